"""Box manoeuvre, slewing load and faults: their bars, and that each row sees what it is for."""

import numpy as np
import pytest

from shipcrane_twin.validation.positioning import ride
from shipcrane_twin.validation.positioning_faults import CASES, WEATHER, changes, fault_rows
from shipcrane_twin.validation.positioning_moves import (
    BOX,
    EVERY_STEP,
    FEED_FORWARD,
    LIFT,
    azimuth_rates,
    box_rows,
    legs,
    lift_rows,
    overshoots,
)

COARSE = ("macro_step_ms=50.0",)


@pytest.fixture(scope="module")
def box():
    return ride(BOX, (*EVERY_STEP, "duration_s=455.0"))


@pytest.fixture(scope="module")
def lifts():
    return {case: ride(LIFT, (*COARSE, *change, "duration_s=330.0")) for case, change in FEED_FORWARD.items()}


@pytest.fixture(scope="module")
def broken():
    return {
        case: ride(WEATHER, (*COARSE, *changes(case), "duration_s=365.0")) for case in ("position lost", "drive-off")
    }


def test_box_manoeuvre(box, measured):
    for row in box_rows(box):
        measured(f"DP {row.what}", row.value, row.bar, row.unit)
    assert len(legs(box)) == 2
    np.testing.assert_allclose(legs(box)[0][1], [0.0, 10.0, -np.pi / 4], atol=1e-9)


def test_overshoot_and_fast_azimuths_are_seen(box):
    rows, way = legs(box)[0]
    ahead = box.setpoint.copy()
    ahead[rows] += 0.06 * way
    wrong = box._replace(pose=ahead, azimuth=1.01 * box.azimuth)
    place, heading = overshoots(wrong)
    assert min(place[0], heading[0]) > 0.06  # the slow part of a step rings
    assert azimuth_rates(wrong).max() > 12.1
    assert [row.holds for row in box_rows(wrong)] == [False, False, False, False]


def test_feed_forward_takes_most_of_the_slewing_loads_push(lifts, measured):
    for row in lift_rows(lifts):
        if row.bar is not None:
            measured(f"DP {row.what}", row.value, 0.5 * row.bar, row.unit)
    swapped = {"without": lifts["with"], "with": lifts["without"]}
    assert not any(row.holds for row in lift_rows(swapped) if row.bar)


def test_faults_are_told_and_break_nothing(broken, measured):
    rows = {row.what: row for row in fault_rows(broken)}
    assert rows["faults without a warning"].value == 0.0
    assert rows["faults with a number that is none"].value == 0.0
    lost = rows["position lost: estimated against true position, 60 s of dead reckoning"]
    measured(f"DP {lost.what}", lost.value, 5.0, lost.unit)
    assert lost.value > 0.5
    assert any("position" in text for text in broken["position lost"].warnings)
    assert any("runaway" in text for text in broken["drive-off"].warnings)


def test_silence_and_numbers_that_are_none_are_seen(broken):
    run = broken["drive-off"]
    gone = {"drive-off": run._replace(warnings=(), pose=np.where(run.time_s[:, None] > 340.0, np.nan, run.pose))}
    rows = {row.what: row for row in fault_rows(gone)}
    assert rows["faults without a warning"].value == rows["faults with a number that is none"].value == 1.0


def test_every_case_names_its_events():
    assert len(CASES) == 6
    assert "at_s: 300.0, event: power_limit, share: 0.0" in changes("drift-off")[0]
