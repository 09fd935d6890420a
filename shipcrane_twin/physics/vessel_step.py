"""One macro step of the ship with thrusters, weather and the crane's feedback, in a single kernel call.

Memory, float64 (33 + 4 n + r,): state of the rigid body (13, see `physics.vessel`), rates of the body velocities
at the end of the last step (6), mean load of the carried body over the last step (6), weather load at its end (6),
yaw of the level axes and its rate (2), azimuth and shaft speed of n thrusters (n, 2), their thrust (n,) and power
(n,), memory of the water (r, see `physics.radiation`).
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross, euler_from_matrix, matrix_from_quat, rotate_to_body
from shipcrane_twin.physics.propeller import PropulsionParams
from shipcrane_twin.physics.propulsion import Faults, propulsion_step
from shipcrane_twin.physics.radiation import radiation_count
from shipcrane_twin.physics.slow_pose import follow_angle
from shipcrane_twin.physics.vessel import (
    VesselParams,
    carried_inertia,
    carried_mean,
    point_motion,
    state_rate,
    vessel_step,
)

STATE, RATES, CARRIED, WEATHER = slice(0, 13), slice(13, 19), slice(19, 25), slice(25, 31)
HEADING, THRUST = slice(31, 33), 33

MICRO_STEP_MAX_S = 0.05
"""Longest Runge-Kutta step [s]: with poles of the water's memory below 15 rad/s its error is far below 1e-3."""


@njit(cache=True)
def micro_steps(step_s: float) -> int:
    """Return into how many Runge-Kutta steps a macro step is cut."""
    return int(np.ceil(step_s / MICRO_STEP_MAX_S - 1e-9))


@njit(cache=True)
def vessel_at_rest(params: VesselParams, state: Array, attached: Array, thrusters: int) -> Array:
    """Return the memory of a ship at rest in ``state`` (13,) that carries a body (10,); no weather yet."""
    memory = np.zeros(THRUST + 4 * thrusters + radiation_count(params.radiation))
    memory[STATE] = state
    memory[HEADING][0] = euler_from_matrix(matrix_from_quat(state[3:7]))[2]
    memory[CARRIED] = carried_mean(params, attached, state, memory[RATES], state, memory[RATES])
    return memory


@njit(cache=True)
def vessel_macro_step(
    params: VesselParams,
    thrusters: PropulsionParams,
    memory: Array,
    command: Array,
    fault: Faults,
    share: Array,
    weather_h: Array,
    crane_wrench: Array,
    attached: Array,
    water_w: Array,
    step_s: float,
) -> Array:
    """Return the memory one macro step later.

    Parameters
    ----------
    params, thrusters : VesselParams, PropulsionParams
    memory : float64, shape (33 + 4 n + r,)
    command : float64, shape (n, 2)
        Azimuth [rad] and shaft speed [rev/s] asked for.
    fault, share : int64, float64, shape (n,)
        See `propulsion_step`.
    weather_h : float64, shape (6,)
        Wave and wind load about the CoG at the end of the step, level axes [N, N m]; over the step it runs
        linearly from the last one.
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
    count = command.shape[0]
    force_at, power_at, water_at = THRUST + 2 * count, THRUST + 3 * count, THRUST + 4 * count
    before = memory[THRUST:force_at].reshape((count, 2))
    relative = memory[7:10] - rotate_to_body(matrix_from_quat(memory[3:7]), water_w)
    through_water = np.array([relative[0], relative[1], memory[12]])
    driven = propulsion_step(thrusters, before, command, through_water, fault, share, step_s)
    crane = crane_wrench - memory[CARRIED]
    steady_b = driven.load_b + crane
    steady_b[3:] += cross(params.crane_base - params.cog, crane[:3])

    state = np.concatenate((memory[STATE], memory[water_at:]))
    steps = micro_steps(step_s)
    change = (weather_h - memory[WEATHER]) / steps
    weather_to = memory[WEATHER]
    mass6 = carried_inertia(params, attached)
    micro_s = step_s / steps
    axis, turning = memory[HEADING]
    for _ in range(steps):
        yaw = euler_from_matrix(matrix_from_quat(state[3:7]))[2]
        axis, turning = follow_angle(params.follow, axis, turning, yaw)
        middle = axis + 0.5 * micro_s * turning
        heading = (np.cos(middle), np.sin(middle), turning)
        weather_from, weather_to = weather_to, weather_to + change
        state = vessel_step(
            params, mass6, state, steady_b, weather_from, weather_to, water_w, attached, heading, micro_s
        )
    heading = (np.cos(axis), np.sin(axis), turning)
    rates = state_rate(params, mass6, state, steady_b, weather_h, water_w, attached, heading)[7:13]
    new[STATE] = state[:13]
    new[RATES] = rates
    new[CARRIED] = carried_mean(params, attached, memory[STATE], memory[RATES], state, rates)
    new[WEATHER] = weather_h
    new[HEADING] = axis, turning
    new[THRUST:force_at] = driven.state.ravel()
    new[force_at:power_at] = driven.thrust
    new[power_at:water_at] = driven.power
    new[water_at:] = state[13:]
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
