# SPDX-License-Identifier: Apache-2.0
"""Calibration and evaluation, compared with the command and with what was simulated."""
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
    command.run(FOLDER.name, "calibrate", "--plan", "ADIS16488", "-p", "multiposition", "--rate",
                "20Hz", "-o", "programme.yaml")
    for seed in (1, 2):
        command.run(FOLDER.name, "simulate", "ADIS16488", "--motion", "programme.yaml", "--rate",
                    "20Hz", "--duration", "110s", "--seed", seed, "-o", f"bench{seed}.csv")
    with open(os.path.join(FOLDER.name, "table.csv"), "w", encoding="utf-8") as file:
        file.write("reference [deg/s],reading [deg/s]\n")
        for k in [*range(-4, 5), *range(3, -5, -1)] * 2:
            file.write(f"{k * 25},{k * 25.01 + 0.02 * math.sin(17 * k)}\n")


def tearDownModule():
    FOLDER.cleanup()


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


class Plans(InFolder):
    def test_programme_reaches_what_it_says(self):
        plan = imukit.plan_calibration("ADIS16488", "sixposition", "accel.scale_factor 300 ppm")
        log = imukit.simulate("ADIS16488", 100, plan.duration, seed=1,
                              motion=imukit.Motion.parse(plan.programme))
        result = imukit.calibrate(log, "sixposition")
        for axis in "xyz":
            name = f"accel.scale_factor.fixed.{axis}"
            self.assertLess(plan.sigmas[name], 300e-6)
            self.assertLess(result.estimates[name].sigma, 2 * plan.sigmas[name])

    def test_as_command(self):
        for procedure, want, more, words in (
                ("multiposition", "accel.scale_factor 100 ppm, gyro.bias 1 mdeg/s", {}, ()),
                ("tumble", None, {"mounting": "0.1 deg", "rate": 50},
                 ("--mounting", "0.1deg", "--rate", "50Hz")),
                ("thermal", None, {"soak": 120, "temperature_order": 2},
                 ("--soak", "2min", "--temperature-order", "2"))):
            plan = imukit.plan_calibration("ADIS16488", procedure, want, **more)
            words = ("calibrate", "--plan", "ADIS16488", "-p", procedure, *words,
                     *(("--want", want) if want else ()))
            self.same(plan, *words)
            command.run(self.folder, *words, "-o", "plan.yaml")
            with open("plan.yaml", encoding="utf-8") as file:
                self.assertEqual(plan.programme, file.read())
            for wish in plan.wishes:
                self.assertGreater(plan.sigmas[wish.name], 0)
                self.assertEqual(wish.reached, wish.expected <= wish.wish)
            self.assertEqual(plan.met, all(wish.reached for wish in plan.wishes))
            again = pickle.loads(pickle.dumps(plan))
            self.assertEqual((again.duration, again.programme), (plan.duration, plan.programme))
        self.assertIsNone(imukit.plan_calibration("ADIS16488", "centrifuge").programme)

    def test_refused(self):
        for procedure, more, kind, said in (
                ("magnetometer", {}, imukit.Error, "needs no programme"),
                ("repeatability", {}, imukit.Error, "needs no programme"),
                ("sixposition", {"want": "accel.bias"}, imukit.Error, "a term and its 1 sigma"),
                ("sixposition", {"want": "bais 5 mg"}, imukit.Error, "expected bias"),
                ("sixposition", {"want": "gyro.scale_factor 5 ppm"}, imukit.Error, "estimates"),
                ("sixposition", {"want": 5}, TypeError, ""),
                ("sixposition", {"frame": "x"}, ValueError, "frame"),
                ("sixposition", {"with_": "x"}, ValueError, "with_"),
                ("thermal", {"rate": math.nan}, imukit.Error, "rate"),
                ("thermal", {"soak": -1}, imukit.Error, "soak"),
                ("shake", {}, ValueError, "procedure"), (None, {}, TypeError, "")):
            with self.assertRaisesRegex(kind, said):
                imukit.plan_calibration("ADIS16488", procedure, **more)
        with self.assertRaisesRegex(imukit.Error, "noise"):
            imukit.plan_calibration(imukit.Model(), "sixposition")
        with self.assertRaises(TypeError):
            imukit.plan_calibration(None, "sixposition")


