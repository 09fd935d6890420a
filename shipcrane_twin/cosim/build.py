"""From settings to the parameters of the kernels: units to SI, marine axes to FLU."""

import functools
import math
from pathlib import Path

import numpy as np

from shipcrane_twin.config.crane import CraneConfig, DriveConfig, LinkConfig, TipConfig
from shipcrane_twin.config.load import data_file
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.config.vessel import VesselConfig
from shipcrane_twin.control.load_limiter import LoadLimiterParams, make_limiter
from shipcrane_twin.hydro.database import HydroDatabase, moved
from shipcrane_twin.hydro.files import load_database
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import ActuatorParams
from shipcrane_twin.physics.crane_chain import ChainParams, make_chain
from shipcrane_twin.physics.crane_cylinders import DriveParams, LinearDrive, TriangleDrive, make_drives
from shipcrane_twin.physics.crane_reference import MotionLimits, make_limits
from shipcrane_twin.physics.crane_segments import Segment
from shipcrane_twin.physics.frames import flu_matrix_from_frd
from shipcrane_twin.physics.hull import HullParams
from shipcrane_twin.physics.payload import WireParams
from shipcrane_twin.physics.radiation import RadiationParams
from shipcrane_twin.physics.slow_pose import follower
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.physics.vessel_step import micro_steps
from shipcrane_twin.physics.winch import WinchParams
from shipcrane_twin.physics.wind import WindParams

CROSS_FLOW_STRIPS = 12
TRIM_LEVER_MAX = 0.005
"""Distance of CoG and centre of buoyancy along the ship, over its length, at which the database's waterline fails."""

DATABASE_TOLERANCE = 1e-3
"""Relative difference at which a scenario's particulars are not those of the hull's database."""


