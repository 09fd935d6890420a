"""Anti-sway on slew and boom: the operator's joint rates shaped, and the sway that is there damped.

Joints are slew and boom, in this order; directions at the tip are along the slewing circle and outward.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body, rotate_to_world

LEVER_MIN_M = 1.0
"""Radius or height below which a joint hardly moves the tip and is no longer asked to."""


class AntiSwayParams(NamedTuple):
    """Constants of the controller; see `make_anti_sway`.

    Attributes
    ----------
    damping_ratio : float
        That the feedback gives the pendulum, and that the shaper counts on.
    share : float
        By which the mean sway moves to the present one in a period.
    tip_speed_max : float
        Of the feedback at the tip [m/s].
    rate_max : float64, shape (2,)
        Of slew and boom [rad/s].
    length_min, length_max : float
        Of the pendulum [m].
    gravity, period : float
        [m/s2]; between two calls [s].
    crane_base : float64, shape (3,)
        In base_link [m].
    pivot_height : float
        Of the boom's pivot above crane_base [m].
    boom_sign : float
        1 if a positive boom rate lifts the tip, -1 if it lowers it.
    """

    damping_ratio: float
    share: float
    tip_speed_max: float
    rate_max: Array
    length_min: float
    length_max: float
    gravity: float
    period: float
    crane_base: Array
    pivot_height: float
    boom_sign: float


class AntiSwayState(NamedTuple):
    """What the controller remembers.

    Attributes
    ----------
    history : float64, shape (n, 2)
        Angles that the operator has asked for so far, one row per period, the newest at row `head` [rad].
    head : int
    shaped : float64, shape (2,)
        Angles that the shaper has given out so far [rad].
    mean : float64, shape (2,)
        Slow part of the load's offset from the tip, along the circle and outward [m].
    """

    history: Array
    head: int
    shaped: Array
    mean: Array


def make_anti_sway(
    *,
    damping_ratio: float,
    mean_time_s: float,
    tip_speed_max: float,
    rate_max: Array,
    length_min: float,
    length_max: float,
    gravity: float,
    period: float,
    crane_base: Array,
    pivot_height: float,
    boom_sign: float,
) -> AntiSwayParams:
    """Return the constants; the sway's mean is taken over `mean_time_s` [s], the rest as in `AntiSwayParams`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """
    if not (0.0 <= damping_ratio < 1.0 and mean_time_s > period > 0.0 and 0.0 < length_min <= length_max):
        raise ValueError(
            f"anti-sway: damping ratio {damping_ratio} must be from 0 to below 1, mean time {mean_time_s} s above the "
            f"step of {period} s, which is > 0, and lengths {length_min} to {length_max} m positive and in order"
        )
    if half_period(length_min, gravity, damping_ratio) < period:
        raise ValueError(f"anti-sway: a wire of {length_min} m swings too fast for a step of {period} s")
    return AntiSwayParams(
        damping_ratio,
        -np.expm1(-period / mean_time_s),
        tip_speed_max,
        rate_max,
        length_min,
        length_max,
        gravity,
        period,
        crane_base,
        pivot_height,
        boom_sign,
    )


def anti_sway_start(params: AntiSwayParams) -> AntiSwayState:
    """Return the state before the first command."""
    rows = int(half_period(params.length_max, params.gravity, params.damping_ratio) / params.period) + 3
    return AntiSwayState(np.zeros((rows, 2)), 0, np.zeros(2), np.zeros(2))


@njit(cache=True)
def half_period(length: float, gravity: float, damping_ratio: float) -> float:
    """Return half the period [s] of a damped pendulum, small angles."""
    return np.pi / np.sqrt(gravity / length * (1.0 - damping_ratio * damping_ratio))


