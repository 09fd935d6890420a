"""The small solver."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.physics.linalg import solve_spd


def positive_definite(size, seed):
    factor = np.random.default_rng(seed).normal(size=(size, size))
    return factor @ factor.T + 0.1 * np.eye(size)


@settings(deadline=None)
@given(size=st.integers(1, 8), seed=st.integers(0, 9999))
def test_solution_satisfies_the_equations(size, seed):
    matrix = positive_definite(size, seed)
    rhs = np.random.default_rng(seed + 1).normal(size=size)
    np.testing.assert_allclose(matrix @ solve_spd(matrix, rhs), rhs, atol=1e-9 * np.abs(rhs).max())


def test_inputs_stay_untouched_and_the_upper_triangle_unread():
    matrix, rhs = positive_definite(4, 3), np.arange(1.0, 5.0)
    lower = np.where(np.tri(4, dtype=bool), matrix, np.nan)
    kept = lower.copy(), rhs.copy()
    np.testing.assert_allclose(solve_spd(lower, rhs), np.linalg.solve(matrix, rhs))
    np.testing.assert_array_equal(lower, kept[0])
    np.testing.assert_array_equal(rhs, kept[1])


@pytest.mark.parametrize("matrix", [np.zeros((2, 2)), np.diag([1.0, -1.0]), np.array([[1.0, 2.0], [2.0, 1.0]])])
def test_a_matrix_that_is_not_positive_definite_is_refused(matrix):
    with pytest.raises(ValueError, match="not positive definite"):
        solve_spd(matrix, np.ones(2))
