"""A bag as pandas tables, one for each topic. No ROS is needed: the types are read out of the bag."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag2 import ReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import TypesysError

from friction_analysis.console import AnalysisError
from friction_analysis.rows import Rows
from friction_analysis.topics import topic_name
from friction_analysis.views import read_views


class BagError(AnalysisError):
    """A bag, or a topic of it, that cannot be read; the text says what was expected."""


@dataclass(frozen=True)
class Bag:
    """Tables of a bag.

    Every table's index is `t_s`, the log time in seconds since `start_ns`; `stamp_ns` is the message's own stamp in
    nanoseconds since 1970, where it has one. Column names carry the unit.
    """

    path: Path
    """The bag folder or .mcap file."""
    start_ns: int
    """Log time of the bag's first message [ns since 1970]: the zero of every index."""
    topics: dict[str, pd.DataFrame] = field(repr=False)
    """Table by topic name; topics without a message have none."""
    types: dict[str, str] = field(repr=False)
    """Message type by topic name."""

    def table(self, name: str, namespace: str = "") -> pd.DataFrame:
        """Table of the topic `namespace`/`name`.

        Raises `BagError`, with the topics that there are, if it was not recorded.
        """
        topic = topic_name(name, namespace)
        try:
            return self.topics[topic]
        except KeyError:
            raise BagError(
                f"{self.path} has no message on {topic}; it has {', '.join(sorted(self.topics)) or 'no topics'}"
            ) from None

    def has(self, name: str, namespace: str = "") -> bool:
        """Whether the topic `namespace`/`name` was recorded."""
        return topic_name(name, namespace) in self.topics


def read_bag(
    bag: Path | str,
    topics: Iterable[str] | None = None,
    start_s: float | None = None,
    stop_s: float | None = None,
    progress: Callable[[float], None] | None = None,
    one_by_one: bool = False,
) -> Bag:
    """Reads a bag folder or an .mcap file.

    `topics` limits it to these absolute names, `start_s` and `stop_s` to that part of the bag [s since its first message].
    `progress` is told now and then which share is read, 0 to 1.

    Numbers of MCAP files are read many at a time where they stand, which takes less than a tenth of the time of reading
    the messages one by one. What cannot be read so (diagnostics, files without an index, SQLite) is read one by one, and with
    `one_by_one` everything is; the tables are the same.

    Raises `BagError` if there is no bag, none of the topics, or a message that does not fit its type.
    """
    path = Path(bag)
    if not path.exists():
        raise BagError(f"{path} does not exist; name a bag folder or an .mcap file")
    wanted = None if topics is None else set(topics)
    told = progress or (lambda _share: None)
    try:
        with AnyReader([path]) as reader:
            connections = [c for c in reader.connections if wanted is None or c.topic in wanted]
            if not connections:
                there = ", ".join(sorted({c.topic for c in reader.connections})) or "no topics"
                raise BagError(f"{path} has none of {', '.join(sorted(wanted or ()))}; it has {there}")
            start_ns = int(reader.start_time)
            first = None if start_s is None else start_ns + round(start_s * 1e9)
            last = None if stop_s is None else start_ns + round(stop_s * 1e9)
            types = {c.topic: c.msgtype for c in connections}
            tables: dict[str, pd.DataFrame] = {}
            if not one_by_one:
                tables = read_views(path, types, reader.typestore, (start_ns, first, last), told)
            rest = [c for c in connections if c.topic not in tables]
            rows = {c.topic: Rows(c.msgtype) for c in rest}
            end_ns = int(reader.end_time)
            for number, (connection, log_time, data) in enumerate(reader.messages(rest, start=first, stop=last) if rest else ()):
                rows[connection.topic].add(log_time - start_ns, reader.deserialize(data, connection.msgtype))
                if number % 4096 == 0 and not tables:
                    told((log_time - start_ns) / max(1, end_ns - start_ns))
            tables |= {topic: found.frame() for topic, found in rows.items()}
            told(1.0)
    except FileNotFoundError as error:
        raise BagError(
            f"{path} has no metadata.yaml: it is no bag, or was cut off while it was written; "
            "`frictionlab bag recover` mends the latter"
        ) from error
    except (AnyReaderError, ReaderError, SerdeError, TypesysError, ValueError, KeyError, IndexError, struct.error) as error:
        # A damaged file can show itself in any of these.
        raise BagError(f"{path} cannot be read as a bag: {error}") from error
    heard = {topic: tables[topic] for topic in types if len(tables[topic])}
    return Bag(path=path, start_ns=start_ns, topics=heard, types={topic: types[topic] for topic in heard})
