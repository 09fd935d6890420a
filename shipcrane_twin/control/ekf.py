"""Extended Kalman filter of the ship's horizontal motion, with the calls of `control.observer` (Fossen 2011, 11.3).

State, float64 (21 + 225,): see `control.observer_model`, then the covariance (15, 15) of its first 15 numbers.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.control.observer_model import (
    MODEL_STATES,
    SHARED_STATES,
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

N = MODEL_STATES


class EkfParams(NamedTuple):
    """Constants of the filter; arrays have shape (3,): east, north, yaw (body axes for loads).

    Attributes
    ----------
    model : ShipModel
    loss : LossParams
    wave_frequency : float64
        Taken where the caller has none [rad/s].
    wave_damping : float64
        Damping ratio of the wave-frequency oscillators, 0 to 1.
    wave_std : float64
        Standard deviation of the wave-frequency motion [m, m, rad].
    measurement_std : float64
        Of one measurement [m, m, rad].
    velocity_noise : float64, shape (3, 3)
        Covariance of the velocity's disturbance in one period, from white load noise.
    bias_noise : float64
        Variance of the bias's change in one period [N2, N2, N2 m2].
    bias_time_constant : float64
        Of the bias as a first-order Gauss-Markov process [s]; inf for a random walk.
    start_std : float64, shape (15,)
        Standard deviations of the state at the start.
    """

    model: ShipModel
    loss: LossParams
    wave_frequency: Array
    wave_damping: Array
    wave_std: Array
    measurement_std: Array
    velocity_noise: Array
    bias_noise: Array
    bias_time_constant: Array
    start_std: Array


def ekf_params(
    mass: Array,
    damping: Array,
    period: float,
    *,
    wave_frequency: Array,
    wave_damping: Array,
    wave_std: Array,
    measurement_std: Array,
    load_noise: Array,
    bias_walk: Array,
    bias_time_constant_s: Array,
    velocity_start_std: Array,
    bias_start_std: Array,
    lost_after_s: float,
    return_s: float,
) -> EkfParams:
    """Return the filter's constants.

    Parameters
    ----------
    mass, damping : float64, shape (3, 3)
        Low-frequency model in body axes [kg ...], [N s/m ...].
    period : float
        Time between two updates [s].
    load_noise : float64, shape (3,)
        White noise of the loads, body axes: standard deviation of its mean over 1 s [N, N, N m].
    bias_walk : float64, shape (3,)
        Standard deviation by which the bias wanders in 1 s [N, N, N m]; with the square root of time.
    velocity_start_std, bias_start_std : float64, shape (3,)
        Of the ship at the start [m/s, m/s, rad/s], [N, N, N m].
    wave_frequency, wave_damping, wave_std, measurement_std, bias_time_constant_s : float64, shape (3,)
    lost_after_s, return_s : float
        See `EkfParams` and `LossParams`.

    Raises
    ------
    ValueError
        If a value is out of range.
    """
    model = ship_model(mass, damping, period)
    noise = model.mass_inverse * per_axis("load_noise", load_noise, 0.0)
    omega = per_axis("wave_frequency", wave_frequency, 0.0, 10.0)
    waves, fixes = per_axis("wave_std", wave_std, 0.0), per_axis("measurement_std", measurement_std, 0.0)
    velocity = per_axis("velocity_start_std", velocity_start_std, 0.0)
    bias = per_axis("bias_start_std", bias_start_std, 0.0)
    return EkfParams(
        model=model,
        loss=loss_params(lost_after_s, return_s),
        wave_frequency=omega,
        wave_damping=per_axis("wave_damping", wave_damping, 0.0, 0.9),
        wave_std=waves,
        measurement_std=fixes,
        velocity_noise=noise @ noise.T * period,
        bias_noise=per_axis("bias_walk", bias_walk, 0.0) ** 2 * period,
        bias_time_constant=per_axis("bias_time_constant_s", bias_time_constant_s, 0.0),
        start_std=np.concatenate((fixes, velocity, bias, waves / omega, waves)),
    )


def ekf_start(params: EkfParams, pose: Array) -> Array:
    """Return the state (246,) at rest at a measured pose (3,); no bias, no waves yet, but a wide covariance."""
    return np.concatenate((shared_start(pose), np.diag(params.start_std**2).ravel()))


@njit(cache=True)
def ekf_covariance(state: Array) -> Array:
    """Return the covariance (15, 15) of pose, velocity, bias and wave states, as in the state's own units."""
    return state[SHARED_STATES:].reshape((N, N)).copy()


