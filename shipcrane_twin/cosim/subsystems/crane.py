"""The crane on the moving ship."""

import math
from collections.abc import Sequence

import numpy as np

from shipcrane_twin.config.controllers import steered_joints
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.load_limiter import (
    CUT_OUT,
    limit_load,
    load_state,
    radius_and_slopes,
    utilisation,
    warned,
)
from shipcrane_twin.control.tip_velocity import tip_joint_rates, tip_joint_rates_level
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands, applied
from shipcrane_twin.cosim.controllers import ControllerCommands, tip_holders
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.crane_report import SeenFlags, condition_of, limiter_warnings
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import NS_PER_S, seconds
from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_actuators import POWER_BRAKE, POWER_COAST, POWER_LEAK, POWER_ON, standing_state
from shipcrane_twin.physics.crane_base import base_motion, crane_macro_step, tip_odometry
from shipcrane_twin.physics.crane_chain import tip_state
from shipcrane_twin.physics.crane_cylinders import TRIANGLE, joint_rates_per_length, lengths_from_joints
from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces
from shipcrane_twin.physics.crane_reference import VELOCITY
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body

FAILURES = {
    "power_failure": POWER_BRAKE,
    "crane_coasts": POWER_COAST,
    "crane_brakes": POWER_BRAKE,
    "crane_leaks": POWER_LEAK,
}
"""Events that take the drives' power, and what is left."""


WITHOUT_POWER = {
    POWER_COAST: "the joints coast",
    POWER_BRAKE: "the brakes hold",
    POWER_LEAK: "the load-holding valves leak",
}


class Crane:
    """Joints with their drives on a base that moves with the ship; the load pulls at the tip."""

    name = "crane"

    def __init__(self, scenario: Scenario) -> None:
        crane = scenario.crane
        self._chain = build.crane_chain(crane)
        self._drives = build.crane_drives(crane)
        self._actuators = build.crane_actuators(crane)
        self._limits = build.crane_limits(crane, self._drives)
        self._limiter = build.load_limiter(scenario)
        self._limited = crane.load_limiter.enabled
        self._base = np.array(crane.base_m)
        self._gravity = scenario.constants.gravity_m_s2
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._micro = math.ceil(scenario.macro_step_ms / crane.servo.micro_step_max_ms)
        self._telemetry_every = scenario.telemetry_every
        self._carries = SCHEMES[scenario.coupling].carries_inertia
        self.commands = JointCommands(
            scenario.joint_names,
            scenario.operations,
            steered_joints(scenario.controllers),
            crane.servo.tip_command_timeout_s,
        )
        self._tip_holders = tip_holders(scenario)
        self._controllers = ControllerCommands(scenario, scenario.joint_names)
        self._command = np.zeros(len(crane.links))
        self._mode = np.full(len(crane.links), VELOCITY, dtype=np.int64)
        self._power = POWER_ON
        self._failures = sorted(
            (round(event.at_s * NS_PER_S), FAILURES[event.event])
            for event in scenario.events
            if event.event in FAILURES
        )
        self._seen = SeenFlags(scenario.joint_names, scenario.step_ns)

        rest = at_rest(scenario)
        rot = matrix_from_quat(rest.vessel[3:7])
        still = np.zeros(3)
        force_b = rotate_to_body(rot, rest.wire_force_w)
        proper_b = self._gravity * rot[2]
        q = rest.joints
        zeros = np.zeros_like(q)
        self._effort = bias_forces(self._chain, q, zeros, still, still, proper_b, force_b)
        self._state = standing_state(self._actuators, self._drives, q, self._effort)
        load = math.hypot(*rest.wire_force_w) / self._gravity
        radius = radius_and_slopes(self._chain, q)[0]
        self._load = np.array([load, utilisation(self._limiter, load, radius), 0.0])
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
        time_ns = (k - 1) * self._step_ns
        mode, command = self.commands.at(time_ns)
        tip = self.commands.tip_at(time_ns)
        if tip is not None:
            command = self._tip_rates(*tip)
        command = self._controllers.over(command, inputs)
        while self._failures and time_ns >= self._failures[0][0]:
            self._power = self._failures.pop(0)[1]
        force_w = inputs["/payload/wire_wrench"][:3]
        self._mode, self._command = self._limit_load(force_w, mode, command)
        self._state, self._effort, self._wrench, self._tip, self._inertia, self._before, flags = crane_macro_step(
            self._chain,
            self._actuators,
            self._limits,
            self._base,
            self._gravity,
            self._state,
            self._mode,
            self._command,
            self._power,
            self._before,
            inputs["/vessel/odom"],
            inputs["/vessel/accel"],
            force_w,
            inputs["/payload/felt_inertia"][0] * self._carries,
            self._micro,
            self._step_s,
        )
        self._seen.note(k, flags)
        return self._outputs(k)

    def say_tip(self, frame: str, velocity: Sequence[float]) -> str | None:
        """Take an operator's velocity for the tip (3,) [m/s]; return why it was refused, or None."""
        if self._tip_holders:
            return f"{self._tip_holders[0]} steers joints of the crane; expected commands of joints"
        return self.commands.say_tip(frame, velocity)

    def _tip_rates(self, frame: str, velocity: Array) -> Array:
        q = self._joints
        if frame == "map":
            rot = matrix_from_quat(self._before[:4])
            return tip_joint_rates_level(self._chain, self._limits, q, velocity, rot)
        return tip_joint_rates(self._chain, self._limits, q, velocity)

    def _limit_load(self, force_w: Array, mode: Ints, command: Array) -> tuple[Ints, Array]:
        load = math.hypot(*force_w) / self._gravity
        self._load, modes, allowed = limit_load(
            self._limiter, self._chain, self._load, load, self._joints, mode, command
        )
        if self._limited:
            return modes, allowed
        self._load[CUT_OUT] = 0.0
        return mode, command

    @property
    def _joints(self) -> Array:
        return self._state[: len(self._command)]

    @property
    def load_state(self) -> Array:
        """What is told of the load (5,), see `control.load_limiter.load_state`."""
        return load_state(self._limiter, self._load, radius_and_slopes(self._chain, self._joints)[0])

    def warnings(self) -> list[str]:
        """Return what an operator should know now."""
        told = limiter_warnings(self.load_state, self._limited and warned(self._limiter, self._load))
        if self._power != POWER_ON:
            told.append(f"the drives have no power: {WITHOUT_POWER[self._power]}")
        return told + self._seen.told()

    def condition(self) -> dict[str, str]:
        """Return how crane and load do, for diagnostics."""
        brakes = self._state[6 * len(self._command) :]
        return condition_of(self.load_state, self.commands.joints, brakes, self._power == POWER_ON)

    def _outputs(self, k: int) -> Signals:
        out = {
            "/crane/tip": self._tip,
            "/crane/base_wrench": self._wrench,
            "/crane/load_state": self.load_state,
            "/crane/base_inertia": self._inertia,
        }
        if k % self._telemetry_every == 0:
            n = len(self._command)
            out["/crane/joint_states"] = self._joint_states(self._state[:n], self._state[n : 2 * n])
            out["/crane/joint_command_applied"] = applied(self._mode, self._command, self._joints)
        return out

    def _joint_states(self, q: Array, qd: Array) -> Array:
        booms = self._drives.kind == TRIANGLE
        lengths = lengths_from_joints(self._drives, q)[booms]
        slopes = joint_rates_per_length(self._drives, q)[booms]  # the cylinder's effective lever arm, inverted
        rates, forces = qd[booms] / slopes, self._effort[booms] * slopes
        return np.concatenate((q, lengths, qd, rates, self._effort, forces))
