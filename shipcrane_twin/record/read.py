"""Read a recorded bag back into arrays.

The bag is a rosbag2 directory (``metadata.yaml`` and MCAP files). Records and chunks are taken apart with the
mcap package; the messages of one topic normally have the same length, the same strings and the same array
sizes, so they are stacked and sliced as columns, and only what does not fit goes through the generic decoder.

Column order of `Series.values` by type (`COLUMNS`), SI units, frames as in the header:

- Odometry px py pz qx qy qz qw vx vy vz wx wy wz; PoseStamped px py pz qx qy qz qw;
- TwistStamped vx vy vz wx wy wz; AccelStamped ax ay az alx aly alz; WrenchStamped fx fy fz mx my mz;
- InertiaStamped m comx comy comz ixx ixy ixz iyy iyz izz; Clock none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from shipcrane_twin.record.decode import (
    CLOUD,
    COLUMNS,
    JOINT_STATE,
    Block,
    decode_block,
    decode_cloud,
    decode_messages,
    merge_blocks,
)
from shipcrane_twin.record.scan import BagError, Batch, scan_file

__all__ = ["COLUMNS", "BagError", "Joints", "Series", "Signals", "read_signals"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """One topic of fixed-size messages; row k of every array belongs to message k, in log order.

    Attributes
    ----------
    stamp_ns, log_ns : int64, shape (n,)
        Header stamp (for Clock its value) and log time, simulated [ns].
    values : float64, shape (n, m)
        The numbers of the message in the order of `columns`, SI units, in the frame of `frame_id`
        (the twist of Odometry in `child_frame_id`).
    """

    topic: str
    msgtype: str
    frame_id: str
    child_frame_id: str
    columns: tuple[str, ...]
    stamp_ns: NDArray[np.int64]
    log_ns: NDArray[np.int64]
    values: NDArray[np.float64]

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Stamps in seconds, float64, shape (n,)."""
        return self.stamp_ns.astype(np.float64) * 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Joints:
    """One topic of JointState; `position`, `velocity`, `effort` have shape (n, len(names)).

    NaN where a message lacks the joint or leaves the array empty. Radians or metres, per second, N m or N.
    """

    topic: str
    frame_id: str
    names: tuple[str, ...]
    stamp_ns: NDArray[np.int64]
    log_ns: NDArray[np.int64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    effort: NDArray[np.float64]

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Stamps in seconds, float64, shape (n,)."""
        return self.stamp_ns.astype(np.float64) * 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Signals:
    """Everything a bag holds: `series`, `joints` and `clouds` by topic; types not decoded appear in `counts` only.

    Of PointCloud2 the last message counts: its columns, float64 (n,), by name.
    """

    path: Path
    types: Mapping[str, str]
    counts: Mapping[str, int]
    series: Mapping[str, Series]
    joints: Mapping[str, Joints]
    clouds: Mapping[str, Mapping[str, NDArray[np.float64]]]


@dataclass(slots=True)
class _Topic:
    """The messages of one topic found so far."""

    name: str
    msgtype: str
    count: int = 0
    blocks: list[Block] = field(default_factory=list)
    log_ns: list[NDArray[np.int64]] = field(default_factory=list)
    cloud: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def add(self, batch: Batch) -> None:
        if batch.msgtype != self.msgtype:
            raise BagError(
                f"{batch.where}: {self.name} was recorded as {self.msgtype} and as {batch.msgtype}; "
                "give the two different topic names and record again"
            )
        self.count += len(batch.starts)
        if batch.starts and (self.msgtype in COLUMNS or self.msgtype == JOINT_STATE):
            self.blocks.append(_decode(batch))
            self.log_ns.append(np.array(batch.log_ns, dtype=np.int64))
        if batch.starts and self.msgtype == CLOUD:
            self.cloud = _decode_last(batch)


def _decode_last(batch: Batch) -> Mapping[str, NDArray[np.float64]]:
    """Decode the last cloud of a batch."""
    with _told(batch):
        return decode_cloud(batch.data[batch.starts[-1] : batch.starts[-1] + batch.sizes[-1]].tobytes())


def _decode(batch: Batch) -> Block:
    """Decode the messages of one batch, by columns if they are alike."""
    size = batch.sizes[0]
    if size > 0 and batch.sizes.count(size) == len(batch.sizes):
        rows = np.lib.stride_tricks.sliding_window_view(batch.data, size)[np.array(batch.starts)]
        block = decode_block(batch.msgtype, rows)
        if block is not None:
            return block
    messages = [batch.data[a : a + n].tobytes() for a, n in zip(batch.starts, batch.sizes, strict=True)]
    with _told(batch):
        return decode_messages(batch.msgtype, messages)


@contextmanager
def _told(batch: Batch) -> Iterator[None]:
    """Turn whatever a decoder raises into a BagError that names the place."""
    try:
        yield
    except Exception as error:
        raise BagError(
            f"{batch.where}: a message on {batch.topic} is not a valid {batch.msgtype} "
            f"({type(error).__name__}: {error}); record the run again"
        ) from error


def read_signals(bag_dir: Path | str) -> Signals:
    """Read all topics of a rosbag2 directory.

    Parameters
    ----------
    bag_dir : path
        Directory with ``metadata.yaml`` and the MCAP files it names.

    Returns
    -------
    Signals
        Read-only arrays, every topic in log-time order.

    Raises
    ------
    BagError
        If there is no bag, it is no MCAP bag, or a file, chunk or message is damaged.
    """
    path = Path(bag_dir)
    info = _metadata(path)
    topics: dict[str, _Topic] = {}
    for name in info["relative_file_paths"]:
        for batch in scan_file(path / str(name)):
            topics.setdefault(batch.topic, _Topic(batch.topic, batch.msgtype)).add(batch)
    found = sum(topic.count for topic in topics.values())
    if found != info.get("message_count", found):
        raise BagError(
            f"{path}: metadata.yaml promises {info['message_count']} messages, the files hold {found}; "
            "the recording was cut or edited: rebuild metadata.yaml with 'ros2 bag reindex', or record again"
        )
    series: dict[str, Series] = {}
    joints: dict[str, Joints] = {}
    for topic in topics.values():
        if topic.msgtype == JOINT_STATE:
            joints[topic.name] = _joints(topic)
        elif topic.msgtype in COLUMNS:
            series[topic.name] = _series(topic)
    return Signals(
        path=path,
        types={t.name: t.msgtype for t in topics.values()},
        counts={t.name: t.count for t in topics.values()},
        series=series,
        joints=joints,
        clouds={topic.name: topic.cloud for topic in topics.values() if topic.msgtype == CLOUD},
    )


def _metadata(path: Path) -> dict[str, Any]:
    """Return the checked content of metadata.yaml."""
    file = path / "metadata.yaml"
    if not path.is_dir():
        what = "is a file" if path.exists() else "does not exist"
        raise BagError(f"{path}: no bag there ({what}); give the directory that holds metadata.yaml")
    if not file.is_file():
        hint = (
            f"did you mean {path / 'bag'}?"
            if (path / "bag" / "metadata.yaml").is_file()
            else ("a recording that was killed can be mended with 'ros2 bag reindex'")
        )
        raise BagError(f"{path}: not a bag, metadata.yaml is missing; {hint}")
    try:
        info = yaml.safe_load(file.read_text(encoding="utf-8"))["rosbag2_bagfile_information"]
        storage, files = info["storage_identifier"], info["relative_file_paths"]
    except (yaml.YAMLError, UnicodeDecodeError, KeyError, TypeError) as error:
        raise BagError(
            f"{file}: not the metadata of a rosbag2 bag ({error!r}); rebuild it with 'ros2 bag reindex'"
        ) from error
    if storage != "mcap" or not isinstance(files, list):
        raise BagError(f"{file}: storage is {storage!r}, expected 'mcap'; convert with 'ros2 bag convert'")
    if info.get("compression_mode"):
        raise BagError(
            f"{file}: compression_mode is {info['compression_mode']!r}, expected none (MCAP chunks are "
            "compressed inside the file); convert with 'ros2 bag convert'"
        )
    return dict(info)


def _in_order(topic: _Topic) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
    """Return the log times, ascending, and the order that sorts the messages so (stable)."""
    logs = np.concatenate(topic.log_ns) if topic.log_ns else np.empty(0, dtype=np.int64)
    order = np.argsort(logs, kind="stable")
    return _frozen(logs[order]), order


def _series(topic: _Topic) -> Series:
    logs, order = _in_order(topic)
    merged = merge_blocks(topic.blocks, len(COLUMNS[topic.msgtype]))
    return Series(
        topic=topic.name,
        msgtype=topic.msgtype,
        frame_id=merged.frame_id,
        child_frame_id=merged.child_frame_id,
        columns=COLUMNS[topic.msgtype],
        stamp_ns=_frozen(merged.stamp_ns[order]),
        log_ns=logs,
        values=_frozen(merged.values[order]),
    )


def _joints(topic: _Topic) -> Joints:
    logs, order = _in_order(topic)
    merged = merge_blocks(topic.blocks, 0)
    position, velocity, effort = np.split(merged.values[order], 3, axis=1)
    return Joints(
        topic=topic.name,
        frame_id=merged.frame_id,
        names=merged.names,
        stamp_ns=_frozen(merged.stamp_ns[order]),
        log_ns=logs,
        position=_frozen(position),
        velocity=_frozen(velocity),
        effort=_frozen(effort),
    )


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array
