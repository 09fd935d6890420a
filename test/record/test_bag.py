import itertools
import os

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from shipcrane_twin.cosim.topics import BY_NAME
from shipcrane_twin.record.bag import BagWriter
from shipcrane_twin.record.read import read_signals
from shipcrane_twin.record.rescue import is_broken, rescue_bag
from shipcrane_twin.ros.cdr import Template

TOPICS = tuple(BY_NAME[name] for name in ("/clock", "/vessel/odom", "/winch/joint_states"))
STEP_NS = 20_000_000
METADATA = {"scenario": "title: x\n", "version": "0", "seed": "3"}


def open_bag(folder, compression="zstd", chunk_kib=16):
    return BagWriter(folder, TOPICS, compression=compression, chunk_kib=chunk_kib, metadata=METADATA)


def messages(steps):
    """Yield topic, time and bytes of a little run with numbers that do not compress away."""
    templates = [(topic, Template(topic)) for topic in TOPICS]
    random = np.random.default_rng(5)
    for step, (topic, template) in itertools.product(range(steps), templates):
        values = random.normal(size=0 if topic.name == "/clock" else topic.width)
        yield topic.name, step * STEP_NS, template.encode(step * STEP_NS, values)


def write(bag, steps):
    written = list(messages(steps))
    for message in written:
        bag.write(*message)
    return written


def read_all(folder):
    with AnyReader([folder]) as reader:
        return [(connection.topic, log_ns, bytes(raw)) for connection, log_ns, raw in reader.messages()]


@pytest.mark.parametrize("compression", ["zstd", "none"])
def test_rosbags_and_mcap_read_what_was_written(compression, tmp_path):
    bag = open_bag(tmp_path / "bag", compression)
    written = write(bag, 200)
    bag.close()
    assert read_all(tmp_path / "bag") == written
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        found = [(channel.topic, message.log_time, message.data) for _, channel, message in reader.iter_messages()]
        times = {message.publish_time - message.log_time for _, _, message in reader.iter_messages()}
        (kept,) = [record.metadata for record in reader.iter_metadata()]
    assert found == written
    assert times == {0}
    assert kept == METADATA
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd" if compression == "zstd" else ""}
    assert len(summary.chunk_indexes) > 3
    assert all(chunk.uncompressed_size < 17 * 1024 for chunk in summary.chunk_indexes)


def test_every_definition_is_whole(tmp_path):
    open_bag(tmp_path / "bag").close()
    with AnyReader([tmp_path / "bag"]) as reader:
        bare = get_typestore(Stores.EMPTY)
        for connection in reader.connections:
            bare.register(reader.typestore.fielddefs | {})
            assert connection.msgtype in bare.types
            assert connection.digest == get_typestore(Stores.ROS2_JAZZY).hash_rihs01(connection.msgtype)


def test_metadata_counts_and_times(tmp_path):
    bag = open_bag(tmp_path / "bag")
    write(bag, 30)
    bag.close()
    info = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert info["message_count"] == 90
    assert [topic["message_count"] for topic in info["topics_with_message_count"]] == [30, 30, 30]
    assert info["duration"] == {"nanoseconds": 29 * STEP_NS}
    assert info["files"][0]["message_count"] == 90
    assert info["version"] == 9
    assert info["ros_distro"] == "jazzy"
    assert info["custom_data"] == METADATA


def test_a_bag_without_messages_is_a_bag(tmp_path):
    open_bag(tmp_path / "bag").close()
    assert read_all(tmp_path / "bag") == []
    assert set(read_signals(tmp_path / "bag").counts.values()) == {0}


def test_a_bag_is_never_written_over(tmp_path):
    open_bag(tmp_path / "bag").close()
    with pytest.raises(FileExistsError):
        open_bag(tmp_path / "bag")


def killed_bag(folder, steps):
    """Leave a bag as a process leaves it that is killed; return what it was given."""
    child = os.fork()
    if child == 0:
        write(open_bag(folder), steps)
        os._exit(1)
    os.waitpid(child, 0)
    return list(messages(steps))


def rescue(folder):
    return rescue_bag(folder, TOPICS, compression="zstd", chunk_kib=16, metadata=METADATA)


def test_a_killed_recorders_bag_is_mended_up_to_its_last_chunk(tmp_path):
    written = killed_bag(tmp_path / "bag", 400)
    assert is_broken(tmp_path / "bag")
    saved = rescue(tmp_path / "bag")
    assert not is_broken(tmp_path / "bag")
    assert len(written) * 0.5 < saved < len(written)
    assert read_all(tmp_path / "bag") == written[:saved]
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


@pytest.mark.parametrize("cut", [0, 5, 40, 3000, 20_000])
def test_a_bag_that_is_cut_anywhere_is_mended(cut, tmp_path):
    written = killed_bag(tmp_path / "bag", 400)
    file = tmp_path / "bag" / "bag_0.mcap"
    os.truncate(file, cut)
    saved = rescue(tmp_path / "bag")
    assert read_all(tmp_path / "bag") == written[:saved]


def test_a_bag_with_a_spoilt_chunk_is_mended_up_to_it(tmp_path):
    written = killed_bag(tmp_path / "bag", 400)
    file = tmp_path / "bag" / "bag_0.mcap"
    with file.open("r+b") as stream:
        stream.seek(file.stat().st_size // 2)
        stream.write(bytes(4096))
    saved = rescue(tmp_path / "bag")
    assert 0 < saved < len(written) * 0.7
    assert read_all(tmp_path / "bag") == written[:saved]


def test_a_closed_bag_is_not_broken(tmp_path):
    open_bag(tmp_path / "bag").close()
    assert not is_broken(tmp_path / "bag")
    assert not is_broken(tmp_path / "nothing")
