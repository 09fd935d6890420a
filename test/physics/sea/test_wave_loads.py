"""Wave loads on a ship: phase, heading, mirror, frequency rules, drift, switches, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sea_series import GRAVITY, jonswap_sea

from shipcrane_twin.physics.sea.components import Regular, make_waves, realise
from shipcrane_twin.physics.sea.loads import outside_shares, wave_load, wave_load_params

OMEGA = np.linspace(0.1, 4.0, 60)
DIRECTION = np.linspace(0.0, np.pi, 37)
MIRROR = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
quick = settings(deadline=None, max_examples=50)
angle = st.floats(-7.0, 7.0)


def excitation(omega, direction):
    """Smooth loads (n, m, 6) of a slender ship of 34 m: long waves lift it, short ones cancel along it."""
    w, d = np.meshgrid(omega, direction, indexing="ij")
    number = w**2 / GRAVITY
    phase = 17.0 * number * np.cos(d)
    decay = np.exp(-2.0 * number)
    turned = np.exp(0.7j * number * np.cos(d))
    columns = [
        1j * w**2 * np.cos(d) * decay,
        -1j * w**2 * np.sin(d) * decay,
        np.sinc(phase / np.pi) * decay,
        -1j * np.sin(d) * (1.0 + 0.3 * np.cos(d)) * decay * w,
        1j * np.sin(phase) * decay,
        np.sin(d) * np.sin(phase) * decay,
    ]
    return 1e5 * np.stack(columns, axis=-1) * turned[..., None]


def mean_drift(omega, direction):
    """Mean drift (n, m, 3): pushes with the wave, turns the ship beam on, reverses in part of the range."""
    w, d = np.meshgrid(omega, direction, indexing="ij")
    size = 1e4 * w**2 / (1.0 + w**2) - 500.0
    return np.stack([size * np.cos(d), size * np.sin(d), -3.0 * size * np.sin(2.0 * d)], axis=-1)


EXCITATION, DRIFT = excitation(OMEGA, DIRECTION), mean_drift(OMEGA, DIRECTION)


def params_of(waves, **switches):
    return wave_load_params(waves, OMEGA, DIRECTION, EXCITATION, DRIFT, **switches)


def regular(period=8.0, direction=0.0, height=2.0, phase=0.0, ramp=0.0):
    systems = [Regular(height, period, direction, phase)]
    return realise(systems, np.random.default_rng(0), gravity=GRAVITY, depth=np.inf, ramp=ramp)


def single(omega, direction, ramp=0.0):
    columns = (np.array([value]) for value in (1.0, omega, direction, 0.0))
    return make_waves(*columns, gravity=GRAVITY, depth=np.inf, ramp=ramp)


def load(waves, t, x=0.0, y=0.0, yaw=0.0, **switches):
    return wave_load(params_of(waves, **switches), waves, t, x, y, yaw)


def transfer(waves, yaw=0.0):
    """Complex load (6,) per amplitude, found from two instants a quarter period apart."""
    quarter = 0.5 * np.pi / waves.omega[0]
    return load(waves, 0.0, yaw=yaw)[0] - 1j * load(waves, quarter, yaw=yaw)[0]


@pytest.mark.parametrize("row", [0, 3, 9, 18, 30, 36])
@pytest.mark.parametrize("column", [0, 8, 20, 40, 59])
def test_at_the_points_of_the_table_the_loads_are_those_of_the_table(column, row):
    waves = single(OMEGA[column], DIRECTION[row])
    np.testing.assert_allclose(transfer(waves), EXCITATION[column, row], atol=2.0)
    np.testing.assert_allclose(load(waves, 3.0)[1], DRIFT[column, row], atol=1e-3)


@pytest.mark.parametrize("period", [4.0, 6.0, 8.0, 12.0])
def test_between_the_points_the_loads_are_those_of_the_ship(period):
    omega = 2.0 * np.pi / period
    scale = np.abs(EXCITATION).max(axis=(0, 1))
    for direction in np.deg2rad([2.5, 33.1, 88.0, 121.7, 177.4]):
        exact = excitation([omega], [direction])[0, 0]
        assert (np.abs(transfer(single(omega, direction)) - exact) / scale).max() < 2e-3


def test_a_phase_that_turns_by_more_than_half_a_circle_between_frequencies_of_the_table_does_no_harm():
    # At a CoG far from the origin of phases, interpolated phases would jump by a whole turn; parts do not.
    shift = np.exp(1j * np.outer(OMEGA**2 / GRAVITY, 6.0 * np.cos(DIRECTION)))[..., None]
    waves = single(1.23, 0.4)
    exact = excitation([1.23], [0.4])[0, 0] * np.exp(6.0j * 1.23**2 / GRAVITY * np.cos(0.4))
    params = wave_load_params(waves, OMEGA, DIRECTION, EXCITATION * shift, DRIFT)
    assert np.angle(EXCITATION * shift).max() > 3.0
    found = wave_load(params, waves, 0.0, 0.0, 0.0, 0.0)[0]
    np.testing.assert_allclose(found, exact.real, atol=3e-3 * np.abs(EXCITATION).max())


@quick
@given(direction=st.floats(0.01, 3.13), t=st.floats(0.0, 100.0))
def test_waves_from_the_other_side_give_mirrored_loads(direction, t):
    port, starboard = load(regular(direction=direction), t), load(regular(direction=-direction), t)
    np.testing.assert_allclose(port[0], MIRROR * starboard[0], atol=1e-6)
    np.testing.assert_allclose(port[1], [1.0, -1.0, -1.0] * starboard[1], atol=1e-9)


@quick
@given(direction=angle, turn=angle, t=st.floats(0.0, 100.0))
def test_only_the_direction_from_the_bow_counts(direction, turn, t):
    one = load(regular(direction=direction), t)
    other = load(regular(direction=direction + turn), t, yaw=turn)
    np.testing.assert_allclose(one[0], other[0], atol=1e-3)
    np.testing.assert_allclose(one[1], other[1], atol=1e-3)


@quick
@given(x=st.floats(-100.0, 100.0), y=st.floats(-100.0, 100.0), direction=angle)
def test_the_phase_follows_the_ship(x, y, direction):
    waves = regular(direction=direction)
    number, omega = waves.number[0], waves.omega[0]
    delay = number * (x * np.cos(direction) + y * np.sin(direction)) / omega
    np.testing.assert_allclose(load(waves, 20.0 + delay, x, y)[0], load(waves, 20.0)[0], atol=0.01)


def test_a_ship_one_wave_length_further_feels_the_same():
    waves = regular(direction=0.6)
    length = 2.0 * np.pi / waves.number[0]
    moved = load(waves, 5.0, length * np.cos(0.6), length * np.sin(0.6))
    np.testing.assert_allclose(moved[0], load(waves, 5.0)[0], atol=0.01)
    halfway = load(waves, 5.0, 0.5 * length * np.cos(0.6), 0.5 * length * np.sin(0.6))
    np.testing.assert_allclose(halfway[0], -load(waves, 5.0)[0], atol=0.01)


def test_a_head_sea_is_felt_earlier_ahead():
    waves = regular(direction=np.pi)
    ahead = load(waves, 5.0, x=1.0)[0]
    later = load(waves, 5.0 + waves.number[0] / waves.omega[0], x=0.0)[0]
    np.testing.assert_allclose(ahead, later, atol=0.01)


def test_mean_drift_in_regular_waves(measured):
    wrong = []
    for period in (3.0, 6.0, 12.0):
        for direction in (0.0, 0.5, np.pi / 2, 2.5, -1.0):
            waves = regular(period, direction, height=3.0)
            found = np.mean([load(waves, t)[1] for t in np.linspace(0.0, period, 20, endpoint=False)], axis=0)
            exact = 2.25 * mean_drift([waves.omega[0]], [abs(direction)])[0, 0]
            exact[1:] *= 1.0 if direction >= 0.0 else -1.0
            wrong.append(np.abs(found - exact).max() / np.abs(exact).max())
    measured("mean drift in regular waves against the transfer function, 15 cases", 100.0 * max(wrong), 5.0, "%")


def test_drift_in_a_regular_wave_is_steady():
    waves = regular(6.0, 0.7)
    loads = np.array([load(waves, t)[1] for t in np.linspace(0.0, 6.0, 13)])
    np.testing.assert_allclose(loads, np.broadcast_to(loads[0], loads.shape), rtol=1e-12)


def test_mean_drift_of_a_sea_is_the_sum_over_its_components():
    waves = jonswap_sea(21, direction=0.7, spreading=20.0)
    params = params_of(waves)
    mean = np.mean([wave_load(params, waves, t, 0.0, 0.0, 0.0)[1] for t in np.arange(0.0, 40000.0, 2.5)], axis=0)
    from_bow = [(w, np.angle(np.exp(1j * d))) for w, d in zip(waves.omega, waves.direction, strict=True)]
    each = np.array([mean_drift([w], [abs(d)])[0, 0] * [1.0, np.sign(d), np.sign(d)] for w, d in from_bow])
    expected = waves.amplitude**2 @ each
    np.testing.assert_allclose(mean, expected, atol=0.05 * np.abs(expected).max())


def test_two_waves_drift_with_their_difference_frequency_alone():
    waves = make_waves(
        *np.array([[1.0, 0.5], [0.9, 1.1], [0.0, 0.0], [0.3, 1.0]]), gravity=GRAVITY, depth=np.inf, ramp=0.0
    )
    one, other = (mean_drift([w], [0.0])[0, 0, 0] for w in waves.omega)
    for t in np.linspace(0.0, 70.0, 9):
        newman = one + 0.25 * other + 2.0 * 0.5 * np.sqrt(one * other) * np.cos(0.2 * t + 0.7)
        assert load(waves, t)[1][0] == pytest.approx(newman, rel=1e-3)


def test_waves_with_drift_of_opposite_sign_do_not_mix():
    waves = make_waves(
        *np.array([[1.0, 1.0], [0.15, 1.5], [0.0, 0.0], [0.0, 0.0]]), gravity=GRAVITY, depth=np.inf, ramp=0.0
    )
    low, high = (mean_drift([w], [0.0])[0, 0, 0] for w in waves.omega)
    assert low < 0.0 < high
    for t in (0.0, 1.0, 2.0, 3.0):
        assert load(waves, t)[1][0] == pytest.approx(low + high, rel=2e-3)


def test_below_the_table_loads_are_held_and_above_it_they_fall():
    np.testing.assert_allclose(transfer(single(0.05, 0.0)), transfer(single(0.1, 0.0)), atol=1e-3)
    np.testing.assert_allclose(transfer(single(8.0, 0.5)), 0.25 * transfer(single(4.0, 0.5)), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(load(single(8.0, 0.5), 0.0)[1], load(single(4.0, 0.5), 0.0)[1], rtol=1e-9)
    below, above = outside_shares(
        make_waves(
            *np.array([[1, 2, 3.0], [0.05, 1, 9], [0, 0, 0], [0, 0, 0]]), gravity=GRAVITY, depth=np.inf, ramp=0.0
        ),
        OMEGA,
    )
    assert (below, above) == (pytest.approx(1 / 14), pytest.approx(9 / 14))


def test_loads_grow_with_amplitude_and_drift_with_its_square():
    small, large = load(regular(height=1.0, direction=0.4), 2.0), load(regular(height=3.0, direction=0.4), 2.0)
    np.testing.assert_allclose(large[0], 3.0 * small[0], rtol=1e-9)
    np.testing.assert_allclose(large[1], 9.0 * small[1], rtol=1e-9)


def test_while_the_sea_grows_so_do_the_loads():
    full, growing = load(regular(direction=0.4), 10.0), load(regular(direction=0.4, ramp=20.0), 10.0)
    np.testing.assert_allclose(growing[0], 0.5 * full[0], rtol=1e-12)
    np.testing.assert_allclose(growing[1], 0.25 * full[1], rtol=1e-12)


@pytest.mark.parametrize(("first", "slow"), [(True, False), (False, True), (False, False)])
def test_each_load_can_be_left_out(first, slow):
    waves = jonswap_sea(22, direction=0.4)
    both, some = load(waves, 9.0), load(waves, 9.0, first_order=first, slow_drift=slow)
    assert np.array_equal(some[0], both[0] if first else np.zeros(6))
    assert np.array_equal(some[1], both[1] if slow else np.zeros(3))
    assert both[0].any()
    assert both[1].any()


def test_a_calm_sea_has_no_loads():
    waves = make_waves(*np.zeros((4, 0)), gravity=GRAVITY, depth=np.inf, ramp=0.0)
    assert not np.concatenate(load(waves, 1.0)).any()
    assert outside_shares(waves, OMEGA) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"omega": OMEGA[::-1]}, "rising"),
        ({"omega": OMEGA[:-1]}, "expected \\(59, 37, 6\\)"),
        ({"direction": np.rad2deg(DIRECTION)}, "from 0 to pi"),
        ({"direction": DIRECTION * 0.9}, "from 0 to pi"),
        ({"excitation": EXCITATION[..., :5]}, "expected"),
        ({"excitation": np.full_like(EXCITATION, np.nan)}, "not finite"),
        ({"drift": DRIFT[:, :-1]}, "expected"),
    ],
)
def test_tables_that_do_not_fit_are_refused(change, word):
    tables = {"omega": OMEGA, "direction": DIRECTION, "excitation": EXCITATION, "drift": DRIFT} | change
    with pytest.raises(ValueError, match=word):
        wave_load_params(regular(), **tables)
