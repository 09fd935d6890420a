"""The weather's step: the pose at which waves act, and loads in axes that do not roll."""

import numpy as np
import pytest
from gunnerus_ship import SCENARIO
from scipy.spatial.transform import Rotation

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.weather import weather_params
from shipcrane_twin.physics.sea.loads import wave_load
from shipcrane_twin.physics.slow_pose import follower
from shipcrane_twin.physics.weather import ship_pose, weather_step
from shipcrane_twin.physics.wind import wind_load

REGULAR = "environment.waves.systems=[{spectrum: regular, direction_to_deg: 60.0, height_m: 0.4, period_s: 8.0}]"
BREEZE = ["environment.wind_speed_m_s=8.0", "environment.wind_direction_to_deg=30.0"]
PARAMS = weather_params(load_scenario("case2", [REGULAR, *BREEZE, "environment.waves.ramp_s=0.0"]))
MOMENTARY = PARAMS._replace(follow=follower(0.0, 0.02))
COG = np.array(SCENARIO.vessel.cog_m)


def odom_at(cog_w=(0.0, 0.0, 1.0), euler=(0.0, 0.0, 1.0), velocity_w=(0.0, 0.0, 0.0), omega_b=(0.0, 0.0, 0.0)):
    """Odometry of base_link for a CoG at a place; euler is roll, pitch, yaw."""
    turn = Rotation.from_euler("ZYX", euler[::-1])
    return np.concatenate((cog_w - turn.apply(COG), turn.as_quat(), turn.inv().apply(velocity_w), omega_b))


def settled(pose):
    return np.column_stack((pose, np.zeros(3)))


def loads(odom, time_s=100.0, params=MOMENTARY, step_s=0.0):
    return weather_step(params, settled(ship_pose(params, odom, 0.0)[0]), odom, time_s, step_s)[3:]


def test_the_pose_is_that_of_the_cog_one_step_on():
    odom = odom_at((3.0, -2.0, 1.0), (0.1, -0.05, 0.7), (0.5, 0.2, 0.0), (0.0, 0.0, 0.02))
    odom[7:10] -= np.cross((0.0, 0.0, 0.02), COG)  # of base_link's origin
    pose, *_ = ship_pose(PARAMS, odom, 0.0)
    np.testing.assert_allclose(pose, [3.0, -2.0, 0.7], atol=1e-12)
    ahead = ship_pose(PARAMS, odom_at((3.0, -2.0, 1.0), (0.0, 0.0, 0.7), (0.5, 0.2, 0.0)), 2.0)[0]
    np.testing.assert_allclose(ahead, [4.0, -1.6, 0.7], atol=1e-12)


@pytest.mark.parametrize("step_s", [0.02, 0.2])
def test_the_follower_is_a_critically_damped_filter(step_s):
    rate = 2.0 * np.pi / 40.0
    rows = follower(40.0, step_s)
    state, found = np.zeros(2), []
    count = round(80.0 / step_s)
    for _ in range(count):
        state = rows[:, :2] @ state + rows[:, 2]
        found.append(state[0])
    time = step_s * np.arange(1, count + 1)
    np.testing.assert_allclose(found, 1.0 - (1.0 + rate * time) * np.exp(-rate * time), atol=1e-12)


def test_drift_is_followed_and_motion_at_wave_frequency_is_not():
    rows, step_s = follower(40.0, 0.02), 0.02
    state, gone, swung = np.zeros((2, 2)), [], []
    for k in range(1, 30001):
        inputs = np.array([0.3 * k * step_s, np.sin(2.0 * np.pi / 8.0 * k * step_s)])
        state = state @ rows[:, :2].T + np.outer(inputs, rows[:, 2])
        gone.append(inputs[0] - state[0, 0])
        swung.append(state[1, 0])
    assert gone[-1] == pytest.approx(0.3 * 2.0 * 40.0 / (2.0 * np.pi), rel=1e-3)  # a constant distance behind
    assert max(swung[-400:]) == pytest.approx(1.0 / (1.0 + (40.0 / 8.0) ** 2), rel=1e-2)


def test_a_ship_that_turns_through_south_goes_the_short_way():
    slow = settled([0.0, 0.0, np.pi - 0.01])
    new = weather_step(MOMENTARY, slow, odom_at(euler=(0.0, 0.0, -np.pi + 0.01)), 0.0, 0.0)[0]
    assert new[2, 0] == pytest.approx(np.pi + 0.01)


def test_waves_repeat_after_a_wave_length_and_their_phase_follows_the_ship():
    number = PARAMS.waves.number[0]
    along = np.array([PARAMS.waves.number_x[0], PARAMS.waves.number_y[0], 0.0]) / number
    length = 2.0 * np.pi / number
    here, there, half = (loads(odom_at((0.0, 0.0, 1.0) + s * along))[0] for s in (0.0, length, 0.5 * length))
    np.testing.assert_allclose(there, here, atol=1e-6 * np.abs(here).max())
    np.testing.assert_allclose(half[2:5], -here[2:5], atol=2e-3 * np.abs(here).max())  # drift does not change sign
    later = loads(odom_at((0.0, 0.0, 1.0) + 5.0 * along), 100.0 + 5.0 * number / PARAMS.waves.omega[0])[0]
    np.testing.assert_allclose(later, here, atol=1e-6 * np.abs(here).max())


def test_loads_do_not_roll_with_the_ship():
    upright = loads(odom_at())
    heeled = loads(odom_at(euler=(0.2, -0.1, 1.0)))
    for load, other in zip(upright, heeled, strict=True):
        np.testing.assert_allclose(other, load, atol=1e-6 * np.abs(load).max())


def test_wind_counts_against_the_moving_ship():
    wind_w = 8.0 * np.array([np.sin(np.pi / 6), np.cos(np.pi / 6), 0.0])
    assert np.abs(loads(odom_at(velocity_w=wind_w))[1]).max() < 1e-9
    still, fleeing = loads(odom_at())[1], loads(odom_at(velocity_w=0.5 * wind_w))[1]
    np.testing.assert_allclose(fleeing, 0.25 * still, atol=1e-9)


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5])
def test_wind_pushes_the_ship_the_way_it_blows_relative_to_the_heading(yaw):
    ahead, port = 8.0 * np.cos(np.pi / 3 - yaw), 8.0 * np.sin(np.pi / 3 - yaw)  # wind towards 30 deg from north
    np.testing.assert_allclose(loads(odom_at(euler=(0.0, 0.0, yaw)))[1], wind_load(PARAMS.wind, ahead, port), atol=1e-6)


def test_first_order_and_drift_load_add_up_mode_by_mode():
    first_order, drift = wave_load(PARAMS.wave_loads, PARAMS.waves, 100.0, 4.0, -3.0, 1.0)
    assert np.abs(drift).min() > 0.0
    expected = first_order + [drift[0], drift[1], 0.0, 0.0, 0.0, drift[2]]
    np.testing.assert_allclose(loads(odom_at((4.0, -3.0, 1.0)))[0], expected, rtol=1e-9)


def test_the_weather_itself_is_told():
    _, current_w, wind_w, _, _ = weather_step(PARAMS, np.zeros((3, 2)), odom_at(), 5.0, 0.02)
    np.testing.assert_allclose(current_w, 0.0)
    np.testing.assert_allclose(wind_w, [4.0, 8.0 * np.cos(np.pi / 6), 0.0], atol=1e-12)
