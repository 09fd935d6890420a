"""The wire between crane tip and load: tension only, elastic, damped."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def wire_stiffness(elastic_modulus: float, diameter: float, fill_factor: float, length: float) -> float:
    """Return the axial stiffness ``E A / L`` [N/m] of a stranded wire; ``A = fill_factor pi D^2 / 4``."""
    return elastic_modulus * fill_factor * 0.25 * np.pi * diameter * diameter / length


@njit(cache=True)
def wire_loss(stiffness: float, mass: float, damping_ratio: float, gravity: float) -> float:
    """Return the loss factor [s/m] that gives the hanging mass the damping ratio about its equilibrium.

    At the static stretch ``m g / k`` the damping of `pull` equals ``2 zeta sqrt(k m)``.
    """
    return 2.0 * damping_ratio * np.sqrt(stiffness * mass) / (mass * gravity)


@njit(cache=True)
def pull(
    tip: Array,
    load: Array,
    length: float,
    pay_out_rate: float,
    stiffness: float,
    loss: float,
    stretch_static: float,
    force: Array,
) -> float:
    """Fill the wire's force on the load and return the tension; the crane tip feels the opposite force.

    Parameters
    ----------
    tip, load : float64, shape (6,)
        Position [m] and velocity [m/s] of the wire's ends, world.
    length, pay_out_rate : float
        Unstretched length [m] and its rate, positive when paying out [m/s].
    stiffness, loss : float
        [N/m] and loss factor [s/m].
    stretch_static : float
        Stretch up to which the damping grows [m]: that of the hanging load.
    force : float64, shape (3,)
        Is filled: force on the load [N, world]; exactly zero while the wire is slack.

    Returns
    -------
    float
        Tension [N], never negative.

    Notes
    -----
    ``T = k max(0, s + loss min(s, s_static) ds/dt)`` with stretch s: the force is continuous when the
    wire goes taut (Hunt and Crossley 1975) and never pushes. Beyond the static stretch it is a plain
    dashpot, so the damping never outgrows what the micro steps resolve. No sag, no mass.
    """
    x, y, z = tip[0] - load[0], tip[1] - load[1], tip[2] - load[2]
    distance = np.sqrt(x * x + y * y + z * z)
    stretch = distance - length
    if stretch <= 0.0 or distance == 0.0:
        force[:] = 0.0
        return 0.0
    x, y, z = x / distance, y / distance, z / distance
    opening = x * (tip[3] - load[3]) + y * (tip[4] - load[4]) + z * (tip[5] - load[5])
    damped = loss * min(stretch, stretch_static) * (opening - pay_out_rate)
    tension = stiffness * max(0.0, stretch + damped)
    force[0], force[1], force[2] = tension * x, tension * y, tension * z
    return tension
