"""Realised seas: energy, number and place of the components, sameness, what is refused."""

import hashlib

import numpy as np
import pytest
from scipy import stats
from sea_series import DENSITY, GRAVITY, HEIGHT, OMEGA, jonswap_sea, series

from shipcrane_twin.physics.dispersion import wave_numbers
from shipcrane_twin.physics.sea.components import (
    TAIL,
    Irregular,
    Regular,
    make_waves,
    realise,
    significant_height,
)
from shipcrane_twin.physics.sea.kinematics import elevation
from shipcrane_twin.physics.sea.spectra import grid, jonswap

WIND_SEA = Irregular(OMEGA, DENSITY, 0.3, 10.0)
SWELL = Irregular(grid(14.0), jonswap(grid(14.0), 1.0, 14.0, 6.0), -1.2, 75.0)


def sea(systems, seed=1, **changes):
    settings = {"gravity": GRAVITY, "depth": np.inf, "ramp": 0.0} | changes
    return realise(systems, np.random.default_rng(seed), **settings)


@pytest.mark.parametrize("error", [0.075, 0.025, 0.0075, 0.00075])
def test_the_components_have_the_energy_of_the_spectrum(error):
    expected = 4.0 * np.sqrt(np.trapezoid(DENSITY, OMEGA))
    assert significant_height(jonswap_sea(3, error)) == pytest.approx(expected, rel=1e-6)
    assert significant_height(jonswap_sea(3, error)) == pytest.approx(HEIGHT, rel=1e-4)


@pytest.mark.parametrize(("error", "count"), [(0.075, 20), (0.025, 60), (0.0075, 200), (0.00075, 2000)])
def test_the_stated_error_sets_the_count_and_is_the_excess_kurtosis(error, count):
    waves = jonswap_sea(4, error)
    assert len(waves.amplitude) == count
    energy = waves.amplitude**2
    assert 1.5 * (energy**2).sum() / energy.sum() ** 2 == pytest.approx(error, rel=1e-6)


def test_excess_kurtosis_over_many_seas_is_that_stated():
    t = np.arange(0.0, 3600.0, 1.0)
    moments = np.array([[np.mean(z**2), np.mean(z**4)] for z in (series(jonswap_sea(s, 0.075), t) for s in range(400))])
    second, fourth = moments.mean(axis=0)
    assert fourth / second**2 - 3.0 == pytest.approx(-0.075, abs=0.02)


def test_equal_energy_lies_between_frequencies():
    waves = jonswap_sea(5)
    below = np.concatenate([[0.0], np.cumsum(0.5 * (DENSITY[1:] + DENSITY[:-1]) * np.diff(OMEGA))])
    share = np.interp(waves.omega, OMEGA, below) / below[-1] / (1.0 - TAIL)
    # One in each sixtieth, anywhere there; straight lines in the cumulated energy err by less than 1e-3.
    inside = share * 60 - np.arange(60)
    assert inside.min() > -1e-3
    assert inside.max() < 1.001
    assert stats.kstest(inside, "uniform").pvalue > 0.01


def test_only_the_stated_tail_is_left_out():
    cut = np.interp(1.0 - TAIL, np.cumsum(DENSITY * np.gradient(OMEGA)) / np.trapezoid(DENSITY, OMEGA), OMEGA)
    highest = max(jonswap_sea(seed, 0.00075).omega.max() for seed in range(20))
    assert 0.8 * cut < highest < 1.01 * cut


def test_two_systems_share_the_count_by_energy_and_keep_their_own():
    waves = sea([WIND_SEA, SWELL])
    wind = waves.amplitude == waves.amplitude[0]
    assert 4.0 * np.sqrt(0.5 * np.sum(waves.amplitude[wind] ** 2)) == pytest.approx(2.0, rel=1e-3)
    assert 4.0 * np.sqrt(0.5 * np.sum(waves.amplitude[~wind] ** 2)) == pytest.approx(1.0, rel=1e-3)
    assert np.mean(waves.direction[~wind]) == pytest.approx(-1.2, abs=0.1)
    assert 0.15 * 60 < np.sum(~wind) < 0.30 * 60
    energy = waves.amplitude**2
    assert 1.5 * (energy**2).sum() / energy.sum() ** 2 <= 0.025


def test_a_weak_system_keeps_a_shape():
    weak = Irregular(SWELL.omega, 1e-4 * SWELL.density, SWELL.direction, SWELL.spreading)
    assert np.sum(sea([WIND_SEA, weak]).amplitude < 0.02) == 8


def test_a_system_without_energy_adds_nothing():
    calm = Irregular(OMEGA, np.zeros_like(DENSITY), 0.0, np.inf)
    assert len(sea([calm]).amplitude) == 0
    assert elevation(sea([calm]), 3.0, 1.0, 2.0) == 0.0


