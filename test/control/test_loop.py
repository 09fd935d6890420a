"""Linearised DP loop: closed forms of one axis, the shipped configuration, the observer, and the loop in time."""

import numpy as np
import pytest
from dp_rig import DRAG, MASS, PERIOD_S, STILL, UNKNOWN, controller, held_at, held_ship, move

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.control.controller import ControllerParams, controller_start, controller_update
from shipcrane_twin.control.loop import (
    OMEGA,
    LinearObserver,
    closed_loop,
    horizontal,
    loop_margins,
    passive_observer,
)
from shipcrane_twin.control.observer import passive_gains, passive_params, passive_start, passive_step
from shipcrane_twin.control.observer_model import observer_pose, observer_velocity
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.cosim.dp_build import controller_of

LAG_S = 2.0
NAMES = ("surge", "sway", "yaw")


def one_axis(params, axis, s):
    """The loop transfer function of an axis on its own, in closed form."""
    pid = params.stiffness[axis] + params.damping[axis] * s + params.integral[axis] / s
    return pid / ((MASS[axis, axis] * s**2 + DRAG[axis, axis] * s) * (LAG_S * s + 1.0))


@pytest.fixture(scope="module")
def shipped():
    """Inertia, damping, gains and thruster lag of the shipped configuration."""
    scenario = load_scenario("case3")
    vessel, data = vessel_params(scenario), hydro_database(scenario)
    inertia = horizontal(vessel.rigid_mass + data.added_mass[0])
    gains = controller_of(scenario.dp, inertia)
    lag = max(thruster.shaft_lag_s for thruster in scenario.vessel.thrusters)
    return inertia, horizontal(vessel.hull.damping), gains, lag


def test_loop_is_that_of_each_axis_when_nothing_couples_them():
    params = controller()
    report = closed_loop(MASS, DRAG, params, LAG_S)
    for axis in range(3):
        np.testing.assert_allclose(report.loop[axis], one_axis(params, axis, 1j * OMEGA), rtol=1e-6)


def test_eigenvalues_are_the_roots_of_each_axis_polynomial():
    params = controller()
    report = closed_loop(MASS, DRAG, params, LAG_S)
    expected = []
    for axis in range(3):
        ship = np.polymul([MASS[axis, axis], DRAG[axis, axis], 0.0, 0.0], [LAG_S, 1.0])
        pid = [params.damping[axis], params.stiffness[axis], params.integral[axis]]
        expected.extend(np.roots(np.polyadd(ship, pid)))
    np.testing.assert_allclose(np.sort_complex(report.eigenvalues), np.sort_complex(expected), rtol=1e-6)
    assert report.slowest_s == pytest.approx(-1.0 / max(root.real for root in expected))


def test_margins_are_where_the_closed_loop_becomes_unstable():
    params = controller()
    report = closed_loop(MASS, DRAG, params, LAG_S, delay=1.0)

    def slowest(factor, delay=1.0):
        changed = params._replace(
            stiffness=factor * params.stiffness, damping=factor * params.damping, integral=factor * params.integral
        )
        return closed_loop(MASS, DRAG, changed, LAG_S, delay).eigenvalues[0].real

    up = 10.0 ** (report.gain_up_db.min() / 20.0)
    down = 10.0 ** (report.gain_down_db.max() / 20.0)
    assert slowest(0.99 * up) < 0.0 < slowest(1.01 * up)
    assert slowest(1.01 * down) < 0.0 < slowest(0.99 * down)
    # a further delay that eats the phase margin at the crossover; Pade's phase is 2 atan(w T / 2)
    plain = closed_loop(MASS, DRAG, params, LAG_S)
    delays = 2.0 * np.tan(0.5 * np.deg2rad(plain.phase_margin_deg)) / plain.crossover
    assert slowest(1.0, 0.99 * delays.min()) < 0.0 < slowest(1.0, 1.01 * delays.min())


def test_gain_margin_counts_only_crossings_behind_the_origin():
    # phase -180 degrees at w = pi / 0.9, -360 degrees at twice that, where the gain is higher
    crossover, _, up, down, peak = loop_margins(0.1 * OMEGA * np.exp(-0.9j * OMEGA))
    assert up == pytest.approx(-20.0 * np.log10(0.1 * np.pi / 0.9), abs=1e-3)
    assert down == -np.inf
    assert np.isnan(crossover)
    assert peak > 1.0 / (1.0 - 0.1 * np.pi / 0.9) - 0.01


