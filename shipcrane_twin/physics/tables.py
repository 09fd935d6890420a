"""Coefficients tabulated over a direction."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def by_direction(table: Array, angle: float) -> Array:
    """Return the coefficients at a direction, linear between the rows.

    Parameters
    ----------
    table : float64, shape (n, 1 + m)
        Direction from 0 to pi [rad] in equal steps, then m coefficients.
    angle : float
        Direction in [-pi, pi] [rad]; its sign does not count.

    Returns
    -------
    float64, shape (m,)
    """
    place = abs(angle) / np.pi * (table.shape[0] - 1)
    row = min(int(place), table.shape[0] - 2)
    part = place - row
    return (1.0 - part) * table[row, 1:] + part * table[row + 1, 1:]
