"""Crane in motion: flow-controlled joints that follow velocity commands, and one macro step of it all.

The state is float64 of shape (4 n,): q, qd, q_ref, qd_ref (joint values, rates, and the reference that
the servos track). A reference is the volume of oil let into the actuators; the servo is the stiffness
and damping of that oil, so the crane sags under load as oil springs do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_chain import ChainParams, fill_tip
from shipcrane_twin.physics.crane_dynamics import (
    bias_forces,
    fill_base_wrench,
    fill_bias,
    fill_mass_matrix,
    mass_matrix,
)
from shipcrane_twin.physics.crane_inertia import fill_composite
from shipcrane_twin.physics.crane_links import ChainWork, new_work, place_links
from shipcrane_twin.physics.crane_load import add_tip_acceleration, hang_load
from shipcrane_twin.physics.crane_reference import FLAG_EFFORT, MotionLimits, advance_reference
from shipcrane_twin.physics.linalg import solve_in_place


class ServoParams(NamedTuple):
    """Joint servos, each float64 (n,): kp [N m/rad, N/m], kd [N m s/rad, N s/m], effort_max [N m, N]."""

    kp: Array
    kd: Array
    effort_max: Array


def servo_gains(
    chain: ChainParams, q0: Array, frequency_hz: ArrayLike, damping_ratio: ArrayLike
) -> tuple[Array, Array]:
    """Return kp and kd (n,) that give each joint alone this frequency [Hz] and damping at the pose q0 (n,).

    Joints move one another, so in company their frequencies spread to both sides of the one asked for.
    """
    omega = 2.0 * np.pi * np.asarray(frequency_hz, dtype=np.float64)
    inertia = np.diag(mass_matrix(chain, q0))
    return inertia * omega**2, 2.0 * np.asarray(damping_ratio, dtype=np.float64) * inertia * omega


def static_reference(chain: ChainParams, q0: Array, kp: Array, f0: Array, tip_force_b: Array) -> Array:
    """Return q_ref (n,) whose servo pull holds the crane at rest at q0 (n,) under f0 and tip force (3,)."""
    zero = np.zeros(3)
    effort = bias_forces(chain, q0, np.zeros_like(q0), zero, zero, f0, tip_force_b)
    held: Array = q0 + effort / kp
    return held


@njit(cache=True)
def _derivatives(
    chain: ChainParams,
    servo: ServoParams,
    q: Array,
    qd: Array,
    q_ref: Array,
    qd_ref: Array,
    base: Array,
    work: ChainWork,
    effort: Array,
    qdd: Array,
    wrench_b: Array,
    flags: Ints,
) -> bool:
    """Fill effort, qdd (n,) and wrench_b (6,) of one stage point; mark clipped servos in flags.

    Return False if the mass matrix is not positive definite.
    """
    place_links(chain, q, work)
    fill_mass_matrix(chain, work)
    fill_bias(chain, qd, base, work)
    hang_load(base, work)
    for i in range(q.shape[0]):
        pull = servo.kp[i] * (q_ref[i] - q[i]) + servo.kd[i] * (qd_ref[i] - qd[i])
        most = servo.effort_max[i]
        if abs(pull) > most:
            pull = min(max(pull, -most), most)
            flags[i] |= FLAG_EFFORT
        effort[i] = pull
        qdd[i] = pull - work.bias[i]
    solved = solve_in_place(work.mass_matrix, qdd)
    fill_base_wrench(work, qdd, wrench_b)
    return solved


@njit(cache=True)
def _check_step(
    n: int, state: Array, command: Array, base_prev: Array, base_next: Array, n_micro: int, dt: float
) -> None:
    if state.shape[0] != 4 * n or command.shape[0] != n:
        raise ValueError("crane_step: expected a state of 4 n and a command of n values for n joints")
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
    servo: ServoParams,
    limits: MotionLimits,
    state: Array,
    command: Array,
    base_prev: Array,
    base_next: Array,
    n_micro: int,
    dt: float,
) -> tuple[Array, Array, Array, Ints, Array, Array, Array]:
    """Advance the crane over one macro step by n_micro classical Runge-Kutta steps.

    Parameters
    ----------
    chain, servo, limits : ChainParams, ServoParams, MotionLimits
        The crane.
    state : float64, shape (4 n,)
        q, qd, q_ref, qd_ref at the start of the step; left untouched.
    command : float64, shape (n,)
        Joint rates wanted over the step [rad/s or m/s].
    base_prev, base_next : float64, shape (16,)
        Base motion and load (see `crane_dynamics`) at start and end, each in the base axes of its
        instant; linear in between.
    n_micro : int
        Runge-Kutta steps, at least 1; stable while the fastest servo mode [rad/s] times dt / n_micro < 2.
    dt : float
        Macro step [s].

    Returns
    -------
    state : float64, shape (4 n,)
        At the end of the step.
    wrench_b : float64, shape (6,)
        Mean over the step of force [N] and moment [N m] of the crane on the ship, at the crane_base origin in
        crane_base axes, by Simpson's rule on the stage points (the order of the states).
    effort : float64, shape (n,)
        Joint efforts at the end of the step [N m or N].
    flags : int64, shape (n,)
        Sum of FLAG_EFFORT, FLAG_REFUSED and FLAG_SPEED.
    tip_b : float64, shape (18,)
        Tip at the end of the step, see `fill_tip`.
    inertia_b : float64, shape (10,)
        Composite inertia at the end of the step, see `composite_inertia`.
    tip_acc_b : float64, shape (3,)
        Mean over the step of the tip's proper acceleration [m/s2].

    Raises
    ------
    ValueError
        If an array has the wrong length, n_micro < 1 or dt <= 0, or a value is not finite.
    """
    n = chain.kind.shape[0]
    _check_step(n, state, command, base_prev, base_next, n_micro, dt)
    result = state.copy()
    q, qd, q_ref, qd_ref = result[:n], result[n : 2 * n], result[2 * n : 3 * n], result[3 * n :]
    rates, flags = advance_reference(limits, q_ref, qd_ref, command, dt)

    work = new_work(n)
    stage_q, stage_qd, sum_qd, sum_qdd = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    now_ref, now_qd_ref, effort, qdd = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    base, wrench_b, mean_b, tip_acc_b = np.empty(16), np.empty(6), np.zeros(6), np.zeros(3)
    h = dt / n_micro
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
            _blend(qd_ref, rates, t, now_qd_ref)
            for i in range(n):
                now_ref[i] = q_ref[i] + 0.5 * t * dt * (qd_ref[i] + now_qd_ref[i])
            finite &= _derivatives(
                chain, servo, stage_q, stage_qd, now_ref, now_qd_ref, base, work, effort, qdd, wrench_b, flags
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
    if not finite:
        raise ValueError("crane_step: the mass matrix is not positive definite; is the state finite?")
    for i in range(n):
        q_ref[i] += 0.5 * dt * (qd_ref[i] + rates[i])
        qd_ref[i] = rates[i]
        pull = servo.kp[i] * (q_ref[i] - q[i]) + servo.kd[i] * (qd_ref[i] - qd[i])
        effort[i] = min(max(pull, -servo.effort_max[i]), servo.effort_max[i])
    tip_b, inertia_b = np.empty(18), np.empty(10)
    place_links(chain, q, work)
    fill_tip(chain, qd, work.rotation_b, work.origin_b, tip_b)
    fill_composite(chain, work, inertia_b)
    return result, mean_b, effort, flags, tip_b, inertia_b, tip_acc_b
