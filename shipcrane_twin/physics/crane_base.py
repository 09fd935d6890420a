"""Between ship and crane: the motion of the crane's base, and the tip seen from the world.

The ship's motion comes as odometry, float64 (13,): position of base_link, quaternion, velocity of its
origin and angular velocity in base_link axes. crane_base has the same axes and sits at ``base_b`` (3,).
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import ChainParams, tip_state
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
def turned_force(odom: Array, force_w: Array) -> Array:
    """Return a world force (3,) in base axes."""
    return rotate_to_body(matrix_from_quat(odom[3:7]), force_w)


@njit(cache=True)
def tip_odometry(chain: ChainParams, q: Array, qd: Array, odom: Array, base_b: Array) -> Array:
    """Return the tip's odometry (13,): pose of crane_tip in the world, velocities in crane_tip axes."""
    tip_b, tip_vel_b, tip_omega_b, tip_rot_b = tip_state(chain, q, qd)
    rot = matrix_from_quat(odom[3:7])
    arm_b = base_b + tip_b
    velocity_b = odom[7:10] + cross(odom[10:13], arm_b) + tip_vel_b
    out = np.empty(13)
    out[:3] = odom[:3] + rotate_to_world(rot, arm_b)
    out[3:7] = quat_from_matrix(rot @ tip_rot_b)
    out[7:10] = rotate_to_body(tip_rot_b, velocity_b)
    out[10:] = rotate_to_body(tip_rot_b, odom[10:13] + tip_omega_b)
    return out
