"""Helpers around graphs of real processes: a domain per run, runs by function and by command line, an operator."""

import importlib.util
import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

from shipcrane_twin.config.load import load_scenario, scenario_yaml
from shipcrane_twin.running.graph import Graph, GraphOptions
from shipcrane_twin.running.session import graph_result

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
NODES = ("environment", "vessel", "crane", "payload", "recorder", "clock")
SHM = Path("/dev/shm")

needs_ros = [
    pytest.mark.ros,
    pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="rclpy is not installed (extra: ros)"),
]

LIVELY = {
    "use": "defaults.yaml",
    "title": "Everything moves from the first seconds on",
    "duration_s": 20.0,
    "environment": {
        "current_speed_m_s": 0.5,
        "current_direction_to_deg": -135.0,
        "wind_speed_m_s": 6.0,
        "wind_direction_to_deg": 70.0,
    },
    "dp": {"enabled_at_s": 2.0, "setpoint": {"north_m": 2.0, "east_m": -1.0, "heading_deg": 5.0}},
    "operations": [
        {"label": "up", "joint": "boom", "from_s": 1.0, "to_s": 6.0, "velocity_rad_s": 0.02},
        {"label": "round", "joint": "slew", "from_s": 2.0, "to_s": 15.0, "velocity_rad_s": 0.03},
        {"label": "knuckle", "joint": "knuckle", "from_s": 3.0, "to_s": 7.0, "velocity_rad_s": 0.01},
        {"label": "in", "joint": "telescope", "from_s": 1.0, "to_s": 9.0, "velocity_m_s": -0.05},
        {"label": "down", "joint": "winch", "from_s": 4.0, "to_s": 12.0, "velocity_m_s": 0.1},
    ],
    "events": [{"label": "off", "at_s": 17.0, "event": "release_payload"}],
}

_taken = []


def free_domain():
    """Return a ROS domain below 233 that no process here uses: its UDP ports are all free."""
    ports = {int(port, 16) for port in re.findall(r"^ *\d+: \w+:(\w+)", Path("/proc/net/udp").read_text(), re.M)}
    first = 100 + os.getpid() % 131
    for domain in (100 + (first - 100 + i) % 131 for i in range(131)):
        base = 7400 + 250 * domain
        if domain not in _taken and not any(base <= port < base + 250 for port in ports):
            _taken.append(domain)
            return str(domain)
    raise RuntimeError("no free ROS domain between 100 and 230")


def surroundings(domain):
    """Return the environment of a process in a domain."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": domain,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep),
    }


def write_lively(folder, **changes):
    """Write the lively scenario with some keys replaced and return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "lively.yaml"
    path.write_text(yaml.safe_dump(LIVELY | changes, sort_keys=False), encoding="utf-8")
    return path


