"""The command line's part for crane and load: validate."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(help="Crane and load: validate them.", no_args_is_help=True)


@app.callback()
def crane() -> None:
    """Crane and load."""


@app.command()
def validate(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the page and pictures/.")] = Path("docs"),
    kinematics: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Poses of the published crane, palfinger_kinematics.csv.")
    ] = None,
) -> None:
    """Check crane and load; write the page with all figures; some minutes; exit code 3 if one misses its bar."""
    from shipcrane_twin.cli_hydro import MISSED, console, print_rows
    from shipcrane_twin.validation.lifting_page import all_sections, write_page
    from shipcrane_twin.validation.page import held

    with console.status("validation") as status:
        sections = all_sections(out / "pictures", kinematics=kinematics, progress=status.update)
    page = write_page(sections, f"./twin crane validate{' --kinematics FILE' if kinematics else ''}", out)
    print_rows([row for section in sections for row in section.rows])
    good, judged = held(sections)
    console.print(f"{good} of {judged} figures hold their bars: {page}", highlight=False, soft_wrap=True)
    if good < judged:
        raise typer.Exit(MISSED)
