import struct

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from shipcrane_twin.cosim.topics import CLOCK, CLOUD, DIAGNOSTICS, IMU, JOINTS, ODOMETRY, TOPICS, Topic
from shipcrane_twin.ros.cdr import CdrError, Template, read_joint_command, read_stamp, read_stamped

STORE = get_typestore(Stores.ROS2_JAZZY)
TIME_NS = 123_456_789_012
TEMPLATED = [topic for topic in TOPICS if topic.type != DIAGNOSTICS]


def numbers_of(message, topic):
    """Flatten a rosbags message in the column order of cosim.topics."""
    if topic.type == JOINTS:
        return np.concatenate([getattr(message, field) for field in topic.fields])

    def flat(part):
        if isinstance(part, float):
            return [part]
        return [x for name in part.__dataclass_fields__ if name != "__msgtype__" for x in flat(getattr(part, name))]

    if topic.type == ODOMETRY:
        return np.array(flat(message.pose.pose) + flat(message.twist.twist))
    if topic.type == IMU:
        parts = (message.orientation, message.angular_velocity, message.linear_acceleration)
        return np.concatenate([flat(part) for part in parts])
    if topic.type == CLOCK:
        return np.empty(0)
    if topic.type == CLOUD:
        assert [column.name for column in message.fields] == list(topic.fields)
        assert message.row_step == message.point_step * message.width == len(message.data)
        return message.data.view("<f8")
    (body,) = (name for name in message.__dataclass_fields__ if name not in ("header", "child_frame_id", "__msgtype__"))
    return np.array(flat(getattr(message, body)))


def stamp_of(message):
    stamp = message.clock if hasattr(message, "clock") else message.header.stamp
    return stamp.sec * 10**9 + stamp.nanosec


def values_for(topic):
    width = {CLOCK: 0, CLOUD: 7 * len(topic.fields)}.get(topic.type)
    return np.random.default_rng(3).normal(size=topic.width if width is None else width)


@pytest.mark.parametrize("topic", TEMPLATED, ids=lambda t: t.name)
def test_rosbags_reads_what_the_template_writes_and_writes_the_same_bytes(topic):
    values = values_for(topic)
    raw = Template(topic).encode(TIME_NS, values)
    message = STORE.deserialize_cdr(raw, topic.type)
    np.testing.assert_array_equal(numbers_of(message, topic), values)
    assert stamp_of(message) == read_stamp(raw) == TIME_NS
    if topic.type != CLOCK:
        assert message.header.frame_id == topic.frame
    if topic.type == ODOMETRY:
        assert message.child_frame_id == topic.child_frame
    theirs = bytes(STORE.serialize_cdr(message, topic.type))
    assert raw.startswith(theirs)
    assert raw[len(theirs) :] == bytes(-len(theirs) % 4)


@pytest.mark.ros
@pytest.mark.parametrize("topic", TEMPLATED, ids=lambda t: t.name)
def test_rclpy_understands_the_template_and_the_template_rclpy(topic):
    serialization = pytest.importorskip("rclpy.serialization")
    package, _, name = topic.type.split("/")
    kind = getattr(__import__(f"{package}.msg", fromlist=[name]), name)
    values = values_for(topic)
    raw = Template(topic).encode(TIME_NS, values)
    message = serialization.deserialize_message(raw, kind)
    assert stamp_of(message) == TIME_NS
    theirs = serialization.serialize_message(message)  # may differ in padding, which they leave as it was
    assert serialization.deserialize_message(theirs, kind) == message
    if topic.type not in (CLOCK, CLOUD, JOINTS):
        np.testing.assert_array_equal(Template(topic).decode(theirs), values)


@pytest.mark.parametrize("topic", [t for t in TEMPLATED if t.type not in (CLOCK, CLOUD)], ids=lambda t: t.name)
def test_decode_returns_what_encode_got(topic):
    template, values = Template(topic), values_for(topic)
    np.testing.assert_array_equal(template.decode(template.encode(TIME_NS, values)), values)


@pytest.mark.parametrize("topic", [t for t in TEMPLATED if t.type not in (CLOCK, CLOUD, JOINTS)], ids=lambda t: t.name)
@pytest.mark.parametrize("frame", ["", "x", "a/much/longer/frame_name"])
def test_decode_reads_other_peoples_frame_names(topic, frame):
    other = Topic(
        name=topic.name, type=topic.type, publisher="user", about="", frame=frame, child_frame=frame + "_child"
    )
    values = values_for(topic)
    np.testing.assert_array_equal(Template(topic).decode(Template(other).encode(0, values)), values)


def test_a_sea_without_waves_is_a_cloud_without_points():
    topic = next(t for t in TOPICS if t.type == CLOUD)
    message = STORE.deserialize_cdr(Template(topic).encode(0, np.empty(0)), CLOUD)
    assert (message.height, message.width, len(message.data)) == (1, 0, 0)


def test_a_message_cut_short_is_an_error():
    topic = next(t for t in TOPICS if t.name == "/payload/wire_wrench")
    raw = Template(topic).encode(0, np.ones(6))
    for size in (16, 20, len(raw) - 1):
        with pytest.raises(CdrError):
            Template(topic).decode(raw[:size])


def test_velocities_and_positions_of_any_joint_state():
    kind = STORE.types["sensor_msgs/msg/JointState"]
    header = STORE.types["std_msgs/msg/Header"](STORE.types["builtin_interfaces/msg/Time"](1, 2), "anything")
    message = kind(header, ["boom", "winch"], np.array([9.0]), np.array([0.01, -0.5]), np.empty(0))
    names, velocities, positions = read_joint_command(bytes(STORE.serialize_cdr(message, kind.__msgtype__)))
    assert names == ["boom", "winch"]
    assert velocities == [0.01, -0.5]
    assert positions == [9.0]


def test_frame_and_numbers_of_any_twist():
    kind = STORE.types["geometry_msgs/msg/TwistStamped"]
    vector = STORE.types["geometry_msgs/msg/Vector3"]
    header = STORE.types["std_msgs/msg/Header"](STORE.types["builtin_interfaces/msg/Time"](1, 2), "crane_base")
    twist = STORE.types["geometry_msgs/msg/Twist"](vector(1.0, 2.0, 3.0), vector(4.0, 5.0, 6.0))
    raw = bytes(STORE.serialize_cdr(kind(header, twist), kind.__msgtype__))
    assert read_stamped(raw, kind.__msgtype__) == ("crane_base", (1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    with pytest.raises(CdrError, match="not a TwistStamped"):
        read_stamped(raw[:-8], kind.__msgtype__)


@pytest.mark.parametrize(
    "raw", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 40, struct.pack("<30d", *range(30))]
)
def test_bytes_that_are_no_joint_state_are_an_error(raw):
    with pytest.raises(CdrError):
        read_joint_command(raw)
