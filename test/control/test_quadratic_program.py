"""Quadratic program: optimality proved by its own conditions, and what it says when there is no solution."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.control.quadratic_program import solve_qp

compiled = settings(deadline=None, max_examples=40)


def stiff_program(seed, stiffness):
    """Nine unknowns of which three take up what three equalities lack, at a high price; zero is feasible."""
    rng = np.random.default_rng(seed)
    weight = 10.0 ** rng.uniform(-1.0, 1.0, 9)
    weight[6:] = stiffness
    rows = rng.normal(size=(60, 9))
    rows[:, 6:] = 0.0
    rows[:3, 6:] = np.eye(3)
    limits = -rng.uniform(0.0, 1.0, 60)
    limits[:3] = rng.normal(size=3) * 3.0
    return weight, rng.normal(size=9) * 0.1, rows, limits


@compiled
@given(seed=st.integers(0, 99999), stiffness=st.sampled_from([1.0, 1e4, 1e8, 1e11]))
def test_solution_fulfils_the_conditions_that_make_it_the_only_optimum(seed, stiffness):
    weight, centre, rows, limits = stiff_program(seed, stiffness)
    x, multiplier, solved = solve_qp(weight, centre, rows, limits, 3)
    margin = rows @ x - limits
    assert solved
    np.testing.assert_allclose(margin[:3], 0.0, atol=1e-9)
    assert margin[3:].min() >= -1e-9
    assert multiplier[3:].min() >= 0.0
    np.testing.assert_allclose(x - centre, rows.T @ multiplier / weight, atol=1e-9 * (1.0 + np.abs(multiplier).max()))
    np.testing.assert_allclose(multiplier[3:] * margin[3:], 0.0, atol=1e-9 * (1.0 + np.abs(multiplier).max()))


@compiled
@given(point=st.tuples(*[st.floats(-5.0, 5.0)] * 4).map(np.array))
def test_in_a_box_the_nearest_point_is_the_clipped_one(point):
    rows = np.vstack((np.eye(4), -np.eye(4)))
    x, _, solved = solve_qp(np.array([1.0, 2.0, 3.0, 4.0]), point, rows, -np.ones(8), 0)
    assert solved
    np.testing.assert_allclose(x, np.clip(point, -1.0, 1.0), atol=1e-12)


def test_without_constraints_in_the_way_the_centre_is_the_solution():
    centre = np.array([0.1, -0.2])
    x, multiplier, solved = solve_qp(np.ones(2), centre, np.eye(2), -np.ones(2), 0)
    assert solved
    np.testing.assert_array_equal(x, centre)
    np.testing.assert_array_equal(multiplier, np.zeros(2))


def test_repeated_rows_and_empty_rows_do_no_harm():
    rows = np.array([[1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 0.0]])
    x, _, solved = solve_qp(np.ones(2), np.zeros(2), rows, np.array([1.0, 1.0, 2.0, -1.0]), 0)
    assert solved
    np.testing.assert_allclose(x, [1.0, 0.0])


@pytest.mark.parametrize(
    ("rows", "limits", "equalities"),
    [
        ([[1.0, 0.0], [-1.0, 0.0]], [1.0, 1.0], 0),
        ([[1.0, 0.0], [1.0, 0.0]], [1.0, 2.0], 2),
        ([[0.0, 0.0]], [1.0], 0),
        ([[1.0, 0.0]], [np.nan], 0),
        ([[np.inf, 0.0]], [1.0], 0),
    ],
)
def test_programs_without_solution_are_told(rows, limits, equalities):
    assert not solve_qp(np.ones(2), np.zeros(2), np.array(rows), np.array(limits), equalities)[2]


def test_the_same_program_gives_the_same_bits():
    program = stiff_program(7, 1e8)
    first, again = solve_qp(*program, 3), solve_qp(*program, 3)
    np.testing.assert_array_equal(first[0], again[0])
    np.testing.assert_array_equal(first[1], again[1])
