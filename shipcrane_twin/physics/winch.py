"""The winch: how fast it is to pay out, and the line pull that its drum holds.

State, float64 (3 + n,): speed that limits on speed, acceleration and ends allow [m/s, positive when paying out],
the speed told to the drum [m/s], length that the drum still lags behind the first of them [m], and the last n values
of the first speed.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

WANTED, TOLD, LAG, WINDOW = range(4)
"""Columns of the state."""

POWERED, COASTING, BRAKED, LEAKING = range(4)
"""What drives the drum: its motor; only friction; the brake; a motor whose oil leaks past it."""

NESTING = 0.5 * np.sqrt(3.0)
"""Rise of a layer of wire over wire diameters: turns lie in the grooves of the layer below."""

SHEAVE_SPEED = 0.01
"""Speed about which the friction of the sheaves turns over [m/s]."""


class WinchParams(NamedTuple):
    """Constants of a winch.

    Attributes
    ----------
    speed_max, accel_max, jerk_max : float
        [m/s], [m/s2], [m/s3].
    length_min, length_max : float
        Limits of the paid-out length [m].
    core_radius, wire_diameter, wire_length : float
        Drum without wire [m], [m], all wire from its end on the drum to its other end [m].
    turns : float
        Of one layer.
    motor_torque, brake_torque, drag_torque : float
        At the drum: largest of the motor, of the brake, friction of the free drum [N m]; ``inf`` holds anything.
    inertia : float
        Of drum, gear and motor, about the drum's axis [kg m2].
    sheave_friction : float
        Share of the tension that the sheaves between drum and tip add to the line pull while hoisting and take from
        it while paying out.
    leak_speed : float
        Speed at which the leaking motor gives way to a pull as great as its own [m/s].
    """

    speed_max: float
    accel_max: float
    jerk_max: float
    length_min: float
    length_max: float
    core_radius: float
    wire_diameter: float
    wire_length: float
    turns: float
    motor_torque: float
    brake_torque: float
    drag_torque: float
    inertia: float
    sheave_friction: float
    leak_speed: float


class Hold(NamedTuple):
    """What the drum holds over one macro step.

    Attributes
    ----------
    pull : float
        Line pull from which on it gives way [N].
    mass : float
        Inertia of the turning parts as a mass on the wire [kg].
    leak : float
        Speed per line pull at which it gives way to any pull [m/s/N]; 0 without a leak.
    sheave_friction : float
    length_min, length_end : float
        Shortest length, and that with no wire left on the drum: there nothing gives way any further [m].
    """

    pull: float
    mass: float
    leak: float
    sheave_friction: float
    length_min: float
    length_end: float


def winch_at_rest(winch: WinchParams, step_s: float) -> Array:
    """Return the state of a winch at rest for macro steps of this length [s].

    Notes
    -----
    The speed told is the mean of the wanted ones over the last ``2 accel_max / jerk_max``: a mean of lengths,
    speeds and accelerations keeps the limits that each of them keeps, and its acceleration changes by no more
    than ``jerk_max`` per second, without overshoot and without a tail.
    """
    return np.zeros(WINDOW + max(1, int(np.ceil(2.0 * winch.accel_max / (winch.jerk_max * step_s)))))


@njit(cache=True)
def smoothed(winch: WinchParams, speeds: Array, step_s: float) -> float:
    """Return the mean of the last speeds (n,), latest last; the earliest counts with what is left of the time."""
    n = speeds.shape[0]
    if n == 1:
        return speeds[0]
    steps = 2.0 * winch.accel_max / (winch.jerk_max * step_s)
    total = (steps - (n - 1)) * speeds[0]
    for i in range(1, n):
        total += speeds[i]
    return total / steps


@njit(cache=True)
def braking_speed(room: float, accel: float, step_s: float) -> float:
    """Return the largest speed at a step's end from which a stop within ``room`` [m] is still possible.

    The step itself uses up ``v step / 2``, and the last step of a stop, with less than ``a step`` left to
    lose, up to as much again: the root of ``v^2 / (2 a) + v step = room``.
    """
    change = accel * step_s
    return np.sqrt(change * change + 2.0 * accel * room) - change


@njit(cache=True)
def speed_toward(winch: WinchParams, length: float, speed: float, wanted_length: float, step_s: float) -> float:
    """Return the speed [m/s] that brings the paid-out length to the wanted one [m] and stops there."""
    side = 1.0 if wanted_length >= length else -1.0
    room = max(0.0, side * (wanted_length - length) - 0.5 * max(0.0, side * speed) * step_s)
    return side * min(winch.speed_max, braking_speed(room, winch.accel_max, step_s))


@njit(cache=True)
def winch_speed(winch: WinchParams, length: float, speed: float, command: float, step_s: float) -> float:
    """Return the wanted speed [m/s] after one step, within speed, acceleration and length limits.

    The speed that still stops before an end with the allowed deceleration bounds the result. A command that is
    no finite number counts as zero.
    """
    if not np.isfinite(command):
        command = 0.0
    wanted = min(winch.speed_max, max(-winch.speed_max, command))
    change = winch.accel_max * step_s
    out = min(speed + change, max(speed - change, wanted))
    room_out = max(0.0, winch.length_max - length - 0.5 * max(0.0, speed) * step_s)
    room_in = max(0.0, length - winch.length_min - 0.5 * max(0.0, -speed) * step_s)
    out = min(out, braking_speed(room_out, winch.accel_max, step_s))
    return max(out, -braking_speed(room_in, winch.accel_max, step_s))


@njit(cache=True)
def drum_layer(winch: WinchParams, length: float) -> tuple[int, float]:
    """Return the layer that the wire leaves at a paid-out length [m], 0 the innermost, and its radius [m]."""
    stored = winch.wire_length - length
    layer, radius = 0, winch.core_radius + 0.5 * winch.wire_diameter
    held = winch.turns * 2.0 * np.pi * radius
    while stored > held:
        layer += 1
        radius += NESTING * winch.wire_diameter
        held += winch.turns * 2.0 * np.pi * radius
    return layer, radius


@njit(cache=True)
def winch_step(
    winch: WinchParams, state: Array, length: float, command: float, by_length: bool, drive: int, step_s: float
) -> tuple[Array, Hold]:
    """Return the winch's state and what its drum holds, one macro step on.

    Parameters
    ----------
    winch : WinchParams
    state : float64, shape (3 + n,)
    length : float
        Paid-out length at the step's start [m].
    command : float
        Pay-out speed [m/s], or with ``by_length`` a paid-out length [m].
    by_length : bool
    drive : int
        `POWERED`, `COASTING`, `BRAKED` or `LEAKING`.
    step_s : float
        Macro step [s].

    Notes
    -----
    A powered winch that is told to stand and stands is held by its brake. Without power the drum is told to
    stand; the speed that it still has decays by what holds it (`drum_slip`).
    """
    new = state.copy()
    if drive == POWERED:
        place = length + state[LAG]
        if by_length and np.isfinite(command):
            command = speed_toward(winch, place, state[WANTED], command, step_s)
        wanted = winch_speed(winch, place, state[WANTED], command, step_s)
        new[WINDOW:-1] = state[WINDOW + 1 :]
        new[-1] = wanted
        new[WANTED] = wanted
        new[TOLD] = smoothed(winch, new[WINDOW:], step_s)
        new[LAG] = state[LAG] + 0.5 * step_s * (state[WANTED] + wanted - state[TOLD] - new[TOLD])
    else:
        new[:] = 0.0
    radius = drum_layer(winch, length)[1]
    leak = 0.0
    if drive == COASTING:
        torque = winch.drag_torque
    elif drive == BRAKED or (drive == POWERED and state[TOLD] == 0.0 and new[TOLD] == 0.0):
        torque = winch.brake_torque
    else:
        torque = winch.motor_torque
        if drive == LEAKING:
            leak = winch.leak_speed * radius / torque
    mass = winch.inertia / (radius * radius)
    return new, Hold(torque / radius, mass, leak, winch.sheave_friction, winch.length_min, winch.wire_length)


@njit(cache=True)
def line_pull(tension: float, pay_out_rate: float, sheave_friction: float) -> float:
    """Return the pull at the drum [N] for a tension at the tip, with the sheaves' friction against the running."""
    if sheave_friction == 0.0:
        return tension
    return tension * (1.0 - sheave_friction * np.tanh(pay_out_rate / SHEAVE_SPEED))


