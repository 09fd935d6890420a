import pytest
from graph_runs import free_domain, run_graph, write_lively

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.running.local import run_inline


@pytest.fixture(scope="session")
def lively(tmp_path_factory):
    """Return the path of a scenario in which everything moves early."""
    return write_lively(tmp_path_factory.mktemp("scenario"))


@pytest.fixture(scope="session")
def graph_domain():
    return free_domain()


@pytest.fixture(scope="session")
def graph_run(lively, graph_domain, tmp_path_factory):
    """Run the lively scenario as a recorded graph; return folder and digest."""
    folder = tmp_path_factory.mktemp("graph") / "run"
    return folder, run_graph(folder, lively, domain=graph_domain, record=True)


@pytest.fixture(scope="session")
def inline_run(lively, tmp_path_factory):
    """Run the lively scenario inline, recorded; return folder and digest."""
    folder = tmp_path_factory.mktemp("inline")
    result = run_inline(load_scenario(str(lively)), folder, True, lambda status: None)
    return folder, result["state_digest"]
