"""Without a run: thrust allocation on random demands, the linearised loop, what the thrusters hold."""

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.allocation import horizontal_load
from shipcrane_twin.control.allocation_program import POLYGON_SIDES, static_thrust
from shipcrane_twin.control.allocation_setup import AllocationParams
from shipcrane_twin.control.loop import LoopReport, closed_loop, passive_observer
from shipcrane_twin.control.observer import passive_gains
from shipcrane_twin.cosim import dp_build
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.validation.positioning import AXES

WAVE_PERIOD_S = 10.0
"""Peak period of E1 and E2."""

PERIODS_S = np.arange(dp_build.WAVE_PERIODS_S[0], dp_build.WAVE_PERIODS_S[1] + 0.1, 1.0)
DEMANDS, EXCESS = 10_000, 3.0
BEYOND = 1e-3
"""Missed part of full load from which a demand counts as infeasible."""


class Allocated(NamedTuple):
    """What a number of demands came to, worst values.

    Attributes
    ----------
    missed : float
        Part of full load that a feasible demand misses.
    over : float
        Thrust over its limit, as a share of full thrust; at most zero if all limits hold.
    in_zone : int
        Solutions that push into a forbidden zone.
    turned_deg : float
        Direction of the force against that of an infeasible demand, with position first.
    infeasible : int
        Demands that were so.
    longest_ms, median_ms : float
        Time of one solve.
    """

    missed: float
    over: float
    in_zone: int
    turned_deg: float
    infeasible: int
    longest_ms: float
    median_ms: float


def in_zone(params: AllocationParams, azimuth: Array, slack: float = 0.0) -> Array:
    """Return which azimuths (n,) [rad] lie outside of all allowed arcs, tunnels never."""
    start, width = params.arcs[:, :, 0], params.arcs[:, :, 1]
    along = (azimuth[:, None] - start + slack) % (2.0 * np.pi)
    return np.asarray((params.azimuthing != 0.0) & ~(along <= width + 2.0 * slack).any(axis=1))


def random_load(params: AllocationParams, rng: np.random.Generator) -> Array:
    """Return the load (3,) of random thrust within all limits and zones, the program's inscribed polygon too."""
    steers = params.azimuthing != 0.0
    azimuth = params.axis.copy()
    while True:
        azimuth[steers] = rng.uniform(-np.pi, np.pi, int(steers.sum()))
        if not in_zone(params, azimuth).any():
            break
    count = len(steers)
    inside = np.cos(np.pi / POLYGON_SIDES) * np.sqrt(rng.uniform(size=count))
    part = np.where(steers, inside, rng.uniform(-1.0, 1.0, count))
    return horizontal_load(params, azimuth, part * params.thrust_max)


def allocate_many(scenario: Scenario, count: int = DEMANDS, seed: int = 2019) -> Allocated:
    """Solve the static program for demands: half of them of random thrust, half of them up to far beyond."""
    thrusters = dp_build.propulsion_params(scenario)
    params = dp_build.allocation_of(scenario, thrusters)
    aim = replace(scenario, dp=replace(scenario.dp, allocation=replace(scenario.dp.allocation, priority="position")))
    position_first = dp_build.allocation_of(aim, thrusters)
    rng, share, fresh = np.random.default_rng(seed), np.ones(len(params.axis)), np.full(len(params.axis), -1.0)
    static_thrust(params, np.zeros(3), share, fresh)  # compiles
    missed, over, zone, turned, beyond, times = 0.0, -np.inf, 0, 0.0, 0, []
    for k in range(count):
        feasible = k % 2 == 0
        load = random_load(params, rng)
        if not feasible:
            load *= rng.uniform(0.5, EXCESS)
        began = time.perf_counter()
        part = static_thrust(params, load, share, fresh)[0]
        times.append(time.perf_counter() - began)
        size = np.hypot(part[0::2], part[1::2])
        over = max(over, float(size.max() - 1.0))
        azimuth = np.where(size > BEYOND, np.arctan2(part[1::2], part[0::2]), params.arcs[:, 0, 0])
        zone += int(in_zone(params, azimuth, 1e-6).sum())
        off = float(np.abs(params.effect @ part - load / params.load_scale).max())
        if feasible:
            missed = max(missed, off)
        elif off > BEYOND:
            beyond += 1
            given = position_first.effect @ static_thrust(position_first, load, share, fresh)[0] * params.load_scale
            angle = np.arctan2(load[0] * given[1] - load[1] * given[0], load[:2] @ given[:2])
            turned = max(turned, float(np.rad2deg(abs(angle))))
    return Allocated(missed, over, zone, turned, beyond, 1e3 * max(times), 1e3 * float(np.median(times)))


