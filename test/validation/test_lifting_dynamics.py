"""Cranes of the package: dynamics against an independent library, energy, work in a lift, servos, structure."""

import numpy as np
import pytest
from typer.testing import CliRunner

from shipcrane_twin import cli
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation import lifting_abuse as abuse
from shipcrane_twin.validation import lifting_energy as energy
from shipcrane_twin.validation import lifting_page as page
from shipcrane_twin.validation import lifting_servo as servo
from shipcrane_twin.validation import lifting_structure as structure
from shipcrane_twin.validation.lifting import CRANES, machine
from shipcrane_twin.validation.page import Picture, Section

LIFT = (
    "duration_s=30.0",
    "operations=[{label: up, joint: boom, from_s: 2.0, to_s: 12.0, velocity_rad_s: 0.02},"
    "{label: in, joint: telescope, from_s: 12.0, to_s: 18.0, velocity_m_s: -0.05},"
    "{label: slew, joint: slew, from_s: 14.0, to_s: 24.0, velocity_rad_s: -0.04}]",
    "events=[{label: drop, at_s: 26.0, event: release_payload}]",
)


@pytest.fixture(scope="module")
def cranes():
    return {name: machine(name) for name in CRANES}


def hold(rows, measured):
    for row in rows:
        if row.bar is not None:
            measured(f"crane: {row.what}", row.value, row.bar, row.unit)


def test_dynamics_of_both_cranes_are_those_of_pinocchio(cranes, measured):
    pytest.importorskip("pinocchio", reason="Pinocchio, the independent library, is not installed")
    for name, crane in cranes.items():
        rows = page.dynamics_rows(name, crane)
        assert len(rows) == 7
        hold(rows, measured)


def test_both_cranes_keep_their_energy(cranes, measured):
    for name, crane in cranes.items():
        found = energy.dropped(crane, energy.kick_of(crane), 40)
        assert np.ptp(found.kinetic) > 500.0
        hold(energy.swing_rows(name, found), measured)


def test_energy_that_is_lost_is_seen(cranes):
    crane = energy.undamped(cranes["Palfinger"])
    lossy = crane._replace(actuators=crane.actuators._replace(damping=1e-4 * crane.actuators.stiffness))
    state = structure.loaded_state(lossy, np.array(lossy.scenario.crane.initial_joints), 0.0)
    state[4:8] = 0.1
    found = energy.swing(lossy.chain, lossy.actuators, lossy.limits, state, 5)
    assert not energy.swing_rows("lossy", found)[0].holds


def test_work_in_a_lift_is_the_change_of_energy(measured):
    found = energy.lift_work("case3_e2", LIFT)
    assert np.ptp(found.actuators) > 2e4
    hold(energy.work_rows(found), measured)
    assert not energy.work_rows(found._replace(base=1.2 * found.base))[0].holds
    assert not energy.work_rows(found._replace(wire=0.99 * found.wire))[0].holds


def test_servos_follow_under_full_load_and_roll(cranes, measured):
    for name, crane in cranes.items():
        hold(servo.servo_rows(name, servo.responses(crane)), measured)


def test_a_servo_that_overshoots_or_stays_behind_is_seen(cranes):
    crane = cranes["Palfinger"]
    soft = crane._replace(
        actuators=crane.actuators._replace(
            stiffness=0.1 * crane.actuators.stiffness, damping=0.0 * crane.actuators.damping
        )
    )
    assert servo.respond(soft, 0, 1.0, 0.0).overshoot > servo.OVERSHOOT_BAR
    run = servo.respond(crane, 3, 1.0, 0.0)
    assert not servo.servo_rows("x", {"y": {0.0: run._replace(rate=0.98 * run.rate)}})[1].holds