def test_loop_in_time_decays_as_its_slowest_eigenvalue_says():
    params = controller()
    slow = closed_loop(MASS, DRAG, params, 1e-3).slowest_s
    poses, _ = held_ship(params, 600.0, lambda k: held_at([0.0, 0.5 if k else 0.0, 0.0]))
    off = np.abs(poses[:, 1] - 0.5)
    assert 2000.0 * 0.1 / np.log(off[3000] / off[5000]) == pytest.approx(slow, rel=0.1)


def test_shipped_configuration_is_stable_with_margins(shipped, measured):
    report = closed_loop(*shipped, delay=0.05)
    measured("DP loop: largest real part of the eigenvalues", report.eigenvalues[0].real, 0.0, "1/s")
    measured("DP loop: slowest time constant", report.slowest_s, 150.0, "s")
    for i, name in enumerate(NAMES):
        measured(f"DP loop, {name}: phase margin, degrees below 45", 45.0 - report.phase_margin_deg[i], 0.0, "deg")
        measured(f"DP loop, {name}: gain margin, dB below 10", 10.0 - report.gain_up_db[i], 0.0, "dB")
        measured(f"DP loop, {name}: sensitivity peak", report.sensitivity_peak[i], 1.7)


def test_delay_costs_its_phase_at_the_crossover(shipped):
    none, late = closed_loop(*shipped), closed_loop(*shipped, delay=0.5)
    lost = none.phase_margin_deg - late.phase_margin_deg
    np.testing.assert_allclose(lost, np.rad2deg(0.5 * none.crossover), rtol=0.02)


def test_observer_that_is_fast_changes_nothing(shipped):
    inertia, damping, gains, lag = shipped
    inverse, one, none = np.linalg.inv(inertia), np.eye(3), np.zeros((3, 3))
    model, gain = np.block([[none, one], [none, -inverse @ damping]]), np.vstack([200.0 * one, 1e4 * one])
    fast = LinearObserver(model - gain @ np.eye(3, 6), gain, np.vstack([none, inverse]), np.eye(6))
    direct, observed = closed_loop(*shipped), closed_loop(inertia, damping, gains, lag, observer=fast)
    slow = OMEGA < 0.3
    np.testing.assert_allclose(observed.loop[:, slow], direct.loop[:, slow], rtol=0.01)


def passive_with(inertia, damping, wave_period, sample_period=1.0):
    """Parameters of the passive observer with the wave filter at a period [s], and that frequency (3,)."""
    wave, same = np.full(3, 2.0 * np.pi / wave_period), np.ones(3)
    params = passive_params(
        inertia,
        damping,
        PERIOD_S,
        wave_frequency=wave,
        wave_damping=0.1 * same,
        notch_damping=same,
        cutoff_ratio=1.2 * same,
        bias_period_s=100.0 * same,
        bias_damping=same,
        bias_time_constant_s=1000.0 * same,
        sample_period_s=sample_period * same,
        lost_after_s=10.0,
        return_s=10.0,
    )
    return params, wave


def observer_of(inertia, damping, wave_period=8.0, sample_period=1.0):
    """The same, linear."""
    params, wave = passive_with(inertia, damping, wave_period, sample_period)
    gains = passive_gains(params, wave)
    return passive_observer(inertia, damping, gains, wave, params.wave_damping, params.bias_time_constant)


def growth(params, axis, factor):
    """Error after a step at 300 to 400 s over that at 200 to 300 s; the ship gets `factor` times the thrust."""
    observer, wave = passive_with(MASS, DRAG, 8.0, PERIOD_S)
    seen, state = passive_start(observer, STILL), controller_start()
    pose, velocity, thrust = np.zeros(3), np.zeros(3), np.zeros(3)
    given = np.where(np.arange(3) == axis, factor, 1.0)
    goal, errors = 0.05 * (np.arange(3) == axis), []
    for k in range(4000):
        seen = passive_step(observer, seen, pose, thrust, wave)
        estimate = observer_pose(seen), observer_velocity(seen)
        reference = held_at(goal * (k > 0))
        state, demand = controller_update(params, state, True, reference, *estimate, STILL, STILL, UNKNOWN)
        thrust = demand + (thrust - demand) * np.exp(-PERIOD_S / LAG_S)
        pose, velocity = move(pose, velocity, given * thrust)
        errors.append(abs(pose[axis] - goal[axis]))
    return max(errors[3000:]) / max(errors[2000:3000])


