"""Controllers as nodes of the graph: the same digest as inline, and a user's own node awaited by stamp."""

import json
import signal
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest
import yaml
from graph_runs import HERE, LIVELY, cli_run, free_domain, needs_ros, run_graph, surroundings
from rosbags.highlevel import AnyReader

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.settings import plain
from shipcrane_twin.cosim.controllers import own_chain_of
from shipcrane_twin.cosim.inline import InlineRun

pytestmark = needs_ros

GAIN = -0.5
MINE = {
    "kind": "external",
    "name": "heave_damper",
    "topic": "/heave_damper/joint_command",
    "joints": ["winch"],
    "mode": "add",
}


def listed(name):
    return plain(load_scenario(name))["controllers"]


def write_controlled(folder, *more, **changes):
    """Write the lively scenario with both controllers and some more, and return its path."""
    controllers = [*listed("heave_compensation"), *listed("anti_sway"), *more]
    controllers[0] |= {"enabled_at_s": 1.0}
    sea = {"waves": {"systems": [{"spectrum": "regular", "direction_to_deg": 40.0, "height_m": 0.5, "period_s": 7.0}]}}
    scenario = LIVELY | {"duration_s": 8.0, "environment": sea, "controllers": controllers} | changes
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "controlled.yaml"
    path.write_text(yaml.safe_dump(scenario, sort_keys=False), encoding="utf-8")
    return path


def inline_digest(path, **options):
    run = InlineRun(load_scenario(str(path)), **options)
    for _ in run.steps():
        pass
    return run.digest


@contextmanager
def external(domain, wrong_from="never"):
    """Run the user's controller in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, str(HERE / "external_controller.py"), MINE["name"], str(GAIN), str(wrong_from)],
        env=surroundings(domain),
    )
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def controlled(tmp_path_factory):
    return write_controlled(tmp_path_factory.mktemp("controlled"))


@pytest.mark.parametrize("backwards", [False, True], ids=["in order", "started in reverse, strict barrier"])
def test_both_controllers_give_the_inline_digest(backwards, controlled, tmp_path):
    order = own_chain_of(load_scenario(str(controlled)))
    overrides = ["lockstep.run_ahead_steps=1"] if backwards else []
    digest = run_graph(tmp_path / "run", controlled, overrides=overrides, order=order[:: -1 if backwards else 1])
    assert digest == inline_digest(controlled)
    assert digest != inline_digest(write_controlled(tmp_path, controllers=[]))


def test_a_users_own_node_is_awaited_and_recorded(tmp_path):
    path = write_controlled(tmp_path, MINE)

    def stand_in(time_ns, inputs):
        return np.array([GAIN * inputs["/payload/odom"][9]])

    domain = free_domain()
    with external(domain), cli_run(tmp_path / "run", path, domain=domain) as run:
        assert run.finish() == 0, run.errors
    assert run.summary["gaps"] == []
    assert run.summary["state_digest"] == inline_digest(path, externals={MINE["name"]: stand_in})
    with AnyReader([tmp_path / "run" / "bag"]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
    assert {counts[f"/{name}/joint_command"] for name in ("heave_compensation", "anti_sway", MINE["name"])} == {401}


def test_nonsense_of_a_users_own_node_counts_as_zero_velocity(tmp_path):
    path = write_controlled(tmp_path, MINE, duration_s=4.0)
    wrong_from_ns = 2_000_000_000

    def stand_in(time_ns, inputs):
        return np.array([GAIN * inputs["/payload/odom"][9] if time_ns < wrong_from_ns else 0.0])

    domain = free_domain()
    with external(domain, wrong_from=2.0), cli_run(tmp_path / "run", path, "--no-record", domain=domain) as run:
        assert run.finish() == 0, run.errors
    assert run.summary["state_digest"] == inline_digest(path, externals={MINE["name"]: stand_in})
    assert "/heave_damper/joint_command counts as zero" in (tmp_path / "run" / "log" / "payload.log").read_text()


def test_a_users_own_node_that_ends_is_named(tmp_path):
    path = write_controlled(tmp_path, MINE, duration_s=1000.0)
    domain = free_domain()
    with external(domain) as node:
        arguments = ("--speed", "2", "--set", "lockstep.silence_timeout_s=2.0")
        with cli_run(tmp_path / "run", path, *arguments, domain=domain) as run:
            run.wait_for_time(1.0)
            node.kill()
            assert run.finish() == 3
    assert "node heave_damper fell silent" in run.errors
    assert json.loads((tmp_path / "run" / "summary.json").read_text())["complete"] is False
