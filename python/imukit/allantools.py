# SPDX-License-Identifier: Apache-2.0
"""Deviations as the public package allantools has them, computed by imukit.

A script changes one line: `import allantools` becomes `from imukit import allantools`. Arguments,
results and conventions are those of allantools 2024.06, whose documentation is at
allantools.readthedocs.io. For intervals, noise types, missing samples and the bias of the total
deviations see imukit.allan().

Every function takes

data        vector of phase [s], or of fractional frequency [1]; or the integral of a rate and the
            rate of an inertial sensor. NaN at the ends of frequencies is cut off
rate        sampling rate [Hz], > 0
data_type   'phase' or 'freq'
taus        'octave' (None), 'decade' (1, 2, 4, 10, 20, 40 …), 'log10' (10 per decade), 'all', or
            averaging times [s]. Each is rounded to a multiple m of 1/rate; what is 0 or as long as
            the data is left out
threads     0: one per processor (allantools has no such argument)

and gives back vectors of equal length: averaging times m/rate [s], deviations, errors (deviation
over the root of the number of averages), and numbers of averages. Averaging times with a single
average are left out. Raises UserWarning where none is left; imukit.Error for a sample that is not
finite; ValueError and TypeError for other arguments. N is the number of phase samples.
"""
from __future__ import annotations

import array
import copy
import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from . import _arrays, _core
from ._inputs import _column
from ._units import si

__all__ = ["adev", "hdev", "htotdev", "mdev", "mtotdev", "oadev", "ohdev", "pdev", "tdev", "theo1",
           "totdev", "ttotdev"]

Taus = str | float | Sequence[float] | None
Deviations = tuple[_arrays.Array, _arrays.Array, _arrays.Array, _arrays.Array]



class _Series:
    """Data, and deviations of them. `size` is N."""

    def __init__(self, data: Any, rate: float, data_type: str, threads: int) -> None:
        if data_type not in ("phase", "freq"):
            raise ValueError(f"data_type={data_type!r}: expected 'phase' or 'freq'")
        self.rate = si("rate", rate, "Hz")
        if not 0 < self.rate < math.inf:
            raise ValueError(f"rate={rate!r}: expected a rate above 0 [Hz]")
        self.phase = data_type == "phase"
        self.data = _vector(data) if self.phase else _trimmed(_vector(data))
        self.size = len(self.data) + (not self.phase)
        self.threads = threads

    def without_last(self) -> _Series:
        """The same without the last phase sample."""
        made = copy.copy(self)
        made.data, made.size = self.data[:-1], self.size - 1
        return made

    def deviations(self, statistic: str, factors: Iterable[int]) -> list[_Point]:
        """The statistic at averaging factors of its range."""
        chosen = array.array("d", factors)
        if not chosen:
            return []
        found, counts = _arrays.empty(len(chosen)), _arrays.empty(len(chosen))
        _core.deviation(self.data, statistic, self.phase, self.rate if self.phase else 1.0, chosen,
                        (found, counts), self.threads)
        return [_Point(int(m), d, n, n) for m, d, n in zip(chosen, found, counts)]


class _Point(NamedTuple):
    factor: int
    deviation: float
    averages: float
    """by which the error is less than the deviation, as a variance"""
    told: float
    """number of averages that is told"""


def _vector(data: Any) -> Any:
    """A vector of numbers with the buffer protocol."""
    data = _column(data)
    try:
        view = memoryview(data)
    except TypeError:
        return array.array("d", data)
    if view.ndim != 1:
        raise ValueError(f"data: expected a vector, found {view.ndim} dimensions")
    return data


def _trimmed(data: Any) -> Any:
    """Without NaN at the ends."""
    first, last = 0, len(data)
    while first < last and data[first] != data[first]:
        first += 1
    while last > first and data[last - 1] != data[last - 1]:
        last -= 1
    return data if last - first == len(data) else data[first:last]


def _factors(taus: Taus, rate: float, size: int) -> list[int]:
    """Averaging factors below `size`, ascending."""
    factors: Iterable[int]
    if taus is None or isinstance(taus, list) and not taus:
        taus = "octave"
    if not isinstance(taus, str):
        times = taus if hasattr(taus, "__iter__") else [taus]
        places = (float(tau) * rate for tau in times)
        factors = (round(place) for place in places if 0 < place < size)
    elif taus == "octave":
        factors = (2 ** k for k in range(size.bit_length()))
    elif taus == "decade":
        factors = (step * 10 ** k for k in range(len(str(size))) for step in (1, 2, 4))
    elif taus == "log10":
        decades = math.log10(max(size, 1))
        count = int(10 * decades)
        factors = (round(10 ** (decades * k / max(count - 1, 1))) for k in range(count))
    elif taus == "all":
        factors = range(1, size)
    else:
        raise ValueError(f"taus={taus!r}: expected 'octave', 'decade', 'log10', 'all' or times [s]")
    return sorted({m for m in factors if 0 < m < size})


def _told(points: Iterable[_Point], rate: float) -> Deviations:
    """Columns of the points with more than one average."""
    kept = [p for p in points if p.told > 1]
    if not kept:
        raise UserWarning("taus: no averaging time has two averages. Longer data or shorter times "
                          "are needed")
    return (_arrays.of_numbers(p.factor / rate for p in kept),
            _arrays.of_numbers(p.deviation for p in kept),
            _arrays.of_numbers(p.deviation / math.sqrt(p.averages) for p in kept),
            _arrays.of_numbers(p.told for p in kept))


