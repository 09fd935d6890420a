"""Settings of the wire, the winch and the load."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le

from shipcrane_twin.config.crane import NotNegative, Positive
from shipcrane_twin.config.settings import Number, Text, Vector3, Whole, settings


@settings
class WireConfig:
    """The hoisting wire; ``sheave_friction`` is that of all sheaves between drum and crane tip, a share of the pull."""

    elastic_modulus_pa: Positive
    diameter_m: Positive
    fill_factor: Annotated[Number, Gt(0), Le(1)]
    damping_ratio: Annotated[Number, Ge(0), Le(5)]
    mass_kg_m: NotNegative
    sheave_friction: Annotated[Number, Ge(0), Le(0.5)]
    phase_max_rad: Annotated[Number, Gt(0), Le(1)]
    micro_step_max_ms: Annotated[Number, Gt(0), Le(20)]


@settings
class DrumConfig:
    """The drum, what turns it and what holds it.

    ``wire_length_m`` is all wire from the drum to the hook; ``motor_torque_n_m`` and ``motor_inertia_kg_m2`` are those
    on the motor's side of the gear, the other torques and inertias those at the drum. ``drift_speed_m_s`` is how
    fast a failed hydraulic motor gives way to the pull that it held at full torque.
    """

    core_diameter_m: Positive
    turns_per_layer: Annotated[Whole, Ge(1), Le(1000)]
    wire_length_m: Positive
    gear_ratio: Positive
    motor_torque_n_m: Positive
    motor_inertia_kg_m2: Positive
    drum_inertia_kg_m2: Positive
    brake_torque_n_m: Positive
    drag_torque_n_m: NotNegative
    drift_speed_m_s: Positive


@settings
class WinchConfig:
    """The winch."""

    initial_length_m: Positive
    length_min_m: Positive
    length_max_m: Positive
    speed_max_m_s: Positive
    accel_max_m_s2: Positive
    jerk_max_m_s3: Positive
    drum: DrumConfig


@settings
class SlingConfig:
    """Two legs from the hook to two lugs on the middle line of the box, ``lug_height_m`` above its middle."""

    lug_distance_m: Positive
    lug_height_m: NotNegative
    leg_length_m: Positive
    leg_stiffness_n_m: Positive

    def __post_init__(self) -> None:
        """Require legs that reach from lug to lug."""
        if 2.0 * self.leg_length_m <= self.lug_distance_m:
            raise ValueError(
                f"leg_length_m above half of lug_distance_m = {self.lug_distance_m:g}; lengthen the legs"
            )


@settings
class ContactConfig:
    """How the corners of the box touch: stiffness of one corner, restitution (see `physics.contact`), dry friction."""

    stiffness_n_m: Positive
    loss_s_m: NotNegative
    friction: Annotated[Number, Ge(0), Le(2)]


@settings
class PlaneConfig:
    """A level rectangle on which the box may lie.

    ``centre_m`` is from aft perpendicular, centre line and baseline on the ship, else east, north and up from still
    water; ``heading_deg`` is where its length points, clockwise from the bow on the ship, else from north. A supply
    deck heaves: ``amplitude sin(2 pi t / period + phase)``.
    """

    label: Text
    moves_with: Literal["ship", "ground", "supply"]
    centre_m: Vector3
    length_m: Positive
    breadth_m: Positive
    heading_deg: Number
    heave_amplitude_m: Positive | None = None
    heave_period_s: Positive | None = None
    heave_phase_deg: Number | None = None

    def __post_init__(self) -> None:
        """Require the heave of a supply deck and of nothing else."""
        for name in ("heave_amplitude_m", "heave_period_s", "heave_phase_deg"):
            if (getattr(self, name) is not None) != (self.moves_with == "supply"):
                raise ValueError(f"{name} for a plane on a supply ship and for no other")


@settings
class BoxConfig:
    """The load as a rigid box of even density; ``cog_m`` is its CoG from its middle along length, breadth and height.

    ``heading_deg`` is where its length points at the start. ``displaced_share`` of its volume displaces water,
    ``perforation`` is the open share of its faces. ``rests_on`` is the label of the plane where it lies at the start.
    """

    length_m: Positive
    breadth_m: Positive
    height_m: Positive
    cog_m: Vector3
    heading_deg: Number
    displaced_share: Annotated[Number, Gt(0), Le(1)]
    perforation: Annotated[Number, Ge(0), Le(0.5)]
    air_drag_coefficient: NotNegative
    drag_coefficient: NotNegative
    slamming_coefficient: Positive
    sling: SlingConfig
    contact: ContactConfig
    planes: tuple[PlaneConfig, ...] = ()
    rests_on: Text | None = None

    def __post_init__(self) -> None:
        """Require planes of different names, and one to rest on."""
        labels = [plane.label for plane in self.planes]
        if len(set(labels)) < len(labels):
            raise ValueError(f"planes with different labels, found {', '.join(labels)}")
        if self.rests_on is not None and self.rests_on not in labels:
            raise ValueError(f"rests_on among the labels of planes ({', '.join(labels) or 'none'})")


@settings
class PayloadConfig:
    """What hangs on the wire: ``mass_kg`` with the hook, ``hook_mass_kg`` after the load is released."""

    mass_kg: Positive
    hook_mass_kg: Positive
    shape: Literal["point", "box"]
    box: BoxConfig | None = None

    def __post_init__(self) -> None:
        """Require a box for the shape box and for no other."""
        if (self.box is not None) != (self.shape == "box"):
            raise ValueError("the group box with shape: box, and only then")
        if self.shape == "box" and self.hook_mass_kg >= self.mass_kg:
            raise ValueError(f"hook_mass_kg below mass_kg = {self.mass_kg:g}, which is hook and box together")


def on_ship(payload: PayloadConfig) -> bool:
    """Return whether the load may touch the ship, so that its motion has to be known."""
    return payload.box is not None and any(plane.moves_with == "ship" for plane in payload.box.planes)
