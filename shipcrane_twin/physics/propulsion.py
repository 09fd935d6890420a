"""Azimuth and tunnel thrusters in motion: shaft speed loop, azimuth servo, faults, mean load on the ship.

Row i of every array is one thruster. State, float64 (n, 2): azimuth [rad], anticlockwise from forward, the direction
of the thrust on the ship (the jet goes the other way); shaft speed [rev/s]. Commands have the same two columns.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle
from shipcrane_twin.physics.propeller import (
    PropulsionParams,
    axis_inflow,
    drive_limit,
    propeller_power,
    propeller_thrust,
)

OK, FAILED, FROZEN, LIMITED, RUNAWAY = 0, 1, 2, 3, 4
"""Fault of a thruster: none; stopped, runs down and stays where it points; keeps azimuth and speed; gives a share of
its thrust; runs up to full thrust while it still steers."""

PIECE_MAX_S = 0.02
"""Longest piece of a step over which thrust is averaged with three points [s]."""

Faults = NDArray[np.int64]


class PropulsionOutput(NamedTuple):
    """What the thrusters did over a step.

    Attributes
    ----------
    state : float64, shape (n, 2)
        At the end.
    load_b : float64, shape (6,)
        Mean over the step of force and moment about the CoG, body axes [N, N m].
    thrust : float64, shape (n,)
        At the end, along the azimuth [N].
    power : float64, shape (n,)
        At the end, at the shaft [W].
    """

    state: Array
    load_b: Array
    thrust: Array
    power: Array


@njit(cache=True)
def limited_lag(start: float, gap: float, rate_max: float, lag: float, time: float) -> float:
    """Return where a first-order lag with limited rate has come from ``start`` after a time; exact.

    ``gap`` is target less start; rate [1/s], lag [s], time [s].
    """
    size = abs(gap)
    ramp = 0.0
    if size > rate_max * lag:
        ramp = min(time, size / rate_max - lag)
    rest = size - rate_max * ramp
    moved = size - rest * np.exp(-(time - ramp) / lag)
    return start + (moved if gap >= 0.0 else -moved)


@njit(cache=True)
def speed_targets(
    params: PropulsionParams, state: Array, command: Array, velocity_rel_b: Array, fault: Faults, share: Array
) -> Array:
    """Return the shaft speeds (n,) [rev/s] that the drives head for within their limits; see `propulsion_step`."""
    count = state.shape[0]
    target, power = np.empty(count), np.zeros(count)
    bound_power = 0.0
    for i in range(count):
        inflow = axis_inflow(params, i, state[i, 0], velocity_rel_b)
        wanted = command[i, 1] if np.isfinite(command[i, 1]) else state[i, 1]
        limit = drive_limit(params, i, inflow if wanted >= 0.0 else -inflow)
        if fault[i] == LIMITED:
            given = share[i] if share[i] > 0.0 else 0.0
            limit *= np.sqrt(min(given, 1.0))
        if fault[i] == RUNAWAY:
            wanted = limit
        lowest = 0.0 if params.azimuthing[i] != 0.0 else -limit
        target[i] = min(limit, max(lowest, wanted))
        if fault[i] == FAILED:
            target[i] = 0.0
        elif fault[i] == FROZEN:
            target[i] = state[i, 1]
        power[i] = propeller_power(params, i, target[i], inflow)
        if fault[i] == FROZEN or fault[i] == RUNAWAY:
            bound_power += power[i]
    rest = power.sum() - bound_power
    left = max(params.power_total_max - bound_power, 0.0)
    if rest > left:
        for i in range(count):
            if fault[i] != FROZEN and fault[i] != RUNAWAY:
                target[i] *= (left / rest) ** (1.0 / 3.0)
    return target


@njit(cache=True)
def propulsion_step(
    params: PropulsionParams,
    state: Array,
    command: Array,
    velocity_rel_b: Array,
    fault: Faults,
    share: Array,
    step_s: float,
) -> PropulsionOutput:
    """Move the thrusters over one macro step.

    Parameters
    ----------
    params : PropulsionParams
    state : float64, shape (n, 2)
    command : float64, shape (n, 2)
        Azimuth [rad], reached the shorter way round, and shaft speed [rev/s], brought within speed, torque and power;
        azimuths do not run backwards. What is not a finite number keeps its present value. Tunnels keep their azimuth.
    velocity_rel_b : float64, shape (3,)
        Of the CoG through the water, held over the step: surge, sway [m/s], yaw rate [rad/s]; not finite: no inflow.
    fault : int64, shape (n,)
        OK, FAILED, FROZEN, LIMITED or RUNAWAY.
    share : float64, shape (n,)
        Of the thrust that a LIMITED thruster still gives, 0 to 1.
    step_s : float
        [s].

    Notes
    -----
    Azimuth and speed are exact for held commands. Their load is averaged with three Gauss points per piece of at most
    `PIECE_MAX_S`. The power limits act on what the drives head for: while one shaft still slows down and another
    already speeds up, the sum may stand above its limit for about a lag.
    """
    count = state.shape[0]
    flow = velocity_rel_b if np.isfinite(velocity_rel_b.sum()) else np.zeros(3)
    target = speed_targets(params, state, command, flow, fault, share)
    out = PropulsionOutput(state.copy(), np.zeros(6), np.empty(count), np.empty(count))
    pieces = max(1, int(np.ceil(step_s / PIECE_MAX_S - 1e-9)))
    for i in range(count):
        gap = 0.0
        if params.azimuthing[i] != 0.0 and np.isfinite(command[i, 0]) and fault[i] != FAILED and fault[i] != FROZEN:
            gap = wrap_angle(command[i, 0] - state[i, 0])
        rise = target[i] - state[i, 1]
        rate, lag = params.speed_rate_max[i], params.speed_lag[i]
        if fault[i] == FAILED:
            lag = params.rundown_lag[i]
            rate = abs(rise) / lag  # the fastest of a plain lag: no limit
        forward, port = 0.0, 0.0
        for k in range(3 * pieces):
            place = (k // 3 + 0.5 + (k % 3 - 1) * np.sqrt(0.15)) / pieces
            weight = (4.0 if k % 3 == 1 else 2.5) / (9.0 * pieces)
            time = place * step_s
            azimuth = limited_lag(state[i, 0], gap, params.azimuth_rate_max[i], params.azimuth_lag[i], time)
            speed = limited_lag(state[i, 1], rise, rate, lag, time)
            thrust = weight * propeller_thrust(params, i, speed, axis_inflow(params, i, azimuth, flow))
            forward += thrust * np.cos(azimuth)
            port += thrust * np.sin(azimuth)
        add_load(out.load_b, params.position[i], forward, port)
        azimuth = limited_lag(state[i, 0], gap, params.azimuth_rate_max[i], params.azimuth_lag[i], step_s)
        out.state[i, 0] = azimuth if -np.pi <= azimuth < np.pi else wrap_angle(azimuth)  # one that rests keeps its bits
        out.state[i, 1] = limited_lag(state[i, 1], rise, rate, lag, step_s)
        inflow = axis_inflow(params, i, azimuth, flow)
        out.thrust[i] = propeller_thrust(params, i, out.state[i, 1], inflow)
        out.power[i] = propeller_power(params, i, out.state[i, 1], inflow)
    return out


@njit(cache=True)
def add_load(load_b: Array, position: Array, forward: float, port: float) -> None:
    """Add, in place, force and moment (6,) of a horizontal thrust [N] at a place (3,) [m] seen from the CoG."""
    load_b[0] += forward
    load_b[1] += port
    load_b[3] -= position[2] * port
    load_b[4] += position[2] * forward
    load_b[5] += position[0] * port - position[1] * forward
