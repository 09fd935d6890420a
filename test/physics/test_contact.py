"""Contact: drop and bounce, sliding to rest, sticking, a heaving supply deck, edges, records."""

import numpy as np
import pytest
from rigid_rig import FLOOR, G, around, box_load, lying, plane, run
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics.rigid_load import APART, IMPACT_MAX, LANDING, LANDINGS, LIFT_OFFS

MASS = 5000.0
ON_FLOOR = around(planes=plane())
RESTING = 1.0 - MASS * G / (4.0 * FLOOR[0, 3])


def landing(states, column):
    return states[:, LANDING + column]


@pytest.mark.parametrize("step_s", [0.001, 0.02, 0.2])
def test_a_dropped_box_bounces_as_hunt_and_crossley_say(step_s, measured):
    hard = FLOOR.copy()
    hard[0, 3] = 2e8  # so that the weight adds little to the impact, which the closed form has alone
    load, height = box_load(planes=hard, mass=MASS), 0.3
    state = lying(load, 1.0 + height)
    state[LANDING + APART] = 1.0
    states, _ = run(load, state, step_s, round(1.0 / step_s), surroundings=ON_FLOOR)
    impact = np.sqrt(2.0 * G * height)
    found = landing(states, IMPACT_MAX)[-1]
    measured(f"impact speed of a dropped box, H = {1e3 * step_s:g} ms", abs(found / impact - 1.0), 0.02)
    if step_s == 0.001:
        loss = FLOOR[0, 4]
        leaves = brentq(lambda u: np.log((1.0 + loss * impact) / (1.0 - loss * u)) - loss * (impact + u), 1e-3, impact)
        measured("rebound of a dropped box against Hunt and Crossley", abs(states[:, 11].max() / leaves - 1.0), 0.02)
    assert landing(states, LANDINGS)[-1] >= 1.0


@pytest.mark.parametrize("step_s", [0.02, 0.1])
def test_a_sliding_box_stops_after_the_way_of_dry_friction(step_s, measured):
    load, speed = box_load(planes=FLOOR, mass=MASS), 1.5
    state = lying(load, RESTING)
    state[9] = speed
    states, _ = run(load, state, step_s, round(2.0 / step_s), surroundings=ON_FLOOR)
    way = speed**2 / (2.0 * FLOOR[0, 5] * G)
    measured(f"way of a sliding box, H = {1e3 * step_s:g} ms", abs(states[-1, 6] / way - 1.0), 0.02)
    assert abs(states[-1, 9]) < 1e-3


@pytest.mark.parametrize(("tilt_deg", "slides"), [(15.0, False), (28.0, True)])
def test_a_box_on_a_slope_sticks_below_the_angle_of_friction_and_slides_above(tilt_deg, slides):
    load = box_load(planes=FLOOR, mass=MASS)
    turn = Rotation.from_euler("y", tilt_deg, degrees=True)
    rot = turn.as_matrix()
    state = lying(load, 0.0, quat=turn.as_quat())
    state[6:9] = rot @ [0.0, 0.0, RESTING]
    states, _ = run(load, state, 0.02, 100, surroundings=around(planes=plane(rot=rot)))
    tilt = np.deg2rad(tilt_deg)
    down = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    slid = (states[-1, 6:9] - states[0, 6:9]) @ down
    if slides:
        assert slid == pytest.approx(0.5 * G * (np.sin(tilt) - 0.4 * np.cos(tilt)) * 2.0**2, rel=0.03)
    else:
        assert 0.0 <= slid < 0.01 * 2.0


def test_a_box_rides_on_a_deck_that_moves_and_turns():
    load = box_load(planes=FLOOR, mass=MASS)
    rate, turning, speed = 0.02, 0.1, 0.5

    def deck(t):
        rot = Rotation.from_euler("z", turning * t).as_matrix()
        return plane((speed * t, 0.0, 0.3 * np.sin(t)), rot, (speed, 0.0, 0.3 * np.cos(t)), (0.0, 0.0, turning))

    state = lying(load, RESTING)
    state[9], state[11], state[18] = speed, 0.3, turning
    states, _ = run(
        load, state, rate, 200,
        surroundings=lambda k: around(planes=deck(k * rate), planes_next=deck((k + 1) * rate)),
    )  # fmt: skip
    assert states[-1, 6] == pytest.approx(speed * 4.0, abs=0.02)
    assert states[-1, 8] == pytest.approx(RESTING + 0.3 * np.sin(4.0), abs=2e-3)
    yaw = Rotation.from_quat(states[-1, 12:16]).as_euler("zyx")[0]
    assert yaw == pytest.approx(turning * 4.0, abs=0.02)
    assert landing(states, LANDINGS)[-1] == landing(states, LIFT_OFFS)[-1] == 0.0


def test_a_box_beside_or_far_below_a_rectangle_falls_freely():
    small = FLOOR.copy()
    small[0, :3] = 2.0, 2.0, 0.5
    load = box_load(planes=small, mass=MASS)
    for start in (lying(load, 1.5, beside=(10.0, 0.0)), lying(load, -2.0)):
        states, _ = run(load, start, 0.02, 25, surroundings=ON_FLOOR)
        assert states[-1, 11] == pytest.approx(-G * 0.5, rel=1e-9)


def test_landings_and_lift_offs_are_counted_and_hops_are_not():
    load = box_load(planes=FLOOR, mass=MASS)

    def floor(t):  # drops away faster than it falls, and comes back
        return plane((0.0, 0.0, 2.0 * (np.cos(2.5 * t) - 1.0)), velocity=(0.0, 0.0, -5.0 * np.sin(2.5 * t)))

    states, _ = run(
        load, lying(load, RESTING), 0.01, 400,
        surroundings=lambda k: around(planes=floor(0.01 * k), planes_next=floor(0.01 * (k + 1))),
    )  # fmt: skip
    assert landing(states, LIFT_OFFS)[-1] >= 1.0
    assert landing(states, LANDINGS)[-1] in (landing(states, LIFT_OFFS)[-1], landing(states, LIFT_OFFS)[-1] - 1.0)


def test_no_contact_pulls():
    load = box_load(planes=FLOOR, mass=MASS)
    state = lying(load, RESTING)
    state[11] = 3.0
    states, _ = run(load, state, 0.01, 20, surroundings=ON_FLOOR)
    assert states[-1, 11] >= 3.0 - G * 0.2 - 1e-9
