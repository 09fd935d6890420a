"""What the actuators are told: commands turned into references that keep speed, acceleration, jerk and ends.

A reference lives in actuator length (the valve lets oil in by the litre), where all limits are constant:
a path of limited speed and acceleration that always can stop before its end or its goal, then a first-order lag of
time constant ``T = 2 accel_max / jerk_max``. The lag's impulse response is positive and of unit area, so what
comes out keeps the path's speed, acceleration, ends and goal without overshoot, and its jerk, the difference of two
accelerations over T, stays below jerk_max.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_cylinders import (
    DriveParams,
    joint_at,
    joints_from_lengths,
    length_and_arm,
)

FLAG_EFFORT = 1  # the drive or its brake was at its greatest force somewhere in the step
FLAG_REFUSED = 2  # the command pushes into an actuator end
FLAG_SPEED = 4  # the command is faster than the actuator
FLAG_COMMAND = 8  # the command is not a finite number and counts as standing still

VELOCITY = 0
POSITION = 1

GOAL_REACHED = 1e-7  # distance to a commanded position that counts as there [m, rad]


class MotionLimits(NamedTuple):
    """What the reference may do, each float64 (n,) in actuator lengths but `drives`; see `make_limits`.

    Attributes
    ----------
    drives : DriveParams
        Actuator geometry and ends.
    low, high : float64, shape (n,)
        Beyond these, nearer to an end than the margin, commands toward that end are refused [m, rad].
    rate_max, accel_max : float64, shape (n,)
        Of the actuator [m/s, rad/s], [m/s2, rad/s2].
    lag : float64, shape (n,)
        Time constant that keeps the jerk [s].
    """

    drives: DriveParams
    low: Array
    high: Array
    rate_max: Array
    accel_max: Array
    lag: Array


def make_limits(
    drives: DriveParams,
    *,
    rate_max: ArrayLike,
    accel_max: ArrayLike,
    jerk_max: ArrayLike,
    end_margin: ArrayLike,
) -> MotionLimits:
    """Check and pack the limits of the reference.

    Parameters
    ----------
    drives : DriveParams
        Actuator geometry and ends.
    rate_max, accel_max, jerk_max : array_like, shape (n,) or scalar
        Of the actuator [m/s, m/s2, m/s3; rad for a motor].
    end_margin : array_like, shape (n,) or scalar
        Distance to an actuator end [m] within which commands toward it are refused.

    Raises
    ------
    ValueError
        If a limit is not positive, or the margins leave no stroke.
    """
    joints = drives.kind.shape[0]

    def each(values: ArrayLike) -> Array:
        return np.array(np.broadcast_to(np.asarray(values, dtype=np.float64), (joints,)))

    rate, accel, jerk, margin = each(rate_max), each(accel_max), each(jerk_max), each(end_margin)
    for name, values in (("rate_max", rate), ("accel_max", accel), ("jerk_max", jerk)):
        if not np.all(values > 0.0):
            raise ValueError(f"crane: {name} is {values.tolist()}, expected every value > 0")
    if not np.all((margin >= 0.0) & (2.0 * margin < drives.length_max - drives.length_min)):
        raise ValueError(
            f"crane: end_margin is {margin.tolist()} m, expected >= 0 and less than half of every stroke"
        )
    return MotionLimits(
        drives=drives,
        low=drives.length_min + margin,
        high=drives.length_max - margin,
        rate_max=rate,
        accel_max=accel,
        lag=2.0 * accel / jerk,
    )


def joint_ends(drives: DriveParams) -> tuple[Array, Array]:
    """Return the joint values (n,) at the shortest and the longest actuator [rad, m]; infinite without ends."""
    return joints_from_lengths(drives, drives.length_min), joints_from_lengths(drives, drives.length_max)


@njit(cache=True)
def advance_path(
    limits: MotionLimits, path: Array, rate: Array, mode: Ints, command: Array, dt: float, wanted: Array, flags: Ints
) -> Array:
    """Return the path's rates (n,) at the end of a step of dt [s].

    Within the step the rate runs linearly from ``rate`` to the result, so the path gains their mean times dt.

    Parameters
    ----------
    limits : MotionLimits
    path, rate : float64, shape (n,)
        Actuator length and speed of the path at the step's start.
    mode : int64, shape (n,)
        VELOCITY: the command is a joint rate [rad/s, m/s]; POSITION: a joint value [rad, m] to go to.
    command : float64, shape (n,)
    dt : float
        Macro step [s].
    wanted : float64, shape (n,)
        Filled: the speed the command asks for, after its checks; 0 once a goal is reached.
    flags : int64, shape (n,)
        FLAG_REFUSED, FLAG_SPEED and FLAG_COMMAND are added.

    Notes
    -----
    Braking at a = accel_max over whole steps needs v^2/(2 a) + v dt/2 up to the end. The rate at the end of the step
    is capped so that this much is left then; once it holds, full braking keeps it, so neither the end nor accel_max
    is ever violated. A goal that the path cannot stop at any more is passed and come back to.
    """
    joints = command.shape[0]
    rates = np.empty(joints)
    for i in range(joints):
        asked, flag = 0.0, FLAG_COMMAND
        if np.isfinite(command[i]):
            if mode[i] == POSITION:
                asked, flag = _speed_to_goal(limits, i, path[i], rate[i], command[i], dt)
            else:
                asked, flag = _speed_asked(limits, i, path[i], command[i])
        flags[i] |= flag
        wanted[i] = asked
        accel, gain = limits.accel_max[i], limits.accel_max[i] * dt
        new = min(max(asked, rate[i] - gain), rate[i] + gain)
        new = min(new, _landing_rate(limits.drives.length_max[i] - path[i], rate[i], accel, dt))
        rates[i] = max(new, -_landing_rate(path[i] - limits.drives.length_min[i], -rate[i], accel, dt))
    return rates


@njit(cache=True)
def _speed_asked(limits: MotionLimits, i: int, path: float, joint_rate: float) -> tuple[float, int]:
    """Return the actuator speed for a commanded joint rate, within speed and end margins, and flags."""
    asked = joint_rate * _arm_at(limits.drives, i, path)
    fastest, flag = limits.rate_max[i], 0
    if abs(asked) > fastest * (1.0 + 1e-9):
        flag = FLAG_SPEED
    asked = min(max(asked, -fastest), fastest)
    if (asked > 0.0 and path >= limits.high[i]) or (asked < 0.0 and path <= limits.low[i]):
        return 0.0, flag | FLAG_REFUSED
    return asked, flag


@njit(cache=True)
def _speed_to_goal(
    limits: MotionLimits, i: int, path: float, rate: float, joint: float, dt: float
) -> tuple[float, int]:
    """Return the actuator speed toward a commanded joint value, from which it can stop there, and flags."""
    goal = _goal(limits.drives, i, joint)
    kept = min(max(goal, limits.low[i]), limits.high[i])
    flag = 0 if kept == goal else FLAG_REFUSED
    ahead, fastest, accel = kept - path, limits.rate_max[i], limits.accel_max[i]
    if ahead > GOAL_REACHED:
        return min(fastest, _landing_rate(ahead, max(rate, 0.0), accel, dt)), flag
    if ahead < -GOAL_REACHED:
        return -min(fastest, _landing_rate(-ahead, max(-rate, 0.0), accel, dt)), flag
    return 0.0, flag


@njit(cache=True)
def _goal(drives: DriveParams, i: int, q: float) -> float:
    """Return the actuator length that a joint value asks for, whatever the value."""
    if q <= joint_at(drives, i, drives.length_min[i]):
        return drives.length_min[i]
    if q >= joint_at(drives, i, drives.length_max[i]):
        return drives.length_max[i]
    return length_and_arm(drives, i, q)[0]


@njit(cache=True)
def _arm_at(drives: DriveParams, i: int, length: float) -> float:
    """Return the effective lever arm at an actuator length, kept between the ends."""
    kept = min(max(length, drives.length_min[i]), drives.length_max[i])
    return length_and_arm(drives, i, joint_at(drives, i, kept))[1]


@njit(cache=True)
def _landing_rate(room: float, rate: float, accel: float, dt: float) -> float:
    """Return the greatest rate toward an end, `room` away, that still lets the path stop before it."""
    free = 2.0 * room - rate * dt
    if free <= 0.0:
        return 0.0
    gain = accel * dt
    return np.sqrt(gain * gain + accel * free) - gain


@njit(cache=True)
def follow_path(behind: float, rate: float, accel: float, lag: float, t: float, decay: float) -> float:
    """Return how far the reference is behind the path a time t later; its speed is that over the lag.

    Parameters
    ----------
    behind : float
        Now [m, rad].
    rate, accel : float
        Of the path, now.
    lag, t, decay : float
        Time constant [s], time [s], and exp(-t / lag).

    Notes
    -----
    ``b' = v + a t - b / T`` solved exactly: ``b = T (v + a t) - a T^2 + (b0 - T v + a T^2) exp(-t / T)``.
    """
    return lag * (rate + accel * (t - lag)) + (behind - lag * (rate - accel * lag)) * decay
