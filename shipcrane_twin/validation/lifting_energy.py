"""Energy: kept by a crane that swings on its own oil, and balanced by the work done in a lift on the moving ship."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import NS_PER_S, Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import POWER_ON, ActuatorParams
from shipcrane_twin.physics.crane_chain import PRISMATIC, ChainParams
from shipcrane_twin.physics.crane_cylinders import lengths_from_joints
from shipcrane_twin.physics.crane_dynamics import pack_base
from shipcrane_twin.physics.crane_inertia import kinetic_energy, potential_energy
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import VELOCITY, MotionLimits
from shipcrane_twin.physics.frames import cross, matrix_from_quat
from shipcrane_twin.validation.lifting import GRAVITY, Machine, loaded_state

SOFTER = 60.0
"""By which the oil is softened, so that joints swing through degrees and decimetres instead of millimetres."""
HANDOVER_M = 2.5
SWING_S, SWING_STEP_S, SWING_MICRO = 300, 0.5, 400
CONSERVED_BAR, WORK_BAR = 1e-5, 1e-3


class Swing(NamedTuple):
    """Kinetic and total energy [J], joint values (n, joints), at times [s]."""

    time_s: Array
    kinetic: Array
    total: Array
    joints: Array

    @property
    def drift(self) -> float:
        """Largest change of the total over the kinetic energy exchanged."""
        return float(np.abs(self.total - self.total[0]).max() / np.ptp(self.kinetic))


def swing(
    chain: ChainParams,
    actuators: ActuatorParams,
    limits: MotionLimits,
    state: Array,
    seconds: int,
    n_micro: int = 250,
) -> Swing:
    """Let a crane with undamped drives swing on a base at rest, its brakes shut; sampled every half second.

    Parameters
    ----------
    chain, actuators, limits
        Of the crane; it must have no damping, and hold any force.
    state : float64, shape (7 n,)
    seconds : int
    n_micro : int
        Runge-Kutta steps in half a second.
    """
    n = chain.kind.shape[0]
    still, up = np.zeros(3), np.array([0.0, 0.0, GRAVITY])
    base = pack_base(still, still, up, still)
    mode, command = np.full(n, VELOCITY), np.zeros(n)
    oil = state[2 * n : 3 * n] - state[4 * n : 5 * n] + state[5 * n : 6 * n]
    rows = []
    for _ in range(round(seconds / SWING_STEP_S) + 1):
        q, qd = state[:n], state[n : 2 * n]
        kinetic = kinetic_energy(chain, q, qd, still, still)
        stretch = lengths_from_joints(limits.drives, q) - oil
        stored = potential_energy(chain, q, -up) + 0.5 * actuators.stiffness @ (stretch * stretch)
        rows.append(np.array([kinetic, kinetic + stored, *q]))
        state = crane_step(
            chain, actuators, limits, state, mode, command, POWER_ON, base, base, n_micro, SWING_STEP_S
        )[0]
    table = np.array(rows)
    time_s = np.arange(len(table), dtype=np.float64) * SWING_STEP_S
    return Swing(time_s, table[:, 0], table[:, 1], table[:, 2:])


def undamped(crane: Machine) -> Machine:
    """Return a crane whose oil is softer by `SOFTER`, without damping, and holds anything."""
    n = len(crane.names)
    endless = np.full(n, np.inf)
    stiffness = crane.actuators.stiffness / SOFTER
    actuators = crane.actuators._replace(
        stiffness=stiffness, damping=np.zeros(n), push=endless, pull=endless, hold_push=endless, hold_pull=endless
    )
    return crane._replace(actuators=actuators)


def dropped(crane: Machine, kick: Array, seconds: int = SWING_S) -> Swing:
    """Let a crane swing that hangs at rest on softened oil and gets a kick: joint rates (n,) [rad/s, m/s].

    A telescope starts where its second segment hands over to the third.
    """
    soft = undamped(crane)
    n = len(crane.names)
    q = np.array(crane.scenario.crane.initial_joints)
    q[crane.chain.kind == PRISMATIC] = HANDOVER_M
    state = loaded_state(soft, q, 0.0)
    state[n : 2 * n] = kick
    return swing(soft.chain, soft.actuators, soft.limits, state, seconds, SWING_MICRO)


def kick_of(crane: Machine) -> Array:
    """Return joint rates (n,) that make the crane swing without meeting its ends; telescopes through a hand-over."""
    return np.where(crane.chain.kind == PRISMATIC, 0.6, 0.15)


def swing_rows(name: str, found: Swing) -> list[Row]:
    """Return how well a crane kept its energy."""
    span = np.ptp(found.joints, axis=0)
    note = f"{np.ptp(found.kinetic) / 1e3:.1f} kJ exchanged; joints through " + ", ".join(f"{v:.2g}" for v in span)
    what = f"{name}, undamped, brakes shut: drift of energy over {found.time_s[-1]:.0f} s over that exchanged"
    return [Row(what, found.drift, CONSERVED_BAR, "relative", note)]


class Work(NamedTuple):
    """Running totals over a run at every macro step, float64 (n,) [J].

    Attributes
    ----------
    time_s : float64, shape (n,)
    energy : float64, shape (n,)
        Kinetic and potential, of the crane in the world, less that at the start.
    actuators, base, wire : float64, shape (n,)
        Work done on the crane by its drives, by the ship at its base, and by the wire at its tip.
    late : float64, shape (n,)
        Work at the tip that the wire's force of the same step would have done less what was done: what the lag made.
    """

    time_s: Array
    energy: Array
    actuators: Array
    base: Array
    wire: Array
    late: Array

    @property
    def residual(self) -> Array:
        """Change of energy that no work accounts for (n,) [J]."""
        return self.energy - self.actuators - self.base - self.wire


class Moment(NamedTuple):
    """The crane at the end of a step: what its work is added up from."""

    energy: float
    power: float
    twist: Array
    tip: Array
    tip_velocity: Array


def moment(scenario: Scenario, chain: ChainParams, seen: Mapping[str, Array]) -> Moment:
    """Return energy, power of the drives, the base's twist, and the tip in the world, from the latest topics."""
    n = len(scenario.joint_names)
    ends = np.cumsum([0, n, sum(link.drive.kind == "triangle" for link in scenario.crane.links)] * 3)[1:]
    states = seen["/crane/joint_states"]
    q, qd, effort = states[:n], states[ends[2] : ends[2] + n], states[ends[5] : ends[5] + n]
    odom, tip = seen["/vessel/odom"], seen["/crane/tip"]
    rot, base_b = matrix_from_quat(odom[3:7]), np.array(scenario.crane.base_m)
    velocity, turning = odom[7:10] + cross(odom[10:13], base_b), odom[10:13]
    height = (odom[:3] + rot @ base_b)[2]
    lifted = potential_energy(chain, q, -GRAVITY * rot[2]) + chain.mass.sum() * GRAVITY * height
    return Moment(
        kinetic_energy(chain, q, qd, velocity, turning) + lifted,
        float(effort @ qd),
        np.concatenate((velocity, turning)),
        tip[:3].copy(),
        matrix_from_quat(tip[3:7]) @ tip[7:10],
    )


