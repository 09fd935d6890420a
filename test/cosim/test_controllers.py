"""Controllers in the lockstep: what they do to a run, who hears whom, and what is refused."""

import copy
import itertools
from dataclasses import replace

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.signal import welch

from shipcrane_twin import cli
from shipcrane_twin.config.controllers import ExternalConfig
from shipcrane_twin.config.load import load_scenario, scenario_yaml
from shipcrane_twin.config.scenario import Scenario, problems
from shipcrane_twin.config.settings import ConfigError, plain
from shipcrane_twin.cosim.build import crane_chain
from shipcrane_twin.cosim.check import check_buildable
from shipcrane_twin.cosim.controllers import (
    ControllerCommands,
    chain_of,
    check_controllers,
    inputs_of,
    own_chain_of,
    topics_of,
)
from shipcrane_twin.cosim.coupling import CHAIN, INPUTS, SCHEMES
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.pacing import Lockstep
from shipcrane_twin.cosim.subsystems.anti_sway import AntiSway, anti_sway_params
from shipcrane_twin.cosim.topics import TOPICS
from shipcrane_twin.physics.crane_chain import tip_state

SCHEME = SCHEMES["in_turn+inertia"]
READ = TypeAdapter(Scenario).validate_python
MINE = ExternalConfig(kind="external", name="mine", topic="/mine/joint_command", joints=("winch", "slew"), mode="add")


def series(scenario, *topics, **options):
    """Run a scenario and return the values of topics, one row per message, and the digest."""
    found = {topic: [] for topic in topics}

    def sink(time_ns, topic, values):
        if topic in found:
            found[topic].append(values.copy())

    run = InlineRun(scenario, sink, **options)
    for _ in run.steps():
        pass
    return *(np.array(found[topic]) for topic in topics), run.digest


def band_ratio(load, tip, step_s):
    """Return the ratio of two heaves' rms between 0.05 and 0.2 Hz."""
    power = []
    for height in (load, tip):
        frequency, density = welch(height, 1.0 / step_s, nperseg=round(60.0 / step_s))
        power.append(density[(frequency >= 0.05) & (frequency <= 0.2)].sum())
    return float(np.sqrt(power[0] / power[1]))


def test_heave_compensation_holds_the_load_in_e2(measured):
    scenario = load_scenario("heave_compensation", ["duration_s=300.0"])
    tip, load, _ = series(scenario, "/crane/tip", "/payload/odom")
    step_s = scenario.step_ns / 1e9
    before, after = slice(round(30 / step_s), round(60 / step_s)), slice(round(80 / step_s), None)
    still = load[:, 2] + np.interp(np.arange(len(load)) * step_s, [120.0, 220.0], [0.0, 10.0])  # the operator lowers
    ratio = band_ratio(still[after], tip[after, 2], step_s)
    measured("heave compensation: load heave over tip heave in E2, 0.05 to 0.2 Hz", ratio, 0.10)
    assert np.std(load[before, 2]) == pytest.approx(np.std(tip[before, 2]), rel=0.05)
    assert np.std(tip[after, 2]) > 0.1


def sway_deg(scenario):
    """Return the angle between wire and vertical at every step, the joints at telemetry's steps [deg, rad]."""
    tip, load, joints, _ = series(scenario, "/crane/tip", "/payload/odom", "/crane/joint_states")
    span = (load - tip)[:, :3]
    return np.degrees(np.arctan2(np.hypot(span[:, 0], span[:, 1]), -span[:, 2])), joints


def test_anti_sway_stops_a_quarter_turn_without_sway(measured):
    with_it = load_scenario("anti_sway")
    step_s = with_it.step_ns / 1e9
    stopped = with_it.operations[0].to_s
    (shaped, joints), (plainly, joints_plain) = (sway_deg(one) for one in (with_it, replace(with_it, controllers=())))
    at_rest = round((stopped + 7.0) / step_s)  # slew and shaper have come to rest
    ratio = shaped[at_rest:].max() / plainly[at_rest:].max()
    measured("anti-sway: residual sway after 90 degrees of slewing, over uncompensated", ratio, 0.20)
    assert plainly[at_rest:].max() > 1.0
    assert joints[-1, 0] == pytest.approx(joints_plain[-1, 0], abs=np.radians(0.5))
    assert joints_plain[-1, 0] - joints_plain[0, 0] == pytest.approx(-np.pi / 2, abs=np.radians(0.5))


