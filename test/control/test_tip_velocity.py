"""Joint rates for the tip: right where the crane can, bounded where it cannot."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from palfinger import WORK_POSE, eight_segment_chain, palfinger_limits
from scipy.spatial.transform import Rotation

from shipcrane_twin.control.tip_velocity import tip_joint_rates, tip_joint_rates_level
from shipcrane_twin.physics.crane_chain import tip_jacobian
from shipcrane_twin.physics.crane_cylinders import joint_rates_per_length, joints_from_lengths

CHAIN, LIMITS = eight_segment_chain(), palfinger_limits()
LENGTHS = st.tuples(st.floats(-4.0, 4.0), st.floats(1.1, 1.8), st.floats(1.2, 1.9), st.floats(1.5, 11.5))
PART = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([np.nan, np.inf, -np.inf, 1e9]))


def test_the_tip_moves_as_asked():
    jacobian = tip_jacobian(CHAIN, WORK_POSE)[:3]
    for velocity in 0.01 * np.vstack((np.eye(3), -np.eye(3), [[0.5, 0.4, -0.3]])):
        got = jacobian @ tip_joint_rates(CHAIN, LIMITS, WORK_POSE, velocity)
        np.testing.assert_allclose(got, velocity, atol=3e-4)


def test_world_axes_are_turned_into_the_ships():
    rot = Rotation.from_euler("zyx", [0.7, 0.1, -0.2]).as_matrix()
    velocity = np.array([0.02, -0.01, 0.01])
    np.testing.assert_allclose(
        tip_joint_rates_level(CHAIN, LIMITS, WORK_POSE, rot @ velocity, rot),
        tip_joint_rates(CHAIN, LIMITS, WORK_POSE, velocity),
        atol=1e-15,
    )


def test_too_fast_a_wish_keeps_its_direction():
    got = tip_jacobian(CHAIN, WORK_POSE)[:3] @ tip_joint_rates(CHAIN, LIMITS, WORK_POSE, np.array([0.0, -5.0, 0.0]))
    assert got[1] < -0.02
    assert np.abs(got[[0, 2]]).max() < 0.1 * abs(got[1])


@settings(deadline=None)  # the first call compiles
@given(lengths=LENGTHS, velocity=st.tuples(PART, PART, PART))
def test_rates_stay_finite_and_within_the_drives_in_every_pose(lengths, velocity):
    q = joints_from_lengths(LIMITS.drives, np.array(lengths))
    rates = tip_joint_rates(CHAIN, LIMITS, q, np.array(velocity))
    speeds = rates / joint_rates_per_length(LIMITS.drives, q)
    assert np.all(np.abs(speeds) <= LIMITS.rate_max * (1.0 + 1e-9))
    assert not np.any((np.array(lengths) >= LIMITS.high) & (speeds > 1e-12))
    assert not np.any((np.array(lengths) <= LIMITS.low) & (speeds < -1e-12))