@pytest.mark.parametrize("axis", [0, 2])
def test_gain_margin_is_that_of_controller_and_observer_in_time(axis):
    params = controller(load_max=np.full(3, 1e12))
    observer = observer_of(MASS, DRAG, sample_period=PERIOD_S)
    margin = closed_loop(MASS, DRAG, params, LAG_S, PERIOD_S, observer).gain_up_db[axis]
    limit = 10.0 ** (margin / 20.0)
    assert growth(params, axis, 0.93 * limit) < 0.8
    assert growth(params, axis, 1.07 * limit) > 1.2


def test_separation_eigenvalues_are_those_of_loop_and_observer(shipped):
    inertia, damping, gains, lag = shipped
    observer = observer_of(inertia, damping)
    # without a bias state the estimates are those of a pure copy of the ship, and the two do not move each other
    observer = observer._replace(
        a=np.delete(np.delete(observer.a, [9, 10, 11], 0), [9, 10, 11], 1),
        b_measured=np.delete(observer.b_measured, [9, 10, 11], 0),
        b_load=np.delete(observer.b_load, [9, 10, 11], 0),
        c=np.delete(observer.c, [9, 10, 11], 1),
    )
    found = closed_loop(inertia, damping, gains, lag, observer=observer).eigenvalues
    alone = np.linalg.eigvals(observer.a)
    for value in alone:
        assert np.abs(found - value).min() < 1e-6


@pytest.mark.parametrize("wave_period", [6.0, 10.0])
def test_wave_filter_takes_its_frequency_out_of_the_loop_and_costs_phase(shipped, wave_period, measured):
    inertia, damping, gains, lag = shipped
    observed = closed_loop(inertia, damping, gains, lag, 0.5, observer_of(inertia, damping, wave_period))
    direct = closed_loop(*shipped, 0.5)
    at = int(np.argmin(np.abs(OMEGA - 2.0 * np.pi / wave_period)))
    assert np.all(np.abs(observed.loop[:, at]) < 0.3 * np.abs(direct.loop[:, at]))
    assert np.all(observed.phase_margin_deg < direct.phase_margin_deg)
    name = f"DP loop with the wave filter at {wave_period:g} s"
    measured(f"{name}: largest real part", observed.eigenvalues[0].real, 0.0, "1/s")
    measured(f"{name}: phase margin, degrees below 20", 20.0 - observed.phase_margin_deg.min(), 0.0, "deg")
    measured(f"{name}: gain margin, dB below 4", 4.0 - observed.gain_up_db.min(), 0.0, "dB")


def test_observers_zero_is_the_wave_frequency(shipped):
    inertia, damping, _, _ = shipped
    observer, omega = observer_of(inertia, damping), 2.0 * np.pi / 8.0

    def pose_estimate(w):
        return (observer.c[:3] @ np.linalg.solve(1j * w * np.eye(15) - observer.a, observer.b_measured))[0, 0]

    # the notch is as deep as the damping of the wave model over its own allows
    assert abs(pose_estimate(omega)) < 0.15
    assert abs(pose_estimate(0.01)) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(("lag", "delay"), [(0.0, 0.0), (-1.0, 0.0), (1.0, -0.1), (np.nan, 0.0)])
def test_lag_and_delay_that_cannot_be_are_refused(lag, delay):
    with pytest.raises(ValueError, match="expected a positive lag"):
        closed_loop(MASS, DRAG, controller(), lag, delay)


def test_unstable_loop_is_reported_as_such():
    weak: ControllerParams = controller()
    weak = weak._replace(damping=0.01 * weak.damping)
    report = closed_loop(MASS, DRAG, weak, LAG_S)
    assert report.eigenvalues[0].real > 0.0
    assert report.slowest_s == np.inf
    assert report.phase_margin_deg.min() < 0.0
