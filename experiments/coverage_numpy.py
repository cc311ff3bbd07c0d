#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Do the intervals hold on records that NumPy made?

usage: coverage_numpy.py IMUKIT [records] [seed]

Neither the generators nor the transforms are imukit's: normal numbers of NumPy's PCG64, flicker
noise by fractional differences with its FFT [HOSKING1981]. Records of 2^16 samples at 100 Hz, six
channels to a file. Prints for each mixture the share of logs without a warning, how often the 95 %
intervals of N, B, K and R hold, and how often K and R are claimed with and without zero in their
interval."""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

SAMPLES, RATE, CHANNELS = 1 << 16, 100.0, 6
NAMES = ("white", "bias_instability", "random_walk", "ramp")
MIXTURES = {"N B": (1, 1, 0, 0), "N B K": (1, 1, 0.3, 0), "N R": (1, 0, 0, 0.002),
            "N B R": (1, 1, 0, 0.012)}


def flicker(random, strength):
    """Samples of S = B^2 dt/(2 sin(pi f dt)), with as many before them."""
    k = np.arange(1, 2 * SAMPLES)
    weights = np.concatenate(([1.0], np.cumprod((k - 0.5) / k)))
    white = random.standard_normal(2 * SAMPLES)
    size = 4 * SAMPLES
    return strength * np.fft.irfft(np.fft.rfft(white, size) * np.fft.rfft(weights, size),
                                   size)[SAMPLES:2 * SAMPLES]


def record(random, mixture):
    n, b, k, r = mixture
    x = n * np.sqrt(RATE) * random.standard_normal(SAMPLES)
    x += k / np.sqrt(RATE) * np.cumsum(random.standard_normal(SAMPLES))
    x += r / RATE * np.arange(SAMPLES)
    return x + flicker(random, b) if b else x


def identify(command, path):
    columns = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    out = subprocess.run([command, "identify", path, "--rate", "100Hz", "--columns", columns,
                          "--gyro-unit", "rad/s", "--accel-unit", "m/s^2", "--keep", "all",
                          "--json"], capture_output=True, check=True)
    return json.loads(out.stdout)["result"]


def main():
    command, records = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 60
    random = np.random.Generator(np.random.PCG64(int(sys.argv[3]) if len(sys.argv) > 3 else 1))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "records.npy")
        for name, mixture in MIXTURES.items():
            held, claimed, certain, count, clear = {}, {}, {}, 0, 0
            for _ in range(records // CHANNELS):
                np.save(path, np.stack([record(random, mixture) for _ in range(CHANNELS)], axis=1))
                result = identify(command, path)
                clear += all(m["level"] != "warning" or m["code"] == "gravity"
                             for m in result["verdict"])
                for channel in result["channels"]:
                    count += 1
                    estimates = list(channel["terms"].values())[1:]  # quantization is the first
                    for term, truth, e in zip(NAMES, mixture, estimates):
                        lower, upper = e["lower"], e["upper"]
                        held[term] = held.get(term, 0) + (lower <= truth <= upper)
                        claimed[term] = claimed.get(term, 0) + e["present"]
                        certain[term] = certain.get(term, 0) + (
                            e["present"] and not lower <= 0 <= upper)
            print(f"{name}: {count} records, logs without a warning "
                  f"{100 * clear * CHANNELS / count:.0f} %")
            for term in NAMES:
                print(f"    {term:17} holds {100 * held[term] / count:5.1f} %  claimed "
                      f"{100 * claimed[term] / count:5.1f} %, without an alternative "
                      f"{100 * certain[term] / count:5.1f} %", flush=True)


main()
