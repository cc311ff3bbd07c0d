# SPDX-License-Identifier: Apache-2.0
"""Noise parameters of filters."""
import pathlib
import pickle
import tempfile
import unittest
import warnings

from command import command_json, python_json

import imukit

DRIVE = """imukit_motion: 1
start: {heading: 90 deg}
steps:
  - hold 1 s
  - accelerate to 5 m/s at 5 m/s^2
  - hold 1 s
"""


class Tune(unittest.TestCase):
    def setUp(self):
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("ignore", imukit.DataWarning)

    def test_as_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            motion = pathlib.Path(folder, "drive.yaml")
            motion.write_text(DRIVE, encoding="utf-8")
            for words, arguments in (
                    ("ADIS16488 {m} --windows 4 --to-time 0.1s", {"windows": 4, "to_time": 0.1}),
                    ("ADIS16488 {m} --windows 2 --to-time 0.05s --assume-class own -r 100Hz "
                     "--gyro-bias 10deg/h --learned --compensated --per-axis -n 3 --seed 2 "
                     "--correlation-time 100s --without gyro.bias --from 0.02s --bias-time 0.5s "
                     "--latitude 30deg",
                     {"windows": 2, "to_time": "50 ms", "assume_class": "own", "rate": 100,
                      "gyro_bias": "10 deg/h", "learned": True, "compensated": True,
                      "per_axis": True, "runs": 3, "seed": 2, "correlation_time": 100,
                      "without": "gyro.bias", "from_time": 0.02, "bias_time": 0.5,
                      "latitude": "30 deg"})):
                words = words.format(m=motion).split()
                with self.subTest(words):
                    result = imukit.tune("ADIS16488", motion, **arguments)
                    self.assertEqual(python_json(result), command_json("tune", *words))

    def test_answers(self):
        result = imukit.tune("ADIS16488", [DRIVE, imukit.Motion.parse(DRIVE)], windows=2,
                             to_time=0.05, threads=1)
        safe, sheet = result.answer(), result.answer("data_sheet")
        self.assertGreaterEqual(safe.gyro_white[0], sheet.gyro_white[0])
        self.assertLess(max(safe.largest), 1.051)  # what `safe` means: eigen_limit is 1.05
        self.assertEqual(len(safe.time), len(safe.nees))
        model = result.model()
        self.assertAlmostEqual(model["gyro.noise.angle_random_walk"][0] / safe.gyro_white[0], 1.0)
        with self.assertRaises(KeyError):
            result.answer("fit_scale_factors")
        with self.assertRaises(KeyError):
            result.model("best")
        copy = pickle.loads(pickle.dumps(result))
        self.assertEqual(copy.model("fit"), result.model("fit"))
        self.assertEqual(repr(copy), repr(result))
        self.assertIn("<svg", result.figure())
        self.assertIn("ADIS16488", result.page())

    def test_unstated_is_told(self):
        with self.assertWarnsRegex(imukit.DataWarning, "does not state .*scale factor"):
            imukit.tune("ADIS16488", DRIVE, windows=2, to_time=0.05)

    def test_refused(self):
        nan = float("nan")
        recorded = imukit.Motion({name: [0.0] * 300 for name in
                                  ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")},
                                 rate=50)
        half = imukit.Model.parse("imukit: 1\ngyro: {}\n")
        for error, words, model, motions, arguments in (
                (imukit.Error, "no accelerometers", half, DRIVE, {}),
                (imukit.Error, "none", "none such", DRIVE, {}),
                (ValueError, "motions", "ADIS16488", [], {}),
                (ValueError, "motions", "ADIS16488", 9 * [DRIVE], {}),
                (TypeError, "motion", "ADIS16488", None, {}),
                (TypeError, "motion", "ADIS16488", [3], {}),
                (ValueError, "at rest", "ADIS16488", imukit.Motion.at_rest(), {}),
                (ValueError, "latitude", "ADIS16488", recorded, {"latitude": 1}),
                (imukit.Error, "own rate", "ADIS16488", recorded, {"rate": 100}),
                (imukit.Error, "no_such", "ADIS16488", "no_such.yaml", {}),
                (imukit.Error, "rate", "ADIS16488", DRIVE, {"rate": nan}),
                (imukit.Error, "rate", "ADIS16488", DRIVE, {"rate": -1}),
                (imukit.Error, "from|to", "ADIS16488", DRIVE, {"from_time": 2, "to_time": 1}),
                (imukit.Error, "window", "ADIS16488", DRIVE, {"windows": 0}),
                (imukit.Error, "bias", "ADIS16488", DRIVE, {"gyro_bias": nan}),
                (imukit.Error, "run", "ADIS16488", DRIVE, {"runs": 2}),
                (imukit.Error, "did you mean", "ADIS16488", DRIVE, {"only": "gyro.bais"}),
                (ValueError, "threads", "ADIS16488", DRIVE, {"threads": -1}),
                (imukit.Error, "too short|samples", "ADIS16488", DRIVE,
                 {"bias_time": 1000, "windows": 2})):
            with self.subTest([model, motions, arguments]), self.assertRaisesRegex(error, words):
                imukit.tune(model, motions, **{"windows": 2, "to_time": 0.05, **arguments})


if __name__ == "__main__":
    unittest.main()
