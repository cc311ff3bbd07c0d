# SPDX-License-Identifier: Apache-2.0
"""Navigation by simulated logs."""
import array
import pathlib
import pickle
import subprocess
import tempfile
import unittest
import warnings

from command import ALONE, COMMAND, command_json, python_json

import imukit

DRIVE = """imukit_motion: 1
start: {latitude: 45 deg, longitude: 7 deg, height: 300 m, heading: 90 deg}
steps:
  - hold 30 s
  - accelerate to 15 m/s at 2 m/s^2
  - hold 10 s
  - turn right 90 deg at 15 deg/s
  - hold 20 s
"""
UNIT = """imukit: 1
gyro: {bias: {repeatability: 1 deg/h}, noise: {angle_random_walk: 0.1 deg/sqrt(h)}}
accel: {bias: {repeatability: 0.5 mg}, noise: {density: two-sided, velocity_random_walk: 50 ug/sqrt(Hz)}}
"""
PLACE = "45 deg, 7 deg, 300 m"
START = {"position": PLACE, "align": 25, "heading": "91 +- 2 deg"}
WORDS = ["--position", PLACE, "--align", "25s", "--heading", "91 +- 2 deg"]


class Drive(unittest.TestCase):
    """A drive with a GNSS receiver, simulated by the command."""

    @classmethod
    def setUpClass(cls):
        if not COMMAND.exists():
            raise unittest.SkipTest("the command is not built")
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        at = cls.at = pathlib.Path(cls.folder.name)
        (at / "drive.yaml").write_text(DRIVE, encoding="utf-8")
        (at / "unit.yaml").write_text(UNIT, encoding="utf-8")
        subprocess.run([COMMAND, "simulate", "unit.yaml", "--motion", "drive.yaml", "--rate", "50Hz",
                        "--seed", "4", "--truth", "truth.csv", "-o", "drive.csv", "--aid",
                        "position 1 1 2 m, velocity 0.05 m/s", "--aid-lever-arm", "1 -0.5 -1.5 m",
                        "--aid-output", "gnss.csv"], cwd=at, check=True,
                       capture_output=True, env=ALONE)
        cls.truth = imukit.read_log(at / "truth.csv", any_columns=True)

    def setUp(self):
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("ignore", imukit.DataWarning)

    def test_as_the_command(self):
        log, model = self.at / "drive.csv", self.at / "unit.yaml"
        aided = ["--model", model, "--aid", self.at / "gnss.csv", "--aid-lever-arm",
                 "1 -0.5 -1.5 m", "--smooth"]
        for words, arguments in (
                ([], {}),
                (["--model", model, "--zero-velocity", "40s", "--stop", "1s", "--vertical", "free",
                  "--coning", "2", "--interval", "2s"],
                 {"model": model, "zero_velocity": 40, "stop": 1, "vertical": "free", "coning": 2,
                  "interval": 2}),
                (aided, {"model": model, "aids": self.at / "gnss.csv", "smooth": True,
                         "aid_lever_arm": (1, -0.5, -1.5)}),
                ([*aided, "--aid-sigma", "position 2 m", "--aid-until", "60s", "--aid-interval",
                  "2s", "--aid-delay", "0.01s"],
                 {"model": model, "aids": self.at / "gnss.csv", "smooth": True,
                  "aid_lever_arm": "1 -0.5 -1.5 m", "aid_sigma": "position 2 m", "aid_until": 60,
                  "aid_interval": 2, "aid_delay": "10 ms"})):
            with self.subTest(words):
                self.assertEqual(python_json(imukit.navigate(log, **START, **arguments)),
                                 command_json("navigate", log, *WORDS, *words))

    def test_track_is_the_truth(self):
        result = imukit.navigate(self.at / "drive.csv", self.at / "unit.yaml", **START, smooth=True,
                                 aids=self.at / "gnss.csv", aid_lever_arm="1 -0.5 -1.5 m")
        track = result.track
        at = [min(round(t * 50), self.truth.rows - 1) for t in track.time.tolist()]
        for name, sigma, unit in (("latitude", "north", 6378e3), ("height", "down", 1.0),
                                  ("yaw", "attitude_down", 1.0)):
            found, true = getattr(track, name).tolist(), self.truth[name]
            sigmas = getattr(track, f"sigma_{sigma}").tolist()
            for k in range(5, len(at)):
                # 50 rows and 3 names: a normal number is beyond 6 sigmas once in 3e6 such tests;
                # a row and the truth are at most half a sample apart, 0.15 m
                self.assertLess(abs(found[k] - true[at[k]]) * unit,
                                6 * sigmas[k] + (0.2 if unit > 1 else 0.02), (name, k))
        self.assertLess(track.sigma_north.tolist()[30], result.filtered.sigma_north.tolist()[30])
        self.assertEqual({i.kind for i in result.innovations}, {"position", "velocity"})
        position = result.innovations[0]
        self.assertEqual(len(position.time), len(position.verdict))
        self.assertGreater(position.verdict.count("used"), 40)
        self.assertLess(max(abs(x) for x in position.axes[0].tolist()), 6)
        copy = pickle.loads(pickle.dumps(result))
        self.assertEqual(copy.track.yaw.tolist(), track.yaw.tolist())
        self.assertIn("<svg", result.figure())

    def test_arrays_are_the_log(self):
        log, gnss = imukit.read_log(self.at / "drive.csv"), imukit.read_log(self.at / "gnss.csv",
                                                                         any_columns=True)
        arm = {"aid_lever_arm": "1 -0.5 -1.5 m"}
        due = imukit.navigate(self.at / "drive.csv", self.at / "unit.yaml", **START, **arm,
                              aids=self.at / "gnss.csv")
        plain = {f"{name} [{gnss.units[name]}]": list(gnss[name]) for name in gnss}
        sensors = {name: array.array("d", log[name]) for name in log}
        for data, aids in ((log, gnss), (sensors, plain)):
            result = imukit.navigate(data, imukit.Model(self.at / "unit.yaml"), **START, **arm,
                                     aids=aids)
            for name in ("latitude", "sigma_north", "yaw"):
                self.assertEqual(getattr(result.track, name).tolist(),
                                 getattr(due.track, name).tolist())


