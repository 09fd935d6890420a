"""What the joints are told: velocity commands turned into references that keep speed, ramps and ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_cylinders import DriveParams, joint_rates_per_length, joints_from_lengths

FLAG_EFFORT = 1  # the servo asked for more than effort_max somewhere in the step
FLAG_REFUSED = 2  # the command pushes into an actuator end
FLAG_SPEED = 4  # the command is faster than the actuator


class MotionLimits(NamedTuple):
    """What the reference may do, each float64 (n,) but `drives`; see `make_limits`.

    Attributes
    ----------
    drives : DriveParams
        Actuator geometry.
    q_min, q_max : float64, shape (n,)
        Joint values at the actuator ends [rad or m].
    q_low, q_high : float64, shape (n,)
        Beyond these, nearer to an end than the margin, commands toward that end are refused.
    length_rate_max : float64, shape (n,)
        Actuator speed [m/s; rad/s for a slew motor].
    accel_max : float64, shape (n,)
        Acceleration of the reference [rad/s2 or m/s2].
    sag : float64, shape (n,)
        Reference minus joint value at rest at the start; ends are judged at q_ref - sag.
    """

    drives: DriveParams
    q_min: Array
    q_max: Array
    q_low: Array
    q_high: Array
    length_rate_max: Array
    accel_max: Array
    sag: Array


def make_limits(
    drives: DriveParams,
    *,
    length_rate_max: ArrayLike,
    accel_max: ArrayLike,
    end_margin: ArrayLike,
    sag: ArrayLike | None = None,
) -> MotionLimits:
    """Check and pack the limits of the reference.

    Parameters
    ----------
    drives : DriveParams
        Actuator geometry and ends.
    length_rate_max, accel_max : array_like, shape (n,) or scalar
        Actuator speed [m/s, rad/s] and joint acceleration [rad/s2, m/s2].
    end_margin : array_like, shape (n,) or scalar
        Distance to an actuator end, in actuator length [m], within which commands toward it are refused.
    sag : array_like, shape (n,), optional
        `static_reference` minus the start pose; none by default.

    Raises
    ------
    ValueError
        If a limit is not positive, or the margins leave no stroke.
    """
    joints = drives.kind.shape[0]
    rate = np.array(np.broadcast_to(np.asarray(length_rate_max, dtype=np.float64), (joints,)))
    accel = np.array(np.broadcast_to(np.asarray(accel_max, dtype=np.float64), (joints,)))
    margin = np.broadcast_to(np.asarray(end_margin, dtype=np.float64), (joints,))
    for name, values in (("length_rate_max", rate), ("accel_max", accel)):
        if not np.all(values > 0.0):
            raise ValueError(f"crane: {name} is {values.tolist()}, expected every value > 0")
    if not np.all((margin >= 0.0) & (2.0 * margin < drives.length_max - drives.length_min)):
        raise ValueError(
            f"crane: end_margin is {margin.tolist()} m, expected >= 0 and less than half of every stroke"
        )
    return MotionLimits(
        drives=drives,
        q_min=joints_from_lengths(drives, drives.length_min),
        q_max=joints_from_lengths(drives, drives.length_max),
        q_low=joints_from_lengths(drives, drives.length_min + margin),
        q_high=joints_from_lengths(drives, drives.length_max - margin),
        length_rate_max=rate,
        accel_max=accel,
        sag=np.zeros(joints) if sag is None else np.array(sag, dtype=np.float64),
    )


@njit(cache=True)
def advance_reference(
    limits: MotionLimits, q_ref: Array, qd_ref: Array, command: Array, dt: float
) -> tuple[Array, Ints]:
    """Return the reference rates (n,) at the end of a step of dt [s], and flags (n,).

    Within the step the rate runs linearly from qd_ref to the result, so q_ref gains their mean times dt.

    Parameters
    ----------
    limits : MotionLimits
        Speeds, accelerations and ends.
    q_ref, qd_ref : float64, shape (n,)
        Reference at the start of the step.
    command : float64, shape (n,)
        Wanted joint rates [rad/s or m/s].
    dt : float
        Macro step [s].

    Notes
    -----
    Braking at a = accel_max over whole steps needs v^2/(2 a) + v dt/2 up to the end. The rate at the end of
    the step is capped so that this much is left then; once it holds, full braking keeps it, so neither the
    end nor accel_max is ever violated. The speed limit follows from the actuator's at the present pose.
    """
    joints = command.shape[0]
    rates = np.empty(joints)
    flags = np.zeros(joints, dtype=np.int64)
    place = q_ref - limits.sag
    per_length = joint_rates_per_length(limits.drives, place)
    for i in range(joints):
        wanted = command[i]
        if (wanted > 0.0 and place[i] >= limits.q_high[i]) or (wanted < 0.0 and place[i] <= limits.q_low[i]):
            wanted = 0.0
            flags[i] |= FLAG_REFUSED
        fastest = limits.length_rate_max[i] * per_length[i]
        if abs(wanted) > fastest:
            wanted = min(max(wanted, -fastest), fastest)
            flags[i] |= FLAG_SPEED
        gain = limits.accel_max[i] * dt
        rate = min(max(wanted, qd_ref[i] - gain), qd_ref[i] + gain)
        rate = min(rate, _landing_rate(limits.q_max[i] - place[i], qd_ref[i], limits.accel_max[i], dt))
        rates[i] = max(rate, -_landing_rate(place[i] - limits.q_min[i], -qd_ref[i], limits.accel_max[i], dt))
    return rates, flags


@njit(cache=True)
def _landing_rate(room: float, rate: float, accel: float, dt: float) -> float:
    """Return the greatest rate toward an end, `room` away, that still lets the reference stop before it."""
    free = 2.0 * room - rate * dt
    if free <= 0.0:
        return 0.0
    gain = accel * dt
    return np.sqrt(gain * gain + accel * free) - gain
