# SPDX-License-Identifier: Apache-2.0
"""What the functions of imukit give back."""
from __future__ import annotations

import contextlib
import dataclasses
import html
import json
import os
import warnings
from typing import Any, Iterator, Mapping

from . import _arrays

LEVELS = ("good", "note", "warning", "failure")


class DataWarning(UserWarning):
    """A doubt about the data, such as gaps in a log."""


@dataclasses.dataclass(frozen=True, slots=True)
class Finding:
    """Something that was noticed in the data."""

    level: str
    """'good', 'note', 'warning' or 'failure'"""
    code: str
    """a word for programs, such as 'gaps'"""
    message: str
    """a sentence for people"""
    name: str = ""
    """the channel concerned, or ''"""


class Fields(Mapping[str, Any]):
    """Named values of a result: fields.name and fields['name'] are the same.

    >>> fields = Fields({"value": 0.5, "unit": "rad/s"})
    >>> fields.value, fields["unit"], list(fields)
    (0.5, 'rad/s', ['value', 'unit'])
    """

    __slots__ = ("_data",)

    def __init__(self, data: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_data", dict(data))

    def __getitem__(self, name: str) -> Any:
        return wrap(self._data[name])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name not in self._data:
            known = ", ".join(self._data)
            raise AttributeError(f"there is no {name!r}; there are: {known}")
        return wrap(self._data[name])

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("results cannot be changed")

    def __reduce__(self) -> tuple[Any, ...]:
        return Fields, (self._data,)

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._data]

    def __repr__(self) -> str:
        return f"Fields({', '.join(f'{k}={wrap(v)!r}' for k, v in self._data.items())})"

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries, lists and numbers."""
        return dict(self._data)


def wrap(value: Any) -> Any:
    """Dictionaries become Fields, lists of numbers arrays, other lists tuples."""
    if isinstance(value, dict):
        return Fields(value)
    if isinstance(value, list):
        if value and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in value):
            return _arrays.of_numbers(value)
        return tuple(wrap(x) for x in value)
    return value


class Result:
    """The result of a function of imukit.

    `data` has every number with its name, as `imukit … --json` prints it (docs/json.md); the fields
    of its part "result" are attributes, too. `findings` says what was noticed in the data.
    print(result) is what the command prints; in a notebook the figure is drawn above it.
    """

    findings: tuple[Finding, ...]
    """what was noticed in the data; warnings among them were told by warnings.warn()"""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]]) -> None:
        self._core = core
        self._data: dict[str, Any] = json.loads(core.json())
        self._text: str | None = None
        self._figure: str | None | bool = False
        self.findings = tuple(Finding(LEVELS[level], *rest) for level, *rest in findings)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        result = self._data.get("result")
        if not isinstance(result, dict) or name not in result:
            known = ", ".join(result) if isinstance(result, dict) else ""
            raise AttributeError(f"there is no {name!r}; there are: {known}")
        return wrap(result[name])

    def __dir__(self) -> list[str]:
        result = self._data.get("result")
        return [*super().__dir__(), *(result if isinstance(result, dict) else ())]

    @property
    def data(self) -> Fields:
        """Everything, as `--json` prints it."""
        return Fields(self._data)

    @property
    def inputs(self) -> Fields:
        """What the result was computed from."""
        return Fields(self._data.get("inputs", {}))

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain dictionaries, lists and numbers, as `--json` prints it."""
        return dict(self._data)

    def figure(self) -> str | None:
        """The figure as SVG; None where the result has none."""
        if self._figure is False:
            self._figure = self._core.figure()
        return self._figure  # type: ignore[return-value]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page (.html), the figure (.svg), the data (.json) or the text (any other
        ending). Raises ValueError for a figure that the result does not have."""
        name = os.fspath(path)
        kind = os.path.splitext(name)[1]
        text: str | None = str(self)
        if kind in (".png", ".pdf"):
            raise ValueError(f"{name}: figures are written as .svg, pages as .html")
        if kind == ".html":
            text = self.page()
        elif kind == ".svg":
            text = self.figure()
        elif kind == ".json":
            text = json.dumps(self._data, indent=1)
        if text is None:
            raise ValueError(f"{name}: the result has no figure")
        try:
            with open(f"{name}.part", "w", encoding="utf-8") as file:
                file.write(text)
            os.replace(f"{name}.part", name)
        except OSError as error:
            with contextlib.suppress(OSError):
                os.unlink(f"{name}.part")
            raise OSError(error.errno, error.strerror, name) from None

    def page(self) -> str:
        """A page (HTML) with all tables and figures. Not of an unpickled result."""
        if self._core is None:
            raise RuntimeError("an unpickled result has no page")
        return self._core.page()  # type: ignore[no-any-return]

    def __str__(self) -> str:
        if self._text is None:
            self._text = self._core.text()
        return self._text

    def __repr__(self) -> str:
        return str(self).rstrip("\n")

    def _repr_html_(self) -> str:
        figure = self.figure() or ""
        return f"{figure}<pre>{html.escape(repr(self))}</pre>"

    def __eq__(self, other: object) -> bool:
        """Equal data."""
        if not isinstance(other, Result):
            return NotImplemented
        return type(self) is type(other) and \
            json.dumps(self._data) == json.dumps(other._data)

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Result:
        made = type(self).__new__(type(self))
        made.__dict__.update(self.__dict__)
        return made

    def __getstate__(self) -> dict[str, Any]:
        str(self)
        self.figure()
        return {**self.__dict__, "_core": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


def tell(result: Result, level: int = 3) -> None:
    """Tell the warnings among the findings. @param level  frames up to the caller of imukit"""
    for finding in result.findings:
        if finding.level == "warning":
            warnings.warn(finding.message, DataWarning, stacklevel=level)
