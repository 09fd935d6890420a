"""Laws of the extended Kalman filter: its derivative, its covariance, its consistency."""

import numpy as np
import pytest
from dp_plant import (
    DT,
    EKF,
    MASS,
    NONE,
    ONE,
    PEAK,
    ekf,
    measure,
    observe,
    ship_path,
    slow_loads,
    turn,
    wave_motion,
)
from scipy.linalg import expm, solve_discrete_are

from shipcrane_twin.control.ekf import (
    ekf_covariance,
    ekf_start,
    ekf_step,
    motion_jacobian,
    predict_covariance,
    take_measurement,
)
from shipcrane_twin.control.observer_model import AGE, SHARED_STATES

OMEGA = np.array([0.6, 0.7, 0.8])
SIZE = np.array([0.5, 0.5, 0.002, 0.1, 0.1, 0.003, 2e3, 2e3, 2e4, 0.4, 0.4, 0.01, 0.3, 0.3, 0.01])
"""Usual size of the state's numbers: what a covariance is divided by, as metres and newtons do not compare."""


def random_state(seed=1, yaw=0.9):
    rng = np.random.default_rng(seed)
    params = ekf()
    state = ekf_start(params, np.array([1.0, 2.0, yaw]))
    state[:15] += SIZE * rng.standard_normal(15)
    mixer = rng.standard_normal((15, 15)) * 0.3 + np.eye(15)
    state[SHARED_STATES:] = (mixer @ mixer.T * np.outer(SIZE, SIZE)).ravel()
    return params, state


def assert_healthy(covariance):
    np.testing.assert_array_equal(covariance, covariance.T)
    size = np.sqrt(np.diag(covariance))
    assert np.all(size > 0.0)
    assert np.linalg.eigvalsh(covariance / np.outer(size, size)).min() > 1e-12


@pytest.mark.parametrize("yaw", [0.0, 0.9, -2.5])
def test_derivative_matches_differences_of_the_prediction(yaw):
    params, state = random_state(yaw=yaw)
    state[AGE] = 0.0
    analytic = motion_jacobian(params, state, OMEGA)
    for j in range(15):
        ends = []
        for sign in (1.0, -1.0):
            moved = state.copy()
            moved[j] += sign * 1e-3 * SIZE[j]
            ends.append(ekf_step(params, moved, NONE, np.array([1e3, 2e3, 3e4]), OMEGA)[:15])
        slope = (ends[0] - ends[1]) / (2e-3 * SIZE[j])
        np.testing.assert_allclose(slope * SIZE[j] / SIZE, analytic[:, j] * SIZE[j] / SIZE, atol=2e-7)


def test_covariance_prediction_is_f_p_ft_plus_q():
    params, state = random_state()
    jacobian, covariance = motion_jacobian(params, state, OMEGA), ekf_covariance(state)
    got = predict_covariance(params, jacobian, covariance, OMEGA)
    noise = np.zeros((15, 15))
    inverse = np.linalg.inv(MASS)
    noise[3:6, 3:6] = inverse @ np.diag(EKF["load_noise"] ** 2) @ inverse.T * DT
    noise[6:9, 6:9] = np.diag(EKF["bias_walk"] ** 2 * DT)
    for i, omega in enumerate(OMEGA):
        flow = expm(np.array([[0.0, 1.0], [-(omega**2), -0.2 * omega]]) * DT)
        rest = np.diag([omega**-2, 1.0]) * EKF["wave_std"][i] ** 2
        noise[np.ix_([9 + i, 12 + i], [9 + i, 12 + i])] = rest - flow @ rest @ flow.T
    scale = np.outer(SIZE, SIZE)
    np.testing.assert_allclose(got / scale, (jacobian @ covariance @ jacobian.T + noise) / scale, atol=1e-11)


@pytest.mark.parametrize("trust", [1.0, 0.3, 0.0])
@pytest.mark.parametrize("axis", [0, 2])
def test_measurement_is_josephs_form_for_every_gain(trust, axis):
    _, state = random_state()
    covariance = ekf_covariance(state)
    variance, rest = 0.25 * SIZE[axis] ** 2, 0.7 * SIZE[axis]
    row = np.zeros(15)
    row[[axis, 12 + axis]] = 1.0
    gain = trust * covariance @ row / (row @ covariance @ row + variance)
    keep = np.eye(15) - np.outer(gain, row)
    wanted = keep @ covariance @ keep.T + variance * np.outer(gain, gain)
    new, got = state.copy(), covariance.copy()
    take_measurement(new, got, axis, rest, variance, trust)
    np.testing.assert_allclose(new[:15], state[:15] + gain * rest, rtol=1e-12)
    np.testing.assert_allclose(got / np.outer(SIZE, SIZE), wanted / np.outer(SIZE, SIZE), atol=1e-12)


