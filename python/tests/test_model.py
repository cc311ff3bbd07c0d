# SPDX-License-Identifier: Apache-2.0
"""Models: every value of a file by its path, and what is no value."""
import array
import copy
import math
import pathlib
import pickle
import tempfile
import unittest

import imukit

EVERY_KEY = """imukit: 1
name: every key
gyro:
  direction: [1 0 0, 0 1 0, 0 0 1]
  sensitivity: 4778 4758 4766 count/(rad/s)
  zero_offset: 32768 count
  bias:
    fixed: 0.1 -0.2 0.05 ± 0.01 deg/h   # of the laboratory
    temperature:
      reference_temperature: 25 degC
      valid_range: -40 85 degC
      coefficients: [0.1 0.2 0.3 deg/h/K, 1e-3 deg/h/K^2]
    warm_up: {amplitude: 2 deg/h, time: 10 min}
  scale_factor:
    temperature: {reference_temperature: 298 K, valid_range: 233 358 K, coefficients: 5 ppm/K}
  misalignment: 0.1 0.2 0.3 0.4 0.5 0.6 mrad
  g2_sensitivity: [0.1 0 0 0 0 0 deg/h/g^2, 0 0 0 0 0 0 deg/h/g^2, 0 0 0 0 0 0.2 deg/h/g^2]
  noise:
    density: one-sided
    angle_random_walk: 0.01 deg/s/sqrt(Hz)
    allan_floor: 2 deg/h
    gauss_markov:
      - {sigma: 0.2 deg/h, correlation_time: 300 s}
      - {sigma: 1 2 3 deg/h, correlation_time: 2 s}
    resonance: [{sigma: 0.01 deg/s, frequency: 20.3 Hz, q: 16}]
  bandwidth: 61 Hz
  damping: 0.7
  evidence:
    source: "a log: 3 h"
    interval_95:
      noise.gauss_markov[1].sigma: [0.5 deg/h, 4 deg/h]
    upper_bound: {noise.quantization: 0.6 arcsec}
accel:
  bias: {fixed: 0 mg, repeatability: 1 mg}
  lever_arm: [0 0 0 mm, 5 0 0 mm, 0 5 0 mm]
timing: {rate_error: 20 ppm, drops: 0.1 %}
correlation:
  parameters: [gyro.bias.fixed.x, gyro.bias.temperature.x.2, gyro.bias.fixed.y]
  values: [-0.5, 0.25 1e-3]
"""
DEGREE_PER_HOUR = math.pi / 180 / 3600


