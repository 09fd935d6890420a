"""The wire between crane tip and load: tension only, elastic, damped."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

STEP_MIN = 1e-4
"""Shortest micro step that a wire is given [s]; see `resolved_stiffness`."""

TAUT, SLACK, RISING = 0.0, 1.0, 2.0
"""What the wire is doing, as `note_tension` sees it: after a slack spell the tension rises to its first peak."""

PHASE, PEAK, SNAPS, SNAP_MAX, SNAP_LAST = range(5)
"""Columns of the record of snaps: what the wire does, peak so far, how many, largest and latest tension [N]."""


@njit(cache=True)
def wire_stiffness(elastic_modulus: float, diameter: float, fill_factor: float, length: float) -> float:
    """Return the axial stiffness ``E A / L`` [N/m] of a stranded wire; ``A = fill_factor pi D^2 / 4``."""
    return elastic_modulus * fill_factor * 0.25 * np.pi * diameter * diameter / length


@njit(cache=True)
def resolved_stiffness(stiffness: float, mass: float, phase_max: float) -> float:
    """Return the stiffness [N/m], no more than what micro steps of `STEP_MIN` resolve with this mass [kg].

    Notes
    -----
    The cap is ``m (phase_max / STEP_MIN)^2``: with a phase of 0.25 rad the axial mode stays below 2500 rad/s
    (400 Hz). A hanging mass stretches the wire by at most ``g (STEP_MIN / phase_max)^2``, 1.6 micrometres more
    than with the true stiffness, whatever the mass. It acts only on light loads on short wire: below 2.6 kg at
    1 m and below 13 kg at 0.2 m of a 20 mm wire; there a snap is weaker than that of the bare wire.
    """
    rate = phase_max / STEP_MIN
    return min(stiffness, mass * rate * rate)


@njit(cache=True)
def note_tension(record: Array, tension: float) -> None:
    """Bring the record of snaps (5,) up to date; a snap is the first peak of tension [N] after a slack spell."""
    if tension <= 0.0:
        if record[PHASE] == RISING:
            count_snap(record)
        record[PHASE] = SLACK
        record[PEAK] = 0.0
    elif record[PHASE] != TAUT:
        if tension >= record[PEAK]:
            record[PHASE] = RISING
            record[PEAK] = tension
        else:
            count_snap(record)
            record[PHASE] = TAUT


@njit(cache=True)
def count_snap(record: Array) -> None:
    """Add the peak so far to the record of snaps (5,)."""
    record[SNAPS] += 1.0
    record[SNAP_LAST] = record[PEAK]
    record[SNAP_MAX] = max(record[SNAP_MAX], record[PEAK])


@njit(cache=True)
def wire_loss(stiffness: float, mass: float, damping_ratio: float, weight: float) -> float:
    """Return the loss factor [s/m] that gives the hanging mass the damping ratio about its equilibrium.

    At the static stretch, weight over stiffness, the damping of `pull` equals ``2 zeta sqrt(k m)``.
    """
    return 2.0 * damping_ratio * np.sqrt(stiffness * mass) / weight


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
