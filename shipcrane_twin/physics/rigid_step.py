"""One macro step of a rigid load in its sling, with what surrounds it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat
from shipcrane_twin.physics.payload import WireParams, least_mass, place_tip, wire_on_tip
from shipcrane_twin.physics.rigid_load import (
    APART,
    IMPACT,
    IMPACT_MAX,
    LANDING,
    LANDINGS,
    LENGTH,
    LIFT_OFFS,
    POSITION,
    QUAT,
    RECORD,
    SLUNG,
    SPEED,
    TURNING,
    RigidParams,
    make_work,
    rigid_micro_steps,
    rigid_rate,
    springs_at,
)
from shipcrane_twin.physics.winch import Hold, drum_slip
from shipcrane_twin.physics.wire import note_tension

MOVING = 19
"""How many values of the state move by themselves."""

SETTLING = 0.2
"""Time without contact after which a load counts as lifted off [s]; shorter hops belong to one landing."""


class Surroundings(NamedTuple):
    """What surrounds the load over one macro step.

    Attributes
    ----------
    tip_prev, tip_next : float64, shape (6,)
        Position and velocity of the tip, world.
    planes_prev, planes_next : float64, shape (n, 18)
        The rectangles, see `contact`.
    water_prev, water_next : float64, shape (7,)
        Elevation [m], velocity [m/s], acceleration [m/s2] of the water at the load, world.
    wind : float64, shape (3,)
        Mean over the step [m/s], world.
    """

    tip_prev: Array
    tip_next: Array
    planes_prev: Array
    planes_next: Array
    water_prev: Array
    water_next: Array
    wind: Array


@njit(cache=True)
def place_planes(prev: Array, after: Array, part: float, step_s: float, now: Array) -> None:
    """Fill the rectangles (n, 18) at ``part`` (0 to 1) of a step: places by cubics, axes and turning linear."""
    for j in range(prev.shape[0]):
        place_tip(prev[j], after[j], part, step_s, now[j])
        for i in range(6, 18):
            now[j, i] = prev[j, i] + part * (after[j, i] - prev[j, i])


@njit(cache=True)
def note_contact(record: Array, normal: float, approach: float, step_s: float) -> None:
    """Bring the record of landings (5,) up to date with the normal force [N] at a micro step's start."""
    if normal > 0.0:
        if record[APART] >= SETTLING:
            record[LANDINGS] += 1.0
            record[IMPACT] = approach
            record[IMPACT_MAX] = max(record[IMPACT_MAX], approach)
        record[APART] = 0.0
        return
    if record[APART] < SETTLING <= record[APART] + step_s:
        record[LIFT_OFFS] += 1.0
    record[APART] += step_s