def run_graph(folder, scenario, *, overrides=(), domain=None, record=False, progress=None, **options):
    """Run a graph without summary and report; return its state digest."""
    folder.mkdir(parents=True)
    loaded = load_scenario(str(scenario), list(overrides))
    (folder / "scenario.yaml").write_text(scenario_yaml(loaded), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        for key, value in surroundings(domain or free_domain()).items():
            patch.setenv(key, value)
        Graph(GraphOptions(folder, record, **options)).run(progress or (lambda status: None))
    result = graph_result(folder)
    assert result["steps"] == loaded.step_count
    return result["state_digest"]


def start_node_alone(name, folder, domain, scenario="case2", **more):
    """Start one node the way ``ros2 run`` does, with its log in the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    parameters = {"scenario": str(scenario), "run_dir": str(folder), **more}
    arguments = [part for key, value in parameters.items() for part in ("-p", f"{key}:={value}")]
    with (folder / f"{name}.log").open("wb") as log:
        return subprocess.Popen(
            [sys.executable, "-m", f"shipcrane_twin.nodes.{name}", "--ros-args", *arguments],
            stdout=log,
            stderr=subprocess.STDOUT,
            env=surroundings(domain),
            start_new_session=True,
        )


def shared_names(pid):
    """Return the Fast DDS segments and ports that a process maps; empty if it is gone."""
    try:
        return set(re.findall(r"/dev/shm/(fastrtps_\w+)", Path(f"/proc/{pid}/maps").read_text()))
    except OSError:
        return set()


def left_behind(names, patience_s=1.5):
    """Return those of the names that lie in /dev/shm with no process alive that maps them."""
    end = time.monotonic() + patience_s
    while True:
        alive = {name for path in Path("/proc").glob("[0-9]*") for name in shared_names(path.name)}
        left = sorted(file.name for file in SHM.iterdir() if any(name in file.name for name in names - alive))
        if not left or time.monotonic() > end:
            return left
        time.sleep(0.05)


def children(pid):
    """Return the node processes of a command line process: name to process id."""
    found = {}
    for path in Path("/proc").glob("[0-9]*"):
        try:
            parent = int(path.joinpath("stat").read_text().rpartition(")")[2].split()[1])
            words = path.joinpath("cmdline").read_bytes().decode().split("\0")
        except (OSError, IndexError):
            continue
        if parent == pid:
            found |= {word.rpartition(".")[2]: int(path.name) for word in words if "shipcrane_twin.nodes." in word}
    return found


def is_running(pid):
    """Whether a process exists and is no zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def wait_until(condition, patience_s=60.0):
    """Wait for a condition and return what it gave; fail the test after a while."""
    end = time.monotonic() + patience_s
    while not (found := condition()):
        assert time.monotonic() < end, f"nothing after {patience_s:g} s"
        time.sleep(0.02)
    return found


class CliRun:
    """``shipcrane run`` as a process of its own."""

    def __init__(self, folder, *arguments, domain=None):
        self.folder = folder
        self.domain = domain or free_domain()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "shipcrane_twin.cli", "run", *map(str, arguments), "--out", str(folder)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=surroundings(self.domain) | {"COLUMNS": "200"},
            start_new_session=True,
        )
        self.nodes = {}
        self.shared = set()
        self.out = self.errors = ""

    def status(self):
        try:
            return json.loads((self.folder / "status.json").read_text())
        except FileNotFoundError:
            return {"state": "starting", "time_s": 0.0}

    def wait_for_time(self, time_s):
        """Wait until the run has reached a simulated time, and take note of its processes."""
        patience_s = 150.0  # kernels may have to be compiled first; the run itself gives up before that
        wait_until(lambda: self.status()["time_s"] >= time_s or self.process.poll() is not None, patience_s)
        assert self.process.poll() is None, f"ended with {self.finish()}: {self.errors}"
        self.nodes = children(self.process.pid)
        self.shared = {name for pid in self.nodes.values() for name in shared_names(pid)}

    def finish(self, patience_s=90.0):
        """Wait for the end and return the exit code."""
        self.out, self.errors = self.process.communicate(timeout=patience_s)
        return self.process.returncode

    @property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def end(self):
        """End what is left of the run, whatever the test found."""
        self.nodes |= children(self.process.pid)
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.communicate(timeout=30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.communicate()
        for pid in filter(is_running, self.nodes.values()):
            os.kill(pid, signal.SIGKILL)


@contextmanager
def cli_run(folder, *arguments, domain=None):
    run = CliRun(folder, *arguments, domain=domain)
    try:
        yield run
    finally:
        run.end()


class OperatorClient:
    """Talks to the operator process; every method of its Operator can be called by name."""

    def __init__(self, domain):
        self.process = subprocess.Popen(
            [sys.executable, str(HERE / "operator_process.py")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=surroundings(domain),
        )

    def __getattr__(self, name):
        def ask(**arguments):
            self.process.stdin.write(json.dumps({"do": name, **arguments}) + "\n")
            self.process.stdin.flush()
            answer = json.loads(self.process.stdout.readline())
            assert "error" not in answer, f"{name}: {answer['error']}"
            return answer["result"]

        return ask


@contextmanager
def operator_in(domain):
    client = OperatorClient(domain)
    try:
        yield client
    finally:
        client.process.stdin.close()
        try:
            client.process.wait(5)
        except subprocess.TimeoutExpired:
            client.process.kill()
            client.process.wait()
        client.process.stdout.close()
