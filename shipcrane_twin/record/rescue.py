"""Mend the bag of a recorder that was killed: what had reached the file becomes a complete bag."""

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader

from shipcrane_twin.cosim.topics import Topic
from shipcrane_twin.record.bag import BagWriter
from shipcrane_twin.record.scan import DAMAGE


def is_broken(folder: Path) -> bool:
    """Whether a bag was begun but never closed."""
    return folder.is_dir() and not (folder / "metadata.yaml").exists()


def rescue_bag(
    folder: Path,
    topics: tuple[Topic, ...],
    *,
    compression: str,
    chunk_kib: int,
    metadata: Mapping[str, str],
) -> int:
    """Write the messages of all whole chunks of a broken bag into a new one in its place.

    Parameters
    ----------
    folder : Path
        Of the bag.
    topics, compression, chunk_kib, metadata
        As for `BagWriter`.

    Returns
    -------
    int
        How many messages were saved; those of the chunk that was being filled are lost.
    """
    broken = folder.with_name(f"{folder.name}.broken")
    folder.rename(broken)
    bag = BagWriter(folder, topics, compression=compression, chunk_kib=chunk_kib, metadata=metadata)
    for file in sorted(broken.glob("*.mcap")):
        for topic, time_ns, message in salvage(file):
            bag.write(topic, time_ns, message)
    bag.close()
    shutil.rmtree(broken)
    return sum(bag.counts.values())


def salvage(file: Path) -> Iterator[tuple[str, int, bytes]]:
    """Yield topic, log time [ns] and bytes of every message before the place where a file breaks off."""
    topics: dict[int, str] = {}
    with file.open("rb") as stream:
        records = StreamReader(stream, validate_crcs=True).records
        while True:
            try:
                record = next(records)
            except (StopIteration, *DAMAGE):
                return
            if isinstance(record, Channel):
                topics[record.id] = record.topic
            elif isinstance(record, Message):
                yield topics[record.channel_id], record.log_time, record.data
