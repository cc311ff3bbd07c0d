# SPDX-License-Identifier: Apache-2.0
"""Simulation: a model and a motion become a log."""
from __future__ import annotations

import concurrent.futures
import math
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from . import _arrays, _core
from ._log import Log, made_log
from ._model import Model, as_model, select_terms
from ._motion import Motion, temperature_of
from ._results import DataWarning
from ._units import si, whole

_Progress = Callable[[str, str, int, int], object] | None
_Model = Model | str | os.PathLike[str] | Mapping[str, Any]
_Terms = str | Sequence[str] | None


class _Run:
    """A simulation that has begun."""

    def __init__(self, model: _Model, rate: Any, duration: Any, motion: Any, temperature: Any,
                 options: dict[str, Any], level: int) -> None:
        unit = select_terms(as_model(model), options.pop("only"), options.pop("without"))
        run, field = options.pop("run"), options.pop("field")
        run = whole("run", run, 0, 2 ** 32 - 1)
        options["seed"] = whole("seed", options["seed"], 0, 2 ** 64 - 1)
        if options["substeps"] is not None:
            options["substeps"] = whole("substeps", options["substeps"], 1, 2 ** 63 - 1)
        if motion is not None:
            motion = _motion(motion, rate, options)
            options.update(motion._rest)
        if rate is None and motion is not None:
            rate = motion.rate
        if rate is None:
            raise TypeError("rate is missing, such as rate=100 or rate='200 Hz'")
        if field is not None:
            options.update(zip(("field_north", "field_east", "field_down"), _vector(field)))
            if "mag" not in unit:
                raise ValueError("field: the model has no magnetometer")
        length = math.nan if duration is None else si("duration", duration, "s")
        self._core = _core.simulation(unit._core, {"rate": rate, **options}, run, length,
                                      None if motion is None else motion._core,
                                      temperature_of(temperature))
        self.rate = si("rate", rate, "Hz")
        self.name = unit.get("name", "the model")
        self.columns = self._core.columns()
        for finding_level, _, message, _ in self._core.findings("the motion"):
            if finding_level == 2:
                warnings.warn(message, DataWarning, stacklevel=level)

    @property
    def left(self) -> int | None:
        """Rows to come; None: without end."""
        return self._core.left()

    def take(self, rows: int, threads: int, progress: _Progress) -> Log:
        """The next rows."""
        left = self.left
        arrays = [_arrays.empty(rows) for _ in self.columns]
        made = self._core.next(arrays, threads, progress)
        due = rows if left is None else min(rows, left)
        if made < rows:
            arrays = [array[:made] for array in arrays]
        return made_log(self.name, self.columns, arrays, 1 / self.rate, due)

    def truth(self, threads: int, progress: _Progress) -> Log:
        """The truth behind all rows."""
        rows = self.left
        if rows is None:
            raise TypeError("duration is missing: this motion has no end")
        arrays = [_arrays.empty(rows) for _ in range(_TRUTH_COLUMNS)]
        columns = self._core.truth(arrays, threads, progress)
        return made_log("the truth", columns, arrays[:len(columns)], 1 / self.rate, rows)


_TRUTH_COLUMNS = 17


def _motion(motion: Any, rate: Any, options: dict[str, Any]) -> Motion:
    rest = {key: options.pop(key) for key in ("roll", "pitch", "yaw", "earth")}
    latitude, height = options.pop("latitude"), options.pop("height")
    for key, value in rest.items():
        if value is not None:
            raise ValueError(f"{key} is of a unit at rest, and there is a motion")
    if isinstance(motion, Motion):
        if latitude is not None or height is not None:
            raise ValueError("latitude and height are of a unit at rest, and there is a motion")
        return motion
    if isinstance(motion, str) and "\n" in motion:
        return Motion.parse(motion, latitude=latitude, height=0.0 if height is None else height,
                            seed=options["seed"])
    return Motion(motion, rate=rate, latitude=latitude, height=0.0 if height is None else height,
                  seed=options["seed"])


