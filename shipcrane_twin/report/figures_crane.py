"""Figures of the crane, the wire and the load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from shipcrane_twin.record.read import Signals
from shipcrane_twin.report import style
from shipcrane_twin.report.motions import north_east_down, payload_offset, sway_angle_deg
from shipcrane_twin.report.style import Plot
from shipcrane_twin.report.summary import wire_tension_kn

_JOINTS = {
    "slew": ("slew, positive\nto port [deg]", style.BLUE),
    "boom": ("main boom,\npositive up [deg]", style.VERMILLION),
    "knuckle": ("knuckle boom,\npositive up [deg]", style.GREEN),
    "telescope": ("telescope,\npositive out [m]", style.PURPLE),
}
_COLORS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE)


def _kinds(scenario: Mapping[str, Any]) -> dict[str, str]:
    """Return the kind of every joint of the scenario's crane, base to tip; the usual crane's where none is told."""
    links = scenario.get("crane", {}).get("links") or ()
    usual = {name: "prismatic" if name == "telescope" else "revolute" for name in _JOINTS}
    return {link["joint"]: link["kind"] for link in links} or usual


def _label(name: str, kind: str, place: int) -> tuple[str, str]:
    """Return label of the axis and colour of a joint."""
    unit = "m" if kind == "prismatic" else "deg"
    return _JOINTS.get(name, (f"{name} [{unit}]", _COLORS[place % len(_COLORS)]))


def joints(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Joint positions of the crane with the operations; the paper's figure 9."""
    states = signals.joints.get("/crane/joint_states")
    kinds = _kinds(scenario)
    shown = [name for name in kinds if states is not None and name in states.names]
    if states is None or not shown:
        return None
    figure, grid = style.time_axes(len(shown), height_in=1.7)
    moved = []
    for (axes,), name in zip(grid, shown, strict=True):
        label, color = _label(name, kinds[name], shown.index(name))
        position = states.position[:, states.names.index(name)]
        values, unit = (position, "m") if kinds[name] == "prismatic" else (np.rad2deg(position), "deg")
        style.line(axes, states.time_s, values, color, linewidth=1.6)
        style.finish(axes, label, 0.5 if unit == "m" else 5.0)
        change = float(np.ptp(values))
        if change > (0.01 if unit == "m" else 0.5):
            moved.append(f"{name} by {change:.2f} m" if unit == "m" else f"{name} by {change:.1f} deg")
    style.mark_operations([[row[0] for row in grid]], style.operations_of(scenario))
    caption = f"The operations move {', '.join(moved)}." if moved else "No joint moves in this run."
    return Plot("joints", "Crane joints", caption, figure)


def positions(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Crane tip and payload in north, east, down, and their difference; the paper's figure 11."""
    tip, payload = signals.series.get("/crane/tip"), signals.series.get("/payload/odom")
    if tip is None or payload is None or not len(tip.values) or not len(payload.values):
        return None
    time_s, offset = payload_offset(tip, payload)
    if not len(time_s):
        return None
    figure, grid = style.time_axes(3, 2)
    tip_ned, payload_ned = north_east_down(tip), north_east_down(payload)
    for k, axis in enumerate(("north", "east", "down")):
        both, apart = grid[k]
        style.line(both, tip.time_s, tip_ned[:, k], style.BLUE, "tip", linewidth=2.2)
        style.line(both, payload.time_s, payload_ned[:, k], style.ORANGE, "payload", linestyle=(0, (4, 2)))
        style.finish(both, f"{axis} [m]", 0.5)
        style.line(apart, time_s, offset[:, k], style.GREEN, linewidth=0.7)
        style.finish(apart, f"payload - tip,\n{axis} [m]", 0.02)
    for axes in grid[2]:
        axes.invert_yaxis()  # deeper is lower on the page
    grid[0][0].legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.06), ncols=2, fontsize=style.SMALL, frameon=False
    )
    style.mark_operations([[row[k] for row in grid] for k in (0, 1)], style.operations_of(scenario))
    apart_m = float(np.hypot(offset[:, 0], offset[:, 1]).max())
    angle = float(sway_angle_deg(offset).max())
    seen = "nearly coincide" if apart_m <= 0.5 else "part"
    caption = (
        f"Tip and payload {seen} in north and east: at most {apart_m:.2f} m apart, the wire up to "
        f"{angle:.1f} deg from the vertical (the axes of down point downwards)."
    )
    return Plot("tip_payload", "Crane tip and payload", caption, figure)


def wire(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Wire tension and paid-out length."""
    tension = wire_tension_kn(signals)
    if tension is None:
        return None
    winch = signals.joints.get("/winch/joint_states")
    if winch is not None and not winch.names:
        winch = None
    figure, grid = style.time_axes(2 if winch is not None else 1)
    style.line(grid[0][0], *tension, style.BLUE)
    style.finish(grid[0][0], "wire tension [kN]", 0.5)
    grid[0][0].set_ylim(bottom=min(0.0, grid[0][0].get_ylim()[0]))
    if winch is not None:
        style.line(grid[1][0], winch.time_s, winch.position[:, 0], style.PURPLE, linewidth=1.6)
        style.finish(grid[1][0], "paid-out length,\nunstretched [m]", 0.5)
    style.mark_operations([[row[0] for row in grid]], style.operations_of(scenario))
    values = tension[1]
    caption = f"The wire carries {np.median(values):.2f} kN (median), {values.max():.2f} kN at the most."
    slack_s = float(np.count_nonzero(values <= 0.0)) / len(values) * float(tension[0][-1] - tension[0][0])
    if slack_s > 0.0:
        caption = caption[:-1] + f"; it is slack for {slack_s:.1f} s."
    return Plot("wire", "Wire", caption, figure)


def base_wrench(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Force and moment of the crane on the ship at the crane's foot."""
    wrench = signals.series.get("/crane/base_wrench")
    if wrench is None or not len(wrench.values):
        return None
    kilo = wrench.values / 1000.0
    figure, grid = style.time_axes(3)
    across, upright, moment = (row[0] for row in grid)
    for k, color, label in ((0, style.BLUE, "X forward"), (1, style.VERMILLION, "Y to port")):
        style.line(across, wrench.time_s, kilo[:, k], color, label)
    style.line(upright, wrench.time_s, kilo[:, 2], style.GREEN)
    turns = (
        (3, style.BLUE, "K starboard down"),
        (4, style.VERMILLION, "M bow down"),
        (5, style.GREEN, "N bow to port"),
    )
    for k, color, label in turns:
        style.line(moment, wrench.time_s, kilo[:, k], color, label)
    style.finish(across, "force along\nthe deck [kN]", 1.0)
    style.finish(upright, "force, positive\nup [kN]", 1.0)
    style.finish(moment, "moment at the\ncrane base [kN m]", 5.0)
    for axes in (across, moment):
        style.legend(axes)
    style.mark_operations([[across, upright, moment]], style.operations_of(scenario))
    caption = (
        f"The crane and its load press on the deck with {-kilo[:, 2].mean():.1f} kN on average and "
        f"heel it with {kilo[:, 3].min():.0f} to {kilo[:, 3].max():.0f} kN m (positive starboard down)."
    )
    return Plot("base_wrench", "Load of the crane on the ship", caption, figure)
