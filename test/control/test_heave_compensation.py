"""Heave compensation: what it leaves of a heave against the closed form, its limits, and what it lets pass."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.control.heave_compensation import (
    carried_heave,
    heave_compensation_step,
    make_heave_compensation,
)

STEP_S = 0.02
CORNER_S = 500.0
FREQUENCIES_HZ = (0.05, 0.1, 0.2)
numbers = st.floats(-1e6, 1e6) | st.sampled_from([np.nan, np.inf, -np.inf])


def params(corner_period_s=CORNER_S, winch_lag_s=0.0, speed_max=10.0, accel_max=50.0, period=STEP_S):
    return make_heave_compensation(corner_period_s, winch_lag_s, speed_max, accel_max, period)


def winch_under(constants, heave, duration_s, lag_s=0.0):
    """Return times, heave (n, 3: height, velocity, acceleration) and paid-out length of a winch one step late."""
    time_s = np.arange(0.0, duration_s, STEP_S)
    tip = np.column_stack(heave(time_s))
    state, command, speed = np.zeros(3), 0.0, 0.0
    length = np.zeros(len(time_s))
    for k in range(1, len(time_s)):
        after = command if lag_s == 0.0 else command + (speed - command) * np.exp(-STEP_S / lag_s)
        length[k] = length[k - 1] + 0.5 * STEP_S * (speed + after)
        speed = after
        state, command = heave_compensation_step(constants, state, tip[k, 1], tip[k, 2], True)
    return time_s, tip, length


def sine(frequency_hz):
    omega = 2.0 * np.pi * frequency_hz
    return lambda t: (np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t))


def amplitude(values, time_s, frequency_hz):
    """Return the complex amplitude of whole periods at the end of a series."""
    period_s = 1.0 / frequency_hz
    count = round(3 * period_s / STEP_S)
    return 2.0 * np.mean(values[-count:] * np.exp(-2j * np.pi * frequency_hz * time_s[-count:]))


def left_of(frequency_hz, constants, lag_s=0.0):
    """Return load heave over tip heave when the filter has settled, as a complex number."""
    time_s, tip, length = winch_under(constants, sine(frequency_hz), 1500.0, lag_s)
    load = amplitude(tip[:, 0] - length, time_s, frequency_hz)
    return load / amplitude(tip[:, 0], time_s, frequency_hz)


def high_pass_leaves(frequency_hz, corner_period_s=CORNER_S):
    """Return ``1 - H`` of the Butterworth high-pass of second order."""
    s = 1j * frequency_hz * corner_period_s
    return (1.0 + np.sqrt(2.0) * s) / (1.0 + np.sqrt(2.0) * s + s * s)


@pytest.mark.parametrize("frequency_hz", FREQUENCIES_HZ)
def test_what_is_left_of_a_heave_is_what_the_high_pass_leaves(frequency_hz, measured):
    left = left_of(frequency_hz, params())
    # linear extrapolation over one step H errs by (w H)^2 / 2, holding the last command by as much
    assert abs(left - high_pass_leaves(frequency_hz)) <= (2.0 * np.pi * frequency_hz * STEP_S) ** 2 + 1e-3
    measured(f"heave compensation: load over tip heave at {frequency_hz:g} Hz, linear winch", abs(left), 0.10)


@pytest.mark.parametrize("frequency_hz", FREQUENCIES_HZ)
def test_a_winch_with_lag_is_led_by_just_that_lag(frequency_hz):
    lag_s = 0.3
    led = left_of(frequency_hz, params(winch_lag_s=lag_s), lag_s)
    omega = 2.0 * np.pi * frequency_hz
    # through a lag a held command acts from the step's start on, half a step before the lead counts on it
    assert abs(led - high_pass_leaves(frequency_hz)) <= 0.6 * omega * STEP_S + 1e-3
    assert abs(left_of(frequency_hz, params(), lag_s) - high_pass_leaves(frequency_hz)) > 0.8 * omega * lag_s


def test_after_a_lasting_rise_the_wire_comes_back_to_the_operators_length():
    def rise(t):
        ramp = np.clip(t / 2.0, 0.0, 1.0)
        angle = np.pi * ramp
        inside = (t < 2.0).astype(float)
        half = np.pi / 2.0
        return (
            0.5 * (1.0 - np.cos(angle)),
            0.5 * half * np.sin(angle) * inside,
            0.5 * half**2 * np.cos(angle) * inside,
        )

    _, _, length = winch_under(params(corner_period_s=50.0), rise, 200.0)
    assert np.max(length) == pytest.approx(1.0, abs=0.2)  # first it follows
    assert abs(length[-1]) < 1e-3


def test_motion_far_slower_than_the_corner_passes():
    assert abs(left_of(1.0 / 250.0, params(corner_period_s=25.0))) == pytest.approx(1.0, abs=0.02)


@given(steps=st.lists(st.tuples(numbers, numbers, st.booleans()), min_size=1, max_size=60))
@settings(deadline=None, max_examples=50)
def test_nothing_makes_the_command_exceed_its_limits(steps):
    constants = params(speed_max=0.4, accel_max=0.5)
    state, before = np.zeros(3), 0.0
    for velocity, accel, active in steps:
        state, command = heave_compensation_step(constants, state, velocity, accel, active)
        assert np.isfinite(state).all()
        assert abs(command) <= 0.4
        assert abs(command - before) <= 0.5 * STEP_S * (1.0 + 1e-9)
        before = command


def test_while_inactive_nothing_is_said_but_the_filter_runs():
    constants = params(corner_period_s=20.0)
    state, said = np.zeros(3), []
    for _ in range(500):
        state, command = heave_compensation_step(constants, state, 0.3, 0.0, False)
        said.append(command)
    assert not np.any(said)
    assert state[0] == pytest.approx(0.3, rel=0.1)
    _, command = heave_compensation_step(constants, state, 0.3, 0.0, True)
    assert abs(command) < 0.05


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=20)
def test_heave_of_a_carried_point_is_the_derivative_of_its_height(seed):
    rng = np.random.default_rng(seed)
    arm_b, start = rng.uniform(-20.0, 20.0, 3), Rotation.random(rng=rng)
    velocity_b, accel_b = rng.normal(size=3), rng.normal(size=3)
    omega_b, alpha_b = 0.3 * rng.normal(size=3), 0.3 * rng.normal(size=3)

    def height(t):
        # to third order in t: what first and second derivatives at zero need
        turned = start * Rotation.from_rotvec(omega_b * t + 0.5 * alpha_b * t * t)
        moved = start.apply(velocity_b * t + 0.5 * accel_b * t * t)
        return (moved + turned.apply(arm_b))[2]

    h = 1e-3
    odom = np.concatenate((np.zeros(3), start.as_quat(), velocity_b, omega_b))
    velocity, accel = carried_heave(odom, np.concatenate((accel_b, alpha_b)), start.apply(arm_b))
    assert velocity == pytest.approx((height(h) - height(-h)) / (2.0 * h), abs=1e-4)
    assert accel == pytest.approx((height(h) - 2.0 * height(0.0) + height(-h)) / h**2, abs=1e-4)


@pytest.mark.parametrize(
    "wrong",
    [{"corner_period_s": 0.05}, {"winch_lag_s": -0.1}, {"speed_max": 0.0}, {"accel_max": -1.0}, {"period": 0.0}],
)
def test_constants_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match="heave compensation"):
        params(**wrong)
