"""From settings to the sea, the gusts and the current of a run; everything random comes from the scenario's seed."""

import math

import numpy as np

from shipcrane_twin.config.environment import WaveSystemConfig
from shipcrane_twin.config.load import data_file
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim import build
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import towards_w, yaw_from_heading
from shipcrane_twin.physics.sea import gusts as gust_models
from shipcrane_twin.physics.sea import spectra
from shipcrane_twin.physics.sea.components import Irregular, Regular, Waves, make_waves, realise
from shipcrane_twin.physics.sea.current import Current, mean_factor, realise_current
from shipcrane_twin.physics.sea.gusts import Gusts, realise_gusts
from shipcrane_twin.physics.sea.loads import outside_shares, wave_load_params
from shipcrane_twin.physics.slow_pose import follower
from shipcrane_twin.physics.weather import WeatherParams

SEA, GUSTS, CURRENT, SENSORS = 0, 1, 2, 3
"""Streams of random numbers: each has its own, so that another sea leaves the gusts as they were."""

OUTSIDE_SHARE_MAX = 0.01
"""Share of the waves' energy outside the hull's database from which a user is warned."""


def stream(scenario: Scenario, which: int) -> np.random.Generator:
    """Return the generator of one stream of the scenario's seed."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([scenario.seed, which])))


def weather_params(scenario: Scenario) -> WeatherParams:
    """Return the realised weather and what turns it into loads."""
    env = scenario.environment
    data = build.hydro_database(scenario)
    waves = sea(scenario)
    loads = wave_load_params(
        waves,
        data.omega,
        data.direction,
        data.excitation,
        data.drift,
        first_order=env.waves.first_order,
        slow_drift=env.waves.slow_drift,
    )
    return WeatherParams(
        waves=waves,
        wave_loads=loads,
        gusts=gusts(scenario),
        current=current(scenario),
        wind=build.wind_params(scenario),
        mean_wind=env.wind_speed_m_s,
        wind_towards=towards_w(env.wind_direction_to_deg)[:2].copy(),
        cog=np.array(scenario.vessel.cog_m),
        follow=follower(env.waves.slow_motion_period_s, scenario.step_ns / 1e9),
    )


def sea(scenario: Scenario) -> Waves:
    """Return the realised sea; without wave systems it has no components.

    Raises
    ------
    ConfigError
        If a spectrum cannot be read or realised.
    """
    env = scenario.environment
    systems = [wave_system(scenario, system) for system in env.waves.systems]
    gravity, depth = scenario.constants.gravity_m_s2, env.water_depth_m or math.inf
    if not systems:
        calm = np.zeros(0)
        return make_waves(calm, calm, calm, calm, gravity=gravity, depth=depth, ramp=env.waves.ramp_s)
    try:
        return realise(
            systems,
            stream(scenario, SEA),
            gravity=gravity,
            depth=depth,
            ramp=env.waves.ramp_s,
            error=env.waves.kurtosis_error,
        )
    except ValueError as err:
        raise ConfigError(f"{scenario.name}: environment.waves: {err}") from None


def wave_system(scenario: Scenario, system: WaveSystemConfig) -> Irregular | Regular:
    """Return one wave system; its settings have been checked against its spectrum."""
    direction = yaw_from_heading(system.direction_to_deg)
    if system.spectrum == "regular":
        return Regular(height=system.height_m or 0.0, period=system.period_s or 0.0, direction=direction)
    spreading = math.inf if system.spreading_exponent is None else system.spreading_exponent
    if system.spectrum == "table":
        omega, density = read_spectrum(system.spectrum_file or "")
        return Irregular(omega=omega, density=density, direction=direction, spreading=spreading)
    height, period = system.significant_wave_height_m or 0.0, system.peak_period_s or 0.0
    omega = spectra.grid(period)
    if system.spectrum == "jonswap":
        density = spectra.jonswap(omega, height, period, system.peak_enhancement or 1.0)
    elif system.spectrum == "pierson_moskowitz":
        density = spectra.pierson_moskowitz(omega, height, period)
    else:
        density = spectra.torsethaugen(omega, height, period, scenario.constants.gravity_m_s2)
    return Irregular(omega=omega, density=density, direction=direction, spreading=spreading)


def read_spectrum(name: str) -> tuple[Array, Array]:
    """Return frequencies [rad/s] and densities [m2 s/rad] of a user's spectrum file."""
    path = data_file(name)
    try:
        rows = np.loadtxt(path, delimiter="," if path.suffix == ".csv" else None, comments="#", ndmin=2)
    except (OSError, ValueError) as err:
        raise ConfigError(f"{path}: cannot be read as a wave spectrum: {err}") from None
    if rows.shape[1] != 2 or len(rows) < 3:
        raise ConfigError(
            f"{path}: a wave spectrum has {rows.shape[1]} columns and {len(rows)} rows, expected two columns, "
            "frequency [rad/s] and density [m2 s/rad], and at least three rows"
        )
    return rows[:, 0].copy(), rows[:, 1].copy()


def gusts(scenario: Scenario) -> Gusts:
    """Return the realised gusts along the mean wind; none without a mean."""
    env = scenario.environment
    rng = stream(scenario, GUSTS)
    frequency = gust_models.grid()
    if env.wind_gusts == "none" or env.wind_speed_m_s == 0.0:
        return realise_gusts(frequency, np.zeros_like(frequency), rng)
    model = gust_models.froya if env.wind_gusts == "froya" else gust_models.harris
    return realise_gusts(frequency, model(frequency, env.wind_speed_m_s), rng)


def current(scenario: Scenario) -> Current:
    """Return the realised current, averaged over the ship's draught."""
    env = scenario.environment
    factor = 1.0
    if env.current_profile:
        depth, share = np.array(env.current_profile).T
        factor = mean_factor(depth, share, scenario.vessel.draught_m)
    return realise_current(
        factor * env.current_speed_m_s,
        yaw_from_heading(env.current_direction_to_deg),
        factor * env.current_deviation_m_s,
        env.current_time_constant_s,
        scenario.duration_s,
        stream(scenario, CURRENT),
    )


def table_warnings(scenario: Scenario) -> list[str]:
    """Return what a user should know of a sea that reaches beyond the frequencies of the hull's database."""
    data = build.hydro_database(scenario)
    waves = sea(scenario)
    if not len(waves.amplitude):
        return []
    told = []
    sides = ("below", "held at its end"), ("above", "excitation falling with the square of the frequency, drift held")
    for share, (side, rule) in zip(outside_shares(waves, data.omega), sides, strict=True):
        if share > OUTSIDE_SHARE_MAX:
            told.append(
                f"{100 * share:.1f} % of the waves' energy lies {side} the frequencies of the hull's database "
                f"({data.omega[0]:g} to {data.omega[-1]:g} rad/s), which is continued there: {rule}"
            )
    return told