class Same(InFolder):
    def test_calibrate(self):
        result = imukit.calibrate("bench1.csv", "multiposition", gravity="9.81 m/s^2",
                                  without="g2_sensitivity")
        self.same(result, "calibrate", "bench1.csv", "-p", "multiposition", "--gravity",
                  "9.81m/s^2", "--without", "g2_sensitivity")
        self.assertTrue(result.usable)
        count = len(result.estimates)
        matrix = result.correlations
        for i in range(count):
            self.assertAlmostEqual(matrix[i, i], 1, 12)
            self.assertEqual(matrix[i, 0], matrix[0, i])
        self.assertEqual(len(result.residuals), len(result.poses))
        again = pickle.loads(pickle.dumps(result))
        self.assertEqual(again.model, result.model)
        self.assertEqual(again.level, result.level)

    def test_several_into(self):
        result = imukit.calibrate(["bench1.csv", "bench2.csv"], "multiposition", into="ADIS16488",
                                  position=("48.1 deg", "11.6 deg", 520), estimate=["accel.bias"])
        words = ("calibrate", "bench1.csv", "bench2.csv", "-p", "multiposition", "--into",
                 "ADIS16488", "--position", "48.1 deg, 11.6 deg, 520 m", "--estimate", "accel.bias")
        self.same(result, *words)
        command.run(self.folder, *words, "-o", "into.yaml", "--anyway")
        self.assertEqual(imukit.calibrate(["bench1.csv", "bench2.csv"], "multiposition",
                                          into="ADIS16488", position=("48.1 deg", "11.6 deg", 520),
                                          estimate=["accel.bias"], anyway=True).model,
                         imukit.Model("into.yaml"))

    def test_repeatability(self):
        models = []
        for seed in (1, 2):
            command.run(self.folder, "calibrate", f"bench{seed}.csv", "-p", "multiposition", "-o",
                        f"run{seed}.yaml")
            models.append(imukit.Model(f"run{seed}.yaml"))
        result = imukit.calibrate(models, "repeatability")
        due = imukit.calibrate(["run1.yaml", "run2.yaml"], "repeatability")
        self.same(due, "calibrate", "run1.yaml", "run2.yaml", "-p", "repeatability")
        self.assertEqual(result.repeatability.to_dict(), due.repeatability.to_dict())

    def test_evaluate(self):
        result = imukit.evaluate("table.csv", limit="linearity 0.001 %, zero 1 deg/s",
                                 full_scale="200 deg/s")
        self.same(result, "evaluate", "table.csv", "--limit", "linearity 0.001 %, zero 1 deg/s",
                  "--full-scale", "200 deg/s")
        self.assertFalse(result.limits_met)
        self.assertEqual(result.figures()["linearity"].verdict, "not met")
        self.assertIn("limit", {f.code for f in result.findings})
        two = imukit.evaluate(["table.csv", imukit.read_log("table.csv", rate=1,
                                                            any_columns=True)])
        self.assertEqual(two.channels[0].runs, 2)


def readings(k, true):
    """What a unit with a few errors reads, as texts."""
    return [f"{1.002 * v + 0.01 + 1e-4 * math.sin(7 * k + j * k * k)}" for j, v in enumerate(true)]


def write_table(name, header, rows):
    with open(name, "w", encoding="utf-8") as file:
        file.write(f"time [s],{header}\n")
        for k, row in enumerate(rows):
            file.write(",".join(map(str, (k / 20, *row))) + "\n")


