"""Faults of thrusters, sensors and power: told, survived, and over when they are repaired."""

import functools

import numpy as np
import pytest
from dp_runs import SEA, DpRun, dp_scenario, event
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.config.scenario import SENSOR_FAULTS, SENSORS, THRUSTER_FAULTS, EventConfig, wrong_keys
from shipcrane_twin.cosim.dp_faults import DpFaults
from shipcrane_twin.physics.propulsion import FAILED, FROZEN, LIMITED, OK, RUNAWAY

THRUSTERS = ("azimuth_port", "azimuth_starboard", "bow_tunnel")


def thruster(at_s, which, fault, **share):
    return event(at_s, "thruster_fault", which=which, fault=fault, **share)


def sensor(at_s, which, fault):
    return event(at_s, "sensor_fault", which=which, fault=fault)


def faults_after(*events):
    faults = DpFaults(THRUSTERS)
    for keys in events:
        faults.happen(EventConfig(**keys))
    return faults


@pytest.mark.parametrize(
    ("fault", "code", "left"),
    [("none", OK, 1.0), ("failed", FAILED, 0.0), ("frozen", FROZEN, 0.0), ("runaway", RUNAWAY, 0.0)],
)
def test_what_a_broken_thruster_is_and_has_left_for_dp(fault, code, left):
    faults = faults_after(thruster(0.0, "azimuth_starboard", fault))
    np.testing.assert_array_equal(faults.thruster, [OK, code, OK])
    np.testing.assert_array_equal(faults.available, [1.0, left, 1.0])
    assert faults.told() == ([] if fault == "none" else [f"thruster azimuth_starboard: {fault}"])


def test_a_limited_thruster_has_its_share_until_it_is_repaired():
    limit = thruster(0.0, "bow_tunnel", "limited", share=0.3)
    faults = faults_after(limit)
    assert faults.thruster[2] == LIMITED
    np.testing.assert_array_equal(faults.available, [1.0, 1.0, 0.3])
    assert faults.told() == ["thruster bow_tunnel: limited to 30 %"]
    repaired = faults_after(limit, thruster(1.0, "bow_tunnel", "none"))
    np.testing.assert_array_equal(repaired.available, 1.0)
    assert repaired.told() == []


def test_sensors_and_power_are_told_until_they_are_repaired():
    broken = [sensor(0.0, "gyro", "drop_out"), event(0.0, "power_limit", share=0.25)]
    assert faults_after(*broken).told() == ["sensor gyro: drop out", "power limited to 25 %"]
    repaired = faults_after(*broken, sensor(0.0, "gyro", "none"), event(0.0, "power_limit", share=1.0))
    assert repaired.told() == []
    assert repaired.power_share == 1.0


BREAK_S, REPAIR_S, END_S = 15.0, 30.0, 40.0
BROKEN = {
    f"{which} {fault}": (thruster(BREAK_S, which, fault), thruster(REPAIR_S, which, "none"))
    for which in THRUSTERS[1:]
    for fault in ("failed", "frozen", "runaway")
}
BROKEN["bow_tunnel limited"] = (
    thruster(BREAK_S, "bow_tunnel", "limited", share=0.2),
    thruster(REPAIR_S, "bow_tunnel", "none"),
)
BROKEN |= {
    f"{which} {fault}": (sensor(BREAK_S, which, fault), sensor(REPAIR_S, which, "none"))
    for which in SENSORS
    for fault in ("drop_out", "frozen")
}
BROKEN |= {
    f"power {share}": (event(BREAK_S, "power_limit", share=share), event(REPAIR_S, "power_limit", share=1.0))
    for share in (0.0, 0.3)
}


@pytest.mark.parametrize(("broken", "repaired"), BROKEN.values(), ids=BROKEN.keys())
def test_a_fault_is_told_survived_and_over_after_its_repair(broken, repaired):
    run = DpRun(dp_scenario(END_S, SEA, events=[broken, repaired]))
    name = broken.get("which", "power")
    assert not any(run.told(0.0, BREAK_S))
    assert all(name in told for told in run.told(BREAK_S + 0.05, REPAIR_S))
    assert not any(name in told for told in run.told(REPAIR_S + 0.05, END_S))
    assert run.excursion(0.0, END_S) < 15.0


HARD = ("environment.wind_speed_m_s=12.0",)


@functools.cache
def in_hard_wind(*kinds):
    """Return a run in which some of these happen at 30 s and end at 60 s."""
    faults = {
        "blackout": (event(30.0, "power_limit", share=0.0), event(60.0, "power_limit", share=1.0)),
        "drive-off": (thruster(30.0, "azimuth_port", "runaway"), thruster(60.0, "azimuth_port", "none")),
        "blind": (sensor(30.0, "position", "drop_out"), sensor(60.0, "position", "none")),
    }
    return DpRun(dp_scenario(160.0, *HARD, events=[found for kind in kinds for found in faults[kind]]))


