"""Water loads on a box on its way through the splash zone: the simplified method of DNV-RP-N103, section 4.

The box is four upright columns of equal area at the Gauss points of its bottom, so that the waterplane has its area and
both of its second moments; each column has its own submerged depth.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

PLATE_ASPECT = np.array([1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.25, 8.0, 10.0])
PLATE_ADDED_MASS = np.array([0.579, 0.642, 0.690, 0.757, 0.801, 0.830, 0.871, 0.897, 0.917, 0.934, 0.947])
"""Longer over shorter side of a rectangular plate, and its added mass across over that of the cylinder of water around
its shorter side (DNV-RP-N103, appendix A, table A-2; 1 for an endless plate)."""

ENTRY_SHARE = 0.01
"""Depth over which slamming and drag come in, so that nothing jumps at the surface, over the height of the box."""


class SplashParams(NamedTuple):
    """Constants of a box in water.

    Attributes
    ----------
    size : float64, shape (3,)
        Length, breadth, height [m].
    centre : float64, shape (3,)
        Middle of the box seen from the CoG, box axes [m].
    displaced : float
        Volume that displaces water over that of the box.
    density, gravity : float
        Of the water [kg/m3]; [m/s2].
    drag, slamming : float
        Coefficients C_D and C_s.
    added_mass : float64, shape (3,)
        Of the submerged box along its axes [kg].
    """

    size: Array
    centre: Array
    displaced: float
    density: float
    gravity: float
    drag: float
    slamming: float
    added_mass: Array


def plate_added_mass(side: float, other_side: float, density: float) -> float:
    """Return the added mass [kg] of a rectangular plate that moves across its plane in endless water."""
    short, long = min(side, other_side), max(side, other_side)
    # beyond the table the share that an endless plate has more falls with the aspect
    aspect = long / short
    share = np.interp(aspect, PLATE_ASPECT, PLATE_ADDED_MASS)
    if aspect > PLATE_ASPECT[-1]:
        share = 1.0 - (1.0 - PLATE_ADDED_MASS[-1]) * PLATE_ASPECT[-1] / aspect
    return float(density * share * 0.25 * np.pi * short * short * long)


def body_added_mass(side: float, other_side: float, depth: float, density: float, perforation: float) -> float:
    """Return the added mass [kg] of a body with flat faces along the direction in which it has a depth [m].

    Parameters
    ----------
    side, other_side : float
        Of the face across the direction [m].
    depth : float
        Of the body along it [m].
    density : float
        [kg/m3].
    perforation : float
        Open share of the face, 0 to 0.5.

    Notes
    -----
    DNV-RP-N103 section 4.6.3: ``(1 + sqrt((1 - l^2) / (2 (1 + l^2)))) A_plate`` with ``l = sqrt(A) / (h + sqrt(A))``,
    and the reduction by perforation p in per cent: none up to 5, ``0.7 + 0.3 cos(pi (p - 5) / 34)`` up to 34, then
    ``exp((10 - p) / 28)``.
    """
    width = np.sqrt(side * other_side)
    part = width / (depth + width)
    solid = (1.0 + np.sqrt((1.0 - part**2) / (2.0 * (1.0 + part**2)))) * plate_added_mass(side, other_side, density)
    percent = 100.0 * perforation
    if percent <= 5.0:
        return float(solid)
    if percent < 34.0:
        return float(solid * (0.7 + 0.3 * np.cos(np.pi * (percent - 5.0) / 34.0)))
    return float(solid * np.exp((10.0 - percent) / 28.0))


@njit(cache=True)
def entered(depth: float, ease: float, rate: float, full: float) -> tuple[float, float]:
    """Return the added mass [kg] of a bottom at a depth [m] below the surface, and its rate over depth [kg/m].

    Parameters
    ----------
    depth : float
        [m].
    ease : float
        Depth over which the rate comes in and goes out [m].
    rate : float
        Rate in between [kg/m].
    full : float
        What it grows to [kg].

    Notes
    -----
    DNV-RP-N103 section 3.2: ``C_s = 2 / (rho A_p) dA33/dh``. A constant coefficient therefore acts until the
    added mass is complete; the rate is a trapezium over the depth whose area is the full added mass.
    """
    if depth <= 0.0:
        return 0.0, 0.0
    flat = full / rate
    ease = min(ease, flat)
    if depth < ease:
        return 0.5 * rate * depth * depth / ease, rate * depth / ease
    if depth < flat:
        return rate * (depth - 0.5 * ease), rate
    left = flat + ease - depth
    if left > 0.0:
        return full - 0.5 * rate * left * left / ease, rate * left / ease
    return full, 0.0


@njit(cache=True)
def column_load(
    box: SplashParams,
    rot: Array,
    upright: float,
    below: float,
    flow: Array,
    water: Array,
    push: Array,
    added_mass: Array,
) -> None:
    """Fill the load (3,) on one of the four columns along the axes of the box [N], and add its added mass (3,) [kg].

    Parameters
    ----------
    box : SplashParams
    rot : float64, shape (3, 3)
        Box to world.
    upright : float
        1, or -1 when the box is upside down.
    below : float
        Depth of the column's lower end, along the column [m].
    flow : float64, shape (3,)
        Velocity of the water relative to the column, world [m/s].
    water : float64, shape (7,)
        See `splash_load`.
    push, added_mass : float64, shape (3,)
    """
    tall = box.size[2]
    area, depth = 0.25 * box.size[0] * box.size[1], min(below, tall)
    half_rho, ease = 0.5 * box.density, ENTRY_SHARE * tall
    mass, rate = entered(below, ease, half_rho * area * box.slamming, 0.25 * box.added_mass[2])
    for i in range(3):
        along = rot[0, i] * flow[0] + rot[1, i] * flow[1] + rot[2, i] * flow[2]
        lifting = rot[0, i] * water[4] + rot[1, i] * water[5] + rot[2, i] * water[6]
        if i == 2:
            face, added = area * min(1.0, below / ease), mass
        else:
            face = 0.25 * box.size[1 - i] * depth
            added = 0.25 * box.added_mass[i] * depth / tall
        push[i] = half_rho * box.drag * face * abs(along) * along
        push[i] += (box.density * box.displaced * area * depth + added) * lifting
        added_mass[i] += added
    if upright * along > 0.0:  # water enters from below
        push[2] += upright * rate * along * along


@njit(cache=True)
def splash_load(
    box: SplashParams,
    place: Array,
    rot: Array,
    velocity: Array,
    turning: Array,
    water: Array,
    force: Array,
    moment: Array,
    added_mass: Array,
) -> float:
    """Add the water's load on a box and return the submerged share of its height.

    Parameters
    ----------
    box : SplashParams
    place, velocity, turning : float64, shape (3,)
        CoG [m], its velocity [m/s], angular velocity [rad/s], world.
    rot : float64, shape (3, 3)
        Box to world.
    water : float64, shape (7,)
        Elevation [m], velocity [m/s] and acceleration [m/s2] of the water at the load, world.
    force, moment : float64, shape (3,)
        Are added to: load about the CoG [N, N m], world. The part with the box's own acceleration is left to
        ``added_mass``.
    added_mass : float64, shape (3,)
        Is filled: along the axes of the box, at this depth [kg].

    Notes
    -----
    Sections of DNV-RP-N103: varying buoyancy ``rho g V`` (4.3.6), mass force ``(rho V + A) a_w`` (4.3.7), slamming
    ``rho C_s A_p w^2 / 2`` while entering (4.3.5), drag ``rho C_D A |w| w / 2`` (4.3.8), with w the velocity of the
    water relative to the box. For a box about upright and small beside the wave length; its
    added moments of inertia are left out.
    """
    added_mass[:] = 0.0
    tall = box.size[2]
    reach = 0.5 * np.sqrt(box.size[0] ** 2 + box.size[1] ** 2 + tall**2) + np.sqrt(
        box.centre[0] ** 2 + box.centre[1] ** 2 + box.centre[2] ** 2
    )
    if place[2] - reach >= water[0]:
        return 0.0
    upright = 1.0 if rot[2, 2] >= 0.0 else -1.0
    slope = max(0.5, abs(rot[2, 2]))
    area = 0.25 * box.size[0] * box.size[1]
    arm, flow, push, load = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    total_share = 0.0
    for column in range(4):
        x = box.centre[0] + (0.5 if column % 2 else -0.5) * box.size[0] / np.sqrt(3.0)
        y = box.centre[1] + (0.5 if column < 2 else -0.5) * box.size[1] / np.sqrt(3.0)
        height = place[2] + rot[2, 0] * x + rot[2, 1] * y + rot[2, 2] * box.centre[2]
        below = (water[0] - height) / slope + 0.5 * tall  # of the column's lower end, along the column
        if below <= 0.0:
            continue
        depth = min(below, tall)
        total_share += 0.25 * depth / tall
        z = box.centre[2] + upright * 0.5 * (depth - tall)
        for i in range(3):
            arm[i] = rot[i, 0] * x + rot[i, 1] * y + rot[i, 2] * z
        flow[0] = water[1] - velocity[0] - (turning[1] * arm[2] - turning[2] * arm[1])
        flow[1] = water[2] - velocity[1] - (turning[2] * arm[0] - turning[0] * arm[2])
        flow[2] = water[3] - velocity[2] - (turning[0] * arm[1] - turning[1] * arm[0])
        column_load(box, rot, upright, below, flow, water, push, added_mass)
        for i in range(3):
            load[i] = rot[i, 0] * push[0] + rot[i, 1] * push[1] + rot[i, 2] * push[2]
        load[2] += box.density * box.gravity * box.displaced * area * depth
        for i in range(3):
            force[i] += load[i]
        moment[0] += arm[1] * load[2] - arm[2] * load[1]
        moment[1] += arm[2] * load[0] - arm[0] * load[2]
        moment[2] += arm[0] * load[1] - arm[1] * load[0]
    return total_share
