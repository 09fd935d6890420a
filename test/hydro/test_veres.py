"""The reference ship's own files: conventions proven by physics, and VERES's own motions rebuilt."""

import numpy as np
import pytest
from imported_ships import shipx_folder, without_fit

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import MIRROR
from shipcrane_twin.hydro.rao import natural_periods, raos
from shipcrane_twin.hydro.veres import import_veres, read_motions
from shipcrane_twin.hydro.veres_coefficients import FROM_AFT
from shipcrane_twin.hydro.veres_extras import read_extras
from shipcrane_twin.hydro.veres_files import read_transfer


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return shipx_folder(tmp_path_factory)


@pytest.fixture(scope="module")
def ship(folder):
    return import_veres(folder, fit=without_fit)


@pytest.fixture(scope="module")
def motions(folder, ship):
    return read_motions(folder, ship)


@pytest.fixture(scope="module")
def extras(folder):
    return read_extras(folder)


def wave_number(ship, n):
    return ship.omega[n] ** 2 / ship.gravity


def test_particulars(ship):
    np.testing.assert_allclose(ship.cog, [15.516, 0.0, 3.624], atol=1e-3)
    assert ship.mass == pytest.approx(482.027e3, rel=1e-5)
    assert (ship.draught, ship.length, ship.water_density) == pytest.approx((2.6, 33.9, 1025.0))
    assert ship.centre_of_buoyancy[2] == 1.591
    np.testing.assert_allclose(np.rad2deg(ship.direction), np.arange(0.0, 181.0, 15.0), atol=1e-9)
    assert ship.omega[[0, -1]] == pytest.approx([2 * np.pi / 60, 2 * np.pi / 3], rel=1e-4)


def test_matrices_in_our_axes(ship):
    # reference: C35 and A_inf in x forward, y starboard, z down; 24 and 46 change sign, 35 and 26 keep it
    assert ship.restoring[2, 4] == pytest.approx(4.7638e6, rel=1e-4)
    assert ship.added_mass_inf[1, 3] == pytest.approx(5.8831e4, rel=1e-4)
    assert ship.added_mass_inf[1, 5] == pytest.approx(-5.3441e5, rel=1e-4)
    assert ship.added_mass_inf[2, 4] == pytest.approx(3.0143e6, rel=1e-4)
    assert ship.added_mass_inf[3, 5] == pytest.approx(-9.3431e5, rel=1e-4)


def test_long_waves_push_the_way_they_go(ship):
    """The fluid accelerates by i k g where the wave goes: this fixes time factor, heading and axes of re8."""
    k = wave_number(ship, 0)
    for mode, toward in ((0, np.cos(ship.direction)), (1, np.sin(ship.direction))):
        inertia = ship.mass + ship.added_mass[0, mode, mode]
        scale = k * ship.gravity * inertia
        np.testing.assert_allclose(ship.excitation[0, :, mode] / scale, 1j * toward, atol=0.03)


def test_long_waves_lift_by_the_waterplane(ship):
    scale = ship.restoring[2, 2]
    np.testing.assert_allclose(ship.excitation[0, :, 2] / scale, 1.0, atol=0.03)
    # by the same sign the pitch moment is C35: the waterplane lies behind the CoG
    np.testing.assert_allclose(ship.excitation[0, :, 4] / ship.restoring[2, 4], 1.0, atol=0.08)


def test_motions_in_long_waves_lie_in_the_surface(ship, motions):
    """Independent of any matrix: swy's axes, phases and headings."""
    k = wave_number(ship, 3)
    d = ship.direction
    np.testing.assert_allclose(motions[3, :, 0], -1j * np.cos(d), atol=0.01)
    np.testing.assert_allclose(motions[3, :, 1], -1j * np.sin(d), atol=0.03)
    np.testing.assert_allclose(motions[3, :, 2], 1.0, atol=0.01)
    np.testing.assert_allclose(motions[3, :, 3] / k, -1j * np.sin(d), atol=0.03)
    np.testing.assert_allclose(motions[3, :, 4] / k, 1j * np.cos(d), atol=0.06)


def test_motions_are_those_of_the_cog(ship, motions, extras):
    """Surge has no water in strip theory: F = -w^2 m x holds exactly for the CoG, and by 100 times less elsewhere."""
    left = -(ship.omega[:, None] ** 2) * extras.mass[0, 0] * motions[..., 0]
    np.testing.assert_allclose(left, ship.excitation[..., 0], atol=3e-6 * np.abs(ship.excitation[..., 0]).max())


def test_sway_yaw_and_their_coupling_with_roll(ship, motions, extras):
    """Roll itself has a viscous damping that depends on wave height; the other two equations have not."""
    w = ship.omega[:, None, None]
    impedance = ship.restoring - w**2 * (extras.mass + ship.added_mass) + 1j * w * ship.damping
    left = np.einsum("nij,nmj->nmi", impedance, motions)
    for mode, bar in ((1, 0.02), (5, 0.05)):
        error = np.abs(left[..., mode] - ship.excitation[..., mode]).max(axis=1)
        assert (error / np.abs(ship.excitation[..., mode]).max()).max() < bar


