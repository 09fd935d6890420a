"""Pictures of the page on crane and load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from shipcrane_twin.hydro.figure_style import COLOURS, INK, PALE, SMALL, blank, finish, grid, legend_below
from shipcrane_twin.validation import lifting_control as control
from shipcrane_twin.validation import lifting_wire as wire
from shipcrane_twin.validation.lifting import Machine
from shipcrane_twin.validation.lifting_abuse import Trace
from shipcrane_twin.validation.lifting_energy import Swing, Work
from shipcrane_twin.validation.lifting_servo import GO_S, STOP_S, Response
from shipcrane_twin.validation.lifting_splash import Transit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TIME = "time [s]"


def energy(swings: Mapping[str, Swing]) -> Figure:
    """Draw kinetic energy and the total's drift of each crane."""
    figure = blank("Energy of the undamped crane", 5.4)
    for row, (name, found) in zip(figure.subplots(2, 2, sharex="col").T, swings.items(), strict=True):
        row[0].plot(found.time_s, found.kinetic / 1e3, color=COLOURS[0], linewidth=0.7)
        finish(row[0], f"{name}: kinetic energy", "[kJ]", "")
        off = (found.total - found.total[0]) / np.ptp(found.kinetic)
        row[1].plot(found.time_s, off, color=COLOURS[1], linewidth=0.9)
        finish(row[1], "total less that at the start, over the energy exchanged", "[1]", TIME)
        row[1].ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
    return figure


def work(found: Work) -> Figure:
    """Draw the running totals of work and energy of a lift."""
    figure = blank("Lift of case 2: work done on the crane and change of its energy", 5.6)
    totals, rest = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    for name, values, colour in (
        ("drives", found.actuators, COLOURS[0]),
        ("wire", found.wire, COLOURS[1]),
        ("ship", found.base, COLOURS[2]),
    ):
        totals.plot(found.time_s, values / 1e3, color=colour, linewidth=1.2, label=name)
    totals.plot(found.time_s, (found.actuators + found.base + found.wire) / 1e3, color=PALE, linewidth=3.0, label="sum")
    totals.plot(found.time_s, found.energy / 1e3, color=INK, linewidth=0.9, label="energy of the crane")
    finish(totals, "", "[kJ]", "")
    totals.set_xlim(190.0, found.time_s[-1])
    rest.plot(found.time_s, found.residual, color=COLOURS[3], linewidth=0.9)
    finish(rest, "energy less work", "[J]", TIME)
    legend_below(figure, totals)
    return figure


def on_the_wire() -> Figure:
    """Draw the pendulum's path, sway amplification and a snap."""
    figure, (path, gain, snap) = grid("The load on its wire", rows=1)
    found = wire.pendulum(0.1)
    for k, name in enumerate(("along x", "along y")):
        path.plot(found.time_s, found.exact[:, k] - wire.FIXED[k], color=PALE, linewidth=2.4)
        path.plot(found.time_s, found.ours[:, k] - wire.FIXED[k], color=COLOURS[k], linewidth=0.9, label=name)
    finish(path, "spherical pendulum, moving pivot; grey: rigid rod", "[m]", TIME)
    path.set_ylim(-3.8, 3.0)
    path.legend(fontsize=SMALL, frameon=False, loc="lower left", ncols=2)
    for low, high in ((0.05, 0.9), (1.1, 4.5)):
        ratio = np.linspace(low, high, 200)
        gain.semilogy(ratio, np.abs(1.0 / (1.0 - ratio**2)), color=PALE, linewidth=1.6)
    gain.semilogy(wire.SHARES, [abs(wire.sway_gain(share)[0]) for share in wire.SHARES], "o", color=COLOURS[0])
    finish(gain, "load over pivot motion; grey: linear formula", "[1]", "frequency over the natural one")
    length, mass, height = wire.DROPS[1]
    bare = wire.WIRE._replace(damping_ratio=0.0)
    for name, rope, colour in (("no damping", bare, COLOURS[0]), ("damped, 0.5", wire.WIRE, COLOURS[1])):
        states = wire.falls(height, length, mass, rope, 0.001, 0.7)
        reach = np.linalg.norm(states[:, :3] - wire.FIXED[:3], axis=1)
        tension = wire.stiffness_at(length) * np.maximum(0.0, reach - length)
        snap.plot(0.001 * np.arange(len(states)), tension / 1e3, color=colour, linewidth=1.1, label=name)
    snap.axhline(wire.snap_tension(height, length, mass) / 1e3, color=INK, linewidth=0.8, linestyle="--")
    finish(snap, f"{mass / 1e3:g} t falls {height:g} m: elastic pull", "[kN]", TIME)
    snap.legend(fontsize=SMALL, frameon=False, loc="upper right", bbox_to_anchor=(1.0, 0.93))
    return figure


def splash(found: Transit) -> Figure:
    """Draw the terms of the force on the way down."""
    figure = blank("A box of 4 m by 3 m by 2 m lowered at 0.5 m/s", 4.6)
    forces, mass = figure.subplots(1, 2, width_ratios=(3, 2))
    forces.plot(found.depth, found.force / 1e3, color=INK, linewidth=1.4, label="kernel")
    every = slice(None, None, 10)
    forces.plot(found.depth[every], found.by_hand[every] / 1e3, "o", color=COLOURS[1], markersize=3.5, label="by hand")
    for name, values, colour in (
        ("buoyancy", found.buoyancy, COLOURS[0]),
        ("slamming", found.slamming, COLOURS[2]),
        ("drag", found.drag, COLOURS[3]),
    ):
        forces.plot(found.depth, values / 1e3, color=colour, linewidth=1.0, linestyle="--", label=name)
    finish(forces, "force up", "[kN]", "depth of the bottom [m]")
    mass.plot(found.depth, found.added_mass / 1e3, color=INK, linewidth=1.4)
    mass.plot(found.depth[every], found.added_by_hand[every] / 1e3, "o", color=COLOURS[1], markersize=3.5)
    finish(mass, "added mass", "[t]", "depth of the bottom [m]")
    legend_below(figure, forces)
    return figure