def test_the_boom_moves_the_tip_as_the_controller_counts_on():
    scenario = load_scenario("anti_sway")
    constants, chain = anti_sway_params(scenario), crane_chain(scenario.crane)
    for slew, boom, knuckle in itertools.product((-2.0, 0.5), (-0.2, 0.4), (0.5, 1.2)):
        q = np.array([slew, boom, knuckle, 4.0])
        tip_b, velocity_b, _, _ = tip_state(chain, q, np.array([0.0, 1.0, 0.0, 0.0]))
        outward = tip_b[:2] / np.hypot(*tip_b[:2])
        expected = -constants.boom_sign * (tip_b[2] - constants.pivot_height)
        assert np.hypot(*velocity_b[:2]) == pytest.approx(abs(expected), abs=1e-9)
        assert velocity_b[:2] @ outward == pytest.approx(expected, rel=0.03)  # the boom's plane misses the slew axis


def test_anti_sway_hears_operations_and_operator_at_the_start_of_the_step_it_speaks_for():
    scenario = load_scenario("anti_sway", ["controllers.0.damping_ratio=0.0", "operations.0.from_s=0.04"])
    run = InlineRun(replace(scenario, controllers=()))
    next(run.steps())
    controller = AntiSway(scenario)
    said = [controller.start(), *(controller.step(k, run.latest) for k in (1, 2))]
    assert controller.commands.say(["slew", "winch"], [0.03, 0.2]) is None
    said.append(controller.step(3, run.latest))
    slew = [float(out["/anti_sway/joint_command"][0]) for out in said]
    np.testing.assert_allclose(slew, [0.0, 0.0, -0.02, 0.015], atol=1e-12)  # half now, half a swing later


def test_a_run_without_controllers_is_the_chain_alone():
    scenario = load_scenario("case2")
    assert chain_of(scenario) == own_chain_of(scenario) == CHAIN
    assert inputs_of(scenario) == INPUTS
    assert topics_of(scenario) == TOPICS


def with_controllers(*controllers, name="case2", **changes):
    return replace(load_scenario(name), controllers=controllers, **changes)


def both():
    return with_controllers(*load_scenario("heave_compensation").controllers, *load_scenario("anti_sway").controllers)


def test_controllers_come_last_and_are_awaited_by_those_they_command():
    scenario = replace(both(), controllers=(*both().controllers, MINE))
    assert chain_of(scenario) == (*CHAIN, "heave_compensation", "anti_sway", "mine")
    assert own_chain_of(scenario) == (*CHAIN, "heave_compensation", "anti_sway")
    inputs = inputs_of(scenario)
    assert inputs["crane"] == (*INPUTS["crane"], "/anti_sway/joint_command", "/mine/joint_command")
    assert inputs["payload"] == (*INPUTS["payload"], "/heave_compensation/joint_command", "/mine/joint_command")
    assert inputs["mine"] == ("/payload/odom",)
    for controller, part in itertools.product(chain_of(scenario)[len(CHAIN) :], CHAIN):
        assert SCHEME.lag(controller, part) == 0
        assert SCHEME.lag(part, controller) == 1


def test_the_clock_counts_controllers_and_waits_for_the_slowest():
    scenario = both()
    topics = {topic.name: topic for topic in topics_of(scenario)}
    state = Lockstep(SCHEME, 100, 1, False, chain_of(scenario), inputs_of(scenario), topics, announced=5)
    state.done |= dict.fromkeys(chain_of(scenario), 5) | {"heave_compensation": 4}
    assert (state.slowest, state.may_announce(), state.silent()) == (4, 5, ["heave_compensation"])
    assert state.last_behind == "heave_compensation"
    state.done["heave_compensation"] = 5
    assert state.last_behind == "anti_sway"
    state.done |= {"heave_compensation": 4, "payload": 5}
    assert not state.can_step("payload", 6)
    assert state.can_step("crane", 6) is False  # the vessel has not done step 6


