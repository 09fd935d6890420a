"""Settings of dynamic positioning: sensors, observer, reference, controller, allocation."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from shipcrane_twin.config.settings import Flag, Number, Vector3, Whole, settings

Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]
Share = Annotated[Number, Ge(0), Le(1)]
Positive3 = tuple[Positive, Positive, Positive]
Samples = Annotated[Whole, Ge(0), Le(100)]


@settings
class PositionSensorConfig:
    """Position reference (GNSS): white noise and a drifting bias per horizontal axis; its antenna in base_link."""

    noise_std_m: NotNegative
    bias_std_m: NotNegative
    bias_time_constant_s: Positive
    period_ms: Positive
    delay_samples: Samples
    antenna_m: Vector3


@settings
class GyroConfig:
    """Gyro compass."""

    noise_std_deg: NotNegative
    bias_std_deg: NotNegative
    bias_time_constant_s: Positive
    period_ms: Positive
    delay_samples: Samples


@settings
class MruConfig:
    """Motion reference unit: roll, pitch, rates and specific force at its place in base_link."""

    angle_noise_std_deg: NotNegative
    rate_noise_std_deg_s: NotNegative
    force_noise_std_m_s2: NotNegative
    period_ms: Positive
    delay_samples: Samples
    place_m: Vector3


@settings
class WindSensorConfig:
    """Anemometer: relative wind at its place in base_link."""

    speed_noise_std_m_s: NotNegative
    direction_noise_std_deg: NotNegative
    period_ms: Positive
    delay_samples: Samples
    place_m: Vector3


@settings
class SensorsConfig:
    """The ship's sensors; `perfect` measures the truth without noise, bias and delay at every update."""

    perfect: Flag
    position: PositionSensorConfig
    gyro: GyroConfig
    mru: MruConfig
    wind: WindSensorConfig


@settings
class PassiveConfig:
    """Nonlinear passive observer; three values are surge, sway, yaw (of position: north and east alike)."""

    cutoff_ratio: Positive3
    notch_damping: Positive3
    bias_period_s: Positive3
    bias_damping: Positive3


@settings
class EkfConfig:
    """Extended Kalman filter: what it believes of the measurements and of what it does not know."""

    position_std_m: Positive
    heading_std_deg: Positive
    force_noise_n_sqrt_s: Positive
    moment_noise_n_m_sqrt_s: Positive
    force_walk_n_per_sqrt_s: Positive
    moment_walk_n_m_per_sqrt_s: Positive
    wave_std_m: Positive
    wave_std_deg: Positive


@settings
class ObserverConfig:
    """Observer and wave filter; `none` hands the measurements on."""

    kind: Literal["passive", "ekf", "none"]
    wave_period_s: Positive
    adaptive: Flag
    wave_damping: Positive
    bias_time_constant_s: Positive
    lost_after_s: Positive
    return_s: Positive
    passive: PassiveConfig
    ekf: EkfConfig


@settings
class ReferenceConfig:
    """Reference model: limits of the way to a set-point."""

    speed_max_m_s: Positive
    accel_max_m_s2: Positive
    turn_max_deg_s: Annotated[Number, Gt(0), Le(10)]
    turn_accel_max_deg_s2: Annotated[Number, Gt(0), Le(10)]
    smoothing_s: Positive
    together: Flag


@settings
class ControllerConfig:
    """PID in body axes with feed-forward; three values are surge, sway, yaw."""

    natural_period_s: Positive3
    damping_ratio: Positive3
    load_max: Positive3
    wind_share: Share
    wind_cutoff_period_s: NotNegative
    crane_share: Share
    crane_cutoff_period_s: NotNegative
    fade_s: Positive


@settings
class AllocationConfig:
    """Thrust allocation; azimuths push against each other with ``bias_thrust_n`` while little is asked of them."""

    method: Literal["qp", "pseudo_inverse"]
    priority: Literal["yaw", "position"]
    thrust_rate_max_share: Annotated[Number, Gt(0), Le(10)]
    hold_thrust_n: NotNegative
    bias_thrust_n: NotNegative


@settings
class WeathervaneConfig:
    """Weather-optimal heading: the heading set-point turns until little sway thrust is needed."""

    enabled: Flag
    rate_max_deg_s: Positive
    full_load_n: Positive
    cutoff_period_s: Positive


@settings
class SetpointConfig:
    """Wanted position of the CoG and heading."""

    north_m: Number
    east_m: Number
    heading_deg: Number


@settings
class TimedSetpointConfig:
    """A set-point from a time on."""

    at_s: NotNegative
    north_m: Number
    east_m: Number
    heading_deg: Number


@settings
class DpConfig:
    """Dynamic positioning."""

    enabled_at_s: NotNegative
    settled_after_s: NotNegative
    period_ms: Positive
    sensors: SensorsConfig
    observer: ObserverConfig
    reference: ReferenceConfig
    controller: ControllerConfig
    allocation: AllocationConfig
    weathervane: WeathervaneConfig
    setpoint: SetpointConfig
    setpoints: tuple[TimedSetpointConfig, ...] = ()
