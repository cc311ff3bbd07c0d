#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""imukit.allantools beside the original, in one run: how much faster, and how equal.

    IMUKIT_ALLANTOOLS=/path/to/checkout PYTHONPATH=build/python-package bench/compare_allantools.py

The original is a checkout of the package allantools, or a folder that contains the package. OADEV,
MDEV, OHDEV and HDEV at octaves of 1e6 frequencies; Theo1 and MTOT of 1e4 at two averaging times that
are short for them: the time of the original grows with them, to minutes, and that of imukit hardly
does. Both sides run in turn, and times are the least of several [s].

The better of imukit's times counts, since other work on the machine delays threads.
What limits one thread (Zen 4): HDEV reads every
m-th phase only, and spends half of its 2.4 to 3 ms on integrating the frequencies (10 additions a
sample, which carry the rounding along); the original needs 27 to 33 ms, so little more than 10 can be
had. OADEV reads 3 points a term in 3.4 ms and OHDEV 4 in 4.0 ms, from caches. MDEV takes 13 ms for the
same 4 points, since running sums by vectors are three sweeps more."""
import importlib
import os
import sys
import time

import numpy

from imukit import allantools as mine

LEAST = {"oadev": 10, "mdev": 10, "ohdev": 10, "hdev": 10, "theo1": 100, "mtotdev": 100}
ALL = ("adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev", "mtotdev", "ttotdev", "htotdev",
       "theo1", "pdev")


def least(runs, functions):
    """Shortest times of functions, three runs each in turn: the first finds cold caches."""
    best, results = [float("inf")] * len(functions), [None] * len(functions)
    for _ in range(runs):
        for k, function in ((k, f) for k, f in enumerate(functions) for _ in range(min(runs, 3))):
            begin = time.perf_counter()
            results[k] = function()
            best[k] = min(best[k], time.perf_counter() - begin)
    return best, results


def difference(one, other):
    """Largest relative difference of the four vectors; infinite where their lengths differ."""
    worst = 0.0
    for a, b in zip(one, other):
        if len(a) != len(b):
            return float("inf")
        worst = max(worst, numpy.max(numpy.abs(numpy.asarray(a) - b) / numpy.abs(b)))
    return worst


def compare_speed(theirs):
    good = True
    rates = numpy.random.default_rng(1).standard_normal(1000000)
    for name, wanted in LEAST.items():
        long = wanted < 100
        data = rates if long else rates[:10000]
        taus = "octave" if long else [16, 128]

        def run(side, **options):
            return getattr(side, name)(data, data_type="freq", taus=taus, **options)

        (slow, quick, alone), (other, one, _) = least(5 if long else 1, (
            lambda: run(theirs), lambda: run(mine), lambda: run(mine, threads=1)))
        apart = difference(one, other)
        good &= slow >= wanted * min(quick, alone) and apart <= 1e-10
        print(f"{name}, {len(data)}: {quick:.6f} s, of one thread {alone:.6f} s, original "
              f"{slow:.6f} s: {slow / quick:.1f} times as fast (wanted {wanted}), of one thread "
              f"{slow / alone:.1f}; relative difference {apart:.1e} (wanted 1e-10)")
    return good


def compare_values(theirs):
    """All functions with all grids, of phase and frequencies."""
    draw = numpy.random.default_rng(2)
    worst = {}
    for name in ALL:
        for kind in ("phase", "freq"):
            for size, rate in ((150, 1.0), (301, 8.0)):
                data = draw.standard_normal(size)
                data = numpy.cumsum(data) if kind == "phase" else data
                for taus in (None, "octave", "decade", "all", [3 / rate, 7.4 / rate, 20 / rate]):
                    if name in ("mtotdev", "ttotdev", "htotdev") and taus == "all":
                        continue
                    if name == "theo1" and isinstance(taus, list):
                        taus = [8 / rate, 20 / rate]
                    sides = [getattr(side, name)(data, rate, kind, taus) for side in (mine, theirs)]
                    worst[name] = max(worst.get(name, 0), difference(*sides))
    for name, apart in worst.items():
        print(f"{name}: largest relative difference of times, deviations, errors and counts "
              f"{apart:.1e} (wanted 1e-10)")
    return max(worst.values()) <= 1e-10


def main():
    folder = os.environ.get("IMUKIT_ALLANTOOLS", "")
    if not os.path.isdir(os.path.join(folder, "allantools")) or not folder:
        print("not compared: IMUKIT_ALLANTOOLS names no checkout")
        return 0
    sys.path.insert(0, folder)
    theirs = importlib.import_module("allantools")
    print(f"allantools {getattr(theirs, '__version__', 'of no version')}, numpy {numpy.__version__}")
    good = compare_speed(theirs)
    return 0 if compare_values(theirs) and good else 1


if __name__ == "__main__":
    sys.exit(main())