def test_what_roll_lacks_is_a_damping_that_grows_with_its_amplitude(ship, motions, extras):
    """At the resonance: a real positive remainder, per roll amplitude the same for all directions (quadratic)."""
    n = int(np.argmin(np.abs(ship.omega - 2 * np.pi / 6)))
    w = ship.omega[n]
    impedance = ship.restoring - w**2 * (extras.mass + ship.added_mass[n]) + 1j * w * ship.damping[n]
    oblique = slice(2, -2)
    roll = motions[n, oblique, 3]
    lack = (ship.excitation[n] - motions[n] @ impedance.T)[oblique, 3] / (1j * w * roll)
    assert (np.abs(lack.imag) < 0.1 * lack.real).all()
    np.testing.assert_allclose(lack.real / np.abs(roll), (lack.real / np.abs(roll)).mean(), rtol=0.06)


def test_both_sides_of_the_file_mirror_each_other(folder):
    table = read_transfer(folder / "input.re8", "WAVE EXCITATION FORCE")
    values = table.values * FROM_AFT
    for heading in (15.0, 45.0, 90.0, 135.0):
        one, other = (values[:, int(np.flatnonzero(table.heading == h)[0])] for h in (heading, 360.0 - heading))
        scale = np.abs(values).max(axis=(0, 1))
        np.testing.assert_allclose(one * MIRROR / scale, other / scale, atol=2e-5)


def test_heave_and_pitch_impedance_against_loads_and_motions(ship, motions, extras):
    """Thirteen directions of loads over motions make the matrices again: this holds re10 against re8 and swy."""
    for n in range(5, len(ship.omega)):
        w = ship.omega[n]
        impedance = np.linalg.lstsq(motions[n][:, [2, 4]], ship.excitation[n][:, [2, 4]], rcond=None)[0].T
        block = np.ix_([2, 4], [2, 4])
        water = (impedance - ship.restoring[block] + w**2 * extras.mass[block]) / (1j * w)
        expected = ship.damping[n][block] + 1j * w * ship.added_mass[n][block]
        np.testing.assert_allclose(water / np.abs(water), expected / np.abs(water), atol=0.03)


def test_heave_and_pitch_motions_are_rebuilt(ship, motions, extras, measured):
    found = raos(ship, extras.mass)
    for name, mode in (("heave", 2), ("pitch", 4)):
        error = np.abs(np.abs(found[..., mode]) - np.abs(motions[..., mode])).max() / np.abs(motions[..., mode]).max()
        measured(f"imported VERES model: {name} RAO against VERES's own, share of maximum", error, 0.02)


def test_natural_periods_of_the_imported_ship(ship, extras):
    found = natural_periods(ship, extras.mass)
    assert found == pytest.approx({"roll": 6.05, "heave": 4.24, "pitch": 3.92}, abs=0.01)


def test_drift_pushes_the_way_the_wave_goes(ship):
    """Beam waves of 3 s: below the wall's rho g L / 2, above half of it; head and following sea along x only."""
    beam = len(ship.direction) // 2
    wall = 0.5 * ship.water_density * ship.gravity * ship.length
    assert 0.5 * wall < ship.drift[-1, beam, 1] < 1.05 * wall
    assert (ship.drift[:, -1, 0] < 0.0).all()
    assert (ship.drift[:, 0, 0] > 0.0).all()
    np.testing.assert_allclose(ship.drift[:, [0, -1], 1:], 0.0, atol=0.1)


def test_extras(extras):
    np.testing.assert_allclose(np.diag(extras.mass)[[0, 3, 4]], [482.027e3, 5.4419e6, 2.5162e7], rtol=1e-4)
    np.testing.assert_allclose(np.diag(extras.damping_correction)[1:4], [3.83e3, 1.064e4, 5.89e3], rtol=1e-2)
    np.testing.assert_allclose(extras.quadratic_roll[0], [0.0, 1.9912e5], rtol=1e-3)
    assert extras.manoeuvring["Xuu"] == -2100.0
    assert extras.manoeuvring_added_mass["Nrdot"] == pytest.approx(-12245783.9, abs=0.1)
    assert not set(extras.manoeuvring) & set(extras.manoeuvring_added_mass)
    assert extras.particulars["ship_displacement"] == pytest.approx(493472.0)
    assert extras.wind["sway"][5] == 0.9
    assert {name: len(values) for name, values in extras.wind.items()} == dict.fromkeys(
        ("surge", "sway", "yaw", "roll"), 19
    )


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("% Retardation functions", "% Something else", "no line '% Retardation functions'; export"),
        ("-0.28831378E+00", "0.28831378E+00", r"re10:\d+: a pole of entry 2,2 does not decay"),
        ("-0.28831378E+00  0.00000000E+00", "-0.28831378E+00", r"re10:\d+: 3 numbers, expected 4"),
        ("     6     6\n", "     7     1\n     0\n     0\n% ", r"re10:\d+: entry 7,1, expected 1 to 6"),
        ("     6     6\n", "% ", r"re10:\d+: 35 retardation functions, expected 36; the file is cut off"),
    ],
)
def test_a_broken_re10_is_named_with_its_remedy(folder, tmp_path, old, new, told):
    for source in folder.iterdir():
        (tmp_path / source.name).write_bytes(source.read_bytes())
    text = (folder / "retfun.re10").read_text()
    assert old in text
    (tmp_path / "retfun.re10").write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError, match=told):
        import_veres(tmp_path, fit=without_fit)
