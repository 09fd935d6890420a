"""The command line's part for hydrodynamic databases: build, import, show."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from shipcrane_twin.config.settings import ConfigError

app = typer.Typer(help="Hydrodynamic databases: build from a hull, import from a code's files, show.", no_args_is_help=True)
console = Console()
errors = Console(stderr=True)

DatabaseFile = Annotated[Path, typer.Argument(metavar="FILE", help="A hydrodynamic database (.nc).")]
OutFile = Annotated[Path, typer.Option("--out", metavar="FILE", help="Where the database goes (.nc).")]


@app.command()
def build(
    hull: Annotated[Path, typer.Argument(metavar="HULL", help="A hull file, as config/vessels/gunnerus/hull.yaml.")],
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Where it goes; hydro.nc beside the hull file.")] = None,
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

        table = Table("what", "found", "bar", "", box=None)
        rows = validate_import(data, motions=motions)
        for row in rows:
            bar = "" if row.bar is None else f"{row.bar:g}"
            table.add_row(row.what, f"{row.value:.3g} {row.unit}", bar, "" if row.holds else "MISSED")
        console.print(table, soft_wrap=True)
        if not all(row.holds for row in rows):
            raise ConfigError(f"{source}: the imported database does not reproduce what its files say; see the table")


@app.command()
def show(
    file: DatabaseFile,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the pictures.")] = Path("hydro_figures"),
    other: Annotated[Path | None, typer.Option(metavar="FILE", help="A second database, drawn dashed.")] = None,
    hull: Annotated[Path | None, typer.Option(metavar="HULL", help="Hull file, for the picture of the mesh.")] = None,
) -> None:
    """Draw hull, added mass, damping, excitation, motions, and the memory against its fit; list the periods."""
    from shipcrane_twin.hydro.build import hull_mesh, read_hull
    from shipcrane_twin.hydro.figures import draw
    from shipcrane_twin.hydro.files import load_database

    data = load_database(file)
    out.mkdir(parents=True, exist_ok=True)
    mesh = hull_mesh(read_hull(hull)) if hull else None
    pictures = draw(data, out, other=load_database(other) if other else None, mesh=mesh)
    table = Table(box=None, show_header=False)
    table.add_row("ship", data.name)
    table.add_row("from", data.source)
    table.add_row("displaces", f"{data.volume:.2f} m3, {data.mass / 1e3:.1f} t")
    table.add_row("frequencies", f"{len(data.omega)}, {data.omega[0]:g} to {data.omega[-1]:g} rad/s")
    table.add_row("directions", f"{len(data.direction)}, every {np.rad2deg(np.diff(data.direction).max()):g} deg")
    table.add_row("pictures", ", ".join(str(path) for path in pictures))
    console.print(table, soft_wrap=True)
