"""The command line: run, check, list, report, demo, bench; crane, dp and hydro have their own files."""

import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Annotated, Any, Literal

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from shipcrane_twin import __version__
from shipcrane_twin.cli_crane import app as crane_app
from shipcrane_twin.cli_dp import app as dp_app
from shipcrane_twin.cli_hydro import app as hydro_app
from shipcrane_twin.config.load import list_scenarios, load_scenario, read_yaml
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.running.folder import make_run_folder

DONE, BAD_INPUT, NODE_FAILED, INTERRUPTED = 0, 2, 3, 130
DEMO = "case3"

app = typer.Typer(
    help="Digital twin of a ship, its deck crane and the load on the hook.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(crane_app, name="crane")
app.add_typer(hydro_app, name="hydro")
app.add_typer(dp_app, name="dp")
console = Console()
errors = Console(stderr=True)

ScenarioName = Annotated[str, typer.Argument(metavar="SCENARIO", help="A name (see list) or a path to a YAML file.")]
SetOption = Annotated[
    list[str], typer.Option("--set", metavar="KEY=VALUE", help="Override a key by its dotted path; repeatable.")
]


@app.command()
def run(
    scenario: ScenarioName,
    mode: Annotated[Literal["graph", "inline"], typer.Option(help="Node processes, or all in this one.")] = "graph",
    speed: Annotated[str, typer.Option(metavar="max|X", help="As fast as it goes, or X times real time.")] = "max",
    until: Annotated[float | None, typer.Option(metavar="S", help="End at this simulated time [s].")] = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="New or empty folder for the results.")] = None,
    seed: Annotated[int | None, typer.Option(metavar="N", help="Seed of all random numbers.")] = None,
    no_record: Annotated[bool, typer.Option("--no-record", help="Write no bag and no report.")] = False,
    changes: SetOption = [],  # noqa: B006 - typer reads the default
) -> None:
    """Run a scenario: simulate, record, report."""
    overrides = [*changes]
    if until is not None:
        overrides.append(f"duration_s={float(until)}")
    if seed is not None:
        overrides.append(f"seed={seed}")
    overrides.append(f"lockstep.speed={parse_speed(speed)}")
    execute(load_scenario(scenario, overrides), mode, out, not no_record)


@app.command()
def demo(
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="New or empty folder for the results.")] = None,
) -> None:
    """Run the main job: the lift as a node graph, recorded, with its report."""
    execute(load_scenario(DEMO), "graph", out, True)


@app.command()
def check(scenario: ScenarioName, changes: SetOption = []) -> None:  # noqa: B006
    """Validate a scenario without running it."""
    from shipcrane_twin.cosim.check import check_buildable

    found = load_scenario(scenario, changes)
    check_buildable(found)
    warn(found)
    console.print(
        f"{found.name}: good. {found.duration_s:g} s in {found.step_count} steps of {found.macro_step_ms:g} ms, "
        f"coupling {found.coupling}, seed {found.seed}.",
        highlight=False,
    )


@app.command(name="list")
def list_command() -> None:
    """List the scenarios that come with the package."""
    table = Table("scenario", "title", box=None)
    for name, path in list_scenarios().items():
        table.add_row(name, str(read_yaml(path).get("title", "")))
    console.print(table)


