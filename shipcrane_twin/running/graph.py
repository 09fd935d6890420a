"""The node graph as processes: start, watch, stop."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shipcrane_twin.cosim.coupling import CHAIN
from shipcrane_twin.ros.shared_memory import mapped_names, remove_orphans

START_LIMIT_S = 300.0
"""Wall time for all nodes to find each other; kernels may have to be compiled first."""

STOP_LIMIT_S = 2.0
WRITE_LIMIT_S = 20.0
"""Wall time for the recorder to write what it holds."""

LOG_LINES = 12
WATCH_PERIOD_S = 0.05

Progress = Callable[[dict[str, Any]], None]


class NodeFailure(RuntimeError):
    """A node ended or fell silent; the message has its name and last log lines."""


@dataclass(frozen=True, slots=True)
class GraphOptions:
    """How a graph run is started.

    Attributes
    ----------
    folder : Path
        Of the run, with ``scenario.yaml``.
    record : bool
    order : sequence of str
        Subsystems in the order in which their processes are started.
    silence_timeout_s : float
        Wall time after which a clock that says nothing has failed [s]; it watches the others itself.
    """

    folder: Path
    record: bool
    order: Sequence[str] = CHAIN
    silence_timeout_s: float = 10.0


class Graph:
    """The processes of one run.

    Parameters
    ----------
    options : GraphOptions
    """

    def __init__(self, options: GraphOptions) -> None:
        self._options = options
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._shared: set[str] = set()
        self._silent = ""

    def run(self, progress: Progress) -> None:
        """Start all nodes, watch them until the clock is done, stop them.

        Raises
        ------
        NodeFailure
            If a node ends early, falls silent or never joins; the others have been stopped.
        KeyboardInterrupt
            As it comes; the others have been stopped and the bag is closed.
        """
        try:
            self._start()
            self._watch(progress)
        finally:
            with undisturbed():
                self._stop()

    def _start(self) -> None:
        (self._options.folder / "log").mkdir(exist_ok=True)
        recorder = ["recorder"] if self._options.record else []
        for name in [*recorder, *self._options.order, "clock"]:
            self._processes[name] = start_node(name, self._options.folder, self._options.record)

    def _watch(self, progress: Progress) -> None:
        limit = time.monotonic() + START_LIMIT_S
        pulse, pulse_at = 0, time.monotonic()
        while True:
            status = read_status(self._options.folder)
            progress(status)
            if (beat := status_time(self._options.folder)) != pulse:
                pulse, pulse_at = beat, time.monotonic()
            if status["state"] == "running" and not self._shared:
                # a node that is killed cannot be asked later
                self._shared = {name for process in self._processes.values() for name in mapped_names(process.pid)}
            if self._is_done():
                progress(read_status(self._options.folder))
                return
            if status["state"] == "silent":
                self._silent = status["silent"][0]
            elif pulse and time.monotonic() - pulse_at > self._options.silence_timeout_s:
                self._silent = "clock"
            if self._silent:
                what = f"fell silent at simulated time {status['time_s']:.3f} s"
                raise NodeFailure(self._obituary(self._silent, what))
            if status["state"] in ("starting", "waiting for nodes") and time.monotonic() > limit:
                missing = status["silent"] or ["clock"]
                raise NodeFailure(self._obituary(missing[0], f"did not join within {START_LIMIT_S:g} s"))
            time.sleep(WATCH_PERIOD_S)

    def _is_done(self) -> bool:
        """Whether the clock has ended well; NodeFailure if any other node has ended, or the clock badly."""
        for name, process in self._processes.items():
            code = process.poll()
            if name == "clock" and code == 0:
                return True
            if code is not None:
                raise NodeFailure(self._obituary(name, f"ended with {describe_exit(code)}"))
        return False

    def _obituary(self, name: str, what: str) -> str:
        log = self._options.folder / "log" / f"{name}.log"
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()[-LOG_LINES:] if log.exists() else []
        last = "\n".join(f"    {line}" for line in lines) or "    (it wrote nothing)"
        return f"node {name} {what}; its last log lines ({log}):\n{last}"

    def _stop(self) -> None:
        """Interrupt the clock, which lets the recorder catch up, then the recorder and the rest; kill what stays."""
        shared = {name for process in self._processes.values() for name in mapped_names(process.pid)}
        for names in (["clock"], ["recorder"], self._options.order):
            group = [self._processes[name] for name in names if name in self._processes]
            for process in group:
                if process.poll() is None:
                    process.send_signal(signal.SIGINT)
            writes = names == ["recorder"] and self._silent != "recorder"
            limit = time.monotonic() + (WRITE_LIMIT_S if writes else STOP_LIMIT_S)
            for process in group:
                try:
                    process.wait(max(0.01, limit - time.monotonic()))
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        remove_orphans(shared | self._shared)


def start_node(name: str, folder: Path, record: bool) -> subprocess.Popen[bytes]:
    """Start one node with its log in the run's folder, out of reach of the terminal's Ctrl-C."""
    # quoted, so that a path that looks like a number stays text
    parameters = {
        "scenario": json.dumps(str(folder / "scenario.yaml")),
        "run_dir": json.dumps(str(folder)),
        "recorded": json.dumps(record),
    }
    arguments = [part for key, value in parameters.items() for part in ("-p", f"{key}:={value}")]
    with (folder / "log" / f"{name}.log").open("wb") as log:
        return subprocess.Popen(
            [sys.executable, "-m", f"shipcrane_twin.nodes.{name}", "--ros-args", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={"OPENBLAS_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1", **os.environ},
        )


def read_status(folder: Path) -> dict[str, Any]:
    """Return what the clock last said of itself."""
    try:
        status: dict[str, Any] = json.loads((folder / "status.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {"state": "starting", "time_s": 0.0, "real_time_factor": 0.0, "silent": []}
    return status


def status_time(folder: Path) -> int:
    """Return when the clock last said something of itself [ns]; 0 if it never did."""
    try:
        return (folder / "status.json").stat().st_mtime_ns
    except FileNotFoundError:
        return 0


@contextmanager
def undisturbed() -> Iterator[None]:
    """Ignore SIGINT and SIGTERM for a while: a second Ctrl-C must not leave nodes behind."""
    if threading.current_thread() is not threading.main_thread():
        yield  # signals do not come here
        return
    # not SIG_IGN, which nodes would inherit
    before = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def describe_exit(code: int) -> str:
    """Return an exit code in words."""
    if code < 0:
        return f"signal {signal.Signals(-code).name}"
    return f"exit code {code}"
