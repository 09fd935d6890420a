"""Drives of the joints: cylinders and motors as oil springs with limited force, brakes, and what failures leave.

A drive is a valve that lets oil in and an oil column that carries the load. The reference (see `crane_reference`)
plus a trim is the length that the oil would have without load; the column's stiffness and damping pull the actuator
there, within the force that pressure and areas allow. What is above that force escapes over the relief valve, and
the reference goes along. While a joint moves, its servo trims the oil until the actuator is where the reference is.
While it stands, the brake or load-holding valve is shut: the oil stays, up to the holding force.

All in actuator length: forces [N], lengths [m]; a motor's are torque [N m] and angle [rad].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_cylinders import LINEAR, DriveParams, length_and_arm, lengths_from_joints, triangle
from shipcrane_twin.physics.crane_reference import FLAG_EFFORT, MotionLimits, advance_path, follow_path

POWER_ON = 0
POWER_COAST = 1  # the drives give nothing but friction
POWER_BRAKE = 2  # the brakes shut, moving or not
POWER_LEAK = 3  # load-holding valves are shut but leak

STANDING_RATE = 0.1
"""Actuator speed, over its greatest, below which the brake may shut."""
STANDING_REFERENCE = 1e-3
"""Speed of the reference, over the actuator's greatest, below which the brake may shut."""
STANDING_TRIM = 0.02
"""Speed at which the servo still trims, over the actuator's greatest, below which the brake may shut."""
STOP_SOFT_M = 1e-3
"""Depth in an end stop over which its damping grows [m]."""


class ActuatorParams(NamedTuple):
    """Drives of n joints, each float64 (n,) but the last.

    Attributes
    ----------
    stiffness, damping : float64, shape (n,)
        Of the oil column [N/m, N s/m]; of the end stops as well.
    push, pull : float64, shape (n,)
        Greatest force of the drive that lengthens and shortens the actuator, both >= 0 [N].
    hold_push, hold_pull : float64, shape (n,)
        The same of brake or load-holding valve.
    friction : float64, shape (n,)
        Of the unpowered actuator, its lines open, at its greatest speed; in proportion at others [N].
    leak_push, leak_pull : float64, shape (n,)
        Speed at which a failed load-holding valve yields, per force that it holds [m/(s N)].
    tracking : float
        Rate at which the servo trims the actuator to its reference [1/s].
    """

    stiffness: Array
    damping: Array
    push: Array
    pull: Array
    hold_push: Array
    hold_pull: Array
    friction: Array
    leak_push: Array
    leak_pull: Array
    tracking: float


# Columns of `drives`, float64 (n, 26), one row per drive for the length of a macro step: inner loops read one array.
KIND, SIDE_A, SIDE_B, OFFSET, SHORTEST, LONGEST = 0, 1, 2, 3, 4, 5  # geometry, see crane_cylinders
STIFFNESS, DAMPING, LOW, HIGH = 6, 7, 8, 9  # of the oil; limits of its force now
FRICTION, RATED, LEAK_PUSH, LEAK_PULL = 10, 11, 12, 13
PATH, PATH_RATE, PATH_RATE_END, PATH_ACCEL = 14, 15, 16, 17  # over the macro step
BEHIND, LAG, DECAY = 18, 19, 20  # reference behind path: now, time constant, decay over half a micro step
TRIM, TRIM_RATE, YIELDED = 21, 22, 23
OIL, OIL_RATE = 24, 25  # length of the oil without load, now
COLUMNS = 26


@njit(cache=True)
def joint_stiffness(actuators: ActuatorParams, drives: DriveParams, q: Array) -> tuple[Array, Array]:
    """Return stiffness and damping (n,) of the joints at q (n,) [N m/rad, N/m]: the oil's times arm squared."""
    kp, kd = np.empty(q.shape[0]), np.empty(q.shape[0])
    for i in range(q.shape[0]):
        arm = length_and_arm(drives, i, q[i])[1]
        kp[i] = actuators.stiffness[i] * arm * arm
        kd[i] = actuators.damping[i] * arm * arm
    return kp, kd


