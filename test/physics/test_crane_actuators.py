"""Drives under load: servo quality, force limits, brakes, failures, end stops."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from palfinger import GRAVITY, UP, WORK_POSE, eight_segment_chain, palfinger_actuators, palfinger_limits

from shipcrane_twin.physics.crane_actuators import (
    POWER_BRAKE,
    POWER_COAST,
    POWER_LEAK,
    POWER_ON,
    joint_stiffness,
    standing_state,
)
from shipcrane_twin.physics.crane_cylinders import (
    joint_rates_per_length,
    joints_from_lengths,
    lengths_from_joints,
)
from shipcrane_twin.physics.crane_dynamics import bias_forces, pack_base
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY

CHAIN, LIMITS = eight_segment_chain(), palfinger_limits()
DRIVES = LIMITS.drives
ZERO, STILL = np.zeros(3), np.zeros(4)
VELOCITIES = np.full(4, VELOCITY)
FULL_LOAD = 2200.0
REAL = {
    "push": np.array([1.5e5, 1.04e6, 8.4e5, 1.5e5]),
    "pull": np.array([1.5e5, 5.3e5, 5.3e5, 9.2e4]),
    "hold_push": np.array([1.9e5, 1.3e6, 1.05e6, 1.9e5]),
    "hold_pull": np.array([1.9e5, 6.6e5, 6.5e5, 1.15e5]),
}


def load_b(mass):
    return np.array([0.0, 0.0, -mass * GRAVITY])


def rest_base(mass):
    return pack_base(ZERO, ZERO, UP, load_b(mass))


def rolling_base(t, mass, amplitude=0.0873, period=8.0):
    """Base and hook load while the ship rolls about x; the load's weight stays vertical."""
    omega = 2.0 * np.pi / period
    roll, rate, accel = (
        amplitude * np.sin(omega * t),
        amplitude * omega * np.cos(omega * t),
        -amplitude * omega**2 * np.sin(omega * t),
    )
    up = np.array([0.0, np.sin(roll), np.cos(roll)])
    return pack_base(np.array([rate, 0, 0]), np.array([accel, 0, 0]), GRAVITY * up, -mass * GRAVITY * up)


def standing(actuators, q=WORK_POSE, mass=700.0):
    effort = bias_forces(CHAIN, q, STILL, ZERO, ZERO, UP, load_b(mass))
    return standing_state(actuators, DRIVES, np.asarray(q), effort)


def go(actuators, state, command, seconds, power=POWER_ON, mass=700.0, dt=0.02, base=None):
    """Run and return all states (k, 28), efforts (k, 4) and flags (k, 4)."""
    states, efforts, flags = [], [], []
    for k in range(round(seconds / dt)):
        start, end = (rest_base(mass),) * 2 if base is None else (base(k * dt), base((k + 1) * dt))
        state, _, effort, flag, *_ = crane_step(
            CHAIN, actuators, LIMITS, state, VELOCITIES, np.asarray(command, float), power, start, end, 4, dt
        )
        states.append(state)
        efforts.append(effort)
        flags.append(flag)
    return np.array(states), np.array(efforts), np.array(flags)


FASTEST = LIMITS.rate_max * joint_rates_per_length(DRIVES, WORK_POSE)
LOW_POSE = np.array([-1.6, 0.2, 0.6, 2.0])
JOINTS = ("slew", "boom", "knuckle", "telescope")


@pytest.mark.parametrize("joint", range(4), ids=JOINTS)
def test_velocity_servo_under_full_load(joint, measured):
    actuators = palfinger_actuators(**REAL)
    command = 0.5 * FASTEST[joint] * np.eye(4)[joint]
    states, _, flags = go(actuators, standing(actuators, LOW_POSE, FULL_LOAD), command, 14.0, mass=FULL_LOAD)
    assert not np.any(flags)
    rates = states[:, 4 + joint] / command[joint]
    measured(f"velocity servo of the {JOINTS[joint]}, 2.2 t: overshoot", rates.max() - 1.0, 0.05)
    measured(f"velocity servo of the {JOINTS[joint]}, 2.2 t: steady error", abs(rates[-100:] - 1.0).max(), 0.01)


@pytest.mark.parametrize("joint", range(4), ids=JOINTS)
def test_velocity_servo_tracks_under_full_load_and_roll(joint, measured):
    actuators = palfinger_actuators(**REAL)
    command = 0.5 * FASTEST[joint] * np.eye(4)[joint]
    start = standing(actuators, LOW_POSE, FULL_LOAD)
    states, _, flags = go(
        actuators, start, command, 24.0, mass=FULL_LOAD, base=lambda t: rolling_base(t, FULL_LOAD)
    )
    assert not np.any(flags & 1)
    whole = states[-400:]  # one period of roll
    error = abs((whole[-1, joint] - whole[0, joint]) / (399 * 0.02) / command[joint] - 1.0)
    measured(f"velocity servo of the {JOINTS[joint]}, 2.2 t, roll of 5 deg: steady error", error, 0.01)
    ripple = abs(whole[:, 4 + joint] - command[joint]).max() / FASTEST[joint]
    measured(f"velocity servo of the {JOINTS[joint]}, 2.2 t, roll of 5 deg: largest error over rated", ripple, 0.05)


