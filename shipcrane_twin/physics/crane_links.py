"""Links of a crane placed in crane_base: the arrays that dynamics and inertia are computed from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_chain import REVOLUTE, ChainParams, cross, place_frames
from shipcrane_twin.physics.crane_segments import gather_segments


class ChainWork(NamedTuple):
    """Scratch arrays of one evaluation, allocated once per macro step; see `new_work`.

    Attributes
    ----------
    rotation_b : float64, shape (n + 1, 3, 3)
        Frames of the links and of the tip; columns are their axes in base axes.
    origin_b : float64, shape (n + 1, 3)
        Origins of these frames [m].
    cog_b : float64, shape (n, 3)
        Link centres of gravity from the base origin [m].
    inertia_b : float64, shape (n, 6)
        xx, xy, xz, yy, yz, zz about the link's own centre, in base axes [kg m2].
    screw_b : float64, shape (n, 6)
        Velocity of the material point at the base origin (3) and angular velocity (3) that a unit
        rate of the joint gives to everything outboard of it.
    momentum_b : float64, shape (n, 6)
        Linear (3) and angular momentum about the base origin (3) per unit rate of the joint.
    wrench_b : float64, shape (n, 6)
        Force (3) and moment about the base origin (3) that the links from i outward need while all
        joint accelerations are zero, tip force deducted.
    mass_matrix : float64, shape (n, n)
        Joint-space mass matrix.
    tip_acc_b : float64, shape (3,)
        Proper acceleration of the tip while all joint accelerations are zero [m/s2].
    bias : float64, shape (n,)
        Joint efforts needed at zero joint acceleration.
    body : float64, shape (n, 9)
        Centre (3) and inertia about it (6) of each link with its segments, in its own frame.
    slide : float64, shape (n, 10)
        How the segments of each link trail behind it, see `crane_segments.gather_segments`.
    motion_b : float64, shape (n, 9)
        Angular velocity and acceleration of each link, and proper acceleration of its origin, in base axes.
    along : float64, shape (n,)
        Velocity of the tip along the wire per unit rate of each joint.
    """

    rotation_b: Array
    origin_b: Array
    cog_b: Array
    inertia_b: Array
    screw_b: Array
    momentum_b: Array
    wrench_b: Array
    mass_matrix: Array
    tip_acc_b: Array
    bias: Array
    body: Array
    slide: Array
    motion_b: Array
    along: Array


@njit(cache=True)
def new_work(joints: int) -> ChainWork:
    """Return zeroed scratch arrays for a chain of that many joints."""
    return ChainWork(
        np.zeros((joints + 1, 3, 3)),
        np.zeros((joints + 1, 3)),
        np.zeros((joints, 3)),
        np.zeros((joints, 6)),
        np.zeros((joints, 6)),
        np.zeros((joints, 6)),
        np.zeros((joints, 6)),
        np.zeros((joints, joints)),
        np.zeros(3),
        np.zeros(joints),
        np.zeros((joints, 9)),
        np.zeros((joints, 10)),
        np.zeros((joints, 9)),
        np.zeros(joints),
    )


@njit(cache=True)
def place_links(chain: ChainParams, q: Array, work: ChainWork) -> None:
    """Fill frames, centres of gravity, inertias and joint screws of `work` for the pose q (n,)."""
    place_frames(chain, q, work.rotation_b, work.origin_b)
    segments = chain.segments
    _gather_bodies(
        chain.mass, chain.cog, chain.inertia, segments.first, segments.rows, segments.handover, q, work.body, work.slide
    )
    _place_bodies(chain.kind, work.rotation_b, work.origin_b, work.body, work.cog_b, work.inertia_b, work.screw_b)


@njit(cache=True)
def _place_bodies(
    kind: Ints, rotation_b: Array, origin_b: Array, body: Array, cog_b: Array, inertia_b: Array, screw_b: Array
) -> None:
    """Fill centres, inertias and screws; arrays by themselves: those of a tuple cost reference counting in a loop."""
    for i in range(kind.shape[0]):
        for k in range(3):
            cog_b[i, k] = (
                origin_b[i, k]
                + rotation_b[i, k, 0] * body[i, 0]
                + rotation_b[i, k, 1] * body[i, 1]
                + rotation_b[i, k, 2] * body[i, 2]
            )
        _turn_inertia(rotation_b, body, inertia_b, i)
        zx, zy, zz = rotation_b[i, 0, 2], rotation_b[i, 1, 2], rotation_b[i, 2, 2]
        if kind[i] == REVOLUTE:
            ux, uy, uz = cross(origin_b[i, 0], origin_b[i, 1], origin_b[i, 2], zx, zy, zz)
            store_row(screw_b, i, ux, uy, uz, zx, zy, zz)
        else:
            store_row(screw_b, i, zx, zy, zz, 0.0, 0.0, 0.0)


@njit(cache=True)
def store_row(rows: Array, i: int, a: float, b: float, c: float, d: float, e: float, f: float) -> None:
    """Write row i of an (n, 6) array; a view of the row would cost reference counting."""
    rows[i, 0] = a
    rows[i, 1] = b
    rows[i, 2] = c
    rows[i, 3] = d
    rows[i, 4] = e
    rows[i, 5] = f


@njit(cache=True)
def project_row(rows: Array, i: int, a: float, b: float, c: float, d: float, e: float, f: float) -> float:
    """Return the product of row i of an (n, 6) array with six numbers: a joint's share of a wrench."""
    return rows[i, 0] * a + rows[i, 1] * b + rows[i, 2] * c + rows[i, 3] * d + rows[i, 4] * e + rows[i, 5] * f


