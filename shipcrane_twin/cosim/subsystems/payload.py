"""The load on the wire, and the winch."""

import numpy as np

from shipcrane_twin.config.scenario import WINCH, Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import NS_PER_S, seconds
from shipcrane_twin.physics.payload import LENGTH, MASS, RECORD, SPEED, hanging_state, payload_step, tip_motion
from shipcrane_twin.physics.winch import (
    BRAKED,
    COASTING,
    LEAKING,
    POWERED,
    TOLD,
    drum_layer,
    line_pull,
    winch_at_rest,
    winch_step,
)
from shipcrane_twin.physics.wire import SNAP_LAST, SNAP_MAX, SNAPS

DRIVES = {"winch_coasts": COASTING, "winch_brakes": BRAKED, "winch_leaks": LEAKING}
"""What turns the drum after an event of the scenario."""


class Payload:
    """A point mass on a tension-only elastic wire under the true motion of the tip."""

    name = "payload"

    def __init__(self, scenario: Scenario) -> None:
        self._params = build.wire_params(scenario)
        self._winch = build.winch_params(scenario)
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self.commands = JointCommands((WINCH,), scenario.operations)
        self._command = np.zeros(1)
        self._events = sorted((round(event.at_s * NS_PER_S), event.event) for event in scenario.events)
        self._hook_mass = scenario.payload.hook_mass_kg

        rest = at_rest(scenario)
        mass = scenario.payload.mass_kg
        self._state = hanging_state(self._params, rest.tip_w, np.zeros(3), scenario.winch.initial_length_m, mass)
        self._memory = winch_at_rest(self._winch, self._step_s)
        self._drive = POWERED
        self._tip = np.concatenate((rest.tip_w, np.zeros(3)))
        self._force_w = rest.wire_force_w
        self._tension = self._tension_most = float(mass * self._params.gravity)

    def start(self) -> Signals:
        """Return the load at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move load and winch over step k; the tip's motion is a cubic over the step."""
        time_ns = (k - 1) * self._step_ns
        while self._events and time_ns >= self._events[0][0]:
            self._happen(self._events.pop(0)[1])
        tip_next = tip_motion(inputs["/crane/tip"])
        self._command = self.commands.at(time_ns)
        told = self._memory[TOLD] if self._drive == POWERED else 0.0
        self._memory, hold = winch_step(
            self._winch, self._memory, self._state[LENGTH], self._command[0], False, self._drive, self._step_s
        )
        self._state, self._force_w, self._tension = payload_step(
            self._params, hold, self._state, told, self._memory[TOLD], self._tip, tip_next, self._step_s
        )
        self._tension_most = max(self._tension_most, self._tension)
        self._tip = tip_next
        return self._outputs(k)

    def events(self) -> dict[str, float]:
        """Return what has happened to wire and winch so far.

        ``snaps``, ``snap_tension_max_n`` and ``snap_tension_last_n`` (first peaks of tension after slack spells),
        ``tension_max_n``, ``drum_layer`` (0 the innermost) and ``drum_slips`` (1 while motor, brake or leak give way).
        """
        record = self._state[RECORD:]
        return {
            "snaps": float(record[SNAPS]),
            "snap_tension_max_n": float(record[SNAP_MAX]),
            "snap_tension_last_n": float(record[SNAP_LAST]),
            "tension_max_n": self._tension_most,
            "drum_layer": float(drum_layer(self._winch, float(self._state[LENGTH]))[0]),
            "drum_slips": float(self._state[SPEED] != self._memory[TOLD]),
        }

    def _happen(self, event: str) -> None:
        if event == "release_payload":
            self._state = self._state.copy()
            self._state[MASS] = self._hook_mass
        elif event in DRIVES:
            self._drive = DRIVES[event]

    def _outputs(self, k: int) -> Signals:
        wrench = np.zeros(6)
        wrench[:3] = self._force_w
        odom = np.zeros(13)
        odom[:3], odom[6], odom[7:10] = self._state[:3], 1.0, self._state[3:6]
        felt = np.zeros(10)
        felt[0] = self._state[MASS] if self._tension > 0.0 else 0.0
        out = {"/payload/wire_wrench": wrench, "/payload/felt_inertia": felt, "/payload/odom": odom}
        if k % self._telemetry_every == 0:
            length, rate = self._state[LENGTH], self._state[SPEED]
            drawn = line_pull(self._tension, rate, self._winch.sheave_friction)
            out["/winch/joint_states"] = np.array([length, rate, drawn])
            out["/winch/joint_command_applied"] = self._command
        return out
