"""Hydrodynamic databases made with Capytaine from a parametric hull."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import AfterValidator

from shipcrane_twin.config.load import read_yaml
from shipcrane_twin.config.settings import ConfigError, Number, Text, Vector3, Whole, read_settings, settings
from shipcrane_twin.hydro.database import HydroDatabase, asymmetry, check
from shipcrane_twin.hydro.drift import mean_drift
from shipcrane_twin.hydro.fit import fit_radiation
from shipcrane_twin.hydro.hull_form import HullFormConfig, MeshConfig, SkegConfig, check_form
from shipcrane_twin.hydro.mesh import Hydrostatics, Panels, hull_panels, hydrostatics, lid_panels
from shipcrane_twin.hydro.panel_method import Solution, added_mass_at_infinity, capytaine_version, floating_body, solve
from shipcrane_twin.physics.arrays import Array

Progress = Callable[[str, float], None]
Positive = Annotated[Number, Gt(0)]


def check_rising(values: tuple[float, ...]) -> tuple[float, ...]:
    """Raise ValueError unless the values rise."""
    if not (np.diff(values) > 0.0).all():
        raise ValueError("rising values without repeats")
    return values


def check_step(value: int) -> int:
    """Raise ValueError unless half a turn is a whole number of steps."""
    if 180 % value:
        raise ValueError("a divisor of 180")
    return value


@settings
class HullBuildConfig:
    """A hull and what to compute of it; see `hull.yaml` of R/V Gunnerus.

    `drift_roll_damping` is the roll damping beside the waves, as a fraction of critical, that limits roll in the
    drift loads; nothing else reads it.
    """

    name: Text
    length_m: Positive
    draught_m: Positive
    cog_m: Vector3
    inertia_kg_m2: tuple[Positive, Positive, Positive]
    water_density_kg_m3: Positive
    gravity_m_s2: Positive
    form: HullFormConfig
    skeg: SkegConfig
    mesh: MeshConfig
    frequencies_rad_s: Annotated[tuple[Annotated[Number, Gt(0), Le(10)], ...], Len(8), AfterValidator(check_rising)]
    direction_step_deg: Annotated[Whole, Ge(1), Le(30), AfterValidator(check_step)]
    drift_roll_damping: Annotated[Number, Ge(0), Lt(1)]


def read_hull(path: Path) -> HullBuildConfig:
    """Read and check a hull file.

    Raises
    ------
    ConfigError
        Naming the file, the wrong key, its value and the remedy.
    """
    config = read_settings(HullBuildConfig, read_yaml(path), lambda _: str(path))
    if config.cog_m[1] != 0.0:
        raise ConfigError(f"{path}: cog_m[1] is {config.cog_m[1]:g}, expected 0: the hull is the same on both sides")
    check_form(config.form, config.skeg, config.draught_m, str(path))
    return config


def hull_mesh(config: HullBuildConfig) -> tuple[Array, Panels]:
    """Return nodes (k, 3) from aft perpendicular, centre line, baseline [m] and panels (p, 4) of the port half."""
    return hull_panels(config.form, config.skeg, config.mesh, config.draught_m)


def hull_hydrostatics(config: HullBuildConfig) -> Hydrostatics:
    """Return the hydrostatics of the hull's mesh."""
    points, panels = hull_mesh(config)
    cog = np.array(config.cog_m)
    return hydrostatics(points, panels, config.draught_m, cog, config.water_density_kg_m3, config.gravity_m_s2)


