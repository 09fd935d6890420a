"""PID controller: closed loop as asked for, no bump, no windup, feed-forward, frames, bad input."""

import numpy as np
import pytest
from dp_rig import (
    DRAG,
    LOAD_MAX,
    MASS,
    PERIOD_S,
    STILL,
    UNKNOWN,
    controller,
    held_at,
    held_ship,
    move,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.control.controller import (
    ACTIVE,
    CRANE,
    INTEGRAL,
    UNLIMITED,
    controller_start,
    controller_update,
    horizontal_load,
    pid_gains,
    to_body,
    to_world,
)
from shipcrane_twin.control.reference import ACCEL, POSE, RATE, ReferenceParams, reference_start, reference_step

FREE = np.full(3, 1e12)
yaws = st.floats(-3.1, 3.1)
loads = st.tuples(st.floats(-3e4, 3e4), st.floats(-3e4, 3e4), st.floats(-3e5, 3e5)).map(np.array)
compiled = settings(deadline=None, max_examples=40)


def running(params, pose=STILL):
    """State of a controller that has been switched on at a pose, at rest."""
    return controller_update(params, controller_start(), True, held_at(pose), pose, STILL, STILL, STILL, STILL)[0]


@pytest.mark.parametrize("axis", range(3))
def test_step_response_has_the_natural_period_and_damping_asked_for(axis, measured):
    period, ratio, yaw = 60.0, 0.3, 0.7
    params = controller(np.full(3, period), np.full(3, ratio), load_max=FREE)._replace(integral=np.zeros(3))
    step = np.zeros(3)
    step[axis] = 0.02
    start = np.array([0.0, 0.0, yaw])
    goal = start + to_world(step, np.cos(yaw), np.sin(yaw))
    # the first update switches on, whatever the error is then
    poses, _ = held_ship(params, 60.0, lambda k: held_at(goal if k else start), pose=start, drag=np.zeros((3, 3)))
    off = poses - poses[0]
    along = np.array([to_body(row, np.cos(yaw), np.sin(yaw)) for row in off])[:, axis] / 0.02
    top = int(along.argmax())
    decrement = -np.log(along[top] - 1.0)
    found = decrement / np.hypot(np.pi, decrement)
    natural = 2.0 * top * PERIOD_S * np.sqrt(1.0 - found**2)
    name = ("surge", "sway", "yaw")[axis]
    measured(f"DP step response, {name}: natural period off by", abs(natural / period - 1.0), 0.05)
    measured(f"DP step response, {name}: damping ratio off by", abs(found / ratio - 1.0), 0.05)


def test_gains_are_those_of_the_wanted_closed_loop():
    inertia, omega = np.array([5e5, 6e5, 4e7]), 2.0 * np.pi / np.array([70.0, 60.0, 50.0])
    stiffness, damping, integral = pid_gains(inertia, 2.0 * np.pi / omega, np.array([0.8, 0.7, 0.6]))
    roots = [np.roots([m, d, k])[0] for m, d, k in zip(inertia, damping, stiffness, strict=True)]
    np.testing.assert_allclose(np.abs(roots), omega)
    np.testing.assert_allclose(-np.real(roots) / np.abs(roots), [0.8, 0.7, 0.6])
    np.testing.assert_allclose(integral, stiffness * omega / 10.0)


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_gains_refuse_what_is_not_positive(wrong):
    values = [np.ones(3), np.ones(3), np.ones(3)]
    values[wrong] = np.array([1.0, 0.0, 1.0])
    with pytest.raises(ValueError, match="expected positive"):
        pid_gains(*values)


@compiled
@given(yaw=yaws, wind=loads, crane=loads, speed=st.floats(-0.3, 0.3))
def test_first_demand_is_the_load_in_force(yaw, wind, crane, speed):
    params = controller(wind_share=1.0, crane_share=0.8)
    pose, velocity = np.array([3.0, -4.0, yaw]), np.array([speed, 0.1, 0.002])
    moving = held_at(pose)
    moving[RATE] = to_world(velocity, np.cos(yaw), np.sin(yaw))
    off = controller_update(params, controller_start(), False, moving, pose, velocity, wind, crane, UNKNOWN)[0]
    for present, expected in ((STILL, STILL), (UNKNOWN, STILL), (np.array([1e4, -2e3, 5e4]),) * 2):
        _, demand = controller_update(params, off, True, moving, pose, velocity, wind, crane, present)
        np.testing.assert_allclose(demand, expected, atol=1e-6)


def test_second_demand_follows_without_a_bump():
    params = controller(wind_share=1.0)
    pose, wind = np.array([3.0, -4.0, 1.0]), np.array([2e4, 1e4, 1e5])
    state, _ = controller_update(params, controller_start(), True, held_at(pose), pose, STILL, wind, STILL, STILL)
    _, demand = controller_update(params, state, True, held_at(pose), pose, STILL, wind, STILL, STILL)
    np.testing.assert_allclose(demand, 0.0, atol=1e-6)


def test_switch_off_fades_the_load_and_forgets_the_integrator():
    params = controller(fade=5.0)
    pose = np.zeros(3)
    state, last = controller_update(
        params, running(params), True, held_at([1.0, 2.0, 0.1]), pose, STILL, STILL, STILL, STILL
    )
    for k in range(1, 50):
        state, demand = controller_update(params, state, False, held_at(pose), pose, STILL, STILL, STILL, STILL)
        np.testing.assert_allclose(demand, last * np.exp(-k * PERIOD_S / 5.0))
    np.testing.assert_array_equal(state[INTEGRAL], 0.0)
    assert state[ACTIVE] == 0.0
    at_once = params._replace(fade=0.0)
    assert not controller_update(at_once, state, False, held_at(pose), pose, STILL, STILL, STILL, STILL)[1].any()


def test_constant_load_of_the_weather_leaves_no_offset():
    push = np.array([1.5e4, -1e4, 8e4])
    poses, demands = held_ship(controller(), 900.0, disturbance_w=lambda t: push)
    np.testing.assert_allclose(poses[-1], 0.0, atol=0.01)
    np.testing.assert_allclose(demands[-1], -push, rtol=0.02)


@pytest.mark.parametrize("aware", [True, False])
def test_ship_that_was_overpowered_comes_back_without_overshoot(aware, measured):
    def storm(t):
        return np.array([0.0, -18e3 if t < 150.0 else -5e3, 0.0])

    def weak(demand, state):
        thrust = np.clip(demand, -15e3, 15e3)
        return thrust, thrust if aware else state[UNLIMITED]

    poses, _ = held_ship(controller(), 700.0, disturbance_w=storm, limit=weak)
    carried_off, beyond = -poses[:, 1].min(), poses[:, 1].max()
    assert carried_off > 10.0
    if aware:
        measured("DP after saturation: overshoot over excursion", beyond / carried_off, 0.01)
    else:  # windup is what the back-calculation is there for
        assert beyond > 0.5 * carried_off


@compiled
@given(pose=st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0), yaws), seed=st.integers(0, 999))
def test_demand_never_exceeds_its_limit(pose, seed):
    rng, params = np.random.default_rng(seed), controller(wind_share=1.0)
    state = running(params)
    for _ in range(20):
        state, demand = controller_update(
            params, state, True, held_at(pose), STILL, rng.normal(size=3), 1e5 * rng.normal(size=3), STILL, UNKNOWN
        )
        assert np.all(np.abs(demand) <= LOAD_MAX)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_ship_off_its_reference_is_pushed_back_along_that_axis_only(axis, yaw):
    params = controller()
    off, place = np.zeros(3), np.array([5.0, 7.0, yaw])
    off[axis] = 0.01
    pose = place + to_world(off, np.cos(yaw), np.sin(yaw))
    pose[2] = yaw  # the body axes stay where the push is judged
    goal = place.copy()
    goal[2] -= off[2]
    _, demand = controller_update(params, running(params), True, held_at(goal), pose, STILL, STILL, STILL, STILL)
    np.testing.assert_allclose(demand, -0.01 * params.stiffness * (np.arange(3) == axis), atol=1e-6)