@app.command()
def report(folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, with bag/.")]) -> None:
    """Draw the report of a run again from its bag."""
    from shipcrane_twin.report.page import write_report

    console.print(f"report: {write_report(folder)}", highlight=False, soft_wrap=True)


@app.command()
def bench(
    scenario: Annotated[str, typer.Argument(metavar="[SCENARIO]")] = DEMO,
    until: Annotated[float, typer.Option(metavar="S", help="Simulated time of each graph run [s].")] = 60.0,
) -> None:
    """Measure speed as a ratio to real time, inline and graph, with 10, 20 and 50 ms steps."""
    from shipcrane_twin.running.bench import run_bench
    from shipcrane_twin.running.bench_hull import bench_hull

    run_bench(scenario, until, console)
    bench_hull(scenario, console)


def parse_speed(text: str) -> float:
    """Return the speed of ``max`` (0) or of a positive number."""
    try:
        value = 0.0 if text == "max" else float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < float("inf") or (value == 0.0 and text != "max"):
        raise ConfigError(f"--speed is {text!r}, expected max or a number above 0, for instance 1.0 for real time")
    return value


def warn(scenario: Scenario) -> None:
    """Tell what is allowed, but better known."""
    from shipcrane_twin.cosim.weather import table_warnings

    for text in table_warnings(scenario):
        errors.print(f"warning: {text}", style="yellow", markup=False, highlight=False, soft_wrap=True)


def execute(scenario: Scenario, mode: Literal["graph", "inline"], out: Path | None, record: bool) -> None:
    """Run a checked scenario with a progress line, print its summary and leave with its exit code."""
    from shipcrane_twin.cosim.check import check_buildable
    from shipcrane_twin.cosim.inline import check_stand_ins
    from shipcrane_twin.running.session import run_scenario

    check_buildable(scenario)
    if mode == "inline":
        check_stand_ins(scenario)
    warn(scenario)
    folder = make_run_folder(scenario, out)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=30),
        TextColumn("{task.completed:.0f} of {task.total:.0f} s simulated, {task.fields[factor]:.1f} x real time"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=errors, transient=True) as bar:
        task = bar.add_task("starting", total=scenario.duration_s, factor=0.0)

        def show(status: dict[str, Any]) -> None:
            text = status["state"]
            if text == "waiting for nodes" and status["silent"]:
                text = f"waiting for {', '.join(status['silent'])} (a first start compiles the models)"
            bar.update(task, completed=status["time_s"], factor=status["real_time_factor"], description=text)

        outcome = run_scenario(scenario, folder, mode, record, show)
    print_summary(outcome.summary, folder, outcome.report)
    if outcome.failure:
        errors.print(f"error: {outcome.failure}", style="red", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(NODE_FAILED)
    if outcome.interrupted:
        errors.print("interrupted; what was simulated so far is in the folder", highlight=False)
        raise typer.Exit(INTERRUPTED)


def print_summary(summary: dict[str, Any], folder: Path, page: Path | None) -> None:
    """Print the short table at the end of a run."""
    table = Table(title=summary["title"], show_header=False, title_justify="left")
    table.add_row("simulated", f"{summary['sim_duration_s']:g} s, {summary['mode']}, {summary['macro_step_ms']:g} ms")
    factor = summary["real_time_factor"]
    table.add_row("real-time factor", f"{factor:.1f} ({summary['wall_time_s']:.1f} s)")
    roll, tension = summary.get("roll_deg"), summary.get("wire_tension_kn")
    if roll:
        table.add_row(
            "roll, starboard down", f"mean {roll['mean']:.2f}, min {roll['min']:.2f}, max {roll['max']:.2f} deg"
        )
    if tension:
        table.add_row(
            "wire tension", f"mean {tension['mean']:.2f}, min {tension['min']:.2f}, max {tension['max']:.2f} kN"
        )
    table.add_row("state digest", summary["state_digest"][:16])
    table.add_row("bag" if page else "results", str(folder / "bag" if page else folder))
    if page:
        table.add_row("report", str(page))
    console.print(table, soft_wrap=True)


def main() -> None:
    """Run the command line; a wrong input gives one message, never a traceback."""
    signal.signal(signal.SIGTERM, interrupt)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell's background jobs do not inherit
    from shipcrane_twin.record.scan import BagError
    from shipcrane_twin.report.page import ReportError

    try:
        app()
    except (ConfigError, BagError, ReportError) as err:
        errors.print(f"error: {err}", style="red", markup=False, highlight=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:  # while it was ending anyway
        sys.exit(INTERRUPTED)


def interrupt(number: int, frame: FrameType | None) -> None:
    """Treat SIGTERM like Ctrl-C: stop the nodes and close the bag."""
    raise KeyboardInterrupt


@app.callback(invoke_without_command=True)
def root(version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    """Digital twin of a ship, its deck crane and the load on the hook."""
    if version:
        console.print(__version__, highlight=False)
        raise typer.Exit(DONE)


if __name__ == "__main__":
    main()