def build_database(config: HullBuildConfig, progress: Progress = lambda text, done: None) -> HydroDatabase:
    """Return the database of a hull, computed with Capytaine in deep water; about a minute.

    Parameters
    ----------
    config : HullBuildConfig
    progress : callable
        Called with what is being done and the share that is done, 0 to 1.

    Raises
    ------
    ConfigError
        If Capytaine or cvxpy is not installed, the mesh encloses no water, or what comes out is no ship's.
    """
    progress("mesh", 0.0)
    hull, still = hull_mesh(config), hull_hydrostatics(config)
    lid = lid_panels(config.form, config.skeg, config.mesh, config.draught_m)
    cog, rho, gravity = np.array(config.cog_m), config.water_density_kg_m3, config.gravity_m_s2
    omega = np.array(config.frequencies_rad_s)
    direction = np.deg2rad(np.arange(0, 181, config.direction_step_deg, dtype=float))
    body = floating_body(hull, config.draught_m, cog, lid)
    bare = floating_body(hull, config.draught_m, cog)
    infinite = added_mass_at_infinity(bare, rho)
    solutions = []
    for number, frequency in enumerate(omega):
        progress(f"{frequency:.3g} rad/s", (number + 0.5) / (len(omega) + 4.0))
        solutions.append(solve(body, float(frequency), direction, rho, gravity))
    added = np.stack([solution.added_mass for solution in solutions])
    damping = np.stack([solution.damping for solution in solutions])
    uneven = max(asymmetry(added), asymmetry(damping), asymmetry(infinite[None]))
    progress("state-space fit", len(omega) / (len(omega) + 4.0))
    added, damping, infinite = (0.5 * (m + np.swapaxes(m, -1, -2)) for m in (added, damping, infinite))
    drift, closure = drift_loads(config, still, omega, direction, solutions)
    source = (
        f"{capytaine_version()}, direct method, {len(hull[1])} panels on the port half, {len(lid[1])} on the lid at "
        f"still water; added mass and damping made symmetric (asymmetry was up to {100 * uneven:.2g} % of scale); "
        f"conjugated from e^{{-iwt}}; drift from the far field with {config.drift_roll_damping:g} of critical in roll, "
        f"energy closes within {100 * closure:.2g} %; {datetime.now(UTC):%Y-%m-%d}"
    )
    data = HydroDatabase(
        name=config.name,
        source=source,
        cog=cog,
        draught=config.draught_m,
        length=config.length_m,
        water_density=rho,
        gravity=gravity,
        depth=float("inf"),
        volume=still.volume,
        centre_of_buoyancy=still.centre_of_buoyancy,
        restoring=still.restoring,
        omega=omega,
        added_mass=added,
        damping=damping,
        added_mass_inf=infinite,
        direction=direction,
        excitation=np.stack([solution.excitation for solution in solutions]),
        drift=drift,
        fit=fit_radiation(omega, added, damping, infinite),
        points=hull[0],
        panels=hull[1].astype(np.int32),
    )
    progress("done", 1.0)
    return check(data, config.name)


def drift_loads(
    config: HullBuildConfig, still: Hydrostatics, omega: Array, direction: Array, solutions: list[Solution]
) -> tuple[Array, float]:
    """Return the mean loads (n, m, 3) on the freely floating ship, and the worst error of the energy balance.

    The energy balance compares extinction with scattering and absorption wherever the power is above 1 % of its
    largest value; elsewhere it is a ratio of rounding errors.
    """
    rho, gravity = config.water_density_kg_m3, config.gravity_m_s2
    mass = rho * still.volume
    inertia = np.diag([mass, mass, mass, *config.inertia_kg_m2])
    roll = np.array([solution.added_mass[3, 3] for solution in solutions]) + inertia[3, 3]
    natural = float(np.interp(0.0, omega**2 * roll / still.restoring[3, 3] - 1.0, omega))
    critical = 2.0 * still.restoring[3, 3] / natural
    viscous = np.zeros((6, 6))
    viscous[3, 3] = config.drift_roll_damping * critical
    drift, closures, powers = np.zeros((len(omega), len(direction), 3)), [], []
    for i, (w, solution) in enumerate(zip(omega, solutions, strict=True)):
        impedance = -(w**2) * (inertia + solution.added_mass) + 1j * w * (solution.damping + viscous) + still.restoring
        motion = np.linalg.solve(impedance, solution.excitation.T).T
        # the far field is in Capytaine's e^{-iwt}
        waves = solution.scattered + motion.conj() @ solution.radiated
        number = w**2 / gravity
        absorbed = 0.5 * w * number * (motion.conj() @ viscous * motion).sum(axis=1).real
        for j, angle in enumerate(direction):
            drift[i, j], closure = mean_drift(waves[j], float(angle), float(number), absorbed[j], rho, gravity)
            closures.append(closure)
            powers.append(0.25 * rho * gravity * 2.0 * np.pi * (np.abs(waves[j]) ** 2).mean() + absorbed[j])
    matters = np.array(powers) > 0.01 * max(powers)
    return drift, float(np.abs(np.array(closures)[matters] - 1.0).max())
