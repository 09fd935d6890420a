"""The ship of the scenarios and variants of it, for tests."""

import numpy as np
from palfinger import inertia_tensor

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.hydro.rao import natural_periods
from shipcrane_twin.physics.frames import matrix_from_quat, quat_from_euler
from shipcrane_twin.physics.radiation import radiation_count
from shipcrane_twin.physics.vessel import VesselParams, carried_inertia, state_rate, vessel_step

SCENARIO = load_scenario("case2")
SHIP = vessel_params(SCENARIO)
DATA = hydro_database(SCENARIO)
DATA_PERIODS = natural_periods(DATA, SHIP.rigid_mass)
STILL_WATER = np.zeros(3)
NO_LOAD = np.zeros(6)
NOTHING_ATTACHED = np.zeros(10)


def ideal_ship(added_mass, restoring) -> VesselParams:
    """The ship in a fluid without friction."""
    hull = SHIP.hull._replace(
        added_mass=added_mass,
        restoring=restoring,
        damping=np.zeros((6, 6)),
        roll_quadratic=0.0,
        strips=np.zeros((1, 2)),
        current_scale=np.zeros(3),
    )
    return SHIP._replace(hull=hull, radiation=SHIP.radiation._replace(c=np.zeros_like(SHIP.radiation.c)))


def state_at(place=(0.0, 0.0, 0.0), euler=(0.0, 0.0, 0.0), nu=(0.0,) * 6, ship=SHIP):
    """State with the CoG `place` away from where it floats at rest."""
    position = np.array([0.0, 0.0, ship.hull.design_height]) + place
    return np.concatenate((position, quat_from_euler(*euler), nu, np.zeros(radiation_count(ship.radiation))))


def heading_of(state):
    """Yaw and its rate."""
    rot = matrix_from_quat(state[3:7])
    rate = (state[11] * rot[2, 1] + state[12] * rot[2, 2]) / (rot[2, 1] ** 2 + rot[2, 2] ** 2)
    return np.arctan2(rot[1, 0], rot[0, 0]), rate


def axes_along(yaw, rate):
    """Level axes at a yaw, as the kernels take them."""
    return np.cos(yaw), np.sin(yaw), rate


def rate_of(ship, state, load_b, water_w, attached):
    """Rate of the state with the inertia that belongs to the attached body, level axes along the momentary heading."""
    mass6 = carried_inertia(ship, attached)
    return state_rate(ship, mass6, state, load_b, NO_LOAD, water_w, attached, axes_along(*heading_of(state)))


def held_step(ship, state, load_b, water_w, attached, step_s, heading=None):
    """One step under a constant load; level axes along the momentary heading if none is given."""
    if heading is None:
        yaw, rate = heading_of(state)
        heading = yaw + 0.5 * step_s * rate, rate
    mass6 = carried_inertia(ship, attached)
    axes = axes_along(*heading)
    return vessel_step(ship, mass6, state, load_b, NO_LOAD, NO_LOAD, water_w, attached, axes, step_s)


def alone(add, *args):
    """What a kernel adds to a load of nothing."""
    load = np.zeros(6)
    add(load, *args)
    return load


def body_of_points(masses, points):
    """Mass, CoM and inertia about it (10,), of point masses seen from one point."""
    mass = masses.sum()
    com = masses @ points / mass
    arms = points - com
    tensor = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
    row = tensor[np.triu_indices(3)]
    np.testing.assert_array_equal(inertia_tensor(row), tensor)
    return np.concatenate(([mass], com, row))


def skew(r):
    """Matrix of the cross product r x."""
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])
