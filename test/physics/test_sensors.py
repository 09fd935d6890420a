"""Sensors: perfect when off, and with noise, wandering bias, rate, delay and drop-out as set."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics.frames import quat_from_euler
from shipcrane_twin.physics.sensors import (
    GYRO_KINDS,
    MRU_KINDS,
    POSITION_KINDS,
    WIND_KINDS,
    antenna_position,
    gyro_heading,
    mru_motion,
    perfect_sensor,
    reference_point,
    relative_wind,
    sensor_params,
    sensor_start,
    sensor_step,
    vertical_acceleration,
)
from shipcrane_twin.physics.wind import WindParams, wind_load

DT = 0.1
G = 9.80665
compiled = settings(deadline=None, max_examples=50)
numbers = st.floats(-1e3, 1e3)
angles = st.floats(-3.0, 3.0)


def sensor(kind=POSITION_KINDS, **changes):
    n = kind.size
    values = {
        "noise_std": np.zeros(n),
        "offset": np.zeros(n),
        "bias_std": np.zeros(n),
        "bias_time_constant_s": np.inf,
        "sample_period_s": DT,
        "delay_s": 0.0,
    }
    return sensor_params(kind, DT, **(values | changes))


def report(params, truths, seed=1, dropped=()):
    """Reports (k, n) for truths (k, n)."""
    n = truths.shape[1]
    rng = np.random.default_rng(seed)
    state = sensor_start(params, rng.standard_normal(n))
    out = []
    for k, truth in enumerate(truths):
        state, measured = sensor_step(params, state, truth, rng.standard_normal(2 * n), k in dropped)
        out.append(measured)
    return np.array(out)


def ramp(count):
    return np.column_stack((np.arange(count, dtype=float), -2.0 * np.arange(count)))


@compiled
@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=10))
def test_off_is_the_truth_to_the_bit(truths):
    truths = np.array(truths)
    np.testing.assert_array_equal(report(perfect_sensor(POSITION_KINDS), truths), truths)
    np.testing.assert_array_equal(report(sensor(), truths), truths)


def test_noise_is_white_with_its_std():
    got = report(sensor(noise_std=[0.5, 0.1]), np.zeros((20000, 2)))
    np.testing.assert_allclose(got.std(axis=0), [0.5, 0.1], rtol=0.03)
    np.testing.assert_allclose(got.mean(axis=0), 0.0, atol=0.02)
    shares = [np.corrcoef(got[:-lag, 0], got[lag:, 0])[0, 1] for lag in (1, 2, 10)]
    np.testing.assert_allclose(shares, 0.0, atol=0.03)
    assert abs(np.corrcoef(got.T)[0, 1]) < 0.03


def test_wandering_bias_is_stationary_and_forgets_with_its_time_constant():
    params = sensor(bias_std=[0.3, 0.0], bias_time_constant_s=2.0)
    runs = np.array([report(params, np.zeros((41, 2)), seed)[:, 0] for seed in range(1500)])
    np.testing.assert_allclose(runs[:, [0, 20, 40]].std(axis=0), 0.3, rtol=0.08)
    assert np.mean(runs[:, 0] * runs[:, 20]) / 0.09 == pytest.approx(np.exp(-1.0), abs=0.08)


def test_without_end_of_memory_the_bias_stays_as_drawn():
    got = report(sensor(bias_std=[0.3, 0.3], offset=[1.0, 2.0]), np.zeros((50, 2)))
    assert np.all(np.ptp(got, axis=0) == 0.0)
    assert np.all(np.abs(got[0] - [1.0, 2.0]) > 1e-3)
    assert np.all(np.abs(got[0] - [1.0, 2.0]) < 1.2)


def test_samples_come_at_their_rate_and_nothing_between():
    got = report(sensor(sample_period_s=1.0), ramp(35))
    assert np.flatnonzero(np.isfinite(got[:, 0])).tolist() == [0, 10, 20, 30]
    np.testing.assert_array_equal(got[::10], ramp(35)[::10])


@pytest.mark.parametrize(("period", "delay"), [(0.1, 0.3), (0.5, 1.0), (1.0, 1.0)])
def test_delayed_reports_are_the_truth_of_then(period, delay):
    got = report(sensor(sample_period_s=period, delay_s=delay), ramp(80))
    every, late = round(period / DT), round(delay / DT)
    assert np.all(np.isnan(got[:late]))
    np.testing.assert_array_equal(got[late::every], ramp(80)[: 80 - late : every])


def test_dropped_samples_are_missing_for_good_and_shift_nothing():
    params = sensor(noise_std=[0.5, 0.5], bias_std=[0.2, 0.2], bias_time_constant_s=5.0, delay_s=0.2)
    whole = report(params, ramp(40))
    broken = report(params, ramp(40), dropped=range(10, 20))
    assert np.flatnonzero(np.isnan(broken[:, 0])).tolist() == [0, 1, *range(12, 22)]
    rest = np.isfinite(broken)
    np.testing.assert_array_equal(broken[rest], whole[rest])


def test_truth_that_is_no_number_is_missing_in_its_part_only():
    truths = ramp(6)
    truths[2, 0], truths[4, 1] = np.nan, np.inf
    got = report(sensor(bias_std=[0.1, 0.1], bias_time_constant_s=5.0), truths)
    assert np.isnan(got).tolist() == [[k == 2, k == 4] for k in range(6)]
    assert np.all(np.isnan(report(sensor(WIND_KINDS), np.full((3, 2), np.nan))))


def test_angles_wrap_and_magnitudes_stay_positive():
    got = report(sensor(GYRO_KINDS, noise_std=[0.2]), np.full((500, 1), np.pi))[:, 0]
    assert np.all(np.abs(got) <= np.pi)
    assert got.min() < -2.5
    assert got.max() > 2.5
    speed = report(sensor(WIND_KINDS, noise_std=[1.0, 0.1]), np.full((500, 2), 0.2))[:, 0]
    assert speed.min() == 0.0


def test_same_draws_same_bits_and_inputs_stay():
    params = sensor(noise_std=[0.5, 0.5], bias_std=[0.2, 0.2], bias_time_constant_s=5.0, delay_s=0.2)
    np.testing.assert_array_equal(report(params, ramp(40)), report(params, ramp(40)))
    state = sensor_start(params, np.ones(2))
    before = state.copy()
    sensor_step(params, state, np.ones(2), np.ones(4), False)
    np.testing.assert_array_equal(state, before)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sample_period_s": 0.25}, "sample_period_s"),
        ({"sample_period_s": 0.0}, "sample_period_s"),
        ({"delay_s": 0.05}, "delay_s"),
        ({"delay_s": np.inf}, "delay_s"),
        ({"noise_std": [-1.0, 0.0]}, "noise_std"),
        ({"bias_std": [np.nan, 0.0]}, "bias_std"),
        ({"offset": [0.0]}, "2 values"),
        ({"bias_time_constant_s": 0.0}, "bias_time_constant_s"),
    ],
)
def test_settings_out_of_range_are_named(changes, words):
    with pytest.raises(ValueError, match=words):
        sensor(**changes)


def odometry(pos=(0.0, 0.0, 0.0), euler=(0.0, 0.0, 0.0), vel_b=(0.0, 0.0, 0.0), omega_b=(0.0, 0.0, 0.0)):
    return np.concatenate((pos, quat_from_euler(*euler), vel_b, omega_b))


@compiled
@given(east=numbers, north=numbers, roll=st.floats(-0.5, 0.5), pitch=st.floats(-0.5, 0.5), yaw=angles)
def test_antenna_and_back(east, north, roll, pitch, yaw):
    arm = np.array([5.0, -1.0, 12.0])
    odom = odometry((east, north, 1.0), (roll, pitch, yaw))
    turned = Rotation.from_euler("ZYX", [yaw, pitch, roll]).apply(arm)
    fix = antenna_position(odom, arm)
    np.testing.assert_allclose(fix, [east + turned[0], north + turned[1]], atol=1e-9)
    np.testing.assert_allclose(reference_point(fix, arm, roll, pitch, yaw), [east, north], atol=1e-9)
    assert gyro_heading(odom)[0] == pytest.approx(yaw, abs=1e-12)


def test_fix_without_attitude_or_fix():
    arm = np.array([5.0, 0.0, 12.0])
    np.testing.assert_allclose(reference_point(np.array([5.0, 1.0]), arm, np.nan, np.nan, 0.0), [0.0, 1.0])
    assert np.all(np.isnan(reference_point(np.array([np.nan, np.nan]), arm, 0.0, 0.0, 0.0)))


def test_motion_unit_at_rest_feels_gravity_along_the_ships_axes():
    got = mru_motion(odometry(euler=(0.2, -0.1, 2.0)), np.zeros(6), np.array([3.0, 1.0, 2.0]), G)
    np.testing.assert_allclose(got[:2], [0.2, -0.1], atol=1e-12)
    up_b = Rotation.from_euler("ZYX", [2.0, -0.1, 0.2]).inv().apply([0.0, 0.0, G])
    np.testing.assert_allclose(got[5:], up_b, atol=1e-12)
    assert np.all(got[2:5] == 0.0)


def test_motion_unit_matches_differences_of_a_tumbling_path():
    """Specific force is the second derivative of the unit's place, minus gravity, in its own axes."""
    arm = np.array([4.0, -2.0, 3.0])

    def attitude(t):
        return Rotation.from_euler("ZYX", [0.5 + 0.3 * t, 0.2 * np.sin(1.1 * t), 0.3 * np.cos(0.9 * t)])

    def place(t):
        return np.array([np.sin(0.7 * t), 0.5 * t * t, 0.3 * np.cos(t)])

    h, t = 1e-3, 1.3
    rot = attitude(t)

    def omega(t):
        return (attitude(t - h).inv() * attitude(t + h)).as_rotvec() / (2.0 * h)

    vel_b = rot.inv().apply((place(t + h) - place(t - h)) / (2.0 * h))
    acc_b = rot.inv().apply((place(t + h) - 2.0 * place(t) + place(t - h)) / h**2)
    alpha_b = (omega(t + h) - omega(t - h)) / (2.0 * h)
    odom = np.concatenate((place(t), rot.as_quat(), vel_b, omega(t)))
    got = mru_motion(odom, np.concatenate((acc_b, alpha_b)), arm, G)
    point = [place(s) + attitude(s).apply(arm) for s in (t - h, t, t + h)]
    acc_w = (point[2] - 2.0 * point[1] + point[0]) / h**2
    np.testing.assert_allclose(got[5:], rot.inv().apply(acc_w + [0.0, 0.0, G]), atol=1e-4)
    np.testing.assert_allclose(got[2:5], omega(t))
    assert vertical_acceleration(got, G) == pytest.approx(acc_w[2], abs=1e-4)
    assert MRU_KINDS.size == got.size