class Values(unittest.TestCase):
    def setUp(self):
        self.model = imukit.Model.parse(EVERY_KEY)

    def near(self, path, due):
        found = self.model[path]
        flat = [x for row in found for x in (row if isinstance(row, tuple) else [row])] \
            if isinstance(found, tuple) else [found]
        self.assertEqual(len(flat), len(due), path)
        for a, b in zip(flat, due):
            self.assertAlmostEqual(a, b, delta=1e-12 * max(1e-3, abs(b)))

    def test_read(self):
        d = DEGREE_PER_HOUR
        self.near("gyro.bias.fixed", [0.1 * d, -0.2 * d, 0.05 * d])
        self.assertAlmostEqual(self.model.sigma("gyro.bias.fixed")[1], 0.01 * d, 15)
        self.near("gyro.bias.warm_up.time", [600])
        self.near("gyro.bias.temperature.valid_range", [233.15, 358.15])
        self.near("gyro.bias.temperature.coefficients[1]", [1e-3 * d] * 3)
        self.near("gyro.scale_factor.temperature.coefficients[0]", [5e-6] * 3)
        self.near("gyro.misalignment", [0, 1e-4, 2e-4, 3e-4, 0, 4e-4, 5e-4, 6e-4, 0])
        self.near("gyro.noise.angle_random_walk", [math.radians(0.01) / math.sqrt(2)] * 3)
        self.near("gyro.noise.allan_floor", [2 * d] * 3)
        self.near("gyro.noise.gauss_markov[1].sigma", [d, 2 * d, 3 * d])
        self.near("gyro.damping", [0.7] * 3)
        self.near("gyro.evidence.interval_95.noise.gauss_markov[1].sigma", [0.5 * d, 4 * d] * 3)
        self.near("gyro.evidence.upper_bound.noise.quantization", [math.radians(0.6 / 3600)] * 3)
        self.near("timing.drops", [0.001])
        self.assertEqual(self.model["accel.bias.fixed"], (0, 0, 0))
        self.assertEqual(self.model["name"], "every key")
        self.assertEqual(self.model["gyro.noise.density"], "one-sided")
        self.assertEqual(self.model["correlation.values"], ((-0.5,), (0.25, 1e-3)))
        self.assertEqual(self.model["correlation.parameters"][1], "gyro.bias.temperature.x.2")

    def test_every_value_can_be_set_to_itself(self):
        for path in self.model:
            with self.subTest(path):
                other = self.model.copy()
                value = self.model[path]
                other[path] = self.model.text(path)
                self.assertEqual(other, self.model)
                if not isinstance(value, str) and "parameters" not in path:
                    other[path] = value
                    self.assertEqual(other[path], value)
                self.assertIn(path, other)

    def test_every_value_can_be_removed(self):
        for path in self.model:
            other = self.model.copy()
            try:
                del other[path]
            except imukit.Error:
                self.assertEqual(other, self.model)  # it needs the others
            else:
                self.assertNotIn(path, list(other) if "[" not in path else [])
                self.assertNotEqual(other, self.model)

    def test_set(self):
        m = self.model
        m["gyro.bias.fixed"] = 1e-5
        self.assertEqual(m["gyro.bias.fixed"], (1e-5,) * 3)
        m["gyro.bias.fixed"] = array.array("d", [1e-5, 2e-5, 3e-5])
        self.assertEqual(m["gyro.bias.fixed"], (1e-5, 2e-5, 3e-5))
        m["gyro.g2_sensitivity"] = [[1e-6] * 6] * 3
        self.assertEqual(m["gyro.g2_sensitivity"], ((1e-6,) * 6,) * 3)
        m["gyro.bias.temperature.coefficients"] = [1e-6, [1e-8, 2e-8, 3e-8]]
        self.assertEqual(m["gyro.bias.temperature.coefficients[1]"], (1e-8, 2e-8, 3e-8))
        m["gyro.scale_factor.temperature.coefficients[1]"] = 1e-9
        self.assertEqual(m["gyro.scale_factor.temperature.coefficients[1]"], (1e-9,) * 3)
        m["gyro.noise.gauss_markov[2]"] = {"sigma": 1e-6, "correlation_time": "1 min"}
        self.assertEqual(m["gyro.noise.gauss_markov[2].correlation_time"], (60,) * 3)
        m.set("gyro.g2_sensitivity", [[1e-6] * 6] * 3, sigma=1e-7)
        self.assertEqual(m.sigma("gyro.g2_sensitivity")[2][0], 1e-7)
        m["gyro.evidence.interval_95.bias.fixed"] = (1e-6, 2e-6)
        self.assertEqual(m["gyro.evidence.interval_95.bias.fixed"], ((1e-6, 2e-6),) * 3)
        m["mag"] = {"sensitivity": 15, "zero_offset": 0}
        self.assertEqual(m["mag.sensitivity"], (15.0,) * 3)
        single = imukit.Model()
        single["gyro.direction"] = [[0, 0, 1]]
        self.assertEqual(single["gyro.direction"], ((0, 0, 1),))

    def test_text_is_kept(self):
        self.model["gyro.damping"] = 0.6
        text = self.model.yaml()
        self.assertEqual(text, EVERY_KEY.replace("damping: 0.7", "damping: 0.6"))
        self.assertIn("# of the laboratory", text)

    def test_attributes(self):
        m = self.model
        self.assertEqual(m.gyro.noise.gauss_markov[1].sigma,
                         m["gyro.noise.gauss_markov[1].sigma"])
        m.gyro.noise.gauss_markov[0].correlation_time = 5
        self.assertEqual(m["gyro.noise.gauss_markov[0].correlation_time"], (5,) * 3)
        m.accel.noise.velocity_random_walk = "0.1 m/s/sqrt(h)"
        self.assertIn("accel.noise.velocity_random_walk", m)
        self.assertEqual([t.sigma for t in m.gyro.noise.gauss_markov][1],
                         m["gyro.noise.gauss_markov[1].sigma"])
        self.assertEqual(len(m.gyro.noise.sinusoid), 0)
        self.assertEqual(list(m.gyro.noise.sinusoid), [])
        self.assertIn("rate_random_walk", dir(m.gyro.noise))
        m.mag.bias.fixed = [1e-6, 0, 0]
        self.assertEqual(m["mag.bias.fixed"][0], 1e-6)
        del m.mag
        self.assertNotIn("mag", m)
        self.assertEqual(m.gyro.evidence.upper_bound["noise.quantization"],
                         m["gyro.evidence.upper_bound.noise.quantization"])
        with self.assertRaisesRegex(AttributeError, "not stated"):
            m.gyro.noise.rate_random_walk
        with self.assertRaises(AttributeError):
            m.gyros = {}
        with self.assertRaises(AttributeError):
            m.gyro.noises

    def test_copies(self):
        for other in (self.model.copy(), copy.deepcopy(self.model), imukit.Model(self.model),
                      imukit.Model(self.model.to_dict()), pickle.loads(pickle.dumps(self.model))):
            self.assertEqual(other, self.model)
            other["name"] = "another"
            self.assertNotEqual(other, self.model)
        self.assertNotEqual(self.model, "a text")
        with self.assertRaises(TypeError):
            hash(self.model)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("unit.yaml", "unit.json"):
                path = pathlib.Path(folder, name)
                self.model.save(path)
                self.assertEqual(imukit.Model(path), self.model)

    def test_terms(self):
        less = self.model.without("gyro.bias")
        self.assertEqual(less["gyro.noise.allan_floor"], self.model["gyro.noise.allan_floor"])
        self.assertNotIn("gyro.bias.fixed", less)
        with self.assertRaisesRegex(imukit.Error, "did you mean"):
            self.model.only("gyro.bia")
        given = self.model.assume_class("tactical")
        self.assertIn("gyro.bias.repeatability", given)
        self.assertGreater(self.model["gyro.bias.repeatability"][0], 0)

    def test_new(self):
        model = imukit.Model(name="new")
        self.assertEqual(list(model), ["name", "gyro", "accel"])
        model.update({"gyro.bias.warm_up.amplitude": 1e-5, "gyro.bias.warm_up.time": 60})
        self.assertEqual(model["gyro.bias.warm_up.time"], 60)
        del model["gyro"]
        self.assertEqual(list(model), ["name", "accel"])