def allocation_rows(found: Allocated, count: int = DEMANDS) -> list[Row]:
    """Return what the demands came to."""
    return [
        Row("allocation: feasible demands, missed part of full load", found.missed, 1e-6, "of 1", f"{count // 2} ones"),
        Row("allocation: thrust over its limit", max(found.over, 0.0), 1e-6, "of 1", f"{count} demands"),
        Row("allocation: azimuths in a forbidden zone", float(found.in_zone), 0.0, f"of {count}"),
        Row(
            "allocation: infeasible demands, position first, direction of the force", found.turned_deg, 0.2, "deg",
            f"{found.infeasible} ones",
        ),
        Row("allocation: worst solve time", found.longest_ms, None, "ms", f"median {found.median_ms:.2f} ms"),
    ]  # fmt: skip


def loop_of(scenario: Scenario, wave_period_s: float | None) -> LoopReport:
    """Analyse a scenario's loop with the passive observer at a wave period, or with measured pose and velocity."""
    dp = scenario.dp
    mass, damping = dp_build.ship_3dof(scenario)
    observer = None
    if wave_period_s is not None:
        params = dp_build.passive_of(dp, mass, damping)
        omega = np.full(3, 2.0 * np.pi / wave_period_s)
        gains = passive_gains(params, omega)
        observer = passive_observer(mass, damping, gains, omega, params.wave_damping, params.bias_time_constant)
    lag = max(thruster.shaft_lag_s for thruster in scenario.vessel.thrusters)
    hold = 0.5 * dp_build.seconds_of(dp.period_ms)
    return closed_loop(mass, damping, dp_build.controller_of(dp, mass), lag, hold, observer)


def stability_rows(scenario: Scenario) -> list[Row]:
    """Return the slowest eigenvalues, with and without observer and over all wave periods, and the margins."""
    bare, filtered = loop_of(scenario, None), loop_of(scenario, WAVE_PERIOD_S)
    worst = max(float(loop_of(scenario, period).eigenvalues[0].real) for period in PERIODS_S)
    span = f"{PERIODS_S[0]:.0f} to {PERIODS_S[-1]:.0f} s"
    rows = []
    for name, report in (("without observer", bare), (f"observer at {WAVE_PERIOD_S:g} s waves", filtered)):
        note = f"slowest time constant {report.slowest_s:.0f} s, {len(report.eigenvalues)} eigenvalues"
        rows.append(Row(f"loop, {name}: largest real part", float(report.eigenvalues[0].real), 0.0, "1/s", note))
    rows.append(Row(f"loop, observer at waves of {span}: largest real part", worst, 0.0, "1/s"))
    for i, axis in enumerate(AXES):
        for name, report in (("without observer", bare), ("with observer", filtered)):
            note = f"gain up {report.gain_up_db[i]:.1f} dB, down {-report.gain_down_db[i]:.1f} dB, "
            note += f"sensitivity peak {report.sensitivity_peak[i]:.2f}, crossover {report.crossover[i]:.2f} rad/s"
            margin = float(report.phase_margin_deg[i])
            rows.append(Row(f"loop, {axis}, {name}: phase margin", margin, None, "deg", note))
    return rows


def capability_rows(cases: Mapping[str, Array]) -> list[Row]:
    """Compare the winds that are held without each thruster with those of the intact ship."""
    intact = cases["intact"]
    rows = [Row("capability, intact: least wind held", float(intact.min()), None, "m/s")]
    for name, winds in cases.items():
        if name != "intact":
            more = float((winds - intact).max())
            what = f"capability {name.replace('_', ' ')}: more wind held than intact, any direction"
            note = f"least wind held {winds.min():.1f} m/s"
            rows.append(Row(what, max(more, 0.0), 0.0, "m/s", note))
    return rows
