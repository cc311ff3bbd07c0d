# SPDX-License-Identifier: Apache-2.0
"""Overlapped or modified Allan deviation at octave tau the way it is usually written with NumPy.

usage: numpy_allan.py SAMPLES [oadev|mdev]   prints the best time of three runs [s]
"""
import sys
import time

import numpy as np


def overlapped_deviations(rate):
    phase = np.concatenate(([0.0], np.cumsum(rate - rate.mean())))
    deviations = []
    m = 1
    while m <= len(rate) // 2:
        d = phase[2 * m :] - 2 * phase[m:-m] + phase[: -2 * m]
        deviations.append(np.sqrt(np.sum(d**2) / (2.0 * m * m * len(d))))
        m *= 2
    return deviations


def modified_deviations(rate):
    phase = np.concatenate(([0.0], np.cumsum(rate - rate.mean())))
    total = np.concatenate(([0.0], np.cumsum(phase)))
    deviations = []
    m = 1
    while m <= len(phase) // 3:
        d = total[3 * m :] - 3 * total[2 * m : -m] + 3 * total[m : -2 * m] - total[: -3 * m]
        deviations.append(np.sqrt(np.sum(d**2) / (2.0 * m**4 * len(d))))
        m *= 2
    return deviations


rate = np.random.default_rng(1).standard_normal(int(sys.argv[1]))
statistic = modified_deviations if sys.argv[2:] == ["mdev"] else overlapped_deviations
best = float("inf")
for _ in range(3):
    start = time.perf_counter()
    statistic(rate)
    best = min(best, time.perf_counter() - start)
print(best)