def test_heading_error_goes_the_shorter_way_round():
    params = controller(load_max=FREE)
    pose, goal = np.array([0.0, 0.0, 3.1]), np.array([0.0, 0.0, -3.1])
    _, demand = controller_update(params, running(params, pose), True, held_at(goal), pose, STILL, STILL, STILL, STILL)
    assert demand[2] == pytest.approx(params.stiffness[2] * (2.0 * np.pi - 6.2))


@compiled
@given(before=yaws, after=yaws, force=st.floats(-2e4, 2e4))
def test_integrators_load_stays_in_the_world_when_the_ship_turns(before, after, force):
    params = controller()
    state = running(params, np.array([0.0, 0.0, before]))
    state[INTEGRAL] = force, 0.0, 0.0
    state[UNLIMITED] = held = to_body(state[INTEGRAL], np.cos(before), np.sin(before))
    pose = np.array([0.0, 0.0, after])
    _, demand = controller_update(params, state, True, held_at(pose), pose, STILL, STILL, STILL, held)
    np.testing.assert_allclose(to_world(demand, np.cos(after), np.sin(after)), [force, 0.0, 0.0], atol=1e-9)


def test_reference_acceleration_is_fed_forward_as_a_load():
    params, yaw = controller(load_max=FREE), 0.7
    reference = held_at([0.0, 0.0, yaw])
    accel_b = np.array([0.004, -0.003, 1e-4])
    reference[ACCEL] = to_world(accel_b, np.cos(yaw), np.sin(yaw))
    pose = reference[POSE].copy()
    _, demand = controller_update(params, running(params, pose), True, reference, pose, STILL, STILL, STILL, STILL)
    np.testing.assert_allclose(demand, MASS @ accel_b)


