"""Wind on a box."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def box_wind(
    size: Array,
    centre: Array,
    drag: float,
    rot: Array,
    velocity: Array,
    wind: Array,
    force: Array,
    moment: Array,
) -> None:
    """Add the wind's load on a box, at its middle and along the wind over it.

    Parameters
    ----------
    size, centre : float64, shape (3,)
        Length, breadth, height [m]; middle seen from the CoG, box axes [m].
    drag : float
        ``rho C_D / 2`` times the dry share of the box [kg/m3].
    rot : float64, shape (3, 3)
        Box to world.
    velocity, wind : float64, shape (3,)
        Of the box and of the air, world [m/s].
    force, moment : float64, shape (3,)
        Are added to: load about the CoG, world [N, N m].

    Notes
    -----
    ``rho C_D A u^2 / 2`` with the area A of the box as the wind sees it (DNV-RP-C205 section 5.3).
    """
    ux, uy, uz = wind[0] - velocity[0], wind[1] - velocity[1], wind[2] - velocity[2]
    if np.sqrt(ux * ux + uy * uy + uz * uz) * drag == 0.0:
        return
    seen = 0.0  # area times speed
    for k in range(3):
        along = rot[0, k] * ux + rot[1, k] * uy + rot[2, k] * uz
        seen += abs(along) * size[(k + 1) % 3] * size[(k + 2) % 3]
    push = drag * seen
    ax = rot[0, 0] * centre[0] + rot[0, 1] * centre[1] + rot[0, 2] * centre[2]
    ay = rot[1, 0] * centre[0] + rot[1, 1] * centre[1] + rot[1, 2] * centre[2]
    az = rot[2, 0] * centre[0] + rot[2, 1] * centre[1] + rot[2, 2] * centre[2]
    force[0] += push * ux
    force[1] += push * uy
    force[2] += push * uz
    moment[0] += push * (ay * uz - az * uy)
    moment[1] += push * (az * ux - ax * uz)
    moment[2] += push * (ax * uy - ay * ux)
