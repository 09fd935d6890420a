"""The load on the wire, and the winch."""

import math

import numpy as np

from shipcrane_twin.config.controllers import steered_joints
from shipcrane_twin.config.scenario import WINCH, Scenario
from shipcrane_twin.control.load_limiter import hoisting_allowed
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands, applied
from shipcrane_twin.cosim.controllers import ControllerCommands
from shipcrane_twin.cosim.hung_loads import hung_load
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import NS_PER_S, seconds
from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY
from shipcrane_twin.physics.payload import tip_motion
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

DRIVES = {"power_failure": BRAKED, "winch_coasts": COASTING, "winch_brakes": BRAKED, "winch_leaks": LEAKING}
"""What turns the drum after an event of the scenario."""

WITHOUT_POWER = {COASTING: "the drum coasts", BRAKED: "the brake holds", LEAKING: "the motor leaks"}


class Payload:
    """The load on a tension-only elastic wire under the true motion of the tip, and the winch that pays it out."""

    name = "payload"

    def __init__(self, scenario: Scenario) -> None:
        self._winch = build.winch_params(scenario)
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self.commands = JointCommands((WINCH,), scenario.operations, steered_joints(scenario.controllers))
        self._controllers = ControllerCommands(scenario, (WINCH,))
        self._mode, self._command = np.full(1, VELOCITY, dtype=np.int64), np.zeros(1)
        self._hoisting_refused = False
        self._pending = sorted(
            (round(event.at_s * NS_PER_S), event.event)
            for event in scenario.events
            if event.event == "release_payload" or event.event in DRIVES
        )

        rest = at_rest(scenario)
        self._load = hung_load(scenario, rest)
        self._memory = winch_at_rest(self._winch, self._step_s)
        self._drive = POWERED
        self._tip = np.concatenate((rest.tip_w, np.zeros(3)))
        # force on the tip and tension
        self._pulled = np.append(rest.wire_force_w, -rest.wire_force_w[2])
        self._tension_most = float(self._pulled[3])
        self._slipped_s = 0.0

    def start(self) -> Signals:
        """Return the load at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move load and winch over step k; the tip's motion is a cubic over the step."""
        time_ns = (k - 1) * self._step_ns
        while self._pending and time_ns >= self._pending[0][0]:
            self._happen(self._pending.pop(0)[1])
        tip_next = tip_motion(inputs["/crane/tip"])
        self._mode, self._command = self._allowed(*self.commands.at(time_ns), inputs)
        told = self._memory[TOLD] if self._drive == POWERED else 0.0
        self._memory, hold = winch_step(
            self._winch,
            self._memory,
            self._load.line[0],
            self._command[0],
            self._mode[0] == POSITION,
            self._drive,
            self._step_s,
        )
        self._pulled = self._load.step(hold, (told, self._memory[TOLD]), (self._tip, tip_next), k, inputs)
        self._tension_most = max(self._tension_most, float(self._pulled[3]))
        if self._load.line[1] != self._memory[TOLD]:
            self._slipped_s += self._step_s
        self._tip = tip_next
        return self._outputs(k)

    def _allowed(self, mode: Ints, command: Array, inputs: Signals) -> tuple[Ints, Array]:
        """Return what the winch is told: nothing that hoists while the crane is cut out, but compensation goes on."""
        cut_out = not hoisting_allowed(inputs["/crane/load_state"])
        hoists = command[0] < (self._load.line[0] if mode[0] == POSITION else 0.0)
        self._hoisting_refused = cut_out and hoists
        if self._hoisting_refused:
            mode, command = np.full(1, VELOCITY, dtype=np.int64), np.zeros(1)
        return mode, self._controllers.over(command, inputs, 0.0 if cut_out else -math.inf)

    def events(self) -> dict[str, float]:
        """Return what has happened to load, wire and winch so far.

        ``snaps``, ``snap_tension_max_n`` and ``snap_tension_last_n`` (first peaks of tension after slack spells),
        ``tension_max_n``, ``drum_layer`` (0 the innermost) and ``drum_slipped_s`` (how long motor, brake or leak gave
        way); for a box also ``landings``, ``impact_speed_last_m_s``, ``impact_speed_max_m_s`` and ``lift_offs``.
        """
        return {
            **self._load.events(),
            "tension_max_n": self._tension_most,
            "drum_layer": float(drum_layer(self._winch, self._load.line[0])[0]),
            "drum_slipped_s": self._slipped_s,
        }

    def warnings(self) -> list[str]:
        """Return what an operator should know: what holds the winch now, and what has happened so far."""
        seen, told = self.events(), []
        if self._drive != POWERED:
            told.append(f"the winch has no power: {WITHOUT_POWER[self._drive]}")
        if self._hoisting_refused:
            told.append("hoisting refused: the crane is cut out by overload")
        if seen["snaps"]:
            told.append(
                f"the wire went slack and snapped taut {seen['snaps']:.0f} times, "
                f"with up to {1e-3 * seen['snap_tension_max_n']:.1f} kN"
            )
        if seen["drum_slipped_s"] and self._drive == POWERED:
            told.append(
                f"the winch gave way for {seen['drum_slipped_s']:.1f} s: the line pull was above what "
                "winch.drum holds"
            )
        if seen.get("landings"):
            told.append(
                f"the load landed {seen['landings']:.0f} times, at up to {seen['impact_speed_max_m_s']:.2f} m/s"
            )
        return told

    def condition(self) -> dict[str, str]:
        """Return how wire, winch and load do, for diagnostics."""
        seen = self.events()
        length, rate = self._load.line
        return {
            "power": "on" if self._drive == POWERED else "off",
            "paid_out_m": f"{length:.2f}",
            "pay_out_m_s": f"{rate:.2f}",
            "tension_kn": f"{1e-3 * self._pulled[3]:.2f}",
            "wire": "taut" if self._pulled[3] > 0.0 else "slack",
            **{key: f"{value:.4g}" for key, value in seen.items()},
        }

    def _happen(self, event: str) -> None:
        if event == "release_payload":
            self._load.release()
        else:
            self._drive = DRIVES[event]

    def _outputs(self, k: int) -> Signals:
        wrench, felt = np.zeros(6), np.zeros(10)
        wrench[:3] = self._pulled[:3]
        felt[0] = self._load.felt_mass() if self._pulled[3] > 0.0 else 0.0
        out = {
            "/payload/wire_wrench": wrench,
            "/payload/felt_inertia": felt,
            "/payload/odom": self._load.odometry(),
        }
        if k % self._telemetry_every == 0:
            length, rate = self._load.line
            drawn = line_pull(float(self._pulled[3]), rate, self._winch.sheave_friction)
            out["/winch/joint_states"] = np.array([length, rate, drawn])
            out["/winch/joint_command_applied"] = applied(self._mode, self._command, np.array([length]))
        return out
