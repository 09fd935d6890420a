"""The same chains in Pinocchio, an independent rigid-body library."""

import numpy as np
import pinocchio as pin


def placement(row):
    """Fixed part of a modified D-H row; what the joint adds comes after it."""
    a, alpha, d, theta = row
    turn_x = pin.SE3(pin.utils.rotate("x", alpha), np.array([a, 0.0, 0.0]))
    return turn_x * pin.SE3(pin.utils.rotate("z", theta), np.array([0.0, 0.0, d]))


def crane_model(chain, gravity_w, *, floating):
    """Return model, data and the id of the last joint; the root is a free flyer or the world."""
    model = pin.Model()
    model.gravity.linear = gravity_w
    parent = 0
    if floating:
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "ship")
    for i, kind in enumerate(chain.kind):
        joint = pin.JointModelRZ() if kind == 0 else pin.JointModelPZ()
        parent = model.addJoint(parent, joint, placement(chain.dh[i]), f"joint{i}")
        body = pin.Inertia(chain.mass[i], chain.cog[i], chain.inertia[i])
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model, model.createData(), parent


def force_on_last_link(chain, model, joint, tip_force, tip_rotation):
    """Return Pinocchio's list of external forces for a force at the tip, both in base axes."""
    tip_in_link = placement(chain.dh[-1])
    at_tip = pin.Force(tip_rotation.T @ tip_force, np.zeros(3))
    forces = pin.StdVec_Force()
    for k in range(model.njoints):
        forces.append(tip_in_link.act(at_tip) if k == joint else pin.Force.Zero())
    return forces
