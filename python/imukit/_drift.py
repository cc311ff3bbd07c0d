# SPDX-License-Identifier: Apache-2.0
"""Growth of the errors of models."""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Sequence
from typing import Any

from . import _arrays, _core
from ._motion import Motion
from ._results import Finding, Result, tell
from ._scenes import (ModelLike, Numbers, as_motion, named_model, named_models, terms, texts,
                      vector)
from ._units import si

_FIGURES = 10
_STATES = ("position_north", "position_east", "position_down", "velocity_north", "velocity_east",
           "velocity_down", "attitude_north", "attitude_east", "attitude_down", "nees")


@dataclasses.dataclass(frozen=True, slots=True)
class DriftGrowth(_arrays.Vectors):
    """Figures of the error of a model, or of one of its terms, against time: vectors of equal
    length. Radii and root mean squares, means included."""

    model: str
    """name of the model"""
    compensated: bool
    """known values of the model are taken out"""
    source: str
    """'': all; 'believed': what the filter of an aided navigator computes for itself; else the
    term, such as 'gyro.bias.repeatability'"""
    time: _arrays.Array
    """from the start of navigation [s]"""
    cep: _arrays.Array
    """radius of the circle that holds half of the horizontal errors [m]"""
    r95: _arrays.Array
    """radius of the circle that holds 95 % of them [m]"""
    drms: _arrays.Array
    """horizontal [m]"""
    north: _arrays.Array
    """[m]"""
    east: _arrays.Array
    """[m]"""
    height: _arrays.Array
    """[m]"""
    velocity: _arrays.Array
    """horizontal [m/s]"""
    climb: _arrays.Array
    """vertical [m/s]"""
    tilt: _arrays.Array
    """about the horizontal axes together [rad]"""
    heading: _arrays.Array
    """[rad]"""


@dataclasses.dataclass(frozen=True, slots=True)
class DriftMoments(_arrays.Vectors):
    """Mean and covariance of the nine errors against time: position [m], velocity [m/s] and
    attitude [rad], each north, east, down."""

    time: _arrays.Array
    """[s]"""
    mean: _arrays.Array
    """matrix, a row for each time"""
    covariance: _arrays.Array
    """a matrix of 9 by 9 for each time, about the mean"""


@dataclasses.dataclass(frozen=True, slots=True)
class DriftShare:
    """What one term has of the error at the time of the budget."""

    source: str
    """'gyro.bias.repeatability'"""
    text: str
    """'gyro bias repeatability'"""
    share: float
    """of the variance of the figure, 0 … 1"""
    cep: float
    """of this term alone [m]"""
    mean_north: float
    """by which it shifts every run [m]"""
    mean_east: float
    """[m]"""


@dataclasses.dataclass(frozen=True, slots=True)
class DriftRuns(_arrays.Vectors):
    """Errors of the runs, estimate minus truth, at the times of the table: matrices with a row for
    each run and a column for each time. NaN after a run has left the Earth's surroundings."""

    time: _arrays.Array
    """[s]"""
    position_north: _arrays.Array
    """[m]"""
    position_east: _arrays.Array
    """[m]"""
    position_down: _arrays.Array
    """[m]"""
    velocity_north: _arrays.Array
    """[m/s]"""
    velocity_east: _arrays.Array
    """[m/s]"""
    velocity_down: _arrays.Array
    """[m/s]"""
    attitude_north: _arrays.Array
    """in the sense of attitude_errors [rad]"""
    attitude_east: _arrays.Array
    """[rad]"""
    attitude_down: _arrays.Array
    """[rad]"""
    nees: _arrays.Array | None
    """errors squared, normalised by the covariance of the filter; None without aids"""


