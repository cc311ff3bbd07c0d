# SPDX-License-Identifier: Apache-2.0
"""Numbers with units."""
from __future__ import annotations

from . import _core


def si(name: str, value: float | str, unit: str) -> float:
    """A number in SI units, or a text with a unit of the same dimension as `unit`."""
    return _core.quantity(name, value, unit)
