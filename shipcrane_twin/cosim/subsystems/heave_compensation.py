"""Active heave compensation as a participant: from the ship's motion at the crane's tip to pay-out speed."""

import numpy as np

from shipcrane_twin.config.controllers import HeaveCompensationConfig
from shipcrane_twin.config.scenario import NS_PER_S, Scenario
from shipcrane_twin.control.heave_compensation import (
    carried_heave,
    heave_compensation_step,
    make_heave_compensation,
)
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds


class HeaveCompensation:
    """Adds a pay-out speed to the operator's."""

    name = "heave_compensation"

    def __init__(self, scenario: Scenario) -> None:
        config = next(one for one in scenario.controllers if isinstance(one, HeaveCompensationConfig))
        self._params = make_heave_compensation(
            config.corner_period_s,
            config.winch_lag_s,
            config.speed_max_m_s,
            config.accel_max_m_s2,
            seconds(scenario.step_ns),
        )
        self._from_ns = round(config.enabled_at_s * NS_PER_S)
        self._step_ns = scenario.step_ns
        self._state = np.zeros(3)

    def start(self) -> Signals:
        """Return the word at t = 0: everything is at rest."""
        return {"/heave_compensation/joint_command": np.zeros(1)}

    def step(self, k: int, inputs: Signals) -> Signals:
        """Return at t_k the pay-out speed for the step that follows."""
        velocity, accel = carried_heave(inputs["/vessel/odom"], inputs["/vessel/accel"], inputs["/crane/tip"][:3])
        active = k * self._step_ns >= self._from_ns
        self._state, speed = heave_compensation_step(self._params, self._state, velocity, accel, active)
        return {"/heave_compensation/joint_command": np.array([speed])}
