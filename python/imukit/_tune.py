# SPDX-License-Identifier: Apache-2.0
"""Noise parameters of filters."""
from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from . import _arrays, _core
from ._model import Model
from ._results import Result, tell
from ._scenes import ModelLike, as_motion, named_model, terms

_ANSWERS = ("data_sheet", "data_sheet_x10", "fit", "safe", "fit_scale_factors",
            "safe_scale_factors")


@dataclasses.dataclass(frozen=True, slots=True)
class FilterAnswer(_arrays.Vectors):
    """Numbers of a filter, two-sided densities, and how consistent it is over the time between its
    updates. Triples are of the axes x, y, z."""

    name: str
    """'safe', 'fit', 'data_sheet', …"""
    gyro_white: tuple[float, float, float]
    """white noise of the gyros [rad/s/sqrt(Hz)]"""
    gyro_random_walk: tuple[float, float, float]
    """random walk of their biases [rad/s/sqrt(s)]"""
    gyro_bias_sigma: float
    """1 sigma of their biases at the beginning [rad/s]"""
    accel_white: tuple[float, float, float]
    """[m/s^2/sqrt(Hz)]"""
    accel_random_walk: tuple[float, float, float]
    """[m/s^2/sqrt(s)]"""
    accel_bias_sigma: float
    """[m/s^2]"""
    correlation_time: float | None
    """of Gauss-Markov biases [s]; None: random walks"""
    gyro_scale_factor_sigma: tuple[float, float, float]
    """1 sigma of scale factors that are estimated, too [1]; 0: they are not"""
    accel_scale_factor_sigma: tuple[float, float, float]
    """[1]"""
    mean_nees: float
    """mean square of the errors in units of the filter's covariance: 1 is consistent"""
    time: _arrays.Array
    """between updates [s]"""
    nees: _arrays.Array
    """at these times"""
    largest: _arrays.Array
    """largest eigenvalue: the mean square in the direction that is worst"""


class TuneResult(Result):
    """The noise of a filter. See tune()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 answers: list[str | None]) -> None:
        super().__init__(core, findings)
        self._models = dict(zip(_ANSWERS, answers))

    def answer(self, name: str = "safe") -> FilterAnswer:
        """The numbers of 'safe', 'fit', 'data_sheet', 'data_sheet_x10', 'safe_scale_factors' or
        'fit_scale_factors'. Raises KeyError where there is none."""
        found = self._data["result"]["answers"].get(name)
        if not found:
            known = ", ".join(key for key, a in self._data["result"]["answers"].items() if a)
            raise KeyError(f"{name!r}; there are: {known}")
        gyro, accel = found["gyro"], found["accel"]
        times = found["times"]

        def three(sensor: Any, key: str) -> tuple[float, float, float]:
            x, y, z = sensor[key]["value"]
            return x, y, z

        correlation = gyro["correlation_time"]
        return FilterAnswer(
            name, three(gyro, "angle_random_walk"), three(gyro, "rate_random_walk"),
            gyro["bias_sigma"]["value"], three(accel, "velocity_random_walk"),
            three(accel, "acceleration_random_walk"), accel["bias_sigma"]["value"],
            correlation["value"] if correlation else None, three(gyro, "scale_factor_sigma"),
            three(accel, "scale_factor_sigma"), found["mean_nees"],
            _arrays.of_numbers(t["time"]["value"] for t in times),
            _arrays.of_numbers(t["nees"] for t in times),
            _arrays.of_numbers(t["largest_eigenvalue"] for t in times))

    def model(self, answer: str = "safe") -> Model:
        """A model that states the numbers of an answer, as the file of -o does. Raises KeyError."""
        text = self._models.get(answer)
        if text is None:
            known = ", ".join(key for key, text in self._models.items() if text)
            raise KeyError(f"{answer!r}; there are: {known}")
        return Model.parse(text)


def tune(model: ModelLike, motions: Any, *, rate: float | str | None = None,
         from_time: float | str | None = None, to_time: float | str | None = None,
         windows: int | None = None, gyro_bias: float | str | None = None,
         accel_bias: float | str | None = None, bias_time: float | str | None = None,
         learned: bool = False, correlation_time: float | str | None = None,
         compensated: bool = False, assume_class: str | None = None, per_axis: bool = False,
         only: str | Sequence[str] | None = None, without: str | Sequence[str] | None = None,
         latitude: float | str | None = None, height: float | str | None = None, runs: int = 0,
         seed: int = 1, threads: int = 0,
         progress: Callable[[str, str, int, int], object] | None = None) -> TuneResult:
    """The noise parameters that make a Kalman filter consistent on motions.

    model        of the sensors: a Model, the name of a file or of a device
    motions      a Motion, name of a motion file, or text of a script; or up to 8 of them
    rate         sampling rate [Hz]; default 200, or that of recorded rates and forces
    from_time, to_time  shortest and longest time between updates of the filter [s]; default 0.01,
                 10
    windows      along each motion, 1 … 256; default 64
    gyro_bias, accel_bias  1 sigma to which the filter knows the biases [rad/s], [m/s^2]; default:
                 the Allan deviation of the model at 100 s
    bias_time    the bias that the filter knows is a mean over this time [s]; default 1
    learned      the bias that the filter knows is the mean of all slow errors of the readings
    correlation_time  the filter's biases are Gauss-Markov processes of this time [s]; default:
                 random walks
    compensated  known values of the model are taken out of the readings
    assume_class typical values for terms that are not stated: 'own', or 'strategic', 'navigation',
                 'tactical', 'AHRS', 'control'
    per_axis     numbers of each axis, not of each triad
    only, without  use only these terms of the model, or all but these
    latitude, height  of motions that state no place [rad], [m]; default 45 deg, 0
    runs         also simulate so many runs, 3 or more, and compare their NEES
    seed         of the runs and of random vibration
    threads      0: one per processor; the results do not depend on it
    progress     called with (stage, unit, done, total); a false value but None ends the work

    Raises imukit.Error: a model without gyros or accelerometers, a motion that is too short, errors
    without noise. Source: include/imukit/tune_model.h, filter_tuning.h; the fields of the result:
    docs/json.md.

    >>> import imukit, warnings
    >>> warnings.simplefilter("ignore", imukit.DataWarning)
    >>> walk = "imukit_motion: 1\\nsteps: [hold 1 s, rotate z 90 deg at 90 deg/s, hold 1 s]"
    >>> tuned = imukit.tune("ADIS16488", walk, windows=4, to_time=0.1)
    >>> sheet, safe = tuned.answer("data_sheet"), tuned.answer("safe")
    >>> safe.gyro_white[0] >= sheet.gyro_white[0], max(safe.largest) < 1.06
    (True, True)
    """
    settings = {"rate": rate, "from": from_time, "to": to_time, "windows": windows,
                "gyro_bias": gyro_bias, "accel_bias": accel_bias, "bias_time": bias_time,
                "learned": learned, "correlation_time": correlation_time,
                "compensated": compensated, "per_axis": per_axis, "runs": runs, "seed": seed}
    several = motions if isinstance(motions, (list, tuple)) else (motions,)
    result = TuneResult(*_core.tune(
        (named_model(model),), terms(only, without, assume_class),
        tuple(as_motion(motion, latitude, height, seed) for motion in several), settings, threads,
        progress))
    tell(result)
    return result
