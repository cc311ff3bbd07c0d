# SPDX-License-Identifier: Apache-2.0
"""Logs that become other logs: compensated, converted, and written to files."""
from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from . import _core
from ._inputs import Data, open_record
from ._log import Log
from ._model import Model, as_model, select_terms
from ._results import LEVELS, DataWarning, Result, tell


class CompensatedLog(Log):
    """A log without the errors that a model describes. See compensate()."""

    result: Result
    """what was taken out and left in, and how many rows have each flag"""


def compensate(data: Data, model: Model | str | os.PathLike[str] | Mapping[str, Any],
               rate: float | str | None = None, *, temperature: float | str | None = None,
               temperature_time: float | str = 30.0, powered_for: float | str = 0.0,
               rate_limit: float | str | None = None, force_limit: float | str | None = None,
               flags: bool = False, only: str | Sequence[str] | None = None,
               without: str | Sequence[str] | None = None,
               columns: str | Sequence[str] | None = None, threads: int = 0,
               progress: Callable[[str, str, int, int], object] | None = None,
               **log: Any) -> CompensatedLog:
    """Take the errors that a model describes out of a log, as `imukit compensate` does: biases,
    scale factors, misalignment and the other deterministic terms, over temperature. Noise stays.

    data         path of a log, a Log, or columns with the names gyro_x … accel_z, temperature
    model        a Model, path of a model file, or name of the catalogue
    rate         sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    temperature  of the unit [K], or a text such as "25 degC", for data without such a column
    temperature_time  over which the rate of temperature is smoothed [s]
    powered_for  how long the unit was on before the first row [s], for warm-up
    rate_limit   largest rate [rad/s], if the model has nonlinear terms but no range
    force_limit  largest specific force [m/s^2], in the same case
    flags        add a column of flags: 1 saturated, 2 temperature, 4 limit, 8 not finite,
                 16 acceleration
    only, without  terms of the model, such as "gyro.bias" or ("bias", "scale_factor")
    columns      names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    threads      0: one per processor
    progress     called with (stage, unit, done, total); a false value but None ends the work
    log          options for reading a log: see read_log()

    The columns of gyros and accelerometers become angular rate [rad/s] and specific force [m/s^2]
    of the body; others are copied. Raises imukit.Error. Source: include/imukit/compensate_log.h.

    >>> import imukit
    >>> model = imukit.Model()
    >>> model["gyro.bias.fixed"] = [0.01, 0.0, 0.0]
    >>> raw = imukit.simulate(model, rate=100, duration=1, earth=False)
    >>> clean = imukit.compensate(raw, model)
    >>> round(float(raw["gyro_x"][50]), 9), abs(round(float(clean["gyro_x"][50]), 9))
    (0.01, 0.0)
    """
    whole = as_model(model)
    terms = None if only is None and without is None else select_terms(whole, only, without)
    name = os.fspath(model) if isinstance(model, (str, os.PathLike)) else "the model"
    settings = {"temperature": temperature, "temperature_time": temperature_time,
                "powered_for": powered_for, "rate_limit": rate_limit, "force_limit": force_limit,
                "flags": flags}
    record = open_record(data, rate, columns, log)
    core, findings, described = _core.compensate(
        record, whole._core, None if terms is None else terms._core, name, settings, threads,
        progress)
    made = CompensatedLog(_name(data), described)
    made.result = Result(core, findings)
    tell(made.result)
    return made


