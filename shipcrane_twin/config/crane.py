"""Settings of the crane, its drives and limits."""

import math
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len

from shipcrane_twin.config.settings import Flag, Number, Row6, Text, Vector3, settings

Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]


MOTOR = {
    "speed_max_rad_s",
    "accel_max_rad_s2",
    "jerk_max_rad_s3",
    "torque_max_n_m",
    "brake_torque_n_m",
    "friction_n_m",
    "stiffness_n_m_per_rad",
    "leak_rad_per_s_n_m",
}
CYLINDER = {
    "speed_max_m_s",
    "accel_max_m_s2",
    "jerk_max_m_s3",
    "length_min_m",
    "length_max_m",
    "end_margin_m",
    "bore_m",
    "rod_m",
    "pressure_max_pa",
    "holding_pressure_pa",
    "friction_n",
    "stiffness_n_per_m",
    "leak_m3_per_s_pa",
}
DRIVE_KEYS = {
    "motor": MOTOR,
    "cylinder": CYLINDER | {"offset_m"},
    "triangle": CYLINDER | {"side_a_m", "side_b_m", "offset_rad"},
}
"""The keys that belong to each kind of drive."""


@settings
class DriveConfig:
    """What moves a joint; all but ``offset_rad`` in the actuator's own units.

    ``motor``: no ends. ``cylinder``: joint = length + offset. ``triangle``: a cylinder opposite the
    angle between two fixed sides, ``joint = acos((a^2 + b^2 - length^2) / (2 a b)) + offset``.

    ``stiffness_...``: of the oil column. ``damping_time_s``: its damping over its stiffness. ``holding_pressure_pa``,
    ``brake_torque_n_m``: what load-holding valve and brake stand. ``friction_...``: of the drive without power.
    ``leak_...``: flow over pressure (turn over torque) past a failed load-holding valve.
    """

    kind: Literal["motor", "cylinder", "triangle"]
    damping_time_s: Positive
    speed_max_rad_s: Positive | None = None
    accel_max_rad_s2: Positive | None = None
    jerk_max_rad_s3: Positive | None = None
    torque_max_n_m: Positive | None = None
    brake_torque_n_m: Positive | None = None
    friction_n_m: Positive | None = None
    stiffness_n_m_per_rad: Positive | None = None
    leak_rad_per_s_n_m: Positive | None = None
    speed_max_m_s: Positive | None = None
    accel_max_m_s2: Positive | None = None
    jerk_max_m_s3: Positive | None = None
    side_a_m: Positive | None = None
    side_b_m: Positive | None = None
    offset_rad: Number | None = None
    offset_m: Number | None = None
    length_min_m: Positive | None = None
    length_max_m: Positive | None = None
    end_margin_m: NotNegative | None = None
    bore_m: Positive | None = None
    rod_m: Positive | None = None
    pressure_max_pa: Positive | None = None
    holding_pressure_pa: Positive | None = None
    friction_n: Positive | None = None
    stiffness_n_per_m: Positive | None = None
    leak_m3_per_s_pa: Positive | None = None

    def __post_init__(self) -> None:
        """Require just the keys that belong to the kind."""
        needed = DRIVE_KEYS[self.kind]
        for name in sorted(set().union(*DRIVE_KEYS.values())):
            if (getattr(self, name) is not None) != (name in needed):
                raise ValueError(f"for kind {self.kind} the keys {', '.join(sorted(needed))} and none else; see {name}")
        if self.rod_m is not None and self.bore_m is not None and self.rod_m >= self.bore_m:
            raise ValueError(f"a rod_m smaller than bore_m; found {self.rod_m:g} and {self.bore_m:g}")

    def of_kind(self, for_motor: str, for_cylinder: str) -> float:
        """Return the value of the one of two keys that belongs to this kind."""
        value = getattr(self, for_motor if self.kind == "motor" else for_cylinder)
        assert value is not None  # __post_init__ saw to it
        return float(value)

    @property
    def speed_max(self) -> float:
        """Actuator speed [rad/s for a motor, m/s for a cylinder]."""
        return self.of_kind("speed_max_rad_s", "speed_max_m_s")

    @property
    def areas(self) -> tuple[float, float]:
        """Areas [m2] on which the pressure pushes and pulls: bore, and bore less rod; (1, 1) for a motor's torque."""
        if self.bore_m is None or self.rod_m is None:
            return 1.0, 1.0
        return 0.25 * math.pi * self.bore_m**2, 0.25 * math.pi * (self.bore_m**2 - self.rod_m**2)


@settings
class SegmentConfig:
    """A telescope segment that extends before its link does, in the link's frame at zero extension."""

    mass_kg: Positive
    cog_m: Vector3
    inertia_kg_m2: Row6
    stroke_m: Positive


@settings
class LinkConfig:
    """One joint and the link it moves, modified (Craig) D-H; CoG and inertia in the link's own frame.

    The joint's value adds to ``theta_deg`` (revolute) or ``d_m`` (prismatic). Of a telescope, the link is the last
    segment, which carries the tip; ``segments`` are those before it, the outermost first.
    """

    joint: Text
    kind: Literal["revolute", "prismatic"]
    a_m: Number
    alpha_deg: Number
    d_m: Number
    theta_deg: Number
    mass_kg: Positive
    cog_m: Vector3
    inertia_kg_m2: Row6
    drive: DriveConfig
    segments: tuple[SegmentConfig, ...] = ()


@settings
class TipConfig:
    """The fixed frame of the crane tip, a last D-H row."""

    a_m: Number
    alpha_deg: Number
    d_m: Number
    theta_deg: Number


@settings
class ServoConfig:
    """Joint servos: what all of them share; a tip command counts for ``tip_command_timeout_s`` of simulated time."""

    tracking_rate_1_s: Annotated[Number, Gt(0), Le(4)]
    micro_step_max_ms: Annotated[Number, Gt(0), Le(50)]
    tip_command_timeout_s: Positive


@settings
class LoadLimiterConfig:
    """Overload limiter: levels are hook load over safe working load; ``filter_s`` smooths the hook load."""

    enabled: Flag
    warning: Positive
    cut_out: Positive
    release: Positive
    filter_s: Positive

    def __post_init__(self) -> None:
        """Require the order of the levels."""
        if not self.warning < self.release < self.cut_out:
            raise ValueError(
                f"warning < release < cut_out; found {self.warning:g}, {self.release:g} and {self.cut_out:g}"
            )


@settings
class CraneConfig:
    """The crane on deck; ``base_m`` from aft perpendicular, centre line and baseline.

    ``load_chart``: radius from the slew axis [m] and safe working load [kg], hook included.
    """

    name: Text
    base_m: Vector3
    links: Annotated[tuple[LinkConfig, ...], Len(1)]
    tip: TipConfig
    segment_handover_m: Positive
    servo: ServoConfig
    load_chart: Annotated[tuple[tuple[NotNegative, Positive], ...], Len(2)]
    load_limiter: LoadLimiterConfig
    initial_joints: Annotated[tuple[Number, ...], Len(1)]
