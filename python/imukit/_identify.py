# SPDX-License-Identifier: Apache-2.0
"""Identification of noise."""
from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

from . import _core
from ._estimates import Estimate, channel_of, estimates_of
from ._inputs import Data, is_path, open_record
from ._model import Model, as_model
from ._results import Result, tell, wrap
from ._scenes import ModelLike


class IdentifyResult(Result):
    """The noise of every channel of a record at rest, or of several records. See identify()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 model: str | None) -> None:
        super().__init__(core, findings)
        self._model = model

    def terms(self, channel: str) -> Any:
        """The terms of a channel by their names: each has present, value, sigma, lower, upper and
        unit (SI). Raises KeyError."""
        return wrap(channel_of(self._data["result"]["channels"], channel)["terms"])

    @property
    def estimates(self) -> dict[str, dict[str, Estimate]]:
        """The terms by channel and name: result.estimates["gyro_x"]["angle_random_walk"].value. Of
        different devices, which have no estimate together, see `population` of the channels."""
        return {channel["name"]: estimates_of(channel["terms"])
                for channel in self._data["result"]["channels"] if "terms" in channel}

    @property
    def model(self) -> Model | None:
        """The noise as a model, or the model `into` with this noise; None where no channel is a
        gyro or an accelerometer."""
        return None if self._model is None else Model.parse(self._model)


class RecordPlan(Result):
    """How accurately a record determines the noise of a model. See plan_record()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]], duration: float,
                 met: bool) -> None:
        super().__init__(core, findings)
        self.duration = duration
        """length that was planned, or that meets what is wanted [s]; 0: none"""
        self.met = met
        """a record of this length meets all that is wanted"""


_FAULTS = {"outliers": _core.SCREEN_OUTLIERS, "stuck": _core.SCREEN_STUCK,
           "saturated": _core.SCREEN_SATURATED, "warm-up": _core.SCREEN_WARM_UP,
           "temperature": _core.SCREEN_TEMPERATURE}


