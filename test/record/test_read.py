import shutil
from operator import attrgetter

import numpy as np
import pytest
import yaml
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.highlevel import AnyReader
from synthetic import STORE, TELEMETRY_MS, Lift, clock, cloud, joint_state, make, odometry, write_bag

from shipcrane_twin.record.read import COLUMNS, BagError, read_signals

SECOND = 10**9


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return write_bag(tmp_path_factory.mktemp("read") / "bag", Lift(duration_s=6.0, wind_speed=2.5).topics())


@pytest.fixture
def copy(bag, tmp_path):
    return shutil.copytree(bag, tmp_path / "bag")


def flatten(value):
    """All floats of a message in the order of its definition, covariances left out."""
    if isinstance(value, float):
        return [value]
    if hasattr(value, "__msgtype__") and value.__msgtype__ != "std_msgs/msg/Header":
        parts = (getattr(value, name) for name in value.__dataclass_fields__ if name != "covariance")
        return [number for part in parts for number in flatten(part)]
    return []


def test_every_message_equals_the_one_of_an_independent_reader(bag):
    signals = read_signals(bag)
    expected = {}
    with AnyReader([bag]) as reader:
        for connection, log_ns, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            expected.setdefault(connection.topic, []).append((log_ns, message))
    assert {name: len(rows) for name, rows in expected.items()} == dict(signals.counts)
    assert signals.series.keys() | signals.joints.keys() | signals.clouds.keys() == expected.keys()
    for name, series in signals.series.items():
        stamp = attrgetter("clock" if name == "/clock" else "header.stamp")
        stamps = [(stamp(m).sec * SECOND + stamp(m).nanosec) for _, m in expected[name]]
        np.testing.assert_array_equal(series.stamp_ns, stamps)
        np.testing.assert_array_equal(series.log_ns, [log_ns for log_ns, _ in expected[name]])
        assert series.values.shape == (len(stamps), len(COLUMNS[series.msgtype]))
        if name != "/clock":
            np.testing.assert_array_equal(series.values, [flatten(m) for _, m in expected[name]])
            assert series.frame_id == expected[name][0][1].header.frame_id
    for name, joints in signals.joints.items():
        messages = [m for _, m in expected[name]]
        assert joints.names == tuple(messages[0].name)
        for attribute in ("position", "velocity", "effort"):
            numbers = np.array([getattr(m, attribute) for m in messages])
            wanted = numbers if numbers.size else np.full((len(messages), len(joints.names)), np.nan)
            np.testing.assert_array_equal(getattr(joints, attribute), wanted)


def test_columns_carry_the_numbers_their_names_say(tmp_path):
    numbers = [10, 20, 30, 0.1, 0.2, 0.3, 0.4, 1, 2, 3, 4, 5, 6]
    late = 3_000_000_000 * SECOND // 2 + 999_999_999  # more nanoseconds than an int32 of seconds can hide
    bag = write_bag(tmp_path / "bag", {"/odom": [(late, odometry(late, numbers, child="ship"))]}, chunk_s=1e9)
    series = read_signals(bag).series["/odom"]
    assert dict(zip(series.columns, series.values[0], strict=True)) == dict(
        zip("px py pz qx qy qz qw vx vy vz wx wy wz".split(), numbers, strict=True)
    )
    assert series.child_frame_id == "ship"
    assert series.stamp_ns[0] == late
    assert series.values.flags.writeable is False


def test_of_a_cloud_the_last_message_counts_by_columns(tmp_path):
    rows = np.arange(12.0).reshape(6, 2)
    messages = [(0, cloud(0, rows[:2], ("amplitude", "omega"))), (SECOND, cloud(SECOND, rows, ("amplitude", "omega")))]
    found = read_signals(write_bag(tmp_path / "bag", {"/sea": messages})).clouds["/sea"]
    assert list(found) == ["amplitude", "omega"]
    np.testing.assert_array_equal(np.column_stack(list(found.values())), rows)


def test_a_cloud_of_other_numbers_is_an_error(tmp_path):
    message = cloud(0, np.ones((1, 2)), ("x", "y"))
    message.fields[0].datatype = 7  # float32
    with pytest.raises(BagError, match="not little-endian float64"):
        read_signals(write_bag(tmp_path / "bag", {"/sea": [(0, message)]}))


def test_changing_strings_joints_and_unknown_types_are_read_too(tmp_path):
    """A free-running user may send different joints each time, or leave arrays empty."""
    text = [(k, make("std_msgs/msg/String", data="x" * k)) for k in range(3)]
    commands = [
        (0, joint_state(0, ("slew", "boom"), velocity=(0.1, 0.2))),
        (1, joint_state(1, ("boom", "winch"), velocity=(0.3, 0.4))),
        (2, joint_state(2, (), ())),
    ]
    odom = [(k, odometry(k, np.arange(13.0) + k, child="ab" * (k + 1))) for k in range(2)]
    bag = write_bag(tmp_path / "bag", {"/text": text, "/joint_command": commands, "/odom": odom})
    signals = read_signals(bag)
    assert signals.counts == {"/text": 3, "/joint_command": 3, "/odom": 2}
    assert signals.types["/text"] == "std_msgs/msg/String"
    assert "/text" not in signals.series
    joints = signals.joints["/joint_command"]
    assert joints.names == ("slew", "boom", "winch")
    nan = np.nan
    np.testing.assert_array_equal(joints.velocity, [[0.1, 0.2, nan], [nan, 0.3, 0.4], [nan, nan, nan]])
    assert np.isnan(joints.position).all()
    np.testing.assert_array_equal(signals.series["/odom"].values[:, 0], [0.0, 1.0])


