"""Figures of the ship and what acts on it: motions, position keeping, environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from shipcrane_twin.record.read import Series, Signals
from shipcrane_twin.report import style
from shipcrane_twin.report.motions import Array, ShipMotion, continuous_deg, position_error_m, towards_deg
from shipcrane_twin.report.style import Plot
from shipcrane_twin.report.summary import motion_of, settled_at_s


def motions(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Roll, pitch and heave over time; the paper's figures 8 and 10."""
    motion = motion_of(signals, scenario)
    if motion is None:
        return None
    figure, grid = style.time_axes(3)
    rows = [
        (motion.roll_deg, style.BLUE, "roll, positive\nstarboard down [deg]", 0.2),
        (motion.pitch_deg, style.VERMILLION, "pitch, positive\nbow up [deg]", 0.1),
        (motion.heave_m, style.GREEN, "heave of CoG,\npositive up [m]", 0.02),
    ]
    for (axes,), (values, color, label, span) in zip(grid, rows, strict=True):
        style.line(axes, motion.time_s, values, color)
        style.finish(axes, label, span)
    operations = style.operations_of(scenario)
    style.mark_operations([[row[0] for row in grid]], operations)
    caption = f"Roll ends at {motion.roll_deg[-1]:.2f} deg"
    if operations and operations[0].from_s <= motion.time_s[-1]:
        before = np.searchsorted(motion.time_s, operations[0].from_s)
        caption += f" and was {motion.roll_deg[before]:.2f} deg when the operations began"
    caption += "; it follows the moment of the crane and its load."
    return Plot("motions", "Ship motions", caption, figure)


def track(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Track of the CoG with the set-point, heading and position error over time; the paper's figure 5."""
    motion = motion_of(signals, scenario)
    if motion is None:
        return None
    goal = scenario["dp"]["setpoint"]
    figure = Figure(figsize=(style.WIDTH_IN, 4.6), layout="constrained")
    places = figure.subplot_mosaic("ah;ae", width_ratios=[1.0, 1.25])
    _draw_track(figure, places["a"], motion, goal)

    heading, error = places["h"], places["e"]
    error.sharex(heading)
    wanted = float(goal["heading_deg"])
    style.line(heading, motion.time_s, continuous_deg(motion.heading_deg, wanted), style.BLUE, "ship")
    heading.axhline(wanted, color=style.VERMILLION, linewidth=1.2, linestyle="--", label="set-point")
    style.finish(heading, "heading, clockwise\nfrom north [deg]", 0.2)
    style.legend(heading)
    heading.tick_params(labelbottom=False)

    distance = position_error_m(motion, goal["north_m"], goal["east_m"])
    style.line(error, motion.time_s, distance, style.BLUE)
    error.set_ylim(0.0, max(0.02, 1.05 * float(distance.max())))
    style.finish(error, "distance of CoG from\nset-point [m]", 0.02)
    error.set_xlabel("time [s]", fontsize=style.FONT, color=style.INK)
    times = {"DP on": float(scenario["dp"]["enabled_at_s"]), "settled": settled_at_s(scenario)}
    style.mark_times(error, times)

    settled = distance[motion.time_s >= times["settled"]]
    caption = "The run ends before the position counts as settled."
    if len(settled):
        caption = (
            f"With DP on from {times['DP on']:g} s, the centre of gravity stays within "
            f"{_distance(float(settled.max()))} of the set-point after {times['settled']:g} s."
        )
    return Plot("track", "Position keeping", caption, figure)


def _draw_track(figure: Figure, axes: Axes, motion: ShipMotion, goal: Mapping[str, float]) -> None:
    stride = max(1, len(motion.time_s) // style.POINTS_MAX + 1)
    east, north, time_s = (v[::stride] for v in (motion.east_m, motion.north_m, motion.time_s))
    points = np.column_stack([east, north])
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    lines = LineCollection(list(pieces), cmap="viridis", array=time_s[:-1], linewidths=1.8, capstyle="round")
    axes.add_collection(lines)
    bar = figure.colorbar(lines, ax=axes, location="bottom", shrink=0.9, aspect=35, pad=0.02)
    bar.set_label("time [s]", fontsize=style.FONT, color=style.INK)
    bar.ax.tick_params(labelsize=style.SMALL)
    marks: dict[str, Any] = {"linestyle": "none", "zorder": 4, "clip_on": False}
    star: dict[str, Any] = {"color": style.VERMILLION, "markersize": 15, "markeredgecolor": "white"}
    ring: dict[str, Any] = {
        "markersize": 9,
        "markerfacecolor": "none",
        "markeredgecolor": style.INK,
        "markeredgewidth": 1.5,
    }
    axes.plot(goal["east_m"], goal["north_m"], marker="*", label="set-point", **marks, **star)
    axes.plot(east[0], north[0], marker="o", label="start", **marks, **ring)
    _square(axes, np.append(east, goal["east_m"]), np.append(north, goal["north_m"]))
    axes.set_xlabel("east [m]", fontsize=style.FONT, color=style.INK)
    style.finish(axes, "north [m]", 0.0)
    axes.spines[["top", "right"]].set_visible(True)
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize=style.SMALL, frameon=False)


def _distance(metres: float) -> str:
    return f"{metres:.2f} m" if metres >= 0.1 else f"{1000.0 * metres:.1f} mm"


def _square(axes: Axes, east: Array, north: Array) -> None:
    """Show the same range, at least 2 cm, on both axes with the data in the middle."""
    half = 0.58 * max(float(np.ptp(east)), float(np.ptp(north)), 0.02)
    for limit, values in ((axes.set_xlim, east), (axes.set_ylim, north)):
        middle = (float(values.min()) + float(values.max())) / 2
        limit(middle - half, middle + half)
    axes.set_aspect("equal", adjustable="box")


def environment(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Speed and direction of current and wind; None if both are zero all the time."""
    found: list[tuple[str, Series, Array, str]] = []
    for name, color in (("current", style.BLUE), ("wind", style.VERMILLION)):
        series = signals.series.get(f"/environment/{name}")
        if series is not None and len(series.values):
            speed = np.linalg.norm(series.values[:, :2], axis=1)
            if speed.any():
                found.append((name, series, speed, color))
    if not found:
        return None
    figure, grid = style.time_axes(len(found) + 1)
    for (axes,), (name, series, speed, color) in zip(grid, found, strict=False):
        style.line(axes, series.time_s, speed, color)
        style.finish(axes, f"{name} speed [m/s]", 0.2)
        axes.set_ylim(0.0, 1.15 * float(speed.max()))
    directions = grid[-1][0]
    for name, series, speed, color in found:
        towards = np.where(speed > 0.0, towards_deg(series.values), np.nan)
        directions.plot(*_strided(series.time_s, towards), ".", markersize=3, color=color, label=name)
    style.finish(directions, "direction towards,\nclockwise from north [deg]", 20.0)
    style.legend(directions)
    style.mark_operations([[row[0] for row in grid]], style.operations_of(scenario))
    means = " and ".join(f"{name} {speed.mean():.2f} m/s" for name, _, speed, _ in found)
    caption = f"Mean speeds: {means}; directions say where it flows to."
    return Plot("environment", "Environment", caption, figure)


def _strided(time_s: Array, values: Array) -> tuple[Array, Array]:
    stride = len(time_s) // style.POINTS_MAX + 1
    return time_s[::stride], values[::stride]
