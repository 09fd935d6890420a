"""Loads of the water on the hull: restoring, added mass, viscous damping and current.

With the memory of `physics.radiation` this is the unified model of Fossen (2005): one set of equations for
manoeuvring and seakeeping. All matrices are about the ship's CoG in level axes (FLU of a ship without roll
and pitch), as seakeeping theory has them.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.linalg import row_dot
from shipcrane_twin.physics.tables import table_place


class HullParams(NamedTuple):
    """Hydrodynamic coefficients of the hull, about the CoG, FLU.

    Attributes
    ----------
    added_mass, damping, restoring : float64, shape (6, 6)
        Infinite-frequency added mass, viscous damping, hydrostatic stiffness; order surge, sway, heave, roll,
        pitch, yaw [kg, kg m, kg m2], [N s/m, ...], [N/m, N, N m/rad].
    roll_quadratic : float
        Roll moment per squared rate [N m s2/rad2].
    strips : float64, shape (n, 2)
        Place forward of the CoG [m] and cross-flow drag per squared sideways speed [N s2/m2] of strips
        along the hull.
    ballast : float64, shape (3,)
        Constant heave force, world up [N], and roll and pitch moments about the CoG [N m].
    current_table : float64, shape (n, 4)
        Direction the water goes to relative to the bow, 0 (from astern) to pi [rad]; coefficients of
        surge, sway and yaw in FRD, uniform spacing.
    current_scale : float64, shape (3,)
        ``0.5 rho A`` of surge and sway, ``0.5 rho A L`` of yaw.
    design_height : float
        Height of the CoG above still water at the design condition [m].
    """

    added_mass: Array
    damping: Array
    restoring: Array
    roll_quadratic: float
    strips: Array
    ballast: Array
    current_table: Array
    current_scale: Array
    design_height: float


@njit(cache=True)
def restoring_load(hull: HullParams, height: float, roll: float, pitch: float) -> tuple[float, float, float]:
    """Return the hydrostatic load: weight and buoyancy of the ship together.

    Parameters
    ----------
    hull : HullParams
    height : float
        Height of the CoG above still water [m].
    roll, pitch : float
        z-y-x Euler angles, FLU [rad].

    Returns
    -------
    float, three times
        Vertical force [N, up], moments about the level axes ahead and to port through the CoG [N m].

    Notes
    -----
    Gradient of ``V = (C33 z^2 + 2 C35 z pitch + C44 roll^2 + C55 pitch^2) / 2`` less the work of the ballast:
    linear in the Euler angles, conservative at any attitude. The moment has no component about the
    world's vertical.
    """
    rise = height - hull.design_height
    c = hull.restoring
    force_up = hull.ballast[0] - c[2, 2] * rise - c[2, 4] * pitch
    about_body_x = hull.ballast[1] - c[3, 3] * roll
    return force_up, about_body_x / np.cos(pitch), hull.ballast[2] - c[4, 2] * rise - c[4, 4] * pitch


@njit(cache=True)
def current_load(hull: HullParams, flow_x: float, flow_y: float) -> tuple[float, float, float]:
    """Return surge force, sway force and yaw moment [N, N, N m; FLU] of steady flow past the hull.

    Parameters
    ----------
    hull : HullParams
    flow_x, flow_y : float
        Velocity of the water relative to the hull along forward and port [m/s].

    Notes
    -----
    Quadratic drag with coefficients by flow direction, port-starboard symmetric. The yaw
    coefficients are fitted to the whole moment, so they hold the Munk moment already.
    """
    angle = np.arctan2(-flow_y, flow_x)  # clockwise from the bow, as the table has it
    to_flu = -1.0 if angle >= 0.0 else 1.0
    table, scale = hull.current_table, hull.current_scale
    row, part = table_place(table, angle)
    square = flow_x * flow_x + flow_y * flow_y
    surge = (1.0 - part) * table[row, 1] + part * table[row + 1, 1]
    sway = (1.0 - part) * table[row, 2] + part * table[row + 1, 2]
    yaw = (1.0 - part) * table[row, 3] + part * table[row + 1, 3]
    return scale[0] * square * surge, to_flu * scale[1] * square * sway, to_flu * scale[2] * square * yaw


@njit(cache=True)
def turning_drag(hull: HullParams, sway: float, yaw_rate: float) -> tuple[float, float]:
    """Return sway force [N] and yaw moment [N m] that cross-flow drag adds when the ship turns, FLU.

    Parameters
    ----------
    hull : HullParams
    sway, yaw_rate : float
        Relative to the water [m/s, rad/s].

    Notes
    -----
    Each strip is dragged by its own sideways speed ``v + x r`` (Faltinsen 1990, section 6; Fossen 2011,
    equation 6.87). What the strips feel in pure sway is taken off, because the current coefficients hold it.
    """
    force = moment = 0.0
    straight = sway * abs(sway)
    for i in range(hull.strips.shape[0]):
        place = hull.strips[i, 0]
        speed = sway + place * yaw_rate
        drag = -hull.strips[i, 1] * (speed * abs(speed) - straight)
        force += drag
        moment += place * drag
    return force, moment


@njit(cache=True)
def add_viscous_load(load: Array, hull: HullParams, relative: Array) -> None:
    """Add to a load (6,) about the CoG the viscous one for the velocity (6,) relative to the water, level axes."""
    for i in range(6):
        load[i] -= row_dot(hull.damping, i, relative)
    surge, sway, yaw = current_load(hull, -relative[0], -relative[1])
    turn_force, turn_moment = turning_drag(hull, relative[1], relative[5])
    load[0] += surge
    load[1] += sway + turn_force
    load[3] -= hull.roll_quadratic * relative[3] * abs(relative[3])
    load[5] += yaw + turn_moment


@njit(cache=True)
def add_added_mass_bias(load: Array, hull: HullParams, nu: Array, relative: Array, yaw_rate: float) -> None:
    """Add to a load (6,) the velocity-dependent one that stands beside ``added_mass @ nu_dot``, level axes.

    Parameters
    ----------
    load : float64, shape (6,)
        About the CoG; changed in place.
    hull : HullParams
    nu, relative : float64, shape (6,)
        Velocity, and that relative to the water, which is steady in the world.
    yaw_rate : float
        Of the level axes [rad/s].

    Notes
    -----
    The load is ``-A d(relative)/dt`` by components, and ``-yaw_rate x`` the momentum on the force (Kirchhoff's
    equations, Fossen 2011, section 6.3.1, for axes that only yaw); ``nu_dot`` is that of the body axes, turned. The
    Munk term ``v x p`` is left out: the current coefficients contain it.
    """
    added = hull.added_mass
    surge = nu[4] * nu[2] - nu[5] * nu[1] + yaw_rate * relative[1]
    sway = nu[5] * nu[0] - nu[3] * nu[2] - yaw_rate * relative[0]
    heave = nu[3] * nu[1] - nu[4] * nu[0]
    roll, pitch = yaw_rate * relative[4], -yaw_rate * relative[3]
    for i in range(6):
        load[i] -= (
            added[i, 0] * surge + added[i, 1] * sway + added[i, 2] * heave + added[i, 3] * roll + added[i, 4] * pitch
        )
    load[0] += yaw_rate * row_dot(added, 1, relative)
    load[1] -= yaw_rate * row_dot(added, 0, relative)