def convert(data: Data, rate: float | str | None = None, *,
            select: str | Sequence[str] | None = None,
            to_point: Sequence[float | str] | None = None, gravity_free: bool = False,
            still: float | str = 10.0, latitude: float | str | None = None,
            height: float | str = 0.0, yaw: float | str = 0.0,
            columns: str | Sequence[str] | None = None, threads: int = 0,
            progress: Callable[[str, str, int, int], object] | None = None, **log: Any) -> Log:
    """Select columns of a log, move its specific force to another point, or take gravity off it, as
    `imukit convert` does. Increments become rates.

    data          path of a log, a Log, or columns with names such as gyro_x
    rate          sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    select        names of the columns to keep, in this order: "time,gyro_x", or a sequence
    to_point      give the specific force at another point of the body, forward, right and down of
                  the accelerometers [m]
    gravity_free  give the acceleration relative to the Earth instead of the specific force; needs a
                  latitude, and a unit that is at rest at the start
    still         time at rest at the start [s]
    latitude, height  place, for gravity [rad], [m]
    yaw           heading at the start, from north to east [rad]
    columns       names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    threads       0: one per processor
    progress      called with (stage, unit, done, total); a false value but None ends the work
    log           options for reading a log: see read_log()

    Raises imukit.Error. Source: include/imukit/convert_log.h.

    >>> import imukit
    >>> raw = imukit.simulate("tactical", rate=100, duration=1)
    >>> list(imukit.convert(raw, select="time,accel_x,accel_y,accel_z,gyro_z"))
    ['time', 'accel_x', 'accel_y', 'accel_z', 'gyro_z']
    """
    if gravity_free and latitude is None:
        raise TypeError("gravity_free: gravity depends on the place; give a latitude")
    settings = {"select": select if select is None or isinstance(select, str)
                else ",".join(select), "gravity_free": gravity_free, "still": still,
                "latitude": latitude, "height": height, "yaw": yaw}
    if to_point is not None:
        point = tuple(to_point) if not isinstance(to_point, str) else ()
        if len(point) != 3:
            raise ValueError("to_point: expected three lengths [m] or texts: forward, right, down")
        settings.update(zip(("point_x", "point_y", "point_z"), point), to_point=True)
    record = open_record(data, rate, columns, log)
    findings, described = _core.convert(record, settings, threads, progress)
    for level, _, message, _ in findings:
        if LEVELS[level] == "warning":
            warnings.warn(message, DataWarning, stacklevel=2)
    return Log(_name(data), described)


def write_log(path: str | os.PathLike[str], data: Data, rate: float | str | None = None, *,
              to_gyro_unit: str | None = None, to_accel_unit: str | None = None,
              to_time_unit: str | None = None, to_temperature_unit: str | None = None,
              decimals: int | None = None, columns: str | Sequence[str] | None = None,
              threads: int = 0, progress: Callable[[str, str, int, int], object] | None = None,
              **log: Any) -> int:
    """Write a log to a file, and give the number of rows.

    path      the ending tells the format: .csv (also .csv.gz, .csv.zst), .npy, .npz, .mat, .h5,
              .bag, .mcap (docs/log-formats.md). The file is complete, or is as it was before
    data      path of a log, whose increments become rates; a Log; or columns with names such as
              gyro_x
    rate      sampling rate [Hz], or a text such as "200 Hz"; without a column of times one is written
              by it, so that it is not lost
    to_gyro_unit, to_accel_unit, to_time_unit, to_temperature_unit  units written, such as "deg/s";
              without, SI, or those of the log that `data` is the path of
    decimals  digits after the point in a text, 0 … 17; without, as many as the number needs, so that
              the same number is read back
    columns   names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    threads   0: one per processor
    progress  called with (stage, unit, done, total); a false value but None ends the work
    log       options for reading a log: see read_log()

    Raises imukit.Error, imukit.FileError. Source: include/imukit/convert_log.h, log.h.

    >>> import imukit, os, tempfile
    >>> log = imukit.simulate("tactical", rate=100, duration=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "log.csv")
    ...     rows = imukit.write_log(path, log, to_gyro_unit="deg/s")
    ...     back = imukit.read_log(path)
    >>> rows, back.written_units["gyro_x"], back["accel_x"][7] == log["accel_x"][7]
    (100, 'deg/s', True)
    """
    if decimals is not None and not 0 <= decimals <= 17:
        raise ValueError(f"decimals={decimals}: expected 0 … 17")
    name = os.fspath(path)
    if name == "-":
        raise ValueError("path='-': expected a file")
    settings = {"to_gyro_unit": to_gyro_unit, "to_accel_unit": to_accel_unit,
                "to_time_unit": to_time_unit, "to_temperature_unit": to_temperature_unit}
    record = open_record(data, rate, columns, log, stamped=True)
    if getattr(data, "labels", ()):
        warnings.warn("a column of texts is written as the numbers of its texts in log.labels; give "
                      "the path of the log to keep them", DataWarning, stacklevel=2)
    findings, rows = _core.write_log(record, name, -1 if decimals is None else decimals,
                                     getattr(data, "time_origin_nanoseconds", 0), settings, threads,
                                     progress)
    for level, code, message, _ in findings:
        if LEVELS[level] == "warning" and code != "unused_sensor":
            warnings.warn(message, DataWarning, stacklevel=2)
    return rows


def _name(data: Data) -> str:
    if isinstance(data, (str, os.PathLike)):
        return os.fspath(data)
    return data.path if isinstance(data, Log) else "the record"
