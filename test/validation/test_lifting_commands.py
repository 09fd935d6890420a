"""Random commands to the whole twin, and compensation in waves and in a quarter turn."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from shipcrane_twin.validation import lifting_abuse as abuse
from shipcrane_twin.validation import lifting_control as control
from shipcrane_twin.validation.lifting import machine

numbers = st.floats(allow_nan=True, allow_infinity=True) | st.sampled_from([0.02, -0.02, 0.5, -0.5, 1e300])
names = st.sampled_from(["slew", "boom", "knuckle", "telescope", "winch", "gripper", "", "Winch"])
messages = st.lists(st.tuples(st.lists(names, max_size=6), st.lists(numbers, max_size=6)), max_size=20)


def hold(rows, measured):
    for row in rows:
        if row.bar is not None:
            measured(f"crane: {row.what}", row.value, row.bar, row.unit)


def test_ten_thousand_steps_of_nonsense_break_nothing(measured):
    found = abuse.abused()
    assert len(found.time_s) == 10_001
    assert found.limits.refused > 1000
    assert found.limits.taken > 10_000
    assert np.ptp(found.lengths, axis=0).min() > 0.1  # every joint did move
    assert np.ptp(found.wire) > 2.0
    hold(abuse.abuse_rows(found), measured)


@settings(deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow])
@given(spells=st.lists(messages, min_size=1, max_size=8))
def test_no_message_breaks_anything(spells):
    found = abuse.abused(lambda k: spells[k // 10 % len(spells)], steps=80)
    assert all(row.holds for row in abuse.abuse_rows(found))


def test_what_is_beyond_a_limit_is_seen():
    scenario = machine("Palfinger").scenario
    still = np.tile([[0.0, 1.5, 1.5, 4.0]], (3, 1))
    wires = np.array([[1.0, 0.0, 0.0]] * 3)
    fine = abuse.beyond(scenario, still, 0.0 * still, 0.0 * still, wires)
    assert max(fine[:6]) <= 0.0
    far, fast, strong = still.copy(), 0.0 * still, 0.0 * still
    far[1, 1], fast[1, 2], strong[1, 3] = 1.81, 0.02, 1e6
    wild = wires + [[0.0, 0.0, 0.0], [0.0, 0.6, 0.0], [-0.9, 0.0, 0.0]]
    found = abuse.beyond(scenario, far, fast, strong, wild)
    assert found.end == pytest.approx(0.01)
    assert found.speed == pytest.approx(1.0)
    assert found.force > 0.0
    assert found.wire == pytest.approx(0.1)
    assert found.pay_out == pytest.approx(0.1)
    assert found.change == pytest.approx(0.6 - 0.005)


@pytest.mark.parametrize("length", [10.0, 80.0])
def test_heave_compensation_holds_the_load_on_any_wire(length, measured):
    hold(control.heave_rows({length: control.held_load(length, 260.0)}), measured)


def test_a_load_that_is_not_compensated_is_seen():
    rows = control.heave_rows({20.0: control.held_load(20.0, 200.0, compensated=False)})
    assert not any(row.holds for row in rows)


def test_anti_sway_leaves_little_sway(measured):
    runs = control.slewed()
    hold(control.sway_rows(runs), measured)
    assert not control.sway_rows(runs | {"with": runs["without"]})[0].holds
