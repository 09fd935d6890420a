"""Whatever ends a run: its exit code, a message that names the culprit, a readable bag, and nothing left running."""

import os
import signal
import time

import numpy as np
import pytest
from graph_runs import cli_run, is_running, left_behind, needs_ros, write_lively
from rosbags.highlevel import AnyReader

from shipcrane_twin.cosim.topics import TOPICS

pytestmark = needs_ros

STEP_NS, TELEMETRY_NS = 20_000_000, 100_000_000
PACED = ("--speed", "4", "--set", "lockstep.silence_timeout_s=2.0")


@pytest.fixture
def endless(tmp_path):
    """Return a scenario that no test waits for, in small chunks so that little is lost with the recorder."""
    return write_lively(tmp_path, duration_s=1000.0, recording={"compression": "zstd", "chunk_kib": 64})


def log_times(bag):
    """Return the log times [ns] of every topic in the bag."""
    with AnyReader([bag]) as reader:
        times = {connection.topic: [] for connection in reader.connections}
        for connection, log_ns, _ in reader.messages():
            times[connection.topic].append(log_ns)
    return times


def assert_whole_up_to(bag, time_s):
    """Check that every topic has each of its messages from zero to a time, and that there are some."""
    assert time_s > 1.0
    times = log_times(bag)
    for topic in TOPICS:
        if topic.rate in ("step", "telemetry"):
            every = STEP_NS if topic.rate == "step" else TELEMETRY_NS
            due = np.arange(0, round(time_s * 1e9) + 1, every)
            np.testing.assert_array_equal(times[topic.name][: len(due)], due, err_msg=topic.name)
            assert len(set(times[topic.name])) == len(times[topic.name]), f"{topic.name} has doubles"


def assert_gone(run):
    assert run.nodes.keys() == {"recorder", "environment", "vessel", "crane", "payload", "clock"}
    assert [name for name, pid in run.nodes.items() if is_running(pid)] == []
    assert run.shared
    assert left_behind(run.shared) == []


@pytest.mark.parametrize("name", ["crane", "clock"])
def test_a_node_that_is_killed_is_named(name, endless, tmp_path):
    with cli_run(tmp_path / "run", endless, *PACED) as run:
        run.wait_for_time(2.0)
        os.kill(run.nodes[name], signal.SIGKILL)
        assert run.finish() == 3
        assert f"node {name} ended with signal SIGKILL" in run.errors
        assert "Traceback" not in run.errors
        summary = run.summary
        assert summary["complete"] is False
        assert f"node {name} ended with signal SIGKILL" in summary["failure"]
        assert summary["gaps"] == []
        assert_whole_up_to(tmp_path / "run" / "bag", summary["sim_duration_s"])
        assert_gone(run)


def test_a_recorder_that_is_killed_is_named_and_its_bag_mended(endless, tmp_path):
    with cli_run(tmp_path / "run", endless, *PACED) as run:
        run.wait_for_time(5.0)
        os.kill(run.nodes["recorder"], signal.SIGKILL)
        assert run.finish() == 3
        assert "node recorder ended with signal SIGKILL" in run.errors
        assert run.summary["sim_duration_s"] > 5.0
        assert run.summary["gaps"] != []  # what was in its memory is lost, and the summary says so
        assert_whole_up_to(tmp_path / "run" / "bag", 3.0)
        assert_gone(run)


@pytest.mark.parametrize("name", ["payload", "clock", "recorder"])
def test_a_node_that_falls_silent_is_named(name, endless, tmp_path):
    with cli_run(tmp_path / "run", endless, *PACED, "--no-record" if name != "recorder" else "--seed=1") as run:
        run.wait_for_time(2.0)
        os.kill(run.nodes[name], signal.SIGSTOP)
        began = time.monotonic()
        assert run.finish() == 3
        assert f"node {name} fell silent" in run.errors
        assert f"node {name} fell silent" in run.summary["failure"]
        assert 2.0 < time.monotonic() - began < 15.0
        assert [other for other, pid in run.nodes.items() if is_running(pid)] == []
        assert left_behind(run.shared) == []


@pytest.mark.parametrize(
    "signals",
    [(signal.SIGINT,), (signal.SIGTERM,), (signal.SIGINT, signal.SIGINT, signal.SIGTERM)],
    ids=["Ctrl-C", "SIGTERM", "impatient"],
)
def test_an_interrupted_run_keeps_what_it_has(signals, endless, tmp_path):
    with cli_run(tmp_path / "run", endless, *PACED) as run:
        run.wait_for_time(2.0)
        for number in signals:
            run.process.send_signal(number)
            time.sleep(0.02)
        assert run.finish() == 130
        assert "Traceback" not in run.errors
        assert run.summary["complete"] is False
        assert_whole_up_to(tmp_path / "run" / "bag", run.summary["sim_duration_s"])
        assert_gone(run)


def test_a_second_run_in_the_same_domain_is_refused_and_harms_nobody(endless, tmp_path):
    with cli_run(tmp_path / "first", endless, "--speed", "2") as first:
        first.wait_for_time(0.5)
        with cli_run(tmp_path / "second", endless, "--no-record", domain=first.domain) as second:
            assert second.finish() == 3
            assert f"publisher of another run in ROS domain {first.domain}" in second.errors
            assert "set another ROS_DOMAIN_ID" in second.errors
        first.process.send_signal(signal.SIGINT)
        assert first.finish() == 130
        # two graphs on few cores can starve the first one's recorder; what it lost then is told
        whole_s = 5.0 if first.summary["gaps"] else first.summary["sim_duration_s"]
        assert_whole_up_to(tmp_path / "first" / "bag", whole_s)


def test_what_a_slow_recorder_missed_is_sent_again_before_an_interrupted_run_ends(endless, tmp_path):
    with cli_run(tmp_path / "run", endless, *PACED) as run:
        run.wait_for_time(1.0)
        os.kill(run.nodes["recorder"], signal.SIGSTOP)
        time.sleep(1.0)  # more than its queue in shared memory holds
        os.kill(run.nodes["recorder"], signal.SIGCONT)
        run.process.send_signal(signal.SIGTERM)
        assert run.finish() == 130
        assert run.summary["gaps"] == []
        assert_whole_up_to(tmp_path / "run" / "bag", run.summary["sim_duration_s"])
        assert_gone(run)
