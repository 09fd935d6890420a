import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "shipcrane_twin"
ASK = (
    "import numpy as np; from shipcrane_twin.physics.vessel import add_momentum_bias; load = np.zeros(6);"
    "add_momentum_bias(load, np.eye(6), np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])); print(load[0])"
)


def bias(folder):
    env = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-c", ASK], cwd=folder, env=env | {"PYTHONPATH": str(folder)}, capture_output=True, text=True
    )
    return float(done.stdout)


@pytest.mark.slow
def test_a_change_in_one_kernel_reaches_those_it_is_compiled_into(tmp_path):
    copy = tmp_path / "shipcrane_twin"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    before = bias(tmp_path)
    algebra = copy / "physics" / "linalg.py"
    text = algebra.read_text()
    changed = text.replace("(matrix[i, 0] * x[0]", "(7.0 + matrix[i, 0] * x[0]")
    assert changed != text
    algebra.write_text(changed)
    assert bias(tmp_path) == pytest.approx(before + 7.0)
    assert len(list((copy / "__pycache__").glob("kernels-*"))) == 1
