"""The panel method: a hemisphere in closed form, conventions by physics, the committed database, convergence."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro import panel_method
from shipcrane_twin.hydro.build import build_database, drift_loads, hull_hydrostatics, hull_mesh, read_hull
from shipcrane_twin.hydro.drift import mean_drift
from shipcrane_twin.hydro.files import load_database
from shipcrane_twin.hydro.mesh import lid_panels
from shipcrane_twin.hydro.panel_method import added_mass_at_infinity, floating_body, solve

FOLDER = Path(__file__).parents[2] / "config" / "vessels" / "gunnerus"
RHO, G = 1025.0, 9.80665


def hemisphere(count):
    """Return half a hemisphere of radius 1 m floating with its centre in still water, 1 m above the baseline."""
    down = np.linspace(0.0, 0.5 * np.pi, count + 1)[:, None]
    around = np.linspace(0.0, np.pi, 2 * count + 1)[None, :]
    x, y = np.cos(down) * np.cos(around), np.cos(down) * np.sin(around)
    nodes = np.stack(np.broadcast_arrays(x, y, 1.0 - np.sin(down)), axis=2)
    number = np.arange(nodes.shape[0] * nodes.shape[1]).reshape(nodes.shape[:2])
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    panels = np.stack(corners, axis=2).reshape(-1, 4)
    panels[panels[:, 1] >= number[-1, 0], 2] = panels[panels[:, 1] >= number[-1, 0], 1]  # one node at the bottom
    panels = np.where(panels[:, [2]] == panels[:, [1]], panels[:, [3, 0, 1, 2]], panels)
    return nodes.reshape(-1, 3), panels


@pytest.fixture(scope="module")
def config():
    return read_hull(FOLDER / "hull.yaml")


@pytest.fixture(scope="module")
def coarse(config):
    """A database of few panels, frequencies and directions."""
    pytest.importorskip("capytaine")
    pytest.importorskip("cvxpy")
    told = []
    data = build_database(
        dataclasses.replace(
            config,
            mesh=dataclasses.replace(config.mesh, along=24, girth=8, skeg=2, lid=2),
            frequencies_rad_s=(0.1, 0.4, 0.7, 1.0, 1.3, 1.7, 2.1, 2.6, 3.2, 4.0),
            direction_step_deg=30,
        ),
        lambda text, done: told.append((text, done)),
    )
    return data, told


def test_hemisphere_has_its_known_added_mass():
    pytest.importorskip("capytaine")
    body = floating_body(hemisphere(10), 1.0, np.array([0.0, 0.0, 1.0]))
    displaced = 2.0 / 3.0 * np.pi * RHO
    infinite = added_mass_at_infinity(body, RHO) / displaced
    slow = solve(body, 0.05, np.array([0.0]), RHO, G).added_mass / displaced
    # Hulme (1982): heave 1/2 and 0.8310 at infinite and zero frequency, surge 0.2732 and 1/2
    assert infinite[2, 2] == pytest.approx(0.5, rel=0.03)
    assert slow[2, 2] == pytest.approx(0.8310, rel=0.03)
    assert infinite[0, 0] == pytest.approx(0.2732, rel=0.03)
    assert slow[0, 0] == pytest.approx(0.5, rel=0.03)
    assert np.abs(infinite[3:, 3:]).max() < 2e-3  # turning about its centre moves no water


def test_fixed_hemisphere_scatters_what_it_takes():
    pytest.importorskip("capytaine")
    body = floating_body(hemisphere(10), 1.0, np.array([0.0, 0.0, 1.0]))
    for number in (0.5, 1.5):
        omega = np.sqrt(number * G)
        waves = solve(body, omega, np.array([0.7]), RHO, G).scattered
        load, closure = mean_drift(waves[0], 0.7, number, 0.0, RHO, G)
        assert closure == pytest.approx(1.0, abs=0.03)
        assert np.arctan2(load[1], load[0]) == pytest.approx(0.7, abs=1e-2)
        assert abs(load[2]) < 1e-2 * np.hypot(*load[:2])


def test_radiated_waves_carry_the_damping_power():
    """``B_ii = rho g c_g / 2 int |A|^2 dtheta * 2 / w^2``: power sent out by a unit motion."""
    pytest.importorskip("capytaine")
    body = floating_body(hemisphere(10), 1.0, np.array([0.0, 0.0, 1.0]))
    omega = 3.0
    found = solve(body, omega, np.array([0.0]), RHO, G)
    group = 0.5 * G / omega
    for mode in (0, 1, 2):
        power = 0.5 * RHO * G * group * 2.0 * np.pi * (np.abs(found.radiated[mode]) ** 2).mean()
        assert 2.0 * power / omega**2 == pytest.approx(found.damping[mode, mode], rel=0.03)


def test_phases_are_those_of_the_documented_convention(coarse):
    data = coarse[0]
    bow, beam = list(np.rad2deg(data.direction).round()).index(180), list(np.rad2deg(data.direction).round()).index(90)
    slow = data.excitation[0]
    # a long wave lifts the ship with C33, and pitches it by its slope: a head sea rises first at the bow
    assert slow[beam, 2].real == pytest.approx(data.restoring[2, 2], rel=0.03)
    number = data.omega[0] ** 2 / data.gravity
    # elevation e^{-i k (x cos + y sin)} e^{iwt}: slope -ik cos, which pitch (bow down) follows with +ik cos
    pitch = slow[bow, 4] - data.restoring[2, 4]
    assert pitch.imag == pytest.approx(-number * data.restoring[4, 4], rel=0.1)
    # a wave that goes to port accelerates the water, and the ship's mass of it, by -g times its slope
    sway = 1j * number * data.gravity * (data.mass + data.added_mass[0, 1, 1])
    assert slow[beam, 1].imag == pytest.approx(sway.imag, rel=0.05)


def test_coarse_database_is_a_ship_near_the_committed_one(coarse):
    data, told = coarse
    committed = load_database(FOLDER / "hydro.nc")
    for name in ("added_mass", "damping"):
        fine = np.array([getattr(committed, name)[np.argmin(np.abs(committed.omega - w))] for w in data.omega])
        found = getattr(data, name)
        for mode in range(6):
            off = np.abs(found[:, mode, mode] - fine[:, mode, mode]).max() / np.abs(fine[:, mode, mode]).max()
            assert off < 0.08, f"{name} {mode + 1}"
    assert (np.linalg.eigvalsh(data.damping)[:, 0] > -1e-2 * np.abs(data.damping).max(axis=(1, 2))).all()
    assert "Capytaine" in data.source
    shares = [done for _, done in told]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_energy_balance_of_the_floating_ship_closes(config):
    """What the waves lose, by their shadow, is what the ship sends away and what its roll damping takes."""
    pytest.importorskip("capytaine")
    mesh = dataclasses.replace(config.mesh, along=24, girth=8, skeg=2, lid=2)
    small = dataclasses.replace(config, mesh=mesh, drift_roll_damping=0.3)
    omega, direction = np.array([0.9, 1.05, 1.4, 2.0]), np.deg2rad([0.0, 45.0, 90.0, 135.0, 180.0])
    lid = lid_panels(small.form, small.skeg, mesh, small.draught_m)
    body = floating_body(hull_mesh(small), small.draught_m, np.array(small.cog_m), lid)
    solutions = [solve(body, float(w), direction, RHO, G) for w in omega]
    drift, closure = drift_loads(small, hull_hydrostatics(small), omega, direction, solutions)
    assert closure < 0.05
    # near its resonance roll takes power out, which pushes: without it less
    calm = dataclasses.replace(small, drift_roll_damping=0.01)
    less, _ = drift_loads(calm, hull_hydrostatics(calm), omega, direction, solutions)
    assert np.abs(less[1, 2, 1] - drift[1, 2, 1]) > 0.1 * drift[1, 2, 1]


def test_committed_database_is_of_the_committed_hull(config):
    data = load_database(FOLDER / "hydro.nc")
    still = hull_hydrostatics(config)
    assert data.volume == pytest.approx(still.volume, rel=1e-6)
    np.testing.assert_allclose(data.restoring, still.restoring, rtol=1e-9)
    np.testing.assert_allclose(data.omega, config.frequencies_rad_s)
    np.testing.assert_allclose(np.rad2deg(data.direction), np.arange(0, 181, config.direction_step_deg))
    np.testing.assert_allclose(data.cog, config.cog_m)
    assert (data.draught, data.length) == pytest.approx((config.draught_m, config.length_m))
    assert (data.water_density, data.gravity) == pytest.approx((config.water_density_kg_m3, config.gravity_m_s2))
    pytest.importorskip("capytaine")
    hull = hull_mesh(config)
    lid = lid_panels(config.form, config.skeg, config.mesh, config.draught_m)
    at = int(np.argmin(np.abs(data.omega - 1.6)))
    body = floating_body(hull, config.draught_m, data.cog, lid)
    found = solve(body, float(data.omega[at]), data.direction[::12], RHO, G)
    np.testing.assert_allclose(np.diag(found.added_mass), np.diag(data.added_mass[at]), rtol=1e-4)
    np.testing.assert_allclose(found.excitation, data.excitation[at, ::12], atol=1e-4 * np.abs(found.excitation).max())


def test_without_capytaine_the_error_says_what_to_install(monkeypatch, config):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(panel_method, "import_module", missing)
    with pytest.raises(ConfigError, match=r"pip install shipcrane_twin\[hydro\]"):
        build_database(config)


@pytest.mark.slow
def test_panels_have_converged(config, measured):
    """Against twice as many panels: changes as a share of the largest value over frequency and direction."""
    pytest.importorskip("capytaine")
    directions = np.deg2rad([0.0, 45.0, 90.0, 135.0, 180.0])
    fine = dataclasses.replace(config.mesh, along=76, girth=26, skeg=4, lid=6)
    solutions = []
    for mesh in (config.mesh, fine):
        hull = hull_mesh(dataclasses.replace(config, mesh=mesh))
        lid = lid_panels(config.form, config.skeg, mesh, config.draught_m)
        body = floating_body(hull, config.draught_m, np.array(config.cog_m), lid)
        solutions.append([solve(body, omega, directions, RHO, G) for omega in (0.5, 1.05, 1.75, 2.8, 4.0)])
    for name, letter in (("added_mass", "A"), ("damping", "B"), ("excitation", "F")):
        own, better = (np.array([getattr(one, name) for one in of]) for of in solutions)
        for mode in range(6):
            pick = (..., mode) if letter == "F" else (..., mode, mode)
            off = np.abs(own[pick] - better[pick]).max() / np.abs(better[pick]).max()
            label = f"{letter}{mode + 1}" if letter == "F" else f"{letter}{mode + 1}{mode + 1}"
            measured(f"panels: change of {label} with twice as many", 100.0 * off, 1.0, "%")
