"""Dynamic positioning: reference, PID in body axes with anti-windup, thrust allocation.

Horizontal vectors are (forward, port, yaw) in body axes or (east, north, yaw) in the world.
State, float64 (9,): reference pose (3) and its rate (3) in the world, integrated error (3) in the world.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle


class DpParams(NamedTuple):
    """Constants of the controller; every array has shape (3,) unless noted.

    Attributes
    ----------
    stiffness, damping, integral : float64
        PID gains [N/m, N/m, N m/rad], [.. s], [.. 1/s].
    load_max : float64
        Largest load that the controller asks for [N, N, N m].
    rate_max, accel_max : float64
        Limits of the reference (surge and sway share the first) [m/s, m/s, rad/s], per second.
    allocation : float64, shape (2 n, 3)
        Pseudo-inverse from load to thrust components, rows (forward, port) per thruster.
    period : float
        Time between two updates [s].
    """

    stiffness: Array
    damping: Array
    integral: Array
    load_max: Array
    rate_max: Array
    accel_max: Array
    allocation: Array
    period: float


def pid_gains(inertia: Array, natural_period: Array, damping_ratio: Array) -> tuple[Array, Array, Array]:
    """Return stiffness, damping and integral gains (3,) that give each axis the wanted closed loop.

    ``K = M w^2``, ``D = 2 zeta w M``, ``I = K w / 10`` (Fossen 2011, algorithm 12.1), w = 2 pi / period.

    Parameters
    ----------
    inertia : float64, shape (3,)
        Mass with added mass in surge and sway [kg], inertia with added inertia in yaw [kg m2].
    natural_period, damping_ratio : float64, shape (3,)
        [s], dimensionless.
    """
    omega = 2.0 * np.pi / natural_period
    stiffness = inertia * omega**2
    return stiffness, 2.0 * damping_ratio * omega * inertia, stiffness * omega / 10.0


def allocation_matrix(position: Array, azimuthing: Array) -> Array:
    """Return the least-squares allocation (2 n, 3) from (surge, sway, yaw) load to thrust components.

    Parameters
    ----------
    position : float64, shape (n, 3)
        Thrusters seen from the CoG [m].
    azimuthing : float64, shape (n,)
        0 marks tunnel thrusters: their forward component stays zero.
    """
    count = position.shape[0]
    effect = np.zeros((3, 2 * count))
    effect[0, 0::2] = azimuthing
    effect[1, 1::2] = 1.0
    effect[2, 0::2] = -position[:, 1] * azimuthing
    effect[2, 1::2] = position[:, 0]
    return np.linalg.pinv(effect)


@njit(cache=True)
def dp_start(pose: Array) -> Array:
    """Return the state (9,) for a switch-on at the present pose (east, north, yaw): no bump."""
    state = np.zeros(9)
    state[:3] = pose
    return state


@njit(cache=True)
def move_reference(params: DpParams, state: Array, setpoint: Array) -> Array:
    """Return the state with the reference one period further on its limited way to the set-point (3,)."""
    new = state.copy()
    dt = params.period
    for i in range(3):
        rest = setpoint[i] - state[i]
        if i == 2:
            rest = wrap_angle(rest)
        accel = params.accel_max[i]
        # the speed from which the reference can still stop at the set-point, counting this period
        half = 0.5 * accel * dt
        wanted = np.sqrt(half * half + 2.0 * accel * abs(rest)) - half
        wanted = min(wanted, params.rate_max[i], abs(rest) / dt)
        wanted = wanted if rest >= 0.0 else -wanted
        rate = min(max(wanted, state[3 + i] - accel * dt), state[3 + i] + accel * dt)
        new[3 + i] = rate
        new[i] = state[i] + rate * dt
    return new


@njit(cache=True)
def dp_update(
    params: DpParams, state: Array, pose: Array, velocity_b: Array, setpoint: Array
) -> tuple[Array, Array, Array]:
    """Run the controller once.

    Parameters
    ----------
    params : DpParams
    state : float64, shape (9,)
    pose : float64, shape (3,)
        East, north [m] and yaw [rad] of the ship.
    velocity_b : float64, shape (3,)
        Surge, sway (port) [m/s] and yaw rate [rad/s].
    setpoint : float64, shape (3,)
        Wanted pose.

    Returns
    -------
    state : float64, shape (9,)
    load_b : float64, shape (3,)
        Limited load asked of the thrusters [N, N, N m].
    command : float64, shape (n, 2)
        Thrust components [N], before the thrusters' own limits.

    Notes
    -----
    Anti-windup: an axis whose demand is limited stops integrating while its error would push on.
    """
    new = move_reference(params, state, setpoint)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    error_w = new[:3] - pose
    error_w[2] = wrap_angle(error_w[2])
    integral_w = state[6:9] + error_w * params.period

    load = np.empty(3)
    error_b = to_body(error_w, cos, sin)
    rate_b = to_body(new[3:6], cos, sin)
    integral_b = to_body(integral_w, cos, sin)
    held_b = to_body(state[6:9], cos, sin)
    for i in range(3):
        base = params.stiffness[i] * error_b[i] + params.damping[i] * (rate_b[i] - velocity_b[i])
        demand = base + params.integral[i] * integral_b[i]
        limit = params.load_max[i]
        if abs(demand) > limit and demand * error_b[i] > 0.0:
            integral_b[i] = held_b[i]
            demand = base + params.integral[i] * held_b[i]
        load[i] = min(limit, max(-limit, demand))
    new[6] = cos * integral_b[0] - sin * integral_b[1]
    new[7] = sin * integral_b[0] + cos * integral_b[1]
    new[8] = integral_b[2]

    count = params.allocation.shape[0] // 2
    command = np.zeros((count, 2))
    for i in range(count):
        for j in range(3):
            command[i, 0] += params.allocation[2 * i, j] * load[j]
            command[i, 1] += params.allocation[2 * i + 1, j] * load[j]
    return new, load, command


@njit(cache=True)
def to_body(vec_w: Array, cos: float, sin: float) -> Array:
    """Return (east, north, yaw) turned into (forward, port, yaw) at a yaw with this cosine and sine."""
    return np.array([cos * vec_w[0] + sin * vec_w[1], -sin * vec_w[0] + cos * vec_w[1], vec_w[2]])
