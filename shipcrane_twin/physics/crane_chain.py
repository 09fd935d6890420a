"""Geometry of a crane as a serial chain of revolute and prismatic joints.

Everything is expressed in the axes of `crane_base` (suffix _b) about its origin, so inertias of
several links add up as they are and no spatial transforms are needed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_segments import Segment, SegmentParams, pack_segments

REVOLUTE = 0
PRISMATIC = 1
JOINT_KINDS = {"revolute": REVOLUTE, "prismatic": PRISMATIC}


class ChainParams(NamedTuple):
    """A chain of n joints and a fixed tip frame, as `make_chain` builds it.

    Attributes
    ----------
    dh : float64, shape (n + 1, 4)
        Modified (Craig) Denavit-Hartenberg rows a [m], alpha [rad], d [m], theta [rad]; the last
        row is the fixed tip frame.
    twist : float64, shape (n + 1, 2)
        cos(alpha) and sin(alpha) of each row.
    kind : int64, shape (n,)
        REVOLUTE: the joint value adds to theta; PRISMATIC: it adds to d.
    mass : float64, shape (n,)
        Link masses with their segments [kg].
    cog : float64, shape (n, 3)
        Link centres of gravity in their own link frames, without segments [m].
    inertia : float64, shape (n, 3, 3)
        Link inertias about those centres, in link axes [kg m2]; those of segments about their own are added.
    segments : SegmentParams
        Telescope segments that trail behind their link; none on most links.
    """

    dh: Array
    twist: Array
    kind: Ints
    mass: Array
    cog: Array
    inertia: Array
    segments: SegmentParams


def make_chain(
    *,
    dh: ArrayLike,
    kind: Sequence[str],
    mass: ArrayLike,
    cog: ArrayLike,
    inertia: ArrayLike,
    segments: Mapping[int, Sequence[Segment]] | None = None,
    handover: float = 0.1,
) -> ChainParams:
    """Check and pack the description of a chain.

    Parameters
    ----------
    dh : array_like, shape (n + 1, 4)
        Modified D-H rows a [m], alpha [rad], d [m], theta [rad] of n joints, then of the tip frame.
    kind : sequence of n str
        "revolute" or "prismatic".
    mass, cog, inertia : array_like, shapes (n,), (n, 3), (n, 3, 3)
        As in `ChainParams`; of a telescope, those of its last segment, which the tip is on.
    segments : mapping of link number to sequence of Segment, optional
        The other segments of telescopes, the outermost first, see `crane_segments`.
    handover : float
        Stroke over which one segment stops and the next starts [m].

    Raises
    ------
    ValueError
        If a shape, a joint kind, a mass or an inertia is impossible; the message names it.
    """
    joints = len(kind)
    if joints < 1:
        raise ValueError("chain: kind is empty, expected at least one joint")
    unknown = [name for name in kind if name not in JOINT_KINDS]
    if unknown:
        known = " or ".join(sorted(JOINT_KINDS))
        raise ValueError(f"chain: joint kind {unknown[0]!r} is unknown, expected {known}")
    rows = _checked(dh, (joints + 1, 4), "dh (one row a, alpha, d, theta per joint and one for the tip)")
    masses = _checked(mass, (joints,), "mass")
    if np.any(masses <= 0.0):
        worst = int(np.argmin(masses))
        raise ValueError(f"chain: mass[{worst}] is {masses[worst]} kg, expected > 0")
    tensors = _checked(inertia, (joints, 3, 3), "inertia")
    trailing = dict(segments or {})
    for link in range(joints):
        _check_inertia(tensors[link], f"inertia[{link}]")
        for number, segment in enumerate(trailing.get(link, ())):
            _check_inertia(np.asarray(segment.inertia), f"inertia of segment {number} of link {link}")
        for segment in trailing.get(link, ()):
            tensors[link] += np.asarray(segment.inertia)
    wrong = [link for link in trailing if not 0 <= link < joints or kind[link] != "prismatic"]
    if wrong:
        raise ValueError(f"chain: segments are given for link {wrong[0]}, expected the number of a prismatic joint")
    return ChainParams(
        dh=rows,
        twist=np.column_stack((np.cos(rows[:, 1]), np.sin(rows[:, 1]))),
        kind=np.array([JOINT_KINDS[name] for name in kind], dtype=np.int64),
        mass=masses + [sum(segment.mass for segment in trailing.get(link, ())) for link in range(joints)],
        cog=_checked(cog, (joints, 3), "cog"),
        inertia=tensors,
        segments=pack_segments(joints, trailing, handover),
    )


def _checked(values: ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    array = np.array(values, dtype=np.float64, order="C")
    if array.shape != shape:
        raise ValueError(f"chain: {name} has shape {array.shape}, expected {shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"chain: {name} holds a value that is not finite")
    return array


def _check_inertia(tensor: Array, name: str) -> None:
    size = float(np.max(np.abs(tensor)))
    if not np.allclose(tensor, tensor.T, rtol=0.0, atol=1e-9 * size):
        raise ValueError(f"chain: {name} is not symmetric")
    low, mid, high = np.linalg.eigvalsh(tensor)
    if low < -1e-9 * size or low + mid < high * (1.0 - 1e-9):
        raise ValueError(
            f"chain: {name} has principal values {low:.6g}, {mid:.6g}, {high:.6g} kg m2; expected "
            "none negative and none greater than the sum of the others"
        )


@njit(cache=True)
def cross(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> tuple[float, float, float]:
    """Return the cross product a x b as three floats: no arrays, so nothing is allocated."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@njit(cache=True)
