# SPDX-License-Identifier: Apache-2.0
"""Allan deviations of arrays, and what is no array of numbers."""
import array
import math
import pickle
import random
import tempfile
import unittest

import imukit


def noise(count, seed=1):
    draw = random.Random(seed)
    return array.array("d", (draw.gauss(0, 1) for _ in range(count)))


class Values(unittest.TestCase):
    def test_definition(self):
        x = noise(1000)
        curve = imukit.allan(x, 1).curve()
        for m, deviation in zip((1, 2, 4), curve.deviation):
            means = [sum(x[i:i + m]) / m for i in range(len(x) - m + 1)]
            squares = [(means[i + m] - means[i]) ** 2 for i in range(len(x) - 2 * m + 1)]
            self.assertAlmostEqual(deviation, math.sqrt(sum(squares) / len(squares) / 2), 12)

    def test_forms_of_data(self):
        x = noise(500)
        due = list(imukit.allan(x, 10).curve().deviation)
        rows = array.array("d", (v for a, b in zip(x, noise(500, 2)) for v in (a, b)))
        matrix = memoryview(rows).cast("B").cast("d", (500, 2))
        forms = {"list": list(x), "memoryview": memoryview(x), "dict": {"x": x},
                 "list of columns": [x], "every second": memoryview(rows)[::2],
                 "backwards": memoryview(array.array("d", reversed(x)))[::-1]}
        for name, data in forms.items():
            with self.subTest(name):
                self.assertEqual(list(imukit.allan(data, 10).curve().deviation), due)
        both = imukit.allan(matrix, 10, columns=("a", "b"))
        self.assertEqual(list(both.curve("a").deviation), due)

    def test_matrix_of_axes(self):
        x = noise(900)
        apart = {f"gyro_{axis} [deg/s]": x[k::3] for k, axis in enumerate("xyz")}
        due = imukit.allan(apart, 10)
        for code in "df":
            rows = memoryview(array.array(code, x)).cast("B").cast(code, (300, 3))
            found = imukit.allan({"gyro [deg/s]": rows}, 10)
            for axis in apart:
                name = axis.split()[0]
                for a, b in zip(found.curve(name).deviation, due.curve(name).deviation):
                    self.assertAlmostEqual(a / b, 1, 12 if code == "d" else 6)
        single = memoryview(x).cast("B").cast("d", (900, 1))
        self.assertEqual(list(imukit.allan({"x": single}, 10).curve().deviation),
                         list(imukit.allan({"x": x}, 10).curve().deviation))
        for shape in (450, 2), (3, 300), (100, 3, 3):
            with self.subTest(shape), self.assertRaisesRegex(ValueError, "shape"):
                imukit.allan({"gyro": memoryview(x).cast("B").cast("d", shape)}, 10)
        with self.assertRaisesRegex(ValueError, "dictionary"):
            imukit.allan([memoryview(x).cast("B").cast("d", (300, 3))] * 2, 10)

    def test_axes_of_a_log(self):
        log = imukit.simulate("tactical", rate=10, duration=3, seed=1)
        matrix = log["accel"]
        self.assertEqual(matrix.shape, (30, 3))
        self.assertEqual([matrix[k, 2] for k in range(30)], list(log["accel_z"]))
        self.assertEqual(log["gyro"][0, 1], log["gyro_y"][0])

    def test_number_types(self):
        numbers = [k * k % 101 for k in range(400)]
        due = list(imukit.allan([float(k) for k in numbers], 1).curve().deviation)
        for code in "bBhHiIlLqQfd":
            with self.subTest(code):
                found = imukit.allan(array.array(code, numbers), 1).curve().deviation
                self.assertEqual(list(found), due)

    def test_units(self):
        x = noise(300)
        degrees = imukit.allan(x, 1, columns="gyro_x [deg/s]").curve()
        self.assertAlmostEqual(degrees.deviation[0] / imukit.allan(x, 1).curve().deviation[0],
                               math.pi / 180, 12)
        self.assertEqual(degrees.unit, "rad/s")
        self.assertEqual(list(imukit.allan(x, "0.1 kHz").curve().tau),
                         list(imukit.allan(x, 100).curve().tau))

    def test_missing_samples(self):
        x = noise(300)
        x[100] = math.nan
        with self.assertWarnsRegex(imukit.DataWarning, "not a finite number"):
            result = imukit.allan(x, 1)
        self.assertLess(min(result.curve().used), 1)