@njit(cache=True)
def standing_state(actuators: ActuatorParams, drives: DriveParams, q: Array, effort: Array) -> Array:
    """Return the state (7 n,) of a crane at rest at q (n,), brakes shut, whose oil carries the efforts (n,)."""
    n = q.shape[0]
    state = np.zeros(7 * n)
    state[:n] = q
    state[2 * n : 3 * n] = lengths_from_joints(drives, q)
    for i in range(n):
        state[5 * n + i] = effort[i] / length_and_arm(drives, i, q[i])[1] / actuators.stiffness[i]
        state[6 * n + i] = 1.0
    return state


@njit(cache=True)
def prepare_drives(
    actuators: ActuatorParams,
    limits: MotionLimits,
    parts: Array,
    mode: Ints,
    command: Array,
    power: int,
    half_step: float,
    dt: float,
    flags: Ints,
) -> Array:
    """Decide what each drive does over the macro step; return their rows (n, 26).

    Parameters
    ----------
    actuators, limits : ActuatorParams, MotionLimits
    parts : float64, shape (7, n)
        The crane's state as in `crane_motion`; the row of brakes is changed.
    mode, command : int64 and float64, shape (n,)
        See `crane_reference.advance_path`.
    power : int
        POWER_ON or a failure.
    half_step, dt : float
        Half a micro step, the macro step [s].
    flags : int64, shape (n,)
    """
    n = parts.shape[1]
    rows = np.zeros((n, COLUMNS))
    wanted, rates = np.zeros(n), np.zeros(n)
    if power == POWER_ON:
        rates = advance_path(limits, parts[2], parts[3], mode, command, dt, wanted, flags)
    geometry = limits.drives
    for i in range(n):
        length, arm = length_and_arm(geometry, i, parts[0, i])
        path, rate, behind, trim = parts[2, i], parts[3, i], parts[4, i], parts[5, i]
        fastest, lag = limits.rate_max[i], limits.lag[i]
        at_rest = (
            rate == 0.0
            and abs(behind) < STANDING_REFERENCE * fastest * lag
            and abs(arm * parts[1, i]) < STANDING_RATE * fastest
            and actuators.tracking * abs(path - behind - length) < STANDING_TRIM * fastest
        )
        stopped = power != POWER_ON or (wanted[i] == 0.0 and (parts[6, i] > 0.0 or at_rest))
        parts[6, i] = 1.0 if stopped and power != POWER_COAST else 0.0
        trim_rate, low, high = 0.0, -actuators.hold_pull[i], actuators.hold_push[i]
        if stopped:
            path -= behind
            behind, rate, rates[i] = 0.0, 0.0, 0.0
            if power == POWER_COAST:
                low, high = 0.0, 0.0
        else:
            low, high = -actuators.pull[i], actuators.push[i]
            trim_rate = actuators.tracking * (path - behind - length)
        rows[i, KIND], rows[i, SIDE_A], rows[i, SIDE_B] = geometry.kind[i], geometry.side_a[i], geometry.side_b[i]
        rows[i, OFFSET], rows[i, SHORTEST] = geometry.offset[i], geometry.length_min[i]
        rows[i, LONGEST] = geometry.length_max[i]
        rows[i, STIFFNESS], rows[i, DAMPING] = actuators.stiffness[i], actuators.damping[i]
        rows[i, LOW], rows[i, HIGH] = low, high
        rows[i, FRICTION], rows[i, RATED] = actuators.friction[i], fastest
        if power == POWER_LEAK:
            rows[i, LEAK_PUSH], rows[i, LEAK_PULL] = actuators.leak_push[i], actuators.leak_pull[i]
        rows[i, PATH], rows[i, PATH_RATE], rows[i, PATH_RATE_END] = path, rate, rates[i]
        rows[i, PATH_ACCEL] = (rates[i] - rate) / dt
        rows[i, BEHIND], rows[i, LAG], rows[i, DECAY] = behind, lag, np.exp(-half_step / lag)
        rows[i, TRIM], rows[i, TRIM_RATE] = trim, trim_rate
        rows[i, OIL], rows[i, OIL_RATE] = path - behind + trim, behind / lag + trim_rate
    return rows


