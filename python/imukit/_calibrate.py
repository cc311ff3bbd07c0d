# SPDX-License-Identifier: Apache-2.0
"""Calibration from bench tests."""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from . import _arrays, _core
from ._estimates import plain_value
from ._inputs import Data, is_path, is_several, open_record
from ._model import Model, as_model
from ._motion import Motion
from ._results import LEVELS, Result, tell
from ._scenes import ModelLike, as_motion
from ._units import si


@dataclasses.dataclass(frozen=True, slots=True)
class Parameter:
    """A number of the model that was estimated."""

    name: str
    """its path in the model file: 'accel.bias.fixed.x'"""
    value: float
    """[unit]"""
    sigma: float
    """1 sigma [unit]"""
    lower: float
    """lower end of the 95 % interval [unit]"""
    upper: float
    """upper end of the 95 % interval [unit]"""
    freedom: float
    """degrees of freedom behind the sigma; NaN: not limited"""
    unit: str
    """SI unit"""


@dataclasses.dataclass(frozen=True, slots=True)
class PoseResidual:
    """An observation at rest, or of a constant reference: how well the result explains it."""

    log: str
    """the record"""
    begin: float
    """time from its start [s]"""
    length: float
    """[s]"""
    force: _arrays.Array
    """force along the axes of the body [m/s^2]"""
    accel_residual: _arrays.Array
    """of each accelerometer [m/s^2]"""
    gyro_residual: _arrays.Array
    """of each gyro [rad/s]"""
    distance: float
    """distance from the result, in sigmas"""
    weight: float
    """0: left out, 1: full weight"""


class CalibrateResult(Result):
    """What bench tests say of a unit. See calibrate()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]], model: str, level: int,
                 anyway: bool) -> None:
        super().__init__(core, findings)
        self._model = model
        self._anyway = anyway
        self.level = LEVELS[level]
        """the worst of the verdict: 'good', 'note', 'warning', or 'failure': not usable"""

    @property
    def usable(self) -> bool:
        """The verdict does not say that the result is of no use."""
        return self.level != "failure"

    @property
    def model(self) -> Model | None:
        """The model with the estimated terms; None where the result is not usable, unless
        anyway=True was asked for."""
        return Model.parse(self._model) if self.usable or self._anyway else None

    @property
    def estimates(self) -> dict[str, Parameter]:
        """The parameters by their paths in the model file:
        result.estimates["accel.bias.fixed.x"].sigma."""
        return {p["name"]: Parameter(*(plain_value(p[f.name])
                                       for f in dataclasses.fields(Parameter)))
                for p in self._data["result"]["parameters"] or ()}

    @property
    def correlations(self) -> _arrays.Array:
        """Matrix of the correlations of the parameters, in the order of `estimates`."""
        rows = self._data["result"]["correlation"] or []  # of the lower triangle
        count = len(rows)
        numbers = _arrays.of_numbers(rows[max(i, k)][min(i, k)]
                                     for i in range(count) for k in range(count))
        return _arrays.matrix(numbers, count, count) if count else numbers

    @property
    def residuals(self) -> tuple[PoseResidual, ...]:
        """What is left of each observation."""
        return tuple(
            PoseResidual(pose["log"], plain_value(pose["begin"]), plain_value(pose["length"]),
                         _vector(pose["force"]), _vector(pose["accel_residual"]),
                         _vector(pose["gyro_residual"]), plain_value(pose["distance"]),
                         plain_value(pose["weight"]))
            for pose in self._data["result"]["poses"] or ())


def _vector(numbers: list[float | None] | None) -> _arrays.Array:
    return _arrays.of_numbers(numbers or ())


class CalibrationPlan(Result):
    """The programme of a bench test. See plan_calibration().

    `steps` are its poses and inputs, `wishes` what was wanted and what is expected."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 sigmas: dict[str, float], programme: str | None, met: bool) -> None:
        super().__init__(core, findings)
        self.duration: float = plain_value(self._data["result"]["duration"]["value"])
        """length of all, with ramps of the temperature of 1 K/min [s]"""
        self.sigmas = sigmas
        """1 sigma with which the test will determine each parameter, by its path in the model file,
        in SI units (Model.unit()); NaN: it does not"""
        self.programme = programme
        """the text of a motion file for simulate() and calibrate(), of 'thermal' that of a file of
        temperatures; None: 'centrifuge', whose arm no motion file describes"""
        self.met = met
        """the programme reaches all that is wanted"""


_TERMS = {"nonlinearity": _core.TERM_NONLINEARITY, "cross_products": _core.TERM_CROSS_PRODUCTS,
          "g_sensitivity": _core.TERM_G_SENSITIVITY, "g2_sensitivity": _core.TERM_G2_SENSITIVITY,
          "gyro": _core.TERM_GYRO}