def _vector(field: Any) -> tuple[Any, ...]:
    vector = tuple(field) if not isinstance(field, str) else ()
    if len(vector) != 3:
        raise ValueError("field: expected three numbers [T] or texts: north, east and down")
    return vector


def simulate(model: _Model, rate: float | str | None = None,
             duration: float | str | None = None, *, seed: int = 1, run: int = 0,
             motion: Any = None, temperature: Any = None,
             latitude: float | str | None = None, height: float | str | None = None,
             roll: float | str | None = None, pitch: float | str | None = None,
             yaw: float | str | None = None, earth: bool | None = None,
             field: Sequence[float | str] | None = None, substeps: int | None = None,
             increments: bool = False, only: _Terms = None, without: _Terms = None,
             threads: int = 0, progress: _Progress = None) -> Log:
    """Simulate a run of a sensor unit with all its errors, as `imukit simulate` does.

    model        a Model, path of a model file, or name of the catalogue
    rate         sampling rate [Hz], or a text such as "200 Hz"; a recorded motion has one
    duration     [s], or a text such as "2 h"; without, the whole motion
    seed         the same seed makes the same numbers on every machine
    run          another run of the same sensor: other noise, other run-to-run biases
    motion       a Motion, path of a motion file, or columns (see Motion); without, at rest
    temperature  [K], or a text such as "25 degC"; path of a profile; or columns time, temperature
    latitude, height  place of a unit at rest [rad], [m]; default 45 deg, 0 m
    roll, pitch, yaw  attitude of a unit at rest [rad]; default 0: level, heading north
    earth        False: without Earth rate and gravity
    field        magnetic field north, east and down [T], for a model with a magnetometer; default:
                 that of a dipole at the latitude
    substeps     parts of a sample, 1 … 512, for vibration and bandwidth; default: as needed
    increments   increments of angle and velocity (dtheta_x, dvel_x) instead of rates
    only, without  terms of the model, such as "gyro.noise" or ("bias", "scale_factor")
    threads      0: one per processor; the numbers do not depend on it
    progress     called with (stage, unit, done, total); False ends the work

    The log has the columns time, gyro_x … accel_z, and mag_x … and temperature where there are
    some, in SI units, or in counts where the model has a sensitivity. Warns of terms that are left
    out. Raises imukit.Error. Source: include/imukit/simulate_log.h.

    >>> import imukit
    >>> log = imukit.simulate("tactical", rate=100, duration="10 s", seed=1)
    >>> log.rows, list(log)[:3], round(float(log["accel_z"][0]))
    (1000, ['time', 'gyro_x', 'gyro_y'], -10)
    """
    begun = _begin(locals())
    if begun.left is None:
        raise TypeError("duration is missing, such as duration=60 or duration='1 h'")
    return begun.take(begun.left, threads, progress)


def simulate_truth(rate: float | str | None = None, duration: float | str | None = None,
                   motion: Any = None, *, model: _Model | None = None, seed: int = 1, run: int = 0,
                   latitude: float | str | None = None, height: float | str | None = None,
                   roll: float | str | None = None, pitch: float | str | None = None,
                   yaw: float | str | None = None, earth: bool | None = None, threads: int = 0,
                   progress: _Progress = None) -> Log:
    """The truth behind a simulation, row by row: position, velocity and attitude at the time of the
    row (not of a recorded motion), and what perfect sensors read over the row.

    rate, duration, motion, latitude, height, roll, pitch, yaw, earth  as in simulate()
    model, seed, run  as in simulate(), where the model has errors of the clock
    threads      0: one per processor
    progress     called with (stage, unit, done, total); False ends the work

    Raises imukit.Error. Source: include/imukit/simulate_log.h.

    >>> import imukit
    >>> truth = imukit.simulate_truth(rate=10, duration=1, latitude="30 deg")
    >>> round(float(truth["gyro_x"][0]) * 1e5, 3), round(float(truth["accel_z"][0]), 3)
    (6.315, -9.793)
    """
    given = locals()
    given["model"] = Model() if model is None else model
    given.update(dict.fromkeys(("temperature", "field", "substeps", "only", "without")))
    return _begin({**given, "increments": False}).truth(threads, progress)


