# SPDX-License-Identifier: Apache-2.0
"""Identification of noise."""
from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

from . import _core
from ._inputs import Data, is_path, open_record
from ._model import Model
from ._results import Result, tell


class IdentifyResult(Result):
    """The noise of every channel of a record at rest. See identify()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 model: str | None) -> None:
        super().__init__(core, findings)
        self._model = model

    def terms(self, channel: str) -> Any:
        """The terms of a channel by their names: each has present, value, sigma, lower, upper and
        unit (SI). Raises KeyError."""
        for found in self.channels:
            if found.name == channel:
                return found.terms
        raise KeyError(f"{channel!r}; there are: {', '.join(c.name for c in self.channels)}")

    @property
    def model(self) -> Model | None:
        """The noise as a model; None where no channel is a gyro or an accelerometer."""
        return None if self._model is None else Model.parse(self._model)


_FAULTS = {"outliers": _core.SCREEN_OUTLIERS, "stuck": _core.SCREEN_STUCK,
           "saturated": _core.SCREEN_SATURATED, "warm-up": _core.SCREEN_WARM_UP,
           "temperature": _core.SCREEN_TEMPERATURE}


def identify(data: Data, rate: float | str | None = None, *,
             columns: str | Sequence[str] | None = None, confidence: float = 0.95,
             significance: float = 0.01, keep: str | Sequence[str] = (),
             method: str = "likelihood", tolerance: float | None = None, gauss_markov: int = 0,
             gaps: str = "keep", name: str | None = None, threads: int = 0,
             progress: Callable[[str, str, int, int], object] | None = None,
             **log: Any) -> IdentifyResult:
    """The noise of every channel of a record at rest, with intervals and a verdict.

    data          path of a log; vector; matrix (rows are samples); dictionary, list or table of
                  columns. NaN is a missing sample
    rate          sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    columns       names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    confidence    of intervals and bounds, 0 … 1
    significance  chance that an absent term is reported as present, below 0.5
    keep          faults that are left in: 'outliers', 'stuck', 'saturated', 'warm-up',
                  'temperature', 'all', or a sequence of these
    method        'likelihood' of the spectrum, or 'allan': least squares on the Allan deviations
    tolerance     with 'allan': error allowed in each deviation beside the statistical one, a share
    gauss_markov  with 'allan': Gauss-Markov terms to look for, 0 … 8
    gaps          rows that are missing: 'keep', 'bridge', 'longest' or 'refuse'
    name          of the model
    threads       0: one per processor
    progress      called with (stage, unit, done, total); False ends the work
    log           options for reading a log: see read_log()

    Raises imukit.Error: the record is too short, constant, or its times are not equally spaced.
    Source: include/imukit/identify_log.h; the fields of the result: docs/json.md.

    >>> import imukit, random
    >>> random.seed(1)
    >>> x = [random.gauss(0, 1e-3) for _ in range(20000)]
    >>> result = imukit.identify(x, rate=100, columns="gyro_x [rad/s]")
    >>> term = result.terms("gyro_x").angle_random_walk
    >>> term.present, term.lower < 1e-4 < term.upper, term.unit
    (True, True, 'rad/sqrt(s)')
    """
    if method not in ("likelihood", "allan"):
        raise ValueError(f"method={method!r}: expected 'likelihood' or 'allan'")
    if method != "allan" and (tolerance is not None or gauss_markov):
        raise ValueError("tolerance and gauss_markov go with method='allan'")
    settings = {"gaps": gaps, "confidence": confidence, "significance": significance,
                "take_out": _take_out(keep), "from_allan": method == "allan",
                "tolerance": tolerance, "gauss_markov_max": gauss_markov}
    record = open_record(data, rate, columns, {"reopened": True, **log} if is_path(data) else log)
    if name is None:
        name = os.path.basename(os.fspath(data)) if is_path(data) else "record"
    result = IdentifyResult(*_core.identify(record, name, settings, threads, progress))
    tell(result)
    return result


def _take_out(keep: str | Sequence[str]) -> int:
    bits = _core.SCREEN_ALL
    for fault in (keep,) if isinstance(keep, str) else keep:
        if fault == "all":
            return 0
        if fault not in _FAULTS:
            raise ValueError(f"keep={fault!r}: expected {', '.join(_FAULTS)} or all")
        bits &= ~_FAULTS[fault]
    return bits
