"""The report of one run: one HTML file with everything inside, and the figures as PNG files beside it."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import yaml

from shipcrane_twin.record.read import Signals, read_signals
from shipcrane_twin.report.figures import DPI, make_figures, png_bytes
from shipcrane_twin.report.style import Plot
from shipcrane_twin.report.summary import Gap, find_gaps, summarise
from shipcrane_twin.report.template import CONVENTIONS, PAGE

_QUANTITIES = (
    ("roll_deg", "Roll, positive starboard down", "deg"),
    ("pitch_deg", "Pitch, positive bow up", "deg"),
    ("heave_m", "Heave of the centre of gravity", "m"),
    ("position_error_m", "Distance from the set-point, DP settled", "m"),
    ("wire_tension_kn", "Wire tension", "kN"),
    ("payload_sway_deg", "Sway of the load from the vertical", "deg"),
)
_COLUMNS = ("mean", "std", "min", "max", "rms")


class ReportError(ValueError):
    """A run directory lacks what a report needs; the message names the file and the remedy."""


def write_report(run_dir: Path | str) -> Path:
    """Write ``report.html`` and ``figures/*.png`` into a run directory.

    Parameters
    ----------
    run_dir : path
        Holds ``bag/`` and ``scenario.yaml`` (resolved); ``summary.json`` adds what the bag cannot know, such
        as the wall time.

    Returns
    -------
    Path
        The page. It loads nothing from anywhere.

    Raises
    ------
    BagError
        If the bag cannot be read.
    ReportError
        If ``scenario.yaml`` or ``summary.json`` cannot be used.
    """
    run = Path(run_dir)
    signals = read_signals(run / "bag")
    scenario, scenario_text = _scenario(run / "scenario.yaml")
    summary = _summary(run / "summary.json")
    try:
        stats = summarise(signals, scenario)
        gaps = find_gaps(
            signals,
            end_s=float(summary.get("sim_duration_s", scenario["duration_s"])),
            macro_step_ms=float(scenario["macro_step_ms"]),
            telemetry_period_ms=float(scenario["telemetry_period_ms"]),
        )
        plots = make_figures(signals, scenario)
    except (KeyError, TypeError) as error:
        raise ReportError(
            f"{run / 'scenario.yaml'}: not a resolved scenario ({type(error).__name__}: {error}); "
            "use the file that the run itself wrote"
        ) from error
    pictures = [(plot, png_bytes(plot.figure)) for plot in plots]
    figures_dir = run / "figures"
    figures_dir.mkdir(exist_ok=True)
    for plot, png in pictures:
        (figures_dir / f"{plot.name}.png").write_bytes(png)
    page = run / "report.html"
    page.write_text(_page(signals, scenario, scenario_text, summary, stats, gaps, pictures), encoding="utf-8")
    return page


def _scenario(file: Path) -> tuple[dict[str, Any], str]:
    """Return the resolved scenario, parsed and as text."""
    try:
        text = file.read_text(encoding="utf-8")
        content = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ReportError(f"{file}: cannot be read ({error}); a run writes it beside its bag") from error
    if not isinstance(content, dict):
        raise ReportError(f"{file}: expected a mapping, found {type(content).__name__}")
    return content, text


def _summary(file: Path) -> dict[str, Any]:
    """Return summary.json, empty if there is none."""
    if not file.exists():
        return {}
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ReportError(
            f"{file}: cannot be read ({error}); without it the bag alone is reported"
        ) from error
    if not isinstance(content, dict):
        raise ReportError(f"{file}: expected an object, found {type(content).__name__}")
    return content


def _page(
    signals: Signals,
    scenario: Mapping[str, Any],
    scenario_text: str,
    summary: Mapping[str, Any],
    stats: Mapping[str, Any],
    gaps: Sequence[Gap],
    pictures: Sequence[tuple[Plot, bytes]],
) -> str:
    """Put the page together."""
    title = str(scenario.get("title") or scenario.get("name") or "Run")
    return PAGE.format(
        title=escape(title),
        run=_rows(_run_facts(signals, scenario, summary)),
        results=_results(stats),
        gaps=_gap_box(gaps),
        figures="\n".join(_figure(plot, png) for plot, png in pictures),
        conventions="\n".join(f"<li>{escape(text)}</li>" for text in CONVENTIONS),
        scenario=escape(scenario_text),
    )


def _run_facts(
    signals: Signals, scenario: Mapping[str, Any], summary: Mapping[str, Any]
) -> list[tuple[str, str]]:
    """Return what was run, as (name, text)."""
    facts: list[tuple[str, Any, str]] = [
        ("Scenario", summary.get("scenario", scenario.get("name")), ""),
        ("Seed", summary.get("seed", scenario.get("seed")), ""),
        ("Mode", summary.get("mode"), ""),
        ("Macro step", scenario["macro_step_ms"], " ms"),
        ("Simulated time", summary.get("sim_duration_s", scenario["duration_s"]), " s"),
        ("Wall-clock time", summary.get("wall_time_s"), " s"),
        ("Real-time factor", summary.get("real_time_factor"), " x"),
        ("Messages in the bag", sum(signals.counts.values()), ""),
        ("State digest", summary.get("state_digest"), ""),
    ]
    return [(name, _text(value) + unit) for name, value, unit in facts if value is not None]


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:,.2f}".rstrip("0").rstrip(".")
    return f"{value:,}" if isinstance(value, int) else str(value)


def _rows(facts: Sequence[tuple[str, str]]) -> str:
    return "\n".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in facts)


def _results(stats: Mapping[str, Any]) -> str:
    """Return the rows of the table of results; a dash where a quantity has no such number."""
    rows = []
    for key, name, unit in _QUANTITIES:
        numbers = stats.get(key) or {}
        cells = "".join(f"<td>{_number(numbers.get(column))}</td>" for column in _COLUMNS)
        rows.append(f"<tr><th>{escape(name)} [{unit}]</th>{cells}</tr>")
    return "\n".join(rows)


def _number(value: float | None) -> str:
    if value is None:
        return "&ndash;"
    return f"{value:.3f}".replace("-", "&minus;") if round(value, 3) else "0.000"


def _gap_box(gaps: Sequence[Gap]) -> str:
    if not gaps:
        return '<p class="whole">No message is missing: every topic has one message per due time.</p>'
    items = "".join(f"<li>{escape(str(gap))}</li>" for gap in gaps)
    return f'<div class="gaps" role="alert"><p>The bag is not complete:</p><ul>{items}</ul></div>'


def _figure(plot: Plot, png: bytes) -> str:
    width, height = (round(inches * DPI) for inches in plot.figure.get_size_inches())
    data = base64.b64encode(png).decode("ascii")
    alt = escape(plot.caption)
    return (
        f'<figure id="{escape(plot.name)}"><h2>{escape(plot.title)}</h2>'
        f'<img width="{width}" height="{height}" alt="{alt}" src="data:image/png;base64,{data}">'
        f"<figcaption>{alt}</figcaption></figure>"
    )