def identify(data: Data, rate: float | str | None = None, *,
             columns: str | Sequence[str] | None = None, confidence: float = 0.95,
             significance: float = 0.01, keep: str | Sequence[str] = (),
             method: str = "likelihood", tolerance: float | None = None, gauss_markov: int = 0,
             gaps: str = "keep", name: str | None = None, into: ModelLike | None = None,
             truth: ModelLike | None = None, twin: bool = False, seed: int = 1,
             verbose: bool = False, threads: int = 0,
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
    into          Model, file or name of the catalogue: `result.model` is this one, with only the
                  noise and the output filter replaced
    truth         the same: its values are shown beside the estimates, for simulated records
    twin, seed    simulate the model over the length of the record, for the figure
    verbose       the text has the messages of the verdict with all details, as the page
    threads       0: one per processor
    progress      called with (stage, unit, done, total); a false value but None ends the work
    log           options for reading a log: see read_log()

    Raises imukit.Error: the record is too short, constant, or its times are not equally spaced; the
    axes of `into` are others. Source: include/imukit/identify_log.h; the fields of the result:
    docs/json.md.

    >>> import imukit, random
    >>> random.seed(1)
    >>> x = [random.gauss(0, 1e-3) for _ in range(20000)]
    >>> result = imukit.identify(x, rate=100, columns="gyro_x [rad/s]")
    >>> term = result.estimates["gyro_x"]["angle_random_walk"]
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
    result = IdentifyResult(*_core.identify(record, False, settings,
                                            _ending([data], name, twin, seed, verbose),
                                            _core_of(truth), _core_of(into), threads, progress))
    tell(result)
    return result


def identify_runs(data: Sequence[Data], rate: float | str | None = None, *,
                  columns: str | Sequence[str] | None = None, confidence: float = 0.95,
                  significance: float = 0.01, keep: str | Sequence[str] = (), gaps: str = "keep",
                  name: str | None = None, into: ModelLike | None = None,
                  truth: ModelLike | None = None, twin: bool = False, seed: int = 1,
                  verbose: bool = False, threads: int = 0,
                  progress: Callable[[str, str, int, int], object] | None = None,
                  **log: Any) -> IdentifyResult:
    """One joint model of several records of one sensor, whether these agree, and how much the mean
    differs from run to run.

    data     2 to 24 records, each as identify() takes it; all have the same columns

    rate, columns, confidence, significance, keep, gaps, name, into, truth, twin, seed, verbose,
    threads, progress and log are as of identify(), for all records.

    Raises imukit.Error: the columns or rates of the records differ; errors of identify().
    Source: include/imukit/identify_several.h.

    >>> import imukit, random
    >>> random.seed(1)
    >>> runs = [[random.gauss(0, 1e-3) for _ in range(5000)] for _ in range(3)]
    >>> result = imukit.identify_runs(runs, rate=100, columns="gyro_x")
    >>> term = result.estimates["gyro_x"]["angle_random_walk"]
    >>> term.lower < 1e-4 < term.upper, result.channels[0].agreement.probability > 1e-6
    (True, True)
    """
    return _several(True, data, rate, columns, confidence, significance, keep, gaps,
                    _ending(data, name, twin, seed, verbose), truth, into, threads, progress, log)


def identify_devices(data: Sequence[Data], rate: float | str | None = None, *,
                     columns: str | Sequence[str] | None = None, confidence: float = 0.95,
                     significance: float = 0.01, keep: str | Sequence[str] = (),
                     gaps: str = "keep", verbose: bool = False, threads: int = 0,
                     progress: Callable[[str, str, int, int], object] | None = None,
                     **log: Any) -> IdentifyResult:
    """Mean and spread of each term over different sensors of one kind, and which of them differ.

    data     2 to 24 records, each as identify() takes it; all have the same columns

    rate, columns, confidence, significance, keep, gaps, verbose, threads, progress and log are
    as of identify(), for all records.

    Raises imukit.Error: the columns of the records differ; errors of identify().
    Source: include/imukit/identify_several.h.

    >>> import imukit, random
    >>> random.seed(1)
    >>> units = [[random.gauss(0, 1e-3) for _ in range(5000)] for _ in range(3)]
    >>> result = imukit.identify_devices(units, rate=100, columns="gyro_x")
    >>> found = result.channels[0].population.angle_random_walk
    >>> found.mean_lower < 1e-4 < found.mean_upper, found.unit
    (True, 'rad/sqrt(s)')
    """
    return _several(False, data, rate, columns, confidence, significance, keep, gaps,
                    _ending(data, None, False, 1, verbose), None, None, threads, progress, log)


def identify_curve(data: Data, rate: float | str, duration: float | str, *,
                   columns: str | Sequence[str] | None = None, confidence: float = 0.95,
                   significance: float = 0.01, tolerance: float | None = None,
                   gauss_markov: int = 0, plain: bool = False, name: str | None = None,
                   into: ModelLike | None = None, truth: ModelLike | None = None,
                   verbose: bool = False,
                   progress: Callable[[str, str, int, int], object] | None = None,
                   **log: Any) -> IdentifyResult:
    """The noise behind a table of Allan deviations, such as that of a data sheet.

    data          path of a table, or columns: tau [s], and a column of deviations for each channel
    rate          sampling rate of the record behind the table [Hz]
    duration      length of this record [s]
    columns       names of the columns, with units in brackets ("gyro_x [deg/h]"); without, SI
    confidence    of intervals and bounds, 0 … 1
    significance  chance that an absent term is reported as present, below 0.5
    tolerance     error allowed in each deviation beside the statistical one, a share; None: the
                  smallest with which the terms explain the curve, which is told
    gauss_markov  Gauss-Markov terms to look for, 0 … 8
    plain         the clusters of the curve do not overlap
    name, into, truth, verbose, progress, log  as of identify()

    Raises imukit.Error: not such a table, fewer than four averaging times.
    Source: include/imukit/identify_curve.h.

    >>> import imukit
    >>> tau = [0.01 * 2 ** k for k in range(12)]
    >>> table = {"tau [s]": tau, "gyro_x": [1e-4 / t ** 0.5 for t in tau]}
    >>> result = imukit.identify_curve(table, rate=100, duration="10 min")
    >>> f"{result.estimates['gyro_x']['angle_random_walk'].value:.1e}"
    '1.0e-04'
    """
    settings = {"rate": rate, "duration": duration, "confidence": confidence,
                "significance": significance, "tolerance": tolerance,
                "gauss_markov_max": gauss_markov, "plain": plain}
    record = open_record(data, rate, columns,
                         {"any_columns": True, **log} if is_path(data) else log)
    result = IdentifyResult(*_core.identify(record, True, settings,
                                            _ending([data], name, False, 1, verbose),
                                            _core_of(truth), _core_of(into), 1, progress))
    tell(result)
    return result


def plan_record(model: ModelLike, rate: float | str, *, want: str | None = None,
                duration: float | str | None = None, significance: float = 0.01) -> RecordPlan:
    """How accurately a record determines the noise of a model, and how long to record.

    model         Model, file or name of the catalogue
    rate          sampling rate of the record [Hz], or a text such as "200 Hz"
    want          what the record shall determine: "bias_instability 5%, gyro.rate_random_walk
                  detected 95%"
    duration      planned length [s]; None: the shortest that does what is wanted
    significance  chance that an absent term is reported as present, below 0.5

    Raises imukit.Error: the model has no noise, or no such term.
    Source: include/imukit/record_plan.h.

    >>> import imukit
    >>> plan = imukit.plan_record("ADIS16488", "100 Hz", want="bias_instability 5%")
    >>> 2000 < plan.duration < 3000, plan.met
    (True, True)
    """
    settings = {"rate": rate, "want": want, "duration": duration, "significance": significance,
                "curve": True}
    label = model if isinstance(model, (str, os.PathLike)) else as_model(model).get("name", "model")
    result = RecordPlan(*_core.plan_record(_core_of(model), os.fspath(label), settings))
    tell(result)
    return result


def _several(runs: bool, data: Sequence[Data], rate: Any, columns: Any, confidence: float,
             significance: float, keep: str | Sequence[str], gaps: str, ending: dict[str, Any],
             truth: ModelLike | None, into: ModelLike | None, threads: int, progress: Any,
             log: dict[str, Any]) -> IdentifyResult:
    if is_path(data) or not isinstance(data, Sequence):
        raise TypeError("expected a sequence of two records or more")
    settings = {"gaps": gaps, "confidence": confidence, "significance": significance,
                "take_out": _take_out(keep)}
    records = tuple(
        open_record(one, rate, columns, {"reopened": True, **log} if is_path(one) else log,
                    f"record {k + 1}") for k, one in enumerate(data))
    result = IdentifyResult(*_core.identify_several(records, runs, settings, ending,
                                                    _core_of(truth), _core_of(into), threads,
                                                    progress))
    tell(result, 4)
    return result


def _ending(data: Sequence[Data], name: str | None, twin: bool, seed: int,
            verbose: bool) -> dict[str, Any]:
    names = [os.path.basename(os.fspath(one)) if is_path(one) else "record" for one in data]
    source = ", ".join(dict.fromkeys(names))
    return {"source": source, "name": source.partition(".")[0] if name is None else name,
            "twin": twin, "seed": seed, "verbose": verbose}


def _core_of(model: ModelLike | None) -> Any:
    return None if model is None else as_model(model)._core


def _take_out(keep: str | Sequence[str]) -> int:
    bits = _core.SCREEN_ALL
    for fault in (keep,) if isinstance(keep, str) else keep:
        if fault == "all":
            return 0
        if fault not in _FAULTS:
            raise ValueError(f"keep={fault!r}: expected {', '.join(_FAULTS)} or all")
        bits &= ~_FAULTS[fault]
    return bits
