"""Servos and the macro step."""

import numpy as np
import pytest
from palfinger import GRAVITY, UP, WORK_POSE, palfinger_chain, palfinger_limits
from scipy.integrate import solve_ivp

from shipcrane_twin.physics.crane_chain import make_chain, tip_jacobian, tip_state
from shipcrane_twin.physics.crane_cylinders import LinearDrive, make_drives
from shipcrane_twin.physics.crane_dynamics import base_wrench, bias_forces, mass_matrix, pack_base
from shipcrane_twin.physics.crane_inertia import composite_inertia
from shipcrane_twin.physics.crane_motion import ServoParams, crane_step, servo_gains, static_reference
from shipcrane_twin.physics.crane_reference import FLAG_EFFORT, FLAG_REFUSED, FLAG_SPEED, make_limits

ZERO = np.zeros(3)
LOAD_B = np.array([200.0, -300.0, -700.0 * GRAVITY])
REST = pack_base(ZERO, ZERO, UP, LOAD_B)


def working_crane(effort_max=np.inf):
    chain = palfinger_chain()
    kp, kd = servo_gains(chain, WORK_POSE, 3.0, 0.7)
    q_ref = static_reference(chain, WORK_POSE, kp, UP, LOAD_B)
    servo = ServoParams(kp, kd, np.full(4, effort_max))
    state = np.concatenate((WORK_POSE, np.zeros(4), q_ref, np.zeros(4)))
    return chain, servo, palfinger_limits(q_ref - WORK_POSE), state


def run(crane, command, seconds, dt=0.02, n_micro=2, base=REST):
    chain, servo, limits, state = crane
    out = (state,)
    for _ in range(round(seconds / dt)):
        out = crane_step(chain, servo, limits, out[0], command, base, base, n_micro, dt)
    return out


def test_loaded_crane_starts_at_rest_and_stays():
    crane = working_crane()
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


def test_step_of_the_reference_settles_in_balance():
    chain, servo, limits, state = working_crane()
    state[8:12] += 0.01
    state, _, effort, *_ = run((chain, servo, limits, state), np.zeros(4), 20.0)
    np.testing.assert_allclose(state[4:8], 0.0, atol=1e-9)
    held = bias_forces(chain, state[:4], np.zeros(4), ZERO, ZERO, UP, LOAD_B)
    np.testing.assert_allclose(effort, held, rtol=0.0, atol=1e-6 * np.abs(held).max())
    np.testing.assert_allclose(state[:4], WORK_POSE + 0.01, atol=2e-3)


def test_gains_give_a_lone_joint_its_frequency_and_damping():
    chain = make_chain(
        dh=np.zeros((2, 4)),
        kind=["revolute"],
        mass=[900.0],
        cog=[[2.0, 0.0, 0.0]],
        inertia=[400.0 * np.eye(3)],
    )
    frequency, damping = 1.5, 0.1
    kp, kd = servo_gains(chain, np.zeros(1), frequency, damping)
    limits = make_limits(make_drives([LinearDrive()]), length_rate_max=1.0, accel_max=1.0, end_margin=0.0)
    base = pack_base(ZERO, ZERO, UP, ZERO)
    servo = ServoParams(kp, kd, np.full(1, np.inf))
    start = np.array([0.02, 0.0, 0.0, 0.0])
    q = crane_step(chain, servo, limits, start, np.zeros(1), base, base, 1000, 2.0)[0][0]
    decay = damping * 2.0 * np.pi * frequency
    omega = 2.0 * np.pi * frequency * np.sqrt(1.0 - damping**2)
    exact = 0.02 * np.exp(-decay * 2.0) * (np.cos(2.0 * omega) + decay / omega * np.sin(2.0 * omega))
    assert q == pytest.approx(exact, rel=1e-6)


def test_joints_follow_the_command_at_its_speed():
    command = np.array([0.04, 0.01, -0.008, 0.03])
    crane = working_crane()
    state = run(crane, command, 10.0)[0]
    np.testing.assert_array_equal(state[12:], command)
    np.testing.assert_allclose(state[4:8], command, atol=2e-3)
    ramp = 0.5 * command * np.abs(command) / crane[2].accel_max
    np.testing.assert_allclose(state[8:12] - crane[3][8:12], command * 10.0 - ramp, atol=2e-3)


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
    """The same motion by another integrator, linear algebra and quadrature."""
    chain, servo, limits, _ = crane
    q_ref, qd_ref = start[8:12], start[12:]
    change = np.clip(command - qd_ref, -limits.accel_max * dt, limits.accel_max * dt) / dt

    def rates(t, y):
        q, qd = y[:4], y[4:8]
        base = base_prev + (base_next - base_prev) * t / dt
        w0, al0, f0, late_force, last = np.split(base[:15], 5)
        reference = q_ref + qd_ref * t + 0.5 * change * t**2
        effort = servo.kp * (reference - q) + servo.kd * (qd_ref + change * t - qd)
        still, slope = tip_acceleration(chain, q, qd, w0, al0, f0)
        pull = late_force / np.linalg.norm(late_force)
        carried = base[15] * np.outer(pull, pull)
        bias = bias_forces(chain, q, qd, w0, al0, f0, late_force - carried @ (still - last))
        qdd = np.linalg.solve(mass_matrix(chain, q) + slope.T @ carried @ slope, effort - bias)
        tip_force = late_force - carried @ (still + slope @ qdd - last)
        return np.concatenate((qd, qdd, base_wrench(chain, q, qd, qdd, w0, al0, f0, tip_force)))

    end = solve_ivp(rates, (0.0, dt), np.append(start[:8], np.zeros(6)), "DOP853", rtol=1e-12, atol=1e-10).y[
        :, -1
    ]
    reference = np.concatenate((q_ref + qd_ref * dt + 0.5 * change * dt**2, qd_ref + change * dt))
    return np.concatenate((end[:8], reference)), end[8:] / dt


