# SPDX-License-Identifier: Apache-2.0
"""Logs that are compensated and converted, and models in the formats of other programs."""
import math
import os
import pathlib
import subprocess
import tempfile
import unittest
from array import array

from command import ALONE, COMMAND

import imukit


def unit():
    model = imukit.Model(name="unit")
    model["gyro.bias.fixed"] = [0.01, -0.02, 0.03]
    model["gyro.misalignment"] = 1e-3
    model["accel.scale_factor.fixed"] = [1e-3, 2e-3, -1e-3]
    model["accel.range"] = 50.0
    return model


class Written(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.log = imukit.simulate("tactical", rate=100, duration=2, seed=1)

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_round_trip(self):
        for ending in "csv", "csv.gz", "csv.zst", "npy", "npz", "mat", "h5", "bag", "mcap", "db3":
            with self.subTest(ending):
                path = self.path(f"log.{ending}")
                self.assertEqual(imukit.write_log(path, self.log), 200)
                back = imukit.read_log(path)
                self.assertEqual(list(back), list(self.log))
                for name in self.log:
                    self.assertEqual(list(back[name]), list(self.log[name]))

    def test_units_and_decimals(self):
        first = pathlib.Path(self.path("first.csv"))
        imukit.write_log(first, self.log, to_gyro_unit="deg/h", to_accel_unit="mg")
        self.assertEqual(imukit.read_log(first).written_units["accel_z"], "mg")
        second = self.path("second.csv")
        imukit.write_log(second, first, decimals=3)
        head, row = pathlib.Path(second).read_text(encoding="utf-8").splitlines()[:2]
        self.assertIn("gyro_x [deg/h]", head)
        self.assertTrue(all(len(x.partition(".")[2]) == 3 for x in row.split(",")), row)

    def test_rate_becomes_times(self):
        rows = memoryview(array("d", range(30))).cast("B").cast("d", (10, 3))
        for data, names in (({"gyro [deg/s]": rows}, ["time", "gyro_x", "gyro_y", "gyro_z"]),
                            (rows, ["time", "a [1]", "b [1]", "c [1]"]),
                            ({"time": [0, 1, 3], "gyro_x": [1, 2, 3]}, ["time", "gyro_x"])):
            columns = ("a", "b", "c") if data is rows else None
            imukit.write_log(self.path("log.csv"), data, 4, columns=columns)
            back = imukit.read_log(self.path("log.csv"), any_columns=True)
            self.assertEqual(list(back), names)
            if len(names) > 2:
                self.assertEqual(list(back["time"]), [k / 4 for k in range(10)])
        imukit.write_log(self.path("again.csv"), back)
        self.assertEqual(list(imukit.read_log(self.path("again.csv"))["time"]), [0, 1, 3])

    def test_increments(self):
        log = imukit.simulate("tactical", rate=100, duration=1, increments=True)
        imukit.write_log(self.path("log.csv"), log)
        text = pathlib.Path(self.path("log.csv")).read_text(encoding="utf-8")
        self.assertIn("dtheta_x [rad]", text.splitlines()[0])
        self.assertEqual(float(text.splitlines()[9].split(",")[1]), log["dtheta_x"][8])

    def test_texts(self):
        pathlib.Path(self.path("log.csv")).write_text(
            "time [s],gyro_x [rad/s],section\n0,1,a\n0.01,2,a\n0.02,3,b\n", encoding="utf-8")
        imukit.write_log(self.path("copy.csv"), self.path("log.csv"))
        self.assertIn("0.02,3,b", pathlib.Path(self.path("copy.csv")).read_text(encoding="utf-8"))
        with self.assertWarnsRegex(imukit.DataWarning, "texts"):
            imukit.write_log(self.path("numbers.csv"), imukit.read_log(self.path("log.csv")))

    def test_epoch(self):
        origin = 1_700_000_000
        pathlib.Path(self.path("log.csv")).write_text(
            "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]\n" + "".join(
                f"{origin}.{k:02d},{k},1,2\n" for k in range(50)), encoding="utf-8")
        log = imukit.read_log(self.path("log.csv"))
        for data in log, self.path("log.csv"):
            imukit.write_log(self.path("log.mcap"), data)
            self.assertEqual(imukit.read_log(self.path("log.mcap")).time_origin, origin)

    def test_wrong(self):
        path = self.path("log.csv")
        imukit.write_log(path, self.log)
        before = pathlib.Path(path).read_bytes()
        for error, words, target, more in (
                (ValueError, "decimals", path, {"decimals": 18}),
                (TypeError, "", path, {"decimals": 2.5}),
                (imukit.Error, "to_gyro_unit.*angular rate", path, {"to_gyro_unit": "m"}),
                (imukit.Error, "to_accel_unit", path, {"to_accel_unit": "quux"}),
                (imukit.Error, "csv", self.path("log.xyz"), {}),
                (imukit.FileError, "absent", self.path("absent/log.csv"), {}),
                (ValueError, "file", "-", {}), (TypeError, "", 3, {}),
                (imukit.Error, "cancelled", path, {"progress": lambda *_: False})):
            with self.subTest(words, **more), self.assertRaisesRegex(error, words):
                imukit.write_log(target, self.log, **more)
        self.assertEqual(pathlib.Path(path).read_bytes(), before)
        self.assertEqual(os.listdir(self.folder), ["log.csv"])


class Compensated(unittest.TestCase):
    def test_truth_comes_back(self):
        motion = imukit.Motion.parse("imukit_motion: 1\nsteps: [rotate z 90 deg at 90 deg/s]")
        raw = imukit.simulate(unit(), 100, motion=motion)
        clean = imukit.compensate(raw, unit())
        truth = motion.truth(100)
        for name in ("gyro_x", "gyro_z", "accel_x", "accel_z"):
            self.assertEqual(clean.units[name], raw.units[name])
            for a, b in zip(clean[name], truth[name]):
                self.assertAlmostEqual(a, b, 9)
        self.assertEqual(clean.rows, raw.rows)
        self.assertAlmostEqual(clean.rate, 100, 9)
        self.assertIn("gyro.bias.fixed", clean.result.to_dict()["result"]["taken_out"])
        self.assertIn("Taken out", str(clean.result))

    def test_terms_and_flags(self):
        raw = imukit.simulate(unit(), 100, 1)
        some = imukit.compensate(raw, unit(), without="accel", flags=True)
        self.assertEqual(list(some["accel_z"]), list(raw["accel_z"]))
        self.assertNotEqual(list(some["gyro_x"]), list(raw["gyro_x"]))
        self.assertEqual(set(some["flags"]), {0.0})
        narrow = unit()
        narrow["accel.range"] = 5.0
        with self.assertWarnsRegex(imukit.DataWarning, "saturated"):
            flagged = imukit.compensate(raw, narrow, flags=True)
        self.assertEqual(set(flagged["flags"]), {1.0})

    def test_counts(self):
        model = unit()
        model.update({"gyro.sensitivity": 1e6, "accel.sensitivity": 1e6, "gyro.zero_offset": 100.0})
        clean = imukit.compensate(imukit.simulate(model, 100, 1, earth=False), model)
        self.assertEqual(clean.units["gyro_x"], "rad/s")
        self.assertAlmostEqual(clean["gyro_y"][7], 0, 5)

    @unittest.skipUnless(COMMAND.exists(), "the command is not built")
    def test_as_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            unit().save(folder / "unit.yaml")
            for line in ("simulate unit.yaml --rate 50Hz --duration 100s -o raw.csv",
                         "compensate raw.csv unit.yaml --flags -o clean.csv"):
                subprocess.run([COMMAND, *line.split()], cwd=folder, check=True,
                               capture_output=True, env=ALONE)
            due = imukit.read_log(folder / "clean.csv", any_columns=True)
            found = imukit.compensate(folder / "raw.csv", folder / "unit.yaml", flags=True)
        self.assertEqual(list(found), list(due))
        for name in due:
            for a, b in zip(found[name], due[name]):
                self.assertAlmostEqual(a, b, delta=1e-13 + 1e-14 * abs(b))

    def test_growing(self):
        raw = imukit.simulate(unit(), 1000, 30, only="gyro.bias")
        self.assertEqual(imukit.compensate(raw, unit()).rows, 30000)

    def test_refused(self):
        raw = imukit.simulate(unit(), 100, 1)
        for kind, words, given in (
                (imukit.Error, "temperature", {"temperature": -5}),
                (imukit.Error, "temperature_time", {"temperature_time": 0}),
                (imukit.Error, "powered_for", {"powered_for": -1}),
                (imukit.Error, "powered_for", {"powered_for": math.nan}),
                (ValueError, "exclude", {"only": "bias", "without": "noise"}),
                (imukit.Error, "mean", {"only": "gyro.bia"}),
                (TypeError, "only for a log", {"topic": "/imu"})):
            with self.subTest(str(given)), self.assertRaises(kind) as caught:
                imukit.compensate(raw, unit(), **given)
            self.assertIn(words, str(caught.exception))
        for data in ([1.0, 2.0], {"gyro_x": [1.0]}, 5, None, "none.csv"):
            with self.subTest(data), self.assertRaises((imukit.Error, TypeError)):
                imukit.compensate(data, unit(), 100)
        with self.assertRaises((imukit.Error, TypeError)):
            imukit.compensate(raw, 5)
        with self.assertRaises(imukit.Error) as caught:
            imukit.compensate(raw, unit(), progress=lambda *said: False)
        self.assertEqual(caught.exception.code, "IMK_ERROR_CANCELLED")

    def test_axes_of_counts(self):
        model = unit()
        model.update({"gyro.sensitivity": 1e6, "accel.sensitivity": 1e6})
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "raw.csv")
            path.write_text("time [s]," + ",".join(
                f"{s}_{a} [count]" for s in ("gyro", "accel") for a in "xyz") +
                "".join(f"\n{k / 100},1,2,3,4,5,6" for k in range(10)) + "\n")
            with self.assertRaisesRegex(imukit.Error, "signs"):
                imukit.compensate(path, model, axes="right-forward-up")