def mine(mode, joints=("winch", "slew"), name="mine"):
    return replace(MINE, mode=mode, joints=joints, name=name, topic=f"/{name}/joint_command")


@pytest.mark.parametrize(
    ("controllers", "expected"),
    [
        ((mine("add"),), [1.2, 2.0]),
        ((mine("replace"),), [0.2, 2.0]),
        ((mine("replace"), mine("add", ("boom", "slew"), "other")), [0.4, 2.1]),
        ((mine("add", ("winch",)),), [1.0, 2.0]),
        ((), [1.0, 2.0]),
    ],
)
def test_velocities_are_replaced_or_added_to_in_the_order_of_the_list(controllers, expected):
    scenario = with_controllers(*controllers)
    said = {"/mine/joint_command": np.array([9.0, 0.2]), "/other/joint_command": np.array([0.1, 0.2])}
    command = np.array([1.0, 2.0])
    found = ControllerCommands(scenario, ("slew", "boom")).over(command, said)
    np.testing.assert_allclose(found, expected)
    np.testing.assert_array_equal(command, [1.0, 2.0])


def test_an_external_controller_has_a_stand_in_inline_that_acts_one_step_later():
    scenario = with_controllers(mine("add", ("winch",)), duration_s=1.0)
    scenario = replace(scenario, winch=replace(scenario.winch, jerk_max_m_s3=1e6))
    heard = []

    def pay_out(time_ns, inputs):
        heard.append((time_ns, inputs["/payload/odom"][2]))
        return np.array([0.1])

    winch, said, load, _ = series(
        scenario, "/winch/joint_states", "/mine/joint_command", "/payload/odom", externals={"mine": pay_out}
    )
    assert [time_ns for time_ns, _ in heard] == [k * scenario.step_ns for k in range(51)]
    np.testing.assert_array_equal([height for _, height in heard], load[:, 2])
    assert said.shape == (51, 1)
    accel = scenario.winch.accel_max_m_s2
    # ramp to 0.1 m/s from t = 0 on: what is said at t = 0 counts in the first step
    assert winch[-1, 0] == pytest.approx(scenario.winch.initial_length_m + 0.1 - 0.1**2 / (2.0 * accel), abs=1e-9)


def test_an_external_controller_without_a_stand_in_is_refused_inline():
    with pytest.raises(ConfigError, match="mine is a node of its own; run the scenario as a graph"):
        InlineRun(with_controllers(MINE))


def test_the_command_line_refuses_it_before_it_makes_a_folder(tmp_path):
    with pytest.raises(ConfigError, match="a node of its own"):
        cli.execute(with_controllers(MINE), "inline", tmp_path / "run", True)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "crane"}, r"controllers\[0\].name is 'crane', a node of the twin"),
        ({"name": "anti_sway"}, "a node of the twin"),
        ({"topic": "/crane/joint_command"}, "expected an absolute name that is not taken"),
        ({"topic": "joint_command"}, "expected an absolute name"),
        ({"inputs": ("/vessel/pose",)}, "expected topics of every step"),
        ({"inputs": ("/payload/odom", "/nothing")}, r"inputs has '/nothing'"),
    ],
)
def test_an_external_controller_that_cannot_be_is_refused(change, message):
    with pytest.raises(ConfigError, match=message):
        check_controllers(with_controllers(replace(MINE, **change)))


def test_two_external_controllers_need_two_topics():
    with pytest.raises(ConfigError, match="not taken"):
        check_controllers(with_controllers(MINE, replace(MINE, name="other")))


