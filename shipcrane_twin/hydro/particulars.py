"""The file with a ship's particulars that an import needs beside the code's own files."""

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from annotated_types import Gt

from shipcrane_twin.config.load import read_yaml
from shipcrane_twin.config.settings import ConfigError, Number, Text, Vector3, read_settings, settings
from shipcrane_twin.hydro.capytaine_file import import_capytaine
from shipcrane_twin.hydro.database import Complex, HydroDatabase
from shipcrane_twin.hydro.importing import Particulars
from shipcrane_twin.hydro.veres import import_veres, read_motions
from shipcrane_twin.hydro.wamit import import_wamit

Positive = Annotated[Number, Gt(0)]
Code = Literal["veres", "wamit", "capytaine"]


@settings
class ParticularsConfig:
    """What WAMIT's and Capytaine's files leave out.

    Positions are from aft perpendicular, centre line, baseline; ``origin_m`` is where the code's axes have their
    zero; ``centre_m`` is the point that loads and motions refer to, in the code's axes. No ``depth_m`` is deep water.
    """

    name: Text
    cog_m: Vector3
    origin_m: Vector3
    centre_m: Vector3
    draught_m: Positive
    length_m: Positive
    volume_m3: Positive
    centre_of_buoyancy_m: Vector3
    water_density_kg_m3: Positive
    gravity_m_s2: Positive
    depth_m: Positive | None = None


def read_particulars(path: Path) -> Particulars:
    """Read and check a file of particulars.

    Raises
    ------
    ConfigError
        Naming the file, the wrong key, its value and the remedy.
    """
    config = read_settings(ParticularsConfig, read_yaml(path), lambda _: str(path))
    return Particulars(
        name=config.name,
        cog=np.array(config.cog_m),
        origin=np.array(config.origin_m),
        centre=np.array(config.centre_m),
        draught=config.draught_m,
        length=config.length_m,
        volume=config.volume_m3,
        centre_of_buoyancy=np.array(config.centre_of_buoyancy_m),
        water_density=config.water_density_kg_m3,
        gravity=config.gravity_m_s2,
        depth=config.depth_m or math.inf,
    )


def import_any(code: Code, source: Path, about: Path | None) -> tuple[HydroDatabase, Complex | None]:
    """Return the database that a code's files make, and the motions that they hold, if any.

    Parameters
    ----------
    code : str
    source : Path
        VERES: the folder; WAMIT: the files without their endings; Capytaine: the NetCDF file.
    about : Path, optional
        File of particulars, for WAMIT and Capytaine.

    Raises
    ------
    ConfigError
        If a file is missing or cannot be understood.
    """
    if code == "veres":
        if about is not None:
            raise ConfigError(f"{about}: VERES's files name the particulars themselves; leave it out")
        data = import_veres(source)
        return data, read_motions(source, data)
    if about is None:
        keys = ", ".join(ParticularsConfig.__dataclass_fields__)
        raise ConfigError(f"{source}: {code} leaves out the ship's particulars; give a YAML file with {keys}")
    particulars = read_particulars(about)
    return (import_wamit if code == "wamit" else import_capytaine)(source, particulars), None
