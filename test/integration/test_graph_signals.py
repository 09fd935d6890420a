"""Every node alone: ends in order on SIGINT and SIGTERM at any moment, and leaves nothing in shared memory."""

import signal
import subprocess
import time
from pathlib import Path

import pytest
from graph_runs import (
    NODES,
    free_domain,
    is_running,
    left_behind,
    needs_ros,
    shared_names,
    start_node_alone,
    wait_until,
)

pytestmark = needs_ros

STOP_LIMIT_S = 2.0
SIGNALS = (signal.SIGINT, signal.SIGTERM)


def catches_sigterm(pid):
    """Whether a process has a handler for SIGTERM: Python brings none."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    mask = next(int(line.split()[1], 16) for line in lines if line.startswith("SigCgt"))
    return bool(mask >> (signal.SIGTERM - 1) & 1)


def sleeps(pid):
    """Whether a process has spent hardly any time of late: it is up and waits for others."""
    before = cpu_ticks(pid)
    time.sleep(0.4)
    return cpu_ticks(pid) - before <= 4


def cpu_ticks(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


MOMENTS = {
    "first breath": catches_sigterm,
    "joining": shared_names,
    "up": lambda pid: shared_names(pid) and sleeps(pid),
}


@pytest.fixture
def start(tmp_path):
    """Start nodes, each in a domain of its own; whatever still runs at the end is killed."""
    started = []

    def one(name, number):
        process = start_node_alone(name, tmp_path / f"{name}-{number}", free_domain())
        started.append(process)
        return process

    yield one
    for process in started:
        if process.poll() is None:
            process.kill()
        process.wait()


@pytest.mark.parametrize("moment", MOMENTS)
@pytest.mark.parametrize("name", NODES)
def test_a_node_ends_at_once_and_leaves_nothing(name, moment, start, tmp_path):
    for number in SIGNALS:
        process = start(name, number)
        wait_until(lambda pid=process.pid: MOMENTS[moment](pid))
        names = shared_names(process.pid)
        process.send_signal(number)
        began = time.monotonic()
        try:
            code = process.wait(STOP_LIMIT_S)
        except subprocess.TimeoutExpired:
            pytest.fail(f"{name} still runs {STOP_LIMIT_S:g} s after {number.name}")
        log = (tmp_path / f"{name}-{number}" / f"{name}.log").read_text()
        assert (code, log) == (0, ""), f"{number.name} after {time.monotonic() - began:.2f} s"
        assert left_behind(names) == []
        assert not is_running(process.pid)


def test_the_recorders_bag_is_closed_when_it_is_stopped_alone(start, tmp_path):
    process = start("recorder", 0)
    wait_until(lambda: shared_names(process.pid) and sleeps(process.pid))
    process.terminate()
    assert process.wait(STOP_LIMIT_S) == 0
    assert (tmp_path / "recorder-0" / "bag" / "metadata.yaml").exists()


@pytest.mark.parametrize("name", NODES)
def test_a_node_without_a_scenario_says_so_and_ends(name, tmp_path):
    process = start_node_alone(name, tmp_path, free_domain(), scenario="no_such")
    assert process.wait(20) == 2
    log = (tmp_path / f"{name}.log").read_text()
    assert log.startswith("error: scenario 'no_such' is unknown; ")
    assert log.count("\n") == 1
