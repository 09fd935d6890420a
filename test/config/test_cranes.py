"""The cranes that come with the package: buildable, of the right weight, and each runs."""

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.control.load_limiter import radius_and_slopes, utilisation
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.check import check_buildable
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.crane_cylinders import joints_from_lengths
from shipcrane_twin.physics.crane_inertia import composite_inertia

SUBSEA = """
use: defaults.yaml
title: A lift with the subsea crane
duration_s: 10.0
crane: {use: cranes/subsea_knuckle.yaml}
vessel: {ballast: {mode: level}}
payload: {mass_kg: 8000.0}
wire: {diameter_m: 0.05}
operations: [{label: up, joint: boom, from_s: 1.0, to_s: 8.0, velocity_rad_s: 0.01}]
"""
WEIGHT = {"palfinger": 6024.0, "subsea_knuckle": 40000.0}


@pytest.fixture
def scenario_of(tmp_path):
    def load(name):
        path = tmp_path / "subsea.yaml"
        path.write_text(SUBSEA)
        return load_scenario(str(path) if name == "subsea_knuckle" else "case2")

    return load


@pytest.mark.parametrize("name", WEIGHT)
def test_crane_is_buildable_and_weighs_what_it_should(name, scenario_of):
    scenario = scenario_of(name)
    check_buildable(scenario)
    chain = build.crane_chain(scenario.crane)
    assert composite_inertia(chain, np.array(scenario.crane.initial_joints))[0] == pytest.approx(WEIGHT[name])


@pytest.mark.parametrize("name", WEIGHT)
def test_chart_covers_the_reach_and_the_start_is_within_it(name, scenario_of):
    crane = scenario_of(name).crane
    chain, drives = build.crane_chain(crane), build.crane_drives(crane)
    ends = [joints_from_lengths(drives, ends) for ends in (drives.length_min, drives.length_max)]
    low, high = (np.where(np.isfinite(end), end, 0.0) for end in ends)
    rng = np.random.default_rng(1)
    reach = max(radius_and_slopes(chain, q)[0] for q in rng.uniform(low, high, (500, len(low))))
    assert reach <= crane.load_chart[-1][0] + 0.1
    limiter = build.load_limiter(scenario_of(name))
    radius = radius_and_slopes(chain, np.array(crane.initial_joints))[0]
    assert utilisation(limiter, scenario_of(name).payload.mass_kg, radius) < 0.9


def test_a_crane_of_three_joints_runs(scenario_of):
    run = InlineRun(scenario_of("subsea_knuckle"))
    tips = [run.latest["/crane/tip"][2] for _ in run.steps()]
    assert run.latest["/crane/joint_states"].shape == (3 * 5,)
    start = scenario_of("subsea_knuckle").crane.initial_joints
    assert run.latest["/crane/joint_states"][1] == pytest.approx(start[1] + 0.07, abs=5e-3)
    assert tips[-1] > tips[0] + 0.1
