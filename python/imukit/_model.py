# SPDX-License-Identifier: Apache-2.0
"""Models of sensors."""
from __future__ import annotations

import copy
import dataclasses
import json
import os
import re
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from typing import Any

from . import _core
from ._model_paths import (GROUPS, PATHS, TEXTS, TOP, bare, child, encode, insert, leaves, plain,
                           shaped, split)
from ._parameters import ParameterText, findings_of, written
from ._results import Finding

CLASSES = ("strategic", "navigation", "tactical", "AHRS", "control", "own")


class Model(MutableMapping[str, Any]):
    """The errors of a unit of gyros and accelerometers: a model file in memory.

    Model("tactical.yaml") reads a file, Model("ADIS16488") takes an entry of the catalogue (see
    devices()), Model.parse(text) reads a text, Model() is a unit without errors, and
    Model({"gyro": {…}}) takes the tree of a model file. `name` replaces the model's name.

    A model is a dictionary of what its file states, by the dotted paths of docs/model-file.md. Its
    values are numbers in SI units: a float, a tuple with one number per axis, or a tuple of rows.
    Set a number in SI units or a text with its unit, for all axes or for each; a group takes a
    dictionary. What the library refuses leaves the model as it was. Attributes reach the same
    values: model.gyro.noise.angle_random_walk.

    Raises imukit.Error with line and column for a text that is no model, and with the path for a
    value that is refused; KeyError for what the model does not state.

    >>> import imukit
    >>> model = imukit.Model("ADIS16488", name="unit 7")
    >>> model["gyro.noise.angle_random_walk"] = "0.3 deg/sqrt(h)"
    >>> model["gyro.bias.fixed"] = [1e-4, -2e-4, 0.0]
    >>> model["gyro.bias.fixed"], model.unit("gyro.bias.fixed")
    ((0.0001, -0.0002, 0.0), 'rad/s')
    >>> model.gyro.noise.gauss_markov = [{"sigma": "2 deg/h", "correlation_time": 300}]
    >>> model["gyro.noise.gauss_markov[0].correlation_time"]
    (300.0, 300.0, 300.0)
    >>> del model["gyro.noise.gauss_markov"]
    >>> "gyro.noise.gauss_markov" in model
    False
    """

    notes: tuple[Finding, ...]
    """how the numbers of another program's file were read (from_parameters())"""
    _core: Any
    _cached: dict[str, Any] | None

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any] | None = None, *,
                 name: str | None = None) -> None:
        if isinstance(source, Model):
            self._take(_core.parse_model(source.yaml()))
        elif source is None or isinstance(source, Mapping):
            self._take(_core.parse_model('{"imukit": 1, "gyro": {}, "accel": {}}'))
            if source is not None:
                self._assign({"imukit": 1, **encode("", _nested(source))})
        else:
            self._take(_core.open_model(source))
        if name is not None:
            self["name"] = name

    def _take(self, core: Any, notes: tuple[Finding, ...] = ()) -> None:
        object.__setattr__(self, "notes", notes)
        object.__setattr__(self, "_core", core)
        object.__setattr__(self, "_cached", None)

    @classmethod
    def parse(cls, text: str) -> Model:
        """The model of a text, YAML or JSON."""
        made = cls.__new__(cls)
        made._take(_core.parse_model(text))
        return made

    def copy(self) -> Model:
        """Another model that says the same."""
        return Model.parse(self.yaml())

    def yaml(self) -> str:
        """The text of its file: units, order and comments are kept where it was read from one."""
        return self._core.yaml()  # type: ignore[no-any-return]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file, complete or not at all; a name that ends in .json makes it JSON."""
        self._core.save(path)

    def to_dict(self) -> dict[str, Any]:
        """The tree of its file: texts with units, by their keys. Model(tree) makes a model of
        it."""
        return copy.deepcopy(self._tree())

    # ---- its values ----

    def __getitem__(self, path: str) -> Any:
        return self._value(path, 2)

    def __setitem__(self, path: str, value: Any) -> None:
        self.update({path: value})

    def __delitem__(self, path: str) -> None:
        steps = split(path)
        tree = self.to_dict()
        above = [tree]
        for step in steps[:-1]:
            above.append(child(above[-1], step, path))
        child(above[-1], steps[-1], path)
        if isinstance(above[-1], str):  # the only coefficient of a polynomial
            above.pop()
            steps.pop()
        for node, step in zip(reversed(above), reversed(steps)):
            del node[step]
            # A sensor without a key is perfect; a group without one says nothing.
            if node or node is above[0] or node is above[min(1, len(above) - 1)]:
                break
        self._assign(tree)

    def __iter__(self) -> Iterator[str]:
        for key, node in self._tree().items():
            if key != "imukit":
                yield from leaves(key, node)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, path: object) -> bool:
        try:
            self._value(path, 2)  # type: ignore[arg-type]
        except (KeyError, TypeError):
            return False
        return True

    def clear(self) -> None:
        """Refused: a model has at least one sensor."""
        raise TypeError("a model cannot be empty; Model() is one without errors")

    def update(self, values: Any = (), /, **more: Any) -> None:
        """Set several values at once, such as those that need each other: all of them, or, if the
        library refuses one, none."""
        tree = self.to_dict()
        for path, value in {**dict(values), **more}.items():
            insert(tree, split(path), encode(path, value), path)
        self._assign(tree)

    def set(self, path: str, value: Any, sigma: Any = None) -> None:
        """Set a value with its 1 sigma: numbers in SI units, for all axes or for each.

        >>> import imukit
        >>> model = imukit.Model()
        >>> model.set("accel.bias.fixed", [0.01, 0.02, 0.0], sigma=0.001)
        >>> model.sigma("accel.bias.fixed")
        (0.001, 0.001, 0.001)
        """
        tree = self.to_dict()
        insert(tree, split(path), encode(path, value, sigma), path)
        self._assign(tree)

    def sigma(self, path: str) -> Any:
        """1 sigma of a value, in the same shape; 0: not stated. Raises KeyError."""
        return self._value(path, 3)

    def unit(self, path: str) -> str:
        """The SI unit of a path, whether or not the model has a value there; '' for pure numbers
        that have none in the file. Raises KeyError."""
        unit: str | None = _core.path_unit(path.replace("[]", "[0]"))
        if unit is None:
            raise KeyError(f"{path!r} has no numbers")
        return unit

    def text(self, path: str) -> Any:
        """A value as the file has it, with its unit; of a group the tree. Raises KeyError."""
        return copy.deepcopy(self._node(path))

    @staticmethod
    def paths() -> tuple[str, ...]:
        """All paths that a model can have; "[]" stands for the element of a list.

        >>> import imukit
        >>> "gyro.noise.gauss_markov[].sigma" in imukit.Model.paths()
        True
        """
        return (*PATHS, *TEXTS)

    # ---- its terms ----

    def only(self, *terms: str | Sequence[str]) -> Model:
        """A copy with only these terms: keys, groups, or either of one sensor ("gyro.noise"). What
        every sensor has is then stated to be 0.

        >>> import imukit
        >>> model = imukit.Model("tactical").only("gyro.noise")
        >>> model["accel.bias.repeatability"], model["gyro.noise.angle_random_walk"][0] > 0
        ((0.0, 0.0, 0.0), True)
        """
        return self._select(True, terms)

    def without(self, *terms: str | Sequence[str]) -> Model:
        """A copy without these terms."""
        return self._select(False, terms)

    def _select(self, keep: bool, terms: tuple[str | Sequence[str], ...]) -> Model:
        names = [name for term in terms for name in ([term] if isinstance(term, str) else term)]
        made = self.copy()
        made._core.select(keep, tuple(names))
        return made

    def assume_class(self, name: str = "own") -> list[str]:
        """Give what the model does not state the values typical of a class: 'strategic',
        'navigation', 'tactical', 'AHRS', 'control', or 'own' for the class that fits.

        Returns the paths that were given values. Source: include/imukit/model_unstated.h."""
        if name not in CLASSES:
            raise ValueError(f"{name!r}: expected {', '.join(CLASSES)}")
        object.__setattr__(self, "_cached", None)
        return self._core.assume_class(CLASSES.index(name))  # type: ignore[no-any-return]

    # ---- other programs ----

    @classmethod
    def from_parameters(cls, path: str | os.PathLike[str] | None = None, *, text: str | None = None,
                        format: str = "", rate: float | str | None = None,
                        density: str = "as-the-program", sensor: str | None = None,
                        frame_rate: float | str | None = None) -> Model:
        """The model of a file of another program: kalibr, Gazebo, PX4 … (parameter_formats()).

        path        of the file
        text        of it, instead of a path
        format      '': recognised by name and content
        rate        sampling rate [Hz], where the format states noise per sample
        density     meaning of a number per sqrt(Hz) where the format leaves it open:
                    'as-the-program', 'two-sided' or 'one-sided'
        sensor      name of one of several sensors in the file
        frame_rate  LiDAR scans per second [Hz], of the format glim

        How each number was read is in `notes`. Source: include/imukit/parameter_file.h."""
        if (path is None) == (text is None):
            raise TypeError("expected either a path or a text")
        core, notes = _core.read_parameters(path, text, format, {
            "rate": rate, "density": density, "sensor": sensor, "frame_rate": frame_rate})
        made = cls.__new__(cls)
        made._take(core, findings_of(notes, 3))
        return made

    def to(self, format: str, path: str | os.PathLike[str] | None = None, *,
           rate: float | str | None = None, density: str = "as-the-program",
           frame_rate: float | str | None = None, flicker: str = "random-walk",
           tau_from: float | str | None = None, tau_to: float | str | None = None,
           bias_instability_tau: float | str | None = None,
           use_bounds: bool = False) -> ParameterText:
        """The model as a file of another program (parameter_formats()), and its text.

        format      'kalibr', 'gazebo', 'px4', 'filter' …
        path        where to write it; None: it is not written
        rate, density, frame_rate  as in from_parameters()
        flicker     'filter': the process that replaces bias instability: 'random-walk',
                    'gauss-markov', 'two-gauss-markov' or 'left-out'
        tau_from, tau_to  'filter': averaging times between which it has to hold [s]
        bias_instability_tau  a format with a random walk but no bias instability: carry it into the
                    walk, so that its Allan deviation is right at this averaging time [s]
        use_bounds  where the model has no random walk, use the bound in its evidence

        Warns of values that the format cannot hold. Source: include/imukit/parameter_file.h.

        >>> import imukit
        >>> text = imukit.Model("navigation").to("kalibr", rate=200)
        >>> "gyroscope_noise_density" in text, text.notes[0].level in ("note", "warning")
        (True, True)
        """
        return written(self._core, path, format, {
            "rate": rate, "density": density, "frame_rate": frame_rate, "flicker": flicker,
            "tau_from": tau_from, "tau_to": tau_to, "use_bounds": use_bounds,
            "bias_instability_tau": bias_instability_tau})

    # ---- the tree of the file ----

    def _tree(self) -> dict[str, Any]:
        if self._cached is None:
            object.__setattr__(self, "_cached", json.loads(self._core.json()))
        return self._cached  # type: ignore[return-value]

    def _assign(self, tree: dict[str, Any]) -> None:
        self._core.assign(json.dumps(tree, ensure_ascii=False))
        object.__setattr__(self, "_cached", None)

    def _node(self, path: str) -> Any:
        node: Any = self._tree()
        for step in split(path):
            node = child(node, step, path)
        return node

    def _value(self, path: str, part: int) -> Any:
        """Numbers (part 2) or their sigmas (3) of a path; a group, or a text."""
        unit = _core.path_unit(path) if isinstance(path, str) else None
        if unit is None:
            node = self._node(path)
            if part == 3:
                raise KeyError(f"{path!r} has no numbers")
            if isinstance(node, dict) or bare(path) in GROUPS:
                return Group(self, path)
            return plain(node, path == "correlation.values")
        try:
            found = self._core.numbers(path)
        except _core.Error as error:
            raise KeyError(str(error)) from None
        if not any(found[2]):
            self._node(path)  # what is 0 may not be stated
        return shaped(found[0], found[1], found[part])

    def _member(self, path: str) -> Any:
        try:
            return self[path]
        except KeyError as error:
            if bare(path) in GROUPS:
                return Group(self, path)
            raise AttributeError(error.args[0]) from None

    def __getattr__(self, name: str) -> Any:
        if name not in TOP:
            raise AttributeError(f"a model has no {name!r}")
        return self._member(name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in TOP:
            raise AttributeError(f"a model has no {name!r}")
        self[name] = value

    def __delattr__(self, name: str) -> None:
        del self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *TOP]

    def __repr__(self) -> str:
        return self.yaml().rstrip("\n")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return self._core.canonical() == other._core.canonical()  # type: ignore[no-any-return]

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Model:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Model:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return Model.parse, (self.yaml(),)


