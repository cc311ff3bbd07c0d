# SPDX-License-Identifier: Apache-2.0
"""Evaluation of references and readings, as test laboratories do it."""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Sequence
from typing import Any

from . import _core
from ._estimates import channel_of, plain_value
from ._inputs import Data, is_path, is_several, open_record
from ._results import Result, tell
from ._scenes import as_motion


@dataclasses.dataclass(frozen=True, slots=True)
class Figure:
    """A figure of a test, such as the linearity. What is not determined is NaN."""

    value: float
    """[unit]; shares of the full scale have the unit '1'"""
    lower: float
    """lower end of the interval [unit]"""
    upper: float
    """upper end of the interval [unit]"""
    unit: str
    """SI unit"""
    level: int | None
    """index of the level at which it occurs; None: of all"""
    limit: str
    """limit that it is compared with; '': none"""
    verdict: str
    """'met', 'met, not surely', 'not met', 'not determined'; '': without a limit"""


class EvaluateResult(Result):
    """The figures of a test. See evaluate()."""

    @property
    def limits_met(self) -> bool:
        """No figure is beyond its limit, or not determined."""
        return bool(self._data["result"]["limits_met"])

    def figures(self, channel: str | None = None) -> dict[str, Figure]:
        """The figures of a channel by their names, such as 'linearity'; the name of the channel may
        be left out if there is only one. Raises KeyError."""
        result = self._data["result"]
        found = channel_of(result["channels"] + result["static"], channel)["figures"]
        return {name: Figure(plain_value(f["value"]), plain_value(f.get("lower")),
                             plain_value(f.get("upper")), f["unit"], f.get("level"),
                             f.get("limit") or "", f.get("verdict") or "")
                for name, f in found.items()}


def evaluate(data: Data | Sequence[Data] = (), rate: float | str | None = None, *,
             columns: str | Sequence[str] | None = None, limit: str | None = None,
             static: Data | None = None, full_scale: float | str | None = None,
             sensitivity: float | str | None = None, zero: float | str | None = None,
             level_width: float | str | None = None, confidence: float = 0.95,
             motion: str | os.PathLike[str] | None = None,
             motion_offset: float | str | None = None, table_axis: str | None = None,
             section: str | None = None, keep_delay: bool = False,
             minimum: float | str | None = None, trim: float | str | None = None,
             settle: float | str | None = None, levels: bool = False, unit: str | None = None,
             serial: str | None = None, operator: str | None = None,
             laboratory: str | None = None, date: str | None = None,
             at_temperature: str | None = None, gaps: str = "refuse",
             progress: Callable[[str, str, int, int], object] | None = None,
             **log: Any) -> EvaluateResult:
    """Linearity, hysteresis, resolution and more of references and readings.

    data         a table, or a record of a test: path of a file, dictionary, list or table of
                 columns; or a sequence of these, each a run. A table has the columns reference and
                 reading (or several: reading_x …), and may have direction (1 up, -1 down), run and
                 sigma. A record has its reference in columns (reference_rate_x, reference_force_x
                 …, table_rate) or in `motion`
    rate         sampling rate of records [Hz], or a text such as "200 Hz"; of no table
    columns      names of the columns, with units in brackets ("reading [deg/s]"); without, SI
    limit        "linearity 0.05 %, zero 0.2 deg/s": figures are compared with these
    static       the same of the unit at rest, for the bias instability
    full_scale   to which % refers [unit of the reference]; None: the largest reference
    sensitivity  nominal, of readings in counts [counts per unit of the reference]
    zero         counts at zero
    level_width  references at most this far apart are one level [unit of the reference]; None:
                 1e-5 of full scale in records, 0 in tables
    confidence   of intervals, and of the coverage, 0 … 1
    motion       motion file that the table ran, or the text of a script: the reference of a record
    motion_offset  time of the record at which it begins [s], or 'auto': find it; None: 0 s
    table_axis   'x', 'y' or 'z': axis about which the column table_rate turns the unit
    section      column of texts that names the runs of a record
    keep_delay   do not move a reference that comes later or earlier than the readings
    minimum      shortest stretch of constant reference [s]; None: 0.5 s
    trim         left out at both ends of a stretch [s]; None: 0.2 s
    settle       left out in addition at the beginning [s]; None: 0 s
    levels       show the levels in the text
    unit, serial, operator, laboratory, date, at_temperature  texts for the page
    gaps         rows missing in `static`: 'refuse', 'bridge' or 'longest'
    progress     called with (stage, unit, done, total); False ends the work
    log          options for reading a log: see read_log()

    Raises imukit.Error: no reference, no readings, a limit of a figure that there is not.
    Source: include/imukit/evaluate.h, evaluate_log.h; the result: docs/json.md.

    >>> import imukit
    >>> reference = [-2.0, -1.0, 0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0]
    >>> reading = [-2.002, -1.001, 0.001, 1.002, 2.003, 1.0, 0.0, -1.0, -2.001]
    >>> result = imukit.evaluate({"reference [rad/s]": reference, "reading [rad/s]": reading},
    ...                          limit="linearity 0.1 %")
    >>> figure = result.figures()["linearity"]
    >>> figure.value < 1e-3, figure.limit, result.limits_met
    (True, '0.1 %', True)
    """
    if motion_offset is not None and motion is None:
        raise ValueError("motion_offset goes with motion")
    auto = motion_offset == "auto"
    settings = {"confidence": confidence, "minimum": minimum, "trim": trim, "settle": settle,
                "sections": section is not None, "keep_delay": keep_delay}
    reading = {"section": section, "table_axis": table_axis, "find_offset": auto,
               "motion_offset": None if auto else motion_offset}
    quantities = {"full_scale": full_scale, "sensitivity": sensitivity, "zero": zero,
                  "level_width": level_width}
    sheet = {"unit": unit, "serial": serial, "operator": operator, "laboratory": laboratory,
             "date": date, "at_temperature": at_temperature, "limit": limit, "levels": levels,
             "gaps": gaps}
    runs: Sequence[Data] = data if is_several(data) or data == () else [data]
    records = tuple(_open(run, rate, columns, log) for run in runs)
    rest = None if static is None else open_record(static, rate, None, log, "static")
    moved = None if motion is None else as_motion(motion)
    result = EvaluateResult(*_core.evaluate(records, rest, settings, reading, quantities, sheet,
                                            moved, progress))
    tell(result)
    return result


def _open(data: Data, rate: float | str | None, columns: str | Sequence[str] | None,
          log: dict[str, Any]) -> Any:
    """A record, or a table, which has no times."""
    reading = {**log, "any_columns": True, "reopened": True} if is_path(data) else log
    try:
        table = open_record(data, 1.0 if rate is None else rate, columns, reading)
    except _core.Error:
        table = None  # reading it as a record tells why
    if table is not None and _core.is_table(table):
        return table
    return open_record(data, rate, columns, log)
