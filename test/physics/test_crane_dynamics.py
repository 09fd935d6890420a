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
    random_vectors,
)

from shipcrane_twin.physics.crane_chain import forward_kinematics
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


def relative(got, expected):
    """Return the largest difference over the largest entry."""
    return np.abs(got - expected).max() / np.abs(expected).max()


def assert_close(got, expected):
    """Compare to 1e-9 of the largest entry."""
    assert relative(got, expected) <= 1e-9


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
def test_mass_matrix_and_coriolis_equal_pinocchio(build, measured):
    pin = pytest.importorskip("pinocchio", reason="Pinocchio, the independent library, is not installed")
    from pinocchio_crane import Projection, crane_model

    chain = build()
    model, data, _ = crane_model(chain, ZERO, floating=False)
    mass, coriolis = 0.0, 0.0
    for q, qd, *_ in states(chain):
        full = Projection(chain, q, qd)
        matrix = pin.crba(model, data, full.q)
        matrix = full.jacobian.T @ (np.triu(matrix) + np.triu(matrix, 1).T) @ full.jacobian
        mass = max(mass, relative(mass_matrix(chain, q), matrix))
        theirs = full.effort(pin.rnea(model, data, full.q, full.velocity(qd), full.acceleration(0.0 * qd)))
        coriolis = max(coriolis, relative(coriolis_matrix(chain, q, qd) @ qd, theirs))
        assert_close(bias_forces(chain, q, qd, ZERO, ZERO, ZERO, ZERO), theirs)
    measured(f"crane mass matrix against Pinocchio, {build.__name__}: relative error", mass, 1e-9)
    measured(f"crane Coriolis forces against Pinocchio, {build.__name__}: relative error", coriolis, 1e-9)


@BUILDS
def test_gravity_equals_pinocchio(build, measured):
    pin = pytest.importorskip("pinocchio", reason="Pinocchio, the independent library, is not installed")
    from pinocchio_crane import Projection, crane_model

    chain = build()
    worst = 0.0
    for q, qd, _, rng in states(chain):
        gravity = rng.normal(size=3) * GRAVITY
        model, data, _ = crane_model(chain, gravity, floating=False)
        ours = bias_forces(chain, q, 0.0 * qd, ZERO, ZERO, -gravity, ZERO)
        full = Projection(chain, q, 0.0 * qd)
        worst = max(worst, relative(ours, full.effort(pin.computeGeneralizedGravity(model, data, full.q))))
    measured(f"crane gravity forces against Pinocchio, {build.__name__}: relative error", worst, 1e-9)


@BUILDS
def test_efforts_and_base_wrench_on_a_moving_base_equal_pinocchio(build, measured):
    pin = pytest.importorskip("pinocchio", reason="Pinocchio, the independent library, is not installed")
    from pinocchio_crane import Projection, crane_model, force_on_last_link

    chain = build()
    joints = chain.kind.shape[0]
    gravity_w = np.array([0.0, 0.0, -GRAVITY])
    model, data, last = crane_model(chain, gravity_w, floating=True)
    joint, worst = 0.0, 0.0
    for q, qd, qdd, rng in states(chain):
        v0, w0, a0, al0 = random_vectors(rng, 4)
        tip_force = rng.normal(size=3) * 2e4
        attitude = rng.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        base_to_world = pin.Quaternion(attitude).toRotationMatrix()
        tip_rotation = forward_kinematics(chain, q)[1][joints]
        full = Projection(chain, q, qd)
        expected = pin.rnea(
            model,
            data,
            np.concatenate((rng.normal(size=3), attitude, full.q)),
            np.concatenate((v0, w0, full.velocity(qd))),
            # Pinocchio's acceleration is spatial: the point's own one less w x v.
            np.concatenate((a0 - np.cross(w0, v0), al0, full.acceleration(qdd))),
            force_on_last_link(chain, model, last, tip_force, tip_rotation),
        )
        f0 = a0 - base_to_world.T @ gravity_w
        effort = mass_matrix(chain, q) @ qdd + bias_forces(chain, q, qd, w0, al0, f0, tip_force)
        joint = max(joint, relative(effort, full.effort(expected[6:])))
        wrench = base_wrench(chain, q, qd, qdd, w0, al0, f0, tip_force)
        worst = max(worst, relative(wrench[:3], -expected[:3]), relative(wrench[3:], -expected[3:6]))
    name = f"on a moving base against Pinocchio, {build.__name__}"
    measured(f"crane efforts {name}: relative error", joint, 1e-9)
    measured(f"crane base wrench {name}: relative error", worst, 1e-9)


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
