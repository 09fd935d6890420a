"""Station keeping, wave filter and observer: their bars, and that each row sees what it is for."""

import numpy as np
import pytest

from shipcrane_twin.cosim.dp_build import ship_3dof
from shipcrane_twin.validation.positioning import off_setpoint, ride, slow, to_level
from shipcrane_twin.validation.positioning_station import (
    BARS,
    NO_FILTER,
    UNBIASED,
    band_power,
    observer_rows,
    station_rows,
    true_bias,
    wave_rows,
)

UNTIL = ("duration_s=340.0",)
COARSE = ("macro_step_ms=50.0",)
WEATHER = {"E1": "case3", "E2": "case3_e2"}


@pytest.fixture(scope="module")
def runs():
    return {weather: ride(name, UNTIL) for weather, name in WEATHER.items()}


@pytest.fixture(scope="module")
def seen():
    return ride("case3", (*COARSE, *UNBIASED))


@pytest.fixture(scope="module")
def blind():
    return ride("case3", (*COARSE, *NO_FILTER))


def hold(rows, measured):
    for row in rows:
        if row.bar is not None:
            measured(f"DP {row.what}", row.value, row.bar, row.unit)


@pytest.mark.parametrize("weather", list(WEATHER))
def test_the_ship_keeps_her_station(runs, weather, measured):
    rows = station_rows(weather, runs[weather])
    assert len(rows) == 4
    hold(rows, measured)


def test_a_ship_beside_her_station_is_seen(runs):
    run = runs["E1"]
    beside = station_rows("E1", run._replace(pose=run.pose + [0.8, 0.8, 0.04]))
    assert not any(row.holds for row in beside)
    distance, heading = off_setpoint(run._replace(pose=run.setpoint + [3.0, 4.0, -0.1]))
    np.testing.assert_allclose(distance, 5.0)
    np.testing.assert_allclose(heading, np.rad2deg(0.1))  # to starboard
    assert BARS["E1"].position_rms == 0.5


def test_waves_stay_out_of_the_demand(seen, blind, measured):
    rows = wave_rows("E1", seen, blind)
    assert sum(row.bar is not None for row in rows) == 5
    hold(rows, measured)
    assert not any(row.holds for row in wave_rows("E1", blind, blind) if row.bar)


def test_power_of_the_band_is_that_of_a_sine_within_it(seen):
    inside, outside = (np.sin(2.0 * np.pi * hz * seen.time_s)[:, None] for hz in (0.1, 0.3))
    assert band_power(seen, inside)[0] == pytest.approx(0.5, rel=0.05)
    assert band_power(seen, outside)[0] < 1e-3


def test_observer_finds_place_and_bias(seen, measured):
    hold(observer_rows("E1", seen), measured)


def test_an_observer_that_is_off_is_seen(seen):
    off = observer_rows("E1", seen._replace(estimate=seen.estimate + [0.0, 0.1, 0.01], bias=0.7 * seen.bias))
    assert [row.holds for row in off] == [False, False, False, False, False]


def test_true_bias_is_the_load_that_no_one_told(seen):
    """A ship at rest: minus what is known; one that speeds up takes mass times acceleration more."""
    still = np.tile([1.0, 2.0, 0.5], (len(seen.time_s), 1))
    known = np.tile([3e3, -2e3, 1e4], (len(seen.time_s), 1))
    np.testing.assert_allclose(true_bias(seen._replace(pose=still, known=known)), -known, rtol=1e-6)
    faster = still + 0.005 * np.outer(seen.time_s**2, [1.0, 0.0, 0.0])
    mass, damping = ship_3dof(seen.scenario)
    rate = to_level(np.array([[0.01, 0.0, 0.0]]), np.array([0.5]))
    expected = rate @ mass.T + np.outer(seen.time_s, rate @ damping.T)
    found = true_bias(seen._replace(pose=faster, known=0.0 * known))
    np.testing.assert_allclose(found[1000:3000], expected[1000:3000], atol=15.0)  # of 6 kN


def test_slow_part_has_no_delay_and_level_axes_turn_with_the_ship():
    time_s = np.arange(0.0, 600.0, 0.1)
    wave = 0.3 * np.sin(0.7 * time_s)
    drift = np.sin(0.03 * time_s)
    np.testing.assert_allclose(slow((drift + wave)[:, None], 0.1)[500:-500, 0], drift[500:-500], atol=0.01)
    turned = to_level(np.array([[1.0, 0.0, 2.0]]), np.array([np.pi / 2]))
    np.testing.assert_allclose(turned, [[0.0, -1.0, 2.0]], atol=1e-12)
