"""Steady wind loads from coefficient tables."""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.tables import by_direction


class WindParams(NamedTuple):
    """Wind coefficients of the ship.

    Attributes
    ----------
    table : float64, shape (n, 5)
        Direction the wind comes from relative to the bow, 0 to pi [rad], uniform spacing;
        coefficients of surge, sway, roll and yaw as published (FRD).
    scale : float64, shape (4,)
        ``0.5 rho A`` of surge and sway, ``0.5 rho A h`` of roll, ``0.5 rho A L`` of yaw.
    """

    table: Array
    scale: Array


@njit(cache=True)
def wind_load(wind: WindParams, air_x: float, air_y: float) -> Array:
    """Return the wind load (6,) about the ship's CoG [N, N m; FLU body axes].

    Parameters
    ----------
    wind : WindParams
    air_x, air_y : float
        Velocity of the air relative to the ship along forward and port [m/s].

    Notes
    -----
    Blendermann's convention as in the ship's data: 0 is head wind (surge coefficient negative),
    sway, roll and yaw are positive for wind from port, which pushes to starboard.
    """
    angle = np.arctan2(-air_y, -air_x)  # FLU: positive when the wind comes from port
    side = 1.0 if angle >= 0.0 else -1.0
    surge, sway, roll, yaw = wind.scale * by_direction(wind.table, angle) * (air_x * air_x + air_y * air_y)
    return np.array([surge, -side * sway, 0.0, side * roll, 0.0, -side * yaw])
