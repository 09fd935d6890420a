"""Loads of the water: what they must obey whatever the coefficients."""

import numpy as np
import pytest
from gunnerus_ship import DATA_PERIODS, SHIP, alone
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from shipcrane_twin.physics.hull import (
    add_added_mass_bias,
    add_viscous_load,
    current_load,
    restoring_load,
    turning_drag,
)

HULL = SHIP.hull
compiled = settings(deadline=None)
tilts = st.floats(-0.6, 0.6)
speeds = st.floats(-5.0, 5.0)
nus = st.tuples(*[st.floats(-2.0, 2.0)] * 3, *[st.floats(-0.3, 0.3)] * 3).map(np.array)


def potential(height, roll, pitch):
    rise, c = height - HULL.design_height, HULL.restoring
    return 0.5 * (
        c[2, 2] * rise**2 + 2.0 * c[2, 4] * rise * pitch + c[3, 3] * roll**2 + c[4, 4] * pitch**2
    )


def slope(place, i, step=1e-4):
    before, after = list(place), list(place)
    before[i], after[i] = place[i] - step, place[i] + step
    return (potential(*after) - potential(*before)) / (2.0 * step)


@compiled
@given(rise=st.floats(-2.0, 2.0), roll=tilts, pitch=tilts)
def test_restoring_is_the_gradient_of_its_potential(rise, roll, pitch):
    place = (HULL.design_height + rise, roll, pitch)
    force_up, about_ahead, about_port = restoring_load(HULL, *place)
    body_x = np.cos(pitch)  # of it along the level axis ahead; the rest points down, where there is no moment
    loads = [force_up, about_ahead * body_x, about_port]
    np.testing.assert_allclose(loads, [-slope(place, i) for i in range(3)], atol=1.0)


@compiled
@given(turn=st.tuples(*[st.floats(-0.3, 0.3)] * 3), heave=st.floats(-2.0, 2.0))
def test_linear_and_quadratic_damping_only_take_power(turn, heave):
    nu = np.array([0.0, 0.0, heave, *turn])
    assert nu @ alone(add_viscous_load, HULL, nu) <= 0.0


@pytest.mark.parametrize("rate", [0.2, -0.2])
def test_roll_damping_is_linear_with_a_squared_part_on_top(rate):
    rates = np.array([0.0, 0.0, 0.0, rate, 0.0, 0.0])
    expected = -HULL.damping @ rates
    expected[3] -= HULL.roll_quadratic * rate * abs(rate)
    np.testing.assert_allclose(alone(add_viscous_load, HULL, rates), expected)


def test_linear_roll_damping_is_the_viscous_share_of_critical_and_friction():
    """2 zeta sqrt((I44 + A44) C44) at the natural frequency, and B44 of the ship's file."""
    omega = 2.0 * np.pi / DATA_PERIODS["roll"]
    critical = 2.0 * HULL.restoring[3, 3] / omega
    assert HULL.damping[3, 3] == pytest.approx(0.06 * critical + 5892.9, rel=1e-3)


@compiled
@given(sway=speeds, rate=st.floats(-0.3, 0.3))
def test_turning_drag_is_the_integral_of_the_sections_drag_less_that_of_straight_sway(sway, rate):
    length, draught, aft = 33.9, 2.6, -15.516
    x = np.linspace(aft, aft + length, 20001)
    speed = sway + x * rate
    drag = -0.5 * 1025.0 * 0.66 * draught * (speed * np.abs(speed) - sway * np.abs(sway))
    expected = np.trapezoid(drag, x), np.trapezoid(drag * x, x)
    scale = np.abs(drag).max() * length + 1e-9
    force, moment = turning_drag(HULL, sway, rate)
    assert force == pytest.approx(expected[0], abs=5e-3 * scale)
    assert moment == pytest.approx(expected[1], abs=5e-3 * scale * length)


@compiled
@given(rate=st.floats(0.01, 0.3))
def test_turning_on_the_spot_is_braked_either_way(rate):
    assert turning_drag(HULL, 0.0, rate)[1] < 0.0 < turning_drag(HULL, 0.0, -rate)[1]


def test_ballast_adds_its_load_and_no_other():
    loaded = HULL._replace(ballast=np.array([1e4, 2e4, 3e4]))
    place = HULL.design_height, 0.0, 0.0
    added = np.subtract(restoring_load(loaded, *place), restoring_load(HULL, *place))
    np.testing.assert_allclose(added, [1e4, 2e4, 3e4])


@compiled
@given(x=speeds, y=speeds)
def test_current_is_symmetric_to_port_and_starboard_and_grows_with_speed_squared(x, y):
    assume(abs(y) > 1e-6)
    load = np.array(current_load(HULL, x, y))
    np.testing.assert_allclose(current_load(HULL, x, -y), load * [1.0, -1.0, -1.0], atol=1e-9)
    np.testing.assert_allclose(current_load(HULL, 3.0 * x, 3.0 * y), 9.0 * load, atol=1e-6)


@pytest.mark.parametrize("towards_deg", [-170, -135, -90, -45, -10, 10, 45, 90, 135, 170])
def test_current_pushes_sideways_the_way_it_flows(towards_deg):
    angle = np.deg2rad(towards_deg)  # anticlockwise from the bow
    assert current_load(HULL, np.cos(angle), np.sin(angle))[1] * np.sin(angle) > 0.0


def test_current_from_astern_pushes_forward_and_from_ahead_aft():
    assert current_load(HULL, 1.0, 0.0)[0] > 0.0
    assert current_load(HULL, -1.0, 0.0)[0] < 0.0


@pytest.mark.parametrize("row", range(19))
def test_current_coefficients_are_those_of_the_table_at_its_directions(row):
    angle, *coefficients = HULL.current_table[row]
    load = current_load(HULL, np.cos(angle), -np.sin(angle))  # the table counts clockwise, y is to port
    expected = HULL.current_scale * coefficients * [1.0, -1.0, -1.0]
    np.testing.assert_allclose(load, expected, atol=1e-6 * HULL.current_scale.max())


def test_current_scale_is_half_density_times_area_and_length():
    half_rho = 0.5 * 1025.0
    np.testing.assert_allclose(HULL.current_scale, half_rho * np.array([24.96, 88.14, 88.14 * 33.9]))


@compiled
@given(nu=nus)
def test_kirchhoffs_forces_of_a_hull_that_only_yaws_do_no_work_with_the_munk_moment_put_back(nu):
    nu = nu * [1.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    bias = alone(add_added_mass_bias, HULL, nu, nu, nu[5])
    munk = -np.cross(nu[:3], (HULL.added_mass @ nu)[:3])
    size = np.abs(nu) @ np.abs(bias) + 1.0
    assert nu[:3] @ bias[:3] + nu[3:] @ (bias[3:] + munk) == pytest.approx(0.0, abs=1e-9 * size)


@compiled
@given(nu=nus, water=st.tuples(*[st.floats(-2.0, 2.0)] * 3).map(np.array))
def test_a_ship_that_drifts_with_the_water_feels_no_more_of_it_than_in_still_water(nu, water):
    """Water and ship moved alike: the momentum against the water is the same, the turning of the axes new."""
    relative = nu.copy()
    moving = nu.copy()
    moving[:3] += water
    still = alone(add_added_mass_bias, HULL, nu, relative, 0.1)
    drift = alone(add_added_mass_bias, HULL, moving, relative, 0.1) - still
    turning = np.concatenate((np.cross(nu[3:], water), np.zeros(3)))  # what nu_dot in body axes has besides
    np.testing.assert_allclose(drift, -HULL.added_mass @ turning, atol=1e-5)
