# SPDX-License-Identifier: Apache-2.0
"""Growth of errors, and classes of models."""
import math
import os
import pathlib
import pickle
import tempfile
import unittest
import warnings

from command import command_json, python_json

import imukit

G = 9.80665
DRIVE = """imukit_motion: 1
start: {latitude: 48 deg, longitude: 11 deg, height: 500 m, heading: 90 deg}
steps:
  - hold 10 s
  - accelerate to 15 m/s at 2 m/s^2
  - hold 20 s
  - stop at 3 m/s^2
"""
AID = "gnss position 1 m, velocity 0.05 m/s at 1 Hz until 30 s"


class Quiet(unittest.TestCase):
    def setUp(self):
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("ignore", imukit.DataWarning)


class Drift(Quiet):
    def test_closed_forms(self):
        # An accelerometer bias b moves the position by b t^2/2, a gyro bias w by g w t^3/6, each
        # on north and east; after 30 s, Schuler's oscillation changes this by (t/806 s)^2/12.
        t = 30.0
        for path, bias, due in (("accel.bias.repeatability", 1e-3 * G, 0.5e-3 * G * t**2),
                                ("gyro.bias.repeatability", 1e-5, G * 1e-5 * t**3 / 6)):
            model = imukit.Model(name="one")
            model[path] = bias
            growth = imukit.drift(model, times=t).growth()
            self.assertAlmostEqual(growth.north[-1] / due, 1.0, delta=2e-3)
            # CEP of equal sigmas: sigma sqrt(2 ln 2)
            self.assertAlmostEqual(growth.cep[-1] / growth.north[-1], math.sqrt(2 * math.log(2)),
                                   delta=1e-3)

    def test_terms_add_up(self):
        result = imukit.drift("tactical", duration=60)
        total = result.moments()
        self.assertEqual(len(total.mean), len(result.times))
        variance = total.covariance.tolist()[-1][0][0]
        self.assertAlmostEqual(sum(result.moments(source=s).covariance.tolist()[-1][0][0]
                                   for s in result.sources()) / variance, 1.0, delta=1e-9)
        self.assertAlmostEqual(result.growth().north[-1] ** 2
                               / (variance + total.mean.tolist()[-1][0] ** 2), 1.0, delta=1e-9)
        self.assertAlmostEqual(sum(term.share for term in result.budget()), 1.0, delta=1e-9)
        self.assertGreater(result.budget()[0].share, result.budget()[1].share)

    def test_as_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            svg = os.path.join(folder, "x.svg")  # a drawing needs the same times as growth()
            motion = pathlib.Path(folder, "drive.yaml")
            motion.write_text(DRIVE, encoding="utf-8")
            for words, arguments in (
                    ("tactical -d 1min --compensated --assume-class own --only "
                     "gyro.bias,gyro.noise",
                     {"duration": 60, "compensated": True, "assume_class": "own",
                      "only": "gyro.bias,gyro.noise"}),
                    ("ADIS16488 --times 10s,60s --aligned self --align-time 60s --vertical free "
                     "--attitude-errors earth --latitude 30deg --yaw 20deg",
                     {"times": [60, "10 s"], "aligned": "self", "align_time": 60,
                      "vertical": "free", "attitude_errors": "earth", "latitude": math.radians(30),
                      "yaw": "20 deg"}),
                    ("navigation --gravity-deflection 30ug --gravity-distance 5km -d 60s "
                     "--without gyro.noise -n 9 --seed 3",
                     {"gravity_deflection": "30 ug", "gravity_distance": 5000, "duration": 60,
                      "without": ["gyro.noise"], "runs": 9, "seed": 3}),
                    (f"tactical --motion {motion} --initial-velocity", None)):
                words = words.split()
                if arguments is None:
                    words += ["0.1 m/s", "--aid", AID, "--filter-model", "navigation", "--outage", "5s"]
                    arguments = {"motion": motion, "initial_velocity": 0.1, "aids": AID,
                                 "filter_model": "navigation", "outage": 5.0}
                with self.subTest(words):
                    due = command_json("drift", *words, "--plot", svg)
                    self.assertEqual(python_json(imukit.drift(words[0], **arguments)), due)

    def test_text_of_a_motion(self):
        result = imukit.drift(["tactical", "navigation"], DRIVE, rate=20)
        self.assertEqual(result.inputs.motion, "the motion")
        self.assertAlmostEqual(float(result.times[-1]), 43.5, delta=0.06)
        self.assertGreater(result.growth("tactical").cep[-1], result.growth("navigation").cep[-1])
        with self.assertRaises(KeyError):
            result.growth()

    def test_runs(self):
        result = imukit.drift("tactical", runs=9, duration=20, aids="position 1 m at 1 Hz until 10s",
                              threads=2)
        runs = result.runs
        self.assertEqual(len(runs.time), len(runs.nees.tolist()[0]))
        self.assertEqual(len(runs.position_north.tolist()), 9)
        last = [row[-1] for row in runs.position_north.tolist()]
        self.assertAlmostEqual(
            math.sqrt(sum(x * x for x in last) / 9),
            result.monte_carlo.times[-1].figures.north.value, delta=1e-12)
        again = imukit.drift("tactical", runs=9, duration=20,
                             aids="position 1 m at 1 Hz until 10s", threads=1)
        self.assertEqual(again.runs.nees.tolist(), runs.nees.tolist())
        self.assertIsNone(imukit.drift("tactical", duration=1).runs)
        self.assertGreater(result.growth(source="believed").cep[-1], 0.0)

    def test_requirement(self):
        result = imukit.drift("tactical", want="CEP 5 m @ 1 min")
        self.assertAlmostEqual(result.want.goal.value, 5.0)
        with tempfile.TemporaryDirectory() as folder:
            due = command_json("drift", "tactical", "--want", "CEP 5 m @ 1 min", "--plot",
                               os.path.join(folder, "x.svg"))
        self.assertEqual(python_json(result), due)

    def test_kept(self):
        result = imukit.drift("tactical", duration=60)
        copy = pickle.loads(pickle.dumps(result))
        self.assertEqual(repr(copy), repr(result))
        self.assertEqual(copy.growth().cep.tolist(), result.growth().cep.tolist())
        self.assertIn("<svg", result.figure())
        self.assertIn("gyro", result.page())

    def test_warnings(self):
        with self.assertWarns(imukit.DataWarning):
            result = imukit.drift(imukit.Model({"gyro": {}}), duration="3 h")
        self.assertIn("completed", {f.code for f in result.findings})
        self.assertNotIn("completed", {f.code for f in result.verdict})

    def test_progress(self):
        seen = []
        imukit.drift("tactical", duration=1, runs=8, progress=lambda *said: seen.append(said))
        self.assertIn(("simulating", "runs", 8, 8), seen)
        with self.assertRaisesRegex(imukit.Error, "cancelled"):
            imukit.drift("tactical", duration=1, progress=lambda *_: False)


