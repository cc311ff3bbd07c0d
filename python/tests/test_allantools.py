# SPDX-License-Identifier: Apache-2.0
"""imukit.allantools against published values, the definitions and the conventions of allantools."""
import array
import math
import random
import signal
import time
import unittest

import imukit
from imukit import allantools

NAMES = ("adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev", "mtotdev", "ttotdev",
         "htotdev", "theo1", "pdev")


def published_set():
    """The 1000 frequencies of [RILEY2008], table 31."""
    value, numbers = 1234567890, []
    for _ in range(1000):
        numbers.append(value / 2147483647)
        value = 16807 * value % 2147483647
    return numbers


def mean_square(terms):
    return sum(t * t for t in terms) / len(terms)


def differences(x, m, order, stride):
    weights = {2: (1, -2, 1), 3: (1, -3, 3, -1)}[order]
    terms = [sum(w * x[i + k * m] for k, w in enumerate(weights))
             for i in range(0, len(x) - order * m, stride)]
    return mean_square(terms) / ({2: 2, 3: 6}[order] * m * m), len(terms)


def modified(x, m):
    terms = [sum(x[i + 2 * m] - 2 * x[i + m] + x[i] for i in range(j, j + m)) / m
             for j in range(len(x) - 3 * m + 1)]
    return mean_square(terms) / (2 * m * m), len(terms)


def total(x, m):
    last = len(x) - 1

    def at(i):
        return 2 * x[0] - x[-i] if i < 0 else 2 * x[last] - x[2 * last - i] if i > last else x[i]

    terms = [at(i - m) - 2 * x[i] + at(i + m) for i in range(1, last)]
    return mean_square(terms) / (2 * m * m), len(terms)


def stretches(v, m):
    """Mean square second difference of the means over m of stretches of 3 m, their trend between
    halves taken off, between their mirror images."""
    squares, length = [], 3 * m
    for p in range(len(v) - length + 1):
        half = length // 2
        left, right = sum(v[p:p + half]) / half, sum(v[p + length - half:p + length]) / half
        slope = (right - left) / (length - half)
        flat = [v[p + k] - slope * k for k in range(length)]
        long = flat[::-1] + flat + flat[::-1]
        squares.append(mean_square([sum(long[j + k] - 2 * long[j + m + k] + long[j + 2 * m + k]
                                        for k in range(m)) / m for j in range(6 * m)]))
    return sum(squares) / len(squares), len(squares)


