"""How pictures of a database look: colours, axes, legends. Figure objects, no pyplot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito 2008, as in report.style, which stands above this package.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")
INK, PALE, GRID = "#222222", "#707070", "#D8D8D8"
FONT, SMALL, TINY, DPI = 10, 9, 8, 130
PERIODS_S = (2, 3, 4, 5, 6, 8, 10, 15, 30)
CROWDED_S = (8, 15, 30)
"""Left out on axes that go beyond 3 rad/s."""


def blank(title: str, height_in: float) -> Figure:
    """Return a figure with a title and no axes yet."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(11.0, height_in), layout=ConstrainedLayoutEngine(wspace=0.05, hspace=0.05))
    figure.suptitle(title, fontsize=FONT + 2, color=INK)
    return figure


def grid(title: str, rows: int = 2) -> tuple[Figure, list[Axes]]:
    """Return a figure with rows of three axes."""
    figure = blank(title, 3.1 * rows + 0.9)
    return figure, list(figure.subplots(rows, 3, squeeze=False).ravel())


def finish(axes: Axes, title: str, y_label: str, x_label: str, *, to: float | None = None) -> None:
    """Label axes; frequency axes end at `to` [rad/s] and have the period on top."""
    axes.set_title(title, fontsize=FONT, color=INK, loc="left")
    axes.set_xlabel(x_label, fontsize=SMALL, color=INK)
    axes.set_ylabel(y_label, fontsize=SMALL, color=INK)
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["right"]].set_visible(False)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    if to is None:
        axes.spines[["top"]].set_visible(False)
        return
    axes.set_xlim(0.0, to)
    top = axes.secondary_xaxis("top")
    crowded = CROWDED_S if to > 3.0 else ()
    marks = [period for period in PERIODS_S if 2.0 * np.pi / period <= to and period not in crowded]
    top.set_xticks([2.0 * np.pi / period for period in marks], [f"{period}" for period in marks])
    top.tick_params(labelsize=TINY, colors=PALE, length=2)
    top.set_xlabel("period [s]", fontsize=TINY, color=PALE, labelpad=2)


def legend_below(figure: Figure, axes: Axes, title: str | None = None) -> None:
    """Put the legend of one of the axes below all of them."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=len(labels), fontsize=SMALL, frameon=False,
        title=title, title_fontsize=SMALL,
    )  # fmt: skip
