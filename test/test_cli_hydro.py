"""The command line for hydrodynamic databases: what it does, and what it says to wrong input."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from imported_ships import COG, a_ship, shipx_folder, without_fit
from typer.testing import CliRunner

from shipcrane_twin import cli_hydro
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro import files, particulars
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.hydro.files import load_database, save_database
from shipcrane_twin.hydro.veres import import_veres
from shipcrane_twin.validation import checks
from shipcrane_twin.validation.page import Section

ROOT = Path(__file__).resolve().parents[1]
GUNNERUS = ROOT / "config" / "vessels" / "gunnerus"


def hydro(*words):
    """Run a command in this process and return what it came to; bad input is its exception."""
    return CliRunner(env={"COLUMNS": "250", "NO_COLOR": "1"}).invoke(cli_hydro.app, [str(word) for word in words])


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (("draught_m: 2.6 ", "draught_m: -2.6 "), r"hull.yaml: draught_m is -2.6, expected .*0"),
        (("breadth_m: 9.6", "breadht_m: 9.6"), r"hull.yaml: form.breadht_m.*did you mean breadth_m"),
        (("mesh: ", "mesh: 3 "), r"hull.yaml: "),
    ],
)
def test_build_refuses_a_wrong_hull_before_it_computes(tmp_path, change, match):
    text = (GUNNERUS / "hull.yaml").read_text()
    assert change[0] in text
    (tmp_path / "hull.yaml").write_text(text.replace(*change, 1))
    done = hydro("build", tmp_path / "hull.yaml")
    assert isinstance(done.exception, ConfigError)
    with pytest.raises(ConfigError, match=match):
        raise done.exception
    assert [path.name for path in tmp_path.iterdir()] == ["hull.yaml"]


def test_build_names_a_hull_file_that_is_not_there(tmp_path):
    done = hydro("build", tmp_path / "none.yaml")
    assert isinstance(done.exception, ConfigError)
    assert "none.yaml" in str(done.exception)


def test_show_draws_the_committed_ship_and_lists_its_periods(tmp_path):
    done = hydro("show", GUNNERUS / "hydro.nc", "--hull", GUNNERUS / "hull.yaml", "--out", tmp_path / "figures")
    assert done.exit_code == 0, done.output
    names = {path.stem for path in (tmp_path / "figures").iterdir()}
    assert {"hull", "added_mass", "damping", "memory", "excitation", "drift", "motions"} <= names
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in (tmp_path / "figures").iterdir())
    assert "R/V Gunnerus, elongated" in done.output
    assert "37, every 5 deg" in done.output
    assert "heave 4.14 s, roll 5.97 s, pitch 3.55 s" in done.output


@pytest.mark.parametrize(
    ("spoil", "match"),
    [
        (lambda data: {"volume": -data.volume}, r"ship.nc: volume is -1200, expected a positive number"),
        (
            lambda data: {"excitation": 1e-3 * data.excitation, "restoring": 1e-3 * data.restoring},
            r"ship.nc: C33 = .*SI",
        ),
        (
            lambda data: {"direction": 0.9 * data.direction},
            r"ship.nc: wave directions are .*expected rising from 0 to 180",
        ),
        (lambda data: {"added_mass": np.triu(data.added_mass)}, r"ship.nc: added_mass is asymmetric.*expected"),
    ],
    ids=["negative volume", "kN", "directions to 162 degrees", "asymmetric"],
)
def test_show_refuses_a_database_that_is_no_ships(tmp_path, monkeypatch, spoil, match):
    """Another program may write such a file; ours refuses to, so its check is taken away for once."""
    data = a_ship()
    path = tmp_path / "ship.nc"
    with monkeypatch.context() as patch:
        patch.setattr(files, "check", lambda data, where: data)
        save_database(path, dataclasses.replace(data, **spoil(data)))
    done = hydro("show", path, "--out", tmp_path / "figures")
    assert isinstance(done.exception, ConfigError)
    with pytest.raises(ConfigError, match=match):
        raise done.exception


def test_a_corrupt_file_ends_with_one_message_and_exit_code_2(tmp_path):
    whole = (GUNNERUS / "hydro.nc").read_bytes()
    path = tmp_path / "cut.nc"
    path.write_bytes(whole[: len(whole) // 2])
    done = subprocess.run(
        [sys.executable, "-m", "shipcrane_twin.cli", "hydro", "show", str(path)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200", "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: {path}: ")
    assert len(done.stderr.strip().splitlines()) == 1
    assert "build or import it again" in done.stderr


def test_import_of_the_reference_ship_reproduces_its_motions(tmp_path, tmp_path_factory):
    """With VERES's own mass, which another mass would miss."""
    folder = shipx_folder(tmp_path_factory)
    pytest.importorskip("cvxpy")
    done = hydro("import", "veres", folder, "--out", tmp_path / "veres.nc", "--validate")
    assert done.exit_code == 0, done.output
    assert "MISSED" not in done.output
    assert "heave RAO against the file's own" in done.output
    assert load_database(tmp_path / "veres.nc").volume == pytest.approx(482.03e3 / 1025.0, rel=0.01)


