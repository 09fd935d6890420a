"""A ship that moves in the horizontal plane only, under the DP controller, for tests of its law."""

import numpy as np

from shipcrane_twin.control.controller import (
    ControllerParams,
    controller_start,
    controller_update,
    pid_gains,
    to_body,
    to_world,
)
from shipcrane_twin.control.reference import POSE

MASS = np.diag([5.7e5, 7.0e5, 4.1e7])
DRAG = np.diag([4.0e3, 1.0e4, 1.0e6])
PERIOD_S = 0.1
NATURAL_PERIOD = np.array([70.0, 70.0, 60.0])
DAMPING_RATIO = np.array([0.8, 0.8, 0.8])
LOAD_MAX = np.array([8.0e4, 4.0e4, 6.0e5])
UNKNOWN = np.full(3, np.nan)
STILL = np.zeros(3)


def controller(natural_period=NATURAL_PERIOD, damping_ratio=DAMPING_RATIO, mass=MASS, **changes):
    stiffness, damping, integral = pid_gains(np.diag(mass), natural_period, damping_ratio)
    plain = ControllerParams(
        inertia=mass,
        stiffness=stiffness,
        damping=damping,
        integral=integral,
        load_max=LOAD_MAX,
        wind_share=0.0,
        wind_period=0.0,
        crane_share=0.0,
        crane_period=0.0,
        fade=0.0,
        period=PERIOD_S,
    )
    return plain._replace(**changes)


def held_at(pose):
    """A reference (15,) at rest."""
    state = np.zeros(15)
    state[POSE] = pose
    return state


def move(pose, velocity_b, load_b, dt=PERIOD_S, mass=MASS, drag=DRAG, steps=4):
    """One period of a mass with linear drag, without Coriolis loads."""
    pose, velocity_b = pose.copy(), velocity_b.copy()
    inverse = np.linalg.inv(mass)
    for _ in range(steps):
        velocity_b = velocity_b + dt / steps * inverse @ (load_b - drag @ velocity_b)
        pose = pose + dt / steps * to_world(velocity_b, np.cos(pose[2]), np.sin(pose[2]))
    return pose, velocity_b


def held_ship(params, duration, reference=None, disturbance_w=None, feed=None, limit=None, pose=STILL, drag=DRAG):
    """Poses (n, 3) and demands (n, 3) of a ship under control.

    `reference(k)`, `disturbance_w(t)` and `feed(t)` (wind, crane; body) give what drives it; `limit(demand, state)`
    says which load the thrusters give and which they report.
    """
    state, velocity, pose = controller_start(), np.zeros(3), np.array(pose, float)
    given = np.zeros(3)
    poses, demands = [pose], []
    for k in range(round(duration / PERIOD_S)):
        t = k * PERIOD_S
        goal = held_at(STILL) if reference is None else reference(k)
        wind, crane = (STILL, STILL) if feed is None else feed(t)
        state, demand = controller_update(params, state, True, goal, pose, velocity, wind, crane, given)
        thrust, given = (demand, demand) if limit is None else limit(demand, state)
        load = thrust.copy()
        if disturbance_w is not None:
            load = load + to_body(disturbance_w(t), np.cos(pose[2]), np.sin(pose[2]))
        pose, velocity = move(pose, velocity, load, drag=drag)
        poses.append(pose)
        demands.append(demand)
    return np.array(poses), np.array(demands)
