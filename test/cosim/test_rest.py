"""The start: an equilibrium, the one that a hand calculation gives, and one that stays."""

import numpy as np
import pytest
from hand_heel import C33, C44, GRAVITY, heel_trim_sinkage, weights_on_ship

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat

POSTURES = {
    "abeam to starboard": ((-np.pi / 2, 0.17, 0.96, 3.0), 700.0),
    "aft": ((-2.5, 0.5, 0.9, 1.0), 700.0),
    "abeam to port, heavy": ((np.pi / 2, 0.17, 1.2, 1.0), 2200.0),
    "forward, hook only": ((0.3, 0.1, 1.0, 2.0), 50.0),
}
CALM = ["operations=[]", "events=[]", "duration_s=20.0"]


def attitude_deg(odom):
    roll, pitch, _ = euler_from_matrix(matrix_from_quat(odom[3:7]))
    return np.rad2deg([roll, pitch])


@pytest.fixture(scope="module")
def calm_start():
    odometry, wire = [], []
    run = InlineRun(load_scenario("case2", CALM))
    for _ in run.steps():
        odometry.append(run.latest["/vessel/odom"])
        wire.append(run.latest["/payload/wire_wrench"][:3])
    return np.array(odometry), np.array(wire)


@pytest.mark.parametrize(("joints", "mass"), POSTURES.values(), ids=POSTURES.keys())
def test_heel_trim_and_sinkage_are_those_of_the_hand_calculation(joints, mass, measured):
    changes = [f"crane.initial_joints={list(joints)}", f"payload.mass_kg={mass}"]
    rest = at_rest(load_scenario("case2", changes))
    heel, trim, sinkage = heel_trim_sinkage(joints, mass)
    roll, pitch, _ = euler_from_matrix(matrix_from_quat(rest.vessel[3:7]))
    name = f"static heel of {abs(np.rad2deg(heel)):.2f} deg against hand calculation"
    measured(name, abs(np.rad2deg(roll - heel)), 0.01, "deg")
    assert np.rad2deg(pitch) == pytest.approx(np.rad2deg(trim), abs=0.01)
    assert rest.vessel[2] == pytest.approx(3.624 - 2.6 - sinkage, abs=1e-3)


def test_the_ship_heels_to_the_side_of_the_crane_and_goes_down():
    heel, _, sinkage = heel_trim_sinkage(*POSTURES["abeam to starboard"])
    assert 1.0 < np.rad2deg(heel) < 4.0
    masses, _ = weights_on_ship(*POSTURES["abeam to starboard"])
    assert sinkage == pytest.approx(GRAVITY * masses.sum() / C33, abs=0.02)


def test_calm_start_stays_at_the_heel_of_the_hand_calculation(calm_start, measured):
    heel = np.rad2deg(heel_trim_sinkage(*POSTURES["abeam to starboard"])[0])
    rolls = np.array([attitude_deg(odom)[0] for odom in calm_start[0]])
    measured("heel over 20 s of simulation against hand calculation", np.abs(rolls - heel).max(), 0.01, "deg")


def test_calm_start_has_no_transient(calm_start, measured):
    odometry, _ = calm_start
    attitudes = np.array([attitude_deg(odom) for odom in odometry])
    measured("roll transient of a calm start over 20 s", np.ptp(attitudes[:, 0]), 1e-3, "deg")
    assert np.ptp(attitudes[:, 1]) < 1e-3
    assert np.ptp(odometry[:, :3], axis=0).max() < 1e-4


def test_static_wire_tension_is_the_weight_of_the_load(calm_start, measured):
    weight = np.array([0.0, 0.0, -700.0 * GRAVITY])
    off = np.linalg.norm(calm_start[1] - weight, axis=1).max() / (700.0 * GRAVITY)
    measured("static wire tension against m g over 20 s", off, 1e-6)


@pytest.mark.parametrize("coupling", ["in_turn", "in_turn+inertia"])
@pytest.mark.parametrize("step_ms", [10.0, 50.0])
def test_start_is_an_equilibrium_of_every_scheme_and_step(coupling, step_ms):
    changes = [*CALM, "duration_s=5.0", f"coupling={coupling}", f"macro_step_ms={step_ms}"]
    run = InlineRun(load_scenario("case2", changes))
    rolls = [attitude_deg(run.latest["/vessel/odom"])[0] for _ in run.steps()]
    assert np.ptp(rolls) < 1e-3


def test_start_follows_heading_and_place():
    place = ["vessel.initial.north_m=20.0", "vessel.initial.east_m=-7.0", "vessel.initial.heading_deg=120.0"]
    rest = at_rest(load_scenario("case2", place))
    np.testing.assert_allclose(rest.vessel[:2], [-7.0, 20.0])
    roll, pitch, yaw = euler_from_matrix(matrix_from_quat(rest.vessel[3:7]))
    assert np.rad2deg(yaw) == pytest.approx(-30.0)
    plain = at_rest(load_scenario("case2"))
    np.testing.assert_allclose([roll, pitch], euler_from_matrix(matrix_from_quat(plain.vessel[3:7]))[:2], atol=1e-12)


def test_a_crane_too_heavy_for_the_ship_finds_no_rest():
    with pytest.raises(ValueError, match="no equilibrium below 40 degrees of heel"):
        at_rest(load_scenario("case2", ["crane.links.1.mass_kg=5.0e+5"]))


def test_ballast_levels_the_ship_at_the_start():
    rest = at_rest(load_scenario("case2", ["vessel.ballast.mode=level"]))
    np.testing.assert_allclose(euler_from_matrix(matrix_from_quat(rest.vessel[3:7]))[:2], 0.0, atol=1e-12)
    assert rest.vessel[2] == pytest.approx(3.624 - 2.6, abs=1e-12)


def test_given_ballast_heels_as_its_moment_over_the_stiffness():
    plain = at_rest(load_scenario("case2", ["payload.mass_kg=50.0"]))
    moment = 2.0e4
    heeled = at_rest(
        load_scenario("case2", ["payload.mass_kg=50.0", f"vessel.ballast={{mode: values, roll_n_m: {moment}}}"])
    )
    rolls = [euler_from_matrix(matrix_from_quat(rest.vessel[3:7]))[0] for rest in (plain, heeled)]
    masses, places = weights_on_ship(plain.joints, 50.0)
    upright = C44 - GRAVITY * masses @ places[:, 2]  # what stands high makes the ship less stiff
    assert rolls[1] - rolls[0] == pytest.approx(moment / upright, rel=2e-3)


def test_leveled_ship_stays_level():
    run = InlineRun(load_scenario("case2", [*CALM, "vessel.ballast.mode=level"]))
    rolls = [attitude_deg(run.latest["/vessel/odom"])[0] for _ in run.steps()]
    assert np.abs(rolls).max() < 1e-3