class Wrong(unittest.TestCase):
    data = {name: [value] * 500 for name, value in
            (("gyro_x", 0.0), ("gyro_y", 0.0), ("gyro_z", 0.0), ("accel_x", 0.0), ("accel_y", 0.0),
             ("accel_z", -9.8062))}
    start = {"rate": 100, "position": PLACE, "attitude": "0 0 0 deg"}

    def setUp(self):
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("ignore", imukit.DataWarning)

    def test_no_model(self):
        track = imukit.navigate(self.data, **self.start).track
        # The first reading is the mean over the sample before its time.
        self.assertEqual([round(t, 9) for t in track.time.tolist()],
                         [-0.01, 0.99, 1.99, 2.99, 3.99, 4.99])
        self.assertIsNone(track.sigma_north)
        self.assertEqual(imukit.navigate(self.data, **self.start).innovations, ())

    def test_aids_as_columns(self):
        data = {**self.data, "time": [k / 100 for k in range(500)],
                "baro_height [m]": [300 + k % 3 for k in range(500)]}
        start = {key: value for key, value in self.start.items() if key != "rate"}
        result = imukit.navigate(data, "tactical", **start, aids=data, aid_sigma="height 1 m")
        self.assertEqual([i.kind for i in result.innovations], ["height"])
        self.assertGreater(result.innovations[0].verdict.count("used"), 400)

    def test_arguments(self):
        nan = float("nan")
        readings = {"time": [1.0, 2.0], "height [m]": [300.0, 300.0]}
        aided = {"model": "tactical", "aids": readings, "aid_sigma": "height 1 m"}
        for error, words, arguments in (
                (ValueError, "attitude at the start", {"attitude": None}),
                (ValueError, "leave one out", {"align": 3}),
                (ValueError, "part of attitude", {"heading": 1}),
                (ValueError, "for align", {"align_method": "means"}),
                (ValueError, "aligns itself", {"attitude": None, "align": 2, "velocity": [1, 0, 0]}),
                (ValueError, "zero_velocity with a time", {"stop": 1}),
                (ValueError, "is for zero_velocity", {"still_rotation": 1}),
                (ValueError, "about aids", {"aid_sigma": "height 1 m"}),
                (ValueError, "give a model", {"aids": readings}),
                (ValueError, "give a model", {"zero_velocity": 1}),
                (imukit.Error, "model", {"smooth": True}),
                (imukit.Error, "alignment", {"model": "tactical", "zero_velocity": "auto"}),
                (ValueError, "latitude, longitude and height", {"position": "45 deg, 7 deg"}),
                (ValueError, "latitude, longitude and height", {"position": 3}),
                (imukit.Error, "no unit|unit", {"position": "45, 7, 300"}),
                (imukit.Error, "latitude", {"position": (2, 0, 0)}),
                (imukit.Error, "longitude", {"position": (0, 9, 0)}),
                (imukit.Error, "height", {"position": (0, 0, nan)}),
                (imukit.Error, "latitude", {"position": (nan, 0, 0)}),
                (TypeError, "", {"position": (None, 0, 0)}),
                (imukit.Error, "attitude", {"attitude": (0, 2, 0)}),
                (imukit.Error, "attitude", {"attitude": (nan, 0, 0)}),
                (ValueError, "three numbers", {"attitude": (1, 2)}),
                (ValueError, "leave one out", {"attitude": "1 2 3 +- 1 deg", "attitude_sigma": 1}),
                (imukit.Error, "position_sigma", {"position_sigma": -1}),
                (imukit.Error, "height is held", {"velocity": (0, 0, 1)}),
                (imukit.Error, "velocity", {"velocity": (nan, 0, 0)}),
                (imukit.Error, "interval", {"interval": 0}),
                (imukit.Error, "coning|samples", {"coning": 9}),
                (ValueError, "gaps", {"gaps": "x"}),
                (ValueError, "vertical", {"vertical": "x"}),
                (imukit.Error, "rate", {"rate": None}),
                (imukit.Error, "standard_gravity", {"standard_gravity": 10}),
                (imukit.Error, "table", {**aided, "aid_sigma": "height 1 m at 1 Hz until 60 s"}),
                (imukit.Error, "twice", {**aided, "aid_sigma": ["height 1 m", "height 2 m"]}),
                (imukit.Error, "did you mean", {**aided, "aid_sigma": "heigth 1 m"}),
                (imukit.Error, "sigma", {**aided, "aid_sigma": None}),
                (imukit.Error, "no_such", {**aided, "aids": "no_such.csv"}),
                (imukit.Error, "the aids: the readings are from 100", {**aided, "aids": {
                    "time": [100.0, 200.0], "height [m]": [3.0, 3.0]}}),
                (imukit.Error, "time|rate", {**aided, "aids": {"height [m]": [3.0, 3.0]}}),
                (TypeError, "file", {"map": "a=b"}),
                (TypeError, "progress", {"progress": 3})):
            with self.subTest(arguments), self.assertRaisesRegex(error, words):
                imukit.navigate(self.data, **{**self.start, **arguments})

    def test_data(self):
        for data in ({**self.data, "accel_z": [-9.8] * 499}, {"gyro_x": [0.0] * 500}, {}, [],
                     [1.0, 2.0], {**self.data, "gyro_x": ["a"] * 500}, "no_such.csv", None,
                     {**self.data, "gyro_x": [float("nan")] * 500},
                     {name: values[:0] for name, values in self.data.items()}):
            with self.subTest(str(data)[:40]), self.assertRaises((ValueError, TypeError)):
                imukit.navigate(data, **self.start)


if __name__ == "__main__":
    unittest.main()
