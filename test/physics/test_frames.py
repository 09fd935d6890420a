"""Every change between frames there and back, and against scipy's rotations."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics.frames import (
    cross,
    enu_from_ned,
    euler_from_matrix,
    flu_matrix_from_frd,
    heading_cosines,
    heading_from_yaw,
    level_axes,
    matrix_from_quat,
    quat_from_euler,
    quat_from_matrix,
    quat_rate,
    rotate_to_body,
    rotate_to_world,
    towards_w,
    wrap_angle,
    yaw_from_heading,
)

compiled = settings(deadline=None)  # the first call compiles
angles = st.floats(-3.1, 3.1)
pitches = st.floats(-1.5, 1.5)
vectors = st.tuples(*[st.floats(-100.0, 100.0)] * 3).map(np.array)
seeds = st.integers(0, 9999)


@compiled
@given(seed=seeds)
def test_matrix_of_a_quaternion_is_that_of_scipy(seed):
    turn = Rotation.random(rng=seed)
    np.testing.assert_allclose(matrix_from_quat(turn.as_quat()), turn.as_matrix(), atol=1e-15)


@compiled
@given(seed=seeds)
def test_quaternion_to_matrix_and_back(seed):
    quat = Rotation.random(rng=seed).as_quat(canonical=True)
    np.testing.assert_allclose(quat_from_matrix(matrix_from_quat(quat)), quat, atol=1e-14)


@pytest.mark.parametrize("axis", [*np.eye(3), [0.6, -0.8, 0.0], [0.0, 0.6, -0.8], [1 / 3, 2 / 3, 2 / 3]])
@pytest.mark.parametrize("angle", [np.pi, np.pi - 1e-9, np.pi + 1e-9])
def test_half_turns_survive_the_matrix(axis, angle):
    turn = Rotation.from_rotvec(angle * np.asarray(axis))
    quat = quat_from_matrix(turn.as_matrix())
    assert quat[3] >= 0.0
    np.testing.assert_allclose(matrix_from_quat(quat), turn.as_matrix(), atol=1e-14)


@compiled
@given(roll=angles, pitch=pitches, yaw=angles)
def test_euler_to_quaternion_to_matrix_and_back(roll, pitch, yaw):
    quat = quat_from_euler(roll, pitch, yaw)
    same = Rotation.from_euler("ZYX", [yaw, pitch, roll])
    np.testing.assert_allclose(matrix_from_quat(quat), same.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(euler_from_matrix(matrix_from_quat(quat)), [roll, pitch, yaw], atol=1e-12)


@compiled
@given(seed=seeds, omega_b=vectors)
def test_quaternion_rate_turns_the_body_about_its_own_axes(seed, omega_b):
    start, dt = Rotation.random(rng=seed), 1e-7
    after = (start * Rotation.from_rotvec(0.5 * dt * omega_b)).as_quat()
    before = (start * Rotation.from_rotvec(-0.5 * dt * omega_b)).as_quat()
    after, before = after * np.sign(after @ start.as_quat()), before * np.sign(before @ start.as_quat())
    np.testing.assert_allclose(quat_rate(start.as_quat(), omega_b), (after - before) / dt, atol=1e-6)


@compiled
@given(seed=seeds, a=vectors, b=vectors)
def test_vector_kernels_agree_with_numpy_and_undo_each_other(seed, a, b):
    rot = Rotation.random(rng=seed).as_matrix()
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-10)
    np.testing.assert_allclose(rotate_to_world(rot, a), rot @ a, atol=1e-11)
    np.testing.assert_allclose(rotate_to_body(rot, rotate_to_world(rot, a)), a, atol=1e-11)


@given(heading=st.floats(0.0, 360.0, exclude_max=True))
def test_heading_to_yaw_and_back(heading):
    difference = heading_from_yaw(yaw_from_heading(heading)) - heading
    assert (difference + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-12 * 360.0)


@given(yaw=st.floats(-50.0, 50.0))
@example(yaw=np.nextafter(np.pi / 2, 4.0))
def test_heading_lies_from_0_to_below_360(yaw):
    assert 0.0 <= heading_from_yaw(yaw) < 360.0


@pytest.mark.parametrize(("heading", "east", "north"), [(0, 0, 1), (90, 1, 0), (180, 0, -1), (270, -1, 0)])
def test_headings_count_clockwise_from_north(heading, east, north):
    yaw = yaw_from_heading(heading)
    np.testing.assert_allclose([np.cos(yaw), np.sin(yaw)], [east, north], atol=1e-15)


@compiled
@given(angle=st.floats(-100.0, 100.0))
@example(angle=np.nextafter(-np.pi, -4.0))
@example(angle=np.pi)
def test_wrapped_angle_is_the_same_direction_within_half_a_turn(angle):
    wrapped = wrap_angle(angle)
    assert -np.pi <= wrapped < np.pi
    assert np.exp(1j * wrapped) == pytest.approx(np.exp(1j * angle), abs=1e-12)


@given(direction=st.floats(-180.0, 180.0))
def test_direction_towards_and_back(direction):
    east, north, up = towards_w(direction)
    assert up == 0.0
    assert np.hypot(east, north) == pytest.approx(1.0)
    assert np.rad2deg(np.arctan2(east, north)) == pytest.approx(direction, abs=1e-9)


def test_minus_135_degrees_is_towards_the_southwest():
    np.testing.assert_allclose(towards_w(-135.0), [-np.sqrt(0.5), -np.sqrt(0.5), 0.0])


@compiled
@given(heading=st.floats(-180.0, 180.0))
def test_a_ship_heads_towards_its_heading(heading):
    bow_w = matrix_from_quat(quat_from_euler(0.0, 0.0, yaw_from_heading(heading)))[:, 0]
    np.testing.assert_allclose(bow_w, towards_w(heading), atol=1e-14)


@given(vector=vectors)
def test_ned_to_enu_and_back(vector):
    np.testing.assert_array_equal(enu_from_ned(enu_from_ned(vector)), vector)


def test_north_east_down_become_y_x_and_minus_z():
    np.testing.assert_array_equal(enu_from_ned(np.array([1.0, 2.0, 3.0])), [2.0, 1.0, -3.0])


@compiled
@given(roll=angles, pitch=pitches, heading=angles)
def test_marine_attitude_is_the_same_ship(roll, pitch, heading):
    ned_from_frd = Rotation.from_euler("ZYX", [heading, pitch, roll]).as_matrix()
    flu_axes_frd = np.diag([1.0, -1.0, -1.0])
    expected = np.column_stack([enu_from_ned(ned_from_frd @ axis) for axis in flu_axes_frd])
    found = matrix_from_quat(quat_from_euler(roll, -pitch, yaw_from_heading(np.rad2deg(heading))))
    np.testing.assert_allclose(found, expected, atol=1e-13)


@given(seed=seeds)
def test_6x6_from_frd_to_flu_and_back_gives_the_turned_load(seed):
    rng = np.random.default_rng(seed)
    matrix_frd, nu_frd = rng.normal(size=(6, 6)), rng.normal(size=6)
    half_turn = np.kron(np.eye(2), Rotation.from_euler("x", 180, degrees=True).as_matrix())
    matrix_flu = flu_matrix_from_frd(matrix_frd)
    np.testing.assert_allclose(matrix_flu @ (half_turn @ nu_frd), half_turn @ (matrix_frd @ nu_frd), atol=1e-12)
    np.testing.assert_array_equal(flu_matrix_from_frd(matrix_flu), matrix_frd)


@given(roll=st.floats(-1.0, 1.0), pitch=st.floats(-1.0, 1.0), yaw=st.floats(-3.0, 3.0))
def test_level_axes_keep_the_heading_and_nothing_else(roll, pitch, yaw):
    rot = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
    np.testing.assert_allclose(heading_cosines(rot), [np.cos(yaw), np.sin(yaw)], atol=1e-12)
    turned = Rotation.from_euler("z", yaw).as_matrix() @ level_axes(rot)  # body to level to world
    np.testing.assert_allclose(turned, rot, atol=1e-12)
