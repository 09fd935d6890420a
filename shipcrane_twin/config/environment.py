"""Settings of sea, wind and current; directions are towards, clockwise from north."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len

from shipcrane_twin.config.settings import Flag, Number, Text, settings

NotNegative = Annotated[Number, Ge(0)]
Positive = Annotated[Number, Gt(0)]

WAVE_KEYS = {
    "regular": {"height_m", "period_s"},
    "jonswap": {"significant_wave_height_m", "peak_period_s", "peak_enhancement"},
    "pierson_moskowitz": {"significant_wave_height_m", "peak_period_s"},
    "torsethaugen": {"significant_wave_height_m", "peak_period_s"},
    "table": {"spectrum_file"},
}
"""Keys that each spectrum needs beside its direction."""


@settings
class WaveSystemConfig:
    """One wave system: wind sea, swell, or a regular wave.

    ``spreading_exponent`` is s of cos^2s of half the angle; without it the waves are long-crested. A
    ``spectrum_file`` has two columns, frequency [rad/s] and density [m2 s/rad].
    """

    spectrum: Literal["regular", "jonswap", "pierson_moskowitz", "torsethaugen", "table"]
    direction_to_deg: Number
    height_m: Positive | None = None
    period_s: Positive | None = None
    significant_wave_height_m: Positive | None = None
    peak_period_s: Positive | None = None
    peak_enhancement: Annotated[Number, Ge(1), Le(10)] | None = None
    spreading_exponent: Annotated[Number, Ge(0), Le(200)] | None = None
    spectrum_file: Text | None = None


@settings
class WavesConfig:
    """The sea and which of its loads act.

    ``slow_motion_period_s`` is that of the filter that keeps the ship's own motion at wave frequency out of the place
    and heading at which the waves act (their mean effect is the drift load); 0 takes the ship's momentary pose.
    ``kurtosis_error`` is how far the elevation's excess kurtosis may be from a Gaussian sea's zero; it
    sets the number of components, 1.5 over it.
    """

    systems: Annotated[tuple[WaveSystemConfig, ...], Len(0, 8)]
    ramp_s: NotNegative
    kurtosis_error: Annotated[Number, Ge(0.00075), Le(0.075)]
    slow_motion_period_s: NotNegative
    first_order: Flag
    slow_drift: Flag


@settings
class EnvironmentConfig:
    """Sea, wind and current.

    Wind speed is the mean over an hour at 10 m. Each row of ``current_profile`` is a depth [m] and the share of
    the surface speed there; without it the speed is the same at all depths. No ``water_depth_m`` is deep water.
    """

    water_depth_m: Positive | None = None
    waves: WavesConfig
    current_speed_m_s: Annotated[Number, Ge(0), Le(10)]
    current_direction_to_deg: Number
    current_deviation_m_s: Annotated[Number, Ge(0), Le(2)]
    current_time_constant_s: Positive
    current_profile: tuple[tuple[NotNegative, Annotated[Number, Ge(0), Le(2)]], ...] = ()
    wind_speed_m_s: Annotated[Number, Ge(0), Le(100)]
    wind_direction_to_deg: Number
    wind_gusts: Literal["none", "froya", "harris"]
