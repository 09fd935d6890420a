import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent
NAME = "shipcrane_twin"
NODES = sorted(path.stem for path in (ROOT / NAME / "nodes").glob("[a-z]*.py"))

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """Return the install prefix of the package after ``colcon build``."""
    pytest.importorskip("colcon_core", reason="colcon is not installed (extra: test)")
    workspace = tmp_path_factory.mktemp("workspace")
    shutil.copytree(
        ROOT,
        workspace / "src" / NAME,
        symlinks=True,
        ignore=shutil.ignore_patterns(".*", "__pycache__", "*.egg-info", "build", "install", "log", "runs"),
    )
    done = subprocess.run(
        [BIN / "colcon", "build", "--event-handlers", "console_direct+", "desktop_notification-"],
        cwd=workspace,
        env={**os.environ, "COLCON_HOME": str(workspace / "home")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return workspace / "install" / NAME


def test_package_is_in_the_index(prefix):
    assert (prefix / "share/ament_index/resource_index/packages" / NAME).is_file()
    assert (prefix / "share" / NAME / "package.xml").is_file()


def test_every_node_is_where_ros2_run_looks(prefix):
    launchers = {path.name: path for path in (prefix / "lib" / NAME).iterdir()}

    assert sorted(launchers) == NODES
    assert all(os.access(path, os.X_OK) for path in launchers.values())


@pytest.mark.parametrize("folder", ["config", "launch", "msg_docs"])
def test_files_are_installed_under_share(prefix, folder):
    def files(top):
        return {p.relative_to(top) for p in (top / folder).rglob("*.*") if p.is_file() and p.suffix != ".pyc"}

    assert files(prefix / "share" / NAME) == files(ROOT) != set()


@pytest.mark.skipif(" " in sys.executable, reason="colcon's setup.sh does not quote the path of Python")
def test_sourced_workspace_runs_the_installed_code(prefix):
    script = f"command -v shipcrane; python3 -c 'import {NAME}; print({NAME}.__file__)'"
    done = subprocess.run(
        ["sh", "-c", f". ./install/setup.sh && {script}"],
        cwd=prefix.parents[1],
        env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=60,
    )

    assert done.returncode == 0, done.stderr
    command, module = done.stdout.splitlines()
    assert Path(command).is_relative_to(prefix)
    assert Path(module).is_relative_to(prefix)
