"""Between ship and crane: the motion of the crane's base, and the tip seen from the world.

The ship's motion comes as odometry, float64 (13,): position of base_link, quaternion, velocity of its
origin and angular velocity in base_link axes. crane_base has the same axes and sits at ``base_b`` (3,).
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_actuators import ActuatorParams
from shipcrane_twin.physics.crane_chain import ChainParams
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import MotionLimits
from shipcrane_twin.physics.frames import (
    cross,
    matrix_from_quat,
    quat_from_matrix,
    rotate_to_body,
    rotate_to_world,
)


@njit(cache=True)
def base_motion(odom: Array, accel: Array, base_b: Array, gravity: float) -> Array:
    """Return what the crane feels of the ship.

    Parameters
    ----------
    odom : float64, shape (13,)
    accel : float64, shape (6,)
        Acceleration of base_link's origin (no gravity) and angular acceleration, base_link axes.
    base_b : float64, shape (3,)
    gravity : float
        [m/s2].

    Returns
    -------
    float64, shape (9,)
        Angular velocity, angular acceleration, and acceleration of crane_base minus gravity, crane_base axes.
    """
    omega, alpha = odom[10:13], accel[3:6]
    rot = matrix_from_quat(odom[3:7])
    out = np.empty(9)
    out[:3] = omega
    out[3:6] = alpha
    out[6:] = accel[:3] + cross(alpha, base_b) + cross(omega, cross(omega, base_b)) + gravity * rot[2]
    return out


@njit(cache=True)
def tip_odometry(tip_b: Array, odom: Array, base_b: Array) -> Array:
    """Return the tip's odometry (13,): pose of crane_tip in the world, velocities in crane_tip axes.

    Parameters
    ----------
    tip_b : float64, shape (18,)
        Tip relative to crane_base, see `crane_chain.fill_tip`.
    odom : float64, shape (13,)
    base_b : float64, shape (3,)
    """
    rot = matrix_from_quat(odom[3:7])
    arm_b = base_b + tip_b[:3]
    tip_rot_b = tip_b[9:].copy().reshape((3, 3))
    velocity_b = odom[7:10] + cross(odom[10:13], arm_b) + tip_b[3:6]
    out = np.empty(13)
    out[:3] = odom[:3] + rotate_to_world(rot, arm_b)
    out[3:7] = quat_from_matrix(times(rot, tip_rot_b))
    out[7:10] = rotate_to_body(tip_rot_b, velocity_b)
    out[10:] = rotate_to_body(tip_rot_b, odom[10:13] + tip_b[6:9])
    return out


@njit(cache=True)
def crane_macro_step(
    chain: ChainParams,
    actuators: ActuatorParams,
    limits: MotionLimits,
    base_b: Array,
    gravity: float,
    state: Array,
    mode: Ints,
    command: Array,
    power: int,
    before: Array,
    odom: Array,
    accel: Array,
    force_w: Array,
    felt_mass: float,
    n_micro: int,
    step_s: float,
) -> tuple[Array, Array, Array, Array, Array, Array, Ints]:
    """Move the crane over one macro step on the moving ship.

    Parameters
    ----------
    chain, actuators, limits : ChainParams, ActuatorParams, MotionLimits
    base_b : float64, shape (3,)
    gravity : float
        [m/s2].
    state, mode, command, power
        See `crane_motion.crane_step`.
    before : float64, shape (16,)
        At the step's start: quaternion of the ship, `base_motion`, and the tip's mean proper acceleration
        over the last step in the world [m/s2].
    odom, accel : float64, shapes (13,), (6,)
        The ship at the step's end.
    force_w : float64, shape (3,)
        Force of the wire on the tip, mean over the last step, held in the world over this one [N].
    felt_mass : float
        Mass that the tip carries along the wire [kg], see `crane_load`; 0 for none.
    n_micro, step_s : int, float
        Micro steps in the macro step, macro step [s].

    Returns
    -------
    state, effort : float64, shapes (7 n,), (n,)
        At the end of the step.
    wrench_b : float64, shape (6,)
        Mean over the step of crane and load on the ship at crane_base.
    tip : float64, shape (13,)
        Odometry of the tip at the end of the step.
    inertia : float64, shape (10,)
        The crane as one rigid body at the end of the step.
    after : float64, shape (16,)
        ``before`` of the next step.
    flags : int64, shape (n,)
        See `crane_motion.crane_step`.
    """
    after = np.empty(16)
    after[:4] = odom[3:7]
    after[4:13] = base_motion(odom, accel, base_b, gravity)
    rot_start, rot_end = matrix_from_quat(before[:4]), matrix_from_quat(after[:4])
    start, end = np.empty(16), np.empty(16)
    for base, motion, rot in ((start, before, rot_start), (end, after, rot_end)):
        base[:9] = motion[4:13]
        base[9:12] = rotate_to_body(rot, force_w)
        base[12:15] = rotate_to_body(rot, before[13:])
        base[15] = felt_mass
    new, wrench_b, effort, flags, tip_b, inertia, tip_acc_b = crane_step(
        chain, actuators, limits, state, mode, command, power, start, end, n_micro, step_s
    )
    after[13:] = 0.5 * (rotate_to_world(rot_start, tip_acc_b) + rotate_to_world(rot_end, tip_acc_b))
    return new, effort, wrench_b, tip_odometry(tip_b, odom, base_b), inertia, after, flags


@njit(cache=True)
def times(a: Array, b: Array) -> Array:
    """Return the product of two matrices (3, 3)."""
    out = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                out[i, j] += a[i, k] * b[k, j]
    return out