def write_centrifuge(name):
    forces = [[level if j == axis else 0.0 for j in range(3)] for axis in range(3)
              for level in (-5, -2, 1, 3, 6) for _ in range(40)]
    write_table(name, ",".join([f"accel_{a} [g]" for a in "xyz"]
                               + [f"reference_force_{a} [g]" for a in "xyz"]),
                ([*readings(k, force), *force] for k, force in enumerate(forces)))


def write_compass(name):
    heights = [1 - 2 * (k + 0.5) / 600 for k in range(600)]
    fields = [(math.sqrt(1 - z * z) * math.cos(k / 7), math.sqrt(1 - z * z) * math.sin(k / 7), z)
              for k, z in enumerate(heights)]
    write_table(name, ",".join(f"mag_{a} [mG]" for a in "xyz"),
                (readings(k, [480 * x for x in field]) for k, field in enumerate(fields)))


def write_thermal(name):
    degrees = [20 + 40 * math.sin(k / 1200) for k in range(4000)]
    write_table(name, "gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],temperature [degC]",
                ([*readings(k, (0, 0.01 * t, 0.01)), t] for k, t in enumerate(degrees)))


def write_rate_table(name):
    rates = [rate for rate in (0, 50, -50, 100, -100, 150, -150) for _ in range(40)]
    write_table(name, "gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],table_rate [deg/s]",
                ([*readings(k, (0, 0, rate)), rate] for k, rate in enumerate(rates)))


TURNS = "imukit_motion: 1\nsteps: [hold 5 s, " + ", ".join(
    f"rotate {axis} {angle} deg at 90 deg/s, hold 4 s" for angle in (360, -360)
    for axis in "xyz") + "]\n"
SPIN = ("imukit_motion: 1\nearth: no\nsteps: [hold 5 s, " + ", ".join(
    f"rotate z {angle} deg at {rate} deg/s, hold 3 s"
    for angle, rate in ((720, 90), (-720, 90), (720, 180), (-720, 180))) + "]\n")


