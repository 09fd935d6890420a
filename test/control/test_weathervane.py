"""Weather-optimal heading: converges bow-on from anywhere, slowly, and keeps still without a demand."""

import numpy as np
import pytest
from dp_rig import controller, move
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.control.controller import controller_start, controller_update, to_body
from shipcrane_twin.control.reference import POSE, ReferenceParams, reference_start, reference_step
from shipcrane_twin.control.weathervane import WeathervaneParams, weathervane_step
from shipcrane_twin.cosim.build import vessel_params
from shipcrane_twin.physics.frames import wrap_angle
from shipcrane_twin.physics.hull import current_load

PERIOD_S = 0.5
STILL = np.zeros(3)
VANE = WeathervaneParams(rate_max=np.deg2rad(0.3), full_load=1e4, cutoff_period=200.0, period=PERIOD_S)


@pytest.fixture(scope="module")
def hull():
    return vessel_params(load_scenario("case2")).hull


def turned_ship(hull, start_yaw, current_yaw, duration, speed=1.0):
    """Headings (n,) and sway demands (n,) of a DP ship in a constant current that goes to `current_yaw`."""
    params = controller(period=PERIOD_S)
    model = ReferenceParams(
        np.array([0.25, np.deg2rad(0.5)]), np.array([0.01, np.deg2rad(0.02)]), 8.0, 0.0, PERIOD_S
    )
    pose, velocity, demand = np.array([0.0, 0.0, start_yaw]), np.zeros(3), np.zeros(3)
    state, reference, vane = controller_start(), reference_start(model, pose, STILL), np.zeros(2)
    heading, yaws, sways = start_yaw, [], []
    for _ in range(round(duration / PERIOD_S)):
        vane, heading = weathervane_step(VANE, vane, demand, pose[2], heading)
        reference = reference_step(model, reference, np.array([0.0, 0.0, heading]))
        state, demand = controller_update(params, state, True, reference, pose, velocity, STILL, STILL, demand)
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        current_w = speed * np.array([np.cos(current_yaw), np.sin(current_yaw), 0.0])
        flow = to_body(current_w, cos, sin) - velocity
        pose, velocity = move(pose, velocity, demand + np.array(current_load(hull, flow[0], flow[1])), PERIOD_S)
        yaws.append(pose[2])
        sways.append(demand[1])
    assert np.hypot(*pose[:2]) < 2.0
    assert reference[POSE][2] == pytest.approx(wrap_angle(heading), abs=0.1)
    return np.array(yaws), np.array(sways)


@pytest.mark.parametrize("off_deg", [30.0, -100.0, 178.0])
def test_ship_ends_bow_to_the_current_without_sway_demand(hull, off_deg, measured):
    current_yaw = 2.0
    bow_on = current_yaw + np.pi
    yaws, sways = turned_ship(hull, wrap_angle(bow_on + np.deg2rad(off_deg)), current_yaw, 3600.0)
    error = abs(np.rad2deg(wrap_angle(yaws[-1] - bow_on)))
    measured(f"weather-optimal heading from {off_deg:g} deg off: error at the end", error, 2.0, "deg")
    assert np.abs(sways[-600:]).max() < 0.1 * np.abs(sways).max()


@settings(deadline=None)
@given(surge=st.floats(1e3, 1e5), sway=st.floats(-1e5, 1e5), yaw=st.floats(-3.0, 3.0))
def test_bow_goes_to_the_side_the_thrusters_push_to_within_the_rate(surge, sway, yaw):
    state, heading = np.zeros(2), yaw
    for _ in range(50):
        state, new = weathervane_step(VANE, state, np.array([surge, sway, 0.0]), yaw, heading)
        turn = wrap_angle(new - heading)
        assert abs(turn) <= VANE.rate_max * VANE.period * (1.0 + 1e-9)
        assert turn * sway >= -1e-12
        heading = new


def test_rate_is_in_proportion_to_the_mean_sway_demand():
    state = np.array([5e4, 2e3])
    _, heading = weathervane_step(VANE, state, np.array([5e4, 2e3, 0.0]), 0.0, 0.0)
    assert heading == pytest.approx(VANE.rate_max * 0.2 * VANE.period)


def test_no_demand_no_turn():
    state, heading = weathervane_step(VANE, np.zeros(2), STILL, 1.0, 0.4)
    assert heading == pytest.approx(0.4)
    np.testing.assert_array_equal(state, 0.0)


def test_stern_to_the_weather_it_turns_though_there_is_no_sway_demand():
    _, heading = weathervane_step(VANE, np.array([-2e4, 0.0]), np.array([-2e4, 0.0, 0.0]), 0.0, 0.0)
    assert abs(heading) == pytest.approx(VANE.rate_max * VANE.period)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("where", [0, 1, "yaw"])
def test_demand_that_is_no_number_changes_nothing(bad, where):
    demand, yaw = np.array([1e4, 1e4, 0.0]), 0.0
    if where == "yaw":
        yaw = bad
    else:
        demand[where] = bad
    state = np.array([1e3, 2e3])
    new, heading = weathervane_step(VANE, state, demand, yaw, 0.3)
    np.testing.assert_array_equal(new, state)
    assert heading == 0.3
