"""Import of a ship from ShipX/VERES.

Conventions of the files, and what becomes of them:

- input.re8, input.re1, input.re7: x aft, y starboard, z up, about the origin of the motion coordinates, which the file
  names. input.swy: the same axes, about the point of the waterline above or below the CoG. input.re2: the same
  axes, about the CoG. retfun.re10: x forward, y starboard, z down, about the CoG.
- All have the time factor ``e^{+i w t}``, as here: in long waves the surge load leads the elevation by a quarter period
  in the direction the wave goes.
- Heading 0 is a head sea. It is where the wave goes in the file's axes, from x (aft) towards y (starboard), so the wave
  goes to ``heading + 180`` degrees anticlockwise from the bow.
"""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import MIRROR, Complex, HydroDatabase
from shipcrane_twin.hydro.importing import Fit, finish, fold, no_fit, phase_shift, transfer
from shipcrane_twin.hydro.veres_coefficients import FROM_AFT, Coefficients, read_re7, read_re10
from shipcrane_twin.hydro.veres_files import Transfer, read_drift, read_transfer
from shipcrane_twin.physics.arrays import Array

FIT_TO = 4.0
"""Up to where re10's functions are given to the fit [rad/s]; re8 ends at periods of 3 s or so."""


def import_veres(folder: Path, *, name: str = "", vcb: float | None = None, fit: Fit | None = None) -> HydroDatabase:
    """Read a ship from a folder of VERES files.

    Parameters
    ----------
    folder : Path
        With input.re8 and one of retfun.re10, input.re7; input.re2 (drift; zero without it).
    name : str
        The ship; as in the file if empty.
    vcb : float, optional
        Centre of buoyancy above the baseline [m], where neither vesselcoeff.xml nor input.hyd says it.
    fit : callable, optional
        Makes the state-space model; `fit.fit_radiation` if absent.

    Raises
    ------
    ConfigError
        Naming file and line, what was found, what was expected, and what to do.

    Notes
    -----
    VERES is a strip theory: surge has no added mass and no damping of its own. What VERES's motion model adds to the
    potential flow (viscous roll damping, the correction terms of re10) is not in the database; see `read_extras`.
    """
    loads = read_transfer(folder / "input.re8", "WAVE EXCITATION FORCE")
    head = loads.header
    coefficients = read_coefficients(folder, loads.omega)
    cog = np.array([head.length / 2.0 - head.lcg, 0.0, head.vcg])
    direction, excitation = converted(loads, moments=True)
    drift = np.zeros((len(loads.omega), len(direction), 3))
    told = "no input.re2: drift is zero"
    if (folder / "input.re2").is_file():
        drift = drift_at(folder / "input.re2", loads.omega, direction)
        told = "input.re2 (x aft, y starboard; by rho g B^2/L and rho g B^2)"
    buoyancy = vcb if vcb is not None else centre_of_buoyancy(folder)
    data = HydroDatabase(
        name=name or head.ship,
        source=(
            f"ShipX/VERES: input.re8 (x aft, y starboard, z up, heading 0 head sea, e^(+iwt)), {head.title}; "
            f"{coefficients.source}; {told}"
        ),
        cog=cog,
        draught=head.draught,
        length=head.length,
        water_density=head.water_density,
        gravity=head.gravity,
        depth=np.inf,
        volume=coefficients.mass[0, 0] / head.water_density,
        centre_of_buoyancy=np.array([cog[0], 0.0, buoyancy]),
        restoring=coefficients.restoring,
        omega=loads.omega,
        added_mass=coefficients.added_mass,
        damping=coefficients.damping,
        added_mass_inf=coefficients.added_mass_inf,
        direction=direction,
        excitation=excitation,
        drift=drift,
        fit=no_fit(),
    )
    return finish(data, str(folder), fit, fit_grid(folder, coefficients))


def read_coefficients(folder: Path, omega: Array) -> Coefficients:
    """Return the coefficients at frequencies (n,) [rad/s], from re10 or else from re7."""
    for file, reader in (("retfun.re10", read_re10), ("input.re7", read_re7)):
        if (folder / file).is_file():
            return reader(folder / file, omega)
    raise ConfigError(f"{folder}: neither retfun.re10 nor input.re7 is there; export one of them from ShipX")


