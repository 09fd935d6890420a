"""A telescope of segments that extend in sequence, the outermost first.

Segment k moves with the tip until its stop, the sum of the strokes of all segments up to it, and stays there
while the others go on: its slide is ``s_k(q) = min(q, stop_k)``, with the corner rounded over the hand-over stroke so
that no velocity jumps and energy is kept. The last segment carries the tip and slides by q itself; it is the
link of the chain. Measured from that link, segment k trails by ``q - s_k`` and moves at the rate
``r_k = ds_k/dq - 1`` per unit rate of the joint. Segments do not turn against each other, so ten sums over them
say all that the dynamics need.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints


class Segment(NamedTuple):
    """A segment, in the frame of its link at zero extension.

    mass [kg], cog (3,) [m], inertia (3, 3) about it [kg m2], and its stroke [m].
    """

    mass: float
    cog: ArrayLike
    inertia: ArrayLike
    stroke: float


class SegmentParams(NamedTuple):
    """Trailing segments of all links, those of link i at first[i] to first[i + 1] - 1.

    Attributes
    ----------
    first : int64, shape (n + 1,)
    mass, stop : float64, shape (k,)
        [kg]; extension of the telescope at which the segment stops [m].
    cog : float64, shape (k, 3)
        In the link's frame at zero extension [m].
    inertia : float64, shape (n, 3, 3)
        Sum over the segments of each link, each about its own centre [kg m2].
    handover : float
        Stroke over which a segment stops and the next starts [m].
    """

    first: Ints
    mass: Array
    stop: Array
    cog: Array
    inertia: Array
    handover: float


def pack_segments(joints: int, segments: Mapping[int, Sequence[Segment]], handover: float) -> SegmentParams:
    """Check and pack the trailing segments of a chain of that many joints.

    Raises
    ------
    ValueError
        If a mass or stroke is not positive, or the hand-over is not positive or longer than a stroke.
    """
    rows = [(link, segment) for link in range(joints) for segment in segments.get(link, ())]
    for link, segment in rows:
        if not segment.mass > 0.0:
            raise ValueError(f"chain: a segment of link {link} has the mass {segment.mass} kg, expected > 0")
        if not 0.0 < handover <= segment.stroke:
            raise ValueError(
                f"chain: handover is {handover} m and a segment of link {link} has a stroke of {segment.stroke} m; "
                "expected a hand-over > 0 and no longer than any stroke"
            )
    inertia = np.zeros((joints, 3, 3))
    for link, segment in rows:
        inertia[link] += np.asarray(segment.inertia, dtype=np.float64)
    stops = [np.cumsum([segment.stroke for segment in segments.get(link, ())]) for link in range(joints)]
    return SegmentParams(
        first=np.array([0, *np.cumsum([len(stop) for stop in stops])], dtype=np.int64),
        mass=np.array([segment.mass for _, segment in rows], dtype=np.float64),
        stop=np.concatenate(stops, dtype=np.float64),
        cog=np.array([segment.cog for _, segment in rows], dtype=np.float64).reshape(len(rows), 3),
        inertia=inertia,
        handover=float(handover),
    )


@njit(cache=True)
def segment_slide(stop: float, handover: float, q: float) -> tuple[float, float, float]:
    """Return slide [m] of a segment with that stop, and its first and second derivative over the extension q [m].

    The first derivative falls from 1 to 0 by the quintic with flat ends, over a hand-over centred on the stop.
    """
    u = (q - stop) / handover + 0.5
    if u <= 0.0:
        return q, 1.0, 0.0
    if u >= 1.0:
        return stop, 0.0, 0.0
    u2 = u * u
    u3 = u2 * u
    slide = stop + handover * (u - 0.5 - u2 * u2 * (2.5 - 3.0 * u + u2))
    return slide, 1.0 - u3 * (10.0 - 15.0 * u + 6.0 * u2), -30.0 * u2 * (1.0 - u) * (1.0 - u) / handover


@njit(cache=True)
def gather_segments(
    segments: SegmentParams, i: int, q: float, mass: float, cog: Array, inertia: Array, body: Array, slide: Array
) -> None:
    """Fill what link i with its segments is at the extension q [m], all in the link's frame.

    Parameters
    ----------
    segments : SegmentParams
    i : int
    q : float
    mass : float
        Of the link with its segments [kg].
    cog, inertia : float64, shapes (n, 3), (n, 3, 3)
        Of the links without their segments.
    body : float64, shape (9,)
        Filled: common centre of gravity (3) [m] and xx, xy, xz, yy, yz, zz about it [kg m2].
    slide : float64, shape (n, 10)
        Row i filled: sums over the segments of m r and m r (x, y, z), of m s'' and m s'' (x, y, z), of m r^2, and of
        m r s'', with r = ds/dq - 1.
    """
    for k in range(10):
        slide[i, k] = 0.0
    own = mass
    for k in range(segments.first[i], segments.first[i + 1]):
        own -= segments.mass[k]
    x, y, z = cog[i, 0], cog[i, 1], cog[i, 2]
    hx, hy, hz = own * x, own * y, own * z
    xx, xy, xz = own * x * x, own * x * y, own * x * z
    yy, yz, zz = own * y * y, own * y * z, own * z * z
    for k in range(segments.first[i], segments.first[i + 1]):
        m = segments.mass[k]
        at, rate, bend = segment_slide(segments.stop[k], segments.handover, q)
        x, y, z = segments.cog[k, 0], segments.cog[k, 1], segments.cog[k, 2] + at - q
        hx, hy, hz = hx + m * x, hy + m * y, hz + m * z
        xx, xy, xz = xx + m * x * x, xy + m * x * y, xz + m * x * z
        yy, yz, zz = yy + m * y * y, yz + m * y * z, zz + m * z * z
        if rate < 1.0:
            r, b = m * (rate - 1.0), m * bend
            slide[i, 0] += r
            slide[i, 1] += r * x
            slide[i, 2] += r * y
            slide[i, 3] += r * z
            slide[i, 4] += b
            slide[i, 5] += b * x
            slide[i, 6] += b * y
            slide[i, 7] += b * z
            slide[i, 8] += r * (rate - 1.0)
            slide[i, 9] += b * (rate - 1.0)
    x, y, z = hx / mass, hy / mass, hz / mass
    body[0], body[1], body[2] = x, y, z
    xx, xy, xz = xx - hx * x, xy - hx * y, xz - hx * z
    yy, yz, zz = yy - hy * y, yz - hy * z, zz - hz * z
    own_j, more_j = inertia[i], segments.inertia[i]
    body[3] = own_j[0, 0] + more_j[0, 0] + yy + zz
    body[4] = own_j[0, 1] + more_j[0, 1] - xy
    body[5] = own_j[0, 2] + more_j[0, 2] - xz
    body[6] = own_j[1, 1] + more_j[1, 1] + xx + zz
    body[7] = own_j[1, 2] + more_j[1, 2] - yz
    body[8] = own_j[2, 2] + more_j[2, 2] + xx + yy
