# SPDX-License-Identifier: Apache-2.0
"""Instruments from first principles: gyros and accelerometers from the physics of their parts.

One class for each kind of instrument: RingLaser, FibreOptic, TunedGyro, MemsAccelerometer … (see
instruments()). Their names, parameters, units, ranges and help are those of the library. An
instrument is a design: parameters that can be set, quantities that follow from them, runs, views of
what happens inside, and its error model by closed forms and by experiments.

>>> import imukit
>>> laser = imukit.physics.RingLaser(wavelength="633 nm", dither={"frequency": "500 Hz"})
>>> laser["cavity.wavelength"], laser.dither.frequency
(6.33e-07, 500.0)
>>> run = laser.run("2 s", rate="10 deg/s")
>>> run.log.rows, round(float(run.log["gyro_x"][-1]), 3)
(200, 0.175)
"""
from __future__ import annotations

import dataclasses
import math
import os
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from . import _arrays, _core
from ._log import Log, made_log
from ._model import Model
from ._results import Result, tell
from ._units import si

Vector = float | str | Sequence[float | str]
"""A number or text along x, "1 2 3 deg/s" along the axes of the case, or a sequence of three."""
_Progress = Callable[[str, str, int, int], object] | None


@dataclasses.dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a design."""

    path: str
    """its place in the design file: 'dither.frequency'"""
    kind: str
    """'number', 'count', 'choice' or 'switch'"""
    unit: str
    """unit in which it is written; '1' for pure numbers"""
    si_unit: str
    """unit of its values"""
    minimum: str | None
    """lowest valid value, with its unit"""
    maximum: str | None
    """highest valid value"""
    open: bool
    """the minimum itself is not valid"""
    choices: str | None
    """the words of a choice: 'open|closed'"""
    help: str
    default: str
    """with its unit"""


@dataclasses.dataclass(frozen=True, slots=True)
class Signal:
    """An output of an instrument, or an internal signal."""

    name: str
    si_unit: str
    """unit of its values"""
    unit: str
    """unit in which it is shown"""
    help: str


@dataclasses.dataclass(frozen=True, slots=True)
class About:
    """A kind of instrument."""

    name: str
    """in design files: 'ring_laser'"""
    title: str
    technology: str
    """in the table of grades: 'RLG'"""
    source: str
    """where the figures of the default design are from"""
    sensor: str
    """'gyro' or 'accel'"""
    parameters: tuple[Parameter, ...]
    outputs: tuple[Signal, ...]
    """the first is the measured input"""
    signals: tuple[Signal, ...]
    """inside"""
    views: tuple[tuple[str, str], ...]
    """title and caption of each"""


@dataclasses.dataclass(frozen=True, slots=True)
class Derived:
    """A quantity that follows from the parts of a design by an equation."""

    name: str
    symbol: str
    value: float
    """SI; NaN where the design has none"""
    unit: str
    """SI unit"""
    equation: str
    source: str
    absent: str | None
    """why the design has none"""
    shown_unit: str
    """unit in which it is shown"""


@dataclasses.dataclass(frozen=True, slots=True)
class View:
    """A view of what happens inside: signals against time, or against each other."""

    title: str
    caption: str
    x_label: str
    """with its unit"""
    y_label: str
    x: _arrays.Array
    """in the unit of the label"""
    curves: Mapping[str, _arrays.Array]
    """by the names of the signals, in the unit of the label"""


class PhysicsResult(Result):
    """A design with what follows from it."""


class Run(PhysicsResult):
    """A run of an instrument. Every function of imukit takes it where it takes data."""

    log: Log
    """readings, row by row; each is the mean over the sample that ends at its time"""
    signals: Log | None
    """internal signals; None: not wanted"""

    def _imukit_columns(self) -> tuple[list[str], list[Any]]:
        return self.log._imukit_columns()


class Views(PhysicsResult):
    """Views of an instrument, drawn in figure()."""

    views: tuple[View, ...]


class Sweep(PhysicsResult):
    """The error model by closed forms beside the one that experiments found."""

    model: Model
    """as measured"""


class Instrument:
    """A design of an instrument from first principles: the base of all kinds.

    source      path of a design file; mapping of parameters; another instrument; None: the default
    name        of the design, and of its error model
    parameters  values by their place in the file: wavelength="633 nm" where one parameter has this
                last word, dither={"frequency": 400} for a group. Numbers are SI

    design["dither.frequency"], design.dither.frequency and, where only one parameter ends so,
    design.wavelength are a parameter in SI units, which may be set: a number in SI units or a text
    with its unit. What the library refuses leaves the design as it was.

    Raises imukit.Error: a value out of its range, a design that is not possible; KeyError: no such
    parameter. Source: include/imukit/instrument.h, design_file.h, physics_log.h, laboratory.h.

    >>> import imukit
    >>> laser = imukit.physics.RingLaser(name="mine")
    >>> laser["lock_in.rate"] = "100 deg/h"
    >>> laser.dither.rate = 0
    >>> run = laser.run("1 s", rate="90 deg/h", noise=False)  # below the rate of lock-in
    >>> abs(float(run.log["gyro_x"][-1])) < 1e-12
    True
    """

    about: ClassVar[About]
    """what the library says of this kind"""

    __slots__ = ("_core", "_source")
    _core: Any
    _source: str

    def __init__(self,
                 source: str | os.PathLike[str] | Mapping[str, Any] | Instrument | None = None, /, *,
                 name: str | None = None, **parameters: Any) -> None:
        if type(self) is Instrument:
            raise TypeError("a kind is wanted, such as RingLaser; Instrument.load() reads a file")
        kind = self.about.name
        if isinstance(source, Instrument):
            self._take(_core.parse_design(source.yaml(), kind), kind)
        elif source is None or isinstance(source, Mapping):
            self._take(_core.parse_design(f"imukit: 1\ninstrument: {kind}\n", kind), kind)
            parameters = {**(source or {}), **parameters}
        else:
            self._take(_core.open_design(source), os.fspath(source))
            found = self._core.about()[0]
            if found != kind:
                raise ValueError(f"{os.fspath(source)} is of a {found}, not of a {kind}")
        if name is not None:
            self._core.rename(name, self._core.about()[2])
        self.update(parameters)

    def _take(self, core: Any, source: str) -> None:
        object.__setattr__(self, "_core", core)
        object.__setattr__(self, "_source", source)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Instrument:
        """The instrument of a design file, of its kind; or the default design of a name."""
        core = _core.open_design(path)
        made = _made(core.about()[0])
        made._take(core, os.fspath(path))
        return made

    @staticmethod
    def parse(text: str) -> Instrument:
        """The instrument of a text, YAML or JSON."""
        core = _core.parse_design(text, None)
        made = _made(core.about()[0])
        made._take(core, core.about()[0])
        return made

    def copy(self) -> Instrument:
        """Another instrument of the same design."""
        return Instrument.parse(self.yaml())

    def yaml(self) -> str:
        """The text of its design file: every parameter with its unit and help."""
        return self._core.yaml()  # type: ignore[no-any-return]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the design file, complete or not at all."""
        self._core.save(path)

    @property
    def name(self) -> str:
        """Name of the design; '' without."""
        return self._core.about()[1]  # type: ignore[no-any-return]

    # ---- parameters ----

    def __getitem__(self, path: str) -> Any:
        found = self._resolve(path)
        return Group(self, found) if found not in self._paths() else self._core.get(found)

    def __setitem__(self, path: str, value: Any) -> None:
        self.update({path: value})

    def update(self, values: Mapping[str, Any]) -> None:
        """Set several parameters at once, such as those that need each other: all, or, if the
        library refuses one, none.

        >>> import imukit
        >>> laser = imukit.physics.RingLaser()
        >>> laser.update({"cavity.shape": "square", "readout": {"range": "400 deg/s"}})
        >>> laser.cavity.shape, round(laser["readout.range"], 3)
        ('square', 6.981)
        """
        self._core.assign(dict(self._leaves("", values)))

    def _leaves(self, above: str, values: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
        for key, value in values.items():
            path = self._resolve(f"{above}.{key}" if above else key)
            if path in self._paths():
                yield path, value
            elif isinstance(value, Mapping):
                yield from self._leaves(path, value)
            else:
                raise TypeError(f"{path} is a group: expected a dictionary of its parameters")

    @classmethod
    def _paths(cls) -> tuple[str, ...]:
        return tuple(p.path for p in cls.about.parameters)

    def _resolve(self, key: str) -> str:
        """The path of a parameter or group: of the whole path, or of its last word."""
        paths = self._paths()
        if key in paths or any(p.startswith(f"{key}.") for p in paths):
            return key
        fit = [p for p in paths if p.rpartition(".")[2] == key]
        if len(fit) == 1:
            return fit[0]
        raise KeyError(f"{key!r} may be {' or '.join(fit)}" if fit else
                       f"the {self.about.title} has no {key!r}; there are: {', '.join(paths)}")

    @classmethod
    def parameter(cls, path: str) -> Parameter:
        """Unit, range and help of a parameter. Raises KeyError.

        >>> import imukit
        >>> imukit.physics.RingLaser.parameter("cavity.wavelength").unit
        'nm'
        """
        for found in cls.about.parameters:
            if found.path == path:
                return found
        raise KeyError(f"the {cls.about.title} has no {path!r}")

    def to_dict(self) -> dict[str, Any]:
        """All parameters in SI units, by their paths."""
        return {path: self._core.get(path) for path in self._paths()}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __setattr__(self, name: str, value: Any) -> None:
        try:
            self[name] = value
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *{path.partition(".")[0] for path in self._paths()}]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Instrument):
            return NotImplemented
        return self.yaml() == other.yaml()

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return Instrument.parse, (self.yaml(),)

    # ---- what follows from it ----

    def derived(self) -> dict[str, Derived]:
        """What a designer computes first, by its name.

        >>> import imukit, math
        >>> laser = imukit.physics.RingLaser()
        >>> scale = laser.derived()["scale factor, beat frequency per rate"]  # 4 A/(lambda P)
        >>> area = laser.cavity.perimeter ** 2 / (12 * math.sqrt(3))
        >>> round(scale.value * laser.wavelength * laser.cavity.perimeter / area, 9), scale.unit
        (4.0, '1/rad')
        """
        return {row[0]: Derived(*row) for row in self._core.derived()}

    def describe(self) -> PhysicsResult:
        """The design and what follows from it, as `imukit physics` prints them."""
        return PhysicsResult(*_core.show_design(self._core, self._source))

    def reduce(self, *, single_axis: bool = False) -> Model:
        """The error model by closed forms.

        single_axis  of one instrument along x, not of three

        >>> import imukit
        >>> model = imukit.physics.RingLaser().reduce()
        >>> len(model["gyro.noise.angle_random_walk"]), model["gyro.noise.angle_random_walk"][0] > 0
        (3, True)
        """
        made = Model.__new__(Model)
        made._take(_core.reduce_design(self._core, single_axis))
        return made

    def run(self, duration: float | str, *, rate: Vector = 0.0, acceleration: Vector = 0.0,
            sine: float | str | None = None, temperature: float | str = 293.15,
            temperature_rate: float | str = 0.0, output_rate: float | str = 100.0,
            level: str = "full", step: float | str | None = None, noise: bool = True, seed: int = 1,
            run: int = 0, signals: bool = False, signal_rate: float | str | None = None,
            progress: _Progress = None) -> Run:
        """Run the instrument.

        duration          [s], or a text such as "10 s"
        rate              angular rate along x [rad/s], up to 1e6; or three numbers (Vector)
        acceleration      specific force along x [m/s^2], up to 1e6; or three numbers
        sine              frequency of a sine [Hz], of which rate or acceleration is the amplitude
        temperature       at the start [K], up to 1e4, or a text such as "20 degC"
        temperature_rate  its change [K/s]
        output_rate       samples per second [Hz]
        level             'full': the dynamics of all parts; 'slow': without the fast part
        step              longest internal step [s]; None: what the accuracy needs
        noise             False: nothing random
        seed, run         the same seed makes the same numbers; another run is another draw of the
                          same instrument
        signals           also take the internal signals
        signal_rate       rows of signals per second [Hz]; None: output_rate
        progress          called with (stage, unit, done, total); a false value but None ends the work

        Raises imukit.Error: an input out of range, a run with too many internal steps;
        MemoryError: more samples than the memory holds.

        >>> import imukit
        >>> run = imukit.physics.PendulousServo().run(1, acceleration="1 g", noise=False)
        >>> round(float(run.log["accel_x"][-1]), 1)
        9.8
        """
        if sine is not None and rate == 0 and acceleration == 0:
            raise ValueError("sine: a rate or an acceleration is its amplitude, and there is none")
        inner_rate = output_rate if signal_rate is None else signal_rate
        rows = _rows(duration, output_rate, len(self.about.outputs) + 2)
        inner = _rows(duration, inner_rate, len(self.about.signals) + 1)
        outputs = [_arrays.empty(rows) for _ in range(len(self.about.outputs) + 2)]
        inside = [_arrays.empty(inner) for _ in range(len(self.about.signals) + 1)]
        settings = {"duration": duration, "output_rate": output_rate, "level": level, "step": step,
                    "noise": noise, "seed": seed, "sine": sine, "temperature": temperature,
                    "temperature_rate": temperature_rate, "signal_rate": signal_rate}
        wanted = (signals or signal_rate is not None) and len(self.about.signals) > 0
        found, columns, names = _core.run_design(self._core, settings, rate, acceleration,
                                                 _number(run), self._source, outputs,
                                                 inside if wanted else None, progress)
        made = Run(*found)
        every = si("output_rate", output_rate, "Hz")
        made.log = made_log(self._source, columns, outputs[:len(columns)], 1 / every, rows)
        made.signals = None
        if wanted:
            every = si("signal_rate", inner_rate, "Hz")
            made.signals = made_log(f"signals of {self._source}", names, inside, 1 / every, inner)
        tell(made)
        return made

    def views(self, view: str | int | None = None, *, duration: float | str | None = None,
              output_rate: float | str | None = None, rate: Vector | None = None,
              acceleration: Vector | None = None, sine: float | str | None = None,
              temperature: float | str = 293.15, level: str = "full", noise: bool = True,
              seed: int = 1, run: int = 0) -> Views:
        """Views of what happens inside, as a figure and as numbers.

        view          number, from 1, or the beginning of a title (about.views); None: all that show
                      something
        duration      length [s], and
        output_rate   points per second [Hz]; None: as each view states
        rate, acceleration, sine, temperature, level, noise, seed, run  as in run(); without rate
                      and acceleration each view has an input that suits it

        >>> import imukit
        >>> views = imukit.physics.RingLaser().views(1)
        >>> len(views.views), views.figure()[:4], list(views.views[0].curves)[0]
        (1, '<svg', 'beat_frequency')
        """
        settings = {"view_duration": duration, "view_rate": output_rate, "level": level,
                    "noise": noise, "seed": seed, "sine": sine, "temperature": temperature,
                    "view_input": rate is not None or acceleration is not None}
        found, views = _core.view_design(self._core, settings, 0.0 if rate is None else rate,
                                         0.0 if acceleration is None else acceleration,
                                         _number(run), self._source,
                                         None if view is None else str(view))
        made = Views(*found)
        made.views = tuple(_view(*each) for each in views)
        return made

    def sweep(self, *, duration: float | str | None = None, temperature: float | str = 293.15,
              output_rate: float | str = 100.0, level: str | None = None,
              step: float | str | None = None, seed: int = 1, run: int = 0,
              single_axis: bool = False, threads: int = 0, progress: _Progress = None) -> Sweep:
        """Find the error model by the experiments of a laboratory, and compare it with the closed
        forms. Takes some seconds.

        duration     simulated time that one experiment may take [s]; None: as it is chosen
        temperature  where the error model does not depend on it [K]
        output_rate  readings per second [Hz]
        level        'full' or 'slow'; None: what takes long is at the slow level
        step, seed, run  as in run()
        single_axis  make a model of one instrument along x, not of three
        threads      0: one per processor; the result does not depend on it
        progress     called with (stage, unit, done, total); a false value but None ends the work
        """
        settings = {"duration": duration, "temperature": temperature, "output_rate": output_rate,
                    "level": level, "quick": level is None, "step": step, "seed": seed}
        found, model = _core.sweep_design(self._core, settings, self._source, _number(run),
                                          single_axis, threads, progress)
        made = Sweep(*found)
        made.model = Model.__new__(Model)
        made.model._take(model)
        tell(made)
        return made

    def __repr__(self) -> str:
        return repr(self.describe())

    def _repr_html_(self) -> str:
        return self.describe()._repr_html_()


