"""Radiation and diffraction of one hull with Capytaine, delivered in the database's conventions."""

import os
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import Complex
from shipcrane_twin.hydro.drift import far_field
from shipcrane_twin.hydro.mesh import Panels
from shipcrane_twin.physics.arrays import Array

HalfMesh = tuple[Array, Panels]


class Solution(NamedTuple):
    """One frequency.

    Attributes
    ----------
    added_mass, damping : float64, shape (6, 6)
        As computed, not quite symmetric.
    excitation : complex128, shape (m, 6)
        Time factor ``e^{+iwt}``.
    scattered : complex128, shape (m, angles)
        Waves that leave the fixed body, per wave amplitude, time factor ``e^{-iwt}``.
    radiated : complex128, shape (6, angles)
        Waves that leave the body that moves by one unit, time factor ``e^{-iwt}``.
    """

    added_mass: Array
    damping: Array
    excitation: Complex
    scattered: Complex
    radiated: Complex


def load_capytaine() -> Any:
    """Import Capytaine, or say how to get it."""
    os.environ.setdefault("CAPYTAINE_PROGRESS_BAR", "False")
    try:
        capytaine = import_module("capytaine")
    except ImportError:
        raise ConfigError(
            "making a hydrodynamic database needs Capytaine; install it with `pip install shipcrane_twin[hydro]`"
        ) from None
    capytaine.set_logging("ERROR")
    return capytaine


def floating_body(hull: HalfMesh, draught: float, cog: Array, lid: HalfMesh | None = None) -> Any:
    """Return a Capytaine body about its CoG, origin above or below it in still water.

    `hull` and `lid` are nodes and panels of the port half; the lid, at still water, takes out the irregular
    frequencies.
    """
    capytaine = load_capytaine()
    centre = (0.0, 0.0, float(cog[2] - draught))

    def whole(half: HalfMesh) -> Any:
        points, panels = half
        mesh = capytaine.Mesh(points - np.array([cog[0], 0.0, draught]), panels)
        return capytaine.ReflectionSymmetricMesh(mesh, plane="xOz")

    return capytaine.FloatingBody(
        mesh=whole(hull),
        lid_mesh=whole(lid) if lid else None,
        dofs=capytaine.rigid_body_dofs(rotation_center=centre),
        center_of_mass=centre,
    )


def capytaine_version() -> str:
    """Return the name and version of the solver."""
    return f"Capytaine {load_capytaine().__version__}"


def added_mass_at_infinity(body: Any, water_density: float) -> Array:
    """Return the added mass (6, 6) at infinite frequency of a body without a lid.

    On a lid the infinite-frequency Green function vanishes, so its equations would be singular.
    """
    capytaine = load_capytaine()
    solver = capytaine.BEMSolver(method="direct")
    rows = []
    for mode in body.dofs:
        problem = capytaine.RadiationProblem(body=body, omega=np.inf, radiating_dof=mode, rho=water_density)
        rows.append(list(solver.solve(problem, _check_wavelength=False).added_mass.values()))
    return np.array(rows).T


def solve(body: Any, omega: float, direction: Array, water_density: float, gravity: float) -> Solution:
    """Return radiation and diffraction at one frequency [rad/s] in deep water, waves going to `direction` (m,) [rad].

    Notes
    -----
    Capytaine's direct method (for the potential on the hull): for this hull with its thin skeg it converges faster
    than the source method. Loads are conjugated from Capytaine's ``e^{-iwt}``; axes and directions agree.
    """
    capytaine = load_capytaine()
    froude_krylov_force = capytaine.bem.airy_waves.froude_krylov_force
    solver = capytaine.BEMSolver(method="direct")
    sea = {"omega": omega, "rho": water_density, "g": gravity}
    problems = [capytaine.RadiationProblem(body=body, radiating_dof=mode, **sea) for mode in body.dofs]
    problems += [capytaine.DiffractionProblem(body=body, wave_direction=float(angle), **sea) for angle in direction]
    results = [solver.solve(problem, _check_wavelength=False) for problem in problems]
    radiation, diffraction = results[:6], results[6:]
    excitation = [
        [result.forces[mode] + forces[mode] for mode in body.dofs]
        for result, forces in ((result, froude_krylov_force(result.problem)) for result in diffraction)
    ]
    hull = np.asarray(body.hull_mask)
    waves = far_field(
        body.mesh.faces_centers,
        body.mesh.faces_normals,
        body.mesh.faces_areas,
        np.stack([result.potential[hull] for result in results]),
        np.stack([problem.boundary_condition[hull] for problem in problems]),
        omega,
        gravity,
    )
    return Solution(
        added_mass=np.array([list(result.added_mass.values()) for result in radiation]).T,
        damping=np.array([list(result.radiation_damping.values()) for result in radiation]).T,
        excitation=np.array(excitation).conj(),
        scattered=waves[6:],
        radiated=waves[:6],
    )
