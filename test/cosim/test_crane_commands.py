"""The crane and the winch as a run steps them: positions, tip velocities, load limiter, lost power, what is told."""

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.controllers import inputs_of, topics_of
from shipcrane_twin.cosim.inline import InlineRun

STILL = ["environment.waves.systems=[]", "operations=[]", "events=[]", "duration_s=40.0"]
ENDLESS = "operations=[{{label: a, joint: {0}, from_s: 1.0, to_s: 40.0, {1}}}]"
REACH = "crane.initial_joints=[-1.5708, 0.3, 1.1, 4.774]"
OVERLOAD = ["payload.mass_kg=5900.0", "winch.drum.motor_torque_n_m=300.0", REACH]


def start(*overrides, name="case2"):
    return InlineRun(load_scenario(name, [*STILL, *overrides]))


def finish(run):
    """Run to the end and return joints and paid-out length as telemetry tells them (n, 5)."""
    rows = []
    for _ in run.steps():
        rows.append(np.append(run.latest["/crane/joint_states"][:4], run.latest["/winch/joint_states"][0]))
    return np.array(rows)


@pytest.mark.parametrize(
    ("joint", "column", "goal"),
    [("slew", 0, "position_rad: -1.3"), ("boom", 1, "position_rad: 0.3"), ("telescope", 3, "position_m: 4.0")]
    + [("winch", 4, "position_m: 4.0")],
)
def test_a_position_is_reached_without_overshoot(joint, column, goal):
    rows = finish(start(ENDLESS.format(joint, goal)))[:, column]
    wanted = float(goal.split()[-1])
    assert rows[-1] == pytest.approx(wanted, abs=3e-3)
    assert rows.max() < wanted + 5e-3


def test_what_was_applied_is_told_as_position_or_velocity():
    run = start(ENDLESS.format("boom", "position_rad: 0.3"), "duration_s=3.0")
    finish(run)
    applied = run.latest["/crane/joint_command_applied"]
    np.testing.assert_array_equal(applied[[1, 5]], [0.3, 0.0])
    run = start(ENDLESS.format("winch", "velocity_m_s: 0.2"), "duration_s=3.0")
    finish(run)
    np.testing.assert_allclose(run.latest["/winch/joint_command_applied"], [run.latest["/winch/joint_states"][0], 0.2])


@pytest.mark.parametrize("frame", ["crane_base", "map"])
def test_the_tip_goes_where_it_is_told_and_stands_after_the_time_out(frame):
    run = start("duration_s=10.0", "crane.servo.tip_command_timeout_s=4.0")
    velocity = np.array([0.05, 0.0, 0.03])  # aft to forward; north for a ship that heads north
    tips = {}
    for k in run.steps():
        time_s = k * 0.02
        if k == 50:
            told = velocity if frame == "crane_base" else np.array([0.0, 0.05, 0.03])
            assert run.subsystem("crane").say_tip(frame, told) is None
        tips[round(time_s, 2)] = run.latest["/crane/tip"][:3].copy() - run.latest["/vessel/odom"][:3]
    moved = tips[4.5] - tips[2.5]
    assert moved[1] == pytest.approx(2.0 * velocity[0], abs=0.02)
    assert moved[2] == pytest.approx(2.0 * velocity[2], abs=0.02)
    assert np.linalg.norm(tips[10.0] - tips[8.0]) < 0.02


def test_a_controller_in_the_operators_place_takes_no_words_for_the_tip():
    run = InlineRun(load_scenario("anti_sway"))
    said = run.subsystem("crane").say_tip("map", [0.1, 0.0, 0.0])
    assert said == "anti_sway steers joints of the crane; expected commands of joints"
    said = run.subsystem("crane").commands.say(["slew"], (), [0.1])
    assert "which a controller steers" in said


@pytest.mark.parametrize(("pay_out", "moves"), [(-0.2, False), (0.2, True)])
def test_a_winch_of_a_crane_that_is_cut_out_lowers_but_does_not_hoist(pay_out, moves):
    run = start(*OVERLOAD, ENDLESS.format("winch", f"velocity_m_s: {pay_out}"), "duration_s=5.0",
                "winch.initial_length_m=3.0")  # fmt: skip
    rows = finish(run)[:, 4]
    assert run.latest["/crane/load_state"][4] == 1.0
    assert (abs(rows[-1] - rows[0]) > 0.5) == moves
    refused = any("hoisting refused" in line for line in run.subsystem("payload").warnings())
    assert refused != moves
    assert any("overload cut-out" in line for line in run.subsystem("crane").warnings())
    assert run.subsystem("crane").condition()["cut_out"] == "yes"


