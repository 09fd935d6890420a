"""The winch: limits, ends, drum and layers, what motor, brake and leak hold."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from wire_rig import WINCH

from shipcrane_twin.physics.winch import braking_speed, winch_speed

compiled = settings(deadline=None)


@settings(deadline=None, max_examples=200)
@given(
    commands=st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=30),
    start=st.floats(0.2, 5.0),
    step_s=st.sampled_from([0.005, 0.02, 0.05, 0.1, 0.2]),
)
@example(commands=[2.0], start=4.0, step_s=0.2)
@example(commands=[-2.0], start=1.0, step_s=0.2)
def test_winch_keeps_speed_acceleration_and_ends(commands, start, step_s):
    winch = WINCH._replace(length_max=5.0)
    length, speed = start, 0.0
    for command in np.repeat(commands, max(1, round(3.0 / step_s / len(commands)))):
        after = winch_speed(winch, length, speed, command, step_s)
        assert abs(after) <= winch.speed_max
        assert abs(after - speed) <= winch.accel_max * step_s * (1.0 + 1e-9)
        length += 0.5 * (speed + after) * step_s
        assert winch.length_min - 1e-9 <= length <= winch.length_max + 1e-9
        speed = after


@pytest.mark.parametrize("command", [0.3, -0.3])
def test_winch_reaches_and_keeps_the_commanded_speed(command):
    length, speed = 50.0, 0.0
    for k in range(1, 101):
        speed = winch_speed(WINCH, length, speed, command, 0.02)
        assert abs(speed) == pytest.approx(min(0.3, k * 0.02 * WINCH.accel_max))
    assert np.sign(speed) == np.sign(command)


@pytest.mark.parametrize(("command", "end"), [(1.0, WINCH.length_max), (-1.0, WINCH.length_min)])
def test_winch_runs_right_up_to_its_ends_and_stops(command, end):
    length, speed = end - np.sign(command) * 2.0, 0.0
    for _ in range(1000):
        after = winch_speed(WINCH, length, speed, command, 0.02)
        length += 0.5 * (speed + after) * 0.02
        speed = after
    assert length == pytest.approx(end, abs=1e-3)
    assert speed == pytest.approx(0.0, abs=1e-3)


@compiled
@given(room=st.floats(0.0, 10.0), step_s=st.floats(0.005, 0.2))
def test_braking_speed_uses_up_the_room(room, step_s):
    speed = braking_speed(room, 0.25, step_s)
    assert speed * step_s + speed**2 / 0.5 == pytest.approx(room, abs=1e-12)
