"""Reading, overriding and writing scenarios."""

import dataclasses

import pytest
import yaml

from shipcrane_twin.config.load import (
    apply_override,
    find_scenario,
    list_scenarios,
    load_scenario,
    merge,
    scenario_yaml,
)
from shipcrane_twin.config.settings import ConfigError, dotted, nearest


@pytest.mark.parametrize("name", list_scenarios())
def test_every_scenario_of_the_package_is_good(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.title


@pytest.mark.parametrize("name", list_scenarios())
def test_resolved_scenario_reads_back_equal(name, tmp_path):
    scenario = load_scenario(name, ["macro_step_ms=50.0", "crane.links.1.mass_kg=2000.0"])
    path = tmp_path / "scenario.yaml"
    path.write_text(scenario_yaml(scenario), encoding="utf-8")
    assert load_scenario(str(path)) == scenario


def test_scenario_is_found_by_name_and_by_path():
    assert find_scenario("case2") == list_scenarios()["case2"]
    assert load_scenario(str(find_scenario("case2"))) == load_scenario("case2")


def test_override_reaches_into_lists():
    changed = load_scenario("case2", ["crane.links.1.mass_kg=2000.0", "crane.initial_joints.3=2.5"])
    original = load_scenario("case2")
    assert changed.crane.links[1].mass_kg == 2000.0
    assert changed.crane.initial_joints == (*original.crane.initial_joints[:3], 2.5)
    assert changed.crane.links[0] == original.crane.links[0]
    assert changed.vessel == original.vessel


def test_overrides_apply_in_order_and_replace_lists_whole():
    scenario = load_scenario("case2", ["seed=2", "operations=[]", "seed=3"])
    assert scenario.seed == 3
    assert scenario.operations == ()


def test_override_of_a_group_keeps_nothing_of_the_old_one():
    with pytest.raises(ConfigError, match="is missing"):
        load_scenario("case2", ["winch={initial_length_m: 1.0}"])


def test_overriding_leaves_the_data_alone():
    data = {"a": {"b": [1, {"c": 2}]}}
    assert apply_override(data, ["a", "b", "1", "c"], 3) == {"a": {"b": [1, {"c": 3}]}}
    assert data == {"a": {"b": [1, {"c": 2}]}}


def test_merge_goes_into_groups_and_the_top_wins():
    base, top = {"a": {"b": 1, "c": [1, 2]}, "d": 4}, {"a": {"c": [3]}, "e": 5}
    assert merge(base, top) == {"a": {"b": 1, "c": [3]}, "d": 4, "e": 5}
    assert base == {"a": {"b": 1, "c": [1, 2]}, "d": 4}


def test_files_beside_the_scenario_go_before_the_packages(tmp_path):
    (tmp_path / "vessels").mkdir()
    ship = yaml.safe_load((find_scenario("case2").parents[1] / "vessels" / "gunnerus.yaml").read_text("utf-8"))
    (tmp_path / "vessels" / "gunnerus.yaml").write_text(yaml.safe_dump({**ship, "name": "Other"}), "utf-8")
    path = tmp_path / "mine.yaml"
    path.write_text("use: defaults.yaml\ntitle: x\nduration_s: 1.0\nvessel: {use: vessels/gunnerus.yaml}\n", "utf-8")
    assert load_scenario(str(path)).vessel.name == "Other"
    path.write_text("use: defaults.yaml\ntitle: x\nduration_s: 1.0\n", "utf-8")  # defaults.yaml has another neighbour
    assert load_scenario(str(path)).vessel.name == ship["name"]


def test_keys_beside_use_change_the_used_file(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("use: defaults.yaml\ntitle: x\nduration_s: 1.0\npayload: {mass_kg: 2200.0}\n", "utf-8")
    scenario = load_scenario(str(path))
    assert scenario.payload.mass_kg == 2200.0
    assert scenario.payload.hook_mass_kg == 50.0
    assert scenario.name == "mine"


def test_settings_are_frozen():
    scenario = load_scenario("case2")
    with pytest.raises(dataclasses.FrozenInstanceError):
        scenario.seed = 2


def test_step_counts_are_exact():
    scenario = load_scenario("case2", ["macro_step_ms=0.1", "duration_s=0.3", "dp.enabled_at_s=0.0"])
    assert (scenario.step_ns, scenario.step_count, scenario.telemetry_every) == (100_000, 3000, 1000)


@pytest.mark.parametrize("duration_s", [0.56, 1.12, 8.2, 65.64, 1000.02])
def test_duration_that_is_whole_steps_only_in_decimals_is_good(duration_s):
    scenario = load_scenario("case2", [f"duration_s={duration_s}"])
    assert scenario.step_count * scenario.step_ns == pytest.approx(duration_s * 1e9, rel=1e-15)


def test_key_path_is_shown_as_it_is_written():
    assert dotted(["operations", 2, "from_s"]) == "operations[2].from_s"


@pytest.mark.parametrize(
    ("key", "advice"),
    [
        ("lenght_m", "did you mean length_m?"),
        ("length_mm", "unit clash: this setting is length_m (the unit is part of the key); convert the value"),
        ("length", "unit clash: this setting is length_m (the unit is part of the key); convert the value"),
        ("zzz", "known here: length_m, speed_m_s"),
    ],
)
def test_advice_for_an_unknown_key(key, advice):
    assert nearest(key, ["length_m", "speed_m_s"]) == advice
