"""Settings of the ship: hull, wind areas, thrusters."""

from typing import Annotated, Literal, TypeVar

import numpy as np
from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import AfterValidator

from shipcrane_twin.config.settings import Flag, Matrix6, Number, Text, Vector3, settings

Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]
CurrentRow = tuple[Number, Number, Number, Number]
WindRow = tuple[Number, Number, Number, Number, Number]
Rows = TypeVar("Rows", bound=tuple[tuple[float, ...], ...])


def check_directions(rows: Rows) -> Rows:
    """Raise ValueError unless the first column runs uniformly from 0 to 180 degrees."""
    if not np.allclose([row[0] for row in rows], np.linspace(0.0, 180.0, len(rows))):
        raise ValueError("directions from 0 to 180 degrees in equal steps in the first column")
    return rows


def check_matrix(rows: Rows) -> Rows:
    """Raise ValueError at a matrix that no hull can have."""
    matrix = np.array(rows)
    largest = np.abs(matrix).max()
    if not np.allclose(matrix, matrix.T, rtol=1e-6, atol=1e-6 * largest):
        raise ValueError("a symmetric matrix")
    if np.linalg.eigvalsh(matrix).min() < -1e-9 * largest:
        raise ValueError("a matrix without negative eigenvalues")
    return rows


CurrentTable = Annotated[tuple[CurrentRow, ...], Len(2), AfterValidator(check_directions)]
WindTable = Annotated[tuple[WindRow, ...], Len(2), AfterValidator(check_directions)]
HullMatrix = Annotated[Matrix6, AfterValidator(check_matrix)]


@settings
class HullConfig:
    """Water loads: potential flow from the hydrodynamic database, the rest by coefficients about the CoG, SI units."""

    hydrodynamics_file: Text
    viscous_damping_frd: HullMatrix
    roll_damping_ratio: Annotated[Number, Ge(0), Le(0.5)]
    roll_quadratic_n_m_s2: NotNegative
    cross_flow_coefficient: NotNegative
    current_front_area_m2: Positive
    current_side_area_m2: Positive
    current_table: CurrentTable


@settings
class BallastConfig:
    """Load that ballast adds: none, what levels the ship at the start, or the values given here."""

    mode: Literal["none", "level", "values"]
    heave_n: Number = 0.0
    roll_n_m: Number = 0.0
    pitch_n_m: Number = 0.0


@settings
class WindAreasConfig:
    """Wind areas and coefficients; 0 degrees is head wind."""

    front_area_m2: Positive
    side_area_m2: Positive
    table: WindTable


@settings
class ForbiddenZoneConfig:
    """A sector into which a thrust must not point, anticlockwise from forward, while another thruster works."""

    centre_deg: Number
    half_width_deg: Annotated[Number, Gt(0), Lt(180)]
    protects: Text


@settings
class ThrusterConfig:
    """One thruster; a tunnel thruster pushes sideways only, to both sides.

    ``thrust_max_n`` is what reaches the ship at full power, the ship at rest. The advance numbers J = V / (n D) are
    those at which the propeller gives no thrust and takes no torque.
    """

    name: Text
    position_m: Vector3
    azimuthing: Flag
    diameter_m: Positive
    thrust_max_n: Positive
    power_max_kw: Positive
    shaft_speed_max_rpm: Positive
    thrust_deduction: Annotated[Number, Ge(0), Lt(1)]
    zero_thrust_advance: Positive
    zero_torque_advance: Positive
    shaft_accel_max_rpm_s: Positive
    shaft_lag_s: Positive
    rundown_lag_s: Positive
    azimuth_rate_max_deg_s: Positive
    azimuth_lag_s: Positive
    forbidden: tuple[ForbiddenZoneConfig, ...] = ()


@settings
class InitialConfig:
    """Where the ship is at t = 0; heave, roll and pitch are in equilibrium with crane and load."""

    north_m: Number
    east_m: Number
    heading_deg: Number


@settings
class VesselConfig:
    """The ship; positions from aft perpendicular, centre line and baseline (x forward, y port, z up).

    Its mass is what the hull displaces (water density times the database's volume).
    """

    name: Text
    length_m: Positive
    draught_m: Positive
    cog_m: Vector3
    inertia_kg_m2: tuple[Positive, Positive, Positive]
    hull: HullConfig
    ballast: BallastConfig
    wind_areas: WindAreasConfig
    power_total_max_kw: Positive
    thrusters: Annotated[tuple[ThrusterConfig, ...], Len(1)]
    initial: InitialConfig
