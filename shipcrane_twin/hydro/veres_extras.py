"""What a ShipX folder says besides the potential flow: viscous damping, manoeuvring, wind, particulars."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.veres import read_coefficients
from shipcrane_twin.hydro.veres_files import read_transfer
from shipcrane_twin.physics.arrays import Array

ADDED_MASS = ("Xudot", "Yvdot", "Yrdot", "Nvdot", "Nrdot")
"""Derivatives that repeat the potential flow's added mass: not to be used beside it."""


class VeresExtras(NamedTuple):
    """For the user, who decides what of it enters a vessel file.

    Attributes
    ----------
    mass : float64, shape (6, 6)
        VERES's rigid-body mass about the CoG, x forward, y port, z up [kg, kg m2].
    damping_correction : float64, shape (6, 6)
        re10's correction terms at zero speed, a linear damping beside the retardation functions.
    quadratic_roll : float64, shape (k, 2)
        Speed [m/s] and quadratic viscous roll damping [N m s2/rad2].
    manoeuvring : dict of float
        Derivatives of the .mancoeff file: SI, x forward, y starboard, about its own origin; without
        the added masses.
    manoeuvring_added_mass : dict of float
        The added masses; the database's matrices hold them already.
    particulars : dict of float
        Scalars of vesselcoeff.xml by name, in SI units (tonnes become kg).
    wind : dict of float64, shape (19,)
        Coefficients of surge, sway, yaw, roll, every 10 degrees from head wind.
    """

    mass: Array
    damping_correction: Array
    quadratic_roll: Array
    manoeuvring: dict[str, float]
    manoeuvring_added_mass: dict[str, float]
    particulars: dict[str, float]
    wind: dict[str, Array]


def read_extras(folder: Path) -> VeresExtras:
    """Read what the folder holds; missing files leave their part empty.

    Raises
    ------
    ConfigError
        If a file that is there cannot be read.
    """
    omega = read_transfer(folder / "input.re8", "WAVE EXCITATION FORCE").omega
    known = read_coefficients(folder, omega)
    derivatives: dict[str, float] = {}
    for file in sorted(folder.glob("*.mancoeff")):
        derivatives |= read_derivatives(file)
    particulars, wind = read_vesselcoeff(folder / "vesselcoeff.xml")
    return VeresExtras(
        mass=known.mass,
        damping_correction=known.damping_correction,
        quadratic_roll=known.quadratic_roll,
        manoeuvring={name: value for name, value in derivatives.items() if name not in ADDED_MASS},
        manoeuvring_added_mass={name: value for name, value in derivatives.items() if name in ADDED_MASS},
        particulars=particulars,
        wind=wind,
    )


def read_derivatives(path: Path) -> dict[str, float]:
    """Return the derivatives of a .mancoeff file by name."""
    found: dict[str, float] = {}
    for row, line in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("'"):
            continue
        name, equals, value = text.partition("=")
        try:
            if not equals:
                raise ValueError
            found[name.strip()] = float(value)
        except ValueError:
            raise ConfigError(f"{path}:{row}: {text[:60]!r}, expected name=number; export the file again") from None
    return found


def read_vesselcoeff(path: Path) -> tuple[dict[str, float], dict[str, Array]]:
    """Return scalars and wind coefficients of vesselcoeff.xml; empty if there is no such file."""
    if not path.is_file():
        return {}, {}
    try:
        root = ElementTree.parse(path).getroot()
        scalars = {
            entry.findtext("name", ""): float(entry.findtext("data", "nan"))
            * (1000.0 if entry.findtext("unit") == "t" else 1.0)
            for entry in root.iter("scalar")
        }
        wind = {
            name.removeprefix("ship_windcoeff_").removesuffix("_vector"): np.array([float(row) for row in rows])
            for name, rows in (
                (entry.findtext("name", ""), [row.text or "nan" for row in entry.iter("r")])
                for entry in root.iter("vector")
            )
            if name.startswith("ship_windcoeff_")
        }
    except (ElementTree.ParseError, ValueError) as err:
        raise ConfigError(
            f"{path}: cannot be read ({err}), expected ShipX's vessel coefficients; export them again"
        ) from None
    return scalars, wind
