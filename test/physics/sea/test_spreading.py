"""Directional spreading: normalised, and its quantiles are those of its density."""

import numpy as np
import pytest

from shipcrane_twin.physics.sea.spreading import spreading_angle, spreading_density

ANGLE = np.linspace(-np.pi, np.pi, 20001)
EXPONENTS = [0.0, 0.5, 1.0, 4.0, 15.0, 75.0, 400.0]


def test_the_energy_over_all_directions_is_one(measured):
    wrong = [abs(np.trapezoid(spreading_density(ANGLE, s), ANGLE) - 1.0) for s in EXPONENTS]
    measured("spreading integral over all directions, s 0 to 400", 100.0 * max(wrong), 1.0, "%")


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_quantiles_are_those_of_the_density(exponent):
    share = np.linspace(0.001, 0.999, 333)
    density = spreading_density(ANGLE, exponent)
    below = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(ANGLE))])
    np.testing.assert_allclose(np.interp(spreading_angle(share, exponent), ANGLE, below), share, atol=1e-5)


def test_a_long_crested_sea_has_one_direction():
    assert (spreading_angle(np.linspace(0.0, 1.0, 11), np.inf) == 0.0).all()


def test_spreading_is_symmetric_and_narrows_with_its_exponent():
    share = np.linspace(0.05, 0.95, 19)
    broad, narrow = spreading_angle(share, 2.0), spreading_angle(share, 20.0)
    np.testing.assert_allclose(broad, -broad[::-1], atol=1e-12)
    assert (np.abs(narrow) <= np.abs(broad) + 1e-12).all()


@pytest.mark.parametrize("exponent", [-1.0, np.nan])
def test_a_negative_exponent_is_refused(exponent):
    with pytest.raises(ValueError, match="exponent s is"):
        spreading_angle(np.array([0.5]), exponent)
