"""The ship with its thrusters and dynamic positioning."""

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.dp import dp_start, dp_update
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import NS_PER_S, seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import (
    cross,
    euler_from_matrix,
    matrix_from_quat,
    quat_from_euler,
    yaw_from_heading,
)
from shipcrane_twin.physics.thrusters import thruster_load, thruster_step
from shipcrane_twin.physics.vessel import carried_mean, point_motion, state_rate, vessel_step


class Vessel:
    """Hull, thrusters and DP.

    The crane's wrench of the last step stands for the whole crane. Under a scheme that carries
    inertia, the part that a rigid crane would have given in that step is taken out of it, because
    the ship's equations hold that part for the present step.
    """

    name = "vessel"

    def __init__(self, scenario: Scenario) -> None:
        self._params = build.vessel_params(scenario)
        self._thrusters = build.thruster_params(scenario)
        self._dp_params = build.dp_params(scenario)
        self._carries = SCHEMES[scenario.coupling].carries_inertia
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self._dp_every = round(scenario.dp.period_ms * 1_000_000) // scenario.step_ns
        self._dp_from_ns = round(scenario.dp.enabled_at_s * NS_PER_S)
        point = scenario.dp.setpoint
        self._setpoint = np.array([point.east_m, point.north_m, yaw_from_heading(point.heading_deg)])

        rest = at_rest(scenario)
        self._state = rest.vessel
        self._nu_dot = np.zeros(6)
        self._carried = carried_mean(
            self._params, rest.inertia * self._carries, rest.vessel, self._nu_dot, rest.vessel, self._nu_dot
        )
        count = len(scenario.vessel.thrusters)
        self._thrust = np.zeros((count, 2))
        self._command = np.zeros((count, 2))
        self._dp: Array | None = None
        self._dp_load = np.zeros(3)

    def start(self) -> Signals:
        """Return the ship at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move the ship over step k."""
        self._control((k - 1) * self._step_ns, k)
        self._thrust, thrust_mean = thruster_step(self._thrusters, self._thrust, self._command, self._step_s)

        attached = inputs["/crane/base_inertia"] * self._carries
        crane = inputs["/crane/base_wrench"] - self._carried
        load_b = thruster_load(self._thrusters, thrust_mean) + inputs["/environment/wind_wrench"] + crane
        load_b[3:] += cross(self._params.crane_base - self._params.cog, crane[:3])

        water_w = inputs["/environment/current"][:3]
        new = vessel_step(self._params, self._state, load_b, water_w, attached, self._step_s)
        nu_dot = state_rate(self._params, new, load_b, water_w, attached)[7:]
        self._carried = carried_mean(self._params, attached, self._state, self._nu_dot, new, nu_dot)
        self._state, self._nu_dot = new, nu_dot
        return self._outputs(k)

    def _control(self, time_ns: int, k: int) -> None:
        if time_ns < self._dp_from_ns or (k - 1) % self._dp_every:
            return
        yaw = euler_from_matrix(matrix_from_quat(self._state[3:7]))[2]
        pose = np.array([self._state[0], self._state[1], yaw])
        if self._dp is None:
            self._dp = dp_start(pose)
        velocity = self._state[np.array([7, 8, 12])]
        self._dp, self._dp_load, self._command = dp_update(
            self._dp_params, self._dp, pose, velocity, self._setpoint
        )

    def _outputs(self, k: int) -> Signals:
        pos_w, vel_b, acc_b = point_motion(self._state, self._nu_dot, -self._params.cog)
        pose = np.concatenate((pos_w, self._state[3:7]))
        out = {
            "/vessel/odom": np.concatenate((pose, vel_b, self._state[10:])),
            "/vessel/accel": np.concatenate((acc_b, self._nu_dot[3:])),
        }
        if k % self._telemetry_every == 0:
            east, north, yaw = self._setpoint
            surge, sway, turn = self._dp_load
            angle = np.arctan2(self._thrust[:, 1], self._thrust[:, 0])
            size = np.hypot(self._thrust[:, 0], self._thrust[:, 1])
            out["/vessel/pose"] = pose
            out["/dp/setpoint"] = np.concatenate(([east, north, 0.0], quat_from_euler(0.0, 0.0, yaw)))
            out["/dp/wrench"] = np.array([surge, sway, 0.0, 0.0, 0.0, turn])
            out["/thrusters/joint_states"] = np.concatenate((angle, size))
        return out
