"""Water motion in waves: continuity, free surface, sea floor, deep limit, the growing sea."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sea_series import GRAVITY, jonswap_sea

from shipcrane_twin.physics.sea.kinematics import elevation, elevations, orbital, ramp_factor

STEP = 1e-3
DEPTHS = [5.0, 20.0, np.inf]
SEAS = {depth: jonswap_sea(11, direction=0.8, spreading=6.0, depth=depth) for depth in DEPTHS}
quick = settings(deadline=None, max_examples=30)
place = st.floats(-50.0, 50.0)
time = st.floats(0.0, 5000.0)


def gradient(waves, t, x, y, z):
    """Derivatives (3, 3) of the velocity: row i along axis i."""
    point = np.array([x, y, z])
    sides = []
    for axis in np.eye(3) * STEP:
        sides.append((orbital(waves, t, *(point + axis))[0] - orbital(waves, t, *(point - axis))[0]) / (2.0 * STEP))
    return np.array(sides)


@pytest.mark.parametrize("depth", DEPTHS)
@quick
@given(t=time, x=place, y=place, z=st.floats(-4.9, -0.1))
def test_the_flow_has_no_sources_and_no_rotation(depth, t, x, y, z):
    slope = gradient(SEAS[depth], t, x, y, z)
    assert abs(np.trace(slope)) < 1e-6  # so its potential obeys Laplace's equation
    np.testing.assert_allclose(slope, slope.T, atol=1e-6)


@pytest.mark.parametrize("depth", DEPTHS)
@quick
@given(t=time, x=place, y=place)
def test_the_surface_moves_with_the_water_and_has_constant_pressure(depth, t, x, y):
    waves = SEAS[depth]
    velocity, acceleration = orbital(waves, t, x, y, 0.0)
    rise = (elevation(waves, t + STEP, x, y) - elevation(waves, t - STEP, x, y)) / (2.0 * STEP)
    slope_x = (elevation(waves, t, x + STEP, y) - elevation(waves, t, x - STEP, y)) / (2.0 * STEP)
    slope_y = (elevation(waves, t, x, y + STEP) - elevation(waves, t, x, y - STEP)) / (2.0 * STEP)
    assert velocity[2] == pytest.approx(rise, abs=1e-5)
    assert acceleration[0] == pytest.approx(-GRAVITY * slope_x, abs=1e-5)
    assert acceleration[1] == pytest.approx(-GRAVITY * slope_y, abs=1e-5)


@pytest.mark.parametrize("depth", DEPTHS)
@quick
@given(t=time, x=place, y=place, z=st.floats(-5.0, 0.0))
def test_acceleration_is_the_rate_of_velocity(depth, t, x, y, z):
    waves = SEAS[depth]
    rate = (orbital(waves, t + STEP, x, y, z)[0] - orbital(waves, t - STEP, x, y, z)[0]) / (2.0 * STEP)
    np.testing.assert_allclose(orbital(waves, t, x, y, z)[1], rate, atol=1e-5)


@pytest.mark.parametrize("depth", [5.0, 20.0])
def test_no_water_goes_through_the_sea_floor(depth):
    for t in np.linspace(0.0, 100.0, 23):
        velocity, acceleration = orbital(SEAS[depth], t, 3.0, -4.0, -depth)
        assert abs(velocity[2]) < 1e-14
        assert abs(acceleration[2]) < 1e-14
        assert np.array_equal(orbital(SEAS[depth], t, 3.0, -4.0, -depth - 10.0)[0], velocity)
    assert max(np.hypot(*orbital(SEAS[depth], t, 0.0, 0.0, -depth)[0][:2]) for t in range(50)) > 1e-3


def test_very_deep_water_is_deep_water():
    deep, finite = jonswap_sea(12, spreading=6.0), jonswap_sea(12, spreading=6.0, depth=3000.0)
    for t in np.linspace(0.0, 500.0, 7):
        for one, other in zip(orbital(deep, t, 30.0, 5.0, -3.0), orbital(finite, t, 30.0, 5.0, -3.0), strict=True):
            np.testing.assert_allclose(one, other, atol=1e-9)


def test_above_still_water_its_motion_is_held():
    waves = SEAS[20.0]
    for one, other in zip(orbital(waves, 7.0, 1.0, 2.0, 1.5), orbital(waves, 7.0, 1.0, 2.0, 0.0), strict=True):
        assert np.array_equal(one, other)


def test_many_places_at_once_have_the_bits_of_single_ones():
    waves = jonswap_sea(13, spreading=6.0, ramp=20.0)
    x, y = np.random.default_rng(1).uniform(-200.0, 200.0, (2, 301))
    singles = [elevation(waves, 13.7, a, b) for a, b in zip(x, y, strict=True)]
    assert elevations(waves, 13.7, x, y).tolist() == singles


def test_the_sea_grows_smoothly_from_rest():
    t = np.linspace(-1.0, 11.0, 12001)
    share = np.array([ramp_factor(10.0, each) for each in t])
    assert (share[t <= 0.0] == 0.0).all()
    assert (share[t >= 10.0] == 1.0).all()
    assert ramp_factor(10.0, 5.0) == pytest.approx(0.5)
    assert (np.diff(share) >= 0.0).all()
    assert np.abs(np.diff(share, 2)).max() / 1e-6 < 6.0 / 100.0  # no jerk: the curvature is bounded by 5.8 / ramp^2
    assert ramp_factor(0.0, 0.0) == ramp_factor(0.0, -1.0) == 1.0


def test_growth_applies_to_elevation_and_motion_alike():
    full, growing = jonswap_sea(14), jonswap_sea(14, ramp=40.0)
    share = ramp_factor(40.0, 12.0)
    assert elevation(growing, 12.0, 5.0, 6.0) == share * elevation(full, 12.0, 5.0, 6.0)
    for one, other in zip(orbital(growing, 12.0, 5.0, 6.0, -1.0), orbital(full, 12.0, 5.0, 6.0, -1.0), strict=True):
        assert np.array_equal(one, share * other)
    assert elevation(growing, 40.0, 5.0, 6.0) == elevation(full, 40.0, 5.0, 6.0)
