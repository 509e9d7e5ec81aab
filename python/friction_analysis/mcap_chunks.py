"""Messages of an MCAP file chunk by chunk, as matrices of bytes.

A file without an index of its chunks is not read here: `UnreadableByIndex` says so, and the caller reads it message by
message.
"""

from __future__ import annotations

import mmap
import struct
import sys
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import numpy as np
import numpy.typing as npt

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

MAGIC = b"\x89MCAP0\r\n"
FOOTER = 37
# Records of the format, and the bytes of a message record before its data: opcode, length, channel, sequence, two times.
MESSAGE, CHANNEL, CHUNK_INDEX = 0x05, 0x04, 0x08
BEFORE_DATA = 1 + 8 + 2 + 4 + 8 + 8
# Records after which a sequence is taken to have begun anew, and records between two looks for one.
LONGEST_SEQUENCE = 64
ALONE = 64

DECOMPRESS: dict[str, Callable[[bytes], bytes]] = {
    "": lambda data: data,
    "lz4": lz4.frame.decompress,
    "zstd": zstd.decompress,
}

Bytes = npt.NDArray[np.uint8]
Numbers = npt.NDArray[np.int64]


class UnreadableByIndex(Exception):  # noqa: N818 - not an error: the file is read another way
    """The file has no index of its chunks."""


@dataclass(frozen=True)
class Block:
    """Messages of one topic and of one length, from one chunk."""

    topic: str
    log_times: Numbers
    """When each was written [ns since 1970]."""
    place: Numbers
    """The place of each among the chunk's messages of the topic."""
    data: Bytes
    """One row a message."""


@dataclass(frozen=True)
class _Chunk:
    first: int
    last: int
    start: int
    compression: str
    compressed: int
    size: int


def blocks(
    file: Path, topics: set[str], first: int | None, last: int | None, progress: Callable[[float], None]
) -> Iterator[list[Block]]:
    """The messages of `topics` from `first` up to but without `last` [ns since 1970], one list a chunk, in the order of the file.

    `progress` is told the share of the file that is done, 0 to 1.

    Raises `UnreadableByIndex` where there is no index, `ValueError` where the file is damaged.
    """
    with file.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as whole:
        channels, chunks = _summary(whole)
        wanted = {number: topic for number, topic in channels.items() if topic in topics}
        bound_low, bound_high = first or 0, (1 << 63) - 1 if last is None else last
        for number, chunk in enumerate(chunks):
            if chunk.last >= bound_low and chunk.first < bound_high:
                yield _read_chunk(whole, chunk, wanted, bound_low, bound_high)
            progress((number + 1) / len(chunks))


def _summary(whole: mmap.mmap) -> tuple[dict[int, str], list[_Chunk]]:
    """Topics by channel, and the chunks in the order of the file."""
    if len(whole) < 2 * len(MAGIC) + FOOTER or whole[: len(MAGIC)] != MAGIC or whole[-len(MAGIC) :] != MAGIC:
        raise UnreadableByIndex
    at = struct.unpack_from("<Q", whole, len(whole) - FOOTER + 9)[0]
    end = len(whole) - FOOTER
    if not 0 < at <= end:
        raise UnreadableByIndex
    channels: dict[int, str] = {}
    chunks: list[_Chunk] = []
    while at + 9 <= end:
        opcode, length = struct.unpack_from("<BQ", whole, at)
        body = at + 9
        if opcode == CHANNEL:
            number, _, size = struct.unpack_from("<HHI", whole, body)
            channels[number] = whole[body + 8 : body + 8 + size].decode()
        elif opcode == CHUNK_INDEX:
            chunks.append(_chunk(whole, body))
        at = body + length
    if not chunks or not channels:
        raise UnreadableByIndex
    return channels, sorted(chunks, key=lambda chunk: chunk.start)


def _chunk(whole: mmap.mmap, at: int) -> _Chunk:
    first, last, start, _, entries = struct.unpack_from("<QQQQI", whole, at)
    at += 36 + entries
    _, length = struct.unpack_from("<QI", whole, at)
    at += 12
    compression = whole[at : at + length].decode()
    compressed, size = struct.unpack_from("<QQ", whole, at + length)
    return _Chunk(first, last, start, compression, compressed, size)


def _read_chunk(whole: mmap.mmap, chunk: _Chunk, wanted: dict[int, str], first: int, last: int) -> list[Block]:
    if chunk.compression not in DECOMPRESS:
        raise ValueError(f"chunks are compressed by {chunk.compression!r}, which is not known")
    crc = struct.unpack_from("<I", whole, chunk.start + 9 + 24)[0]
    at = chunk.start + 9 + 40 + len(chunk.compression)
    packed = whole[at : at + chunk.compressed]
    try:
        raw = DECOMPRESS[chunk.compression](packed)
    except (zstd.ZstdError, RuntimeError) as error:
        raise ValueError(f"a chunk cannot be unpacked: {error}") from error
    if len(raw) != chunk.size or (crc and zlib.crc32(raw) != crc):
        raise ValueError("a chunk's length or checksum is wrong")
    content = np.frombuffer(raw, dtype=np.uint8)
    found: list[Block] = []
    by_topic: dict[str, list[Numbers]] = {}
    for number, offsets_of in _offsets(content, raw).items():
        if number in wanted:
            by_topic.setdefault(wanted[number], []).append(offsets_of)
    for topic, offsets in by_topic.items():
        found += _blocks_of(topic, np.sort(np.concatenate(offsets)), content, first, last)
    return found


