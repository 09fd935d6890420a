"""Frequency of the waves that the ship meets, from one of its own motions (pitch, roll or heave).

State, float64 (7,): slow part of the signal and its rate (2), resonator and its rate (2), mean squares of the
resonator and of its rate (2), frequency [rad/s].

The position fix is no good signal: with 0.5 m of noise it hides decimetres of wave motion. Heave amidships follows
the waves; pitch and roll answer short waves and their own resonance more, so they read high in a long sea.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

BUTTERWORTH = 0.5**0.5
"""Damping ratio of the second-order filter with the flattest pass band."""


class FrequencyParams(NamedTuple):
    """Constants of the estimator.

    Attributes
    ----------
    nominal, lowest, highest : float
        Frequency at the start and in calm water, and its bounds [rad/s].
    memory_s : float
        Time over which the means forget [s]; tens of wave periods.
    floor : float
        Motion whose standard deviation, in the signal's unit, weighs as much as the nominal frequency; small, so
        that only a calm sea falls back to the nominal.
    damping_ratio : float
        Of the resonator that singles out the waves.
    period : float
        Between two updates [s].
    """

    nominal: float
    lowest: float
    highest: float
    memory_s: float
    floor: float
    damping_ratio: float
    period: float


def frequency_params(
    period: float,
    *,
    nominal: float,
    lowest: float,
    highest: float,
    memory_s: float,
    floor: float,
    damping_ratio: float = 0.2,
) -> FrequencyParams:
    """Return the estimator's constants; ValueError if they are out of range or order."""
    if not 0.0 < lowest <= nominal <= highest < np.pi / period:
        raise ValueError(
            f"wave frequency: lowest {lowest}, nominal {nominal}, highest {highest} rad/s must rise, between 0 and the "
            f"{np.pi / period:.3g} rad/s that a period of {period} s can tell"
        )
    if not (memory_s > 2.0 * np.pi / lowest and floor > 0.0 and 0.0 < damping_ratio < 1.0):
        raise ValueError(
            f"wave frequency: memory_s {memory_s} must exceed the longest wave period {2.0 * np.pi / lowest:.3g} s, "
            f"floor {floor} be > 0 and damping_ratio {damping_ratio} between 0 and 1"
        )
    return FrequencyParams(nominal, lowest, highest, memory_s, floor, damping_ratio, period)


def frequency_start(params: FrequencyParams) -> Array:
    """Return the state (7,) before the first wave."""
    state = np.zeros(7)
    state[6] = params.nominal
    return state


@njit(cache=True)
def frequency_step(params: FrequencyParams, state: Array, signal: float) -> Array:
    """Return the state (7,) one period later; a signal that is not finite leaves it as it is.

    Notes
    -----
    A second-order high-pass at half the lowest frequency takes out the mean and slow motion. A lightly damped
    resonator at the present estimate w singles out the waves near it; for a narrow band the mean squares of its
    rate and value have the ratio of the squared frequency there. The estimate moves to that ratio within
    `memory_s`, whereby the resonator follows the peak. White noise has exactly the ratio w^2: it does not pull.
    All filters are stepped implicitly, so no setting makes them unstable.
    """
    new = state.copy()
    if not np.isfinite(signal):
        return new
    dt = params.period
    corner = 0.5 * params.lowest
    new[0], new[1] = resonator_step(state[0], state[1], signal, corner, BUTTERWORTH, dt)
    fast = signal - new[0] - 2.0 * BUTTERWORTH / corner * new[1]
    new[2], new[3] = resonator_step(state[2], state[3], fast, state[6], params.damping_ratio, dt)
    share = -np.expm1(-dt / params.memory_s)
    new[4] += share * (new[2] * new[2] - state[4])
    new[5] += share * (new[3] * new[3] - state[5])
    # the resonator's gain at its own frequency is 1 / (2 z): the floor is meant for the signal
    floor = (params.floor / (2.0 * params.damping_ratio)) ** 2
    wanted = np.sqrt((new[5] + floor * params.nominal**2) / (new[4] + floor))
    wanted = min(params.highest, max(params.lowest, wanted))
    new[6] = state[6] + share * (wanted - state[6])
    return new


@njit(cache=True)
def resonator_step(
    value: float, rate: float, drive: float, omega: float, damping_ratio: float, dt: float
) -> tuple[float, float]:
    """Return value and rate of ``x'' + 2 z w x' + w^2 x = w^2 u`` one step on; trapezoidal rule, u held."""
    quarter = (0.5 * omega * dt) ** 2 + damping_ratio * omega * dt
    after = ((1.0 - quarter) * rate + dt * omega * omega * (drive - value)) / (1.0 + quarter)
    return value + 0.5 * dt * (rate + after), after


@njit(cache=True)
def heave_step(state: Array, accel_up: float, corner: float, period: float) -> Array:
    """Return heave [m] and its rate (2,) one period later from the vertical acceleration [m/s2] without gravity.

    Double integration above a corner frequency [rad/s], as motion reference units do it; what lies below fades. A
    value that is not finite leaves the state as it is.
    """
    new = state.copy()
    if np.isfinite(accel_up):
        drive = accel_up / (corner * corner)
        new[0], new[1] = resonator_step(state[0], state[1], drive, corner, BUTTERWORTH, period)
    return new


@njit(cache=True)
def wave_frequency(state: Array) -> float:
    """Return the estimated frequency [rad/s] of a state (7,)."""
    return state[6]
