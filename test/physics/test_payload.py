"""The load on its wire: energy, pendulum, moving pivot, momentum, release."""

import itertools

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from wire_rig import energies, hoist, swung_state

from shipcrane_twin.physics.payload import hanging_state, micro_steps, place_tip
from shipcrane_twin.physics.wire import STEP_MIN
from shipcrane_twin.validation.lifting_wire import (
    FIXED,
    SHARES,
    WIRE,
    held_step,
    pendulum,
    stiffness_at,
    sway_gain,
    swing,
)

compiled = settings(deadline=None)
UNDAMPED = WIRE._replace(damping_ratio=0.0)


@pytest.mark.parametrize("step_s", [0.005, 0.02, 0.05])
@pytest.mark.parametrize("length", [1.0, 10.0])
def test_undamped_load_keeps_its_energy_over_a_minute(length, step_s, measured):
    states = swing(swung_state(1.0, length, 700.0), step_s, round(60.0 / step_s), UNDAMPED)
    kinetic, total = energies(states)
    exchanged = np.ptp(kinetic)
    assert exchanged > 3000.0
    name = f"energy of the undamped load over 60 s, wire {length:g} m, H = {1e3 * step_s:g} ms"
    measured(f"{name}: drift over exchanged", np.abs(total - total[0]).max() / exchanged, 1e-6)


@pytest.mark.parametrize("angle_deg", [5.0, 60.0])
@pytest.mark.parametrize("length", [1.0, 10.0])
def test_pendulum_has_the_period_of_the_elliptic_integral(angle_deg, length, measured):
    angle, step_s = np.deg2rad(angle_deg), 0.01
    static = length + 700.0 * WIRE.gravity / stiffness_at(length)
    period = 4.0 * np.sqrt(static / WIRE.gravity) * ellipk(np.sin(0.5 * angle) ** 2)
    sway = swing(swung_state(angle, length, 700.0), step_s, round(3.3 * period / step_s))[:, 0] - FIXED[0]
    falls = np.flatnonzero((sway[:-1] > 0.0) & (sway[1:] <= 0.0))
    crossings = step_s * (falls + sway[falls] / (sway[falls] - sway[falls + 1]))
    assert len(crossings) == 4
    name = f"pendulum period at {angle_deg:g} deg, wire {length:g} m, against the elliptic integral"
    measured(name, np.abs(np.diff(crossings) / period - 1.0).max(), 1e-3)


class MovingTip:
    """A tip on a smooth path with exact velocity."""

    amplitude = np.array([0.6, 0.3, 0.2])
    rate = np.array([1.1, 1.7, 1.4])

    def at(self, t):
        position = FIXED[:3] + self.amplitude * (1.0 - np.cos(self.rate * t))
        return np.concatenate((position, self.amplitude * self.rate * np.sin(self.rate * t)))


def exact_load(tip, start, times):
    """Path of the load by an independent solver; wire law written out again."""
    length, mass = start[6], start[8]
    stiffness = 8.5e10 * 0.6 * np.pi * 0.02**2 / 4.0 / length
    loss = 2.0 * 0.5 * np.sqrt(stiffness * mass) / (mass * 9.80665)

    def rate(t, y):
        pivot = tip.at(t)
        span, opening = pivot[:3] - y[:3], pivot[3:] - y[3:]
        reach = np.linalg.norm(span)
        stretch, stretch_rate = reach - length, span @ opening / reach
        damped = loss * min(stretch, mass * 9.80665 / stiffness) * stretch_rate
        tension = stiffness * max(0.0, stretch + damped) if stretch > 0.0 else 0.0
        return np.concatenate((y[3:], tension / mass * span / reach - [0.0, 0.0, 9.80665]))

    return solve_ivp(rate, (0.0, times[-1]), start[:6], "DOP853", times, rtol=1e-9, atol=1e-10).y.T


