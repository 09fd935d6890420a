"""Picture of load chart, telescope, end stop and failures of power."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from shipcrane_twin.hydro.figure_style import COLOURS, INK, PALE, SMALL, finish, grid
from shipcrane_twin.validation.lifting import Machine
from shipcrane_twin.validation.lifting_structure import FAIL_S, OVERLOAD_KG, Motion, Overload, Telescope

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TIME = "time [s]"


def structure(
    crane: Machine, chart: Overload, beam: Telescope, end: Motion, failed: Mapping[str, Motion]
) -> Figure:
    """Draw what the section on load chart, telescope, end stop and failures tells."""
    figure, axes = grid("Load chart, telescope, end stop, failures of power")
    radius, load = chart.chart.T
    axes[0].plot(radius, load / 1e3, color=INK, linewidth=1.4, label="safe working load")
    for share, style in ((0.9, ":"), (1.1, "--")):
        axes[0].plot(radius, share * load / 1e3, color=PALE, linewidth=0.9, linestyle=style, label=f"{share:.0%} of it")
    told = [OVERLOAD_KG / 1e3] * 2
    way = [chart.radius[0], chart.radius[-1]]
    axes[0].plot(way, told, "o-", color=COLOURS[1], markersize=4, label="the load's way")
    finish(axes[0], "load chart", "[t]", "radius [m]")
    axes[0].set_ylim(0.0, 9.0)
    axes[0].legend(fontsize=SMALL, frameon=False, loc="lower left")

    axes[1].plot(chart.time_s, 100.0 * chart.utilisation, color=COLOURS[0], linewidth=1.1)
    for level in (90.0, 110.0):
        axes[1].axhline(level, color=PALE, linewidth=0.8, linestyle="--")
    axes[1].set_ylim(80.0, 115.0)
    finish(axes[1], "utilisation, the load on its way out", "[%]", TIME)

    axes[2].plot(beam.extension, beam.by_hand, color=PALE, linewidth=3.0, label="segments with hard stops")
    axes[2].plot(beam.extension, beam.centre, color=COLOURS[0], linewidth=1.1, label="centre of gravity")
    finish(axes[2], "telescope of eight segments", "[m]", "extension [m]")
    across = axes[2].twinx()
    across.plot(beam.extension, beam.inertia / 1e3, color=COLOURS[1], linewidth=1.0)
    across.set_ylabel("inertia across it [t m²]", fontsize=SMALL, color=COLOURS[1])
    across.tick_params(labelsize=SMALL, colors=COLOURS[1])
    axes[2].legend(fontsize=SMALL, frameon=False, loc="upper left")

    near = end.time_s >= end.time_s[np.argmax(end.length[:, 1] > crane.limits.drives.length_max[1] - 0.03)]
    axes[3].plot(end.time_s[near], 1e3 * (end.length[near, 1] - crane.limits.drives.length_max[1]), color=COLOURS[0])
    finish(axes[3], "boom cylinder on its way into the end", "[mm]", TIME)
    axes[4].plot(end.time_s[near], 1e3 * end.rate[near, 1], color=COLOURS[0])
    finish(axes[4], "its speed", "[mm/s]", TIME)

    for (name, run), colour in zip(failed.items(), COLOURS, strict=False):
        axes[5].plot(run.time_s, run.length[:, 1], color=colour, linewidth=1.1, label=name)
    axes[5].axvline(FAIL_S, color=PALE, linewidth=0.8, linestyle="--")
    finish(axes[5], "boom cylinder when the power fails", "[m]", TIME)
    axes[5].set_ylim(1.0, 1.9)
    axes[5].legend(fontsize=SMALL, frameon=False)
    return figure
