"""From recorded poses to what a mariner reads: degrees, north and east, heading, heave.

Signs: roll positive starboard down, pitch positive bow up, heading clockwise from north, heave positive up,
down = -z of the world. These are the array forms of what `physics.frames` does for one pose; tests hold
the two equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.record.read import Series

Array = NDArray[np.float64]
_POSITION, _QUATERNION = slice(0, 3), slice(3, 7)  # columns of Odometry and PoseStamped


@dataclass(frozen=True, slots=True, kw_only=True)
class ShipMotion:
    """Motion of the ship as the report shows it; every array float64, shape (n,).

    Attributes
    ----------
    roll_deg, pitch_deg, heading_deg : ndarray
        Positive starboard down; positive bow up; clockwise from north, in [0, 360).
    north_m, east_m : ndarray
        Position of the centre of gravity.
    heave_m : ndarray
        Height of the centre of gravity over its height at the design draught, positive up.
    """

    time_s: Array
    roll_deg: Array
    pitch_deg: Array
    heading_deg: Array
    north_m: Array
    east_m: Array
    heave_m: Array


def ship_motion(odom: Series, cog_m: Sequence[float], draught_m: float) -> ShipMotion:
    """Return the ship's motion in mariners' quantities.

    Parameters
    ----------
    odom : Series
        ``/vessel/odom``: pose of base_link (aft perpendicular, centre line, baseline) in ENU.
    cog_m : sequence of 3 floats
        Centre of gravity in base_link [m].
    draught_m : float
        Design draught [m]; the still water surface is z = 0.
    """
    cog_b = np.asarray(cog_m, dtype=np.float64)
    axes = rotation_matrices(odom.values[:, _QUATERNION])
    cog_w = odom.values[:, _POSITION] + axes @ cog_b
    yaw = np.arctan2(axes[:, 1, 0], axes[:, 0, 0])
    return ShipMotion(
        time_s=odom.time_s,
        roll_deg=np.rad2deg(np.arctan2(axes[:, 2, 1], axes[:, 2, 2])),
        pitch_deg=np.rad2deg(np.arcsin(np.clip(axes[:, 2, 0], -1.0, 1.0))),
        heading_deg=_compass(90.0 - np.rad2deg(yaw)),
        north_m=cog_w[:, 1],
        east_m=cog_w[:, 0],
        heave_m=cog_w[:, 2] - (cog_b[2] - draught_m),
    )


def rotation_matrices(quaternions: Array) -> Array:
    """Return body-to-world matrices, shape (n, 3, 3), of quaternions (x, y, z, w), shape (n, 4)."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=-1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=-1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1),
        ],
        axis=1,
    )


def north_east_down(series: Series) -> Array:
    """Return positions north, east, down [m], shape (n, 3), of a pose in ENU."""
    east, north, up = series.values[:, _POSITION].T
    return np.column_stack([north, east, -up])


def same_times(one: Series, other: Series) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows of two series whose stamps are equal; all rows where no message is missing."""
    _, rows_one, rows_other = np.intersect1d(one.stamp_ns, other.stamp_ns, return_indices=True)
    return rows_one, rows_other


def payload_offset(tip: Series, payload: Series) -> tuple[Array, Array]:
    """Return times [s], shape (n,), and payload minus tip as north, east, down [m], shape (n, 3)."""
    rows_tip, rows_payload = same_times(tip, payload)
    offset = north_east_down(payload)[rows_payload] - north_east_down(tip)[rows_tip]
    return tip.time_s[rows_tip], offset


def sway_angle_deg(offset_ned: Array) -> Array:
    """Return the angle between the line from tip to payload and the vertical [deg], shape (n,).

    0 hangs straight down, 90 is level with the tip; `offset_ned` as from `payload_offset`.
    """
    return np.rad2deg(np.arctan2(np.hypot(offset_ned[:, 0], offset_ned[:, 1]), offset_ned[:, 2]))


def position_error_m(motion: ShipMotion, north_m: float, east_m: float) -> Array:
    """Return the horizontal distance of the centre of gravity from the set-point [m], shape (n,)."""
    return np.hypot(motion.north_m - north_m, motion.east_m - east_m)


def towards_deg(vectors_enu: Array) -> Array:
    """Return where horizontal vectors point to, clockwise from north [deg, in [0, 360)], shape (n,)."""
    return _compass(np.rad2deg(np.arctan2(vectors_enu[:, 0], vectors_enu[:, 1])))


def _compass(angle_deg: Array) -> Array:
    """Return angles in [0, 360); the remainder of a tiny negative angle would round to 360 itself."""
    wrapped = angle_deg % 360.0
    return np.where(wrapped == 360.0, 0.0, wrapped)


def continuous_deg(angle_deg: Array, near_deg: float) -> Array:
    """Return angles without jumps at 0/360, the first within 180 degrees of `near_deg`; for plots."""
    if not len(angle_deg):
        return angle_deg
    unwrapped = np.unwrap(angle_deg, period=360.0)
    return unwrapped + 360.0 * np.round((near_deg - unwrapped[0]) / 360.0)
