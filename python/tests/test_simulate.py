# SPDX-License-Identifier: Apache-2.0
"""Simulations: the numbers of the command, blocks, runs, motions, and what is refused."""
import array
import copy
import gc
import math
import os
import pathlib
import subprocess
import tempfile
import threading
import unittest
import warnings

from command import ALONE, COMMAND

import imukit

CAR = """imukit_motion: 1
start: {speed: 10 m/s}
steps: [turn 90 deg at 10 deg/s, hold 2 s]
"""


def numbers(log):
    return {name: list(log[name]) for name in log}


def npy(path):
    """The rows of a matrix of float64."""
    content = path.read_bytes()
    begin = 10 + int.from_bytes(content[8:10], "little")
    values = array.array("d", content[begin:])
    header = content[10:begin].decode()
    rows, columns = (int(n) for n in header.split("(")[1].split(")")[0].split(","))
    if "'fortran_order': True" in header:
        return [list(values[c * rows:(c + 1) * rows]) for c in range(columns)]
    return [list(values[c::columns]) for c in range(columns)]


@unittest.skipUnless(COMMAND.exists(), "the command is not built")
class AsTheCommand(unittest.TestCase):
    def same(self, options, model="tactical", **named):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "car.yaml").write_text(CAR)
            subprocess.run([COMMAND, "simulate", model, *options.split(), "-o", "log.npy",
                            "--gyro-unit", "rad/s" if "increments" not in named else "rad"],
                           cwd=folder, check=True, capture_output=True, env=ALONE)
            due = npy(folder / "log.npy")
            if "motion" in named:
                named["motion"] = folder / named["motion"]
            log = imukit.simulate(model, **named)
        self.assertEqual(len(log), len(due))
        for name, values in zip(log, due):
            self.assertEqual(list(log[name]), values, name)

    def test_rest(self):
        self.same("--rate 100Hz --duration 20s --seed 7 --run 3 --latitude 0.5rad --roll 0.1rad",
                  rate=100, duration=20, seed=7, run=3, latitude=0.5, roll=0.1)

    def test_motion(self):
        self.same("--rate 50Hz --motion car.yaml --without accel.bias", rate="50 Hz",
                  motion="car.yaml", without="accel.bias")

    def test_increments(self):
        self.same("--rate 10Hz --duration 5s --no-earth --increments", rate=10, duration=5,
                  earth=False, increments=True)


