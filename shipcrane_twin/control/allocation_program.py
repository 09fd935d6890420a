"""The two programs of the thrust allocation, see `allocation`, and the pseudo-inverse as their fast stand-in.

Thrust is in parts of each thruster's full thrust, (2 n,): forward and port per azimuth; along its axis and nothing for
a tunnel.
"""

import numpy as np
from numba import njit

from shipcrane_twin.control.allocation_setup import AllocationParams
from shipcrane_twin.control.azimuth_sectors import TURN, arc_place
from shipcrane_twin.control.quadratic_program import IntArray, solve_qp
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle
from shipcrane_twin.physics.linalg import solve_in_place

POLYGON_SIDES = 32
"""Of the polygon inscribed in the circle of an azimuth's thrust: it gives away ``1 - cos(pi / 32)`` = 0.5 % of the
full thrust at most, in the first program only."""

PIECE_GAIN = 0.1
"""Share of the cost that another piece of the allowed azimuths must save before the thrusters turn to it."""


@njit(cache=True)
def static_thrust(params: AllocationParams, load: Array, share: Array, piece: Array) -> tuple[Array, Array]:
    """Return the thrust (2 n,) for a load (3,) [N, N, N m], any azimuth at once, and the pieces (n,) it lies in.

    ``share`` (n,) of full thrust is there. ``piece`` (n,) holds those in use, to be left for a gain only; -1 for none.
    """
    if params.method != 0:
        return limited_pseudo_inverse(params, load, share), piece.copy()
    count = share.shape[0]
    number = piece_numbers(params, share)
    best, best_piece, best_cost = np.zeros(2 * count), np.zeros(count), np.inf
    found = False
    choices = 1
    for value in number:
        choices *= value
    for choice in range(choices):
        trial, rest, same = np.zeros(count), choice, True
        for i in range(count):
            trial[i] = rest % number[i]
            rest //= number[i]
            same = same and (number[i] == 1 or trial[i] == piece[i])
        rows, limits = static_rows(params, load, share, trial)
        thrust, cost, solved = solve_load(params, rows, limits, share, params.bias, True)
        if same:
            cost *= 1.0 - PIECE_GAIN
        if solved and cost < best_cost:
            best, best_piece, best_cost, found = thrust, trial, cost, True
    if not found:
        return limited_pseudo_inverse(params, load, share), piece.copy()
    for i in range(count):
        if number[i] == 1 and piece[i] >= 0.0:
            best_piece[i] = piece[i]
    return best, best_piece


@njit(cache=True)
def piece_numbers(params: AllocationParams, share: Array) -> IntArray:
    """Return how many pieces each thruster (n,) may choose from."""
    number = np.ones(share.shape[0], dtype=np.int64)
    for i in range(share.shape[0]):
        if params.azimuthing[i] != 0.0 and share[i] > 0.0:
            number[i] = 0
            for k in range(params.pieces.shape[1]):
                number[i] += params.pieces[i, k, 1] > 0.0
    return number


