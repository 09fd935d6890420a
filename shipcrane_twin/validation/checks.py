"""All checks of the validation page, with the words that go with them."""

import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from shipcrane_twin.config.load import data_file, load_scenario
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.hydro.build import read_hull
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.hydro.database import HydroDatabase, moved
from shipcrane_twin.hydro.figures import draw
from shipcrane_twin.hydro.rao import raos
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.validation import drift, hull, motions, pictures, sea, veres, words
from shipcrane_twin.validation.page import Picture, Section

SCENARIO = "case3"

Progress = Callable[[str], None]


class Extent(NamedTuple):
    """How much is done: frequencies [rad/s] of motions and drift, steps of direction [deg], numbers of seas."""

    motion_omega: tuple[float, ...] = motions.OMEGA
    drift_omega: tuple[float, ...] = drift.OMEGA
    drift_step_deg: int = drift.DIRECTION_STEP_DEG
    height_seeds: int = 60
    spectrum_seeds: int = 400
    crest_seeds: int = 40


def all_sections(
    folder: Path,
    *,
    veres_folder: Path | None = None,
    panels: bool = False,
    progress: Progress = lambda text: None,
    extent: Extent = Extent(),  # noqa: B008
) -> tuple[list[Section], str]:
    """Run every check and draw its pictures.

    Parameters
    ----------
    folder : Path
        Where pictures go.
    veres_folder : Path, optional
        ShipX/VERES files of the same ship; without it the comparisons with them are left out.
    panels : bool
        Whether to compute the convergence of the panels, which takes Capytaine and a minute.
    progress : callable
        Called with what is being done.
    extent : Extent

    Returns
    -------
    sections : list of Section
    source : str
        Where the ship's database comes from.

    Raises
    ------
    ConfigError
        If VERES's files cannot be read, or Capytaine is asked for and not installed.
    """
    scenario = load_scenario(SCENARIO)
    params, data = vessel_params(scenario), hydro_database(scenario)
    reference = veres.read_veres(veres_folder) if veres_folder else None
    hull_file = data_file(scenario.vessel.hull.hydrodynamics_file).with_name("hull.yaml")

    progress("pictures of the database")
    drawn = database_pictures(folder, data, params, reference)
    sections = [Section("Hull", words.HULL, hull.hull_rows(data), drawn["hull"])]
    if panels:
        progress("panels: twice as many, a minute")
    rows = hull.panel_rows(read_hull(hull_file)) if panels else []
    sections.append(Section("Panels", words.PANELS if panels else words.NO_PANELS, rows, []))
    sections.append(Section("State space", words.STATE_SPACE, hull.fit_rows(data), drawn["memory"]))

    progress("motions in regular waves")
    moving = motions.regular_wave_motions(params, data, extent.motion_omega)
    linear = raos(data, params.rigid_mass, params.hull.damping)
    figure = pictures.regular_waves(moving, linear, data)
    picture = Picture(pictures.save(figure, folder, "regular_waves"), words.MOTIONS_CAPTION)
    sections.append(Section("Motions in regular waves", words.MOTIONS, motions.motion_rows(moving), [picture]))

    progress("mean drift")
    held = drift.held_drift(drift.make_rig(SCENARIO), extent.drift_omega, extent.drift_step_deg)
    picture = Picture(pictures.save(pictures.held_drift(held, data), folder, "held_drift"), words.DRIFT_CAPTION)
    rows = drift.load_rows(data) + drift.drift_rows(held, data)
    sections.append(Section("Mean drift", words.DRIFT, rows, [picture, *drawn["drift"]]))

    progress("sea")
    sections.append(sea_section(folder, extent))
    progress("VERES")
    if reference is None or veres_folder is None:
        sections.append(Section("VERES", words.NO_VERES, [], drawn["veres"]))
    else:
        compared = veres.veres_rows(data, *reference)
        judged = [row for row in compared if not tells(row)]
        sections.append(Section("Against VERES", words.VERES, judged, drawn["veres"]))
        sections.append(
            Section("Where strip theory differs", words.DIFFERENCES, [row for row in compared if tells(row)], [])
        )
        imported = veres.import_rows(veres_folder, *reference)
        sections.append(Section("Imported VERES model", words.IMPORTED, imported, []))
    return sections, data.source


def tells(row: Row) -> bool:
    """Return whether a row of the comparison with VERES is told only, itself and its partner with phase."""
    return row.bar is None and not any(row.what.startswith(load) for load in ("F2", "F3", "F4", "F5"))


def sea_section(folder: Path, extent: Extent) -> Section:
    """Return the checks of the realised sea."""
    rows = sea.sea_rows(
        height_seeds=extent.height_seeds, spectrum_seeds=extent.spectrum_seeds, crest_seeds=extent.crest_seeds
    )
    drawn = [
        Picture(
            pictures.save(pictures.elevation_spectrum(range(extent.spectrum_seeds)), folder, "spectrum"),
            words.SPECTRUM_CAPTION,
        ),
        Picture(
            pictures.save(pictures.crest_exceedance(range(extent.crest_seeds)), folder, "crests"), words.CRESTS_CAPTION
        ),
    ]
    return Section("Sea", words.SEA, rows, drawn)


def database_pictures(
    folder: Path,
    data: HydroDatabase,
    params: VesselParams,
    reference: tuple[HydroDatabase, Array] | None,
) -> dict[str, Sequence[Picture]]:
    """Draw the database, with VERES's beside it where that is given, and sort the pictures by section."""
    ship = moved(data, reference[0].cog) if reference else data
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {}
    with tempfile.TemporaryDirectory() as workshop:
        for path in draw(
            ship,
            Path(workshop),
            other=reference[0] if reference else None,
            mass6=params.rigid_mass,
            extra_damping=params.hull.damping,
            mesh=(data.points, data.panels) if len(data.panels) else None,
        ):
            place = folder / f"validation_{path.name}"
            shutil.move(path, place)
            drawn[path.stem] = Picture(place, words.DATABASE_CAPTIONS[path.stem])
    order = {
        "hull": ("hull",),
        "memory": ("memory",),
        "drift": ("drift",),
        "veres": ("excitation", "added_mass", "damping", "coupling", "motions"),
    }
    return {section: [drawn[name] for name in names if name in drawn] for section, names in order.items()}
