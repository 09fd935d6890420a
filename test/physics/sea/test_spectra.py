"""Wave spectra: energy, peaks, tails, published forms, and what they refuse."""

import numpy as np
import pytest

from shipcrane_twin.physics.sea.spectra import grid, jonswap, pierson_moskowitz, torsethaugen

G = 9.80665
SEAS = [(0.5, 4.0), (2.0, 8.0), (5.0, 9.5), (3.0, 16.0), (12.0, 15.0)]
SPECTRA = {
    "pierson_moskowitz": pierson_moskowitz,
    "jonswap 1.5": lambda w, h, t: jonswap(w, h, t, 1.5),
    "jonswap 3.3": lambda w, h, t: jonswap(w, h, t, 3.3),
    "jonswap 7": lambda w, h, t: jonswap(w, h, t, 7.0),
    "torsethaugen": lambda w, h, t: torsethaugen(w, h, t, G),
}


@pytest.mark.parametrize(("height", "period"), SEAS)
@pytest.mark.parametrize("name", SPECTRA)
def test_four_standard_deviations_are_the_significant_height(name, height, period):
    omega = np.geomspace(0.05, 200.0, 20000)
    own = 4.0 * np.sqrt(np.trapezoid(SPECTRA[name](omega, height, period), omega))
    assert own == pytest.approx(height, rel=1e-4)


@pytest.mark.parametrize("name", SPECTRA)
def test_the_grid_resolves_the_spectrum(name):
    omega = grid(8.0)
    own = 4.0 * np.sqrt(np.trapezoid(SPECTRA[name](omega, 2.0, 8.0), omega))
    assert own == pytest.approx(2.0, rel=5e-4)


@pytest.mark.parametrize(("height", "period"), SEAS)
@pytest.mark.parametrize("name", SPECTRA)
def test_the_peak_is_at_the_peak_period(name, height, period):
    omega = np.linspace(0.1, 6.0, 20000)
    density = SPECTRA[name](omega, height, period)
    # Torsethaugen's peak has the tail of the fourth power, and the second peak lies on its flank.
    assert 2.0 * np.pi / omega[np.argmax(density)] == pytest.approx(period, rel=0.015)


def test_pierson_moskowitz_is_jonswap_without_enhancement():
    omega = grid(8.0)
    np.testing.assert_allclose(jonswap(omega, 2.0, 8.0, 1.0), pierson_moskowitz(omega, 2.0, 8.0), rtol=1e-4)


@pytest.mark.parametrize("gamma", [1.5, 3.3, 5.0, 7.0])
def test_jonswap_peak_is_enhanced_as_published(gamma):
    peak = np.array([2.0 * np.pi / 8.0])
    ratio = jonswap(peak, 2.0, 8.0, gamma) / pierson_moskowitz(peak, 2.0, 8.0)
    published = gamma * (1.0 - 0.287 * np.log(gamma))  # the approximate normalisation of DNV-RP-C205
    assert ratio[0] == pytest.approx(published, rel=0.02)


def test_torsethaugen_wind_sea_has_the_published_peaks():
    height, period = 4.0, 8.0  # below 6.6 Hs^(1/3) = 10.48 s: wind sea prevails
    developed = 6.6 * 4.0 ** (1.0 / 3.0)
    part = 0.7 + 0.3 * np.exp(-((2.0 * (developed - period) / (developed - 4.0)) ** 2))
    gamma = 35.0 * (2.0 * np.pi / G * part * height / period**2) ** 0.857
    second, second_period = np.sqrt(1.0 - part**2) * height, developed + 2.0
    check_peaks(height, period, (part * height, period, gamma), (second, second_period, 1.0))


def test_torsethaugen_swell_has_the_published_peaks():
    height, period = 2.0, 14.0
    developed = 6.6 * 2.0 ** (1.0 / 3.0)
    beyond = (period - developed) / (25.0 - developed)
    part = 0.6 + 0.4 * np.exp(-((beyond / 0.3) ** 2))
    gamma = 35.0 * (2.0 * np.pi / G * height / developed**2) ** 0.857 * (1.0 + 6.0 * beyond)
    second = np.sqrt(1.0 - part**2) * height
    second_period = 6.6 * second ** (1.0 / 3.0)
    check_peaks(height, period, (part * height, period, gamma), (second, second_period, 1.0))


def check_peaks(height, period, *peaks):
    for _, at, _ in peaks:
        expected = sum(published_peak(at, own_period, own, gamma) for own, own_period, gamma in peaks)
        found = torsethaugen(np.array([2.0 * np.pi / at]), height, period, G)[0]
        assert found == pytest.approx(expected, rel=0.03)  # their fitted normalisation errs that much


def published_peak(at, period, height, gamma):
    """Torsethaugen and Haver's closed form with its fitted normalisation, at a period; per rad/s."""
    f = period / at
    sigma = 0.07 if f < 1.0 else 0.09
    fitted = 3.26 * (1.0 + 1.1 * np.log(gamma) ** 1.19) / gamma
    enhanced = gamma ** np.exp(-((f - 1.0) ** 2) / (2.0 * sigma**2))
    return height**2 * period / 16.0 * fitted * f**-4 * np.exp(-(f**-4)) * enhanced / (2.0 * np.pi)


@pytest.mark.parametrize(("name", "power"), [("pierson_moskowitz", -5), ("jonswap 3.3", -5), ("torsethaugen", -4)])
def test_the_tail_falls_with_its_power(name, power):
    low, high = SPECTRA[name](np.array([8.0, 16.0]), 2.0, 8.0)
    assert np.log2(high / low) == pytest.approx(power, abs=0.01)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: jonswap(grid(8.0), -1.0, 8.0, 3.3), "height is -1"),
        (lambda: jonswap(grid(8.0), 1.0, 0.0, 3.3), "period is 0"),
        (lambda: jonswap(grid(8.0), 1.0, 8.0, 0.5), "gamma is 0.5"),
        (lambda: jonswap(grid(8.0), 1.0, 8.0, 33.0), "gamma is 33"),
        (lambda: jonswap(np.array([0.0, 1.0]), 1.0, 8.0, 3.3), "positive"),
        (lambda: pierson_moskowitz(np.array([np.nan, 1.0]), 1.0, 8.0), "finite"),
        (lambda: torsethaugen(grid(8.0), 1.0, 30.0, G), "period 30"),
        (lambda: torsethaugen(grid(8.0), 60.0, 8.0, G), "height 60"),
        (lambda: grid(0.0), "period is 0"),
    ],
)
def test_impossible_seas_are_refused(call, word):
    with pytest.raises(ValueError, match=word):
        call()