def test_a_position_that_hoists_is_refused_as_well():
    run = start(*OVERLOAD, ENDLESS.format("winch", "position_m: 1.0"), "duration_s=5.0", "winch.initial_length_m=3.0")
    rows = finish(run)[:, 4]
    assert abs(rows[-1] - rows[0]) < 0.05


def test_a_limiter_that_is_off_refuses_nothing():
    run = start(*OVERLOAD, ENDLESS.format("winch", "velocity_m_s: -0.2"), "duration_s=5.0",
                "winch.initial_length_m=3.0", "crane.load_limiter.enabled=false")  # fmt: skip
    rows = finish(run)[:, 4]
    assert rows[-1] < rows[0] - 0.5
    assert run.latest["/crane/load_state"][4] == 0.0


def test_a_warning_comes_before_the_cut_out():
    run = start("payload.mass_kg=5000.0", REACH, "duration_s=1.0")
    finish(run)
    assert run.latest["/crane/load_state"][3] == pytest.approx(5000.0 / 5300.0, abs=0.02)
    assert [line.split(":")[0] for line in run.subsystem("crane").warnings()] == ["overload warning"]


def test_without_power_the_brakes_of_crane_and_winch_hold():
    run = start(
        ENDLESS.format("winch", "velocity_m_s: 0.2").replace("]", ", {label: b, joint: boom, from_s: 1.0, to_s: 40.0,"
        " velocity_rad_s: 0.02}]"),
        "events=[{label: dark, at_s: 3.0, event: power_failure}]",
        "duration_s=8.0",
    )  # fmt: skip
    rows = finish(run)
    assert np.abs(rows[-1] - rows[250])[[1, 4]].max() < 2e-3
    assert rows[140, 4] > rows[0, 4] + 0.1
    assert "the drives have no power: the brakes hold" in run.subsystem("crane").warnings()
    assert "the winch has no power: the brake holds" in run.subsystem("payload").warnings()
    assert run.subsystem("crane").condition()["braked"] == "slew, boom, knuckle, telescope"


def test_a_joint_at_its_end_is_told_for_a_while():
    run = start(ENDLESS.format("boom", "velocity_rad_s: 0.02").replace("40.0", "39.0"), "duration_s=42.0",
                "crane.initial_joints.1=0.8")  # fmt: skip
    told = []
    for _ in run.steps():
        told.append("boom at its end" in run.subsystem("crane").warnings())
    assert not told[60]
    assert told[39 * 50 - 10]
    assert told[40 * 50]
    assert not told[-1]


def test_topics_of_another_crane_have_its_joints():
    topics = {topic.name: topic.joints for topic in topics_of(load_scenario("subsea_lift"))}
    own = ("slew", "boom", "knuckle")
    assert topics["/crane/joint_states"] == (*own, "boom_cylinder", "knuckle_cylinder")
    assert topics["/crane/joint_command_applied"] == own
    assert topics["/crane/joint_command"] == (*own, "winch")


def test_the_load_sees_the_ship_when_it_may_touch_it():
    assert "/vessel/odom" in inputs_of(load_scenario("quay_pickup"))["payload"]
    assert "/vessel/odom" not in inputs_of(load_scenario("splash_zone"))["payload"]


@pytest.mark.parametrize("name", ["splash_zone", "quay_pickup"])
def test_a_box_hangs_still_under_a_still_crane(name):
    run = start("duration_s=12.0", name=name) if name == "splash_zone" else InlineRun(
        load_scenario(name, ["duration_s=60.0"])
    )  # fmt: skip
    tension = []
    for _ in run.steps():
        tension.append(np.linalg.norm(run.latest["/payload/wire_wrench"][:3]))
    last = np.array(tension[-200:])
    assert last.std() < 0.02 * last.mean()
    assert run.subsystem("payload").events()["snaps"] <= 3.0
