"""Pictures of the validation page: motions and drift of both ways, spectrum and crests of the realised sea."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from shipcrane_twin.hydro.compare import MODES
from shipcrane_twin.hydro.database import Complex, HydroDatabase
from shipcrane_twin.hydro.figure_style import COLOURS, DPI, INK, PALE, SMALL, blank, finish, grid, legend_below
from shipcrane_twin.validation import sea
from shipcrane_twin.validation.drift import NAMES, Drift
from shipcrane_twin.validation.motions import Motions

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOWARD = "direction the wave goes to [deg]"
MARK = 4.5


def save(figure: Figure, folder: Path, name: str, page: str = "validation") -> Path:
    """Write a figure of a page as PNG and return where it is."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{page}_{name}.png"
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def nearest(data: HydroDatabase, omega: float) -> int:
    """Return the row of a frequency in the database's tables."""
    return int(np.argmin(np.abs(data.omega - omega)))


def directions(axes: Axes) -> None:
    """Mark a direction axis from following to head sea."""
    axes.set_xlim(-3.0, 183.0)
    axes.set_xticks(range(0, 181, 30))


def regular_waves(motions: Motions, linear: Complex, data: HydroDatabase) -> Figure:
    """Draw motions over direction: dots of the time domain, lines of the frequency domain (linear, (n, m, 6))."""
    figure, all_axes = grid("Motions in regular waves: frequency domain (lines), run's own kernels in time (dots)")
    angle = np.rad2deg(motions.direction)
    for mode, axes in enumerate(all_axes):
        unit = 1.0 if mode < 3 else 180.0 / np.pi
        for row, (omega, colour) in enumerate(zip(motions.omega, COLOURS, strict=False)):
            line = unit * np.abs(linear[nearest(data, omega), :, mode])
            dots = unit * np.abs(motions.time_domain[row, :, mode])
            axes.plot(np.rad2deg(data.direction), line, color=colour, linewidth=1.2, label=f"{omega:.3g} rad/s")
            axes.plot(angle, dots, "o", color=colour, markersize=MARK)
        finish(axes, MODES[mode], "[m/m]" if mode < 3 else "[deg/m]", TOWARD)
        directions(axes)
    legend_below(figure, all_axes[0])
    return figure


def held_drift(drift: Drift, data: HydroDatabase) -> Figure:
    """Draw mean loads over direction: lines of the transfer function, dots of the held ship."""
    figure, all_axes = grid("Mean drift load: transfer function (lines), what holds the ship (dots)", rows=1)
    angle = np.rad2deg(drift.direction)
    drawn = list(range(1, len(drift.omega), 2)) or [0]
    for k, axes in enumerate(all_axes):
        for row, colour in zip(drawn, COLOURS, strict=False):
            omega, dots = drift.omega[row], drift.measured[row, :, k] / 1e3
            line = data.drift[nearest(data, omega), :, k] / 1e3
            axes.plot(np.rad2deg(data.direction), line, color=colour, linewidth=1.2, label=f"{omega:.3g} rad/s")
            axes.plot(angle, dots, "o", color=colour, markersize=MARK)
        finish(axes, NAMES[k], "[kN/m²]" if k < 2 else "[kN m/m²]", TOWARD)
        directions(axes)
    legend_below(figure, all_axes[0])
    return figure


def elevation_spectrum(seeds: range) -> Figure:
    """Draw the spectrum, its estimate from one record, and the mean of many."""
    figure = blank(f"Realised elevation: spectrum of {len(seeds)} seas, five minutes each", 4.6)
    axes = figure.subplots()
    found = sea.ordinates(seeds)
    omega = 2.0 * np.pi / (sea.RECORD_STEP_S * sea.RECORD_COUNT) * sea.LINES
    scale = sea.RECORD_STEP_S / (np.pi * (sea.WINDOW**2).sum())
    inside = sea.OMEGA < 1.1 * omega[-1]
    axes.plot(sea.OMEGA[inside], sea.DENSITY[inside], color=INK, linewidth=1.2, label="JONSWAP, Hs 2 m, Tp 8 s")
    expected = scale * sea.expected_ordinates(sea.DENSITY)
    axes.plot(omega, expected, color=COLOURS[0], linewidth=1.2, label="as the window sees it")
    axes.plot(omega, scale * found.mean(axis=0), "o", color=COLOURS[1], markersize=MARK, label="mean of the records")
    axes.plot(omega, scale * found[0], "x", color=PALE, markersize=MARK, label="one record")
    finish(axes, "", "[m² s]", "frequency [rad/s]")
    axes.legend(fontsize=SMALL, frameon=False)
    return figure


def crest_exceedance(seeds: range) -> Figure:
    """Draw the share of crests above a level, of each sea and by Rayleigh's law."""
    figure = blank(f"Crests of three hours, {len(seeds)} seas (thin) against Rayleigh's law and its 95 % band", 4.6)
    axes = figure.subplots()
    level = np.linspace(0.0, 4.0, 81)
    law = np.exp(-0.5 * level**2)
    count = 0
    for seed in seeds:
        found = sea.three_hour_crests(seed)
        count = len(found)
        share = (found[:, None] > level).mean(axis=0)
        axes.semilogy(level, np.where(share > 0.0, share, np.nan), color=PALE, linewidth=0.5, alpha=0.6)
    low, high = stats.binom.interval(0.95, count, law)
    axes.fill_between(level, np.maximum(low, 0.3) / count, high / count, color=COLOURS[0], alpha=0.2, linewidth=0.0)
    axes.semilogy(level, law, color=COLOURS[0], linewidth=1.6)
    finish(axes, "", "share of crests above", "crest height [standard deviations]")
    for judged in sea.CREST_LEVELS:
        axes.axvline(judged, color=INK, linewidth=0.7, linestyle=":")
    axes.set_ylim(0.3 / count, 1.3)
    axes.set_xlim(0.0, 4.0)
    return figure
