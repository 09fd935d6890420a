"""Thrust allocation: from the load that the controller asks for to azimuth and thrust of each thruster.

Two quadratic programs per period. The first finds the thrust that gives the load, or as much of it as the thrusters
can, for the least power and outside the forbidden zones, as if thrusters turned at once. The second comes as near to
that load as azimuths and thrusts that can be reached within the period allow.

Loads are (surge, sway, yaw), body axes about the CoG [N, N, N m]. Row i of every array is one thruster; azimuths run
anticlockwise from forward. State, float64 (n, 4): azimuth [rad] and thrust [N] commanded, sign of a long turn under
way, convex piece of the allowed azimuths in use.
"""

import numpy as np
from numba import njit

from shipcrane_twin.control.allocation_program import static_thrust, track_load
from shipcrane_twin.control.allocation_setup import AllocationParams
from shipcrane_twin.control.azimuth_sectors import reach, turn_towards
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle

PIECE = 3
"""Column of the state that names the convex piece in use; `NO_PIECE` for none yet."""
NO_PIECE = -1.0


@njit(cache=True)
def allocation_start(params: AllocationParams, azimuth: Array) -> Array:
    """Return the state (n, 4) of thrusters at rest that point at azimuths (n,) [rad]; tunnels lie along their axis."""
    state = np.zeros((azimuth.shape[0], 4))
    for i in range(azimuth.shape[0]):
        state[i, 0] = azimuth[i] if params.azimuthing[i] != 0.0 else params.axis[i]
        state[i, PIECE] = NO_PIECE
    return state


@njit(cache=True)
def horizontal_load(params: AllocationParams, azimuth: Array, thrust: Array) -> Array:
    """Return the load (3,) of thrust (n,) [N] along azimuths (n,) [rad], as of thrusters out of the DP's control."""
    load = np.zeros(3)
    for i in range(thrust.shape[0]):
        part = thrust[i] / params.thrust_max[i]
        turn = azimuth[i] if params.azimuthing[i] != 0.0 else 0.0
        load += part * (np.cos(turn) * params.effect[:, 2 * i] + np.sin(turn) * params.effect[:, 2 * i + 1])
    return load * params.load_scale


@njit(cache=True)
def allocate(
    params: AllocationParams, state: Array, load: Array, azimuth_measured: Array, share: Array
) -> tuple[Array, Array]:
    """Run the allocation once.

    Parameters
    ----------
    params : AllocationParams
    state : float64, shape (n, 4)
    load : float64, shape (3,)
        Asked of the thrusters; not finite: the commands stay. The load of thrusters out of service that still push
        is the caller's to take off (`horizontal_load`).
    azimuth_measured : float64, shape (n,)
        [rad]; not finite: taken as commanded.
    share : float64, shape (n,)
        Of the full thrust that a thruster may give; 0 is out of service, and gets no thrust from now on.

    Returns
    -------
    state : float64, shape (n, 4)
        Its first two columns are the commands: azimuth [rad], thrust [N] (tunnels both ways).
    achieved : float64, shape (3,)
        Load of the commands.
    """
    count = state.shape[0]
    new = state.copy()
    if np.isfinite(load.sum()):
        given = np.array([min(part, 1.0) if part > 0.0 else 0.0 for part in share])
        wanted, piece = static_thrust(params, load, given, state[:, PIECE].copy())
        sector, upper = np.zeros((count, 4)), np.zeros(count)
        for i in range(count):
            new[i, PIECE] = piece[i]
            sector[i], upper[i], new[i, 2] = thruster_reach(
                params, i, state[i], wanted[2 * i : 2 * i + 2], azimuth_measured[i], given[i]
            )
        new[:, :2] = track_load(params, state, wanted, sector, upper)
    return new, horizontal_load(params, new[:, 0], new[:, 1])


@njit(cache=True)
def thruster_reach(
    params: AllocationParams, i: int, state: Array, wanted: Array, measured: float, share: float
) -> tuple[Array, float, float]:
    """Return what thruster i can do in this period.

    ``wanted`` (2,) is its thrust over full thrust, ``state`` (4,) its state.

    Returns
    -------
    sector : float64, shape (4,)
        Azimuth now, turns from and to, turn at which it aims [rad].
    upper : float
        Largest thrust [N].
    latch : float
    """
    sector = np.zeros(4)
    sector[0] = state[0]
    upper = min(share * params.thrust_max[i], abs(state[1]) + params.thrust_step[i])
    if params.azimuthing[i] == 0.0:
        return sector, share * params.thrust_max[i], 0.0
    size = np.hypot(wanted[0], wanted[1]) * params.thrust_max[i]
    goal = np.arctan2(wanted[1], wanted[0]) if size > params.hold_thrust[i] else state[0]
    gap, latch, low, high = turn_towards(params.arcs[i], state[0], goal, state[2])
    start, end = reach(gap, params.azimuth_step[i]) if size > params.hold_thrust[i] else (0.0, 0.0)
    lowered = min(upper, max(abs(state[1]) - params.thrust_step[i], 0.0))
    if low == 0.0 and high == 0.0:
        # inside a forbidden zone: out of it, and no more thrust than a falling one
        upper = lowered
    elif gap < low or gap > high:
        # the goal lies beyond a forbidden zone: wait at its edge for the thrust to end, then cross
        upper = lowered
        if state[1] > 0.0:
            start, end = min(max(start, low), high), min(max(end, low), high)
    else:
        start, end = min(max(start, low), high), min(max(end, low), high)
    lead = wrap_angle(state[0] - measured) if np.isfinite(measured) else 0.0
    if lead > params.lead_max[i]:
        start, end = min(start, 0.0), min(end, 0.0)
    elif lead < -params.lead_max[i]:
        start, end = max(start, 0.0), max(end, 0.0)
    sector[1], sector[2] = start, end
    sector[3] = min(max(gap, start), end)
    return sector, upper, latch
