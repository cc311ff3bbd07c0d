# SPDX-License-Identifier: Apache-2.0
"""Logs, arrays and tables that the functions of imukit take, as records of the library."""
from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _arrays, _core
from ._units import si

Data = Any
"""A path of a log, a Log, a vector, a matrix whose rows are samples, a dictionary of columns, a list
of columns, or a table with columns such as pandas.DataFrame. In a dictionary a matrix of three columns
stands for the axes: {"gyro [deg/s]": w} for "gyro_x [deg/s]" and so on."""


def is_path(data: Data) -> bool:
    """Is it the name of a file?"""
    return isinstance(data, (str, os.PathLike))


def is_several(data: Any) -> bool:
    """Is it a sequence of records, not of the columns of one?"""
    return isinstance(data, (list, tuple)) and len(data) > 0 and all(
        is_path(one) or isinstance(one, Mapping) or hasattr(one, "columns")
        or hasattr(one, "_imukit_columns") for one in data)


def open_record(data: Data, rate: float | str | None, columns: str | Sequence[str] | None,
                log: Mapping[str, Any] | None = None, name: str = "the record",
                stamped: bool = False) -> Any:
    """The record of `data`.

    rate     sampling rate [Hz], or a text such as "200 Hz"
    columns  names of the columns, with units in brackets: "gyro_x [deg/s]"; without, SI
    log      options for reading a log
    name     in messages, where it is no file
    stamped  columns with a rate and without times get a column of times
    """
    if is_path(data):
        return _core.open_log(data, log_options(rate, columns, log))
    if log:
        raise TypeError(f"{', '.join(log)}: only for a log in a file")
    if hasattr(data, "_imukit_columns"):
        names, arrays = data._imukit_columns()
    elif isinstance(data, Mapping) or hasattr(data, "to_numpy") and hasattr(data, "columns"):
        names, arrays = [], []
        for key in data if isinstance(data, Mapping) else data.columns:
            for title, column in _axes(str(key), _column(data[key], f"column {key!r}")):
                names.append(title)
                arrays.append(column)
    else:
        names, arrays = None, _columns(data)
    if columns is not None:
        names = [columns] if isinstance(columns, str) else list(columns)
    if names is None:
        names = _names(_count(arrays))
    hertz = 0.0 if rate is None else si("rate", rate, "Hz")
    if stamped and hertz > 0 and "time" not in [title.partition("[")[0].strip() for title in names]:
        arrays = arrays if isinstance(arrays, list) else _arrays.columns_of(arrays)
        if len(arrays) == len(names) and arrays:
            arrays, names = [_arrays.times(len(arrays[0]), hertz), *arrays], ["time [s]", *names]
    return _core.arrays(name, tuple(names), arrays, hertz)


def _axes(name: str, values: Any) -> list[tuple[str, Any]]:
    """A vector with its name, or the three columns of a matrix with theirs."""
    try:
        view = memoryview(values)
    except TypeError:
        return [(name, values)]
    if view.ndim == 1 or view.shape is None:
        return [(name, values)]
    if view.ndim != 2 or view.shape[1] not in (1, 3):
        hint = ". Rows are samples: is it to be transposed?" if view.shape[0] == 3 else ""
        raise ValueError(f"column {name!r} has the shape {view.shape}: expected a vector, or a "
                         f"column for each axis, x, y and z{hint}")
    if view.shape[1] == 1:
        return [(name, _arrays.columns_of(values)[0])]
    word, bracket, unit = name.partition("[")
    titles = [f"{word.strip()}_{axis}" + (f" [{unit}" if bracket else "") for axis in "xyz"]
    return list(zip(titles, _arrays.columns_of(values)))


def log_options(rate: Any, columns: Any, log: Mapping[str, Any] | None) -> dict[str, Any]:
    """Options for reading a log, as the extension takes them."""
    options = dict(log or {})
    if rate is not None:
        options["rate"] = rate
    if columns is not None:
        options["columns"] = columns if isinstance(columns, str) else ",".join(columns)
    return options


def _names(count: int) -> list[str]:
    return ["x"] if count == 1 else [f"column_{k + 1}" for k in range(count)]


def _count(arrays: Any) -> int:
    if isinstance(arrays, list):
        return len(arrays)
    shape = memoryview(arrays).shape or ()
    return shape[1] if len(shape) == 2 else 1


def _column(values: Any, name: str = "data") -> Any:
    """A vector: as it is where it has the buffer protocol or is a sequence. What is masked is NaN.

    name  in messages
    """
    if values is None or isinstance(values, (str, bytes, bytearray, int, float)):
        hint = " (a path is a str or a PathLike)" if isinstance(values, (bytes, bytearray)) else ""
        raise TypeError(f"{name}: expected a vector of numbers, not {type(values).__name__}{hint}")
    if hasattr(values, "__array__") and not isinstance(values, memoryview):
        return _arrays.of_numeric(values, name)
    try:
        memoryview(values)
    except TypeError:
        if not isinstance(values, Sequence):
            try:
                values = list(values)
            except TypeError:
                raise TypeError(f"{name}: expected a vector of numbers, not "
                                f"{type(values).__name__}") from None
        for place, value in enumerate(values):
            if value is None or isinstance(value, (str, bytes)):
                raise TypeError(f"{name}: item {place} is {type(value).__name__}, not a number; "
                                "NaN is a missing sample") from None
    return values


def _columns(data: Any) -> Any:
    """A vector or matrix with the buffer protocol, or a list of vectors."""
    if isinstance(data, Sequence) and not isinstance(data, (str, bytes, bytearray, memoryview)) \
            and any(_is_vector(x) for x in data):
        return [_column(column, f"column {k + 1}") for k, column in enumerate(data)]
    data = _column(data)
    try:
        memoryview(data)
    except TypeError:
        return [data]
    return data


def _is_vector(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, (str, bytes)) and \
        getattr(value, "ndim", 1) > 0
