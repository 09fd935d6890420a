"""Closed forms between actuator lengths (cylinders) and joint values.

A triangle drive is a cylinder that closes a triangle with two rigid sides; the joint angle is the
triangle's angle opposite the cylinder plus a constant. A linear drive is joint = length + offset: a
telescope, or a slew motor with offset 0 and no ends. Joint values grow with length in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array, Ints

LINEAR = 0
TRIANGLE = 1


class LinearDrive(NamedTuple):
    """Joint value = length + offset; lengths in the joint's unit, ends may be infinite."""

    offset: float = 0.0
    length_min: float = -np.inf
    length_max: float = np.inf


class TriangleDrive(NamedTuple):
    """Joint angle [rad] = angle between side_a and side_b [m], opposite the cylinder, + offset [rad]."""

    side_a: float
    side_b: float
    offset: float
    length_min: float
    length_max: float


class DriveParams(NamedTuple):
    """Drives of n joints as arrays of shape (n,): kind (int64) and the fields of the two drive types."""

    kind: Ints
    side_a: Array
    side_b: Array
    offset: Array
    length_min: Array
    length_max: Array


def make_drives(drives: Sequence[LinearDrive | TriangleDrive]) -> DriveParams:
    """Check and pack the drives of all joints, base to tip.

    Raises
    ------
    ValueError
        If the ends of a drive are not ordered, or a cylinder end cannot close its triangle.
    """
    for joint, drive in enumerate(drives):
        if not drive.length_min < drive.length_max:
            raise ValueError(
                f"drive {joint}: length_min {drive.length_min} m and length_max {drive.length_max} m; "
                "expected length_min < length_max"
            )
        if isinstance(drive, TriangleDrive):
            _check_triangle(drive, joint)
    return DriveParams(
        kind=np.array([TRIANGLE if isinstance(d, TriangleDrive) else LINEAR for d in drives], dtype=np.int64),
        side_a=np.array([d.side_a if isinstance(d, TriangleDrive) else 1.0 for d in drives]),
        side_b=np.array([d.side_b if isinstance(d, TriangleDrive) else 1.0 for d in drives]),
        offset=np.array([d.offset for d in drives], dtype=np.float64),
        length_min=np.array([d.length_min for d in drives], dtype=np.float64),
        length_max=np.array([d.length_max for d in drives], dtype=np.float64),
    )


def _check_triangle(drive: TriangleDrive, joint: int) -> None:
    shortest = abs(drive.side_a - drive.side_b)
    longest = drive.side_a + drive.side_b
    if drive.side_a <= 0.0 or drive.side_b <= 0.0:
        raise ValueError(f"drive {joint}: sides {drive.side_a} m and {drive.side_b} m; expected both > 0")
    if not (shortest < drive.length_min and drive.length_max < longest):
        raise ValueError(
            f"drive {joint}: cylinder {drive.length_min} to {drive.length_max} m cannot close its triangle; "
            f"expected lengths between {shortest:.6g} and {longest:.6g} m, both excluded"
        )


@njit(cache=True)
def joints_from_lengths(drives: DriveParams, lengths: Array) -> Array:
    """Return joint values (n,) [rad or m] for actuator lengths (n,) [m, or rad for a slew motor].

    Source for the triangle: law of cosines, as in the closed forms of the Palfinger co-simulation unit.

    Raises
    ------
    ValueError
        If a cylinder is too short or too long to close its triangle.
    """
    q = np.empty(lengths.shape[0])
    for i in range(lengths.shape[0]):
        q[i] = joint_at(drives, i, lengths[i])
        if not (q[i] == q[i]) and lengths[i] == lengths[i]:
            raise ValueError("crane: a cylinder length cannot close its triangle")
    return q


@njit(cache=True)
def joint_at(drives: DriveParams, i: int, length: float) -> float:
    """Return the joint value of drive i at that length; NaN if a cylinder cannot close its triangle."""
    if drives.kind[i] == LINEAR:
        return drives.offset[i] + length
    a, b = drives.side_a[i], drives.side_b[i]
    cosine = (a * a + b * b - length * length) / (2.0 * a * b)
    if not (-1.0 <= cosine <= 1.0) or length < 0.0:
        return np.nan
    return drives.offset[i] + np.arccos(cosine)


@njit(cache=True)
def lengths_from_joints(drives: DriveParams, q: Array) -> Array:
    """Return actuator lengths (n,) for joint values (n,); inverse of `joints_from_lengths`."""
    lengths = np.empty(q.shape[0])
    for i in range(q.shape[0]):
        lengths[i] = length_and_arm(drives, i, q[i])[0]
    return lengths


@njit(cache=True)
def joint_rates_per_length(drives: DriveParams, q: Array) -> Array:
    """Return d(joint)/d(length) (n,) at the pose q (n,) [rad/m]; 1 for a linear drive.

    Joint rate = this times cylinder speed; cylinder force = this times joint torque (equal power).
    It grows without bound as the triangle folds flat.
    """
    rates = np.empty(q.shape[0])
    for i in range(q.shape[0]):
        rates[i] = 1.0 / length_and_arm(drives, i, q[i])[1]
    return rates


@njit(cache=True)
def length_and_arm(drives: DriveParams, i: int, q: float) -> tuple[float, float]:
    """Return length and effective lever arm d(length)/d(joint) [m/rad] of drive i at the joint value q.

    Joint torque = arm times cylinder force; cylinder speed = arm times joint rate.
    """
    angle = q - drives.offset[i]
    if drives.kind[i] == LINEAR:
        return angle, 1.0
    return triangle(drives.side_a[i], drives.side_b[i], angle)


@njit(cache=True)
def triangle(a: float, b: float, angle: float) -> tuple[float, float]:
    """Return the side opposite an angle [rad] between sides a and b [m], and its derivative over the angle [m/rad]."""
    length = np.sqrt(a * a + b * b - 2.0 * a * b * np.cos(angle))
    return length, a * b * np.sin(angle) / length