def test_load_sways_under_a_moving_tip_as_an_independent_solver_says():
    tip, step_s, mass = MovingTip(), 0.02, 2200.0
    times = np.arange(0.0, 8.0 + 1e-9, step_s)
    state = hanging_state(WIRE, tip.at(0.0)[:3], np.zeros(3), 5.0, mass)
    exact = exact_load(tip, state, times)
    path = [state]
    for t in times[:-1]:
        path.append(held_step(WIRE, path[-1], tip.at(t), tip.at(t + step_s), step_s)[0])
    path = np.array(path)
    assert np.ptp(path[:, 0]) > 1.0
    np.testing.assert_allclose(path[:, :3], exact[:, :3], atol=1e-6)
    np.testing.assert_allclose(path[:, 3:6], exact[:, 3:], atol=1e-5)


@compiled
@given(seed=st.integers(0, 9999), step_s=st.floats(0.005, 0.1))
def test_mean_force_on_the_tip_balances_the_loads_momentum(seed, step_s):
    rng = np.random.default_rng(seed)
    state = swung_state(rng.uniform(0.0, 1.2), rng.uniform(0.5, 20.0), rng.uniform(50.0, 5000.0))
    state[:3] += rng.normal(size=3) * 1e-3
    state[3:6] = rng.normal(size=3) * 0.3
    after = FIXED + np.concatenate((rng.normal(size=3) * 1e-3, rng.normal(size=3) * 0.1))
    new, tip_force, _ = held_step(WIRE, state, FIXED, after, step_s, rng.uniform(-0.5, 0.5))
    weight = np.array([0.0, 0.0, -WIRE.gravity])
    impulse = state[8] * (new[3:6] - state[3:6] - weight * step_s)
    np.testing.assert_allclose(-tip_force * step_s, impulse, atol=1e-9 * (1.0 + state[8]))


def test_hanging_load_stays_and_pulls_with_its_weight():
    state = hanging_state(WIRE, FIXED[:3], np.zeros(3), 3.0, 700.0)
    for _ in range(100):
        state, tip_force, tension = held_step(WIRE, state, FIXED, FIXED, 0.02)
    np.testing.assert_allclose(tip_force, [0.0, 0.0, -700.0 * WIRE.gravity], rtol=1e-9, atol=1e-9)
    assert tension == pytest.approx(700.0 * WIRE.gravity, rel=1e-9)
    np.testing.assert_allclose(state[3:6], 0.0, atol=1e-12)


def test_released_load_leaves_the_hook_to_spring_up_and_hang():
    state = hanging_state(WIRE, FIXED[:3], np.zeros(3), 5.0, 700.0)
    state[8] = 50.0
    states = swing(state, 0.02, 500)
    hanging = FIXED[2] - 5.0 - 50.0 * WIRE.gravity / stiffness_at(5.0)
    assert state[2] < hanging < states[:, 2].max()
    assert states[-1, 2] == pytest.approx(hanging, abs=1e-9)
    _, tip_force, _ = held_step(WIRE, states[-1], FIXED, FIXED, 0.02)
    assert -tip_force[2] == pytest.approx(50.0 * WIRE.gravity, rel=1e-6)


@settings(deadline=None, max_examples=60)
@given(
    log_length=st.floats(np.log(0.2), np.log(100.0)),
    log_mass=st.floats(0.0, np.log(5e4)),
    step_s=st.floats(0.001, 0.2),
    seed=st.integers(0, 999),
)
@example(log_length=np.log(0.2), log_mass=0.0, step_s=0.2, seed=0)
@example(log_length=np.log(100.0), log_mass=np.log(5e4), step_s=0.2, seed=1)
@example(log_length=np.log(0.2), log_mass=np.log(5e4), step_s=0.2, seed=2)
@example(log_length=np.log(100.0), log_mass=0.0, step_s=0.001, seed=3)
def test_no_length_mass_or_step_blows_up(log_length, log_mass, step_s, seed):
    rng = np.random.default_rng(seed)
    length, mass = np.exp(log_length), np.exp(log_mass)
    state = swung_state(rng.uniform(-1.0, 1.0), length, mass)
    state[:3] -= (state[:3] - FIXED[:3]) * rng.uniform(-1e-3, 1e-2)  # from overstretched to slack
    state[3:6] = rng.normal(size=3) * 0.5
    _, total = energies(swing(state, step_s, 40))
    scale = mass * WIRE.gravity * length
    assert np.diff(total).max() <= 1e-4 * scale


