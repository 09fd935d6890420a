"""The 50 poses that the crane of the published co-simulation computes itself."""

from pathlib import Path

import numpy as np
import pytest

ROWS = Path(__file__).resolve().parents[2] / "../shared/reference/palfinger_kinematics.csv"


def kinematics_rows() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return actuator lengths (50, 4), joints (50, 4) and tips (50, 3), or skip the test."""
    if not ROWS.exists():
        pytest.skip("the reference table palfinger_kinematics.csv is not beside this project")
    table = np.genfromtxt(ROWS, delimiter=",", names=True)
    assert table.shape == (50,)
    groups = (
        ("slew_rad", "boom_cylinder_m", "knuckle_cylinder_m", "telescope_cylinder_m"),
        ("theta1_rad", "theta2_rad", "theta3_rad", "d4_m"),
        ("tip_x_m", "tip_y_m", "tip_z_m"),
    )
    lengths, joints, tips = (np.column_stack([table[name] for name in group]) for group in groups)
    return lengths, joints, tips
