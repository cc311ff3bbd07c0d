# SPDX-License-Identifier: Apache-2.0
"""Power spectral densities."""
from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from . import _arrays, _core
from ._inputs import Data, open_record
from ._estimates import Estimate, channel_of, estimates_of, plain_value
from ._results import Result, tell


@dataclasses.dataclass(frozen=True, slots=True)
class SpectrumCurve(_arrays.Vectors):
    """Density of one channel, 100 bands per decade: vectors of equal length."""

    name: str
    """the channel"""
    unit: str
    """unit of the channel; densities are in its square per Hz"""
    sides: str
    """'two-sided' or 'one-sided'"""
    frequency: _arrays.Array
    """[Hz]"""
    density: _arrays.Array
    """[unit^2/Hz]"""
    lower: _arrays.Array
    """lower end of the interval [unit^2/Hz]"""
    upper: _arrays.Array
    """upper end of the interval [unit^2/Hz]"""
    degrees: _arrays.Array
    """degrees of freedom"""


@dataclasses.dataclass(frozen=True, slots=True)
class SpectrumLine:
    """A line of the spectrum of one channel, such as a vibration."""

    name: str
    """the channel"""
    unit: str
    """unit of the channel and of the amplitude"""
    frequency: float
    """[Hz]"""
    frequency_sigma: float
    """1 sigma [Hz]"""
    amplitude: float
    """[unit]"""
    amplitude_sigma: float
    """1 sigma [unit]"""
    coherent: bool
    """a sine of constant frequency and amplitude"""
    width: float
    """[Hz]"""
    ratio: float
    """density over that of the noise around"""
    false_alarm: float
    """chance that noise alone shows such a line in this channel"""
    family: int
    """number of the family of multiples of one frequency"""
    multiple: int
    """which multiple it is"""


class SpectrumResult(Result):
    """Densities, lines and noise parameters of every channel of a record. See spectrum()."""

    def __init__(self, core: Any, findings: list[tuple[int, str, str, str]],
                 curves: list[tuple[Any, ...]]) -> None:
        super().__init__(core, findings)
        self._curves = curves

    @property
    def curves(self) -> tuple[SpectrumCurve, ...]:
        """The density of each channel."""
        sides = self._data["inputs"]["density"]
        return tuple(SpectrumCurve(name, unit, sides, *map(_arrays.of_bytes, numbers))
                     for name, unit, *numbers in self._curves)

    def curve(self, name: str | None = None) -> SpectrumCurve:
        """The density of a channel, whose name may be left out if there is only one. Raises
        KeyError."""
        fit = [c for c in self.curves if name in (None, c.name)]
        if len(fit) != 1:
            raise KeyError(f"{len(fit)} channels are {name or 'any channel'}; there are: "
                           f"{', '.join(c.name for c in self.curves)}")
        return fit[0]

    @property
    def lines(self) -> tuple[SpectrumLine, ...]:
        """The lines of all channels."""
        return tuple(SpectrumLine(channel["name"], line["amplitude"]["unit"],
                                  *(plain_value(line[key]) for key in _LINE))
                     for channel in self._data["result"]["channels"] for line in channel["lines"])

    def estimates(self, name: str | None = None) -> dict[str, Estimate]:
        """The noise that a channel shows, as identify() has it: a cross-check of identify(), which
        is the better estimator. Empty where it could not be fitted. Raises KeyError."""
        found = channel_of(self._data["result"]["channels"], name)["parameters"]
        return estimates_of(found["terms"]) if found else {}


_LINE = ("frequency", "frequency_sigma", "amplitude", "amplitude_sigma", "coherent", "width",
         "ratio", "false_alarm", "family", "multiple")


def spectrum(data: Data, rate: float | str | None = None, *, method: str = "welch",
             resolution: float | str | None = None, window: str = "hann", trend: bool = False,
             density: str = "two-sided", false_alarm: float = 0.001,
             from_: float | str | None = None, to: float | str | None = None,
             columns: str | Sequence[str] | None = None, confidence: float = 0.95,
             gaps: str = "refuse", threads: int = 0,
             progress: Callable[[str, str, int, int], object] | None = None,
             **log: Any) -> SpectrumResult:
    """Power spectral density of every channel with intervals, its lines and its noise.

    data        path of a log; vector; matrix (rows are samples); dictionary, list or table of
                columns. NaN is a missing sample
    rate        sampling rate [Hz], or a text such as "200 Hz"; needed without a column of times
    method      'welch': averaged windowed segments; 'multitaper': Slepian tapers, for records too
                short to be divided
    resolution  smallest distance at which two lines are separated [Hz]; None: 31 segments, or one
                for 'multitaper'
    window      of the segments: 'hann', 'blackman-harris' or 'kaiser'
    trend       remove a straight line from each segment, not only its mean
    density     'two-sided', or 'one-sided': twice as large. Parameters are always two-sided
    false_alarm  chance that a channel without lines shows any, 0 … 1
    from_, to   range of the fit of the noise parameters [Hz]; None: the lowest resolved, half the
                sampling rate
    columns     names of the columns, with units in brackets ("gyro_x [deg/s]"); without, SI
    confidence  of the two-sided intervals, 0 … 1
    gaps        rows that are missing: 'refuse', 'bridge' or 'longest'
    threads     0: one per processor
    progress    called with (stage, unit, done, total); a false value but None ends the work
    log         options for reading a log: see read_log()

    Raises imukit.Error: the record is too short or constant, samples are missing, the resolution
    does not fit. Source: include/imukit/spectrum.h, spectrum_log.h.

    >>> import imukit, random
    >>> random.seed(1)
    >>> x = [random.gauss(0, 0.1) for _ in range(4000)]
    >>> curve = imukit.spectrum(x, rate=100).curve()
    >>> due = 0.1 ** 2 / 100
    >>> 0.9 * due < sum(curve.density) / len(curve.density) < 1.1 * due, curve.sides
    (True, 'two-sided')
    """
    if density not in ("two-sided", "one-sided"):
        raise ValueError(f"density={density!r}: expected 'two-sided' or 'one-sided'")
    settings = {"gaps": gaps, "method": method, "window": window, "resolution": resolution,
                "trend": trend, "from": from_, "to": to, "confidence": confidence,
                "false_alarm": false_alarm, "one_sided": density == "one-sided"}
    record = open_record(data, rate, columns, log)
    result = SpectrumResult(*_core.spectrum(record, settings, threads, progress))
    tell(result)
    return result
