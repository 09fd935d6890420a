"""The ship with its thrusters and dynamic positioning."""

import numpy as np

from shipcrane_twin.config.scenario import NS_PER_MS, NS_PER_S, Scenario
from shipcrane_twin.control.dp import dp_start, dp_update
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import (
    euler_from_matrix,
    matrix_from_quat,
    quat_from_euler,
    yaw_from_heading,
)
from shipcrane_twin.physics.vessel_step import (
    THRUST,
    vessel_at_rest,
    vessel_macro_step,
    vessel_outputs,
)


class Vessel:
    """Hull, thrusters and DP; the crane's wrench of the last step stands for crane and load."""

    name = "vessel"

    def __init__(self, scenario: Scenario) -> None:
        rest = at_rest(scenario)
        self._params = rest.params
        self._thrusters = build.thruster_params(scenario)
        self._dp_params = build.dp_params(scenario)
        self._carries = SCHEMES[scenario.coupling].carries_inertia
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self._dp_every = round(scenario.dp.period_ms * NS_PER_MS) // scenario.step_ns
        self._dp_from_ns = round(scenario.dp.enabled_at_s * NS_PER_S)
        point = scenario.dp.setpoint
        self._setpoint = np.array([point.east_m, point.north_m, yaw_from_heading(point.heading_deg)])

        count = len(scenario.vessel.thrusters)
        self._memory = vessel_at_rest(self._params, rest.vessel, rest.inertia * self._carries, count)
        self._command = np.zeros((count, 2))
        self._dp: Array | None = None
        self._dp_load = np.zeros(3)

    def start(self) -> Signals:
        """Return the ship at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move the ship over step k."""
        self._control((k - 1) * self._step_ns, k)
        self._memory = vessel_macro_step(
            self._params,
            self._thrusters,
            self._memory,
            self._command,
            inputs["/environment/wave_wrench"] + inputs["/environment/wind_wrench"],
            inputs["/crane/base_wrench"],
            inputs["/crane/base_inertia"] * self._carries,
            inputs["/environment/current"][:3],
            self._step_s,
        )
        return self._outputs(k)

    def _control(self, time_ns: int, k: int) -> None:
        if time_ns < self._dp_from_ns or (k - 1) % self._dp_every:
            return
        state = self._memory
        yaw = euler_from_matrix(matrix_from_quat(state[3:7]))[2]
        pose = np.array([state[0], state[1], yaw])
        if self._dp is None:
            self._dp = dp_start(pose)
        velocity = state[np.array([7, 8, 12])]
        self._dp, self._dp_load, self._command = dp_update(
            self._dp_params, self._dp, pose, velocity, self._setpoint
        )

    def _outputs(self, k: int) -> Signals:
        odom, accel = vessel_outputs(self._memory, self._params.cog)
        out = {"/vessel/odom": odom, "/vessel/accel": accel}
        if k % self._telemetry_every == 0:
            east, north, yaw = self._setpoint
            surge, sway, turn = self._dp_load
            thrust = self._memory[THRUST : THRUST + self._command.size].reshape(self._command.shape)
            forward, port = thrust.T
            out["/vessel/pose"] = odom[:7].copy()
            out["/dp/setpoint"] = np.concatenate(([east, north, 0.0], quat_from_euler(0.0, 0.0, yaw)))
            out["/dp/wrench"] = np.array([surge, sway, 0.0, 0.0, 0.0, turn])
            out["/thrusters/joint_states"] = np.concatenate((np.arctan2(port, forward), np.hypot(forward, port)))
        return out