@pytest.mark.parametrize(
    ("controllers", "place", "message"),
    [
        ((MINE, MINE), ["controllers", 1], "one controller with the name mine"),
        ((replace(MINE, joints=("gripper",)),), ["controllers", 0], "it commands the joint gripper, expected joints"),
        ((replace(MINE, joints=("slew", "slew")),), ["controllers", 0, "joints"], "every joint once"),
        ((MINE, mine("replace", ("slew",), "other")), ["controllers", 1], "before those that add to it; see slew"),
    ],
)
def test_controllers_at_odds_are_told(controllers, place, message):
    found = problems(with_controllers(*controllers))
    assert [(path, message in advice) for path, advice in found] == [(place, True)]


def test_a_controller_out_of_the_kernels_range_is_a_config_error():
    scenario = load_scenario("anti_sway", ["winch.length_min_m=0.0001"])
    with pytest.raises(ConfigError, match=r"anti_sway: anti-sway: a wire of 0\.0001 m swings too fast"):
        check_buildable(scenario)


@pytest.mark.parametrize("name", ["heave_compensation", "anti_sway"])
def test_the_scenarios_are_buildable_and_survive_a_round_trip(name, tmp_path):
    scenario = load_scenario(name)
    check_buildable(scenario)
    path = tmp_path / f"{name}.yaml"
    path.write_text(scenario_yaml(scenario), encoding="utf-8")
    assert load_scenario(str(path)) == scenario


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"controllers": [{"kind": "anti_swai"}]}, r"\[0\].kind is 'anti_swai', expected one of .*'anti_sway'"),
        ({"controllers": [{"name": "x"}]}, r"\[0\].kind is missing; add it"),
        ({"controllers.0.dampingratio": 0.1}, r"\[0\].dampingratio is unknown; did you mean damping_ratio\?"),
        ({"controllers.0.damping_ratio": 2.0}, r"\[0\].damping_ratio is 2.0, expected less than or equal to 0.7"),
        ({"controllers.0.damping_ratio": "x"}, r"\[0\].damping_ratio is 'x', expected a valid number"),
    ],
)
def test_wrong_settings_name_key_and_remedy(change, message):
    with pytest.raises(ConfigError, match=r"controllers" + message):
        load_scenario("anti_sway", [f"{key}={value}" for key, value in change.items()])


def digest(data):
    return series(READ(data))[-1]


def busy_controllers():
    """A second in which both controllers are at work and at their limits, as plain data."""
    data = plain(load_scenario("heave_compensation"))
    data["duration_s"] = 4.0
    data["environment"]["waves"]["ramp_s"] = 1.0
    data["operations"] = [
        {"label": "slew", "joint": "slew", "from_s": 0.5, "to_s": 2.0, "velocity_rad_s": 0.06},
        {"label": "boom", "joint": "boom", "from_s": 0.5, "to_s": 2.0, "velocity_rad_s": 0.06},
    ]
    data["winch"]["initial_length_m"] = 2.0
    heave, sway = data["controllers"][0], plain(load_scenario("anti_sway"))["controllers"][0]
    heave |= {"enabled_at_s": 1.0, "corner_period_s": 30.0, "accel_max_m_s2": 0.2}
    sway |= {"tip_speed_max_m_s": 0.01}
    data["controllers"] = [heave, sway]
    fast = copy.deepcopy(data)
    fast["controllers"][0] |= {"speed_max_m_s": 0.002, "accel_max_m_s2": 5.0, "enabled_at_s": 0.0}
    return data, fast


def test_every_number_of_the_controllers_changes_a_run():
    stages = busy_controllers()
    known = [digest(stage) for stage in stages]
    silent = []
    for i, controller in enumerate(stages[0]["controllers"]):
        for key, value in controller.items():
            if isinstance(value, float):
                changed = [copy.deepcopy(stage) for stage in stages]
                for stage in changed:
                    now = stage["controllers"][i][key]
                    steps = 0.02 if key == "enabled_at_s" or now == 0.0 else 0.01 * now
                    stage["controllers"][i][key] = now + steps
                if [digest(stage) for stage in changed] == known:
                    silent.append(f"{controller['kind']}.{key}")
    assert silent == []