def test_ship_follows_the_box_manoeuvre(measured):
    model = ReferenceParams(
        np.array([0.25, np.deg2rad(0.5)]), np.array([0.01, np.deg2rad(0.02)]), 8.0, 1.0, PERIOD_S
    )
    corners = [(10.0, 0.0, 0.0), (10.0, 10.0, 0.0), (10.0, 10.0, np.pi / 4), (0.0, 0.0, np.pi / 4), (0.0, 0.0, 0.0)]
    rows = [reference_start(model, STILL, STILL)]
    for corner in corners:
        for _ in range(2000):
            rows.append(reference_step(model, rows[-1], np.array(corner)))
    poses, _ = held_ship(controller(), 200.0 * len(corners), lambda k: rows[k])
    worst, before = 0.0, np.zeros(3)
    for i, corner in enumerate(corners):
        leg = poses[2000 * i : 2000 * (i + 1)]
        moved = np.array(corner) - before
        for axis in np.flatnonzero(moved):
            beyond = (leg[:, axis] - corner[axis]) / moved[axis]
            worst = max(worst, float(beyond.max()))
        before = np.array(corner)
    measured("box manoeuvre of a ship in the horizontal plane: overshoot", worst, 0.05)


@compiled
@given(load=loads)
def test_crane_feed_forward_cancels_a_steady_wrench_after_its_low_pass(load):
    params = controller(crane_share=1.0, crane_period=20.0)
    state = running(params)
    for _ in range(600):
        state, demand = controller_update(params, state, True, held_at(STILL), STILL, STILL, STILL, load, UNKNOWN)
    np.testing.assert_allclose(demand, np.clip(-load, -LOAD_MAX, LOAD_MAX), atol=1e-3)


