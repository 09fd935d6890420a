"""The validation page: every check with its figure, bar and outcome, and what the figures mean."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from shipcrane_twin.hydro.compare import Row

PHASE = ", with phase"
THIN = 0.9
"""Share of a bar from which a margin is called thin."""


class Picture(NamedTuple):
    """A picture of the page: its file and a sentence that says what to see."""

    path: Path
    caption: str


class Section(NamedTuple):
    """One group of checks: what was done, its figures, its pictures; no rows where it was left out."""

    title: str
    text: str
    rows: Sequence[Row]
    pictures: Sequence[Picture]


def figure_text(value: float, unit: str) -> str:
    """Return a figure for a reader; one without a unit is a share, in per cent."""
    if unit:
        return f"{value:.2g} {unit}"
    return f"{100.0 * value:.2f} %" if value >= 1e-4 else "< 0.01 %"


def outcome(row: Row) -> str:
    """Return whether a row holds its bar, in a word."""
    return "" if row.bar is None else "yes" if row.holds else "**MISSED**"


def table(rows: Sequence[Row]) -> list[str]:
    """Return the lines of a table; figures with phase stand beside those of the amplitude."""
    with_phase = {row.what.removesuffix(PHASE): row for row in rows if row.what.endswith(PHASE)}
    lines = ["| check | figure | bar | holds | with phase | |", "|---|--:|--:|---|--:|---|"]
    if not with_phase:
        lines = ["| check | figure | bar | holds | |", "|---|--:|--:|---|---|"]
    for row in rows:
        if row.what.endswith(PHASE):
            continue
        bar = "" if row.bar is None else figure_text(row.bar, row.unit)
        cells = [row.what, figure_text(row.value, row.unit), bar, outcome(row)]
        if with_phase:
            beside = with_phase.get(row.what)
            cells.append(figure_text(beside.value, beside.unit) if beside else "")
        lines.append(f"| {' | '.join([*cells, row.note])} |")
    return lines


def held(sections: Sequence[Section]) -> tuple[int, int]:
    """Return how many figures hold their bars, and how many have one."""
    judged = [row for section in sections for row in section.rows if row.bar is not None]
    return sum(row.holds for row in judged), len(judged)


def missed_text(sections: Sequence[Section]) -> list[str]:
    """Return the list of what misses its bar."""
    missed = [row for section in sections for row in section.rows if not row.holds]
    return [
        f"- {row.what}: {figure_text(row.value, row.unit)} of {figure_text(row.bar or 0.0, row.unit)} ({row.note})"
        for row in missed
    ] or ["- nothing"]


def thin_text(sections: Sequence[Section]) -> list[str]:
    """Return the list of what holds its bar by less than a tenth of it."""
    rows = [row for section in sections for row in section.rows if row.bar and row.holds and row.value > THIN * row.bar]
    return [
        f"- {row.what}: {figure_text(row.value, row.unit)} of {figure_text(row.bar or 0.0, row.unit)}" for row in rows
    ] or ["- nothing"]


def anchor(title: str) -> str:
    """Return the link target that Markdown readers make of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def page_text(sections: Sequence[Section], command: str, source: str, folder: Path) -> str:
    """Return the page in Markdown.

    Parameters
    ----------
    sections : sequence of Section
    command : str
        What wrote it.
    source : str
        Where the hull's database comes from.
    folder : Path
        Where the page goes; links to pictures are relative to it.
    """
    good, all_of = held(sections)
    opening = [
        "# Validation of the sea and the hull",
        "",
        f"Written by `{command}`; {good} of {all_of} figures hold their bars. A figure in per cent is a share",
        "of what its part names; one without a bar is told, not judged. Directions are where waves go:",
        "0 following sea, 90 to port, 180 head sea.",
        f"The ship is the one of case 3; its database: {source}.",
    ]
    return page_with(opening, sections, folder)


def page_with(opening: Sequence[str], sections: Sequence[Section], folder: Path) -> str:
    """Return a page in Markdown: its first lines, what is missed and what is thin, then all sections."""
    lines = [
        *opening,
        "",
        "Missed:",
        "",
        *missed_text(sections),
        "",
        "Thin margins, above nine tenths of the bar:",
        "",
        *thin_text(sections),
        "",
        "| part | holds |",
        "|---|---|",
    ]
    for section in sections:
        own, count = held([section])
        told = f"{own} of {count}" if count else "no bars" if section.rows else "left out"
        lines.append(f"| [{section.title}](#{anchor(section.title)}) | {told} |")
    for section in sections:
        lines += ["", f"## {section.title}", "", section.text]
        if section.rows:
            lines += ["", *table(section.rows)]
        for picture in section.pictures:
            link = picture.path.relative_to(folder).as_posix()
            lines += ["", f"![{picture.caption}]({link})", "", picture.caption]
    return "\n".join(lines) + "\n"


def write_page(sections: Sequence[Section], command: str, source: str, folder: Path) -> Path:
    """Write `validation.md` into a folder and return where it is; see `page_text`."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "validation.md"
    path.write_text(page_text(sections, command, source, folder), encoding="utf-8")
    return path
