"""Current: mean, variance, memory, sameness, interpolation, profile, refusals."""

import numpy as np
import pytest

from shipcrane_twin.physics.sea.current import current_at, mean_factor, realise_current

MEAN, DIRECTION, DEVIATION, MEMORY = 0.6, 2.2, 0.1, 120.0


def realised(seed=1, duration=3600.0, **changes):
    settings = {
        "mean_speed": MEAN,
        "direction": DIRECTION,
        "deviation": DEVIATION,
        "time_constant": MEMORY,
        "duration": duration,
    } | changes
    return realise_current(rng=np.random.default_rng(seed), **settings)


def test_mean_variance_and_memory_are_those_of_a_gauss_markov_process():
    deviation = realised(2, duration=400000.0).velocity - MEAN * np.array([np.cos(DIRECTION), np.sin(DIRECTION)])
    independent = 400000.0 / (2.0 * MEMORY)  # number of independent values in the record
    for one in deviation.T:
        assert abs(one.mean()) < 4.0 * DEVIATION / np.sqrt(independent)
        assert one.var() == pytest.approx(DEVIATION**2, rel=4.0 * np.sqrt(2.0 / independent))
        for lag in (12, 60, 120, 240):
            assert np.mean(one[lag:] * one[:-lag]) / one.var() == pytest.approx(np.exp(-lag / MEMORY), abs=0.08)
    assert abs(np.corrcoef(deviation.T)[0, 1]) < 4.0 / np.sqrt(independent)


def test_the_start_is_as_varied_as_the_rest():
    starts = np.array([realised(seed, duration=1.0).velocity[0] for seed in range(2000)])
    np.testing.assert_allclose(starts.std(axis=0), DEVIATION, rtol=0.06)


def test_the_step_of_the_grid_does_not_change_the_process():
    coarse = realised(3, duration=400000.0, step=10.0).velocity
    coarse = coarse - coarse.mean(axis=0)
    assert coarse.var() == pytest.approx(DEVIATION**2, rel=0.1)
    assert np.mean(coarse[12:] * coarse[:-12]) / coarse.var() == pytest.approx(np.exp(-1.0), abs=0.08)


def test_the_same_seed_gives_the_same_current_and_a_longer_run_begins_alike():
    one, other, third = realised(4), realised(4), realised(5)
    assert np.array_equal(one.velocity, other.velocity)
    assert not np.array_equal(one.velocity, third.velocity)
    assert np.array_equal(realised(4, duration=7200.0).velocity[:3601], one.velocity)


def test_a_steady_current_is_its_mean_at_all_times():
    current = realised(deviation=0.0)
    for t in (0.0, 100.0, 1e6):
        np.testing.assert_allclose(
            current_at(current, t), [MEAN * np.cos(DIRECTION), MEAN * np.sin(DIRECTION)], atol=1e-12
        )


def test_between_the_times_the_current_is_on_a_line_and_outside_held():
    current = realised(6, duration=10.0)
    grid = current.velocity
    np.testing.assert_allclose(current_at(current, 3.0), grid[3], rtol=1e-15)
    np.testing.assert_allclose(current_at(current, 3.25), 0.75 * grid[3] + 0.25 * grid[4], rtol=1e-14)
    assert current_at(current, -1.0).tolist() == grid[0].tolist()
    assert current_at(current, 10.0).tolist() == current_at(current, 99.0).tolist() == grid[-1].tolist()
    assert len(grid) == 11


@pytest.mark.parametrize(
    ("depth", "factor", "draught", "expected"),
    [
        ([0.0], [1.0], 2.6, 1.0),
        ([0.0, 10.0], [1.0, 0.0], 2.0, 0.9),
        ([0.0, 1.0], [1.0, 0.5], 2.0, 0.5 * 0.75 + 0.5 * 0.5),
        ([0.0, 1.0, 2.0], [1.0, 0.8, 0.2], 2.0, 0.5 * 0.9 + 0.5 * 0.5),
    ],
)
def test_the_hull_feels_the_mean_over_its_draught(depth, factor, draught, expected):
    assert mean_factor(depth, factor, draught) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: realised(mean_speed=-1.0), "mean speed -1"),
        (lambda: realised(deviation=-0.1), "deviation -0.1"),
        (lambda: realised(direction=np.inf), "direction inf"),
        (lambda: realised(time_constant=2.0), "time constant 2"),
        (lambda: realised(step=0.0), "steps of 0"),
        (lambda: realised(duration=-5.0), "duration is -5"),
        (lambda: mean_factor([1.0, 2.0], [1.0, 1.0], 2.0), "from 0"),
        (lambda: mean_factor([0.0, 2.0, 1.0], [1.0, 1.0, 1.0], 2.0), "from 0"),
        (lambda: mean_factor([0.0, 2.0], [1.0], 2.0), "one factor each"),
        (lambda: mean_factor([0.0], [1.0], 0.0), "draught 0"),
    ],
)
def test_impossible_currents_are_refused(call, word):
    with pytest.raises(ValueError, match=word):
        call()
