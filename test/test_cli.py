import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from rosbags.highlevel import AnyReader

from shipcrane_twin import cli

ROOT = Path(__file__).resolve().parents[1]

SUMMARY_KEYS = {
    "scenario": str,
    "seed": int,
    "mode": str,
    "macro_step_ms": float,
    "sim_duration_s": float,
    "wall_time_s": float,
    "real_time_factor": float,
    "messages": dict,
    "roll_deg": {"mean", "std", "min", "max"},
    "pitch_deg": {"mean", "std", "min", "max"},
    "heave_m": {"mean", "std", "min", "max"},
    "position_error_m": {"rms", "max"},
    "wire_tension_kn": {"mean", "max", "min"},
    "payload_sway_deg": {"rms", "max"},
    "state_digest": str,
}


def shipcrane(*words, cwd, program=("-m", "shipcrane_twin.cli")):
    """Run the command line in a folder and return what it came to."""
    return subprocess.run(
        [sys.executable, *program, *map(str, words)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200", "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.fixture(autouse=True)
def same_handler_for_sigterm():
    """Undo what the command line sets up for its process."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Return folder and outcome of an inline run in which DP has settled by definition."""
    folder = tmp_path_factory.mktemp("cli") / "run"
    changes = ["dp.enabled_at_s=1.0", "dp.settled_after_s=1.0"]
    sets = [word for change in changes for word in ("--set", change)]
    done = shipcrane(
        "run", "case2", "--mode", "inline", "--until", "5", "--seed", "7", "--out", folder, *sets, cwd=folder.parent
    )
    return folder, done


def test_run_leaves_everything_in_its_folder(finished):
    folder, done = finished
    assert (done.returncode, done.stderr.strip()) == (0, "")
    assert {path.name for path in folder.iterdir()} == {
        "bag",
        "figures",
        "report.html",
        "scenario.yaml",
        "summary.json",
    }
    assert str(folder / "report.html") in done.stdout


def test_summary_has_what_the_design_promises(finished):
    summary = json.loads((finished[0] / "summary.json").read_text())
    for key, kind in SUMMARY_KEYS.items():
        if isinstance(kind, set):
            assert kind <= summary[key].keys()
            assert all(isinstance(value, float) for value in summary[key].values())
        else:
            assert isinstance(summary[key], kind), key
    assert summary["seed"] == 7
    assert summary["mode"] == "inline"
    assert summary["sim_duration_s"] == 5.0
    assert summary["messages"]["/vessel/odom"] == 251
    assert len(summary["state_digest"]) == 64
    assert summary["complete"] is True


def test_scenario_yaml_repeats_the_run(finished, tmp_path):
    folder = finished[0]
    done = shipcrane(
        "run", folder / "scenario.yaml", "--mode", "inline", "--no-record", "--out", tmp_path / "again", cwd=tmp_path
    )
    assert done.returncode == 0
    again = json.loads((tmp_path / "again" / "summary.json").read_text())
    assert again["state_digest"] == json.loads((folder / "summary.json").read_text())["state_digest"]
    assert sorted(path.name for path in (tmp_path / "again").iterdir()) == ["scenario.yaml", "summary.json"]


def test_inline_bag_opens_with_rosbags(finished):
    with AnyReader([finished[0] / "bag"]) as reader:
        assert sum(1 for _ in reader.messages()) == reader.message_count > 3000


def test_report_draws_the_same_page_again(finished, tmp_path):
    folder = finished[0]
    page = folder / "report.html"
    before = page.read_text()
    page.unlink()
    done = shipcrane("report", folder, cwd=tmp_path)
    assert done.returncode == 0
    assert page.read_text() == before


def test_inline_does_not_import_ros(tmp_path):
    script = (
        "import sys\n"
        "from shipcrane_twin import cli\n"
        "try:\n"
        "    cli.main()\n"
        "except SystemExit as end:\n"
        "    assert not end.code, end.code\n"
        "print(sorted(name for name in sys.modules if name.split('.')[0] in ('rclpy', 'rcl_interfaces', 'std_msgs')))\n"
    )
    words = ("run", "case2", "--mode", "inline", "--until", "1", "--out", tmp_path / "run")
    done = shipcrane(*words, cwd=tmp_path, program=("-c", script))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"


def test_check_says_what_a_run_would_be_and_leaves_nothing(tmp_path):
    done = shipcrane("check", "case2", "--set", "macro_step_ms=50", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "case2: good. 480 s in 9600 steps of 50 ms, coupling in_turn+inertia, seed 1.\n"
    assert list(tmp_path.iterdir()) == []


def test_list_names_every_scenario_with_its_title(tmp_path):
    done = shipcrane("list", cwd=tmp_path)
    assert done.returncode == 0
    for path in (ROOT / "config" / "scenarios").glob("*.yaml"):
        title = yaml.safe_load(path.read_text())["title"]
        assert any(path.stem in line and title in line for line in done.stdout.splitlines())


def test_runs_get_numbers_of_their_own(tmp_path):
    (tmp_path / "runs" / "case2-1").mkdir(parents=True)
    done = shipcrane("run", "case2", "--mode", "inline", "--until", "0.2", "--no-record", cwd=tmp_path)
    assert done.returncode == 0
    assert (tmp_path / "runs" / "case2-2" / "summary.json").exists()
    assert list((tmp_path / "runs" / "case2-1").iterdir()) == []


RUN = ("run", "case2", "--mode", "inline", "--until", "0.2")
BAD = {
    "scenario": (("run", "case22"), ["scenario 'case22' is unknown", "did you mean case2?"]),
    "scenario file": (("run", "no/such.yaml"), ["no/such.yaml: no such scenario file", "give a path"]),
    "check scenario": (("check", "cas2"), ["scenario 'cas2' is unknown", "did you mean case2?"]),
    "key": ((*RUN, "--set", "wire.diametre_m=0.1"), ["--set: wire.diametre_m is unknown", "did you mean diameter_m?"]),
    "unit": ((*RUN, "--set", "macro_step_s=0.02"), ["--set: macro_step_s is unknown", "unit clash", "macro_step_ms"]),
    "type": ((*RUN, "--set", "payload.mass_kg=heavy"), ["--set: payload.mass_kg is 'heavy', expected"]),
    "range": ((*RUN, "--set", "payload.mass_kg=-1"), ["--set: payload.mass_kg is -1, expected"]),
    "no equals sign": ((*RUN, "--set", "seed"), ["--set 'seed': expected key=value"]),
    "step": ((*RUN, "--set", "macro_step_ms=30"), ["macro_step_ms is 30, expected a step that divides", "20, 25"]),
    "coupling": ((*RUN, "--set", "coupling=in_turns"), ["coupling is 'in_turns'", "did you mean in_turn?"]),
    "until": (("run", "case2", "--until", "-5"), ["duration_s is -5.0, expected"]),
    "until nan": (("run", "case2", "--until", "nan"), ["duration_s is 'nan', expected"]),
    "seed": ((*RUN, "--seed", "-1"), ["seed is -1, expected"]),
    "speed word": ((*RUN, "--speed", "fast"), ["--speed is 'fast', expected max or a number above 0"]),
    "speed zero": ((*RUN, "--speed", "0"), ["--speed is '0', expected max or a number above 0"]),
    "speed negative": ((*RUN, "--speed=-2"), ["--speed is '-2', expected max or a number above 0"]),
    "speed nan": ((*RUN, "--speed", "nan"), ["--speed is 'nan', expected max or a number above 0"]),
    "out not empty": ((*RUN, "--out", "full"), ["--out full: the folder is not empty", "name another"]),
    "out below a file": ((*RUN, "--out", "file/run"), ["the run's folder cannot be written", "--out DIR"]),
    "out is a file": ((*RUN, "--out", "file"), ["the run's folder cannot be written", "--out DIR"]),
    "report nowhere": (("report", "nowhere"), ["nowhere"]),
    "report without bag": (("report", "full"), ["full"]),
    "option": ((*RUN, "--sped", "1"), ["No such option: --sped", "--speed"]),
    "mode": (("run", "case2", "--mode", "grph"), ["grph", "graph", "inline"]),
    "command": (("rnu", "case2"), ["No such command 'rnu'"]),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input_gives_one_message_and_starts_nothing(what, tmp_path, monkeypatch, capfd):
    words, expected = BAD[what]
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    (tmp_path / "file").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["shipcrane", *words])
    with pytest.raises(SystemExit) as end:
        cli.main()
    out, err = capfd.readouterr()
    assert (end.value.code, out) == (2, "")
    assert [part for part in expected if part not in err] == [], err
    assert err.lower().count("error: ") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_bad_input_ends_the_process_with_code_2_and_no_traceback(tmp_path):
    done = shipcrane("run", "case2", "--set", "dp.period=1", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: --set: dp.period is unknown; unit clash: this setting is period_ms")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
