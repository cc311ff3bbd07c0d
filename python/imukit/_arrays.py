# SPDX-License-Identifier: Apache-2.0
"""Arrays of results: of NumPy where it is installed, else memoryviews."""
from __future__ import annotations

import array
import dataclasses
import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

Array = Any
"""A vector of float64: numpy.ndarray where NumPy is installed, else memoryview."""


def of_numbers(numbers: Iterable[float | None]) -> Array:
    """A vector of numbers; None becomes NaN."""
    made = array.array("d", (math.nan if x is None else x for x in numbers))
    return _view(made)


def of_buffer(buffer: Any) -> Array:
    """The numbers of an object with the buffer protocol, not copied."""
    return numpy.asarray(buffer) if numpy is not None else memoryview(buffer)


def of_numeric(values: Any, name: str) -> Any:
    """An array of NumPy of what can become one, such as a column of a table. What is masked is NaN.

    Raises TypeError, which begins with the name, for what is no real number.
    """
    import numpy as found
    made: Any = found.asanyarray(values)
    if made.dtype.kind not in "biuf" or made.dtype.itemsize > 8:
        raise TypeError(f"{name}: items of the type {made.dtype} are no numbers that imukit reads: "
                        "convert them to float64")
    if isinstance(made, found.ma.MaskedArray):
        masked: Any = made.astype(float)
        return masked.filled(math.nan)
    return made.astype(float) if made.dtype == found.float16 else found.asarray(made)


def of_rows(values: Any, name: str) -> Array:
    """A contiguous array of float64: of a number, of numbers, or of rows of them; copied if it is not
    one.

    Raises TypeError or ValueError for what is neither.
    """
    if numpy is not None:
        return numpy.ascontiguousarray(of_numeric(values, name), float)
    try:
        values = memoryview(values).tolist()
    except TypeError:
        pass
    if isinstance(values, (int, float)):
        return _view(array.array("d", [values]))
    rows = [memoryview(row).tolist() if isinstance(row, (array.array, memoryview)) else row
            for row in values]
    if not all(isinstance(row, (list, tuple)) and len(row) == len(rows[0]) for row in rows):
        return _view(array.array("d", map(float, rows)))
    return matrix(_view(array.array("d", [float(x) for row in rows for x in row])), len(rows),
                  len(rows[0]) if rows else 0)


def of_bytes(numbers: bytes, columns: int = 1, column: int = 0) -> Array:
    """A column of a matrix of float64 in memory; read only."""
    return of_buffer(memoryview(numbers).cast("d")[column::columns])


def of_matrix(numbers: bytes, columns: int, which: range, shape: tuple[int, ...],
              rows: int | None = None) -> Array:
    """Some columns of a matrix of float64 in memory, each row in a shape."""
    rows = len(numbers) // (8 * columns) if rows is None else rows
    if numpy is not None:
        return numpy.frombuffer(numbers).reshape(rows, columns)[:, which].reshape(rows, *shape)
    view = memoryview(numbers).cast("d")
    made = array.array("d")
    for row in range(rows):
        made.extend(view[row * columns + which.start:row * columns + which.stop:which.step])
    return memoryview(made).cast("B").cast("d", (rows, *shape))


def times(count: int, rate: float) -> Any:
    """Times of equally spaced samples from 0 [s]."""
    if numpy is not None:
        return numpy.arange(count) / rate
    return array.array("d", (k / rate for k in range(count)))


def columns_of(matrix: Any) -> list[Any]:
    """The columns of a matrix, not copied where NumPy made it or its rows follow each other."""
    if hasattr(matrix, "T") and matrix.ndim == 2:
        return list(matrix.T)
    view: Any = memoryview(matrix)
    if view.ndim == 1:
        return [matrix]
    rows, columns = view.shape or (0, 0)
    if not view.c_contiguous:
        copied = array.array(view.format, (view[i, j] for i in range(rows) for j in range(columns)))
        view = memoryview(copied)
    flat = view.cast("B")
    return [flat.cast(view.format)[column::columns] for column in range(columns)]


def matrix_of(columns: Sequence[Any]) -> Array:
    """A matrix of vectors of float64 of one length: its columns."""
    if numpy is not None:
        return numpy.stack(columns, axis=1)
    made = array.array("d", bytes(8 * len(columns) * len(columns[0])))
    for place, column in enumerate(columns):
        memoryview(made)[place::len(columns)] = column
    return memoryview(made).cast("B").cast("d", (len(columns[0]), len(columns)))


class Vectors:
    """Base of dataclasses with arrays as fields: they can be pickled and copied without NumPy, too."""

    __slots__ = ()

    def __reduce__(self) -> tuple[Any, ...]:
        values = [getattr(self, field.name) for field in dataclasses.fields(self)]
        return _vectors, (type(self), [_Kept.of(x) if isinstance(x, memoryview) else x
                                       for x in values])


class _Kept(NamedTuple):
    """The numbers of a memoryview."""

    numbers: bytes
    shape: tuple[int, ...]

    @classmethod
    def of(cls, view: memoryview) -> _Kept:
        return cls(view.tobytes(), view.shape or ())

    def view(self) -> Array:
        flat = memoryview(array.array("d", self.numbers))
        return flat if len(self.shape) == 1 else flat.cast("B").cast("d", self.shape)


def _vectors(kind: Any, values: list[Any]) -> Any:
    return kind(*(x.view() if isinstance(x, _Kept) else x for x in values))


def equal(a: Array, b: Array) -> bool:
    """Are two vectors equal? NaN is equal to NaN."""
    if numpy is not None:
        return bool(numpy.array_equal(a, b, equal_nan=True))
    return len(a) == len(b) and all(x == y or x != x and y != y for x, y in zip(a, b))


def empty(rows: int) -> Array:
    """A vector to be written."""
    if numpy is not None:
        return numpy.empty(rows)
    return _view(array.array("d", bytes(8 * rows)))


def matrix(vector: Array, rows: int, columns: int) -> Array:
    """The numbers of a vector as rows, not copied."""
    if numpy is not None:
        return vector.reshape(rows, columns)
    return vector.cast("B").cast("d", (rows, columns))


def _view(made: array.array[float]) -> Array:
    return numpy.asarray(made) if numpy is not None else memoryview(made)
