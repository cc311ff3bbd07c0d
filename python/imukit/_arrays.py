# SPDX-License-Identifier: Apache-2.0
"""Arrays of results: of NumPy where it is installed, else memoryviews."""
from __future__ import annotations

import array
import math
from typing import Any, Iterable

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


def of_array(values: Any) -> Any:
    """An array of NumPy of what can become one, such as a column of a table."""
    import numpy as found
    return found.asarray(values)


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


def of_bytes(numbers: bytes) -> Array:
    """A vector of the numbers of float64 in bytes, not copied."""
    return numpy.frombuffer(numbers) if numpy is not None else memoryview(numbers).cast("d")
