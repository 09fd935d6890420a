"""PID controller of dynamic positioning in body axes, with feed-forward of reference, wind and crane.

Horizontal vectors are (forward, port, yaw) in body axes or (east, north, yaw) in the world.
State, float64 (16,): see the slices below.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.control.reference import ACCEL, POSE, RATE
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross, level_axes, wrap_angle

INTEGRAL, WIND, CRANE = slice(0, 3), slice(3, 6), slice(6, 9)
"""Load of the integrator in the world, low-passed wind and crane load in body axes."""

UNLIMITED, DEMAND, ACTIVE = slice(9, 12), slice(12, 15), 15
"""Last demand before and after its limits, body axes; 1 while switched on."""


class ControllerParams(NamedTuple):
    """Constants of the controller; arrays of shape (3,) are for surge, sway, yaw.

    Attributes
    ----------
    inertia : float64, shape (3, 3)
        Ship with added mass [kg, kg m, kg m2], for the reference's acceleration.
    stiffness, damping, integral : float64, shape (3,)
        PID gains [N/m, N/m, N m/rad], [.. s], [.. 1/s].
    load_max : float64, shape (3,)
        Largest load that the controller asks for [N, N, N m].
    wind_share, crane_share : float
        Shares of the wind's and the crane's load that are fed forward, 0 to 1.
    wind_period, crane_period : float
        Cut-off periods of the first-order low-pass on them [s]; 0 for none.
    fade : float
        Time constant with which the load fades after switch-off [s]; 0 for at once.
    period : float
        Time between two updates [s].
    """

    inertia: Array
    stiffness: Array
    damping: Array
    integral: Array
    load_max: Array
    wind_share: float
    wind_period: float
    crane_share: float
    crane_period: float
    fade: float
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

    Raises
    ------
    ValueError
        If one of them is not positive.
    """
    for name, values in (("inertia", inertia), ("natural period", natural_period), ("damping ratio", damping_ratio)):
        if not (np.asarray(values) > 0.0).all():
            raise ValueError(f"PID gains: the {name} is {values}, expected positive numbers for surge, sway and yaw")
    omega = 2.0 * np.pi / natural_period
    stiffness = inertia * omega**2
    return stiffness, 2.0 * damping_ratio * omega * inertia, stiffness * omega / 10.0


@njit(cache=True)
def to_body(vec_w: Array, cos: float, sin: float) -> Array:
    """Return (east, north, yaw) turned into (forward, port, yaw) at a yaw with this cosine and sine."""
    return np.array([cos * vec_w[0] + sin * vec_w[1], -sin * vec_w[0] + cos * vec_w[1], vec_w[2]])


@njit(cache=True)
def to_world(vec_b: Array, cos: float, sin: float) -> Array:
    """Return (forward, port, yaw) turned into (east, north, yaw) at a yaw with this cosine and sine."""
    return to_body(vec_b, cos, -sin)


@njit(cache=True)
def horizontal_load(wrench_b: Array, arm_b: Array, rot: Array) -> Array:
    """Return surge, sway and yaw part (3,) about the CoG of a wrench on the ship, in level axes [N, N, N m].

    Parameters
    ----------
    wrench_b : float64, shape (6,)
        Force and moment at a point of the ship, body axes [N, N m].
    arm_b : float64, shape (3,)
        That point seen from the CoG, body axes [m].
    rot : float64, shape (3, 3)
        Body to world. Level axes leave the weight out of the horizontal load of a heeled ship.
    """
    moment_b = wrench_b[3:] + cross(arm_b, wrench_b[:3])
    level = level_axes(rot)
    out = np.zeros(3)
    for j in range(3):
        out[0] += level[0, j] * wrench_b[j]
        out[1] += level[1, j] * wrench_b[j]
        out[2] += level[2, j] * moment_b[j]
    return out


def controller_start() -> Array:
    """Return the state (16,) of a controller that is off."""
    return np.zeros(16)


