"""Integer time."""

from hypothesis import given
from hypothesis import strategies as st

from shipcrane_twin.cosim.time import NS_PER_S, seconds, stamp_parts


@given(st.integers(0, 2**62))
def test_stamp_parts_lose_nothing(time_ns):
    sec, nanosec = stamp_parts(time_ns)
    assert 0 <= nanosec < NS_PER_S
    assert sec * NS_PER_S + nanosec == time_ns


def test_seconds_are_for_physics():
    assert seconds(20_000_000) == 0.02
