"""Azimuth sectors: arcs and pieces cover what zones leave, and turns never lead through a zone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.control.azimuth_sectors import (
    allowed_arcs,
    arc_place,
    convex_pieces,
    padded,
    reach,
    turn_towards,
)
from shipcrane_twin.physics.frames import wrap_angle

compiled = settings(deadline=None, max_examples=60)
ZONES = [(0.5, 0.3), (-2.0, 0.6)]
ONE = padded([allowed_arcs(ZONES[:1])])[0]
TWO = padded([allowed_arcs(ZONES)])[0]
CIRCLE = padded([allowed_arcs([])])[0]
angles = st.floats(-3.14, 3.14)


def in_some_zone(azimuth, zones):
    return any(abs((azimuth - centre + np.pi) % (2.0 * np.pi) - np.pi) < half for centre, half in zones)


@compiled
@given(azimuth=angles)
def test_an_azimuth_is_in_an_arc_and_in_a_convex_piece_or_in_a_zone(azimuth):
    if any(abs(abs(wrap_angle(azimuth - centre)) - half) < 1e-9 for centre, half in ZONES):
        return  # on a border it is in both
    free = not in_some_zone(azimuth, ZONES)
    assert (arc_place(TWO, azimuth)[0] >= 0) == free
    pieces = convex_pieces(allowed_arcs(ZONES))
    assert any((azimuth - start) % (2.0 * np.pi) <= width for start, width in pieces) == free
    assert all(width <= np.pi for _, width in pieces)


@compiled
@given(present=angles, goal=angles)
def test_a_turn_arrives_and_never_passes_the_zone(present, goal):
    if in_some_zone(present, ZONES[:1]) or in_some_zone(goal, ZONES[:1]):
        return
    gap, _, low, high = turn_towards(ONE, present, goal, 0.0)
    assert low - 1e-9 <= gap <= high + 1e-9
    assert np.cos(present + gap - goal) == pytest.approx(1.0)
    assert not any(in_some_zone(present + part * gap, [(0.5, 0.3 - 1e-6)]) for part in np.linspace(0.0, 1.0, 50))


def test_a_long_turn_under_way_goes_on_until_the_other_way_is_a_quarter():
    gap, latch, *_ = turn_towards(CIRCLE, 0.0, 3.0, 0.0)
    assert (gap, latch) == (pytest.approx(3.0), 1.0)
    gap, latch, *_ = turn_towards(CIRCLE, 0.0, -3.0, 1.0)
    assert (gap, latch) == (pytest.approx(2.0 * np.pi - 3.0), 1.0)
    gap, latch, *_ = turn_towards(CIRCLE, 0.0, -1.0, 1.0)
    assert (gap, latch) == (pytest.approx(-1.0), 0.0)


@compiled
@given(gap=st.floats(-6.0, 6.0))
def test_reach_is_within_the_step_comes_nearer_and_ends_within_a_step_of_the_goal_once_near(gap):
    low, high = reach(gap, 0.02)
    assert -0.02 <= low <= high <= 0.02
    for turn in (low, high):
        assert abs(gap - turn) <= max(abs(gap) - 0.02, 0.02) + 1e-12


@pytest.mark.parametrize("zones", [[(0.0, 0.0)], [(0.0, 4.0)], [(0.0, 0.5), (0.4, 0.5)]])
def test_zones_that_make_no_sense_are_told(zones):
    with pytest.raises(ValueError, match="zone"):
        allowed_arcs(zones)
