"""The chain of dynamic positioning in the whole twin: switch-on, set-points, observers, operator's orders."""

import functools

import numpy as np
import pytest
from dp_runs import SEA, STEP_S, DpRun, dp_scenario, event, poses

from shipcrane_twin.config.dp import SetpointConfig
from shipcrane_twin.config.scenario import EventConfig
from shipcrane_twin.physics.frames import wrap_angle, yaw_from_heading

LOAD_MAX = np.array([1.0e5, 8.0e4, 1.2e6])
THRUST_MAX = np.array([54e3, 54e3, 28e3])
NORTH = yaw_from_heading(0.0)


@functools.cache
def switched():
    """On at 20 s, off at 60, on again at 62 while the load still fades, off for good at 70."""
    switches = [event(60.0, "dp_off"), event(62.0, "dp_on"), event(70.0, "dp_off")]
    return DpRun(dp_scenario(110.0, "dp.enabled_at_s=20.0", "dp.sensors.perfect=true", events=switches))


def demand(run):
    times, values = run.series("/dp/wrench")
    return times, values[:, [0, 1, 5]]


def test_it_is_on_when_it_should_be():
    on = [k * STEP_S for k, is_on in switched().on.items() if is_on]
    expected = [t for t in np.arange(0.0, 110.05, 0.1) if 20.0 < t - 1e-6 <= 60.0 or 62.0 < t - 1e-6 <= 70.0]
    np.testing.assert_allclose(on, expected)


def test_the_demand_is_continuous_at_every_switch():
    times, asked = demand(switched())
    np.testing.assert_array_equal(asked[times <= 20.05], 0.0)
    # the first demand is the load in force: none
    np.testing.assert_allclose(asked[np.isclose(times, 20.1)], 0.0, atol=1e-6)
    steps = np.abs(np.diff(asked, axis=0)) / LOAD_MAX
    assert steps.max() < 0.03
    assert np.abs(asked[times > 60.0] / LOAD_MAX).max() > 0.1  # there is a load that could jump


def test_thrusters_idle_while_it_is_off_and_never_jump():
    times, values = switched().series("/thrusters/joint_states")
    speed, thrust = values[:, 3:6], values[:, 6:9]
    np.testing.assert_array_equal(thrust[times <= 20.05], 0.0)
    np.testing.assert_array_equal(speed[times <= 20.05], 0.0)
    assert np.abs(thrust[times > 105.0]).max() < 0.005 * THRUST_MAX.max()
    # 20 % of the greatest thrust per second, and what the shaft's lag adds to it
    assert (np.abs(np.diff(thrust, axis=0)).max(0) < 0.06 * THRUST_MAX).all()
    assert np.abs(thrust[(times > 40.0) & (times < 60.0)]).max() > 1e3


def test_azimuths_turn_no_faster_than_they_can():
    _, values = switched().series("/thrusters/joint_states")
    assert np.abs(wrap_angle_all(np.diff(values[:, :2], axis=0))).max() <= np.deg2rad(12.0) * 0.1 * 1.001


def wrap_angle_all(angles):
    return np.vectorize(wrap_angle)(angles)


def test_set_points_count_from_their_time_in_any_order_of_the_list():
    points = [
        {"at_s": 50.0, "north_m": -1.0, "east_m": 4.0, "heading_deg": 350.0},
        {"at_s": 5.0, "north_m": 2.0, "east_m": 1.0, "heading_deg": 5.0},
    ]
    limits = {"speed_max_m_s": 1.0, "accel_max_m_s2": 0.1, "turn_max_deg_s": 2.0, "turn_accel_max_deg_s2": 0.2}
    changes = [f"dp.reference.{key}={value}" for key, value in limits.items()]
    run = DpRun(dp_scenario(100.0, "dp.sensors.perfect=true", *changes, setpoints=points))
    times, values = run.series("/dp/reference")
    reference = poses(values)

    def at(time_s):
        return reference[np.argmin(np.abs(times - time_s))]

    np.testing.assert_allclose(at(5.0), [0.0, 0.0, NORTH], atol=0.3)
    np.testing.assert_allclose(at(50.0), [1.0, 2.0, yaw_from_heading(5.0)], atol=0.02)
    np.testing.assert_allclose(at(100.0), [4.0, -1.0, yaw_from_heading(350.0)], atol=0.02)
    _, pose = run.cog()
    np.testing.assert_allclose(pose[-1, :2], at(100.0)[:2], atol=2.0)  # on its way to be settled


def test_perfect_sensors_without_an_observer_tell_the_truth():
    run = DpRun(dp_scenario(15.0, SEA, "dp.sensors.perfect=true", "dp.observer.kind=none"))
    _, pose = run.cog()
    _, values = run.series("/dp/estimate")
    # at a telemetry step the chain last ran on what was five steps before
    np.testing.assert_allclose(poses(values)[1:], pose[:-1], atol=1e-9)
    assert np.ptp(pose[:, 0]) > 0.1
    east, north = np.gradient(pose[:, 0], 0.1), np.gradient(pose[:, 1], 0.1)
    cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    expected = np.column_stack((cos * east + sin * north, -sin * east + cos * north))[1:-1]
    # body axes lean with the ship: their surge and sway hold a little of heave
    np.testing.assert_allclose(values[2:, 7:9], expected, atol=0.02)


