"""Thrusters: exact lag, limits, and their effect on the ship."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from shipcrane_twin.physics.thrusters import ThrusterParams, limit_thrust, thruster_load, thruster_step

THRUSTERS = ThrusterParams(
    position=np.array([[-14.0, 2.0, -3.6], [-14.0, -2.0, -3.6], [14.5, 0.0, -3.6]]),
    thrust_max=np.array([54e3, 54e3, 20e3]),
    azimuthing=np.array([1.0, 1.0, 0.0]),
    time_constant=2.0,
)
compiled = settings(deadline=None)
seeds = st.integers(0, 9999)


def within_limits(seed):
    thrust = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, 2)) * 15e3
    thrust[2, 0] = 0.0
    return thrust


@compiled
@given(seed=seeds, step_s=st.floats(1e-3, 10.0))
def test_lag_is_the_exact_exponential_and_its_exact_mean(seed, step_s):
    start, command = within_limits(seed), within_limits(seed + 1)
    end, mean = thruster_step(THRUSTERS, start, command, step_s)
    np.testing.assert_allclose(end, command + (start - command) * np.exp(-step_s / 2.0), atol=1e-6)
    share = quad(lambda t: np.exp(-t / 2.0), 0.0, step_s)[0] / step_s
    np.testing.assert_allclose(mean, command + (start - command) * share, atol=1e-6)


@compiled
@given(seed=seeds, parts=st.integers(2, 20))
def test_many_short_steps_make_one_long_one(seed, parts):
    start, command = within_limits(seed), within_limits(seed + 1)
    end, mean = thruster_step(THRUSTERS, start, command, 1.0)
    means = np.zeros((parts, 3, 2))
    for i in range(parts):
        start, means[i] = thruster_step(THRUSTERS, start, command, 1.0 / parts)
    np.testing.assert_allclose(start, end, atol=1e-6)
    np.testing.assert_allclose(means.mean(axis=0), mean, atol=1e-6)


@compiled
@given(seed=seeds)
def test_limits_cut_the_size_and_keep_the_direction(seed):
    command = np.random.default_rng(seed).normal(size=(3, 2)) * 60e3
    limited = limit_thrust(THRUSTERS, command)
    sizes = np.linalg.norm(limited, axis=1)
    assert np.all(sizes <= THRUSTERS.thrust_max * (1.0 + 1e-12))
    for i in range(2):
        wanted = np.linalg.norm(command[i])
        assert sizes[i] == pytest.approx(min(wanted, 54e3))
        np.testing.assert_allclose(limited[i] * wanted, command[i] * sizes[i], rtol=1e-9)
    assert limited[2, 0] == 0.0
    assert limited[2, 1] == pytest.approx(np.clip(command[2, 1], -20e3, 20e3))


@compiled
@given(seed=seeds)
def test_thrust_never_leaves_the_limits(seed):
    rng, thrust = np.random.default_rng(seed), np.zeros((3, 2))
    for _ in range(30):
        thrust, mean = thruster_step(THRUSTERS, thrust, rng.normal(size=(3, 2)) * 1e5, 0.5)
        for values in (thrust, mean):
            assert np.all(np.linalg.norm(values, axis=1) <= THRUSTERS.thrust_max * (1.0 + 1e-12))


@compiled
@given(seed=seeds)
def test_load_is_the_sum_of_forces_and_their_moments(seed):
    thrust = within_limits(seed)
    forces = np.column_stack((thrust, np.zeros(3)))
    expected = np.concatenate((forces.sum(axis=0), np.cross(THRUSTERS.position, forces).sum(axis=0)))
    np.testing.assert_allclose(thruster_load(THRUSTERS, thrust), expected, atol=1e-6)
