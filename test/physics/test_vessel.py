"""The ship as a rigid body: inertia against point masses, conservation laws, the linear model."""

from itertools import pairwise

import numpy as np
import pytest
from gunnerus_ship import (
    NO_LOAD,
    NOTHING_ATTACHED,
    SCENARIO,
    SHIP,
    STILL_WATER,
    alone,
    body_of_points,
    held_step,
    ideal_ship,
    rate_of,
    skew,
    state_at,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shipcrane_twin.cosim.dp_build import propulsion_params
from shipcrane_twin.physics.frames import matrix_from_quat
from shipcrane_twin.physics.vessel import (
    add_momentum_bias,
    attached_inertia,
    carried_load,
    carried_mean,
    point_motion,
)
from shipcrane_twin.physics.vessel_step import vessel_at_rest, vessel_macro_step

compiled = settings(deadline=None)
seeds = st.integers(0, 9999)
RESTING_WATER_AND_NO_LOAD = NO_LOAD, STILL_WATER


def point_masses(seed, count=6):
    rng = np.random.default_rng(seed)
    return rng, rng.uniform(50.0, 2000.0, count), rng.normal(size=(count, 3)) * 4.0


@compiled
@given(seed=seeds)
def test_attached_inertia_is_that_of_point_masses(seed):
    rng, masses, points = point_masses(seed)
    offset = rng.normal(size=3) * 5.0
    expected = np.zeros((6, 6))
    for mass, point in zip(masses, points + offset, strict=True):
        velocity_from_nu = np.hstack((np.eye(3), -skew(point)))
        expected += mass * velocity_from_nu.T @ velocity_from_nu
    found = attached_inertia(body_of_points(masses, points), offset)
    np.testing.assert_allclose(found, expected, atol=1e-9 * expected.max())


@compiled
@given(seed=seeds)
def test_momentum_bias_is_what_point_masses_need_to_keep_their_body_velocities(seed):
    rng, masses, points = point_masses(seed)
    nu = rng.normal(size=6)
    expected = np.zeros(6)
    for mass, point in zip(masses, points, strict=True):
        force = mass * np.cross(nu[3:], nu[:3] + np.cross(nu[3:], point))
        expected += np.concatenate((force, np.cross(point, force)))
    inertia = attached_inertia(body_of_points(masses, points), np.zeros(3))
    np.testing.assert_allclose(alone(add_momentum_bias, inertia, nu), -expected, atol=1e-9 * np.abs(expected).max())


@compiled
@given(seed=seeds)
def test_carried_load_is_that_of_point_masses(seed):
    rng, masses, points = point_masses(seed)
    omega, alpha, proper = rng.normal(size=(3, 3))
    expected = np.zeros(6)
    for mass, point in zip(masses, points, strict=True):
        felt = proper + np.cross(alpha, point) + np.cross(omega, np.cross(omega, point))
        expected -= mass * np.concatenate((felt, np.cross(point, felt)))
    found = carried_load(body_of_points(masses, points), omega, alpha, proper)
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_a_body_carried_at_rest_weighs_on_its_foot():
    body = np.array([2000.0, 1.0, 2.0, 3.0, *np.ones(6)])
    heeled = state_at(euler=(0.2, 0.0, 1.0))
    down_b = -matrix_from_quat(heeled[3:7])[2] * 2000.0 * SHIP.gravity
    wrench = carried_mean(SHIP, body, heeled, np.zeros(6), heeled, np.zeros(6))
    np.testing.assert_allclose(wrench, np.concatenate((down_b, np.cross(body[1:4], down_b))))


@compiled
@given(seed=seeds)
def test_carried_mean_is_the_mean_of_both_ends(seed):
    rng, masses, points = point_masses(seed)
    body = body_of_points(masses, points)
    ends = [state_at(euler=rng.normal(size=3), nu=rng.normal(size=6)) for _ in range(2)]
    rates = rng.normal(size=(2, 6))
    arm = SHIP.crane_base - SHIP.cog
    loads = []
    for state, rate in zip(ends, rates, strict=True):
        proper = point_motion(state, rate, arm)[2] + SHIP.gravity * matrix_from_quat(state[3:7])[2]
        loads.append(carried_load(body, state[10:13], rate[3:], proper))
    found = carried_mean(SHIP, body, ends[0], rates[0], ends[1], rates[1])
    np.testing.assert_allclose(found, 0.5 * (loads[0] + loads[1]), rtol=1e-12)


@compiled
@given(seed=seeds)
def test_motion_of_a_point_is_the_derivative_of_its_path(seed):
    rng = np.random.default_rng(seed)
    arm, dt = rng.normal(size=3) * 10.0, 1e-3
    state = state_at(euler=rng.normal(size=3) * 0.2, nu=rng.normal(size=6) * 0.3)
    args = (NO_LOAD, rng.normal(size=3), NOTHING_ATTACHED)
    nu_dot = rate_of(SHIP, state, *args)[7:13]
    _, vel_b, acc_b = point_motion(state, nu_dot, arm)
    rot = matrix_from_quat(state[3:7])
    before, here, after = (
        point_motion(held_step(SHIP, state, *args, t), nu_dot, arm)[0] for t in (-dt, 0.0, dt)
    )
    np.testing.assert_allclose((after - before) / (2.0 * dt), rot @ vel_b, atol=1e-3)
    np.testing.assert_allclose((after - 2.0 * here + before) / dt**2, rot @ acc_b, atol=1e-2)


LEVEL_YAW = 1.9
"""Of the level axes while energy is watched: added mass that turns with them would take some."""


def rigid_inertia(ship, attached):
    return ship.rigid_mass + attached_inertia(attached, ship.crane_base - ship.cog)


def energy(ship, state, attached):
    nu, c = state[7:13], ship.hull.restoring
    rot = matrix_from_quat(state[3:7])
    rise = state[2] - ship.hull.design_height
    roll, pitch = np.arctan2(rot[2, 1], rot[2, 2]), -np.arcsin(rot[2, 0])
    level = Rotation.from_euler("z", -LEVEL_YAW).as_matrix() @ rot
    nu_level = np.concatenate((level @ nu[:3], level @ nu[3:]))  # added mass is that of a level hull
    kinetic = 0.5 * nu @ rigid_inertia(ship, attached) @ nu + 0.5 * nu_level @ ship.hull.added_mass @ nu_level
    water = 0.5 * (c[2, 2] * rise**2 + 2.0 * c[2, 4] * rise * pitch + c[3, 3] * roll**2 + c[4, 4] * pitch**2)
    com_w = state[:3] + rot @ (ship.crane_base - ship.cog + attached[1:4])
    return kinetic, kinetic + water + attached[0] * ship.gravity * com_w[2]


def test_undamped_ship_with_a_crane_keeps_its_energy(measured):
    # Alike in all directions of travel, so that Kirchhoff's forces do no work without the Munk moment.
    added = np.zeros((6, 6))
    added[:3, :3] = 4e5 * np.eye(3)
    added[3:, 3:] = SHIP.hull.added_mass[3:, 3:]
    ship = ideal_ship(added, SHIP.hull.restoring)
    _, masses, points = point_masses(5)
    crane = body_of_points(masses, points)
    state = state_at((0.0, 0.0, 0.4), (0.25, -0.1, 2.0), (0.8, -0.5, 0.2, 0.1, 0.05, -0.2))
    kinetic, total = [], []
    for _ in range(6000):
        values = energy(ship, state, crane)
        kinetic.append(values[0])
        total.append(values[1])
        state = held_step(ship, state, *RESTING_WATER_AND_NO_LOAD, crane, 0.01, (LEVEL_YAW, 0.0))
    exchanged = np.ptp(kinetic)
    assert exchanged > 1e5
    drift = np.abs(np.array(total) - total[0]).max() / exchanged
    measured("energy of the undamped ship with a crane over 60 s: drift over energy exchanged", drift, 1e-6)


def test_ship_without_water_keeps_its_momentum_and_spin():
    ship = ideal_ship(np.zeros((6, 6)), np.zeros((6, 6)))._replace(gravity=0.0)
    _, masses, points = point_masses(6)
    crane = body_of_points(masses * 30.0, points)
    inertia = rigid_inertia(ship, crane)

    def momentum_w(state):
        rot, body = matrix_from_quat(state[3:7]), inertia @ state[7:13]
        return rot @ body[:3], rot @ body[3:] + np.cross(state[:3], rot @ body[:3])

    state = state_at((3.0, -2.0, 1.0), (0.3, -0.2, 1.0), (0.5, -0.4, 0.3, 0.5, -0.3, 0.4))
    linear, angular = momentum_w(state)
    for _ in range(6000):
        state = held_step(ship, state, *RESTING_WATER_AND_NO_LOAD, crane, 0.01)
    linear_end, angular_end = momentum_w(state)
    np.testing.assert_allclose(linear_end, linear, atol=1e-6 * np.abs(linear).max())
    np.testing.assert_allclose(angular_end, angular, atol=1e-6 * np.abs(angular).max())


@compiled
@given(seed=seeds)
def test_a_current_only_carries_everything_along(seed):
    rng = np.random.default_rng(seed)
    state = state_at(rng.normal(size=3) * 0.3, rng.normal(size=3) * 0.2, rng.normal(size=6) * 0.2)
    water = np.array([*rng.normal(size=2), 0.0])
    drifting = state.copy()
    drifting[7:10] += matrix_from_quat(state[3:7]).T @ water
    load = rng.normal(size=6) * 1e5
    for _ in range(100):
        state = held_step(SHIP, state, load, np.zeros(3), NOTHING_ATTACHED, 0.02)
        drifting = held_step(SHIP, drifting, load, water, NOTHING_ATTACHED, 0.02)
    np.testing.assert_allclose(drifting[:3] - 2.0 * water, state[:3], atol=1e-7)
    np.testing.assert_allclose(drifting[3:7], state[3:7], atol=1e-8)


def oscillating_modes():
    """Eigenvalue and shape (position, rate, memory) of the slowest oscillation in which each mode leads."""
    hull, water = SHIP.hull, SHIP.radiation
    sections = water.b.shape[1]
    count = 12 * sections
    reading, memory, driving = np.zeros((6, count)), np.zeros((count, count)), np.zeros((count, 6))
    at = 0
    for block, j, k in np.ndindex(2, 3, sections):
        pair = slice(at, at + 2)
        memory[pair, pair] = water.a[block, k]
        driving[pair, block + 2 * j] = water.b[block, k]
        for i in range(3):
            reading[block + 2 * i, pair] = water.c[block, i, j, k]
        at += 2
    inverse = np.linalg.inv(SHIP.rigid_mass + hull.added_mass)
    still = np.zeros((6, 6))
    matrix = np.block(
        [
            [still, np.eye(6), np.zeros_like(reading)],
            [-inverse @ hull.restoring, -inverse @ hull.damping, -inverse @ reading],
            [np.zeros_like(driving), driving, memory],
        ]
    )
    values, shapes = np.linalg.eig(matrix)
    moving = [(value, shape) for value, shape in zip(values, shapes.T, strict=True) if 0.1 < value.imag < 3.0]
    lever = np.array([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])  # angles times metres
    names = ("surge", "sway", "heave", "roll", "pitch", "yaw")
    modes = {}
    for value, shape in sorted(moving, key=lambda mode: mode[0].real):
        leader = names[int(np.argmax(np.abs(shape[:6]) * lever))]
        modes[leader] = (value, shape)  # the last is the least damped
    return modes


@pytest.mark.parametrize(("mode", "row"), [("roll", 3), ("heave", 2), ("pitch", 4)])
def test_free_decay_has_period_and_damping_of_the_linear_model(mode, row, measured):
    value, shape = oscillating_modes()[mode]
    period = 2.0 * np.pi / value.imag
    start = (shape * 1e-4 / shape[row]).real
    state = state_at(start[:3], start[3:6], start[6:12])
    state[13:] = start[12:]
    dt, moves = 0.01, []
    for _ in range(round(3.3 * period / dt)):
        w, x, y, z = state[6], state[3], state[4], state[5]
        small = 2.0 * w * np.array([x, y, z])
        moves.append([0.0, 0.0, state[2] - SHIP.hull.design_height, *small][row])
        state = held_step(SHIP, state, *RESTING_WATER_AND_NO_LOAD, NOTHING_ATTACHED, dt)
    times, moves = np.arange(len(moves)) * dt, np.array(moves)
    falls = np.flatnonzero((moves[:-1] > 0.0) & (moves[1:] <= 0.0))
    crossings = times[falls] + dt * moves[falls] / (moves[falls] - moves[falls + 1])
    off = np.abs(np.diff(crossings) / period - 1.0).max()
    measured(f"free {mode} decay, period {period:.3f} s, against the linear model's eigenvalue", off, 0.01)
    peaks = [moves[a:b].max() for a, b in pairwise(falls)]
    assert np.log(peaks[0] / peaks[1]) == pytest.approx(-value.real * period, rel=0.01)


def test_a_load_in_each_direction_moves_the_ship_that_way():
    for i in range(6):
        load = np.zeros(6)
        load[i] = 1e5
        assert rate_of(SHIP, state_at(), load, STILL_WATER, NOTHING_ATTACHED)[7 + i] > 0.0


def test_attached_weight_pulls_down_and_heels_to_its_side():
    starboard = np.array([5000.0, 0.0, -4.0, 3.0, *np.zeros(6)])
    rate = rate_of(SHIP, state_at(), *RESTING_WATER_AND_NO_LOAD, starboard)[7:13]
    assert rate[2] < 0.0
    assert rate[3] > 0.0


def test_a_step_leaves_its_inputs_alone_and_the_quaternion_a_unit():
    state = state_at(euler=(0.3, 0.1, 1.0), nu=(1.0, 0.5, 0.2, 0.3, 0.1, 0.2))
    kept = state.copy()
    new = held_step(SHIP, state, *RESTING_WATER_AND_NO_LOAD, NOTHING_ATTACHED, 0.1)
    np.testing.assert_array_equal(state, kept)
    assert np.linalg.norm(new[3:7]) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("step_s", [0.02, 0.05, 0.1])  # the last in two Runge-Kutta steps
def test_weather_runs_linearly_from_one_step_to_the_next(step_s):
    thrusters = propulsion_params(SCENARIO)
    count = len(thrusters.diameter)
    idle, sound, full = np.zeros((count, 2)), np.zeros(count, np.int64), np.ones(count)
    memory = vessel_at_rest(SHIP, state_at()[:13], NOTHING_ATTACHED, count)
    weather = np.array([0.0, 0.0, 1e5, 0.0, 0.0, 0.0])
    mass = 1.0 / np.linalg.inv(SHIP.rigid_mass + SHIP.hull.added_mass)[2, 2]
    gained = []
    for _ in range(2):
        new = vessel_macro_step(
            SHIP, thrusters, memory, idle, sound, full, weather, NO_LOAD, NOTHING_ATTACHED, STILL_WATER, step_s
        )
        gained.append((new[9] - memory[9]) * mass / (1e5 * step_s))
        memory = new
    np.testing.assert_allclose(gained, [0.5, 1.0], atol=0.6 * step_s)
