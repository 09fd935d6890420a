"""Anti-sway on a linear pendulum: residual sway and damping against closed forms, travel, limits, geometry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.control.anti_sway import (
    anti_sway_start,
    anti_sway_step,
    half_period,
    make_anti_sway,
    sway_offset,
)

STEP_S, GRAVITY, RADIUS_M, SPEED = 0.02, 9.81, 10.0, 0.02
LEVER = np.array([RADIUS_M, -4.0])
LONG_S = 1e6


def params(damping_ratio=0.0, mean_time_s=LONG_S, **changes):
    values = {
        "tip_speed_max": 10.0,
        "rate_max": np.array([0.5, 0.5]),
        "length_min": 0.5,
        "length_max": 60.0,
        "gravity": GRAVITY,
        "period": STEP_S,
        "crane_base": np.array([5.0, -3.0, 6.0]),
        "pivot_height": 2.0,
        "boom_sign": 1.0,
    }
    return make_anti_sway(damping_ratio=damping_ratio, mean_time_s=mean_time_s, **(values | changes))


def pendulum(constants, wanted, length, duration_s, believed=None, offset=(0.0, 0.0), joint=0):
    """Return offset (n,) and rate (n,) at the end of each period, the pivot driven through the controller.

    Between samples the pivot's speed is constant, so ``s'' + omega^2 s = -v'`` is stepped exactly: free swings
    with a kick of minus the change of speed at each sample.
    """
    omega = np.sqrt(GRAVITY / length)
    turn = np.array([[np.cos(omega * STEP_S), np.sin(omega * STEP_S) / omega],
                     [-omega * np.sin(omega * STEP_S), np.cos(omega * STEP_S)]])  # fmt: skip
    state, speed = anti_sway_start(constants), 0.0
    sway, turned = np.array(offset, dtype=float), 0.0
    out = []
    for k in range(round(duration_s / STEP_S)):
        seen, rates = np.zeros(2), np.zeros(2)
        seen[joint], rates[joint] = sway[0], wanted(k * STEP_S)
        state, said = anti_sway_step(constants, state, rates, believed or length, seen, LEVER)
        after = said[joint] * LEVER[joint]
        sway = turn @ (sway - np.array([0.0, after - speed]))
        speed = after
        turned += said[joint] * STEP_S
        out.append((sway[0], sway[1], turned))
    offset_, rate, angle = np.array(out).T
    return np.hypot(offset_, rate / omega), angle


def start_only(t):
    return SPEED


def go_and_stop(until_s):
    return lambda t: SPEED if t < until_s else 0.0


PLAIN = SPEED * RADIUS_M  # over omega: the swing that the unshaped step of speed leaves


@pytest.mark.parametrize("damping_ratio", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("length", [3.0, 12.0])
def test_a_step_of_speed_leaves_no_swing(damping_ratio, length):
    swing, _ = pendulum(params(damping_ratio), start_only, length, 25.0)
    late = round(1.2 * half_period(length, GRAVITY, damping_ratio) / STEP_S) + 3
    assert swing[late:].max() < 0.02 * PLAIN * np.sqrt(length / GRAVITY)


@pytest.mark.parametrize("wrong_by", [0.8, 0.9, 1.2])
def test_with_a_wrong_length_the_closed_form_of_the_shaper_is_left(wrong_by):
    """Two equal steps half a believed period apart leave ``|cos(pi/2 believed/true)|`` of one step's swing."""
    length = 10.0
    swing, _ = pendulum(params(), start_only, length, 20.0, believed=length * wrong_by**2)
    expected = abs(np.cos(0.5 * np.pi * wrong_by)) * PLAIN * np.sqrt(length / GRAVITY)
    assert swing[-1] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("joint", [0, 1])
@pytest.mark.parametrize("damping_ratio", [0.05, 0.2])
def test_feedback_gives_the_pendulum_its_damping_ratio(damping_ratio, joint):
    length = 8.0
    swing, _ = pendulum(params(damping_ratio), lambda t: 0.0, length, 40.0, offset=(0.3, 0.0), joint=joint)
    omega_d = np.sqrt(GRAVITY / length * (1.0 - damping_ratio**2))
    periods = 2 if damping_ratio > 0.1 else 4
    every = round(2.0 * np.pi * periods / omega_d / STEP_S)
    decrement = np.log(swing[10] / swing[10 + every]) / (2.0 * np.pi * periods)
    # the sample is held for a period and half of it: that takes a little of the damping
    assert decrement == pytest.approx(damping_ratio / np.sqrt(1.0 - damping_ratio**2), rel=0.05)