def test_an_import_that_misses_says_so(tmp_path, tmp_path_factory, monkeypatch):
    folder = shipx_folder(tmp_path_factory)
    monkeypatch.setattr(particulars, "import_veres", lambda source: import_veres(source, fit=without_fit))
    done = hydro("import", "veres", folder, "--out", tmp_path / "veres.nc", "--validate")
    assert isinstance(done.exception, ConfigError)
    assert "does not reproduce what its files say" in str(done.exception)
    assert "MISSED" in done.output


@pytest.mark.parametrize(
    ("words", "match"),
    [
        (("veres", "nowhere"), r"nowhere"),
        (("wamit", "ship"), r"ship: wamit leaves out the ship's particulars; give a YAML file with name, cog_m"),
        (("capytaine", "ship.nc", "--about", "about.yaml"), r"about.yaml"),
        (("veres", "nowhere", "--about", "about.yaml"), r"about.yaml: VERES's files name the particulars themselves"),
    ],
)
def test_import_names_what_is_missing(tmp_path, monkeypatch, words, match):
    monkeypatch.chdir(tmp_path)
    done = hydro("import", *words)
    assert isinstance(done.exception, ConfigError)
    with pytest.raises(ConfigError, match=match):
        raise done.exception
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("value", "code"), [(0.5, 0), (2.0, 3)])
def test_validate_ends_with_3_where_a_figure_misses(tmp_path, monkeypatch, value, code):
    asked = {}

    def sections(folder, **options):
        asked.update(options, folder=folder)
        return [Section("Part", "Words.", [Row("a figure", value, 1.0, "m")], [])], "a source"

    monkeypatch.setattr(checks, "all_sections", sections)
    done = hydro("validate", "--out", tmp_path, "--veres", tmp_path / "shipx", "--panels")
    assert done.exit_code == code
    assert ("MISSED" in done.output) == (code == 3)
    assert f"{1 - code // 3} of 1 figures hold their bars" in done.output
    assert (asked["folder"], asked["veres_folder"], asked["panels"]) == (
        tmp_path / "pictures",
        tmp_path / "shipx",
        True,
    )
    text = (tmp_path / "validation.md").read_text()
    assert "`./twin hydro validate --veres FOLDER --panels`" in text
    assert "a source" in text


def test_a_hull_file_gives_the_motions_their_inertia(tmp_path):
    """Without it usual radii of gyration are taken, and the list says so."""
    save_database(tmp_path / "ship.nc", a_ship())
    assert COG[1] == 0.0
    done = hydro("show", tmp_path / "ship.nc", "--out", tmp_path / "figures")
    assert done.exit_code == 0, done.output
    assert "usual radii of gyration" in " ".join(done.output.split())