class DriftResult(Result):
    """Growth of the errors of models. See drift().

    result.models has what the command prints as JSON: the table, the budget and what is missing of
    each model; result.monte_carlo the statistics of runs; result.want the answer to a requirement.
    """

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 arrays: tuple[Any, ...]) -> None:
        super().__init__(core, findings)
        self._times, self._moments, self._rows, self._errors = arrays

    @property
    def times(self) -> _arrays.Array:
        """Times of growth() and moments() [s]: those of the table, and those of curves between."""
        return _arrays.of_bytes(self._times)

    @property
    def verdict(self) -> tuple[Finding, ...]:
        """Reasons not to trust the figures: terms that are not stated or left out, errors beyond
        the linear range, runs that differ."""
        return tuple(f for f in self.findings if f.level == "warning")

    def growth(self, model: str | None = None, source: str = "",
               compensated: bool | None = None) -> DriftGrowth:
        """The error against time, of all terms or of one source. Each argument may be left out if
        there is only one; with and without known values, those without are given. Raises KeyError.
        """
        found = self._find(self._moments, model, compensated, lambda row: bool(row[2] == source))
        figures = _core.drift_figures(found[3])
        columns = (_arrays.of_bytes(figures, _FIGURES, k) for k in range(_FIGURES))
        return DriftGrowth(found[0], bool(found[1]), found[2], self.times, *columns)

    def sources(self, model: str | None = None, compensated: bool | None = None) -> tuple[str, ...]:
        """Names of the terms that growth() takes."""
        first = self._find(self._moments, model, compensated)
        return tuple(row[2] for row in self._moments
                     if row[:2] == first[:2] and row[2] not in ("", "believed"))

    def moments(self, model: str | None = None, source: str = "",
                compensated: bool | None = None) -> DriftMoments:
        """Mean and covariance against time, of all terms or of one source. Raises KeyError."""
        found = self._find(self._moments, model, compensated, lambda row: bool(row[2] == source))
        return DriftMoments(self.times, _arrays.of_matrix(found[3], 90, range(9), (9,)),
                            _arrays.of_matrix(found[3], 90, range(9, 90), (9, 9)))

    def budget(self, model: str | None = None,
               compensated: bool | None = None) -> tuple[DriftShare, ...]:
        """The terms at the time of the budget, the largest first. Raises KeyError."""
        cases = [(case["model"], case["compensated"], case["budget"])
                 for case in self._data["result"]["models"]]
        return tuple(DriftShare(term["source"], term["text"], term["share"],
                                term["figures"]["cep"]["value"], term["mean_north"]["value"],
                                term["mean_east"]["value"])
                     for term in self._find(cases, model, compensated)[2])

    @property
    def runs(self) -> DriftRuns | None:
        """The runs of a Monte Carlo; None without."""
        if not self._errors:
            return None
        rows = len(self._rows) // 8
        states = 10 if "aids" in self._data["inputs"] else 9
        count = len(self._errors) // (8 * rows * states)
        shape = [_arrays.of_matrix(self._errors, rows * states,
                                   range(k, rows * states, states), (rows,), count)
                 for k in range(states)]
        return DriftRuns(_arrays.of_bytes(self._rows), *shape,
                         *([None] if states == 9 else []))

    def _find(self, rows: Any, model: str | None, compensated: bool | None,
              fits: Callable[[Any], bool] = lambda row: True) -> Any:
        found = [row for row in rows if model in (None, row[0])
                 and compensated in (None, bool(row[1])) and fits(row)]
        if not found or len({row[0] for row in found}) > 1:
            known = ", ".join(dict.fromkeys(row[0] for row in self._moments))
            what = "more than one fits" if found else "none fits"
            raise KeyError(f"{what}; models: {known}; sources() lists the terms")
        return found[-1]


