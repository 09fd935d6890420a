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
    heading_cosines,
    matrix_from_quat,
    quat_rate,
    rotate_to_world,
    turned_axes,
)
from shipcrane_twin.physics.hull import (
    HullParams,
    add_added_mass_bias,
    add_viscous_load,
    restoring_load,
)
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
    follow : float64, shape (2, 3)
        With which the level axes follow the heading, see `slow_pose.follower`.
    """

    rigid_mass: Array
    hull: HullParams
    radiation: RadiationParams
    cog: Array
    crane_base: Array
    gravity: float
    follow: Array


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


@njit(cache=True, forceinline=True)
def add_momentum_bias(load: Array, mass6: Array, nu: Array) -> None:
    """Add to a load (6,) ``-C(nu) nu`` of a rigid body with inertia (6, 6) moving with nu (6,); any axes."""
    u, v, w, p, q, r = nu[0], nu[1], nu[2], nu[3], nu[4], nu[5]
    x, y, z = row_dot(mass6, 0, nu), row_dot(mass6, 1, nu), row_dot(mass6, 2, nu)
    k, m, n = row_dot(mass6, 3, nu), row_dot(mass6, 4, nu), row_dot(mass6, 5, nu)
    load[0] -= q * z - r * y
    load[1] -= r * x - p * z
    load[2] -= p * y - q * x
    load[3] -= q * n - r * m + v * z - w * y
    load[4] -= r * k - p * n + w * x - u * z
    load[5] -= p * m - q * k + u * y - v * x


@njit(cache=True)
def carried_inertia(params: VesselParams, attached: Array) -> Array:
    """Return the rigid inertia (6, 6) of the ship and of a body (10,) carried at crane_base, about the CoG."""
    return params.rigid_mass + attached_inertia(attached, params.crane_base - params.cog)


@njit(cache=True, forceinline=True)
def inertia_in(level: Array, mass6: Array) -> Array:
    """Return in level axes a rigid inertia (6, 6) about the CoG given in body axes; ``level`` (3, 3) turns to them."""
    out = np.zeros((6, 6))
    mass = mass6[0, 0]
    for i in range(3):
        out[i, i] = mass
        a, b, c = level[i, 0], level[i, 1], level[i, 2]
        x = a * mass6[3, 3] + b * mass6[4, 3] + c * mass6[5, 3]
        y = a * mass6[3, 4] + b * mass6[4, 4] + c * mass6[5, 4]
        z = a * mass6[3, 5] + b * mass6[4, 5] + c * mass6[5, 5]
        for j in range(3):
            out[3 + i, 3 + j] = x * level[j, 0] + y * level[j, 1] + z * level[j, 2]
    # the first moments of mass, a vector
    body_x, body_y, body_z = mass6[1, 5], -mass6[0, 5], mass6[0, 4]
    x = level[0, 0] * body_x + level[0, 1] * body_y + level[0, 2] * body_z
    y = level[1, 0] * body_x + level[1, 1] * body_y + level[1, 2] * body_z
    z = level[2, 0] * body_x + level[2, 1] * body_y + level[2, 2] * body_z
    out[0, 4], out[0, 5], out[1, 3], out[1, 5], out[2, 3], out[2, 4] = z, -y, -z, x, y, -x
    out[4, 0], out[5, 0], out[3, 1], out[5, 1], out[3, 2], out[4, 2] = z, -y, -z, x, y, -x
    return out


@njit(cache=True, forceinline=True)
def state_rate(
    params: VesselParams,
    mass6: Array,
    state: Array,
    load_b: Array,
    weather: Array,
    water_w: Array,
    attached: Array,
    heading: tuple[float, float, float],
) -> Array:
    """Return d(state)/dt (13 + r,).

    Parameters
    ----------
    params : VesselParams
    mass6 : float64, shape (6, 6)
        Of `carried_inertia` with the same attached body.
    state : float64, shape (13 + r,)
    load_b : float64, shape (6,)
        Outer force and moment about the CoG, body axes [N, N m].
    weather : float64, shape (6,)
        Wave and wind load about the CoG, level axes (see `frames.level_axes`).
    water_w : float64, shape (3,)
        Current, world [m/s].
    attached : float64, shape (10,)
        Rigid body carried along at crane_base: its inertia and its weight are added here.
    heading : float, three times
        Of the level axes: east and north part of the unit vector ahead, yaw rate [rad/s]. They follow the ship
        without its motion at wave frequency.

    Raises
    ------
    ValueError
        If the inertia is not positive definite, as with a state that is not finite.

    Notes
    -----
    ``(M_RB + M_attached + A_inf) nu_dot = load + weight + restoring + viscous + memory - C(nu) nu - C_A(nu_r) nu_r``
    (Fossen 2005; Fossen 2011, section 8.3, about the CoG), in level axes, for which seakeeping theory has its loads:
    in axes that roll with the ship, heave loads would push it sideways on average, harder than the real drift, and
    in axes that yaw with every wave, sway loads would push it ahead.
    """
    nu_b = state[7:13]
    rot = matrix_from_quat(state[3:7])
    roll, pitch, _ = euler_from_matrix(rot)
    yaw_rate = (nu_b[4] * rot[2, 1] + nu_b[5] * rot[2, 2]) / (rot[2, 1] * rot[2, 1] + rot[2, 2] * rot[2, 2])
    ahead_x, ahead_y, turning = heading
    level = turned_axes(rot, ahead_x, ahead_y)
    hull = params.hull

    motion = np.empty((2, 6))
    nu, relative = motion[0], motion[1]  # level axes; the second against the water
    total = np.empty(6)
    for i in range(3):
        nu[i] = level[i, 0] * nu_b[0] + level[i, 1] * nu_b[1] + level[i, 2] * nu_b[2]
        nu[3 + i] = level[i, 0] * nu_b[3] + level[i, 1] * nu_b[4] + level[i, 2] * nu_b[5]
        total[i] = level[i, 0] * load_b[0] + level[i, 1] * load_b[1] + level[i, 2] * load_b[2] + weather[i]
        total[3 + i] = level[i, 0] * load_b[3] + level[i, 1] * load_b[4] + level[i, 2] * load_b[5] + weather[3 + i]
    relative[:] = nu
    relative[0] -= ahead_x * water_w[0] + ahead_y * water_w[1]
    relative[1] -= ahead_x * water_w[1] - ahead_y * water_w[0]
    relative[2] -= water_w[2]

    rate = np.empty(state.shape[0])
    inertia = inertia_in(level, mass6)
    add_momentum_bias(total, inertia, nu)
    add_added_mass_bias(total, hull, nu, relative, turning)
    relative[5] = yaw_rate  # the heading's own; roll and pitch together turn about the vertical, too, on average
    add_viscous_load(total, hull, relative)
    add_memory_load(total, params.radiation, state[13:], relative, rate[13:])
    force_up, roll_moment, pitch_moment = restoring_load(hull, state[2], roll, pitch)
    # the ship's momentary heading seen from the level axes
    bow_x, bow_y = heading_cosines(rot)
    off_x, off_y = ahead_x * bow_x + ahead_y * bow_y, ahead_x * bow_y - ahead_y * bow_x
    weight = -attached[0] * params.gravity
    arm_x = attached[1] + params.crane_base[0] - params.cog[0]
    arm_y = attached[2] + params.crane_base[1] - params.cog[1]
    arm_z = attached[3] + params.crane_base[2] - params.cog[2]
    total[2] += force_up + weight
    total[3] += off_x * roll_moment - off_y * pitch_moment
    total[4] += off_y * roll_moment + off_x * pitch_moment
    total[3] += weight * (level[1, 0] * arm_x + level[1, 1] * arm_y + level[1, 2] * arm_z)
    total[4] -= weight * (level[0, 0] * arm_x + level[0, 1] * arm_y + level[0, 2] * arm_z)

    inertia += hull.added_mass
    if not factorise(inertia):
        raise ValueError("ship: the inertia with added mass is not positive definite")
    solve_factorised(inertia, total)
    for i in range(3):
        rate[i] = rot[i, 0] * nu_b[0] + rot[i, 1] * nu_b[1] + rot[i, 2] * nu_b[2]
        rate[7 + i] = level[0, i] * total[0] + level[1, i] * total[1] + level[2, i] * total[2]
        rate[10 + i] = level[0, i] * total[3] + level[1, i] * total[4] + level[2, i] * total[5]
    rate[3], rate[4], rate[5], rate[6] = quat_rate(state[3:7], nu_b[3:])
    return rate


@njit(cache=True)
def vessel_step(
    params: VesselParams,
    mass6: Array,
    state: Array,
    load_b: Array,
    weather_from: Array,
    weather_to: Array,
    water_w: Array,
    attached: Array,
    heading: tuple[float, float, float],
    step_s: float,
) -> Array:
    """Return the state (13 + r,) one classical Runge-Kutta step later.

    The weather's load runs linearly over the step, all else is held; see `state_rate`. Take the heading in the
    middle of the step.
    """
    count = state.shape[0]
    middle = 0.5 * (weather_from + weather_to)
    half = 0.5 * step_s
    k1 = state_rate(params, mass6, state, load_b, weather_from, water_w, attached, heading)
    stage = np.empty(count)
    for i in range(count):
        stage[i] = state[i] + half * k1[i]
    k2 = state_rate(params, mass6, stage, load_b, middle, water_w, attached, heading)
    for i in range(count):
        stage[i] = state[i] + half * k2[i]
    k3 = state_rate(params, mass6, stage, load_b, middle, water_w, attached, heading)
    for i in range(count):
        stage[i] = state[i] + step_s * k3[i]
    k4 = state_rate(params, mass6, stage, load_b, weather_to, water_w, attached, heading)
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