@njit(cache=True)
def _gather_bodies(
    mass: Array,
    cog: Array,
    inertia: Array,
    first: Ints,
    rows: Array,
    handover: float,
    q: Array,
    body: Array,
    slide: Array,
) -> None:
    """Fill bodies (n, 9) and slides (n, 10) of all links with their segments; see `ChainWork`."""
    for i in range(mass.shape[0]):
        for k in range(3):
            body[i, k] = cog[i, k]
            body[i, 3 + k] = inertia[i, 0, k]
        body[i, 6], body[i, 7], body[i, 8] = inertia[i, 1, 1], inertia[i, 1, 2], inertia[i, 2, 2]
        if first[i + 1] > first[i]:
            gather_segments(rows, first[i], first[i + 1], handover, q[i], mass[i], i, body, slide)


@njit(cache=True)
def slide_moment(slide: Array, r: Array, origin: Array, i: int, first: int) -> tuple[float, float, float]:
    """Return a sum over segments of link i, weight times place, in base axes from the base origin.

    ``first`` is the column of ``slide`` (n, 10) that holds the sum of the weights; three for the places follow.
    r (n + 1, 3, 3) and origin (n + 1, 3) are the frames of `ChainWork`: whole, it would cost reference counting.
    """
    s = slide[i, first]
    x, y, z = slide[i, first + 1], slide[i, first + 2], slide[i, first + 3]
    return (
        s * origin[i, 0] + r[i, 0, 0] * x + r[i, 0, 1] * y + r[i, 0, 2] * z,
        s * origin[i, 1] + r[i, 1, 0] * x + r[i, 1, 1] * y + r[i, 1, 2] * z,
        s * origin[i, 2] + r[i, 2, 0] * x + r[i, 2, 1] * y + r[i, 2, 2] * z,
    )


@njit(cache=True)
def _turn_inertia(rotation: Array, body: Array, out: Array, i: int) -> None:
    """Write R J R^T of link i as xx, xy, xz, yy, yz, zz; J is in body[i, 3:9]."""
    jxx, jxy, jxz = body[i, 3], body[i, 4], body[i, 5]
    jyy, jyz, jzz = body[i, 6], body[i, 7], body[i, 8]
    ax, ay, az = rotation[i, 0, 0], rotation[i, 0, 1], rotation[i, 0, 2]
    bx, by, bz = rotation[i, 1, 0], rotation[i, 1, 1], rotation[i, 1, 2]
    cx, cy, cz = rotation[i, 2, 0], rotation[i, 2, 1], rotation[i, 2, 2]
    px = jxx * ax + jxy * ay + jxz * az
    py = jxy * ax + jyy * ay + jyz * az
    pz = jxz * ax + jyz * ay + jzz * az
    qx = jxx * bx + jxy * by + jxz * bz
    qy = jxy * bx + jyy * by + jyz * bz
    qz = jxz * bx + jyz * by + jzz * bz
    rx = jxx * cx + jxy * cy + jxz * cz
    ry = jxy * cx + jyy * cy + jyz * cz
    rz = jxz * cx + jyz * cy + jzz * cz
    xx = px * ax + py * ay + pz * az
    xy = px * bx + py * by + pz * bz
    xz = px * cx + py * cy + pz * cz
    yy = qx * bx + qy * by + qz * bz
    yz = qx * cx + qy * cy + qz * cz
    store_row(out, i, xx, xy, xz, yy, yz, rx * cx + ry * cy + rz * cz)
