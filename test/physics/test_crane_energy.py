"""Energy: conserved by the free crane, balanced by power on a moving base."""

import numpy as np
import pytest
from palfinger import (
    GRAVITY,
    eight_segment_chain,
    mixed_chain,
    mixed_telescopes,
    palfinger_actuators,
    palfinger_chain,
)
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics.crane_actuators import standing_state
from shipcrane_twin.physics.crane_chain import tip_jacobian, tip_state
from shipcrane_twin.physics.crane_cylinders import LinearDrive, make_drives
from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces, mass_matrix
from shipcrane_twin.physics.crane_inertia import kinetic_energy, potential_energy
from shipcrane_twin.physics.crane_reference import make_limits
from shipcrane_twin.validation.lifting_energy import swing

# Without a spring the telescope slides out and falls for ever; on one, boom and knuckle swing as a pendulum.
SPRINGS = {
    "free": np.zeros(4),
    "telescope sprung": np.array([0.0, 0.0, 0.0, 5e4]),
    "all sprung": np.array([1e4, 3e4, 2e4, 5e3]),
}
ENDLESS = make_drives([LinearDrive()] * 4)
LIMITS = make_limits(ENDLESS, rate_max=1.0, accel_max=1.0, jerk_max=1.0, end_margin=0.0)


def swung(chain, spring, rest, rates, seconds):
    """Let an undamped crane swing on springs at its joints."""
    # where a drive yields, a spring of no stiffness would divide by zero
    actuators = palfinger_actuators(stiffness=np.maximum(spring, 1e-12), damping=np.zeros(4))
    state = standing_state(actuators, ENDLESS, rest, np.zeros(4))
    state[4:8] = rates
    return swing(chain, actuators, LIMITS, state, seconds)


def assert_kept(name, found, measured):
    measured(f"energy of the undamped crane, {name}: drift over energy exchanged", found.drift, 1e-5)


@pytest.mark.parametrize("name", SPRINGS)
def test_undamped_crane_on_a_resting_base_keeps_its_energy(name, measured):
    seconds = 60 if name == "free" else 300
    rest = np.array([0.3, 0.4, 0.8, 1.0])
    found = swung(palfinger_chain(), SPRINGS[name], rest, [0.3, 0.0, 0.1, 0.0], seconds)
    assert np.ptp(found.kinetic) > 1e4  # it does fall and swing
    assert_kept(f"{name}, {seconds} s", found, measured)


def test_undamped_crane_keeps_its_energy_while_segments_hand_over(measured):
    rest = np.array([0.3, 0.4, 0.8, 2.55])
    spring = np.array([1e6, 3e6, 2e6, 5e4])
    found = swung(eight_segment_chain(), spring, rest, [0.2, 0.1, 0.1, 0.9], 300)
    places = found.joints
    crossings = np.count_nonzero(np.diff(places[:, 3] > np.median(places[:, 3])))
    assert crossings > 50
    assert places[:, 3].min() < 2.45
    assert places[:, 3].max() > 2.55
    assert np.ptp(found.kinetic) > 3e2
    assert_kept(f"eight segments, {crossings} hand-overs seen, 300 s", found, measured)


class Voyage:
    """A smooth, made-up motion of base and joints with exact derivatives."""

    def __init__(self, joints, seed):
        rng = np.random.default_rng(seed)
        self.sway, self.turn, self.swing = rng.normal(size=(3, 2, 3))
        self.joint = rng.normal(size=(2, joints))

    @staticmethod
    def wave(amplitudes, t):
        a, b = amplitudes
        s, c, s2, c2 = np.sin(t), np.cos(t), np.sin(2 * t), np.cos(2 * t)
        return a * s + b * c2, a * c - 2 * b * s2, -a * s - 4 * b * c2

    def base(self, t):
        """World position, velocity, acceleration; attitude; angular velocity and acceleration in base axes.

        The attitude is a turn by the first wave's angle about a fixed axis after one about another.
        """
        axis1, axis2 = (v / np.linalg.norm(v) for v in self.swing)
        angles, rates, accels = self.wave(self.turn, t)
        first, second = Rotation.from_rotvec(axis1 * angles[0]), Rotation.from_rotvec(axis2 * angles[1])
        carried = second.inv().apply(axis1)
        w0 = carried * rates[0] + axis2 * rates[1]
        al0 = carried * accels[0] + axis2 * accels[1] - np.cross(axis2 * rates[1], carried * rates[0])
        return (*self.wave(self.sway, t), first * second, w0, al0)


@pytest.mark.parametrize("build", [palfinger_chain, mixed_chain, eight_segment_chain, mixed_telescopes])
def test_power_of_efforts_ship_and_tip_force_is_the_rate_of_energy(build):
    chain = build()
    joints = chain.kind.shape[0]
    gravity_w = np.array([0.0, 0.0, -GRAVITY])
    tip_force_w = np.array([3e3, -2e3, -9e3])
    mass = chain.mass.sum()

    def energy(voyage, t):
        position, velocity, _, attitude, w0, _ = voyage.base(t)
        q, qd, _ = voyage.wave(voyage.joint, t)
        to_base = attitude.inv().apply
        lifted = potential_energy(chain, q, to_base(gravity_w)) + mass * GRAVITY * position[2]
        return kinetic_energy(chain, q, qd, to_base(velocity), w0) + lifted

    def power(voyage, t):
        _, velocity, accel, attitude, w0, al0 = voyage.base(t)
        q, qd, qdd = voyage.wave(voyage.joint, t)
        to_base = attitude.inv().apply
        f0, tip_force_b, v0 = to_base(accel - gravity_w), to_base(tip_force_w), to_base(velocity)
        effort = mass_matrix(chain, q) @ qdd + bias_forces(chain, q, qd, w0, al0, f0, tip_force_b)
        wrench = base_wrench(chain, q, qd, qdd, w0, al0, f0, tip_force_b)
        tip_velocity = v0 + np.cross(w0, tip_state(chain, q, qd)[0]) + tip_jacobian(chain, q)[:3] @ qd
        return effort @ qd - wrench[:3] @ v0 - wrench[3:] @ w0 + tip_force_b @ tip_velocity

    h = 1e-3
    for seed in range(5):
        voyage = Voyage(joints, seed)
        for t in np.linspace(0.0, 6.0, 13):
            sample = {k: energy(voyage, t + k * h) for k in (-3, -2, -1, 1, 2, 3)}
            rate = (
                45 * (sample[1] - sample[-1]) - 9 * (sample[2] - sample[-2]) + (sample[3] - sample[-3])
            ) / (60 * h)
            assert power(voyage, t) == pytest.approx(rate, rel=1e-7, abs=1e-7 * abs(sample[1]) + 1e-3)