def test_covariance_stays_symmetric_and_positive_through_losses():
    params = ekf()
    path, loads = ship_path(300.0, slow_loads)
    poses = measure(path, wave_motion(300.0, [0.075, 0.075, 0.003]), np.array([0.5, 0.5, 0.002]))
    rng = np.random.default_rng(2)
    poses[rng.uniform(size=poses.shape) < 0.3] = np.nan
    poses[1000:2000, :2] = np.nan
    poses[1500:1800, 2] = np.nan
    states = observe(ekf_step, params, ekf_start(params, np.zeros(3)), poses, loads)
    spread = []
    for state in states[::25]:
        covariance = ekf_covariance(state)
        assert_healthy(covariance)
        spread.append(np.sqrt(covariance[0, 0]))
    assert np.all(np.diff(spread[40:80]) > 0.0)  # it knows less and less while position is lost
    assert spread[-1] < 0.2 * spread[79]


def test_settles_at_the_riccati_equation():
    params = ekf()
    state = ekf_start(params, np.zeros(3))
    for _ in range(30000):
        state = ekf_step(params, state, np.zeros(3), np.zeros(3), NONE)
    flow = motion_jacobian(params, state, PEAK * ONE)
    noise = predict_covariance(params, flow, np.zeros((15, 15)), PEAK * ONE)
    seen = np.zeros((3, 15))
    seen[:, :3] = seen[:, 12:] = np.eye(3)
    scaled = flow * SIZE / SIZE[:, None]
    before = solve_discrete_are(
        scaled.T, (seen * SIZE).T, noise / np.outer(SIZE, SIZE), np.diag(params.measurement_std**2)
    )
    before *= np.outer(SIZE, SIZE)
    total = seen @ before @ seen.T + np.diag(params.measurement_std**2)
    after = before - before @ seen.T @ np.linalg.solve(total, seen @ before)
    np.testing.assert_allclose(np.diag(ekf_covariance(state)), np.diag(after), rtol=1e-3)


def test_errors_are_as_large_as_the_covariance_says():
    """Ships that move as the model says: the error's square over its covariance is 15 on average."""
    params = ekf()
    rng = np.random.default_rng(4)
    flow = expm(np.array([[0.0, 1.0], [-(PEAK**2), -0.2 * PEAK]]) * DT)
    values = []
    for _ in range(6):
        truth = np.concatenate((np.zeros(3), SIZE[3:] * 0.5 * rng.standard_normal(12)))
        truth[6:9] = EKF["bias_start_std"] * 0.3 * rng.standard_normal(3)
        state = ekf_start(params, truth[:3] + params.measurement_std * rng.standard_normal(3))
        carrier = ekf_start(params, np.zeros(3))
        for k in range(1500):
            rot = turn(truth[2])
            load = -rot.T @ truth[6:9] - [1e4, 1e4, 1e6] * truth[3:6]
            carrier[:15] = truth
            carrier[AGE] = 0.0
            truth = ekf_step(params, carrier, NONE, load, NONE)[:15]
            truth[3:6] += np.linalg.inv(MASS) @ (EKF["load_noise"] * rng.standard_normal(3)) * np.sqrt(DT)
            truth[6:9] += EKF["bias_walk"] * rng.standard_normal(3) * np.sqrt(DT)
            for i in range(3):
                rest = np.diag([PEAK**-2, 1.0]) * EKF["wave_std"][i] ** 2
                truth[[9 + i, 12 + i]] += np.linalg.cholesky(rest - flow @ rest @ flow.T) @ rng.standard_normal(2)
            pose = truth[:3] + truth[12:15] + params.measurement_std * rng.standard_normal(3)
            state = ekf_step(params, state, pose, load, NONE)
            if k >= 500 and k % 100 == 0:
                error = truth - state[:15]
                error[2] = (error[2] + np.pi) % (2.0 * np.pi) - np.pi
                scale = np.outer(SIZE, SIZE)
                values.append(error / SIZE @ np.linalg.solve(ekf_covariance(state) / scale, error / SIZE))
    assert 12.0 < np.mean(values) < 18.0


def test_wandering_bias_fades_with_its_time_constant_only_while_measured():
    params = ekf(bias_time_constant_s=np.full(3, 50.0), bias_walk=np.full(3, 1e-3), bias_start_std=np.full(3, 1e-3))
    state = ekf_start(params, np.zeros(3))
    state[6:9] = 1e-3
    start = state.copy()
    for _ in range(40):
        state = ekf_step(params, state, NONE, np.zeros(3), NONE)
    np.testing.assert_allclose(state[6:9], start[6:9] * np.exp(-4.0 / 50.0), rtol=1e-12)
    for _ in range(400):
        state = ekf_step(params, state, NONE, np.zeros(3), NONE)
    np.testing.assert_allclose(state[6:9], start[6:9] * np.exp(-5.1 / 50.0), rtol=3e-3)
