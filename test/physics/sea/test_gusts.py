"""Gusts: published values, energy, statistics of the realisation, profile, refusals."""

import numpy as np
import pytest
from scipy import integrate, stats
from sea_series import harmonic_series

from shipcrane_twin.physics.sea.gusts import BAND, froya, froya_profile, grid, gust, harris, realise_gusts

SPECTRA = {"froya": froya(grid(), 15.0), "harris": harris(grid(), 15.0)}


def test_froya_at_ten_metres_and_ten_metres_per_second_is_its_formula_without_factors():
    frequency = np.array([0.002, 0.01, 0.1, 0.4])
    expected = 320.0 / (1.0 + (172.0 * frequency) ** 0.468) ** (5.0 / (3.0 * 0.468))
    np.testing.assert_allclose(froya(frequency, 10.0), expected, rtol=1e-12)


def test_froya_scales_with_speed_and_height_as_published():
    assert froya(np.array([0.0]), 30.0, 40.0)[0] == pytest.approx(320.0 * 9.0 * 4.0**0.45)
    higher = froya(np.array([0.01 / 4.0 ** (2.0 / 3.0)]), 10.0, 40.0)[0]
    assert higher == pytest.approx(4.0**0.45 * froya(np.array([0.01]), 10.0, 10.0)[0])
    # f S / U0^2 depends on 172 f (z/10)^(2/3) (U0/10)^(-3/4) alone
    slow, fast = froya(np.array([0.02]), 10.0, 10.0)[0], froya(np.array([0.02 * 2.0**0.75]), 20.0, 10.0)[0]
    assert fast == pytest.approx(4.0 * slow)


def test_froya_has_the_turbulence_that_its_profile_states():
    # 0.06 (1 + 0.043 U) of the hourly mean; the formulas were fitted apart from each other.
    for speed in (10.0, 20.0, 30.0):
        f = np.geomspace(1.0 / 3600.0, 1.0, 4000)
        intensity = np.sqrt(np.trapezoid(froya(f, speed), f)) / speed
        assert intensity == pytest.approx(0.06 * (1.0 + 0.043 * speed), rel=0.25)


def test_harris_has_the_variance_of_its_closed_form():
    variance = integrate.quad(lambda f: harris(np.array([f]), 12.0, 0.002, 1500.0)[0], 0.0, np.inf, limit=500)[0]
    assert variance == pytest.approx(6.677 * 0.002 * 144.0, rel=1e-3)


@pytest.mark.parametrize("spectrum", [froya, harris])
def test_gust_spectra_fall_with_minus_five_thirds(spectrum):
    low, high = spectrum(np.array([1e4, 2e4]), 15.0)
    assert np.log2(high / low) == pytest.approx(-5.0 / 3.0, abs=0.02)


@pytest.mark.parametrize("name", SPECTRA)
def test_realised_gusts_have_the_variance_of_the_spectrum(name):
    variance = np.trapezoid(SPECTRA[name], grid())
    gusts = realise_gusts(grid(), SPECTRA[name], np.random.default_rng(1))
    assert 0.5 * np.sum(gusts.amplitude**2) == pytest.approx(variance, rel=1e-6)
    times = np.arange(0.0, 40000.0, 1.0)
    found = [harmonic_series(*realise_gusts(grid(), SPECTRA[name], np.random.default_rng(s)), times) for s in range(20)]
    assert np.mean([series.var() for series in found]) == pytest.approx(variance, rel=0.03)
    assert abs(np.mean(found)) < 0.01 * np.sqrt(variance)


@pytest.mark.parametrize("name", SPECTRA)
def test_realised_gusts_have_the_shape_of_the_spectrum(name):
    below = np.concatenate([[0.0], np.cumsum(0.5 * (SPECTRA[name][1:] + SPECTRA[name][:-1]) * np.diff(grid()))])
    seeds = range(100)
    drawn = [realise_gusts(grid(), SPECTRA[name], np.random.default_rng(s), 60).omega / (2 * np.pi) for s in seeds]
    share = np.interp(np.array(drawn), grid(), below) / below[-1]
    assert (np.abs(60 * share - np.arange(60) - 0.5) < 0.502).all()  # one component per sixtieth of the energy
    places = (60 * share % 1.0).ravel()
    assert stats.chisquare(np.histogram(places, 20, (0.0, 1.0))[0]).pvalue > 0.001
    assert BAND[0] - 1e-6 < np.min(drawn) < np.max(drawn) < BAND[1] + 1e-6


def test_gust_is_the_sum_of_its_components():
    gusts = realise_gusts(grid(), SPECTRA["froya"], np.random.default_rng(3), 25)
    for t in (0.0, 17.3, 9000.0):
        expected = np.sum(gusts.amplitude * np.cos(gusts.omega * t + gusts.phase))
        assert gust(gusts, t) == pytest.approx(expected, abs=1e-10)


def test_the_same_seed_gives_the_same_gusts():
    one, other, third = (realise_gusts(grid(), SPECTRA["froya"], np.random.default_rng(s)) for s in (5, 5, 6))
    assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    assert not np.array_equal(one.phase, third.phase)


def test_no_wind_has_no_gusts():
    for spectrum in (froya, harris):
        gusts = realise_gusts(grid(), spectrum(grid(), 0.0), np.random.default_rng(1))
        assert gust(gusts, 12.0) == 0.0


@pytest.mark.parametrize(
    ("speed", "height", "averaging", "expected"),
    [
        (20.0, 10.0, 3600.0, 20.0),
        (20.0, 10.0, 60.0, 20.0 * (1.0 + 0.41 * 0.06 * 1.86 * np.log(60.0))),  # 23.7 m/s
        (20.0, 40.0, 3600.0, 20.0 * (1.0 + 0.0573 * 2.0 * np.log(4.0))),
        (0.0, 10.0, 60.0, 0.0),
    ],
)
def test_mean_wind_over_height_and_time(speed, height, averaging, expected):
    assert froya_profile(speed, height, averaging) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: froya(grid(), -1.0), "mean speed is -1"),
        (lambda: froya(grid(), 10.0, 0.0), "is 0 m"),
        (lambda: harris(grid(), 10.0, drag=-0.1), "drag coefficient is -0.1"),
        (lambda: harris(grid(), 10.0, scale=-5.0), "is -5 m"),
        (lambda: froya_profile(10.0, 10.0, 7200.0), "averaging over 7200"),
        (lambda: realise_gusts(grid(), SPECTRA["froya"], np.random.default_rng(1), 5), "5 components"),
        (lambda: realise_gusts(grid()[::-1], SPECTRA["froya"], np.random.default_rng(1)), "rising"),
        (lambda: realise_gusts(grid(), -SPECTRA["froya"], np.random.default_rng(1)), "not negative"),
    ],
)
def test_impossible_winds_are_refused(call, word):
    with pytest.raises(ValueError, match=word):
        call()
