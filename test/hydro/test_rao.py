import dataclasses

import numpy as np
import pytest
from imported_ships import OMEGA, a_ship, mass_of

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.rao import (
    coupled_periods,
    mass_matrix,
    natural_periods,
    own_mass,
    raos,
    roll_damping,
    usual_mass,
)


def single(data):
    """The ship with diagonal matrices: six oscillators."""
    only = np.eye(6)
    return dataclasses.replace(
        data, added_mass=data.added_mass * only, damping=data.damping * only, restoring=data.restoring * only
    )


def test_one_degree_of_freedom_is_the_oscillator_of_the_textbooks():
    data = single(a_ship())
    mass = mass_of(data)
    extra = np.diag([0.0, 0.0, 0.0, 1e6, 0.0, 0.0])
    found = raos(data, mass, extra)
    w = OMEGA[:, None]
    stiffness, inertia = data.restoring[3, 3], mass[3, 3] + data.added_mass[:, 3, 3]
    expected = data.excitation[..., 3] / (
        stiffness - w**2 * inertia[:, None] + 1j * w * (data.damping[:, 3, 3, None] + 1e6)
    )
    np.testing.assert_allclose(found[..., 3], expected, rtol=1e-12, atol=1e-15)


def test_motions_solve_the_equations_of_motion():
    data = a_ship()
    mass = mass_of(data)
    found = raos(data, mass, extra_stiffness=np.diag([1e5, 0, 0, 0, 0, 0]))
    n = 17
    w = OMEGA[n]
    left = (
        data.restoring + np.diag([1e5, 0, 0, 0, 0, 0]) - w**2 * (mass + data.added_mass[n]) + 1j * w * data.damping[n]
    )
    np.testing.assert_allclose(found[n] @ left.T, data.excitation[n], rtol=1e-9, atol=1e-6)


def test_long_waves_carry_the_ship_along():
    omega = np.concatenate([[0.05], np.linspace(0.1, 1.0, 10)])
    data = a_ship(omega)
    motion = raos(data, mass_of(data))[0]
    k, d = omega[0] ** 2 / data.gravity, data.direction
    np.testing.assert_allclose(motion[:, 2], 1.0, atol=0.02)
    np.testing.assert_allclose(motion[:, 3], -1j * k * np.sin(d), atol=0.05 * k)  # lies in the surface
    np.testing.assert_allclose(motion[:, 4], 1j * k * np.cos(d), atol=0.05 * k)


def test_the_state_space_model_takes_the_place_of_the_tables():
    data = a_ship()
    # a memory of nothing leaves A_inf alone
    same = dataclasses.replace(
        data, added_mass=np.broadcast_to(data.added_mass_inf, (len(OMEGA), 6, 6)), damping=0 * data.damping
    )
    np.testing.assert_allclose(raos(data, mass_of(data), from_fit=True), raos(same, mass_of(data)), rtol=1e-12)


def test_natural_periods_of_single_oscillators():
    data = single(a_ship())
    added = np.broadcast_to(data.added_mass_inf * np.eye(6), (len(OMEGA), 6, 6))
    data, mass = dataclasses.replace(data, added_mass=added), mass_of(data)
    found, coupled = natural_periods(data, mass), coupled_periods(data, mass)
    for name, mode in (("heave", 2), ("roll", 3), ("pitch", 4)):
        expected = 2 * np.pi * np.sqrt((mass[mode, mode] + added[0, mode, mode]) / data.restoring[mode, mode])
        assert found[name] == pytest.approx(expected, rel=1e-3)
        assert coupled[name] == pytest.approx(expected, rel=1e-3)


def test_coupled_periods_make_the_matrix_singular():
    data = a_ship()
    mass = mass_of(data)
    for name, modes in (("heave", (2, 4)), ("roll", (1, 3, 5)), ("pitch", (2, 4))):
        w = 2 * np.pi / coupled_periods(data, mass)[name]
        added = np.array([[np.interp(w, OMEGA, data.added_mass[:, i, j]) for j in modes] for i in modes])
        block = np.ix_(modes, modes)
        inertia = mass[block] + added
        root = np.linalg.inv(np.linalg.cholesky(inertia))
        values = np.linalg.eigvalsh(root @ (data.restoring[block] - w**2 * inertia) @ root.T)
        assert np.abs(values).min() < 1e-6 * np.abs(values).max()


def test_an_unstable_ship_is_refused():
    data = a_ship()
    restoring = data.restoring.copy()
    restoring[3, 3] = -1.0
    with pytest.raises(ConfigError, match=r"roll: stiffness -1, expected a positive one; lower the CoG"):
        natural_periods(dataclasses.replace(data, restoring=restoring), mass_of(data))


def test_a_mass_matrix_is_diagonal_about_the_cog():
    np.testing.assert_array_equal(np.diag(mass_matrix(1.0, 2.0, 3.0, 4.0)), [1.0, 1.0, 1.0, 2.0, 3.0, 4.0])


def test_own_mass_keeps_the_inertia():
    data = a_ship()
    found = own_mass(np.diag([1.0, 1.0, 1.0, 7.0, 8.0, 9.0]), data)
    np.testing.assert_array_equal(np.diag(found), [data.mass] * 3 + [7.0, 8.0, 9.0])


def test_usual_radii_and_roll_damping():
    data = a_ship()
    mass = usual_mass(data)
    radii = np.sqrt(np.diag(mass)[3:] / data.mass)
    np.testing.assert_allclose(radii, [0.35 * 10.0 / 0.82, 10.0, 10.0])
    critical = 2.0 * np.sqrt(data.restoring[3, 3] * (mass[3, 3] + data.added_mass_inf[3, 3]))
    extra = roll_damping(data, mass, 0.07)
    assert extra[3, 3] == pytest.approx(0.07 * critical)
    assert np.count_nonzero(extra) == 1
