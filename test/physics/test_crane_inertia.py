"""Composite inertia and energies."""

import numpy as np
import pytest
from palfinger import (
    GRAVITY,
    eight_segment_chain,
    inertia_tensor,
    mixed_chain,
    mixed_telescopes,
    palfinger_chain,
    random_vectors,
)

from shipcrane_twin.physics.crane_chain import forward_kinematics
from shipcrane_twin.physics.crane_dynamics import base_wrench, mass_matrix
from shipcrane_twin.physics.crane_inertia import composite_inertia, kinetic_energy, potential_energy

ZERO = np.zeros(3)
BUILDS = pytest.mark.parametrize("build", [palfinger_chain, mixed_chain, eight_segment_chain, mixed_telescopes])


@pytest.mark.parametrize("build", [palfinger_chain, mixed_chain])
def test_composite_inertia_is_the_sum_over_the_links(build):
    chain = build()
    rng = np.random.default_rng(7)
    for _ in range(20):
        q = rng.normal(size=chain.kind.shape[0])
        origins, rotations = forward_kinematics(chain, q)
        centres = [origins[i] + rotations[i] @ chain.cog[i] for i in range(q.size)]
        mass = chain.mass.sum()
        centre = sum(m * c for m, c in zip(chain.mass, centres, strict=True)) / mass
        tensor = np.zeros((3, 3))
        for i in range(q.size):
            arm = centres[i] - centre
            tensor += rotations[i] @ chain.inertia[i] @ rotations[i].T
            tensor += chain.mass[i] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        total = composite_inertia(chain, q)
        np.testing.assert_allclose(total[:4], [mass, *centre], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(inertia_tensor(total[4:]), tensor, rtol=1e-11, atol=1e-9 * tensor.max())


@BUILDS
def test_frozen_joints_resist_base_acceleration_as_the_composite_body(build):
    chain = build()
    rng = np.random.default_rng(8)
    q = rng.normal(size=chain.kind.shape[0])
    al0, f0 = random_vectors(rng, 2)
    still = np.zeros_like(q)
    mass, *rest = composite_inertia(chain, q)
    centre, tensor = np.array(rest[:3]), inertia_tensor(np.array(rest[3:]))
    force = mass * (f0 + np.cross(al0, centre))
    moment = tensor @ al0 + np.cross(centre, force)
    wrench = base_wrench(chain, q, still, still, ZERO, al0, f0, ZERO)
    np.testing.assert_allclose(wrench, -np.concatenate((force, moment)), rtol=1e-11)


@BUILDS
def test_kinetic_energy_is_that_of_mass_matrix_and_of_the_composite_body(build):
    chain = build()
    rng = np.random.default_rng(9)
    q, qd = rng.normal(size=(2, chain.kind.shape[0]))
    v0, w0 = random_vectors(rng, 2)
    assert kinetic_energy(chain, q, qd, ZERO, ZERO) == pytest.approx(0.5 * qd @ mass_matrix(chain, q) @ qd)
    mass, *rest = composite_inertia(chain, q)
    velocity = v0 + np.cross(w0, rest[:3])
    energy = 0.5 * mass * velocity @ velocity + 0.5 * w0 @ inertia_tensor(np.array(rest[3:])) @ w0
    assert kinetic_energy(chain, q, 0.0 * qd, v0, w0) == pytest.approx(energy)


@BUILDS
def test_potential_energy_is_the_weight_lifted(build):
    chain = build()
    q = np.random.default_rng(10).normal(size=chain.kind.shape[0])
    total = composite_inertia(chain, q)
    energy = potential_energy(chain, q, np.array([0.0, 0.0, -GRAVITY]))
    assert energy == pytest.approx(total[0] * GRAVITY * total[3])
