# SPDX-License-Identifier: Apache-2.0
"""Copies of logs and results, by pickle and copy, are equal to what they are of."""
import copy
import math
import pathlib
import pickle
import tempfile
import unittest

import imukit


def copies(value):
    return pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)


class Logs(unittest.TestCase):
    def check(self, log):
        for made in copies(log):
            self.assertEqual(made, log)
            self.assertEqual(repr(made), repr(log))
            self.assertEqual([list(made[name]) for name in made if name != "temperature"],
                             [list(log[name]) for name in log if name != "temperature"])

    def test_simulated(self):
        log = imukit.simulate("tactical", 100, 1)
        self.check(log)
        self.assertNotEqual(log, imukit.simulate("tactical", 100, 1, seed=2))
        self.assertNotEqual(log, 1)
        with self.assertRaises(TypeError):
            hash(log)

    def test_read(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "log.csv")
            path.write_text("time [s],gyro_x [deg/s]\n0,180\n0.01,90\n0.02,0\n")
            log = imukit.read_log(path)
            self.check(log)
            path.write_text("time [s],gyro_x [deg/s]\n0,180\n0.01,nan\n0.02,0\n")
            missing = imukit.read_log(path)
        self.assertNotEqual(log, missing)
        self.assertTrue(math.isnan(missing["gyro_x"][1]))
        self.assertEqual(pickle.loads(pickle.dumps(missing)), missing)


class Results(unittest.TestCase):
    def test_equal_and_saved(self):
        result = imukit.allan([float(k * k % 101) for k in range(300)], 1)
        for made in copies(result):
            self.assertEqual(made, result)
        self.assertNotEqual(result, imukit.allan([float(k % 7) for k in range(300)], 1))
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "x.html")
            copy.copy(result).save(page)
            self.assertIn("<html", page.read_text(encoding="utf-8"))
            for kind in "png", "pdf":
                path = pathlib.Path(folder, f"x.{kind}")
                with self.assertRaisesRegex(ValueError, "figures are written as .svg"):
                    result.save(path)
                self.assertFalse(path.exists())

    def test_curves(self):
        x = [float(k * k % 101) for k in range(600)]
        for curve in (imukit.allan(x, 1).curve(), imukit.spectrum(x, 1).curve()):
            for made in copies(curve):
                self.assertEqual(repr(type(made)), repr(type(curve)))
                self.assertEqual(list(made.lower), list(curve.lower))
                self.assertEqual(made.name, curve.name)


class Others(unittest.TestCase):
    def test_motion(self):
        script = "imukit_motion: 1\nsteps: [hold 1 s, rotate z 90 deg at 90 deg/s]"
        for motion in (imukit.Motion.parse(script, latitude="30 deg", height=100),
                       imukit.Motion.parse(script, seed=3),
                       imukit.Motion.at_rest(yaw="20 deg")):
            length = None if motion.kind == "script" else 1
            for made in copies(motion):
                self.assertEqual(repr(made), repr(motion))
                self.assertEqual(made.truth(10, length), motion.truth(10, length))
        columns = imukit.Motion({name: [0.01 * k for k in range(9)] for name in (
            "time [s]", "roll [rad]", "pitch [rad]", "yaw [rad]", "latitude [rad]",
            "longitude [rad]", "height [m]")})
        self.assertEqual(copy.copy(columns).duration, columns.duration)
        self.assertEqual(copy.deepcopy(columns).kind, columns.kind)
        with self.assertRaisesRegex(TypeError, "pickle what it was made of"):
            pickle.dumps(columns)

    def test_figure_is_kept(self):
        result = imukit.allan([float(k * k % 101) for k in range(300)], 1)
        made = pickle.loads(pickle.dumps(result))
        self.assertIn("<svg", made._repr_html_())
        self.assertEqual(made._repr_html_(), result._repr_html_())

    def test_closed_blocks(self):
        with imukit.simulate_blocks("tactical", 100, rows=10) as blocks:
            self.assertEqual(next(blocks).rows, 10)
        self.assertEqual(list(blocks), [])


if __name__ == "__main__":
    unittest.main()
