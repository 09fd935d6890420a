"""What both observers of the horizontal motion share: layout of the state, model of the ship, loss of a measurement.

The measured pose is the sum of a low-frequency pose, driven by known loads and an unknown slow bias, and of a
wave-frequency motion, one lightly damped oscillator per axis (Fossen 2011, section 11.4).

State, float64 (21,), at the front of each observer's own: low-frequency pose in the world (3), velocity in body axes
(3), bias load in the world (3), wave-frequency states xi (3) and their rates (3), time since the last measurement
per axis (3), trust in the measurement per axis (3). The wave-frequency motion is the rate part of xi. World axes are
(east, north, yaw), body axes (forward, port, yaw), units m, rad, N and N m. A measurement that is not finite is none.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.linalg import expm

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle

POSE, VELOCITY, BIAS = slice(0, 3), slice(3, 6), slice(6, 9)
WAVE_STATE, WAVE, AGE, TRUST = slice(9, 12), slice(12, 15), slice(15, 18), slice(18, 21)
MODEL_STATES, SHARED_STATES = 15, 21


class ShipModel(NamedTuple):
    """The ship's low-frequency motion M dv/dt + D v = load in body axes, and the observer's period.

    Attributes
    ----------
    mass : float64, shape (3, 3)
        With low-frequency added mass [kg, kg m, kg m2].
    mass_inverse : float64, shape (3, 3)
    damping : float64, shape (3, 3)
        Linear damping [N s/m, ...].
    transition, response : float64, shape (3, 3)
        Velocity after one period is ``transition @ velocity + response @ load`` for a held load, exactly.
    period : float
        Time between two updates [s].
    """

    mass: Array
    mass_inverse: Array
    damping: Array
    transition: Array
    response: Array
    period: float


class LossParams(NamedTuple):
    """When a measurement counts as lost, and how the observer takes it back.

    Attributes
    ----------
    lost_after_s : float
        Age of the last measurement from which its axis is dead reckoned [s].
    return_s : float
        Time of measuring over which the gains rise from zero again after a loss [s]; 0 for at once.
    """

    lost_after_s: float
    return_s: float


def ship_model(mass: Array, damping: Array, period: float) -> ShipModel:
    """Return the model; the response to a held load comes from one exponential (Van Loan 1978).

    Raises
    ------
    ValueError
        If the mass is not symmetric positive definite or the period not positive.
    """
    mass, damping = np.array(mass, dtype=np.float64), np.array(damping, dtype=np.float64)
    if not np.allclose(mass, mass.T) or np.min(np.linalg.eigvalsh(mass)) <= 0.0:
        raise ValueError("observer: mass must be symmetric positive definite; give the rigid body's with added mass")
    if not period > 0.0:
        raise ValueError(f"observer: period is {period} s, it must be > 0")
    inverse: Array = np.linalg.inv(mass).astype(np.float64)
    block = np.zeros((6, 6))
    block[:3, :3] = -inverse @ damping * period
    block[:3, 3:] = inverse * period
    exponential = expm(block)
    return ShipModel(mass, inverse, damping, exponential[:3, :3].copy(), exponential[:3, 3:].copy(), float(period))


def per_axis(name: str, values: Array, lowest: float, highest: float = np.inf) -> Array:
    """Return three values as float64 (3,).

    Raises
    ------
    ValueError
        If there are not three, or one is not above ``lowest`` and at most ``highest``.
    """
    out = np.array(values, dtype=np.float64)
    if out.shape != (3,) or not np.all((out > lowest) & (out <= highest)):
        raise ValueError(f"observer: {name} is {values}, expected three values above {lowest} and up to {highest}")
    return out


def loss_params(lost_after_s: float, return_s: float) -> LossParams:
    """Return the constants of a loss; ValueError if a time is negative or not a number."""
    if not (lost_after_s > 0.0 and return_s >= 0.0):
        raise ValueError(f"observer: lost_after_s is {lost_after_s} and return_s {return_s}; need > 0 and >= 0")
    return LossParams(float(lost_after_s), float(return_s))


def shared_start(pose: Array) -> Array:
    """Return the shared state (21,) at rest at a pose (3,) in the world.

    Raises
    ------
    ValueError
        If the pose is not finite: an observer starts from a measurement.
    """
    if not np.all(np.isfinite(pose)):
        raise ValueError(f"observer: start pose is {pose}; wait until position and heading are measured")
    state = np.zeros(SHARED_STATES)
    state[POSE] = pose
    state[2] = wrap_angle(state[2])
    state[TRUST] = 1.0
    return state


@njit(cache=True)
def predict_motion(model: ShipModel, state: Array, load_b: Array, yaw: float) -> None:
    """Move pose and velocity of a state (>= 9,) over one period, in place; a held bias acts with the known load.

    Parameters
    ----------
    model : ShipModel
    state : float64, shape (>= 9,)
    load_b : float64, shape (3,)
        Mean of every known load over the period, body axes; a part that is not finite counts as zero.
    yaw : float
        Heading for the change of axes [rad].
    """
    cos, sin = np.cos(yaw), np.sin(yaw)
    load = np.empty(3)
    load[0] = cos * state[6] + sin * state[7]
    load[1] = -sin * state[6] + cos * state[7]
    load[2] = state[8]
    for i in range(3):
        if np.isfinite(load_b[i]):
            load[i] += load_b[i]
    mean = np.empty(3)
    for i in range(3):
        after = 0.0
        for j in range(3):
            after += model.transition[i, j] * state[3 + j] + model.response[i, j] * load[j]
        mean[i] = 0.5 * (state[3 + i] + after)
    for i in range(3):
        state[3 + i] = 2.0 * mean[i] - state[3 + i]
    state[0] += model.period * (cos * mean[0] - sin * mean[1])
    state[1] += model.period * (sin * mean[0] + cos * mean[1])
    state[2] = wrap_angle(state[2] + model.period * mean[2])


@njit(cache=True)
def oscillator(omega: float, damping_ratio: float, period: float) -> tuple[float, float, float, float]:
    """Return the transition matrix, by rows, of ``x'' + 2 z w x' + w^2 x = 0`` over a period; 0 <= z < 1."""
    ringing = omega * np.sqrt(1.0 - damping_ratio * damping_ratio)
    loss = damping_ratio * omega / ringing
    decay = np.exp(-damping_ratio * omega * period)
    cos, sin = decay * np.cos(ringing * period), decay * np.sin(ringing * period)
    return cos + loss * sin, sin / ringing, -omega * omega / ringing * sin, cos - loss * sin


