import numpy as np
import pytest

from shipcrane_twin.physics.dispersion import wave_numbers

OMEGA = np.geomspace(0.05, 10.0, 200)


def test_deep_water():
    np.testing.assert_allclose(wave_numbers(OMEGA, 9.80665, np.inf), OMEGA**2 / 9.80665)


@pytest.mark.parametrize("depth", [0.5, 5.0, 50.0, 5000.0])
def test_finite_depth_solves_the_dispersion_relation(depth):
    number = wave_numbers(OMEGA, 9.80665, depth)
    np.testing.assert_allclose(9.80665 * number * np.tanh(number * depth), OMEGA**2, rtol=1e-12)


def test_long_waves_travel_at_the_root_of_gravity_times_depth():
    number = wave_numbers(np.array([0.01]), 9.80665, 2.0)
    assert 0.01 / number[0] == pytest.approx(np.sqrt(9.80665 * 2.0), rel=1e-4)
