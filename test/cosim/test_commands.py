"""Joint commands: the operations to the nanosecond, and the operator over them."""

import numpy as np
import pytest

from shipcrane_twin.config.scenario import OperationConfig
from shipcrane_twin.cosim.commands import JointCommands
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY

MS = 1_000_000
MOVES = (
    OperationConfig(label="a", joint="boom", from_s=0.1, to_s=0.3, velocity_rad_s=0.02),
    OperationConfig(label="b", joint="boom", from_s=0.3, to_s=0.5, velocity_rad_s=-0.01),
    OperationConfig(label="c", joint="winch", from_s=0.2, to_s=0.4, velocity_m_s=0.3),
)


def velocities(commands, time_ns, expected):
    mode, values = commands.at(time_ns)
    np.testing.assert_array_equal(mode, VELOCITY)
    np.testing.assert_array_equal(values, expected)


@pytest.fixture
def commands():
    return JointCommands(("slew", "boom"), MOVES)


@pytest.mark.parametrize(
    ("time_ns", "boom"),
    [
        (0, 0.0),
        (100 * MS - 1, 0.0),
        (100 * MS, 0.02),
        (300 * MS - 1, 0.02),
        (300 * MS, -0.01),
        (500 * MS - 1, -0.01),
        (500 * MS, 0.0),
    ],
)
def test_a_move_counts_from_its_start_to_just_before_its_end(commands, time_ns, boom):
    velocities(commands, time_ns, [0.0, boom])


def test_moves_of_other_joints_are_left_out():
    velocities(JointCommands(("winch",), MOVES), 250 * MS, [0.3])
    velocities(JointCommands(("slew",), MOVES), 250 * MS, [0.0])


def test_the_operator_overrides_one_joint_until_the_next_word(commands):
    assert commands.say(["boom"], [0.005]) is None
    velocities(commands, 150 * MS, [0.0, 0.005])
    velocities(commands, 10_000 * MS, [0.0, 0.005])
    assert commands.say(["slew"], [0.01]) is None
    velocities(commands, 150 * MS, [0.01, 0.005])
    assert commands.say(["boom"], [0.0]) is None
    velocities(commands, 150 * MS, [0.01, 0.0])


def test_other_peoples_joints_are_passed_over(commands):
    assert commands.say(["winch", "boom"], [0.4, 0.003]) is None
    velocities(commands, 0, [0.0, 0.003])


@pytest.mark.parametrize(
    ("names", "speeds", "said"),
    [
        (["boom", "slew"], [0.1], "2 names but 1 velocities; expected one velocity per name"),
        ([], [0.1], "0 names but 1 velocities"),
        (["boom"], [float("nan")], "expected finite numbers"),
        (["boom"], [float("inf")], "expected finite numbers"),
        (["slew", "boom"], [0.1, float("nan")], "expected finite numbers"),
        (["boom", "boom"], [0.1, 0.2], "expected every joint once"),
    ],
)
def test_a_faulty_word_is_refused_and_changes_nothing(commands, names, speeds, said):
    assert said in commands.say(names, speeds)
    velocities(commands, 150 * MS, [0.0, 0.02])


@pytest.mark.parametrize(
    ("names", "speeds", "places", "said"),
    [
        (["boom"], [0.1], [0.2], "1 velocities and 1 positions; expected one of the two arrays filled"),
        (["boom", "slew"], [], [0.1], "2 names but 1 positions; expected one position per name"),
        (["boom"], [], [float("nan")], "positions [nan]; expected finite numbers"),
        (["boom", "winch"], [], [0.1, 5.0], "a position for winch, which a controller steers; expected a velocity"),
    ],
)
def test_a_faulty_position_is_refused_and_changes_nothing(names, speeds, places, said):
    commands = JointCommands(("slew", "boom"), MOVES, by_speed=("winch",))
    assert said in commands.say(names, speeds, places)
    velocities(commands, 150 * MS, [0.0, 0.02])


def test_a_position_counts_until_the_next_word(commands):
    assert commands.say(["boom"], (), [0.4]) is None
    mode, values = commands.at(150 * MS)
    np.testing.assert_array_equal(mode, [VELOCITY, POSITION])
    np.testing.assert_array_equal(values, [0.0, 0.4])
    assert commands.say(["boom"], [0.0]) is None
    velocities(commands, 150 * MS, [0.0, 0.0])


def test_an_operation_may_tell_a_position():
    move = OperationConfig(label="in", joint="winch", from_s=0.1, to_s=0.2, position_m=3.0)
    commands = JointCommands(("winch",), (move,))
    mode, values = commands.at(100 * MS)
    assert (mode[0], values[0]) == (POSITION, 3.0)
    velocities(commands, 200 * MS, [0.0])


@pytest.fixture
def tip():
    return JointCommands(("slew", "boom"), MOVES, tip_timeout_s=0.5)


def test_a_word_for_the_tip_counts_for_its_time_and_then_the_joints_stand(tip):
    assert tip.tip_at(0) is None
    assert tip.say_tip("map", [0.1, 0.0, -0.2]) is None
    for time_ns in (100 * MS, 599 * MS):
        frame, velocity = tip.tip_at(time_ns)
        assert frame == "map"
        np.testing.assert_array_equal(velocity, [0.1, 0.0, -0.2])
    assert tip.tip_at(600 * MS) is None
    assert tip.tip_at(100 * MS) is None
    velocities(tip, 150 * MS, [0.0, 0.0])  # not what the operations said


def test_the_last_word_counts_of_tip_and_joints(tip):
    tip.say_tip("crane_base", [0.1, 0.0, 0.0])
    tip.say(["winch"], [0.1])  # is not one of these joints
    assert tip.tip_at(0) is not None
    tip.say(["boom"], [0.01])
    assert tip.tip_at(0) is None
    velocities(tip, 0, [0.0, 0.01])
    tip.say_tip("crane_base", [0.1, 0.0, 0.0])
    velocities(tip, 0, [0.0, 0.0])


@pytest.mark.parametrize(
    ("frame", "velocity", "said"),
    [
        ("crane_tip", [0.1, 0.0, 0.0], "its frame is 'crane_tip', expected crane_base or map"),
        ("", [0.1, 0.0, 0.0], "its frame is ''"),
        ("map", [0.1, float("inf"), 0.0], "expected finite numbers"),
    ],
)
def test_a_faulty_word_for_the_tip_is_refused_and_changes_nothing(tip, frame, velocity, said):
    assert said in tip.say_tip(frame, velocity)
    assert tip.tip_at(0) is None
    velocities(tip, 150 * MS, [0.0, 0.02])
