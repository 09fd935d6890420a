from collections import Counter

import pytest
import yaml
from graph_runs import needs_ros
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.topics import BY_NAME, TOPICS

pytestmark = needs_ros

STEPS, STEP_NS = 1000, 20_000_000
COUNTS = {"step": STEPS + 1, "telemetry": STEPS // 5 + 1, "once": 1}


@pytest.fixture(scope="module")
def bag(graph_run):
    return graph_run[0] / "bag"


def mcap_messages(bag):
    with (bag / "bag_0.mcap").open("rb") as stream:
        yield from make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False)


def regular(bag):
    """Return topic, log time and bytes of every message with a rate, in file order."""
    return [
        (channel.topic, message.log_time, message.data)
        for _, channel, message in mcap_messages(bag)
        if BY_NAME[channel.topic].rate in COUNTS
    ]


def test_no_message_is_missing(bag):
    counts = Counter(topic for topic, _, _ in regular(bag))
    assert counts == {topic.name: COUNTS[topic.rate] for topic in TOPICS if topic.rate in COUNTS}


def test_every_message_is_logged_at_its_stamp(bag):
    times = {}
    with AnyReader([bag]) as reader:
        for connection, log_ns, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            stamp = message.clock if hasattr(message, "clock") else message.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == log_ns
            times.setdefault(connection.topic, []).append(log_ns)
    for topic in TOPICS:
        if topic.rate in COUNTS:
            every = STEP_NS * {"step": 1, "telemetry": 5, "once": STEPS + 1}[topic.rate]
            assert times[topic.name] == list(range(0, STEPS * STEP_NS + 1, every))


def test_definitions_of_all_types_are_in_the_file(bag):
    with (bag / "bag_0.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    types = {channel.topic: summary.schemas[channel.schema_id] for channel in summary.channels.values()}
    assert {name: schema.name for name, schema in types.items()} == {
        topic.name: topic.type for topic in TOPICS if topic.name != "/recorder/progress"
    }
    assert all(schema.encoding == "ros2msg" and schema.data for schema in types.values())
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}


def test_metadata_tells_what_the_file_holds(bag, lively):
    info = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    counts = Counter(channel.topic for _, channel, _ in mcap_messages(bag))
    listed = {topic["topic_metadata"]["name"]: topic["message_count"] for topic in info["topics_with_message_count"]}
    assert listed == {topic.name: counts[topic.name] for topic in TOPICS if topic.name != "/recorder/progress"}
    assert info["message_count"] == counts.total()
    assert info["storage_identifier"] == "mcap"
    assert info["relative_file_paths"] == ["bag_0.mcap"]
    assert info["starting_time"] == {"nanoseconds_since_epoch": 0}
    assert info["duration"] == {"nanoseconds": STEPS * STEP_NS}
    assert info["custom_data"]["seed"] == "1"


def test_the_bag_holds_the_scenario_that_made_it(bag, lively, tmp_path):
    info = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    copy = tmp_path / "copy.yaml"
    copy.write_text(info["custom_data"]["scenario"], encoding="utf-8")
    assert load_scenario(str(copy)) == load_scenario(str(lively))


def test_graph_and_inline_record_the_same_bytes_in_the_same_order(bag, inline_run):
    assert regular(bag) == regular(inline_run[0] / "bag")
