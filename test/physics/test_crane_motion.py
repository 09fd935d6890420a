"""Servos and the macro step."""

import numpy as np
import pytest
from palfinger import (
    GRAVITY,
    UP,
    WORK_POSE,
    eight_segment_chain,
    palfinger_actuators,
    palfinger_chain,
    palfinger_limits,
)
from scipy.integrate import solve_ivp

from shipcrane_twin.physics.crane_actuators import POWER_ON, ActuatorParams, standing_state
from shipcrane_twin.physics.crane_chain import make_chain, tip_jacobian, tip_state
from shipcrane_twin.physics.crane_cylinders import LinearDrive, length_and_arm, lengths_from_joints, make_drives
from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces, mass_matrix, pack_base
from shipcrane_twin.physics.crane_inertia import composite_inertia
from shipcrane_twin.physics.crane_motion import crane_step
from shipcrane_twin.physics.crane_reference import (
    FLAG_COMMAND,
    FLAG_EFFORT,
    FLAG_REFUSED,
    FLAG_SPEED,
    POSITION,
    VELOCITY,
    make_limits,
)

ZERO = np.zeros(3)
STILL = np.zeros(4)
VELOCITIES, POSITIONS = np.full(4, VELOCITY), np.full(4, POSITION)
LOAD_B = np.array([200.0, -300.0, -700.0 * GRAVITY])
REST = pack_base(ZERO, ZERO, UP, LOAD_B)


def working_crane(chain=None, **changes):
    chain = chain or palfinger_chain()
    actuators, limits = palfinger_actuators(**changes), palfinger_limits()
    effort = bias_forces(chain, WORK_POSE, STILL, ZERO, ZERO, UP, LOAD_B)
    return chain, actuators, limits, standing_state(actuators, limits.drives, WORK_POSE, effort)


def run(crane, command, seconds, dt=0.02, n_micro=4, base=REST, mode=VELOCITIES, power=POWER_ON):
    chain, actuators, limits, state = crane
    out = (state,)
    for _ in range(round(seconds / dt)):
        out = crane_step(chain, actuators, limits, out[0], mode, command, power, base, base, n_micro, dt)
    return out


def test_loaded_crane_starts_at_rest_and_stays():
    crane = working_crane(eight_segment_chain())
    state, wrench, effort, flags, *_ = run(crane, np.zeros(4), 20.0)
    np.testing.assert_allclose(state, crane[3], rtol=0.0, atol=1e-9)
    still = np.zeros(4)
    np.testing.assert_allclose(
        wrench, base_wrench(crane[0], WORK_POSE, still, still, ZERO, ZERO, UP, LOAD_B), atol=1e-2
    )
    np.testing.assert_allclose(
        effort, bias_forces(crane[0], WORK_POSE, still, ZERO, ZERO, UP, LOAD_B), atol=1e-2
    )
    np.testing.assert_array_equal(flags, 0)


