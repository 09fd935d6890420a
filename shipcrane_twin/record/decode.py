"""CDR messages to arrays: a column decoder for stacks of equal messages and a generic one for the rest.

CDR as ROS 2 writes it: 4 bytes of encapsulation, then little-endian fields, each aligned to its own size
counted from byte 4. Strings and sequences begin with a uint32 length (strings count their closing NUL).
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache, reduce
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

CLOCK = "rosgraph_msgs/msg/Clock"
IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
JOINT_STATE = "sensor_msgs/msg/JointState"
CLOUD = "sensor_msgs/msg/PointCloud2"

_POSE = ("px", "py", "pz", "qx", "qy", "qz", "qw")
_TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
COLUMNS: dict[str, tuple[str, ...]] = {
    CLOCK: (),
    IMU: ("qx", "qy", "qz", "qw", "wx", "wy", "wz", "ax", "ay", "az"),
    ODOMETRY: _POSE + _TWIST,
    "geometry_msgs/msg/PoseStamped": _POSE,
    "geometry_msgs/msg/TwistStamped": _TWIST,
    "geometry_msgs/msg/AccelStamped": ("ax", "ay", "az", "alx", "aly", "alz"),
    "geometry_msgs/msg/WrenchStamped": ("fx", "fy", "fz", "mx", "my", "mz"),
    "geometry_msgs/msg/InertiaStamped": (
        "m", "comx", "comy", "comz", "ixx", "ixy", "ixz", "iyy", "iyz", "izz",
    ),
}  # fmt: skip

_XYZ, _XYZW = ("x", "y", "z"), ("x", "y", "z", "w")


def _paths(*groups: tuple[str, tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(f"{prefix}.{leaf}" for prefix, leaves in groups for leaf in leaves)


# Where the generic decoder finds the same numbers, in the order of COLUMNS.
_FIELDS: dict[str, tuple[str, ...]] = {
    CLOCK: (),
    IMU: _paths(("orientation", _XYZW), ("angular_velocity", _XYZ), ("linear_acceleration", _XYZ)),
    ODOMETRY: _paths(
        ("pose.pose.position", _XYZ),
        ("pose.pose.orientation", _XYZW),
        ("twist.twist.linear", _XYZ),
        ("twist.twist.angular", _XYZ),
    ),
    "geometry_msgs/msg/PoseStamped": _paths(("pose.position", _XYZ), ("pose.orientation", _XYZW)),
    "geometry_msgs/msg/TwistStamped": _paths(("twist.linear", _XYZ), ("twist.angular", _XYZ)),
    "geometry_msgs/msg/AccelStamped": _paths(("accel.linear", _XYZ), ("accel.angular", _XYZ)),
    "geometry_msgs/msg/WrenchStamped": _paths(("wrench.force", _XYZ), ("wrench.torque", _XYZ)),
    "geometry_msgs/msg/InertiaStamped": _paths(
        ("inertia", ("m",)),
        ("inertia.com", _XYZ),
        ("inertia", ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    ),
}
_WITH_COVARIANCE = {ODOMETRY: ((7, 36), (6, 36)), IMU: ((4, 9), (3, 9), (3, 9))}
"""How many doubles are wanted, and how many of covariance come after them, part by part."""



@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Decoded messages of one topic: stamps, int64 (n,), and numbers, float64 (n, m).

    For JointState, m is three times the number of `names`: positions, velocities, efforts.
    """

    stamp_ns: NDArray[np.int64]
    values: NDArray[np.float64]
    frame_id: str = ""
    child_frame_id: str = ""
    names: tuple[str, ...] = ()