class Procedures(InFolder):
    """Each procedure gives the numbers of the command, and gives some."""

    def simulated(self, name, duration, text=None):
        if text:
            with open(f"{name}.yaml", "w", encoding="utf-8") as file:
                file.write(text)
        else:
            command.run(self.folder, "calibrate", "--plan", "ADIS16488", "-p", name, "--rate",
                        "20Hz", "-o", f"{name}.yaml")
        command.run(self.folder, "simulate", "ADIS16488", "--motion", f"{name}.yaml", "--rate",
                    "20Hz", "--duration", duration, "-o", f"{name}.csv")

    def check(self, name, procedure, log=None, **named):
        """Arguments as options: the same names and texts."""
        log = log or f"{name}.csv"
        words = [word for key, value in named.items() for word in
                 ([f"--{key.replace('_', '-')}"] if value is True else
                  [f"--{key.replace('_', '-')}", value])]
        with self.subTest(procedure, **named):
            result = imukit.calibrate(log, procedure, **named)
            self.same(result, "calibrate", log, "-p", procedure, *words)
            self.assertTrue(result.estimates or procedure in ("magnetometer", "repeatability"))
            return result

    def test_programmes(self):
        for name, duration, with_motion in (("ferraris", "72s", False), ("tumble", "108s", True),
                                            ("sixposition", "36s", False),
                                            ("rate-table", "222s", True)):
            self.simulated(name, duration)
            self.check(name, name, **({"motion": f"{name}.yaml"} if with_motion else {}))
        self.check("ferraris", "ferraris", estimator="closed-form")
        self.check("tumble", "tumble", motion="tumble.yaml", motion_offset="auto")
        draw = random.Random(2)
        write_table("rest.csv", "gyro_z [deg/s]", ([draw.gauss(0, 0.1)] for _ in range(400)))
        result = imukit.evaluate("rate-table.csv", motion="rate-table.yaml", static="rest.csv")
        self.same(result, "evaluate", "rate-table.csv", "--motion", "rate-table.yaml", "--static",
                  "rest.csv")
        self.assertTrue(result.channels)

    def test_turns_and_spin(self):
        self.simulated("turns", "52s", TURNS)
        self.check("turns", "turns", turn_angle="360 deg")
        self.simulated("spin", "41s", SPIN)
        self.check("spin", "spin", motion="spin.yaml", no_earth=True)

    def test_references(self):
        write_centrifuge("centrifuge.csv")
        self.check("centrifuge", "centrifuge")
        write_rate_table("table_rate.csv")
        self.check("table_rate", "rate-table", table_axis="z", no_earth=True)
        self.same(imukit.evaluate("table_rate.csv", table_axis="z"), "evaluate", "table_rate.csv",
                  "--table-axis", "z")

    def test_fields_and_temperatures(self):
        write_compass("compass.csv")
        self.assertTrue(self.check("compass", "magnetometer", field="48 uT").usable)
        write_thermal("thermal.csv")
        self.check("thermal", "thermal", temperature_order=2, reference_temperature="20 degC")
        with self.assertRaises(imukit.Error):
            imukit.calibrate("thermal.csv", "thermal", temperature_order=77)

    def test_sections(self):
        write_table("runs.csv", "gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],run",
                    ([*readings(k, (0, 0, k // 300)), "abc"[k // 300]] for k in range(900)))
        result = self.check("runs", "repeatability", section="run")
        self.assertEqual(result.repeatability.runs, 3)


AT_REST = "imukit_motion: 1\nsteps: [hold 10 s]\n"
FACES = [(9.8, 0, 0), (-9.8, 0, 0), (0, 9.8, 0), (0, -9.8, 0), (0, 0, 9.8), (0, 0, -9.8)]


def faces(scale=1.01, bias=0.1, counts=1.0):
    draw = random.Random(1)
    return {f"accel_{a}{'' if counts == 1 else ' [count]'}":
            [counts * (scale * f[k] + bias + draw.gauss(0, 1e-4)) for f in FACES * 3]
            for k, a in enumerate("xyz")}


class Calibrate(unittest.TestCase):
    def test_known_truth(self):
        result = imukit.calibrate(faces(), "sixposition", pose_means=True, gravity=9.8)
        for axis in "xyz":
            scale = result.estimates[f"accel.scale_factor.fixed.{axis}"]
            bias = result.estimates[f"accel.bias.fixed.{axis}"]
            self.assertAlmostEqual(scale.value, 0.01, delta=6 * scale.sigma + 1e-5)
            self.assertAlmostEqual(bias.value, 0.1, delta=6 * bias.sigma + 1e-4)
            self.assertEqual((bias.unit, scale.unit), ("m/s^2", "1"))

    def test_counts(self):
        for given in (400, "400 count/(m/s^2)", (400, 400, 400)):
            result = imukit.calibrate(faces(counts=400.0), "sixposition", pose_means=True,
                                      gravity=9.8, accel_sensitivity=given)
            self.assertAlmostEqual(result.estimates["accel.scale_factor.fixed.x"].value, 0.01,
                                   delta=1e-4)

    def test_refused(self):
        good = {"procedure": "sixposition", "pose_means": True, "gravity": 9.8}
        refused = [{"procedure": "sixpositions"}, {"procedure": ["sixposition", "spin"]},
                   {"gravity": 3}, {"estimate": "no such term"},
                   {"estimate": "bias", "with_": "gyro"}, {"with_": "bias"},
                   {"frame": "skew"}, {"estimator": "closed-form"}, {"estimator": "guess"},
                   {"position": "91 deg, 0 deg, 0 m"}, {"position": (1, 2)},
                   {"position": (math.nan, 0, 0)}, {"accel_sensitivity": "3 m"},
                   {"accel_sensitivity": ()}, {"accel_sensitivity": (1,) * 9},
                   {"accel_range": -1}, {"field": ("50 uT",)}, {"field": (5, 6, 7)},
                   {"motion": "no_such_file.yaml"}, {"motion_offset": 3},
                   {"turn_angle": 1}, {"field": 5}, {"dip": 2}, {"reference_temperature": 300},
                   {"model": "no such part"}, {"into": "ADIS16488", "model": "ADIS16488"},
                   {"temperature_order": 77}, {"table_axis": "w"}, {"placement": -1},
                   {"motion": imukit.Motion.parse(AT_REST)}, {"window": 2}, {"rate": 100},
                   {"procedure": "turns", "pose_means": False, "turn_angle": -1},
                   {"procedure": "ferraris", "pose_means": False, "estimator": "closed-form",
                    "estimate": "bias"},
                   {"procedure": "rate-table"}, {"procedure": "repeatability"}]
        for named in refused:
            with self.subTest(named), self.assertRaises((ValueError, OSError)):
                imukit.calibrate(faces(), **{**good, **named})
        for named in ({"placement": []}, {"estimate": 5}, {"robust": 1, "no": 2}, {"motion": 7},
                      {"procedure": 5}, {"with_": 5}, {"name": 5}):
            with self.subTest(named), self.assertRaises(TypeError):
                imukit.calibrate(faces(), **{**good, **named})
        for data in ([], None, "no_such_file.csv", {"accel_x": [1.0]}, ["a.csv", "b.csv"]):
            with self.subTest(data), self.assertRaises((ValueError, TypeError)):
                imukit.calibrate(data, "multiposition")

    def test_cancelled(self):
        with self.assertRaises(imukit.Error):
            imukit.calibrate(faces(), "sixposition", pose_means=True, gravity=9.8,
                             progress=lambda *said: False)


class Evaluate(unittest.TestCase):
    def test_refused(self):
        table = {"reference [rad/s]": [1.0, 2, 3, 2, 1], "reading [rad/s]": [1.0, 2, 3, 2.1, 1]}
        for named in ({"limit": "linearty 5 %"}, {"limit": "linearity"}, {"limit": "linearity 5 m"},
                      {"limit": "bias_instability 5 deg/h"}, {"limit": "linearity 1 %,"},
                      {"full_scale": -1}, {"full_scale": "3 m"}, {"level_width": math.nan},
                      {"sensitivity": 3}, {"zero": 1}, {"confidence": 2}, {"motion_offset": 1},
                      {"motion": "no_such_file.yaml"}, {"static": [1.0, 2.0]}, {"gaps": "keep"},
                      {"table_axis": "w"}, {"table_axis": "z"}, {"section": "run"}, {"trim": -1},
                      {"minimum": 0}, {"motion": imukit.Motion.parse(AT_REST)}):
            with self.subTest(named), self.assertRaises((ValueError, OSError)):
                imukit.evaluate(table, **named)
        for named in ({"unit": 5}, {"limit": 5}, {"motion": 5}, {"no": 1}, {"trim": []}):
            with self.subTest(named), self.assertRaises(TypeError):
                imukit.evaluate(table, **named)
        for data in ((), [], None, "no_such_file.csv", {"gyro_x": [1.0, 2.0]}, [1.0, 2.0],
                     [table] * 65):
            with self.subTest(str(data)[:20]), self.assertRaises((ValueError, TypeError)):
                imukit.evaluate(data)

    def test_counts(self):
        table = {"reference [rad/s]": [-1.0, 0, 1, 0, -1], "reading [count]":
                 [-1000.0, 2, 1001, 1, -1000]}
        figures = imukit.evaluate(table, sensitivity=1000).figures()
        self.assertAlmostEqual(figures["sensitivity"].value, 1.0005, delta=1e-3)
        self.assertIn("accuracy", figures)


if __name__ == "__main__":
    unittest.main()
