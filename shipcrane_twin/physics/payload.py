"""The load on the hook as a point mass, and its motion over one macro step.

State, float64 (14,): position (3) and velocity (3) of the load in the world, unstretched wire length
paid out [m], its rate [m/s], the mass on the hook [kg], and the record of snaps (5), see `wire`.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_world
from shipcrane_twin.physics.winch import Hold, drum_slip
from shipcrane_twin.physics.wire import note_tension, pull, resolved_stiffness, wire_loss, wire_stiffness

LENGTH, SPEED, MASS, RECORD = 6, 7, 8, 9
"""Columns of the state after position and velocity."""


class WireParams(NamedTuple):
    """Constants of the wire.

    Attributes
    ----------
    elastic_modulus, diameter, fill_factor, damping_ratio : float
        [Pa], [m], metallic share of the section, axial damping ratio of the hanging load.
    mass_per_length : float
        [kg/m]; 0 for a wire without mass.
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
    mass_per_length: float
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
def carried(wire: WireParams, length: float, mass: float) -> tuple[float, float]:
    """Return inertia [kg] and weight [N] at the load's end of the wire, with the wire's own share.

    Notes
    -----
    A third of the wire's mass and half of its weight: with them the axial mode (Rayleigh), the stretch under the
    wire's weight and its sway as a straight rod come out right. The other half of the weight hangs on the tip. What
    inertia the tip has of the wire, up to two thirds of its mass, is left out, and so is sag.
    """
    own = wire.mass_per_length * length
    return mass + own * (1.0 / 3.0), wire.gravity * (mass + 0.5 * own)


@njit(cache=True)
def wire_on_tip(wire: WireParams, length: float) -> float:
    """Return the wire's weight [N] that does not hang at the load's end, see `carried`."""
    return 0.5 * wire.mass_per_length * length * wire.gravity


@njit(cache=True)
def hanging_wire(wire: WireParams, length: float, mass: float, weight: float) -> tuple[float, float, float]:
    """Return stiffness [N/m], loss factor [s/m] and static stretch [m] with this inertia [kg] and weight [N]."""
    stiffness = resolved_stiffness(
        wire_stiffness(wire.elastic_modulus, wire.diameter, wire.fill_factor, length), mass, wire.phase_max
    )
    return stiffness, wire_loss(stiffness, mass, wire.damping_ratio, weight), weight / stiffness


@njit(cache=True)
def micro_steps(wire: WireParams, length: float, mass: float, step_s: float) -> int:
    """Return how many micro steps resolve the wire's axial vibration over one macro step.

    At most ``step_s / STEP_MIN``, a thousand for 0.1 s, however light the load and short the wire.
    """
    inertia, weight = carried(wire, length, mass)
    stiffness = hanging_wire(wire, length, inertia, weight)[0]
    by_phase = step_s * np.sqrt(stiffness / inertia) / wire.phase_max
    by_time = step_s / wire.micro_step_max
    return int(np.ceil(max(1.0, by_phase, by_time) - 1e-9))  # a whole quotient must not round up


@njit(cache=True)
def least_mass(wire: WireParams, stiffness: float, dashpot: float, step_s: float) -> float:
    """Return the mass [kg] whose vibration on a spring [N/m] and dashpot [N s/m] a micro step [s] still resolves."""
    return max(stiffness * (step_s / wire.phase_max) ** 2, dashpot * step_s)


