from concurrent.futures import ThreadPoolExecutor

import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.running.folder import make_run_folder, next_folder


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return load_scenario("case2", ["duration_s=60"])


def test_the_folder_holds_the_scenario_to_the_last_bit(scenario, tmp_path):
    folder = make_run_folder(scenario, tmp_path / "a" / "b")
    assert folder == tmp_path / "a" / "b"
    read = load_scenario(str(folder / "scenario.yaml"))
    assert read == scenario


def test_folders_of_a_scenario_are_numbered(scenario, tmp_path):
    assert [make_run_folder(scenario, None).name for _ in range(3)] == ["case2-1", "case2-2", "case2-3"]


def test_runs_that_start_at_once_get_different_folders(scenario):
    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(lambda _: next_folder("same"), range(24)))
    assert len(set(folders)) == 24


def test_an_empty_folder_may_be_given(scenario, tmp_path):
    (tmp_path / "mine").mkdir()
    assert make_run_folder(scenario, tmp_path / "mine") == tmp_path / "mine"


def test_a_folder_with_anything_in_it_is_left_alone(scenario, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("keep")
    with pytest.raises(ConfigError, match="not empty"):
        make_run_folder(scenario, tmp_path / "mine")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["notes.txt"]
