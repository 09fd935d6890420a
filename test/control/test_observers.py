"""Both observers on the same ship: accuracy, waves kept out, loss of measurements, bad input."""

import numpy as np
import pytest
from dp_plant import (
    BIAS_W,
    DT,
    GYRO_STD,
    NONE,
    OBSERVERS,
    PEAK,
    band_power,
    ekf,
    measure,
    observe,
    passive,
    ship_path,
    slow_loads,
    turn,
    wave_motion,
)

from shipcrane_twin.control.ekf import ekf_start, ekf_step
from shipcrane_twin.control.observer import passive_start, passive_step
from shipcrane_twin.control.observer_model import (
    AGE,
    BIAS,
    POSE,
    VELOCITY,
    observer_age,
    observer_bias,
    observer_pose,
    observer_velocity,
    observer_wave,
)

WAVE_STD = np.array([0.075, 0.075, np.deg2rad(0.2)])
NOISE = np.array([0.5, 0.5, GYRO_STD])
both = pytest.mark.parametrize("kind", list(OBSERVERS))


@pytest.fixture(scope="module")
def sea_trial():
    path, loads = ship_path(700.0, slow_loads)
    return path, loads, wave_motion(700.0, WAVE_STD)


def trial(kind, sea_trial, every=1, **changes):
    make, start, step = OBSERVERS[kind]
    path, loads, waves = sea_trial
    if kind == "passive":
        changes["sample_period_s"] = np.array([DT * every, DT * every, DT])
    params = make(**changes)
    return observe(step, params, start(params, np.zeros(3)), measure(path, waves, NOISE, every), loads), path


def rms(x):
    return np.sqrt(np.mean(x**2, axis=0))


@both
def test_position_and_bias_with_half_a_metre_of_noise_ten_times_a_second(kind, sea_trial, measured):
    states, path = trial(kind, sea_trial)
    error = states[:, :6] - path
    measured(f"DP {kind}: position error, 0.5 m noise at 10 Hz, RMS from 100 s", rms(error[1000:, :2]).max(), 0.1, "m")
    measured(f"DP {kind}: heading error, RMS from 100 s", np.rad2deg(rms(error[1000:, 2])), 0.2, "deg")
    measured(f"DP {kind}: velocity error, RMS from 100 s", rms(error[1000:, 3:5]).max(), 0.02, "m/s")
    wrong = states[1000:1500, BIAS] - BIAS_W
    force = np.sqrt(np.mean(np.sum(wrong[:, :2] ** 2, axis=1))) / np.hypot(*BIAS_W[:2])
    measured(f"DP {kind}: bias force error, 100 s after a start with none", force, 0.05, "")
    measured(f"DP {kind}: bias moment error, 100 s after a start with none", rms(wrong[:, 2]) / BIAS_W[2], 0.05, "")
    assert rms(wrong[:, :2] / np.hypot(*BIAS_W[:2])).min() > 1e-4  # noise is there


@both
def test_position_with_half_a_metre_of_noise_once_a_second(kind, sea_trial, measured):
    states, path = trial(kind, sea_trial, every=10)
    error = rms(states[1000:, :2] - path[1000:, :2])
    measured(f"DP {kind}: position error, 0.5 m noise at 1 Hz, RMS from 100 s", error.max(), 0.3, "m")
    assert np.all(np.abs(states[1500:, BIAS].mean(axis=0) / BIAS_W - 1.0) < 0.05)


@both
def test_waves_stay_out_of_the_velocity(kind, sea_trial, measured):
    path, loads, waves = sea_trial
    make, start, step = OBSERVERS[kind]
    blind = {"notch_damping": np.full(3, 0.1)} if kind == "passive" else {"wave_std": np.full(3, 1e-6)}
    power = []
    for changes in ({}, blind):
        params = make(**changes)
        state = start(params, np.zeros(3))
        still = observe(step, params, state, path[:, :3], loads)
        rough = observe(step, params, state, path[:, :3] + waves, loads)
        power.append(band_power((rough - still)[1000:, VELOCITY]))
    true = band_power(np.gradient(waves[1000:], DT, axis=0))
    measured(f"DP {kind}: wave power in the velocity, filter over none", (power[0] / power[1]).max(), 0.1, "")
    measured(f"DP {kind}: wave power in the velocity over the ship's own", (power[0] / true).max(), 0.02, "")


