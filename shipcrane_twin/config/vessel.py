"""Settings of the ship: hull, wind areas, thrusters and dynamic positioning."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le, Len

from shipcrane_twin.config.settings import Flag, Matrix6, Number, Text, Vector3, settings

Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]
CurrentRow = tuple[Number, Number, Number, Number]
WindRow = tuple[Number, Number, Number, Number, Number]


@settings
class HullConfig:
    """Water loads about the CoG; matrices in forward-right-down axes, SI units, as ship data has them."""

    added_mass_frd: Matrix6
    damping_frd: Matrix6
    restoring_frd: Matrix6
    roll_quadratic_n_m_s2: NotNegative
    yaw_quadratic_n_m_s2: NotNegative
    current_front_area_m2: Positive
    current_side_area_m2: Positive
    current_table: Annotated[tuple[CurrentRow, ...], Len(2)]

    def __post_init__(self) -> None:
        """Refuse matrices that no hull can have."""
        for name in ("added_mass_frd", "damping_frd", "restoring_frd"):
            matrix = np.array(getattr(self, name))
            if not np.allclose(matrix, matrix.T, rtol=1e-6, atol=1e-6 * np.abs(matrix).max()):
                raise ValueError(f"a symmetric matrix in {name}")
            if np.linalg.eigvalsh(matrix).min() < -1e-9 * np.abs(matrix).max():
                raise ValueError(f"a matrix without negative eigenvalues in {name}")
        check_directions("current_table", self.current_table)


@settings
class WindAreasConfig:
    """Wind areas and coefficients; 0 degrees is head wind."""

    front_area_m2: Positive
    side_area_m2: Positive
    table: Annotated[tuple[WindRow, ...], Len(2)]

    def __post_init__(self) -> None:
        """Refuse a table that is not uniform from 0 to 180 degrees."""
        check_directions("table", self.table)


@settings
class ThrusterConfig:
    """One thruster; a tunnel thruster pushes sideways only."""

    name: Text
    position_m: Vector3
    thrust_max_n: Positive
    azimuthing: Flag


@settings
class InitialConfig:
    """Where the ship is at t = 0; heave, roll and pitch are in equilibrium with crane and load."""

    north_m: Number
    east_m: Number
    heading_deg: Number


@settings
class VesselConfig:
    """The ship; positions from aft perpendicular, centre line and baseline (x forward, y port, z up)."""

    name: Text
    length_m: Positive
    draught_m: Positive
    mass_kg: Positive
    cog_m: Vector3
    inertia_kg_m2: tuple[Positive, Positive, Positive]
    hull: HullConfig
    wind_areas: WindAreasConfig
    thruster_time_constant_s: Positive
    thrusters: Annotated[tuple[ThrusterConfig, ...], Len(1)]
    initial: InitialConfig


@settings
class SetpointConfig:
    """Wanted position of the CoG and heading."""

    north_m: Number
    east_m: Number
    heading_deg: Number


@settings
class DpConfig:
    """Dynamic positioning; three values are surge, sway, yaw."""

    enabled_at_s: NotNegative
    settled_after_s: NotNegative
    period_ms: Positive
    natural_period_s: tuple[Positive, Positive, Positive]
    damping_ratio: tuple[Positive, Positive, Positive]
    load_max: tuple[Positive, Positive, Positive]
    reference_speed_max_m_s: Positive
    reference_accel_max_m_s2: Positive
    reference_turn_max_deg_s: Annotated[Number, Gt(0), Le(10)]
    reference_turn_accel_max_deg_s2: Annotated[Number, Gt(0), Le(10)]
    setpoint: SetpointConfig


def check_directions(name: str, rows: tuple[tuple[float, ...], ...]) -> None:
    """Raise ValueError unless the first column runs uniformly from 0 to 180 degrees."""
    column = [row[0] for row in rows]
    if not np.allclose(column, np.linspace(0.0, 180.0, len(rows))):
        raise ValueError(f"directions from 0 to 180 degrees in equal steps in the first column of {name}")
