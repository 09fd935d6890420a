from hypothesis import given
from hypothesis import strategies as st

from shipcrane_twin.cosim.topics import BY_NAME
from shipcrane_twin.record.collector import StepCollector

NAMES = ("/clock", "/vessel/odom", "/vessel/pose", "/crane/joint_command")
TOPICS = [BY_NAME[name] for name in NAMES]
REGULAR = NAMES[:3]
STEP_NS, EVERY, LAST = 20, 5, 12


def due(step):
    return REGULAR if step % EVERY == 0 else REGULAR[:2]


def text(topic, step):
    return f"{topic} {step}".encode()


EXPECTED = [(topic, step * STEP_NS, text(topic, step)) for step in range(LAST + 1) for topic in due(step)]


def collect(arrivals, finish=False):
    written = []
    collector = StepCollector(TOPICS, STEP_NS, EVERY, lambda *message: written.append(message))
    for message in arrivals:
        collector.add(*message)
    if finish:
        collector.flush()
    return written, collector.complete


@given(st.permutations(EXPECTED))
def test_any_order_of_arrival_gives_the_same_bag(arrivals):
    assert collect(arrivals) == (EXPECTED, LAST)


@given(st.permutations(EXPECTED), st.integers(0, len(EXPECTED)))
def test_only_whole_steps_are_written_until_the_end(arrivals, count):
    arrivals = arrivals[:count]
    written, complete = collect(arrivals)
    assert written == [message for message in EXPECTED if message[1] <= complete * STEP_NS]
    assert set(written) <= set(arrivals)
    missing = [message for message in EXPECTED if message not in arrivals]
    assert complete == (min(time for _, time, _ in missing) // STEP_NS - 1 if missing else LAST)


@given(st.permutations(EXPECTED), st.integers(0, len(EXPECTED)))
def test_a_broken_off_run_loses_nothing_that_arrived(arrivals, count):
    written, _ = collect(arrivals[:count], finish=True)
    assert written == [message for message in EXPECTED if message in arrivals[:count]]


def test_what_has_no_rate_is_written_at_once():
    command = ("/crane/joint_command", 7, b"go")
    assert collect([command]) == ([command], -1)