def hull_params(scenario: Scenario, data: HydroDatabase) -> HullParams:
    """Return the hull's coefficients about the CoG in FLU; the ballast is not in yet, it depends on the start."""
    vessel = scenario.vessel
    hull = vessel.hull
    table = np.array(hull.current_table)
    table[:, 0] = np.deg2rad(table[:, 0])
    half_rho = 0.5 * scenario.constants.water_density_kg_m3
    damping = flu_matrix_from_frd(np.array(hull.viscous_damping_frd))
    damping[3, 3] += 2.0 * hull.roll_damping_ratio * roll_impedance(data, vessel.inertia_kg_m2[0])
    ballast = vessel.ballast
    return HullParams(
        added_mass=data.added_mass_inf,
        damping=damping,
        restoring=data.restoring,
        roll_quadratic=hull.roll_quadratic_n_m_s2,
        strips=cross_flow_strips(vessel, half_rho),
        ballast=np.array([ballast.heave_n, ballast.roll_n_m, ballast.pitch_n_m]),
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


def roll_impedance(data: HydroDatabase, inertia: float) -> float:
    """Return ``sqrt((I44 + A44) C44)`` with the added mass at the natural frequency [N m s]."""
    omega = 1.0
    for _ in range(30):
        added = np.interp(omega, data.omega, data.added_mass[:, 3, 3])
        omega = math.sqrt(data.restoring[3, 3] / (inertia + added))
    return float(data.restoring[3, 3]) / omega


def cross_flow_strips(vessel: VesselConfig, half_rho: float) -> Array:
    """Return place [m from the CoG] and drag [N s2/m2] of equal strips between the perpendiculars, shape (n, 2)."""
    each = vessel.length_m / CROSS_FLOW_STRIPS
    place = (np.arange(CROSS_FLOW_STRIPS) + 0.5) * each - vessel.cog_m[0]
    drag = half_rho * vessel.hull.cross_flow_coefficient * vessel.draught_m * each
    return np.column_stack((place, np.full(CROSS_FLOW_STRIPS, drag)))


def hydro_database(scenario: Scenario) -> HydroDatabase:
    """Return the hull's database about the scenario's CoG.

    Raises
    ------
    ConfigError
        If it cannot be read or is that of another ship, or of other water.
    """
    vessel = scenario.vessel
    path = data_file(vessel.hull.hydrodynamics_file)
    data = moved(cached_database(path), np.array(vessel.cog_m))
    for key, value, stored in (
        ("vessel.draught_m", vessel.draught_m, data.draught),
        ("vessel.length_m", vessel.length_m, data.length),
        ("constants.water_density_kg_m3", scenario.constants.water_density_kg_m3, data.water_density),
        ("constants.gravity_m_s2", scenario.constants.gravity_m_s2, data.gravity),
    ):
        if abs(value / stored - 1.0) > DATABASE_TOLERANCE:
            raise ConfigError(
                f"{scenario.name}: {key} is {value:g}, expected {stored:g} as in vessel.hull.hydrodynamics_file "
                f"({path}); change it or build the database anew"
            )
    lever = data.centre_of_buoyancy[0] - vessel.cog_m[0]
    if abs(lever) > TRIM_LEVER_MAX * data.length:
        raise ConfigError(
            f"{scenario.name}: vessel.cog_m is {-lever:.2f} m ahead of the hull's centre of buoyancy, so that the ship "
            f"would not float on an even keel; expected {data.centre_of_buoyancy[0]:.3f} m from the aft perpendicular, "
            f"within {TRIM_LEVER_MAX * data.length:.2f} m; put crane, load and vessel.ballast where they are instead"
        )
    afloat = data.restoring[2:5, 2:5]
    if np.linalg.eigvalsh(afloat).min() <= 0.0:
        raise ConfigError(
            f"{scenario.name}: the hull has no stiffness in heave, roll or pitch (C44 = {afloat[1, 1]:.4g} N m/rad) "
            f"with vessel.cog_m at {vessel.cog_m[2]:g} m above the baseline; lower it"
        )
    return data


@functools.lru_cache(maxsize=4)
def cached_database(path: Path) -> HydroDatabase:
    """Return a database that is read once: every subsystem of an inline run asks for it."""
    return load_database(path)


def vessel_params(scenario: Scenario) -> VesselParams:
    """Return the ship's constants."""
    vessel = scenario.vessel
    data = hydro_database(scenario)
    step_s = scenario.step_ns / 1e9
    return VesselParams(
        rigid_mass=np.diag([data.mass] * 3 + list(vessel.inertia_kg_m2)),
        hull=hull_params(scenario, data),
        radiation=RadiationParams(data.fit.a, data.fit.b, data.fit.c),
        cog=np.array(vessel.cog_m),
        crane_base=np.array(scenario.crane.base_m),
        gravity=scenario.constants.gravity_m_s2,
        follow=follower(scenario.environment.waves.slow_motion_period_s, step_s / micro_steps(step_s)),
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
        segments={
            i: [Segment(s.mass_kg, s.cog_m, symmetric(s.inertia_kg_m2), s.stroke_m) for s in link.segments]
            for i, link in enumerate(crane.links)
            if link.segments
        },
        handover=crane.segment_handover_m,
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


def crane_limits(crane: CraneConfig, drives: DriveParams) -> MotionLimits:
    """Return what the references of the crane's drives may do."""
    each = [link.drive for link in crane.links]
    return make_limits(
        drives,
        rate_max=[drive.speed_max for drive in each],
        accel_max=[drive.of_kind("accel_max_rad_s2", "accel_max_m_s2") for drive in each],
        jerk_max=[drive.of_kind("jerk_max_rad_s3", "jerk_max_m_s3") for drive in each],
        end_margin=[drive.end_margin_m or 0.0 for drive in each],
    )


def crane_actuators(crane: CraneConfig) -> ActuatorParams:
    """Return forces, oil and brakes of the crane's drives."""
    each = [link.drive for link in crane.links]
    stiffness = np.array([drive.of_kind("stiffness_n_m_per_rad", "stiffness_n_per_m") for drive in each])
    areas = np.array([drive.areas for drive in each])
    force = np.array([drive.of_kind("torque_max_n_m", "pressure_max_pa") for drive in each])
    holding = np.array([drive.of_kind("brake_torque_n_m", "holding_pressure_pa") for drive in each])
    leak = np.array([drive.of_kind("leak_rad_per_s_n_m", "leak_m3_per_s_pa") for drive in each])
    return ActuatorParams(
        stiffness=stiffness,
        damping=stiffness * [drive.damping_time_s for drive in each],
        push=force * areas[:, 0],
        pull=force * areas[:, 1],
        hold_push=holding * areas[:, 0],
        hold_pull=holding * areas[:, 1],
        friction=np.array([drive.of_kind("friction_n_m", "friction_n") for drive in each]),
        leak_push=leak / areas[:, 0] ** 2,
        leak_pull=leak / areas[:, 1] ** 2,
        tracking=crane.servo.tracking_rate_1_s,
    )


def load_limiter(scenario: Scenario) -> LoadLimiterParams:
    """Return the overload limiter of the crane."""
    limiter = scenario.crane.load_limiter
    return make_limiter(
        scenario.crane.load_chart,
        warning=limiter.warning,
        cut_out=limiter.cut_out,
        release=limiter.release,
        filter_s=limiter.filter_s,
        step_s=scenario.step_ns / 1e9,
    )


def wire_params(scenario: Scenario) -> WireParams:
    """Return the constants of the wire."""
    wire = scenario.wire
    return WireParams(
        elastic_modulus=wire.elastic_modulus_pa,
        diameter=wire.diameter_m,
        fill_factor=wire.fill_factor,
        damping_ratio=wire.damping_ratio,
        mass_per_length=wire.mass_kg_m,
        gravity=scenario.constants.gravity_m_s2,
        phase_max=wire.phase_max_rad,
        micro_step_max=wire.micro_step_max_ms * 1e-3,
    )


def tip_weight(scenario: Scenario) -> float:
    """Return what hangs on the tip at the start [N]: the load, unless it rests on something, its hook and the wire."""
    payload = scenario.payload
    resting = payload.box is not None and payload.box.rests_on is not None
    mass = payload.hook_mass_kg if resting else payload.mass_kg
    return scenario.constants.gravity_m_s2 * (mass + scenario.wire.mass_kg_m * scenario.winch.initial_length_m)


def winch_params(scenario: Scenario) -> WinchParams:
    """Return the constants of the winch, all torques and inertias at the drum."""
    wire, winch, drum = scenario.wire, scenario.winch, scenario.winch.drum
    return WinchParams(
        speed_max=winch.speed_max_m_s,
        accel_max=winch.accel_max_m_s2,
        jerk_max=winch.jerk_max_m_s3,
        length_min=winch.length_min_m,
        length_max=winch.length_max_m,
        core_radius=0.5 * drum.core_diameter_m,
        wire_diameter=wire.diameter_m,
        wire_length=drum.wire_length_m,
        turns=float(drum.turns_per_layer),
        motor_torque=drum.motor_torque_n_m * drum.gear_ratio,
        brake_torque=drum.brake_torque_n_m,
        drag_torque=drum.drag_torque_n_m,
        inertia=drum.drum_inertia_kg_m2 + drum.motor_inertia_kg_m2 * drum.gear_ratio**2,
        sheave_friction=wire.sheave_friction,
        leak_speed=drum.drift_speed_m_s,
    )