@njit(cache=True)
def sway_offset(params: AntiSwayParams, odom: Array, tip_w: Array, load_w: Array) -> tuple[Array, Array]:
    """Return the load's level offset from the tip and how fast unit joint rates move the tip there.

    Parameters
    ----------
    params : AntiSwayParams
    odom : float64, shape (13,)
        Ship, as in `physics.crane_base`.
    tip_w, load_w : float64, shape (3,)
        World [m].

    Returns
    -------
    offset : float64, shape (2,)
        Along the slewing circle (anticlockwise) and outward [m]. Level in the world: a wire that hangs
        still on a heeled ship has no offset.
    lever : float64, shape (2,)
        Tip speed along the circle by slew, outward by boom [m/rad].
    """
    rot = matrix_from_quat(odom[3:7])
    arm_w = tip_w - odom[:3] - rotate_to_world(rot, params.crane_base)
    radius = np.sqrt(arm_w[0] * arm_w[0] + arm_w[1] * arm_w[1])
    offset, lever = np.zeros(2), np.zeros(2)
    if radius == 0.0:
        return offset, lever
    east, north = arm_w[0] / radius, arm_w[1] / radius
    x, y = load_w[0] - tip_w[0], load_w[1] - tip_w[1]
    offset[0] = north * -x + east * y
    offset[1] = east * x + north * y
    lever[0] = radius
    lever[1] = -params.boom_sign * (rotate_to_body(rot, arm_w)[2] - params.pivot_height)
    return offset, lever


@njit(cache=True)
def anti_sway_step(
    params: AntiSwayParams, state: AntiSwayState, wanted: Array, length: float, offset: Array, lever: Array
) -> tuple[AntiSwayState, Array]:
    """Return the state one period later and the rates (2,) of slew and boom [rad/s] for this period.

    Parameters
    ----------
    params : AntiSwayParams
    state : AntiSwayState
    wanted : float64, shape (2,)
        The operator's rates of slew and boom for this period [rad/s].
    length : float
        From tip to load [m].
    offset, lever : float64, shape (2,)
        See `sway_offset`.

    Notes
    -----
    Feedback: a tip that follows the load's offset s with ``v = 2 zeta omega s`` turns the pendulum
    ``s'' + omega^2 s = -v'`` into ``s'' + 2 zeta omega s' + omega^2 s = 0``; from rest to rest it adds no
    travel. A steady offset (wind on the load) is taken off as the slow mean.

    Shaping (ZV shaper, Singer and Seering 1990), for the pendulum so damped: a share ``1 / (1 + K)`` of every
    command at once and ``K / (1 + K)`` half a damped period later, ``K = exp(-zeta pi / sqrt(1 - zeta^2))``. It is
    the angles that are shaped, and their difference that is given out, so that the crane arrives where the
    operator sent it although the delay follows the hoisting length.
    """
    length = min(params.length_max, max(params.length_min, length))
    zeta = params.damping_ratio
    omega = np.sqrt(params.gravity / length)
    delay = half_period(length, params.gravity, zeta)
    late = np.exp(-omega * zeta * delay)
    late = late / (1.0 + late)

    rows = state.history.shape[0]
    head = (state.head + 1) % rows
    history = state.history.copy()
    back = delay / params.period
    whole = int(back)
    part = back - whole
    mean = state.mean + params.share * (offset - state.mean)
    shaped, rates = np.empty(2), np.empty(2)
    for i in range(2):
        most = params.rate_max[i]
        history[head, i] = history[state.head, i] + params.period * min(most, max(-most, wanted[i]))
        before = (1.0 - part) * history[(head - whole) % rows, i] + part * history[(head - whole - 1) % rows, i]
        target = (1.0 - late) * history[head, i] + late * before
        rate = min(most, max(-most, (target - state.shaped[i]) / params.period))
        shaped[i] = state.shaped[i] + params.period * rate
        follow = 2.0 * zeta * omega * (offset[i] - mean[i])
        follow = min(params.tip_speed_max, max(-params.tip_speed_max, follow))
        rate += follow * lever[i] / max(lever[i] * lever[i], LEVER_MIN_M * LEVER_MIN_M)
        rates[i] = min(most, max(-most, rate))
    return AntiSwayState(history, head, shaped, mean), rates