@njit(cache=True)
def chosen_frequency(nominal: Array, wave_frequency: Array) -> Array:
    """Return wave frequencies (3,) [rad/s]: the given ones, or where these are not positive numbers the nominal."""
    out = nominal.copy()
    for i in range(3):
        if np.isfinite(wave_frequency[i]) and wave_frequency[i] > 0.0:
            out[i] = wave_frequency[i]
    return out


@njit(cache=True)
def innovation(state: Array, measured: Array, i: int) -> float:
    """Return what the measurement of axis i says beyond the estimate, yaw the short way round; nan for none."""
    if not np.isfinite(measured[i]):
        return np.nan
    rest = measured[i] - state[i] - state[12 + i]
    return wrap_angle(rest) if i == 2 else rest


@njit(cache=True)
def count_measurement(loss: LossParams, state: Array, i: int, measured: bool, period: float, span_max: float) -> float:
    """Keep the books of axis i in place; return the time for which its measurement stands [s], 0 for none.

    After a loss the trust starts at zero and grows with the time measured, so that the estimate returns smoothly.
    """
    age = state[15 + i] + period
    if not measured:
        state[15 + i] = age
        return 0.0
    span = min(age, span_max)
    if age > loss.lost_after_s:
        state[18 + i] = 0.0
    rise = span / loss.return_s if loss.return_s > 0.0 else 1.0
    state[18 + i] = min(1.0, state[18 + i] + rise)
    state[15 + i] = 0.0
    return span


@njit(cache=True)
def observer_pose(state: Array) -> Array:
    """Return the low-frequency pose (3,): east, north [m], yaw in [-pi, pi) [rad]."""
    return state[0:3].copy()


@njit(cache=True)
def observer_velocity(state: Array) -> Array:
    """Return the low-frequency velocity over ground (3,) in body axes [m/s, m/s, rad/s]."""
    return state[3:6].copy()


@njit(cache=True)
def observer_bias(state: Array) -> Array:
    """Return the bias load (3,) in body axes [N, N, N m]: current, drift and all else that no one told."""
    cos, sin = np.cos(state[2]), np.sin(state[2])
    return np.array([cos * state[6] + sin * state[7], -sin * state[6] + cos * state[7], state[8]])


@njit(cache=True)
def observer_wave(state: Array) -> Array:
    """Return the wave-frequency motion (3,) in the world [m, m, rad]."""
    return state[12:15].copy()


@njit(cache=True)
def observer_age(state: Array) -> Array:
    """Return the time since the last measurement of east, north and yaw (3,) [s]."""
    return state[15:18].copy()
