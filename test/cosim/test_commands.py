"""Joint commands: the operations to the nanosecond, and the operator over them."""

import numpy as np
import pytest

from shipcrane_twin.config.scenario import OperationConfig
from shipcrane_twin.cosim.commands import JointCommands

MS = 1_000_000
MOVES = (
    OperationConfig(label="a", joint="boom", from_s=0.1, to_s=0.3, velocity_rad_s=0.02),
    OperationConfig(label="b", joint="boom", from_s=0.3, to_s=0.5, velocity_rad_s=-0.01),
    OperationConfig(label="c", joint="winch", from_s=0.2, to_s=0.4, velocity_m_s=0.3),
)


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
    np.testing.assert_array_equal(commands.at(time_ns), [0.0, boom])


def test_moves_of_other_joints_are_left_out():
    np.testing.assert_array_equal(JointCommands(("winch",), MOVES).at(250 * MS), [0.3])
    np.testing.assert_array_equal(JointCommands(("slew",), MOVES).at(250 * MS), [0.0])


def test_the_operator_overrides_one_joint_until_the_next_word(commands):
    assert commands.say(["boom"], [0.005]) is None
    np.testing.assert_array_equal(commands.at(150 * MS), [0.0, 0.005])
    np.testing.assert_array_equal(commands.at(10_000 * MS), [0.0, 0.005])
    assert commands.say(["slew"], [0.01]) is None
    np.testing.assert_array_equal(commands.at(150 * MS), [0.01, 0.005])
    assert commands.say(["boom"], [0.0]) is None
    np.testing.assert_array_equal(commands.at(150 * MS), [0.01, 0.0])


def test_other_peoples_joints_are_passed_over(commands):
    assert commands.say(["winch", "boom"], [0.4, 0.003]) is None
    np.testing.assert_array_equal(commands.at(0), [0.0, 0.003])


@pytest.mark.parametrize(
    ("names", "velocities", "said"),
    [
        (["boom", "slew"], [0.1], "2 names but 1 velocities; expected one velocity per name"),
        ([], [0.1], "0 names but 1 velocities"),
        (["boom"], [float("nan")], "expected finite numbers"),
        (["boom"], [float("inf")], "expected finite numbers"),
        (["slew", "boom"], [0.1, float("nan")], "expected finite numbers"),
    ],
)
def test_a_faulty_word_is_refused_and_changes_nothing(commands, names, velocities, said):
    assert said in commands.say(names, velocities)
    np.testing.assert_array_equal(commands.at(150 * MS), [0.0, 0.02])