@njit(cache=True)
def move_oil(drives: Array, done: float, half_step: float) -> None:
    """Move the oil of all drives (n, 26) on by half a micro step; ``done`` of the macro step [s] lie behind."""
    after = done + half_step
    for i in range(drives.shape[0]):
        accel, rate, lag = drives[i, PATH_ACCEL], drives[i, PATH_RATE], drives[i, LAG]
        behind = follow_path(drives[i, BEHIND], rate + accel * done, accel, lag, half_step, drives[i, DECAY])
        path = drives[i, PATH] + after * (rate + 0.5 * accel * after)
        drives[i, BEHIND] = behind
        drives[i, OIL] = path - behind + drives[i, TRIM] + drives[i, TRIM_RATE] * after - drives[i, YIELDED]
        drives[i, OIL_RATE] = behind / lag + drives[i, TRIM_RATE]


@njit(cache=True)
def _length_and_arm(drives: Array, i: int, q: float) -> tuple[float, float]:
    """Return what `crane_cylinders.length_and_arm` does, from row i."""
    angle = q - drives[i, OFFSET]
    if drives[i, KIND] == LINEAR:
        return angle, 1.0
    return triangle(drives[i, SIDE_A], drives[i, SIDE_B], angle)


@njit(cache=True)
def fill_efforts(drives: Array, q: Array, qd: Array, power: int, effort: Array, flags: Ints) -> None:
    """Fill the joint efforts (n,) [N m, N], end stops included, for joint values and rates (n,).

    Drives (n, 26) at their greatest force are marked in ``flags`` (n,).
    """
    for i in range(q.shape[0]):
        length, arm = _length_and_arm(drives, i, q[i])
        rate = arm * qd[i]
        k, c = drives[i, STIFFNESS], drives[i, DAMPING]
        if power == POWER_COAST:
            force = -drives[i, FRICTION] * rate / drives[i, RATED]
        else:
            force = k * (drives[i, OIL] - length) + c * (drives[i, OIL_RATE] - rate)
            kept = min(max(force, drives[i, LOW]), drives[i, HIGH])
            if kept != force:
                force = kept
                flags[i] |= FLAG_EFFORT
        if length > drives[i, LONGEST]:
            force -= stop_force(k, c, length - drives[i, LONGEST], rate)
        elif length < drives[i, SHORTEST]:
            force += stop_force(k, c, drives[i, SHORTEST] - length, -rate)
        effort[i] = force * arm


@njit(cache=True)
def stop_force(stiffness: float, damping: float, depth: float, rate: float) -> float:
    """Return the push of an end stop [N] that a drive has entered by a depth [m] at a rate [m/s]; never a pull.

    The damping grows over the first millimetre, so that the force has no jump where the stop is met.
    """
    return max(0.0, stiffness * depth + damping * min(1.0, depth / STOP_SOFT_M) * rate)


@njit(cache=True)
def yield_oil(drives: Array, q: Array, h: float) -> None:
    """Let escape what the drives (n, 26) cannot hold at the end of a micro step of h [s], and what leaks."""
    for i in range(q.shape[0]):
        k = drives[i, STIFFNESS]
        force = k * (drives[i, OIL] - _length_and_arm(drives, i, q[i])[0])
        lost = (force - min(max(force, drives[i, LOW]), drives[i, HIGH])) / k
        lost += h * (force - k * lost) * (drives[i, LEAK_PUSH] if force > 0.0 else drives[i, LEAK_PULL])
        drives[i, YIELDED] += lost
        drives[i, OIL] -= lost


@njit(cache=True)
def settle_drives(drives: Array, dt: float, parts: Array) -> None:
    """Write the step's end into rows 2 to 5 of parts (7, n); what yielded moves the path, but not past its ends."""
    for i in range(drives.shape[0]):
        path = drives[i, PATH] + 0.5 * dt * (drives[i, PATH_RATE] + drives[i, PATH_RATE_END])
        moved, yielded = path, drives[i, YIELDED]
        if yielded != 0.0:
            moved = min(max(path - yielded, drives[i, SHORTEST]), drives[i, LONGEST])
        parts[2, i], parts[3, i], parts[4, i] = moved, drives[i, PATH_RATE_END], drives[i, BEHIND]
        parts[5, i] = drives[i, TRIM] + drives[i, TRIM_RATE] * dt + path - yielded - moved
