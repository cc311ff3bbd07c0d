# SPDX-License-Identifier: Apache-2.0
"""Instruments: their classes, designs, runs and error models, beside those of the command."""
import json
import math
import os
import pathlib
import pickle
import subprocess
import tempfile
import unittest
import warnings

from command import ALONE, COMMAND

import imukit
from imukit import physics



def by_command(*words):
    if not COMMAND.exists():
        raise unittest.SkipTest("no command")
    done = subprocess.run([COMMAND, "physics", *words, "--json"], check=True, text=True, env=ALONE,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return json.loads(done.stdout)


class Designs(unittest.TestCase):
    def test_all_kinds(self):
        """Every kind: its names and docstring, and that no parameter hides a method."""
        self.assertEqual(len(physics.instruments()), 12)
        for kind in physics.instruments():
            with self.subTest(kind.__name__):
                self.assertIs(getattr(physics, kind.__name__), kind)
                self.assertIn(kind.__name__, physics.__all__)
                design = kind()
                self.assertEqual(set(design.to_dict()), {p.path for p in kind.about.parameters})
                words = {part for p in kind.about.parameters for part in p.path.split(".")}
                methods = {name for name in dir(physics.Instrument) if not name.startswith("_")}
                tops = {p.path.split(".")[0] for p in kind.about.parameters}
                self.assertFalse(tops & methods)
                for p in kind.about.parameters:
                    self.assertIn(p.path, kind.__doc__)
                    self.assertTrue(p.help)
                    if p.unit not in ("", "1"):
                        self.assertIn(f"[{p.unit}]", kind.__doc__)
                self.assertTrue(words)
                self.assertEqual(physics.Instrument.parse(design.yaml()), design)
                self.assertGreater(len(design.derived()), 0)
                self.assertIsInstance(design.reduce(), imukit.Model)

    def test_as_the_command(self):
        for kind in physics.instruments():
            name = kind.about.name
            with self.subTest(name):
                due = by_command(name)
                design = kind()
                self.assertEqual(design.describe().to_dict()["result"], due["result"])
                for path, value in due["result"]["design"].items():
                    found = design[path]
                    self.assertEqual(found, value["value"] if isinstance(value, dict) else value)
                derived = {row["name"]: row["value"] for row in due["result"]["derived"]}
                for quantity, value in derived.items():
                    found = design.derived()[quantity].value
                    self.assertTrue(math.isnan(found) if value is None else found == value)

    def test_parameters(self):
        laser = physics.RingLaser(wavelength="633 nm", dither={"frequency": 400, "rate": "1 rad/s"})
        self.assertAlmostEqual(laser["cavity.wavelength"], 633e-9, 20)
        self.assertEqual((laser.dither.frequency, laser["dither"]["rate"]), (400, 1))
        laser.cavity.shape = "square"
        laser["lock_in.rate"] = 1e-4
        self.assertEqual((laser.shape, laser.lock_in.rate), ("square", 1e-4))
        self.assertEqual(list(laser.dither), ["frequency", "rate", "randomness"])
        copy = laser.copy()
        copy.wavelength = "1 um"
        self.assertNotEqual(copy, laser)
        self.assertEqual(pickle.loads(pickle.dumps(laser)), laser)
        self.assertEqual(physics.RingLaser(laser), laser)
        self.assertEqual(physics.RingLaser({"cavity.wavelength": 1e-6}).wavelength, 1e-6)

    def test_all_or_none(self):
        laser = physics.RingLaser()
        before = laser.yaml()
        for values in ({"wavelength": "1 um", "perimeter": "-1 m"}, {"wavelength": math.nan},
                       {"shape": "round"}, {"shape": "square", "wavelength": "1 s"}):
            with self.subTest(values=values), self.assertRaises(ValueError):
                laser.update(values)
            self.assertEqual(laser.yaml(), before)

    def test_switches(self):
        kinds = {p.kind for kind in physics.instruments() for p in kind.about.parameters}
        self.assertEqual(kinds, {"number", "count", "choice", "switch"})
        for kind in physics.instruments():
            for p in kind.about.parameters:
                if p.kind != "switch":
                    continue
                for word, value in (("yes", True), ("no", False)):
                    with self.subTest(p.path, word=word):
                        self.assertIs(kind({p.path: word})[p.path], value)
                        self.assertIs(kind({p.path: value})[p.path], value)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mine.yaml")
            made = physics.TuningFork(name="mine")
            made.save(path)
            self.assertEqual(physics.TuningFork(path), made)
            found = physics.Instrument.load(path)
            self.assertIsInstance(found, physics.TuningFork)
            self.assertEqual((found, found.name), (made, "mine"))
            with self.assertRaisesRegex(ValueError, "not of a ring_laser"):
                physics.RingLaser(path)
        self.assertEqual(made.reduce()["name"], "mine")


class Jobs(unittest.TestCase):
    def test_run(self):
        run = physics.RingLaser().run("1 s", rate="10 deg/s", signals=True, seed=1)
        due = by_command("ring_laser", "--rate", "10 deg/s", "--duration", "1s")
        self.assertEqual(run.to_dict()["result"], due["result"])
        self.assertEqual(run.to_dict()["inputs"], due["inputs"])
        readings = [float(x) for x in run.log["gyro_x"]]
        self.assertEqual(len(readings), 100)
        mean = due["result"]["outputs"][0]["mean"]["value"]
        self.assertAlmostEqual(sum(readings) / 100, mean, 14)
        self.assertEqual(run.log.units["gyro_x"], "rad/s")
        self.assertEqual(set(run.signals) - {"time"}, {s.name for s in
                                                       physics.RingLaser.about.signals})
        self.assertIn("<svg", run._repr_html_())

    def test_run_is_data(self):
        run = physics.FibreOptic().run("5 s")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertEqual(imukit.allan(run).curve("gyro_x").unit, "rad/s")

    def test_inputs(self):
        servo = physics.PendulousServo()
        runs = [servo.run(1, acceleration=a, noise=False).log["accel_x"][-1]
                for a in (9.80665, "1 g", [9.80665, 0, 0], ("1 g", 0, 0), "1 0 0 g")]
        for value in runs[1:]:
            self.assertAlmostEqual(value, runs[0], 12)
        sine = servo.run(1, acceleration="1 g", sine="2 Hz", noise=False).log["accel_x"]
        self.assertLess(min(sine), -9)
        with self.assertWarnsRegex(imukit.DataWarning, "the output ends at"):
            warm = servo.run(1, temperature="60 degC", temperature_rate="6 K/min", noise=False).log
        self.assertAlmostEqual(warm["temperature"][-1], 333.25, 2)
        coarse = servo.run(1, signals=True, signal_rate=10)
        self.assertEqual((coarse.log.rows, coarse.signals.rows), (100, 10))

    def test_models(self):
        for kind in (physics.RingLaser, physics.MemsAccelerometer):
            due = by_command(kind.about.name, "--reduce")
            model = kind().reduce(single_axis=True)
            sensor = kind.about.sensor
            for path in ("bias.repeatability", "range"):
                self.assertEqual(model[f"{sensor}.{path}"][0],
                                 due["result"]["reduced"][path]["value"])

    def test_sweep(self):
        sweep = physics.PendulousServo().sweep(duration="1 s", level="slow")
        due = by_command("pendulous_servo", "--sweep", "--duration", "1s", "--level", "slow")
        self.assertEqual(sweep.to_dict()["result"], due["result"])
        self.assertEqual(len(sweep.model["accel.bias.fixed"]), 3)

    def test_views(self):
        laser = physics.RingLaser()
        views = laser.views()
        self.assertEqual([v.title for v in views.views], [t for t, _ in laser.about.views])
        self.assertIn("<svg", views._repr_html_())
        for view in views.views:
            for curve in view.curves.values():
                self.assertEqual(len(curve), len(view.x))
                self.assertTrue(all(math.isfinite(y) for y in curve))
        self.assertEqual(len(laser.views("kicks").views), 1)

    def test_progress(self):
        seen = []
        physics.RingLaser().run(1, progress=lambda *said: seen.append(said))
        self.assertTrue(seen)
        with self.assertRaises(imukit.Error) as caught:
            physics.RingLaser().run(1, progress=lambda *said: False)
        self.assertEqual(caught.exception.code, "IMK_ERROR_CANCELLED")

    def test_changed_meanwhile(self):
        laser = physics.RingLaser()

        def change(*said):
            laser.wavelength = 1e-6
        with self.assertRaisesRegex(RuntimeError, "in use"):
            laser.run(1, progress=change)
        laser.wavelength = 1e-6


class Refused(unittest.TestCase):
    def test_arguments(self):
        laser = physics.RingLaser()
        for kind, words, call in (
                (KeyError, "lock_in.rate or dither.rate", lambda: laser["rate"]),
                (KeyError, "has no 'foo'", lambda: laser.update({"foo": 1})),
                (AttributeError, "has no 'foo'", lambda: laser.foo),
                (AttributeError, "has no 'foo'", lambda: laser.dither.foo),
                (TypeError, "is a group", lambda: laser.update({"dither": 1})),
                (TypeError, "a kind is wanted", physics.Instrument),
                (AttributeError, "RingLaser", lambda: physics.RingLazer),
                (imukit.Error, "known name", lambda: physics.RingLaser("nonsense")),
                (imukit.Error, "length", lambda: physics.RingLaser(perimeter="1 s")),
                (imukit.Error, "not finite", lambda: physics.RingLaser(wavelength=math.nan)),
                (imukit.Error, "outside its valid range", lambda: physics.RingLaser(loss=2)),
                (imukit.Error, "at most 1e6 rad/s", lambda: laser.run(1, rate=1e9)),
                (imukit.Error, "at most 1e6", lambda: laser.run(1, acceleration=[0, 0, math.nan])),
                (imukit.Error, "angular rate", lambda: laser.run(1, rate="1 g")),
                (imukit.Error, "four samples", lambda: laser.run(1, rate=1, sine=60)),
                (imukit.Error, "absolute zero", lambda: laser.run(1, temperature=-5)),
                (imukit.Error, "1 s. is outside", lambda: laser.run(1, step=1)),
                (imukit.Error, "one sample", lambda: laser.run(-1)),
                (imukit.Error, "one sample", lambda: laser.run(math.nan)),
                (MemoryError, "", lambda: laser.run(1e15)),
                (ValueError, "amplitude", lambda: laser.run(1, sine=5)),
                (ValueError, "one number, or three", lambda: laser.run(1, rate=[1, 2])),
                (ValueError, "one number, or three", lambda: laser.run(1, rate="1 2 deg/s")),
                (ValueError, "above 0", lambda: laser.run(1, output_rate=0)),
                (ValueError, "above 0", lambda: laser.run(1, signal_rate=-5)),
                (ValueError, "full|slow", lambda: laser.run(1, level="fast")),
                (ValueError, "4294967295", lambda: laser.run(1, run=-1)),
                (ValueError, "1 to 4", lambda: laser.views("zz")),
                (ValueError, "threads", lambda: laser.sweep(threads=-1)),
                (ValueError, "95 bytes", lambda: physics.RingLaser(name="x" * 200)),
                (TypeError, "", lambda: laser.run(None)),
                (TypeError, "", lambda: laser.run(1, rate=None)),
                (imukit.FileError, "does not exist", lambda: laser.save("/nonexistent/x.yaml"))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()


if __name__ == "__main__":
    unittest.main()
