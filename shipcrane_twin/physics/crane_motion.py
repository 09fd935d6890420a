"""Crane in motion: one macro step of links, drives and references on a moving base.

The state is float64 of shape (7 n,), seven values for each of n joints, one kind after the other:

- q, qd: joint values and rates [rad, rad/s] or [m, m/s];
- path, its rate, and how far the reference is behind it, in actuator length, see `crane_reference`;
- trim: oil length less reference, see `crane_actuators`;
- 1 while the brake is shut, else 0.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_actuators import (
    ActuatorParams,
    fill_efforts,
    move_oil,
    prepare_drives,
    settle_drives,
    yield_oil,
)
from shipcrane_twin.physics.crane_chain import ChainParams, fill_tip
from shipcrane_twin.physics.crane_dynamics import fill_base_wrench, fill_bias, fill_mass_matrix
from shipcrane_twin.physics.crane_inertia import fill_composite
from shipcrane_twin.physics.crane_links import ChainWork, new_work, place_links
from shipcrane_twin.physics.crane_load import add_tip_acceleration, hang_load
from shipcrane_twin.physics.crane_reference import MotionLimits
from shipcrane_twin.physics.linalg import solve_in_place


@njit(cache=True)
def _derivatives(
    chain: ChainParams,
    drives: Array,
    q: Array,
    qd: Array,
    power: int,
    base: Array,
    work: ChainWork,
    effort: Array,
    qdd: Array,
    wrench_b: Array,
    flags: Ints,
) -> bool:
    """Fill effort, qdd (n,) and wrench_b (6,) of one stage point; mark clipped drives in flags.

    Return False if the mass matrix is not positive definite.
    """
    place_links(chain, q, work)
    fill_mass_matrix(chain, work)
    fill_bias(chain, qd, base, work)
    hang_load(base, work)
    fill_efforts(drives, q, qd, power, effort, flags)
    for i in range(q.shape[0]):
        qdd[i] = effort[i] - work.bias[i]
    solved = solve_in_place(work.mass_matrix, qdd)
    fill_base_wrench(work, qdd, wrench_b)
    return solved


@njit(cache=True)
def _check_step(
    n: int, state: Array, mode: Ints, command: Array, base_prev: Array, base_next: Array, n_micro: int, dt: float
) -> None:
    if state.shape[0] != 7 * n or command.shape[0] != n or mode.shape[0] != n:
        raise ValueError("crane_step: expected a state of 7 n, and a mode and command of n values for n joints")
    if base_prev.shape[0] != 16 or base_next.shape[0] != 16:
        raise ValueError("crane_step: base_prev and base_next hold 16 values, see crane_dynamics")
    if n_micro < 1 or not dt > 0.0:
        raise ValueError("crane_step: expected n_micro >= 1 and dt > 0")


@njit(cache=True)
def _blend(start: Array, end: Array, t: float, out: Array) -> None:
    """Write what lies at the fraction t of the way from start to end."""
    for k in range(out.shape[0]):
        out[k] = start[k] + t * (end[k] - start[k])


@njit(cache=True)
def crane_step(
    chain: ChainParams,
    actuators: ActuatorParams,
    limits: MotionLimits,
    state: Array,
    mode: Ints,
    command: Array,
    power: int,
    base_prev: Array,
    base_next: Array,
    n_micro: int,
    dt: float,
) -> tuple[Array, Array, Array, Ints, Array, Array, Array]:
    """Advance the crane over one macro step by n_micro classical Runge-Kutta steps.

    Parameters
    ----------
    chain, actuators, limits : ChainParams, ActuatorParams, MotionLimits
        The crane.
    state : float64, shape (7 n,)
        At the start of the step, see the head of this module; left untouched.
    mode : int64, shape (n,)
        VELOCITY or POSITION of `crane_reference`, for each joint.
    command : float64, shape (n,)
        Joint rates wanted over the step [rad/s or m/s], or joint values to go to [rad or m].
    power : int
        POWER_ON, POWER_COAST, POWER_BRAKE or POWER_LEAK of `crane_actuators`.
    base_prev, base_next : float64, shape (16,)
        Base motion and load (see `crane_dynamics`) at start and end, each in the base axes of its
        instant; linear in between.
    n_micro : int
        Runge-Kutta steps, at least 1; stable while the fastest servo mode [rad/s] times dt / n_micro < 2.
    dt : float
        Macro step [s].

    Returns
    -------
    state : float64, shape (7 n,)
        At the end of the step.
    wrench_b : float64, shape (6,)
        Mean over the step of force [N] and moment [N m] of the crane on the ship, at the crane_base origin in
        crane_base axes, by Simpson's rule on the stage points (the order of the states).
    effort : float64, shape (n,)
        Joint efforts at the end of the step [N m or N], end stops included.
    flags : int64, shape (n,)
        Sum of FLAG_EFFORT, FLAG_REFUSED, FLAG_SPEED and FLAG_COMMAND.
    tip_b : float64, shape (18,)
        Tip at the end of the step, see `fill_tip`.
    inertia_b : float64, shape (10,)
        Composite inertia at the end of the step, see `composite_inertia`.
    tip_acc_b : float64, shape (3,)
        Mean over the step of the tip's proper acceleration [m/s2].

    Raises
    ------
    ValueError
        If an array has the wrong length, n_micro < 1 or dt <= 0, or a value other than a command is not finite.
    """
    n = chain.kind.shape[0]
    _check_step(n, state, mode, command, base_prev, base_next, n_micro, dt)
    result = state.copy()
    parts = result.reshape((7, n))
    q, qd = parts[0], parts[1]
    flags = np.zeros(n, dtype=np.int64)
    h = dt / n_micro
    drives = prepare_drives(actuators, limits, parts, mode, command, power, 0.5 * h, dt, flags)

    work = new_work(n)
    stage_q, stage_qd, sum_qd, sum_qdd = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    effort, qdd = np.empty(n), np.empty(n)
    base, wrench_b, mean_b, tip_acc_b = np.empty(16), np.empty(6), np.zeros(6), np.zeros(3)
    finite = True
    for micro in range(n_micro):
        stage_q[:] = q
        stage_qd[:] = qd
        sum_qd[:] = 0.0
        sum_qdd[:] = 0.0
        for stage in range(4):
            middle = stage == 1 or stage == 2
            weight = 2.0 / 6.0 if middle else 1.0 / 6.0
            t = (micro + (0.5 if middle else stage / 3.0)) / n_micro
            _blend(base_prev, base_next, t, base)
            if stage == 1 or stage == 3:
                move_oil(drives, (micro + 0.5 * (stage // 2)) * h, 0.5 * h)
            finite &= _derivatives(
                chain, drives, stage_q, stage_qd, power, base, work, effort, qdd, wrench_b, flags
            )
            add_tip_acceleration(work, qdd, weight / n_micro, tip_acc_b)
            for k in range(6):
                mean_b[k] += weight / n_micro * wrench_b[k]
            reach = h if stage == 2 else 0.5 * h
            for i in range(n):
                sum_qd[i] += weight * stage_qd[i]
                sum_qdd[i] += weight * qdd[i]
                stage_q[i] = q[i] + reach * stage_qd[i]
                stage_qd[i] = qd[i] + reach * qdd[i]
        for i in range(n):
            q[i] += h * sum_qd[i]
            qd[i] += h * sum_qdd[i]
        yield_oil(drives, q, h)
    if not finite:
        raise ValueError("crane_step: the mass matrix is not positive definite; is the state finite?")
    settle_drives(drives, dt, parts)
    fill_efforts(drives, q, qd, power, effort, flags)
    tip_b, inertia_b = np.empty(18), np.empty(10)
    place_links(chain, q, work)
    fill_tip(chain, qd, work.rotation_b, work.origin_b, tip_b)
    fill_composite(chain, work, inertia_b)
    return result, mean_b, effort, flags, tip_b, inertia_b, tip_acc_b