HOLDS = {
    "passive": ["dp.observer.kind=passive"],
    "ekf": ["dp.observer.kind=ekf"],
    "none": ["dp.observer.kind=none", "dp.sensors.perfect=true"],
    "pseudo_inverse": ["dp.allocation.method=pseudo_inverse"],
    "position first": ["dp.allocation.priority=position"],
    "slow fix, late": [
        "dp.sensors.position.period_ms=1000.0",
        "dp.sensors.position.delay_samples=1",
        "dp.sensors.gyro.period_ms=500.0",
        "dp.sensors.mru.delay_samples=3",
    ],
    "nominal waves": ["dp.observer.adaptive=false"],
    "crane known": ["dp.controller.crane_share=1.0"],
}


@functools.cache
def excursion_without_dp():
    return DpRun(dp_scenario(60.0, "dp.enabled_at_s=60.0")).excursion(0.0, 60.0)


@pytest.mark.parametrize("changes", HOLDS.values(), ids=HOLDS.keys())
def test_every_kind_of_chain_holds_the_ship_in_wind(changes):
    run = DpRun(dp_scenario(60.0, *changes))
    assert run.excursion(0.0, 60.0) < min(3.0, 0.5 * excursion_without_dp())
    _, pose = run.cog()
    assert np.abs(wrap_angle_all(pose[:, 2] - NORTH)).max() < np.deg2rad(8.0)
    assert not any(word in told for told in run.told(0.0, 60.0) for word in ("thruster ", "sensor", "reckoning"))


def test_weather_optimal_heading_turns_the_bow_to_the_wind():
    turning = ["dp.weathervane={enabled: true, rate_max_deg_s: 0.5, full_load_n: 1.0e+3, cutoff_period_s: 20.0}"]
    run = DpRun(dp_scenario(100.0, "dp.sensors.perfect=true", *turning, "dp.reference.turn_accel_max_deg_s2=0.2"))
    _, pose = run.cog()
    turned = np.rad2deg(wrap_angle_all(pose[:, 2] - NORTH))
    assert turned[-1] > 15.0  # the wind comes from the west, to port
    assert run.excursion(0.0, 100.0) < 4.0


OFF_GRID_S = 3.06
"""Start of a macro step at which the chain does not run: it runs every fifth step."""

ORDERS = {
    "off": {"event": "dp_off"},
    "thruster": {"event": "thruster_fault", "which": "bow_tunnel", "fault": "runaway"},
    "sensor": {"event": "sensor_fault", "which": "position", "fault": "frozen"},
    "power": {"event": "power_limit", "share": 0.001},
}


@functools.cache
def undisturbed_digest():
    return DpRun(dp_scenario(5.0)).digest


@pytest.mark.parametrize("keys", ORDERS.values(), ids=ORDERS.keys())
def test_an_order_is_an_event_of_the_scenario_at_that_time(keys):
    told = EventConfig(label="operator", at_s=OFF_GRID_S, **keys)
    planned = DpRun(dp_scenario(5.0, events=[{"label": "planned", "at_s": OFF_GRID_S, **keys}]))
    ordered = DpRun(dp_scenario(5.0), {OFF_GRID_S: lambda dp: dp.happen(told)})
    assert ordered.digest == planned.digest != undisturbed_digest()


def test_an_ordered_set_point_is_one_of_the_scenario_at_that_time():
    keys = {"north_m": 3.0, "east_m": -2.0, "heading_deg": 12.3}
    planned = DpRun(dp_scenario(5.0, setpoints=[{"at_s": OFF_GRID_S, **keys}]))
    ordered = DpRun(dp_scenario(5.0), {OFF_GRID_S: lambda dp: dp.move_to(SetpointConfig(**keys))})
    assert ordered.digest == planned.digest != undisturbed_digest()


def test_an_ordered_set_point_replaces_those_of_the_scenario_that_are_to_come():
    keys = {"north_m": 3.0, "east_m": -2.0, "heading_deg": 12.3}
    later = [{"at_s": 4.0, "north_m": 50.0, "east_m": 0.0, "heading_deg": 90.0}]
    ordered = {OFF_GRID_S: lambda dp: dp.move_to(SetpointConfig(**keys))}
    assert DpRun(dp_scenario(5.0, setpoints=later), ordered).digest == DpRun(dp_scenario(5.0), ordered).digest


def test_only_a_release_takes_the_load_off_the_hook():
    run = DpRun(dp_scenario(4.0, events=[event(1.0, "dp_off"), event(3.0, "release_payload")]))
    times, values = run.series("/winch/joint_states")
    assert values[(times > 1.0) & (times < 3.0), 2].min() > 6000.0
    assert values[-1, 2] < 6000.0
