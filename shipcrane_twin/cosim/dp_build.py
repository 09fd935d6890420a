"""From settings to the constants of dynamic positioning and of the thrusters."""

from collections.abc import Collection

import numpy as np

from shipcrane_twin.config.dp import DpConfig, SensorsConfig
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.allocation_setup import AllocationParams, allocation_params, opposing_bias
from shipcrane_twin.control.controller import ControllerParams, pid_gains
from shipcrane_twin.control.ekf import EkfParams, ekf_params
from shipcrane_twin.control.loop import horizontal
from shipcrane_twin.control.observer import PassiveParams, passive_params
from shipcrane_twin.control.reference import ReferenceParams
from shipcrane_twin.control.wave_frequency import FrequencyParams, frequency_params
from shipcrane_twin.control.weathervane import WeathervaneParams
from shipcrane_twin.cosim import build
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.propeller import PropulsionParams, bollard_coefficients
from shipcrane_twin.physics.sensors import (
    GYRO_KINDS,
    MRU_KINDS,
    POSITION_KINDS,
    WIND_KINDS,
    SensorParams,
    perfect_sensor,
    sensor_params,
)

DECAY_S = 300.0
"""Time constant with which the observers' ship loses speed where the hull has no linear damping [s]: a little keeps
their model from drifting, and the bias takes up the difference."""

WAVE_PERIODS_S = (3.0, 25.0)
"""Range of the estimated wave period [s]."""

HEAVE_CORNER = 0.15
"""Below this frequency the heave that tells the waves' frequency fades [rad/s]."""

FREQUENCY_MEMORY_S, FREQUENCY_FLOOR_M = 120.0, 0.02
VELOCITY_START_STD = (0.2, 0.2, 0.005)
"""What the Kalman filter believes of the velocity at its start [m/s, m/s, rad/s]."""


def seconds_of(period_ms: float) -> float:
    """Return a period in seconds."""
    return period_ms * 1e-3


def ship_3dof(scenario: Scenario) -> tuple[Array, Array]:
    """Return mass with low-frequency added mass and linear damping (3, 3) in surge, sway, yaw."""
    data = build.hydro_database(scenario)
    params = build.vessel_params(scenario)
    mass = horizontal(params.rigid_mass + data.added_mass[0])
    damping = horizontal(params.hull.damping)
    return mass, damping + np.diag(np.maximum(0.0, np.diag(mass) / DECAY_S - np.diag(damping)))


def propulsion_params(scenario: Scenario) -> PropulsionParams:
    """Return the thrusters' constants, positions seen from the CoG."""
    vessel = scenario.vessel
    density = scenario.constants.water_density_kg_m3

    def each(key: str, factor: float = 1.0) -> Array:
        return factor * np.array([getattr(thruster, key) for thruster in vessel.thrusters], dtype=np.float64)

    per_minute = 1.0 / 60.0
    speed_max, power_max = each("shaft_speed_max_rpm", per_minute), each("power_max_kw", 1e3)
    diameter, deduction = each("diameter_m"), each("thrust_deduction")
    thrust, torque = bollard_coefficients(
        each("thrust_max_n"), power_max, diameter, speed_max, deduction, density
    )
    return PropulsionParams(
        position=np.array([t.position_m for t in vessel.thrusters]) - np.array(vessel.cog_m),
        azimuthing=each("azimuthing"),
        diameter=diameter,
        thrust_coefficient=thrust,
        torque_coefficient=torque,
        deduction=deduction,
        zero_thrust_advance=each("zero_thrust_advance"),
        zero_torque_advance=each("zero_torque_advance"),
        speed_max=speed_max,
        speed_rate_max=each("shaft_accel_max_rpm_s", per_minute),
        speed_lag=each("shaft_lag_s"),
        power_max=power_max,
        torque_max=power_max / (2.0 * np.pi * speed_max),
        rundown_lag=each("rundown_lag_s"),
        azimuth_rate_max=each("azimuth_rate_max_deg_s", np.pi / 180.0),
        azimuth_lag=each("azimuth_lag_s"),
        power_total_max=vessel.power_total_max_kw * 1e3,
        water_density=density,
    )


