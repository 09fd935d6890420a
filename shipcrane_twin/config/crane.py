"""Settings of the crane and its servos."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len

from shipcrane_twin.config.settings import Number, Row6, Text, Vector3, settings

Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]


@settings
class DriveConfig:
    """What moves a joint; ``accel_max`` and ``effort_max`` are in the joint's own units.

    ``servo_frequency_hz`` is the natural frequency of the joint alone on its oil, at the initial posture.

    ``motor``: no ends. ``cylinder``: joint = length + offset. ``triangle``: a cylinder opposite the
    angle between two fixed sides, ``joint = acos((a^2 + b^2 - length^2) / (2 a b)) + offset``.
    """

    kind: Literal["motor", "cylinder", "triangle"]
    accel_max: Positive
    effort_max: Positive
    servo_frequency_hz: Annotated[Number, Gt(0), Le(20)]
    speed_max_rad_s: Positive | None = None
    speed_max_m_s: Positive | None = None
    side_a_m: Positive | None = None
    side_b_m: Positive | None = None
    offset_rad: Number | None = None
    offset_m: Number | None = None
    length_min_m: Positive | None = None
    length_max_m: Positive | None = None
    end_margin_m: NotNegative | None = None

    def __post_init__(self) -> None:
        """Require just the keys that belong to the kind."""
        stroke = {"speed_max_m_s", "length_min_m", "length_max_m", "end_margin_m"}
        needed = {
            "motor": {"speed_max_rad_s"},
            "cylinder": {*stroke, "offset_m"},
            "triangle": {*stroke, "side_a_m", "side_b_m", "offset_rad"},
        }[self.kind]
        for name in ("speed_max_rad_s", "side_a_m", "side_b_m", "offset_rad", "offset_m", *sorted(stroke)):
            if (getattr(self, name) is not None) != (name in needed):
                raise ValueError(f"for kind {self.kind} the keys {', '.join(sorted(needed))} and none else; see {name}")

    @property
    def speed_max(self) -> float:
        """Actuator speed [rad/s for a motor, m/s for a cylinder]."""
        speed = self.speed_max_rad_s if self.kind == "motor" else self.speed_max_m_s
        assert speed is not None  # __post_init__ saw to it
        return speed


@settings
class LinkConfig:
    """One joint and the link it moves, modified (Craig) D-H; CoG and inertia in the link's own frame.

    The joint's value adds to ``theta_deg`` (revolute) or ``d_m`` (prismatic).
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


@settings
class TipConfig:
    """The fixed frame of the crane tip, a last D-H row."""

    a_m: Number
    alpha_deg: Number
    d_m: Number
    theta_deg: Number


@settings
class ServoConfig:
    """Joint servos: what all of them share."""

    damping_ratio: Positive
    micro_step_max_ms: Annotated[Number, Gt(0), Le(50)]


@settings
class CraneConfig:
    """The crane on deck; ``base_m`` from aft perpendicular, centre line and baseline."""

    name: Text
    base_m: Vector3
    links: Annotated[tuple[LinkConfig, ...], Len(1)]
    tip: TipConfig
    servo: ServoConfig
    initial_joints: Annotated[tuple[Number, ...], Len(1)]
