"""Laws of the wire."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from wire_rig import swung_state

from shipcrane_twin.physics.wire import pull, wire_loss, wire_stiffness
from shipcrane_twin.validation.lifting_wire import WIRE, stiffness_at, swing

LENGTH, STIFF, LOSS, STATIC = 2.0, 8e6, 40.0, 1e-3
compiled = settings(deadline=None)
vectors = st.tuples(*[st.floats(-2.0, 2.0)] * 3).map(np.array)
rates = st.floats(-0.5, 0.5)


def force_on_load(tip_from_load, velocity, pay_out=0.0, loss=LOSS, turn=lambda v: v):
    force = np.full(3, np.nan)
    load = np.concatenate((turn(np.array([3.0, 1.0, -2.0])), turn(velocity)))
    tip = np.concatenate((load[:3] + turn(tip_from_load), turn(np.array([0.1, 0.2, -0.1]))))
    load[3:] += tip[3:]
    tension = pull(tip, load, LENGTH, pay_out, STIFF, loss, STATIC, force)
    assert tension == pytest.approx(np.linalg.norm(force))
    return force


@compiled
@given(span=vectors, velocity=vectors, pay_out=rates, seed=st.integers(0, 999))
def test_pulls_only_brakes_only_and_ignores_axis_choice(span, velocity, pay_out, seed):
    force = force_on_load(span, velocity, pay_out)
    assert force @ span >= 0.0
    damper = force - force_on_load(span, velocity, pay_out, loss=0.0)
    drum_pull = damper @ span / max(np.linalg.norm(span), 1e-9) * pay_out  # power that the drum takes out
    assert damper @ velocity + drum_pull <= 1e-6 * np.linalg.norm(damper)
    turn = Rotation.random(rng=seed).apply
    turned = force_on_load(span, velocity, pay_out, turn=turn)
    np.testing.assert_allclose(turned, turn(force), atol=1e-6 + 1e-9 * np.linalg.norm(force))


@compiled
@given(span=vectors, velocity=vectors, pay_out=rates)
def test_is_zero_while_slack_and_along_the_wire_while_taut(span, velocity, pay_out):
    force = force_on_load(span, velocity, pay_out)
    if np.linalg.norm(span) < LENGTH - 1e-9:
        np.testing.assert_array_equal(force, np.zeros(3))
    assert np.linalg.norm(np.cross(force, span)) <= 1e-9 * np.linalg.norm(force)


@compiled
@given(velocity=vectors, gap=st.floats(1e-12, 1e-6))
def test_is_continuous_where_it_goes_taut(velocity, gap):
    span = np.array([0.0, 0.0, LENGTH + gap])
    most = STIFF * gap * (1.0 + LOSS * np.linalg.norm(velocity))
    assert np.linalg.norm(force_on_load(span, velocity)) <= most * (1.0 + 1e-3)


def test_resting_pull_is_stiffness_times_stretch():
    force = force_on_load(np.array([0.0, 0.0, LENGTH + 1e-3]), np.zeros(3))
    np.testing.assert_allclose(force, [0.0, 0.0, STIFF * 1e-3], rtol=1e-9)


@compiled
@given(rate=rates)
def test_only_the_rate_of_stretch_is_damped(rate):
    span = np.array([0.0, 0.0, LENGTH + 1e-3])
    still = force_on_load(span, np.zeros(3))
    across, down = np.array([rate, rate, 0.0]), np.array([0.0, 0.0, -rate])
    np.testing.assert_allclose(force_on_load(span, across), still)
    np.testing.assert_allclose(force_on_load(span, down, pay_out=rate), still)


@pytest.mark.parametrize(("stretch", "share"), [(0.25, 0.25), (1.0, 1.0), (8.0, 1.0)])
def test_damping_grows_up_to_the_static_stretch_and_no_further(stretch, share):
    span, opening = np.array([0.0, 0.0, LENGTH + stretch * STATIC]), np.array([0.0, 0.0, -1e-3])
    damper = force_on_load(span, opening) - force_on_load(span, np.zeros(3))
    assert damper[2] == pytest.approx(share * STIFF * STATIC * LOSS * 1e-3, rel=1e-6)


def test_a_coincident_load_feels_nothing():
    np.testing.assert_array_equal(force_on_load(np.zeros(3), np.ones(3)), np.zeros(3))


def test_stiffness_is_that_of_the_metallic_section():
    assert wire_stiffness(8.5e10, 0.02, 0.6, 1.0) == pytest.approx(8.5e10 * 0.6 * np.pi * 0.02**2 / 4.0)
    assert wire_stiffness(8.5e10, 0.02, 0.6, 4.0) == pytest.approx(wire_stiffness(8.5e10, 0.02, 0.6, 1.0) / 4.0)


def test_loss_gives_the_promised_dashpot_at_the_static_stretch():
    stiffness, mass = 1.6e7, 700.0
    loss = wire_loss(stiffness, mass, 0.5, mass * 9.80665)
    stretch = mass * 9.80665 / stiffness
    assert stiffness * stretch * loss == pytest.approx(2.0 * 0.5 * np.sqrt(stiffness * mass))


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.5])
@pytest.mark.parametrize(("length", "mass"), [(1.0, 700.0), (20.0, 2200.0)])
def test_bobbing_load_loses_height_as_its_damping_ratio_says(ratio, length, mass):
    wire = WIRE._replace(damping_ratio=ratio)
    state = swung_state(0.0, length, mass, wire)
    rest, stretch = state[2], mass * wire.gravity / stiffness_at(length)
    state[2] -= 1e-3 * stretch
    damped = np.sqrt(stiffness_at(length) / mass) * np.sqrt(1.0 - ratio**2)
    half = np.pi / damped
    heights = swing(state, half / 200.0, 400, wire)[:, 2] - rest
    decrement = np.log(heights[0] / heights[400])
    assert decrement == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=1e-2)
    assert heights[200] > 0.0 > heights[0]
