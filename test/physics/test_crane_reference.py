"""References keep speed, acceleration, jerk and ends, and still get where they should."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from palfinger import palfinger_drives, palfinger_limits

from shipcrane_twin.physics.crane_cylinders import joint_rates_per_length, joints_from_lengths
from shipcrane_twin.physics.crane_reference import (
    FLAG_COMMAND,
    FLAG_REFUSED,
    FLAG_SPEED,
    POSITION,
    VELOCITY,
    advance_path,
    follow_path,
    make_limits,
)

DRIVES = palfinger_drives()
LIMITS = palfinger_limits()
JERK = 2.0 * LIMITS.accel_max / LIMITS.lag
MIDDLE = np.array([0.2, 1.45, 1.55, 6.0])  # actuator lengths away from all ends
VELOCITIES, POSITIONS = np.full(4, VELOCITY), np.full(4, POSITION)
ANYTHING = st.one_of(st.floats(-0.2, 0.2), st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 3.0, -3.0]))


class Reference:
    """Path and reference of the four drives, step by step."""

    def __init__(self, path):
        self.path, self.rate, self.behind = np.array(path), np.zeros(4), np.zeros(4)

    @property
    def place(self):
        return self.path - self.behind

    @property
    def speed(self):
        return self.behind / LIMITS.lag

    @property
    def accel(self):
        return (self.rate - self.speed) / LIMITS.lag

    def step(self, mode, command, dt, parts=4):
        """Advance; return place, speed and acceleration at parts of the step, shape (parts, 3, 4), and flags."""
        flags, wanted = np.zeros(4, dtype=np.int64), np.zeros(4)
        end = advance_path(LIMITS, self.path, self.rate, mode, np.asarray(command, float), dt, wanted, flags)
        accel, h, seen = (end - self.rate) / dt, dt / parts, []
        for _ in range(parts):
            decay = np.exp(-h / LIMITS.lag)
            self.behind = follow_path(self.behind, self.rate, accel, LIMITS.lag, h, decay)
            self.path = self.path + h * (self.rate + 0.5 * accel * h)
            self.rate = self.rate + accel * h
            seen.append([self.place, self.speed, self.accel])
        self.rate = end
        return np.array(seen), flags


@settings(deadline=None, max_examples=60)  # the first call compiles
@given(
    part=st.tuples(*[st.floats(0.0, 1.0)] * 4).map(np.array),
    commands=st.lists(st.tuples(*[ANYTHING] * 4).map(np.array), min_size=1, max_size=8),
    modes=st.lists(st.tuples(*[st.sampled_from([VELOCITY, POSITION])] * 4).map(np.array), min_size=8, max_size=8),
    hold=st.integers(1, 60),
    dt=st.sampled_from([0.001, 0.02, 0.05, 0.2]),
)
def test_speed_acceleration_jerk_and_ends_are_kept_whatever_is_commanded(part, commands, modes, hold, dt):
    low = np.where(np.isfinite(DRIVES.length_min), DRIVES.length_min, -3.0)
    high = np.where(np.isfinite(DRIVES.length_max), DRIVES.length_max, 3.0)
    reference = Reference(low + part * (high - low))
    for mode, command in zip(modes, commands, strict=False):
        for _ in range(hold):
            before = reference.accel
            seen, _ = reference.step(mode, command, dt)
            assert np.all(np.isfinite(seen))
            assert np.all((seen[:, 0] >= DRIVES.length_min - 1e-9) & (seen[:, 0] <= DRIVES.length_max + 1e-9))
            assert np.all(np.abs(seen[:, 1]) <= LIMITS.rate_max * (1.0 + 1e-9))
            assert np.all(np.abs(seen[:, 2]) <= LIMITS.accel_max * (1.0 + 1e-6))
            jerk = np.diff(np.vstack((before, seen[:, 2])), axis=0) / (dt / len(seen))
            assert np.all(np.abs(jerk) <= JERK * (1.0 + 1e-6) + 1e-7)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_full_command_reaches_actuator_speed_then_stops_softly_inside_the_end_margin(way):
    reference = Reference(MIDDLE)
    fastest, low_jerk = np.zeros(4), []
    for _ in range(10000):
        seen, flags = reference.step(VELOCITIES, np.full(4, 1.0 * way), 0.02, parts=1)
        fastest = np.maximum(fastest, np.abs(seen[-1, 1]))
        low_jerk.append(seen[-1, 2])
    np.testing.assert_allclose(fastest, LIMITS.rate_max, rtol=1e-3)
    end = DRIVES.length_max if way > 0.0 else DRIVES.length_min
    room = way * (end - reference.place)[1:]
    assert np.all((room >= 0.0) & (room <= 0.01))
    np.testing.assert_allclose(reference.speed[1:], 0.0, atol=1e-12)
    np.testing.assert_array_equal(flags, [FLAG_SPEED, *[FLAG_REFUSED | FLAG_SPEED] * 3])


def test_a_slow_command_is_met_in_joint_rates():
    reference = Reference(MIDDLE)
    command = np.array([-0.03, 0.005, -0.004, 0.02])
    for _ in range(300):
        _, flags = reference.step(VELOCITIES, command, 0.02)
        np.testing.assert_array_equal(flags, 0)
    rates = reference.speed * joint_rates_per_length(DRIVES, joints_from_lengths(DRIVES, reference.place))
    np.testing.assert_allclose(rates, command, rtol=1e-4)


@pytest.mark.parametrize("dt", [0.001, 0.02, 0.2])
def test_a_position_is_reached_without_overshoot(dt):
    goal = joints_from_lengths(DRIVES, MIDDLE + [0.5, 0.1, -0.15, 1.0])
    reference, places = Reference(MIDDLE), []
    for _ in range(round(60.0 / dt)):
        seen, flags = reference.step(POSITIONS, goal, dt)
        places.append(seen[:, 0])
    np.testing.assert_array_equal(flags, 0)
    way = np.array([1.0, 1.0, -1.0, 1.0])
    assert np.all(way * (np.vstack(places) - MIDDLE - [0.5, 0.1, -0.15, 1.0]) <= 1e-9)
    np.testing.assert_allclose(joints_from_lengths(DRIVES, reference.place), goal, atol=2e-6)


def test_a_position_beyond_an_end_stops_at_the_margin():
    reference = Reference(MIDDLE)
    for _ in range(4000):
        _, flags = reference.step(POSITIONS, np.full(4, 50.0), 0.1, parts=1)
    np.testing.assert_allclose(reference.place[1:], LIMITS.high[1:], atol=1e-6)
    np.testing.assert_array_equal(flags, [0, FLAG_REFUSED, FLAG_REFUSED, FLAG_REFUSED])


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_inside_the_margin_only_the_way_out_is_open(way):
    end = DRIVES.length_max if way > 0.0 else DRIVES.length_min
    start = np.where(np.isfinite(end), end - way * 0.005, 0.0)
    inward, flags = Reference(start).step(VELOCITIES, np.full(4, 0.01 * way), 0.02)
    np.testing.assert_array_equal(inward[-1, 1, 1:], 0.0)
    assert np.all(flags[1:] & FLAG_REFUSED)
    outward, flags = Reference(start).step(VELOCITIES, np.full(4, -0.01 * way), 0.02)
    assert np.all(way * outward[-1, 1] < 0.0)
    assert not np.any(flags & FLAG_REFUSED)


@pytest.mark.parametrize("mode", [VELOCITIES, POSITIONS])
def test_what_is_no_number_stands_still_and_says_so(mode):
    seen, flags = Reference(MIDDLE).step(mode, [np.nan, np.inf, -np.inf, np.nan], 0.02)
    np.testing.assert_array_equal(flags, FLAG_COMMAND)
    np.testing.assert_array_equal(seen[:, 1:], 0.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rate_max": [0.05, 0.0, 0.01, 0.05]}, "rate_max"),
        ({"accel_max": -1.0}, "accel_max"),
        ({"jerk_max": 0.0}, "jerk_max"),
        ({"end_margin": 0.4}, "less than half of every stroke"),
        ({"end_margin": -0.01}, "end_margin"),
    ],
)
def test_impossible_limits_are_named(changes, message):
    good = {"rate_max": 0.01, "accel_max": 0.02, "jerk_max": 0.1, "end_margin": 0.01}
    with pytest.raises(ValueError, match=message):
        make_limits(DRIVES, **(good | changes))
