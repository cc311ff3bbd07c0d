# SPDX-License-Identifier: Apache-2.0
"""Models, motions and vectors that drift(), grade(), navigate() and tune() take."""
from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _core
from ._inputs import is_path
from ._model import Model, as_model
from ._motion import Motion
from ._units import si

ModelLike = Model | str | os.PathLike[str] | Mapping[str, Any]
Numbers = float | str | Sequence[float | str]


def named_models(models: ModelLike | Sequence[ModelLike]) -> tuple[tuple[str, Any], ...]:
    """Models with the names that results show."""
    if isinstance(models, Sequence) and not isinstance(models, str):
        return tuple(named_model(model) for model in models)
    return (named_model(models),)


def named_model(model: ModelLike) -> tuple[str, Any]:
    """A model and its name: that of its file or of the catalogue, or the one that it states."""
    made = as_model(model)
    if is_path(model):
        return os.fspath(model), made._core  # type: ignore[arg-type]
    return str(made.get("name", None) or "the model"), made._core


def terms(only: str | Sequence[str] | None, without: str | Sequence[str] | None,
          assume_class: str | None) -> tuple[Any, Any, str | None]:
    """Which terms are used, for the C functions."""
    return _names("only", only), _names("without", without), assume_class


def _names(argument: str, names: str | Sequence[str] | None) -> tuple[str, ...] | None:
    if names is None:
        return None
    if isinstance(names, str):
        names = names.replace(",", " ").split()
    if not all(isinstance(name, str) for name in names):
        raise TypeError(f"{argument}: expected names of terms")
    return tuple(names)


def as_motion(motion: Any, latitude: float | str | None = None,
              height: float | str | None = None, seed: int = 1) -> tuple[str, Any]:
    """A motion of a Motion, the name of a file or the text of a script, with its name."""
    if isinstance(motion, Motion):
        if latitude is not None or height is not None:
            raise ValueError("latitude and height are for a motion given as a file or a text")
        if motion.kind == "rest":
            raise ValueError("the motion is at rest; here it must move")
        return motion.name or "the motion", motion._core
    place: dict[str, Any] = {"latitude": latitude, "height": height or 0.0, "seed": seed}
    if isinstance(motion, str) and "\n" in motion:
        return "the motion", Motion.parse(motion, **place)._core
    if is_path(motion):
        return os.fspath(motion), Motion(motion, **place)._core
    raise TypeError("motion: expected a Motion, the name of a file or the text of a script")


def texts(argument: str, given: str | Sequence[str] | None) -> tuple[str, ...]:
    """One text, or several."""
    several = () if given is None else (given,) if isinstance(given, str) else given
    if not isinstance(several, Sequence) or not all(isinstance(text, str) for text in several):
        raise TypeError(f"{argument}: expected texts")
    if any("\0" in text for text in several):
        raise ValueError(f"{argument}: a text has a character 0")
    return tuple(several)


def numbers(argument: str, value: Numbers, unit: str) -> tuple[float, ...]:
    """Numbers in SI units: one, several, or a text such as "1 2 3 deg"."""
    return with_sigmas(argument, value, unit)[0]


def with_sigmas(argument: str, value: Numbers,
                unit: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Numbers and their 1 sigma, which a text may state: "1 2 3 +- 0.1 deg"."""
    if isinstance(value, str):
        return _core.quantities(argument, value, unit)
    several: Any = value if hasattr(value, "__iter__") else (value,)
    made = tuple(si(argument, x, unit) for x in several)
    return made, (0.0,) * len(made)


def vector(argument: str, value: Numbers, unit: str, *, one: bool = False) -> tuple[float, ...]:
    """Three numbers in SI units. @param one  a single one stands for all three"""
    made = numbers(argument, value, unit)
    if one and len(made) == 1:
        made = 3 * made
    if len(made) != 3:
        raise ValueError(f"{argument}: expected three numbers{' or one' if one else ''}, and there "
                         f"are {len(made)}")
    return made
