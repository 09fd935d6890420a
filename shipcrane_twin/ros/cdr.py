"""Serialized messages by template: the few layouts of the loop, written and read without a type library.

CDR, little endian: 4 bytes of encapsulation, then every number aligned to its size counted from there.
Tests hold every layout against rclpy's and rosbags' own serialization. Needs no ROS, so that the inline
runner records the same bytes as the graph.
"""

import struct
from collections.abc import Sequence

import numpy as np

from shipcrane_twin.cosim.time import stamp_parts
from shipcrane_twin.cosim.topics import CLOCK, CLOUD, IMU, JOINT_FIELDS, JOINTS, ODOMETRY, WIDTHS, Topic
from shipcrane_twin.physics.arrays import Array

ENCAPSULATION = b"\x00\x01\x00\x00"
ORIGIN = 4
"""Where alignment counts from."""

FLOAT64 = 8
"""Of the constants of sensor_msgs/PointField."""


class CdrError(ValueError):
    """A serialized message does not have the layout of its topic."""


class _Writer:
    """Appends CDR primitives."""

    def __init__(self) -> None:
        self.data = bytearray(ENCAPSULATION)

    def align(self, size: int) -> None:
        self.data += bytes(-(len(self.data) - ORIGIN) % size)

    def count(self, number: int) -> None:
        self.align(4)
        self.data += struct.pack("<I", number)

    def string(self, text: str) -> None:
        raw = text.encode() + b"\0"
        self.count(len(raw))
        self.data += raw

    def doubles(self, number: int) -> int:
        """Append zeros; return the offset of the first."""
        if number:
            self.align(8)
        start = len(self.data)
        self.data += bytes(8 * number)
        return start


def encode_cloud(topic: Topic, time_ns: int, values: Array) -> bytes:
    """Return a serialized PointCloud2 of float64 columns.

    Parameters
    ----------
    topic : Topic
        With frame and names of the columns.
    time_ns : int
    values : float64, shape (n * columns,)
        Row by row.
    """
    writer = _Writer()
    writer.data += struct.pack("<iI", *stamp_parts(time_ns))
    writer.string(topic.frame)
    size = 8 * len(topic.fields)
    points = values.size // len(topic.fields)
    writer.count(1)  # height
    writer.count(points)
    writer.count(len(topic.fields))
    for i, name in enumerate(topic.fields):
        writer.string(name)
        writer.count(8 * i)
        writer.data += bytes([FLOAT64])
        writer.count(1)
    writer.data += b"\0"  # little endian
    writer.count(size)
    writer.count(size * points)
    writer.count(size * points)
    writer.data += values.astype("<f8").tobytes() + b"\1"  # all points are valid
    writer.align(4)  # as the middleware hands it on
    return bytes(writer.data)


class Template:
    """Serialized messages of one topic: everything fixed but stamp and numbers.

    Parameters
    ----------
    topic : Topic
        Of one of the types of `cosim.topics`; not DiagnosticArray. Those of a PointCloud2 are only written,
        and seldom, so nothing of them is prepared.
    """

    def __init__(self, topic: Topic) -> None:
        writer = _Writer()
        writer.data += bytes(8)  # stamp
        if topic.type != CLOCK:
            writer.string(topic.frame)
        blocks: list[tuple[int, int]] = []
        if topic.type == JOINTS:
            writer.count(len(topic.joints))
            for name in topic.joints:
                writer.string(name)
            for field in JOINT_FIELDS:
                number = len(topic.joints) if field in topic.fields else 0
                writer.count(number)
                blocks.append((writer.doubles(number), number))
        elif topic.type == ODOMETRY:
            writer.string(topic.child_frame)
            pose = writer.doubles(7)
            writer.doubles(36)
            twist = writer.doubles(6)
            writer.doubles(36)
            blocks = [(pose, 7), (twist, 6)]
        elif topic.type == IMU:
            for number in (4, 3, 3):  # orientation, angular velocity, linear acceleration, each with its covariance
                blocks.append((writer.doubles(number), number))
                writer.doubles(9)
        elif topic.type not in (CLOCK, CLOUD):
            blocks = [(writer.doubles(topic.width), topic.width)]
        self.topic = topic
        self._buffer = writer.data
        self._views = [
            np.frombuffer(self._buffer, dtype="<f8", count=number, offset=start) for start, number in blocks if number
        ]
        self._spans = [(start, number) for start, number in blocks if number]

    def encode(self, time_ns: int, values: Array) -> bytes:
        """Return the serialized message with this stamp and these values (the topic's width)."""
        if self.topic.type == CLOUD:
            return encode_cloud(self.topic, time_ns, values)
        struct.pack_into("<iI", self._buffer, ORIGIN, *stamp_parts(time_ns))
        at = 0
        for view in self._views:
            view[:] = values[at : at + len(view)]
            at += len(view)
        return bytes(self._buffer)

    def decode(self, message: bytes) -> Array:
        """Return the values of a serialized message of this topic, whoever wrote it.

        Raises
        ------
        CdrError
            If its layout is another: other frame names are fine, missing or other joints are not.
        """
        spans = self._spans
        if len(message) != len(self._buffer) or message[12 : spans[0][0]] != self._buffer[12 : spans[0][0]]:
            spans = self._foreign_spans(message)
        # copies, because kernels are compiled for arrays that are aligned and may be written
        if len(spans) == 1:
            return np.frombuffer(message, "<f8", spans[0][1], spans[0][0]).copy()
        return np.concatenate([np.frombuffer(message, "<f8", number, start) for start, number in spans])

    def _foreign_spans(self, message: bytes) -> list[tuple[int, int]]:
        """Locate the numbers of a message whose header strings have other lengths."""
        if self.topic.type == JOINTS:
            raise CdrError(f"{self.topic.name}: a JointState with other joints or fields than {self.topic.joints}")
        at = skip_string(message, ORIGIN + 8)
        if self.topic.type == ODOMETRY:
            at = skip_string(message, at)
        shift = at + (-(at - ORIGIN) % 8) - self._spans[0][0]
        spans = [(start + shift, number) for start, number in self._spans]
        if spans[-1][0] + 8 * spans[-1][1] > len(message):
            raise CdrError(f"{self.topic.name}: the message has {len(message)} bytes, too few for {self.topic.type}")
        return spans


