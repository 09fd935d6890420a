"""Capability plot: attainable set, mean loads, largest wind, degradation, figure."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import hydro_database
from shipcrane_twin.validation.capability import (
    CORNERS,
    WIND_SPEED,
    Thruster,
    capabilities,
    capability,
    capability_figure,
    largest_wind,
    remaining,
    sea_drift,
    ship_of,
    thrust_facets,
    wave_drift,
    weather_load,
)

MIRROR = np.array([1.0, -1.0, -1.0])
TOP = WIND_SPEED[-1]


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("case3")


@pytest.fixture(scope="module")
def ship(scenario):
    return ship_of(scenario)


@pytest.fixture(scope="module")
def facets(ship):
    return thrust_facets(ship.thrusters, ship.length)


@pytest.fixture(scope="module")
def cases(ship):
    return capabilities(ship)


def reach(facets, load, length):
    """How many times a load the attainable set holds."""
    return 1.0 / np.max(facets[:, :3] @ (load / [1.0, 1.0, length]) / facets[:, 3])


def reach_by_program(thrusters, load):
    """The same by a linear program in the thrust components, azimuths as polygons."""
    angle = (np.arange(CORNERS) + 0.5) * (2.0 * np.pi / CORNERS)
    balance, sides, ends = [], [], []
    for thruster in thrusters:
        balance += [[1.0, 0.0, -thruster.port], [0.0, 1.0, thruster.forward]]
        along = np.column_stack([np.cos(angle), np.sin(angle)])
        if not thruster.azimuthing:
            along = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        sides.append(along)
        apothem = thruster.thrust_max * np.cos(np.pi / CORNERS)
        across = thruster.thrust_max * np.array([0.0, 0.0, 1.0, 1.0])
        ends.append(np.full(CORNERS, apothem) if thruster.azimuthing else across)
    count = 2 * len(thrusters)
    limit = np.zeros((sum(map(len, ends)), count + 1))
    row = 0
    for i, along in enumerate(sides):
        limit[row : row + len(along), 2 * i : 2 * i + 2] = along
        row += len(along)
    unit = np.array([1e4, 1e4, 1e5])
    equal = np.column_stack([np.array(balance).T / unit[:, None], -load / unit])
    cost = np.append(np.zeros(count), -1.0)
    bounds = [(None, None)] * count + [(0.0, None)]
    found = linprog(cost, limit, np.concatenate(ends), equal, np.zeros(3), bounds)
    return found.x[-1]


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 9999), lost=st.sampled_from([(), ("azimuth_port",), ("bow_tunnel",)]))
def test_attainable_set_is_that_of_a_linear_program(ship, seed, lost):
    left = remaining(ship, lost)
    load = np.random.default_rng(seed).normal(size=3) * [5e4, 3e4, 4e5]
    found = reach(thrust_facets(left, ship.length), load, ship.length)
    assert found == pytest.approx(reach_by_program(left, load), rel=1e-6)


def test_attainable_set_ends_at_the_sum_of_the_thrusts(ship, facets):
    azimuths, tunnel = 2 * 54e3, 20e3
    assert reach(facets, np.array([1.0, 0.0, 0.0]), ship.length) == pytest.approx(azimuths, rel=1e-9)
    # one azimuth on the centre line: the tunnel gives all it has, the azimuth what balances its moment
    pair = [Thruster("stern", -12.0, 0.0, 54e3, True), Thruster("bow", 15.0, 0.0, 20e3, False)]
    found = reach(thrust_facets(pair, ship.length), np.array([0.0, 1.0, 0.0]), ship.length)
    assert found == pytest.approx(tunnel * (1.0 + 15.0 / 12.0), rel=1e-9)


def test_thrusters_that_leave_an_axis_free_hold_nothing(ship):
    assert thrust_facets([Thruster("a", 1.0, 0.0, 1e4, True)], ship.length) is None
    assert not capability(ship, ("azimuth_port", "azimuth_starboard")).any()


def test_thruster_that_the_ship_does_not_have_is_refused(ship):
    with pytest.raises(ValueError, match="stern_tunnel is no thruster of the ship, expected one of azimuth_port"):
        capability(ship, ("stern_tunnel",))


@pytest.mark.parametrize("period", [4.0, 8.0, 12.0])
def test_constant_drift_gives_an_eighth_of_the_squared_height(scenario, period):
    data = hydro_database(scenario)
    flat = dataclasses.replace(data, drift=np.full_like(data.drift, 3.0))
    np.testing.assert_allclose(sea_drift(flat, period), 3.0 / 8.0, rtol=1e-3)


@settings(deadline=None, max_examples=20)
@given(height=st.floats(0.1, 8.0), period=st.floats(3.6, 11.9), row=st.integers(0, 8))
def test_tabulated_drift_is_that_of_the_sea(scenario, ship, height, period, row):
    exact = height**2 * sea_drift(hydro_database(scenario), period)
    largest = np.abs(exact).max(axis=0)
    found = wave_drift(ship, height, period, ship.direction[row])
    np.testing.assert_allclose(found, exact[row], atol=0.01 * largest.max() + 1e-9)


@settings(deadline=None)
@given(wind=st.floats(0.0, 32.0), from_deg=st.floats(1.0, 179.0))
def test_weather_from_the_other_side_is_mirrored(ship, wind, from_deg):
    one, other = weather_load(ship, wind, from_deg), weather_load(ship, wind, -from_deg)
    np.testing.assert_allclose(other, MIRROR * one, atol=1e-9 * np.abs(one).max() + 1e-9)


@pytest.mark.parametrize(("from_deg", "axis", "sign"), [(0.0, 0, -1), (180.0, 0, 1), (90.0, 1, 1), (270.0, 1, -1)])
def test_weather_pushes_away_from_where_it_comes(ship, from_deg, axis, sign):
    assert sign * weather_load(ship, 12.0, from_deg, 0.0)[axis] > 1e3
    assert not weather_load(ship, 0.0, from_deg).any()


def test_wind_alone_from_ahead_ends_where_it_takes_all_thrust(ship):
    calm = ship._replace(drift=np.zeros_like(ship.drift))
    weak = [t._replace(thrust_max=0.02 * t.thrust_max) for t in ship.thrusters]
    found = largest_wind(calm, thrust_facets(weak, ship.length), 0.0, 0.0)
    per_square = -weather_load(calm, 10.0, 0.0, 0.0)[0] / 100.0
    assert found == pytest.approx(np.sqrt(0.02 * 108e3 / per_square), abs=0.02)


@pytest.mark.parametrize("from_deg", [20.0, 90.0, 140.0])
def test_largest_wind_is_the_edge_of_what_is_held(ship, facets, from_deg):
    wind = largest_wind(ship, facets, from_deg)
    assert reach(facets, -weather_load(ship, wind, from_deg), ship.length) >= 1.0
    assert reach(facets, -weather_load(ship, wind + 0.02, from_deg), ship.length) < 1.0


def test_ship_that_lost_a_thruster_never_holds_more_wind(cases, measured):
    intact = cases.pop("intact")
    assert set(cases) == {"without azimuth_port", "without azimuth_starboard", "without bow_tunnel"}
    for name, winds in cases.items():
        measured(f"capability {name}: more wind held than intact, any direction", (winds - intact).max(), 0.0, "m/s")
        assert (winds < intact - 1.0).any()
    cases["intact"] = intact
    assert intact.min() > 5.0
    assert intact.max() <= TOP


def test_losing_one_azimuth_mirrors_losing_the_other(cases):
    port, starboard = cases["without azimuth_port"], cases["without azimuth_starboard"]
    np.testing.assert_allclose(port, np.roll(starboard[::-1], 1), atol=0.05)


def test_figure_shows_every_case_all_around(cases):
    figure = capability_figure("a ship", cases)
    drawn = {line.get_label(): line.get_ydata() for line in figure.axes[0].lines}
    for name, winds in cases.items():
        values = drawn[name.replace("_", " ")]
        np.testing.assert_array_equal(values, np.append(winds, winds[0]))
