"""Compensation: heave compensation on the winch in waves, anti-sway on slew and boom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.signal import csd, welch

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import NS_PER_S, Scenario
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array

HEAVE, SWAY = "heave_compensation", "anti_sway"
LENGTHS_M = (10.0, 20.0, 40.0, 80.0)
BAND_HZ = (0.05, 0.2)
SEGMENT_S, SETTLED_S = 80.0, 100.0
HEAVE_BAR, SWAY_BAR = 0.10, 0.20
POWER_SHARE = 0.02
"""Of the largest density of the tip's heave: below it a ratio at one frequency says nothing."""

STOPPED_S = 7.0
"""After the operation's end slew and shaper have come to rest."""


class Hang(NamedTuple):
    """Heights of tip and load, their level distance [m], and slew [rad], at every macro step."""

    scenario: Scenario
    time_s: Array
    tip: Array
    load: Array
    aside: Array
    slew: Array

    @property
    def step_s(self) -> float:
        """The macro step [s]."""
        return float(self.time_s[1] - self.time_s[0])

    @property
    def sway_deg(self) -> Array:
        """Angle between wire and vertical [deg]."""
        return np.rad2deg(np.arctan2(self.aside, self.tip - self.load))


def hang(scenario: Scenario) -> Hang:
    """Run a scenario and note where tip and load are."""
    run = InlineRun(replace(scenario, telemetry_period_ms=scenario.macro_step_ms))
    rows = []
    for _ in run.steps():
        tip, load = run.latest["/crane/tip"], run.latest["/payload/odom"]
        aside = np.hypot(*(load - tip)[:2])
        rows.append((tip[2], load[2], aside, run.latest["/crane/joint_states"][0]))
    time_s = np.arange(len(rows)) * scenario.step_ns / NS_PER_S
    return Hang(scenario, time_s, *np.array(rows).T)


def held_load(length: float, duration_s: float = 480.0, *, compensated: bool = True) -> Hang:
    """Return a load that hangs on so much wire in E2."""
    scenario = load_scenario(
        HEAVE,
        [f"duration_s={duration_s}", "operations=[]", f"winch.initial_length_m={length}"]
        + ([] if compensated else ["controllers=[]"]),
    )
    return hang(scenario)


def heave_spectra(run: Hang) -> tuple[Array, Array, Array, Array]:
    """Return frequency [Hz], densities of tip and load heave [m2/Hz], and the load's part that follows the tip."""
    settled = run.time_s >= SETTLED_S
    tip, load = run.tip[settled], run.load[settled]
    rate, size = 1.0 / run.step_s, round(SEGMENT_S / run.step_s)
    hz, of_tip = welch(tip, rate, nperseg=size)
    of_load = welch(load, rate, nperseg=size)[1]
    return hz, of_tip, of_load, np.abs(csd(tip, load, rate, nperseg=size)[1]) / of_tip


def heave_ratios(run: Hang) -> tuple[float, float]:
    """Return load heave over tip heave in the band, as a whole (RMS) and at the frequency where it is largest."""
    hz, tip, load, follows = heave_spectra(run)
    inside = (hz >= BAND_HZ[0] - 1e-9) & (hz <= BAND_HZ[1] + 1e-9)
    loud = inside & (tip >= POWER_SHARE * tip[inside].max())
    return float(np.sqrt(load[inside].sum() / tip[inside].sum())), float(follows[loud].max())


def heave_rows(runs: Mapping[float, Hang]) -> list[Row]:
    """Return what is left of the tip's heave on each length of wire."""
    rows = []
    for length, run in runs.items():
        whole, worst = heave_ratios(run)
        still = float(np.std(run.tip[run.time_s >= SETTLED_S]))
        what = f"heave compensation in E2, {length:g} m of wire: load heave over tip heave"
        rows.append(Row(f"{what}, {BAND_HZ[0]:g} to {BAND_HZ[1]:g} Hz", whole, HEAVE_BAR, "", f"tip {still:.3f} m RMS"))
        rows.append(Row(f"{what}, at the worst frequency there", worst, HEAVE_BAR, ""))
    return rows


def slewed() -> dict[str, Hang]:
    """Return the quarter turn with anti-sway and without."""
    scenario = load_scenario(SWAY)
    return {"with": hang(scenario), "without": hang(replace(scenario, controllers=()))}


def residual_deg(run: Hang) -> float:
    """Return the largest sway after the crane has stopped [deg]."""
    return float(run.sway_deg[run.time_s >= run.scenario.operations[0].to_s + STOPPED_S].max())


def sway_rows(runs: Mapping[str, Hang]) -> list[Row]:
    """Return the residual sway over the uncompensated one, and by how much the crane misses its place."""
    left, plain = residual_deg(runs["with"]), residual_deg(runs["without"])
    off = abs(np.rad2deg(runs["with"].slew[-1] - runs["without"].slew[-1]))
    turned = abs(np.rad2deg(runs["without"].slew[-1] - runs["without"].slew[0]))
    return [
        Row(
            f"anti-sway: residual sway after slewing by {turned:.0f} degrees, of the uncompensated", left / plain,
            SWAY_BAR, "", f"{left:.2f} of {plain:.2f} deg",
        ),
        Row("anti-sway: slew off where it ends without it", float(off), 0.5, "deg"),
    ]  # fmt: skip
