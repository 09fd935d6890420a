"""The box in the splash zone, term by term against hand calculations after DNV-RP-N103."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rigid_rig import G, around, box_load, lying, run
from scipy.spatial.transform import Rotation

from shipcrane_twin.physics.splash import body_added_mass, entered, plate_added_mass
from shipcrane_twin.validation.lifting_splash import AREA, STILL, box_in_water, load_at, splash_rows, transit
from shipcrane_twin.validation.lifting_splash import DENSITY as RHO

VOLUME = 24.0


def off(value, wanted):
    return abs(value / wanted - 1.0)


def test_added_mass_is_that_of_the_recommended_practice(measured):
    # plate 4 x 3 m: aspect 1.333, coefficient 0.658 between 0.642 and 0.690
    plate = 1025.0 * 0.658 * np.pi / 4.0 * 3.0**2 * 4.0
    measured("splash zone: added mass of a plate", off(plate_added_mass(4.0, 3.0, 1025.0), plate), 0.02)
    # box 2 m high: lambda = sqrt(12) / (2 + sqrt(12)) = 0.634, factor 1 + sqrt(0.598 / 2.804) = 1.462
    full = 1.462 * plate
    measured("splash zone: added mass of a box", off(body_added_mass(4.0, 3.0, 2.0, 1025.0, 0.0), full), 0.02)
    # 20 % open: 0.7 + 0.3 cos(pi 15 / 34) = 0.755
    open_box = body_added_mass(4.0, 3.0, 2.0, 1025.0, 0.2)
    measured("splash zone: added mass of a box with 20 % holes", off(open_box, 0.755 * full), 0.02)
    assert body_added_mass(4.0, 3.0, 2.0, 1025.0, 0.05) == body_added_mass(4.0, 3.0, 2.0, 1025.0, 0.0)
    near = [body_added_mass(4.0, 3.0, 2.0, 1025.0, 0.34 + d) for d in (-1e-6, 1e-6)]
    assert near[0] == pytest.approx(near[1], rel=0.03)
    assert plate_added_mass(1e4, 1.0, 1025.0) == pytest.approx(1025.0 * np.pi / 4.0 * 1e4, rel=1e-4)


def test_buoyancy_is_the_weight_of_the_water_displaced(measured):
    for depth in (0.5, 1.3, 2.0, 7.0):
        found = load_at(depth)[0][2]
        hand = 1025.0 * 9.80665 * 12.0 * min(depth, 2.0)
        measured(f"splash zone: buoyancy at {depth:g} m", off(found, hand), 0.02)
    half = load_at(1.0, box=box_in_water(displaced=0.5))[0][2]
    assert half == pytest.approx(0.5 * load_at(1.0)[0][2])


def test_slamming_force_on_entry(measured):
    # C_s = 5, A = 12 m2, 0.8 m/s down into water that rises with 0.6 m/s: 60.3 kN
    water = np.array([0.3, 0.0, 0.0, 0.6, 0.0, 0.0, 0.0])
    boxes = [box_in_water(drag=0.0, slamming=c) for c in (1e-9, 5.0)]
    plain, slammed = (load_at(0.2, (0.0, 0.0, -0.8), water, box=box)[0][2] for box in boxes)
    measured("splash zone: slamming force", off(slammed - plain, 0.5 * 1025.0 * 5.0 * 12.0 * 1.4**2), 0.02)
    leaving = load_at(0.2, (0.0, 0.0, 0.8), box=box_in_water(drag=0.0))[0][2]
    assert leaving == pytest.approx(load_at(0.2, box=box_in_water(drag=0.0))[0][2])


def test_slamming_lasts_until_the_added_mass_is_there():
    rate, full, ease = 0.5 * RHO * 5.0 * AREA, 2.0e4, 0.04
    depth = np.linspace(0.0, 2.0, 200001)
    mass, slope = np.array([entered(d, ease, rate, full) for d in depth]).T
    np.testing.assert_allclose(np.gradient(mass, depth)[1:-1], slope[1:-1], atol=1e-3 * rate)
    assert slope.max() == pytest.approx(rate)
    assert mass[-1] == pytest.approx(full)
    assert np.abs(np.diff(slope)).max() < 1e-3 * rate


def test_drag_and_mass_force_of_the_submerged_box(measured):
    level = load_at(5.0)[0]
    for axis, area in ((0, 6.0), (1, 8.0), (2, 12.0)):
        velocity = np.zeros(3)
        velocity[axis] = -0.7
        found = (load_at(5.0, velocity)[0] - level)[axis]
        measured(f"splash zone: drag along axis {axis}", off(found, 0.5 * 1025.0 * 1.2 * area * 0.7**2), 0.02)
    water = np.zeros(7)
    water[6] = 0.9
    lifted = (load_at(5.0, water=water)[0] - level)[2]
    a33 = 1.462 * 1025.0 * 0.658 * np.pi / 4.0 * 36.0
    measured("splash zone: mass force", off(lifted, (1025.0 * 24.0 + a33) * 0.9), 0.02)
    measured("splash zone: added mass of the submerged box", off(load_at(5.0)[2][2], a33), 0.02)


def test_nothing_jumps_on_the_way_through_the_surface():
    depths = np.linspace(-0.5, 4.0, 20001)
    water = np.array([0.0, 0.4, 0.2, 0.6, 0.1, 0.2, 0.5])
    rot = Rotation.from_euler("xyz", [4.0, -3.0, 30.0], degrees=True).as_matrix()
    for turn in (np.eye(3), rot):
        forces = np.array([np.concatenate(load_at(d, (0.1, 0.0, -1.0), water, turn)) for d in depths])
        assert (np.abs(np.diff(forces, axis=0)).max(axis=0) <= 0.01 * np.ptp(forces, axis=0)[[2] * 9]).all()


def test_transit_at_constant_speed_has_the_hand_calculated_history(measured):
    for row in splash_rows(transit()):
        measured(f"splash zone: {row.what}", row.value, row.bar)


def test_a_box_floats_at_its_draught_and_rights_itself(measured):
    water = box_in_water(drag=4.0)
    load = box_load(mass=12300.0, water=water)
    heeled = Rotation.from_euler("x", 8.0, degrees=True).as_quat()
    states, _ = run(load, lying(load, 0.4, quat=heeled), 0.02, 3000, surroundings=around(water=STILL))
    draught = 12300.0 / 1025.0 / 12.0
    measured("splash zone: draught of a floating box", off(1.0 - states[-400:, 8].mean(), draught), 0.02)
    assert np.abs(states[-1, 12:14]).max() < 0.02
    # small heel: righting moment rho g V GM with GM = KB + I / V - KG
    heel = np.deg2rad(2.0)
    rot = Rotation.from_euler("x", heel).as_matrix()
    moment = load_at(draught, rot=rot)[1][0]
    metacentric = 0.5 * draught + 4.0 * 3.0**3 / 12.0 / (12.0 * draught) - 1.0
    measured("splash zone: righting moment", off(-moment, 12300.0 * G * metacentric * np.sin(heel)), 0.02)


def test_dropped_into_deep_water_it_sinks_at_its_terminal_speed(measured):
    load = box_load(mass=40000.0)
    states, _ = run(load, lying(load, 3.0), 0.05, 400, surroundings=around(water=STILL))
    terminal = np.sqrt((40000.0 - RHO * VOLUME) * G / (0.5 * RHO * 1.2 * AREA))
    measured("splash zone: terminal speed", off(-states[-1, 11], terminal), 0.02)


@settings(deadline=None, max_examples=100)
@given(
    depth=st.floats(-3.0, 6.0),
    angles=st.tuples(*[st.floats(-180.0, 180.0)] * 3),
    velocity=st.tuples(*[st.floats(-30.0, 30.0)] * 3),
    yaw=st.floats(0.0, 360.0),
)
def test_drag_brakes_and_turning_the_world_changes_nothing(depth, angles, velocity, yaw):
    rot = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    force, moment, added = load_at(depth, velocity, rot=rot)
    still, _, _ = load_at(depth, rot=rot, box=box_in_water(slamming=1e-9))
    resisted = load_at(depth, velocity, rot=rot, box=box_in_water(slamming=1e-9))[0]
    assert (resisted - still) @ np.array(velocity) <= 1e-6 * np.linalg.norm(resisted)
    assert (added >= 0.0).all()
    turn = Rotation.from_euler("z", yaw, degrees=True).as_matrix()
    turned, turned_moment, same = load_at(depth, turn @ velocity, rot=turn @ rot)
    np.testing.assert_allclose(turned, turn @ force, rtol=1e-9, atol=1e-6 * (1.0 + np.linalg.norm(force)))
    np.testing.assert_allclose(turned_moment, turn @ moment, atol=1e-6 * (1.0 + np.linalg.norm(moment)))
    np.testing.assert_allclose(same, added, atol=1e-6 * (1.0 + added.max()))


def test_a_dry_box_feels_no_water():
    force, moment, added = load_at(-0.01, (0.0, 0.0, -1.0))
    np.testing.assert_array_equal(np.concatenate((force, moment, added)), np.zeros(9))
