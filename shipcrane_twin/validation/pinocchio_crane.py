"""Cranes in Pinocchio, an independent rigid-body library, and how far the dynamics here are from it.

Every telescope segment is a prismatic joint of its own there; `Projection` ties it to its telescope. Needs the package
``pin``, which a run does not.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import PRISMATIC, REVOLUTE, ChainParams, forward_kinematics
from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces, mass_matrix
from shipcrane_twin.physics.crane_inertia import coriolis_matrix

GRAVITY_W = np.array([0.0, 0.0, -9.80665])
STATES = 120
"""Random states that each comparison goes through."""


def placement(row: Array) -> Any:
    """Return the fixed part of a modified D-H row; what the joint adds comes after it."""
    a, alpha, d, theta = row
    turn_x = pin.SE3(pin.utils.rotate("x", alpha), np.array([a, 0.0, 0.0]))
    return turn_x * pin.SE3(pin.utils.rotate("z", theta), np.array([0.0, 0.0, d]))


def segments_of(chain: ChainParams, link: int) -> range:
    """Return the rows of a link's segments."""
    return range(chain.segments.first[link], chain.segments.first[link + 1])


def crane_model(chain: ChainParams, gravity_w: Array, *, floating: bool) -> tuple[Any, Any, int]:
    """Return model, data and the id of the last joint; the root is a free flyer or the world.

    The segments of a telescope come before it in the model's joints. Their inertias are known only as a sum; as
    they do not turn against each other, the last one may have it all.
    """
    model = pin.Model()
    model.gravity.linear = gravity_w
    parent = 0
    if floating:
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "ship")
    for i, kind in enumerate(chain.kind):
        own = chain.mass[i]
        for k in segments_of(chain, i):
            own -= chain.segments.rows[k, 0]
            slide = model.addJoint(parent, pin.JointModelPZ(), placement(chain.dh[i]), f"segment{k}")
            body = pin.Inertia(chain.segments.rows[k, 0], chain.segments.rows[k, 2:], np.zeros((3, 3)))
            model.appendBodyToJoint(slide, body, pin.SE3.Identity())
        joint = pin.JointModelRZ() if kind == REVOLUTE else pin.JointModelPZ()
        parent = model.addJoint(parent, joint, placement(chain.dh[i]), f"joint{i}")
        body = pin.Inertia(own, chain.cog[i], chain.inertia[i])
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model, model.createData(), parent


def rounded_slide(stop: float, handover: float, extension: float) -> tuple[float, float, float]:
    """Return slide, slope and curvature of a segment from the quintic itself, by polynomial algebra."""
    step = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    u = min(max((extension - stop) / handover + 0.5, 0.0), 1.0)
    slide = min(extension, stop - 0.5 * handover) + handover * (u - step.integ()(u))
    return slide, 1.0 - step(u), -step.deriv()(u) / handover


class Projection:
    """Full joint values of the model, and what its forces are worth in the crane's joints."""

    def __init__(self, chain: ChainParams, q: Array, qd: Array) -> None:
        rows, rates, full = [], [], []
        n = len(q)
        for i in range(n):
            for k in segments_of(chain, i):
                slide, slope, curve = rounded_slide(chain.segments.rows[k, 1], chain.segments.handover, q[i])
                full.append(slide)
                rows.append(slope * np.eye(n)[i])
                rates.append(curve * qd[i] ** 2)
            full.append(q[i])
            rows.append(np.eye(n)[i])
            rates.append(0.0)
        self.q, self.jacobian, self.late = np.array(full), np.array(rows), np.array(rates)

    def velocity(self, qd: Array) -> Array:
        """Return the model's joint rates."""
        return self.jacobian @ qd

    def acceleration(self, qdd: Array) -> Array:
        """Return the model's joint accelerations."""
        return self.jacobian @ qdd + self.late

    def effort(self, full: Array) -> Array:
        """Return the crane's joint efforts for those of the model."""
        return self.jacobian.T @ full


