# SPDX-License-Identifier: Apache-2.0
"""Paths of a model file in its tree, and numbers as the file has them."""
from __future__ import annotations

import numbers
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from . import _core

PATHS = tuple(_core.model_paths())
TEXTS = ("name", "description", "residual_of", "correlation.parameters", "correlation.values",
          *(f"{sensor}.{key}" for sensor in ("gyro", "accel", "mag")
            for key in ("noise.density", "evidence.source", "evidence.method", "evidence.frame",
                        "evidence.interval_95", "evidence.upper_bound")))
TOP = ("name", "description", "residual_of", "gyro", "accel", "mag", "timing", "correlation")
GROUPS = {path[:at.start()] for path in (*PATHS, *TEXTS) for at in re.finditer(r"\.|\[", path)} \
    | {path for path in TEXTS if path.endswith(("interval_95", "upper_bound"))}
_EVIDENCE = re.compile(r"(.*\.evidence\.(?:interval_95|upper_bound))\.(.+)")
_PATH = re.compile(r"[^.\[\]]+(\[\d+\])*(\.[^.\[\]]+(\[\d+\])*)*")


def bare(path: str) -> str:
    """A path as Model.paths() has it, without the index of an element at its end."""
    return re.sub(r"\[\d+\]", "[]", path).removesuffix("[]")


def split(path: str) -> list[Any]:
    """Keys and indices; the names in evidence are keys with dots."""
    if not isinstance(path, str):
        raise TypeError(f"the path of a model is a text, not {type(path).__name__}")
    evidence = _EVIDENCE.fullmatch(path)
    if evidence:
        return [*split(evidence[1]), evidence[2]]
    if not _PATH.fullmatch(path):
        raise KeyError(f"{path!r} is no path of a model file, such as 'gyro.bias.fixed'")
    return [int(step[1:-1]) if step[0] == "[" else step
            for step in re.findall(r"[^.\[\]]+|\[\d+\]", path)]


def child(node: Any, step: Any, path: str) -> Any:
    if isinstance(step, int):
        if isinstance(node, list) and step < len(node):
            return node[step]
        if isinstance(node, str) and step == 0:
            return node  # one coefficient of a polynomial needs no list
    elif isinstance(node, dict) and step in node:
        return node[step]
    raise KeyError(f"{path!r} is not stated by the model")


def leaves(path: str, node: Any) -> Iterator[str]:
    if isinstance(node, dict) and node:
        for key, below in node.items():
            yield from leaves(f"{path}.{key}", below)
    elif isinstance(node, list) and (_core.path_unit(path) is None
                                     and _core.path_unit(f"{path}[0]")
                                     or node and isinstance(node[0], dict)):
        for k, below in enumerate(node):
            yield from leaves(f"{path}[{k}]", below)
    elif isinstance(node, str) and _core.path_unit(path) is None \
            and _core.path_unit(f"{path}[0]"):
        yield f"{path}[0]"
    else:
        yield path


def insert(tree: dict[str, Any], steps: list[Any], leaf: Any, path: str) -> None:
    node: Any = tree
    for step, after in zip(steps, [*steps[1:], None]):
        made: Any = leaf if after is None else [] if isinstance(after, int) else {}
        if isinstance(step, int) and isinstance(node, list) and step == len(node):
            node.append(made)
        elif isinstance(step, int) and not (isinstance(node, list) and step < len(node)) or \
                isinstance(step, str) and not isinstance(node, dict):
            raise KeyError(f"{path!r}: the model has no such element")
        elif after is None or isinstance(step, str) and step not in node:
            node[step] = made
        if isinstance(after, int) and isinstance(node[step], str):
            node[step] = [node[step]]
        node = node[step]


# ---- values ----

def shaped(axes: int, columns: int, values: list[float]) -> Any:
    if columns == 1:
        return tuple(values) if axes else values[0]
    rows = tuple(tuple(values[k:k + columns]) for k in range(0, len(values), columns))
    return rows if axes else rows[0]


def plain(node: Any, rows: bool) -> Any:
    """A text as it is, a list as a tuple; the rows of correlations as numbers."""
    if isinstance(node, list):
        return tuple(plain(item, rows) for item in node)
    return tuple(map(float, str(node).split())) if rows else node


def _number(value: Any, path: str) -> str:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{path}: expected numbers, or a text with a unit, "
                        f"not {type(value).__name__}")
    return repr(float(value))


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _is_several(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes, bytearray))


def encode(path: str, value: Any, sigma: Any = None) -> Any:
    """A value as the file has it."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if hasattr(sigma, "tolist"):
        sigma = sigma.tolist()
    if isinstance(value, str) and sigma is None:
        return value
    if hasattr(value, "to_dict"):
        value = value.to_dict()
    if isinstance(value, Mapping) and sigma is None:
        return {key: encode(f"{path}.{key}" if path else key, below)
                for key, below in value.items() if path or key != "imukit"}
    if path and _EVIDENCE.fullmatch(path) and ".interval_95." in path and \
            _is_several(value) and len(value) > 0 and not isinstance(value[0], str):
        rows = list(zip(*value)) if _is_several(value[0]) else value
        return [_quantity(end, None, _core.path_unit(path), path) for end in rows]
    if path in TEXTS and not path.startswith("correlation."):
        raise TypeError(f"{path}: expected a text, not {type(value).__name__}")
    unit = _core.path_unit(path)
    if unit is None and _is_several(value) and \
            (_core.path_unit(f"{path}[0]") or not all(map(_is_number, value))):
        return [encode(f"{path}[{k}]", item) for k, item in enumerate(value)]
    if unit is None:
        unit = _core.path_unit(f"{path}[0]")  # the only coefficient of a polynomial
    return _quantity(value, sigma, unit, path)


def _quantity(value: Any, sigma: Any, unit: str | None, path: str) -> Any:
    """Numbers with their 1 sigma and unit: one text, or one for each row."""
    if isinstance(value, str) and sigma is None:
        return value
    if _is_several(value) and not all(map(_is_number, value)):
        every = sigma if _is_several(sigma) else [sigma] * len(value)
        if len(every) != len(value):
            raise ValueError(f"{path}: {len(every)} rows of 1 sigma for {len(value)} rows")
        return [_quantity(row, s, unit, path) for row, s in zip(value, every)]
    texts = [_joined(value, path)]
    if sigma is not None:
        texts += ["±", _joined(sigma, path)]
    if unit:
        texts.append(unit)
    return " ".join(texts)


def _joined(value: Any, path: str) -> str:
    return " ".join(_number(x, path) for x in (value if _is_several(value) else [value]))
