"""Reference model: set-point steps become smooth motions that the ship can follow.

State, float64 (15,), world axes (east, north, yaw): pose (3) and rate (3) of a motion with limited speed and
acceleration, then pose (3), rate (3) and acceleration (3) of the reference, which is that motion low-passed.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle

LIMITED, LIMITED_RATE = slice(0, 3), slice(3, 6)
POSE, RATE, ACCEL = slice(6, 9), slice(9, 12), slice(12, 15)


class ReferenceParams(NamedTuple):
    """Constants of the reference model.

    Attributes
    ----------
    speed_max : float64, shape (2,)
        Largest horizontal speed [m/s] and turn rate [rad/s].
    accel_max : float64, shape (2,)
        Largest horizontal [m/s2] and angular acceleration [rad/s2].
    smoothing : float
        Time constant of the low-pass that makes the acceleration continuous [s]; the jerk stays below
        ``2 accel_max / smoothing``. 0 leaves it out.
    share_time : float
        1 for a heading that moves in proportion to the position, so that both arrive together; 0 for each at its own
        limits.
    period : float
        Time between two updates [s].
    """

    speed_max: Array
    accel_max: Array
    smoothing: float
    share_time: float
    period: float


@njit(cache=True)
def reference_start(params: ReferenceParams, pose: Array, velocity_w: Array) -> Array:
    """Return the state (15,) that goes on from a pose (3,) with a velocity (3,), world axes: no bump.

    Notes
    -----
    The low-pass runs behind what it follows; the limited motion therefore starts ahead by that lag. Numbers that are
    not finite count as zero.
    """
    state = np.zeros(15)
    lag = params.period / smoothing_share(params) - params.period
    for i in range(3):
        place = pose[i] if np.isfinite(pose[i]) else 0.0
        rate = velocity_w[i] if np.isfinite(velocity_w[i]) else 0.0
        state[i] = place + rate * lag
        state[3 + i] = rate
        state[6 + i] = place
        state[9 + i] = rate
    return state


@njit(cache=True)
def smoothing_share(params: ReferenceParams) -> float:
    """Return the share of the way to its input that the low-pass goes in one period."""
    return 1.0 - np.exp(-params.period / params.smoothing) if params.smoothing > 0.0 else 1.0


@njit(cache=True)
def reference_step(params: ReferenceParams, state: Array, setpoint: Array) -> Array:
    """Return the state (15,) one period later on the way to a set-point (3,): east, north [m], yaw [rad].

    Parameters
    ----------
    params : ReferenceParams
    state : float64, shape (15,)
    setpoint : float64, shape (3,)
        An axis whose set-point is not finite comes to rest.

    Notes
    -----
    The limited motion has the highest speed from which it can still stop at the set-point. From rest it goes straight
    and does not overshoot. The low-pass is first-order: its impulse response is positive and of unit area, so the
    reference keeps the limits of what it follows, and does not overshoot either. East and north share the limits as a
    vector. The yaw turns the shorter way round.
    """
    new = state.copy()
    dt = params.period
    rest = np.zeros(3)
    for i in range(3):
        if np.isfinite(setpoint[i]):
            rest[i] = setpoint[i] - state[i]
    rest[2] = wrap_angle(rest[2])
    distance = np.sqrt(rest[0] ** 2 + rest[1] ** 2), abs(rest[2])
    for block in range(2):
        speed, accel = params.speed_max[block], params.accel_max[block]
        speed_share, accel_share = 1.0, 1.0
        if params.share_time > 0.0 and distance[block] > 0.0:
            # of all that is left, the slower of the two sets the pace; the other scales its limits down
            other = 1 - block
            ratio = distance[block] / max(distance[other], 1e-12)
            speed_share = min(1.0, ratio * params.speed_max[other] / speed)
            accel_share = min(1.0, ratio * params.accel_max[other] / accel)
        wanted = stopping_speed(accel_share * accel, distance[block], dt)
        wanted = min(wanted, speed_share * speed)
        first, count = (0, 2) if block == 0 else (2, 1)
        steer(new, rest, distance[block], wanted, accel, accel_share * accel, first, count, dt)
    share = smoothing_share(params)
    for i in range(3):
        new[i] = state[i] + new[3 + i] * dt
        behind = new[i] - state[6 + i]
        rate = share * behind / dt
        new[6 + i] = state[6 + i] + rate * dt
        new[9 + i] = rate
        new[12 + i] = (rate - state[9 + i]) / dt
    # both yaws by the same turn, which keeps their difference
    turns = wrap_angle(new[8]) - new[8]
    new[2] += turns
    new[8] += turns
    return new


@njit(cache=True)
def stopping_speed(accel: float, distance: float, dt: float) -> float:
    """Return the highest speed from which a motion in steps `dt` can still stop within a distance, this step counted.

    Notes
    -----
    Braking by ``a dt`` per step takes ``v^2 / (2 a) + v dt / 2``; the last step ends at the goal.
    """
    half = 0.5 * accel * dt
    return min(np.sqrt(half * half + 2.0 * accel * distance) - half, distance / dt)


@njit(cache=True)
def steer(
    new: Array,
    rest: Array,
    distance: float,
    wanted: float,
    brake: float,
    accel: float,
    first: int,
    count: int,
    dt: float,
) -> None:
    """Bring the rates of axes ``first`` to ``first + count - 1`` towards the wanted speed along the rest, in place.

    Parameters
    ----------
    new : float64, shape (15,)
        Its limited rates are changed.
    rest : float64, shape (3,)
        What is left to the set-point.
    distance, wanted : float
        Length of these axes' rest, speed along it.
    brake, accel : float
        Largest change of the rate per second; the second holds while it gains speed.
    first, count : int
    dt : float
    """
    goal = np.zeros(3)
    change_square = rate_square = 0.0
    for i in range(first, first + count):
        goal[i] = wanted * rest[i] / distance if distance > 0.0 else 0.0
        change_square += (goal[i] - new[3 + i]) ** 2
        rate_square += new[3 + i] ** 2
    change = np.sqrt(change_square)
    limit = (accel if wanted * wanted > rate_square else brake) * dt
    share = min(1.0, limit / change) if change > 0.0 else 0.0
    for i in range(first, first + count):
        new[3 + i] += share * (goal[i] - new[3 + i])
