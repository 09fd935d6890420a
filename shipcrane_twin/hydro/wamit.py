"""Import of a ship from WAMIT's .1, .3 and .hst files.

Conventions of the files (WAMIT user manual, chapter 4), and what becomes of them:

- x forward, y port, z up if the geometry was made so; time factor ``e^{+iwt}``; heading 0 goes to +x, 90 degrees to +y:
  this project's convention. Loads are about the body's origin and are moved to the CoG.
- Numbers are without dimension: ``A = A' rho L^k``, ``B = B' rho L^k w`` with k = 3, 4, 5 for force by translation,
  mixed, moment by rotation; ``F = F' rho g L^2`` for forces, ``rho g L^3`` for moments; ``C = C' rho g L^2``, ``L^3``,
  ``L^4`` like A. L is ULEN of the geometry file.
- The first column is the period [s]; 0 is infinite frequency, a negative one is zero frequency.
- .hst holds the ship's weight at the CoG that the force file names: it must be the one given here.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import MIRROR, Complex, HydroDatabase
from shipcrane_twin.hydro.importing import Fit, Particulars, finish, fold, no_fit, phase_shift, transfer
from shipcrane_twin.hydro.memory import infinite_added_mass
from shipcrane_twin.physics.arrays import Array

ROTATION = np.array([0, 0, 0, 1, 1, 1])


def import_wamit(stem: Path, about: Particulars, *, ulen: float = 1.0, fit: Fit | None = None) -> HydroDatabase:
    """Read stem.1, stem.3 and stem.hst.

    Parameters
    ----------
    stem : Path
        The files' path without suffix.
    about : Particulars
        What the files lack. `centre` is the body's origin in WAMIT's axes, zero unless XBODY moved it.
    ulen : float
        WAMIT's length scale ULEN [m].
    fit : callable, optional
        Makes the state-space model; `fit.fit_radiation` if absent.

    Raises
    ------
    ConfigError
        Naming file and line, what was found, what was expected, and what to do.

    Notes
    -----
    Drift forces (.8, .9) are not read: drift is zero. If .1 has no infinite frequency it follows from the rest
    (`memory.infinite_added_mass`).
    """
    density, gravity = about.water_density, about.gravity
    radiation, told = read_1(stem.with_name(stem.name + ".1"), density, ulen)
    omega, added, damping, infinite = radiation
    direction, loads = read_3(stem.with_name(stem.name + ".3"), omega, density * gravity, ulen)
    shift = transfer(about.arm)
    phase = phase_shift(omega, direction, float(about.cog[0] - about.origin[0]), gravity, about.depth)
    restoring = read_hst(stem.with_name(stem.name + ".hst"), density * gravity, ulen)
    data = HydroDatabase(
        name=about.name,
        source=f"WAMIT: {stem.name}.1 .3 .hst, ULEN {ulen:g} m (e^(+iwt), about its origin); {told}; drift is zero",
        cog=np.asarray(about.cog, float),
        draught=about.draught,
        length=about.length,
        water_density=density,
        gravity=gravity,
        depth=about.depth,
        volume=about.volume,
        centre_of_buoyancy=np.asarray(about.centre_of_buoyancy, float),
        restoring=shift.T @ restoring @ shift,
        omega=omega,
        added_mass=shift.T @ added @ shift,
        damping=shift.T @ damping @ shift,
        added_mass_inf=shift.T @ infinite @ shift,
        direction=direction,
        excitation=(loads @ shift) * phase[..., None],
        drift=np.zeros((len(omega), len(direction), 3)),
        fit=no_fit(),
    )
    return finish(data, str(stem), fit)


def rows_of(path: Path, widths: tuple[int, ...]) -> list[tuple[int, list[float]]]:
    """Return line numbers and numbers of the lines of a WAMIT file; a first line of text is a title."""
    try:
        lines = path.read_text(encoding="latin-1").splitlines()
    except OSError as err:
        raise ConfigError(f"{path}: cannot be read ({err.strerror}); give the files' path without suffix") from None
    found = []
    for row, line in enumerate(lines, 1):
        try:
            numbers = [float(word) for word in line.replace("D", "E").split()]
        except ValueError:
            if row == 1:
                continue
            raise ConfigError(f"{path}:{row}: {line.strip()[:60]!r}, expected numbers only; run WAMIT again") from None
        if not numbers:
            continue
        if len(numbers) not in widths:
            raise ConfigError(
                f"{path}:{row}: {len(numbers)} columns, expected {' or '.join(map(str, widths))} of a single rigid body"
            )
        found.append((row, numbers))
    if not found:
        raise ConfigError(f"{path}: is empty, expected WAMIT's numeric output; run WAMIT with this option on")
    return found


def mode_of(path: Path, row: int, value: float) -> int:
    """Return a mode 1 to 6 as an index."""
    if value not in range(1, 7):
        raise ConfigError(f"{path}:{row}: mode {value:g}, expected 1 to 6; export a single rigid body")
    return int(value) - 1


def read_1(path: Path, density: float, ulen: float) -> tuple[tuple[Array, Array, Array, Array], str]:
    """Return frequencies, added mass, damping, added mass at infinite frequency [SI], and where the last is from."""
    periods: dict[float, Array] = {}
    for row, (period, i, j, *values) in rows_of(path, (4, 5)):
        entry = periods.setdefault(period, np.full((2, 6, 6), 0.0))
        entry[: len(values), mode_of(path, row, i), mode_of(path, row, j)] = values
    unit = density * ulen ** (3.0 + ROTATION[:, None] + ROTATION)
    finite = sorted((period for period in periods if period > 0.0), reverse=True)
    omega = 2.0 * np.pi / np.array(finite)
    added = np.array([periods[period][0] for period in finite]).reshape(-1, 6, 6) * unit
    damping = np.array([periods[period][1] for period in finite]).reshape(-1, 6, 6) * unit * omega[:, None, None]
    if 0.0 in periods:
        return (omega, added, damping, periods[0.0][0] * unit), "added mass at infinite frequency from the file"
    if len(omega) < 8:
        raise ConfigError(f"{path}: {len(omega)} periods, expected at least 8; run more")
    told = "added mass at infinite frequency from the others (Ogilvie)"
    return (omega, added, damping, infinite_added_mass(omega, added, damping)), told


def read_3(path: Path, omega: Array, unit: float, ulen: float) -> tuple[Array, Complex]:
    """Return directions (m,) from 0 to pi [rad] and loads (n, m, 6) about the body's origin [N/m, N]."""
    table: dict[tuple[int, float], Complex] = {}
    headings: list[float] = []
    for row, (period, heading, mode, modulus, _phase, real, imag) in rows_of(path, (7,)):
        if period <= 0.0:
            continue
        if abs(modulus - np.hypot(real, imag)) > 1e-3 * abs(modulus) + 1e-9:
            raise ConfigError(
                f"{path}:{row}: modulus {modulus:g} beside {real:g} + {imag:g}i, expected columns period, heading, "
                "mode, modulus, phase, real part, imaginary part"
            )
        at = int(np.argmin(np.abs(omega - 2.0 * np.pi / period)))
        if abs(omega[at] * period - 2.0 * np.pi) > 1e-3:
            raise ConfigError(f"{path}:{row}: period {period:g} s is not in the .1 file; take both from the same run")
        headings += [heading] if heading not in headings else []
        loads = table.setdefault((at, heading), np.full(6, np.nan, complex))
        loads[mode_of(path, row, mode)] = real + 1j * imag
    values = np.full((len(omega), len(headings), 6), np.nan, complex)
    for (at, heading), loads in table.items():
        values[at, headings.index(heading)] = loads
    if not np.isfinite(values).all():
        at, head, mode = (int(axis[0]) for axis in np.nonzero(~np.isfinite(values)))
        raise ConfigError(
            f"{path}: no load of mode {mode + 1} at period {2.0 * np.pi / omega[at]:g} s, heading {headings[head]:g}, "
            "expected all modes at all periods of .1; run WAMIT with all six modes"
        )
    dimension = unit * ulen ** (2.0 + ROTATION)
    return fold(np.array(headings), np.asarray(values * dimension, complex), MIRROR)


def read_hst(path: Path, unit: float, ulen: float) -> Array:
    """Return the restoring matrix (6, 6) about the body's origin [SI]."""
    matrix = np.zeros((6, 6))
    for row, (i, j, value) in rows_of(path, (3,)):
        matrix[mode_of(path, row, i), mode_of(path, row, j)] = value
    return matrix * unit * ulen ** (2.0 + ROTATION[:, None] + ROTATION)