def _offsets(content: Bytes, raw: bytes) -> dict[int, Numbers]:
    """Where the messages of each channel begin in a chunk.

    Nothing in a chunk tells that but the length of each record. Recorders write the same topics again and again, with
    messages of the same lengths: once a sequence of records is known, all its repetitions are looked at together.
    """
    found: dict[int, list[Numbers]] = {}
    at, end = 0, len(raw)
    alone = 0
    while at + 9 <= end:
        sequence = _sequence(raw, at) if alone == 0 else []
        repeated = _repetitions(content, at, sequence) if sequence else 0
        if repeated:
            width = sum(length for length, _ in sequence)
            begins = at + width * np.arange(repeated)
            for length, channel in sequence:
                found.setdefault(channel, []).append(begins)
                begins = begins + length
            at += width * repeated
            continue
        # Nothing repeats here: some records one by one before it is tried again.
        alone = alone - 1 if alone else ALONE
        opcode, length = struct.unpack_from("<BQ", raw, at)
        if opcode == MESSAGE and at + 11 <= end:
            channel = struct.unpack_from("<H", raw, at + 9)[0]
            found.setdefault(channel, []).append(np.array([at]))
        at += 9 + length
    if at != end:
        raise ValueError("a record is longer than its chunk")
    return {channel: np.concatenate(offsets) for channel, offsets in found.items()}


def _sequence(raw: bytes, at: int) -> list[tuple[int, int]]:
    """Length, as a whole, and channel of each record from `at` up to the next one like the first; empty if there is none."""
    sequence: list[tuple[int, int]] = []
    for _ in range(LONGEST_SEQUENCE):
        if at + BEFORE_DATA > len(raw):
            return []
        opcode, length, channel = struct.unpack_from("<BQH", raw, at)
        if opcode != MESSAGE or length < BEFORE_DATA - 9:
            return []
        if sequence and (9 + length, channel) == sequence[0]:
            return sequence
        sequence.append((9 + length, channel))
        at += 9 + length
    return []


def _repetitions(content: Bytes, at: int, sequence: list[tuple[int, int]]) -> int:
    """How often the sequence of records stands in a row from `at` on."""
    width = sum(length for length, _ in sequence)
    most = (len(content) - at) // width
    known, tried = 0, 64
    while known < most:
        number = min(tried, most - known)
        begins = at + width * (known + np.arange(number))
        same = np.ones(number, dtype=bool)
        for length, channel in sequence:
            head = np.frombuffer(struct.pack("<BQH", MESSAGE, length - 9, channel), dtype=np.uint8)
            same &= (content[begins[:, None] + np.arange(len(head))] == head).all(axis=1)
            begins = begins + length
        if not same.all():
            return known + int(same.argmin())
        known += number
        tried *= 8
    return known


def _field(content: Bytes, offsets: Numbers, after: int, dtype: str) -> npt.NDArray[np.unsignedinteger]:
    """One number of each record, so many bytes after the record's beginning."""
    width = np.dtype(dtype).itemsize
    rows = content[offsets[:, None] + np.arange(after, after + width)]
    numbers: npt.NDArray[np.unsignedinteger] = rows.view(dtype)[:, 0]
    return numbers


def _blocks_of(topic: str, offsets: Numbers, content: Bytes, first: int, last: int) -> Iterator[Block]:
    times = _field(content, offsets, 15, "<u8").astype(np.int64)
    kept = (times >= first) & (times < last)
    offsets, times = offsets[kept], times[kept]
    # Within a chunk as everywhere: by time, and messages of one time in the order in which they were written.
    order = np.argsort(times, kind="stable")
    offsets, times = offsets[order], times[order]
    lengths = _field(content, offsets, 1, "<u8").astype(np.int64) - (BEFORE_DATA - 9)
    if len(lengths) and (int(lengths.min()) < 0 or int((offsets + BEFORE_DATA + lengths).max()) > len(content)):
        raise ValueError("a message is longer than its chunk")
    for length in np.unique(lengths):
        place = np.flatnonzero(lengths == length)
        begin = offsets[place] + BEFORE_DATA
        windows = np.lib.stride_tricks.sliding_window_view(content, int(length)) if length else content[:0].reshape(1, 0)
        data = windows[begin] if length else np.zeros((len(place), 0), dtype=np.uint8)
        yield Block(topic, times[place], place.astype(np.int64), data)
