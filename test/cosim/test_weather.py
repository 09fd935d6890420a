"""The weather of a scenario: what its seed decides, what its files may hold, what the hull's database refuses."""

import numpy as np
import pytest

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim import weather
from shipcrane_twin.cosim.build import hydro_database
from shipcrane_twin.cosim.check import check_buildable
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.sea.components import significant_height

TWO_SYSTEMS = (
    "environment.waves.systems=[{spectrum: jonswap, significant_wave_height_m: 0.6, peak_period_s: 5.0, "
    "peak_enhancement: 3.3, direction_to_deg: 90.0, spreading_exponent: 10.0}, {spectrum: torsethaugen, "
    "significant_wave_height_m: 0.8, peak_period_s: 11.0, direction_to_deg: -135.0}]"
)


def realised(*changes):
    return weather.weather_params(load_scenario("case3", changes))


def test_the_seed_decides_the_whole_weather():
    one, same, other = (realised(f"seed={seed}", "environment.current_deviation_m_s=0.1") for seed in (3, 3, 4))
    for part in ("waves", "gusts", "current"):
        for mine, equal in zip(getattr(one, part), getattr(same, part), strict=True):
            np.testing.assert_array_equal(mine, equal)
    assert (one.waves.phase != other.waves.phase).all()
    assert (one.gusts.phase != other.gusts.phase).all()
    assert (one.current.velocity != other.current.velocity).any()


def test_another_sea_leaves_gusts_and_current_as_they_were():
    one, other = (realised(TWO_SYSTEMS, f"environment.waves.kurtosis_error={error}") for error in (0.02, 0.01))
    assert len(other.waves.omega) > len(one.waves.omega)
    np.testing.assert_array_equal(one.gusts.phase, other.gusts.phase)
    np.testing.assert_array_equal(one.current.velocity, other.current.velocity)


def test_two_systems_add_up():
    assert significant_height(realised(TWO_SYSTEMS).waves) == pytest.approx(1.0, rel=1e-3)  # 0.6 and 0.8


def test_calm_water_has_no_components_and_no_wave_load():
    run = InlineRun(load_scenario("case2", ["operations=[]", "events=[]", "duration_s=1.0"]))
    for _ in run.steps():
        assert not run.latest["/environment/wave_wrench"].any()
    assert run.latest["/environment/sea_state"].size == 0


def test_the_sea_that_is_told_is_the_sea_that_acts():
    seen = {}
    run = InlineRun(load_scenario("case3", ["duration_s=0.1"]), lambda _, topic, values: seen.setdefault(topic, values))
    for _ in run.steps():
        pass
    waves = realised().waves
    told = seen["/environment/sea_state"].reshape(-1, 5).T
    for row, name in zip(told, ("amplitude", "omega", "number_x", "number_y", "phase"), strict=True):
        np.testing.assert_array_equal(row, getattr(waves, name))


def test_waves_go_where_the_scenario_says():
    waves = realised().waves
    np.testing.assert_allclose(waves.number_x, waves.number_y, rtol=1e-6)  # to -135 deg: south-west
    assert (waves.number_x < 0.0).all()


def test_current_is_the_mean_over_the_draught():
    profile = "environment.current_profile=[[0.0, 1.0], [2.6, 0.5]]"
    full, sheared = (realised(*changes).current.velocity[0] for changes in ([], [profile]))
    np.testing.assert_allclose(sheared, 0.75 * full)


def spectrum_in(folder, text):
    path = folder / "sea.csv"
    path.write_text(text, encoding="utf-8")
    return f"environment.waves.systems=[{{spectrum: table, direction_to_deg: 0.0, spectrum_file: {path}}}]"


def test_a_users_spectrum_is_read(tmp_path):
    omega = np.linspace(0.4, 2.0, 81)
    density = 0.1 * np.exp(-(((omega - 0.8) / 0.1) ** 2))
    rows = "\n".join(f"{w:.6f}, {s:.9f}" for w, s in zip(omega, density, strict=True))
    waves = realised(spectrum_in(tmp_path, f"# rad/s, m2 s\n{rows}\n")).waves
    assert significant_height(waves) == pytest.approx(4.0 * np.sqrt(np.trapezoid(density, omega)), rel=1e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1.0, 2.0, 3.0\n" * 4, "has 3 columns and 4 rows, expected two columns, frequency"),
        ("0.5, high\n", "cannot be read as a wave spectrum"),
        ("1.0, 0.1\n0.5, 0.2\n0.7, 0.1\n", "environment.waves: "),
        ("0.5, 0.1\n0.6, -0.2\n0.7, 0.1\n", "environment.waves: "),
    ],
    ids=["columns", "text", "order", "negative"],
)
def test_a_spectrum_that_is_none_is_refused(tmp_path, text, said):
    with pytest.raises(ConfigError) as caught:
        realised(spectrum_in(tmp_path, text))
    assert said in str(caught.value)


def test_a_spectrum_file_that_is_missing_is_named():
    with pytest.raises(ConfigError, match=r"nowhere\.csv: cannot be read as a wave spectrum"):
        realised("environment.waves.systems=[{spectrum: table, direction_to_deg: 0.0, spectrum_file: nowhere.csv}]")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("vessel.hull.hydrodynamics_file=nowhere.nc", "nowhere.nc: no such file; give the path of a hydrodynamic"),
        ("vessel.draught_m=2.7", "vessel.draught_m is 2.7, expected 2.6 as in vessel.hull.hydrodynamics_file"),
        ("constants.water_density_kg_m3=1000.0", "constants.water_density_kg_m3 is 1000, expected 1025"),
        ("vessel.cog_m=[15.516, 0.0, 6.0]", "the hull has no stiffness in heave, roll or pitch"),
        ("vessel.cog_m=[15.516, 0.5, 3.624]", "0.5 m off the centre line"),
        ("vessel.cog_m=[16.516, 0.0, 3.624]", "1.00 m ahead of the hull's centre of buoyancy, so that the ship would"),
    ],
    ids=["missing", "draught", "water", "capsizes", "off centre", "trims"],
)
def test_a_database_of_another_ship_is_refused(change, said):
    with pytest.raises(ConfigError) as caught:
        check_buildable(load_scenario("case3", [change]))
    assert said in str(caught.value)


def test_another_cog_moves_the_database():
    shifted = hydro_database(load_scenario("case3", ["vessel.cog_m=[15.516, 0.0, 3.524]"]))
    usual = hydro_database(load_scenario("case3"))
    gain = usual.mass * usual.gravity * 0.1
    assert shifted.restoring[3, 3] - usual.restoring[3, 3] == pytest.approx(gain)


def test_a_sea_beyond_the_database_is_told():
    assert weather.table_warnings(load_scenario("case3")) == []
    ripples = (
        "environment.waves.systems=[{spectrum: jonswap, direction_to_deg: 0.0, significant_wave_height_m: 0.2, "
        "peak_period_s: 1.6, peak_enhancement: 3.3}]"
    )
    (told,) = weather.table_warnings(load_scenario("case3", [ripples]))
    assert "of the waves' energy lies above the frequencies of the hull's database (0.1 to 4 rad/s)" in told
