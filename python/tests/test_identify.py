# SPDX-License-Identifier: Apache-2.0
"""Identification of arrays."""
import array
import pickle
import random
import unittest

import imukit


def white(count, sigma=1e-3, seed=1):
    draw = random.Random(seed)
    return array.array("d", (draw.gauss(0, sigma) for _ in range(count)))


class Identify(unittest.TestCase):
    def test_white_noise(self):
        result = imukit.identify(white(20000), 100, columns="gyro_x")
        term = result.terms("gyro_x").angle_random_walk
        # 1e-3 rad/s at 100 Hz is 1e-4 rad/sqrt(s), known to 1/sqrt(2 * 20000) = 0.5 %; 6 sigmas.
        self.assertAlmostEqual(term.value, 1e-4, delta=3e-6)
        self.assertFalse(result.terms("gyro_x").bias_instability.present)
        self.assertIn("angle_random_walk", result.model.yaml())
        self.assertEqual(pickle.loads(pickle.dumps(result)).model, result.model)

    def test_faults_are_told(self):
        x = white(20000)
        for k in range(0, 20000, 1000):
            x[k] = 0.02
        result = imukit.identify(x, 100, columns="gyro_x")
        codes = {m.code for m in result.verdict}
        self.assertIn("outliers", codes)
        kept = imukit.identify(x, 100, columns="gyro_x", keep="outliers", gaps="keep")
        self.assertGreater(kept.terms("gyro_x").angle_random_walk.value,
                           1.05 * result.terms("gyro_x").angle_random_walk.value)

    def test_refused(self):
        for named in ({"keep": "everything"}, {"method": "guess"}, {"tolerance": 0.1},
                      {"confidence": 1.5}, {"significance": 0.7}, {"gauss_markov": 3}):
            with self.subTest(named), self.assertRaises(ValueError):
                imukit.identify(white(1000), 100, **named)


if __name__ == "__main__":
    unittest.main()
