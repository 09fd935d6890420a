"""Current: a mean, a slow random variation, a profile over depth."""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


class Current(NamedTuple):
    """A realised current.

    Attributes
    ----------
    step : float
        Of the time grid, which starts at t = 0 [s].
    velocity : float64, shape (m, 2)
        East and north at the times of the grid [m/s].
    """

    step: float
    velocity: Array


def realise_current(
    mean_speed: float,
    direction: float,
    deviation: float,
    time_constant: float,
    duration: float,
    rng: np.random.Generator,
    step: float = 1.0,
) -> Current:
    """Return a current that varies about its mean as a Gauss-Markov process of first order.

    Parameters
    ----------
    mean_speed, direction : float
        [m/s]; where the current goes, anticlockwise from east [rad].
    deviation : float
        Standard deviation of the east and of the north component [m/s]; 0 for a steady current.
    time_constant : float
        After which the autocorrelation has fallen to 1/e [s].
    duration : float
        Length of the run [s]; after it the current stays as it is.
    rng : numpy.random.Generator
        Two normal numbers per time are drawn in the order of time, so a longer run begins like a shorter one.
    step : float
        Of the time grid [s]; independent of the simulation's step, so that does not change the current.

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    Each horizontal component obeys ``v' = -v / T + noise`` (Fossen 2021, chapter 10, there for speed and angle;
    components have no singular direction in slack water). Exact discretisation
    ``v_k+1 = e v_k + s sqrt(1 - e^2) n_k`` with ``e = exp(-step / T)``, and a stationary start. Linear interpolation
    between the times takes about ``step / (3 T)`` of the variance.
    """
    if not (0.0 <= mean_speed < np.inf and 0.0 <= deviation < np.inf and np.isfinite(direction)):
        raise ValueError(
            f"current: mean speed {mean_speed:g} m/s, deviation {deviation:g} m/s, direction {direction:g} rad; "
            "expected finite numbers, speeds of 0 or more"
        )
    if not (0.0 < step < np.inf and time_constant >= 5.0 * step and np.isfinite(time_constant)):
        raise ValueError(f"current: time constant {time_constant:g} s, expected at least 5 steps of {step:g} s")
    if not 0.0 <= duration < np.inf:
        raise ValueError(f"current: the duration is {duration:g} s, expected 0 or more")
    mean = np.array([round(mean_speed * float(f(direction)), 12) for f in (np.cos, np.sin)])
    if deviation == 0.0:
        return Current(step=float(step), velocity=mean[None, :])
    count = int(np.ceil(duration / step)) + 1
    noise = deviation * rng.standard_normal((count, 2))
    # Rounded, so that the exponential of every mathematical library leads to the same bits.
    kept = float(np.round(np.exp(-step / time_constant), 12))
    velocity: Array = np.empty((count, 2))
    velocity[0] = noise[0]
    renewed = np.sqrt(1.0 - kept * kept) * noise
    for k in range(1, count):
        velocity[k] = kept * velocity[k - 1] + renewed[k]
    return Current(step=float(step), velocity=mean + velocity)


@njit(cache=True)
def current_at(current: Current, t: float) -> Array:
    """Return the current (2,), east and north [m/s], at time t [s]; held before the start and after the end."""
    velocity = current.velocity
    last = velocity.shape[0] - 1
    place = min(max(t / current.step, 0.0), float(last))
    low = min(int(place), max(last - 1, 0))
    high = min(low + 1, last)
    share = place - low
    out = np.empty(2)
    for k in range(2):
        out[k] = (1.0 - share) * velocity[low, k] + share * velocity[high, k]
    return out


def mean_factor(depth: Array, factor: Array, draught: float) -> float:
    """Return the share of the surface current that acts on a hull on average over its draught.

    Parameters
    ----------
    depth, factor : float64, shape (k,)
        Below the surface [m], from 0 rising; current there over that at the surface, linear in between, held below.
    draught : float
        [m].

    Raises
    ------
    ValueError
        If the profile does not start at the surface or is out of order.

    Notes
    -----
    Loads from coefficient tables take one velocity; its mean over the draught keeps the mean drag right to
    first order in the shear.
    """
    depth, factor = np.asarray(depth, float), np.asarray(factor, float)
    columns = depth.ndim == 1 and depth.shape == factor.shape and len(depth) > 0
    if not (columns and depth[0] == 0.0 and (np.diff(depth) > 0.0).all()):
        raise ValueError("current profile: depths must rise from 0, with one factor each [m]")
    if not (np.isfinite(factor).all() and 0.0 < draught < np.inf):
        raise ValueError(f"current profile: draught {draught:g} m, factors {factor}; expected finite numbers")
    inside = np.append(depth[depth < draught], draught)
    return float(np.trapezoid(np.interp(inside, depth, factor), inside) / draught)
