import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics import frames
from shipcrane_twin.record.read import COLUMNS, Series
from shipcrane_twin.report.motions import (
    continuous_deg,
    north_east_down,
    payload_offset,
    position_error_m,
    rotation_matrices,
    ship_motion,
    sway_angle_deg,
    towards_deg,
)

ODOMETRY = "nav_msgs/msg/Odometry"
COG_M, DRAUGHT_M = (15.0, 0.0, 4.0), 2.5
degrees = st.floats(-60.0, 60.0)


def odom(positions, quaternions, stamps_ns=None):
    count = len(positions)
    stamps = np.arange(count) if stamps_ns is None else np.asarray(stamps_ns)
    return Series(
        topic="/odom",
        msgtype=ODOMETRY,
        frame_id="map",
        child_frame_id="base_link",
        columns=COLUMNS[ODOMETRY],
        stamp_ns=stamps,
        log_ns=stamps,
        values=np.hstack([positions, quaternions, np.zeros((count, 6))]),
    )


def motion_at(roll, pitch, heading, position=(0.0, 0.0, 0.0)):
    turn = Rotation.from_euler("ZYX", [90.0 - heading, -pitch, roll], degrees=True)
    return ship_motion(odom([position], [turn.as_quat()]), COG_M, DRAUGHT_M), turn


@given(roll=degrees, pitch=degrees, heading=st.floats(0.0, 359.99))
def test_attitude_comes_back_in_mariners_signs(roll, pitch, heading):
    motion, turn = motion_at(roll, pitch, heading)
    np.testing.assert_allclose([motion.roll_deg[0], motion.pitch_deg[0]], [roll, pitch], atol=1e-9)
    assert abs((motion.heading_deg[0] - heading + 180.0) % 360.0 - 180.0) < 1e-9
    port_up, bow_up = turn.apply([0, 1, 0])[2], turn.apply([1, 0, 0])[2]
    assert port_up * roll >= -1e-12  # positive roll lifts the port side: starboard down
    assert bow_up * pitch >= -1e-12


@pytest.mark.parametrize(("heading", "bow_enu"), [(0, (0, 1)), (90, (1, 0)), (180, (0, -1)), (270, (-1, 0))])
def test_heading_is_clockwise_from_north(heading, bow_enu):
    motion, turn = motion_at(5.0, -3.0, heading)
    assert motion.heading_deg[0] == pytest.approx(heading, abs=1e-9)
    flat = turn.apply([1, 0, 0])[:2]
    np.testing.assert_allclose(flat / np.linalg.norm(flat), bow_enu, atol=1e-12)


def test_at_design_draught_heave_is_zero_and_position_is_that_of_the_cog():
    motion, _ = motion_at(0.0, 0.0, 90.0, position=(100.0, 50.0, -DRAUGHT_M))
    assert motion.heave_m[0] == pytest.approx(0.0, abs=1e-12)
    assert (motion.east_m[0], motion.north_m[0]) == pytest.approx((115.0, 50.0))


def test_heave_is_that_of_the_cog_not_of_the_stern():
    """Bow up by 10 degrees about the aft perpendicular lifts the CoG, 15 m forward and 4 m up."""
    motion, _ = motion_at(0.0, 10.0, 0.0, position=(0.0, 0.0, -DRAUGHT_M))
    angle = np.deg2rad(10.0)
    assert motion.heave_m[0] == pytest.approx(15.0 * np.sin(angle) + 4.0 * np.cos(angle) - 4.0)


@settings(deadline=None)  # the first call compiles
@given(st.tuples(degrees, degrees, st.floats(-180.0, 180.0)))
def test_array_forms_equal_the_frames_of_physics(angles):
    quat = frames.quat_from_euler(*np.deg2rad(angles))
    np.testing.assert_allclose(rotation_matrices(quat[None])[0], frames.matrix_from_quat(quat), atol=1e-15)
    vector = np.array([1.0, 2.0, 3.0])
    series = odom([vector], [quat])
    np.testing.assert_array_equal(frames.enu_from_ned(north_east_down(series)[0]), vector)
    motion = ship_motion(series, COG_M, DRAUGHT_M)
    _, _, yaw = frames.euler_from_matrix(frames.matrix_from_quat(quat))
    turned = motion.heading_deg[0] - frames.heading_from_yaw(yaw)
    assert abs((turned + 180.0) % 360.0 - 180.0) < 1e-9


def test_compass_angles_stay_below_360():
    """-1e-16 % 360 is 360."""
    assert towards_deg(np.array([[-1e-17, 1.0, 0.0]]))[0] == 0.0


@pytest.mark.parametrize("angle", [0.0, 1e-6, 30.0, 90.0, 150.0])
def test_sway_is_the_angle_from_the_vertical(angle):
    around = np.deg2rad(np.arange(0.0, 360.0, 30.0))
    level, down = np.sin(np.deg2rad(angle)), np.full_like(around, np.cos(np.deg2rad(angle)))
    offset = 7.0 * np.column_stack([level * np.cos(around), level * np.sin(around), down])
    np.testing.assert_allclose(sway_angle_deg(offset), angle, atol=1e-9)


def test_offset_pairs_messages_by_stamp_even_if_some_are_missing():
    still = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
    tip = odom([[0, 0, 10], [0, 0, 11], [0, 0, 12]], still, [0, 10**9, 2 * 10**9])
    payload = odom([[0, 1, 9], [2, 0, 9]], still[:2], [0, 2 * 10**9])
    time_s, offset = payload_offset(tip, payload)
    np.testing.assert_array_equal(time_s, [0.0, 2.0])
    np.testing.assert_array_equal(offset, [[1, 0, 1], [0, 2, 3]])


def test_position_error_is_the_horizontal_distance():
    motion, _ = motion_at(0.0, 0.0, 0.0, position=(1.0, 2.0, 99.0))
    assert position_error_m(motion, north_m=17.0 - 3.0, east_m=1.0 + 4.0)[0] == pytest.approx(5.0)


@settings(deadline=None)
@given(direction=st.floats(0.0, 359.9))
def test_direction_equals_the_frames_of_physics(direction):
    vector = 3.0 * frames.towards_w(direction)
    apart = towards_deg(vector[None])[0] - direction
    assert abs((apart + 180.0) % 360.0 - 180.0) < 1e-9


def test_heading_through_north_makes_no_jump_and_stays_near_the_setpoint():
    heading = np.array([358.0, 359.5, 1.0, 3.0])
    np.testing.assert_allclose(continuous_deg(heading, near_deg=0.0), [-2.0, -0.5, 1.0, 3.0])
    np.testing.assert_allclose(continuous_deg(heading, near_deg=350.0), [358.0, 359.5, 361.0, 363.0])