def test_step_on_a_moving_base_converges_to_the_exact_motion_and_mean_wrench():
    crane = working_crane()
    chain, servo, limits, state = crane
    start = state.copy()
    start[:4] += [0.01, -0.004, 0.006, 0.002]
    start[12:] = [0.01, 0.002, -0.002, 0.0]
    command = np.array([0.04, 0.006, -0.006, -0.04])
    base_prev, base_next = moving_bases()
    exact, mean = independent_step(crane, start, command, base_prev, base_next, 0.1)
    errors = {}
    for n_micro in (10, 20, 40):
        got = crane_step(chain, servo, limits, start, command, base_prev, base_next, n_micro, 0.1)
        errors[n_micro] = np.abs(got[0] - exact)[:8].max(), np.abs(got[1] - mean).max() / np.abs(mean).max()
        np.testing.assert_allclose(got[0][8:], exact[8:], atol=1e-15)
    assert errors[40][0] < 1e-6
    assert errors[40][1] < 1e-6
    for coarse, fine in zip(errors[10], errors[20], strict=True):
        assert coarse / fine > 11.0  # order four: 16


def test_outputs_describe_the_end_of_the_step_and_inputs_stay():
    chain, servo, limits, state = working_crane()
    base_prev, base_next = moving_bases()
    command = np.array([0.04, 0.006, -0.006, -0.04])
    inputs = [a.copy() for a in (state, command, base_prev, base_next)]
    end, _, effort, _, tip, inertia, _ = crane_step(
        chain, servo, limits, state, command, base_prev, base_next, 2, 0.02
    )
    for array, copy in zip((state, command, base_prev, base_next), inputs, strict=True):
        np.testing.assert_array_equal(array, copy)
    expected = np.concatenate([part.ravel() for part in tip_state(chain, end[:4], end[4:8])])
    np.testing.assert_allclose(tip, expected, atol=1e-15)
    np.testing.assert_allclose(inertia, composite_inertia(chain, end[:4]), rtol=1e-14)
    np.testing.assert_allclose(effort, servo.kp * (end[8:12] - end[:4]) + servo.kd * (end[12:] - end[4:8]))


def test_weak_servos_are_clipped_and_say_so():
    crane = working_crane(effort_max=5e3)
    state, _, effort, flags, *_ = run(crane, np.zeros(4), 0.1)
    assert np.all(np.abs(effort) <= 5e3)
    np.testing.assert_array_equal(flags & FLAG_EFFORT, [0, FLAG_EFFORT, FLAG_EFFORT, 0])
    assert state[1] < WORK_POSE[1] - 0.01  # the boom falls


def test_flags_name_fast_and_refused_commands():
    chain, servo, limits, state = working_crane()
    state[8 + 3] = limits.q_max[3] + limits.sag[3]
    flags = crane_step(chain, servo, limits, state, np.array([1.0, 0.0, 0.0, 0.01]), REST, REST, 2, 0.02)[3]
    np.testing.assert_array_equal(flags & (FLAG_SPEED | FLAG_REFUSED), [FLAG_SPEED, 0, 0, FLAG_REFUSED])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"state": np.zeros(15)}, "state of 4 n"),
        ({"command": np.zeros(5)}, "command of n values"),
        ({"base_prev": np.zeros(9)}, "16 values"),
        ({"n_micro": 0}, "n_micro >= 1"),
        ({"dt": 0.0}, "dt > 0"),
        ({"state": np.full(16, np.nan)}, "is the state finite"),
    ],
)
def test_wrong_arguments_are_named(changes, message):
    chain, servo, limits, state = working_crane()
    arguments = {
        "state": state,
        "command": np.zeros(4),
        "base_prev": REST,
        "base_next": REST,
        "n_micro": 2,
        "dt": 0.02,
    }
    with pytest.raises(ValueError, match=message):
        crane_step(chain, servo, limits, *(arguments | changes).values())
