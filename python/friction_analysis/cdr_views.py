"""Many messages of one type at once: numbers are read where they stand, as NumPy views of the serialised bytes (CDR).

Where a number stands depends on the lengths of the strings and sequences before it. The first message tells the layout, and
all messages whose lengths are the same share it; the others get layouts of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from rosbags.interfaces import Nodetype

Bytes = npt.NDArray[np.uint8]
Values = npt.NDArray[Any]

NUMBERS = {
    "bool": "u1",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float32": "f4",
    "float64": "f8",
}
# More values a message than this make no columns that anybody could read.
MOST_VALUES = 1000
# Layouts a block of messages may have before it is read message by message instead.
MOST_LAYOUTS = 64


class NoView(Exception):  # noqa: N818 - not an error: such messages are read one by one
    """The messages cannot be read as views: their type has parts that are not numbers or texts, or each has its own layout."""


@dataclass(frozen=True)
class Leaf:
    """A value of the message: `name` with its path, as in `header.stamp.sec` or `position[0]`."""

    name: str
    kind: str
    """A name of `NUMBERS`, or `string`."""
    offset: int
    size: int
    element: bool
    """Whether it is one of an array."""


@dataclass
class Layout:
    """Where everything stands in messages of equal lengths."""

    order: Literal["<", ">"]
    leaves: list[Leaf] = field(default_factory=list)
    lengths: list[tuple[int, int]] = field(default_factory=list)
    """Places of lengths, and what stands there."""
    counts: dict[str, int] = field(default_factory=dict)
    """Elements of each sequence by its name."""

    def fits(self, data: Bytes) -> npt.NDArray[np.bool_]:
        """Which rows have this layout."""
        fitting = np.ones(len(data), dtype=bool)
        for offset, length in self.lengths:
            fitting &= self.numbers(data, offset, "uint32") == length
        return fitting

    def numbers(self, data: Bytes, offset: int, kind: str) -> Values:
        """One number of every row."""
        dtype = np.dtype(NUMBERS[kind]).newbyteorder(self.order)
        part = np.ascontiguousarray(data[:, offset : offset + dtype.itemsize])
        found: Values = part.view(dtype)[:, 0].astype(dtype.newbyteorder("="))
        return found

    def values(self, data: Bytes, leaf: Leaf) -> Values:
        """A value of every row, in the type in which it comes message by message."""
        if leaf.kind == "string":
            return _texts(np.ascontiguousarray(data[:, leaf.offset : leaf.offset + leaf.size]))
        numbers = self.numbers(data, leaf.offset, leaf.kind)
        if leaf.kind == "bool":
            truths: Values = numbers != 0
            return truths
        if leaf.element:
            return numbers
        # A number of its own becomes one of Python's, which has no short forms.
        values: Values = numbers.astype(
            np.float64 if numbers.dtype.kind == "f" else np.uint64 if leaf.kind == "uint64" else np.int64
        )
        return values


def layouts(data: Bytes, type_name: str, store: Any) -> list[tuple[Layout, npt.NDArray[np.int64]]]:
    """The layouts in a block of messages of one length, each with the rows that have it.

    `store` is a type store of rosbags that knows the type. Raises `NoView`.
    """
    left = np.arange(len(data))
    found: list[tuple[Layout, npt.NDArray[np.int64]]] = []
    while len(left):
        if len(found) == MOST_LAYOUTS:
            raise NoView
        layout = _Walk(data[left[0]], store).layout(type_name)
        # The encoding is among what has to be the same.
        fitting = layout.fits(data[left]) & (data[left][:, :2] == data[left[0], :2]).all(axis=1)
        found.append((layout, left[fitting]))
        left = left[~fitting]
    return found


class _Walk:
    """Goes through one message and notes where everything stands."""

    def __init__(self, message: Bytes, store: Any) -> None:
        self.message = message.tobytes()
        self.store = store
        if len(self.message) < 4 or self.message[0] != 0 or self.message[1] not in (0, 1):
            raise NoView
        self.result = Layout("<" if self.message[1] else ">")
        self.at = 4

    def layout(self, type_name: str) -> Layout:
        self._type("", type_name)
        # Up to three bytes may fill the message up; more is something else.
        if not self.at <= len(self.message) < self.at + 4:
            raise NoView
        return self.result

    def _type(self, prefix: str, type_name: str) -> None:
        for name, description in self.store.fielddefs[type_name][1]:
            self._field(f"{prefix}{name}", description, element=False)

    def _field(self, name: str, description: Any, *, element: bool) -> None:
        kind, detail = description
        if kind == Nodetype.BASE:
            self._base(name, detail[0], element=element)
        elif kind == Nodetype.NAME:
            self._type(f"{name}.", detail)
        else:
            inner, size = detail
            count = size if kind == Nodetype.ARRAY else self._length()
            self.result.counts[name] = count
            # Every element is a byte at least: a count that is larger is damage.
            if count > min(MOST_VALUES, len(self.message)):
                raise NoView
            for index in range(count):
                self._field(f"{name}[{index}]", inner, element=True)

    def _base(self, name: str, base: str, *, element: bool) -> None:
        if base == "string":
            length = self._length()
            self._leaf(Leaf(name, base, self.at, max(0, length - 1), element), length)
        elif base in NUMBERS:
            size = np.dtype(NUMBERS[base]).itemsize
            self._align(size)
            self._leaf(Leaf(name, base, self.at, size, element), size)
        else:
            raise NoView

    def _leaf(self, leaf: Leaf, size: int) -> None:
        if self.at + size > len(self.message) or len(self.result.leaves) >= MOST_VALUES:
            raise NoView
        self.result.leaves.append(leaf)
        self.at += size

    def _length(self) -> int:
        self._align(4)
        part = self.message[self.at : self.at + 4]
        if len(part) < 4:
            raise NoView
        length = int.from_bytes(part, "little" if self.result.order == "<" else "big")
        self.result.lengths.append((self.at, length))
        self.at += 4
        return length

    def _align(self, size: int) -> None:
        # Places count from behind the four bytes of encoding.
        self.at += -(self.at - 4) % size


def _texts(data: Bytes) -> Values:
    """Texts of equal length; most topics have one and the same, which is decoded once."""
    count, width = data.shape
    found = np.empty(count, dtype=object)
    if width == 0:
        found[:] = ""
    elif (data == data[0]).all():
        found[:] = data[0].tobytes().decode()
    else:
        kinds, which = np.unique(data, axis=0, return_inverse=True)
        found[:] = np.array([kind.tobytes().decode() for kind in kinds], dtype=object)[which.reshape(-1)]
    return found
