"""Mean drift from the far field: a vertical cylinder in closed form, moved about, and what the ship's must fulfil."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import h1vp, hankel1, jvp

from shipcrane_twin.hydro.drift import ANGLES, far_field, mean_drift
from shipcrane_twin.hydro.files import load_database

GUNNERUS = Path(__file__).parents[2] / "config" / "vessels" / "gunnerus" / "hydro.nc"
RHO, G, RADIUS = 1025.0, 9.80665, 1.7
THETA = 2.0 * np.pi * np.arange(ANGLES) / ANGLES


def cylinder_waves(number, direction):
    """Return the far field of a fixed vertical cylinder in deep water (MacCamy and Fuchs 1954), e^{-iwt}."""
    m = np.arange(-40, 41)[:, None]
    orders = jvp(m, number * RADIUS) / h1vp(m, number * RADIUS) * np.exp(1j * m * (THETA - direction))
    return -np.sqrt(2.0 / (np.pi * number)) * np.exp(-0.25j * np.pi) * orders.sum(axis=0)


def cylinder_force(number):
    """Return the drift force along the wave from the pressure on the cylinder itself.

    Mean of ``rho g zeta^2 / 2`` at the waterline against that of ``rho |grad phi|^2 / 2`` below, with the elevation
    on the cylinder ``sum i^m 2i / (pi k a H_m') e^{im theta}``.
    """
    m = np.arange(-40, 41)[:, None]
    phases = 1j**m * np.exp(1j * m * THETA)
    terms = 2j / (np.pi * number * RADIUS * h1vp(m, number * RADIUS)) * phases
    elevation, slope = terms.sum(axis=0), (1j * m * terms).sum(axis=0) / (number * RADIUS)
    ring = -(np.abs(elevation) ** 2) + np.abs(slope) ** 2
    return RHO * G / 8.0 * RADIUS * 2.0 * np.pi * (ring * np.cos(THETA)).mean()


@pytest.mark.parametrize("number", [0.05, 0.3, 1.0, 2.5])
@pytest.mark.parametrize("direction", [0.0, 0.7, 2.9])
def test_cylinder_feels_what_the_pressure_on_it_gives(number, direction):
    load, closure = mean_drift(cylinder_waves(number, direction), direction, number, 0.0, RHO, G)
    force = cylinder_force(number)
    np.testing.assert_allclose(load[:2], force * np.array([np.cos(direction), np.sin(direction)]), atol=1e-6 * force)
    assert abs(load[2]) < 1e-8 * force
    assert closure == pytest.approx(1.0, abs=1e-6)


def test_short_waves_are_reflected_by_the_cylinder():
    load, _ = mean_drift(cylinder_waves(15.0, 0.0), 0.0, 15.0, 0.0, RHO, G)
    assert load[0] == pytest.approx(2.0 / 3.0 * RHO * G * RADIUS, rel=0.03)  # Havelock 1940


def test_moment_is_that_of_the_force_where_the_cylinder_stands():
    number, direction, place = 0.8, 0.6, np.array([2.0, -3.0])
    heading = np.array([np.cos(direction), np.sin(direction)])
    # a wave meets a moved body later, and what it sends away has less far to go
    later = number * (heading @ place - np.stack([np.cos(THETA), np.sin(THETA)], axis=1) @ place)
    load, _ = mean_drift(cylinder_waves(number, direction) * np.exp(1j * later), direction, number, 0.0, RHO, G)
    force = cylinder_force(number) * heading
    np.testing.assert_allclose(load[:2], force, rtol=1e-6)
    assert load[2] == pytest.approx(place[0] * force[1] - place[1] * force[0], rel=1e-6)


def test_absorbed_power_pushes_along_the_wave():
    waves = cylinder_waves(0.8, 0.6)
    without, _ = mean_drift(waves, 0.6, 0.8, 0.0, RHO, G)
    with_it, closure = mean_drift(waves, 0.6, 0.8, 500.0, RHO, G)
    np.testing.assert_allclose(with_it[:2] - without[:2], 500.0 * np.array([np.cos(0.6), np.sin(0.6)]))
    assert closure < 1.0  # more taken up than was missing


def test_far_field_of_a_pulsating_source():
    """A panel of flux alone is a source, whose waves leave evenly."""
    omega, depth, flux = 1.4, 0.9, 3.0
    number = omega**2 / G
    centre, normal = np.array([[0.6, -0.4, -depth]]), np.array([[0.0, 0.0, 1.0]])
    strength = np.array([[flux + 0.0j]])
    found = far_field(centre, normal, np.array([1.0]), 0.0 * strength, strength, omega, G)[0]
    # phi = -(i k / 2) e^{k (z - d)} H0(k R) times the flux (Wehausen and Laitone 1960, 13.17); elevation i w / g phi
    distance = 4000.0 / number
    ring = distance * np.stack([np.cos(THETA), np.sin(THETA)], axis=1) - centre[0, :2]
    potential = -0.5j * number * np.exp(-number * depth) * hankel1(0, number * np.linalg.norm(ring, axis=1)) * flux
    elevation = 1j * omega / G * potential
    np.testing.assert_allclose(found * np.exp(1j * number * distance) / np.sqrt(distance), elevation, rtol=2e-3)


@pytest.fixture(scope="module")
def ship():
    return load_database(GUNNERUS)


def test_ship_in_head_and_following_sea_is_not_pushed_aside(ship):
    largest = np.abs(ship.drift).max(axis=(0, 1))
    for direction in (0, -1):
        assert np.abs(ship.drift[:, direction, 1]).max() < 1e-3 * largest[1]
        assert np.abs(ship.drift[:, direction, 2]).max() < 2e-3 * largest[2]
    assert (ship.drift[:, -1, 0] < 0.0).all()  # a head sea pushes back
    assert (ship.drift[:, 0, 0] > 0.0).all()


def test_ship_drifts_with_the_wave_and_not_at_all_in_long_ones(ship):
    beam = ship.drift[:, len(ship.direction) // 2, 1]
    assert (beam > 0.0).all()
    assert beam[0] < 1e-6 * beam.max()
    # beam sea, short waves: a wall of the waterline's length reflects rho g / 2 per length, a rounded one less
    wall = 0.5 * ship.water_density * ship.gravity * 35.319
    assert 0.8 * wall < beam[-1] < wall
