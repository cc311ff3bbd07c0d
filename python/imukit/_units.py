# SPDX-License-Identifier: Apache-2.0
"""Numbers with units."""
from __future__ import annotations

import operator
from typing import Any

from . import _core


def si(name: str, value: float | str, unit: str) -> float:
    """A number in SI units, or a text with a unit of the same dimension as `unit`."""
    return _core.quantity(name, value, unit)


def whole(name: str, value: Any, least: int, most: int) -> int:
    """A whole number, also one of NumPy, from `least` to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, not {type(value).__name__}") from None
    if not least <= number <= most:
        raise ValueError(f"{name}={number}: expected {least} to {most}")
    return number
