"""From settings to the parameters of the kernels: units to SI, marine axes to FLU."""

import math

import numpy as np

from shipcrane_twin.config.crane import CraneConfig, DriveConfig, LinkConfig, TipConfig
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.dp import DpParams, allocation_matrix, pid_gains
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import ChainParams, make_chain
from shipcrane_twin.physics.crane_cylinders import DriveParams, LinearDrive, TriangleDrive, make_drives
from shipcrane_twin.physics.frames import flu_matrix_from_frd
from shipcrane_twin.physics.hull import HullParams
from shipcrane_twin.physics.payload import WireParams
from shipcrane_twin.physics.thrusters import ThrusterParams
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.physics.wind import WindParams


def hull_params(scenario: Scenario) -> HullParams:
    """Return the hull's coefficients about the CoG in FLU."""
    vessel = scenario.vessel
    hull = vessel.hull
    table = np.array(hull.current_table)
    table[:, 0] = np.deg2rad(table[:, 0])
    half_rho = 0.5 * scenario.constants.water_density_kg_m3
    return HullParams(
        added_mass=flu_matrix_from_frd(np.array(hull.added_mass_frd)),
        damping=flu_matrix_from_frd(np.array(hull.damping_frd)),
        restoring=flu_matrix_from_frd(np.array(hull.restoring_frd)),
        quadratic=np.array([hull.roll_quadratic_n_m_s2, hull.yaw_quadratic_n_m_s2]),
        current_table=table,
        current_scale=half_rho
        * np.array(
            [
                hull.current_front_area_m2,
                hull.current_side_area_m2,
                hull.current_side_area_m2 * vessel.length_m,
            ]
        ),
        design_height=vessel.cog_m[2] - vessel.draught_m,
    )


def vessel_params(scenario: Scenario) -> VesselParams:
    """Return the ship's constants."""
    vessel = scenario.vessel
    return VesselParams(
        rigid_mass=np.diag([vessel.mass_kg] * 3 + list(vessel.inertia_kg_m2)),
        hull=hull_params(scenario),
        cog=np.array(vessel.cog_m),
        crane_base=np.array(scenario.crane.base_m),
        gravity=scenario.constants.gravity_m_s2,
    )


def wind_params(scenario: Scenario) -> WindParams:
    """Return the ship's wind coefficients; the roll lever is side area over length (Blendermann 1994)."""
    areas, length = scenario.vessel.wind_areas, scenario.vessel.length_m
    table = np.array(areas.table)
    table[:, 0] = np.deg2rad(table[:, 0])
    side = areas.side_area_m2
    scale = 0.5 * scenario.constants.air_density_kg_m3 * np.array(
        [areas.front_area_m2, side, side * side / length, side * length]
    )
    return WindParams(table=table, scale=scale)


def thruster_params(scenario: Scenario) -> ThrusterParams:
    """Return the thrusters, positions seen from the CoG."""
    vessel = scenario.vessel
    return ThrusterParams(
        position=np.array([t.position_m for t in vessel.thrusters]) - np.array(vessel.cog_m),
        thrust_max=np.array([t.thrust_max_n for t in vessel.thrusters]),
        azimuthing=np.array([float(t.azimuthing) for t in vessel.thrusters]),
        time_constant=vessel.thruster_time_constant_s,
    )


def dp_params(scenario: Scenario) -> DpParams:
    """Return the DP controller's constants; gains from natural periods and damping ratios."""
    dp = scenario.dp
    vessel, thrusters = vessel_params(scenario), thruster_params(scenario)
    mass6 = vessel.rigid_mass + vessel.hull.added_mass
    stiffness, damping, integral = pid_gains(
        np.diag(mass6)[[0, 1, 5]], np.array(dp.natural_period_s), np.array(dp.damping_ratio)
    )
    turn, turn_accel = np.deg2rad([dp.reference_turn_max_deg_s, dp.reference_turn_accel_max_deg_s2])
    speed, accel = dp.reference_speed_max_m_s, dp.reference_accel_max_m_s2
    return DpParams(
        stiffness=stiffness,
        damping=damping,
        integral=integral,
        load_max=np.array(dp.load_max),
        rate_max=np.array([speed, speed, turn]),
        accel_max=np.array([accel, accel, turn_accel]),
        allocation=allocation_matrix(thrusters.position, thrusters.azimuthing),
        period=dp.period_ms * 1e-3,
    )


def symmetric(values: tuple[float, ...]) -> Array:
    """Return the tensor (3, 3) of xx, xy, xz, yy, yz, zz."""
    xx, xy, xz, yy, yz, zz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def crane_chain(crane: CraneConfig) -> ChainParams:
    """Return the crane's links."""
    frames: list[LinkConfig | TipConfig] = [*crane.links, crane.tip]
    rows = [(row.a_m, math.radians(row.alpha_deg), row.d_m, math.radians(row.theta_deg)) for row in frames]
    return make_chain(
        dh=rows,
        kind=[link.kind for link in crane.links],
        mass=[link.mass_kg for link in crane.links],
        cog=[link.cog_m for link in crane.links],
        inertia=[symmetric(link.inertia_kg_m2) for link in crane.links],
    )


def crane_drives(crane: CraneConfig) -> DriveParams:
    """Return what moves the crane's joints."""
    return make_drives([one_drive(link.drive) for link in crane.links])


def one_drive(drive: DriveConfig) -> LinearDrive | TriangleDrive:
    """Return one drive; DriveConfig has checked that its kind's keys are there."""
    if drive.kind == "motor":
        return LinearDrive()
    low, high = drive.length_min_m or 0.0, drive.length_max_m or 0.0
    if drive.kind == "cylinder":
        return LinearDrive(drive.offset_m or 0.0, low, high)
    return TriangleDrive(drive.side_a_m or 0.0, drive.side_b_m or 0.0, drive.offset_rad or 0.0, low, high)


def wire_params(scenario: Scenario) -> WireParams:
    """Return the constants of wire and winch."""
    wire, winch = scenario.wire, scenario.winch
    return WireParams(
        elastic_modulus=wire.elastic_modulus_pa,
        diameter=wire.diameter_m,
        fill_factor=wire.fill_factor,
        damping_ratio=wire.damping_ratio,
        speed_max=winch.speed_max_m_s,
        accel_max=winch.accel_max_m_s2,
        length_min=winch.length_min_m,
        length_max=winch.length_max_m,
        gravity=scenario.constants.gravity_m_s2,
        phase_max=wire.phase_max_rad,
        micro_step_max=wire.micro_step_max_ms * 1e-3,
    )
