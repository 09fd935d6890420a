"""Where azimuth thrusters may point, and how they get there.

An arc is (start, width) [rad], anticlockwise. Arcs are what forbidden zones leave; pieces cut each arc into convex
cones of at most 180 degrees (two that overlap make up an arc wider than that). A whole circle is one of each.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle

TURN = 2.0 * np.pi
EDGE = 1e-9
"""Angle by which an azimuth at the edge of an arc may lie outside of it [rad]."""

Zones = Sequence[Sequence[tuple[float, float]]]


def allowed_arcs(zones: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the arcs that zones (centre, half width) [rad] leave of the circle.

    Raises
    ------
    ValueError
        If zones overlap, or a half width is not between 0 and 180 degrees.
    """
    ordered = sorted(((centre - half) % TURN, 2.0 * half) for centre, half in zones)
    if any(not 0.0 < width < TURN for _, width in ordered):
        raise ValueError(f"forbidden zones {list(zones)}: a half width must lie between 0 and pi rad")
    arcs = []
    for k, (start, width) in enumerate(ordered):
        following = ordered[k + 1][0] if k + 1 < len(ordered) else ordered[0][0] + TURN
        if start + width > following:
            raise ValueError(f"forbidden zones {list(zones)} overlap: make them one zone")
        if start + width < following:
            arcs.append(((start + width) % TURN, following - start - width))
    return arcs if ordered else [(0.0, TURN)]


def convex_pieces(arcs: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return cones of at most 180 degrees that together are the arcs; a whole circle stays as it is."""
    pieces = []
    for start, width in arcs:
        if width <= np.pi or width >= TURN:
            pieces.append((start, width))
        else:
            pieces += [(start, np.pi), (start + width - np.pi, np.pi)]
    return pieces


def padded(lists: Sequence[Sequence[tuple[float, float]]]) -> Array:
    """Return the lists as one array (n, longest, 2), filled up with widths of -1."""
    out = np.full((len(lists), max(len(row) for row in lists), 2), -1.0)
    for i, row in enumerate(lists):
        out[i, : len(row)] = row
    return out


@njit(cache=True)
def arc_place(arcs: Array, azimuth: float) -> tuple[int, float]:
    """Return the arc (of arcs (k, 2)) that holds an azimuth, and how far along it; -1 if it is in a forbidden zone."""
    for k in range(arcs.shape[0]):
        start, width = arcs[k, 0], arcs[k, 1]
        if width < 0.0:
            break
        along = (azimuth - start) % TURN
        if along <= width:
            return k, along
        if along <= width + EDGE:
            return k, width
        if along >= TURN - EDGE:
            return k, 0.0
    return -1, 0.0


@njit(cache=True)
def turn_towards(arcs: Array, present: float, goal: float, latch: float) -> tuple[float, float, float, float]:
    """Return how an azimuth turns to its goal.

    Parameters
    ----------
    arcs : float64, shape (k, 2)
    present, goal : float
        [rad].
    latch : float
        Sign of a turn of more than 90 degrees that is under way, else 0: it goes on, though the other way has
        become shorter, so that a goal that wavers behind the thruster does not make it dither.

    Returns
    -------
    gap : float
        Turn to the goal [rad]; within an arc that ends it never leads through a forbidden zone.
    latch : float
    low, high : float
        Turns to the ends of the present arc; both 0 in a forbidden zone.
    """
    gap = wrap_angle(goal - present)
    place, along = arc_place(arcs, present)
    if place < 0:
        return gap, 0.0, 0.0, 0.0
    width = arcs[place, 1]
    if width < TURN:
        goal_place, goal_along = arc_place(arcs, goal)
        if goal_place == place:
            gap = goal_along - along
        return gap, 0.0, -along, width - along
    if abs(gap) <= 0.5 * np.pi:
        return gap, 0.0, -np.inf, np.inf
    if latch * gap < 0.0:
        gap += latch * TURN
    return gap, 1.0 if gap > 0.0 else -1.0, -np.inf, np.inf


@njit(cache=True)
def reach(gap: float, step: float) -> tuple[float, float]:
    """Return the turns from, to [rad] over one period, at most ``step`` either way.

    Near the goal every turn that keeps it within reach of the next period; else the fastest turn alone, so that
    the thruster arrives, whatever a detour would be worth now.
    """
    if gap >= 0.0:
        return min(step, gap - step), step
    return -step, max(-step, gap + step)
