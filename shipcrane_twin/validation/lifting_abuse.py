"""Random commands to crane and winch of the whole twin in waves: nonsense, floods and reversals, and what they do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import NS_PER_S, WINCH, Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.subsystems.crane import Crane
from shipcrane_twin.cosim.subsystems.payload import Payload
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import POWER_ON
from shipcrane_twin.physics.crane_cylinders import length_and_arm
from shipcrane_twin.physics.crane_dynamics import pack_base
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY
from shipcrane_twin.validation.lifting import GRAVITY, Machine, loaded_state

WEATHER = "case3_e2"
STEPS = 10_000
FLOOD = 40
"""Messages between two steps in a flood."""

ELASTIC_M = 1e-3
"""Depth to which a loaded actuator may press into its end stop, oil and stop being elastic."""
EXACT = 1e-9
"""What rounding may add."""

Message = tuple[Sequence[str], Sequence[float]]
Operator = Callable[[int], Iterable[Message]]
"""What is said before a step of that number."""


class Limits(NamedTuple):
    """How far beyond its limits anything was; not above 0 where a limit is never reached.

    Attributes
    ----------
    end : float
        Actuator length beyond an end [m].
    speed, force : float
        Share beyond the rated speed of an actuator, and beyond the greatest force of drive, brake and stop.
    wire, pay_out, change : float
        Paid-out length beyond its ends [m]; pay-out speed and its change in a step beyond the limits [m/s].
    not_finite : int
        Values of any topic.
    refused, taken : int
        Messages.
    """

    end: float = -np.inf
    speed: float = -np.inf
    force: float = -np.inf
    wire: float = -np.inf
    pay_out: float = -np.inf
    change: float = -np.inf
    not_finite: int = 0
    refused: int = 0
    taken: int = 0


class Trace(NamedTuple):
    """What a run under random commands showed: time (n,), actuator lengths (n, joints), paid-out length (n,)."""

    time_s: Array
    lengths: Array
    wire: Array
    limits: Limits


def nonsense(names: Sequence[str], seed: int) -> Operator:
    """Return an operator who says anything, the same for the same seed.

    Spells of 20 to 400 steps: silence, one command held, a reversal at every step, floods, and messages that are wrong.
    """
    rng = np.random.default_rng(seed)
    strange = (np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-320, 0.0)
    left, kind, held = 0, "silence", np.zeros(len(names))

    def message() -> Message:
        chosen = list(rng.choice(names, rng.integers(1, len(names) + 1), replace=False))
        values = rng.normal(size=len(chosen)) * 10.0 ** rng.uniform(-3.0, 3.0)
        if rng.random() < 0.3:
            values[rng.integers(len(values))] = rng.choice(strange)
        if rng.random() < 0.2:
            chosen.append(str(rng.choice(["gripper", "", "Slew", "winch "])))
        if rng.random() < 0.3:
            return chosen, list(values)
        return chosen, [*values, *[0.1] * (len(chosen) - len(values))]

    def say(k: int) -> Iterable[Message]:
        nonlocal left, kind, held
        if left == 0:
            left = int(rng.integers(20, 400))
            kind = str(rng.choice(["silence", "held", "reversal", "flood", "wrong"]))
            signs = rng.choice(np.array([-1.0, 1.0]), len(names))
            held = signs * float(rng.choice([0.02, 0.1, 10.0]))
        left -= 1
        if kind == "held":
            return [(names, list(held))]
        if kind == "reversal":
            return [(names, list(held if k % 2 else -held))]
        return [message() for _ in range({"flood": FLOOD, "wrong": 1}.get(kind, 0))]

    return say


def abused(operator: Operator | None = None, steps: int = STEPS, seed: int = 2) -> Trace:
    """Run the whole twin in E2 while an operator, by default `nonsense`, commands crane and winch."""
    scenario = load_scenario(WEATHER, ["operations=[]", "events=[]"])
    seconds = steps * scenario.step_ns / NS_PER_S
    scenario = replace(scenario, duration_s=seconds, telemetry_period_ms=scenario.macro_step_ms)
    say = operator or nonsense((*scenario.joint_names, WINCH), seed)
    bad = 0

    def watch(time_ns: int, topic: str, values: Array) -> None:
        nonlocal bad
        bad += int(np.count_nonzero(~np.isfinite(values)))

    run = InlineRun(scenario, watch)
    crane, payload = run.subsystem("crane"), run.subsystem("payload")
    assert isinstance(crane, Crane)
    assert isinstance(payload, Payload)
    joints, winches = [], []
    refused = taken = 0
    for k in run.steps():
        joints.append(run.latest["/crane/joint_states"].copy())
        winches.append(run.latest["/winch/joint_states"].copy())
        for names, values in say(k):
            for part in (crane, payload):
                wrong = part.commands.say(names, values) is not None
                refused, taken = refused + wrong, taken + (not wrong)
    lengths, rates, forces = actuator_states(scenario, np.array(joints))
    found = beyond(scenario, lengths, rates, forces, np.array(winches))
    time_s = np.arange(len(joints)) * scenario.step_ns / NS_PER_S
    limits = found._replace(not_finite=bad, refused=refused, taken=taken)
    return Trace(time_s, lengths, np.array(winches)[:, 0], limits)


def actuator_states(scenario: Scenario, joints: Array) -> tuple[Array, Array, Array]:
    """Return lengths, speeds and forces (n, joints) of all actuators from joint states (n, m)."""
    n = len(scenario.joint_names)
    drives = build.crane_drives(scenario.crane)
    booms = sum(link.drive.kind == "triangle" for link in scenario.crane.links)
    q, qd, effort = (joints[:, i * (n + booms) : i * (n + booms) + n] for i in range(3))
    table = np.array([[length_and_arm(drives, i, row[i]) for i in range(n)] for row in q])
    return table[:, :, 0], qd * table[:, :, 1], effort / table[:, :, 1]


def beyond(scenario: Scenario, lengths: Array, rates: Array, forces: Array, winches: Array) -> Limits:
    """Return how far a run went beyond the limits of drives and winch."""
    actuators = build.crane_actuators(scenario.crane)
    limits = build.crane_limits(scenario.crane, build.crane_drives(scenario.crane))
    low, high, fastest = limits.drives.length_min, limits.drives.length_max, limits.rate_max
    deepest = np.maximum(lengths - high, low - lengths)
    stop = actuators.stiffness * np.maximum(deepest, 0.0) + actuators.damping * np.abs(rates) * (deepest > 0.0)
    greatest = np.maximum(actuators.hold_push, actuators.push), np.maximum(actuators.hold_pull, actuators.pull)
    over = np.maximum(forces - stop - greatest[0], -forces - stop - greatest[1]) / np.minimum(*greatest)
    winch, step_s = scenario.winch, scenario.step_ns / NS_PER_S
    paid_out, speed = winches[:, 0], winches[:, 1]
    return Limits(
        end=float(deepest.max()),
        speed=float((np.abs(rates) / fastest).max() - 1.0),
        force=float(over.max()),
        wire=float(np.maximum(paid_out - winch.length_max_m, winch.length_min_m - paid_out).max()),
        pay_out=float(np.abs(speed).max() - winch.speed_max_m_s),
        change=float(np.abs(np.diff(speed)).max() - winch.accel_max_m_s2 * step_s),
    )


def referenced(crane: Machine, steps: int = STEPS, seed: int = 1) -> tuple[float, float, float]:
    """Drive a crane's kernel alone with random rates and positions, wrong numbers among them.

    Returns
    -------
    float
        How far the reference came beyond the actuators' ends [m, rad], and its speed and its change of speed in a
        step beyond their limits, as shares of these.
    """
    rng = np.random.default_rng(seed)
    n, step_s = len(crane.names), 0.02
    still = np.zeros(3)
    base = pack_base(still, still, np.array([0.0, 0.0, GRAVITY]), still)
    state = loaded_state(crane, np.array(crane.scenario.crane.initial_joints), 0.0)
    mode, command = np.full(n, VELOCITY), np.zeros(n)
    end = speed = change = -np.inf
    limits, drives = crane.limits, crane.limits.drives
    for _ in range(steps):
        if rng.random() < rng.choice([0.01, 0.5]):
            mode = rng.choice([VELOCITY, POSITION], n)
            command = rng.normal(size=n) * 10.0 ** rng.uniform(-3.0, 3.0, n)
            command[rng.random(n) < 0.05] = rng.choice([np.nan, np.inf, -np.inf])
        rate = state[3 * n : 4 * n]
        state = crane_step(
            crane.chain, crane.actuators, limits, state, mode, command, POWER_ON, base, base, 4, step_s
        )[0]
        path = state[2 * n : 3 * n]
        end = max(end, float(np.maximum(path - drives.length_max, drives.length_min - path).max()))
        after = state[3 * n : 4 * n]
        speed = max(speed, float((np.abs(after) / limits.rate_max).max()) - 1.0)
        # a brake that shuts ends what is left of the lag's tail at once
        moving = (state[6 * n :] == 0.0) & np.isfinite(after)
        gain = np.abs(after - rate) / (limits.accel_max * step_s)
        change = max(change, float(gain[moving].max()) - 1.0 if moving.any() else -np.inf)
        if not np.isfinite(state).all():
            return np.inf, np.inf, np.inf
    return end, speed, change


def reference_rows(name: str, found: tuple[float, float, float]) -> list[Row]:
    """Return how far a crane's reference went beyond the limits under random rates and positions."""
    what = f"{name}: random rates and positions, reference"
    return [
        Row(f"{what} beyond an actuator's end", max(0.0, found[0]), EXACT, "m"),
        Row(f"{what} faster than its limit", max(0.0, found[1]), EXACT, "relative"),
        Row(f"{what}: acceleration beyond its limit", max(0.0, found[2]), EXACT, "relative"),
    ]


def abuse_rows(found: Trace) -> list[Row]:
    """Return what random commands broke."""
    limits = found.limits
    steps = len(found.time_s) - 1
    said = f"{limits.taken + limits.refused} times a message was heard, {limits.refused} refused"
    return [
        Row(f"random commands, {steps} steps: values that are not finite", float(limits.not_finite), 0.0, "of all",
            said),
        Row("random commands: actuator beyond its end, the stop being elastic", max(0.0, 1e3 * limits.end), 1.0, "mm"),
        Row("random commands: actuator beyond its rated speed, by the load's pull", max(0.0, limits.speed), None, ""),
        Row("random commands: force beyond that of drive and brake", max(0.0, limits.force), EXACT, "relative"),
        Row("random commands: wire beyond its ends", max(0.0, limits.wire), EXACT, "m"),
        Row("random commands: pay-out speed beyond its limit", max(0.0, limits.pay_out), EXACT, "m/s"),
        Row("random commands: change of pay-out speed beyond its limit", max(0.0, limits.change), EXACT, "m/s"),
    ]