def allocation_of(
    scenario: Scenario, thrusters: PropulsionParams, stopped: Collection[str] = ()
) -> AllocationParams:
    """Return the allocation's constants; what protects a stopped thruster is not forbidden."""
    config = scenario.dp.allocation
    vessel = scenario.vessel
    thrust_max = np.array([t.thrust_max_n for t in vessel.thrusters])
    steers = thrusters.azimuthing != 0.0
    hold = np.where(steers, config.hold_thrust_n, 0.0)
    return allocation_params(
        position=thrusters.position,
        azimuthing=thrusters.azimuthing,
        axis=np.full(len(thrust_max), 0.5 * np.pi),
        thrust_max=thrust_max,
        power_max=thrusters.power_max,
        azimuth_rate_max=thrusters.azimuth_rate_max,
        azimuth_lag=thrusters.azimuth_lag,
        thrust_rate_max=config.thrust_rate_max_share * thrust_max,
        period=seconds_of(scenario.dp.period_ms),
        forbidden=[
            [(np.deg2rad(z.centre_deg), np.deg2rad(z.half_width_deg)) for z in t.forbidden if z.protects not in stopped]
            for t in vessel.thrusters
        ],
        bias=opposing_bias(thrusters.position, thrusters.azimuthing, config.bias_thrust_n),
        hold_thrust=hold,
        yaw_first=config.priority == "yaw",
        method=config.method,
    )


def reference_of(dp: DpConfig) -> ReferenceParams:
    """Return the reference model's constants."""
    limits = dp.reference
    turn, turn_accel = np.deg2rad([limits.turn_max_deg_s, limits.turn_accel_max_deg_s2])
    return ReferenceParams(
        speed_max=np.array([limits.speed_max_m_s, turn]),
        accel_max=np.array([limits.accel_max_m_s2, turn_accel]),
        smoothing=limits.smoothing_s,
        share_time=float(limits.together),
        period=seconds_of(dp.period_ms),
    )


def controller_of(dp: DpConfig, mass: Array) -> ControllerParams:
    """Return the controller's constants; gains from natural periods and damping ratios."""
    config = dp.controller
    stiffness, damping, integral = pid_gains(
        np.diag(mass).copy(), np.array(config.natural_period_s), np.array(config.damping_ratio)
    )
    return ControllerParams(
        inertia=mass,
        stiffness=stiffness,
        damping=damping,
        integral=integral,
        load_max=np.array(config.load_max),
        wind_share=config.wind_share,
        wind_period=config.wind_cutoff_period_s,
        crane_share=config.crane_share,
        crane_period=config.crane_cutoff_period_s,
        fade=config.fade_s,
        period=seconds_of(dp.period_ms),
    )


def passive_of(dp: DpConfig, mass: Array, damping: Array) -> PassiveParams:
    """Return the passive observer's constants."""
    config, tuning = dp.observer, dp.observer.passive
    same = np.ones(3)
    position_s = seconds_of(dp.period_ms if dp.sensors.perfect else dp.sensors.position.period_ms)
    gyro_s = seconds_of(dp.period_ms if dp.sensors.perfect else dp.sensors.gyro.period_ms)
    return passive_params(
        mass,
        damping,
        seconds_of(dp.period_ms),
        wave_frequency=2.0 * np.pi / config.wave_period_s * same,
        wave_damping=config.wave_damping * same,
        notch_damping=np.array(tuning.notch_damping),
        cutoff_ratio=np.array(tuning.cutoff_ratio),
        bias_period_s=np.array(tuning.bias_period_s),
        bias_damping=np.array(tuning.bias_damping),
        bias_time_constant_s=config.bias_time_constant_s * same,
        sample_period_s=np.array([position_s, position_s, gyro_s]),
        lost_after_s=config.lost_after_s,
        return_s=config.return_s,
    )


