"""Load chart, levels, hysteresis, and which motions are refused."""

import numpy as np
import pytest
from palfinger import WORK_POSE, eight_segment_chain

from shipcrane_twin.control.load_limiter import (
    CUT_OUT,
    UTILISATION,
    allowed_commands,
    hoisting_allowed,
    limit_load,
    limiter_step,
    make_limiter,
    radius_and_slopes,
    safe_working_load,
    utilisation,
    warned,
)
from shipcrane_twin.physics.crane_chain import forward_kinematics
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY

CHART = [[2.0, 5000.0], [6.0, 2600.0], [12.0, 1000.0]]
LEVELS = {"warning": 0.9, "cut_out": 1.1, "release": 1.0, "filter_s": 1e-9, "step_s": 0.02}
LIMITER = make_limiter(CHART, **LEVELS)
CUT = np.array([3000.0, 1.2, 1.0])
VELOCITIES, POSITIONS = np.full(4, VELOCITY), np.full(4, POSITION)


def test_safe_working_load_by_hand():
    assert safe_working_load(LIMITER, 1.0) == 5000.0
    assert safe_working_load(LIMITER, 4.0) == 3800.0
    assert safe_working_load(LIMITER, 9.0) == 1800.0
    assert safe_working_load(LIMITER, 12.0) == 1000.0
    assert safe_working_load(LIMITER, 12.01) == 0.0
    assert utilisation(LIMITER, 900.0, 9.0) == 0.5
    assert utilisation(LIMITER, 1.0, 13.0) == np.inf
    assert utilisation(LIMITER, 0.0, 13.0) == 0.0


def test_radius_and_slopes_are_those_of_the_tip():
    chain, step = eight_segment_chain(), 1e-6
    radius, slopes = radius_and_slopes(chain, WORK_POSE)
    tip = forward_kinematics(chain, WORK_POSE)[0][4]
    assert radius == pytest.approx(np.hypot(tip[0], tip[1]))
    for i, unit in enumerate(np.eye(4)):
        ahead, behind = (radius_and_slopes(chain, WORK_POSE + way * step * unit)[0] for way in (1, -1))
        assert slopes[i] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-7)
    assert abs(slopes[0]) < 1e-12


def test_levels_warn_cut_out_and_release_with_hysteresis():
    state, seen = np.zeros(3), []
    for share in (0.85, 0.95, 1.05, 1.15, 1.05, 1.01, 0.99, 1.05):
        state = limiter_step(LIMITER, state, share * 2600.0, 6.0)
        assert state[UTILISATION] == pytest.approx(share)
        seen.append((warned(LIMITER, state), bool(state[CUT_OUT]), hoisting_allowed(state)))
    quiet, warning, cut = (False, False, True), (True, False, True), (True, True, False)
    assert seen == [quiet, warning, warning, cut, cut, cut, warning, warning]


def test_smoothing_lets_a_short_peak_pass():
    slow = make_limiter(CHART, **(LEVELS | {"filter_s": 0.5}))
    state = limiter_step(slow, np.array([2000.0, 0.8, 0.0]), 2.0 * 2600.0, 6.0)
    assert state[0] == pytest.approx(5200.0 - 3200.0 * np.exp(-0.02 / 0.5))
    assert not state[CUT_OUT]


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_only_motions_outward_are_refused(way):
    _, slopes = radius_and_slopes(eight_segment_chain(), WORK_POSE)
    command = way * np.array([0.05, 0.01, 0.01, 0.05])
    _, left = allowed_commands(CUT, slopes, WORK_POSE, VELOCITIES, command)
    outward = slopes * command > 1e-6
    assert outward[1:].any() == (way > 0.0)
    assert not outward[0]
    np.testing.assert_array_equal(left, np.where(outward, 0.0, command))
    mode, left = allowed_commands(CUT, slopes, WORK_POSE, POSITIONS, WORK_POSE + command)
    np.testing.assert_array_equal(mode, np.where(outward, VELOCITY, POSITION))
    np.testing.assert_array_equal(left, np.where(outward, 0.0, WORK_POSE + command))


def test_nothing_is_refused_below_the_cut_out():
    command = np.array([0.05, -0.01, 0.01, 0.05])
    start = np.array([700.0, 0.0, 0.0])
    state, mode, left = limit_load(LIMITER, eight_segment_chain(), start, 700.0, WORK_POSE, VELOCITIES, command)
    assert 0.0 < state[UTILISATION] < 0.9
    np.testing.assert_array_equal(left, command)
    np.testing.assert_array_equal(mode, VELOCITIES)


@pytest.mark.parametrize(
    ("chart", "message"),
    [([[2.0, 5.0], [2.0, 4.0]], "radii are"), ([[2.0, 5.0], [3.0, 6.0]], "loads are")],
)
def test_an_impossible_chart_is_named(chart, message):
    with pytest.raises(ValueError, match=message):
        make_limiter(chart, **LEVELS)
