# SPDX-License-Identifier: Apache-2.0
"""Allan deviations."""
from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from . import _arrays, _core
from ._inputs import Data, _column, open_record
from ._results import Result, tell


@dataclasses.dataclass(frozen=True, slots=True)
class AllanCurve(_arrays.Vectors):
    """Deviations of one channel over the averaging time: vectors of equal length."""

    name: str
    """the channel"""
    statistic: str
    """'oadev', 'mdev', …"""
    unit: str
    """SI unit of the deviations"""
    tau: _arrays.Array
    """averaging times [s]"""
    deviation: _arrays.Array
    """[unit]"""
    lower: _arrays.Array
    """lower end of the interval [unit]"""
    upper: _arrays.Array
    """upper end of the interval [unit]"""
    edf: _arrays.Array
    """equivalent degrees of freedom"""
    count: _arrays.Array
    """squares averaged"""
    used: _arrays.Array
    """share of the record's pairs that were used; below 1 where samples are missing"""
    noise: tuple[str, ...]
    """noise type at each averaging time: 'white-rate', 'flicker-rate', …"""


class AllanResult(Result):
    """Allan deviations of every channel of a record. See allan()."""

    @property
    def curves(self) -> tuple[AllanCurve, ...]:
        """One curve for each channel and statistic."""
        return tuple(_curve(channel) for channel in self._data["result"]["channels"])

    def curve(self, name: str | None = None, statistic: str | None = None) -> AllanCurve:
        """The curve of a channel and a statistic; each may be left out if there is only one.

        Raises KeyError where none, or more than one, fits."""
        fit = [c for c in self.curves
               if name in (None, c.name) and statistic in (None, c.statistic)]
        if len(fit) != 1:
            known = ", ".join(f"{c.name} {c.statistic}" for c in self.curves)
            raise KeyError(f"{len(fit)} curves are of {name or 'any channel'}, "
                           f"{statistic or 'any statistic'}; there are: {known}")
        return fit[0]


def _curve(channel: dict[str, Any]) -> AllanCurve:
    points = channel["points"]

    def vector(key: str) -> _arrays.Array:
        return _arrays.of_numbers(p[key]["value"] if isinstance(p[key], dict) else p[key]
                                  for p in points)

    unit = points[0]["deviation"]["unit"] if points else ""
    return AllanCurve(channel["name"], channel["statistic"], unit,
                      vector("tau"), vector("deviation"), vector("lower"), vector("upper"),
                      vector("edf"), vector("count"), vector("used"),
                      tuple(p["noise"] for p in points))


def _times(tau: Any) -> list[Any]:
    """Averaging times as one column; a single number is a list of one."""
    times = [float(tau)] if isinstance(tau, (int, float)) else tau
    column = _column(times, "tau")
    if any(not a < b for a, b in zip(column, column[1:])):
        raise ValueError("tau: the times must ascend")
    return [column]


def allan(data: Data, rate: float | str | None = None, *,
          statistic: str | Sequence[str] = "oadev",
          tau: str | Sequence[float] = "octave", columns: str | Sequence[str] | None = None,
          kind: str = "rate", confidence: float = 0.95, edf: str = "exact",
          bias: str = "removed", gaps: str = "keep", threads: int = 0,
          progress: Callable[[str, str, int, int], object] | None = None,
          **log: Any) -> AllanResult:
    """Allan deviations of every channel, with confidence intervals.

    data        path of a log; vector; matrix (rows are samples); dictionary, list or table of
                columns. NaN is a missing sample
    rate        sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    statistic   'oadev', 'adev', 'mdev', 'tdev', 'ohdev', 'hdev', 'totdev', 'mtot', 'htot',
                'theo1', 'pdev', 'haar', 'all', or a sequence of these
    tau         'octave', 'decade', 'many', 'all', or ascending averaging times [s]
    columns     names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    kind        'rate', or 'phase': the columns hold the integral of the rates
    confidence  of the two-sided intervals, 0 … 1
    edf         degrees of freedom: 'exact', or 'greenhall-riley' for the published formulas
    bias        of totdev, mtot, htot and theo1: 'removed', 'published' or 'left'
    gaps        rows that are missing: 'keep', 'bridge', 'longest' or 'refuse'
    threads     0: one per processor
    progress    called with (stage, unit, done, total); a false value but None ends the work
    log         options for reading a log: see read_log()

    Raises imukit.Error: the record is too short or constant, a statistic needs every sample, an
    averaging time is out of range. Source: include/imukit/allan.h, allan_log.h.

    >>> import imukit, random
    >>> random.seed(1)
    >>> result = imukit.allan([random.gauss(0, 0.1) for _ in range(1000)], rate=100)
    >>> curve = result.curve()
    >>> list(curve.tau[:3]), round(float(curve.deviation[0]), 3)
    ([0.01, 0.02, 0.04], 0.1)
    """
    names = (statistic,) if isinstance(statistic, str) else tuple(statistic)
    if names == ("all",):
        names = ("oadev", "adev", "mdev", "tdev", "ohdev", "hdev", "totdev", "mtot", "htot",
                 "theo1", "pdev", "haar")
    grid = tau if isinstance(tau, str) else None
    times = None if grid else _times(tau)
    if kind not in ("rate", "phase"):
        raise ValueError(f"kind={kind!r}: expected 'rate' or 'phase'")
    if edf not in ("exact", "greenhall-riley"):
        raise ValueError(f"edf={edf!r}: expected 'exact' or 'greenhall-riley'")
    settings = {"gaps": gaps, "phase": kind == "phase", "confidence": confidence, "bias": bias,
                "greenhall_riley": edf == "greenhall-riley", "grid": grid}
    record = open_record(data, rate, columns, log)
    result = AllanResult(*_core.allan(record, names, times, settings, threads,
                                      progress))
    tell(result)
    return result
