import json
from types import SimpleNamespace

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.participant import state_digest
from shipcrane_twin.cosim.topics import TOPICS
from shipcrane_twin.record.bag import RECORDED, BagWriter
from shipcrane_twin.running import session
from shipcrane_twin.running.folder import make_run_folder
from shipcrane_twin.running.graph import NodeFailure
from shipcrane_twin.running.session import graph_result, recorded_steps, run_scenario


@pytest.fixture
def scenario():
    return load_scenario("case2", ["duration_s=2.0", "dp.enabled_at_s=0.0"])


def run(scenario, folder, mode="inline", record=True, progress=lambda status: None):
    return run_scenario(scenario, make_run_folder(scenario, folder), mode, record, progress)


def test_an_inline_run_is_complete_and_says_so(scenario, tmp_path):
    outcome = run(scenario, tmp_path / "run")
    assert (outcome.failure, outcome.interrupted) == ("", False)
    assert outcome.summary["complete"] is True
    assert outcome.summary["gaps"] == []
    assert outcome.summary["sim_duration_s"] == 2.0
    assert outcome.summary == json.loads((tmp_path / "run" / "summary.json").read_text())
    assert outcome.report == tmp_path / "run" / "report.html"


def test_recording_changes_no_result(scenario, tmp_path):
    digests = {run(scenario, tmp_path / str(on), record=on).summary["state_digest"] for on in (True, False)}
    assert len(digests) == 1


def test_an_interrupted_inline_run_keeps_what_it_has(scenario, tmp_path):
    scenario = load_scenario("case2", ["duration_s=60.0"])

    def interrupt(status):
        if status["time_s"] >= 5.0:
            raise KeyboardInterrupt

    outcome = run(scenario, tmp_path / "run", progress=interrupt)
    assert outcome.interrupted
    assert outcome.summary["complete"] is False
    assert outcome.summary["sim_duration_s"] == pytest.approx(5.0, abs=0.1)
    assert outcome.summary["gaps"] == []
    assert outcome.summary["messages"]["/vessel/odom"] == pytest.approx(251, abs=5)


@pytest.mark.parametrize(("telemetry_last", "steps"), [(135, 137), (130, 134)])
def test_a_step_counts_as_recorded_once_its_telemetry_is_there_too(scenario, telemetry_last, steps):
    def stamps(last, every):
        return SimpleNamespace(stamp_ns=np.arange(0, last + 1, every) * scenario.step_ns)

    kinds = {"step": stamps(137, 1), "telemetry": stamps(135, 5)}
    series = {topic.name: kinds[topic.rate] for topic in TOPICS if topic.rate in kinds}
    series["/dp/estimate"] = stamps(telemetry_last, 5)
    assert recorded_steps(SimpleNamespace(series=series, joints={}), scenario) == steps


class FakeGraph:
    """A graph whose nodes leave what is given and then fail."""

    leave = staticmethod(lambda folder: None)

    def __init__(self, options):
        self.folder = options.folder

    def run(self, progress):
        type(self).leave(self.folder)
        raise NodeFailure("node vessel ended with exit code 1; its last log lines")


@pytest.fixture
def fake_graph(monkeypatch):
    monkeypatch.setattr(session, "Graph", FakeGraph)
    return lambda leave: monkeypatch.setattr(FakeGraph, "leave", staticmethod(leave))


def assert_named(outcome, folder):
    assert outcome.failure.startswith("node vessel ended")
    assert json.loads((folder / "summary.json").read_text())["failure"] == outcome.failure


def test_a_graph_that_fails_before_the_bag_is_made_is_summed_up(scenario, fake_graph, tmp_path):
    outcome = run(scenario, tmp_path / "run", "graph")
    assert_named(outcome, tmp_path / "run")
    assert outcome.report is None


def open_bag(folder):
    return BagWriter(folder / "bag", RECORDED, compression="none", chunk_kib=16, metadata={})


def test_a_graph_that_fails_before_the_first_message_is_summed_up(scenario, fake_graph, tmp_path):
    fake_graph(lambda folder: open_bag(folder).close())
    outcome = run(scenario, tmp_path / "run", "graph")
    assert_named(outcome, tmp_path / "run")
    assert outcome.summary["roll_deg"] is None


def test_a_bag_that_was_never_closed_is_mended(scenario, fake_graph, tmp_path):
    fake_graph(open_bag)
    outcome = run(scenario, tmp_path / "run", "graph")
    assert_named(outcome, tmp_path / "run")
    assert (tmp_path / "run" / "bag" / "metadata.yaml").exists()


def test_the_result_of_a_graph_is_put_together_from_its_nodes(tmp_path):
    results = {"clock": {"steps": 9, "wall_time_s": 2.5}, "vessel": {"digest": "b"}, "crane": {"digest": "a"}}
    results["payload"] = {"events": {"snaps": 2.0}}
    (tmp_path / "nodes").mkdir()
    for name, result in results.items():
        (tmp_path / "nodes" / f"{name}.json").write_text(json.dumps(result))
    digest = state_digest({"crane": "a", "vessel": "b"})
    assert graph_result(tmp_path) == {"steps": 9, "wall_time_s": 2.5, "state_digest": digest, "load": {"snaps": 2.0}}


def test_all_but_the_recorders_own_progress_is_recorded():
    assert {topic.name for topic in TOPICS} - {topic.name for topic in RECORDED} == {"/recorder/progress"}
    assert np.unique([topic.name for topic in RECORDED]).size == len(RECORDED)
