# SPDX-License-Identifier: Apache-2.0
"""Logs that become other logs: compensated, and converted."""
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


def _name(data: Data) -> str:
    if isinstance(data, (str, os.PathLike)):
        return os.fspath(data)
    return data.path if isinstance(data, Log) else "the record"
