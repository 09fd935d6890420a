"""The folder of a run: made once, never written over."""

import json
from pathlib import Path
from typing import Any

from shipcrane_twin.config.load import scenario_yaml
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError

RUNS = Path("runs")


def make_run_folder(scenario: Scenario, out: Path | None) -> Path:
    """Make the folder of a run and write the resolved scenario into it.

    Parameters
    ----------
    scenario : Scenario
    out : Path or None
        Wanted folder; None picks ``runs/<scenario>-<n>`` below the current folder.

    Returns
    -------
    Path
        Absolute.

    Raises
    ------
    ConfigError
        If it cannot be made or already holds a run.
    """
    try:
        folder = out if out is not None else next_folder(scenario.name)
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise ConfigError(f"--out {folder}: the folder is not empty, expected a new or empty one; name another")
        (folder / "scenario.yaml").write_text(scenario_yaml(scenario), encoding="utf-8")
    except OSError as err:
        raise ConfigError(
            f"the run's folder cannot be written: {err}; give a folder that can be written with --out DIR"
        ) from None
    return folder.resolve()


def next_folder(name: str) -> Path:
    """Make and return the first free ``runs/<name>-<n>``; two runs at once get different ones."""
    number = 1
    while True:
        folder = RUNS / f"{name}-{number}"
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            number += 1
        else:
            return folder


def node_results(folder: Path) -> dict[str, dict[str, Any]]:
    """Return what the nodes of a graph run wrote at their end, by node name."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (folder / "nodes").glob("*.json")}
