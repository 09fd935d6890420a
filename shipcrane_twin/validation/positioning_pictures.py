"""Pictures of the page on dynamic positioning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from shipcrane_twin.control.loop import OMEGA, LoopReport
from shipcrane_twin.hydro.figure_style import COLOURS, INK, PALE, SMALL, blank, finish, grid, legend_below
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.validation.positioning import AXES, Ride, off_setpoint, slow
from shipcrane_twin.validation.positioning_faults import AWAY, FAULT_S
from shipcrane_twin.validation.positioning_moves import azimuth_rates
from shipcrane_twin.validation.positioning_station import BAND_HZ, BIAS_HZ, observer_error, spectra, true_bias

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TIME = "time [s]"
LOADS = (("surge", "[kN]"), ("sway", "[kN]"), ("yaw", "[kN m]"))


def over_time(axes: Axes, runs: Mapping[str, Ride], which: int) -> None:
    """Draw distance (0) or heading (1) off the set-point over time, a colour each."""
    for (name, run), colour in zip(runs.items(), COLOURS, strict=False):
        axes.plot(run.time_s, off_setpoint(run)[which], color=colour, linewidth=1.1, label=name)


def station(runs: Mapping[str, Ride]) -> Figure:
    """Draw how the ship is caught and held in each weather."""
    figure = blank("Station keeping: DP on at 50 s (dotted), settled by 200 s (dashed), judged from 250 s on", 6.4)
    position, heading = figure.subplots(2, 1, sharex=True)
    for which, axes in enumerate((position, heading)):
        over_time(axes, runs, which)
        for at, style in ((50.0, ":"), (200.0, "--"), (250.0, "--")):
            axes.axvline(at, color=PALE, linewidth=0.8, linestyle=style)
    finish(position, "CoG off the set-point", "[m]", "")
    position.set_yscale("symlog", linthresh=1.0, linscale=1.2)
    position.set_ylim(0.0, 60.0)
    position.set_yticks([0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0], ["0", "0.5", "1", "2", "5", "10", "20", "50"])
    finish(heading, "heading off the set-point, clockwise", "[deg]", TIME)
    legend_below(figure, position)
    return figure


def wave_spectra(pairs: Mapping[str, tuple[Ride, Ride]]) -> Figure:
    """Draw the spectra of the demand with and without wave filter, a row for each weather."""
    figure, all_axes = grid("Demand of DP: with wave filter and without it; shaded: the waves' frequencies", len(pairs))
    for row, (weather, runs) in enumerate(pairs.items()):
        for i, axes in enumerate(all_axes[3 * row : 3 * row + 3]):
            for run, name, colour in zip(runs, ("with filter", "without"), COLOURS, strict=False):
                hz, density = spectra(run, run.demand / 1e3)
                axes.semilogy(hz[1:], density[1:, i], color=colour, linewidth=1.2, label=name)
            axes.axvspan(*BAND_HZ, color=PALE, alpha=0.15, linewidth=0.0)
            unit = "[(kN m)²/Hz]" if i == 2 else "[kN²/Hz]"
            finish(axes, f"{weather}: {AXES[i]}", unit, "frequency [Hz]")
            axes.set_xlim(0.0, 0.4)
    legend_below(figure, all_axes[0])
    return figure


def observer(run: Ride) -> Figure:
    """Draw the observer's position error and its bias beside the true load."""
    figure, all_axes = grid("Observer in E1: errors of position and heading; estimated bias and true slow load")
    error = observer_error(run) * [1.0, 1.0, -180.0 / np.pi]
    titles = (("east", "[m]"), ("north", "[m]"), ("heading", "[deg]"))
    for i, (axes, (name, unit)) in enumerate(zip(all_axes[:3], titles, strict=True)):
        axes.plot(run.time_s, error[:, i], color=COLOURS[0], linewidth=0.9)
        finish(axes, f"{name}: estimate minus slow truth", unit, "")
    truth, estimate = true_bias(run) / 1e3, run.bias / 1e3
    for i, (axes, (name, unit)) in enumerate(zip(all_axes[3:], LOADS, strict=True)):
        axes.plot(run.time_s, estimate[:, i], color=COLOURS[0], linewidth=1.0, label="bias estimate")
        axes.plot(run.time_s, truth[:, i], color=COLOURS[1], linewidth=1.4, label=f"true load below {BIAS_HZ:g} Hz")
        axes.axvline(run.scenario.dp.enabled_at_s, color=PALE, linewidth=0.8, linestyle=":")
        finish(axes, name, unit, TIME)
    legend_below(figure, all_axes[3])
    return figure


