"""Statistics of the realised elevation over many seeds: height, spectrum, crests."""

import numpy as np
import pytest
from scipy import stats
from sea_series import DENSITY, GAMMA, HEIGHT, OMEGA, PERIOD, jonswap_sea, series

from shipcrane_twin.physics.sea.components import significant_height
from shipcrane_twin.physics.sea.spectra import jonswap

STEP, NUMBER = 1.0, 300
TIMES = STEP * np.arange(NUMBER)
WINDOW = np.hanning(NUMBER)
SPACING = 3
"""Ordinates of a periodogram with this window are independent when so far apart."""

LINES = np.arange(27, 84, SPACING)
"""Ordinates from 0.7 to 2.2 peak frequencies."""


def test_significant_height_of_three_hours(measured):
    times = np.arange(0.0, 10800.0, 0.5)
    wrong = [abs(4.0 * series(jonswap_sea(seed), times).std() / HEIGHT - 1.0) for seed in range(60)]
    measured("Hs of a 3-hour realisation, 60 components, worst of 60 seeds", 100.0 * max(wrong), 2.0, "%")
    nominal = [abs(significant_height(jonswap_sea(seed)) / HEIGHT - 1.0) for seed in range(60)]
    measured("Hs as 4 sqrt(m0) of the components, worst of 60 seeds", 100.0 * max(nominal), 2.0, "%")


def expected_ordinates(density):
    """Mean periodogram of a stationary sea with this spectrum, with all that the window and the sampling do to it."""
    covariance = np.trapezoid(density[:, None] * np.cos(np.outer(OMEGA, TIMES)), OMEGA, axis=0)
    overlap = np.correlate(WINDOW, WINDOW, "full")[NUMBER - 1 :]
    turns = np.cos(2.0 * np.pi / NUMBER * np.outer(LINES, np.arange(NUMBER)))
    return 2.0 * turns @ (overlap * covariance) - overlap[0] * covariance[0]


@pytest.fixture(scope="module")
def ordinates():
    """Periodograms of one five-minute record of each of 400 seas with 2000 components."""
    records = np.array([series(jonswap_sea(seed, 0.00075), TIMES) for seed in range(400)])
    return np.abs(np.fft.rfft(records * WINDOW, axis=1)[:, LINES]) ** 2


def rejected(ordinates, density):
    """Whether chi-square at 5 % says that groups of records (groups, records, lines) have another spectrum.

    In a Gaussian sea an ordinate over its mean, times two, is chi-square with 2 degrees of freedom, and a sum over
    independent records has 2 per record. Each such sum is turned into a standard normal deviate by its own
    distribution; their squares add up to chi-square with one degree per line.
    """
    records = ordinates.shape[1]
    share = stats.chi2.cdf(2.0 * (ordinates / expected_ordinates(density)).sum(axis=1), 2 * records)
    statistic = (stats.norm.ppf(np.clip(share, 1e-15, 1.0 - 1e-15)) ** 2).sum(axis=1)
    return statistic > stats.chi2.ppf(0.95, len(LINES))


def test_spectrum_of_the_realised_elevation(ordinates, measured):
    # Five minutes hold some twenty components to an ordinate, enough for its chi-square law; so the test must reject
    # one record in twenty. In longer records it would see the lines, and that a band's energy does not vary.
    one_by_one = rejected(ordinates[:, None, :], DENSITY).mean()
    bar = 0.05 + 2.5 * np.sqrt(0.05 * 0.95 / 400)
    measured(
        "spectrum: five-minute seas that chi-square at 5 % rejects, 400 seeds", 100.0 * one_by_one, 100.0 * bar, "%"
    )
    assert one_by_one > 0.05 - 2.5 * np.sqrt(0.05 * 0.95 / 400)  # or the test would be blind
    groups = ordinates.reshape(8, 50, -1)
    measured("spectrum: of 8 groups of 50 seas, rejected by chi-square at 5 %", rejected(groups, DENSITY).sum(), 2)


@pytest.mark.parametrize(
    ("height", "period", "gamma"),
    [
        (HEIGHT, PERIOD, 1.5),
        (HEIGHT, 1.05 * PERIOD, GAMMA),
        (1.08 * HEIGHT, PERIOD, GAMMA),
        (HEIGHT, 0.96 * PERIOD, GAMMA),
    ],
)
def test_chi_square_tells_the_spectrum_from_its_neighbours(ordinates, height, period, gamma):
    groups = ordinates.reshape(4, 100, -1)
    assert rejected(groups, jonswap(OMEGA, height, period, gamma)).all()


def test_places_of_the_components_in_their_bins_are_uniform():
    # The spectrum that 60 lines realise, whatever the length of the record: their places are independent and uniform.
    below = np.concatenate([[0.0], np.cumsum(0.5 * (DENSITY[1:] + DENSITY[:-1]) * np.diff(OMEGA))])
    places = [60 / 0.999 * np.interp(jonswap_sea(seed).omega, OMEGA, below) / below[-1] % 1.0 for seed in range(200)]
    counts = np.array([np.histogram(place, 6, (0.0, 1.0))[0] for place in places])
    p_values = stats.chisquare(counts, axis=1).pvalue
    assert 0.01 < np.mean(p_values < 0.05) < 0.10
    assert stats.chisquare(counts.sum(axis=0)).pvalue > 0.001


def crests(elevation):
    """Highest elevation between successive upward zero crossings."""
    up = np.flatnonzero((elevation[:-1] <= 0.0) & (elevation[1:] > 0.0))
    return np.maximum.reduceat(elevation, up)[:-1]


def test_exceedance_of_crests(measured):
    # Crests of 3 hours against Rayleigh's law. Below 1.5 standard deviations a sea of this bandwidth has fewer, because
    # small local crests lie between; that is theory (Cartwright and Longuet-Higgins 1956), not the realisation.
    times = np.arange(0.0, 10800.0, 0.25)
    level = np.array([1.5, 2.0, 2.5, 3.0])
    rayleigh = np.exp(-0.5 * level**2)
    outside = []
    for seed in range(40):
        found = crests(series(jonswap_sea(seed), times)) / (HEIGHT / 4.0)
        low, high = stats.binom.interval(0.95, len(found), rayleigh)
        exceeding = (found[:, None] > level).sum(axis=0)
        outside.append((exceeding < low) | (exceeding > high))
    measured("crest exceedances outside Rayleigh's 95 % band, 4 levels, 40 seeds", 100.0 * np.mean(outside), 5.0, "%")
    assert np.mean(outside, axis=0).max() <= 0.15
