"""One run from start to report, and its summary."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from shipcrane_twin import __version__
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import plain
from shipcrane_twin.cosim.controllers import own_chain_of, topics_of
from shipcrane_twin.cosim.participant import state_digest
from shipcrane_twin.record.bag import bag_options
from shipcrane_twin.record.read import Signals, read_signals
from shipcrane_twin.record.rescue import is_broken, rescue_bag
from shipcrane_twin.report.page import write_report
from shipcrane_twin.report.summary import find_gaps, summarise
from shipcrane_twin.running.folder import node_results
from shipcrane_twin.running.graph import Graph, GraphOptions, NodeFailure
from shipcrane_twin.running.local import run_inline

Mode = Literal["graph", "inline"]
Progress = Callable[[dict[str, Any]], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a run came to.

    Attributes
    ----------
    summary : dict
        As in summary.json.
    report : Path or None
        The page, where a bag was written.
    failure : str
        Why the run is not good; empty if it is.
    interrupted : bool
        Stopped by the user.
    """

    summary: dict[str, Any]
    report: Path | None
    failure: str = ""
    interrupted: bool = False


def run_scenario(scenario: Scenario, folder: Path, mode: Mode, record: bool, progress: Progress) -> Outcome:
    """Run a scenario and write summary.json, report.html and figures into its folder.

    Parameters
    ----------
    scenario : Scenario
    folder : Path
        Made by `make_run_folder`.
    mode : str
        ``graph`` or ``inline``.
    record : bool
    progress : callable
        Gets the run's status a few times a second.
    """
    failure, interrupted = "", False
    result: dict[str, Any] = {"steps": 0, "wall_time_s": 0.0, "state_digest": ""}
    try:
        if mode == "inline":
            result = run_inline(scenario, folder, record, progress)
        else:
            silence_s = scenario.lockstep.silence_timeout_s
            options = GraphOptions(folder, record, own_chain_of(scenario), silence_s)
            Graph(options).run(progress)
    except NodeFailure as err:
        failure = str(err)
    except KeyboardInterrupt:
        interrupted = True
    if mode == "graph":
        result = graph_result(folder)
    return conclude(scenario, folder, mode, record, result, failure, interrupted)


def graph_result(folder: Path) -> dict[str, Any]:
    """Return steps, wall time and digest of a graph run from what its nodes wrote."""
    nodes = node_results(folder)
    digests = {name: result["digest"] for name, result in nodes.items() if "digest" in result}
    clock = nodes.get("clock", {"steps": 0, "wall_time_s": 0.0})
    return {
        "steps": max(0, clock["steps"]),
        "wall_time_s": clock["wall_time_s"],
        "state_digest": state_digest(digests),
        "load": nodes.get("payload", {}).get("events", {}),
    }


def conclude(
    scenario: Scenario,
    folder: Path,
    mode: Mode,
    record: bool,
    result: dict[str, Any],
    failure: str,
    interrupted: bool,
) -> Outcome:
    """Sum a run up from its bag, write summary and report."""
    signals = recorded_signals(scenario, folder) if record else None
    complete = not failure and not interrupted
    if not complete and not result["steps"] and signals is not None:
        result["steps"] = recorded_steps(signals, scenario)  # who counts them was the one that ended
    simulated_s = result["steps"] * scenario.step_ns / 1e9
    wall_s = result["wall_time_s"]
    summary: dict[str, Any] = {
        "scenario": scenario.name,
        "title": scenario.title,
        "version": __version__,
        "seed": scenario.seed,
        "mode": mode,
        "coupling": scenario.coupling,
        "macro_step_ms": scenario.macro_step_ms,
        "sim_duration_s": simulated_s,
        "wall_time_s": wall_s,
        "real_time_factor": simulated_s / wall_s if wall_s > 0.0 else 0.0,
        "state_digest": result["state_digest"],
        "complete": complete,
        "load": load_summary(result.get("load", {})),
    }
    report = None
    if signals is not None:
        summary |= summarise(signals, plain(scenario))
        gaps = find_gaps(
            signals,
            end_s=simulated_s,
            macro_step_ms=scenario.macro_step_ms,
            telemetry_period_ms=scenario.telemetry_period_ms,
            topics=topics_of(scenario),
        )
        if not complete:
            gaps = [gap for gap in gaps if gap.first_s is not None]  # some were a little further than the slowest
        elif gaps:
            failure = "the bag is not complete: " + "; ".join(map(str, gaps))
        summary["gaps"] = [str(gap) for gap in gaps]
    if failure:
        summary["failure"] = failure
    (folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    if signals is not None:
        report = write_report(folder)
    return Outcome(summary, report, failure, interrupted)


def load_summary(events: dict[str, float]) -> dict[str, float]:
    """Return what of the load's events a summary tells: snaps and landings, each with the worst of them."""
    told = {
        "snaps": "snaps",
        "snap_tension_max_n": "snap_tension_max_kn",
        "landings": "landings",
        "lift_offs": "lift_offs",
        "impact_speed_max_m_s": "impact_speed_max_m_s",
    }
    return {name: events[key] * (1e-3 if name.endswith("_kn") else 1.0) for key, name in told.items() if key in events}


def recorded_signals(scenario: Scenario, folder: Path) -> Signals | None:
    """Return the content of a run's bag, mended where the recorder was killed; None if there is no bag."""
    bag = folder / "bag"
    if not bag.exists():
        return None
    if is_broken(bag):
        rescue_bag(bag, **bag_options(scenario))
    return read_signals(bag)


def recorded_steps(signals: Signals, scenario: Scenario) -> int:
    """Return the last step of which every subsystem's messages are there; 0 if there is none.

    Of telemetry the next message is not due until its period is over.
    """
    step_ns = scenario.step_ns
    ahead = {"step": 0, "telemetry": (scenario.telemetry_every - 1) * step_ns}
    found = {name: one.stamp_ns for name, one in signals.series.items()}
    found |= {name: one.stamp_ns for name, one in signals.joints.items()}
    stamps = [(found[t.name], ahead[t.rate]) for t in topics_of(scenario) if t.rate in ahead and t.name in found]
    return min(((int(one[-1]) + more) // step_ns if len(one) else 0 for one, more in stamps), default=0)
