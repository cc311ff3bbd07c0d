# SPDX-License-Identifier: Apache-2.0
"""Models in the formats of other programs."""
from __future__ import annotations

import os
import warnings
from typing import Any

from . import _core
from ._results import DataWarning, Finding


class ParameterText(str):
    """The text of a parameter file, with notes. See Model.to()."""

    notes: tuple[Finding, ...]
    """what was assumed (level 'note'), and what the format cannot hold (level 'warning')"""


def parameter_formats() -> list[str]:
    """The formats of other programs that Model.to() writes and Model.from_parameters() reads.

    Raises nothing. Source: include/imukit/parameter_file.h; docs/other-formats.md.

    >>> import imukit
    >>> imukit.parameter_formats()[:3]
    ['kalibr', 'gazebo', 'matlab']
    """
    return _core.parameter_formats()


def findings_of(notes: list[tuple[bool, str]], level: int) -> tuple[Finding, ...]:
    """Notes as findings; what is lost is told. @param level  frames up to the caller of imukit"""
    found = tuple(Finding("warning", "lost", text) if lost else Finding("note", "assumed", text)
                  for lost, text in notes)
    for finding in found:
        if finding.level == "warning":
            warnings.warn(finding.message, DataWarning, stacklevel=level)
    return found


def written(core: Any, path: str | os.PathLike[str] | None, format: str,
            settings: dict[str, Any]) -> ParameterText:
    """The file of a model, written where there is a path."""
    text, notes = _core.write_parameters(core, path, format, settings)
    made = ParameterText(text)
    made.notes = findings_of(notes, 4)
    return made
