"""Current, wind, and the wind's load on the ship."""

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body, towards_w
from shipcrane_twin.physics.wind import wind_load


class Environment:
    """The weather: steady current and wind; the wind load follows the ship's heading and speed."""

    name = "environment"

    def __init__(self, scenario: Scenario) -> None:
        env = scenario.environment
        self._params = build.wind_params(scenario)
        self._telemetry_every = scenario.telemetry_every
        self._current = np.zeros(6)
        self._current[:3] = env.current_speed_m_s * towards_w(env.current_direction_to_deg)
        self._wind = np.zeros(6)
        self._wind[:3] = env.wind_speed_m_s * towards_w(env.wind_direction_to_deg)
        self._quat = at_rest(scenario).vessel[3:7]

    def start(self) -> Signals:
        """Return the weather at t = 0."""
        return self._outputs(0, self._quat, np.zeros(3))

    def step(self, k: int, inputs: Signals) -> Signals:
        """Return the weather over step k; the ship's motion is that at the step's start."""
        odom = inputs["/vessel/odom"]
        return self._outputs(k, odom[3:7], odom[7:10])

    def _outputs(self, k: int, quat: Array, velocity_b: Array) -> Signals:
        air_b = rotate_to_body(matrix_from_quat(quat), self._wind[:3]) - velocity_b
        out = {
            "/environment/current": self._current,
            "/environment/wind_wrench": wind_load(self._params, air_b[0], air_b[1]),
        }
        if k % self._telemetry_every == 0:
            out["/environment/wind"] = self._wind
        return out