def joint_count(chain: ChainParams, q: Array) -> int:
    """Return n, or raise ValueError if q does not hold one value per joint.

    Only the outer kernels check: a raise in the inner ones would cost them reference counting.
    """
    if q.shape[0] != chain.kind.shape[0]:
        raise ValueError("crane: the number of joint values differs from the number of joints")
    return chain.kind.shape[0]


@njit(cache=True)
def place_frames(chain: ChainParams, q: Array, rotation_b: Array, origin_b: Array) -> None:
    """Fill the frames of all links and of the tip, modified D-H (Craig, Introduction to Robotics, ch. 3).

    Parameters
    ----------
    chain : ChainParams
        Geometry.
    q : float64, shape (n,)
        Joint values [rad] or [m].
    rotation_b, origin_b : float64, shapes (n + 1, 3, 3), (n + 1, 3)
        Filled: axes (as columns) and origins in crane_base axes.
    """
    joints = chain.kind.shape[0]
    xx, xy, xz = 1.0, 0.0, 0.0
    yx, yy, yz = 0.0, 1.0, 0.0
    zx, zy, zz = 0.0, 0.0, 1.0
    px, py, pz = 0.0, 0.0, 0.0
    for i in range(joints + 1):
        a = chain.dh[i, 0]
        d = chain.dh[i, 2]
        theta = chain.dh[i, 3]
        if i < joints:
            if chain.kind[i] == REVOLUTE:
                theta += q[i]
            else:
                d += q[i]
        ca = chain.twist[i, 0]
        sa = chain.twist[i, 1]
        ct = np.cos(theta)
        st = np.sin(theta)
        # Turn about x by alpha, then about the new z by theta.
        tx, ty, tz = ca * yx + sa * zx, ca * yy + sa * zy, ca * yz + sa * zz
        zx, zy, zz = ca * zx - sa * yx, ca * zy - sa * yy, ca * zz - sa * yz
        px, py, pz = px + a * xx + d * zx, py + a * xy + d * zy, pz + a * xz + d * zz
        yx, yy, yz = ct * tx - st * xx, ct * ty - st * xy, ct * tz - st * xz
        xx, xy, xz = ct * xx + st * tx, ct * xy + st * ty, ct * xz + st * tz
        rotation_b[i, 0, 0], rotation_b[i, 0, 1], rotation_b[i, 0, 2] = xx, yx, zx
        rotation_b[i, 1, 0], rotation_b[i, 1, 1], rotation_b[i, 1, 2] = xy, yy, zy
        rotation_b[i, 2, 0], rotation_b[i, 2, 1], rotation_b[i, 2, 2] = xz, yz, zz
        origin_b[i, 0], origin_b[i, 1], origin_b[i, 2] = px, py, pz