@njit(cache=True)
def load_rows(effect: Array, load: Array, share: Array, height: int) -> tuple[Array, Array]:
    """Return ``height`` rows and limits for the unknowns (thrust, missing load), the first three the load's balance.

    ``effect`` (3, 2 n) and ``load`` (3,) are over the scale of the loads.
    """
    wide = effect.shape[1]
    rows, limits = np.zeros((height, wide + 3)), np.zeros(height)
    for k in range(3):
        limits[k] = load[k]
        rows[k, wide + k] = 1.0
        for j in range(wide):
            rows[k, j] = effect[k, j] if share[j // 2] > 0.0 else 0.0
    return rows, limits


@njit(cache=True)
def static_rows(params: AllocationParams, load: Array, share: Array, piece: Array) -> tuple[Array, Array]:
    """Return rows and limits of the first program; its surge and sway are turned along and across the asked force."""
    count = share.shape[0]
    rows, limits = load_rows(params.effect, load / params.load_scale, share, 3 + (POLYGON_SIDES + 2) * count)
    size = np.hypot(limits[0], limits[1])
    if size > 0.0:
        cos, sin = limits[0] / size, limits[1] / size
        for j in range(2 * count):
            a, b = rows[0, j], rows[1, j]
            rows[0, j], rows[1, j] = cos * a + sin * b, cos * b - sin * a
        limits[0], limits[1] = size, 0.0
    at = 3
    for i in range(count):
        if share[i] == 0.0:
            continue
        if params.azimuthing[i] == 0.0:
            rows[at, 2 * i], rows[at + 1, 2 * i] = 1.0, -1.0
            limits[at], limits[at + 1] = -share[i], -share[i]
            at += 2
            continue
        for k in range(POLYGON_SIDES):
            angle = (k + 0.5) * TURN / POLYGON_SIDES
            rows[at, 2 * i], rows[at, 2 * i + 1] = -np.cos(angle), -np.sin(angle)
            limits[at] = -share[i] * np.cos(np.pi / POLYGON_SIDES)
            at += 1
        start, width = params.pieces[i, int(piece[i]), 0], params.pieces[i, int(piece[i]), 1]
        if width < TURN:
            rows[at, 2 * i], rows[at, 2 * i + 1] = -np.sin(start), np.cos(start)
            rows[at + 1, 2 * i], rows[at + 1, 2 * i + 1] = np.sin(start + width), -np.cos(start + width)
            at += 2
    return rows[:at], limits[:at]


@njit(cache=True)
def solve_load(
    params: AllocationParams, rows: Array, limits: Array, share: Array, centre: Array, turned: bool
) -> tuple[Array, float, bool]:
    """Return the thrust (2 n,) nearest to ``centre`` in power that misses least of the load, its cost, and success."""
    count = share.shape[0]
    weight, middle = np.empty(2 * count + 3), np.zeros(2 * count + 3)
    for i in range(count):
        for j in range(2 * i, 2 * i + 2):
            weight[j] = params.power_share[i]
            middle[j] = centre[j] if share[i] > 0.0 else 0.0
    weight[2 * count] = params.along_weight
    weight[2 * count + 1] = params.across_weight if turned else params.along_weight
    weight[2 * count + 2] = params.yaw_weight
    x, _, solved = solve_qp(weight, middle, rows, limits, 3)
    cost = 0.0
    for j in range(2 * count + 3):
        cost += weight[j] * (x[j] - middle[j]) ** 2
    return x[: 2 * count].copy(), cost, solved


@njit(cache=True)
def track_load(params: AllocationParams, state: Array, wanted: Array, sector: Array, upper: Array) -> Array:
    """Return the commands (n, 2): azimuth [rad] and thrust [N] within reach, nearest to the load of ``wanted`` (2 n,).

    ``sector`` (n, 4) and ``upper`` (n,) come from `allocation.thruster_reach`, ``state`` (n, 4) is the present one.
    """
    count = upper.shape[0]
    part = upper / params.thrust_max
    effect, frame = turned_effect(params, sector)
    centre, low = np.zeros(2 * count), np.zeros(count)
    for i in range(count):
        cos, sin = np.cos(frame[i]), np.sin(frame[i])
        centre[2 * i] = cos * wanted[2 * i] + sin * wanted[2 * i + 1]
        centre[2 * i + 1] = cos * wanted[2 * i + 1] - sin * wanted[2 * i]
        before, step = state[i, 1] / params.thrust_max[i], params.thrust_step[i] / params.thrust_max[i]
        if params.azimuthing[i] != 0.0:
            low[i] = min(max(before - step, 0.0), part[i])
        else:
            low[i] = min(max(before - step, -part[i]), part[i])
            part[i] = max(min(before + step, part[i]), low[i])
    out = centre.copy()
    if params.method == 0:
        load = np.zeros(3)
        for j in range(2 * count):
            load += params.effect[:, j] * wanted[j]
        rows, limits = reach_rows(params, effect, load, sector, frame, low, part)
        out, _, solved = solve_load(params, rows, limits, np.ones(count), centre, False)
        if not solved:
            out = centre.copy()
    command = np.empty((count, 2))
    for i in range(count):
        turn, size = sector[i, 3], out[2 * i]
        if params.azimuthing[i] != 0.0:
            if sector[i, 2] > sector[i, 1] and np.hypot(size, out[2 * i + 1]) > 1e-9:
                turn = frame[i] - sector[i, 0] + np.arctan2(out[2 * i + 1], size)
                size = np.hypot(size, out[2 * i + 1])
            turn = min(max(turn, sector[i, 1]), sector[i, 2])
        command[i, 0] = wrap_angle(sector[i, 0] + turn)
        command[i, 1] = min(max(size, low[i]), part[i]) * params.thrust_max[i]
    return command


@njit(cache=True)
def turned_effect(params: AllocationParams, sector: Array) -> tuple[Array, Array]:
    """Return the effect (3, 2 n) of thrust along and across the middle of each sector (n, 4), and these azimuths (n,).

    A sector of one direction leaves no load across it, so that the program puts nothing there.
    """
    count = sector.shape[0]
    frame, effect = np.zeros(count), params.effect.copy()
    for i in range(count):
        if params.azimuthing[i] == 0.0:
            continue
        frame[i] = sector[i, 0] + 0.5 * (sector[i, 1] + sector[i, 2])
        cos, sin = np.cos(frame[i]), np.sin(frame[i])
        wide = 1.0 if sector[i, 2] > sector[i, 1] else 0.0
        for k in range(3):
            a, b = params.effect[k, 2 * i], params.effect[k, 2 * i + 1]
            effect[k, 2 * i], effect[k, 2 * i + 1] = cos * a + sin * b, wide * (cos * b - sin * a)
    return effect, frame


@njit(cache=True)
def reach_rows(
    params: AllocationParams, effect: Array, load: Array, sector: Array, frame: Array, low: Array, part: Array
) -> tuple[Array, Array]:
    """Return rows and limits of the second program.

    The upper limit is tangent to the circle of thrust where the thruster aims; what lies beyond is cut afterwards.
    """
    count = part.shape[0]
    rows, limits = load_rows(effect, load, np.ones(count), 3 + 4 * count)
    at = 3
    for i in range(count):
        aim = 0.0
        if params.azimuthing[i] != 0.0:
            aim = sector[i, 0] + sector[i, 3] - frame[i]
            half = 0.5 * (sector[i, 2] - sector[i, 1])
            if half > 0.0:
                rows[at : at + 2, 2 * i] = np.tan(half)
                rows[at, 2 * i + 1], rows[at + 1, 2 * i + 1] = 1.0, -1.0
                at += 2
        rows[at, 2 * i], limits[at] = 1.0, low[i] * np.cos(aim)
        rows[at + 1, 2 * i], rows[at + 1, 2 * i + 1], limits[at + 1] = -np.cos(aim), -np.sin(aim), -part[i]
        at += 2
    return rows[:at], limits[:at]


@njit(cache=True)
def pseudo_inverse(params: AllocationParams, load: Array, share: Array) -> Array:
    """Return the thrust (2 n,) without limits that gives the load for the least power; least squares if none does."""
    wide = params.effect.shape[1]
    rows, limits = load_rows(params.effect, load / params.load_scale, share, 3)
    missing = limits[:3].copy()
    square = np.zeros((3, 3))
    out = np.zeros(wide)
    for j in range(wide):
        out[j] = params.bias[j] if share[j // 2] > 0.0 else 0.0
        for k in range(3):
            missing[k] -= rows[k, j] * out[j]
            for m in range(3):
                square[k, m] += rows[k, j] * rows[m, j] / params.power_share[j // 2]
    for k in range(3):
        square[k, k] += 1e-11
    if solve_in_place(square, missing):
        for j in range(wide):
            for k in range(3):
                out[j] += rows[k, j] * missing[k] / params.power_share[j // 2]
    return out


@njit(cache=True)
def limited_pseudo_inverse(params: AllocationParams, load: Array, share: Array) -> Array:
    """Return the pseudo-inverse's thrust (2 n,), all thrusters cut by the same factor, out of forbidden zones."""
    thrust = pseudo_inverse(params, load, share)
    cut = 1.0
    for i in range(share.shape[0]):
        size = np.hypot(thrust[2 * i], thrust[2 * i + 1])
        if size > share[i] > 0.0:
            cut = min(cut, share[i] / size)
    thrust *= cut
    for i in range(share.shape[0]):
        azimuth = np.arctan2(thrust[2 * i + 1], thrust[2 * i])
        if params.azimuthing[i] == 0.0 or arc_place(params.arcs[i], azimuth)[0] >= 0:
            continue
        nearest = np.pi
        for arc in params.arcs[i]:
            for edge in (arc[0], arc[0] + arc[1]):
                gap = wrap_angle(edge - azimuth)
                if arc[1] > 0.0 and abs(gap) < abs(nearest):
                    nearest = gap
        size = np.hypot(thrust[2 * i], thrust[2 * i + 1]) * max(np.cos(nearest), 0.0)
        thrust[2 * i] = size * np.cos(azimuth + nearest)
        thrust[2 * i + 1] = size * np.sin(azimuth + nearest)
    return thrust
