# SPDX-License-Identifier: Apache-2.0
"""Logs in memory."""
from __future__ import annotations

import array
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from . import _arrays, _core


class Log(Mapping[str, Any]):
    """A log in memory: its columns by their names, in SI units. See read_log().

    log["gyro_x"] is a vector (numpy.ndarray, or memoryview without NumPy) of the log's own memory,
    log["gyro"] a matrix of the columns gyro_x, gyro_y and gyro_z, made from them.
    Every function of imukit takes a Log where it takes data.
    """

    def __init__(self, path: str, described: tuple[Any, ...]) -> None:
        columns, labels, *numbers = described
        self.path = path
        self.labels: tuple[str, ...] = tuple(labels)
        """texts of the label columns, whose values are indices into this"""
        self.units = {name: si for name, _, si, _ in columns}
        """SI unit of each column"""
        self.written_units = {name: unit for name, unit, _, _ in columns}
        """unit of each column in the file"""
        self.interval: float
        (self.rows, self.interval, self.first_time, self.last_time, self.time_origin, self.gaps,
         self.missing, self.not_finite, self.damaged, self.time_origin_nanoseconds) = numbers
        self._columns = {name: numbers for name, _, _, numbers in columns}

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]: 1 over the median interval."""
        return 1.0 / self.interval if self.interval else math.nan

    def __getitem__(self, name: str) -> _arrays.Array:
        axes = [f"{name}_{axis}" for axis in "xyz"]
        if name not in self._columns and all(axis in self._columns for axis in axes):
            return _arrays.matrix_of([_arrays.of_buffer(self._columns[axis]) for axis in axes])
        if name not in self._columns:
            raise KeyError(f"{name!r}; there are: {', '.join(self._columns)}")
        return _arrays.of_buffer(self._columns[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        columns = ", ".join(f"{name} [{self.written_units[name]}]" for name in self)
        return f"{self.path}: {self.rows} rows at {self.rate:.6g} Hz: {columns}"

    def __eq__(self, other: object) -> bool:
        """Equal names, units and numbers; NaN is equal to NaN."""
        if not isinstance(other, Log):
            return NotImplemented
        return list(self.units.items()) == list(other.units.items()) and all(
            _arrays.equal(self[name], other[name]) for name in self)

    __hash__ = None  # type: ignore[assignment]

    def __getstate__(self) -> dict[str, Any]:
        numbers = {name: memoryview(column).tobytes() for name, column in self._columns.items()}
        return {**self.__dict__, "_columns": numbers}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._columns = {name: array.array("d", numbers)
                         for name, numbers in state["_columns"].items()}

    def _imukit_columns(self) -> tuple[list[str], list[Any]]:
        names = [f"{name} [{unit}]" if unit and not name.endswith("]") else name
                 for name, unit in self.units.items()]
        return names, list(self._columns.values())


def made_log(name: str, columns: Sequence[tuple[str, str, str]], arrays: Sequence[Any],
             interval: float, due: int) -> Log:
    """A log of columns that were made in memory: (name, unit, SI unit) of each, and its numbers.

    due  rows that there would be if none were lost
    """
    rows = len(arrays[0])
    time = arrays[0]
    described = [(title, unit, unit, array) for (title, _, unit), array in zip(columns, arrays)]
    lost = due - rows
    gaps = sum(b - a > 1.5 * interval for a, b in zip(time, time[1:])) if lost else 0
    first, last = (float(time[0]), float(time[-1])) if rows else (float("nan"),) * 2
    return Log(name, (described, (), rows, interval, first, last, 0.0, gaps, lost, 0, 0, 0))


def read_log(path: str | os.PathLike[str], *, rate: float | str | None = None,
             columns: str | None = None, map: str | None = None, binary: str | None = None,
             format: str | None = None, topic: str | None = None, instance: int | None = None,
             gyro_unit: str | None = None, accel_unit: str | None = None,
             time_unit: str | None = None, temperature_unit: str | None = None,
             gyro_scale: str | None = None, accel_scale: str | None = None,
             device: str | None = None, gyro_range: str | None = None,
             accel_range: str | None = None, axes: str | None = None,
             after: float | str | None = None, before: float | str | None = None,
             any_columns: bool = False,
             progress: Callable[[str, str, int, int], object] | None = None) -> Log:
    """Read a whole log, of every format that the command reads (docs/log-formats.md).

    rate         sampling rate [Hz] of a log without times
    columns      names for a file without header: "time,gyro_x,-,gyro_z"
    map          columns by the names that the log has: "gyro_x=wx,time=stamp"
    binary       layout of the records of a binary file
    format       name of the format, where the content does not tell it
    topic, instance  which of the sensors in a log that holds several
    gyro_unit, accel_unit, time_unit, temperature_unit  where the file states none: "deg/s"
    gyro_scale, accel_scale  what a count is: "16.4 LSB/(deg/s)"
    device, gyro_range, accel_range  part whose counts these are, and its full scales
    axes         directions of the log's axes, "right-forward-up", mapped to forward-right-down
    after, before  leave out what is before, or after, this time from the start [s]
    any_columns  also accept a table without time and sensors
    progress     called with (stage, unit, done, total); a false value but None ends the work

    Raises imukit.Error, imukit.FileError: the message ends with the option to add. Source:
    include/imukit/log.h.

    >>> import imukit, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "log.csv")
    >>> _ = path.write_text("time [s],gyro_x [deg/s]\\n0,180\\n0.01,90\\n0.02,0\\n")
    >>> log = imukit.read_log(path)
    >>> [round(x, 4) for x in log["gyro_x"].tolist()], log.units["gyro_x"], log.rate
    ([3.1416, 1.5708, 0.0], 'rad/s', 100.0)
    """
    settings = {key: value for key, value in locals().items() if key not in ("path", "progress")}
    if instance is not None:
        settings["instance"] = instance + 1
    return Log(os.fspath(path), _core.load_log(path, settings, progress))