def skip_string(message: bytes, at: int) -> int:
    """Return the offset behind the string that starts (aligned to 4) at an offset."""
    at += -(at - ORIGIN) % 4
    if at + 4 > len(message):
        raise CdrError("the message ends inside a string")
    return at + 4 + int(struct.unpack_from("<I", message, at)[0])


def read_stamp(message: bytes) -> int:
    """Return the stamp [ns] of a serialized Clock or of any message that starts with a Header.

    Raises
    ------
    CdrError
        If it is too short to hold one, or the stamp lies before zero.
    """
    try:
        sec, nanosec = struct.unpack_from("<iI", message, ORIGIN)
    except struct.error:
        raise CdrError(f"the message has {len(message)} bytes, too few for a stamp") from None
    if sec < 0:
        raise CdrError(f"the stamp is {sec} s, expected zero or more")
    return int(sec) * 1_000_000_000 + int(nanosec)


def check_layout(topic: Topic, message: bytes) -> None:
    """Raise CdrError unless a serialized message from outside can be one of a topic, JointState or stamped numbers."""
    if topic.type == JOINTS:
        read_joint_command(message)
    else:
        read_stamped(message, topic.type)


def read_stamped(message: bytes, kind: str) -> tuple[str, tuple[float, ...]]:
    """Return frame and numbers of any serialized message of a type that has nothing else, such as PoseStamped.

    Raises
    ------
    CdrError
        If the bytes are not of this type.
    """
    try:
        start = ORIGIN + 12
        end = skip_string(message, ORIGIN + 8)
        frame = message[start : end - 1].decode()
        end += -(end - ORIGIN) % 8
        return frame, struct.unpack_from(f"<{WIDTHS[kind]}d", message, end)
    except (struct.error, ValueError) as err:
        raise CdrError(f"not a {kind.rpartition('/')[2]}: {err}") from None


def read_joint_command(message: bytes) -> tuple[list[str], list[float], list[float]]:
    """Return names, velocities and positions of any serialized JointState.

    Raises
    ------
    CdrError
        If the bytes are not a JointState.
    """
    try:
        at = skip_string(message, ORIGIN + 8)
        names, at = _read_names(message, at)
        positions, at = _read_doubles(message, at)
        velocities, at = _read_doubles(message, at)
        _read_doubles(message, at)  # a message that lacks its end is none
    except (struct.error, ValueError) as err:
        raise CdrError(f"not a JointState: {err}") from None
    return names, velocities, positions


def joint_velocities(message: bytes, joints: Sequence[str]) -> Array:
    """Return the velocities of these joints, in this order, from a serialized JointState that names just them.

    Raises
    ------
    CdrError
        If the bytes are no JointState, or names and velocities are not one finite number for each joint.
    """
    names, velocities, _ = read_joint_command(message)
    if sorted(names) != sorted(joints) or len(velocities) != len(names) or not np.isfinite(velocities).all():
        raise CdrError(
            f"names {names}, velocities {list(velocities)}; expected one finite velocity for each of "
            f"{', '.join(joints)}"
        )
    said = dict(zip(names, velocities, strict=True))
    return np.array([said[joint] for joint in joints])


def _read_count(message: bytes, at: int) -> tuple[int, int]:
    at += -(at - ORIGIN) % 4
    return struct.unpack_from("<I", message, at)[0], at + 4


def _read_names(message: bytes, at: int) -> tuple[list[str], int]:
    count, at = _read_count(message, at)
    names = []
    for _ in range(count):
        start = at + (-(at - ORIGIN) % 4) + 4
        at = skip_string(message, at)
        names.append(message[start : at - 1].decode())
    return names, at


def _read_doubles(message: bytes, at: int) -> tuple[list[float], int]:
    count, at = _read_count(message, at)
    if not count:
        return [], at
    at += -(at - ORIGIN) % 8
    return list(struct.unpack_from(f"<{count}d", message, at)), at + 8 * count