@njit(cache=True)
def payload_step(
    wire: WireParams,
    hold: Hold,
    state: Array,
    told_prev: float,
    told_next: float,
    tip_prev: Array,
    tip_next: Array,
    step_s: float,
) -> tuple[Array, Array, float]:
    """Move the load over one macro step under the true motion of the tip.

    Parameters
    ----------
    wire : WireParams
    hold : Hold
        What the drum holds, from `winch.winch_step`.
    state : float64, shape (14,)
    told_prev, told_next : float
        Speed told to the drum at both ends of the step [m/s], linear between; what the wire runs beyond it is slip.
    tip_prev, tip_next : float64, shape (6,)
        Position and velocity of the tip in the world at both ends of the step; a cubic between.
    step_s : float
        Macro step [s].

    Returns
    -------
    state : float64, shape (14,)
    tip_force_w : float64, shape (3,)
        Mean over the step of the force of wire and load on the tip [N, world].
    tension_max : float
        Largest tension at the load's end seen at a micro step's start [N].
    """
    new = state.copy()
    record = new[RECORD:]
    mass = state[MASS]
    count = micro_steps(wire, state[LENGTH], mass, step_s)
    h = step_s / count
    tip, stage_state, total = np.empty(6), np.empty(6), np.empty(6)
    force, impulse = np.zeros(3), np.zeros(3)
    tension_max, slid, slip = 0.0, 0.0, state[SPEED] - told_prev
    told_accel = (told_next - told_prev) / step_s
    drum_holds = hold.pull == np.inf and hold.leak == 0.0 and slip == 0.0

    for micro in range(count):
        stage_state[:] = new[:6]
        total[:] = 0.0
        for stage in range(4):
            middle = stage == 1 or stage == 2
            weight = 2.0 / 6.0 if middle else 1.0 / 6.0
            share = 0.5 if middle else stage / 3.0
            part = (micro + share) / count
            told = told_prev + part * (told_next - told_prev)
            rate = told + slip
            length = state[LENGTH] + part * step_s * 0.5 * (told_prev + told) + (slid + share * h * slip)
            place_tip(tip_prev, tip_next, part, step_s, tip)
            inertia, hanging = carried(wire, length, mass)
            stiffness, loss, stretch_static = hanging_wire(wire, length, inertia, hanging)
            tension = pull(tip, stage_state, length, rate, stiffness, loss, stretch_static, force)
            if stage == 0:
                tension_max = max(tension_max, tension)
                note_tension(record, tension)
                slip_next = slip
                if not drum_holds:
                    light = least_mass(wire, stiffness, loss * stiffness * stretch_static, h)
                    drawn = tension + wire_on_tip(wire, length)
                    slip_next = drum_slip(hold, slip, told_accel, rate, length, drawn, light, h)
            reach = h if stage == 2 else 0.5 * h
            for i in range(3):
                velocity = stage_state[3 + i]
                acceleration = (force[i] - (hanging if i == 2 else 0.0)) / inertia
                impulse[i] -= weight * h * force[i]
                total[i] += weight * velocity
                total[3 + i] += weight * acceleration
                stage_state[i] = new[i] + reach * velocity
                stage_state[3 + i] = new[3 + i] + reach * acceleration
        for i in range(6):
            new[i] += h * total[i]
        slid += h * slip
        slip = slip_next

    new[LENGTH] = state[LENGTH] + 0.5 * (told_prev + told_next) * step_s + slid
    new[SPEED] = told_next + slip
    impulse[2] -= wire_on_tip(wire, state[LENGTH]) * step_s
    return new, impulse / step_s, tension_max


@njit(cache=True)
def hanging_state(wire: WireParams, tip_pos_w: Array, tip_vel_w: Array, length: float, mass: float) -> Array:
    """Return the state (14,) of a load that hangs at rest relative to the tip, wire stretched by its weight."""
    inertia, weight = carried(wire, length, mass)
    state = np.zeros(RECORD + 5)
    state[:3] = tip_pos_w
    state[2] -= length + hanging_wire(wire, length, inertia, weight)[2]
    state[3:6] = tip_vel_w
    state[LENGTH] = length
    state[MASS] = mass
    return state


@njit(cache=True)
def tip_motion(odom: Array) -> Array:
    """Return position and velocity in the world (6,) of an odometry (13,) whose velocity is in body axes."""
    out = np.empty(6)
    out[:3] = odom[:3]
    out[3:] = rotate_to_world(matrix_from_quat(odom[3:7]), odom[7:10])
    return out