def test_stiffness_of_a_joint_is_that_of_its_oil_times_arm_squared():
    actuators = palfinger_actuators()
    step, q = 1e-6, np.array([0.1, 0.3, 0.7, 4.0])
    slope = (lengths_from_joints(DRIVES, q + step) - lengths_from_joints(DRIVES, q - step)) / (2.0 * step)
    stiffness, damping = joint_stiffness(actuators, DRIVES, q)
    np.testing.assert_allclose(stiffness, actuators.stiffness * slope**2, rtol=1e-6)
    np.testing.assert_allclose(damping, actuators.damping * slope**2, rtol=1e-6)


def test_forces_stay_within_push_and_pull():
    small = {key: 0.35 * value for key, value in REAL.items()}
    actuators = palfinger_actuators(**small)
    states, efforts, flags = go(actuators, standing(actuators), [0.05, 0.02, 0.02, 0.05], 6.0, mass=2000.0)
    assert np.any(flags & 1)
    ends = (states[:, :4] <= joints_from_lengths(DRIVES, DRIVES.length_min)) | (
        states[:, :4] >= joints_from_lengths(DRIVES, DRIVES.length_max)
    )
    for q, effort, at_end in zip(states[:, :4], efforts, ends, strict=True):
        force = effort * joint_rates_per_length(DRIVES, q)
        within = (force <= small["hold_push"] * (1.0 + 1e-9)) & (force >= -small["hold_pull"] * (1.0 + 1e-9))
        assert np.all(within | at_end)


def test_brakes_shut_at_rest_and_open_to_move():
    actuators = palfinger_actuators(**REAL)
    states, *_ = go(actuators, standing(actuators), STILL, 1.0)
    np.testing.assert_array_equal(states[:, 24:], 1.0)
    moving, *_ = go(actuators, states[-1], [0.0, 0.01, 0.0, 0.0], 2.0)
    np.testing.assert_array_equal(moving[-1, 24:], [1.0, 0.0, 1.0, 1.0])
    stopped, *_ = go(actuators, moving[-1], STILL, 8.0)
    np.testing.assert_array_equal(stopped[-1, 24:], 1.0)
    np.testing.assert_allclose(stopped[-1, 4:8], 0.0, atol=1e-5)


def test_a_brake_holds_what_the_drive_cannot_and_slips_above_its_own_limit():
    boom = bias_forces(CHAIN, WORK_POSE, STILL, ZERO, ZERO, UP, load_b(700.0))[1]
    force = boom * joint_rates_per_length(DRIVES, WORK_POSE)[1]
    for share, falls in ((1.2, False), (0.8, True)):
        hold = REAL["hold_push"].copy()
        hold[1] = share * force
        push = REAL["push"].copy()
        push[1] = 0.7 * force
        actuators = palfinger_actuators(**(REAL | {"hold_push": hold, "push": push}))
        states, *_ = go(actuators, standing(actuators), STILL, 3.0)
        assert (states[-1, 1] < WORK_POSE[1] - 0.02) == falls


def test_power_failure_with_brakes_stops_the_motion_and_stays():
    actuators = palfinger_actuators(**REAL)
    moving, *_ = go(actuators, standing(actuators), [0.05, -0.015, 0.01, 0.05], 4.0)
    states, efforts, _ = go(actuators, moving[-1], [0.05, -0.015, 0.01, 0.05], 6.0, power=POWER_BRAKE)
    assert np.all(np.abs(states[-1, :4] - moving[-1, :4]) < [0.02, 0.01, 0.01, 0.02])
    np.testing.assert_allclose(states[-1, 4:8], 0.0, atol=1e-5)
    force = efforts * np.array([joint_rates_per_length(DRIVES, q) for q in states[:, :4]])
    assert np.all((force <= REAL["hold_push"]) & (force >= -REAL["hold_pull"]))


