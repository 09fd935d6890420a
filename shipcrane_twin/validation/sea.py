"""The realised sea against the spectrum it was drawn from: height, spectrum, directions, crests."""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import stats

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.sea.components import Irregular, Waves, realise, significant_height
from shipcrane_twin.physics.sea.spectra import grid, jonswap
from shipcrane_twin.physics.sea.spreading import spreading_density
from shipcrane_twin.physics.sea.trig import sincos

GRAVITY = 9.80665
HEIGHT, PERIOD, GAMMA = 2.0, 8.0, 3.3
OMEGA = grid(PERIOD)
DENSITY = jonswap(OMEGA, HEIGHT, PERIOD, GAMMA)
STANDARD, FINEST = 0.025, 0.00075
"""Errors of 60 and of 2000 components."""

THREE_HOURS_S = 10800.0
RECORD_STEP_S, RECORD_COUNT = 1.0, 300
RECORD_TIMES: Array = RECORD_STEP_S * np.arange(RECORD_COUNT, dtype=np.float64)
WINDOW = np.hanning(RECORD_COUNT)
LINES = np.arange(27, 84, 3)
"""Ordinates of a record's periodogram, 0.7 to 2.2 peak frequencies; with this window every third is independent."""

CREST_LEVELS = np.array([1.5, 2.0, 2.5, 3.0])
"""In standard deviations. Lower crests are fewer than Rayleigh's law says, because small local ones lie between: that
is theory for a sea of this bandwidth (Cartwright and Longuet-Higgins 1956), not the realisation."""

EXPONENTS = (0.0, 0.5, 1.0, 4.0, 15.0, 75.0, 400.0)


def a_sea(seed: int, error: float) -> Waves:
    """Return a long-crested JONSWAP sea of 2 m and 8 s."""
    system = Irregular(OMEGA, DENSITY, 0.3, np.inf)
    return realise([system], np.random.default_rng(seed), gravity=GRAVITY, depth=np.inf, ramp=0.0, error=error)


@njit(cache=True)
def harmonic_series(amplitude: Array, omega: Array, phase: Array, times: Array) -> Array:
    """Return the sum of cosines at times (m,); the run's own `sincos`."""
    total = np.zeros(times.shape[0])
    for i in range(amplitude.shape[0]):
        for j in range(times.shape[0]):
            total[j] += amplitude[i] * sincos(omega[i] * times[j] + phase[i])[1]
    return total


def series(waves: Waves, times: Array) -> Array:
    """Return the elevation (m,) at the origin at times (m,) [m]."""
    return harmonic_series(waves.amplitude, waves.omega, waves.phase, times)


def height_errors(seeds: range) -> tuple[Array, Array]:
    """Return relative errors of Hs: ``4 std`` of three hours of elevation, and ``4 sqrt(m0)`` of the components."""
    times = np.arange(0.0, THREE_HOURS_S, 0.5)
    seas = [a_sea(seed, STANDARD) for seed in seeds]
    told = np.array([4.0 * series(sea, times).std() / HEIGHT - 1.0 for sea in seas])
    return told, np.array([significant_height(sea) / HEIGHT - 1.0 for sea in seas])


def expected_ordinates(density: Array) -> Array:
    """Return the mean periodogram of a stationary sea, with all that the window and the sampling do to it."""
    covariance = np.asarray(np.trapezoid(density[:, None] * np.cos(np.outer(OMEGA, RECORD_TIMES)), OMEGA, axis=0))
    overlap = np.correlate(WINDOW, WINDOW, "full")[RECORD_COUNT - 1 :]
    turns = np.cos(2.0 * np.pi / RECORD_COUNT * np.outer(LINES, np.arange(RECORD_COUNT)))
    return np.asarray(2.0 * turns @ (overlap * covariance) - overlap[0] * covariance[0])


def ordinates(seeds: range) -> Array:
    """Return periodograms (seeds, lines) of one five-minute record of each sea, 2000 components.

    Five minutes hold some twenty components to an ordinate, enough for its chi-square law. In longer records the test
    would see the lines, and that the energy of a band does not vary.
    """
    records = np.array([series(a_sea(seed, FINEST), RECORD_TIMES) for seed in seeds])
    return np.asarray(np.abs(np.fft.rfft(records * WINDOW, axis=1)[:, LINES]) ** 2)


