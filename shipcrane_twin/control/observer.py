"""Nonlinear passive observer with wave filter and bias estimate (Fossen and Strand 1999; Fossen 2011, section 11.4.1).

State, float64 (21,): see `control.observer_model`. Its counterpart with the same calls is `control.ekf`.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.control.observer_model import (
    LossParams,
    ShipModel,
    chosen_frequency,
    count_measurement,
    innovation,
    loss_params,
    oscillator,
    per_axis,
    predict_motion,
    shared_start,
    ship_model,
)
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle


class PassiveParams(NamedTuple):
    """Constants of the passive observer; arrays have shape (3,): east, north, yaw.

    Attributes
    ----------
    model : ShipModel
    loss : LossParams
    load_mass : float64
        Mean of surge's and sway's mass twice, inertia of yaw [kg, kg, kg m2]: turns accelerations into loads.
    wave_frequency : float64
        Taken where the caller has none [rad/s].
    wave_damping : float64
        Damping ratio of the wave-frequency oscillators, 0 to 1.
    notch_damping : float64
        Damping ratio that the filter's poles get at the wave frequency; equal to `wave_damping` there is no filter.
    cutoff_ratio : float64
        Cut-off frequency of the pose loop over the wave frequency.
    bias_frequency, bias_damping : float64
        Natural frequency [rad/s] and damping ratio of the slow pair of poles, velocity and bias.
    bias_time_constant : float64
        Of the bias as a first-order Gauss-Markov process [s]; inf for an integrator.
    sample_period : float64
        Longest time that one measurement may stand for [s].
    """

    model: ShipModel
    loss: LossParams
    load_mass: Array
    wave_frequency: Array
    wave_damping: Array
    notch_damping: Array
    cutoff_ratio: Array
    bias_frequency: Array
    bias_damping: Array
    bias_time_constant: Array
    sample_period: Array


def passive_params(
    mass: Array,
    damping: Array,
    period: float,
    *,
    wave_frequency: Array,
    wave_damping: Array,
    notch_damping: Array,
    cutoff_ratio: Array,
    bias_period_s: Array,
    bias_damping: Array,
    bias_time_constant_s: Array,
    sample_period_s: Array,
    lost_after_s: float,
    return_s: float,
) -> PassiveParams:
    """Return the observer's constants.

    Parameters
    ----------
    mass, damping : float64, shape (3, 3)
        Low-frequency model in body axes [kg ...], [N s/m ...].
    period : float
        Time between two updates [s].
    bias_period_s : float64, shape (3,)
        Natural period of velocity and bias estimates [s].
    sample_period_s : float64, shape (3,)
        Of the position reference (twice) and the gyro [s]; at least the period of the updates counts.
    wave_frequency, wave_damping, notch_damping, cutoff_ratio, bias_damping, bias_time_constant_s : float64, shape (3,)
    lost_after_s, return_s : float
        See `PassiveParams` and `LossParams`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """
    model = ship_model(mass, damping, period)
    waves = per_axis("wave_damping", wave_damping, 0.0, 0.9)
    notch = per_axis("notch_damping", notch_damping, 0.0, 2.0)
    if np.any(notch < waves):
        raise ValueError(f"observer: notch_damping {notch} is below wave_damping {waves}: the filter would add waves")
    samples = np.maximum(per_axis("sample_period_s", sample_period_s, 0.0), period)
    if not np.all(samples < lost_after_s):
        raise ValueError(f"observer: lost_after_s {lost_after_s} is below sample_period_s {samples}: every fix is late")
    horizontal = 0.5 * (model.mass[0, 0] + model.mass[1, 1])
    return PassiveParams(
        model=model,
        loss=loss_params(lost_after_s, return_s),
        load_mass=np.array([horizontal, horizontal, model.mass[2, 2]]),
        wave_frequency=per_axis("wave_frequency", wave_frequency, 0.0, 10.0),
        wave_damping=waves,
        notch_damping=notch,
        cutoff_ratio=per_axis("cutoff_ratio", cutoff_ratio, 0.0, 10.0),
        bias_frequency=2.0 * np.pi / per_axis("bias_period_s", bias_period_s, 0.0),
        bias_damping=per_axis("bias_damping", bias_damping, 0.0, 2.0),
        bias_time_constant=per_axis("bias_time_constant_s", bias_time_constant_s, 0.0),
        sample_period=samples,
    )


def passive_start(params: PassiveParams, pose: Array) -> Array:
    """Return the state (21,) at rest at a measured pose (3,); no bias, no waves yet."""
    return shared_start(pose)


@njit(cache=True)
def passive_gains(params: PassiveParams, wave_frequency: Array) -> Array:
    """Return the continuous gains (3, 5) for wave frequencies (3,) [rad/s].

    Columns: K1 of xi [1], K1 of its rate [1/s], K2 [1/s], K3 [N/(m s)], K4 [N/m], in yaw per rad.

    Notes
    -----
    K1 and K2 place the poles of the filter at ``(s^2 + 2 zn w0 s + w0^2)(s + wc)`` (the tuning rules of Fossen and
    Strand 1999; Fossen 2011, section 11.4.1). Well below w0 the rest is third order; K3 and K4 give it the poles
    ``(s + wc - 2 zb wb)(s^2 + 2 zb wb s + wb^2)``. Where a slow sea brings wc near the bias loop, wb gives way, so
    that the first pole stays above wc/2.
    """
    omega = chosen_frequency(params.wave_frequency, wave_frequency)
    gains = np.empty((3, 5))
    for i in range(3):
        cutoff = params.cutoff_ratio[i] * omega[i]
        widening = params.notch_damping[i] - params.wave_damping[i]
        damp = params.bias_damping[i]
        slow = min(params.bias_frequency[i], 0.25 * cutoff / damp)
        fast = cutoff - 2.0 * damp * slow
        gains[i, 0] = -2.0 * widening * params.cutoff_ratio[i]
        gains[i, 1] = 2.0 * widening * omega[i]
        gains[i, 2] = cutoff
        gains[i, 3] = params.load_mass[i] * fast * slow * slow
        gains[i, 4] = params.load_mass[i] * (slow * slow + 2.0 * damp * slow * fast)
    return gains


@njit(cache=True)
def passive_step(
    params: PassiveParams, state: Array, measured: Array, load_b: Array, wave_frequency: Array
) -> Array:
    """Return the state one period later, with the measurement of that time taken in.

    Parameters
    ----------
    params : PassiveParams
    state : float64, shape (21,)
    measured : float64, shape (3,)
        East, north [m] and yaw [rad] of the point that the model's velocity belongs to; nan where there is none,
        between samples or lost. Then that axis is dead reckoned: model, known load, held bias.
    load_b : float64, shape (3,)
        Mean of the known loads since the last update, body axes [N, N, N m].
    wave_frequency : float64, shape (3,)
        [rad/s]; nan takes the nominal one.

    Notes
    -----
    The model moves exactly over the period. Then the innovation e works on the state for the time span that the
    measurement stands for: of ``x' = K e``, ``e' = -(K1b + K2) e`` the exact solution is taken, so that a rare
    sample cannot overshoot, as explicit steps would. With small spans this is the continuous observer.
    """
    new = state.copy()
    period = params.model.period
    yaw = measured[2] if np.isfinite(measured[2]) else state[2]
    predict_motion(params.model, new, load_b, yaw)
    omega = chosen_frequency(params.wave_frequency, wave_frequency)
    gains = passive_gains(params, omega)
    push = np.zeros(3)
    for i in range(3):
        xi, rate = new[9 + i], new[12 + i]
        a, b, c, d = oscillator(omega[i], params.wave_damping[i], period)
        new[9 + i], new[12 + i] = a * xi + b * rate, c * xi + d * rate
        rest = innovation(new, measured, i)
        span = count_measurement(params.loss, new, i, np.isfinite(rest), period, params.sample_period[i])
        if span > 0.0:
            loop = gains[i, 1] + gains[i, 2]
            work = new[18 + i] * rest * (-np.expm1(-loop * span) / loop if loop > 0.0 else span)
            new[9 + i] += gains[i, 0] * work
            new[12 + i] += gains[i, 1] * work
            new[i] += gains[i, 2] * work
            # the bias fades only while it is measured: dead reckoning holds it
            new[6 + i] = np.exp(-span / params.bias_time_constant[i]) * new[6 + i] + gains[i, 3] * work
            push[i] = gains[i, 4] * work
    new[2] = wrap_angle(new[2])
    add_impulse(params.model, new, push, yaw)
    return new


@njit(cache=True)
def add_impulse(model: ShipModel, state: Array, impulse_w: Array, yaw: float) -> None:
    """Change the velocity of a state in place by an impulse (3,) in the world [N s, N s, N m s]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    forward = cos * impulse_w[0] + sin * impulse_w[1]
    port = -sin * impulse_w[0] + cos * impulse_w[1]
    for i in range(3):
        inverse = model.mass_inverse[i]
        state[3 + i] += inverse[0] * forward + inverse[1] * port + inverse[2] * impulse_w[2]