def box(run: Ride) -> Figure:
    """Draw the track of the box manoeuvre, the headings, and the azimuths' rates."""
    figure = blank("Box manoeuvre in 5 m/s of wind: 10 m by 10 m, 45 degrees of heading on every side", 6.0)
    parts = figure.subplot_mosaic([["track", "heading"], ["track", "rate"]])
    track, heading, rate = parts["track"], parts["heading"], parts["rate"]
    pose, there = slow(run.pose, run.step_s), run.time_s >= run.scenario.dp.setpoints[0].at_s
    track.plot(pose[there, 0], pose[there, 1], color=COLOURS[0], linewidth=1.4, label="CoG, slow motion")
    track.plot(run.reference[there, 0], run.reference[there, 1], color=COLOURS[1], linewidth=1.0, label="reference")
    places = np.unique(np.round(run.setpoint, 6), axis=0)
    track.plot(places[:, 0], places[:, 1], "o", color=INK, markersize=5, label="set-points, bow")
    track.quiver(
        places[:, 0], places[:, 1], np.cos(places[:, 2]), np.sin(places[:, 2]), color=INK, scale=12.0, width=0.006
    )  # fmt: skip
    finish(track, "track", "north [m]", "east [m]")
    track.set_aspect("equal", adjustable="datalim")
    track.legend(fontsize=SMALL, frameon=False, loc="center")
    for values, colour, name in ((pose, COLOURS[0], "ship"), (run.reference, COLOURS[1], "reference")):
        heading.plot(run.time_s, 90.0 - np.rad2deg(np.unwrap(values[:, 2])), color=colour, linewidth=1.2, label=name)
    finish(heading, "heading", "[deg]", "")
    heading.legend(fontsize=SMALL, frameon=False)
    limit = max(t.azimuth_rate_max_deg_s for t in run.scenario.vessel.thrusters if t.azimuthing)
    rate.plot(run.time_s[1:], azimuth_rates(run), color=COLOURS[2], linewidth=0.6)
    rate.axhline(limit, color=INK, linewidth=0.8, linestyle=":")
    finish(rate, "fastest azimuth and its limit", "[deg/s]", TIME)
    return figure


def lift(runs: Mapping[str, Ride]) -> Figure:
    """Draw how far the slewing load takes the ship, with and without feed-forward."""
    figure = blank("5 t at 8 m radius slewed side to side in calm water (shaded), DP on", 5.6)
    position, heading = figure.subplots(2, 1, sharex=True)
    named = {f"{name} feed-forward of the crane's wrench": run for name, run in runs.items()}
    for which, axes in enumerate((position, heading)):
        over_time(axes, named, which)
        for move in next(iter(runs.values())).scenario.operations:
            axes.axvspan(move.from_s, move.to_s, color=PALE, alpha=0.15, linewidth=0.0)
        axes.set_xlim(150.0, None)
    finish(position, "CoG off the set-point", "[m]", "")
    finish(heading, "heading off the set-point, clockwise", "[deg]", TIME)
    legend_below(figure, position)
    return figure


def faults(runs: Mapping[str, Ride]) -> Figure:
    """Draw excursions after faults: those that end near the set-point, and those that drift away."""
    figure = blank(f"Faults in E2 at {FAULT_S:.0f} s (dotted)", 4.4)
    for axes, inside in zip(figure.subplots(1, 2), (True, False), strict=True):
        for (name, run), colour in zip(runs.items(), (*COLOURS, INK), strict=False):
            if (name not in AWAY) == inside:
                rows = run.time_s >= FAULT_S - 30.0
                axes.plot(run.time_s[rows], off_setpoint(run)[0][rows], color=colour, linewidth=1.2, label=name)
        axes.axvline(FAULT_S, color=PALE, linewidth=0.8, linestyle=":")
        finish(axes, "held" if inside else "drifts away", "CoG off the set-point [m]", TIME)
        axes.legend(fontsize=SMALL, frameon=False, loc="upper left")
    return figure


def loop(bare: LoopReport, filtered: LoopReport, wave_omega: float) -> Figure:
    """Draw gain and phase of each axis' open loop, without observer (thin) and with it."""
    figure, all_axes = grid("Open loop of each axis, without observer (dashed) and with it; dotted: the waves")
    for i in range(3):
        gain, phase = all_axes[i], all_axes[3 + i]
        for report, style, colour in ((bare, "--", PALE), (filtered, "-", COLOURS[i])):
            gain.semilogx(OMEGA, decibel(report.loop[i]), style, color=colour, linewidth=1.2)
            turned = np.rad2deg(np.unwrap(np.angle(report.loop[i])))
            turned -= 360.0 * np.round((turned[0] + 270.0) / 360.0)
            phase.semilogx(OMEGA, turned, style, color=colour, linewidth=1.2)
        for axes in (gain, phase):
            axes.axvline(wave_omega, color=PALE, linewidth=0.8, linestyle=":")
            axes.set_xlim(0.005, 3.0)
        finish(gain, f"{AXES[i]}: gain", "[dB]", "")
        gain.set_ylim(-60.0, 60.0)
        finish(phase, f"{AXES[i]}: phase", "[deg]", "frequency [rad/s]")
        phase.axhline(-180.0, color=INK, linewidth=0.6)
        phase.set_ylim(-400.0, -60.0)
    return figure


def decibel(values: Array) -> Array:
    """Return amplitudes in dB."""
    return np.asarray(20.0 * np.log10(np.abs(values)))