class Converted(unittest.TestCase):
    def test_select(self):
        raw = imukit.simulate("tactical", 100, 1)
        log = imukit.convert(raw, select=("gyro_z", "time"))
        self.assertEqual(list(log), ["gyro_z", "time"])
        self.assertEqual(list(log["gyro_z"]), list(raw["gyro_z"]))

    def test_gravity(self):
        raw = imukit.simulate(imukit.Model(), 100, 15, only="noise")
        with self.assertWarnsRegex(imukit.DataWarning, "attitude"):
            free = imukit.convert(raw, gravity_free=True, latitude="45 deg")
        self.assertLess(max(map(abs, free["accel_z"])), 1e-6)
        moved = imukit.convert({"time": [0.0, 0.01, 0.02], "gyro_x": [0.0] * 3, "gyro_y": [0.0] * 3,
                                "gyro_z": [2.0] * 3, "accel_x": [0.0] * 3, "accel_y": [0.0] * 3,
                                "accel_z": [0.0] * 3}, to_point=("0.5 m", 0, 0))
        self.assertAlmostEqual(moved["accel_x"][1], -2.0, 12)

    def test_refused(self):
        raw = imukit.simulate("tactical", 100, 1)
        for kind, words, given in (
                (imukit.Error, "wind", {"select": "wind"}),
                (TypeError, "latitude", {"gravity_free": True}),
                (imukit.Error, "latitude", {"gravity_free": True, "latitude": 5.0}),
                (imukit.Error, "", {"gravity_free": True, "latitude": 0.5, "still": 100}),
                (ValueError, "three", {"to_point": [1.0]}),
                (ValueError, "three", {"to_point": "1 2 3 m"}),
                (TypeError, "", {"select": 5})):
            with self.subTest(str(given)), self.assertRaises(kind) as caught:
                imukit.convert(raw, **given)
            self.assertIn(words, str(caught.exception))


