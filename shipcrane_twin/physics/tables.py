"""Coefficients tabulated over a direction."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def table_place(table: Array, angle: float) -> tuple[int, float]:
    """Return the row before a direction and the share of the way to the next row.

    Parameters
    ----------
    table : float64, shape (n, m)
        Direction from 0 to pi [rad] in equal steps in the first column.
    angle : float
        Direction in [-pi, pi] [rad]; its sign does not count.
    """
    place = abs(angle) / np.pi * (table.shape[0] - 1)
    row = min(int(place), table.shape[0] - 2)
    return row, place - row


@njit(cache=True)
def by_direction(table: Array, angle: float) -> Array:
    """Return the coefficients (m - 1,) at a direction, linear between the rows; see `table_place`."""
    row, part = table_place(table, angle)
    return (1.0 - part) * table[row, 1:] + part * table[row + 1, 1:]
