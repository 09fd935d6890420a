"""Allocation, stability and capability as the page tells them, and the page itself."""

import dataclasses

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim import dp_build
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation.page import Picture, Section
from shipcrane_twin.validation.positioning_page import write_page
from shipcrane_twin.validation.positioning_theory import (
    allocate_many,
    allocation_rows,
    capability_rows,
    in_zone,
    random_load,
    stability_rows,
)


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("case3")


def test_allocation_of_many_demands(scenario, measured):
    found = allocate_many(scenario, 2000)
    assert found.infeasible > 200
    for row in allocation_rows(found, 2000):
        measured(f"DP {row.what}", row.value, 1e3 if row.bar is None else row.bar, row.unit)


def test_an_allocation_that_is_off_is_seen(scenario):
    quick = dataclasses.replace(scenario.dp.allocation, method="pseudo_inverse")
    found = allocate_many(dataclasses.replace(scenario, dp=dataclasses.replace(scenario.dp, allocation=quick)), 400)
    rows = allocation_rows(found, 400)
    assert [row.holds for row in rows][:4] == [False, True, True, False]  # it keeps to the limits and misses demands


def test_zones_are_those_of_the_settings(scenario):
    params = dp_build.allocation_of(scenario, dp_build.propulsion_params(scenario))
    north, edge = np.deg2rad([90.0, -90.0, 90.0]), np.deg2rad([111.0, -69.0, 90.0])
    np.testing.assert_array_equal(in_zone(params, north), [True, True, False])
    assert not in_zone(params, edge).any()
    assert np.isfinite(random_load(params, np.random.default_rng(1))).all()


def test_loop_is_stable_with_margins(scenario, measured):
    rows = stability_rows(scenario)
    for row in rows[:3]:
        measured(f"DP {row.what}", row.value, row.bar, row.unit)
    margins = [row.value for row in rows[3:]]
    assert len(margins) == 6
    measured("DP loop with observer: least phase margin, degrees below 30", 30.0 - min(margins), 0.0, "deg")


def test_a_loop_that_is_not_stable_is_seen(scenario):
    weak = dataclasses.replace(scenario.dp.controller, damping_ratio=(0.05, 0.05, 0.05))
    rows = stability_rows(dataclasses.replace(scenario, dp=dataclasses.replace(scenario.dp, controller=weak)))
    assert not any(row.holds for row in rows[:3])


def test_capability_that_grows_with_a_loss_is_seen():
    cases = {"intact": np.array([5.0, 6.0]), "without a_b": np.array([4.0, 6.0]), "without c": np.array([5.0, 6.1])}
    assert [row.holds for row in capability_rows(cases)] == [True, True, False]


def test_page_holds_every_figure_and_picture(tmp_path):
    picture = Picture(tmp_path / "pictures" / "dp_a.png", "What to see.")
    sections = [Section("Part", "Words.", [Row("one", 1.0, 2.0, "m"), Row("two", 3.0, 2.0, "m", "far")], [picture])]
    text = write_page(sections, "./twin dp validate", tmp_path).read_text(encoding="utf-8")
    assert text.startswith("# Validation of dynamic positioning\n")
    assert "`./twin dp validate`; 1 of 2 figures" in text
    assert "| two | 3 m | 2 m | **MISSED** | far |" in text
    assert "](pictures/dp_a.png)" in text
