"""Rotations and every change between frames: body, level and world, marine (NED, FRD) and ROS (ENU, FLU).

Inside and on topics the twin speaks REP 103: world ENU (x east, y north, z up), body FLU
(x forward, y port, z up). Mariners' quantities (heading clockwise from north, roll positive
starboard down, pitch positive bow up) exist only in scenarios and reports.
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

FLU_FROM_FRD = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
"""Signs that turn a 6-vector (force, moment or motion) given forward-right-down into forward-left-up."""


@njit(cache=True)
def matrix_from_quat(quat: Array) -> Array:
    """Return the rotation matrix, body to world, of a unit quaternion.

    Parameters
    ----------
    quat : float64, shape (4,)
        Unit quaternion (x, y, z, w), body to world.

    Returns
    -------
    float64, shape (3, 3)
        ``r_w = R @ r_b``.
    """
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    rot = np.empty((3, 3))
    rot[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    rot[0, 1] = 2.0 * (x * y - z * w)
    rot[0, 2] = 2.0 * (x * z + y * w)
    rot[1, 0] = 2.0 * (x * y + z * w)
    rot[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    rot[1, 2] = 2.0 * (y * z - x * w)
    rot[2, 0] = 2.0 * (x * z - y * w)
    rot[2, 1] = 2.0 * (y * z + x * w)
    rot[2, 2] = 1.0 - 2.0 * (x * x + y * y)
    return rot


@njit(cache=True)
def quat_from_matrix(rot: Array) -> Array:
    """Return the unit quaternion (x, y, z, w) with w >= 0 of a rotation matrix (3, 3); Shepperd 1978."""
    quat = np.empty(4)
    trace = rot[0, 0] + rot[1, 1] + rot[2, 2]
    if trace > max(rot[0, 0], rot[1, 1], rot[2, 2]):
        big = 2.0 * np.sqrt(1.0 + trace)
        quat[0] = (rot[2, 1] - rot[1, 2]) / big
        quat[1] = (rot[0, 2] - rot[2, 0]) / big
        quat[2] = (rot[1, 0] - rot[0, 1]) / big
        quat[3] = 0.25 * big
        return quat
    i = 0
    if rot[1, 1] > rot[0, 0]:
        i = 1
    if rot[2, 2] > rot[i, i]:
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    big = 2.0 * np.sqrt(1.0 + rot[i, i] - rot[j, j] - rot[k, k])
    quat[i] = 0.25 * big
    quat[j] = (rot[j, i] + rot[i, j]) / big
    quat[k] = (rot[k, i] + rot[i, k]) / big
    quat[3] = (rot[k, j] - rot[j, k]) / big
    if quat[3] < 0.0:
        quat = -quat
    return quat


@njit(cache=True)
def quat_from_euler(roll: float, pitch: float, yaw: float) -> Array:
    """Return the quaternion (x, y, z, w) of yaw, then pitch, then roll (z-y-x, FLU body, ENU world) [rad]."""
    cr, sr = np.cos(0.5 * roll), np.sin(0.5 * roll)
    cp, sp = np.cos(0.5 * pitch), np.sin(0.5 * pitch)
    cy, sy = np.cos(0.5 * yaw), np.sin(0.5 * yaw)
    return np.array(
        [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ]
    )


@njit(cache=True)
def euler_from_matrix(rot: Array) -> tuple[float, float, float]:
    """Return roll, pitch, yaw [rad] (z-y-x, FLU: pitch positive bow down) of a matrix (3, 3) body to world."""
    pitch = np.arcsin(min(1.0, max(-1.0, -rot[2, 0])))
    return np.arctan2(rot[2, 1], rot[2, 2]), pitch, np.arctan2(rot[1, 0], rot[0, 0])


@njit(cache=True)
def heading_cosines(rot: Array) -> tuple[float, float]:
    """Return east and north part of the horizontal unit vector in which the body's x axis points."""
    length = np.sqrt(rot[0, 0] ** 2 + rot[1, 0] ** 2)
    return rot[0, 0] / length, rot[1, 0] / length


