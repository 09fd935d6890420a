"""Import of a ship from a NetCDF file that Capytaine's `export_dataset` wrote.

Conventions of the file (Capytaine user manual, "conventions"), and what becomes of them:

- Time factor ``e^{-i w t}``: loads are conjugated.
- Axes x forward, y port, z up if the mesh was made so; a wave direction is where the wave goes, from x towards y [rad].
- Loads about the body's rotation centre, phase counted at the origin of the mesh's axes: moved to the CoG.
- Complex numbers as a dimension ``complex`` with "re" and "im".
- ``hydrostatic_stiffness`` holds the ship's weight at the body's centre of mass: it must be the CoG given here.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import MIRROR, Complex, HydroDatabase
from shipcrane_twin.hydro.importing import Fit, Particulars, finish, fold, no_fit, phase_shift, transfer
from shipcrane_twin.hydro.memory import infinite_added_mass
from shipcrane_twin.physics.arrays import Array

MODES = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")


def import_capytaine(path: Path, about: Particulars, *, fit: Fit | None = None) -> HydroDatabase:
    """Read a Capytaine data set of one rigid body.

    Parameters
    ----------
    path : Path
    about : Particulars
        What the file lacks; density, gravity and depth are taken from the file. `centre` is the body's rotation
        centre in the mesh's axes.
    fit : callable, optional
        Makes the state-space model; `fit.fit_radiation` if absent.

    Raises
    ------
    ConfigError
        If xarray is absent, or naming what the file lacks.
    """
    try:
        import xarray
    except ImportError:
        raise ConfigError("xarray is not installed; run `pip install shipcrane_twin[hydro]`") from None
    try:
        with xarray.open_dataset(path) as file:
            dataset = file.load()
    except (OSError, ValueError) as err:
        raise ConfigError(f"{path}: cannot be read as NetCDF ({err}); write it with capytaine.export_dataset") from None
    frequency = needed(path, dataset, "omega")
    order = np.argsort(frequency)
    order = order[frequency[order] > 0.0]
    finite = order[np.isfinite(frequency[order])]
    if len(finite) < 8:
        raise ConfigError(f"{path}: {len(finite)} finite frequencies, expected at least 8; solve more")
    omega = frequency[finite]
    added, damping = matrices(path, dataset, "added_mass"), matrices(path, dataset, "radiation_damping")
    told = "added mass at infinite frequency from the file"
    if np.isinf(frequency[order[-1]]):
        infinite = added[order[-1]]
    else:
        told = "added mass at infinite frequency from the others (Ogilvie)"
        infinite = infinite_added_mass(omega, added[finite], damping[finite])
    direction, loads = excitation(path, dataset, finite)
    density, gravity, depth = (float(needed(path, dataset, name)) for name in ("rho", "g", "water_depth"))
    shift = transfer(about.arm)
    phase = phase_shift(omega, direction, float(about.cog[0] - about.origin[0]), gravity, depth)
    version = dataset.attrs.get("capytaine_version", "")
    data = HydroDatabase(
        name=about.name,
        source=f"Capytaine {version}: {path.name} (e^(-iwt), conjugated); {told}; drift is zero",
        cog=np.asarray(about.cog, float),
        draught=about.draught,
        length=about.length,
        water_density=density,
        gravity=gravity,
        depth=depth,
        volume=about.volume,
        centre_of_buoyancy=np.asarray(about.centre_of_buoyancy, float),
        restoring=shift.T @ matrices(path, dataset, "hydrostatic_stiffness") @ shift,
        omega=omega,
        added_mass=shift.T @ added[finite] @ shift,
        damping=shift.T @ damping[finite] @ shift,
        added_mass_inf=shift.T @ infinite @ shift,
        direction=direction,
        excitation=(loads @ shift) * phase[..., None],
        drift=np.zeros((len(omega), len(direction), 3)),
        fit=no_fit(),
    )
    return finish(data, str(path), fit)


def needed(path: Path, dataset: Any, name: str) -> Array:
    """Return a variable or coordinate as an array."""
    if name not in dataset.variables:
        remedy = "solve and export it"
        if name == "hydrostatic_stiffness":
            remedy = "call body.compute_hydrostatic_stiffness() before assemble_dataset(..., hydrostatics=True)"
        raise ConfigError(f"{path}: no {name!r}, expected a data set of capytaine.assemble_dataset; {remedy}")
    return np.asarray(dataset[name].values, float)


def matrices(path: Path, dataset: Any, name: str) -> Array:
    """Return matrices (..., 6, 6), rows the loads and columns the motions, in the order of the modes."""
    needed(path, dataset, name)
    variable = dataset[name]
    found = {str(mode) for mode in variable["influenced_dof"].values}
    if found != set(MODES):
        raise ConfigError(f"{path}: degrees of freedom {sorted(found)}, expected {list(MODES)} of one rigid body")
    ordered = variable.sel(influenced_dof=list(MODES), radiating_dof=list(MODES))
    return np.asarray(ordered.transpose(..., "influenced_dof", "radiating_dof").values, float)


def excitation(path: Path, dataset: Any, rows: NDArray[np.intp]) -> tuple[Array, Complex]:
    """Return directions (m,) from 0 to pi [rad] and loads (n, m, 6), conjugated."""
    if "excitation_force" in dataset.variables:
        variable = dataset["excitation_force"]
    else:
        for name in ("Froude_Krylov_force", "diffraction_force"):
            needed(path, dataset, name)
        variable = dataset["Froude_Krylov_force"] + dataset["diffraction_force"]
    ordered = variable.sel(influenced_dof=list(MODES)).transpose("complex", "omega", "wave_direction", "influenced_dof")
    real, imag = (np.asarray(ordered.sel(complex=part).values, float)[rows] for part in ("re", "im"))
    return fold(np.rad2deg(needed(path, dataset, "wave_direction")), real - 1j * imag, MIRROR)