@njit(cache=True)
def motion_jacobian(params: EkfParams, state: Array, omega: Array) -> Array:
    """Return the derivative (15, 15) of the predicted state to the present one.

    Parameters
    ----------
    params : EkfParams
    state : float64, shape (246,)
        Before the prediction.
    omega : float64, shape (3,)
        Wave frequencies [rad/s].
    """
    model = params.model
    dt = model.period
    cos, sin = np.cos(state[2]), np.sin(state[2])
    out = np.zeros((N, N))
    for i in range(3):
        out[i, i] = 1.0
        out[6 + i, 6 + i] = bias_decay(params, state, i)
        a, b, c, d = oscillator(omega[i], params.wave_damping[i], dt)
        out[9 + i, 9 + i], out[9 + i, 12 + i] = a, b
        out[12 + i, 9 + i], out[12 + i, 12 + i] = c, d
    # the bias in body axes turns with the heading
    forward = cos * state[6] + sin * state[7]
    port = -sin * state[6] + cos * state[7]
    for i in range(3):
        to_velocity = model.response[i]
        out[3 + i, 2] = to_velocity[0] * port - to_velocity[1] * forward
        out[3 + i, 6] = to_velocity[0] * cos - to_velocity[1] * sin
        out[3 + i, 7] = to_velocity[0] * sin + to_velocity[1] * cos
        out[3 + i, 8] = to_velocity[2]
        for j in range(3):
            out[3 + i, 3 + j] = model.transition[i, j]
    # the pose moves by the mean of the velocities before and after
    for j in range(2, 9):
        half = 0.5 * dt
        surge, sway, turn = half * out[3, j], half * out[4, j], half * out[5, j]
        if j == 3:
            surge += half
        elif j == 4:
            sway += half
        elif j == 5:
            turn += half
        out[0, j] += cos * surge - sin * sway
        out[1, j] += sin * surge + cos * sway
        out[2, j] += turn
    out[0, 2] -= dt * (sin * state[3] + cos * state[4])
    out[1, 2] += dt * (cos * state[3] - sin * state[4])
    return out


@njit(cache=True)
def bias_decay(params: EkfParams, state: Array, i: int) -> float:
    """Return the share of the bias of axis i left after a period; all of it while the axis is dead reckoned."""
    if state[15 + i] > params.loss.lost_after_s:
        return 1.0
    return np.exp(-params.model.period / params.bias_time_constant[i])


@njit(cache=True)
def predict_covariance(params: EkfParams, jacobian: Array, covariance: Array, omega: Array) -> Array:
    """Return ``F P F^T + Q`` (15, 15), symmetric to the bit."""
    half = np.zeros((N, N))
    for i in range(N):
        for k in range(N):
            factor = jacobian[i, k]
            if factor != 0.0:
                for j in range(N):
                    half[i, j] += factor * covariance[k, j]
    out = np.empty((N, N))
    for i in range(N):
        for j in range(i + 1):
            total = 0.0
            for k in range(N):
                total += half[i, k] * jacobian[j, k]
            out[i, j] = total
    add_process_noise(params, out, omega)
    for i in range(N):
        for j in range(i):
            out[j, i] = out[i, j]
    return out


@njit(cache=True)
def add_process_noise(params: EkfParams, out: Array, omega: Array) -> None:
    """Add Q to the lower triangle of a covariance (15, 15), in place."""
    for i in range(3):
        out[6 + i, 6 + i] += params.bias_noise[i]
        for j in range(i + 1):
            out[3 + i, 3 + j] += params.velocity_noise[i, j]
        # noise that keeps an oscillator's covariance at its stationary value diag(1 / w^2, 1) wave_std^2
        a, b, c, d = oscillator(omega[i], params.wave_damping[i], params.model.period)
        variance, softness = params.wave_std[i] ** 2, 1.0 / (omega[i] * omega[i])
        out[9 + i, 9 + i] += variance * (softness - a * a * softness - b * b)
        out[12 + i, 9 + i] -= variance * (a * c * softness + b * d)
        out[12 + i, 12 + i] += variance * (1.0 - c * c * softness - d * d)


@njit(cache=True)
def take_measurement(state: Array, covariance: Array, i: int, rest: float, variance: float, trust: float) -> None:
    """Take in the innovation of axis i, in place.

    Notes
    -----
    The gain is the Kalman gain times the trust. Joseph's form ``(I - K H) P (I - K H)^T + K R K^T`` holds for every
    gain; for one number measured it is ``P - K v^T - v K^T + s K K^T`` with v = P H^T and s = H P H^T + R.
    """
    spread = covariance[:, i] + covariance[:, 12 + i]
    total = spread[i] + spread[12 + i] + variance
    gain = trust / total * spread
    for k in range(N):
        state[k] += gain[k] * rest
        for j in range(k + 1):
            covariance[k, j] += total * gain[k] * gain[j] - gain[k] * spread[j] - spread[k] * gain[j]
            covariance[j, k] = covariance[k, j]
    state[2] = wrap_angle(state[2])


@njit(cache=True)
def ekf_step(params: EkfParams, state: Array, measured: Array, load_b: Array, wave_frequency: Array) -> Array:
    """Return the state one period later, with the measurement of that time taken in.

    Parameters
    ----------
    params : EkfParams
    state : float64, shape (246,)
    measured, load_b, wave_frequency : float64, shape (3,)
        As for `control.observer.passive_step`.
    """
    new = state.copy()
    omega = chosen_frequency(params.wave_frequency, wave_frequency)
    jacobian = motion_jacobian(params, state, omega)
    covariance = predict_covariance(params, jacobian, ekf_covariance(state), omega)
    predict_motion(params.model, new, load_b, state[2])
    for i in range(3):
        new[6 + i] *= jacobian[6 + i, 6 + i]
        xi, rate = new[9 + i], new[12 + i]
        new[9 + i] = jacobian[9 + i, 9 + i] * xi + jacobian[9 + i, 12 + i] * rate
        new[12 + i] = jacobian[12 + i, 9 + i] * xi + jacobian[12 + i, 12 + i] * rate
    period = params.model.period
    for i in range(3):
        rest = innovation(new, measured, i)
        if count_measurement(params.loss, new, i, np.isfinite(rest), period, period) > 0.0:
            take_measurement(new, covariance, i, rest, params.measurement_std[i] ** 2, new[18 + i])
    new[SHARED_STATES:] = covariance.ravel()
    return new
