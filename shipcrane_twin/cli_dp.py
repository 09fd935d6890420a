"""The command line's part for dynamic positioning: validate."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(help="Dynamic positioning: validate it.", no_args_is_help=True)


@app.callback()
def dp() -> None:
    """Dynamic positioning."""


@app.command()
def validate(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of validation_dp.md and pictures/.")] = Path("docs"),
) -> None:
    """Check dynamic positioning; write the page with all figures; some minutes; exit code 3 if one misses its bar."""
    from shipcrane_twin.cli_hydro import MISSED, console, print_rows
    from shipcrane_twin.validation.page import held
    from shipcrane_twin.validation.positioning_page import all_sections, write_page

    with console.status("validation") as status:
        sections = all_sections(out / "pictures", progress=status.update)
    page = write_page(sections, "./twin dp validate", out)
    print_rows([row for section in sections for row in section.rows])
    good, judged = held(sections)
    console.print(f"{good} of {judged} figures hold their bars: {page}", highlight=False, soft_wrap=True)
    if good < judged:
        raise typer.Exit(MISSED)