def ekf_of(dp: DpConfig, mass: Array, damping: Array) -> EkfParams:
    """Return the Kalman filter's constants."""
    config, tuning = dp.observer, dp.observer.ekf
    heading, wave_heading = np.deg2rad([tuning.heading_std_deg, tuning.wave_std_deg])
    walk = np.array([tuning.force_walk_n_per_sqrt_s] * 2 + [tuning.moment_walk_n_m_per_sqrt_s])
    return ekf_params(
        mass,
        damping,
        seconds_of(dp.period_ms),
        wave_frequency=np.full(3, 2.0 * np.pi / config.wave_period_s),
        wave_damping=np.full(3, config.wave_damping),
        wave_std=np.array([tuning.wave_std_m, tuning.wave_std_m, wave_heading]),
        measurement_std=np.array([tuning.position_std_m, tuning.position_std_m, heading]),
        load_noise=np.array([tuning.force_noise_n_sqrt_s] * 2 + [tuning.moment_noise_n_m_sqrt_s]),
        bias_walk=walk,
        bias_time_constant_s=np.full(3, config.bias_time_constant_s),
        velocity_start_std=np.array(VELOCITY_START_STD),
        bias_start_std=walk * np.sqrt(config.bias_time_constant_s),
        lost_after_s=config.lost_after_s,
        return_s=config.return_s,
    )


def frequency_of(dp: DpConfig) -> FrequencyParams:
    """Return the constants of the wave frequency's estimator."""
    shortest, longest = WAVE_PERIODS_S
    return frequency_params(
        seconds_of(dp.period_ms),
        nominal=2.0 * np.pi / dp.observer.wave_period_s,
        lowest=2.0 * np.pi / longest,
        highest=2.0 * np.pi / shortest,
        memory_s=FREQUENCY_MEMORY_S,
        floor=FREQUENCY_FLOOR_M,
    )


def weathervane_of(dp: DpConfig) -> WeathervaneParams:
    """Return the constants of the weather-optimal heading."""
    config = dp.weathervane
    return WeathervaneParams(
        rate_max=float(np.deg2rad(config.rate_max_deg_s)),
        full_load=config.full_load_n,
        cutoff_period=config.cutoff_period_s,
        period=seconds_of(dp.period_ms),
    )


def sensors_of(sensors: SensorsConfig, update_s: float) -> dict[str, SensorParams]:
    """Return the constants of position reference, gyro, motion reference unit and wind sensor."""
    kinds = {"position": POSITION_KINDS, "gyro": GYRO_KINDS, "mru": MRU_KINDS, "wind": WIND_KINDS}
    if sensors.perfect:
        return {name: perfect_sensor(kind) for name, kind in kinds.items()}
    position, gyro, mru, wind = sensors.position, sensors.gyro, sensors.mru, sensors.wind
    angle, rate = np.deg2rad([mru.angle_noise_std_deg, mru.rate_noise_std_deg_s])
    noise = {
        "position": [position.noise_std_m] * 2,
        "gyro": [np.deg2rad(gyro.noise_std_deg)],
        "mru": [angle] * 2 + [rate] * 3 + [mru.force_noise_std_m_s2] * 3,
        "wind": [wind.speed_noise_std_m_s, np.deg2rad(wind.direction_noise_std_deg)],
    }
    bias = {"position": ([position.bias_std_m] * 2, position.bias_time_constant_s)}
    bias["gyro"] = ([np.deg2rad(gyro.bias_std_deg)], gyro.bias_time_constant_s)
    made = {}
    for name, kind in kinds.items():
        config = getattr(sensors, name)
        std, memory_s = bias.get(name, ([0.0] * kind.size, np.inf))
        sample_s = seconds_of(config.period_ms)
        made[name] = sensor_params(
            kind,
            update_s,
            noise_std=np.array(noise[name]),
            offset=np.zeros(kind.size),
            bias_std=np.array(std),
            bias_time_constant_s=memory_s,
            sample_period_s=sample_s,
            delay_s=config.delay_samples * sample_s,
        )
    return made
