"""Active heave compensation: the winch pays out as the ship lifts the crane's tip, so that the load stays.

The tip's heave is that of the ship alone, from motion reference unit and lever arm: what the operator does
with the crane's joints passes untouched. State, float64 (3,): value and rate of the low-pass that the
high-pass takes away, and the last command [m/s].
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.control.wave_frequency import BUTTERWORTH, resonator_step
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross, matrix_from_quat, rotate_to_body, rotate_to_world


class HeaveCompensationParams(NamedTuple):
    """Constants of the compensator; see `make_heave_compensation`.

    Attributes
    ----------
    corner : float
        Of the high-pass [rad/s].
    lead : float
        Time from a measurement to its effect: the step until the command is reached, and the winch's lag [s].
    speed_max, accel_max : float
        Of the command [m/s], [m/s2].
    period : float
        Between two calls [s].
    """

    corner: float
    lead: float
    speed_max: float
    accel_max: float
    period: float


def make_heave_compensation(
    corner_period_s: float, winch_lag_s: float, speed_max: float, accel_max: float, period: float
) -> HeaveCompensationParams:
    """Return the constants for a high-pass of this period [s] and a winch with this first-order lag [s].

    Raises
    ------
    ValueError
        If a value is out of range.
    """
    if not (corner_period_s > 2.0 * np.pi * period > 0.0 and winch_lag_s >= 0.0):
        raise ValueError(
            f"heave compensation: corner period {corner_period_s} s must be well above the step of {period} s, which "
            f"is > 0, and winch lag {winch_lag_s} s at least 0"
        )
    if not (speed_max > 0.0 and accel_max > 0.0):
        raise ValueError(f"heave compensation: limits {speed_max} m/s and {accel_max} m/s2 must be > 0")
    return HeaveCompensationParams(
        2.0 * np.pi / corner_period_s, period + winch_lag_s, speed_max, accel_max, period
    )


@njit(cache=True)
def carried_heave(odom: Array, accel: Array, point_w: Array) -> tuple[float, float]:
    """Return the upward velocity [m/s] and acceleration [m/s2] that the ship gives to a point it carries.

    Parameters
    ----------
    odom : float64, shape (13,)
        Ship: position of base_link, quaternion, velocity of its origin and angular velocity in its axes.
    accel : float64, shape (6,)
        Acceleration of the origin (no gravity) and angular acceleration, base_link axes.
    point_w : float64, shape (3,)
        The point, world [m].

    Notes
    -----
    ``v = v_0 + w x r`` and ``a = a_0 + alpha x r + w x (w x r)``, as if the point were fixed to the ship.
    """
    rot = matrix_from_quat(odom[3:7])
    arm_b = rotate_to_body(rot, point_w - odom[:3])
    omega, alpha = odom[10:13], accel[3:6]
    turning = cross(omega, arm_b)
    velocity_b = odom[7:10] + turning
    accel_b = accel[:3] + cross(alpha, arm_b) + cross(omega, turning)
    return rotate_to_world(rot, velocity_b)[2], rotate_to_world(rot, accel_b)[2]


@njit(cache=True)
def heave_compensation_step(
    params: HeaveCompensationParams, state: Array, velocity_up: float, accel_up: float, active: bool
) -> tuple[Array, float]:
    """Return the state (3,) one period later and the pay-out speed [m/s] to add to the operator's.

    Parameters
    ----------
    params : HeaveCompensationParams
    state : float64, shape (3,)
    velocity_up, accel_up : float
        Heave of the tip by the ship, see `carried_heave`. Values that are not finite let the command fade.
    active : bool
        Else the filter runs, and the command goes to zero within the acceleration limit.

    Notes
    -----
    ``v + lead a`` undoes a first-order lag exactly and a delay to first order (Kuechler et al. 2011 predict
    likewise, further). A Butterworth high-pass of second order takes out what is slow: the compensated length
    always returns to the operator's. With r = omega / corner it leaves of a heave the part
    ``|1 + i sqrt(2) r| / |1 - r^2 + i sqrt(2) r|``.
    """
    new = state.copy()
    wanted = 0.0
    predicted = velocity_up + params.lead * accel_up
    if np.isfinite(predicted):
        new[0], new[1] = resonator_step(state[0], state[1], predicted, params.corner, BUTTERWORTH, params.period)
        if active:
            wanted = predicted - new[0] - 2.0 * BUTTERWORTH / params.corner * new[1]
    wanted = min(params.speed_max, max(-params.speed_max, wanted))
    change = params.accel_max * params.period
    new[2] = min(state[2] + change, max(state[2] - change, wanted))
    return new, new[2]
