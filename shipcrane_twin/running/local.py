"""The inline run with the same recording as the graph's; imports no ROS."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.topics import DIAGNOSTICS
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.record.bag import BagWriter, bag_options, recorded_topics
from shipcrane_twin.record.collector import StepCollector
from shipcrane_twin.ros.cdr import Template

PROGRESS_STEPS = 250
_NO_VALUES = np.empty(0)


class InlineRecorder:
    """Writes every output of an inline run to a bag, as the recorder node would.

    Parameters
    ----------
    scenario : Scenario
    folder : Path
        Of the run; ``bag/`` is made in it.
    """

    def __init__(self, scenario: Scenario, folder: Path) -> None:
        topics = recorded_topics(scenario)
        self._templates = {topic.name: Template(topic) for topic in topics if topic.type != DIAGNOSTICS}
        self._bag = BagWriter(folder / "bag", **bag_options(scenario))
        self._collector = StepCollector(topics, scenario.step_ns, scenario.telemetry_every, self._bag.write)
        self.spent_s = 0.0

    def take(self, time_ns: int, topic: str, values: Array) -> None:
        """Record one output."""
        began = time.perf_counter()
        self._collector.add(topic, time_ns, self._templates[topic].encode(time_ns, values))
        self.spent_s += time.perf_counter() - began

    def tick(self, time_ns: int) -> None:
        """Record the clock."""
        self.take(time_ns, "/clock", _NO_VALUES)

    def close(self) -> None:
        """Finish the bag."""
        self._collector.flush()
        self._bag.close()


def run_inline(
    scenario: Scenario, folder: Path, record: bool, progress: Callable[[dict[str, Any]], None]
) -> dict[str, Any]:
    """Run a scenario in this process and return what the summary needs of the run itself.

    Parameters
    ----------
    scenario : Scenario
    folder : Path
        Of the run.
    record : bool
    progress : callable
        Gets a status like the clock's, a few times a second.

    Returns
    -------
    dict
        steps; wall_time_s from the first step on; record_s, the part of it spent on recording; state_digest; load, what
        has happened to it.
    """
    recorder = InlineRecorder(scenario, folder) if record else None
    run = InlineRun(scenario, recorder.take if recorder else None)
    step_s = scenario.step_ns / 1e9
    began = time.perf_counter()
    done = -1
    try:
        for done in run.steps():
            if done == 1:
                began = time.perf_counter()  # the first steps may have compiled kernels
            if recorder is not None:
                recorder.tick(done * scenario.step_ns)
            if done % PROGRESS_STEPS == 0:
                elapsed = max(1e-9, time.perf_counter() - began)
                factor = done * step_s / elapsed
                progress({"state": "running", "time_s": done * step_s, "real_time_factor": factor, "silent": []})
    finally:
        wall_s = time.perf_counter() - began
        if recorder is not None:
            recorder.close()
    record_s = recorder.spent_s if recorder is not None else 0.0
    return {
        "steps": done,
        "wall_time_s": wall_s,
        "state_digest": run.digest,
        "record_s": record_s,
        "load": run.subsystem("payload").events(),  # type: ignore[attr-defined]
    }