def test_joints_in_another_order_keep_their_numbers(tmp_path):
    """Equal lengths, other names: nothing but the names tells that columns have changed."""
    commands = [
        (0, joint_state(0, ("slew", "boom"), velocity=(0.1, 0.2))),
        (1, joint_state(1, ("boom", "slew"), velocity=(0.3, 0.4))),
    ]
    joints = read_signals(write_bag(tmp_path / "bag", {"/command": commands})).joints["/command"]
    assert joints.names == ("slew", "boom")
    np.testing.assert_array_equal(joints.velocity, [[0.1, 0.2], [0.4, 0.3]])


def test_messages_of_a_topic_come_in_log_order(tmp_path):
    path = tmp_path / "bag"
    rows = [(k * SECOND, clock(k * SECOND)) for k in (5, 1, 3)]
    write_bag(path, {"/clock": rows}, chunk_s=1e9, as_given=True)
    series = read_signals(path).series["/clock"]
    np.testing.assert_array_equal(series.stamp_ns, np.array([1, 3, 5]) * SECOND)
    np.testing.assert_array_equal(series.log_ns, series.stamp_ns)


@pytest.mark.parametrize("message", [odometry(7, np.arange(13.0)), clock(7)])
def test_big_endian_messages_are_decoded(tmp_path, message):
    raw = bytes(STORE.serialize_cdr(message, message.__msgtype__, little_endian=False))
    path = tmp_path / "bag"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("synthetic.STORE.serialize_cdr", lambda *_: raw)
        write_bag(path, {"/topic": [(7, message)]})
    series = read_signals(path).series["/topic"]
    assert series.stamp_ns.tolist() == [7]
    np.testing.assert_array_equal(series.values[0], np.arange(float(len(series.columns))))


def damage(bag, change):
    file = bag / "bag.mcap"
    data = bytearray(file.read_bytes())
    file.write_bytes(change(data))


def zero_compressed_bytes(data):
    start = data.index(b"zstd") + 12  # behind the name of the compression and the length
    data[start : start + 64] = bytes(64)
    return data


def edit_metadata(bag, **keys):
    file = bag / "metadata.yaml"
    content = yaml.safe_load(file.read_text())
    content["rosbag2_bagfile_information"].update(keys)
    file.write_text(yaml.safe_dump(content))


BROKEN = {
    "cut in half": (lambda b: damage(b, lambda d: d[: len(d) // 2]), "cut short.*mcap recover"),
    "cut by a byte": (lambda b: damage(b, lambda d: d[:-1]), "cut short"),
    "cut to nothing": (lambda b: damage(b, lambda d: b""), "only 0 bytes"),
    "bytes of a chunk lost": (
        lambda b: damage(b, zero_compressed_bytes),
        "chunk at byte [0-9]+ is unreadable",
    ),
    "other file": (lambda b: damage(b, lambda d: b"PK" + d), "not an MCAP file"),
    "file gone": (lambda b: (b / "bag.mcap").unlink(), "missing"),
    "metadata gone": (lambda b: (b / "metadata.yaml").unlink(), "metadata.yaml is missing.*reindex"),
    "metadata odd": (lambda b: (b / "metadata.yaml").write_text("a: [b"), "not the metadata"),
    "metadata of else": (lambda b: (b / "metadata.yaml").write_text("a: 1"), "not the metadata"),
    "other storage": (lambda b: edit_metadata(b, storage_identifier="sqlite3"), "'sqlite3'.*convert"),
    "compressed files": (lambda b: edit_metadata(b, compression_mode="file"), "compression_mode"),
    "fewer messages": (lambda b: edit_metadata(b, message_count=5), "promises 5 messages"),
}


@pytest.mark.parametrize("how", BROKEN)
def test_a_damaged_bag_is_refused_with_place_and_remedy(copy, how):
    spoil, message = BROKEN[how]
    spoil(copy)
    with pytest.raises(BagError, match=message) as caught:
        read_signals(copy)
    assert str(copy) in str(caught.value)


def test_a_flipped_byte_is_caught_by_the_checksum(copy):
    with (copy / "bag.mcap").open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.NONE)
        writer.start()
        channel = writer.register_channel("/note", "cdr", 0)
        writer.add_message(channel, log_time=0, publish_time=0, data=b"a long note")
        writer.finish()
    edit_metadata(copy, message_count=1)
    assert read_signals(copy).counts == {"/note": 1}
    damage(copy, lambda data: data.replace(b"a long note", b"a lost note"))
    with pytest.raises(BagError, match=r"unreadable.*crc"):
        read_signals(copy)


def test_wrong_paths_are_explained(bag, tmp_path):
    with pytest.raises(BagError, match="does not exist"):
        read_signals(tmp_path / "nowhere")
    with pytest.raises(BagError, match="is a file"):
        read_signals(bag / "metadata.yaml")
    with pytest.raises(BagError, match=r"did you mean .*bag"):
        read_signals(bag.parent)


def test_a_message_that_is_not_its_type_is_refused(tmp_path):
    path = tmp_path / "bag"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("synthetic.STORE.serialize_cdr", lambda *_: b"\x00\x01\x00\x00garbage")
        write_bag(path, {"/odom": [(7, odometry(7, np.zeros(13)))]})
    with pytest.raises(BagError, match="/odom is not a valid nav_msgs/msg/Odometry"):
        read_signals(path)


def test_no_chunk_border_loses_a_message(tmp_path):
    topics = {"/clock": [(k, clock(k)) for k in range(0, 6 * SECOND, TELEMETRY_MS * 10**6)]}
    for chunk_s in (0.05, 0.3, 100.0):
        signals = read_signals(write_bag(tmp_path / f"bag{chunk_s}", topics, chunk_s=chunk_s))
        np.testing.assert_array_equal(signals.series["/clock"].stamp_ns, [k for k, _ in topics["/clock"]])