def servo(found: Mapping[str, Mapping[str, Mapping[float, Response]]]) -> Figure:
    """Draw the rates of all joints of each crane, a row for each."""
    widest = max(len(joints) for joints in found.values())
    figure = blank("Velocity servos, full load: rate over the commanded one", 6.0)
    rows = figure.subplots(len(found), widest, squeeze=False, sharey=True)
    for row, (crane, joints) in zip(rows, found.items(), strict=True):
        for axes in row[len(joints) :]:
            axes.set_visible(False)
        for axes, (joint, runs) in zip(row, joints.items(), strict=False):
            for (roll, run), colour in zip(reversed(list(runs.items())), (COLOURS[1], COLOURS[0]), strict=True):
                name = f"roll {roll:g} deg" if roll else "level ship"
                axes.plot(run.time_s, run.rate, color=colour, linewidth=0.9, label=name)
            axes.plot([0.0, GO_S, GO_S, STOP_S, STOP_S, run.time_s[-1]], [0, 0, 1, 1, 0, 0], color=PALE, linewidth=0.7)
            finish(axes, f"{crane}: {joint}", "", TIME)
            axes.set_xlim(GO_S - 4.0, run.time_s[-1])
    legend_below(figure, rows[0][0])
    return figure


def abuse(found: Trace, crane: Machine) -> Figure:
    """Draw actuator lengths between their ends and the paid-out length."""
    figure, all_axes = grid("Random commands: actuators between their ends, and the wire", rows=2)
    drives = crane.limits.drives
    for i, (axes, name) in enumerate(zip(all_axes, crane.names, strict=False)):
        axes.plot(found.time_s, found.lengths[:, i], color=COLOURS[0], linewidth=0.8)
        for end in (drives.length_min[i], drives.length_max[i]):
            if np.isfinite(end):
                axes.axhline(end, color=COLOURS[1], linewidth=0.8, linestyle="--")
                axes.set_ylim(0.9 * drives.length_min[i], 1.05 * drives.length_max[i])
        finish(axes, name, "[m]" if np.isfinite(drives.length_max[i]) else "[rad]", TIME)
    axes = all_axes[len(crane.names)]
    axes.plot(found.time_s, found.wire, color=COLOURS[0], linewidth=0.8)
    axes.axhline(crane.scenario.winch.length_min_m, color=COLOURS[1], linewidth=0.8, linestyle="--")
    finish(axes, "wire paid out", "[m]", TIME)
    for axes in all_axes[len(crane.names) + 1 :]:
        axes.set_visible(False)
    return figure


def heave(with_it: control.Hang, without: control.Hang, name: str) -> Figure:
    """Draw spectra of tip and load, and what is left."""
    figure = blank(f"Heave compensation in E2, {name} of wire", 4.4)
    spectrum, ratio = figure.subplots(1, 2)
    hz, tip, load, follows = control.heave_spectra(with_it)
    inside = (hz > 0.0) & (hz <= 0.4)
    spectrum.semilogy(hz[inside], tip[inside], color=COLOURS[0], linewidth=1.2, label="tip")
    free = control.heave_spectra(without)[2]
    spectrum.semilogy(hz[inside], free[inside], color=PALE, linewidth=1.0, linestyle="--", label="load, uncompensated")
    spectrum.semilogy(hz[inside], load[inside], color=COLOURS[1], linewidth=1.2, label="load, compensated")
    spectrum.axvspan(*control.BAND_HZ, color=PALE, alpha=0.15, linewidth=0.0)
    finish(spectrum, "heave", "[m²/Hz]", "frequency [Hz]")
    loud = (hz <= control.BAND_HZ[1] + 1e-9) & (tip >= control.POWER_SHARE * tip.max())
    ratio.plot(hz[loud], follows[loud], "o-", color=COLOURS[1], linewidth=1.0, markersize=3.5)
    ratio.axhline(control.HEAVE_BAR, color=INK, linewidth=0.8, linestyle="--")
    ratio.set_xlim(0.0, 0.25)
    ratio.set_ylim(0.0, 0.15)
    finish(ratio, "load heave that follows the tip's, over it; bar dashed", "[1]", "frequency [Hz]")
    legend_below(figure, spectrum)
    return figure


def sway(runs: Mapping[str, control.Hang]) -> Figure:
    """Draw the sway and the slewing angle."""
    figure = blank("Anti-sway: a quarter turn with the load on 8 m of wire", 5.0)
    angle, slew = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    for (name, run), colour in zip(reversed(list(runs.items())), (COLOURS[1], COLOURS[0]), strict=True):
        angle.plot(run.time_s, run.sway_deg, color=colour, linewidth=1.0, label=f"{name} anti-sway")
        slew.plot(run.time_s, np.rad2deg(run.slew), color=colour, linewidth=1.0)
        stopped = run.scenario.operations[0].to_s + control.STOPPED_S
    angle.axvline(stopped, color=PALE, linewidth=0.8, linestyle="--")
    finish(angle, "angle between wire and vertical; judged from the dashed line on", "[deg]", "")
    finish(slew, "slew", "[deg]", TIME)
    legend_below(figure, angle)
    return figure