class Blocks(Iterator[Log]):
    """The blocks of simulate_blocks(); columns, units and rate are known before the first."""

    def __init__(self, begun: _Run, rows: int, threads: int) -> None:
        self._run, self._rows, self._threads = begun, rows, threads
        self._closed = False
        self.units = {name: unit for name, _, unit in begun.columns}
        """SI unit of each column"""
        self.rate = begun.rate
        """sampling rate [Hz]"""

    @property
    def rows_left(self) -> int | None:
        """Rows to come, those that are lost included; None: without end."""
        return self._run.left

    def close(self) -> None:
        """End: no block comes any more. Done at the end of a `with` statement."""
        self._closed = True

    def __enter__(self) -> Blocks:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError("the state of a simulation cannot be copied; begin another of this seed")

    def __next__(self) -> Log:
        while not self._closed and (left := self._run.left) != 0:
            rows = self._rows if left is None else min(self._rows, left)
            block = self._run.take(rows, self._threads, None)
            if block.rows > 0:
                return block
        raise StopIteration


def simulate_blocks(model: _Model, rate: float | str | None = None,
                    duration: float | str | None = None, rows: int = 65536, *,
                    seed: int = 1, run: int = 0, motion: Any = None, temperature: Any = None,
                    latitude: float | str | None = None, height: float | str | None = None,
                    roll: float | str | None = None, pitch: float | str | None = None,
                    yaw: float | str | None = None, earth: bool | None = None,
                    field: Sequence[float | str] | None = None, substeps: int | None = None,
                    increments: bool = False, only: _Terms = None, without: _Terms = None,
                    threads: int = 0) -> Blocks:
    """Simulate in blocks, each a Log of its own, so that the memory does not depend on the length.
    Together they are the log of simulate(), whatever the rows of a block.

    rows      of a block; the last has fewer
    duration  [s]; without, the whole motion, and without an end where it has none

    The other arguments are those of simulate(): model, rate, seed, run, motion, temperature,
    latitude, height, roll, pitch, yaw, earth, field, substeps, increments, only, without, threads.

    Raises imukit.Error; RuntimeError where two threads take blocks at once.
    Source: include/imukit/simulate_log.h.

    >>> import imukit
    >>> blocks = imukit.simulate_blocks("tactical", rate=100, rows=1000)
    >>> first, second = next(blocks), next(blocks)
    >>> first.rows, float(second["time"][0]), blocks.rows_left
    (1000, 10.0, None)
    """
    given = locals()
    del given["rows"]
    rows = whole("rows", rows, 1, 2 ** 63 - 1)
    return Blocks(_begin({**given, "progress": None}), rows, threads)


def simulate_runs(model: _Model, runs: int, rate: float | str | None = None,
                  duration: float | str | None = None, *, run: int = 0, threads: int = 0,
                  **options: Any) -> list[Log]:
    """Simulate several runs of a unit, on several threads: other noise, other run-to-run biases.

    runs      how many
    run       number of the first
    threads   runs at a time; 0: one per processor
    options   the other arguments of simulate(); model, rate and duration are those, too

    Raises imukit.Error. Source: include/imukit/simulate_log.h.

    >>> import imukit
    >>> logs = imukit.simulate_runs("tactical", 3, rate=100, duration=1)
    >>> len({float(log["gyro_x"][0]) for log in logs})
    3
    """
    runs, threads = whole("runs", runs, 1, 2 ** 32), whole("threads", threads, 0, 65536)
    run = whole("run", run, 0, 2 ** 32 - 1)
    unit = as_model(model)
    with concurrent.futures.ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        waiting = [pool.submit(simulate, unit, rate, duration, run=run + k, threads=1, **options)
                   for k in range(runs)]
        try:
            return [made.result() for made in waiting]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _begin(given: dict[str, Any]) -> _Run:
    options = {key: value for key, value in given.items() if key not in (
        "model", "rate", "duration", "motion", "temperature", "threads", "progress", "given")}
    return _Run(given["model"], given["rate"], given["duration"], given["motion"],
                given["temperature"], options, 5)
