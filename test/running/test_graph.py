import json
import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from shipcrane_twin.running import graph
from shipcrane_twin.running.graph import Graph, GraphOptions, NodeFailure, describe_exit, read_status, undisturbed

SLEEPER = "import time; print('up'); time.sleep(60)"


@pytest.fixture
def nodes(monkeypatch):
    """Put little programs in the place of the nodes; by name, the others just sleep."""
    programs = {}

    def start(name, folder, record):
        log = (folder / "log" / f"{name}.log").open("wb")
        return subprocess.Popen([sys.executable, "-u", "-c", programs.get(name, SLEEPER)], stdout=log, stderr=log)

    monkeypatch.setattr(graph, "start_node", start)
    return programs


def says(folder, **status):
    """Return a program that writes the clock's status file again and again."""
    text = json.dumps({"state": "running", "time_s": 1.5, "real_time_factor": 1.0, "silent": []} | status)
    file = str(folder / "status.json")
    return (
        "import os, time\n"
        "while True:\n"
        f"    open({file + '.part'!r}, 'w').write({text!r})\n"
        f"    os.replace({file + '.part'!r}, {file!r})\n"
        "    time.sleep(0.05)"
    )


def run(folder, **options):
    watched = Graph(GraphOptions(folder, record=False, **options))
    try:
        watched.run(lambda status: None)
    finally:
        assert all(process.poll() is not None for process in watched._processes.values())


def test_a_node_that_ends_is_named_with_its_last_words(nodes, tmp_path):
    nodes["crane"] = "print('first'); print('the hook is gone'); raise SystemExit(7)"
    with pytest.raises(NodeFailure, match=r"node crane ended with exit code 7; .*\n    first\n    the hook is gone$"):
        run(tmp_path)


def test_the_one_whom_the_clock_calls_silent_is_named(nodes, tmp_path):
    nodes["clock"] = says(tmp_path, state="silent", silent=["payload"])
    with pytest.raises(NodeFailure, match=r"node payload fell silent at simulated time 1\.500 s"):
        run(tmp_path)


def test_a_clock_that_stops_talking_is_named(nodes, tmp_path):
    nodes["clock"] = says(tmp_path).replace("while True", "for _ in range(5)") + "\ntime.sleep(60)"
    began = time.monotonic()
    with pytest.raises(NodeFailure, match=r"node clock fell silent at simulated time 1\.500 s"):
        run(tmp_path, silence_timeout_s=0.5)
    assert time.monotonic() - began < 5.0


def test_nodes_that_do_not_join_are_named(nodes, tmp_path, monkeypatch):
    monkeypatch.setattr(graph, "START_LIMIT_S", 0.5)
    nodes["clock"] = says(tmp_path, state="waiting for nodes", silent=["vessel"])
    with pytest.raises(NodeFailure, match=r"node vessel did not join within 0\.5 s"):
        run(tmp_path)


def test_a_clock_that_never_starts_is_named(nodes, tmp_path, monkeypatch):
    monkeypatch.setattr(graph, "START_LIMIT_S", 0.5)
    with pytest.raises(NodeFailure, match="node clock did not join"):
        run(tmp_path)


def test_a_node_that_ignores_the_signal_is_killed(nodes, tmp_path, monkeypatch):
    monkeypatch.setattr(graph, "STOP_LIMIT_S", 0.3)
    nodes["vessel"] = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); time.sleep(60)"
    nodes["clock"] = "import time; time.sleep(0.5)"
    run(tmp_path)  # which checks that all have ended


def test_signals_are_ignored_only_inside(request):
    # a suite that a shell runs in the background has inherited a SIGINT that does nothing
    request.addfinalizer(partial(signal.signal, signal.SIGINT, signal.getsignal(signal.SIGINT)))
    signal.signal(signal.SIGINT, signal.default_int_handler)

    def interrupt():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.01)

    with undisturbed():
        interrupt()
        interrupt()
    with pytest.raises(KeyboardInterrupt):
        interrupt()


def test_status_before_the_clock_has_spoken(tmp_path):
    assert read_status(tmp_path)["state"] == "starting"


@pytest.mark.parametrize(("code", "words"), [(1, "exit code 1"), (-9, "signal SIGKILL"), (-11, "signal SIGSEGV")])
def test_exit_codes_in_words(code, words):
    assert describe_exit(code) == words
