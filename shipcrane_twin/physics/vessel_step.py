"""One macro step of the ship with thrusters, wind and the crane's feedback, in a single kernel call.

Memory, float64 (25 + 2 n,): state (13, see `physics.vessel`), rates of the body velocities at the end
of the last step (6), mean load of the carried body over the last step (6), thrust of n thrusters (n, 2).
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross
from shipcrane_twin.physics.thrusters import ThrusterParams, thruster_load, thruster_step
from shipcrane_twin.physics.vessel import VesselParams, carried_mean, point_motion, state_rate, vessel_step

STATE, RATES, CARRIED, THRUST = slice(0, 13), slice(13, 19), slice(19, 25), 25


@njit(cache=True)
def vessel_at_rest(params: VesselParams, state: Array, attached: Array, thrusters: int) -> Array:
    """Return the memory of a ship at rest in ``state`` (13,) that carries a body (10,)."""
    memory = np.zeros(THRUST + 2 * thrusters)
    memory[STATE] = state
    memory[CARRIED] = carried_mean(params, attached, state, memory[RATES], state, memory[RATES])
    return memory


@njit(cache=True)
def vessel_macro_step(
    params: VesselParams,
    thrusters: ThrusterParams,
    memory: Array,
    command: Array,
    outer_b: Array,
    crane_wrench: Array,
    attached: Array,
    water_w: Array,
    step_s: float,
) -> Array:
    """Return the memory one macro step later.

    Parameters
    ----------
    params, thrusters : VesselParams, ThrusterParams
    memory : float64, shape (25 + 2 n,)
    command : float64, shape (n, 2)
        Thrust components asked for [N].
    outer_b : float64, shape (6,)
        Wind (and later wave) load about the CoG, body axes [N, N m].
    crane_wrench : float64, shape (6,)
        Mean over the last step of crane and load on the ship at crane_base, weight included.
    attached : float64, shape (10,)
        Rigid body at crane_base that the ship carries in its own equations; zeros for none.
    water_w : float64, shape (3,)
        Current, world [m/s].
    step_s : float
        [s].

    Notes
    -----
    What the carried body gave in the last step is taken out of the crane's wrench, because the ship's
    equations hold it for the present step.
    """
    new = np.empty_like(memory)
    count = thrusters.thrust_max.shape[0]
    thrust, thrust_mean = thruster_step(thrusters, memory[THRUST:].reshape((count, 2)), command, step_s)
    crane = crane_wrench - memory[CARRIED]
    load_b = thruster_load(thrusters, thrust_mean) + outer_b + crane
    load_b[3:] += cross(params.crane_base - params.cog, crane[:3])
    state = vessel_step(params, memory[STATE], load_b, water_w, attached, step_s)
    rates = state_rate(params, state, load_b, water_w, attached)[7:]
    new[STATE] = state
    new[RATES] = rates
    new[CARRIED] = carried_mean(params, attached, memory[STATE], memory[RATES], state, rates)
    new[THRUST:] = thrust.ravel()
    return new


@njit(cache=True)
def vessel_outputs(memory: Array, cog: Array) -> tuple[Array, Array]:
    """Return odometry (13,) and acceleration (6,) of base_link, whose origin lies at ``-cog`` from the CoG.

    Odometry: position in the world, quaternion, velocity of the origin and angular velocity in body axes.
    Acceleration: of the origin without gravity, and angular, body axes.
    """
    state, rates = memory[STATE], memory[RATES]
    pos_w, vel_b, acc_b = point_motion(state, rates, -cog)
    odom, accel = np.empty(13), np.empty(6)
    odom[:3] = pos_w
    odom[3:7] = state[3:7]
    odom[7:10] = vel_b
    odom[10:] = state[10:]
    accel[:3] = acc_b
    accel[3:] = rates[3:]
    return odom, accel