@njit(cache=True)
def controller_update(
    params: ControllerParams,
    state: Array,
    on: bool,
    reference: Array,
    pose: Array,
    velocity_b: Array,
    wind_b: Array,
    crane_b: Array,
    achieved_b: Array,
) -> tuple[Array, Array]:
    """Run the controller once; it is called while off as well, so that its filters keep up.

    Parameters
    ----------
    params : ControllerParams
    state : float64, shape (16,)
    on : bool
        Whether the ship is to be held.
    reference : float64, shape (15,)
        See `control.reference`; at switch-on it starts anew at the present pose and velocity.
    pose, velocity_b : float64, shape (3,)
        Estimated pose in the world, velocity in body axes [m, rad, m/s, rad/s].
    wind_b, crane_b : float64, shape (3,)
        Loads of wind and crane on the ship, as measured or estimated, body axes [N, N, N m].
    achieved_b : float64, shape (3,)
        What the allocation could give of the last demand; at switch-on the load in force. Not finite: unknown.

    Returns
    -------
    state : float64, shape (16,)
    demand_b : float64, shape (3,)
        Limited load asked of the thrusters.

    Notes
    -----
    ``tau = M R^T a_ref + K e + D (v_ref - v) + z - s_w w - s_c c``, the integrator's load z held in the world, where a
    steady current stays when the ship turns. Anti-windup by back-calculation: z follows what the thrusters could
    not give with the time constant ``sqrt(Ti Td)`` (Astrom and Hagglund 2006, section 3.5), Ti = K / I, Td = D / K.
    At switch-on z is such that the first demand is the load in force.

    An estimate that is not finite makes no error on its axis (east and north go together), and its integrator
    holds; with an unknown yaw the reference's serves. A measured load that is not finite leaves its filter as it is.
    """
    new = state.copy()
    low_pass(new, 3, wind_b, params.wind_period, params.period)
    low_pass(new, 6, crane_b, params.crane_period, params.period)
    demand = np.zeros(3)
    if not on:
        kept = np.exp(-params.period / params.fade) if params.fade > 0.0 else 0.0
        for i in range(3):
            demand[i] = kept * state[12 + i]
        new[INTEGRAL] = 0.0
        new[UNLIMITED] = demand
        new[DEMAND] = demand
        new[ACTIVE] = 0.0
        return new, demand

    yaw = pose[2] if np.isfinite(pose[2]) else reference[POSE][2]
    cos, sin = np.cos(yaw), np.sin(yaw)
    error_w = reference[POSE] - pose
    error_w[2] = wrap_angle(error_w[2])
    error = to_body(error_w, cos, sin)
    rate = to_body(reference[RATE], cos, sin)
    accel = to_body(reference[ACCEL], cos, sin)
    integral = to_body(state[INTEGRAL], cos, sin)
    starts = state[ACTIVE] == 0.0
    for i in range(3):
        base = -params.wind_share * new[3 + i] - params.crane_share * new[6 + i]
        for j in range(3):
            base += params.inertia[i, j] * accel[j]
        known = np.isfinite(error[i])
        if known:
            base += params.stiffness[i] * error[i]
        if np.isfinite(velocity_b[i]):
            base += params.damping[i] * (rate[i] - velocity_b[i])
        limit = params.load_max[i]
        if starts:
            integral[i] = (achieved_b[i] if np.isfinite(achieved_b[i]) else 0.0) - base
        elif params.integral[i] > 0.0:
            given = achieved_b[i] if np.isfinite(achieved_b[i]) else state[12 + i]
            tracking = np.sqrt(params.damping[i] / params.integral[i])
            integral[i] += params.period / tracking * (given - state[9 + i])
        new[9 + i] = base + integral[i]
        demand[i] = min(limit, max(-limit, new[9 + i]))
        if known:
            integral[i] += params.period * params.integral[i] * error[i]
    new[INTEGRAL] = to_world(integral, cos, sin)
    new[DEMAND] = demand
    new[ACTIVE] = 1.0
    return new, demand


@njit(cache=True)
def low_pass(state: Array, at: int, load: Array, cutoff_period: float, dt: float) -> None:
    """Move three numbers of a state from `at` on towards a load (3,) by a first-order low-pass, in place."""
    share = 1.0 - np.exp(-2.0 * np.pi * dt / cutoff_period) if cutoff_period > 0.0 else 1.0
    for i in range(3):
        if np.isfinite(load[i]):
            state[at + i] += share * (load[i] - state[at + i])
