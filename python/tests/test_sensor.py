# SPDX-License-Identifier: Apache-2.0
"""Sensors that are stepped."""
import array
import copy
import math
import unittest

import imukit

try:
    import numpy
except ImportError:
    numpy = None

GRAVITY = [0.0, 0.0, -9.8]


class Steps(unittest.TestCase):
    def test_same_seed_same_readings(self):
        one, two = (imukit.Sensor("tactical", 100, seed=3) for _ in range(2))
        for k in range(600):
            w = [0.1 * math.sin(0.01 * k), 0.0, 0.2]
            self.assertEqual(list(one.step(w, GRAVITY)),
                             list(two.step(array.array("d", w), array.array("d", GRAVITY))))

    def test_several_are_runs(self):
        several = imukit.Sensor("AHRS", 100, seed=5, run=2, count=4)
        alone = [imukit.Sensor("AHRS", 100, seed=5, run=2 + i) for i in range(4)]
        rate = memoryview(array.array("d", [0.1 * i for i in range(12)])).cast("B").cast("d", (3, 4))
        for _ in range(520):
            found = memoryview(several.step(rate, GRAVITY)).tolist()
            for i, sensor in enumerate(alone):
                due = sensor.step([rate[k, i] for k in range(3)], GRAVITY)
                self.assertEqual([channel[i] for channel in found], list(due))

    def test_out_is_written(self):
        sensor = imukit.Sensor("AHRS", 100)
        out = array.array("d", [0.0] * 6)
        self.assertIs(sensor.step([0, 0, 0], GRAVITY, out=out), out)
        self.assertNotEqual(out[2], 0.0)

    def test_not_a_number(self):
        bad, good = (imukit.Sensor("tactical", 100, seed=1) for _ in range(2))
        reading = bad.step([math.nan, 0, 0], GRAVITY)
        self.assertTrue(math.isnan(reading[0]))
        good.step([0, 0, 0], GRAVITY)
        self.assertTrue(all(math.isfinite(x) for x in bad.step([0, 0, 0], GRAVITY)))

    def test_temperature(self):
        sensor = imukit.Sensor("tactical", 100, temperature=True)
        sensor.step([0, 0, 0], GRAVITY, temperature=300.0, temperature_rate=0.1)
        with self.assertRaisesRegex(ValueError, "needs one"):
            sensor.step([0, 0, 0], GRAVITY)
        with self.assertRaisesRegex(ValueError, "temperature=True"):
            imukit.Sensor("tactical", 100).step([0, 0, 0], GRAVITY, temperature=300.0)

    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_arrays_of_numpy(self):
        sensor = imukit.Sensor("tactical", 100, count=100, temperature=True)
        found = sensor.step(numpy.zeros((3, 100)), numpy.array(GRAVITY),
                            temperature=numpy.linspace(280, 320, 100))
        self.assertEqual(found.shape, (6, 100))
        with self.assertRaises(ValueError):
            sensor.step(numpy.zeros((100, 3)), numpy.array(GRAVITY), temperature=300.0)

    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_what_is_converted(self):
        rates = numpy.arange(24.0).reshape(3, 8) / 16
        wide = numpy.zeros((3, 16))
        wide[:, ::2] = rates
        due = imukit.Sensor("tactical", 100, count=8).step(rates, GRAVITY)
        for given in (rates.astype("f4"), wide[:, ::2], numpy.asfortranarray(rates), rates.tolist(),
                      rates.T.copy().T, rates.astype(">f8"), list(rates)):
            sensor = imukit.Sensor("tactical", 100, count=8)
            numpy.testing.assert_array_equal(sensor.step(given, GRAVITY), due)
        sensor = imukit.Sensor("tactical", 100, temperature=True)
        sensor.step(numpy.zeros(3, int), numpy.float32(GRAVITY), temperature=numpy.float32(300))
        for wrong in (rates.T, rates + 1j, rates.astype(str), [[0], [0, 1], [2]], numpy.zeros(0)):
            with self.assertRaises((TypeError, ValueError)):
                imukit.Sensor("tactical", 100, count=8).step(wrong, GRAVITY)
        for out in (numpy.zeros((6, 8), "f4"), numpy.zeros((6, 16))[:, ::2],
                    numpy.zeros((8, 6)).T):
            with self.assertRaises((ValueError, BufferError)):
                imukit.Sensor("tactical", 100, count=8).step(rates, GRAVITY, out=out)

    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_masked(self):
        sensor = imukit.Sensor("tactical", rate=100, seed=1)
        rates = numpy.ma.masked_array(numpy.zeros(3), [True, False, False])
        self.assertTrue(numpy.isnan(sensor.step(rates, numpy.array(GRAVITY))[0]))
        self.assertFalse(numpy.isnan(sensor.step(numpy.zeros(3), numpy.array(GRAVITY))).any())

    def test_what_is_converted_without_numpy(self):
        due = list(imukit.Sensor("tactical", 100).step([0, 0.5, 0.25], GRAVITY))
        single = array.array("f", [0, 0.5, 0.25])
        for given in ((single, GRAVITY), ((0, 0.5, 0.25), GRAVITY), ([0, 0.5, 0.25, *GRAVITY],),
                      (memoryview(array.array("d", [0, 9, 0.5, 9, 0.25, 9]))[::2], GRAVITY)):
            self.assertEqual(list(imukit.Sensor("tactical", 100).step(*given)), due)
        rows = [[0, 0.5], [0.5, 0.25], [1, 2]]
        due = imukit.Sensor("tactical", 100, count=2).step(
            memoryview(array.array("d", sum(rows, []))).cast("B").cast("d", (3, 2)), GRAVITY)
        for given in (rows, [array.array("f", row) for row in rows]):
            found = imukit.Sensor("tactical", 100, count=2).step(given, GRAVITY)
            self.assertEqual(memoryview(found).tolist(), memoryview(due).tolist())
        for wrong in ([0] * 5, [0] * 3, [[0] * 6]):
            with self.assertRaises((TypeError, ValueError)):
                imukit.Sensor("tactical", 100).step(wrong)