def test_roll_of_the_ship_has_exact_derivatives():
    h = 1e-4
    for t in (3.0, 7.9, 20.3):
        rolls = [2.0 * np.arcsin(servo.rolling(t + k * h, 5.0)[0][3]) for k in (-1, 0, 1)]
        odom, accel = servo.rolling(t, 5.0)
        assert odom[10] == pytest.approx((rolls[2] - rolls[0]) / (2 * h), abs=1e-6)
        assert accel[3] == pytest.approx((rolls[2] - 2 * rolls[1] + rolls[0]) / h**2, abs=1e-5)


def test_references_keep_their_limits_whatever_is_told(cranes, measured):
    for name, crane in cranes.items():
        hold(abuse.reference_rows(name, abuse.referenced(crane)), measured)


def test_limits_that_are_passed_are_seen():
    rows = abuse.reference_rows("x", (2e-3, 0.1, 0.2))
    assert not any(row.holds for row in rows)
    assert all(row.holds for row in abuse.reference_rows("x", (-1.0, -0.1, -0.2)))


def test_limiter_telescope_end_and_failures(cranes, measured):
    crane = cranes["Palfinger"]
    hold(structure.overload_rows(structure.overload()), measured)
    hold(structure.telescope_rows(crane, structure.telescope(crane)), measured)
    end, failed = structure.to_the_end(crane), structure.failures(crane)
    hold(structure.failure_rows(crane, end, failed), measured)
    fall = {name: run.length[-1, 1] - run.length[500, 1] for name, run in failed.items()}
    assert fall["power stays"] > 0.05
    assert fall["coasts"] < fall["leaks"] < -0.01
    assert end.length[-1, 1] > crane.limits.drives.length_max[1] - 0.011


def test_kinematics_table_is_read_or_refused(cranes, tmp_path):
    crane = cranes["Palfinger"]
    q = np.array(crane.scenario.crane.initial_joints)
    lengths = structure.lengths_from_joints(crane.limits.drives, q)
    tip = structure.forward_kinematics(crane.chain, q)[0][-1]
    path = tmp_path / "poses.csv"
    names = (*structure.LENGTHS, *structure.JOINTS, *structure.TIP)
    line = ",".join(repr(float(v)) for v in (*lengths, *q, *tip))
    path.write_text("\n".join([",".join(names), line, line]))
    assert all(row.holds for row in structure.kinematics_rows(path, crane))
    off = ",".join(repr(float(v)) for v in (*lengths, *q, *(tip + 1e-5)))
    path.write_text("\n".join([",".join(names), off, off]))
    assert [row.holds for row in structure.kinematics_rows(path, crane)] == [True, False]
    path.write_text("a,b\n1,2\n3,4\n")
    with pytest.raises(ConfigError, match="expected the columns"):
        structure.kinematics_rows(path, crane)


def test_page_says_what_is_left_out(tmp_path):
    picture = Picture(tmp_path / "pictures" / "crane_a.png", "What to see.")
    sections = [Section("Part", "Words.", [Row("one", 1.0, 2.0, "m")], [picture]), Section("None", "Left out.", [], [])]
    text = page.write_page(sections, "./twin crane validate", tmp_path).read_text(encoding="utf-8")
    assert text.startswith("# Validation of crane and load\n")
    assert "1 of 1 figures" in text
    assert "| [None](#none) | left out |" in text


@pytest.mark.parametrize(("value", "code"), [(1.0, 0), (3.0, 3)])
def test_the_command_writes_the_page_and_says_whether_all_holds(value, code, tmp_path, monkeypatch):
    asked = {}

    def sections(folder, **options):
        asked.update(options, folder=folder)
        return [Section("Part", "Words.", [Row("one", value, 2.0, "m")], [])]

    monkeypatch.setattr(page, "all_sections", sections)
    words = ["crane", "validate", "--out", str(tmp_path), "--kinematics", "poses.csv"]
    assert CliRunner().invoke(cli.app, words).exit_code == code
    assert asked["folder"] == tmp_path / "pictures"
    assert str(asked["kinematics"]) == "poses.csv"
    assert "--kinematics FILE`" in (tmp_path / "validation_crane.md").read_text(encoding="utf-8")
