"""Another crane, and a box among moving decks, as nodes of a graph: the same digest as inline."""

import pytest
from graph_runs import cli_run, needs_ros, run_graph

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.inline import InlineRun

pytestmark = needs_ros

SOON = {
    "subsea_lift": ["operations.0.from_s=1.0", "operations.1.from_s=2.0", "operations.3.from_s=1.0"],
    "quay_pickup": ["operations.0.from_s=1.0", "operations.1.from_s=3.0"],
    "splash_zone": ["operations.0.from_s=1.0"],
}


@pytest.mark.parametrize("name", SOON)
def test_a_graph_gives_the_inline_digest(name, tmp_path):
    overrides = ["duration_s=12.0", *(["events=[]"] if name == "quay_pickup" else []), *SOON[name]]
    run = InlineRun(load_scenario(name, overrides))
    for _ in run.steps():
        pass
    assert run_graph(tmp_path / "run", name, overrides=overrides) == run.digest


def test_snaps_and_landings_are_in_the_summary(tmp_path):
    with cli_run(tmp_path / "run", "quay_pickup", "--until", "6") as run:
        assert run.finish() == 0, run.errors
    assert run.summary["gaps"] == []
    assert run.summary["load"].keys() == {
        "snaps", "snap_tension_max_kn", "landings", "lift_offs", "impact_speed_max_m_s"
    }  # fmt: skip