@dataclass(slots=True)
class _Walk:
    """Position in one message; collects which bytes must not differ and where the numbers lie."""

    data: bytes
    at: int = 4
    fixed: list[slice] = field(default_factory=list)
    numbers: list[tuple[int, int]] = field(default_factory=list)  # byte offset (-1: absent, NaN), count

    def align(self, size: int) -> None:
        self.at += -(self.at - 4) % size

    def count(self) -> int:
        self.align(4)
        value: int = struct.unpack_from("<I", self.data, self.at)[0]
        self.fixed.append(slice(self.at, self.at + 4))
        self.at += 4
        return value

    def string(self) -> str:
        length = self.count()
        text = self.data[self.at : self.at + length]
        self.fixed.append(slice(self.at, self.at + length))
        self.at += length
        return text.rstrip(b"\0").decode()

    def doubles(self, count: int, keep: bool = True) -> None:
        if count:
            self.align(8)
        if keep:
            self.numbers.append((self.at, count))
        self.at += 8 * count


def _read_through(msgtype: str, walk: _Walk) -> tuple[str, str, tuple[str, ...]] | None:
    """Walk through a message; return frame, child frame and joint names, None for arrays of unequal length."""
    frame_id = child_frame_id = ""
    names: tuple[str, ...] = ()
    if msgtype != CLOCK:
        frame_id = walk.string()
    if msgtype == ODOMETRY:
        child_frame_id = walk.string()
    if msgtype in _WITH_COVARIANCE:
        for count, covariance in _WITH_COVARIANCE[msgtype]:
            walk.doubles(count)
            walk.doubles(covariance, keep=False)
    elif msgtype == JOINT_STATE:
        names = tuple(walk.string() for _ in range(walk.count()))
        for _ in range(3):
            count = walk.count()
            if count not in (0, len(names)):
                return None
            walk.doubles(count)
            if not count:
                walk.numbers[-1] = (-1, len(names))
    else:
        walk.doubles(len(COLUMNS[msgtype]))
    return frame_id, child_frame_id, names


def decode_block(msgtype: str, rows: NDArray[np.uint8]) -> Block | None:
    """Decode messages of equal length, one per row, by columns.

    Parameters
    ----------
    msgtype : str
        A key of `COLUMNS`, or `JOINT_STATE`.
    rows : uint8, shape (n, length), n >= 1
        Serialized messages with their encapsulation.

    Returns
    -------
    Block or None
        None where the first row does not parse or the rows differ in strings or array sizes.
    """
    first = rows[0].tobytes()
    walk = _Walk(first, 12, [slice(0, 2)])
    try:
        texts = _read_through(msgtype, walk)
    except (struct.error, UnicodeDecodeError):
        return None
    if texts is None:
        return None
    frame_id, child_frame_id, names = texts
    little_endian = first[:2] == b"\x00\x01"
    padding = len(first) - walk.at
    if not little_endian or not 0 <= padding < 4 or len(set(names)) != len(names):
        return None
    if any((rows[:, part] != rows[0, part]).any() for part in walk.fixed):
        return None
    stamp = np.ascontiguousarray(rows[:, 4:12])
    sec, nanosec = stamp[:, :4].copy().view("<i4"), stamp[:, 4:].copy().view("<u4")
    stamp_ns = sec[:, 0].astype(np.int64) * 1_000_000_000 + nanosec[:, 0]
    columns = [_columns(rows, offset, count) for offset, count in walk.numbers]
    values = np.hstack(columns) if columns else np.empty((len(rows), 0))
    return Block(
        stamp_ns=stamp_ns, values=values, frame_id=frame_id, child_frame_id=child_frame_id, names=names
    )


def _columns(rows: NDArray[np.uint8], offset: int, count: int) -> NDArray[np.float64]:
    """Return `count` doubles of every row, shape (n, count)."""
    if offset < 0 or not count:
        return np.full((len(rows), count), np.nan)
    return np.ascontiguousarray(rows[:, offset : offset + 8 * count]).view("<f8")


@cache
def _typestore() -> Any:
    from rosbags.typesys import Stores, get_typestore  # costs 0.2 s, rarely needed

    return get_typestore(Stores.ROS2_JAZZY)