@both
def test_wave_motion_is_told_from_slow_motion(kind, sea_trial):
    states, _ = trial(kind, sea_trial)
    waves = sea_trial[2]
    seen = states[2000:, 14]
    assert np.corrcoef(seen, waves[2000:, 2])[0, 1] > 0.9
    np.testing.assert_array_equal(observer_wave(states[-1]), states[-1, 12:15])


@both
def test_a_sea_of_another_period_needs_its_frequency(kind, sea_trial):
    path, loads, _ = sea_trial
    waves = wave_motion(700.0, WAVE_STD, peak=1.1)
    make, start, step = OBSERVERS[kind]
    params = make()
    state = start(params, np.zeros(3))
    told, untold = (
        observe(step, params, state, path[:, :3] + waves, loads, np.full(3, omega)) for omega in (1.1, PEAK)
    )
    base = observe(step, params, state, path[:, :3], loads)
    told_power, untold_power = (band_power((s - base)[1000:, POSE]) for s in (told, untold))
    assert np.all(told_power < 0.7 * untold_power)


@both
def test_dead_reckoning_drifts_little_and_returns_smoothly(kind, sea_trial, measured):
    make, start, step = OBSERVERS[kind]
    path, loads, waves = sea_trial
    poses = measure(path, waves, NOISE)
    poses[4000:4600, :2] = np.nan
    params, at_once = make(), make(return_s=0.0)
    states = observe(step, params, start(params, np.zeros(3)), poses, loads)
    drift = np.hypot(*(states[4000:4600, :2] - path[4000:4600, :2]).T).max()
    measured(f"DP {kind}: drift in 60 s without position", drift, 5.0, "m")
    np.testing.assert_allclose(observer_age(states[4599]), [60.0, 60.0, 0.0], atol=1e-9)
    if kind == "passive":
        np.testing.assert_array_equal(states[4599, 6:8], states[3999, 6:8])
    else:  # what heading says of the bias through the model's coupling is little
        np.testing.assert_allclose(states[4599, 6:8], states[3999, 6:8], atol=200.0)
    # put 4 m more on the return, far more than any drift, and look at the size of the steps
    poses[4600:, 0] += 4.0
    back = observe(step, params, states[4599], poses[4599:], loads[4599:])
    sudden = observe(step, at_once, states[4599], poses[4599:], loads[4599:])
    # the mean over a second: a single step's noise is the same for both
    def fastest(run):
        return np.abs(run[10:300, 0] - run[:290, 0]).max()

    assert fastest(back) < 0.5 * fastest(sudden)
    assert abs(back[1, 0] - back[0, 0]) < 0.05
    assert abs(np.mean(back[1500:, 0] - path[6099:, 0]) - 4.0) < 0.15


@both
def test_lost_heading_is_dead_reckoned_too(kind, sea_trial):
    path, loads, waves = sea_trial
    poses = measure(path, waves, NOISE)
    poses[3000:3300, 2] = np.nan
    make, start, step = OBSERVERS[kind]
    params = make()
    states = observe(step, params, start(params, np.zeros(3)), poses, loads)
    assert np.abs(states[3000:3300, 2] - path[3000:3300, 2]).max() < np.deg2rad(3.0)
    assert observer_age(states[3299])[2] == pytest.approx(30.0)


