"""Hydrodynamic databases as NetCDF files (classic format, so that scipy alone reads them)."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import netcdf_file

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import HydroDatabase, RadiationFit, check

FORMAT = "shipcrane hydrodynamic database 1"

NUMBERS = ("draught", "length", "water_density", "gravity", "depth", "volume")

VARIABLES: dict[str, tuple[tuple[str, ...], str]] = {
    "cog": (("xyz",), "m from aft perpendicular, centre line, baseline"),
    "centre_of_buoyancy": (("xyz",), "m from aft perpendicular, centre line, baseline"),
    "restoring": (("mode", "mode"), "SI, ship's weight at cog"),
    "omega": (("frequency",), "rad/s"),
    "added_mass": (("frequency", "mode", "mode"), "SI"),
    "damping": (("frequency", "mode", "mode"), "SI"),
    "added_mass_inf": (("mode", "mode"), "SI"),
    "direction": (("direction",), "rad, where the wave goes, anticlockwise from the bow"),
    "drift": (("frequency", "direction", "horizontal"), "N/m2, N/m per squared amplitude"),
}
FIT: dict[str, tuple[str, ...]] = {
    "a": ("block", "section", "two", "two"),
    "b": ("block", "section", "two"),
    "c": ("block", "three", "three", "section", "two"),
}
EXCITATION = (("frequency", "direction", "mode"), "N/m, N m/m; real and imaginary part, e^{+i w t}")
CONVENTION = (
    "axes x forward, y port, z up; order surge sway heave roll pitch yaw; about cog; time factor e^{+i w t}; "
    "fit: x_jk' = a_k x_jk + b_k nu_j, load = -(added_mass_inf nu_dot + sum c_ijk x_jk), "
    "blocks surge heave pitch and sway roll yaw"
)


def save_database(path: Path, data: HydroDatabase) -> None:
    """Write a database, whole or not at all."""
    check(data, str(path))
    part = path.with_name(f".{path.name}.part")
    with netcdf_file(part, "w", mmap=False) as file:
        file.format_name, file.convention = FORMAT, CONVENTION
        file.ship, file.source = data.name, data.source
        for name in NUMBERS:
            setattr(file, name, np.float64(getattr(data, name)))  # a Python float would become float32
        sections = data.fit.b.shape[1]
        sizes = {"xyz": 3, "mode": 6, "frequency": len(data.omega), "direction": len(data.direction)}
        sizes |= {"horizontal": 3, "block": 2, "section": sections, "two": 2, "three": 3}
        if len(data.panels):
            sizes |= {"point": len(data.points), "panel": len(data.panels), "corner": 4}
        for name, size in sizes.items():
            file.createDimension(name, size)
        for name, (dimensions, units) in VARIABLES.items():
            put(file, name, dimensions, units, getattr(data, name))
        put(file, "excitation_real", *EXCITATION, data.excitation.real)
        put(file, "excitation_imag", *EXCITATION, data.excitation.imag)
        for name, dimensions in FIT.items():
            put(file, f"fit_{name}", dimensions, "SI", getattr(data.fit, name))
        if len(data.panels):
            put(file, "mesh_points", ("point", "xyz"), "m from aft perpendicular, centre line, baseline", data.points)
            put(file, "mesh_panels", ("panel", "corner"), "numbers of points, port half", data.panels, "i4")
    part.replace(path)


def put(file: Any, name: str, dimensions: tuple[str, ...], units: str, values: Any, kind: str = "f8") -> None:
    """Write one variable."""
    variable = file.createVariable(name, kind, dimensions)
    variable[:] = values
    variable.units = units


def load_database(path: Path) -> HydroDatabase:
    """Read and check a database.

    Raises
    ------
    ConfigError
        If the file is missing, is no database of ours, or holds what no ship can have.
    """
    try:
        with netcdf_file(path, "r", mmap=False) as file:
            if getattr(file, "format_name", b"").decode() != FORMAT:
                raise ConfigError(f"{path}: not a {FORMAT!r}; make one with `shipcrane hydro build` or `hydro import`")
            values: dict[str, Any] = {name: read(file, name) for name in VARIABLES}
            values |= {name: float(getattr(file, name)) for name in NUMBERS}
            values["excitation"] = read(file, "excitation_real") + 1j * read(file, "excitation_imag")
            fit = RadiationFit(a=read(file, "fit_a"), b=read(file, "fit_b"), c=read(file, "fit_c"))
            if "mesh_panels" in file.variables:
                values["points"] = read(file, "mesh_points")
                values["panels"] = np.array(file.variables["mesh_panels"][:], dtype=np.int32)
            name, source = file.ship.decode(), file.source.decode()
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file; give the path of a hydrodynamic database (.nc)") from None
    except (OSError, TypeError, ValueError, KeyError, AttributeError) as err:
        if isinstance(err, ConfigError):
            raise
        raise ConfigError(f"{path}: cannot be read as a {FORMAT} ({err}); build or import it again") from None
    return check(HydroDatabase(name=name, source=source, fit=fit, **values), str(path))


def read(file: Any, name: str) -> Any:
    """Return one variable in native byte order."""
    return np.array(file.variables[name][:], dtype=np.float64)