class Refused(unittest.TestCase):
    def test_values(self):
        model = imukit.Model("tactical")
        before = model.yaml()
        for kind, words, path, value in (
                (imukit.Error, "deg/h", "gyro.bias.fixed", "1 m"),
                (imukit.Error, "unit", "gyro.bias.fixed", "1"),
                (imukit.Error, "axes", "gyro.bias.fixed", [1.0, 2.0]),
                (imukit.Error, "gyro.bias.repeatability", "gyro.bias.repeatability", -1.0),
                (imukit.Error, "finite", "gyro.bias.fixed", math.nan),
                (imukit.Error, "finite", "gyro.bias.fixed", math.inf),
                (imukit.Error, "did you mean", "gyro.bias.fixd", 1.0),
                (imukit.Error, "did you mean", "gyros.bias.fixed", 1.0),
                (imukit.Error, "warm_up", "gyro.bias.warm_up", {"amplitude": 1.0}),
                (imukit.Error, "", "gyro.bias.fixed", ""),
                (imukit.Error, "", "gyro.bias.fixed", []),
                (imukit.Error, "", "gyro", "text"),
                (imukit.Error, "", "imukit", 2),
                (imukit.Error, "", "gyro.bias.fixed", {"x": 1.0}),
                (imukit.Error, "", "gyro.noise.density", "both"),
                (imukit.Error, "", "name", "x" * 1000),
                (TypeError, "bool", "gyro.bias.fixed", True),
                (TypeError, "NoneType", "gyro.bias.fixed", None),
                (TypeError, "object", "gyro.bias.fixed", object()),
                (TypeError, "bytes", "gyro.bias.fixed", [b"1"]),
                (KeyError, "no such element", "gyro.noise.gauss_markov[3].sigma", 1.0),
                (KeyError, "no such element", "name.first", 1.0),
                (KeyError, "no path", "", 1.0),
                (KeyError, "no path", "gyro..bias", 1.0),
                (KeyError, "no path", "gyro.bias.fixed[x]", 1.0)):
            with self.subTest(path=path, value=value):
                with self.assertRaises(kind) as caught:
                    model[path] = value
                self.assertIn(words, str(caught.exception))
                self.assertEqual(model.yaml(), before)
        with self.assertRaises(TypeError):
            model[5] = 1.0

    def test_missing(self):
        model = imukit.Model("tactical")
        for path in ("gyro.noise.rate_ramp", "gyro.noise.gauss_markov[0].sigma", "mag.bias.fixed",
                     "mag", "", "gyro.", "nothing", "gyro.bias.fixed[0]", "timing.jitter"):
            with self.subTest(path):
                self.assertNotIn(path, model)
                for action in (model.__getitem__, model.__delitem__, model.sigma, model.text):
                    with self.assertRaises(KeyError):
                        action(path)
        self.assertEqual(model.get("gyro.noise.rate_ramp", 5), 5)
        self.assertEqual(model.unit("gyro.noise.rate_ramp"), "rad/s^2")
        with self.assertRaises(KeyError):
            model.unit("gyro.noise")
        self.assertNotIn(5, model)

    def test_sources(self):
        with self.assertRaisesRegex(imukit.Error, "nearest|did you mean|ADIS"):
            imukit.Model("ADIS1648")
        with self.assertRaises(imukit.Error) as caught:
            imukit.Model.parse("imukit: 1\ngyro: {bias: {fixed: 1 m}}\n")
        self.assertEqual(caught.exception.line, 2)
        for source in (5, b"\xff", ["a"], object()):
            with self.assertRaises((TypeError, imukit.Error)):
                imukit.Model(source)
        for name in (5, ["a"]):
            with self.assertRaises((TypeError, imukit.Error)):
                imukit.Model(name=name)
        with self.assertRaises(ValueError):
            imukit.Model("tactical").assume_class("best")


class Copied(unittest.TestCase):
    def test_groups(self):
        group = imukit.Model("AHRS").gyro
        for made in (copy.copy(group), copy.deepcopy(group), pickle.loads(pickle.dumps(group))):
            self.assertEqual(made.to_dict(), group.to_dict())

    def test_paths_as_keys(self):
        model = imukit.Model("AHRS")
        self.assertEqual(imukit.Model(dict(model)).gyro.to_dict().keys(),
                         model.gyro.to_dict().keys())
        made = imukit.Model({"gyro.bias.fixed": [1.0, 2.0, 3.0]})
        self.assertEqual(made["gyro.bias.fixed"], (1.0, 2.0, 3.0))
        with self.assertRaisesRegex(TypeError, "cannot be empty"):
            model.clear()
        self.assertEqual(model.only(["gyro.noise"]), model.only("gyro.noise"))


if __name__ == "__main__":
    unittest.main()
