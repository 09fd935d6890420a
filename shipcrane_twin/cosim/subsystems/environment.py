"""Sea, wind and current, and the loads of sea and wind on the ship."""

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import build, weather
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import (
    euler_from_matrix,
    matrix_from_quat,
    rotate_to_body,
    rotate_to_world,
    towards_w,
)
from shipcrane_twin.physics.sea.current import current_at
from shipcrane_twin.physics.sea.gusts import gust
from shipcrane_twin.physics.sea.loads import wave_load
from shipcrane_twin.physics.wind import wind_load


class Environment:
    """The weather; its loads follow the ship's true position, heading and speed.

    The ship's motion comes from the start of a step, so that it is moved on by its velocity to the end,
    where the loads hold.
    """

    name = "environment"

    def __init__(self, scenario: Scenario) -> None:
        env = scenario.environment
        self._wind_params = build.wind_params(scenario)
        self._wave_params, self._sea = build.wave_params(scenario)
        self._gusts = weather.gusts(scenario)
        self._current = weather.current(scenario)
        self._telemetry_every = scenario.telemetry_every
        self._step_ns, self._step_s = scenario.step_ns, seconds(scenario.step_ns)
        self._towards = towards_w(env.wind_direction_to_deg)
        self._mean_wind = env.wind_speed_m_s
        rest = at_rest(scenario)
        self._cog = rest.params.cog
        self._rest = rest.vessel

    def start(self) -> Signals:
        """Return the weather at t = 0."""
        sea = self._sea
        rows = np.column_stack((sea.amplitude, sea.omega, sea.number_x, sea.number_y, sea.phase))
        now = self._outputs(0, self._rest[:3], matrix_from_quat(self._rest[3:7]), np.zeros(3))
        return {"/environment/sea_state": rows.ravel(), **now}

    def step(self, k: int, inputs: Signals) -> Signals:
        """Return the weather at the end of step k."""
        odom = inputs["/vessel/odom"]
        rot = matrix_from_quat(odom[3:7])
        velocity_w = rotate_to_world(rot, odom[7:10])
        place_w = odom[:3] + rotate_to_world(rot, self._cog) + self._step_s * velocity_w
        return self._outputs(k, place_w, rot, odom[7:10])

    def _outputs(self, k: int, place_w: Array, rot: Array, velocity_b: Array) -> Signals:
        time_s = seconds(k * self._step_ns)
        current = np.zeros(6)
        current[:2] = current_at(self._current, time_s)
        wind = np.zeros(6)
        wind[:3] = (self._mean_wind + gust(self._gusts, time_s)) * self._towards
        air_b = rotate_to_body(rot, wind[:3]) - velocity_b
        yaw = euler_from_matrix(rot)[2]
        waves = np.zeros(6)
        if len(self._sea.amplitude):
            first_order, drift = wave_load(self._wave_params, self._sea, time_s, place_w[0], place_w[1], yaw)
            waves = first_order
            waves[:2] += drift[:2]
            waves[5] += drift[2]
        out = {
            "/environment/current": current,
            "/environment/wave_wrench": waves,
            "/environment/wind_wrench": wind_load(self._wind_params, air_b[0], air_b[1]),
        }
        if k % self._telemetry_every == 0:
            out["/environment/wind"] = wind
        return out