@given(
    moves=st.lists(st.tuples(st.floats(0.1, 4.0), st.floats(-0.3, 0.3)), min_size=1, max_size=6),
    lengths=st.lists(st.floats(1.0, 40.0), min_size=2, max_size=2),
)
@settings(deadline=None, max_examples=20)
def test_the_crane_arrives_where_the_operator_sent_it_though_the_wire_changes(moves, lengths):
    constants = params()
    state, asked, turned = anti_sway_start(constants), 0.0, 0.0
    commands = [rate for duration, rate in moves for _ in range(round(duration / STEP_S))] + [0.0] * 2000
    for k, rate in enumerate(commands):
        length = np.interp(k, [0, len(commands) - 800], lengths)
        state, said = anti_sway_step(constants, state, np.array([rate, 0.0]), length, np.zeros(2), LEVER)
        asked, turned = asked + rate * STEP_S, turned + said[0] * STEP_S
    assert turned == pytest.approx(asked, abs=1e-9)


def test_from_rest_to_rest_feedback_adds_no_travel():
    _, angle = pendulum(params(0.2), go_and_stop(10.0), 6.0, 60.0)
    assert angle[-1] == pytest.approx(10.0 * SPEED, abs=1e-4)


def test_a_lasting_offset_is_taken_for_wind_and_not_followed():
    constants = params(0.2, mean_time_s=20.0)
    state = anti_sway_start(constants)
    said = [np.zeros(2)]
    for _ in range(round(200.0 / STEP_S)):
        state, rates = anti_sway_step(constants, state, np.zeros(2), 8.0, np.array([0.5, -0.2]), LEVER)
        said.append(rates)
    assert said[1][0] > 1e-3
    assert said[1][1] > 1e-3  # outward is against a lever that is negative
    assert np.abs(said[-1]).max() < 1e-4 * np.abs(said[1]).max()


@given(
    steps=st.lists(
        st.tuples(*[st.floats(-1e9, 1e9)] * 2, st.floats(0.0, 1e4), *[st.floats(-1e4, 1e4)] * 2, st.floats(-20, 20)),
        min_size=1,
        max_size=60,
    )
)
@settings(deadline=None, max_examples=50)
def test_no_command_sway_or_length_makes_a_rate_exceed_its_limit(steps):
    constants = params(0.3, rate_max=np.array([0.05, 0.03]), mean_time_s=10.0)
    state = anti_sway_start(constants)
    for slew, boom, length, along, outward, lever in steps:
        seen = np.array([along, outward])
        state, rates = anti_sway_step(constants, state, np.array([slew, boom]), length, seen, np.array([5.0, lever]))
        assert np.all(np.abs(rates) <= constants.rate_max)


def test_tip_speed_of_the_feedback_is_bounded():
    constants = params(0.5, tip_speed_max=0.1)
    _, rates = anti_sway_step(constants, anti_sway_start(constants), np.zeros(2), 2.0, np.array([5.0, 5.0]), LEVER)
    np.testing.assert_allclose(rates * LEVER, 0.1)


def ship(roll=0.1, pitch=-0.05, yaw=0.7):
    turn = Rotation.from_euler("ZYX", [yaw, pitch, roll])
    odom = np.concatenate(([100.0, -50.0, 3.0], turn.as_quat(), np.zeros(6)))
    return odom, turn


def test_a_load_that_hangs_still_from_a_heeled_ship_has_no_offset():
    odom, turn = ship()
    tip_w = odom[:3] + turn.apply([10.0, -8.0, 12.0])
    offset, _ = sway_offset(params(), odom, tip_w, tip_w - [0.0, 0.0, 7.0])
    np.testing.assert_allclose(offset, 0.0, atol=1e-12)


def test_offsets_are_along_the_circle_and_outward():
    constants = params()
    odom, turn = ship(roll=0.0, pitch=0.0)
    tip_b = np.array([5.0, -3.0, 6.0]) + [0.0, -9.0, 5.0]  # over the starboard side
    tip_w = odom[:3] + turn.apply(tip_b)
    for shift_b, expected in (([0.3, 0.0, 0.0], (0.3, 0.0)), ([0.0, 0.2, 0.0], (0.0, -0.2))):
        load_w = tip_w + turn.apply(np.array(shift_b) - [0.0, 0.0, 6.0])
        offset, lever = sway_offset(constants, odom, tip_w, load_w)
        np.testing.assert_allclose(offset, expected, atol=1e-12)
        np.testing.assert_allclose(lever, (9.0, -3.0))


def test_a_tip_over_the_slew_axis_has_no_directions():
    odom, _ = ship(roll=0.0, pitch=0.0, yaw=0.0)
    offset, lever = sway_offset(params(), odom, odom[:3] + [5.0, -3.0, 15.0], odom[:3])
    assert not offset.any()
    assert not lever.any()


@pytest.mark.parametrize(
    "wrong", [{"damping_ratio": 1.0}, {"mean_time_s": 0.01}, {"length_min": 0.0}, {"length_min": 1e-5}, {"period": 0.0}]
)
def test_constants_that_cannot_be_are_refused(wrong):
    with pytest.raises(ValueError, match="anti-sway"):
        params(**wrong)