Counts = float | str | Sequence[float | str]
"""One number, one for each axis, or a text with one or all of them."""


def calibrate(data: Data | Sequence[Data], procedure: str | Sequence[str],
              rate: float | str | None = None, *, columns: str | Sequence[str] | None = None,
              model: ModelLike | None = None, into: ModelLike | None = None,
              name: str | None = None, position: str | Sequence[float | str] | None = None,
              gravity: float | str | None = None,
              field: float | str | Sequence[float | str] | None = None,
              dip: float | str | None = None, no_earth: bool = False, frame: str | None = None,
              estimate: str | Sequence[str] | None = None, with_: str | Sequence[str] = (),
              without: str | Sequence[str] = (), accel_sensitivity: Counts | None = None,
              gyro_sensitivity: Counts | None = None, accel_zero: Counts | None = None,
              gyro_zero: Counts | None = None, accel_range: Counts | None = None,
              gyro_range: Counts | None = None, robust: bool = True,
              estimator: str = "maximum-likelihood", pose_means: bool = False,
              section: str | None = None, initial_rest: float | str | None = None,
              window: float | str | None = None, minimum: float | str | None = None,
              trim: float | str | None = None, settle: float | str | None = None,
              placement: float | str | None = None,
              g_sensitivity_sigma: float | str | None = None,
              mounting: float | str | None = None, turn_angle: float | str | None = None,
              motion: Motion | str | os.PathLike[str] | None = None,
              motion_offset: float | str | None = None, table_axis: str | None = None,
              temperature_order: int | None = None,
              reference_temperature: float | str | None = None, poses: bool = False,
              anyway: bool = False,
              progress: Callable[[str, str, int, int], object] | None = None,
              **log: Any) -> CalibrateResult:
    """Bias, scale factor, misalignment and more from bench tests, with their uncertainty.

    data         one record: path of a log, matrix (rows are samples), dictionary, list or table of
                 columns; or a sequence of up to 64 such records, solved together. With the
                 procedure 'repeatability' also models, each the calibration of a power cycle
    procedure    of the test: 'multiposition', 'sixposition', 'ferraris', 'rate-table', 'tumble',
                 'centrifuge', 'spin', 'thermal', 'turns', 'magnetometer' or 'repeatability'
                 (docs/calibrate.md says how to do each); one for all records, or one for each
    rate         sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    columns      names of the columns, with units in brackets ("accel_x [g]"); without, SI
    model        Model, file or name of the catalogue that is known before: sensitivities, and terms
                 that are not estimated
    into         the same, which the result starts from: only the estimated terms are replaced
    name         of the resulting model
    position     of the test, for gravity and the Earth's rotation: latitude [rad], longitude [rad],
                 height [m], or a text such as "48.1 deg, 11.6 deg, 520 m"
    gravity      local gravity [m/s^2], 9.5 … 10.1, if it is known better than from the position
    field        of the Earth at the place, for magnetometers [T]: a number, a number and its 1
                 sigma, or a text such as "48.1 uT"
    dip          of this field below the horizontal [rad]
    no_earth     the references do not contain the Earth's rotation
    frame        'upper-triangular', 'lower-triangular', 'symmetric' or 'reference': what fixes the
                 rotation of the triads; None: chosen by the procedures
    estimate     terms to estimate: "bias,scale_factor,accel.misalignment"; None: those that the
                 procedures determine
    with_, without  terms to estimate in addition, or not to: 'nonlinearity', 'cross_products',
                 'g_sensitivity', 'g2_sensitivity', 'gyro' (multiposition: the gyros' scale factors
                 and misalignments, by the turns; bias and g-sensitivity come from the rests)
    accel_sensitivity, gyro_sensitivity  nominal, for records in counts [count/(m/s^2)],
                 [count/(rad/s)]; one number, or one for each axis
    accel_zero, gyro_zero  counts at zero input
    accel_range, gyro_range  full scale [m/s^2], [rad/s]; readings at it are left out as saturated
    robust       observations that do not fit the others lose their weight
    estimator    'maximum-likelihood', or 'closed-form': the published solution of ferraris
    pose_means   records of multiposition, sixposition and tumble are tables with a row for each
                 pose: its means, and gyro_x_std, accel_x_std … with samples, or accel_x_std_of_mean
    section      column of texts that name the holds, turns or runs
    initial_rest  length of the rest at the beginning [s]; None: the quietest part is used
    window       in which rest is detected [s]; None: chosen from the record
    minimum      shortest rest, step or run [s]; None: 1 s for rests, 0.5 s for steps
    trim         left out at both ends of a step or run [s]; None: 0.2 s
    settle       left out in addition at the beginning [s]; None: 0 s
    placement    1 sigma of the attitude on a face, and of angle and axis of a turn [rad]; None:
                 0.1 deg for sixposition, ferraris and turns
    g_sensitivity_sigma  1 sigma of the gyros' g-sensitivity where it is not determined
                 [rad/s/(m/s^2)]; None: 36 deg/h/g, or what the record shows
    mounting     1 sigma of the unit's attitude on its fixture or table [rad]; None: 0
    turn_angle   ferraris: angle of each turn, with sign; turns: of each turn whose label states
                 none, above 0 [rad]; None: 360 deg
    motion       Motion or motion file that the table ran, or the text of a script: the reference
    motion_offset  time of the record at which it begins [s], or 'auto': find it; None: 0 s
    table_axis   'x', 'y' or 'z': axis about which the table turns the unit, for a column table_rate
    temperature_order  thermal: of the bias polynomial, 1 … 5; None: chosen by cross-validation
    reference_temperature  thermal: at which the polynomials are 0 [K]; None: 25 degC if the sweep
                 contains it
    poses        show every observation with its residuals in the text
    anyway       have a model although the verdict says that it is not usable
    progress     called with (stage, unit, done, total); False ends the work
    log          options for reading a log: see read_log()

    Raises imukit.Error: a record is not of its procedure, terms cannot be determined, settings
    exclude each other. Source: include/imukit/calibrate_log.h; the result: docs/json.md.

    >>> import imukit
    >>> faces = [(9.8, 0, 0), (-9.8, 0, 0), (0, 9.8, 0), (0, -9.8, 0), (0, 0, 9.8), (0, 0, -9.8)]
    >>> table = {f"accel_{a}": [1.01 * f[k] + 0.1 + 1e-6 * (i ** 3 % 31)
    ...                         for i, f in enumerate(faces * 2)] for k, a in enumerate("xyz")}
    >>> result = imukit.calibrate(table, "sixposition", pose_means=True, gravity=9.8)
    >>> found = result.estimates["accel.scale_factor.fixed.x"]
    >>> round(found.value, 4), result.estimates["accel.bias.fixed.z"].unit
    (0.01, 'm/s^2')
    """
    given = dict(locals())
    several = not isinstance(procedure, str) or is_several(data)
    runs = list(data) if several else [data]
    procedures = [procedure] * len(runs) if isinstance(procedure, str) else list(procedure)
    if len(procedures) != len(runs):
        raise ValueError(f"{len(procedures)} procedures for {len(runs)} records")
    repeats = procedures == ["repeatability"] * len(runs)
    if "device" in log:
        log = {**log, "accel_range": accel_range, "gyro_range": gyro_range}
    if pose_means and rate is not None and all(map(_core.procedures.get, procedures)):
        raise ValueError("rate: a table of pose means has no times; leave it out")
    names = tuple(os.fspath(run) if is_path(run) else f"run {k + 1}" for k, run in enumerate(runs))
    if repeats and any(_is_model(run) for run in runs):
        opened = tuple(as_model(run)._core for run in runs)
    else:
        opened = tuple(
            open_record(run, _rate(rate, pose_means, kind), columns, log,
                        f"record {k + 1}" if len(runs) > 1 else "the record")
            for k, (run, kind) in enumerate(zip(runs, procedures)))
    before = None if into is None else as_model(into)
    if name is None and not (before and before.get("name", None)):
        name = os.path.basename(names[0]).partition(".")[0] if is_path(runs[0]) else "record"
    place = _place(position)
    there = None if isinstance(motion, Motion) else place
    moved = None if motion is None else \
        as_motion(motion, there[0] if there else None, there[2] if there else None)
    core, findings, text, level = _core.calibrate(
        opened, names, () if repeats else tuple(procedures), _settings(given, repeats),
        {key: _counts(given[key]) for key in _SHEET}, place, _known(model),
        before._core if before is not None else None, moved, name, poses, progress)
    result = CalibrateResult(core, findings, text, level, anyway)
    tell(result)
    return result


