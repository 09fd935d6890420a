"""Gusts: wind spectra, their realisation, the mean wind over height.

The mean wind speed is that over one hour, 10 m above the sea. Gusts blow along the mean wind.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.sea.components import frequency_at
from shipcrane_twin.physics.sea.trig import sincos

HEIGHT, AVERAGING = 10.0, 3600.0
"""To which the mean wind speed refers [m], [s]."""

BAND = (1.0 / 600.0, 0.5)
"""Frequencies in which the Froya spectrum holds [Hz]."""


class Gusts(NamedTuple):
    """Components of realised gusts.

    Attributes
    ----------
    amplitude, omega, phase : float64, shape (n,)
        [m/s], [rad/s], [rad].
    """

    amplitude: Array
    omega: Array
    phase: Array


def grid() -> Array:
    """Return frequencies (n,) [Hz] over `BAND` that resolve any of these spectra."""
    return np.geomspace(*BAND, 1024)


def froya(frequency: Array, mean_speed: float, height: float = HEIGHT) -> Array:
    """Return the gust spectrum of the Norwegian shelf (n,) [m2/s2 per Hz].

    Parameters
    ----------
    frequency : float64, shape (n,)
        [Hz]; meant for `BAND`.
    mean_speed : float
        One hour, 10 m [m/s].
    height : float
        Above the sea [m].

    Notes
    -----
    Andersen and Lovseth (2006), measured on Froya; NORSOK N-003, DNV-RP-C205 section 2.3.
    """
    check(mean_speed, height)
    if mean_speed == 0.0:
        return np.zeros(len(frequency))
    n = 0.468
    reduced = 172.0 * frequency * (height / 10.0) ** (2.0 / 3.0) * (mean_speed / 10.0) ** -0.75
    return 320.0 * (mean_speed / 10.0) ** 2 * (height / 10.0) ** 0.45 / (1.0 + reduced**n) ** (5.0 / (3.0 * n))


def harris(frequency: Array, mean_speed: float, drag: float = 0.003, scale: float = 1800.0) -> Array:
    """Return Harris's gust spectrum (n,) [m2/s2 per Hz], the same at all heights.

    Parameters
    ----------
    frequency : float64, shape (n,)
        [Hz].
    mean_speed : float
        One hour, 10 m [m/s].
    drag, scale : float
        Surface drag coefficient, length scale [m].

    Notes
    -----
    Harris (1971) as in Faltinsen (1990) equation 2.40, ``f S = 4 kappa U^2 x / (2 + x^2)^(5/6)``, ``x = L f / U``; the
    variance over all frequencies is 6.677 kappa U^2. Found over land; Faltinsen advises against it below 0.01 Hz.
    """
    check(mean_speed, scale)
    if not drag >= 0.0:
        raise ValueError(f"Harris spectrum: the drag coefficient is {drag:g}, expected 0 or more (sea: 0.003)")
    if mean_speed == 0.0:
        return np.zeros(len(frequency))
    reduced = scale * frequency / mean_speed
    return 4.0 * drag * scale * mean_speed / (2.0 + reduced**2) ** (5.0 / 6.0)


def froya_profile(mean_speed: float, height: float, averaging: float = AVERAGING) -> float:
    """Return the mean wind speed [m/s] at a height [m], the highest one over a shorter time [s] in the hour.

    Notes
    -----
    NORSOK N-003, DNV-RP-C205 section 2.3: logarithmic in height and, up to one hour, in time.
    """
    check(mean_speed, height)
    if not 1.0 <= averaging <= AVERAGING:
        raise ValueError(f"wind profile: averaging over {averaging:g} s, expected 1 to {AVERAGING:g}")
    hourly = mean_speed * (1.0 + 5.73e-2 * np.sqrt(1.0 + 0.15 * mean_speed) * np.log(height / 10.0))
    intensity = 0.06 * (1.0 + 0.043 * mean_speed) * (height / 10.0) ** -0.22
    return float(max(0.0, hourly * (1.0 - 0.41 * intensity * np.log(averaging / AVERAGING))))


def realise_gusts(frequency: Array, density: Array, rng: np.random.Generator, count: int = 60) -> Gusts:
    """Return gusts drawn from a spectrum.

    Parameters
    ----------
    frequency, density : float64, shape (n,)
        Rising [Hz], and energy there [m2/s2 per Hz], linear in between, none outside.
    rng : numpy.random.Generator
    count : int
        Components, 20 to 2000; the excess kurtosis is -1.5 over their number.

    Raises
    ------
    ValueError
        If the spectrum or the count is out of range.

    Notes
    -----
    One frequency in each of ``count`` bins of equal energy and a random phase, rounded, as in `components.realise`.
    """
    if not 20 <= count <= 2000:
        raise ValueError(f"gusts: {count} components, expected 20 to 2000")
    columns = len(frequency) == len(density) > 1
    if not (columns and frequency[0] > 0.0 and (np.diff(frequency) > 0.0).all()):
        raise ValueError("gusts: frequencies must be positive and rising, with one density each, at least 2 [Hz]")
    if not (np.isfinite(density).all() and np.min(density) >= 0.0):
        raise ValueError("gusts: densities must be finite and not negative [m2/s2 per Hz]")
    drawn = rng.random((count, 2))
    place = frequency_at((np.arange(count) + drawn[:, 0]) / count, frequency, density)
    variance = np.trapezoid(density, frequency)
    return Gusts(
        amplitude=np.round(np.full(count, np.sqrt(2.0 * variance / count)), 9),
        omega=np.round(2.0 * np.pi * place, 9),
        phase=np.round(2.0 * np.pi * drawn[:, 1], 9),
    )


@njit(cache=True)
def gust(gusts: Gusts, t: float) -> float:
    """Return what the wind blows above its mean at time t [s], along the mean wind [m/s]."""
    total = 0.0
    for i in range(gusts.amplitude.shape[0]):
        total += gusts.amplitude[i] * sincos(gusts.omega[i] * t + gusts.phase[i])[1]
    return total


def check(mean_speed: float, length: float) -> None:
    """Refuse speeds and lengths that no wind has."""
    if not 0.0 <= mean_speed < np.inf:
        raise ValueError(f"wind: the mean speed is {mean_speed:g} m/s, expected 0 or more")
    if not 0.0 < length < np.inf:
        raise ValueError(f"wind: the height or length scale is {length:g} m, expected above 0")