@njit(cache=True)
def drum_slip(
    hold: Hold,
    slip: float,
    told_accel: float,
    rate: float,
    length: float,
    tension: float,
    mass_min: float,
    step_s: float,
) -> float:
    """Return by how much the drum runs faster than it is told [m/s] after a micro step.

    Parameters
    ----------
    hold : Hold
    slip : float
        At the step's start [m/s].
    told_accel : float
        Of the speed told to the drum [m/s2].
    rate, length, tension : float
        Pay-out rate [m/s], paid-out length [m] and tension at the tip [N] at the step's start.
    mass_min : float
        Least inertia on the wire that the micro step resolves [kg].
    step_s : float
        Micro step [s].

    Notes
    -----
    Motor and brake hold like dry friction: as long as pull and inertia of the turning parts together stay below
    ``hold.pull`` there is no slip, beyond it ``m dv/dt = pull - hold.pull`` for the whole speed v. A leak is a
    dashpot, solved implicitly.
    """
    mass = max(hold.mass, mass_min)
    pulled = line_pull(tension, rate, hold.sheave_friction) - mass * told_accel
    if hold.leak > 0.0:
        slip = (slip + step_s * pulled / mass) / (1.0 + step_s / (mass * hold.leak))
    elif slip < 0.0:
        slip = min(0.0, slip + step_s * (pulled + hold.pull) / mass)
    elif slip > 0.0 or pulled > hold.pull:
        slip = max(0.0, slip + step_s * (pulled - hold.pull) / mass)
    if (slip > 0.0 and length >= hold.length_end) or (slip < 0.0 and length <= hold.length_min):
        return 0.0
    return slip
