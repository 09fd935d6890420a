import dataclasses

import numpy as np
import pytest
from imported_ships import a_ship, mass_of, shipx_folder, without_fit

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.compare import Row, compare_with_veres, haskind_rows, validate_import
from shipcrane_twin.hydro.fit import fit_radiation
from shipcrane_twin.hydro.rao import raos
from shipcrane_twin.hydro.veres import import_veres, read_motions
from shipcrane_twin.hydro.veres_extras import read_extras


def by_name(rows):
    assert len({row.what for row in rows}) == len(rows)
    return {row.what: row for row in rows}


def test_a_ship_equals_itself():
    data = a_ship()
    rows = compare_with_veres(data, data, mass_of(data))
    assert all(row.value < 1e-9 for row in rows)
    assert {row.what.split()[0] for row in rows if row.bar is not None} == {
        "F2",
        "F3",
        "F4",
        "F5",
        "A22",
        "A33",
        "A44",
        "natural",
    }


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_a_larger_load_is_measured_at_its_own_size(share):
    data = a_ship()
    loads = data.excitation.copy()
    loads[..., 2] *= 1.0 + share
    rows = by_name(compare_with_veres(dataclasses.replace(data, excitation=loads), data, mass_of(data)))
    row = rows["F3 (heave) against VERES at 8 s"]
    assert row.value == pytest.approx(share)
    assert row.holds == (share < 0.15)
    assert rows["F2 (sway) against VERES at 8 s"].value == 0.0


def test_a_phase_is_seen_only_with_phase():
    data = a_ship()
    rows = by_name(compare_with_veres(dataclasses.replace(data, excitation=1j * data.excitation), data, mass_of(data)))
    assert rows["F4 (roll) against VERES at 6 s"].value < 1e-9
    assert rows["F4 (roll) against VERES at 6 s, with phase"].value == pytest.approx(np.sqrt(2.0))


def test_added_mass_and_periods_follow_their_ratio():
    data = a_ship()
    heavy = dataclasses.replace(data, added_mass=1.1 * data.added_mass)
    rows = by_name(compare_with_veres(heavy, data, mass_of(data)))
    assert rows["A33 against VERES, periods of 5 to 12 s"].value == pytest.approx(0.1)
    assert 0.01 < rows["natural period of heave against VERES"].value < 0.05


def test_other_reference_points_are_refused():
    data = a_ship()
    with pytest.raises(ConfigError, match=r"CoG at .* move one database with `moved`"):
        compare_with_veres(data, dataclasses.replace(data, cog=data.cog + [0.5, 0, 0]), mass_of(data))


def test_a_table_that_ends_early_is_named():
    data = a_ship(np.linspace(0.15, 1.1, 10))
    with pytest.raises(ConfigError, match=r"box: the table runs from 0.15 to 1.1 rad/s, expected one that holds"):
        compare_with_veres(data, data, mass_of(data))


def test_validation_sees_a_wrong_motion():
    data = a_ship()
    motions = raos(data, mass_of(data))
    right = by_name(validate_import(data, mass_of(data), motions))
    wrong = by_name(validate_import(data, mass_of(data), motions * 1.05))
    assert right["heave RAO against the file's own"].holds
    assert right["pitch RAO against the file's own, with phase"].value < 1e-12
    assert wrong["heave RAO against the file's own"].value == pytest.approx(0.05 / 1.05)
    assert not wrong["heave RAO against the file's own"].holds


def test_haskind_relation_of_a_point_that_radiates_alike():
    """A body small beside the wave radiates in rings: |F3| is the same all around, B33 is w^3 |F3|^2 / (2 rho g^3)."""
    data = a_ship()
    loads = np.zeros_like(data.excitation)
    loads[..., 2] = 1e6
    damping = np.zeros_like(data.damping)
    damping[:, 2, 2] = data.omega**3 * 1e12 / (2.0 * data.water_density * data.gravity**3)
    rows = by_name(haskind_rows(dataclasses.replace(data, excitation=loads, damping=damping + np.eye(6))))
    assert rows["B33 against the wave loads (Haskind)"].value < 1e-3


def test_motions_need_the_mass_they_were_made_with():
    data = a_ship()
    with pytest.raises(ConfigError, match=r"box: motions without the mass matrix .*; give mass6"):
        validate_import(data, motions=data.excitation)
    assert validate_import(data)


def test_a_row_without_a_bar_holds():
    assert Row("any", 9.0, None).holds


def test_the_reference_ship_through_its_state_space_model(tmp_path_factory, measured):
    folder = shipx_folder(tmp_path_factory)
    pytest.importorskip("cvxpy")
    ship, extras = import_veres(folder, fit=fit_radiation), read_extras(folder)
    roll = np.zeros((6, 6))
    roll[3, 3] = 0.12 * np.sqrt(ship.restoring[3, 3] * (extras.mass[3, 3] + ship.added_mass_inf[3, 3]))
    rows = by_name(validate_import(ship, extras.mass, read_motions(folder, ship), roll))
    for name in ("surge", "sway", "heave", "roll", "pitch", "yaw"):
        row = rows[f"{name} RAO from state space against the tables"]
        measured(f"imported VERES model: {name} RAO of the state-space model against its tables", row.value, row.bar)
    whole = raos(ship, extras.mass, roll, from_fit=True)
    motions = read_motions(folder, ship)
    for name, mode in (("heave", 2), ("pitch", 4)):
        error = np.abs(np.abs(whole[..., mode]) - np.abs(motions[..., mode])).max() / np.abs(motions[..., mode]).max()
        measured(f"imported VERES model: {name} RAO of the state-space model against VERES's own", error, 0.02)
    assert all(row.holds for row in rows.values())


def test_without_a_fit_the_state_space_rows_miss(tmp_path_factory):
    folder = shipx_folder(tmp_path_factory)
    rows = by_name(validate_import(import_veres(folder, fit=without_fit)))
    assert not rows["heave RAO from state space against the tables"].holds