def force_on_last_link(chain: ChainParams, model: Any, joint: int, tip_force: Array, tip_rotation: Array) -> Any:
    """Return Pinocchio's list of external forces for a force at the tip, both in base axes."""
    tip_in_link = placement(chain.dh[-1])
    at_tip = pin.Force(tip_rotation.T @ tip_force, np.zeros(3))
    forces = pin.StdVec_Force()
    for k in range(model.njoints):
        forces.append(tip_in_link.act(at_tip) if k == joint else pin.Force.Zero())
    return forces


def random_states(chain: ChainParams, rng: np.random.Generator, count: int) -> Iterator[tuple[Array, Array, Array]]:
    """Yield joint values, rates and accelerations; telescopes over their whole stroke and a little beyond."""
    stroke = chain.segments.rows[:, 1].max() + 0.5 if chain.segments.rows.size else 0.0
    slides = np.flatnonzero((chain.kind == PRISMATIC) & (np.diff(chain.segments.first) > 0))
    for _ in range(count):
        q, qd, qdd = rng.normal(size=(3, chain.kind.shape[0])) * [[1.5], [1.0], [1.0]]
        q[slides] = rng.uniform(0.0, stroke, slides.size)
        yield q, qd, qdd


def relative(got: Array, expected: Array) -> float:
    """Return the largest difference over the largest entry."""
    return float(np.abs(got - expected).max() / np.abs(expected).max())


def joint_space_errors(chain: ChainParams, count: int = STATES, seed: int = 5) -> dict[str, float]:
    """Return the largest relative errors of mass matrix, Coriolis forces and weight on a base at rest."""
    still = np.zeros(3)
    model, data, _ = crane_model(chain, GRAVITY_W, floating=False)
    bare, _, _ = crane_model(chain, still, floating=False)
    worst = dict.fromkeys(("mass matrix", "Coriolis matrix times rates", "Coriolis forces", "weight"), 0.0)
    for q, qd, _ in random_states(chain, np.random.default_rng(seed), count):
        full = Projection(chain, q, qd)
        upper = pin.crba(bare, data, full.q)
        whole = full.jacobian.T @ (np.triu(upper) + np.triu(upper, 1).T) @ full.jacobian
        rates = full.effort(pin.rnea(bare, data, full.q, full.velocity(qd), full.late))
        weight = full.effort(pin.computeGeneralizedGravity(model, data, full.q))
        for name, error in (
            ("mass matrix", relative(mass_matrix(chain, q), whole)),
            ("Coriolis matrix times rates", relative(coriolis_matrix(chain, q, qd) @ qd, rates)),
            ("Coriolis forces", relative(bias_forces(chain, q, qd, still, still, still, still), rates)),
            ("weight", relative(bias_forces(chain, q, 0.0 * qd, still, still, -GRAVITY_W, still), weight)),
        ):
            worst[name] = max(worst[name], error)
    return worst


def moving_base_errors(chain: ChainParams, count: int = STATES, seed: int = 5) -> dict[str, float]:
    """Return the largest relative errors of joint efforts and base wrench, all six motions of the base at work."""
    rng = np.random.default_rng(seed)
    model, data, last = crane_model(chain, GRAVITY_W, floating=True)
    worst = dict.fromkeys(("joint efforts", "force on the ship", "moment on the ship"), 0.0)
    for q, qd, qdd in random_states(chain, rng, count):
        v0, w0, a0, al0 = rng.normal(size=(4, 3))
        tip_force = rng.normal(size=3) * 2e4
        attitude = rng.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        to_world = pin.Quaternion(attitude).toRotationMatrix()
        tip_rotation = forward_kinematics(chain, q)[1][len(q)]
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
        f0 = a0 - to_world.T @ GRAVITY_W
        effort = mass_matrix(chain, q) @ qdd + bias_forces(chain, q, qd, w0, al0, f0, tip_force)
        wrench = base_wrench(chain, q, qd, qdd, w0, al0, f0, tip_force)
        for name, error in (
            ("joint efforts", relative(effort, full.effort(expected[6:]))),
            ("force on the ship", relative(wrench[:3], -expected[:3])),
            ("moment on the ship", relative(wrench[3:], -expected[3:6])),
        ):
            worst[name] = max(worst[name], error)
    return worst