def test_wind_sensor_meets_the_ships_own_speed():
    arm = np.zeros(3)
    ahead = relative_wind(odometry(vel_b=(4.0, 0.0, 0.0), euler=(0.0, 0.0, 1.0)), np.zeros(3), arm)
    np.testing.assert_allclose(ahead, [4.0, 0.0], atol=1e-12)  # from the bow
    port = relative_wind(odometry(euler=(0.0, 0.0, np.pi / 2.0)), np.array([6.0, 0.0, 0.0]), arm)
    np.testing.assert_allclose(port, [6.0, np.pi / 2.0], atol=1e-12)  # bow north, air goes east: from port
    turning = relative_wind(odometry(omega_b=(0.0, 0.0, 0.1)), np.zeros(3), np.array([10.0, 0.0, 0.0]))
    np.testing.assert_allclose(turning, [1.0, np.pi / 2.0], atol=1e-12)


def test_wind_sensors_direction_is_the_one_of_the_coefficients():
    """Wind from ahead pushes back, with the load that the true velocity of the air gives."""
    angles = np.linspace(0.0, np.pi, 19)
    table = np.column_stack((angles, -0.5 * np.cos(angles), *np.zeros((3, 19))))
    wind = WindParams(table, np.array([10.0, 10.0, 10.0, 10.0]))
    speed, direction = relative_wind(odometry(euler=(0.0, 0.0, 0.4)), np.array([-5.0, -1.0, 0.0]), np.zeros(3))
    air = -speed * np.array([np.cos(direction), np.sin(direction)])
    turned = Rotation.from_euler("z", 0.4).inv().apply([-5.0, -1.0, 0.0])
    np.testing.assert_allclose(air, turned[:2], atol=1e-12)
    assert wind_load(wind, air[0], air[1])[0] < 0.0
