"""The ship as a rigid body in six degrees of freedom with the water's memory, and the crane's inertia bolted to it.

State, float64 (13 + r,): position of the CoG in the world (3), quaternion body to world (4), velocity
of the CoG (3) and angular velocity (3), both in body axes, memory of the water (r, see `physics.radiation`).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import (
    cross,
    euler_from_matrix,
    matrix_from_quat,
    quat_rate,
    rotate_to_world,
)
from shipcrane_twin.physics.hull import HullParams, add_added_mass_bias, add_viscous_load, restoring_load
from shipcrane_twin.physics.linalg import factorise, row_dot, solve_factorised
from shipcrane_twin.physics.radiation import RadiationParams, add_memory_load


class VesselParams(NamedTuple):
    """Constants of the ship.

    Attributes
    ----------
    rigid_mass : float64, shape (6, 6)
        Rigid-body inertia about the CoG.
    hull : HullParams
    radiation : RadiationParams
    cog : float64, shape (3,)
        CoG in base_link [m].
    crane_base : float64, shape (3,)
        Origin of crane_base in base_link [m]; its axes are parallel to base_link.
    gravity : float
        [m/s2].
    """

    rigid_mass: Array
    hull: HullParams
    radiation: RadiationParams
    cog: Array
    crane_base: Array
    gravity: float


@njit(cache=True)
def attached_inertia(body: Array, offset: Array) -> Array:
    """Return the inertia (6, 6) about a reference point of a rigid body given at another point.

    Parameters
    ----------
    body : float64, shape (10,)
        Mass, CoM (3) from the other point, inertia xx xy xz yy yz zz about the CoM; common axes.
    offset : float64, shape (3,)
        The other point seen from the reference point [m].
    """
    mass = body[0]
    x, y, z = body[1] + offset[0], body[2] + offset[1], body[3] + offset[2]
    out = np.zeros((6, 6))
    for i in range(3):
        out[i, i] = mass
    out[0, 4], out[0, 5] = mass * z, -mass * y
    out[1, 3], out[1, 5] = -mass * z, mass * x
    out[2, 3], out[2, 4] = mass * y, -mass * x
    for i in range(3):
        for j in range(3, 6):
            out[j, i] = out[i, j]
    out[3, 3] = body[4] + mass * (y * y + z * z)
    out[3, 4] = body[5] - mass * x * y
    out[3, 5] = body[6] - mass * x * z
    out[4, 4] = body[7] + mass * (x * x + z * z)
    out[4, 5] = body[8] - mass * y * z
    out[5, 5] = body[9] + mass * (x * x + y * y)
    out[4, 3], out[5, 3], out[5, 4] = out[3, 4], out[3, 5], out[4, 5]
    return out


@njit(cache=True)
def add_momentum_bias(load: Array, mass6: Array, nu_b: Array) -> None:
    """Add to a load (6,) ``-C(nu) nu`` of a rigid body with inertia (6, 6) moving with nu (6,), body axes."""
    u, v, w, p, q, r = nu_b[0], nu_b[1], nu_b[2], nu_b[3], nu_b[4], nu_b[5]
    x, y, z = row_dot(mass6, 0, nu_b), row_dot(mass6, 1, nu_b), row_dot(mass6, 2, nu_b)
    k, m, n = row_dot(mass6, 3, nu_b), row_dot(mass6, 4, nu_b), row_dot(mass6, 5, nu_b)
    load[0] -= q * z - r * y
    load[1] -= r * x - p * z
    load[2] -= p * y - q * x
    load[3] -= q * n - r * m + v * z - w * y
    load[4] -= r * k - p * n + w * x - u * z
    load[5] -= p * m - q * k + u * y - v * x


@njit(cache=True)
def carried_inertia(params: VesselParams, attached: Array) -> tuple[Array, Array]:
    """Return the rigid inertia (6, 6) of ship and carried body about the CoG, and factors of it with added mass.

    Parameters
    ----------
    params : VesselParams
    attached : float64, shape (10,)
        Rigid body carried along at crane_base.

    Raises
    ------
    ValueError
        If the inertia is not positive definite.
    """
    mass6 = params.rigid_mass + attached_inertia(attached, params.crane_base - params.cog)
    factors = mass6 + params.hull.added_mass
    if not factorise(factors):
        raise ValueError("ship: the inertia with added mass is not positive definite")
    return mass6, factors


@njit(cache=True)
def state_rate(
    params: VesselParams,
    inertia: tuple[Array, Array],
    state: Array,
    load_b: Array,
    water_w: Array,
    attached: Array,
) -> Array:
    """Return d(state)/dt (13 + r,).

    Parameters
    ----------
    params : VesselParams
    inertia : tuple
        Of `carried_inertia` with the same attached body.
    state : float64, shape (13 + r,)
    load_b : float64, shape (6,)
        Outer force and moment about the CoG, body axes [N, N m].
    water_w : float64, shape (3,)
        Current, world [m/s].
    attached : float64, shape (10,)
        Rigid body carried along at crane_base: its inertia and its weight are added here.

    Notes
    -----
    ``(M_RB + M_attached + A_inf) nu_dot = load + weight + restoring + viscous + memory - C(nu) nu - C_A(nu_r) nu_r``
    (Fossen 2005; Fossen 2011, section 8.3, about the CoG).
    """
    nu_b = state[7:13]
    rot = matrix_from_quat(state[3:7])
    roll, pitch, _ = euler_from_matrix(rot)
    hull = params.hull

    motion = np.empty((2, 6))  # of the water, of the ship in it
    water_b, nu_rel_b = motion[0, :3], motion[1]
    for i in range(3):
        water_b[i] = rot[0, i] * water_w[0] + rot[1, i] * water_w[1] + rot[2, i] * water_w[2]
        nu_rel_b[i] = nu_b[i] - water_b[i]
        nu_rel_b[3 + i] = nu_b[3 + i]

    rate = np.empty(state.shape[0])
    total = rate[7:13]
    for i in range(6):
        total[i] = load_b[i]
    add_momentum_bias(total, inertia[0], nu_b)
    add_viscous_load(total, hull, nu_rel_b)
    add_added_mass_bias(total, hull, nu_rel_b, water_b)
    add_memory_load(total, params.radiation, state[13:], nu_rel_b, rate[13:])

    force_up, roll_moment, pitch_moment, yaw_moment = restoring_load(hull, state[2], roll, pitch)
    weight = -attached[0] * params.gravity
    arm_x = attached[1] + params.crane_base[0] - params.cog[0]
    arm_y = attached[2] + params.crane_base[1] - params.cog[1]
    arm_z = attached[3] + params.crane_base[2] - params.cog[2]
    up_x, up_y, up_z = rot[2, 0], rot[2, 1], rot[2, 2]
    total[0] += (force_up + weight) * up_x
    total[1] += (force_up + weight) * up_y
    total[2] += (force_up + weight) * up_z
    total[3] += roll_moment + weight * (arm_y * up_z - arm_z * up_y)
    total[4] += pitch_moment + weight * (arm_z * up_x - arm_x * up_z)
    total[5] += yaw_moment + weight * (arm_x * up_y - arm_y * up_x)

    solve_factorised(inertia[1], total)
    for i in range(3):
        rate[i] = rot[i, 0] * nu_b[0] + rot[i, 1] * nu_b[1] + rot[i, 2] * nu_b[2]
    rate[3], rate[4], rate[5], rate[6] = quat_rate(state[3:7], nu_b[3:])
    return rate


@njit(cache=True)
def vessel_step(
    params: VesselParams,
    inertia: tuple[Array, Array],
    state: Array,
    load_from_b: Array,
    load_to_b: Array,
    water_w: Array,
    attached: Array,
    step_s: float,
) -> Array:
    """Return the state (13 + r,) one classical Runge-Kutta step later; the load runs linearly over the step."""
    count = state.shape[0]
    middle = 0.5 * (load_from_b + load_to_b)
    half = 0.5 * step_s
    k1 = state_rate(params, inertia, state, load_from_b, water_w, attached)
    stage = np.empty(count)
    for i in range(count):
        stage[i] = state[i] + half * k1[i]
    k2 = state_rate(params, inertia, stage, middle, water_w, attached)
    for i in range(count):
        stage[i] = state[i] + half * k2[i]
    k3 = state_rate(params, inertia, stage, middle, water_w, attached)
    for i in range(count):
        stage[i] = state[i] + step_s * k3[i]
    k4 = state_rate(params, inertia, stage, load_to_b, water_w, attached)
    for i in range(count):
        stage[i] = state[i] + (step_s / 6.0) * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
    stage[3:7] /= np.sqrt(stage[3] ** 2 + stage[4] ** 2 + stage[5] ** 2 + stage[6] ** 2)
    return stage


@njit(cache=True)
def point_motion(state: Array, nu_dot_b: Array, arm_b: Array) -> tuple[Array, Array, Array]:
    """Return world position, velocity and acceleration (body axes) of a point fixed in the ship.

    Parameters
    ----------
    state : float64, shape (13 + r,)
    nu_dot_b : float64, shape (6,)
        Rates of the body-axes velocities at the CoG.
    arm_b : float64, shape (3,)
        The point seen from the CoG, body axes [m].

    Returns
    -------
    pos_w, vel_b, acc_b : float64, shape (3,)
        The acceleration is that of the point in the world (no gravity), resolved in body axes.
    """
    rot = matrix_from_quat(state[3:7])
    vel, omega = state[7:10], state[10:13]
    pos_w = state[:3] + rotate_to_world(rot, arm_b)
    vel_b = vel + cross(omega, arm_b)
    acc_b = nu_dot_b[:3] + cross(omega, vel) + cross(nu_dot_b[3:], arm_b) + cross(omega, cross(omega, arm_b))
    return pos_w, vel_b, acc_b


@njit(cache=True)
def carried_load(attached: Array, omega_b: Array, alpha_b: Array, proper_acc_b: Array) -> Array:
    """Return force and moment (6,) of a rigidly carried body on its carrier, at the point of attachment.

    Parameters
    ----------
    attached : float64, shape (10,)
        Mass, CoM (3) from the point, inertia about the CoM.
    omega_b, alpha_b : float64, shape (3,)
        Angular velocity and acceleration, body axes.
    proper_acc_b : float64, shape (3,)
        Acceleration of the point minus gravity, body axes [m/s2].
    """
    com = attached[1:4]
    acc_com = proper_acc_b + cross(alpha_b, com) + cross(omega_b, cross(omega_b, com))
    force = -attached[0] * acc_com
    tensor = np.array(
        [
            [attached[4], attached[5], attached[6]],
            [attached[5], attached[7], attached[8]],
            [attached[6], attached[8], attached[9]],
        ]
    )
    moment = -(rotate_to_world(tensor, alpha_b) + cross(omega_b, rotate_to_world(tensor, omega_b)))
    out = np.empty(6)
    out[:3] = force
    out[3:] = moment + cross(com, force)
    return out


@njit(cache=True)
def carried_mean(
    params: VesselParams, attached: Array, start: Array, start_rate: Array, end: Array, end_rate: Array
) -> Array:
    """Return the mean over a step (trapezium) of the load (6,) of a body carried at crane_base.

    Parameters
    ----------
    params : VesselParams
    attached : float64, shape (10,)
        The body, see `carried_load`.
    start, end : float64, shape (13 + r,)
        Ship states at both ends of the step.
    start_rate, end_rate : float64, shape (6,)
        ``nu_dot`` at both ends.

    Returns
    -------
    float64, shape (6,)
        Force and moment on the ship at crane_base's origin, body axes, weight included.
    """
    arm = params.crane_base - params.cog
    total = np.zeros(6)
    for state, rate in ((start, start_rate), (end, end_rate)):
        acc_b = point_motion(state, rate, arm)[2]
        proper_b = acc_b + params.gravity * matrix_from_quat(state[3:7])[2]
        total += 0.5 * carried_load(attached, state[10:13], rate[3:], proper_b)
    return total
