"""A rigid load under a fixed tip, for tests."""

import numpy as np

from shipcrane_twin.physics.rigid_load import make_rigid
from shipcrane_twin.physics.rigid_step import Surroundings, rigid_step, slung_state
from shipcrane_twin.validation.lifting_splash import SIZE, box_in_water
from shipcrane_twin.validation.lifting_wire import FAST, FIXED, WIRE

G = WIRE.gravity
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])
DRY = np.array([-1e3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
NONE = np.zeros((0, 18))
FLOOR = np.array([[50.0, 50.0, 1.0, 4e6, 0.2, 0.4]])
UNDAMPED = WIRE._replace(damping_ratio=0.0)


def box_load(mass=5000.0, hook=200.0, planes=None, size=SIZE, air=0.0, water=None, centre=(0.0, 0.0, 0.0), **sling):
    half = 0.4 * size[0]
    sling = {"leg_length": 3.0, "leg_stiffness": 2e6} | sling
    return make_rigid(
        hook_mass=hook,
        mass=mass,
        lugs=np.array([[-half, 0.0, 0.5 * size[2]], [half, 0.0, 0.5 * size[2]]]) + np.array(centre),
        splash=box_in_water(size, centre) if water is None else water,
        air_drag=air,
        planes=np.zeros((0, 6)) if planes is None else planes,
        phase_max=WIRE.phase_max,
        **sling,
    )


def plane(place=(0.0, 0.0, 0.0), rot=None, velocity=(0.0, 0.0, 0.0), turning=(0.0, 0.0, 0.0)):
    rot = np.eye(3) if rot is None else rot
    return np.concatenate((place, velocity, rot.ravel(), turning))[None, :]


def around(tip=FIXED, planes=NONE, water=DRY, wind=(0.0, 0.0, 0.0), tip_next=None, planes_next=None, water_next=None):
    return Surroundings(
        tip,
        tip if tip_next is None else tip_next,
        planes,
        planes if planes_next is None else planes_next,
        water,
        water if water_next is None else water_next,
        np.array(wind, float),
    )


def hanging(load, wire=WIRE, length=4.0, quat=LEVEL):
    return slung_state(wire, load, FIXED[:3], length, quat, np.zeros(3), False)


def lying(load, height, wire=WIRE, length=1.0, quat=LEVEL, beside=(0.0, 0.0)):
    """A load without sling at a height of its CoG, below and beside the tip."""
    state = slung_state(wire, load, FIXED[:3], length, quat, np.array([*beside, height]), True)
    state[21] = 0.0
    return state


def run(load, state, step_s, count, wire=WIRE, surroundings=None, hold=FAST):
    """States after each macro step, and force on the tip and tension."""
    there = around() if surroundings is None else surroundings
    states, forces = [state], []
    for k in range(count):
        now = there(k) if callable(there) else there
        state, force, tension = rigid_step(wire, hold, load, states[-1], 0.0, 0.0, now, step_s)
        states.append(state)
        forces.append((*force, tension))
    return np.array(states), np.array(forces)
