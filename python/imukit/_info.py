# SPDX-License-Identifier: Apache-2.0
"""A first look at a log."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from . import _core
from ._inputs import Data, is_path, log_options, open_record
from ._results import Fields, Result, tell, wrap


class InfoResult(Result):
    """What is in a log. See info(). `record` has the rows, times, faults and columns, `topics` the
    sensors of a log that holds several."""

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]: 1 over the median interval; NaN where it is not known."""
        interval = (self._data["result"]["record"] or {}).get("interval")
        seconds: float | None = interval["value"] if interval else None
        return 1 / seconds if seconds else float("nan")

    @property
    def columns(self) -> dict[str, Fields]:
        """The columns by their names: unit, mean, scatter, range, resolution, clipped values."""
        record = self._data["result"]["record"]
        return {c["name"]: wrap(c) for c in record["columns"]} if record else {}


def info(data: Data, rate: float | str | None = None, *,
         columns: str | Sequence[str] | None = None, full: bool = False,
         progress: Callable[[str, str, int, int], object] | None = None,
         **log: Any) -> InfoResult:
    """What is in a log: sensors, columns, units, rate, gaps, clipping, rest or motion.

    data      path of a log; vector; matrix (rows are samples); dictionary, list or table of columns
    rate      sampling rate [Hz], or a text such as "200 Hz", of a log without times
    columns   names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    full      read every row of a long log, too; else about 64 MB of it are read, and what follows
              from these only is marked
    progress  called with (stage, unit, done, total); a false value but None ends the work
    log       options for reading a log: see read_log()

    A log of which units, times or names are missing is shown in its own numbers, and a warning
    says what is missing; a log with several sensors, none of which is chosen, is listed.

    Raises imukit.Error, imukit.FileError: it is no log, or has no rows. Source:
    include/imukit/info_log.h; the fields of the result: docs/json.md.

    >>> import imukit
    >>> result = imukit.info({"time": [0, 0.01, 0.02, 0.05], "gyro_x": [1, 2, 3, 4]})
    >>> round(result.rate), result.record.gaps, result.record.missing
    (100, 1, 2)
    """
    if is_path(data):
        result = InfoResult(*_core.info(data, log_options(rate, columns, log), full, progress))
    else:
        record = open_record(data, rate, columns, log)
        result = InfoResult(*_core.info_record(record, full, progress))
    tell(result)
    return result
