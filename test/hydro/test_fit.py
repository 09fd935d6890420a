"""The state-space fit: close, passive at every frequency, and exact where the data are a passive system."""

from pathlib import Path

import numpy as np
import pytest

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro import fit as fitting
from shipcrane_twin.hydro.database import LATERAL, LONGITUDINAL
from shipcrane_twin.hydro.files import load_database
from shipcrane_twin.hydro.fit import POLE_MAX, SECTIONS, fit_poles, fit_radiation, sections

GUNNERUS = Path(__file__).parents[2] / "config" / "vessels" / "gunnerus" / "hydro.nc"
FINE = np.concatenate([[0.0], np.geomspace(1e-3, 15.0, 3000), np.linspace(0.005, 15.0, 3001)])
"""A grid of its own: the fit sees none of these frequencies."""


@pytest.fixture(scope="module")
def ship():
    return load_database(GUNNERUS)


def memory(data):
    step = 1j * data.omega[:, None, None]
    return data.damping + step * (data.added_mass - data.added_mass_inf)


def scales(values):
    return np.sqrt(np.abs(np.diagonal(values, axis1=1, axis2=2)).max(axis=0))


def entries():
    return [(i, j) for modes in (LONGITUDINAL, LATERAL) for i in modes for j in modes if i <= j]


def lowest_eigenvalue(response, scale):
    real = (response / np.outer(scale, scale)).real
    return np.linalg.eigvalsh(0.5 * (real + np.swapaxes(real, 1, 2))).min()


def test_ship_memory_is_followed_up_to_4_rad_s(ship, measured):
    wanted, found = memory(ship), ship.fit.response(ship.omega)
    scale = scales(wanted)
    counted = 0
    for i, j in entries():
        if np.abs(wanted[:, i, j]).max() < 0.05 * scale[i] * scale[j]:
            continue
        left = np.abs(found[:, i, j] - wanted[:, i, j]) ** 2
        spread = np.abs(wanted[:, i, j] - wanted[:, i, j].mean()) ** 2
        measured(f"state space: 1 - R2 of K{i + 1}{j + 1}, w <= 4 rad/s", left.sum() / spread.sum(), 0.03)
        counted += 1
    assert counted >= 10


def test_ship_memory_is_passive_and_vanishes_at_rest(ship, measured):
    scale = scales(memory(ship))
    response = ship.fit.response(FINE)
    measured("state space: -min eig Re K(iw) of scale, 0 to 15 rad/s", -lowest_eigenvalue(response, scale), 1e-6)
    assert np.abs(response[0] / np.outer(scale, scale)).max() < 1e-9


def test_ship_memory_is_symmetric_with_slow_stable_poles(ship):
    poles = np.linalg.eigvals(ship.fit.a)
    assert poles.shape == (2, SECTIONS, 2)
    assert (poles.real < 0.0).all()
    assert np.abs(poles).max() <= POLE_MAX
    np.testing.assert_allclose(ship.fit.c, np.swapaxes(ship.fit.c, 1, 2), rtol=1e-9)


def passive_block(generator, poles):
    """Return a passive K(s) of one block with K(0) = 0: damped springs, ``sum R_k s / (s^2 + 2 d s + w^2)``."""
    residues = []
    for _ in poles:
        half = generator.normal(size=(3, 3))
        residues.append(half @ half.T)

    def response(omega):
        s = 1j * omega[:, None, None]
        return sum(r * s / (s * s - 2.0 * p.real * s + abs(p) ** 2) for r, p in zip(residues, poles, strict=True))

    return response


def known_system(noise=0.0):
    pytest.importorskip("cvxpy")
    generator = np.random.default_rng(3)
    poles = np.array([-0.3 + 0.5j, -0.5 + 1.1j, -0.4 + 1.8j, -1.5 + 2.4j])
    blocks = [passive_block(generator, poles) for _ in range(2)]
    omega = np.linspace(0.1, 4.0, 50)

    def whole(at):
        out = np.zeros((len(at), 6, 6), complex)
        for modes, block in zip((LONGITUDINAL, LATERAL), blocks, strict=True):
            out[np.ix_(range(len(at)), modes, modes)] = block(at)
        return out

    values = whole(omega)
    disturbance = noise * generator.normal(size=values.shape)
    values += disturbance + np.swapaxes(disturbance, 1, 2)
    infinite = np.eye(6)
    added = infinite + values.imag / omega[:, None, None]
    return fit_radiation(omega, added, values.real, infinite), whole, poles


def test_a_known_passive_system_is_found_again():
    fit, whole, poles = known_system()
    wanted = whole(FINE)
    # beyond the data as well: 4 to 15 rad/s
    assert np.abs(fit.response(FINE) - wanted).max() < 1e-3 * np.abs(wanted).max()
    found = np.linalg.eigvals(fit.a[0])
    np.testing.assert_allclose(np.sort_complex(found[found.imag > 0]), np.sort_complex(poles), atol=1e-3)


def test_data_that_no_passive_system_has_are_fitted_by_one():
    fit, whole, _ = known_system(noise=0.1)
    response = fit.response(FINE)
    assert lowest_eigenvalue(response, scales(whole(FINE))) > -1e-9
    assert np.abs(response[0]).max() < 1e-9
    assert np.abs(response - whole(FINE)).max() < 0.3 * np.abs(whole(FINE)).max()


def test_modes_without_memory_get_none():
    pytest.importorskip("cvxpy")
    omega = np.linspace(0.1, 4.0, 30)
    values = np.zeros((30, 6, 6))
    values[:, 2, 2] = 1e5 * omega * np.exp(-omega)  # heave alone, the other block is empty
    fit = fit_radiation(omega, np.zeros((30, 6, 6)), values, np.zeros((6, 6)))
    response = fit.response(omega)
    assert np.abs(response[:, 2, 2]).max() > 1e3
    response[:, 2, 2] = 0.0
    assert np.abs(response).max() < 1.0
    assert (np.linalg.eigvals(fit.a).real < 0.0).all()


def test_poles_stay_stable_and_slow_whatever_the_data():
    omega = np.linspace(0.1, 4.0, 30)
    growing = 1.0 / (1j * omega - 0.5) + 1.0 / (1j * omega + 40.0)
    poles = fit_poles(omega, growing[None, :], np.ones(30))
    assert (poles.real < 0.0).all()
    assert np.abs(poles).max() <= POLE_MAX + 1e-9
    a, b = sections(poles)
    assert a.shape == (SECTIONS, 2, 2)
    assert b.shape == (SECTIONS, 2)
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(a).ravel()), np.sort_complex(poles), atol=1e-9)


def test_real_poles_share_a_section():
    a, b = sections(np.array([-1.0, -2.0, -0.5 + 1.0j, -0.5 - 1.0j]))
    np.testing.assert_allclose(a[1], np.diag([-2.0, -1.0]))
    np.testing.assert_allclose(b, [[1.0, 0.0], [1.0, 1.0]])


def test_without_cvxpy_the_error_says_what_to_install(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(fitting, "import_module", missing)
    with pytest.raises(ConfigError, match=r"pip install shipcrane_twin\[hydro\]"):
        fit_radiation(np.linspace(0.1, 4.0, 20), np.ones((20, 6, 6)), np.ones((20, 6, 6)), np.ones((6, 6)))
