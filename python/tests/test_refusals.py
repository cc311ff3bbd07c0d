# SPDX-License-Identifier: Apache-2.0
"""What is refused is said in the words of Python: arguments, radians, classes of exceptions."""
import errno
import math
import os
import pathlib
import pickle
import re
import tempfile
import unittest
import warnings

import imukit


class Files(unittest.TestCase):
    def test_missing(self):
        name = "/nowhere/x.csv"
        for read in imukit.read_log, imukit.allan, imukit.Motion:
            with self.assertRaises(FileNotFoundError) as caught:
                read(name)
            error = caught.exception
            self.assertIsInstance(error, imukit.FileError)
            self.assertEqual((error.errno, error.filename), (errno.ENOENT, name))
            self.assertEqual(error.strerror, os.strerror(errno.ENOENT))
            self.assertRegex(str(error), "^/nowhere/x.csv: .*check the path")
            self.assertEqual(str(pickle.loads(pickle.dumps(error))), str(error))

    def test_folder_and_forbidden(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(imukit.FileError) as caught:
                imukit.read_log(folder)
            self.assertNotIsInstance(caught.exception, FileNotFoundError)
            self.assertIn(folder, str(caught.exception))
            path = pathlib.Path(folder, "x.csv")
            path.write_text("time,gyro_x\n0,1\n")
            path.chmod(0)
            if os.getuid():  # root may read all
                with self.assertRaises(PermissionError):
                    imukit.read_log(path)

    def test_what_is_no_file(self):
        with self.assertRaises(imukit.Error) as caught:
            imukit.convert_unit(1, "deg/s", "m")
        self.assertNotIsInstance(caught.exception, OSError)


class Angles(unittest.TestCase):
    def test_degrees_as_numbers(self):
        said = "latitude=45: a number is taken as radians.*'45 deg'"
        for call in (lambda: imukit.normal_gravity(45, 0),
                     lambda: imukit.Motion.parse("imukit_motion: 1\nsteps: [hold 1 s]", latitude=45),
                     lambda: imukit.simulate("tactical", 10, 1, latitude=45)):
            with self.assertRaisesRegex(imukit.Error, said):
                call()
        with self.assertRaisesRegex(imukit.Error, "yaw=90: a number is taken as radians"):
            imukit.simulate("tactical", 10, 1, yaw=90)

    def test_limits(self):
        pole = imukit.normal_gravity(math.pi / 2, 0)
        self.assertEqual(imukit.normal_gravity("90 deg", 0), pole)
        imukit.simulate("tactical", 10, 1, yaw=2 * math.pi, pitch="-360 deg")
        for wrong in None, True, "45 m":
            with self.assertRaises((TypeError, ValueError)):
                imukit.normal_gravity(wrong, 0)


class Sentences(unittest.TestCase):
    def test_results_name_arguments(self):
        wave = [math.sin(1.1 * k * k) for k in range(2000)]
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            result = imukit.identify({"time": [0.01 * k for k in range(2000)], "gyro_x": wave,
                                      "gyro_y": wave[::-1], "gyro_z": wave})
        said = " ".join([str(result), repr(result.to_dict()), *(f.message for f in result.findings),
                         *(str(w.message) for w in told)])
        self.assertIn("with map", said)
        self.assertIsNone(re.search(r"[ (]--[a-z]", said))


class Sizes(unittest.TestCase):
    def test_too_many_samples(self):
        servo = imukit.physics.PendulousServo()
        for settings in {"output_rate": 1e11}, {"signal_rate": 1e11}:
            with self.assertRaisesRegex(MemoryError, "samples of .* lower output_rate"):
                servo.run(10, noise=False, **settings)


if __name__ == "__main__":
    unittest.main()