class Refused(unittest.TestCase):
    def refused(self, kind, words, *arguments, **named):
        with self.assertRaises(kind) as caught:
            imukit.allan(*arguments, **named)
        self.assertIn(words, str(caught.exception))
        return caught.exception

    def test_data(self):
        x = noise(100)
        self.refused(imukit.Error, "a rate in Hz", x)
        self.refused(imukit.Error, "no data", [], 1)
        self.refused(imukit.Error, "too few", [1.0, 2.0], 1)
        self.refused(ValueError, "column 1 has 3 rows", [x, [1.0, 2.0, 3.0]], 1)
        self.refused(ValueError, "3 names", [x, x], 1, columns=("a", "b", "c"))
        self.refused(ValueError, "transposed", memoryview(bytes(8 * 200)).cast("d", (1, 200)), 1)
        self.refused(TypeError, "", [object()], 1)
        self.refused(TypeError, "", 5, 1)
        self.refused(TypeError, "", ["a", "b"], 1)
        self.refused(TypeError, "convert", array.array("u", "abc"), 1)

    def test_settings(self):
        x = noise(100)
        self.refused(ValueError, "oadev", x, 1, statistic="odev")
        self.refused(ValueError, "twice", x, 1, statistic=("oadev", "oadev"))
        self.refused(ValueError, "expected one of", x, 1, tau="octaves")
        self.refused(ValueError, "expected one of", x, 1, gaps="fill")
        self.refused(imukit.Error, "confidence", x, 1, confidence=2)
        self.refused(imukit.Error, "averaging times", x, 1, tau=[1000.0])
        self.refused(TypeError, "only for a log", x, 1, topic="/imu")
        self.refused(imukit.Error, "deg/s", x, "1 deg/s")
        self.refused(ValueError, "threads", x, 1, threads=-1)

    def test_options_are_arguments(self):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("gyro_x [deg/s]\n1\n2\n3\n")
            file.flush()
            self.refused(imukit.Error, "add rate=RATE (samples per second, as in rate='100Hz'",
                         file.name)
            self.assertEqual(imukit.read_log(file.name, rate="100Hz").rows, 3)

    def test_error_is_whole(self):
        error = self.refused(imukit.FileError, "no_such.csv", "no_such.csv")
        self.assertEqual(error.code, "IMK_ERROR_OPEN")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.code), (str(error), error.code))
        self.assertIsInstance(error, OSError)
        self.assertIsInstance(error, ValueError)


class Work(unittest.TestCase):
    def test_progress(self):
        seen = []
        imukit.allan(noise(1000), 1, progress=lambda *said: seen.append(said))
        self.assertTrue(seen)
        stage, unit, done, total = seen[0]
        self.assertIsInstance(stage, str)
        self.assertLessEqual(done, total)
        with self.assertRaises(imukit.Error) as caught:
            imukit.allan(noise(1000), 1, progress=lambda *said: False)
        self.assertEqual(caught.exception.code, "IMK_ERROR_CANCELLED")

    def test_exception_in_progress(self):
        def fail(*said):
            raise LookupError("by the caller")
        with self.assertRaisesRegex(LookupError, "by the caller"):
            imukit.allan(noise(1000), 1, progress=fail)

    def test_result(self):
        result = imukit.allan(noise(1000), 1)
        again = pickle.loads(pickle.dumps(result))
        self.assertEqual(repr(again), repr(result))
        self.assertEqual(again.to_dict(), result.to_dict())
        self.assertIn("<svg", result._repr_html_())
        self.assertIn("<html", result.page())
        self.assertEqual(result.to_dict()["command"], "allan")


if __name__ == "__main__":
    unittest.main()
