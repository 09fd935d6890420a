import dataclasses

import numpy as np
import pytest
from imported_ships import a_ship, without_fit

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import MIRROR, check, moved
from shipcrane_twin.hydro.importing import finish, fold, phase_shift, transfer


def test_the_known_ship_passes_the_checks():
    check(a_ship(), "box")


def test_a_transfer_moves_velocities_as_a_rigid_body_does():
    arm, velocity, spin = np.array([2.0, -1.0, 3.0]), np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.5, 0.6])
    here = transfer(arm) @ np.concatenate([velocity, spin])
    np.testing.assert_allclose(here, [*(velocity - np.cross(spin, arm)), *spin])


def test_transfer_and_phase_agree_with_the_move_of_a_database():
    data = a_ship()
    arm = np.array([3.0, 0.0, -1.5])
    there = moved(data, data.cog + arm)
    shift = transfer(arm)
    np.testing.assert_allclose(there.added_mass, shift.T @ data.added_mass @ shift, rtol=1e-12)
    phase = phase_shift(data.omega, data.direction, arm[0], data.gravity, data.depth)
    np.testing.assert_allclose(there.excitation, (data.excitation @ shift) * phase[..., None], rtol=1e-9)


def test_directions_of_both_sides_fold_onto_one():
    angles = np.array([-90.0, -45.0, 0.0, 45.0, 180.0, 200.0])
    values = np.exp(1j * np.arange(36.0)).reshape(1, 6, 6)
    found, folded = fold(angles, values)
    np.testing.assert_allclose(np.rad2deg(found), [0.0, 45.0, 90.0, 160.0, 180.0])
    # 45 degrees is given itself; 90 and 160 come from the other side
    np.testing.assert_allclose(
        folded[0], [values[0, 2], values[0, 3], values[0, 0] * MIRROR, values[0, 5] * MIRROR, values[0, 4]]
    )


def test_a_hull_whose_sides_differ_is_refused():
    data = a_ship()
    added = data.added_mass.copy()
    added[:, 1, 2] = added[:, 2, 1] = 0.1 * np.sqrt(added[:, 1, 1] * added[:, 2, 2])
    with pytest.raises(ConfigError, match=r"file: added_mass couples .* by .* % .* same on both"):
        finish(dataclasses.replace(data, added_mass=added), "file", without_fit)


def test_numerical_asymmetry_is_averaged_away():
    data = a_ship()
    added = data.added_mass.copy()
    added[:, 2, 4] *= 1.001
    whole = finish(dataclasses.replace(data, added_mass=added), "file", without_fit)
    np.testing.assert_allclose(whole.added_mass[:, 2, 4], 0.5 * (added[:, 2, 4] + added[:, 4, 2]))
    np.testing.assert_array_equal(whole.added_mass, np.swapaxes(whole.added_mass, 1, 2))