def rejected(found: Array, density: Array) -> NDArray[np.bool_]:
    """Return whether chi-square at 5 % says that groups of records (groups, records, lines) have another spectrum.

    Notes
    -----
    In a Gaussian sea an ordinate over its mean, times two, is chi-square with 2 degrees of freedom, and a sum over
    independent records has 2 per record. Each such sum is turned into a standard normal deviate by its own
    distribution; their squares add up to chi-square with one degree per line.
    """
    records = found.shape[1]
    share = stats.chi2.cdf(2.0 * (found / expected_ordinates(density)).sum(axis=1), 2 * records)
    statistic = (stats.norm.ppf(np.clip(share, 1e-15, 1.0 - 1e-15)) ** 2).sum(axis=1)
    return np.asarray(statistic > stats.chi2.ppf(0.95, len(LINES)))


def crests(elevation: Array) -> Array:
    """Return the highest elevation between successive upward zero crossings."""
    up = np.flatnonzero((elevation[:-1] <= 0.0) & (elevation[1:] > 0.0))
    return np.asarray(np.maximum.reduceat(elevation, up)[:-1])


def three_hour_crests(seed: int) -> Array:
    """Return the crests of three hours [standard deviations]."""
    return crests(series(a_sea(seed, STANDARD), np.arange(0.0, THREE_HOURS_S, 0.25))) / (HEIGHT / 4.0)


def crests_outside(seeds: range) -> NDArray[np.bool_]:
    """Return whether the number of crests above each level is outside the 95 % band of Rayleigh's law (seeds, 4)."""
    rayleigh = np.exp(-0.5 * CREST_LEVELS**2)
    out = []
    for seed in seeds:
        found = three_hour_crests(seed)
        low, high = stats.binom.interval(0.95, len(found), rayleigh)
        exceeding = (found[:, None] > CREST_LEVELS).sum(axis=0)
        out.append((exceeding < low) | (exceeding > high))
    return np.array(out)


def spreading_errors() -> Array:
    """Return how far the spreading's integral over all directions is from 1, for exponents s from 0 to 400."""
    angle = np.linspace(-np.pi, np.pi, 20001)
    return np.array([np.trapezoid(spreading_density(angle, s), angle) - 1.0 for s in EXPONENTS])


def sea_rows(*, height_seeds: int = 60, spectrum_seeds: int = 400, crest_seeds: int = 40) -> list[Row]:
    """Measure a JONSWAP sea of Hs 2 m, Tp 8 s, gamma 3.3.

    Parameters
    ----------
    height_seeds, spectrum_seeds, crest_seeds : int
        Numbers of seas, each with a seed of its own; `spectrum_seeds` is a multiple of 8.

    Notes
    -----
    A right test at 5 % rejects one sea in twenty: the bar for the share of rejected seas is 5 % and 2.5 standard
    deviations of that share. The sharper test puts the records of an eighth of the seas together.
    """
    told, nominal = height_errors(range(height_seeds))
    found = ordinates(range(spectrum_seeds))
    one_by_one = float(rejected(found[:, None, :], DENSITY).mean())
    bar = 0.05 + 2.5 * np.sqrt(0.05 * 0.95 / spectrum_seeds)
    groups = int(rejected(found.reshape(8, spectrum_seeds // 8, -1), DENSITY).sum())
    outside = float(crests_outside(range(crest_seeds)).mean())
    wrong = float(np.abs(spreading_errors()).max())
    return [
        Row("Hs of a 3-hour realisation", float(np.abs(told).max()), 0.02, "", f"worst of {height_seeds} seeds"),
        Row("Hs as 4 sqrt(m0) of the components", float(np.abs(nominal).max()), 0.02, "", "60 components"),
        Row("seas whose spectrum chi-square at 5 % rejects", one_by_one, float(bar), "", f"of {spectrum_seeds} seeds"),
        Row("the same, groups of seas together", groups, 2.0, "of 8", f"{spectrum_seeds // 8} seas each"),
        Row("spreading integral over all directions", wrong, 0.01, "", "s = 0 to 400"),
        Row("crest exceedances outside Rayleigh's 95 % band", outside, 0.05, "", f"4 levels, {crest_seeds} seeds"),
    ]
