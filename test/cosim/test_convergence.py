"""The same lift with other steps, schemes and loads."""

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat

LIFT = (
    "operations=["
    "{label: up, joint: boom, from_s: 5.0, to_s: 15.0, velocity_rad_s: 0.02},"
    "{label: out, joint: winch, from_s: 10.0, to_s: 20.0, velocity_m_s: 0.3},"
    "{label: in, joint: telescope, from_s: 20.0, to_s: 30.0, velocity_m_s: -0.05},"
    "{label: over, joint: slew, from_s: 10.0, to_s: 35.0, velocity_rad_s: -0.0408}]"
)
SHORT = [
    LIFT,
    "events=[]",
    "duration_s=40.0",
    "dp.enabled_at_s=1.0",
    "crane.initial_joints=[-1.57, 0.3, 1.1, 1.0]",
    "environment.current_speed_m_s=0.5",
    "environment.current_direction_to_deg=-135.0",
    "environment.wind_speed_m_s=3.0",
]


def roll_deg(odom):
    return np.rad2deg(euler_from_matrix(matrix_from_quat(odom[3:7]))[0])


@pytest.fixture(scope="module")
def lift():
    """Return roll [deg] and wire tension [N] every 0.1 s of the lift, each variant computed once."""
    known = {}

    def run(step_ms, coupling="in_turn+inertia", mass=700.0):
        key = step_ms, coupling, mass
        if key not in known:
            changes = [f"macro_step_ms={step_ms}", f"coupling={coupling}", f"payload.mass_kg={mass}"]
            twin = InlineRun(load_scenario("case2", SHORT + changes))
            rolls, pulls = [], []
            for k in twin.steps():
                if k % round(100 / step_ms) == 0:
                    rolls.append(roll_deg(twin.latest["/vessel/odom"]))
                    pulls.append(np.linalg.norm(twin.latest["/payload/wire_wrench"][:3]))
            known[key] = np.array(rolls), np.array(pulls)
        return known[key]

    return run


@pytest.mark.parametrize("step_ms", [20.0, 50.0])
def test_longer_steps_give_the_same_roll_and_tension(lift, step_ms, measured):
    (roll, pull), (roll_fine, pull_fine) = lift(step_ms), lift(10.0)
    assert np.ptp(roll_fine) > 0.5
    name = f"lift in current and wind, H = {step_ms:g} against 10 ms"
    measured(f"{name}: roll", np.abs(roll - roll_fine).max(), 0.01, "deg")
    measured(f"{name}: tension, RMS over mean", np.std(pull - pull_fine) / pull_fine.mean(), 0.005)


def test_errors_shrink_with_the_step(lift):
    error = {step: np.abs(lift(step)[0] - lift(5.0)[0]).max() for step in (10.0, 50.0)}
    assert error[10.0] < 0.5 * error[50.0]


def test_schemes_differ_a_little_and_both_are_stable(lift, measured):
    (with_inertia, pull), (without, pull_without) = lift(20.0), lift(20.0, "in_turn")
    difference = np.abs(with_inertia - without).max()
    assert difference > 0.0
    measured("in_turn against in_turn+inertia at 20 ms: roll", difference, 0.02, "deg")
    measured("in_turn against in_turn+inertia at 20 ms: tension", np.abs(pull / pull_without - 1.0).max(), 0.02)


def test_carried_inertia_brings_coarse_steps_nearer_to_fine_ones(lift):
    error = {name: np.abs(lift(50.0, name)[0] - lift(5.0)[0]).max() for name in ("in_turn", "in_turn+inertia")}
    assert error["in_turn+inertia"] < error["in_turn"]


@pytest.mark.parametrize("step_ms", [20.0, 50.0])
def test_the_heavier_load_is_stable(lift, step_ms, measured):
    (roll, pull), (roll_fine, _) = lift(step_ms, mass=2200.0), lift(10.0, mass=2200.0)
    measured(f"2.2 t, H = {step_ms:g} against 10 ms: roll", np.abs(roll - roll_fine).max(), 0.03, "deg")
    assert 0.8 < pull.min() / (2200.0 * 9.80665)
    assert pull.max() / (2200.0 * 9.80665) < 1.2


def test_released_load_lets_the_ship_come_up():
    dropped = ["operations=[]", "events.0.at_s=5.0", "duration_s=100.0", "macro_step_ms=50.0"]
    run = InlineRun(load_scenario("case2", dropped))
    rolls = {k: roll_deg(run.latest["/vessel/odom"]) for k in run.steps() if k in (90, 2000)}
    pull = np.linalg.norm(run.latest["/payload/wire_wrench"][:3])
    assert pull == pytest.approx(50.0 * 9.80665, rel=1e-2)  # the hook still sways a little
    rest = at_rest(load_scenario("case2", ["payload.mass_kg=50.0"])).vessel
    assert rolls[2000] == pytest.approx(roll_deg(rest), abs=0.15)  # it still rolls a little, too
    assert rolls[2000] < rolls[90] - 0.3
