"""Where the crane's frames are, and how the tip moves."""

import numpy as np
import pytest
from kinematics_rows import kinematics_rows
from palfinger import WORK_POSE, mixed_chain, palfinger_chain

from shipcrane_twin.physics.crane_chain import forward_kinematics, make_chain, tip_jacobian, tip_state


def test_tip_equals_the_published_crane(measured):
    chain = palfinger_chain()
    _, joints, tips = kinematics_rows()
    found = [tip_state(chain, q, np.zeros(4))[0] for q in joints]
    measured("crane tip, 50 reference rows: largest error", np.abs(np.array(found) - tips).max(), 1e-6, "m")


def test_tip_equals_the_published_closed_form():
    chain = palfinger_chain()
    rng = np.random.default_rng(1)
    for q in rng.uniform([-3.0, -1.0, -1.0, 0.0], [3.0, 1.0, 1.5, 10.0], (100, 4)):
        c1, s1, c2, s2 = np.cos(q[0]), np.sin(q[0]), np.cos(q[1]), np.sin(q[1])
        c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
        reach = -0.38 + 1.85 * c2 - 0.5 * c23 + (2.0 + q[3]) * s23
        tip = [
            c1 * reach - 0.6 * s1,
            s1 * reach + 0.6 * c1,
            2.0 + 1.85 * s2 - 0.5 * s23 - (2.0 + q[3]) * c23,
        ]
        np.testing.assert_allclose(forward_kinematics(chain, q)[0][4], tip, rtol=0.0, atol=1e-13)


def homogeneous(row, value, kind):
    """One modified D-H row as the textbook writes it: Rx(alpha) Tx(a) Rz(theta) Tz(d)."""
    a, alpha, d, theta = row
    theta, d = (theta + value, d) if kind == 0 else (theta, d + value)
    ca, sa, ct, st = np.cos(alpha), np.sin(alpha), np.cos(theta), np.sin(theta)
    turn_x = np.array([[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1.0]])
    turn_z = np.array([[ct, -st, 0, 0], [st, ct, 0, 0], [0, 0, 1, d], [0, 0, 0, 1.0]])
    return turn_x @ turn_z


def test_frames_are_the_product_of_textbook_transforms():
    chain = mixed_chain()
    q = np.random.default_rng(2).normal(size=6)
    origin_b, rotation_b = forward_kinematics(chain, q)
    transform = np.eye(4)
    for i, (row, value, kind) in enumerate(zip(chain.dh, [*q, 0.0], [*chain.kind, 0], strict=True)):
        transform = transform @ homogeneous(row, value, kind)
        np.testing.assert_allclose(origin_b[i], transform[:3, 3], atol=1e-12)
        np.testing.assert_allclose(rotation_b[i], transform[:3, :3], atol=1e-12)


@pytest.mark.parametrize("build", [palfinger_chain, mixed_chain])
def test_jacobian_is_the_derivative_of_the_tip_frame(build):
    chain = build()
    joints = chain.kind.shape[0]
    rng = np.random.default_rng(3)
    step = 1e-5
    for _ in range(20):
        q = rng.normal(size=joints)
        jacobian = tip_jacobian(chain, q)
        rotation = forward_kinematics(chain, q)[1][joints]
        for i in range(joints):
            ahead, behind = q.copy(), q.copy()
            ahead[i] += step
            behind[i] -= step
            (p1, r1), (p0, r0) = (forward_kinematics(chain, x) for x in (ahead, behind))
            spin = (r1[joints] - r0[joints]) @ rotation.T / (2 * step)
            turned = [spin[2, 1], spin[0, 2], spin[1, 0]]
            np.testing.assert_allclose(jacobian[:3, i], (p1[joints] - p0[joints]) / (2 * step), atol=1e-8)
            np.testing.assert_allclose(jacobian[3:, i], turned, atol=1e-8)


@pytest.mark.parametrize("build", [palfinger_chain, mixed_chain])
def test_tip_state_moves_as_its_jacobian_says(build):
    chain = build()
    rng = np.random.default_rng(4)
    q, qd = rng.normal(size=(2, chain.kind.shape[0]))
    position_b, velocity_b, angular_velocity_b, rotation_b = tip_state(chain, q, qd)
    origins_b, rotations_b = forward_kinematics(chain, q)
    np.testing.assert_array_equal(position_b, origins_b[-1])
    np.testing.assert_array_equal(rotation_b, rotations_b[-1])
    np.testing.assert_allclose(
        np.concatenate((velocity_b, angular_velocity_b)), tip_jacobian(chain, q) @ qd, atol=1e-12
    )


def one_link(**changes):
    link = {
        "dh": np.zeros((2, 4)),
        "kind": ["revolute"],
        "mass": [1.0],
        "cog": np.zeros((1, 3)),
        "inertia": [np.eye(3)],
    }
    return make_chain(**(link | changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": []}, "kind is empty"),
        ({"kind": ["hinge"]}, "'hinge' is unknown"),
        ({"dh": np.zeros((1, 4))}, r"dh .* has shape \(1, 4\), expected \(2, 4\)"),
        ({"dh": np.full((2, 4), np.nan)}, "dh .* not finite"),
        ({"mass": [0.0]}, r"mass\[0\] is 0.0 kg"),
        ({"cog": np.zeros(3)}, "cog has shape"),
        ({"inertia": [np.array([[1.0, 0.5, 0], [0, 1, 0], [0, 0, 1]])]}, r"inertia\[0\] is not symmetric"),
        ({"inertia": [np.diag([1.0, 1.0, 3.0])]}, "principal values"),
        ({"inertia": [np.diag([-1.0, 1.0, 1.0])]}, "principal values"),
    ],
)
def test_an_impossible_chain_is_named(changes, message):
    with pytest.raises(ValueError, match=message):
        one_link(**changes)


def test_a_pose_of_the_wrong_length_is_refused():
    with pytest.raises(ValueError, match="number of joint values"):
        tip_jacobian(palfinger_chain(), WORK_POSE[:3])