class Refused(unittest.TestCase):
    def test_arguments(self):
        for kind, arguments, named in ((imukit.Error, ("tactical", 0), {}),
                                       (imukit.Error, ("no such model", 100), {}),
                                       (imukit.Error, ("tactical", "1 deg"), {}),
                                       (ValueError, ("tactical", 100), {"count": -1}),
                                       (imukit.Error, ("tactical", 100), {"count": 0}),
                                       (TypeError, ("tactical", None), {}),
                                       (TypeError, ("tactical", 100), {"run": "x"})):
            with self.subTest(arguments=arguments, named=named), self.assertRaises(kind):
                imukit.Sensor(*arguments, **named)

    def test_steps(self):
        sensor = imukit.Sensor("tactical", 100)
        for truth in (([0, 0], GRAVITY), ([0, 0, 0, 0], GRAVITY), ("abc", GRAVITY), (5, GRAVITY),
                      ([0, 0, 0], [None] * 3), (b"12345678" * 3, GRAVITY)):
            with self.subTest(truth), self.assertRaises((TypeError, ValueError)):
                sensor.step(*truth)
        for out in (array.array("d", [0] * 5), array.array("f", [0] * 6), bytes(48), 3):
            with self.subTest(out=out), self.assertRaises((TypeError, ValueError, BufferError)):
                sensor.step([0, 0, 0], GRAVITY, out=out)
        with self.assertRaises(IndexError):
            sensor.dropped(3, 1)


class Stated(unittest.TestCase):
    def test_what_is_no_argument(self):
        for make in (lambda: imukit.Sensor(None, 100), lambda: imukit.Sensor("AHRS", 100, seed=None),
                     lambda: imukit.Sensor("AHRS", 100).step(None, GRAVITY),
                     lambda: imukit.Sensor("AHRS", 100).step([0, 0, 0], None),
                     lambda: copy.copy(imukit.Sensor("AHRS", 100)),
                     lambda: copy.deepcopy(imukit.Sensor("AHRS", 100))):
            with self.assertRaises(TypeError):
                make()
        for named in ({"seed": -1}, {"run": -1}, {"count": -1}):
            with self.assertRaisesRegex(ValueError, f"{[*named][0]}=-1"):
                imukit.Sensor("AHRS", 100, **named)
        self.assertIn("the model", repr(imukit.Sensor(imukit.Model(), 100)))

    def test_shape_of_out(self):
        flat = array.array("d", bytes(8 * 24))
        several = imukit.Sensor("AHRS", 100, count=4)
        for out in (flat, memoryview(flat).cast("B").cast("d", (4, 6))):
            with self.assertRaisesRegex(ValueError, r"\(6, 4\)"):
                several.step([0, 0, 0], GRAVITY, out=out)
        several.step([0, 0, 0], GRAVITY, out=memoryview(flat).cast("B").cast("d", (6, 4)))
        with self.assertRaisesRegex(ValueError, "temperature_rate"):
            several.step([0, 0, 0], GRAVITY, temperature_rate=1.0)


if __name__ == "__main__":
    unittest.main()
