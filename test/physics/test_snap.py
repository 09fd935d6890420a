"""Slack and snap, and the wire's own mass."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from wire_rig import swung_state

from shipcrane_twin.physics.payload import hanging_state
from shipcrane_twin.validation.lifting_wire import (
    DROPS,
    FIXED,
    WIRE,
    falls,
    held_step,
    snap_error,
    stiffness_at,
    swing,
)


@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
@pytest.mark.parametrize(("length", "mass", "height"), DROPS)
def test_snap_is_that_of_a_mass_falling_onto_an_elastic_wire(length, mass, height, step_s, measured):
    name = f"snap, {mass:g} kg falls {height:g} m on {length:g} m of wire, H = {1e3 * step_s:g} ms"
    measured(name, snap_error(height, length, mass, step_s), 0.02)


@pytest.mark.parametrize("ratio", [0.1, 0.5])
def test_snap_of_a_damped_wire_is_that_of_an_independent_solver(ratio, measured):
    length, mass, height = 5.0, 1500.0, 0.2
    weight, stiffness = mass * WIRE.gravity, stiffness_at(length)
    static, dashpot = weight / stiffness, 2.0 * ratio * np.sqrt(stiffness * mass)

    def tension(s, v):
        return max(0.0, stiffness * s + dashpot * min(s / static, 1.0) * v) if s > 0.0 else 0.0

    start = (0.0, np.sqrt(2.0 * WIRE.gravity * height))
    solved = solve_ivp(
        lambda t, y: (y[1], WIRE.gravity - tension(*y) / mass), (0.0, 0.05), start, "DOP853", rtol=1e-10, atol=1e-12,
        max_step=1e-4,
    )  # fmt: skip
    peak = max(tension(*row) for row in solved.y.T)
    last = falls(height, length, mass, WIRE._replace(damping_ratio=ratio), 0.02, 0.4)[-1]
    measured(f"snap with damping ratio {ratio:g} against an independent solver", abs(last[12] / peak - 1.0), 0.02)


def test_snaps_are_counted_one_for_each_slack_spell():
    wire = WIRE._replace(damping_ratio=0.0)
    assert swing(swung_state(0.5, 5.0, 700.0), 0.02, 500)[-1, 11] == 0.0
    states = falls(0.1, 5.0, 700.0, wire, 0.001, 3.0)
    slack = np.linalg.norm(states[:, :3] - FIXED[:3], axis=1) <= states[:, 6]
    rises = np.count_nonzero(slack[:-1] & ~slack[1:])
    assert rises >= 5
    assert states[-1, 11] in (rises, rises - 1)
    assert states[-1, 13] <= states[-1, 12] * (1.0 + 1e-9)


def test_a_heavy_wire_weighs_on_the_tip_and_stretches_as_a_bar_does():
    wire = WIRE._replace(mass_per_length=1.6)
    length, mass = 80.0, 300.0
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    own = 1.6 * length
    stretch = (mass + 0.5 * own) * wire.gravity / stiffness_at(length)
    assert FIXED[2] - state[2] - length == pytest.approx(stretch, rel=1e-9)
    after, force, _ = held_step(wire, state, FIXED, FIXED, 0.02)
    np.testing.assert_allclose(after[:6], state[:6], atol=1e-9)
    assert -force[2] == pytest.approx((mass + own) * wire.gravity, rel=1e-9)


@pytest.mark.parametrize("mass", [10.0, 300.0])
def test_a_heavy_wire_sways_with_its_load_as_a_rod_with_a_weight(mass, measured):
    wire, length, step_s = WIRE._replace(mass_per_length=1.6), 80.0, 0.02
    own = 1.6 * length
    period = 2.0 * np.pi * np.sqrt((mass + own / 3.0) / (mass + own / 2.0) * length / wire.gravity)
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    state[0] += 0.01 * length
    sway = swing(state, step_s, round(1.1 * period / step_s), wire)[:, 0] - FIXED[0]
    down = np.flatnonzero((sway[:-1] > 0.0) & (sway[1:] <= 0.0))[0]
    quarter = step_s * (down + sway[down] / (sway[down] - sway[down + 1]))
    measured(f"sway period of {mass:g} kg on 80 m of wire with mass", abs(4.0 * quarter / period - 1.0), 2e-3)