def test_without_power_the_ship_drifts_off_down_the_wind_and_comes_back():
    held, adrift = in_hard_wind(), in_hard_wind("blackout")
    assert held.excursion(30.0, 160.0) < 2.0
    times, place = adrift.cog()
    assert place[times == 60.0, 0] > held.excursion(30.0, 60.0) + 3.0  # the wind goes east
    times, thrust = adrift.series("/thrusters/joint_states")
    assert np.abs(thrust[times == 59.0, 6:9]).max() < 100.0
    assert adrift.excursion(60.0, 160.0) < 2.0 * adrift.excursion(60.0, 61.0)  # no integrator that has wound up
    assert adrift.excursion(150.0, 160.0) < 2.0


def test_a_thruster_that_runs_away_drives_the_ship_off_and_dp_brings_it_back():
    driven = in_hard_wind("drive-off")
    assert driven.excursion(30.0, 90.0) > in_hard_wind().excursion(30.0, 90.0) + 2.0
    assert any("cannot give" in told for told in driven.told(30.0, 60.0))
    assert driven.excursion(150.0, 160.0) < 2.0


@pytest.mark.parametrize(("lost", "wind_to_deg"), [("azimuth_port", 270.0), ("azimuth_starboard", 90.0)])
def test_the_other_azimuth_may_push_towards_one_that_stands_still(lost, wind_to_deg):
    """All sway force of the one left points into the zone that protected the lost one."""
    weather = (f"environment.wind_direction_to_deg={wind_to_deg}", "environment.wind_speed_m_s=10.0")
    failed = [event(30.0, "thruster_fault", which=lost, fault="failed")]
    run = DpRun(dp_scenario(120.0, *weather, events=failed))
    assert run.excursion(60.0, 120.0) < 2.0


def test_dead_reckoning_keeps_the_ship_near_and_the_fix_brings_it_back():
    blind = in_hard_wind("blind")
    assert blind.excursion(30.0, 60.0) < 6.0
    assert blind.excursion(140.0, 160.0) < 2.0


@pytest.mark.parametrize("kind", ["passive", "ekf"])
def test_dead_reckoning_is_told_once_the_position_is_lost_for_long(kind):
    cut = [sensor(10.0, "position", "drop_out"), sensor(20.0, "position", "none"), sensor(20.0, "gyro", "drop_out")]
    run = DpRun(dp_scenario(28.0, f"dp.observer.kind={kind}", events=cut))
    assert not any("dead reckoning" in told for told in run.told(0.0, 14.9))
    assert all("dead reckoning: no east, north for" in told for told in run.told(15.3, 20.0))
    assert not any("dead reckoning" in told for told in run.told(20.3, 24.9))
    assert all("dead reckoning: no heading for" in told for told in run.told(25.3, 28.0))


@st.composite
def anything(draw):
    """Return an event of any kind at any time, as the settings allow it."""
    at_s = draw(st.integers(0, 240)) / 50.0
    kind = draw(st.sampled_from(["thruster_fault", "sensor_fault", "power_limit", "dp_on", "dp_off"]))
    keys = {}
    if kind == "thruster_fault":
        keys = {"which": draw(st.sampled_from(THRUSTERS)), "fault": draw(st.sampled_from(THRUSTER_FAULTS))}
    elif kind == "sensor_fault":
        keys = {"which": draw(st.sampled_from(SENSORS)), "fault": draw(st.sampled_from(SENSOR_FAULTS))}
    if kind == "power_limit" or keys.get("fault") == "limited":
        keys["share"] = draw(st.sampled_from([0.0, 0.001, 0.5, 1.0]))
    found = event(at_s, kind, **keys)
    assert wrong_keys(EventConfig(**found), THRUSTERS) == []
    return found


@settings(deadline=None, max_examples=15)
@given(
    events=st.lists(anything(), min_size=1, max_size=8),
    kind=st.sampled_from(["passive", "ekf", "none"]),
    method=st.sampled_from(["qp", "pseudo_inverse"]),
    delay=st.integers(0, 2),
)
def test_nothing_that_happens_breaks_the_run(events, kind, method, delay):
    changes = [f"dp.sensors.{name}.delay_samples={delay}" for name in SENSORS]
    changes += [f"dp.observer.kind={kind}", f"dp.allocation.method={method}", "dp.observer.lost_after_s=0.5"]
    scenario = dp_scenario(5.0, SEA, *changes, "dp.enabled_at_s=1.0", "dp.weathervane.enabled=true", events=events)
    run = DpRun(scenario)  # which asserts that every number published is finite
    assert run.excursion(0.0, 5.0) < 5.0