def drift(models: ModelLike | Sequence[ModelLike], motion: Any = None, *,
          rate: float | str = 100.0, duration: float | str | None = None,
          times: str | float | Sequence[float | str] | None = None,
          latitude: float | str | None = None, height: float | str | None = None,
          roll: float | str | None = None, pitch: float | str | None = None,
          yaw: float | str | None = None, aligned: str = "given",
          align_time: float | str | None = None, initial_attitude: Numbers = 0.0,
          initial_velocity: Numbers = 0.0, initial_position: Numbers = 0.0,
          vertical: str = "slaved", attitude_errors: str = "local",
          gravity_deflection: float | str = 0.0, gravity_distance: float | str | None = None,
          only: str | Sequence[str] | None = None, without: str | Sequence[str] | None = None,
          compensated: bool = False, assume_class: str | None = None,
          aids: str | Sequence[str] | None = None,
          outage: str | float | Sequence[float | str] | None = None,
          filter_model: ModelLike | None = None, want: str | None = None, gains: str = "held",
          runs: int = 0, seed: int = 1, threads: int = 0,
          progress: Callable[[str, str, int, int], object] | None = None) -> DriftResult:
    """How large the error of a navigator becomes, which terms cause it, and how small they must be.

    models       a Model, the name of a file or of a device; or up to 8 of them, to compare
    motion       a Motion, name of a motion file, or text of a script; without, the unit is at rest
    rate         sampling rate [Hz]
    duration     length of the navigation [s]; default: 24 h, that of the motion, or want's time
    times        times of the table instead [s]: numbers, or "1min, 10min, 1h"
    latitude     geodetic [rad]; default 45 deg, or what the motion states
    height       above the ellipsoid [m]; default 0
    roll, pitch, yaw  attitude of a unit at rest [rad]; default level, to the north
    aligned      'given': the attitude at the start is true but for initial_attitude; 'self': the
                 unit finds it at rest
    align_time   length of the alignment of aligned='self' [s]; default 300
    initial_attitude, initial_velocity, initial_position  1 sigma at the start [rad, m/s, m]: one
                 number, or north, east, down; a text such as "0.01 0.01 0.1 deg"
    vertical     'slaved': height follows the truth, as with a barometer; 'free'
    attitude_errors  'local': of what is displayed; 'earth': against Earth-fixed axes
    gravity_deflection  1 sigma of gravity beside normal gravity, north and east each [m/s^2]
    gravity_distance  its correlation distance [m]; default 20 km
    only, without  use only these terms of the models, or all but these: names, such as
                 "gyro.bias, angle_random_walk"
    compensated  show also the figures with known values of the models taken out
    assume_class typical values for terms that are not stated: 'own', or 'strategic', 'navigation',
                 'tactical', 'AHRS', 'control'
    aids         of the navigator: texts such as "gnss position 1 m, velocity 0.05 m/s at 1 Hz until
                 600 s"; also height, heading, odometer, zero velocity
    outage       times after the end of the aids to show [s]; default 10, 60, 300
    filter_model what the filter with aids is made for; default: the model itself
    want         the inverse question: "CEP 1 nmi @ 1h"; also R95, DRMS, height, velocity, tilt,
                 heading; with aids "CEP 5 m after 60 s". One model
    gains        of want, with aids: 'held', or 'retuned' for the improved terms
    runs         also simulate and navigate so many runs of the last model, without linearising
    seed         of the runs
    threads      0: one per processor; the results do not depend on it
    progress     called with (stage, unit, done, total); a false value but None ends the work

    Raises imukit.Error: a model that is not whole, times beyond the motion, a text that cannot be
    read; ValueError: arguments that exclude each other. Source: include/imukit/drift_models.h,
    drift.h, aid_text.h; the fields of the result: docs/json.md.

    >>> import imukit, math, warnings
    >>> warnings.simplefilter("ignore", imukit.DataWarning)
    >>> bias = imukit.Model({"accel": {"bias": {"repeatability": "1 mg"}}}, name="bias")
    >>> growth = imukit.drift(bias, times="1 min").growth()
    >>> round(float(growth.north[-1]) / (0.5 * 9.80665e-3 * 60**2), 2)  # a t^2/2
    1.0
    >>> imukit.drift("tactical", duration="10min").budget()[0].text
    'accelerometer bias repeatability'
    """
    if isinstance(motion, Motion) and motion.kind == "rest":
        rest = motion._rest
        if not latitude is height is roll is pitch is yaw is None or not rest["earth"]:
            raise ValueError("a Motion at rest states place and attitude, on the Earth")
        latitude, height, roll = rest["latitude"], rest["height"], rest["roll"]
        pitch, yaw = rest["pitch"], rest["yaw"]
        motion = None
    pairs = named_models(models)
    several = texts("aids", aids)
    _check(motion, len(pairs), several, roll=roll, pitch=pitch, yaw=yaw, aligned=aligned,
           align_time=align_time, initial_attitude=initial_attitude, want=want, gains=gains,
           filter_model=filter_model, outage=outage, gravity_deflection=gravity_deflection,
           gravity_distance=gravity_distance, runs=runs)
    name, core = (None, None) if filter_model is None else named_model(filter_model)
    settings = {"rate": rate, "duration": duration, "latitude": latitude, "height": height,
                "roll": roll, "pitch": pitch, "yaw": yaw, "aligned": aligned,
                "align_time": align_time, "vertical": vertical, "attitude_errors": attitude_errors,
                "gravity_deflection": gravity_deflection, "gravity_distance": gravity_distance,
                "compensated": compensated, "gains": gains, "runs": runs, "seed": seed,
                "want": want, "filter_name": name}
    initial = (*vector("initial_position", initial_position, "m", one=True),
               *vector("initial_velocity", initial_velocity, "m/s", one=True),
               *vector("initial_attitude", initial_attitude, "rad", one=True))
    moved = None if motion is None else as_motion(motion, latitude, height, seed)
    result = DriftResult(*_core.drift(
        pairs, terms(only, without, assume_class), settings, initial, _times("times", times),
        _times("outage", outage), moved, core, several, threads, progress))
    tell(result)
    return result


def _times(argument: str, given: Any) -> list[list[float]] | None:
    if given is None:
        return None
    if isinstance(given, str):
        given = given.split(",")
    elif isinstance(given, (int, float)):
        given = [given]
    return [[si(argument, time, "s") for time in given]]


def _check(motion: Any, models: int, aids: tuple[str, ...], **o: Any) -> None:
    wrong = (
        (motion is not None and not o["roll"] is o["pitch"] is o["yaw"] is None,
         "roll, pitch and yaw are for a unit at rest; the attitude is in the motion"),
        (o["aligned"] == "self" and o["initial_attitude"] != 0.0,
         "initial_attitude is for a given attitude, and aligned='self' finds it: leave one out"),
        (o["aligned"] != "self" and o["align_time"] is not None,
         "align_time is for aligned='self'"),
        (o["gravity_distance"] is not None and o["gravity_deflection"] == 0.0,
         "gravity_distance is for gravity_deflection"),
        (o["outage"] is not None and not aids, "outage is for a navigator with aids"),
        (o["filter_model"] is not None and not aids, "filter_model is for a navigator with aids"),
        (o["gains"] == "retuned" and not (aids and o["want"]), "gains is for want with aids"),
        (o["want"] is not None and models > 1, "want takes one model at a time"),
        (o["runs"] and models > 1, "runs takes one model at a time"))
    for is_wrong, message in wrong:
        if is_wrong:
            raise ValueError(message)