class Group:
    """A group of parameters: design.dither."""

    __slots__ = ("_design", "_path")

    def __init__(self, design: Instrument, path: str) -> None:
        object.__setattr__(self, "_design", design)
        object.__setattr__(self, "_path", path)

    def _at(self, key: str) -> str:
        path = f"{self._path}.{key}"
        if path not in self:
            raise KeyError(f"{self._path} has no {key!r}; there are: {', '.join(self)}")
        return path

    def __getitem__(self, key: str) -> Any:
        return self._design[self._at(key)]

    def __setitem__(self, key: str, value: Any) -> None:
        self._design[self._at(key)] = value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __setattr__(self, name: str, value: Any) -> None:
        try:
            self[name] = value
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __contains__(self, path: object) -> bool:
        return path in self._design._paths()

    def __iter__(self) -> Iterator[str]:
        begin = f"{self._path}."
        return (p[len(begin):] for p in self._design._paths() if p.startswith(begin))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return f"{self._path}: {dict((key, self[key]) for key in self)}"


def instruments() -> tuple[type[Instrument], ...]:
    """The classes of all kinds: spinning mass, optical, vibratory, accelerometers.

    Raises nothing. Source: include/imukit/instrument.h.

    >>> import imukit
    >>> [kind.__name__ for kind in imukit.physics.instruments()][5:8]
    ['FibreOptic', 'RingLaser', 'TuningFork']
    >>> imukit.physics.RingLaser.about.title
    'ring laser gyro'
    """
    return tuple(_kinds.values())


