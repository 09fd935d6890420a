"""The command line's part for hydrodynamic databases: build, import, show, validate."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from shipcrane_twin.config.settings import ConfigError

if TYPE_CHECKING:
    from shipcrane_twin.hydro.compare import Row

app = typer.Typer(
    help="Hydrodynamic databases: build from a hull, import from a code's files, show; validate the physics.",
    no_args_is_help=True,
)
console = Console()
errors = Console(stderr=True)

MISSED = 3
"""Exit code of `validate` where a figure misses its bar."""

DatabaseFile = Annotated[Path, typer.Argument(metavar="FILE", help="A hydrodynamic database (.nc).")]
OutFile = Annotated[Path, typer.Option("--out", metavar="FILE", help="Where the database goes (.nc).")]


@app.command()
def build(
    hull: Annotated[Path, typer.Argument(metavar="HULL", help="A hull file, as config/vessels/gunnerus/hull.yaml.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where it goes; hydro.nc beside the hull file.")
    ] = None,
) -> None:
    """Compute a database with Capytaine (extra: hydro); some minutes on one core."""
    from shipcrane_twin.hydro.build import build_database, read_hull
    from shipcrane_twin.hydro.files import save_database

    config = read_hull(hull)
    place = out or hull.with_name("hydro.nc")
    columns = (TextColumn("{task.description}"), BarColumn(bar_width=30), TimeElapsedColumn())
    with Progress(*columns, console=errors, transient=True) as bar:
        task = bar.add_task("mesh", total=1.0)
        data = build_database(config, lambda text, done: bar.update(task, description=text, completed=done))
    save_database(place, data)
    console.print(f"{data.name}: {place}", highlight=False, soft_wrap=True)


@app.command(name="import")
def import_command(
    kind: Annotated[Literal["veres", "wamit", "capytaine"], typer.Argument(help="The code whose files they are.")],
    source: Annotated[Path, typer.Argument(metavar="SOURCE", help="VERES folder, WAMIT file stem, Capytaine NetCDF.")],
    out: OutFile = Path("hydro.nc"),
    about: Annotated[
        Path | None, typer.Option(metavar="FILE", help="YAML with the particulars that WAMIT and Capytaine leave out.")
    ] = None,
    validate: Annotated[bool, typer.Option("--validate", help="Rebuild the motions and compare.")] = False,
) -> None:
    """Read another code's results into a database."""
    from shipcrane_twin.hydro.files import save_database
    from shipcrane_twin.hydro.particulars import import_any

    data, motions = import_any(kind, source, about)
    save_database(out, data)
    console.print(f"{data.name}: {out}", highlight=False, soft_wrap=True)
    if validate:
        from shipcrane_twin.hydro.compare import validate_import
        from shipcrane_twin.hydro.veres_extras import read_extras

        mass6 = read_extras(source).mass if kind == "veres" else None
        rows = validate_import(data, mass6, motions)
        print_rows(rows)
        if not all(row.holds for row in rows):
            raise ConfigError(f"{source}: the imported database does not reproduce what its files say; see the table")


def print_rows(rows: Sequence[Row]) -> None:
    """Print figures with their bars."""
    table = Table("what", "found", "bar", "", box=None)
    for row in rows:
        bar = "" if row.bar is None else f"{row.bar:g}"
        table.add_row(row.what, f"{row.value:.3g} {row.unit}", bar, "" if row.holds else "MISSED")
    console.print(table, soft_wrap=True)


@app.command()
def show(
    file: DatabaseFile,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the pictures.")] = Path("hydro_figures"),
    other: Annotated[Path | None, typer.Option(metavar="FILE", help="A second database, drawn dashed.")] = None,
    hull: Annotated[
        Path | None, typer.Option(metavar="HULL", help="Hull file: moments of inertia for the motions, its own mesh.")
    ] = None,
) -> None:
    """Draw hull, added mass, damping, excitation, motions, and the memory against its fit; list the periods."""
    from shipcrane_twin.hydro.build import hull_mesh, read_hull
    from shipcrane_twin.hydro.figures import draw
    from shipcrane_twin.hydro.files import load_database
    from shipcrane_twin.hydro.rao import mass_matrix, natural_periods, usual_mass

    data = load_database(file)
    out.mkdir(parents=True, exist_ok=True)
    config = read_hull(hull) if hull else None
    mesh = hull_mesh(config) if config else (data.points, data.panels)
    mass6 = mass_matrix(data.mass, *config.inertia_kg_m2) if config else None
    beside = load_database(other) if other else None
    pictures = draw(data, out, other=beside, mass6=mass6, mesh=mesh if len(mesh[1]) else None)
    table = Table(box=None, show_header=False)
    table.add_column()
    table.add_column(overflow="fold")  # paths are not cut
    table.add_row("ship", data.name)
    table.add_row("from", data.source)
    table.add_row("displaces", f"{data.volume:.2f} m3, {data.mass / 1e3:.1f} t")
    table.add_row("frequencies", f"{len(data.omega)}, {data.omega[0]:g} to {data.omega[-1]:g} rad/s")
    table.add_row("directions", f"{len(data.direction)}, every {np.rad2deg(np.diff(data.direction).max()):g} deg")
    periods = natural_periods(data, usual_mass(data) if mass6 is None else mass6)
    told = ", ".join(f"{name} {period:.2f} s" for name, period in periods.items())
    table.add_row("natural periods", told if hull else f"{told} (usual radii of gyration; --hull has the ship's own)")
    table.add_row("pictures", ", ".join(str(path) for path in pictures))
    console.print(table, soft_wrap=True)


@app.command()
def validate(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of validation.md and pictures/.")] = Path("docs"),
    veres: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="ShipX/VERES files of the ship to compare with.")
    ] = None,
    panels: Annotated[
        bool, typer.Option("--panels", help="Also the convergence of the panels (extra: hydro); a minute.")
    ] = False,
) -> None:
    """Check sea, hull and their loads; write the page with all figures; exit code 3 if one misses its bar."""
    from shipcrane_twin.validation.checks import all_sections
    from shipcrane_twin.validation.page import held, write_page

    with console.status("validation") as status:
        sections, source = all_sections(out / "pictures", veres_folder=veres, panels=panels, progress=status.update)
    options = " --veres FOLDER" * (veres is not None) + " --panels" * panels
    page = write_page(sections, f"./twin hydro validate{options}", source, out)
    print_rows([row for section in sections for row in section.rows])
    good, judged = held(sections)
    console.print(f"{good} of {judged} figures hold their bars: {page}", highlight=False, soft_wrap=True)
    if good < judged:
        raise typer.Exit(MISSED)