def lift_work(name: str, changes: Sequence[str] = ()) -> Work:
    """Run a scenario and add up all work on its crane, macro step by macro step.

    Notes
    -----
    Drives: trapezium of effort times rate. Base: mean wrench of the step times mean twist of the ends. Wire: the
    force that the crane felt, held over the step in the world, times the way of the tip; with it the reaction of the
    mass that the tip carries, ``-m n n.(a - a_last)``, see `physics.crane_load`. The potential energy has the work of
    the weight.
    """
    scenario = load_scenario(name, changes)
    scenario = replace(scenario, telemetry_period_ms=scenario.macro_step_ms)
    chain = build.crane_chain(scenario.crane)
    run = InlineRun(scenario)
    step_s = scenario.step_ns / NS_PER_S
    rows: list[tuple[float, ...]] = []
    before, force, felt, accel_last = None, np.zeros(3), 0.0, np.zeros(3)
    for k in run.steps():
        seen = run.latest
        now = moment(scenario, chain, seen)
        if before is not None:
            way = now.tip - before.tip
            accel = (now.tip_velocity - before.tip_velocity) / step_s
            along = force / np.sqrt(force @ force)
            given = float(force @ way) - felt * float(along @ (accel - accel_last)) * float(along @ way)
            energy, drives = now.energy - before.energy, 0.5 * step_s * (now.power + before.power)
            base = -0.5 * step_s * float(seen["/crane/base_wrench"] @ (now.twist + before.twist))
            late = float(seen["/payload/wire_wrench"][:3] @ way) - given
            rows.append((k * step_s, energy, drives, base, given, late))
            accel_last = accel
        before = now
        force, felt = seen["/payload/wire_wrench"][:3].copy(), float(seen["/payload/felt_inertia"][0])
    table = np.array(rows)
    return Work(table[:, 0], *np.cumsum(table[:, 1:], axis=0).T)


def work_rows(found: Work) -> list[Row]:
    """Return what of the change of energy no work explains, over what the drives gave at most."""
    given = float(np.ptp(found.actuators))
    told = ", ".join(
        f"{what} {values[-1] / 1e3:+.2f}"
        for what, values in (("drives", found.actuators), ("ship", found.base), ("wire", found.wire))
    )
    worst = float(np.abs(found.residual).max())
    made = float(np.abs(found.late).max())
    return [
        Row(
            f"energy of the crane that no work explains, largest, of the {given / 1e3:.1f} kJ that the drives gave",
            worst / given, WORK_BAR, "",
            f"{worst:.1f} J; at the end [kJ]: {told}, energy {found.energy[-1] / 1e3:+.2f}",
        ),
        Row(
            "work that the wire's force made at the tip by coming a step late, largest, of the same", made / given,
            None, "", f"{made:.1f} J",
        ),
    ]  # fmt: skip