def test_a_regular_wave_is_one_component_with_its_height_and_period():
    waves = sea([Regular(height=1.4, period=7.0, direction=0.5)])
    assert len(waves.amplitude) == 1
    assert elevation(waves, 0.0, 0.0, 0.0) == pytest.approx(0.7)
    assert elevation(waves, 3.5, 0.0, 0.0) == pytest.approx(-0.7)
    length = GRAVITY * 49.0 / (2.0 * np.pi)
    assert elevation(waves, 7.0, length * np.cos(0.5), length * np.sin(0.5)) == pytest.approx(0.7, abs=1e-6)
    assert elevation(waves, 0.1, length * 0.01, 0.0) > elevation(waves, -0.1, length * 0.01, 0.0)  # goes east


@pytest.mark.parametrize("depth", [4.0, 30.0, np.inf])
def test_wave_numbers_obey_dispersion(depth):
    waves = jonswap_sea(6, direction=2.0, spreading=4.0, depth=depth)
    np.testing.assert_allclose(waves.number, wave_numbers(waves.omega, GRAVITY, depth), atol=1e-11)
    np.testing.assert_allclose(np.hypot(waves.number_x, waves.number_y), waves.number, atol=1e-11)
    np.testing.assert_allclose(np.arctan2(waves.number_y, waves.number_x) % (2 * np.pi), waves.direction % (2 * np.pi))


def test_directions_follow_the_spreading():
    waves = jonswap_sea(7, 0.00075, direction=1.0, spreading=8.0)
    # For cos^2s of half the angle the mean cosine of the angle is s / (s + 1).
    assert np.mean(np.cos(waves.direction - 1.0)) == pytest.approx(8.0 / 9.0, abs=1e-3)
    assert np.mean(np.sin(waves.direction - 1.0)) == pytest.approx(0.0, abs=1e-3)
    assert abs(stats.spearmanr(waves.omega, waves.direction).statistic) < 0.08


def test_the_same_seed_gives_the_same_bits_on_every_machine():
    waves = sea([WIND_SEA, SWELL], seed=2024, depth=50.0, ramp=10.0)
    again = sea([WIND_SEA, SWELL], seed=2024, depth=50.0, ramp=10.0)
    assert all(np.array_equal(a, b) for a, b in zip(waves, again, strict=True))
    heights = np.array([elevation(waves, 0.37 * i, 3.0 * i, -2.0 * i) for i in range(500)])
    digest = hashlib.sha256(b"".join(np.asarray(part).tobytes() for part in (*waves, heights)))
    assert digest.hexdigest()[:16] == "3f4acd137de1f943"


def test_another_seed_gives_another_sea():
    assert not np.array_equal(jonswap_sea(1).phase, jonswap_sea(2).phase)


def test_direction_and_spreading_change_neither_phases_nor_frequencies():
    one, other = jonswap_sea(8, direction=0.0), jonswap_sea(8, direction=2.0, spreading=5.0)
    assert np.array_equal(one.phase, other.phase)
    assert np.array_equal(one.omega, other.omega)


def test_published_components_make_the_same_sea():
    waves = jonswap_sea(9, direction=1.0, spreading=5.0, depth=20.0, ramp=30.0)
    again = make_waves(
        waves.amplitude, waves.omega, waves.direction, waves.phase, gravity=GRAVITY, depth=20.0, ramp=30.0
    )
    assert all(np.array_equal(a, b) for a, b in zip(waves, again, strict=True))


@pytest.mark.parametrize("seed", range(5))
def test_the_sea_does_not_repeat_within_three_hours(seed):
    z = series(jonswap_sea(seed), np.arange(0.0, 10800.0, 0.5))
    spectrum = np.abs(np.fft.rfft(z, 2 * len(z))) ** 2
    lag = np.fft.irfft(spectrum)[: len(z)] / np.arange(len(z), 0, -1)
    # Sixty incommensurate lines leave a noise of 1/sqrt(120); a repetition would come near 1.
    assert np.abs(lag[600:18000]).max() / lag[0] < 0.55


@pytest.mark.parametrize(
    ("systems", "changes", "word"),
    [
        ([], {}, "no wave system"),
        ([WIND_SEA], {"error": 0.1}, "error is 0.1"),
        ([WIND_SEA], {"error": 1e-5}, "error is 1e-05"),
        ([WIND_SEA], {"gravity": -9.8}, "gravity -9.8"),
        ([WIND_SEA], {"depth": 0.0}, "depth 0"),
        ([WIND_SEA], {"ramp": -1.0}, "ramp -1"),
        ([WIND_SEA._replace(omega=OMEGA[::-1])], {}, "rising"),
        ([WIND_SEA._replace(density=-DENSITY)], {}, "not negative"),
        ([WIND_SEA._replace(density=DENSITY[1:])], {}, "same length"),
        ([WIND_SEA._replace(direction=np.nan)], {}, "direction is nan"),
        ([WIND_SEA._replace(spreading=-1.0)], {}, "exponent s is -1"),
        ([Regular(-1.0, 8.0, 0.0)], {}, "height -1"),
        ([Regular(1.0, 0.0, 0.0)], {}, "period 0"),
        ([Regular(1.0, 1e5, 0.0)], {}, "below 0.001"),
    ],
)
def test_impossible_seas_are_refused(systems, changes, word):
    with pytest.raises(ValueError, match=word):
        sea(systems, **changes)
