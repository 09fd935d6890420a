import configparser
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest

import shipcrane_twin

ROOT = Path(__file__).resolve().parents[1]
NODES = ["anti_sway", "clock", "crane", "environment", "heave_compensation", "payload", "recorder", "vessel"]
# What ./twin calls besides Python, and the tool that the simulated Pythons below are written in.
TOOLS = ["sh", "cat", "cksum", "date", "dirname", "find", "ls", "mkdir", "readlink", "rm", "tail"]


def setup_cfg():
    settings = configparser.ConfigParser()
    settings.read(ROOT / "setup.cfg")
    return settings


def test_name_and_version_agree_everywhere():
    manifest = ET.parse(ROOT / "package.xml").getroot()
    metadata = setup_cfg()["metadata"]
    name = shipcrane_twin.__name__

    assert [manifest.findtext("name"), metadata["name"]] == [name, name]
    assert manifest.findtext("version") == metadata["version"] == shipcrane_twin.__version__
    assert manifest.findtext("description") == metadata["description"]
    assert manifest.findtext("license") == metadata["license"]
    assert (ROOT / "resource" / name).is_file()


def test_every_requirement_has_both_bounds_or_one_exact_version():
    options = setup_cfg()
    blocks = [options["options"]["install_requires"], *options["options.extras_require"].values()]
    listed = [line for block in blocks for line in block.split("\n") if line]

    assert len(listed) > 15
    assert [line for line in listed if "==" not in line and not (">=" in line and ",<" in line)] == []


def test_manifest_names_every_ros_package_that_is_imported():
    packages = {"rclpy", "rcl_interfaces", "builtin_interfaces", "launch", "launch_ros", "std_srvs"}
    imported = set()
    for path in [*ROOT.glob("shipcrane_twin/**/*.py"), *ROOT.glob("launch/*.py")]:
        for line in path.read_text(encoding="utf-8").splitlines():
            words = line.replace(".", " ").split()
            if len(words) > 1 and words[0] in {"from", "import"}:
                imported |= {words[1]} if words[1] in packages or words[1].endswith("_msgs") else set()
    manifest = ET.parse(ROOT / "package.xml").getroot()

    assert imported - {node.text for node in manifest.findall("exec_depend")} == set()


def test_every_code_folder_is_a_package():
    folders = {path.parent for path in (ROOT / "shipcrane_twin").rglob("*.py")}

    assert [folder for folder in folders if not (folder / "__init__.py").is_file()] == []


def test_nodes_and_launchers_match_one_to_one():
    modules = [
        path.stem
        for path in (ROOT / "shipcrane_twin" / "nodes").glob("*.py")
        if "\ndef main(" in path.read_text(encoding="utf-8")
    ]
    launchers = [path for path in (ROOT / "executables").iterdir() if not path.name.startswith("_")]

    assert sorted(modules) == sorted(path.name for path in launchers) == NODES
    assert all(os.access(path, os.X_OK) for path in launchers)


def test_launcher_becomes_the_python_of_its_own_prefix(tmp_path):
    """Signals sent to the launcher must reach the node, so its process id has to stay."""
    for folder in ["bin", "lib/shipcrane_twin"]:
        (tmp_path / folder).mkdir(parents=True)
    launcher = shutil.copy(ROOT / "executables" / "vessel", tmp_path / "lib/shipcrane_twin")
    python = tmp_path / "bin" / "python3"
    python.write_text('#!/bin/sh\necho "$$ $*"\n')
    python.chmod(0o755)

    with subprocess.Popen([launcher, "--ros-args"], stdout=subprocess.PIPE, text=True) as process:
        printed, _ = process.communicate(timeout=10)

    assert printed == f"{process.pid} -m shipcrane_twin.nodes.vessel --ros-args\n"


def start_twin(tmp_path, pythons, **environment):
    """Run ./twin where PATH has the tools it calls and nothing else but the given scripts."""
    path = tmp_path / "path"
    path.mkdir()
    for tool in TOOLS:
        (path / tool).symlink_to(shutil.which(tool))
    for name, body in pythons.items():
        (path / name).write_text(f"#!/bin/sh\n{body}\n")
        (path / name).chmod(0o755)
    return subprocess.run(
        [ROOT / "twin", "list"],
        env={"PATH": str(path), "TWIN_VENV": str(tmp_path / "venv"), **environment},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.parametrize(
    ("pythons", "found"),
    [
        ({}, "none"),
        ({"python3": "echo 3.9"}, "python3 is 3.9"),
        ({"python3.12": "exit 127", "python3": "echo 3.13"}, "python3 is 3.13"),
        ({"python3": 'case $2 in *ensurepip*) exit 1;; esac; echo 3.11'}, "without the modules venv"),
    ],
)
def test_twin_without_a_fitting_python_says_what_it_found(tmp_path, pythons, found):
    done = start_twin(tmp_path, pythons)

    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("twin:") == 1
    assert "needs Python 3.11 or 3.12" in done.stderr
    assert found in done.stderr
    assert not (tmp_path / "venv").exists()


def test_twin_leaves_a_folder_alone_that_it_did_not_make(tmp_path):
    (tmp_path / "venv").mkdir()
    (tmp_path / "venv" / "letters").write_text("mine")

    done = start_twin(tmp_path, {"python3": f'exec "{sys.executable}" "$@"'})

    assert done.returncode == 2
    assert "was not made by this script" in done.stderr
    assert (tmp_path / "venv" / "letters").read_text() == "mine"


def test_twin_shows_the_end_of_the_log_when_a_stage_fails(tmp_path):
    body = f'case "$*" in *"-m venv"*) echo no space left; exit 1;; esac; exec "{sys.executable}" "$@"'

    done = start_twin(tmp_path, {"python3": body})

    assert done.returncode == 2
    assert "no space left" in done.stderr
    assert str(tmp_path / "venv/.twin/install.log") in done.stderr


@pytest.mark.slow
def test_wheel_carries_the_files_and_keeps_launchers_executable(tmp_path):
    source = tmp_path / "source"
    leave_out = shutil.ignore_patterns(".*", "*.egg-info", "build", "install", "log", "runs")
    shutil.copytree(ROOT, source, symlinks=True, ignore=leave_out)
    pip_wheel = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip_wheel, "-w", tmp_path, source], check=True, capture_output=True, timeout=300)

    with zipfile.ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        mode = {
            info.filename.partition(".data/data/")[2]: info.external_attr >> 16
            for info in wheel.infolist()
            if ".data/data/" in info.filename
        }

    assert [name for name in NODES if not mode[f"lib/shipcrane_twin/{name}"] & 0o100] == []
    assert "share/ament_index/resource_index/packages/shipcrane_twin" in mode
    for folder in ["config", "launch", "msg_docs"]:
        expected = {p.relative_to(ROOT).as_posix() for p in (ROOT / folder).rglob("*.*") if p.is_file()}
        assert {f"share/shipcrane_twin/{name}" for name in expected if "__pycache__" not in name} <= set(mode)