def _nested(source: Mapping[str, Any]) -> dict[str, Any]:
    """A tree in which keys may be paths, as a model lists them."""
    tree: dict[str, Any] = {}
    paths: dict[str, Any] = {}
    for key, value in source.items():
        (paths if isinstance(key, str) and re.search(r"[.\[]", key) else tree)[key] = value
    if not paths:
        return tree
    tree = encode("", tree)
    for path, value in paths.items():
        insert(tree, split(path), encode(path, value), path)
    return tree


class Group:
    """A part of a model: model.gyro, model.gyro.noise, an element of a list."""

    __slots__ = ("_model", "_path")

    def __init__(self, model: Model, path: str) -> None:
        object.__setattr__(self, "_model", model)
        object.__setattr__(self, "_path", path)

    def __reduce__(self) -> tuple[Any, ...]:
        return Group, (self._model, self._path)

    def __copy__(self) -> Group:
        return self

    def _at(self, key: str | int) -> str:
        return f"{self._path}[{key}]" if isinstance(key, int) else f"{self._path}.{key}"

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return self._model._member(self._at(name))

    def __setattr__(self, name: str, value: Any) -> None:
        self._model[self._at(name)] = value

    def __delattr__(self, name: str) -> None:
        del self._model[self._at(name)]

    def __getitem__(self, key: str | int) -> Any:
        try:
            return self._model[self._at(key)]
        except KeyError as error:
            if isinstance(key, int):
                raise IndexError(error.args[0]) from None
            raise

    def __setitem__(self, key: str | int, value: Any) -> None:
        self._model[self._at(key)] = value

    def __delitem__(self, key: str | int) -> None:
        del self._model[self._at(key)]

    def __len__(self) -> int:
        try:
            return len(self._model._node(self._path))
        except KeyError:
            return 0

    def __iter__(self) -> Iterator[Any]:
        try:
            node = self._model._node(self._path)
        except KeyError:
            return iter(())
        return iter([self[k] for k in range(len(node))] if isinstance(node, list) else list(node))

    def __contains__(self, key: object) -> bool:
        return isinstance(key, (str, int)) and self._at(key) in self._model

    def to_dict(self) -> Any:
        """Its tree: texts with units."""
        return self._model.text(self._path) if len(self) else {}

    def __dir__(self) -> list[str]:
        begin = bare(self._path) + "."
        keys = {path[len(begin):].split(".")[0].split("[")[0] for path in (*PATHS, *TEXTS)
                if path.startswith(begin)}
        return [*super().__dir__(), *sorted(keys)]

    def __repr__(self) -> str:
        return f"{self._path}: {json.dumps(self.to_dict(), ensure_ascii=False)}"


