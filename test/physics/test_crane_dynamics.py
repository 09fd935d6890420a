"""Mass matrix, bias and base wrench: laws, hand calculation and an independent library."""

import numpy as np
import pytest
from palfinger import (
    GRAVITY,
    UP,
    WORK_POSE,
    eight_segment_chain,
    mixed_chain,
    mixed_telescopes,
    palfinger_chain,
)

from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces, mass_matrix
from shipcrane_twin.physics.crane_inertia import coriolis_matrix
from shipcrane_twin.physics.linalg import solve_in_place

ZERO = np.zeros(3)
BUILDS = pytest.mark.parametrize("build", [palfinger_chain, mixed_chain, eight_segment_chain, mixed_telescopes])


def states(chain, count=120, seed=5):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        q, qd, qdd = rng.normal(size=(3, chain.kind.shape[0])) * [[1.5], [1.0], [1.0]]
        if chain.segments.rows.size:
            slides = np.flatnonzero(np.diff(chain.segments.first))
            q[slides] = rng.uniform(0.0, chain.segments.rows[:, 1].max() + 0.5, slides.size)
        yield q, qd, qdd, rng


def assert_close(got, expected):
    """Compare to 1e-9 of the largest entry."""
    assert np.abs(got - expected).max() <= 1e-9 * np.abs(expected).max()


@BUILDS
def test_mass_matrix_is_symmetric_positive_definite(build):
    chain = build()
    for q, *_ in states(chain):
        matrix = mass_matrix(chain, q)
        np.testing.assert_array_equal(matrix, matrix.T)
        assert np.linalg.eigvalsh(matrix)[0] > 0.0


def test_the_telescope_has_its_mass():
    assert mass_matrix(palfinger_chain(), WORK_POSE)[3, 3] == pytest.approx(1000.0, rel=1e-12)


@BUILDS
def test_dynamics_equal_pinocchio(build, measured):
    pytest.importorskip("pinocchio", reason="Pinocchio, the independent library, is not installed")
    from shipcrane_twin.validation.pinocchio_crane import joint_space_errors, moving_base_errors

    chain = build()
    for name, error in (joint_space_errors(chain) | moving_base_errors(chain)).items():
        measured(f"crane {name} against Pinocchio, {build.__name__}: relative error", error, 1e-9)


@BUILDS
def test_mass_matrix_rate_less_twice_coriolis_is_skew(build):
    chain = build()
    h = 1e-3
    for q, qd, *_ in states(chain, count=30):
        # Derivative along qd by central differences of order six.
        samples = {k: mass_matrix(chain, q + k * h * qd) for k in (-3, -2, -1, 1, 2, 3)}
        rate = (
            45 * (samples[1] - samples[-1]) - 9 * (samples[2] - samples[-2]) + (samples[3] - samples[-3])
        ) / (60 * h)
        skew = rate - 2.0 * coriolis_matrix(chain, q, qd)
        np.testing.assert_allclose(skew + skew.T, 0.0, atol=1e-9 * np.abs(mass_matrix(chain, q)).max())


@BUILDS
def test_coriolis_matrix_gives_the_bias_of_a_resting_weightless_base(build):
    chain = build()
    for q, qd, *_ in states(chain, count=30):
        assert_close(coriolis_matrix(chain, q, qd) @ qd, bias_forces(chain, q, qd, ZERO, ZERO, ZERO, ZERO))


def test_crane_at_rest_weighs_on_the_ship_where_its_masses_are():
    # Slew 0, boom and knuckle level: link CoGs by hand at x = 0, -0.38 + 1, -0.38 + 1.85 - 0.5 for knuckle
    # and telescope; y = +0.6 for the last two (b = -0.6 along z2, which points to -y); tip at x 0.97, y 0.6.
    q = np.array([0.0, 0.0, 0.0, 2.0])
    load = 7000.0
    wrench = base_wrench(palfinger_chain(), q, 0.0 * q, 0.0 * q, ZERO, ZERO, UP, np.array([0.0, 0.0, -load]))
    weight = GRAVITY * (1524.0 + 2236.0 + 1264.0 + 1000.0) + load
    along = GRAVITY * (2236.0 * 0.62 + (1264.0 + 1000.0) * 0.97) + load * 0.97
    aside = GRAVITY * (1264.0 + 1000.0) * 0.6 + load * 0.6
    np.testing.assert_allclose(wrench, [0.0, 0.0, -weight, -aside, along, 0.0], atol=1e-8)


def test_levers_at_rest_by_hand():
    # The same pose: boom and knuckle carry what hangs outboard of their pins at x = -0.38 and 1.47.
    q = np.array([0.0, 0.0, 0.0, 2.0])
    effort = bias_forces(palfinger_chain(), q, 0.0 * q, ZERO, ZERO, UP, np.array([0.0, 0.0, -7000.0]))
    knuckle = (GRAVITY * (1264.0 + 1000.0) + 7000.0) * (0.97 - 1.47)
    boom = GRAVITY * (2236.0 * 1.0 + (1264.0 + 1000.0) * 1.35) + 7000.0 * 1.35
    np.testing.assert_allclose(effort, [0.0, boom, knuckle, -GRAVITY * 1000.0 - 7000.0], atol=1e-8)


def test_solver_solves_and_reports_what_is_not_positive_definite():
    rng = np.random.default_rng(6)
    root = rng.normal(size=(5, 5))
    matrix, right = root @ root.T + np.eye(5), rng.normal(size=5)
    x = right.copy()
    assert solve_in_place(matrix.copy(), x)
    np.testing.assert_allclose(matrix @ x, right, atol=1e-12)
    assert not solve_in_place(np.diag([1.0, -1.0]), np.ones(2))
    assert not solve_in_place(np.full((2, 2), np.nan), np.ones(2))
