"""Thrusters: thrust law and its inverse, drives and servos, faults, and the load on the ship."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.physics.propeller import (
    PropulsionParams,
    axis_inflow,
    bollard_coefficients,
    drive_limit,
    propeller_power,
    propeller_thrust,
    speed_for_thrust,
)
from shipcrane_twin.physics.propulsion import FAILED, FROZEN, LIMITED, OK, RUNAWAY, limited_lag, propulsion_step

THRUST = np.array([54e3, 54e3, 20e3])
POWER = np.array([500e3, 500e3, 200e3])
DIAMETER = np.array([1.9, 1.9, 1.0])
SPEED = np.array([3.8, 3.8, 9.3])
DEDUCTION = np.array([0.2, 0.2, 0.5])
KT, KQ = bollard_coefficients(THRUST, POWER, DIAMETER, SPEED, DEDUCTION, 1025.0)
SHIP = PropulsionParams(
    position=np.array([[-14.0, 2.0, -3.6], [-14.0, -2.0, -3.6], [14.5, 0.0, -3.6]]),
    azimuthing=np.array([1.0, 1.0, 0.0]),
    diameter=DIAMETER,
    thrust_coefficient=KT,
    torque_coefficient=KQ,
    deduction=DEDUCTION,
    zero_thrust_advance=np.full(3, 0.9),
    zero_torque_advance=np.full(3, 1.0),
    speed_max=SPEED,
    speed_rate_max=SPEED / 5.0,
    speed_lag=np.full(3, 0.7),
    power_max=POWER,
    torque_max=1.0001 * POWER / (2.0 * np.pi * SPEED),
    rundown_lag=np.full(3, 4.0),
    azimuth_rate_max=np.deg2rad([12.0, 12.0, 12.0]),
    azimuth_lag=np.full(3, 0.4),
    power_total_max=1e9,
    water_density=1025.0,
)
REST = np.array([[0.3, 0.0], [-0.4, 0.0], [np.pi / 2, 0.0]])
STILL, WELL, WHOLE = np.zeros(3), np.full(3, OK), np.ones(3)
compiled = settings(deadline=None, max_examples=40)
seeds = st.integers(0, 9999)


def full_ahead(azimuth=(0.3, -0.4, np.pi / 2)):
    return np.column_stack((azimuth, SPEED))


def run(params, state, command, seconds, step_s=0.1, flow=STILL, fault=WELL, share=WHOLE):
    """Outputs of every step."""
    outputs = []
    for _ in range(round(seconds / step_s)):
        outputs.append(propulsion_step(params, state, command, flow, fault, share, step_s))
        state = outputs[-1].state
    return outputs


def random_case(seed):
    rng = np.random.default_rng(seed)
    state = np.column_stack((rng.uniform(-np.pi, np.pi, 3), rng.uniform(0.0, 1.0, 3) * SPEED))
    state[2] = np.pi / 2, rng.uniform(-1.0, 1.0) * SPEED[2]
    command = np.column_stack((rng.uniform(-np.pi, np.pi, 3), rng.uniform(-1.5, 1.5, 3) * SPEED))
    return state, command, rng.uniform(-1.0, 1.0, 3) * np.array([2.0, 1.0, 0.05])


def test_full_power_at_the_bollard_gives_the_configured_thrust():
    last = run(SHIP, REST, full_ahead(), 60.0)[-1]
    np.testing.assert_allclose(last.state[:, 1], SPEED, rtol=1e-9)
    np.testing.assert_allclose(last.thrust, THRUST, rtol=1e-9)
    np.testing.assert_allclose(last.power, POWER, rtol=1e-9)


def test_coefficients_are_those_of_real_propellers():
    assert np.all((KT > 0.3) & (KT < 0.6))
    assert np.all((KQ > 0.02) & (KQ < 0.08))


@compiled
@given(seed=seeds)
def test_speed_for_thrust_inverts_the_thrust_law_with_any_inflow(seed):
    state, _, flow = random_case(seed)
    thrust = np.random.default_rng(seed).uniform(0.0, 1.0, 3) * THRUST
    thrust[2] -= 10e3
    speed = speed_for_thrust(SHIP, state, thrust, flow)
    found = [propeller_thrust(SHIP, i, speed[i], axis_inflow(SHIP, i, state[i, 0], flow)) for i in range(3)]
    np.testing.assert_allclose(found, thrust, rtol=1e-9, atol=1e-6)


def test_azimuths_asked_to_push_backwards_stand_still_and_tunnels_do_it():
    speed = speed_for_thrust(SHIP, REST, -THRUST, STILL)
    np.testing.assert_allclose(speed, [0.0, 0.0, -SPEED[2]])
    last = run(SHIP, REST, np.column_stack((REST[:, 0], -SPEED)), 60.0)[-1]
    np.testing.assert_allclose(last.thrust, [0.0, 0.0, -20e3], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_inflow_from_ahead_takes_thrust_linearly_until_none_is_left(speed):
    bollard = propeller_thrust(SHIP, 2, speed, 0.0)
    zero = 0.9 * 3.0 * 1.0 * np.sign(speed)
    for part in (0.25, 0.5, 1.0):
        assert propeller_thrust(SHIP, 2, speed, part * zero) == pytest.approx((1.0 - part) * bollard, abs=1e-9)
    assert propeller_thrust(SHIP, 2, speed, 2.0 * zero) == 0.0
    assert propeller_thrust(SHIP, 2, speed, -zero) == bollard


def test_inflow_is_the_motion_of_the_thruster_along_its_axis():
    flow = np.array([1.0, 0.5, 0.02])
    for i, azimuth in enumerate((0.3, -2.0, np.pi / 2)):
        motion = np.array([flow[0], flow[1], 0.0]) + np.cross([0.0, 0.0, flow[2]], SHIP.position[i])
        expected = motion @ [np.cos(azimuth), np.sin(azimuth), 0.0]
        assert axis_inflow(SHIP, i, azimuth, flow) == pytest.approx(expected)


def test_ahead_through_the_water_the_ship_gets_less_thrust():
    still = run(SHIP, REST, full_ahead((0.0, 0.0, 0.0)), 60.0)[-1]
    ahead = run(SHIP, REST, full_ahead((0.0, 0.0, 0.0)), 60.0, flow=np.array([2.0, 0.0, 0.0]))[-1]
    assert np.all(ahead.thrust[:2] < 0.8 * still.thrust[:2])
    np.testing.assert_allclose(ahead.thrust[2], still.thrust[2])


@compiled
@given(inflow=st.floats(0.0, 4.0), weak=st.floats(0.2, 2.0))
def test_drive_limit_is_where_power_torque_or_speed_reaches_its_bound(inflow, weak):
    params = SHIP._replace(power_max=POWER * weak)
    for i in range(3):
        speed = drive_limit(params, i, inflow)
        power = propeller_power(params, i, speed, inflow)
        torque = power / (2.0 * np.pi * speed)
        uses = [power / params.power_max[i], torque / params.torque_max[i], speed / SPEED[i]]
        assert max(uses) == pytest.approx(1.0, abs=1e-9)


@compiled
@given(seed=seeds, time=st.floats(0.0, 10.0), rate=st.floats(0.05, 3.0), lag=st.floats(0.05, 3.0))
def test_limited_lag_obeys_its_differential_equation_and_its_rate(seed, time, rate, lag):
    start, gap = np.random.default_rng(seed).uniform(-3.0, 3.0, 2)
    here = limited_lag(start, gap, rate, lag, time)
    slope = (limited_lag(start, gap, rate, lag, time + 1e-6) - here) / 1e-6
    expected = np.clip((start + gap - here) / lag, -rate, rate)
    assert slope == pytest.approx(expected, abs=2e-5)
    assert (start + gap - here) * gap >= 0.0


@compiled
@given(seed=seeds, step_s=st.sampled_from([0.005, 0.05, 0.1, 0.2]))
def test_load_times_step_is_the_integral_of_a_fine_run_and_states_agree(seed, step_s):
    state, command, flow = random_case(seed)
    limits = SHIP._replace(power_max=10.0 * POWER, torque_max=100.0 * SHIP.torque_max)  # inflow at the start sets them
    coarse = propulsion_step(limits, state, command, flow, WELL, WHOLE, step_s)
    fine = run(limits, state, command, step_s, step_s / 200.0, flow)
    # the rate limit of azimuth or speed may end within the step: a kink between two points of the average
    np.testing.assert_allclose(np.mean([o.load_b for o in fine], axis=0), coarse.load_b, atol=2e-5 * 54e3 * 14.0)
    np.testing.assert_allclose(fine[-1].state, coarse.state, atol=1e-9)
    np.testing.assert_allclose(fine[-1].thrust, coarse.thrust, atol=1e-4)


def test_mean_load_is_the_integral_to_a_millionth_where_no_rate_limit_ends():
    quick = SHIP._replace(speed_rate_max=np.full(3, 1e3), azimuth_rate_max=np.full(3, 1e3))
    start = np.array([[0.3, 1.0], [-0.4, 2.0], [np.pi / 2, 3.0]])
    command = np.column_stack(([1.0, -2.0, 0.0], SPEED))
    coarse = propulsion_step(quick, start, command, STILL, WELL, WHOLE, 0.2)
    fine = run(quick, start, command, 0.2, 0.2 / 400.0)
    np.testing.assert_allclose(np.mean([o.load_b for o in fine], axis=0), coarse.load_b, rtol=1e-7)


@compiled
@given(seed=seeds)
def test_held_thrusters_load_the_ship_by_force_and_moment(seed):
    state, _, flow = random_case(seed)
    out = propulsion_step(SHIP, state, state, flow, np.full(3, FROZEN), WHOLE, 0.1)
    azimuth = state[:, 0]
    forces = out.thrust[:, None] * np.column_stack((np.cos(azimuth), np.sin(azimuth), np.zeros(3)))
    expected = np.concatenate((forces.sum(axis=0), np.cross(SHIP.position, forces).sum(axis=0)))
    np.testing.assert_allclose(out.load_b, expected, atol=1e-6)


@compiled
@given(seed=seeds, faults=st.tuples(*[st.integers(0, 4)] * 3), cap=st.floats(1e4, 2e6))
def test_rates_speeds_and_power_keep_their_limits_whatever_is_asked(seed, faults, cap):
    rng, fault = np.random.default_rng(seed), np.array(faults)
    state, _, flow = random_case(seed)
    params = SHIP._replace(power_total_max=cap)
    for _ in range(20):
        command = np.column_stack((rng.uniform(-9.0, 9.0, 3), rng.normal(size=3) * 2.0 * SPEED))
        out = propulsion_step(params, state, command, flow, fault, rng.uniform(size=3), 0.1)
        turned = (out.state[:, 0] - state[:, 0] + np.pi) % (2.0 * np.pi) - np.pi
        assert np.all(np.abs(turned) <= SHIP.azimuth_rate_max * 0.1 * (1.0 + 1e-9))
        assert turned[2] == pytest.approx(0.0, abs=1e-15)
        driven = fault != FAILED
        assert np.all(np.abs(out.state[:, 1] - state[:, 1])[driven] <= 0.1 * SHIP.speed_rate_max[driven] + 1e-9)
        assert np.all(out.state[:2, 1] >= 0.0)
        assert np.all(np.abs(out.state[:, 1]) <= SPEED * (1.0 + 1e-12))
        assert np.all(out.power >= 0.0)
        assert np.all(out.power <= POWER * (1.0 + 1e-9))
        state = out.state


def test_azimuth_takes_the_shorter_way_through_aft():
    start = np.array([[3.0, 0.0], [-3.0, 0.0], [np.pi / 2, 0.0]])
    path = run(SHIP, start, np.column_stack((-start[:, 0], SPEED)), 1.0)
    assert np.all(np.abs([o.state[:2, 0] for o in path]) >= 3.0 - 1e-12)


def test_a_failed_thruster_runs_down_where_it_points_and_the_others_go_on():
    start = run(SHIP, REST, full_ahead(), 60.0)[-1].state
    out = run(SHIP, start, full_ahead((2.0, -0.4, 0.0)), 4.0, fault=np.array([FAILED, OK, OK]))
    speeds = np.array([o.state[0, 1] for o in out])
    assert np.all(np.diff(speeds) < 0.0)
    assert speeds[-1] == pytest.approx(SPEED[0] * np.exp(-1.0))
    assert out[-1].state[0, 0] == start[0, 0]
    np.testing.assert_allclose(out[-1].thrust[1:], THRUST[1:], rtol=1e-9)


def test_a_frozen_thruster_keeps_azimuth_and_speed():
    start = np.array([[0.3, 2.0], [-0.4, 1.0], [np.pi / 2, -4.0]])
    out = run(SHIP, start, full_ahead((2.0, 1.0, 0.0)), 5.0, fault=np.full(3, FROZEN))[-1]
    np.testing.assert_array_equal(out.state, start)


def test_a_limited_thruster_gives_its_share():
    share = np.array([0.5, 0.25, 0.0])
    out = run(SHIP, REST, full_ahead(), 60.0, fault=np.full(3, LIMITED), share=share)[-1]
    np.testing.assert_allclose(out.thrust, share * THRUST, rtol=1e-9, atol=1e-6)


def test_a_runaway_thruster_drives_off_at_full_thrust_and_still_steers():
    command = np.column_stack(([1.0, -0.4, 0.0], np.zeros(3)))
    out = run(SHIP, REST, command, 60.0, fault=np.array([RUNAWAY, OK, OK]))[-1]
    np.testing.assert_allclose(out.thrust, [54e3, 0.0, 0.0], rtol=1e-9, atol=1e-6)
    assert out.state[0, 0] == pytest.approx(1.0)


def test_short_of_power_all_give_up_the_same_share():
    out = run(SHIP._replace(power_total_max=600e3), REST, full_ahead(), 60.0)[-1]
    np.testing.assert_allclose(out.power, POWER / 2.0, rtol=1e-9)
    np.testing.assert_allclose(out.thrust, THRUST * 0.5 ** (2.0 / 3.0), rtol=1e-9)


def test_power_that_a_runaway_takes_is_left_to_none():
    fault = np.array([RUNAWAY, OK, OK])
    out = run(SHIP._replace(power_total_max=600e3), REST, full_ahead(), 60.0, fault=fault)[-1]
    np.testing.assert_allclose(out.power, [500e3, 100e3 * 5.0 / 7.0, 100e3 * 2.0 / 7.0], rtol=1e-9)


def test_what_is_not_a_number_keeps_its_present_value():
    start = np.array([[0.3, 2.0], [-0.4, 1.0], [np.pi / 2, -4.0]])
    lost = np.full(3, np.nan)
    out = propulsion_step(SHIP, start, np.full((3, 2), np.nan), lost, np.full(3, LIMITED), WHOLE, 0.1)
    np.testing.assert_array_equal(out.state, start)
    off = propulsion_step(SHIP, start, full_ahead(), lost, np.full(3, LIMITED), lost, 0.1)
    assert np.all(np.isfinite(np.concatenate((off.state.ravel(), off.load_b, off.thrust, off.power))))
    assert np.all(np.abs(off.state[:, 1]) < np.abs(start[:, 1]))


def test_inputs_stay_untouched():
    state, command = REST.copy(), full_ahead()
    propulsion_step(SHIP, state, command, STILL, WELL, WHOLE, 0.1)
    np.testing.assert_array_equal(state, REST)
    np.testing.assert_array_equal(command, full_ahead())
