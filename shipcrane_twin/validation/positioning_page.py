"""The page on dynamic positioning: every experiment, its figures and pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation import capability
from shipcrane_twin.validation import positioning_faults as faults
from shipcrane_twin.validation import positioning_moves as moves
from shipcrane_twin.validation import positioning_pictures as drawing
from shipcrane_twin.validation import positioning_station as station
from shipcrane_twin.validation import positioning_theory as theory
from shipcrane_twin.validation import positioning_words as words
from shipcrane_twin.validation.page import Picture, Section, held, page_with
from shipcrane_twin.validation.pictures import save
from shipcrane_twin.validation.positioning import ride

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENARIOS = {"calm": "case2", "E1": "case3", "E2": "case3_e2"}
ROUGH = ("E1", "E2")

Progress = Callable[[str], None]


def all_sections(folder: Path, progress: Progress = lambda text: None) -> list[Section]:
    """Run every experiment and draw its pictures into a folder; some minutes."""

    def section(title: str, text: str, rows: Sequence[Row], figure: Figure | None, name: str = "") -> Section:
        drawn = [] if figure is None else [Picture(save(figure, folder, name, "dp"), words.CAPTIONS[name])]
        return Section(title, text, rows, drawn)

    scenario = load_scenario(SCENARIOS["E1"])
    progress("station keeping")
    runs = {weather: ride(name) for weather, name in SCENARIOS.items()}
    rows = [row for weather, run in runs.items() for row in station.station_rows(weather, run)]
    sections = [section("Station keeping", words.STATION, rows, drawing.station(runs), "station")]

    progress("wave filter")
    pairs = {weather: (runs[weather], ride(SCENARIOS[weather], station.NO_FILTER)) for weather in ROUGH}
    rows = [row for weather, pair in pairs.items() for row in station.wave_rows(weather, *pair)]
    sections.append(section("Wave filter", words.WAVES, rows, drawing.wave_spectra(pairs), "waves"))

    progress("observer")
    seen = ride(SCENARIOS["E1"], station.UNBIASED)
    sections.append(
        section("Observer", words.OBSERVER, station.observer_rows("E1", seen), drawing.observer(seen), "observer")
    )

    progress("box manoeuvre")
    box = ride(moves.BOX, moves.EVERY_STEP)
    sections.append(section("Box manoeuvre", words.BOX, moves.box_rows(box), drawing.box(box), "box"))

    progress("thrust allocation")
    rows = theory.allocation_rows(theory.allocate_many(scenario))
    sections.append(section("Thrust allocation", words.ALLOCATION, rows, None))

    progress("capability")
    ship = capability.ship_of(scenario)
    cases = capability.capabilities(ship)
    figure = capability.capability_figure(scenario.vessel.name, cases)
    sections.append(section("Capability", words.CAPABILITY, theory.capability_rows(cases), figure, "capability"))

    progress("stability")
    loops = theory.loop_of(scenario, None), theory.loop_of(scenario, theory.WAVE_PERIOD_S)
    figure = drawing.loop(*loops, 2.0 * np.pi / theory.WAVE_PERIOD_S)
    sections.append(section("Stability", words.STABILITY, theory.stability_rows(scenario), figure, "loop"))

    progress("slewing load")
    lifts = {case: ride(moves.LIFT, change) for case, change in moves.FEED_FORWARD.items()}
    sections.append(section("Slewing load", words.LIFT, moves.lift_rows(lifts), drawing.lift(lifts), "lift"))

    progress("faults")
    broken = {case: ride(faults.WEATHER, faults.changes(case)) for case in faults.CASES}
    text = f"{words.FAULTS}\n\n{faults.warnings_text(broken)}"
    figure = drawing.faults(broken)
    sections.append(section("Faults", text, faults.fault_rows(broken), figure, "faults"))
    return sections


def write_page(sections: Sequence[Section], command: str, folder: Path) -> Path:
    """Write `validation_dp.md` into a folder and return where it is."""
    good, judged = held(sections)
    opening = [
        "# Validation of dynamic positioning",
        "",
        f"Written by `{command}`; {good} of {judged} figures hold their bars; one without a bar is told, not judged.",
        *words.OPENING.splitlines(),
    ]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "validation_dp.md"
    path.write_text(page_with(opening, sections, folder), encoding="utf-8")
    return path
