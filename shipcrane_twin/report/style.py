"""How figures look: colours, axes over time, shaded operations, decimation. Figure objects, no pyplot."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from shipcrane_twin.report.motions import Array

# Okabe and Ito 2008: told apart with any colour vision; the order is the order of use.
BLUE, VERMILLION, GREEN = "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE = "#CC79A7", "#E69F00"
INK, SHADE, GRID = "#222222", "#8093A8", "#D8D8D8"
FONT = 10  # points; nothing is set smaller than SMALL
SMALL = 9
WIDTH_IN = 10.0
POINTS_MAX = 4000


@dataclass(frozen=True, slots=True)
class Plot:
    """A finished figure: file name without suffix, heading, one sentence that says what to see."""

    name: str
    title: str
    caption: str
    figure: Figure


@dataclass(frozen=True, slots=True)
class Operation:
    """A step of the lift on the time axis; `to_s` equals `from_s` for a single event."""

    tag: str
    label: str
    from_s: float
    to_s: float


def operations_of(scenario: Mapping[str, Any]) -> list[Operation]:
    """Return the scenario's operations and events in order of time.

    A label that begins with a number ("3 lower") keeps it as its tag, others are counted; moves with the same
    label share one tag.
    """
    entries = [*(scenario.get("operations") or ()), *(scenario.get("events") or ())]
    found: list[Operation] = []
    tags: dict[str, str] = {}
    for entry in sorted(entries, key=lambda entry: (_start(entry), _end(entry))):
        name = entry.get("label") or entry.get("event") or entry.get("joint") or "operation"
        text = str(name).replace("_", " ")
        numbered = re.match(r"(\d+)[.):\s]+(.+)", text)
        tag = tags.setdefault(text, numbered[1] if numbered else str(len(tags) + 1))
        found.append(Operation(tag, numbered[2] if numbered else text, _start(entry), _end(entry)))
    return found


def _start(entry: Mapping[str, Any]) -> float:
    return float(entry["at_s"] if "at_s" in entry else entry["from_s"])


def _end(entry: Mapping[str, Any]) -> float:
    return float(entry.get("to_s", _start(entry)))


def decimate(time_s: Array, values: Array, limit: int = POINTS_MAX) -> tuple[Array, Array]:
    """Return at most `limit` points of a line that keep its ends and every peak as high as it is.

    Each of limit/2 - 1 slices of equal count keeps its lowest and its highest point.

    Parameters
    ----------
    time_s, values : float64, shape (n,)
    limit : int
        Even, at least 4.
    """
    count = len(time_s)
    if count <= limit:
        return time_s, values
    edges = np.linspace(0, count, limit // 2, dtype=np.intp)
    keep = {0, count - 1}
    for start, end in pairwise(edges.tolist()):
        part = values[start:end]
        keep.update((start + int(part.argmin()), start + int(part.argmax())))
    rows: NDArray[np.intp] = np.array(sorted(keep), dtype=np.intp)
    return time_s[rows], values[rows]


def time_axes(rows: int, columns: int = 1, height_in: float = 2.0) -> tuple[Figure, list[list[Axes]]]:
    """Return a figure with a grid of axes that share the time axis."""
    figure = Figure(figsize=(WIDTH_IN, height_in * rows + 0.9), layout=ConstrainedLayoutEngine(wspace=0.06))
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False)
    figure.align_ylabels()
    return figure, [list(row) for row in grid]


def line(axes: Axes, time_s: Array, values: Array, color: str, label: str = "", **style: Any) -> None:
    """Draw one decimated line."""
    axes.plot(*decimate(time_s, values), color=color, label=label, **({"linewidth": 1.2} | style))


def finish(axes: Axes, label: str, span: float) -> None:
    """Give axes label, grid and fonts, and a y range of at least `span`: little shall look like little."""
    low, high = axes.get_ylim()
    if high - low < span:
        axes.set_ylim((low + high - span) / 2, (low + high + span) / 2)
    axes.set_ylabel(label, fontsize=FONT, color=INK)
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.margins(x=0.0)
    axes.spines[["top", "right"]].set_visible(False)


def legend(axes: Axes) -> None:
    """Put the legend beside the axes, where it hides nothing."""
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=SMALL, frameon=False, handlelength=1.6)


def mark_operations(columns: Sequence[Sequence[Axes]], operations: Sequence[Operation]) -> None:
    """Shade the operations in stacks of axes (top to bottom), tag them on top and explain the tags below.

    A run that ended early shows only what it reached. Call this after all lines are drawn.
    """
    start, end = columns[0][0].get_xlim()
    reached = [replace(move, to_s=min(move.to_s, end)) for move in operations if start <= move.from_s < end]
    for stack in columns:
        for axes in stack:
            for move in reached:
                if move.to_s > move.from_s:
                    axes.axvspan(move.from_s, move.to_s, color=SHADE, alpha=0.18, linewidth=0, zorder=0)
                else:
                    axes.axvline(move.from_s, color=INK, linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
        for middle, tag in _tags(reached, apart_s=0.025 * (end - start)):
            _note(stack[0], middle, tag, fontweight="bold")
        stack[-1].set_xlabel("time [s]", fontsize=FONT, color=INK)
    if reached:
        words = {f"{move.tag}\u00a0{move.label.replace(' ', chr(0xA0))}" for move in reached}
        key = "\n".join(textwrap.wrap("   ".join(sorted(words, key=_natural)), 120))
        columns[0][0].figure.supxlabel(key, fontsize=SMALL, color=INK)


def _tags(operations: Sequence[Operation], apart_s: float) -> list[tuple[float, str]]:
    """Return where to write which tags [s]; those that would overprint each other become one, as in "1+2"."""
    placed: list[tuple[float, list[str]]] = []
    for middle, tag in sorted(((move.from_s + move.to_s) / 2, move.tag) for move in operations):
        if placed and middle - placed[-1][0] < apart_s:
            if tag not in placed[-1][1]:
                placed[-1][1].append(tag)
        else:
            placed.append((middle, [tag]))
    return [(middle, "+".join(tags)) for middle, tags in placed]


def _note(axes: Axes, time_s: float, text: str, **style: Any) -> None:
    """Write a short text above the axes at a time [s]."""
    axes.annotate(
        text, (time_s, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2), textcoords="offset points",
        ha="center", va="bottom", fontsize=SMALL, color=INK, **style,
    )  # fmt: skip


def _natural(text: str) -> tuple[int, str]:
    number = re.match(r"\d+", text)
    return (int(number[0]) if number else 0, text)


def mark_times(axes: Axes, times: Mapping[str, float]) -> None:
    """Draw labelled upright lines at the given times [s] that lie within the axes."""
    end = axes.get_xlim()[1]
    for label, time_s in times.items():
        if 0.0 < time_s < end:
            axes.axvline(time_s, color=INK, linewidth=1.0, linestyle="--")
            _note(axes, time_s, label)