def plan_calibration(model: ModelLike, procedure: str, want: str | None = None, *,
                     rate: float | str | None = None,
                     position: str | Sequence[float | str] | None = None,
                     gravity: float | str | None = None, no_earth: bool = False,
                     frame: str | None = None, with_: str | Sequence[str] = (),
                     without: str | Sequence[str] = (), placement: float | str | None = None,
                     mounting: float | str | None = None, turn_angle: float | str | None = None,
                     temperature_order: int | None = None,
                     soak: float | str | None = None) -> CalibrationPlan:
    """How well a bench test will determine the errors of a unit, and the programme that does it.

    model        Model with the noise of the unit, file or name of the catalogue
    procedure    of the test, as of calibrate(), but for 'magnetometer' and 'repeatability', which
                 need no programme
    want         1 sigma to reach: "accel.scale_factor 50 ppm, gyro.bias 5 deg/h"; None: the
                 shortest programme that determines all parameters. It includes the bias instability
                 and the repeatability of the model, which no test lowers
    rate         sampling rate [Hz]; None: 100 Hz, 'thermal' 10 Hz
    soak         'thermal': time at each temperature before the measurement [s]; None: 600 s
    temperature_order  'thermal': of the bias polynomial, 1 … 5; None: 3

    position, gravity, no_earth, frame, with_, without, placement, mounting and turn_angle are as of
    calibrate().

    Raises imukit.Error: the model states no noise, a wish names no parameter that the procedure
    estimates, the procedure needs no programme. Source: include/imukit/calibration_plan.h.

    >>> import imukit
    >>> plan = imukit.plan_calibration("ADIS16488", "sixposition", "accel.scale_factor 300 ppm")
    >>> plan.met, len(plan.steps), plan.wishes[0].name
    (True, 6, 'accel.scale_factor.fixed.x')
    >>> plan.sigmas["accel.scale_factor.fixed.x"] < 300e-6
    True
    >>> imukit.Motion.parse(plan.programme).kind, plan.duration
    ('script', 36)
    """
    given = {key: value for key, value in locals().items() if key in _SAME}
    repeats = procedure == "repeatability"
    settings = {**given, "with": _bits("with_", with_), "without": _bits("without", without),
                "repeatability": repeats}
    unit = as_model(model)
    label = os.fspath(model) if isinstance(model, (str, os.PathLike)) else \
        unit.get("name", "the model")
    result = CalibrationPlan(*_core.plan_calibration(
        unit._core, label, procedure, settings, _place(position), {"rate": rate, "soak": soak},
        want))
    tell(result)
    return result


