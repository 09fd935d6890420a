"""The state at t = 0: ship, crane and load at rest in static equilibrium.

Every subsystem computes it by itself from the scenario, so no value has to be exchanged first.
"""

from dataclasses import dataclass

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import tip_state
from shipcrane_twin.physics.crane_inertia import composite_inertia
from shipcrane_twin.physics.frames import (
    level_axes,
    matrix_from_quat,
    quat_from_euler,
    rotate_to_world,
    yaw_from_heading,
)
from shipcrane_twin.physics.hull import restoring_load
from shipcrane_twin.physics.vessel import VesselParams


@dataclass(frozen=True, slots=True)
class Rest:
    """Everything at rest.

    Attributes
    ----------
    params : VesselParams
        The ship with its ballast.
    vessel : float64, shape (13,)
        State of the ship, see `physics.vessel`.
    joints : float64, shape (n,)
        Crane joints [rad, m].
    tip_b, tip_w : float64, shape (3,)
        Crane tip in crane_base and in the world [m].
    inertia : float64, shape (10,)
        The crane as one rigid body, in crane_base.
    wire_force_w : float64, shape (3,)
        Force of the wire on the tip [N, world].
    """

    params: VesselParams
    vessel: Array
    joints: Array
    tip_b: Array
    tip_w: Array
    inertia: Array
    wire_force_w: Array


def at_rest(scenario: Scenario) -> Rest:
    """Return the equilibrium that a run starts from; heave, roll and pitch are solved, the rest is given."""
    params = build.vessel_params(scenario)
    chain = build.crane_chain(scenario.crane)
    joints = np.array(scenario.crane.initial_joints)
    tip_b = tip_state(chain, joints, np.zeros_like(joints))[0]
    inertia = composite_inertia(chain, joints)
    force_w = np.array([0.0, 0.0, -build.tip_weight(scenario)])
    start = scenario.vessel.initial
    yaw = yaw_from_heading(start.heading_deg)
    if scenario.vessel.ballast.mode == "level":
        upright = np.array([params.hull.design_height, 0.0, 0.0])
        ballast = -unbalanced(params, inertia, tip_b, force_w, upright, yaw)
        params = params._replace(hull=params.hull._replace(ballast=ballast))
    height, roll, pitch = equilibrium(params, inertia, tip_b, force_w, yaw)

    vessel = np.zeros(13)
    vessel[:3] = start.east_m, start.north_m, height
    vessel[3:7] = quat_from_euler(roll, pitch, yaw)
    rot = matrix_from_quat(vessel[3:7])
    tip_w = vessel[:3] + rotate_to_world(rot, params.crane_base + tip_b - params.cog)
    return Rest(params, vessel, joints, tip_b, tip_w, inertia, force_w)


def equilibrium(
    params: VesselParams, inertia: Array, tip_b: Array, force_w: Array, yaw: float
) -> tuple[float, float, float]:
    """Return height of the CoG [m], roll and pitch [rad, FLU] at which weights and buoyancy balance.

    Newton's method with the hull's own stiffness as Jacobian; weights are small beside it, so every
    round gains about two digits.

    Raises
    ------
    ValueError
        If it does not converge: the crane is too heavy for this ship.
    """
    c = params.hull.restoring
    stiffness = np.array([[c[2, 2], 0.0, c[2, 4]], [0.0, c[3, 3], 0.0], [c[4, 2], 0.0, c[4, 4]]])
    place = np.array([params.hull.design_height, 0.0, 0.0])
    for _ in range(60):
        rest = unbalanced(params, inertia, tip_b, force_w, place, yaw)
        change = np.linalg.solve(stiffness, rest)
        place = place + change
        if abs(place[1]) > 0.7 or abs(place[2]) > 0.7:
            break
        if np.abs(change).max() < 1e-15:
            return float(place[0]), float(place[1]), float(place[2])
    raise ValueError(
        "the ship finds no equilibrium below 40 degrees of heel: crane and load are too heavy for it; "
        "lighten them or move the crane base inboard"
    )


def unbalanced(
    params: VesselParams, inertia: Array, tip_b: Array, force_w: Array, place: Array, yaw: float
) -> Array:
    """Return what is left of vertical force and of the moments about level axes ahead and to port (3,)."""
    height, roll, pitch = place
    rot = matrix_from_quat(quat_from_euler(roll, pitch, yaw))
    up, about_ahead, about_port = restoring_load(params.hull, height, roll, pitch)
    level = level_axes(rot)
    arm = params.crane_base - params.cog
    crane_at, tip_at = level @ (arm + inertia[1:4]), level @ (arm + tip_b)
    crane_down, pull = inertia[0] * params.gravity, force_w[2]
    return np.array(
        [
            up - crane_down + pull,
            about_ahead - crane_at[1] * crane_down + tip_at[1] * pull,
            about_port + crane_at[0] * crane_down - tip_at[0] * pull,
        ]
    )
