"""All figures of a report, in the order in which one reads them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from io import BytesIO
from typing import Any

from matplotlib.figure import Figure

from shipcrane_twin.record.read import Signals
from shipcrane_twin.report import figures_crane, figures_sea, figures_ship
from shipcrane_twin.report.style import Plot

DPI = 130
_MAKERS: tuple[Callable[[Signals, Mapping[str, Any]], Plot | None], ...] = (
    figures_ship.motions,
    figures_crane.joints,
    figures_crane.positions,
    figures_crane.wire,
    figures_crane.base_wrench,
    figures_ship.track,
    figures_ship.environment,
    figures_sea.sea,
)


def make_figures(signals: Signals, scenario: Mapping[str, Any]) -> list[Plot]:
    """Draw every figure for which the bag has the data.

    Parameters
    ----------
    signals : Signals
        The bag.
    scenario : mapping
        Resolved scenario: vessel, dp, operations and events.
    """
    plots = (make(signals, scenario) for make in _MAKERS)
    return [plot for plot in plots if plot is not None]


def png_bytes(figure: Figure) -> bytes:
    """Return the figure as PNG; equal figures give equal bytes."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()
