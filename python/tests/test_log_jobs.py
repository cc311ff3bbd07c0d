# SPDX-License-Identifier: Apache-2.0
"""Spectra, a first look, and identification of several records, compared with the command."""
import array
import csv
import math
import os
import pickle
import random
import tempfile
import unittest
import warnings

import command
import imukit


def setUpModule():
    global FOLDER
    FOLDER = tempfile.TemporaryDirectory()
    for seed in (1, 2):
        command.run(FOLDER.name, "simulate", "ADIS16488", "--duration", "30s", "--rate", "100Hz",
                    "--seed", seed, "-o", f"run{seed}.csv")


def tearDownModule():
    FOLDER.cleanup()


def white(count, sigma=1e-3, seed=1):
    draw = random.Random(seed)
    return array.array("d", (draw.gauss(0, sigma) for _ in range(count)))


class InFolder(command.SameAsCommand):
    def setUp(self):
        self.folder = FOLDER.name
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        silent = warnings.catch_warnings()
        silent.__enter__()
        self.addCleanup(silent.__exit__, None, None, None)
        warnings.simplefilter("ignore", imukit.DataWarning)


class Same(InFolder):
    def test_spectrum(self):
        result = imukit.spectrum("run1.csv", resolution="0.5 Hz", density="one-sided",
                                 window="kaiser", trend=True, to=40)
        self.same(result, "spectrum", "run1.csv", "--resolution", "0.5Hz", "--density",
                  "one-sided", "--window", "kaiser", "--trend", "--to", "40Hz")
        command.run(self.folder, "spectrum", "run1.csv", "--resolution", "0.5Hz", "--density",
                    "one-sided", "--window", "kaiser", "--trend", "-o", "s.csv")
        with open("s.csv", encoding="utf-8") as file:
            rows = [row for row in list(csv.reader(file))[1:] if row[0] == "accel_y"]
        curve = result.curve("accel_y")
        self.assertEqual([float(row[1]) for row in rows], list(curve.frequency))
        for row, density, lower in zip(rows, curve.density, curve.lower):
            self.assertTrue(math.isclose(float(row[2]), density, rel_tol=1e-12))
            self.assertTrue(math.isclose(float(row[3]), lower, rel_tol=1e-12))

    def test_info(self):
        self.same(imukit.info("run1.csv"), "info", "run1.csv", without=("next",))
        with open("bare.csv", "w", encoding="utf-8") as file:
            file.write("time,gyro_x\n0,1\n0.1,2\n0.2,4\n")
        result = imukit.info("bare.csv")
        self.same(result, "info", "bare.csv", without=("next",))
        self.assertIn("IMK_ERROR_UNIT_MISSING", {f.code for f in result.findings})

    def test_identify(self):
        result = imukit.identify("run1.csv", truth="ADIS16488", twin=True, seed=3)
        self.same(result, "identify", "run1.csv", "--truth", "ADIS16488", "--twin", "--seed", 3)
        command.run(self.folder, "identify", "run1.csv", "-o", "m.yaml", "--into", "ADIS16488")
        into = imukit.identify("run1.csv", into="ADIS16488", name=imukit.Model("m.yaml")["name"])
        self.assertEqual(into.model, imukit.Model("m.yaml"))

    def test_text_names_no_options(self):
        for verbose in (False, True):
            text = str(imukit.identify("run1.csv", verbose=verbose))
            self.assertNotIn("--", text)
            self.assertEqual("Details: verbose" in text or "details: verbose" in text, not verbose)

    def test_identify_several(self):
        runs = imukit.identify_runs(["run1.csv", "run2.csv"])
        self.same(runs, "identify", "run1.csv", "run2.csv", "--runs")
        self.assertTrue(runs.estimates["gyro_x"]["angle_random_walk"].present)
        self.assertIn("angle_random_walk", runs.model.yaml())
        devices = imukit.identify_devices(["run1.csv", "run2.csv"])
        self.same(devices, "identify", "run1.csv", "run2.csv", "--devices")
        self.assertIsNone(devices.model)
        self.assertEqual(devices.estimates, {})

    def test_curve(self):
        with open("curve.csv", "w", encoding="utf-8") as file:
            file.write("tau [s],gyro_x [deg/h]\n")
            for k in range(12):
                tau = 0.01 * 2 ** k
                file.write(f"{tau},{math.hypot(20 / math.sqrt(tau), 5)}\n")
        result = imukit.identify_curve("curve.csv", 100, "1 h", gauss_markov=1)
        self.same(result, "identify", "curve.csv", "--curve", "--rate", "100Hz", "--duration", "1h",
                  "--gauss-markov", 1)

    def test_plan(self):
        plan = imukit.plan_record("ADIS16488", "100 Hz", want="bias_instability 5%")
        self.same(plan, "identify", "--plan", "ADIS16488", "--rate", "100Hz", "--want",
                  "bias_instability 5%")
        again = pickle.loads(pickle.dumps(plan))
        self.assertEqual((again.duration, again.met), (plan.duration, True))
        self.assertIn("<svg", plan._repr_html_())


