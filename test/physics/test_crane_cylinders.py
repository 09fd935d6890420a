"""Cylinder lengths and joint values."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinematics_rows import kinematics_rows
from palfinger import palfinger_drives

from shipcrane_twin.physics.crane_cylinders import (
    LinearDrive,
    TriangleDrive,
    joint_rates_per_length,
    joints_from_lengths,
    lengths_from_joints,
    make_drives,
)

DRIVES = palfinger_drives()
LENGTHS = st.tuples(st.floats(-4.0, 4.0), st.floats(1.1, 1.8), st.floats(1.2, 1.9), st.floats(1.5, 11.5)).map(
    np.array
)


def test_joints_equal_the_published_crane(measured):
    lengths, joints, _ = kinematics_rows()
    worst = max(np.abs(joints_from_lengths(DRIVES, a) - q).max() for a, q in zip(lengths, joints, strict=True))
    measured("crane joints from cylinders, 50 reference rows: largest error", worst, 1e-6, "rad, m")


@settings(deadline=None)  # the first call compiles
@given(lengths=LENGTHS)
def test_there_and_back(lengths):
    np.testing.assert_allclose(
        lengths_from_joints(DRIVES, joints_from_lengths(DRIVES, lengths)), lengths, atol=1e-12
    )


@settings(deadline=None)  # the first call compiles
@given(lengths=LENGTHS)
def test_rate_is_the_slope_of_the_closed_form(lengths):
    step = 1e-6
    slope = (joints_from_lengths(DRIVES, lengths + step) - joints_from_lengths(DRIVES, lengths - step)) / (
        2 * step
    )
    rates = joint_rates_per_length(DRIVES, joints_from_lengths(DRIVES, lengths))
    np.testing.assert_allclose(rates, slope, rtol=1e-7)
    assert np.all(rates > 0.0)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (LinearDrive(0.0, 2.0, 1.0), "length_min < length_max"),
        (TriangleDrive(1.0, 0.0, 0.0, 0.5, 1.0), "both > 0"),
        (TriangleDrive(1.0, 0.5, 0.0, 0.4, 1.0), "cannot close .* between 0.5 and 1.5 m"),
        (TriangleDrive(1.0, 0.5, 0.0, 0.6, 1.6), "cannot close its triangle"),
    ],
)
def test_an_impossible_drive_is_named(drive, message):
    with pytest.raises(ValueError, match=message):
        make_drives([drive])


def test_a_length_beyond_the_triangle_is_refused():
    with pytest.raises(ValueError, match="cannot close its triangle"):
        joints_from_lengths(DRIVES, np.array([0.0, 2.1, 1.5, 2.0]))