@dataclasses.dataclass(frozen=True, slots=True)
class Device:
    """An entry of the catalogue: Model(device.name) is its model."""

    name: str
    grade: str
    """'industrial MEMS', 'navigation', …"""
    source: str
    """source of the figures"""
    note: str
    """conversions made and contradictions found"""
    preset: bool
    """one of the five classes, and no real device"""


def devices(name: str = "") -> tuple[Device, ...]:
    """The catalogue of real devices and of typical units of five classes.

    name  only entries with this in their name

    Raises nothing. Source: include/imukit/model.h.

    >>> import imukit
    >>> [device.name for device in imukit.devices("ADIS1648")]
    ['ADIS16488']
    """
    return tuple(Device(*entry) for entry in _core.devices() if name.lower() in entry[0].lower())


def as_model(model: Model | str | os.PathLike[str] | Mapping[str, Any]) -> Model:
    """A model of what a function accepts in its place: a path, a name of the catalogue, a tree."""
    if not isinstance(model, (Model, str, os.PathLike, Mapping)):
        raise TypeError("expected a model: a Model, a path, a name of the catalogue, or a tree, "
                        f"not {type(model).__name__}")
    return model if isinstance(model, Model) else Model(model)


def select_terms(model: Model, only: str | Sequence[str] | None,
                 without: str | Sequence[str] | None) -> Model:
    """A model with the terms of the arguments `only` and `without`; itself where both are None."""
    if only is not None and without is not None:
        raise ValueError("only and without exclude each other")
    if only is not None:
        return model.only(*([only] if isinstance(only, str) else only))
    if without is not None:
        return model.without(*([without] if isinstance(without, str) else without))
    return model