class Refused(Quiet):
    def test_arguments(self):
        nan = float("nan")
        for error, words, arguments in (
                (ValueError, "roll, pitch", {"motion": DRIVE, "roll": 1}),
                (ValueError, "leave one out", {"aligned": "self", "initial_attitude": 0.1}),
                (ValueError, "align_time", {"align_time": 3}),
                (ValueError, "aligned='x'", {"aligned": "x"}),
                (ValueError, "aids", {"outage": 10}),
                (ValueError, "aids", {"filter_model": "tactical"}),
                (ValueError, "no aid ends", {"aids": "position 1 m", "want": "CEP 1 m after 10 s"}),
                (ValueError, "exclude", {"only": "gyro", "without": "accel"}),
                (imukit.Error, "did you mean", {"only": "gyro.bais"}),
                (ValueError, "only", {"only": []}),
                (TypeError, "only", {"only": [1]}),
                (ValueError, "assume_class", {"assume_class": "best"}),
                (imukit.Error, "exclude", {"duration": 10, "times": 10}),
                (imukit.Error, "times", {"times": []}),
                (imukit.Error, "times", {"times": [nan]}),
                (imukit.Error, "times", {"times": [0.0]}),
                (imukit.Error, "duration", {"duration": -1}),
                (imukit.Error, "duration", {"duration": nan}),
                (imukit.Error, "rate", {"rate": nan}),
                (imukit.Error, "rate", {"rate": 0}),
                (imukit.Error, "latitude", {"latitude": nan}),
                (imukit.Error, "initial", {"initial_velocity": nan}),
                (imukit.Error, "initial", {"initial_velocity": -1}),
                (ValueError, "three numbers or one", {"initial_velocity": [1, 2]}),
                (imukit.Error, "initial_velocity", {"initial_velocity": "1 deg"}),
                (imukit.Error, "did you mean position", {"aids": "positon 1 m"}),
                (TypeError, "aids", {"aids": 3}),
                (TypeError, "aids", {"aids": [3]}),
                (imukit.Error, "want.*CEP, R95", {"want": "CPE 1 m @ 1h"}),
                (imukit.Error, "want.*time is missing", {"want": "CEP 1 m"}),
                (imukit.Error, "want", {"want": "CEP 1 m @ 1h", "duration": 60}),
                (imukit.Error, "motion", {"motion": DRIVE, "duration": 100}),
                (imukit.Error, "no_such", {"motion": "no_such.yaml"}),
                (imukit.Error, "the motion:2", {"motion": "imukit_motion: 1\nstepps: []\n"}),
                (TypeError, "motion", {"motion": 3}),
                (TypeError, "progress", {"progress": 3}),
                (ValueError, "threads", {"threads": -1}),
                (TypeError, "", {"seed": "one"}),
                (OverflowError, "", {"runs": -1})):
            with self.subTest(arguments), self.assertRaisesRegex(error, words):
                imukit.drift("tactical", **arguments)

    def test_models(self):
        for error, models in ((imukit.Error, "no such device"), (ValueError, []), (TypeError, None),
                              (TypeError, 3), (ValueError, 9 * ["tactical"]), (TypeError, [None])):
            with self.subTest(models), self.assertRaises(error):
                imukit.drift(models, duration=1)
        with self.assertRaisesRegex(ValueError, "one model"):
            imukit.drift(["tactical", "AHRS"], want="CEP 1 m @ 1h")


class Grade(Quiet):
    def test_as_the_command(self):
        result = imukit.grade(["tactical", "ADIS16488"], assume_class="own")
        self.assertEqual(python_json(result), command_json("grade", "tactical", "ADIS16488",
                                                           "--assume-class", "own"))
        self.assertEqual(result.models[0].gyro, "tactical")
        self.assertIn("<svg", imukit.grade("tactical", map="gyro").figure())

    def test_refused(self):
        for error, model, arguments in (
                (imukit.Error, imukit.Model({"gyro": {}}), {}), (ValueError, "tactical", {"map": "x"}),
                (ValueError, "tactical", {"assume_class": "x"}), (TypeError, None, {}),
                (imukit.Error, "none such", {})):
            with self.subTest(model), self.assertRaises(error):
                imukit.grade(model, **arguments)


if __name__ == "__main__":
    unittest.main()
