"""Sea, wind and current, and the loads of sea and wind on the ship."""

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import weather
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.vessel_step import vessel_at_rest, vessel_outputs
from shipcrane_twin.physics.weather import ship_pose, weather_step


class Environment:
    """The weather; its loads follow the ship's position, heading and speed.

    The ship's motion comes from the start of a step, so that it is moved on by its velocity to the end,
    where the loads hold.
    """

    name = "environment"

    def __init__(self, scenario: Scenario) -> None:
        self._params = weather.weather_params(scenario)
        self._step_ns, self._step_s = scenario.step_ns, seconds(scenario.step_ns)
        rest = at_rest(scenario)
        self._odom = vessel_outputs(vessel_at_rest(rest.params, rest.vessel, rest.inertia, 0), rest.params.cog)[0]
        self._slow = np.zeros((3, 2))
        self._slow[:, 0] = ship_pose(self._params, self._odom, 0.0)[0]

    def start(self) -> Signals:
        """Return the weather at t = 0."""
        sea = self._params.waves
        rows = np.column_stack((sea.amplitude, sea.omega, sea.number_x, sea.number_y, sea.phase))
        return {"/environment/sea_state": rows.ravel(), **self._outputs(0, self._odom)}

    def step(self, k: int, inputs: Signals) -> Signals:
        """Return the weather at the end of step k."""
        return self._outputs(k, inputs["/vessel/odom"])

    def _outputs(self, k: int, odom: Array) -> Signals:
        time_s = seconds(k * self._step_ns)
        self._slow, current, wind, waves, blown = weather_step(self._params, self._slow, odom, time_s, self._step_s)
        return {
            "/environment/current": np.concatenate((current, np.zeros(3))),
            "/environment/wind": np.concatenate((wind, np.zeros(3))),
            "/environment/wave_wrench": waves,
            "/environment/wind_wrench": blown,
        }
