"""Schemes: what is late and what is not, and that the order of computing cannot matter."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.coupling import CHAIN, FEEDBACK, INPUTS, SCHEMES
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.participant import Participant, state_digest
from shipcrane_twin.cosim.topics import BY_NAME, CLOUD, JOINTS, TOPICS, published_by

BUSY = [
    "duration_s=1.0",
    "dp.enabled_at_s=0.0",
    "environment.current_speed_m_s=0.5",
    "environment.wind_speed_m_s=5.0",
    "operations.0.from_s=0.1",
    "operations.3.from_s=0.2",
    "events.0.at_s=0.5",
]
SCENARIO = load_scenario("case2", BUSY)
SCHEME = SCHEMES[SCENARIO.coupling]


def inline_digest(scenario):
    run = InlineRun(scenario)
    for _ in run.steps():
        pass
    return run.digest


def inputs_by_stamp(name, k, published):
    """Inputs of a step, each of the stamp that the scheme asks for; None while one is missing."""
    stamps = {topic: k - SCHEME.lag(name, BY_NAME[topic].publisher) for topic in INPUTS[name]} if k else {}
    if any((topic, stamp) not in published for topic, stamp in stamps.items()):
        return None
    return {topic: published[topic, stamp] for topic, stamp in stamps.items()}


def stamped_digest(scenario, rng, run_ahead):
    """Digest of a run in which whoever can step may be the next to do so."""
    parts = {name: Participant(name, scenario) for name in CHAIN}
    published = {}
    while min(part.step for part in parts.values()) < scenario.step_count:
        slowest = min(part.step for part in parts.values())
        ready = []
        for name, part in parts.items():
            k = part.step + 1
            found = inputs_by_stamp(name, k, published)
            if found is not None and k <= min(scenario.step_count, slowest + run_ahead):
                ready.append((name, found))
        name, found = ready[rng.integers(len(ready))]
        out = parts[name].advance(found)
        published |= {(topic, parts[name].step): values.copy() for topic, values in out.items()}
    return state_digest({name: part.digest for name, part in parts.items()})


@settings(deadline=None, max_examples=8)
@given(seed=st.integers(0, 9999), run_ahead=st.integers(1, 8))
def test_any_order_of_computing_gives_the_same_digest(seed, run_ahead):
    assert stamped_digest(SCENARIO, np.random.default_rng(seed), run_ahead) == inline_digest(SCENARIO)


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES.keys())
@pytest.mark.parametrize(("consumer", "publisher"), list(itertools.permutations(CHAIN, 2)))
def test_a_neighbour_before_is_fresh_and_one_behind_a_step_old(scheme, consumer, publisher):
    before = CHAIN.index(publisher) < CHAIN.index(consumer)
    assert scheme.lag(consumer, publisher) == (0 if before else 1)


def test_feedback_names_every_link_against_the_chain():
    links = {(BY_NAME[topic].publisher, name) for name in CHAIN for topic in INPUTS[name]}
    late = {(publisher, name) for publisher, name in links if SCHEME.lag(name, publisher) == 1}
    assert late == set(FEEDBACK)


def test_inputs_are_published_every_step_by_somebody_else():
    for name in CHAIN:
        for topic in INPUTS[name]:
            assert BY_NAME[topic].rate == "step"
            assert BY_NAME[topic].publisher in set(CHAIN) - {name}


def test_outputs_have_the_width_and_the_rate_of_the_topic_table():
    seen = {}
    run = InlineRun(SCENARIO, lambda time_ns, topic, values: seen.setdefault(topic, []).append((time_ns, values)))
    for _ in run.steps():
        pass
    regular = [topic for name in CHAIN for topic in published_by(name) if topic.rate != "irregular"]
    assert set(seen) == {topic.name for topic in regular}
    for name, messages in seen.items():
        topic = BY_NAME[name]
        every = {"step": 1, "telemetry": SCENARIO.telemetry_every, "once": SCENARIO.step_count + 1}[topic.rate]
        assert [time_ns for time_ns, _ in messages] == list(range(0, 1_000_000_001, every * SCENARIO.step_ns))
        if topic.type != CLOUD:
            assert all(values.dtype == np.float64 and values.shape == (topic.width,) for _, values in messages)
        assert all(np.isfinite(values).all() for _, values in messages)


def test_topic_names_are_unique_and_joint_topics_name_their_joints():
    assert len(BY_NAME) == len(TOPICS)
    assert all(bool(topic.joints) == (topic.type == JOINTS) for topic in TOPICS)


def test_outputs_stay_as_they_were_published():
    kept = []
    run = InlineRun(SCENARIO, lambda _, topic, values: kept.append((topic, values, values.copy())))
    for _ in run.steps():
        pass
    for topic, values, copy in kept:
        np.testing.assert_array_equal(values, copy, err_msg=topic)


def test_the_same_scenario_gives_the_same_digest_again():
    assert inline_digest(SCENARIO) == inline_digest(SCENARIO)


@pytest.mark.parametrize(
    "change", ["payload.mass_kg=700.0001", "macro_step_ms=10.0", "coupling=in_turn", "events.0.at_s=0.52"]
)
def test_another_scenario_gives_another_digest(change):
    assert inline_digest(load_scenario("case2", [*BUSY, change])) != inline_digest(SCENARIO)


def test_digest_tells_every_bit_of_every_step():
    class Still:
        def __init__(self, values):
            self.values = values

        def start(self):
            return {"/a": self.values[0]}

        def step(self, k, inputs):
            return {"/a": self.values[k]}

    def digest_of(values):
        part = Participant("environment", SCENARIO)
        part.subsystem = Still(values)
        for _ in values:
            part.advance({})
        return part.digest

    values = np.ones((3, 4))
    other = values.copy()
    other[1, 2] = np.nextafter(1.0, 2.0)
    assert digest_of(values) == digest_of(values.copy())
    assert digest_of(values) != digest_of(other)
    assert digest_of(values) != digest_of(values[:2])


def test_state_digest_ignores_the_order_of_names_but_not_who_has_which():
    a, b = {"x": "1", "y": "2"}, {"y": "2", "x": "1"}
    assert state_digest(a) == state_digest(b)
    assert state_digest({"x": "2", "y": "1"}) != state_digest(a)
