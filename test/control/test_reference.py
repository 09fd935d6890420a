"""Reference model: limits, arrival, straight way, no bump."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from shipcrane_twin.control.reference import (
    ACCEL,
    LIMITED_RATE,
    POSE,
    RATE,
    ReferenceParams,
    reference_start,
    reference_step,
)

APART = ReferenceParams(
    speed_max=np.array([0.25, np.deg2rad(0.5)]),
    accel_max=np.array([0.01, np.deg2rad(0.02)]),
    smoothing=8.0,
    share_time=0.0,
    period=0.1,
)
TOGETHER = APART._replace(share_time=1.0)
STILL = np.zeros(3)
places = st.floats(-30.0, 30.0)
yaws = st.floats(-3.1, 3.1)
poses = st.tuples(places, places, yaws)
ways = st.sampled_from([APART, TOGETHER])
compiled = settings(deadline=None, max_examples=30)


def path(params, state, setpoint, updates):
    rows = [state]
    for _ in range(updates):
        rows.append(reference_step(params, rows[-1], np.array(setpoint)))
    return np.array(rows)


def wrapped(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def assert_within_limits(params, rows):
    for part, limits in ((RATE, params.speed_max), (ACCEL, params.accel_max)):
        values = rows[:, part]
        assert np.all(np.hypot(values[:, 0], values[:, 1]) <= limits[0] * (1.0 + 1e-9))
        assert np.all(np.abs(values[:, 2]) <= limits[1] * (1.0 + 1e-9))
    jerk = np.diff(rows[:, ACCEL], axis=0) / params.period
    bar = 2.0 * params.accel_max / params.smoothing * (1.0 + 1e-9)
    assert np.all(np.hypot(jerk[:, 0], jerk[:, 1]) <= bar[0])
    assert np.all(np.abs(jerk[:, 2]) <= bar[1])


@compiled
@given(params=ways, start=poses, goal=poses)
@example(params=APART, start=(0.0, 0.0, 3.0), goal=(0.0, 0.0, -3.0))
@example(params=TOGETHER, start=(0.0, 0.0, 0.0), goal=(10.0, 0.0, 0.0))
def test_from_rest_it_arrives_within_limits_without_overshoot(params, start, goal):
    rows = path(params, reference_start(params, np.array(start), STILL), goal, 8000)
    assert_within_limits(params, rows)
    rest = np.array(goal) - rows[:, POSE]
    rest[:, 2] = wrapped(rest[:, 2])
    assert np.all(rest * np.sign(rest[0]) >= -1e-9)
    np.testing.assert_allclose(rest[-1], 0.0, atol=1e-6)


@compiled
@given(params=ways, moves=st.lists(poses, min_size=2, max_size=8))
def test_limits_hold_and_it_arrives_whatever_the_operator_does(params, moves):
    state, rows = reference_start(params, STILL, STILL), []
    for move in moves:
        rows.append(path(params, state, move, 100))
        state = rows[-1][-1]
    rows.append(path(params, state, moves[-1], 8000))
    assert_within_limits(params, np.concatenate(rows))
    rest = np.array(moves[-1]) - rows[-1][-1, POSE]
    np.testing.assert_allclose([*rest[:2], wrapped(rest[2])], 0.0, atol=1e-4)


@compiled
@given(params=ways, start=poses, goal=poses)
def test_rate_and_acceleration_are_the_derivatives_of_the_pose(params, start, goal):
    rows = path(params, reference_start(params, np.array(start), STILL), goal, 300)
    step = np.diff(rows[:, POSE], axis=0)
    step[:, 2] = wrapped(step[:, 2])
    np.testing.assert_allclose(step / params.period, rows[1:, RATE], atol=1e-9)
    np.testing.assert_allclose(np.diff(rows[:, RATE], axis=0) / params.period, rows[1:, ACCEL], atol=1e-9)


def test_takes_the_time_of_a_trapezoidal_speed_and_the_filter():
    distance, speed, accel = 20.0, APART.speed_max[0], APART.accel_max[0]
    rows = path(APART, reference_start(APART, STILL, STILL), [12.0, 16.0, 0.0], 4000)
    moving = np.hypot(rows[:, 3], rows[:, 4]) > 1e-12
    expected = distance / speed + speed / accel
    assert moving.sum() * APART.period == pytest.approx(expected, abs=0.3)
    # a first-order lag delays the centre of the motion by its time constant
    delay = (20.0 - np.hypot(rows[:, 6], rows[:, 7])).sum() * APART.period / 20.0 - expected / 2.0
    assert delay == pytest.approx(APART.smoothing, abs=0.2)


@compiled
@given(goal=poses.filter(lambda goal: np.abs(goal).min() > 0.1))
def test_sharing_time_keeps_position_and_heading_in_proportion(goal):
    rows = path(TOGETHER, reference_start(TOGETHER, STILL, STILL), goal, 3000)
    share = rows[:, POSE] / np.array(goal)
    np.testing.assert_allclose(share, share[:, :1] * np.ones(3), atol=1e-6)


@compiled
@given(goal=poses.filter(lambda goal: np.hypot(*goal[:2]) > 1.0))
def test_goes_straight_from_rest(goal):
    rows = path(APART, reference_start(APART, STILL, STILL), goal, 2000)
    aside = rows[:, 6] * goal[1] - rows[:, 7] * goal[0]
    assert np.abs(aside).max() < 1e-9 * np.hypot(*goal[:2]) ** 2 + 1e-9


def test_turns_the_shorter_way_round_and_stays_wrapped():
    rows = path(APART, reference_start(APART, np.array([0.0, 0.0, 3.0]), STILL), [0.0, 0.0, -3.0], 2500)
    assert np.all(rows[1:, RATE][:, 2] >= 0.0)
    assert np.abs(rows[:, 8]).max() <= np.pi
    assert rows[-1, 8] == pytest.approx(-3.0, abs=1e-6)


def test_starts_with_the_pose_and_velocity_it_is_given():
    pose, velocity = np.array([3.0, -4.0, 1.0]), np.array([0.1, 0.05, 0.002])
    state = reference_start(APART, pose, velocity)
    np.testing.assert_array_equal(state[POSE], pose)
    np.testing.assert_array_equal(state[RATE], velocity)
    # far ahead: it goes on with what it has, and its acceleration begins at zero and changes by the filter only
    first = reference_step(APART, state, pose + 500.0 * velocity)
    np.testing.assert_allclose(first[POSE], pose + velocity * APART.period, atol=2e-5)
    jerk = APART.accel_max[0] / APART.smoothing
    assert np.all(np.abs(first[ACCEL]) <= 1.01 * jerk * APART.period)


def test_ship_that_is_too_fast_brakes_within_the_limits_and_comes_back():
    start = reference_start(APART, STILL, np.array([0.2, 0.0, 0.0]))
    rows = path(APART, start, STILL, 4000)
    assert_within_limits(APART, rows)
    # the lag of the filter, by which the limited motion is ahead, and the way of braking, v^2 / 2a
    furthest = 0.2 * APART.smoothing + 0.2**2 / 0.02
    assert rows[:, 0].max() == pytest.approx(furthest, rel=0.01)
    assert rows[:, 6].max() < furthest
    np.testing.assert_allclose(rows[-1, POSE], 0.0, atol=1e-6)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_axis_with_a_setpoint_that_is_no_number_comes_to_rest(axis, bad):
    state = path(APART, reference_start(APART, STILL, STILL), [20.0, 20.0, 1.0], 300)[-1]
    goal = np.array([20.0, 20.0, 1.0])
    goal[axis] = bad
    rows = path(APART, state, goal, 2000)
    assert np.isfinite(rows).all()
    assert abs(rows[-1, RATE][axis]) < 1e-9
    assert np.isfinite(reference_start(APART, goal, goal)).all()


def test_without_smoothing_it_is_the_limited_motion_itself():
    sharp = APART._replace(smoothing=0.0)
    rows = path(sharp, reference_start(sharp, STILL, STILL), [5.0, 3.0, 0.5], 1500)
    np.testing.assert_allclose(rows[1:, POSE], rows[1:, :3], atol=1e-12)
    np.testing.assert_allclose(rows[1:, RATE], rows[1:, LIMITED_RATE], atol=1e-9)


def test_inputs_stay_untouched():
    state, goal = reference_start(APART, STILL, STILL), np.array([1.0, 2.0, 0.3])
    kept = state.copy()
    reference_step(APART, state, goal)
    np.testing.assert_array_equal(state, kept)
    np.testing.assert_array_equal(goal, [1.0, 2.0, 0.3])
