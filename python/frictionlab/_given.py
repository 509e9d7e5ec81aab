"""What a caller gives: files, tables in memory and options, made ready for the extension module."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from .errors import BadInput

if TYPE_CHECKING:
    import pandas as pd

    from ._native import Table

Floats: TypeAlias = npt.NDArray[np.float64]
# A file or folder, a DataFrame, or arrays by the names that a file's columns would have.
Data: TypeAlias = "str | os.PathLike[str] | pd.DataFrame | Mapping[str, npt.ArrayLike]"


def numbers(values: Any, name: str, dimensions: Sequence[int] = (1,)) -> Floats:
    """An array of 64-bit numbers, whatever holds them; read-only and strided arrays are copied."""
    try:
        array = np.asarray(values)
    except (ValueError, TypeError) as error:
        raise BadInput(f"`{name}` must be an array of numbers, but cannot be made one: {error}") from None
    if array.dtype.kind in "mM":
        array = _seconds(array)
    if array.dtype.kind not in "biuf":
        raise BadInput(f"`{name}` must hold numbers, but its type is {array.dtype}; convert it, as by .astype(float)")
    if array.ndim not in dimensions:
        shape = " by ".join(map(str, array.shape)) or "a single number"
        raise BadInput(f"`{name}` must have {' or '.join(map(str, dimensions))} dimension(s), but it is {shape}")
    return np.asarray(array, dtype=np.float64, order="C")


def _seconds(times: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Times of day and lengths of time in seconds from the first."""
    if times.size == 0:
        return times.astype(np.float64)
    since: npt.NDArray[Any] = (times - times.flat[0]) / np.timedelta64(1, "ns") * 1e-9
    return since


def table(data: Mapping[str, Any] | pd.DataFrame, name: str) -> Table:
    """The columns of a table in memory, each a matrix with a column for each joint."""
    columns = []
    for key, values in _columns(data).items():
        if not isinstance(key, str):
            raise BadInput(f"{name}: a column must be called by a text, as velocity_rad_s, but is called {key!r}")
        values = _only_numbers(values)
        if values is None:
            continue
        matrix = numbers(values, key, (1, 2))
        columns.append((key, matrix.reshape(len(matrix), -1)))
    return name, columns


def _columns(data: Mapping[str, Any] | pd.DataFrame) -> dict[Any, Any]:
    columns = dict(data.items())
    index: Any = getattr(data, "index", None)
    # A named index is a column that pandas has put aside, as `table()` of friction_analysis does.
    if getattr(index, "name", None) is not None and index.name not in columns:
        columns = {index.name: np.asarray(index)} | columns
    return columns


def _only_numbers(values: Any) -> Any:
    """The values; none of a DataFrame's column that holds texts, which a file may hold beside numbers."""
    dtype = getattr(values, "dtype", None)
    is_series = hasattr(values, "to_numpy")
    if is_series and dtype is not None and str(dtype) in {"object", "str", "string", "category"}:
        return None
    return values.to_numpy() if is_series else values


def is_table(data: object) -> bool:
    """Whether it is a table in memory."""
    return isinstance(data, Mapping) or (hasattr(data, "columns") and hasattr(data, "items"))


def inputs(data: Data | Iterable[Data], what: str) -> tuple[list[str], list[Table]]:
    """Names of files and tables in their order, and the tables."""
    if isinstance(data, str | os.PathLike) or is_table(data) or hasattr(data, "read"):
        data = [data]  # type: ignore[list-item]
    if not isinstance(data, Iterable):
        raise BadInput(f"the {what} must be files, DataFrames or arrays by name, but is {type(data).__name__}")
    names, tables = [], []
    several = list(data)
    for number, one in enumerate(several, 1):
        if is_table(one):
            kind = "arrays" if isinstance(one, Mapping) else "DataFrame"
            name = f"<{kind}>" if what == "data" and len(several) == 1 else f"<{what} {number}: {kind}>"
            tables.append(table(one, name))  # type: ignore[arg-type]
            names.append(name)
        else:
            names.append(path(one))  # type: ignore[arg-type]
    return names, tables


def path(file: str | os.PathLike[str]) -> str:
    """The path of a file that is named; not of one that is open."""
    if hasattr(file, "read"):
        closed = "a closed file" if getattr(file, "closed", False) else "an open file"
        raise BadInput(f"expected the path of a file, but got {closed}; give its name")
    if not isinstance(file, str | os.PathLike):
        raise BadInput(f"expected a file, a DataFrame or arrays by name, but got {type(file).__name__}")
    found = os.fspath(file)
    if isinstance(found, str) and "://" in found:
        raise BadInput(f"expected a file on this machine, but got the address {found}; frictionlab.fleet reads addresses")
    return str(Path(found)) if found else found


def options(given: Mapping[str, Any]) -> list[str]:
    """Options of the command from keywords: `torque_source="driving"` is `--torque-source=driving`."""
    line = []
    for name, value in given.items():
        option = "--" + name.strip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            line.append(option)
        elif isinstance(value, str | int | float | os.PathLike) or not isinstance(value, Iterable):
            line.append(f"{option}={_word(value)}")
        else:
            line.append(f"{option}=" + ",".join(map(_word, value)))
    return line


def _word(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return repr(float(value))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)
