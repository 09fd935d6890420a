"""Settings of the wire, the winch and the load."""

from typing import Annotated

from annotated_types import Ge, Gt, Le

from shipcrane_twin.config.crane import NotNegative, Positive
from shipcrane_twin.config.settings import Number, Whole, settings


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
class PayloadConfig:
    """What hangs on the wire: ``mass_kg`` with the hook, ``hook_mass_kg`` after the load is released."""

    mass_kg: Positive
    hook_mass_kg: Positive
