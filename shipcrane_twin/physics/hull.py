"""Loads of the water on the hull: restoring, added mass, viscous damping and current.

With the memory of `physics.radiation` this is the unified model of Fossen (2005): one set of equations for
manoeuvring and seakeeping. All matrices are about the ship's CoG in FLU axes.
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
def restoring_load(hull: HullParams, height: float, roll: float, pitch: float) -> tuple[float, float, float, float]:
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
    float, four times
        Vertical force [N, world up] and moment about the CoG [N m, body axes].

    Notes
    -----
    Gradient of ``V = (C33 z^2 + 2 C35 z pitch + C44 roll^2 + C55 pitch^2) / 2`` less the work of the ballast:
    linear in the Euler angles, conservative at any attitude. The moment has no component about the
    world's vertical.
    """
    rise = height - hull.design_height
    c = hull.restoring
    force_up = hull.ballast[0] - c[2, 2] * rise - c[2, 4] * pitch
    roll_load = hull.ballast[1] - c[3, 3] * roll
    pitch_load = hull.ballast[2] - c[4, 2] * rise - c[4, 4] * pitch
    sr, cr, tp = np.sin(roll), np.cos(roll), np.tan(pitch)
    return force_up, roll_load, cr * pitch_load + sr * tp * roll_load, -sr * pitch_load + cr * tp * roll_load


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
def add_viscous_load(load: Array, hull: HullParams, nu_rel_b: Array) -> None:
    """Add to a load (6,) about the CoG the viscous one for the velocity (6,) relative to the water, body axes."""
    for i in range(6):
        for j in range(6):
            load[i] -= hull.damping[i, j] * nu_rel_b[j]
    surge, sway, yaw = current_load(hull, -nu_rel_b[0], -nu_rel_b[1])
    turn_force, turn_moment = turning_drag(hull, nu_rel_b[1], nu_rel_b[5])
    load[0] += surge
    load[1] += sway + turn_force
    load[3] -= hull.roll_quadratic * nu_rel_b[3] * abs(nu_rel_b[3])
    load[5] += yaw + turn_moment


@njit(cache=True)
def add_added_mass_bias(load: Array, hull: HullParams, nu_rel_b: Array, water_b: Array) -> None:
    """Add to a load (6,) the velocity-dependent one that stands beside ``added_mass @ nu_dot``.

    Parameters
    ----------
    load : float64, shape (6,)
        About the CoG, body axes; changed in place.
    hull : HullParams
    nu_rel_b : float64, shape (6,)
        Velocity relative to the water, body axes.
    water_b : float64, shape (3,)
        Velocity of the water, constant in the world, body axes [m/s].

    Notes
    -----
    Kirchhoff's equations (Fossen 2011, section 6.3.1) without the Munk term ``v x p``, which the
    current coefficients contain. Water that is steady in the world turns in body axes, so the
    relative acceleration is ``nu_dot + omega x water_b``.
    """
    added = hull.added_mass
    p, q, r = nu_rel_b[3], nu_rel_b[4], nu_rel_b[5]
    turn_x = q * water_b[2] - r * water_b[1]
    turn_y = r * water_b[0] - p * water_b[2]
    turn_z = p * water_b[1] - q * water_b[0]
    for i in range(6):
        load[i] -= added[i, 0] * turn_x + added[i, 1] * turn_y + added[i, 2] * turn_z
    for part in (0, 3):
        x, y, z = row_dot(added, part, nu_rel_b), row_dot(added, part + 1, nu_rel_b), row_dot(added, part + 2, nu_rel_b)
        load[part] -= q * z - r * y
        load[part + 1] -= r * x - p * z
        load[part + 2] -= p * y - q * x
