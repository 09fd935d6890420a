"""Wind: signs in every quadrant, symmetry, growth with speed."""

import numpy as np
import pytest
from gunnerus_ship import SCENARIO
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from shipcrane_twin.cosim.build import wind_params
from shipcrane_twin.physics.wind import wind_load

WIND = wind_params(SCENARIO)
compiled = settings(deadline=None)
speeds = st.floats(-20.0, 20.0)
SURGE, SWAY, HEAVE, ROLL, PITCH, YAW = range(6)


def load_of_wind_from(degrees, speed=10.0):
    """Load of wind that comes from this direction, anticlockwise from the bow (positive: from port)."""
    angle = np.deg2rad(degrees)
    return wind_load(WIND, -speed * np.cos(angle), -speed * np.sin(angle))


def test_head_wind_pushes_aft_and_tail_wind_forward():
    assert load_of_wind_from(0.0)[SURGE] < 0.0
    assert load_of_wind_from(180.0)[SURGE] > 0.0


@pytest.mark.parametrize("degrees", [15, 45, 90, 135, 165])
def test_wind_from_port_pushes_to_starboard_and_heels_to_starboard(degrees):
    load = load_of_wind_from(degrees)
    assert load[SWAY] < 0.0
    assert load[ROLL] > 0.0


@pytest.mark.parametrize("degrees", [-15, -45, -90, -135, -165])
def test_wind_from_starboard_pushes_to_port_and_heels_to_port(degrees):
    load = load_of_wind_from(degrees)
    assert load[SWAY] > 0.0
    assert load[ROLL] < 0.0


@pytest.mark.parametrize(("degrees", "sign"), [(45, -1), (-45, 1), (150, 1), (-150, -1)])
def test_wind_turns_the_end_that_it_meets_to_leeward(degrees, sign):
    assert np.sign(load_of_wind_from(degrees)[YAW]) == sign


@compiled
@given(x=speeds, y=speeds)
def test_wind_is_symmetric_to_port_and_starboard(x, y):
    assume(abs(y) > 1e-6)
    mirrored = wind_load(WIND, x, y) * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]
    np.testing.assert_allclose(wind_load(WIND, x, -y), mirrored, atol=1e-9)


@compiled
@given(x=speeds, y=speeds)
def test_wind_load_grows_with_speed_squared_and_leaves_heave_and_pitch_alone(x, y):
    load = wind_load(WIND, x, y)
    np.testing.assert_allclose(wind_load(WIND, 2.0 * x, 2.0 * y), 4.0 * load, atol=1e-6)
    assert load[HEAVE] == load[PITCH] == 0.0


@pytest.mark.parametrize("row", range(19))
def test_wind_coefficients_are_those_of_the_table_at_its_directions(row):
    angle, surge, sway, roll, yaw = WIND.table[row]
    load = load_of_wind_from(np.rad2deg(angle), 1.0)
    half_rho = 0.5 * 1.225
    expected = half_rho * np.array(
        [81.0 * surge, -172.0 * sway, 0.0, 172.0 * (172.0 / 33.9) * roll, 0.0, -172.0 * 33.9 * yaw]
    )
    np.testing.assert_allclose(load, expected, atol=1e-8 * half_rho * 172.0 * 33.9)


@pytest.mark.parametrize("degrees", range(5, 180, 10))
def test_wind_between_two_rows_is_their_mean(degrees):
    mean = 0.5 * (load_of_wind_from(degrees - 5.0) + load_of_wind_from(degrees + 5.0))
    np.testing.assert_allclose(load_of_wind_from(degrees), mean, atol=1e-6)