class Spectrum(unittest.TestCase):
    def test_line(self):
        x = [v + 0.01 * math.sin(2 * math.pi * 12.5 * k / 100)
             for k, v in enumerate(white(20000))]
        result = imukit.spectrum(x, 100, columns="gyro_x")
        line, = result.lines
        self.assertAlmostEqual(line.frequency, 12.5, delta=6 * line.frequency_sigma)
        self.assertAlmostEqual(line.amplitude, 0.01, delta=6 * line.amplitude_sigma)
        self.assertEqual((line.name, line.unit), ("gyro_x", "rad/s"))
        again = pickle.loads(pickle.dumps(result))
        self.assertEqual(list(again.curve().density), list(result.curve().density))
        self.assertTrue(result.estimates("gyro_x")["angle_random_walk"].present)

    def test_sides(self):
        one = imukit.spectrum(white(2000), 100, density="one-sided").curve()
        two = imukit.spectrum(white(2000), 100).curve()
        self.assertAlmostEqual(one.density[5] / two.density[5], 2, 12)

    def test_refused(self):
        x = white(1000)
        refused = [(ValueError, {"method": "periodogram"}), (ValueError, {"density": "both"}),
                   (ValueError, {"gaps": "keep"}), (imukit.Error, {"from_": 60}),
                   (imukit.Error, {"from_": 20, "to": 10}), (imukit.Error, {"from_": math.nan}),
                   (imukit.Error, {"to": math.nan}), (imukit.Error, {"resolution": -1}),
                   (imukit.Error, {"resolution": 1e-6}), (imukit.Error, {"resolution": "1 m"}),
                   (imukit.Error, {"false_alarm": 0}), (imukit.Error, {"confidence": math.nan}),
                   (TypeError, {"trend": None, "no": 1}), (TypeError, {"to": []})]
        for kind, named in refused:
            with self.subTest(named), self.assertRaises(kind):
                imukit.spectrum(x, 100, **named)
        for data in ([], [1.0] * 1000, x[:20], None):
            with self.subTest(str(data)[:20]), self.assertRaises((TypeError, ValueError)):
                imukit.spectrum(data, 100)
        with self.assertRaises(KeyError):
            imukit.spectrum(x, 100).curve("y")


class Info(unittest.TestCase):
    def test_arrays(self):
        result = imukit.info({"gyro_x": [0.0, 1.0, math.nan, 1.0]}, 10)
        self.assertEqual((result.rate, result.record.not_finite), (10, 1))
        self.assertEqual(result.columns["gyro_x"].name, "gyro_x")

    def test_refused(self):
        for data in ("no_such_file.csv", [], None, 5, [object()]):
            with self.subTest(data), self.assertRaises((TypeError, ValueError)):
                imukit.info(data, 10)
        with self.assertRaises(TypeError):
            imukit.info([1.0, 2.0], 10, topic="/imu")


class Several(unittest.TestCase):
    def test_refused(self):
        x = white(2000)
        for data in ([x], [], [x, white(2000), [1.0]], "a.csv", None, [x] * 65, [x, None]):
            with self.subTest(str(data)[:20]), self.assertRaises((TypeError, ValueError)):
                imukit.identify_runs(data, 100)
        with self.assertRaisesRegex(imukit.Error, "channels"):
            imukit.identify_devices([x, {"a": x, "b": white(2000, seed=2)}], 100)

    def test_same_record_twice(self):
        with self.assertRaisesRegex(imukit.Error, "record 2.*earlier record"):
            imukit.identify_devices([white(2000), white(2000)], 100)
        log = imukit.identify_devices([white(2000), white(2000, seed=2)], 100)
        self.assertEqual(len(log.logs), 2)

    def test_endings_refused(self):
        x = white(2000)
        for named in ({"into": "no such part"}, {"truth": "none.yaml"}, {"seed": -1},
                      {"into": {"gyro": {"direction": "[1 0 0]"}}, "columns": "accel_x"}):
            with self.subTest(named), self.assertRaises((ValueError, OverflowError)):
                imukit.identify(x, 100, **named)

    def test_curve_refused(self):
        table = {"tau [s]": [0.01, 0.02, 0.04, 0.08, 0.16], "gyro_x": [1, 0.7, 0.5, 0.35, 0.25]}
        for named in ({"duration": math.nan}, {"duration": -1}, {"rate": 0}, {"tolerance": 2},
                      {"confidence": 5}, {"gauss_markov": 99}):
            with self.subTest(named), self.assertRaises(ValueError):
                imukit.identify_curve(table, **{"rate": 100, "duration": 100, **named})
        with self.assertRaises(imukit.Error):
            imukit.identify_curve({"gyro_x": white(10)}, 100, 100)

    def test_plan_refused(self):
        for named in ({"want": "bias_instability"}, {"want": "no_such 5%"}, {"duration": math.nan},
                      {"significance": 0.9}, {"rate": 0}, {"rate": "1 m"}):
            with self.subTest(named), self.assertRaises(ValueError):
                imukit.plan_record("ADIS16488", **{"rate": 100, **named})
        with self.assertRaises(imukit.Error):
            imukit.plan_record({"gyro": {}}, 100)


if __name__ == "__main__":
    unittest.main()
