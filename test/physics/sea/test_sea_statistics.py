"""Statistics of the realised elevation over many seeds, by the experiments of the validation page."""

import numpy as np
import pytest
from scipy import stats
from sea_series import DENSITY, GAMMA, HEIGHT, OMEGA, PERIOD, jonswap_sea

from shipcrane_twin.physics.sea.spectra import jonswap
from shipcrane_twin.validation import sea
from shipcrane_twin.validation.sea import rejected


def test_significant_height_of_three_hours(measured):
    told, nominal = sea.height_errors(range(60))
    measured("Hs of a 3-hour realisation, 60 components, worst of 60 seeds", 100.0 * np.abs(told).max(), 2.0, "%")
    measured("Hs as 4 sqrt(m0) of the components, worst of 60 seeds", 100.0 * np.abs(nominal).max(), 2.0, "%")


@pytest.fixture(scope="module")
def ordinates():
    return sea.ordinates(range(400))


def test_spectrum_of_the_realised_elevation(ordinates, measured):
    # a right test must reject one record in twenty
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


def test_exceedance_of_crests(measured):
    outside = sea.crests_outside(range(40))
    measured("crest exceedances outside Rayleigh's 95 % band, 4 levels, 40 seeds", 100.0 * np.mean(outside), 5.0, "%")
    assert np.mean(outside, axis=0).max() <= 0.15


def test_the_rows_of_the_page_hold_their_bars():
    rows = sea.sea_rows()
    assert len(rows) == 6
    assert all(row.holds for row in rows)