@njit(cache=True)
def rigid_step(
    wire: WireParams,
    hold: Hold,
    load: RigidParams,
    state: Array,
    told_prev: float,
    told_next: float,
    around: Surroundings,
    step_s: float,
) -> tuple[Array, Array, float]:
    """Move hook and load over one macro step; see `payload.payload_step` for what is not told here.

    Parameters
    ----------
    wire : WireParams
    hold : Hold
    load : RigidParams
    state : float64, shape (32,)
        See `rigid_load`.
    told_prev, told_next : float
    around : Surroundings
    step_s : float

    Returns
    -------
    state : float64, shape (32,)
    tip_force_w : float64, shape (3,)
    tension_max : float

    Notes
    -----
    Runge-Kutta of fourth order; the quaternion is normalised after each micro step. Stiffness and damping of the wire
    are those of the length at each micro step's start.
    """
    new = state.copy()
    snaps, landing = new[RECORD : RECORD + 5], new[LANDING : LANDING + 5]
    slung = state[SLUNG] > 0.0
    count = rigid_micro_steps(wire, load, state[LENGTH], slung, step_s)
    h = step_s / count
    work = make_work()
    tip, y, rate, total = np.empty(6), np.empty(MOVING), np.empty(MOVING), np.empty(MOVING)
    planes, water = np.empty_like(around.planes_prev), np.empty(7)
    impulse = np.zeros(3)
    tension_max, slid, slip = 0.0, 0.0, state[SPEED] - told_prev
    told_accel = (told_next - told_prev) / step_s

    for micro in range(count):
        y[:] = new[:MOVING]
        total[:] = 0.0
        slip_next = slip
        for stage in range(4):
            middle = stage == 1 or stage == 2
            weight = 2.0 / 6.0 if middle else 1.0 / 6.0
            share = 0.5 if middle else stage / 3.0
            part = (micro + share) / count
            told = told_prev + part * (told_next - told_prev)
            length = state[LENGTH] + part * step_s * 0.5 * (told_prev + told) + (slid + share * h * slip)
            place_tip(around.tip_prev, around.tip_next, part, step_s, tip)
            place_planes(around.planes_prev, around.planes_next, part, step_s, planes)
            for i in range(7):
                water[i] = around.water_prev[i] + part * (around.water_next[i] - around.water_prev[i])
            if stage == 0:
                springs = springs_at(wire, load, length, slung)
            tension, normal, approach = rigid_rate(
                wire, load, springs, slung, y, tip, length, told + slip, planes, water, around.wind, work, rate
            )
            if stage == 0:
                tension_max = max(tension_max, tension)
                note_tension(snaps, tension)
                note_contact(landing, normal, approach, h)
                light = least_mass(wire, springs.stiffness, springs.loss * springs.stiffness * springs.stretch, h)
                drawn = tension + wire_on_tip(wire, length)
                slip_next = drum_slip(hold, slip, told_accel, told + slip, length, drawn, light, h)
            reach = h if stage == 2 else 0.5 * h
            for i in range(3):
                impulse[i] -= weight * h * work.part_w[i]
            for i in range(MOVING):
                total[i] += weight * rate[i]
                y[i] = new[i] + reach * rate[i]
        for i in range(MOVING):
            new[i] += h * total[i]
        norm = np.sqrt(new[QUAT] ** 2 + new[QUAT + 1] ** 2 + new[QUAT + 2] ** 2 + new[QUAT + 3] ** 2)
        for i in range(QUAT, TURNING):
            new[i] /= norm
        slid += h * slip
        slip = slip_next

    new[LENGTH] = state[LENGTH] + 0.5 * (told_prev + told_next) * step_s + slid
    new[SPEED] = told_next + slip
    impulse[2] -= wire_on_tip(wire, state[LENGTH]) * step_s
    return new, impulse / step_s, tension_max


@njit(cache=True)
def slung_state(
    wire: WireParams, load: RigidParams, tip_pos_w: Array, length: float, quat: Array, place: Array, lying: bool
) -> Array:
    """Return the state (32,) at rest: the load hangs level under the tip, or lies at a place with the hook above it.

    Parameters
    ----------
    wire : WireParams
    load : RigidParams
    tip_pos_w : float64, shape (3,)
        [m]
    length : float
        Paid-out length [m].
    quat : float64, shape (4,)
        Of the load.
    place : float64, shape (3,)
        Where the CoG lies [m]; of no account while it hangs.
    lying : bool

    Notes
    -----
    The load hangs with its middle of lugs under the hook; with the CoG beside the middle it starts to turn.
    """
    state = np.zeros(LANDING + 5)
    springs = springs_at(wire, load, length, not lying)
    state[:3] = tip_pos_w
    if lying:
        hook_stretch = springs.hook_weight / springs.stiffness
        state[2] -= length + hook_stretch
        state[POSITION : POSITION + 3] = place
    else:
        state[2] -= length + springs.stretch
        rot = matrix_from_quat(quat)
        apart, middle = 0.0, np.empty(3)
        for i in range(3):
            apart += (0.5 * (load.lugs[1, i] - load.lugs[0, i])) ** 2
            middle[i] = 0.5 * (load.lugs[0, i] + load.lugs[1, i])
        drop = sling_drop(load, wire.gravity, np.sqrt(apart))
        for i in range(3):
            state[POSITION + i] = state[i] - (rot[i, 0] * middle[0] + rot[i, 1] * middle[1] + rot[i, 2] * middle[2])
        state[POSITION + 2] -= drop
    state[QUAT:TURNING] = quat
    state[LENGTH] = length
    state[SLUNG] = 1.0
    state[LANDING + APART] = 0.0 if lying else 2.0 * SETTLING
    return state


@njit(cache=True)
def sling_drop(load: RigidParams, gravity: float, half: float) -> float:
    """Return the height [m] of the hook over two level lugs, each ``half`` [m] beside it, with the load at rest."""
    drop = np.sqrt(max(1e-12, load.leg_length**2 - half * half))
    for _ in range(50):
        reach = np.sqrt(drop * drop + half * half)
        pulled = 2.0 * load.leg_stiffness * (reach - load.leg_length) * drop / reach
        slope = 2.0 * load.leg_stiffness * (1.0 - load.leg_length * half * half / reach**3)
        drop += (load.mass * gravity - pulled) / slope
    return drop