def test_crane_feed_forward_takes_a_slow_wrench_out_of_the_excursion(measured):
    def slewing(t):
        return np.array([2e3, 8e3, 1.5e5]) * np.sin(2.0 * np.pi * t / 120.0)

    excursions = []
    for share in (0.0, 1.0):
        params = controller(crane_share=share, crane_period=5.0)
        poses, _ = held_ship(params, 400.0, disturbance_w=slewing, feed=lambda t: (STILL, slewing(t)))
        excursions.append(np.abs(poses[2000:]).max(axis=0))
    measured("crane feed-forward: excursion with over without", (excursions[1] / excursions[0]).max(), 0.1)


def test_low_pass_has_its_cut_off_period():
    params = controller(crane_share=1.0, crane_period=20.0)
    state, found = running(params), []
    for k in range(1200):
        load = np.array([1e4 * np.sin(2.0 * np.pi * k * PERIOD_S / 20.0), 0.0, 0.0])
        state, _ = controller_update(params, state, False, held_at(STILL), STILL, STILL, STILL, load, UNKNOWN)
        found.append(state[CRANE][0])
    assert max(found[600:]) / 1e4 == pytest.approx(np.sqrt(0.5), rel=0.02)


@compiled
@given(seed=st.integers(0, 999), heel=st.floats(-0.2, 0.2), trim=st.floats(-0.1, 0.1), yaw=yaws)
def test_cranes_weight_is_no_horizontal_load_and_its_pull_is(seed, heel, trim, yaw):
    rng = np.random.default_rng(seed)
    turn = Rotation.from_euler("ZYX", [yaw, trim, heel])
    arm_b, pull_w = rng.normal(size=3), rng.normal(size=3)
    weight_b, pull_b = turn.inv().apply([0.0, 0.0, -2e5]), turn.inv().apply(pull_w)
    rot = turn.as_matrix()
    np.testing.assert_allclose(horizontal_load(np.concatenate((weight_b, STILL)), STILL, rot), 0.0, atol=1e-6)
    found = horizontal_load(np.concatenate((pull_b, STILL)), arm_b, rot)
    expected = to_body(pull_w, np.cos(yaw), np.sin(yaw))
    np.testing.assert_allclose(found[:2], expected[:2], atol=1e-12)
    assert found[2] == pytest.approx(np.cross(turn.apply(arm_b), pull_w)[2])


@pytest.mark.parametrize("which", ["pose", "velocity", "wind", "crane", "achieved"])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_input_that_is_no_number_is_left_out(which, axis, bad):
    params = controller(wind_share=1.0, crane_share=1.0)
    good = {name: np.zeros(3) for name in ("pose", "velocity", "wind", "crane", "achieved")}
    broken = {name: value.copy() for name, value in good.items()}
    broken[which][axis] = bad
    for start in (controller_start(), running(params)):
        for on in (True, False):
            state, demand = controller_update(params, start, on, held_at([0.1, 0.1, 0.01]), *broken.values())
            state, demand = controller_update(params, state, on, held_at([0.1, 0.1, 0.01]), *broken.values())
            assert np.isfinite(state).all()
            assert np.isfinite(demand).all()
    if which == "pose":
        kept = running(params)[INTEGRAL]
        new = controller_update(params, running(params), True, held_at([0.1, 0.1, 0.01]), *broken.values())[0]
        assert new[INTEGRAL][axis] == kept[axis]


def test_inputs_stay_untouched():
    params = controller(wind_share=1.0)
    inputs = [running(params), held_at([1.0, 2.0, 0.3]), np.ones(3), np.ones(3), np.ones(3), np.ones(3), np.ones(3)]
    kept = [value.copy() for value in inputs]
    controller_update(params, inputs[0], True, *inputs[1:])
    for value, before in zip(inputs, kept, strict=True):
        np.testing.assert_array_equal(value, before)


def test_rig_moves_as_newton_says():
    pose, velocity = np.zeros(3), np.zeros(3)
    for _ in range(100):
        pose, velocity = move(pose, velocity, np.array([1e4, 0.0, 0.0]), drag=0.0 * DRAG)
    assert velocity[0] == pytest.approx(10.0 * 1e4 / MASS[0, 0])