def test_coasting_booms_fall_onto_their_end_stops_and_pass_them_by_millimetres(measured):
    actuators = palfinger_actuators(**REAL)
    # as in the crane's file: a damping that the micro steps resolve with the outermost segment alone
    actuators.stiffness[3], actuators.damping[3] = 1.5e6, 1.8e4
    states, *_ = go(actuators, standing(actuators), STILL, 120.0, power=POWER_COAST)
    lengths = np.array([lengths_from_joints(DRIVES, q) for q in states[:, :4]])
    assert lengths[-1, 1] < DRIVES.length_min[1] + 1e-3  # the main boom lies on its stop
    past = np.maximum(DRIVES.length_min - lengths, lengths - DRIVES.length_max)[:, 1:].max()
    measured("a coasting crane passes its cylinder ends by", 1e3 * past, 8.0, "mm")
    np.testing.assert_allclose(states[-1, 4:8], 0.0, atol=1e-3)


def test_coasting_gives_friction_and_nothing_else():
    actuators = palfinger_actuators(**REAL)
    start = standing(actuators)
    start[4] = 0.05
    states, efforts, _ = go(actuators, start, STILL, 1.0, power=POWER_COAST)
    for state, effort in zip(states, efforts, strict=True):
        slope = joint_rates_per_length(DRIVES, state[:4])
        share = state[4:8] / slope / LIMITS.rate_max
        force = -actuators.friction * share
        np.testing.assert_allclose(effort * slope, force, rtol=1e-9, atol=1e-6)


def test_a_leaking_valve_lets_the_boom_down_at_leak_times_force():
    actuators = palfinger_actuators(**REAL)
    start = standing(actuators)
    states, efforts, _ = go(actuators, start, STILL, 10.0, power=POWER_LEAK)
    lengths = np.array([lengths_from_joints(DRIVES, q) for q in states[:, :4]])
    force = efforts * np.array([joint_rates_per_length(DRIVES, q) for q in states[:, :4]])
    for joint in (1, 2):
        assert np.all(force[:, joint] > 0.0)
        drift = (lengths[-1, joint] - lengths[100, joint]) / 8.0
        yielded = actuators.leak_push[joint] * force[100:, joint].mean()
        assert -drift == pytest.approx(yielded, rel=0.05)
    assert lengths[-1, 1] < lengths[0, 1] - 1e-3


def test_after_a_leak_power_takes_the_crane_up_where_it_is():
    actuators = palfinger_actuators(**REAL)
    drifted, *_ = go(actuators, standing(actuators), STILL, 10.0, power=POWER_LEAK)
    states, *_ = go(actuators, drifted[-1], STILL, 3.0)
    np.testing.assert_allclose(states[-1, :4], drifted[-1, :4], atol=5e-4)


COMMAND = st.one_of(st.floats(-0.1, 0.1), st.sampled_from([np.nan, np.inf, -np.inf, 1e12, -1e12]))


@settings(deadline=None, max_examples=10)  # the first call compiles
@given(
    commands=st.lists(st.tuples(*[COMMAND] * 4).map(np.array), min_size=1, max_size=20),
    position=st.lists(st.booleans(), min_size=4, max_size=4),
    dt=st.sampled_from([0.02, 0.1, 0.2]),
    seed=st.integers(0, 2**32 - 1),
)
def test_random_commands_for_ten_thousand_steps(commands, position, dt, seed):
    """A thousand steps in each of ten examples: all finite, no limit exceeded, ends kept, on a rolling ship."""
    actuators = palfinger_actuators(**REAL)
    state, rng = standing(actuators), np.random.default_rng(seed)
    mode = np.where(position, POSITION, VELOCITY)
    command = commands[0]
    micro = round(dt / 0.005)
    for k in range(1000):
        if k % 25 == 0:
            command = commands[rng.integers(len(commands))]
        ends = rolling_base(k * dt, 700.0), rolling_base((k + 1) * dt, 700.0)
        before = state
        state, wrench, effort, _, tip, inertia, acc = crane_step(
            CHAIN, actuators, LIMITS, state, mode, command, POWER_ON, *ends, micro, dt
        )
        for array in (state, wrench, effort, tip, inertia, acc):
            assert np.all(np.isfinite(array))
        speed = state[16:20] / LIMITS.lag
        assert np.all(np.abs(speed) <= LIMITS.rate_max * (1.0 + 1e-9))
        accel = (state[12:16] - speed) / LIMITS.lag
        assert np.all(np.abs(accel) <= LIMITS.accel_max * (1.0 + 1e-6))
        was = (before[12:16] - before[16:20] / LIMITS.lag) / LIMITS.lag
        braked = state[24:] > before[24:]  # a brake that shuts ends what is left of the lag
        assert np.all((np.abs(accel - was) <= 2.0 * LIMITS.accel_max / LIMITS.lag * dt * (1.0 + 1e-6)) | braked)
        length = lengths_from_joints(DRIVES, state[:4])
        assert np.all((length >= DRIVES.length_min - 2e-3) & (length <= DRIVES.length_max + 2e-3))
        force = effort * joint_rates_per_length(DRIVES, state[:4])
        assert np.all((force <= REAL["hold_push"]) & (force >= -REAL["hold_pull"]))
