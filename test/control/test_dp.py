"""Dynamic positioning: reference, controller, allocation, and the ship that it holds."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.control.dp import (
    allocation_matrix,
    dp_start,
    dp_update,
    move_reference,
    pid_gains,
    to_body,
)
from shipcrane_twin.cosim.build import dp_params, thruster_params
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.frames import quat_from_euler, yaw_from_heading
from shipcrane_twin.physics.thrusters import thruster_load

SCENARIO = load_scenario("case2")
DP = dp_params(SCENARIO)
THRUSTERS = thruster_params(SCENARIO)
STILL = np.zeros(3)
compiled = settings(deadline=None)
places = st.floats(-30.0, 30.0)
yaws = st.floats(-3.1, 3.1)


def reference_path(state, setpoints, updates):
    """States (n, 9) on the way along the set-points, so many updates towards each."""
    path = [state]
    for setpoint in setpoints:
        for _ in range(updates):
            path.append(move_reference(DP, path[-1], np.array(setpoint)))
    return np.array(path)


def assert_within_limits(path):
    rates = path[:, 3:6]
    assert np.all(np.abs(rates) <= DP.rate_max * (1.0 + 1e-12))
    assert np.all(np.abs(np.diff(rates, axis=0)) <= DP.accel_max * DP.period * (1.0 + 1e-9))
    np.testing.assert_allclose(np.diff(path[:, :3], axis=0), rates[1:] * DP.period, atol=1e-12)


@settings(deadline=None, max_examples=40)
@given(start=st.tuples(places, places, yaws), goal=st.tuples(places, places, yaws))
@example(start=(0.0, 0.0, 3.0), goal=(0.0, 0.0, -3.0))
def test_reference_keeps_its_limits_and_arrives_without_overshoot(start, goal):
    path = reference_path(dp_start(np.array(start)), [goal], 6000)
    assert_within_limits(path)
    rest = np.array(goal) - path[:, :3]
    rest[:, 2] = (rest[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    assert np.all(rest * np.sign(rest[0]) >= -1e-3)
    np.testing.assert_allclose(rest[-1], 0.0, atol=1e-3)


@compiled
@given(moves=st.lists(st.tuples(places, places, yaws), min_size=2, max_size=8))
def test_reference_keeps_its_limits_whatever_the_operator_does(moves):
    assert_within_limits(reference_path(dp_start(np.zeros(3)), moves, 100))


def test_reference_turns_the_short_way_round():
    state = dp_start(np.array([0.0, 0.0, 3.0]))
    assert move_reference(DP, state, np.array([0.0, 0.0, -3.0]))[5] > 0.0


def test_switching_on_gives_no_bump():
    pose = np.array([3.0, -4.0, 1.2])
    _, load, command = dp_update(DP, dp_start(pose), pose, STILL, pose)
    np.testing.assert_allclose(load, 0.0, atol=1e-9)
    np.testing.assert_allclose(command, 0.0, atol=1e-9)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_ship_off_its_reference_is_pushed_back_along_that_axis_only(axis, yaw):
    off_b = np.zeros(3)
    off_b[axis] = 0.01
    place = np.array([5.0, 7.0, yaw])
    off_w = to_body(off_b, np.cos(yaw), -np.sin(yaw))
    turned = yaw + off_b[2]
    _, load, _ = dp_update(DP, dp_start(place), place + off_w, STILL, place)
    expected = np.zeros(3)
    expected[axis] = -0.01 * (DP.stiffness[axis] + DP.integral[axis] * DP.period)
    np.testing.assert_allclose(load, expected, atol=1e-6 * DP.stiffness[axis])
    assert turned == pytest.approx(place[2] + off_w[2])


def test_motion_is_damped_on_each_axis():
    pose, velocity = np.zeros(3), np.array([0.01, -0.02, 0.001])
    _, load, _ = dp_update(DP, dp_start(pose), pose, velocity, pose)
    np.testing.assert_allclose(load, -DP.damping * velocity)


@compiled
@given(pose=st.tuples(places, places, yaws), off=st.tuples(places, places, yaws), seed=st.integers(0, 999))
def test_asked_load_never_exceeds_its_limit(pose, off, seed):
    rng, state = np.random.default_rng(seed), dp_start(np.array(pose))
    for _ in range(20):
        state, load, _ = dp_update(DP, state, np.array(off), rng.normal(size=3), np.array(pose))
        assert np.all(np.abs(load) <= DP.load_max)


def test_integrator_holds_while_the_demand_is_limited():
    reference, far = np.zeros(3), np.array([-100.0, 100.0, 0.0])
    state, load, _ = dp_update(DP, dp_start(reference), far, STILL, reference)
    np.testing.assert_allclose(load[:2], [DP.load_max[0], -DP.load_max[1]])
    np.testing.assert_array_equal(state[6:9], np.zeros(3))


def test_integrator_gathers_the_error_while_there_is_room():
    reference, near = np.zeros(3), np.array([-0.1, 0.2, 0.01])
    state, _, _ = dp_update(DP, dp_start(reference), near, STILL, reference)
    np.testing.assert_allclose(state[6:9], -near * DP.period)


def test_integrator_unwinds_though_the_demand_is_limited():
    state = dp_start(np.zeros(3))
    state[6] = 1e4  # pushes forward beyond the limit while the ship is already ahead
    new, load, _ = dp_update(DP, state, np.array([1.0, 0.0, 0.0]), STILL, np.zeros(3))
    assert load[0] == DP.load_max[0]
    assert new[6] < 1e4


def test_integral_stays_in_the_world_when_the_ship_turns():
    state = dp_start(np.array([0.0, 0.0, np.pi / 2]))
    state[6:9] = 100.0, 0.0, 0.0  # holds against a push to the west, with the bow to the north
    _, load, _ = dp_update(DP, state, state[:3].copy(), STILL, state[:3].copy())
    np.testing.assert_allclose(load, [0.0, -100.0 * DP.integral[1], 0.0], atol=1e-9)


@compiled
@given(load=st.tuples(st.floats(-6e4, 6e4), st.floats(-4e4, 4e4), st.floats(-3e5, 3e5)).map(np.array))
def test_allocation_gives_the_load_that_was_asked_for(load):
    command = (DP.allocation @ load).reshape(-1, 2)
    found = thruster_load(THRUSTERS, command)[[0, 1, 5]]
    np.testing.assert_allclose(found, load, atol=1e-9 * 6e5)
    assert command[2, 0] == pytest.approx(0.0, abs=1e-9)  # the tunnel thruster pushes sideways only


@compiled
@given(seed=st.integers(0, 999))
def test_allocation_takes_the_least_thrust_that_does_it(seed):
    rng = np.random.default_rng(seed)
    matrix = allocation_matrix(THRUSTERS.position, THRUSTERS.azimuthing)
    effect = np.linalg.pinv(matrix)
    load, other = rng.normal(size=3), rng.normal(size=6)
    other[4] = 0.0
    least = matrix @ load
    same_effect = least + other - matrix @ (effect @ other)
    np.testing.assert_allclose(effect @ same_effect, load, atol=1e-9)
    assert np.linalg.norm(least) <= np.linalg.norm(same_effect) + 1e-12


def test_gains_give_each_axis_the_wanted_period_and_damping():
    inertia = np.array([5e5, 6e5, 4e7])
    stiffness, damping, integral = pid_gains(inertia, np.array([70.0, 60.0, 50.0]), np.array([0.8, 0.7, 0.6]))
    roots = [np.roots([m, d, k])[0] for m, d, k in zip(inertia, damping, stiffness, strict=True)]
    np.testing.assert_allclose(2.0 * np.pi / np.abs(roots), [70.0, 60.0, 50.0])
    np.testing.assert_allclose(-np.real(roots) / np.abs(roots), [0.8, 0.7, 0.6])
    for m, d, k, i in zip(inertia, damping, stiffness, integral, strict=True):
        assert np.real(np.roots([m, d, k, i])).max() < 0.0


def test_inputs_stay_untouched():
    state, pose = dp_start(np.ones(3)), np.array([2.0, 3.0, 0.5])
    kept = state.copy()
    dp_update(DP, state, pose, STILL, np.zeros(3))
    np.testing.assert_array_equal(state, kept)
    np.testing.assert_array_equal(pose, [2.0, 3.0, 0.5])


def cog_place(odom):
    """East, north of the CoG from the odometry of base_link; heel moves it by centimetres at most."""
    x, y, z, w = odom[3:7]
    yaw = np.arctan2(2.0 * (x * y + z * w), 1.0 - 2.0 * (y * y + z * z))
    return odom[:2] + 15.516 * np.array([np.cos(yaw), np.sin(yaw)]), yaw


@pytest.fixture(scope="module")
def held_ship():
    weather = [
        "environment.current_speed_m_s=0.5",
        "environment.current_direction_to_deg=-135.0",
        "environment.wind_speed_m_s=1.0",
        "environment.wind_direction_to_deg=-135.0",
        "duration_s=340.0",
        "macro_step_ms=50.0",
    ]
    places, yaws = [], []
    run = InlineRun(load_scenario("case2", weather))
    for _ in run.steps():
        place, yaw = cog_place(run.latest["/vessel/odom"])
        places.append(place)
        yaws.append(yaw)
    return np.arange(len(places)) * 0.05, np.array(places), np.array(yaws)


def test_ship_drifts_with_the_current_until_dp_is_on(held_ship):
    times, places, _ = held_ship
    drift = places[np.searchsorted(times, 50.0)] - places[0]
    assert drift[0] < -0.3
    assert drift[1] < -0.3


def test_ship_under_dp_comes_back_to_its_place_in_current_and_wind(held_ship, measured):
    times, places, yaws = held_ship
    late = times >= 300.0
    off = np.linalg.norm(places[late], axis=1).max()
    measured("DP in current 0.5 m/s and wind 1 m/s after 300 s: position", off, 0.5, "m")
    assert np.abs(np.rad2deg(yaws[late] - yaw_from_heading(0.0))).max() < 1.0


def test_setpoint_of_the_scenario_is_where_the_ship_goes():
    goal = ["dp.setpoint.north_m=3.0", "dp.setpoint.east_m=-2.0", "dp.setpoint.heading_deg=10.0"]
    early = ["dp.enabled_at_s=0.0", "duration_s=200.0", "macro_step_ms=50.0", "operations=[]"]
    run = InlineRun(load_scenario("case2", goal + early))
    for _ in run.steps():
        pass
    place, yaw = cog_place(run.latest["/vessel/odom"])
    np.testing.assert_allclose(place, [-2.0, 3.0], atol=0.5)
    assert yaw == pytest.approx(yaw_from_heading(10.0), abs=np.deg2rad(1.0))
    np.testing.assert_allclose(run.latest["/dp/setpoint"][3:], quat_from_euler(0.0, 0.0, yaw_from_heading(10.0)))