def theo(x, m):
    """The variance, how many sums there are, and how many terms."""
    sums = [sum(((x[i] - x[i - d + m // 2]) + (x[i + m] - x[i + d + m // 2])) ** 2 / (m // 2 - d)
                for d in range(m // 2)) for i in range(len(x) - m)]
    return sum(sums) / len(sums) / (0.75 * m * m), len(sums), len(sums) * m // 2


def parabolic(x, m):
    if m == 1:
        return differences(x, 1, 2, 1)
    terms = [sum(((m - 1) / 2 - k) * (x[i + k] - x[i + k + m]) for k in range(m))
             for i in range(len(x) - 2 * m)]
    return (72 * mean_square(terms) / m ** 6, len(terms)) if terms else None


def expected(name, phase, rate, m):
    """(time, deviation, error, count) at an averaging factor; None where it is left out."""
    x = [value * rate for value in phase]
    n = len(x)
    y = [b - a for a, b in zip(x, x[1:])]
    if name in ("adev", "oadev") and 2 * m < n:
        found = differences(x, m, 2, m if name == "adev" else 1)
    elif (name in ("hdev", "ohdev") or name == "htotdev" and m == 1) and 3 * m < n:
        found = differences(x, m, 3, m if name == "hdev" else 1)
    elif name in ("mdev", "tdev") and 3 * m <= n:
        found = modified(x, m)
    elif name == "totdev" and m < n:
        found = total(x, m)
    elif name in ("mtotdev", "ttotdev") and 3 * m <= n:
        square, count = stretches(x, m)
        found = square / (2 * m * m), count
    elif name == "htotdev" and 3 * m <= n - 1:
        square, count = stretches(y, m)
        found = square / 6, count
    elif name == "theo1" and m < n and m % 2 == 0:
        found = theo(x, m)
    elif name == "pdev" and 2 * m < n:
        found = parabolic(x, m)
    else:
        found = None
    if not found or found[-1] <= 1:
        return None
    deviation = math.sqrt(found[0])
    if name in ("tdev", "ttotdev"):
        deviation *= m / rate / math.sqrt(3)
    return m / rate, deviation, deviation / math.sqrt(found[1]), found[-1]


class Values(unittest.TestCase):
    def close(self, found, due, relative):
        self.assertEqual(len(found), len(due))
        for a, b in zip(found, due):
            self.assertLessEqual(abs(a - b), relative * abs(b), f"{a} is not {b}")

    def test_published(self):
        """[RILEY2008], table 31, all digits; and for the total family and Theo1, of which the table
        has values without their bias, what two other programs computed."""
        table = {
            "adev": (.2922319, .09965736, .03897804), "oadev": (.2922319, .09159953, .03241343),
            "mdev": (.2922319, .06172376, .02170921), "tdev": (.1687202, .3563623, 1.253382),
            "hdev": (.2943883, .1052754, .03910861), "ohdev": (.2943883, .09581083, .03237638),
            "totdev": (.2922319, .09134743, .03406530),
            "mtotdev": (.2066391, .05552886, .01954675), "htotdev": (.2943883, .0959072, .03050448),
        }
        data = published_set()
        for name, due in table.items():
            with self.subTest(name):
                found = getattr(allantools, name)(data, data_type="freq", taus=[1, 10, 100])[1]
                self.close(found, due, 6e-7)
        found = allantools.theo1(data, data_type="freq", taus=[10, 100, 1000])
        self.assertEqual(list(found[0]), [10, 100, 1000])
        self.close(found[1], (.1075739889, .0317893126, .0050523996), 1e-8)

    def test_definitions(self):
        """Every averaging factor of short data; the kept ones are those of the definitions."""
        draw = random.Random(7)
        for size, rate in ((3, 1.0), (7, 2.0), (24, 0.5), (37, 10.0)):
            phase = [0.0]
            for _ in range(size - 1):
                phase.append(phase[-1] + draw.gauss(0.01, 1) / rate)
            rates = [rate * (b - a) for a, b in zip(phase, phase[1:])]
            for name in NAMES:
                rows = [row for m in range(1, size) if (row := expected(name, phase, rate, m))]
                if not rows:
                    with self.assertRaises(UserWarning):
                        getattr(allantools, name)(phase, rate, taus="all")
                    continue
                for data, kind in ((phase, "phase"), (rates, "freq")):
                    with self.subTest(name, size=size, kind=kind):
                        found = getattr(allantools, name)(data, rate, kind, "all")
                        for column, due in zip(found, zip(*rows)):
                            self.close(column, due, 1e-10)

    def test_longer(self):
        """Where the fast ways take over, on phase of 1e-9 s with a ramp of 1e-6."""
        draw, phase = random.Random(3), [0.0]
        for _ in range(179):
            phase.append(phase[-1] + 1e-6 + draw.gauss(0, 1e-9))
        for name in NAMES:
            with self.subTest(name):
                found = getattr(allantools, name)(phase, taus=[6, 20, 56])
                rows = [expected(name, phase, 1.0, m) for m in (6, 20, 56)]
                for column, due in zip(found, zip(*(row for row in rows if row))):
                    self.close(column, due, 1e-7)  # of a phase of 2e-4 with 3e-20 of rounding


class Conventions(unittest.TestCase):
    def times(self, taus, size=50, rate=1.0, function=allantools.oadev):
        draw = random.Random(1)
        return [float(t) for t in function([draw.gauss(0, 1) for _ in range(size)], rate,
                                           taus=taus)[0]]

    def test_grids(self):
        self.assertEqual(self.times(None), [1, 2, 4, 8, 16])
        self.assertEqual(self.times([]), self.times("octave"))
        self.assertEqual(self.times("decade", 500), [1, 2, 4, 10, 20, 40, 100, 200])
        self.assertEqual(self.times("all"), list(range(1, 25)))
        self.assertEqual(self.times("all", function=allantools.theo1), list(range(2, 50, 2)))
        self.assertEqual(self.times("octave", function=allantools.totdev), [1, 2, 4, 8, 16, 32])
        self.assertEqual(self.times("log10", 100),
                         [1, 2, 3, 4, 5, 7, 9, 11, 14, 18, 23, 30, 38, 48])

    def test_times(self):
        self.assertEqual(self.times([3, 2, 2.4, 2.6, -1, 0, 0.4, 1e9, math.nan, math.inf]), [2, 3])
        self.assertEqual(self.times([0.5, 1.5, 2.5]), [2], "halves go to the even one")
        self.assertEqual(self.times([0.021, 0.1], rate=100), [0.02, 0.1])
        self.assertEqual(self.times((1, 2)), [1, 2])
        self.assertEqual(self.times(array.array("d", [2])), [2])
        self.assertEqual(self.times(2), [2])
        self.assertEqual(self.times([2], rate="1 Hz"), [2])

    def test_frequencies(self):
        rates = published_set()[:60]
        due = [list(column) for column in allantools.oadev(rates, data_type="freq")]
        shifted = [math.nan, *(r + 1000 for r in rates), math.nan, math.nan]
        for column, expects in zip(allantools.oadev(shifted, data_type="freq"), due):
            for a, b in zip(column, expects):
                self.assertAlmostEqual(a, b, 11)
        self.assertEqual(due[3], [59, 57, 53, 45, 29])

    def test_forms_of_data(self):
        x = array.array("d", published_set()[:100])
        pairs = array.array("d", (v for a in x for v in (a, 7.0)))
        due = list(allantools.mtotdev(x)[1])
        for data in (list(x), tuple(x), memoryview(x), memoryview(pairs)[::2]):
            self.assertEqual(list(allantools.mtotdev(data)[1]), due)
        due = list(allantools.mtotdev(x, data_type="freq")[1])
        self.assertEqual(list(allantools.mtotdev(memoryview(pairs)[::2], data_type="freq")[1]), due)
        self.assertEqual(list(x), published_set()[:100], "the data stays as it is")

    def test_numpy(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("no NumPy")
        x = numpy.array(published_set()[:100])
        found = allantools.theo1(x, taus=numpy.array([10.0, 20]))
        self.assertTrue(all(isinstance(column, numpy.ndarray) for column in found))
        self.assertEqual(list(found[3]), [90 * 5, 80 * 10])
        self.assertEqual(list(allantools.oadev(numpy.arange(9) ** 2)[1])[0],
                         allantools.oadev([k * k for k in range(9)])[1][0])

    def test_threads(self):
        for name in NAMES:
            x = published_set()
            self.assertEqual([list(c) for c in getattr(allantools, name)(x, threads=1)],
                             [list(c) for c in getattr(allantools, name)(x, threads=3)])


class Refused(unittest.TestCase):
    def test_arguments(self):
        x = published_set()[:30]
        for kind, words, arguments in (
                (ValueError, "data_type='frequency'", (x, 1, "frequency")),
                (ValueError, "above 0", (x, 0)), (ValueError, "above 0", (x, -1)),
                (ValueError, "rate", (x, math.nan)),
                (ValueError, "taus='octaves'", (x, 1, "phase", "octaves")),
                (TypeError, "", (x, None)), (TypeError, "", (x, 1, "phase", [None])),
                (TypeError, "", (None,)), (TypeError, "", (5,)), (TypeError, "", ("abc",)),
                (TypeError, "", ([object()] * 9,)),
                (ValueError, "dimensions", (memoryview(bytes(64)).cast("d", (2, 4)),)),
                (UserWarning, "longer", ([],)), (UserWarning, "longer", ([1.0],)),
                (UserWarning, "longer", (x, 1, "phase", [1000])),
                (UserWarning, "longer", ([math.nan] * 9, 1, "freq")),
                (imukit.Error, "data[3]", ([1, 2, 3, math.nan, 5, 6, 7, 8],)),
                (imukit.Error, "data[3]", ([1, 2, 3, math.inf, 5, 6, 7, 8], 1, "freq"))):
            for name in NAMES:
                with self.subTest(name, arguments=arguments):
                    with self.assertRaisesRegex(kind, "(?i)" + words.replace("[", r"\[")):
                        getattr(allantools, name)(*arguments)
        with self.assertRaisesRegex(ValueError, "threads"):
            allantools.oadev(x, threads=-1)


class Stopped(Exception):
    pass


class Interrupted(unittest.TestCase):
    def test_long_call(self):
        """Half a minute of work ends soon after a signal."""
        def stop(*said):
            raise Stopped

        x = array.array("d", (k * k % 101 for k in range(20000)))
        before = signal.signal(signal.SIGALRM, stop)
        began = time.perf_counter()
        try:
            with self.assertRaises(Stopped):
                signal.setitimer(signal.ITIMER_REAL, 0.05)
                allantools.theo1(x, taus="all")
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertLess(time.perf_counter() - began, 5)


if __name__ == "__main__":
    unittest.main()