def decode_messages(msgtype: str, messages: Sequence[bytes]) -> Block:
    """Decode serialized messages one by one; the slow way that takes any strings and sizes.

    Raises whatever the generic decoder raises on bytes that are not a `msgtype`.
    """
    decoded = [_typestore().deserialize_cdr(data, msgtype) for data in messages]
    if msgtype == JOINT_STATE:
        return merge_blocks([_joint_block(message) for message in decoded], 0)
    stamps = [message.clock if msgtype == CLOCK else message.header.stamp for message in decoded]
    gets = [attrgetter(path) for path in _FIELDS[msgtype]]
    values = np.array([[get(message) for get in gets] for message in decoded], dtype=np.float64)
    return Block(
        stamp_ns=np.array([_nanoseconds(stamp) for stamp in stamps], dtype=np.int64),
        values=values.reshape(len(decoded), len(gets)),
        frame_id="" if msgtype == CLOCK else decoded[0].header.frame_id,
        child_frame_id=decoded[0].child_frame_id if msgtype == ODOMETRY else "",
    )


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def _joint_block(message: Any) -> Block:
    """Return one JointState as a block of one row; of a joint named twice the first numbers count."""
    names = tuple(dict.fromkeys(message.name))
    values = np.full((3, len(names)), np.nan)
    for row, array in enumerate((message.position, message.velocity, message.effort)):
        for name, number in reversed(list(zip(message.name, array, strict=False))):
            values[row, names.index(name)] = number
    return Block(
        stamp_ns=np.array([_nanoseconds(message.header.stamp)], dtype=np.int64),
        values=values.reshape(1, -1),
        frame_id=message.header.frame_id,
        names=names,
    )


def decode_cloud(message: bytes) -> dict[str, NDArray[np.float64]]:
    """Return the float64 columns (n,) of a serialized PointCloud2, by name.

    Raises
    ------
    ValueError
        If a column is of another type or the message ends too early.
    """
    cloud = _typestore().deserialize_cdr(message, CLOUD)
    if cloud.is_bigendian or any(column.datatype != column.FLOAT64 for column in cloud.fields):
        raise ValueError("a PointCloud2 with columns that are not little-endian float64")
    layout = np.dtype(
        {
            "names": [column.name for column in cloud.fields],
            "formats": ["<f8"] * len(cloud.fields),
            "offsets": [column.offset for column in cloud.fields],
            "itemsize": cloud.point_step,
        }
    )
    rows = np.frombuffer(cloud.data.tobytes(), dtype=layout, count=cloud.width * cloud.height)
    return {name: rows[name].astype(np.float64) for name in layout.names or ()}


def merge_blocks(blocks: Sequence[Block], width: int) -> Block:
    """Join blocks of one topic; joints are the union of all names, NaN where a block lacks one.

    `width` is the number of columns when there is no block at all.
    """
    if not blocks:
        return Block(stamp_ns=np.empty(0, dtype=np.int64), values=np.empty((0, width)))
    if len(blocks) == 1:
        return blocks[0]
    names = reduce(_union, (block.names for block in blocks))
    return Block(
        stamp_ns=np.concatenate([block.stamp_ns for block in blocks]),
        values=np.concatenate([_spread(block, names) for block in blocks]),
        frame_id=blocks[0].frame_id,
        child_frame_id=blocks[0].child_frame_id,
        names=names,
    )


def _union(known: tuple[str, ...], more: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys((*known, *more)))


def _spread(block: Block, names: tuple[str, ...]) -> NDArray[np.float64]:
    """Return the block's values with one column per joint of `names` (three groups)."""
    if block.names == names:
        return block.values
    wide = np.full((len(block.values), 3, len(names)), np.nan)
    where = [names.index(name) for name in block.names]
    wide[:, :, where] = block.values.reshape(len(block.values), 3, len(block.names))
    return wide.reshape(len(block.values), -1)