_SHEET = ("gyro_sensitivity", "accel_sensitivity", "gyro_zero", "accel_zero", "gyro_range",
          "accel_range")
_SAME = ("gravity", "dip", "no_earth", "frame", "pose_means", "section", "initial_rest", "window",
         "minimum", "trim", "settle", "placement", "g_sensitivity_sigma", "mounting", "turn_angle",
         "table_axis", "temperature_order", "reference_temperature")


def _settings(given: Mapping[str, Any], repeats: bool) -> dict[str, Any]:
    if given["estimator"] not in ("maximum-likelihood", "closed-form"):
        raise ValueError(f"estimator={given['estimator']!r}: expected 'maximum-likelihood' or "
                         "'closed-form'")
    if given["into"] is not None and given["model"] is not None:
        raise ValueError("into and model both name the model to start from")
    if given["motion_offset"] is not None and given["motion"] is None:
        raise ValueError("motion_offset goes with motion")
    estimate = given["estimate"]
    field = given["field"]
    pair = not isinstance(field, str) and isinstance(field, Sequence)
    auto = given["motion_offset"] == "auto"
    if pair and len(field) != 2:
        raise ValueError(f"field={field!r}: expected a number, or a number and its 1 sigma")
    return {**{key: given[key] for key in _SAME}, "repeatability": repeats,
            "closed_form": given["estimator"] == "closed-form",
            "least_squares": not given["robust"],
            "estimate": estimate if isinstance(estimate, (str, type(None))) else ",".join(estimate),
            "with": _bits("with_", given["with_"]), "without": _bits("without", given["without"]),
            "field": field[0] if pair else field, "field_sigma": field[1] if pair else 0.0,
            "find_offset": auto, "motion_offset": None if auto else given["motion_offset"]}


def _bits(argument: str, terms: str | Sequence[str]) -> int:
    bits = 0
    for term in terms.replace(",", " ").split() if isinstance(terms, str) else terms:
        if term not in _TERMS:
            raise ValueError(f"{argument}={term!r}: expected {', '.join(_TERMS)}")
        bits |= _TERMS[term]
    return bits


def _rate(rate: float | str | None, pose_means: bool, procedure: str) -> float | str | None:
    """Tables of means have no times."""
    return 1.0 if pose_means and _core.procedures.get(procedure) else rate


def _counts(given: Any) -> Any:
    return given if given is None or isinstance(given, (str, float, int)) else tuple(given)


def _known(model: ModelLike | None) -> Any:
    return None if model is None else as_model(model)._core


def _place(position: str | Sequence[float | str] | None) -> tuple[float, float, float] | None:
    if position is None:
        return None
    parts: Sequence[float | str] = position
    if isinstance(position, str):
        parts = position.split(",")
    if len(parts) != 3:
        raise ValueError(f"position={position!r}: expected latitude, longitude and height")
    latitude, longitude, height = (
        si("position", part.strip() if isinstance(part, str) else part, unit)
        for part, unit in zip(parts, ("rad", "rad", "m")))
    return latitude, longitude, height


def _is_model(run: Any) -> bool:
    return isinstance(run, Model) or is_path(run) and \
        os.fspath(run).endswith((".yaml", ".yml", ".json"))
