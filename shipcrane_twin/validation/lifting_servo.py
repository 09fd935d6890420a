"""Velocity servos under the full load of the chart, on a level and on a rolling ship."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import POWER_ON
from shipcrane_twin.physics.crane_base import base_motion, crane_macro_step
from shipcrane_twin.physics.crane_cylinders import joint_at, length_and_arm
from shipcrane_twin.physics.crane_reference import VELOCITY
from shipcrane_twin.validation.lifting import GRAVITY, Machine, loaded_state, safe_load

ROLL_DEG, ROLL_PERIOD_S = 5.0, 8.0
STEP_S = 0.02
START_S, GO_S, STOP_S = 8.0, 16.0, 48.0
"""Roll is at its full size; the command begins; it ends, whole periods later [s]."""

END_S = 56.0
SPEED_SHARE = 0.8
"""Of the rated speed: what is commanded, so that the servo has room to catch up."""

OVERSHOOT_BAR, STEADY_BAR = 0.05, 0.01


class Response(NamedTuple):
    """A joint told to move at a constant rate from `GO_S` to `STOP_S`; rates (n,) over the commanded one."""

    time_s: Array
    rate: Array
    reference: Array
    roll_deg: Array
    load: float

    def during(self, from_s: float, to_s: float) -> Array:
        """Return the rates from one time to another."""
        return self.rate[(self.time_s >= from_s - 1e-9) & (self.time_s < to_s - 1e-9)]

    @property
    def overshoot(self) -> float:
        """Largest rate beyond the commanded one while it is commanded, over it."""
        return max(0.0, float(self.during(GO_S, STOP_S).max()) - 1.0)

    @property
    def rebound(self) -> float:
        """Largest rate the other way after the stop, over the commanded one."""
        return max(0.0, -float(self.during(STOP_S, END_S).min()))

    @property
    def steady_error(self) -> float:
        """Mean rate over the last whole roll periods against the commanded one, over it."""
        return abs(float(self.during(STOP_S - 2.0 * ROLL_PERIOD_S, STOP_S).mean()) - 1.0)


def rolling(time_s: float, amplitude_deg: float) -> tuple[Array, Array]:
    """Return odometry (13,) and acceleration (6,) of a ship that rolls about base_link's x axis, from rest."""
    omega, size = 2.0 * math.pi / ROLL_PERIOD_S, math.radians(amplitude_deg)
    share, rate, bend = 1.0, 0.0, 0.0
    if time_s < START_S:
        turn = math.pi / START_S
        share, rate = 0.5 - 0.5 * math.cos(turn * time_s), 0.5 * turn * math.sin(turn * time_s)
        bend = 0.5 * turn * turn * math.cos(turn * time_s)
    s, c = math.sin(omega * time_s), math.cos(omega * time_s)
    roll = size * share * s
    odom, accel = np.zeros(13), np.zeros(6)
    odom[3], odom[6] = math.sin(0.5 * roll), math.cos(0.5 * roll)
    odom[10] = size * (rate * s + share * omega * c)
    accel[3] = size * (bend * s + 2.0 * rate * omega * c - share * omega * omega * s)
    return odom, accel


def respond(crane: Machine, joint: int, way: float, roll_deg: float) -> Response:
    """Move one joint, the others told to stand.

    The load is the chart's at the start, a mass on the tip that takes part in its vertical motion.
    """
    config = crane.scenario.crane
    n, q = len(crane.names), np.array(config.initial_joints)
    mass = safe_load(crane, q)
    state = loaded_state(crane, q, mass)
    base_b = np.array(config.base_m)
    odom, accel = rolling(0.0, 0.0)
    before = np.concatenate((odom[3:7], base_motion(odom, accel, base_b, GRAVITY), [0.0, 0.0, GRAVITY]))
    wanted = way * SPEED_SHARE * crane.limits.rate_max[joint] / longest_arm(crane, joint)
    micro = math.ceil(1e3 * STEP_S / config.servo.micro_step_max_ms)
    mode, command = np.full(n, VELOCITY), np.zeros(n)
    rows = []
    for k in range(1, round(END_S / STEP_S) + 1):
        start_s = (k - 1) * STEP_S
        command[joint] = wanted if GO_S - 1e-9 <= start_s < STOP_S - 1e-9 else 0.0
        odom, accel = rolling(k * STEP_S, roll_deg)
        pull = np.array([0.0, 0.0, -mass * before[15]])
        out = crane_macro_step(
            crane.chain, crane.actuators, crane.limits, base_b, GRAVITY, state, mode, command, POWER_ON, before, odom,
            accel, pull, mass, micro, STEP_S,
        )  # fmt: skip
        state, before = out[0], out[5]
        here = length_and_arm(crane.limits.drives, joint, state[joint])[1]
        told = state[4 * n + joint] / crane.limits.lag[joint] / here  # the reference follows its path at this rate
        rows.append((k * STEP_S, state[n + joint] / wanted, told / wanted, 2.0 * math.degrees(math.asin(odom[3]))))
    time_s, rate, reference, roll = np.array(rows).T
    return Response(time_s, rate, reference, roll, mass)


def longest_arm(crane: Machine, joint: int) -> float:
    """Return the longest lever arm of a drive over its stroke [m]; with it a joint's rate is within the drive's."""
    drives = crane.limits.drives
    low, high = (joint_at(drives, joint, end[joint]) for end in (drives.length_min, drives.length_max))
    if not np.isfinite(high - low):
        return 1.0
    return max(length_and_arm(drives, joint, q)[1] for q in np.linspace(low, high, 200))


def ways(crane: Machine) -> tuple[float, ...]:
    """Return for each joint the way that has the longer stroke ahead."""
    low, high = crane.limits.low, crane.limits.high
    q = np.array(crane.scenario.crane.initial_joints)
    here = [length_and_arm(crane.limits.drives, i, q[i])[0] for i in range(len(q))]
    return tuple(1.0 if high[i] - here[i] >= here[i] - low[i] else -1.0 for i in range(len(q)))


def responses(crane: Machine) -> dict[str, dict[float, Response]]:
    """Return the response of every joint on a level and on a rolling ship, by joint and roll [deg]."""
    return {
        name: {roll: respond(crane, i, way, roll) for roll in (0.0, ROLL_DEG)}
        for i, (name, way) in enumerate(zip(crane.names, ways(crane), strict=True))
    }


def servo_rows(crane: str, found: Mapping[str, Mapping[float, Response]]) -> list[Row]:
    """Return overshoot and steady error of each joint on a level and a rolling ship."""
    rows = []
    for joint, runs in found.items():
        for roll, run in runs.items():
            where = f"roll {roll:g} deg" if roll else "level ship"
            what = f"{crane}, {joint}, {1e-3 * run.load:.1f} t, {where}"
            steady = run.during(STOP_S - 2.0 * ROLL_PERIOD_S, STOP_S)
            told = f"ripple {50.0 * np.ptp(steady):.2f} %; {100.0 * run.rebound:.1f} % the other way after the stop"
            rows.append(Row(f"{what}: overshoot", run.overshoot, OVERSHOOT_BAR, ""))
            rows.append(Row(f"{what}: steady error", run.steady_error, STEADY_BAR, "", told))
    return rows
