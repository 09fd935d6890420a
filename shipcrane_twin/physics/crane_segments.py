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
    """Trailing segments of all links, those of link i in rows first[i] to first[i + 1] - 1.

    Attributes
    ----------
    first : int64, shape (n + 1,)
    rows : float64, shape (k, 5)
        Mass [kg], extension of the telescope at which the segment stops [m], and centre of gravity x, y, z in the
        link's frame at zero extension [m].
    handover : float
        Stroke over which a segment stops and the next starts [m].
    """

    first: Ints
    rows: Array
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
    stops = [np.cumsum([segment.stroke for segment in segments.get(link, ())]) for link in range(joints)]
    packed = [
        (segment.mass, stop, *np.asarray(segment.cog, dtype=np.float64))
        for (_, segment), stop in zip(rows, np.concatenate(stops), strict=True)
    ]
    return SegmentParams(
        first=np.array([0, *np.cumsum([len(stop) for stop in stops])], dtype=np.int64),
        rows=np.array(packed, dtype=np.float64).reshape(len(rows), 5),
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
    rows: Array, begin: int, end: int, handover: float, q: float, mass: float, i: int, body: Array, slide: Array
) -> None:
    """Add to link i its segments at the extension q [m], all in the link's frame.

    Parameters
    ----------
    rows, begin, end, handover
        Of `SegmentParams`.
    q : float
    mass : float
        Of the link with its segments [kg].
    i : int
    body : float64, shape (n, 9)
        Row i: centre of gravity (3) [m] of the link alone, and xx, xy, xz, yy, yz, zz of link and segments, each
        about its own centre [kg m2]; becomes the common centre and the inertia about it.
    slide : float64, shape (n, 10)
        Row i is filled: sums over the segments of m r and m r (x, y, z), of m s'' and m s'' (x, y, z), of m r^2, and
        of m r s'', with r = ds/dq - 1.
    """
    for k in range(10):
        slide[i, k] = 0.0
    own = mass
    for k in range(begin, end):
        own -= rows[k, 0]
    x, y, z = body[i, 0], body[i, 1], body[i, 2]
    hx, hy, hz = own * x, own * y, own * z
    xx, xy, xz = own * x * x, own * x * y, own * x * z
    yy, yz, zz = own * y * y, own * y * z, own * z * z
    for k in range(begin, end):
        m = rows[k, 0]
        at, rate, bend = segment_slide(rows[k, 1], handover, q)
        x, y, z = rows[k, 2], rows[k, 3], rows[k, 4] + at - q
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
    body[i, 0], body[i, 1], body[i, 2] = x, y, z
    xx, xy, xz = xx - hx * x, xy - hx * y, xz - hx * z
    yy, yz, zz = yy - hy * y, yz - hy * z, zz - hz * z
    body[i, 3] += yy + zz
    body[i, 4] -= xy
    body[i, 5] -= xz
    body[i, 6] += xx + zz
    body[i, 7] -= yz
    body[i, 8] += xx + yy
