"""Tables of topics from the views of their messages, the same as from the messages one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
from ruamel.yaml import YAML

from friction_analysis.cdr_views import Layout, Leaf, NoView, layouts
from friction_analysis.mcap_chunks import Block, UnreadableByIndex, blocks
from friction_analysis.rows import COLUMNS, DIAGNOSTICS, JOINT_STATE

Numbers = npt.NDArray[np.int64]


@dataclass(frozen=True)
class _Part:
    """Messages of one layout."""

    times: Numbers
    order: Numbers
    """The order in the file, for messages of one time."""
    columns: dict[str, npt.NDArray[Any]]


class ViewedTable:
    """The table of one topic, block by block."""

    def __init__(self, type_name: str, store: Any) -> None:
        self.type_name = type_name
        self.store = store
        self.parts: list[_Part] = []
        self.units = COLUMNS.get(type_name, {})

    def add(self, block: Block, order: int) -> None:
        """Takes in a block; `order` grows from chunk to chunk. Raises `NoView`."""
        for layout, rows in layouts(block.data, self.type_name, self.store):
            data = block.data[rows]
            columns = self._joint_state(layout, data) if self.type_name == JOINT_STATE else self._message(layout, data)
            if any(leaf.name == "header.stamp.sec" for leaf in layout.leaves):
                stamp = {leaf.name: leaf for leaf in layout.leaves}
                seconds = layout.values(data, stamp["header.stamp.sec"])
                columns["stamp_ns"] = seconds * 1_000_000_000 + layout.values(data, stamp["header.stamp.nanosec"])
            self.parts.append(_Part(block.log_times[rows], (order << 40) + block.place[rows], columns))

    def frame(self, start_ns: int) -> pd.DataFrame:
        """The table, its index in seconds since `start_ns`."""
        if not self.parts:
            return pd.DataFrame(index=pd.Index(np.zeros(0), name="t_s", dtype=np.float64))
        times = np.concatenate([part.times for part in self.parts])
        order = np.lexsort((np.concatenate([part.order for part in self.parts]), times))
        index = pd.Index((times[order] - start_ns).astype(np.float64) * 1e-9, name="t_s", dtype=np.float64)
        return pd.DataFrame({name: pd.Series(self._column(name, order), index=index) for name in self._names()}, index=index)

    def _names(self) -> list[str]:
        """The columns in the order in which they come first."""
        firsts = [(part.times.min(), part.order[part.times.argmin()], number) for number, part in enumerate(self.parts)]
        names: dict[str, None] = {}
        for *_, number in sorted(firsts):
            names |= dict.fromkeys(self.parts[number].columns)
        return list(names)

    def _column(self, name: str, order: Numbers) -> npt.NDArray[Any] | list[Any]:
        pieces = [part.columns.get(name) for part in self.parts]
        whole = [piece for piece in pieces if piece is not None]
        if len(whole) == len(pieces):
            joined = np.concatenate(whole)[order]
            # As pandas does with numbers of Python: unsigned only where it must be.
            if joined.dtype == np.uint64 and joined.max() <= np.iinfo(np.int64).max and "[" not in name:
                joined = joined.astype(np.int64)
            # Texts get the type that pandas finds for them.
            return joined.tolist() if joined.dtype == object else joined
        # Where some messages lack the column, there is nothing.
        filled = np.full(len(order), None, dtype=object)
        at = 0
        for part, piece in zip(self.parts, pieces, strict=True):
            if piece is not None:
                filled[at : at + len(piece)] = piece
            at += len(part.times)
        found: list[Any] = filled[order].tolist()
        return found

    def _message(self, layout: Layout, data: npt.NDArray[np.uint8]) -> dict[str, npt.NDArray[Any]]:
        columns = {}
        for leaf in layout.leaves:
            top = leaf.name.split(".", 1)[0].split("[", 1)[0]
            if top != "header":
                columns[self.units.get(top, top) + leaf.name[len(top) :]] = layout.values(data, leaf)
        return columns

    def _joint_state(self, layout: Layout, data: npt.NDArray[np.uint8]) -> dict[str, npt.NDArray[Any]]:
        leaves: dict[str, Leaf] = {leaf.name: leaf for leaf in layout.leaves}
        joints = []
        for index in range(layout.counts["name"]):
            names = layout.values(data, leaves[f"name[{index}]"])
            if (names != names[0]).any():
                raise NoView
            joints.append(names[0])
        return {
            column if len(joints) == 1 else f"{joint}.{column}": layout.values(data, leaves[f"{name}[{index}]"])
            for name, column in self.units.items()
            for index, joint in enumerate(joints)
            if layout.counts[name] == len(joints)
        }


def read_views(
    path: Path,
    types: dict[str, str],
    store: Any,
    span: tuple[int, int | None, int | None],
    progress: Callable[[float], None],
) -> dict[str, pd.DataFrame]:
    """Tables of those topics that can be read as views; the others are not among them.

    `types`: message type by topic. `span`: zero of the index, and the times from which and before which messages count
    [ns since 1970]. Raises `ValueError` where a file is damaged.
    """
    start_ns, first, last = span
    files = _files(path)
    tables = {topic: ViewedTable(kind, store) for topic, kind in types.items() if kind != DIAGNOSTICS}
    if not files:
        return {}
    order = 0
    try:
        for number, file in enumerate(files):

            def told(share: float, before: int = number) -> None:
                progress((before + share) / len(files))

            for chunk in blocks(file, set(tables), first, last, told):
                order += 1
                for block in chunk:
                    if block.topic in tables:
                        try:
                            tables[block.topic].add(block, order)
                        except NoView:
                            del tables[block.topic]
    except UnreadableByIndex:
        return {}
    return {topic: table.frame(start_ns) for topic, table in tables.items()}


def _files(path: Path) -> list[Path]:
    """The MCAP files of a bag in their order; none where they are compressed as a whole, or message by message."""
    if path.is_file():
        return [path] if path.suffix == ".mcap" else []
    about = YAML(typ="safe").load((path / "metadata.yaml").read_text(encoding="utf-8"))["rosbag2_bagfile_information"]
    if (about.get("compression_mode") or "none").lower() != "none":
        return []
    files = [path / Path(name).name for name in about["relative_file_paths"]]
    return files if all(file.suffix == ".mcap" for file in files) else []
