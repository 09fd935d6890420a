"""The ship against VERES's model of it, and VERES's model, imported, against VERES's own motions."""

import dataclasses
from pathlib import Path

import numpy as np

from shipcrane_twin.hydro.compare import Row, compare_with_veres, validate_import
from shipcrane_twin.hydro.database import HydroDatabase, moved
from shipcrane_twin.hydro.importing import no_fit
from shipcrane_twin.hydro.veres import import_veres, read_motions
from shipcrane_twin.hydro.veres_extras import read_extras
from shipcrane_twin.physics.arrays import Array


def read_veres(folder: Path) -> tuple[HydroDatabase, Array]:
    """Return VERES's database and its mass (6, 6).

    It gets no state-space model, which no comparison here needs: the model's residues are not numbers.

    Raises
    ------
    ConfigError
        If a file is missing or cannot be understood.
    """
    data = import_veres(folder, name="VERES", fit=lambda *_tables: no_fit())
    nothing = dataclasses.replace(data.fit, c=np.full_like(data.fit.c, np.nan))
    return dataclasses.replace(data, fit=nothing), read_extras(folder).mass


def veres_rows(data: HydroDatabase, veres: HydroDatabase, mass6: Array) -> list[Row]:
    """Compare loads, added mass, damping, motions and natural periods; see `compare.compare_with_veres`."""
    return compare_with_veres(moved(data, veres.cog), veres, mass6)


def import_rows(folder: Path, veres: HydroDatabase, mass6: Array) -> list[Row]:
    """Rebuild motions from the imported added mass, damping, stiffness and loads, and compare with the file's own."""
    # what it says of the state-space model goes, see `read_veres`
    rows = validate_import(veres, mass6, read_motions(folder, veres))
    return [row for row in rows if "against the file's own" in row.what]