@both
def test_turning_the_world_turns_the_estimate(kind):
    """Also across the seam at half a turn."""
    make, start, step = OBSERVERS[kind]
    params = make()
    path, loads = ship_path(60.0, lambda t: [2e3, 3e3, 2e5], hold=False)
    angle = np.pi - 0.01 - path[300, 2]
    turned = path[:, :3] @ turn(angle).T
    turned[:, 2] = (path[:, 2] + angle + np.pi) % (2.0 * np.pi) - np.pi
    assert turned[-1, 2] < 0.0 < turned[0, 2]
    plain = observe(step, params, start(params, path[0, :3]), path[:, :3], loads)
    other = observe(step, params, start(params, turned[0]), turned, loads)
    np.testing.assert_allclose(other[:, VELOCITY], plain[:, VELOCITY], atol=1e-9)
    np.testing.assert_allclose(
        [observer_bias(s) for s in other], [observer_bias(s) for s in plain], rtol=1e-6, atol=1e-2
    )
    np.testing.assert_allclose(other[:, :2], (plain[:, :3] @ turn(angle).T)[:, :2], atol=1e-9)
    assert np.all(np.abs(other[:, 2]) <= np.pi)


@both
def test_exact_model_and_measurement_leave_no_error(kind):
    make, start, step = OBSERVERS[kind]
    params = make()
    path, loads = ship_path(100.0, slow_loads, bias_w=np.zeros(3))
    states = observe(step, params, start(params, path[0, :3]), path[:, :3], loads)
    np.testing.assert_allclose(states[:, :6], path, atol=2e-4)
    np.testing.assert_allclose(observer_pose(states[-1]), path[-1, :3], atol=2e-4)
    np.testing.assert_allclose(observer_velocity(states[-1]), path[-1, 3:], atol=2e-4)


@both
def test_bad_input_never_makes_nan_and_counts_as_missing(kind):
    make, start, step = OBSERVERS[kind]
    params = make()
    state = step(params, start(params, np.zeros(3)), np.array([0.3, -0.2, 0.01]), np.full(3, 1e3), NONE)
    before = state.copy()
    for bad in (np.nan, np.inf, -np.inf):
        wrong = np.full(3, bad)
        missing = step(params, state, NONE, np.zeros(3), NONE)
        np.testing.assert_array_equal(step(params, state, wrong, wrong, wrong), missing)
        half = step(params, state, np.array([bad, 0.1, 0.0]), np.zeros(3), np.zeros(3))
        assert np.all(np.isfinite(half))
        assert half[AGE].tolist() == [pytest.approx(DT), 0.0, 0.0]
    run = [state]
    for k in range(3000):
        pose = np.where(np.random.default_rng(k).uniform(size=3) < 0.6, np.nan, [1.0, -1.0, 0.1])
        run.append(step(params, run[-1], pose, np.array([np.nan, 0.0, 1e3]), NONE))
    assert np.all(np.isfinite(run))
    np.testing.assert_array_equal(state, before)


@both
def test_start_needs_a_pose(kind):
    make, start, _ = OBSERVERS[kind]
    with pytest.raises(ValueError, match="wait until"):
        start(make(), np.array([0.0, np.nan, 0.0]))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"notch_damping": np.full(3, 0.05)}, "would add waves"),
        ({"wave_damping": np.full(3, 1.5)}, "wave_damping"),
        ({"bias_period_s": np.zeros(3)}, "bias_period_s"),
        ({"cutoff_ratio": np.ones(2)}, "cutoff_ratio"),
        ({"lost_after_s": 0.0}, "lost_after_s"),
        ({"sample_period_s": np.full(3, 6.0)}, "every fix is late"),
        ({"period": 0.0}, "period"),
    ],
)
def test_settings_out_of_range_are_named(changes, words):
    with pytest.raises(ValueError, match=words):
        passive(**changes)


def test_the_two_agree_on_a_calm_day():
    path, loads = ship_path(300.0, slow_loads)
    ends = []
    for make, start, step in ((passive, passive_start, passive_step), (ekf, ekf_start, ekf_step)):
        params = make()
        ends.append(observe(step, params, start(params, np.zeros(3)), path[:, :3], loads)[-1])
    np.testing.assert_allclose(ends[0][:6], ends[1][:6], atol=0.02)
    np.testing.assert_allclose(ends[0][BIAS] / BIAS_W, ends[1][BIAS] / BIAS_W, atol=0.03)