@njit(cache=True)
def turned_axes(rot: Array, ahead_x: float, ahead_y: float) -> Array:
    """Return the matrix (3, 3) from body axes to horizontal axes along (ahead_x, ahead_y), east and north, and up."""
    out = np.empty((3, 3))
    for i in range(3):
        out[0, i] = ahead_x * rot[0, i] + ahead_y * rot[1, i]
        out[1, i] = ahead_x * rot[1, i] - ahead_y * rot[0, i]
        out[2, i] = rot[2, i]
    return out


@njit(cache=True)
def level_axes(rot: Array) -> Array:
    """Return the matrix (3, 3) from body axes to level axes: x ahead and horizontal, z up, whatever roll and pitch.

    Parameters
    ----------
    rot : float64, shape (3, 3)
        Body to world.
    """
    ahead_x, ahead_y = heading_cosines(rot)
    return turned_axes(rot, ahead_x, ahead_y)


@njit(cache=True)
def quat_rate(quat: Array, omega_b: Array) -> tuple[float, float, float, float]:
    """Return dq/dt of a quaternion (x, y, z, w) for the angular velocity (3,) in body axes [rad/s]."""
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    p, q, r = omega_b[0], omega_b[1], omega_b[2]
    return (
        0.5 * (w * p + y * r - z * q),
        0.5 * (w * q + z * p - x * r),
        0.5 * (w * r + x * q - y * p),
        -0.5 * (x * p + y * q + z * r),
    )


@njit(cache=True)
def cross(a: Array, b: Array) -> Array:
    """Return the cross product of two 3-vectors (numpy's own is slow for single vectors)."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@njit(cache=True)
def rotate_to_world(rot: Array, vec_b: Array) -> Array:
    """Return ``rot @ vec_b`` for a matrix (3, 3) and a vector (3,)."""
    out = np.empty(3)
    for i in range(3):
        out[i] = rot[i, 0] * vec_b[0] + rot[i, 1] * vec_b[1] + rot[i, 2] * vec_b[2]
    return out


@njit(cache=True)
def rotate_to_body(rot: Array, vec_w: Array) -> Array:
    """Return ``rot.T @ vec_w`` for a matrix (3, 3) and a vector (3,)."""
    out = np.empty(3)
    for i in range(3):
        out[i] = rot[0, i] * vec_w[0] + rot[1, i] * vec_w[1] + rot[2, i] * vec_w[2]
    return out


def yaw_from_heading(heading_deg: float) -> float:
    """Return the ENU yaw [rad, in [-pi, pi)] of a heading in degrees clockwise from north."""
    return float(wrap_angle(np.deg2rad(90.0 - heading_deg)))


def heading_from_yaw(yaw: float) -> float:
    """Return the heading [deg, in [0, 360)] of an ENU yaw [rad]."""
    heading = float((90.0 - np.rad2deg(yaw)) % 360.0)
    return 0.0 if heading == 360.0 else heading  # the remainder of a tiny negative number rounds up


def towards_w(direction_to_deg: float) -> Array:
    """Return the horizontal unit vector (3,) in ENU of a direction (towards, clockwise from north) [deg]."""
    angle = np.deg2rad(direction_to_deg)
    return np.array([np.sin(angle), np.cos(angle), 0.0])


def enu_from_ned(vec_ned: Array) -> Array:
    """Return a world vector (3,) given north-east-down as east-north-up; its own inverse."""
    return np.array([vec_ned[1], vec_ned[0], -vec_ned[2]])


def flu_matrix_from_frd(matrix_frd: Array) -> Array:
    """Return a 6x6 coefficient matrix given forward-right-down in forward-left-up; its own inverse."""
    return FLU_FROM_FRD[:, None] * matrix_frd * FLU_FROM_FRD[None, :]


@njit(cache=True)
def wrap_angle(angle: float) -> float:
    """Return an angle [rad] brought into [-pi, pi)."""
    wrapped = (angle + np.pi) % (2.0 * np.pi) - np.pi
    return -np.pi if wrapped >= np.pi else wrapped  # the remainder of a tiny negative number rounds up
