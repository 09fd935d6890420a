"""The load on the wire, and the winch."""

import numpy as np

from shipcrane_twin.config.scenario import WINCH, Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import NS_PER_S, seconds
from shipcrane_twin.physics.payload import hanging_state, payload_step, tip_motion


class Payload:
    """A point mass on a tension-only elastic wire under the true motion of the tip."""

    name = "payload"

    def __init__(self, scenario: Scenario) -> None:
        self._params = build.wire_params(scenario)
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self.commands = JointCommands((WINCH,), scenario.operations)
        self._command = np.zeros(1)
        self._releases_ns = sorted(
            round(event.at_s * NS_PER_S) for event in scenario.events if event.event == "release_payload"
        )
        self._hook_mass = scenario.payload.hook_mass_kg

        rest = at_rest(scenario)
        mass = scenario.payload.mass_kg
        self._state = hanging_state(self._params, rest.tip_w, np.zeros(3), scenario.winch.initial_length_m, mass)
        self._tip = np.concatenate((rest.tip_w, np.zeros(3)))
        self._force_w = rest.wire_force_w
        self._tension_max = float(mass * self._params.gravity)

    def start(self) -> Signals:
        """Return the load at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move load and winch over step k; the tip's motion is a cubic over the step."""
        time_ns = (k - 1) * self._step_ns
        if self._releases_ns and time_ns >= self._releases_ns[0]:
            self._releases_ns.pop(0)
            self._state = self._state.copy()
            self._state[8] = self._hook_mass
        tip_next = tip_motion(inputs["/crane/tip"])
        self._command = self.commands.at(time_ns)
        self._state, self._force_w, self._tension_max = payload_step(
            self._params, self._state, self._command[0], self._tip, tip_next, self._step_s
        )
        self._tip = tip_next
        return self._outputs(k)

    def _outputs(self, k: int) -> Signals:
        wrench = np.zeros(6)
        wrench[:3] = self._force_w
        odom = np.zeros(13)
        odom[:3], odom[6], odom[7:10] = self._state[:3], 1.0, self._state[3:6]
        felt = np.zeros(10)
        felt[0] = self._state[8] if self._tension_max > 0.0 else 0.0
        out = {"/payload/wire_wrench": wrench, "/payload/felt_inertia": felt, "/payload/odom": odom}
        if k % self._telemetry_every == 0:
            out["/winch/joint_states"] = np.array([self._state[6], self._state[7], self._tension_max])
            out["/winch/joint_command_applied"] = self._command
        return out
