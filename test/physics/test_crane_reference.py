"""The reference keeps speeds, ramps and ends, and still gets where it should."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from palfinger import palfinger_drives, palfinger_limits

from shipcrane_twin.physics.crane_cylinders import (
    joint_rates_per_length,
    joints_from_lengths,
    lengths_from_joints,
)
from shipcrane_twin.physics.crane_reference import (
    FLAG_REFUSED,
    FLAG_SPEED,
    advance_reference,
    make_limits,
)

DRIVES = palfinger_drives()
MIDDLE = np.array([0.2, 1.45, 1.55, 6.0])  # actuator lengths away from all ends
SPEED = np.array([0.05, 0.01, 0.01, 0.05])


def follow(limits, q_ref, qd_ref, command, dt):
    """One step of the reference: its new place and rates, its farthest place either way, and flags."""
    rates, flags = advance_reference(limits, q_ref, qd_ref, command, dt)
    accel = (rates - qd_ref) / dt
    turns = (qd_ref * rates < 0.0) & (accel != 0.0)  # stops and goes back inside the step
    turning = np.where(turns, q_ref - 0.5 * qd_ref**2 / np.where(turns, accel, 1.0), q_ref)
    return q_ref + 0.5 * dt * (qd_ref + rates), rates, turning, flags


@settings(deadline=None)  # the first call compiles
@given(
    part=st.tuples(*[st.floats(0.0, 1.0)] * 4).map(np.array),
    commands=st.lists(st.tuples(*[st.floats(-0.2, 0.2)] * 4).map(np.array), min_size=1, max_size=8),
    hold=st.integers(1, 150),
    dt=st.sampled_from([0.005, 0.02, 0.05, 0.3]),
    sag=st.tuples(*[st.floats(-0.1, 0.1)] * 4).map(np.array),
)
def test_speed_ramp_and_ends_are_kept(part, commands, hold, dt, sag):
    limits = palfinger_limits(sag)
    low = np.where(np.isfinite(limits.q_min), limits.q_min, -3.0)
    high = np.where(np.isfinite(limits.q_max), limits.q_max, 3.0)
    q_ref, qd_ref = low + part * (high - low) + sag, np.zeros(4)
    for command in commands:
        for _ in range(hold):
            fastest = SPEED * joint_rates_per_length(DRIVES, q_ref - sag)
            was = qd_ref
            q_ref, qd_ref, turning, _ = follow(limits, q_ref, qd_ref, command, dt)
            assert np.all(np.abs(qd_ref) <= fastest * (1.0 + 1e-12))
            assert np.all(np.abs(qd_ref - was) <= limits.accel_max * dt * (1.0 + 1e-9) + 1e-12)
            for place in (q_ref - sag, turning - sag):
                assert np.all((place >= limits.q_min - 1e-12) & (place <= limits.q_max + 1e-12))


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_full_command_reaches_actuator_speed_then_stops_softly_inside_the_end_margin(way):
    limits = palfinger_limits()
    q_ref, qd_ref, dt = joints_from_lengths(DRIVES, MIDDLE), np.zeros(4), 0.02
    fastest = np.zeros(4)
    for _ in range(10000):
        lengths = lengths_from_joints(DRIVES, q_ref)
        q_ref, qd_ref, _, flags = follow(limits, q_ref, qd_ref, np.full(4, 1.0 * way), dt)
        speed = np.abs(lengths_from_joints(DRIVES, q_ref) - lengths) / dt
        fastest = np.maximum(fastest, speed)
    np.testing.assert_allclose(fastest, SPEED, rtol=1e-3)
    end = DRIVES.length_max if way > 0.0 else DRIVES.length_min
    room = way * (end - lengths_from_joints(DRIVES, q_ref))[1:]
    assert np.all((room >= 0.0) & (room <= 0.01))
    np.testing.assert_allclose(qd_ref[1:], 0.0, atol=1e-12)
    np.testing.assert_array_equal(flags, [FLAG_SPEED, FLAG_REFUSED, FLAG_REFUSED, FLAG_REFUSED])


def test_a_slow_command_is_met_exactly_after_its_ramp():
    limits = palfinger_limits()
    q_ref, qd_ref = joints_from_lengths(DRIVES, MIDDLE), np.zeros(4)
    command = np.array([-0.03, 0.005, -0.004, 0.02])
    steps = int(np.ceil(np.max(np.abs(command) / limits.accel_max) / 0.02))
    for _ in range(steps):
        q_ref, qd_ref, _, flags = follow(limits, q_ref, qd_ref, command, 0.02)
        np.testing.assert_array_equal(flags, 0)
    np.testing.assert_array_equal(qd_ref, command)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_inside_the_margin_only_the_way_out_is_open(way):
    limits = palfinger_limits()
    end = DRIVES.length_max if way > 0.0 else DRIVES.length_min
    lengths = np.where(np.isfinite(end), end - way * 0.005, 0.0)
    q_ref = joints_from_lengths(DRIVES, lengths)
    inward, flags = advance_reference(limits, q_ref, np.zeros(4), np.full(4, way), 0.02)
    np.testing.assert_array_equal(inward[1:], 0.0)
    assert np.all(flags[1:] & FLAG_REFUSED)
    outward, flags = advance_reference(limits, q_ref, np.zeros(4), np.full(4, -way), 0.02)
    np.testing.assert_allclose(outward, -way * limits.accel_max * 0.02)
    assert not np.any(flags & FLAG_REFUSED)


def test_a_reference_that_starts_outside_its_ends_stays_until_it_is_driven_back():
    limits = palfinger_limits()
    q_ref = limits.q_max + 0.05
    q_ref[0] = 0.0
    rates, _ = advance_reference(limits, q_ref, np.zeros(4), np.zeros(4), 0.02)
    np.testing.assert_array_equal(rates, 0.0)
    rates, _ = advance_reference(limits, q_ref, np.zeros(4), np.full(4, -1.0), 0.02)
    assert np.all(rates < 0.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"length_rate_max": [0.05, 0.0, 0.01, 0.05]}, "length_rate_max"),
        ({"accel_max": -1.0}, "accel_max"),
        ({"end_margin": 0.4}, "less than half of every stroke"),
        ({"end_margin": -0.01}, "end_margin"),
    ],
)
def test_impossible_limits_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        make_limits(DRIVES, **({"length_rate_max": 0.01, "accel_max": 0.02, "end_margin": 0.01} | changes))
