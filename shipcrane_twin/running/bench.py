"""How fast the twin runs here: ratio to real time, and where the time goes."""

import itertools
import os
import platform
import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from shipcrane_twin.config.load import load_scenario, scenario_yaml
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.running.folder import node_results
from shipcrane_twin.running.graph import Graph, GraphOptions
from shipcrane_twin.running.local import run_inline

STEPS_MS = (10, 20, 50)
REPEATS = 3
MESSAGING = ("decode", "encode", "publish")

Row = dict[str, float]


def run_bench(name: str, until_s: float, console: Console) -> None:
    """Measure inline and graph runs, with and without recording, and print one table.

    Parameters
    ----------
    name : str
        Scenario.
    until_s : float
        Simulated time of each run [s].
    console : Console
    """
    table = Table(title=f"{name}, {until_s:g} s; median of {REPEATS} runs (spread)", title_justify="left")
    for heading in ("mode", "bag", "step", "real-time factor", "ms/step", "physics", "messaging", "recording"):
        table.add_column(heading, justify="left" if heading in ("mode", "bag") else "right", no_wrap=True)
    modes = (("inline", measure_inline), ("graph", measure_graph))
    for (mode, measure), record, step_ms in itertools.product(modes, (True, False), STEPS_MS):
        scenario = load_scenario(name, [f"macro_step_ms={step_ms}", f"duration_s={float(until_s)}"])
        bag = "yes" if record else "no"
        with console.status(f"{mode}, {step_ms} ms, bag {bag}"):
            rows = [repeat(measure, scenario, record) for _ in range(REPEATS)]
        table.add_row(mode, bag, f"{step_ms} ms", *cells(rows))
    console.print(table)
    console.print(
        "physics, messaging (decode, encode, publish) and recording: microseconds per step, summed over the "
        "processes;\nthe rest of a graph's step is the middleware and waiting for neighbours.\n"
        f"machine: {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        highlight=False,
    )


def repeat(measure: Callable[[Scenario, Path, bool], Row], scenario: Scenario, record: bool) -> Row:
    """Measure one run in a folder that is thrown away."""
    with tempfile.TemporaryDirectory(prefix="twin-bench-") as folder:
        return measure(scenario, Path(folder), record)


def measure_inline(scenario: Scenario, folder: Path, record: bool) -> Row:
    """Return one inline run's figures."""
    result = run_inline(scenario, folder, record, ignore)
    steps = result["steps"]
    recording = result["record_s"] / steps * 1e6
    return {
        "factor": scenario.duration_s / result["wall_time_s"],
        "ms": result["wall_time_s"] / steps * 1e3,
        "physics": result["wall_time_s"] / steps * 1e6 - recording,
        "messaging": 0.0,
        "recording": recording,
    }


def measure_graph(scenario: Scenario, folder: Path, record: bool) -> Row:
    """Return one graph run's figures."""
    (folder / "scenario.yaml").write_text(scenario_yaml(scenario), encoding="utf-8")
    Graph(GraphOptions(folder, record=record)).run(ignore)
    nodes = node_results(folder)
    budgets = [node["us_per_step"] for node in nodes.values() if "us_per_step" in node]
    clock = nodes["clock"]
    return {
        "factor": scenario.duration_s / clock["wall_time_s"],
        "ms": clock["wall_time_s"] / clock["steps"] * 1e3,
        "physics": sum(budget.get("physics", 0.0) for budget in budgets),
        "messaging": sum(budget.get(kind, 0.0) for budget in budgets for kind in MESSAGING),
        "recording": sum(budget.get("record", 0.0) for budget in budgets),
    }


def cells(rows: list[Row]) -> list[str]:
    """Return the table cells of repeated runs."""
    middle = {key: statistics.median(row[key] for row in rows) for key in rows[0]}
    factors = [row["factor"] for row in rows]
    return [
        f"{middle['factor']:.1f} ({min(factors):.1f} to {max(factors):.1f})",
        f"{middle['ms']:.3f}",
        *(f"{middle[key]:.0f} us" for key in ("physics", "messaging", "recording")),
    ]


def ignore(status: dict[str, Any]) -> None:
    """Take a run's progress and show nothing."""
