"""One macro step of the weather: current and wind where the ship is, and the loads of waves and wind on it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat, rotate_to_world
from shipcrane_twin.physics.sea.components import Waves
from shipcrane_twin.physics.sea.current import Current, current_at
from shipcrane_twin.physics.sea.gusts import Gusts, gust
from shipcrane_twin.physics.sea.loads import WaveLoadParams, wave_load
from shipcrane_twin.physics.slow_pose import follow, follow_angle
from shipcrane_twin.physics.wind import WindParams, wind_load


class WeatherParams(NamedTuple):
    """The realised weather and what it does to the ship.

    Attributes
    ----------
    waves : Waves
    wave_loads : WaveLoadParams
    gusts : Gusts
    current : Current
    wind : WindParams
    mean_wind : float
        [m/s]
    wind_towards : float64, shape (2,)
        Unit vector, east and north.
    cog : float64, shape (3,)
        CoG in base_link [m].
    follow : float64, shape (2, 3)
        See `slow_pose.follower`.
    """

    waves: Waves
    wave_loads: WaveLoadParams
    gusts: Gusts
    current: Current
    wind: WindParams
    mean_wind: float
    wind_towards: Array
    cog: Array
    follow: Array


@njit(cache=True)
def ship_pose(params: WeatherParams, odom: Array, step_s: float) -> tuple[Array, float, float]:
    """Return east, north of the CoG and yaw (3,) one step on, and velocity of base_link's origin, east and north."""
    rot = matrix_from_quat(odom[3:7])
    place_w = odom[:3] + rotate_to_world(rot, params.cog)
    velocity_w = rotate_to_world(rot, odom[7:10])
    turning_w = rotate_to_world(rot, odom[10:13])
    yaw = euler_from_matrix(rot)[2]
    pose = np.array(
        [place_w[0] + step_s * velocity_w[0], place_w[1] + step_s * velocity_w[1], yaw + step_s * turning_w[2]]
    )
    return pose, velocity_w[0], velocity_w[1]


@njit(cache=True)
def weather_step(
    params: WeatherParams, slow: Array, odom: Array, time_s: float, step_s: float
) -> tuple[Array, Array, Array, Array, Array]:
    """Return the weather at a time, as it acts on a ship whose motion is known one step earlier.

    Parameters
    ----------
    params : WeatherParams
    slow : float64, shape (3, 2)
        East, north [m] and yaw [rad] of the ship without its motion at wave frequency, and their rates.
    odom : float64, shape (13,)
        ``/vessel/odom`` one step before.
    time_s, step_s : float
        [s].

    Returns
    -------
    slow : float64, shape (3, 2)
    current_w, wind_w : float64, shape (3,)
        [m/s]
    wave_load, wind_load : float64, shape (6,)
        About the CoG, level axes of the slow heading [N, N m].

    Notes
    -----
    Waves count at the slow pose: what first-order loads and motions at wave frequency make together on
    average is in the drift transfer function already.
    """
    pose, velocity_x, velocity_y = ship_pose(params, odom, step_s)
    new = np.empty((3, 2))
    for i in range(2):
        new[i, 0], new[i, 1] = follow(params.follow, slow[i, 0], slow[i, 1], pose[i])
    new[2, 0], new[2, 1] = follow_angle(params.follow, slow[2, 0], slow[2, 1], pose[2])

    current_w, wind_w = np.zeros(3), np.zeros(3)
    current_w[:2] = current_at(params.current, time_s)
    speed = params.mean_wind + gust(params.gusts, time_s)
    wind_w[0], wind_w[1] = speed * params.wind_towards[0], speed * params.wind_towards[1]
    air_x, air_y = wind_w[0] - velocity_x, wind_w[1] - velocity_y
    ahead_x, ahead_y = np.cos(new[2, 0]), np.sin(new[2, 0])
    blown = wind_load(params.wind, ahead_x * air_x + ahead_y * air_y, ahead_x * air_y - ahead_y * air_x)

    waved = np.zeros(6)
    if params.waves.amplitude.shape[0]:
        waved, drift = wave_load(params.wave_loads, params.waves, time_s, new[0, 0], new[1, 0], new[2, 0])
        waved[0] += drift[0]
        waved[1] += drift[1]
        waved[5] += drift[2]
    return new, current_w, wind_w, waved, blown
