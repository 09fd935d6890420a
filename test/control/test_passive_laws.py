"""Laws of the passive observer: where its poles lie, passivity, error energy, stable steps."""

import numpy as np
import pytest
from dp_plant import BIAS_W, COMMON, DAMPING, DT, MASS, NONE, PASSIVE, PEAK, passive, ship_path
from scipy.linalg import solve_continuous_are

from shipcrane_twin.control.observer import passive_gains, passive_start, passive_step
from shipcrane_twin.control.observer_model import BIAS, POSE, VELOCITY, WAVE, WAVE_STATE, oscillator, ship_model

ZETA, NOTCH, RATIO = COMMON["wave_damping"][0], PASSIVE["notch_damping"][0], PASSIVE["cutoff_ratio"][0]
SLOW = 2.0 * np.pi / PASSIVE["bias_period_s"][0]


def filter_matrices(gains, omega, time_constant):
    """Error dynamics of one axis: matrix of (xi, its rate, pose, bias), effect of the velocity's error, and output.

    The output is the load that the observer gives back to the velocity's error: K4 e less the bias's error.
    """
    model = np.zeros((4, 4))
    model[0, 1], model[1, 0], model[1, 1] = 1.0, -(omega**2), -2.0 * ZETA * omega
    model[3, 3] = -1.0 / time_constant
    seen = np.array([0.0, 1.0, 1.0, 0.0])
    loop = model - np.outer(gains[[0, 1, 2, 3]], seen)
    return loop, np.array([0.0, 0.0, 1.0, 0.0]), gains[4] * seen - [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize("omega", [0.4, PEAK, 1.2])
def test_filter_poles_lie_where_the_tuning_rules_put_them(omega):
    params = passive()
    for gains in passive_gains(params, np.full(3, omega)):
        loop = filter_matrices(gains, omega, 1e4)[0][:3, :3]
        wanted = np.polymul([1.0, 2.0 * NOTCH * omega, omega**2], [1.0, RATIO * omega])
        np.testing.assert_allclose(np.poly(loop), wanted, rtol=1e-12)


@pytest.mark.parametrize("omega", [0.4, PEAK, 1.2])
def test_slow_poles_have_the_period_and_damping_asked_for(omega):
    params = passive(bias_damping=np.full(3, 0.8))
    gains = passive_gains(params, np.full(3, omega))
    for i, row in enumerate(gains):
        mass = params.load_mass[i]
        # pose, velocity and bias without waves, drag and leak
        loop = np.array([[-row[2], 1.0, 0.0], [-row[4] / mass, 0.0, 1.0 / mass], [-row[3], 0.0, 0.0]])
        pair = np.polymul([1.0, 1.6 * SLOW, SLOW**2], [1.0, RATIO * omega - 1.6 * SLOW])
        np.testing.assert_allclose(np.poly(loop), pair, rtol=1e-9)


def test_slow_sea_slows_the_bias_loop_instead_of_spoiling_it():
    params = passive(bias_period_s=np.full(3, 15.0))
    omega = 0.3
    row = passive_gains(params, np.full(3, omega))[0]
    mass = params.load_mass[0]
    loop = np.array([[-row[2], 1.0, 0.0], [-row[4] / mass, 0.0, 1.0 / mass], [-row[3], 0.0, 0.0]])
    assert np.linalg.eigvals(loop).real.max() < -0.05


@pytest.mark.parametrize("omega", [0.4, PEAK, 0.9, 1.2])
def test_filter_is_passive(omega):
    """Its phase stays within 90 degrees of the velocity's error: Fossen and Strand's condition on the gains."""
    for gains in passive_gains(passive(), np.full(3, omega)):
        loop, drive, output = filter_matrices(gains, omega, 1e4)
        assert np.linalg.eigvals(loop).real.max() < 0.0
        response = [output @ np.linalg.solve(1j * w * np.eye(4) - loop, drive) for w in np.logspace(-5, 3, 2000)]
        assert np.abs(np.angle(response)).max() < 0.5 * np.pi


def storage(loop, drive, output, scale, slack=1e-6):
    """Matrix P > 0 with loop^T P + P loop <= 0 and P drive = output (Kalman, Yakubovich, Popov), nearly.

    The Riccati equation of the transfer function plus a small positive number, in states of like size.
    """
    a = loop * scale[None, :] / scale[:, None]
    b, c = drive / scale, output * scale
    size = np.abs(c).max()
    c = c / size
    n = a.shape[0]
    feed = np.array([[2.0 * slack]])
    p = solve_continuous_are(a, b[:, None], np.zeros((n, n)), -feed, s=-c[:, None])
    return size * p / np.outer(scale, scale)


def test_error_energy_falls_while_the_ship_turns():
    """Kinetic energy of the velocity's error plus the filter's storage, with whole-turn changes of heading."""
    period = 0.02
    params = passive(period=period, sample_period_s=np.full(3, period))
    parts = []
    for i, row in enumerate(passive_gains(params, NONE)):
        loop, drive, output = filter_matrices(row, PEAK, 1e4)
        p = storage(loop, drive, output, np.array([1.0, 1.0, 1.0, params.load_mass[i] * SLOW**2]))
        assert np.linalg.eigvalsh(p / np.sqrt(np.outer(np.diag(p), np.diag(p)))).min() > 0.0
        np.testing.assert_allclose(p @ drive, output, rtol=0.02, atol=0.02 * np.abs(output).max())
        parts.append(p)
    state = passive_start(params, np.zeros(3))
    state[POSE], state[VELOCITY], state[BIAS] = [1.5, -1.0, 0.05], [0.1, -0.2, 0.01], BIAS_W
    state[WAVE_STATE], state[WAVE] = [0.4, -0.3, 0.02], [0.2, 0.2, -0.02]
    pose, velocity = np.zeros(3), np.array([0.0, 0.0, 0.05])
    energy = []
    for _ in range(round(250.0 / period)):
        pose = pose + period * velocity
        state = passive_step(params, state, pose, DAMPING @ velocity, NONE)
        wrong = velocity - state[VELOCITY]
        total = wrong @ MASS @ wrong
        for i, p in enumerate(parts):
            far = pose[i] - state[i]
            if i == 2:
                far = (far + np.pi) % (2.0 * np.pi) - np.pi
            error = np.array([-state[9 + i], -state[12 + i], far, -state[6 + i]])
            total += error @ p @ error
        energy.append(total)
    energy = np.array(energy)
    assert pose[2] > 10.0
    assert np.all(np.diff(energy) < 0.0)
    assert energy[-1] < 1e-6 * energy[0]


def error_map(params, omega, yaw, every):
    """Matrix that carries the error (15,) over one sample of every so many updates; the step is linear there."""
    state = passive_start(params, np.array([0.0, 0.0, yaw]))
    wave = np.full(3, omega)
    size = np.array([1e-3] * 6 + [1e2] * 3 + [1e-3] * 6)
    size[[2, 5, 11, 14]] = 1e-5

    def over_a_sample(start):
        for k in range(every):
            pose = np.array([0.0, 0.0, yaw])
            if k < every - 1:
                pose[:2] = np.nan
            start = passive_step(params, start, pose, np.zeros(3), wave)
        return start[:15]

    base = over_a_sample(state)
    columns = []
    for j in range(15):
        moved = state.copy()
        moved[j] += size[j]
        change = over_a_sample(moved) - base
        columns.append(change / size)
    return np.array(columns).T


@pytest.mark.parametrize("every", [1, 5, 10, 20])
def test_steps_are_stable_for_every_sea_and_sample_period(every):
    params = passive(sample_period_s=np.array([every * DT, every * DT, DT]))
    for omega in (0.3, PEAK, 1.0, 1.6):
        for yaw in (0.0, 0.7, 2.4):
            # scaled columns make a similar matrix: the same eigenvalues
            radius = np.abs(np.linalg.eigvals(error_map(params, omega, yaw, every))).max()
            assert radius < 1.0 - 1e-3 * every * DT, (every, omega, yaw, radius)


def test_fast_steps_follow_the_continuous_observer():
    params = passive(bias_damping=np.full(3, 0.8))
    gains = passive_gains(params, NONE)
    inverse = np.linalg.inv(MASS)
    loop = np.zeros((15, 15))
    eye = np.eye(3)
    loop[:3, 3:6], loop[3:6, 3:6], loop[3:6, 6:9] = eye, -inverse @ DAMPING, inverse
    loop[6:9, 6:9] = -1e-4 * eye
    loop[9:12, 12:], loop[12:, 9:12], loop[12:, 12:] = eye, -(PEAK**2) * eye, -2.0 * ZETA * PEAK * eye
    k1, k1_rate, k2, k3, k4 = (np.diag(column) for column in gains.T)
    loop -= np.vstack((k2, inverse @ k4, k3, k1, k1_rate)) @ np.hstack((eye, np.zeros((3, 9)), eye))
    steps = np.sort(-np.log(np.abs(np.linalg.eigvals(error_map(params, PEAK, 0.0, 1)))) / DT)
    np.testing.assert_allclose(steps, np.sort(-np.linalg.eigvals(loop).real), rtol=0.05)


def test_model_follows_runge_kutta_and_oscillator_its_closed_form():
    model = ship_model(MASS, DAMPING, DT)
    path, loads = ship_path(DT, lambda t: [1e5, -5e4, 1e6], bias_w=np.zeros(3), start=(0, 0, 0, 1, 0.5, 0), hold=False)
    after = model.transition @ path[0, 3:] + model.response @ loads[0]
    np.testing.assert_allclose(after, path[1, 3:], rtol=1e-10)
    a, b, c, d = oscillator(0.8, 0.1, 0.7)
    whole = np.array([[a, b], [c, d]])
    half = np.array(oscillator(0.8, 0.1, 0.35)).reshape(2, 2)
    np.testing.assert_allclose(half @ half, whole, atol=1e-14)
    assert np.linalg.det(whole) == pytest.approx(np.exp(-2.0 * 0.1 * 0.8 * 0.7))
    assert np.trace(whole) == pytest.approx(2.0 * np.exp(-0.056) * np.cos(0.56 * np.sqrt(0.99)))


def test_model_refuses_a_mass_that_is_none():
    with pytest.raises(ValueError, match="positive definite"):
        ship_model(-MASS, DAMPING, DT)