class Parameters(unittest.TestCase):
    def test_round_trip(self):
        model = imukit.Model("tactical").only("gyro.noise", "accel.noise")
        for name in ("kalibr", "openvins", "gazebo", "navego", "gtsam"):
            with self.subTest(name), self.assertWarns(imukit.DataWarning):
                walk = {} if name == "gazebo" else {"bias_instability_tau": 100}
                text = model.to(name, rate=200, **walk)
                self.assertTrue(text.notes)
                if name == "gtsam":
                    continue
                again = imukit.Model.from_parameters(text=text, format=name, rate=200)
                a = again["gyro.noise.angle_random_walk"][0]
                self.assertAlmostEqual(a / model["gyro.noise.angle_random_walk"][0], 1, 6)
                self.assertIsInstance(again.notes, tuple)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder, self.assertWarns(imukit.DataWarning):
            path = pathlib.Path(folder, "imu.yaml")
            text = imukit.Model("tactical").to("kalibr", path, rate=200, bias_instability_tau=100)
            self.assertEqual(path.read_text(), text)
            self.assertEqual(len(text.notes), len(set(text.notes)))
            model = imukit.Model.from_parameters(path)
            self.assertIn("gyro.noise.angle_random_walk", model)

    def test_refused(self):
        model = imukit.Model("tactical")
        for kind, words, format, given in (
                (ValueError, "format", "matlabs", {}), (ValueError, "expected one of", "kalibr", {
                    "density": "both"}), (imukit.Error, "", "kalibr", {"rate": -1}),
                (imukit.Error, "frame", "glim", {"rate": 200}),
                (TypeError, "", "kalibr", {"rate": []}),
                (imukit.FileError, "none", "kalibr", {"path": "/none/imu.yaml", "rate": 200,
                                                      "bias_instability_tau": 1})):
            with self.subTest(format, **given), self.assertRaises(kind) as caught:
                model.to(format, **given)
            self.assertIn(words, str(caught.exception))
        for given in ({}, {"path": "a", "text": "b"}, {"text": "nothing"}, {"path": "none.yaml"},
                      {"text": "", "format": "kalibr"}, {"path": 5}):
            with self.subTest(str(given)), self.assertRaises((imukit.Error, TypeError)):
                imukit.Model.from_parameters(**given)


if __name__ == "__main__":
    unittest.main()