def _rows(duration: float | str, rate: float | str, columns: int) -> int:
    """Rows of a run; 1 where the library is to refuse it."""
    every = si("rate", rate, "Hz")
    if not 0 < every < math.inf:
        raise ValueError(f"output_rate, signal_rate: {rate!r}: expected a rate above 0 [Hz]")
    samples = si("duration", duration, "s") * every
    if not 0 < samples < math.inf:
        return 1
    limit = _core.memory_limit() / 2
    if samples * columns * 8 > limit:
        raise MemoryError(f"{samples:g} samples of {columns} columns take {samples * columns * 8:.3g} "
                          f"bytes of {limit:.3g}: lower output_rate, signal_rate or duration")
    return max(math.floor(samples + 0.5), 1)


def _number(run: int) -> int:
    if not 0 <= run < 2 ** 32:
        raise ValueError(f"run={run}: expected 0 to 4294967295")
    return run


def _view(title: str, caption: str, x_label: str, y_label: str, names: list[str],
          data: bytes) -> View:
    numbers = memoryview(data).cast("d")
    points = len(numbers) // (1 + len(names))
    vectors = [_arrays.of_buffer(numbers[k * points:(k + 1) * points])
               for k in range(1 + len(names))]
    return View(title, caption, x_label, y_label, vectors[0], dict(zip(names, vectors[1:])))


