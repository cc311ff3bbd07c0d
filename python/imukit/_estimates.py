# SPDX-License-Identifier: Apache-2.0
"""Estimates with their uncertainty."""
from __future__ import annotations

import dataclasses
import math
from typing import Any


@dataclasses.dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its uncertainty. What is not known is NaN."""

    value: float
    """0 where it is absent [unit]"""
    sigma: float
    """1 sigma [unit]"""
    lower: float
    """lower end of the interval [unit]"""
    upper: float
    """upper end of the interval, or the upper bound of what is absent [unit]"""
    present: bool
    """False: the data do not show it"""
    unit: str
    """SI unit"""


def plain_value(found: Any) -> Any:
    """The number of a quantity; anything else as it is, without a number NaN."""
    value = found["value"] if isinstance(found, dict) else found
    return math.nan if value is None else value


def estimate_of(found: dict[str, Any]) -> Estimate:
    """Of an object with value, sigma, lower, upper."""
    unit = found["unit"] if "unit" in found else found["value"]["unit"]
    value, sigma, lower, upper = (plain_value(found.get(key))
                                  for key in ("value", "sigma", "lower", "upper"))
    return Estimate(value, sigma, lower, upper, bool(found.get("present", True)), unit)


def estimates_of(terms: dict[str, Any]) -> dict[str, Estimate]:
    """Of an object of such objects."""
    return {name: estimate_of(found) for name, found in terms.items()}


def channel_of(channels: list[dict[str, Any]], name: str | None) -> dict[str, Any]:
    """The channel of a name, which may be left out if there is only one. Raises KeyError."""
    fit = [c for c in channels if name in (None, c["name"])]
    if len(fit) != 1:
        raise KeyError(f"{name!r}; there are: {', '.join(c['name'] for c in channels)}")
    return fit[0]