def test_micro_steps_resolve_the_vibration_and_never_exceed_their_limit():
    for length, mass in [(0.2, 50.0), (1.0, 50.0), (1.0, 700.0), (100.0, 5e4)]:
        count = micro_steps(WIRE, length, mass, 0.02)
        assert 0.02 / count <= WIRE.micro_step_max * (1.0 + 1e-9)
        assert 0.02 / count * np.sqrt(stiffness_at(length) / mass) <= WIRE.phase_max * (1.0 + 1e-9)
    assert micro_steps(WIRE, 1.0, 700.0, 0.02) == 20


@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
def test_micro_steps_stay_few_however_light_the_load(step_s):
    for length, mass in itertools.product((0.2, 1.0, 100.0), (1e-3, 1.0, 50.0)):
        assert micro_steps(WIRE, length, mass, step_s) <= round(step_s / STEP_MIN)
    assert micro_steps(WIRE, 0.2, 1.0, step_s) == round(step_s / STEP_MIN)


def test_a_light_load_hangs_where_the_bare_wire_holds_it_to_micrometres():
    for length, mass in itertools.product((0.2, 1.0, 100.0), (1.0, 10.0, 50.0)):
        hanging = FIXED[2] - length - mass * WIRE.gravity / stiffness_at(length)
        assert hanging_state(WIRE, FIXED[:3], np.zeros(3), length, mass)[2] == pytest.approx(hanging, abs=2e-6)


def test_tip_path_meets_both_ends_and_its_velocity_is_its_slope():
    rng = np.random.default_rng(1)
    prev, after, tip = rng.normal(size=6), rng.normal(size=6), np.empty(6)
    for part, end in ((0.0, prev), (1.0, after)):
        place_tip(prev, after, part, 0.05, tip)
        np.testing.assert_allclose(tip, end, atol=1e-12)
    around = []
    for part in (0.3 - 1e-5, 0.3 + 1e-5):
        place_tip(prev, after, part, 0.05, tip)
        around.append(tip[:3].copy())
    place_tip(prev, after, 0.3, 0.05, tip)
    np.testing.assert_allclose((around[1] - around[0]) / (2e-5 * 0.05), tip[3:], rtol=1e-6)


def test_paying_out_lowers_the_load_by_the_length_paid_out():
    state = hanging_state(WIRE, FIXED[:3], np.zeros(3), 2.0, 700.0)
    states, memories, _ = hoist(state, 0.02, 500, command=0.2)
    states = hoist(states[-1], 0.02, 500, at_rest=memories[-1])[0]
    length = states[-1, 6]
    assert 3.9 < length < 4.1
    assert states[-1, 2] == pytest.approx(FIXED[2] - length - 700.0 * WIRE.gravity / stiffness_at(length), abs=1e-9)


def test_a_step_leaves_its_inputs_alone():
    state, tip = swung_state(0.5, 2.0, 700.0), FIXED.copy()
    kept = state.copy()
    held_step(WIRE, state, tip, tip, 0.02, 0.2)
    np.testing.assert_array_equal(state, kept)
    np.testing.assert_array_equal(tip, FIXED)


@pytest.mark.parametrize("step_s", [0.02, 0.1])
def test_spherical_pendulum_with_a_moving_pivot_follows_the_rigid_rod(step_s, measured):
    name = f"spherical pendulum, moving pivot, 60 s, H = {1e3 * step_s:g} ms, against a rigid rod"
    measured(name, pendulum(step_s).error_m, 1e-4, "m")


@pytest.mark.parametrize("share", SHARES)
def test_sway_over_pivot_motion_is_that_of_the_linear_pendulum(share, measured):
    found, exact = sway_gain(share)
    measured(f"sway over pivot motion at {share:g} of the natural frequency, error", abs(found / exact - 1.0), 0.02)