def _made(kind: str) -> Instrument:
    return _kinds[kind].__new__(_kinds[kind])


def _range_of(p: Parameter) -> str:
    """ "; above 0 m, up to 10 m" """
    if p.choices:
        return f"; {p.choices.replace('|', ', ')}"
    above = "above" if p.open else "from"
    low = f"; {above} {p.minimum}" if p.minimum else ""
    return low + (f"{'' if low else ';'} up to {p.maximum}" if p.maximum else "")


def _documented(about: About) -> str:
    """The docstring of a class: every parameter with its unit and range, outputs and signals."""
    lines = [f"{about.title[0].upper()}{about.title[1:]}: a design of its parts.", "",
             *textwrap.wrap(f"Default design: {about.source}", 96), "", "Parameters (default):", ""]
    for p in about.parameters:
        unit = f" [{p.unit}]" if p.unit not in ("", "1") else ""
        lines += textwrap.wrap(f"{p.path}{unit}  {p.help}{_range_of(p)} ({p.default})", 96,
                               subsequent_indent="    ")
    for title, signals in (("Outputs", about.outputs), ("Internal signals", about.signals)):
        if signals:
            lines += ["", f"{title}:", ""]
        for s in signals:
            lines += textwrap.wrap(f"{s.name} [{s.unit}]  {s.help}", 96, subsequent_indent="    ")
    if about.views:
        lines += ["", "Views:", "", *(f"{k + 1}  {v[0]}" for k, v in enumerate(about.views))]
    return "\n".join([*lines, "", "See Instrument for what all kinds have."])


def _classes() -> dict[str, type[Instrument]]:
    made = {}
    for kind, title, technology, source, sensor, parameters, *signals, views in _core.instruments():
        outputs, inside = (tuple(Signal(*s) for s in each) for each in signals)
        about = About(kind, title, technology, source, sensor,
                      tuple(Parameter(*p) for p in parameters), outputs, inside, tuple(views))
        name = "".join(word.capitalize() for word in about.name.split("_"))
        made[about.name] = type(name, (Instrument,), {
            "__doc__": _documented(about), "__module__": __name__, "__slots__": (), "about": about})
    return made


_kinds = _classes()
globals().update((kind.__name__, kind) for kind in _kinds.values())

__all__ = ["About", "Derived", "Group", "Instrument", "Parameter", "PhysicsResult", "Run", "Signal",
           "Sweep", "View", "Views", "instruments"]
__all__ += [kind.__name__ for kind in _kinds.values()]


if TYPE_CHECKING:  # the classes that are made, as a stub says
    from ._instrument_types import *
else:
    def __getattr__(name: str) -> Any:
        raise AttributeError(f"imukit.physics has no {name!r}; there are: {', '.join(__all__)}")