def test_oil_gives_a_lone_joint_its_frequency_and_damping():
    chain = make_chain(
        dh=np.zeros((2, 4)),
        kind=["revolute"],
        mass=[900.0],
        cog=[[2.0, 0.0, 0.0]],
        inertia=[400.0 * np.eye(3)],
    )
    omega, damping, inertia = 2.0 * np.pi * 1.5, 0.1, 4000.0
    drives = make_drives([LinearDrive()])
    limits = make_limits(drives, rate_max=1.0, accel_max=1.0, jerk_max=4.0, end_margin=0.0)
    one, much, none = np.ones(1), np.full(1, np.inf), np.zeros(1)
    stiffness = inertia * omega**2 * one
    actuators = ActuatorParams(
        stiffness, 2.0 * damping / omega * stiffness, much, much, much, much, one, none, none, 1.0
    )
    base = pack_base(ZERO, ZERO, UP, ZERO)
    state = np.array([0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    q = crane_step(chain, actuators, limits, state, VELOCITIES[:1], none, POWER_ON, base, base, 1000, 2.0)[0][0]
    bare = omega * np.sqrt(1.0 - damping**2)
    decay = damping * omega
    exact = 0.02 * np.exp(-decay * 2.0) * (np.cos(2.0 * bare) + decay / bare * np.sin(2.0 * bare))
    assert q == pytest.approx(exact, rel=1e-6)


def test_joints_follow_the_command_at_its_speed():
    command = np.array([0.04, 0.01, -0.008, 0.03])
    state = run(working_crane(), command, 10.0)[0]
    np.testing.assert_allclose(state[4:8], command, rtol=2e-3)
    np.testing.assert_array_equal(state[24:], 0.0)  # brakes are off


def test_a_joint_goes_to_its_position_without_overshoot_and_is_braked_there():
    crane = working_crane(eight_segment_chain())
    goal = WORK_POSE + [0.3, 0.1, -0.1, 1.0]
    places = []
    for _ in range(60):
        crane = (*crane[:3], run(crane, goal, 1.0, mode=POSITIONS)[0])
        places.append(crane[3][:4])
    np.testing.assert_allclose(crane[3][:4], goal, atol=2e-3)  # braked joints sag as others move
    way = np.sign(goal - WORK_POSE)
    assert np.all(way * (np.array(places) - goal) <= 2e-3)
    np.testing.assert_array_equal(crane[3][24:], 1.0)
    np.testing.assert_allclose(crane[3][4:8], 0.0, atol=1e-6)


def moving_bases():
    rng = np.random.default_rng(12)
    spread = np.append(np.repeat([0.1, 0.2, 0.5, 3e3, 2.0], 3), 0.0)
    ends = [REST + rng.normal(size=16) * spread for _ in range(2)]
    for end in ends:
        end[15] = 900.0  # the load is carried along the wire
    return ends[0], ends[1]


def tip_acceleration(chain, q, qd, w0, al0, f0):
    """Return the tip's proper acceleration at qdd = 0 and its slope over qdd, from the Jacobian."""
    h = 1e-4
    jacobian = tip_jacobian(chain, q)[:3]
    jacobian_rate = (tip_jacobian(chain, q + h * qd) - tip_jacobian(chain, q - h * qd))[:3] / (2 * h)
    arm, velocity = tip_state(chain, q, qd)[:2]
    ship = f0 + np.cross(al0, arm) + np.cross(w0, np.cross(w0, arm)) + 2.0 * np.cross(w0, velocity)
    return ship + jacobian_rate @ qd, jacobian


def independent_step(crane, start, command, base_prev, base_next, dt):
    """The same motion by another integrator, linear algebra and quadrature, the lag as a differential equation."""
    chain, actuators, limits, _ = crane
    path, rate, behind, trim = start[8:24].reshape(4, 4)
    drives = limits.drives
    q_start = start[:4]
    trim_rate = actuators.tracking * (path - behind - lengths_from_joints(drives, q_start))
    arms = np.array([length_and_arm(drives, i, q)[1] for i, q in enumerate(q_path(drives, path))])
    asked = np.clip(command * arms, -limits.rate_max, limits.rate_max)
    accel = np.clip(asked - rate, -limits.accel_max * dt, limits.accel_max * dt) / dt

    def rates(t, y):
        q, qd, late = y[:4], y[4:8], y[14:]
        base = base_prev + (base_next - base_prev) * t / dt
        w0, al0, f0, late_force, last = np.split(base[:15], 5)
        oil = path + rate * t + 0.5 * accel * t**2 - late + trim + trim_rate * t
        length, arm = np.array([length_and_arm(drives, i, value) for i, value in enumerate(q)]).T
        force = actuators.stiffness * (oil - length)
        force += actuators.damping * (late / limits.lag + trim_rate - arm * qd)
        still, slope = tip_acceleration(chain, q, qd, w0, al0, f0)
        pull = late_force / np.linalg.norm(late_force)
        carried = base[15] * np.outer(pull, pull)
        bias = bias_forces(chain, q, qd, w0, al0, f0, late_force - carried @ (still - last))
        qdd = np.linalg.solve(mass_matrix(chain, q) + slope.T @ carried @ slope, force * arm - bias)
        tip_force = late_force - carried @ (still + slope @ qdd - last)
        wrench = base_wrench(chain, q, qd, qdd, w0, al0, f0, tip_force)
        return np.concatenate((qd, qdd, wrench, rate + accel * t - late / limits.lag))

    first = np.concatenate((start[:8], np.zeros(6), behind))
    end = solve_ivp(rates, (0.0, dt), first, "DOP853", rtol=1e-12, atol=1e-10).y[:, -1]
    reference = (path + rate * dt + 0.5 * accel * dt**2, rate + accel * dt, end[14:], trim + trim_rate * dt)
    return np.concatenate((end[:8], *reference)), end[8:14] / dt


def q_path(drives, path):
    """Return joint values of actuator lengths by the law of cosines, apart from the kernels."""
    a, b = drives.side_a, drives.side_b
    angle = np.arccos(np.clip((a**2 + b**2 - path**2) / (2.0 * a * b), -1.0, 1.0))
    return np.where(drives.kind == 1, angle, path) + drives.offset


@pytest.mark.parametrize("build", [palfinger_chain, eight_segment_chain])
def test_step_on_a_moving_base_converges_to_the_exact_motion_and_mean_wrench(build):
    crane = working_crane(build())
    chain, actuators, limits, state = crane
    start = state.copy()
    start[:4] += [0.01, -0.004, 0.006, 0.002]
    start[12:16] = [0.01, 0.002, -0.002, 0.01]
    start[16:20] = [0.001, 0.0005, -0.0005, 0.002]
    start[24:] = 0.0
    command = np.array([0.04, 0.006, -0.006, -0.04])
    base_prev, base_next = moving_bases()
    exact, mean = independent_step(crane, start, command, base_prev, base_next, 0.1)
    errors = {}
    for n_micro in (20, 40, 80):
        got = crane_step(
            chain, actuators, limits, start, VELOCITIES, command, POWER_ON, base_prev, base_next, n_micro, 0.1
        )
        errors[n_micro] = np.abs(got[0][:24] - exact)[:8].max(), np.abs(got[1] - mean).max() / np.abs(mean).max()
        np.testing.assert_allclose(got[0][8:24], exact[8:], atol=1e-10)
    assert errors[80][0] < 1e-6
    assert errors[80][1] < 1e-6
    for coarse, fine in zip(errors[20], errors[40], strict=True):
        assert coarse / fine > 11.0  # order four: 16


def test_outputs_describe_the_end_of_the_step_and_inputs_stay():
    chain, actuators, limits, state = working_crane(eight_segment_chain())
    base_prev, base_next = moving_bases()
    command = np.array([0.04, 0.006, -0.006, -0.04])
    inputs = [a.copy() for a in (state, command, base_prev, base_next)]
    end, _, effort, _, tip, inertia, _ = crane_step(
        chain, actuators, limits, state, VELOCITIES, command, POWER_ON, base_prev, base_next, 4, 0.02
    )
    for array, copy in zip((state, command, base_prev, base_next), inputs, strict=True):
        np.testing.assert_array_equal(array, copy)
    expected = np.concatenate([part.ravel() for part in tip_state(chain, end[:4], end[4:8])])
    np.testing.assert_allclose(tip, expected, atol=1e-15)
    np.testing.assert_allclose(inertia, composite_inertia(chain, end[:4]), rtol=1e-14)
    _, arm = np.array([length_and_arm(limits.drives, i, value) for i, value in enumerate(end[:4])]).T
    oil = end[8:12] - end[16:20] + end[20:24]
    rate = end[16:20] / limits.lag
    force = actuators.stiffness * (oil - lengths_from_joints(limits.drives, end[:4]))
    force += actuators.damping * (rate - arm * end[4:8])
    np.testing.assert_allclose(effort, force * arm, rtol=1e-3, atol=20.0)  # trims change by mm/s


def test_weak_drives_are_clipped_yield_and_say_so():
    weak = np.full(4, 5e3)
    crane = working_crane(push=weak, pull=weak, hold_push=weak, hold_pull=weak)
    state, _, effort, flags, *_ = run(crane, STILL, 0.1)
    _, arm = np.array([length_and_arm(crane[2].drives, i, value) for i, value in enumerate(state[:4])]).T
    assert np.all(np.abs(effort) <= 5e3 * arm * (1.0 + 1e-12))
    assert flags[1] & FLAG_EFFORT
    assert state[1] < WORK_POSE[1] - 0.01  # the boom falls


def test_flags_name_fast_and_refused_commands_and_what_is_no_number():
    chain, actuators, limits, state = working_crane()
    state[8 + 3] = limits.drives.length_max[3]
    command = np.array([1.0, np.nan, 0.0, 0.01])
    flags = crane_step(chain, actuators, limits, state, VELOCITIES, command, POWER_ON, REST, REST, 4, 0.02)[3]
    mine = flags & (FLAG_SPEED | FLAG_REFUSED | FLAG_COMMAND)
    np.testing.assert_array_equal(mine, [FLAG_SPEED, FLAG_COMMAND, 0, FLAG_REFUSED])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"state": np.zeros(27)}, "state of 7 n"),
        ({"mode": VELOCITIES[:3]}, "a mode and command of n values"),
        ({"command": np.zeros(5)}, "a mode and command of n values"),
        ({"base_prev": np.zeros(9)}, "16 values"),
        ({"n_micro": 0}, "n_micro >= 1"),
        ({"dt": 0.0}, "dt > 0"),
        ({"state": np.full(28, np.nan)}, "is the state finite"),
    ],
)
def test_wrong_arguments_are_named(changes, message):
    chain, actuators, limits, state = working_crane()
    arguments = {
        "state": state,
        "mode": VELOCITIES,
        "command": np.zeros(4),
        "power": POWER_ON,
        "base_prev": REST,
        "base_next": REST,
        "n_micro": 2,
        "dt": 0.02,
    }
    with pytest.raises(ValueError, match=message):
        crane_step(chain, actuators, limits, *(arguments | changes).values())