class Values(unittest.TestCase):
    def test_truth_of_a_turn(self):
        motion = imukit.Motion.parse(CAR)
        truth = motion.truth(rate=10)
        self.assertEqual(truth.rows, math.floor(motion.duration * 10 + 1e-6) + 1)
        self.assertAlmostEqual(truth["yaw"][-1], math.pi / 2, 8)
        self.assertAlmostEqual(truth["vel_east"][-1], 10, 8)
        perfect = imukit.simulate(imukit.Model(), rate=10, motion=motion)
        for name in ("gyro_x", "gyro_z", "accel_y"):
            for a, b in zip(perfect[name], truth[name]):
                self.assertAlmostEqual(a, b, 12)

    def test_rest(self):
        rest = imukit.Motion.at_rest(latitude="60 deg", pitch="90 deg", earth=True)
        log = imukit.simulate(imukit.Model(), 10, 1, motion=rest)
        gravity = imukit.normal_gravity(math.radians(60), 0)
        self.assertAlmostEqual(log["accel_x"][3], gravity, 6)
        self.assertEqual(numbers(log), numbers(imukit.simulate(
            imukit.Model(), 10, 1, latitude=math.radians(60), pitch="90 deg")))
        truth = rest.truth(10, 1)
        self.assertAlmostEqual(truth["pitch"][0], math.pi / 2, 9)

    def test_recorded(self):
        due = imukit.simulate("tactical", 50, 2, seed=4, only="gyro.noise")
        motion = imukit.Motion({name: due[name] for name in due if name != "time"}, rate=50)
        self.assertEqual((motion.kind, motion.rate), ("recorded", 50))
        log = imukit.simulate(imukit.Model(), motion=motion)
        for name in ("gyro_x", "accel_z"):
            self.assertEqual(list(log[name]), list(due[name]))
        self.assertEqual(numbers(imukit.simulate(imukit.Model(), motion=imukit.Motion(due))),
                         numbers(log))

    def test_poses(self):
        time = [k / 10 for k in range(41)]
        with self.assertWarnsRegex(imukit.DataWarning, "stays at its place"):
            motion = imukit.Motion({"time": time, "roll [rad]": [0.0] * 41,
                                    "pitch [rad]": [0.0] * 41,
                                    "yaw [rad]": [0.1 * t for t in time]}, latitude=0.0)
        log = imukit.simulate(imukit.Model(), 10, motion=motion)
        self.assertAlmostEqual(log["gyro_z"][20], 0.1, 6)
        self.assertEqual(motion.kind, "poses")
        self.assertEqual(motion.duration, 4)

    def test_temperature(self):
        model = imukit.Model()
        model["gyro.bias.temperature"] = {"reference_temperature": "25 degC",
                                          "valid_range": (273.15, 353.15), "coefficients": 1e-3}
        with self.assertWarnsRegex(imukit.DataWarning, "temperature terms"):
            imukit.simulate(model, 10, 1)
        for temperature in ("35 degC", 308.15, {"time": [0.0, 1.0], "temperature": [308.15] * 2}):
            log = imukit.simulate(model, 10, 1, earth=False, temperature=temperature)
            self.assertAlmostEqual(log["gyro_x"][5], 0.01, 12)
            self.assertAlmostEqual(log["temperature"][5], 308.15, 9)

    def test_field(self):
        model = imukit.Model()
        model["mag"] = {}
        log = imukit.simulate(model, 10, 1, field=("20 uT", 0, 43e-6))
        self.assertAlmostEqual(log["mag_x"][0], 20e-6, 15)
        self.assertGreater(imukit.simulate(model, 10, 1)["mag_z"][0], 1e-5)

    def test_counts(self):
        model = imukit.Model()
        model["gyro.sensitivity"] = 1000.0
        model["gyro.bias.fixed"] = 0.1
        log = imukit.simulate(model, 100, 10, earth=False)
        self.assertEqual((log["gyro_x"][0], log.units["gyro_x"]), (100, "count"))

    def test_is_data(self):
        log = imukit.simulate("tactical", 100, 30)
        curve = imukit.allan(log).curve("gyro_x")
        self.assertAlmostEqual(curve.tau[0], 0.01, 12)
        self.assertEqual(curve.unit, "rad/s")


