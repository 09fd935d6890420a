"""The load on the hook as a point mass, its winch, and their motion over one macro step.

State, float64 (9,): position (3) and velocity (3) of the load in the world, unstretched wire length
paid out [m], its rate [m/s], and the mass on the hook [kg].
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_world
from shipcrane_twin.physics.wire import pull, wire_loss, wire_stiffness


class WireParams(NamedTuple):
    """Constants of wire and winch.

    Attributes
    ----------
    elastic_modulus, diameter, fill_factor, damping_ratio : float
        [Pa], [m], metallic share of the section, axial damping ratio of the hanging load.
    speed_max, accel_max : float
        Winch limits [m/s], [m/s2].
    length_min, length_max : float
        Limits of the paid-out length [m].
    gravity : float
        [m/s2].
    phase_max : float
        Largest phase of the wire's axial vibration per micro step [rad].
    micro_step_max : float
        Largest micro step [s].
    """

    elastic_modulus: float
    diameter: float
    fill_factor: float
    damping_ratio: float
    speed_max: float
    accel_max: float
    length_min: float
    length_max: float
    gravity: float
    phase_max: float
    micro_step_max: float


@njit(cache=True)
def place_tip(prev: Array, after: Array, part: float, step_s: float, tip: Array) -> None:
    """Fill position and velocity (6,) of the tip at ``part`` (0 to 1) of a step with these ends (6,).

    Position is the cubic through both ends with their velocities (Hermite), velocity its derivative.
    """
    p2, p3 = part * part, part * part * part
    for i in range(3):
        tip[i] = (
            (2.0 * p3 - 3.0 * p2 + 1.0) * prev[i]
            + (p3 - 2.0 * p2 + part) * step_s * prev[3 + i]
            + (3.0 * p2 - 2.0 * p3) * after[i]
            + (p3 - p2) * step_s * after[3 + i]
        )
        tip[3 + i] = (
            (6.0 * p2 - 6.0 * part) / step_s * (prev[i] - after[i])
            + (3.0 * p2 - 4.0 * part + 1.0) * prev[3 + i]
            + (3.0 * p2 - 2.0 * part) * after[3 + i]
        )


@njit(cache=True)
def winch_speed(wire: WireParams, length: float, speed: float, command: float, step_s: float) -> float:
    """Return the winch speed [m/s] after one step, within speed, acceleration and length limits.

    The speed that still stops before an end with the allowed deceleration bounds the result.
    """
    wanted = min(wire.speed_max, max(-wire.speed_max, command))
    change = wire.accel_max * step_s
    out = min(speed + change, max(speed - change, wanted))
    room_out = max(0.0, wire.length_max - length - 0.5 * max(0.0, speed) * step_s)
    room_in = max(0.0, length - wire.length_min - 0.5 * max(0.0, -speed) * step_s)
    out = min(out, braking_speed(room_out, wire.accel_max, step_s))
    return max(out, -braking_speed(room_in, wire.accel_max, step_s))


@njit(cache=True)
def braking_speed(room: float, accel: float, step_s: float) -> float:
    """Return the largest speed at a step's end from which a stop within ``room`` [m] is still possible.

    The step itself uses up ``v step / 2``, and the last step of a stop, with less than ``a step`` left to
    lose, up to as much again: the root of ``v^2 / (2 a) + v step = room``.
    """
    change = accel * step_s
    return np.sqrt(change * change + 2.0 * accel * room) - change


@njit(cache=True)
def micro_steps(wire: WireParams, length: float, mass: float, step_s: float) -> int:
    """Return how many micro steps resolve the wire's axial vibration over one macro step."""
    stiffness = wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length)
    by_phase = step_s * np.sqrt(stiffness / mass) / wire.phase_max
    by_time = step_s / wire.micro_step_max - 1e-9  # a whole quotient must not round up
    return int(np.ceil(max(1.0, by_phase, by_time)))


@njit(cache=True)
def payload_step(
    wire: WireParams,
    state: Array,
    winch_command: float,
    tip_prev: Array,
    tip_next: Array,
    step_s: float,
) -> tuple[Array, Array, float]:
    """Move load and winch over one macro step under the true motion of the tip.

    Parameters
    ----------
    wire : WireParams
    state : float64, shape (9,)
    winch_command : float
        Commanded pay-out speed [m/s].
    tip_prev, tip_next : float64, shape (6,)
        Position and velocity of the tip in the world at both ends of the step; a cubic between.
    step_s : float
        Macro step [s].

    Returns
    -------
    state : float64, shape (9,)
    tip_force_w : float64, shape (3,)
        Mean over the step of the wire's force on the tip [N, world].
    tension_max : float
        Largest tension seen at a micro step's start [N].
    """
    new = state.copy()
    speed_prev = state[7]
    speed_next = winch_speed(wire, state[6], speed_prev, winch_command, step_s)
    mass = state[8]
    count = micro_steps(wire, state[6], mass, step_s)
    h = step_s / count
    tip, stage_state, total = np.empty(6), np.empty(6), np.empty(6)
    force, impulse = np.zeros(3), np.zeros(3)
    tension_max = 0.0

    for micro in range(count):
        stage_state[:] = new[:6]
        total[:] = 0.0
        for stage in range(4):
            middle = stage == 1 or stage == 2
            weight = 2.0 / 6.0 if middle else 1.0 / 6.0
            part = (micro + (0.5 if middle else stage / 3.0)) / count
            rate = speed_prev + part * (speed_next - speed_prev)
            length = state[6] + part * step_s * 0.5 * (speed_prev + rate)
            place_tip(tip_prev, tip_next, part, step_s, tip)
            stiffness = wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length)
            loss = wire_loss(stiffness, mass, wire.damping_ratio, wire.gravity)
            stretch_static = mass * wire.gravity / stiffness
            tension = pull(tip, stage_state, length, rate, stiffness, loss, stretch_static, force)
            if stage == 0:
                tension_max = max(tension_max, tension)
            reach = h if stage == 2 else 0.5 * h
            for i in range(3):
                velocity = stage_state[3 + i]
                acceleration = force[i] / mass - (wire.gravity if i == 2 else 0.0)
                impulse[i] -= weight * h * force[i]
                total[i] += weight * velocity
                total[3 + i] += weight * acceleration
                stage_state[i] = new[i] + reach * velocity
                stage_state[3 + i] = new[3 + i] + reach * acceleration
        for i in range(6):
            new[i] += h * total[i]

    new[6] = state[6] + 0.5 * (speed_prev + speed_next) * step_s
    new[7] = speed_next
    return new, impulse / step_s, tension_max


@njit(cache=True)
def hanging_state(wire: WireParams, tip_pos_w: Array, tip_vel_w: Array, length: float, mass: float) -> Array:
    """Return the state (9,) of a load that hangs at rest relative to the tip, wire stretched by its weight."""
    stiffness = wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length)
    state = np.zeros(9)
    state[:3] = tip_pos_w
    state[2] -= length + mass * wire.gravity / stiffness
    state[3:6] = tip_vel_w
    state[6] = length
    state[8] = mass
    return state


@njit(cache=True)
def tip_motion(odom: Array) -> Array:
    """Return position and velocity in the world (6,) of an odometry (13,) whose velocity is in body axes."""
    out = np.empty(6)
    out[:3] = odom[:3]
    out[3:] = rotate_to_world(matrix_from_quat(odom[3:7]), odom[7:10])
    return out
