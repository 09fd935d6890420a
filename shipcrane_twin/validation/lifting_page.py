"""The page on crane and load: every experiment, its figures and pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation import lifting_abuse as abuse
from shipcrane_twin.validation import lifting_control as control
from shipcrane_twin.validation import lifting_energy as energy
from shipcrane_twin.validation import lifting_pictures as drawing
from shipcrane_twin.validation import lifting_servo as servo
from shipcrane_twin.validation import lifting_splash as splash
from shipcrane_twin.validation import lifting_structure as structure
from shipcrane_twin.validation import lifting_wire as wire
from shipcrane_twin.validation import lifting_words as words
from shipcrane_twin.validation.lifting import CRANES, Machine, machine
from shipcrane_twin.validation.lifting_structure_picture import structure as structure_picture
from shipcrane_twin.validation.page import Picture, Section, held, page_with
from shipcrane_twin.validation.pictures import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PINOCCHIO_BAR = 1e-9
LIFT = "case2"
SHOWN_M = 20.0
"""Length of wire that the picture of heave compensation is of."""

Progress = Callable[[str], None]


def dynamics_rows(crane: str, mount: Machine) -> list[Row]:
    """Return how far a crane's dynamics are from Pinocchio's; none where that is not installed."""
    if find_spec("pinocchio") is None:
        return []
    from shipcrane_twin.validation.pinocchio_crane import joint_space_errors, moving_base_errors

    groups = (
        ("base at rest", joint_space_errors(mount.chain)),
        ("moving base", moving_base_errors(mount.chain)),
    )
    return [
        Row(f"{crane}, {where}: {what} against Pinocchio", error, PINOCCHIO_BAR, "relative")
        for where, errors in groups
        for what, error in errors.items()
    ]


def all_sections(
    folder: Path, *, kinematics: Path | None = None, progress: Progress = lambda text: None
) -> list[Section]:
    """Run every experiment and draw its pictures into a folder; some minutes.

    Parameters
    ----------
    folder : Path
        Where the pictures go.
    kinematics : Path, optional
        A table of poses of the published crane; without it that part is left out.
    progress : callable
        Is told what comes next.
    """

    def section(title: str, text: str, rows: Sequence[Row], figure: Figure | None = None, name: str = "") -> Section:
        drawn = [] if figure is None else [Picture(save(figure, folder, name, "crane"), words.CAPTIONS[name])]
        return Section(title, text, rows, drawn)

    cranes = {name: machine(name) for name in CRANES}
    palfinger = cranes["Palfinger"]
    progress("kinematics and dynamics")
    rows = structure.kinematics_rows(kinematics, palfinger) if kinematics else []
    sections = [section("Kinematics", words.KINEMATICS + ("" if rows else "\n\nLeft out: no table was given."), rows)]
    rows = [row for name, mount in cranes.items() for row in dynamics_rows(name, mount)]
    sections.append(section("Dynamics", words.DYNAMICS + ("" if rows else "\n\nLeft out: no Pinocchio here."), rows))

    progress("energy")
    swings = {name: energy.dropped(mount, energy.kick_of(mount)) for name, mount in cranes.items()}
    rows = [row for name, found in swings.items() for row in energy.swing_rows(name, found)]
    sections.append(section("Energy", words.ENERGY, rows, drawing.energy(swings), "energy"))
    progress("work in a lift")
    lift = energy.lift_work(LIFT)
    sections.append(section("Work in a lift", words.WORK, energy.work_rows(lift), drawing.work(lift), "work"))

    progress("wire and water")
    sections.append(section("Wire", words.WIRE, wire.wire_rows(), drawing.on_the_wire(), "wire"))
    down = splash.transit()
    sections.append(section("Splash zone", words.SPLASH, splash.splash_rows(down), drawing.splash(down), "splash"))

    progress("servos")
    answers = {name: servo.responses(mount) for name, mount in cranes.items()}
    rows = [row for name, found in answers.items() for row in servo.servo_rows(name, found)]
    sections.append(section("Velocity servos", words.SERVO, rows, drawing.servo(answers), "servo"))

    progress("random commands")
    trace = abuse.abused()
    rows = abuse.abuse_rows(trace)
    for name, mount in cranes.items():
        rows += abuse.reference_rows(name, abuse.referenced(mount))
    sections.append(section("Random commands", words.ABUSE, rows, drawing.abuse(trace, palfinger), "abuse"))

    progress("compensation")
    loads = {length: control.held_load(length) for length in control.LENGTHS_M}
    figure = drawing.heave(loads[SHOWN_M], control.held_load(SHOWN_M, compensated=False), f"{SHOWN_M:g} m")
    sections.append(section("Heave compensation", words.COMPENSATION, control.heave_rows(loads), figure, "heave"))
    turns = control.slewed()
    sections.append(section("Anti-sway", words.SWAY, control.sway_rows(turns), drawing.sway(turns), "sway"))

    progress("load chart and failures")
    chart, beam = structure.overload(), structure.telescope(palfinger)
    end, failed = structure.to_the_end(palfinger), structure.failures(palfinger)
    rows = [*structure.overload_rows(chart), *structure.telescope_rows(palfinger, beam)]
    rows += structure.failure_rows(palfinger, end, failed)
    figure = structure_picture(palfinger, chart, beam, end, failed)
    sections.append(section("Load chart, telescope, failures", words.STRUCTURE, rows, figure, "structure"))
    return sections


def write_page(sections: Sequence[Section], command: str, folder: Path) -> Path:
    """Write `validation_crane.md` into a folder and return where it is."""
    good, judged = held(sections)
    opening = [
        "# Validation of crane and load",
        "",
        f"Written by `{command}`; {good} of {judged} figures hold their bars; one without a bar is told, not judged.",
        *words.OPENING.splitlines(),
    ]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "validation_crane.md"
    path.write_text(page_with(opening, sections, folder), encoding="utf-8")
    return path
