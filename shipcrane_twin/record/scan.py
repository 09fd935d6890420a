"""Walk an MCAP file: which bytes of which chunk are messages of which topic, and is the file whole.

The mcap package parses the records and opens the chunks; only the walk over the messages is done here,
because one Python object per message would cost more than everything else together.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema
from mcap.stream_reader import get_chunk_data_stream
from numpy.typing import NDArray

_MAGIC = b"\x89MCAP0\r\n"
_RECORD = struct.Struct("<BQ")  # opcode, length of the content
_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
DAMAGE = (
    McapError,
    ValueError,
    LookupError,
    RuntimeError,
    MemoryError,
    OverflowError,
    struct.error,
    zstandard.ZstdError,
)
"""What the parsers and decompressors raise on damaged bytes."""


class BagError(ValueError):
    """A bag cannot be read; the message names the place, what was found and the remedy."""


@dataclass(slots=True)
class Batch:
    """Messages of one topic in one chunk; empty where a topic is only announced.

    `data` holds the chunk's bytes (uint8), message k is ``data[starts[k] : starts[k] + sizes[k]]`` and was
    logged at ``log_ns[k]`` [ns]; `where` names the chunk for errors.
    """

    topic: str
    msgtype: str
    where: str
    data: NDArray[np.uint8] = field(repr=False)
    starts: list[int] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    log_ns: list[int] = field(default_factory=list)


def scan_file(file: Path) -> Iterator[Batch]:
    """Yield all messages of an MCAP file, chunk by chunk and topic by topic.

    Raises
    ------
    BagError
        If the file is missing, no MCAP file, cut short, or a record or chunk cannot be read.
    """
    if not file.is_file():
        raise BagError(f"{file}: named in metadata.yaml but missing; restore it or record again")
    size = file.stat().st_size
    if size < 2 * len(_MAGIC):
        raise BagError(f"{file}: not an MCAP file, only {size} bytes long; record again")
    with file.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as whole:
        if whole[: len(_MAGIC)] != _MAGIC:
            raise BagError(f"{file}: not an MCAP file, begins with {whole[:8]!r}, expected {_MAGIC!r}")
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        for data, where in _regions(whole, file):
            try:
                batches = _batches(data, where, schemas, channels)
            except DAMAGE as error:
                raise _damaged(file, where, error) from error
            yield from batches


def _damaged(file: Path, where: str, error: BaseException) -> BagError:
    reason = f"{type(error).__name__}: {error}".rstrip(": ")
    return BagError(
        f"{file}: {where} is unreadable ({reason}); 'mcap recover' saves what lies around it, or record again"
    )


def _regions(whole: mmap.mmap, file: Path) -> Iterator[tuple[bytes, str]]:
    """Yield the content of every chunk, and the schema, channel and message records outside chunks."""
    at, size = len(_MAGIC), len(whole)
    opcode = -1
    while opcode != Opcode.FOOTER:
        head = at + _RECORD.size
        end = head + (_RECORD.unpack_from(whole, at)[1] if head <= size else 0)
        if end > size - len(_MAGIC):
            raise BagError(
                f"{file}: cut short, the record at byte {at} needs {end + len(_MAGIC) - size} bytes more "
                f"than the file's {size}; 'mcap recover' saves the part before it, or record again"
            )
        opcode, where = whole[at], f"the record at byte {at}"
        if opcode == Opcode.CHUNK:
            where = f"the chunk at byte {at}"
            try:
                chunk = Chunk.read(ReadDataStream(BytesIO(whole[head:end])))
                content, length = get_chunk_data_stream(chunk, validate_crc=True)
                data = content.read(length)
            except DAMAGE as error:
                raise _damaged(file, where, error) from error
            yield data, where
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE):
            yield whole[at:end], where
        at = end
    if whole[at:] != _MAGIC:
        raise BagError(f"{file}: odd bytes behind the footer; rebuild the file with 'mcap recover'")


def _batches(
    data: bytes, where: str, schemas: dict[int, str], channels: dict[int, tuple[str, str]]
) -> list[Batch]:
    """Return the messages of one region by channel; learn the schemas and channels that it announces."""
    found: dict[int, Batch] = {}
    array = np.frombuffer(data, dtype=np.uint8)
    at, size = 0, len(data)
    while at < size:
        opcode, length = _RECORD.unpack_from(data, at)
        body = at + _RECORD.size
        at = body + length
        if at > size:
            raise ValueError(f"a record inside it ends {at - size} bytes too late")
        if opcode == Opcode.MESSAGE:
            channel_id, _, log_ns, _ = _MESSAGE.unpack_from(data, body)
            batch = found.get(channel_id)
            if batch is None:
                batch = found[channel_id] = Batch(*channels[channel_id], where, array)
            batch.starts.append(body + _MESSAGE.size)
            batch.sizes.append(length - _MESSAGE.size)
            batch.log_ns.append(log_ns)
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(ReadDataStream(BytesIO(data[body:at])))
            schemas[schema.id] = schema.name
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(ReadDataStream(BytesIO(data[body:at])))
            channels[channel.id] = (channel.topic, schemas.get(channel.schema_id, ""))
            found.setdefault(channel.id, Batch(*channels[channel.id], where, array))
    return list(found.values())
