"""The frequency of the waves from the ship's own motion."""

import numpy as np
import pytest
from dp_plant import DT, PEAK, jonswap

from shipcrane_twin.control.wave_frequency import (
    frequency_params,
    frequency_start,
    frequency_step,
    heave_step,
    resonator_step,
    wave_frequency,
)

SETTINGS = {"nominal": 0.8, "lowest": 0.3, "highest": 1.6, "memory_s": 120.0, "floor": np.deg2rad(0.02)}


def follow(signal, **changes):
    params = frequency_params(DT, **(SETTINGS | changes))
    state = frequency_start(params)
    seen = []
    for value in signal:
        state = frequency_step(params, state, value)
        seen.append(wave_frequency(state))
    return np.array(seen)


@pytest.mark.parametrize("omega", [0.4, 0.63, 1.2])
def test_finds_a_regular_wave_on_a_heeled_ship(omega):
    t = np.arange(0.0, 900.0, DT)
    seen = follow(0.05 + 0.01 * np.sin(omega * t))
    assert seen[-1] == pytest.approx(omega, rel=0.02)
    assert np.ptp(seen[-500:]) < 0.01 * omega


@pytest.mark.parametrize("peak", [0.5, PEAK, 1.0])
def test_finds_the_peak_of_a_noisy_irregular_sea(peak, measured):
    noise = np.deg2rad(0.02) * np.random.default_rng(1).standard_normal(18001)
    seen = follow(jonswap(1800.0, np.deg2rad(0.3), seed=7, peak=peak) + noise)
    settled = seen[6000:]
    measured(f"DP: wave frequency, peak {peak:.2f} rad/s, mean error", abs(settled.mean() / peak - 1.0), 0.08, "")
    measured(f"DP: wave frequency, peak {peak:.2f} rad/s, wandering", settled.std() / peak, 0.06, "")


def test_follows_a_sea_that_changes():
    t = np.arange(0.0, 1200.0, DT)
    first = follow(np.where(t < 400.0, np.sin(0.6 * t), np.sin(1.0 * t)))
    assert first[3999] == pytest.approx(0.6, rel=0.05)
    assert first[-1] == pytest.approx(1.0, rel=0.03)
    assert np.abs(np.diff(first)).max() < (1.6 - 0.3) * DT / 120.0  # slowly, no jumps


def test_calm_water_leads_back_to_the_nominal():
    t = np.arange(0.0, 3000.0, DT)
    seen = follow(np.where(t < 600.0, np.deg2rad(0.3) * np.sin(0.6 * t), 0.0))
    assert seen[5999] == pytest.approx(0.6, rel=0.05)
    assert seen[-1] == pytest.approx(0.8, rel=0.01)
    np.testing.assert_array_equal(follow(np.zeros(100)), 0.8)


def test_noise_alone_does_not_run_to_a_bound():
    seen = follow(np.deg2rad(1.0) * np.random.default_rng(3).standard_normal(20000), memory_s=60.0)
    assert 0.5 < seen[5000:].mean() < 1.1


def test_stays_within_bounds_and_keeps_through_missing_values():
    t = np.arange(0.0, 900.0, DT)
    assert follow(np.sin(2.5 * t)).max() <= 1.6
    assert follow(np.sin(0.1 * t)).min() >= 0.3
    whole = follow(np.sin(0.6 * t))
    gappy = follow(np.concatenate((np.sin(0.6 * t), [np.nan, np.inf, -np.inf])))
    np.testing.assert_array_equal(gappy[-3:], whole[-1])


def test_resonator_rings_as_its_equation_says():
    """Trapezoidal steps keep the energy of an undamped oscillator and settle a damped one at the drive."""
    value, rate = 1.0, 0.0
    for _ in range(1000):
        value, rate = resonator_step(value, rate, 0.0, 0.7, 0.0, DT)
    assert value**2 + (rate / 0.7) ** 2 == pytest.approx(1.0, rel=1e-12)
    assert value == pytest.approx(np.cos(0.7 * 100.0), abs=0.03)
    for _ in range(3000):
        value, rate = resonator_step(value, rate, 2.0, 0.7, 0.3, DT)
    assert (value, rate) == pytest.approx((2.0, 0.0), abs=1e-9)


def test_heave_is_the_acceleration_twice_integrated():
    omega, corner = 0.8, 0.1
    t = np.arange(0.0, 600.0, DT)
    state, seen = np.zeros(2), []
    for accel in 0.02 - omega**2 * 0.5 * np.cos(omega * t):  # an offset that must not run away
        state = heave_step(state, accel, corner, DT)
        seen.append(state[0])
    late = np.array(seen[4000:]) - 0.02 / corner**2
    # closed form of the filter at this frequency: the wave, a little turned
    gain = -(omega**2) / (corner**2 - omega**2 + 2j * 0.5**0.5 * corner * omega)
    assert abs(abs(gain) - 1.0) < 0.01
    np.testing.assert_allclose(late, 0.5 * np.real(gain * np.exp(1j * omega * t[4000:])), atol=0.03)
    np.testing.assert_array_equal(heave_step(state, np.nan, corner, DT), state)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"lowest": 0.9}, "must rise"),
        ({"memory_s": 5.0}, "memory_s"),
        ({"floor": 0.0}, "floor"),
        ({"highest": 40.0}, "0.1 s"),
    ],
)
def test_settings_out_of_range_are_named(changes, words):
    with pytest.raises(ValueError, match=words):
        frequency_params(DT, **(SETTINGS | changes))