def fit_grid(folder: Path, known: Coefficients) -> tuple[Array, Array, Array]:
    """Return frequencies, added mass and damping for the fit: re10 says more than the frequencies of re8."""
    omega = known.omega
    if (folder / "retfun.re10").is_file() and omega[-1] < FIT_TO:
        omega = np.concatenate([omega, np.arange(omega[-1] + 0.1, FIT_TO, 0.1)])
        known = read_coefficients(folder, omega)
    return omega, known.added_mass, known.damping


def converted(table: Transfer, *, moments: bool) -> tuple[Array, Complex]:
    """Return directions (m,) [rad] and loads or motions (n, m, 6) in this project's axes, about the CoG.

    Parameters
    ----------
    table : Transfer
        As the file has it.
    moments : bool
        Loads (True) or motions: they follow another point by transposed laws.
    """
    head = table.header
    arm = np.array([table.origin[0] - head.lcg, 0.0, head.vcg - table.origin[1]])
    direction, values = fold(table.heading + 180.0, table.values * FROM_AFT, MIRROR)
    shift = transfer(arm)
    moved = values @ shift if moments else values @ np.linalg.inv(shift).T
    phase = phase_shift(table.omega, direction, float(arm[0]), head.gravity, np.inf)
    return direction, moved * phase[..., None]


def drift_at(path: Path, omega: Array, direction: Array) -> Array:
    """Return mean surge force, sway force and yaw moment (n, m, 3) per squared amplitude [N/m2, N/m]."""
    table = read_drift(path)
    found, values = fold(table.heading + 180.0, table.values * FROM_AFT, MIRROR)
    same = len(found) == len(direction) and np.abs(found - direction).max() < 1e-4
    # the file rounds frequencies to four decimals
    if not same or len(table.omega) != len(omega) or np.abs(table.omega - omega).max() > 1e-3:
        raise ConfigError(f"{path}: headings or frequencies are not those of input.re8; export both from the same run")
    return np.asarray(values[..., [0, 1, 5]].real)


def read_motions(folder: Path, data: HydroDatabase) -> Complex | None:
    """Return VERES's own motions (n, m, 6) per wave amplitude, about the CoG, in the database's convention.

    Parameters
    ----------
    folder : Path
        With input.re1 or input.swy; None is returned if there is neither.
    data : HydroDatabase
        Imported from the same folder.

    Raises
    ------
    ConfigError
        If frequencies or headings differ from the database's.
    """
    if (folder / "input.re1").is_file():
        table = read_transfer(folder / "input.re1", "MOTION TRANSFER FUNCTIONS")
    elif (folder / "input.swy").is_file():
        table = read_transfer(folder / "input.swy", "SEAWAY", seaway=True)
    else:
        return None
    direction, motions = converted(table, moments=False)
    if motions.shape != data.excitation.shape or np.abs(direction - data.direction).max() > 1e-4:
        raise ConfigError(f"{folder}: motions are given at other headings or frequencies than input.re8")
    return motions


def centre_of_buoyancy(folder: Path) -> float:
    """Return the centre of buoyancy above the baseline [m], from vesselcoeff.xml or input.hyd."""
    file = folder / "vesselcoeff.xml"
    if file.is_file():
        try:
            root = ElementTree.parse(file).getroot()
        except ElementTree.ParseError as err:
            raise ConfigError(f"{file}: is not XML ({err}); export it again") from None
        for scalar in root.iter("scalar"):
            if scalar.findtext("name", "").lower() == "vertical_centre_of_buoyancy":
                return float(scalar.findtext("data", "nan"))
    file = folder / "input.hyd"
    if file.is_file():
        found = re.search(r"KB\s+([\d.]+)", file.read_text(encoding="latin-1"))
        if found:
            return float(found[1])
    raise ConfigError(f"{folder}: neither vesselcoeff.xml nor input.hyd names the centre of buoyancy; give its height")
