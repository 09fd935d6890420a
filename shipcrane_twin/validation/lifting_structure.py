"""What holds the load: kinematics, the load chart with its limiter, telescope, end stops, and failures of power."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import NS_PER_S
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.subsystems.crane import Crane
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import POWER_BRAKE, POWER_COAST, POWER_LEAK, POWER_ON
from shipcrane_twin.physics.crane_chain import forward_kinematics
from shipcrane_twin.physics.crane_cylinders import joints_from_lengths, lengths_from_joints
from shipcrane_twin.physics.crane_dynamics import pack_base
from shipcrane_twin.physics.crane_links import new_work, place_links
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import VELOCITY
from shipcrane_twin.validation.lifting import GRAVITY, Machine, loaded_state, safe_load

LENGTHS = ("slew_rad", "boom_cylinder_m", "knuckle_cylinder_m", "telescope_cylinder_m")
JOINTS = ("theta1_rad", "theta2_rad", "theta3_rad", "d4_m")
TIP = ("tip_x_m", "tip_y_m", "tip_z_m")
KINEMATICS_BAR = 1e-6

OVERLOAD_KG = 5600.0
OVERLOAD = (
    "duration_s=120.0",
    f"payload.mass_kg={OVERLOAD_KG}",
    "vessel.ballast.mode=level",
    "operations=[{label: out, joint: telescope, from_s: 5.0, to_s: 110.0, velocity_m_s: 0.04}]",
    "events=[]",
)
FAILURES = {"power stays": POWER_ON, "coasts": POWER_COAST, "brakes": POWER_BRAKE, "leaks": POWER_LEAK}
FAIL_S, FAIL_END_S, STEP_S = 10.0, 40.0, 0.02


def kinematics_rows(table: Path, crane: Machine) -> list[Row]:
    """Return how far joints and tip from cylinder lengths are from a table of poses.

    Raises
    ------
    ConfigError
        If the table cannot be read or lacks a column.
    """
    try:
        poses = np.genfromtxt(table, delimiter=",", names=True)
        lengths, joints, tips = (np.column_stack([poses[name] for name in group]) for group in (LENGTHS, JOINTS, TIP))
    except (OSError, ValueError) as err:
        raise ConfigError(f"{table}: {err}; expected the columns {', '.join((*LENGTHS, *JOINTS, *TIP))}") from None
    found = [joints_from_lengths(crane.limits.drives, row) for row in lengths]
    off = np.abs(np.array(found) - joints)
    ends = [forward_kinematics(crane.chain, q)[0][-1] for q in found]
    away = np.linalg.norm(np.array(ends) - tips, axis=1)
    count = f"{len(poses)} poses"
    return [
        Row("joints from cylinder lengths, against the table", float(off.max()), KINEMATICS_BAR, "rad, m", count),
        Row("tip from cylinder lengths, against the table", float(away.max()), KINEMATICS_BAR, "m", count),
    ]


class Overload(NamedTuple):
    """A load taken outward until the limiter stops it: time [s], radius [m], utilisation, warning, cut-out (n,)."""

    time_s: Array
    radius: Array
    utilisation: Array
    warning: Array
    cut_out: Array
    chart: Array


def overload() -> Overload:
    """Telescope a load of `OVERLOAD_KG` outward in calm water."""
    scenario = load_scenario("case2", OVERLOAD)
    scenario = replace(scenario, telemetry_period_ms=scenario.macro_step_ms)
    run = InlineRun(scenario)
    crane = run.subsystem("crane")
    assert isinstance(crane, Crane)
    rows = []
    for k in run.steps():
        radius, _, _, used, cut_out = run.latest["/crane/load_state"]
        warning = any("overload" in told for told in crane.warnings())
        rows.append((k * scenario.step_ns / NS_PER_S, radius, used, warning, cut_out))
    time_s, radius, used, warning, cut_out = np.array(rows, dtype=np.float64).T
    return Overload(time_s, radius, used, warning, cut_out, np.array(scenario.crane.load_chart))


def overload_rows(found: Overload) -> list[Row]:
    """Return where the limiter warned and cut out, and how far the load went on."""
    warned, out = (int(np.argmax(flag > 0.0)) for flag in (found.warning, found.cut_out))
    gained = float(found.radius[out:].max() - found.radius[out])
    return [
        Row("load limiter: warning, off 90 % of the safe load", abs(float(found.utilisation[warned]) - 0.9), 0.005, ""),
        Row("load limiter: cut-out, off 110 % of it", abs(float(found.utilisation[out]) - 1.1), 0.005, ""),
        Row(
            "load limiter: radius gained after the cut-out", gained, 0.1, "m",
            f"at {found.radius[out]:.2f} m, told to go on for {110.0 - found.time_s[out]:.0f} s",
        ),
    ]  # fmt: skip


class Telescope(NamedTuple):
    """Extension (n,), centre of gravity of all segments along the telescope (n,) [m], the same by hand, and inertia.

    ``inertia`` is that about the common centre, across the telescope [kg m2].
    """

    extension: Array
    centre: Array
    by_hand: Array
    inertia: Array


def telescope(crane: Machine) -> Telescope:
    """Extend a crane's telescope over its whole stroke."""
    link = int(np.flatnonzero(np.diff(crane.chain.segments.first))[0])
    config = crane.scenario.crane.links[link]
    stops = np.cumsum([segment.stroke_m for segment in config.segments])
    masses = np.array([*[segment.mass_kg for segment in config.segments], config.mass_kg])
    places = np.array([*[segment.cog_m[2] for segment in config.segments], config.cog_m[2]])
    longest = crane.limits.drives.length_max[link] + crane.limits.drives.offset[link]
    extension = np.linspace(0.0, longest, 401)
    q = np.array(crane.scenario.crane.initial_joints)
    work = new_work(len(q))
    rows = []
    for out in extension:
        q[link] = out
        place_links(crane.chain, q, work)
        slides = np.array([*np.minimum(out, stops), out])
        rows.append((work.body[link, 2] + out, masses @ (places + slides) / masses.sum(), work.body[link, 3]))
    return Telescope(extension, *np.array(rows).T)


