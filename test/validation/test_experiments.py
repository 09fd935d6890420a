"""The experiments of the validation page: their bars, and that each sees a wrong physics."""

import dataclasses

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.hydro.rao import raos
from shipcrane_twin.validation import drift, hull, motions


@pytest.fixture(scope="module")
def rig():
    return drift.make_rig("case3")


@pytest.fixture(scope="module")
def ship():
    scenario = load_scenario("case3")
    return vessel_params(scenario), hydro_database(scenario)


def test_hull_and_state_space_hold_their_bars(ship):
    rows = hull.hull_rows(ship[1]) + hull.fit_rows(ship[1])
    assert len(rows) >= 6 + 10 + 1
    assert [row for row in rows if not row.holds] == []


def test_a_hull_of_another_size_misses_by_what_it_is_larger(ship):
    larger = dataclasses.replace(ship[1], volume=1.02 * ship[1].volume, restoring=1.02 * ship[1].restoring)
    rows = {row.what: row for row in hull.hull_rows(larger)}
    for name in ("volume", "C33", "C44", "C55"):
        assert not rows[f"{name} of the hull"].holds
    assert rows["GM_T of the hull"].value == pytest.approx(0.0158, abs=1e-3)  # a ratio of both: as before


def test_a_state_space_model_that_is_off_or_feeds_motion_is_seen(ship):
    data = ship[1]
    off = dataclasses.replace(data, fit=dataclasses.replace(data.fit, c=1.25 * data.fit.c))
    assert sum(not row.holds for row in hull.fit_rows(off)) > 8
    active = dataclasses.replace(data, fit=dataclasses.replace(data.fit, c=-data.fit.c))
    assert not hull.fit_rows(active)[-1].holds


@pytest.fixture(scope="module")
def moving(ship):
    return motions.regular_wave_motions(*ship)


def test_motions_in_regular_waves(moving, measured):
    assert moving.time_domain.shape == (5, 10, 6)
    for row in motions.motion_rows(moving):
        measured(f"regular waves: {row.what}, 50 cases", 100.0 * row.value, 100.0 * row.bar, "%")


@pytest.mark.parametrize("factor", [1.05, 1.0 + 0.05j])  # of the size, of the phase
def test_motions_that_are_off_by_5_percent_are_seen(moving, factor):
    wrong = moving._replace(frequency_domain=moving.frequency_domain * factor)
    assert not any(row.holds for row in motions.motion_rows(wrong))


def test_motions_show_the_viscous_damping(ship, moving):
    params, data = ship
    rows = [int(np.argmin(np.abs(data.omega - omega))) for omega in moving.omega]
    columns = [int(np.argmin(np.abs(data.direction - angle))) for angle in moving.direction]
    undamped = raos(data, params.rigid_mass)[np.ix_(rows, columns)]
    assert not motions.motion_rows(moving._replace(frequency_domain=undamped))[3].holds


def test_drift_load_of_the_kernel_is_the_transfer_function(rig, measured):
    for row in drift.load_rows(rig.data):
        measured(f"drift: {row.what}", 100.0 * row.value, 100.0 * row.bar, "%")


def test_without_first_order_loads_the_held_ship_feels_the_drift_alone(rig, measured):
    """The springs, the slow pose and the means are right: 0.5 % wherever a load counts."""
    still = dataclasses.replace(rig.data, excitation=np.zeros_like(rig.data.excitation))
    held = drift.held_drift(rig._replace(data=still), (1.9,), 45)
    for row in drift.drift_rows(held, rig.data):
        if row.bar:
            measured(f"drift, no first-order loads: {row.what}", 100.0 * row.value, 0.5, "%")


def test_mean_loads_of_the_whole_ship(rig, measured):
    """First-order loads and motions add no mean load of their own."""
    held = drift.held_drift(rig, (1.05, 1.65), 45)
    for row in drift.drift_rows(held, rig.data):
        if row.bar:
            measured(f"drift: {row.what}", 100.0 * row.value, 100.0 * row.bar, "%")


def test_a_drift_of_the_wrong_size_is_seen(rig):
    larger = dataclasses.replace(rig.data, drift=1.08 * rig.data.drift)
    held = drift.held_drift(rig._replace(data=larger), (1.9,), 90)
    wrong = held._replace(expected=held.expected / 1.08)
    row = next(row for row in drift.drift_rows(wrong, rig.data) if row.what.startswith("mean sway"))
    assert row.value == pytest.approx(0.08, abs=0.01)
    assert not row.holds
