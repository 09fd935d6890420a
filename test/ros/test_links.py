import struct

import pytest

from shipcrane_twin.ros.cdr import CdrError, read_stamp

HEAD = b"\x00\x01\x00\x00"



@pytest.mark.parametrize("raw", [b"", HEAD, HEAD + b"\x01" * 7, HEAD + struct.pack("<iI", -1, 0)])
def test_a_message_without_a_usable_stamp_is_an_error(raw):
    with pytest.raises(CdrError, match="stamp"):
        read_stamp(raw)


class Arrivals:
    """Stands where rclpy's subscription handle stands."""

    def __init__(self, *messages):
        self.messages = list(messages)

    def take_message(self, kind, raw):
        return (self.messages.pop(0), {}) if self.messages else None


def stamped(time_ns, content=b""):
    return HEAD + struct.pack("<iI", time_ns // 10**9, time_ns % 10**9) + content


@pytest.fixture
def inbox():
    pytest.importorskip("rclpy", reason="rclpy is not installed (extra: ros)")
    from shipcrane_twin.ros.links import Inbox

    inbox = Inbox.__new__(Inbox)  # without a node: only what has arrived matters here
    inbox.kind, inbox.waiting, inbox.handle = None, {}, Arrivals()
    return inbox


@pytest.mark.ros
def test_messages_are_found_by_stamp_whatever_their_order(inbox):
    inbox.handle = Arrivals(stamped(40, b"c"), stamped(0, b"a"), HEAD, stamped(20, b"b"))
    assert inbox.has(20)
    assert not inbox.has(60)
    assert [inbox.pop(time_ns)[-1:] for time_ns in (0, 20, 40)] == [b"a", b"b", b"c"]


@pytest.mark.ros
def test_an_inbox_forgets_what_nobody_will_ask_for(inbox):
    from shipcrane_twin.ros.links import LOOP_DEPTH

    inbox.handle = Arrivals(*(stamped(k) for k in range(3 * LOOP_DEPTH)))
    assert inbox.has(3 * LOOP_DEPTH - 1)
    inbox.pop(3 * LOOP_DEPTH - 1)
    assert inbox.waiting == {}


@pytest.mark.ros
def test_the_queue_is_deeper_than_the_clock_can_lead():
    pytest.importorskip("rclpy", reason="rclpy is not installed (extra: ros)")
    from shipcrane_twin.cosim.pacing import RECORDER_LEAD_STEPS
    from shipcrane_twin.ros.links import LOOP_DEPTH

    most_run_ahead = 50  # the upper end of lockstep.run_ahead_steps
    assert most_run_ahead + RECORDER_LEAD_STEPS < LOOP_DEPTH
