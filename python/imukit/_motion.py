# SPDX-License-Identifier: Apache-2.0
"""Motions of a unit, and temperatures."""
from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Any

from . import _core
from ._inputs import Data, is_path, open_record
from ._log import Log
from ._results import DataWarning
from ._units import si


class Motion:
    """A motion: a script, a table of poses, or recorded rates and forces (docs/motion-file.md).

    source     path of a motion script or of a table, or columns (a dictionary, a Log, a table):
               time, latitude, longitude and height, or x, y and z, and roll, pitch and yaw, or a
               quaternion q_w … q_z, with units in their names ("latitude [deg]"); or gyro_x …
               accel_z in equal steps, SI where they name no unit
    rate       of a table without times [Hz]
    latitude, height  place of a script that states none, and of local coordinates [rad], [m];
               default 45 deg, 0 m
    seed       of random vibration

    Motions can be copied; those of a script and at rest can be pickled.
    Motion.parse(text) reads the text of a script, Motion.at_rest() is a unit that stands. Raises
    imukit.Error. Source: include/imukit/motion_file.h.

    >>> import imukit
    >>> text = "imukit_motion: 1\\nsteps: [hold 1 s, rotate z 90 deg at 90 deg/s]"
    >>> motion = imukit.Motion.parse(text)
    >>> motion.kind, motion.duration
    ('script', 2.5)
    >>> truth = motion.truth(rate=10)
    >>> round(float(truth["yaw"][-1]), 6)
    1.570796
    """

    kind: str
    """'script', 'poses', 'recorded' or 'rest'"""
    duration: float
    """its length [s]; infinite: it has no end"""
    name: str
    """of a script"""
    note: str
    """what was assumed about columns that are missing, and which are not used"""
    text: str | None
    """of a script"""
    rate: float | None
    """of recorded rates and forces [Hz]"""

    def __init__(self, source: Data, *, rate: float | str | None = None,
                 latitude: float | str | None = None, height: float | str = 0.0,
                 seed: int = 1) -> None:
        place = _place(latitude, height)
        if is_path(source):
            hertz = 0.0 if rate is None else si("rate", rate, "Hz")
            self._parsed = place, seed
            self._describe(_core.open_motion(source, hertz, place, seed))
        else:
            self._describe(_core.motion_of_record(open_record(source, rate, None), place))

    @classmethod
    def parse(cls, text: str, *, latitude: float | str | None = None, height: float | str = 0.0,
              seed: int = 1) -> Motion:
        """The motion of the text of a script."""
        made = cls.__new__(cls)
        place = _place(latitude, height)
        made._parsed = place, seed
        made._describe(_core.parse_motion(text, place, seed))
        return made

    @classmethod
    def at_rest(cls, *, latitude: float | str = "45 deg", height: float | str = 0.0,
                roll: float | str = 0.0, pitch: float | str = 0.0, yaw: float | str = 0.0,
                earth: bool = True) -> Motion:
        """A unit that stands, at a geodetic latitude [rad] and height [m], turned by roll, pitch
        and yaw [rad] from north, east and down. earth=False: without Earth rate and gravity."""
        made = cls.__new__(cls)
        made._core = None
        made._rest = {"latitude": latitude, "height": height, "roll": roll, "pitch": pitch,
                      "yaw": yaw, "earth": earth}
        made.kind, made.duration, made.name, made.note = "rest", float("inf"), "", ""
        made.text, made.rate = None, None
        return made

    def _describe(self, core: Any) -> None:
        self._core = core
        self._rest: Mapping[str, Any] = {}
        self.kind, self.duration, self.name, self.note, self.text, rate = \
            _core.describe_motion(core)
        self.rate = rate or None
        if self.note:
            warnings.warn(self.note, DataWarning, stacklevel=3)

    def truth(self, rate: float | str | None = None, duration: float | str | None = None, *,
              threads: int = 0) -> Log:
        """The truth, row by row: position, velocity and attitude at the time of the row (not of a
        recorded motion), and what perfect sensors read over the row.

        rate      rows per second [Hz], or a text such as "100 Hz"
        duration  [s], or a text such as "2 h"; without, the whole motion
        threads   0: one per processor
        """
        from ._simulate import simulate_truth  # which needs this module
        return simulate_truth(rate, duration, self, threads=threads)

    def __copy__(self) -> Motion:
        made = type(self).__new__(type(self))
        made.__dict__.update(self.__dict__)
        return made

    def __deepcopy__(self, memo: Any) -> Motion:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        if self.kind == "rest":
            return _at_rest, (dict(self._rest),)
        if self.text is None:
            raise TypeError("a Motion of columns cannot be pickled: pickle what it was made of, and "
                            "make another")
        return _of_text, (self.text, *self._parsed)

    def __repr__(self) -> str:
        return f"Motion: {self.kind} of {self.duration:g} s"


def _at_rest(arguments: Mapping[str, Any]) -> Motion:
    return Motion.at_rest(**arguments)


def _of_text(text: str, place: tuple[float, float] | None, seed: int) -> Motion:
    with warnings.catch_warnings():  # told when the motion was made
        warnings.simplefilter("ignore", DataWarning)
        if place is None:
            return Motion.parse(text, seed=seed)
        return Motion.parse(text, latitude=place[0], height=place[1], seed=seed)


def _place(latitude: float | str | None, height: float | str) -> tuple[float, float] | None:
    if latitude is None:
        return None
    return si("latitude", latitude, "rad"), si("height", height, "m")


def temperature_of(source: Any) -> Any:
    """A temperature profile: None; a number [K] or a text with a unit; a path; or columns."""
    if source is None:
        return None
    if is_path(source):
        return _core.open_temperature(source)
    if isinstance(source, (int, float)) and not isinstance(source, bool):
        return _core.open_temperature(f"{float(source)!r} K")
    return _core.temperature_of_record(open_record(source, None, None))
