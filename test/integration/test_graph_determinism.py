import pytest
from graph_runs import free_domain, needs_ros, operator_in, run_graph

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.inline import InlineRun

pytestmark = needs_ros


def test_graph_and_inline_agree(graph_run, inline_run):
    assert graph_run[1] == inline_run[1]


@pytest.mark.parametrize(
    ("overrides", "options"),
    [
        ([], {}),
        ([], {"order": ("payload", "crane", "vessel", "environment")}),
        (["lockstep.run_ahead_steps=1"], {}),
        (["lockstep.run_ahead_steps=40"], {"order": ("crane", "environment", "payload", "vessel")}),
    ],
    ids=["again", "started in reverse", "strict barrier", "far ahead, other order"],
)
def test_nothing_about_the_graph_changes_the_digest(overrides, options, lively, graph_run, graph_domain, tmp_path):
    digest = run_graph(tmp_path / "run", lively, overrides=overrides, domain=graph_domain, **options)
    assert digest == graph_run[1]


def test_another_domain_gives_the_same_digest(lively, graph_run, graph_domain, tmp_path):
    other = free_domain()
    assert other != graph_domain
    assert run_graph(tmp_path / "run", lively, domain=other) == graph_run[1]


def test_listeners_early_and_late_change_nothing(lively, graph_run, tmp_path):
    domain = free_domain()
    topics = {
        "/vessel/odom": "nav_msgs/msg/Odometry",
        "/payload/wire_wrench": "geometry_msgs/msg/WrenchStamped",
        "/clock": "rosgraph_msgs/msg/Clock",
    }
    with operator_in(domain) as early, operator_in(domain) as late:
        for topic, kind in topics.items():
            early.listen(topic=topic, kind=kind)
        joined = []

        def join(status):
            if status["time_s"] > 5.0 and not joined:
                joined.append(True)
                for topic, kind in topics.items():
                    late.listen(topic=topic, kind=kind)

        digest = run_graph(tmp_path / "run", lively, overrides=["lockstep.speed=4.0"], domain=domain, progress=join)
        heard, heard_late = ([client.stamps(topic=topic) for topic in topics] for client in (early, late))
    assert digest == graph_run[1]
    # nobody waits for free listeners, so how soon they are connected depends on the machine
    assert all(len(stamps) > 0 for stamps in heard + heard_late)


def test_another_load_gives_another_digest(lively, graph_run):
    run = InlineRun(load_scenario(str(lively), ["payload.mass_kg=701.0"]))
    for _ in run.steps():
        pass
    assert run.digest != graph_run[1]
