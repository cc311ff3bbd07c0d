# SPDX-License-Identifier: Apache-2.0
"""Classes of models."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from . import _core
from ._results import Result, tell
from ._scenes import ModelLike, named_models, terms


class GradeResult(Result):
    """Classes of models. See grade(); result.models has the numbers of each."""


def grade(models: ModelLike | Sequence[ModelLike], *, map: str = "all",
          assume_class: str | None = None, threads: int = 0,
          progress: Callable[[str, str, int, int], object] | None = None) -> GradeResult:
    """Class of models by their biases and by computed performance, and the terms that limit it.

    models        a Model, the name of a file or of a device; or up to 8 of them, to compare
    map           the map that figure() draws: 'gyro', 'accel', 'cost', 'sensor-cost' or 'all'
    assume_class  typical values for terms that are not stated: 'own', or 'strategic', 'navigation',
                  'tactical', 'AHRS', 'control'
    threads       0: one per processor
    progress      called with (stage, unit, done, total); a false value but None ends the work

    Raises imukit.Error: a model that states nothing to grade. Source:
    include/imukit/grade_position.h; the fields of the result: docs/json.md.

    >>> import imukit
    >>> bias = {"bias": {"repeatability": "0.8 deg/h"}, "noise": {"bias_instability": "0.1 deg/h"}}
    >>> unit = imukit.grade(imukit.Model({"gyro": bias}, name="unit")).models[0]
    >>> unit.gyro, unit.limiting
    ('tactical', 'gyro bias')
    """
    result = GradeResult(*_core.grade(named_models(models), terms(None, None, assume_class),
                                      {"map": map}, threads, progress))
    tell(result)
    return result
