"""The same chains in Pinocchio, an independent rigid-body library.

Every telescope segment is a prismatic joint of its own there; `Projection` ties it to its telescope.
"""

import numpy as np
import pinocchio as pin


def placement(row):
    """Fixed part of a modified D-H row; what the joint adds comes after it."""
    a, alpha, d, theta = row
    turn_x = pin.SE3(pin.utils.rotate("x", alpha), np.array([a, 0.0, 0.0]))
    return turn_x * pin.SE3(pin.utils.rotate("z", theta), np.array([0.0, 0.0, d]))


def segments_of(chain, link):
    return range(chain.segments.first[link], chain.segments.first[link + 1])


def crane_model(chain, gravity_w, *, floating):
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
        joint = pin.JointModelRZ() if kind == 0 else pin.JointModelPZ()
        parent = model.addJoint(parent, joint, placement(chain.dh[i]), f"joint{i}")
        body = pin.Inertia(own, chain.cog[i], chain.inertia[i])
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model, model.createData(), parent


def rounded_slide(stop, handover, extension):
    """Return slide, slope and curvature of a segment from the quintic itself, by polynomial algebra."""
    step = np.polynomial.Polynomial([0.0, 0.0, 0.0, 10.0, -15.0, 6.0])
    u = np.clip((extension - stop) / handover + 0.5, 0.0, 1.0)
    slide = min(extension, stop - 0.5 * handover) + handover * (u - step.integ()(u))
    return slide, 1.0 - step(u), -step.deriv()(u) / handover


class Projection:
    """Full joint values of the model, and what its forces are worth in the crane's joints."""

    def __init__(self, chain, q, qd):
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

    def velocity(self, qd):
        return self.jacobian @ qd

    def acceleration(self, qdd):
        return self.jacobian @ qdd + self.late

    def effort(self, full):
        return self.jacobian.T @ full


def force_on_last_link(chain, model, joint, tip_force, tip_rotation):
    """Return Pinocchio's list of external forces for a force at the tip, both in base axes."""
    tip_in_link = placement(chain.dh[-1])
    at_tip = pin.Force(tip_rotation.T @ tip_force, np.zeros(3))
    forces = pin.StdVec_Force()
    for k in range(model.njoints):
        forces.append(tip_in_link.act(at_tip) if k == joint else pin.Force.Zero())
    return forces