def telescope_rows(crane: Machine, found: Telescope) -> list[Row]:
    """Return how far the common centre is from segments that stop at once."""
    handover = crane.scenario.crane.segment_handover_m
    off = float(np.abs(found.centre - found.by_hand).max())
    told = f"inertia {found.inertia[0]:.0f} to {found.inertia[-1]:.0f} kg m²"
    return [Row("telescope: centre of gravity off that of segments with hard stops", off, 0.1 * handover, "m", told)]


class Motion(NamedTuple):
    """Time [s], actuator lengths (n, joints) [m, rad] and their rates."""

    time_s: Array
    length: Array
    rate: Array


def driven(crane: Machine, command: Array, seconds: float, power: int = POWER_ON, from_s: float = 0.0) -> Motion:
    """Move a crane with half its safe load at joint rates (n,) on a level base; its power changes at a time [s]."""
    n, q = len(crane.names), np.array(crane.scenario.crane.initial_joints)
    mass = 0.5 * safe_load(crane, q)
    still = np.zeros(3)
    base = pack_base(still, still, np.array([0.0, 0.0, GRAVITY]), np.array([0.0, 0.0, -mass * GRAVITY]))
    state, mode = loaded_state(crane, q, mass), np.full(n, VELOCITY)
    rows = []
    for k in range(round(seconds / STEP_S)):
        now = power if k * STEP_S >= from_s else POWER_ON
        state = crane_step(
            crane.chain, crane.actuators, crane.limits, state, mode, command, now, base, base, 4, STEP_S
        )[0]
        rows.append(lengths_from_joints(crane.limits.drives, state[:n]))
    length = np.array(rows)
    time_s = np.arange(1, len(rows) + 1, dtype=np.float64) * STEP_S
    return Motion(time_s, length, np.gradient(length, STEP_S, axis=0))


def to_the_end(crane: Machine) -> Motion:
    """Lift with the boom as fast as it goes, into the end of its cylinder."""
    command = np.zeros(len(crane.names))
    command[1] = 0.02
    return driven(crane, command, 60.0)


def failures(crane: Machine) -> dict[str, Motion]:
    """Lift with the boom; after `FAIL_S` the power fails in one way or another."""
    command = np.zeros(len(crane.names))
    command[1] = 0.01
    return {name: driven(crane, command, FAIL_END_S, power, FAIL_S) for name, power in FAILURES.items()}


def failure_rows(crane: Machine, end: Motion, found: Mapping[str, Motion]) -> list[Row]:
    """Return how the boom lands in its end and what becomes of the load when the power fails."""
    beyond = 1e3 * float(end.length[:, 1].max() - crane.limits.drives.length_max[1])
    peak = float(np.abs(np.gradient(end.rate[:, 1], STEP_S)).max())
    allowed = crane.limits.accel_max[1]
    fall = {name: 1e3 * float(run.length[-1, 1] - run.length[round(FAIL_S / STEP_S), 1]) for name, run in found.items()}
    drift = found["leaks"].rate[round(20.0 / STEP_S) :, 1].mean()
    return [
        Row("boom cylinder run into its end: beyond it", max(0.0, beyond), 0.1, "mm"),
        Row("boom cylinder run into its end: largest acceleration, of the reference's", peak / float(allowed), None, "",
            f"{1e3 * peak:.1f} mm/s²"),
        Row("power fails, brakes shut: boom cylinder moves on", abs(fall["brakes"]), 5.0, "mm"),
        Row("power fails, drives coast: boom cylinder moves in 30 s", abs(fall["coasts"]), None, "mm"),
        Row("power fails, holding valves leak: boom cylinder creeps", abs(1e3 * float(drift)), None, "mm/s"),
    ]  # fmt: skip
