"""The winch: limits, ends, drum and layers, what motor, brake and leak hold."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from wire_rig import WINCH, hoist

from shipcrane_twin.physics.payload import hanging_state
from shipcrane_twin.physics.winch import (
    BRAKED,
    COASTING,
    LEAKING,
    NESTING,
    POWERED,
    braking_speed,
    drum_layer,
    line_pull,
    winch_at_rest,
    winch_speed,
    winch_step,
)
from shipcrane_twin.validation.lifting_wire import FIXED, WIRE

compiled = settings(deadline=None)


@settings(deadline=None, max_examples=200)
@given(
    commands=st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=30),
    start=st.floats(0.2, 5.0),
    step_s=st.sampled_from([0.005, 0.02, 0.05, 0.1, 0.2]),
)
@example(commands=[2.0], start=4.0, step_s=0.2)
@example(commands=[-2.0], start=1.0, step_s=0.2)
def test_winch_keeps_speed_acceleration_and_ends(commands, start, step_s):
    winch = WINCH._replace(length_max=5.0)
    length, speed = start, 0.0
    for command in np.repeat(commands, max(1, round(3.0 / step_s / len(commands)))):
        after = winch_speed(winch, length, speed, command, step_s)
        assert abs(after) <= winch.speed_max
        assert abs(after - speed) <= winch.accel_max * step_s * (1.0 + 1e-9)
        length += 0.5 * (speed + after) * step_s
        assert winch.length_min - 1e-9 <= length <= winch.length_max + 1e-9
        speed = after


@pytest.mark.parametrize("command", [0.3, -0.3])
def test_winch_reaches_and_keeps_the_commanded_speed(command):
    length, speed = 50.0, 0.0
    for k in range(1, 101):
        speed = winch_speed(WINCH, length, speed, command, 0.02)
        assert abs(speed) == pytest.approx(min(0.3, k * 0.02 * WINCH.accel_max))
    assert np.sign(speed) == np.sign(command)


@pytest.mark.parametrize(("command", "end"), [(1.0, WINCH.length_max), (-1.0, WINCH.length_min)])
def test_winch_runs_right_up_to_its_ends_and_stops(command, end):
    length, speed = end - np.sign(command) * 2.0, 0.0
    for _ in range(1000):
        after = winch_speed(WINCH, length, speed, command, 0.02)
        length += 0.5 * (speed + after) * 0.02
        speed = after
    assert length == pytest.approx(end, abs=1e-3)
    assert speed == pytest.approx(0.0, abs=1e-3)


@compiled
@given(room=st.floats(0.0, 10.0), step_s=st.floats(0.005, 0.2))
def test_braking_speed_uses_up_the_room(room, step_s):
    speed = braking_speed(room, 0.25, step_s)
    assert speed * step_s + speed**2 / 0.5 == pytest.approx(room, abs=1e-12)


def run_winch(winch, commands, step_s, length, by_length=False):
    """Length, speed told and its limits over macro steps of a winch that nothing pulls."""
    memory, path = winch_at_rest(winch, step_s), []
    for command in commands:
        told = memory[1]
        memory, _ = winch_step(winch, memory, length, command, by_length, POWERED, step_s)
        length += 0.5 * (told + memory[1]) * step_s
        path.append((length, memory[1]))
    return np.array(path)


anything = st.one_of(st.floats(-2.0, 2.0), st.floats(allow_nan=True, allow_infinity=True))


@settings(deadline=None, max_examples=150)
@given(
    commands=st.lists(anything, min_size=1, max_size=20),
    start=st.floats(0.2, 5.0),
    step_s=st.sampled_from([0.001, 0.02, 0.05, 0.2]),
    jerk=st.floats(0.1, 100.0),
    by_length=st.booleans(),
)
@example(commands=[np.nan, 2.0, np.inf, -np.inf], start=4.0, step_s=0.2, jerk=0.3, by_length=False)
@example(commands=[np.nan, 6.0, 0.0, np.inf], start=4.0, step_s=0.2, jerk=0.3, by_length=True)
def test_told_speed_keeps_speed_acceleration_jerk_and_ends(commands, start, step_s, jerk, by_length):
    winch = WINCH._replace(length_max=5.0, jerk_max=jerk)
    steps = np.repeat(commands, max(1, round(min(6.0, 300 * step_s) / step_s / len(commands))))
    length, speed = run_winch(winch, steps, step_s, start, by_length).T
    speed = np.concatenate(([0.0, 0.0], speed))
    accel = np.diff(speed) / step_s
    assert np.abs(speed).max() <= winch.speed_max * (1.0 + 1e-9)
    assert np.abs(accel).max() <= winch.accel_max * (1.0 + 1e-9)
    assert np.abs(np.diff(accel)).max() / step_s <= max(jerk, 0.0) * (1.0 + 1e-6) + 1e-9
    assert length.min() >= winch.length_min - 1e-9
    assert length.max() <= winch.length_max + 1e-9


@pytest.mark.parametrize("jerk", [0.4, 10.0])
@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
@pytest.mark.parametrize("goal", [3.0, 20.0])
def test_a_wanted_length_is_reached_without_overshoot_and_kept(goal, step_s, jerk):
    winch = WINCH._replace(jerk_max=jerk)
    length, speed = run_winch(winch, np.full(round(60.0 / step_s), goal), step_s, 10.0, by_length=True).T
    assert length[-1] == pytest.approx(goal, abs=2e-3)
    assert speed[-1] == pytest.approx(0.0, abs=2e-3)
    side = np.sign(goal - 10.0)
    assert (side * (goal - length)).min() >= -1e-9
    assert (side * speed).max() == pytest.approx(winch.speed_max)


def test_layers_hold_all_wire_and_the_pull_falls_with_their_radius():
    winch = WINCH._replace(core_radius=0.2, wire_diameter=0.02, turns=30.0, wire_length=105.0, length_max=105.0)
    radii = 0.21 + NESTING * 0.02 * np.arange(3)
    held = np.cumsum(30.0 * 2.0 * np.pi * radii)  # 39.6, 82.4 and 128.5 m
    for stored, layer in [(1.0, 0), (held[0] - 0.01, 0), (held[0] + 0.01, 1), (held[1] + 0.01, 2), (104.8, 2)]:
        found = drum_layer(winch, 105.0 - stored)
        assert found == (layer, pytest.approx(radii[layer]))
        hold = winch_step(winch, winch_at_rest(winch, 0.02), 105.0 - stored, 0.3, False, POWERED, 0.02)[1]
        assert hold.pull == pytest.approx(winch.motor_torque / radii[layer])
        assert hold.mass == pytest.approx(winch.inertia / radii[layer] ** 2)


def pulled(command, mass, drive=POWERED, seconds=2.0, length=5.0, step_s=0.02, winch=WINCH, wire=WIRE, memory=None):
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    return hoist(state, step_s, round(seconds / step_s), command, drive, winch, wire, at_rest=memory)


def radius_at(length):
    return drum_layer(WINCH, length)[1]


def test_brake_holds_up_to_its_capacity_and_no_more():
    capacity = WINCH.brake_torque / radius_at(5.0) / WIRE.gravity
    for share, slips in ((0.98, False), (1.02, True)):
        states, _, _ = pulled(0.0, share * capacity)
        assert (states[-1, 6] > 5.0 + 1e-6) == slips


def test_an_overloaded_winch_stalls_and_pays_out_as_its_torque_leaves_over():
    limit = WINCH.motor_torque / radius_at(5.0)
    mass = 1.1 * limit / WIRE.gravity
    turning = WINCH.inertia / radius_at(5.0) ** 2
    states, memories, _ = pulled(-0.3, mass, seconds=1.5)
    assert memories[-1, 1] == pytest.approx(-0.3)
    # load and drum fall together under what the motor cannot hold
    sink = (mass * WIRE.gravity - limit) / (mass + turning)
    fall = np.diff(states[5:, 7]) / 0.02
    assert fall.mean() == pytest.approx(sink, rel=0.02)
    held, memories, _ = pulled(-0.3, 0.9 * limit / WIRE.gravity, seconds=1.5)
    np.testing.assert_allclose(held[20:, 7], memories[20:, 1], atol=1e-12)


@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
def test_a_coasting_winch_lets_the_load_fall_against_drag_and_inertia(step_s, measured):
    mass = 700.0
    radius = radius_at(5.0)
    turning = WINCH.inertia / radius**2
    states, _, _ = pulled(0.0, mass, COASTING, 2.0, step_s=step_s)
    sink = (mass * WIRE.gravity - WINCH.drag_torque / radius) / (mass + turning)
    slope = np.diff(states[:, 5])[round(0.6 / step_s) :].mean() / step_s
    measured(f"fall of a load on a coasting winch, H = {1e3 * step_s:g} ms", abs(-slope / sink - 1.0), 1e-2)


def test_a_brake_that_falls_in_while_moving_stops_drum_and_load_as_its_torque_does():
    mass, radius = 700.0, radius_at(20.0)
    states, _, _ = pulled(0.5, mass, seconds=4.0, length=20.0)
    assert states[-1, 7] == pytest.approx(0.5)
    stopped, _, _ = hoist(states[-1], 0.001, 400, 0.0, BRAKED, at_rest=winch_at_rest(WINCH, 0.001))
    assert stopped[0, 7] == pytest.approx(0.5)
    turning = WINCH.inertia / radius**2
    at_first = (WINCH.brake_torque / radius - mass * WIRE.gravity) / turning
    assert -np.diff(stopped[:3, 7])[0] / 0.001 == pytest.approx(at_first, rel=0.05)
    assert (stopped[-1, 7], stopped[-1, 6]) == (0.0, pytest.approx(stopped[200, 6]))


@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
def test_a_leaking_winch_sinks_in_proportion_to_the_pull(step_s, measured):
    for mass in (350.0, 1400.0):
        states, _, _ = pulled(0.0, mass, LEAKING, 8.0, step_s=step_s)
        drift = (states[-1, 6] - states[len(states) // 2, 6]) / (len(states) - 1 - len(states) // 2) / step_s
        share = mass * WIRE.gravity * radius_at(5.0) / WINCH.motor_torque
        name = f"drift of {mass:g} kg on a leaking winch, H = {1e3 * step_s:g} ms"
        measured(name, abs(drift / (share * WINCH.leak_speed) - 1.0), 1e-3)


def test_the_end_of_the_wire_on_the_drum_stops_a_fall():
    winch = WINCH._replace(length_max=6.0, wire_length=7.0)
    states, _, _ = pulled(0.0, 700.0, COASTING, 3.0, winch=winch)
    assert 7.0 <= states[-1, 6] <= 7.02
    assert states[-1, 7] == 0.0
    assert np.isfinite(states).all()


def test_sheaves_make_hoisting_heavier_and_lowering_lighter():
    assert line_pull(1e4, -0.3, 0.08) == pytest.approx(1.08e4)
    assert line_pull(1e4, 0.3, 0.08) == pytest.approx(0.92e4)
    assert line_pull(1e4, 0.0, 0.08) == 1e4
    # at the limit of the motor the friction decides whether the load comes up
    mass = 0.95 * WINCH.motor_torque / radius_at(5.0) / WIRE.gravity
    for friction, stalls in ((0.0, False), (0.1, True)):
        winch = WINCH._replace(sheave_friction=friction)
        states, memories, _ = pulled(-0.3, mass, seconds=2.0, winch=winch)
        assert (np.abs(states[-30:, 7] - memories[-30:, 1]).max() > 0.05) == stalls


@settings(deadline=None, max_examples=60)
@given(
    log_length=st.floats(np.log(0.2), np.log(100.0)),
    log_mass=st.floats(0.0, np.log(5e4)),
    step_s=st.floats(0.001, 0.2),
    command=anything,
    drive=st.sampled_from([POWERED, COASTING, BRAKED, LEAKING]),
)
def test_any_load_on_any_drive_stays_finite_and_loses_energy(log_length, log_mass, step_s, command, drive):
    length, mass = np.exp(log_length), np.exp(log_mass)
    states, _, forces = pulled(command, mass, drive, 40 * step_s, length, step_s)
    assert np.isfinite(states).all()
    assert np.isfinite(forces).all()
    assert states[:, 6].min() > 0.0
    if drive != POWERED:
        height = states[:, 2] - FIXED[2]
        kinetic = 0.5 * mass * np.sum(states[:, 3:6] ** 2, axis=1)
        slack = 1e-3 * mass * WIRE.gravity
        assert (kinetic + mass * WIRE.gravity * (height - height[0])).max() <= slack * length + 1e-6