class Blocks(unittest.TestCase):
    def joined(self, blocks):
        made = {}
        for block in blocks:
            for name in block:
                made.setdefault(name, []).extend(block[name])
        return made

    def test_any_division(self):
        due = numbers(imukit.simulate("tactical", 100, 10))
        for rows in (1, 7, 999, 1000, 10 ** 6):
            self.assertEqual(self.joined(imukit.simulate_blocks("tactical", 100, 10, rows)), due)

    def test_lost_rows(self):
        model = imukit.Model()
        model["timing.drops"] = 0.5
        log = imukit.simulate(model, 100, 10)
        self.assertLess(log.rows, 600)
        self.assertEqual(log.missing, 1000 - log.rows)
        self.assertEqual(self.joined(imukit.simulate_blocks(model, 100, 10, 1)), numbers(log))

    def test_without_end(self):
        blocks = imukit.simulate_blocks("tactical", 100, rows=50)
        self.assertIsNone(blocks.rows_left)
        first = next(blocks)
        kept = list(first["gyro_x"])
        for _ in range(10):
            last = next(blocks)
        self.assertAlmostEqual(last["time"][0], 5.0, 12)
        self.assertEqual(list(first["gyro_x"]), kept)
        self.assertIs(iter(blocks), blocks)

    def test_ends(self):
        blocks = imukit.simulate_blocks("tactical", 100, 1, 60)
        self.assertEqual([b.rows for b in blocks], [60, 40])
        self.assertEqual(blocks.rows_left, 0)
        with self.assertRaises(StopIteration):
            next(blocks)

    def test_left_early(self):
        motion = imukit.Motion.parse(CAR)
        for _ in range(50):
            next(imukit.simulate_blocks("tactical", 100, rows=10, motion=motion, temperature=300))
        del motion
        gc.collect()

    def test_model_may_change(self):
        model = imukit.Model("tactical")
        blocks = imukit.simulate_blocks(model, 100, 1, 50)
        model["gyro.bias.fixed"] = 1.0
        del model
        self.assertEqual(self.joined(blocks), numbers(imukit.simulate("tactical", 100, 1)))

    def test_one_thread_at_a_time(self):
        blocks = imukit.simulate_blocks("tactical", 100, rows=300000)
        failed = []

        def take():
            try:
                for _ in range(3):
                    next(blocks)
            except RuntimeError as error:
                failed.append(str(error))
        threads = [threading.Thread(target=take) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertIn("another thread", "".join(failed))

    def test_runs(self):
        logs = imukit.simulate_runs("tactical", 4, 100, 2, run=5, seed=3)
        for k, log in enumerate(logs):
            self.assertEqual(numbers(log), numbers(imukit.simulate("tactical", 100, 2, run=5 + k,
                                                                   seed=3)))
        with self.assertRaises(imukit.Error):
            imukit.simulate_runs("tactical", 4, 100, -2)


class Refused(unittest.TestCase):
    def test_arguments(self):
        motion = imukit.Motion.parse(CAR)
        for kind, words, given in (
                (TypeError, "rate", {"duration": 1}),
                (TypeError, "duration", {"rate": 10}),
                (imukit.Error, "rate", {"rate": 0, "duration": 1}),
                (imukit.Error, "rate", {"rate": math.nan, "duration": 1}),
                (imukit.Error, "rate", {"rate": math.inf, "duration": 1}),
                (imukit.Error, "Hz", {"rate": "10 deg", "duration": 1}),
                (imukit.Error, "duration", {"rate": 10, "duration": 0}),
                (imukit.Error, "duration", {"rate": 10, "duration": -1}),
                (imukit.Error, "duration", {"rate": 10, "duration": 1e20}),
                (imukit.Error, "duration", {"rate": 10, "duration": math.inf}),
                (imukit.Error, "length of the motion", {"rate": 10, "duration": 1e3,
                                                        "motion": motion}),
                (ValueError, "run=", {"rate": 10, "duration": 1, "run": -1}),
                (ValueError, "run=", {"rate": 10, "duration": 1, "run": 2 ** 32}),
                (ValueError, "", {"rate": 10, "duration": 1, "seed": -1}),
                (TypeError, "", {"rate": 10, "duration": 1, "seed": "x"}),
                (TypeError, "", {"rate": [10], "duration": 1}),
                (imukit.Error, "latitude", {"rate": 10, "duration": 1, "latitude": 5.0}),
                (imukit.Error, "", {"rate": 10, "duration": 1, "latitude": math.nan}),
                (imukit.Error, "substeps", {"rate": 10, "duration": 1, "substeps": 1000}),
                (ValueError, "at rest", {"rate": 10, "motion": motion, "roll": 0.0}),
                (ValueError, "at rest", {"rate": 10, "motion": motion, "latitude": 0.0}),
                (ValueError, "three", {"rate": 10, "duration": 1, "field": [1.0]}),
                (ValueError, "exclude", {"rate": 10, "duration": 1, "only": "bias",
                                         "without": "noise"}),
                (imukit.Error, "mean", {"rate": 10, "duration": 1, "only": "biass"}),
                (imukit.FileError, "none.yaml", {"rate": 10, "motion": "none.yaml"}),
                (imukit.Error, "", {"rate": 10, "duration": 1, "temperature": "5 m"}),
                (imukit.Error, "", {"rate": 10, "duration": 1, "temperature": -5}),
                (imukit.Error, "", {"rate": 10, "duration": 1, "temperature": math.nan}),
                (TypeError, "", {"rate": 10, "duration": 1, "temperature": object()}),
                (TypeError, "", {"rate": 10, "motion": 5}),
                (ValueError, "threads", {"rate": 10, "duration": 1, "threads": -1})):
            with self.subTest(str(given)):
                with self.assertRaises(kind) as caught:
                    imukit.simulate("tactical", **given)
                self.assertIn(words, str(caught.exception))
        for model in (None, 5, "no such device", object()):
            if model is not None:
                with self.subTest(model=model), self.assertRaises((TypeError, imukit.Error)):
                    imukit.simulate(model, 10, 1)
        with self.assertRaises(ValueError):
            imukit.simulate_blocks("tactical", 10, 1, 0)
        with self.assertRaises(ValueError):
            imukit.simulate_runs("tactical", 0, 10, 1)

    def test_progress(self):
        seen = []
        imukit.simulate("tactical", 100, 10, progress=lambda *said: seen.append(said))
        self.assertEqual(seen[-1][2:], (1000, 1000))
        with self.assertRaises(imukit.Error) as caught:
            imukit.simulate("tactical", 100, 10, progress=lambda *said: False)
        self.assertEqual(caught.exception.code, "IMK_ERROR_CANCELLED")

    def test_motions(self):
        with self.assertRaises(imukit.Error) as caught:
            imukit.Motion.parse("imukit_motion: 1\nsteps: [turn]\n")
        self.assertEqual(caught.exception.line, 2)
        for columns in ({}, {"time": [0.0]}, {"time": [0.0, 1.0], "speed": [1.0, 1.0]},
                        {"gyro_x": [0.0, 1.0]}, {"time": [0.0, 0.0], "roll": [0.0, 0.0]},
                        {"time": [0.0, 1.0], "roll": [0.0, math.nan]}, 5, None, ["x"]):
            with self.subTest(str(columns)), \
                    self.assertRaises((imukit.Error, ValueError, TypeError)):
                imukit.Motion(columns)
        with self.assertRaises(TypeError):
            imukit.Motion.parse(CAR).truth(10, 1, 5)
        with self.assertRaises(TypeError):
            imukit.Motion.at_rest().truth(10)


class Stated(unittest.TestCase):
    def test_what_is_no_argument(self):
        for kind, named in ((TypeError, {"seed": None}), (ValueError, {"seed": -1}),
                            (ValueError, {"run": -1}), (ValueError, {"substeps": 0}),
                            (ValueError, {"field": [1e-5, 0, 4e-5]})):
            with self.subTest(named=named), self.assertRaisesRegex(kind, [*named][0]):
                imukit.simulate("AHRS", 100, 1, **named)
        with self.assertRaisesRegex(TypeError, "expected a model"):
            imukit.simulate(None, 100, 1)
        with self.assertRaisesRegex(TypeError, "cannot be copied"):
            copy.copy(imukit.simulate_blocks("AHRS", 100, 1))

    def test_text_of_a_script(self):
        text = "imukit_motion: 1\nsteps: [hold 1 s, rotate z 90 deg at 90 deg/s]"
        log = imukit.simulate("AHRS", 100, motion=text)
        due = imukit.simulate("AHRS", 100, motion=imukit.Motion.parse(text))
        self.assertEqual(list(log["gyro_z"]), list(due["gyro_z"]))


class Temperatures(unittest.TestCase):
    def test_of_no_sensor(self):
        with self.assertWarnsRegex(imukit.DataWarning, "write 25degC"):
            log = imukit.simulate("AHRS", rate=100, duration=1, temperature=25)
        with self.assertWarnsRegex(imukit.DataWarning, "write 300K"):
            imukit.compensate(log, "AHRS", temperature="300 degC")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for usual in (298.15, "25 degC", "-90 degC", "190 degC"):
                log = imukit.simulate("AHRS", rate=100, duration=1, temperature=usual)
                imukit.compensate(log, "AHRS", temperature=usual)


if __name__ == "__main__":
    unittest.main()
