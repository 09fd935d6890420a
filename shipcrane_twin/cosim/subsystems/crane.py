"""The crane on the moving ship."""

import math

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands
from shipcrane_twin.cosim.controllers import ControllerCommands
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_base import base_motion, crane_macro_step, tip_odometry
from shipcrane_twin.physics.crane_chain import tip_state
from shipcrane_twin.physics.crane_cylinders import TRIANGLE, joint_rates_per_length, lengths_from_joints
from shipcrane_twin.physics.crane_dynamics import base_wrench
from shipcrane_twin.physics.crane_motion import ServoParams, servo_gains, static_reference
from shipcrane_twin.physics.crane_reference import make_limits
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body


class Crane:
    """Joints with their servos on a base that moves with the ship; the load pulls at the tip."""

    name = "crane"

    def __init__(self, scenario: Scenario) -> None:
        crane = scenario.crane
        self._chain = build.crane_chain(crane)
        self._drives = build.crane_drives(crane)
        self._base = np.array(crane.base_m)
        self._gravity = scenario.constants.gravity_m_s2
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._micro = math.ceil(scenario.macro_step_ms / crane.servo.micro_step_max_ms)
        self._telemetry_every = scenario.telemetry_every
        self._carries = SCHEMES[scenario.coupling].carries_inertia
        self.commands = JointCommands(scenario.joint_names, scenario.operations)
        self._controllers = ControllerCommands(scenario, scenario.joint_names)
        self._command = np.zeros(len(crane.links))

        rest = at_rest(scenario)
        rot = matrix_from_quat(rest.vessel[3:7])
        still = np.zeros(3)
        force_b = rotate_to_body(rot, rest.wire_force_w)
        proper_b = self._gravity * rot[2]
        q = rest.joints
        frequencies = [link.drive.servo_frequency_hz for link in crane.links]
        kp, kd = servo_gains(self._chain, q, frequencies, crane.servo.damping_ratio)
        self._servo = ServoParams(kp, kd, np.array([link.drive.effort_max for link in crane.links]))
        held = static_reference(self._chain, q, kp, proper_b, force_b)
        self._limits = make_limits(
            self._drives,
            length_rate_max=[link.drive.speed_max for link in crane.links],
            accel_max=[link.drive.accel_max for link in crane.links],
            end_margin=[link.drive.end_margin_m or 0.0 for link in crane.links],
            sag=held - q,
        )
        zeros = np.zeros_like(q)
        self._state = np.concatenate((q, zeros, held, zeros))
        self._effort = kp * (held - q)
        odom = np.zeros(13)
        odom[:3] = rest.tip_w - rot @ (self._base + rest.tip_b)
        odom[3:7] = rest.vessel[3:7]
        motion = base_motion(odom, np.zeros(6), self._base, self._gravity)
        self._before = np.concatenate((odom[3:7], motion, [0.0, 0.0, self._gravity]))
        tip_b = np.concatenate([part.ravel() for part in tip_state(self._chain, q, zeros)])
        self._tip = tip_odometry(tip_b, odom, self._base)
        self._wrench = base_wrench(self._chain, q, zeros, zeros, still, still, proper_b, force_b)
        self._inertia = rest.inertia

    def start(self) -> Signals:
        """Return the crane at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move the crane over step k: ship motion linear over the step, wire force held in the world."""
        self._command = self._controllers.over(self.commands.at((k - 1) * self._step_ns), inputs)
        self._state, self._effort, self._wrench, self._tip, self._inertia, self._before = crane_macro_step(
            self._chain,
            self._servo,
            self._limits,
            self._base,
            self._gravity,
            self._state,
            self._command,
            self._before,
            inputs["/vessel/odom"],
            inputs["/vessel/accel"],
            inputs["/payload/wire_wrench"][:3],
            inputs["/payload/felt_inertia"][0] * self._carries,
            self._micro,
            self._step_s,
        )
        return self._outputs(k)

    def _outputs(self, k: int) -> Signals:
        out = {
            "/crane/tip": self._tip,
            "/crane/base_wrench": self._wrench,
            "/crane/base_inertia": self._inertia,
        }
        if k % self._telemetry_every == 0:
            n = len(self._command)
            out["/crane/joint_states"] = self._joint_states(self._state[:n], self._state[n : 2 * n])
            out["/crane/joint_command_applied"] = self._command
        return out

    def _joint_states(self, q: Array, qd: Array) -> Array:
        booms = self._drives.kind == TRIANGLE
        lengths = lengths_from_joints(self._drives, q)[booms]
        slopes = joint_rates_per_length(self._drives, q)[booms]  # the cylinder's effective lever arm, inverted
        rates, forces = qd[booms] / slopes, self._effort[booms] * slopes
        return np.concatenate((q, lengths, qd, rates, self._effort, forces))