def _told_up_to(highest: int, statistic: str, series: _Series, taus: Taus) -> Deviations:
    """A statistic at all averaging factors up to a highest one."""
    factors = _factors(taus, series.rate, series.size)
    return _told(series.deviations(statistic, (m for m in factors if m <= highest)), series.rate)


def _times_tau(times: _arrays.Array, found: _arrays.Array, counts: _arrays.Array) -> Deviations:
    """A modified deviation as one of time."""
    scaled = [tau * d / math.sqrt(3) for tau, d in zip(times, found)]
    return (times, _arrays.of_numbers(scaled),
            _arrays.of_numbers(d / math.sqrt(n) for d, n in zip(scaled, counts)), counts)


def adev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
         threads: int = 0) -> Deviations:
    """Allan deviation, of neighbouring means over tau [RILEY2008, (7)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.adev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.3849, 2.5836, 0.559]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to((series.size - 1) // 2, "adev", series, taus)


def oadev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
          threads: int = 0) -> Deviations:
    """Overlapping Allan deviation [RILEY2008, (11)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.oadev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.3849, 2.1344, 1.2374]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to((series.size - 1) // 2, "oadev", series, taus)


def mdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
         threads: int = 0) -> Deviations:
    """Modified Allan deviation [RILEY2008, (14)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.mdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.3849, 1.2686, 0.4614]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to(series.size // 3, "mdev", series, taus)


def tdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
         threads: int = 0) -> Deviations:
    """Time deviation, tau mdev/sqrt(3), in seconds [RILEY2008, (15)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.tdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [2.5316, 1.4649, 1.0656]
    """
    times, found, errors, counts = mdev(data, rate, data_type, taus, threads=threads)
    return _times_tau(times, found, counts)


def hdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
         threads: int = 0) -> Deviations:
    """Hadamard deviation, of neighbouring means over tau [RILEY2008, (17)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.hdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.7346, 2.59]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to((series.size - 1) // 3, "hdev", series, taus)


def ohdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
          threads: int = 0) -> Deviations:
    """Overlapping Hadamard deviation [RILEY2008, (20)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.ohdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.7346, 2.2374]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to((series.size - 1) // 3, "ohdev", series, taus)


def totdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
           threads: int = 0) -> Deviations:
    """Total deviation, of the data reflected at both ends [RILEY2008, (25)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    Its bias is left, as allantools leaves it; imukit.allan(statistic='totdev') takes it off.

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.totdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.3849, 2.1768, 1.5076, 0.514]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to(series.size - 1, "totdev", series, taus)


def mtotdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
            threads: int = 0) -> Deviations:
    """Modified total deviation [RILEY2008, (27)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    Its bias is left, as allantools leaves it; imukit.allan(statistic='mtot') takes it off.

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.mtotdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [3.1006, 1.4973, 0.4828]
    """
    series = _Series(data, rate, data_type, threads)
    return _told_up_to(series.size // 3, "mtot", series, taus)


def ttotdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
            threads: int = 0) -> Deviations:
    """Time total deviation, tau mtotdev/sqrt(3), in seconds [RILEY2008, (28)].

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.ttotdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [1.7901, 1.7289, 1.1149]
    """
    times, found, errors, counts = mtotdev(data, rate, data_type, taus, threads=threads)
    return _times_tau(times, found, counts)


def htotdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
            threads: int = 0) -> Deviations:
    """Hadamard total deviation [RILEY2008, 5.2.13]; at m = 1 the overlapping Hadamard deviation.

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    Its bias is left, as allantools leaves it; imukit.allan(statistic='htot') takes it off.

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.htotdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.7346, 2.7829]
    """
    series = _Series(data, rate, data_type, threads)
    factors = _factors(taus, series.rate, series.size - 1)
    factors = [m for m in factors if m <= (series.size - 1) // 3]
    return _told(series.deviations("ohdev", (m for m in factors if m == 1)) +
                 series.deviations("htot", (m for m in factors if m > 1)), series.rate)


def theo1(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
          threads: int = 0) -> Deviations:
    """Theo1 [RILEY2008, (30)], at even m.

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    The times are m/rate, as in allantools; it stands for the Allan deviation at 0.75 m/rate. An error
    is the deviation over sqrt(N - m); counts are of the terms of both sums, (N - m) m/2.

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.theo1([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [3.5802, 1.7533, 0.7973]
    """
    series = _Series(data, rate, data_type, threads)
    factors = (m for m in _factors(taus, series.rate, series.size) if m % 2 == 0)
    points = series.deviations("theo1", factors)
    return _told([p._replace(told=p.averages * p.factor / 2) for p in points], series.rate)


def pdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Taus = None, *,
         threads: int = 0) -> Deviations:
    """Parabolic deviation, of least-squares slopes [VERNOTTE2016]; at m = 1 the Allan one.

    data, rate, data_type, taus, threads: see help(imukit.allantools).

    Beyond m = 1 it averages N - 2m terms, as allantools does; there are N - 2m + 1, of which
    imukit.allan(statistic='pdev') takes all.

    >>> from imukit import allantools
    >>> times, found, errors, counts = allantools.pdev([0, 3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 9])
    >>> [round(float(d), 4) for d in found]
    [4.3849, 2.8118, 0.8021]
    """
    series = _Series(data, rate, data_type, threads)
    factors = _factors(taus, series.rate, series.size)
    first = series.deviations("oadev", (m for m in factors if m == 1 and series.size > 2))
    last = series.without_last().deviations(
        "pdev", (m for m in factors if 1 < m <= (series.size - 1) // 2))
    return _told(first + last, series.rate)