@njit(cache=True)
def forward_kinematics(chain: ChainParams, q: Array) -> tuple[Array, Array]:
    """Return origins (n + 1, 3) [m] and rotations (n + 1, 3, 3) of all links and the tip, in crane_base.

    The last entry is the tip frame; columns of a rotation are the frame's axes in base axes.
    """
    joints = joint_count(chain, q)
    rotation_b = np.empty((joints + 1, 3, 3))
    origin_b = np.empty((joints + 1, 3))
    place_frames(chain, q, rotation_b, origin_b)
    return origin_b, rotation_b


@njit(cache=True)
def tip_jacobian(chain: ChainParams, q: Array) -> Array:
    """Return the Jacobian of the tip relative to the base, shape (6, n), in crane_base axes.

    Rows 0 to 2: velocity of the tip point; rows 3 to 5: angular velocity of the last link; per
    unit joint rate [rad/s] or [m/s].
    """
    origin_b, rotation_b = forward_kinematics(chain, q)
    joints = chain.kind.shape[0]
    jacobian = np.zeros((6, joints))
    for i in range(joints):
        zx, zy, zz = rotation_b[i, 0, 2], rotation_b[i, 1, 2], rotation_b[i, 2, 2]
        if chain.kind[i] == REVOLUTE:
            arm = origin_b[joints] - origin_b[i]
            jacobian[0, i], jacobian[1, i], jacobian[2, i] = cross(zx, zy, zz, arm[0], arm[1], arm[2])
            jacobian[3, i], jacobian[4, i], jacobian[5, i] = zx, zy, zz
        else:
            jacobian[0, i], jacobian[1, i], jacobian[2, i] = zx, zy, zz
    return jacobian


@njit(cache=True)
def fill_tip(chain: ChainParams, qd: Array, rotation_b: Array, origin_b: Array, tip_b: Array) -> None:
    """Fill tip_b (18,) from frames that `place_frames` made and joint rates qd (n,).

    Position, velocity and angular velocity relative to the base (3 each) [m, m/s, rad/s], then the
    rotation from tip frame to base (9, row by row), in crane_base axes.
    """
    joints = chain.kind.shape[0]
    px, py, pz = origin_b[joints, 0], origin_b[joints, 1], origin_b[joints, 2]
    vx, vy, vz = 0.0, 0.0, 0.0
    wx, wy, wz = 0.0, 0.0, 0.0
    for i in range(joints):
        zx, zy, zz = rotation_b[i, 0, 2] * qd[i], rotation_b[i, 1, 2] * qd[i], rotation_b[i, 2, 2] * qd[i]
        if chain.kind[i] == REVOLUTE:
            wx, wy, wz = wx + zx, wy + zy, wz + zz
            zx, zy, zz = cross(zx, zy, zz, px - origin_b[i, 0], py - origin_b[i, 1], pz - origin_b[i, 2])
        vx, vy, vz = vx + zx, vy + zy, vz + zz
    tip_b[0], tip_b[1], tip_b[2] = px, py, pz
    tip_b[3], tip_b[4], tip_b[5] = vx, vy, vz
    tip_b[6], tip_b[7], tip_b[8] = wx, wy, wz
    for i in range(3):
        for k in range(3):
            tip_b[9 + 3 * i + k] = rotation_b[joints, i, k]


@njit(cache=True)
def tip_state(chain: ChainParams, q: Array, qd: Array) -> tuple[Array, Array, Array, Array]:
    """Return where the tip is and how it moves relative to the crane base.

    Parameters
    ----------
    chain : ChainParams
        Geometry.
    q, qd : float64, shape (n,)
        Joint values and rates [rad, rad/s] or [m, m/s].

    Returns
    -------
    position_b, velocity_b, angular_velocity_b : float64, shape (3,)
        Of the tip relative to the base, in crane_base axes [m, m/s, rad/s].
    rotation_b : float64, shape (3, 3)
        Tip frame to crane_base axes.
    """
    origin_b, rotation_b = forward_kinematics(chain, q)
    tip_b = np.empty(18)
    fill_tip(chain, qd, rotation_b, origin_b, tip_b)
    return tip_b[0:3], tip_b[3:6], tip_b[6:9], tip_b[9:18].reshape(3, 3)
