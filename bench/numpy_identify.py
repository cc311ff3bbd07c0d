# SPDX-License-Identifier: Apache-2.0
"""N, B and K of the channels of a .npy log the way it is usually written with NumPy: overlapped
Allan variances at octave tau, then nonnegative least squares on their relative size.

usage: numpy_identify.py FILE.npy   prints the time of a run [s]
"""
import sys
import time

import numpy as np
from scipy.optimize import nnls


def overlapped_variances(rate):
    phase = np.concatenate(([0.0], np.cumsum(rate - rate.mean())))
    factors, variances = [], []
    m = 1
    while m <= len(rate) // 9:
        d = phase[2 * m :] - 2 * phase[m:-m] + phase[: -2 * m]
        variances.append(np.sum(d**2) / (2.0 * m * m * len(d)))
        factors.append(m)
        m *= 2
    return np.array(factors), np.array(variances)


def identify(rate, dt):
    factors, variances = overlapped_variances(rate)
    tau = factors * dt
    shapes = np.array([1 / tau, np.full(len(tau), 2 * np.log(2) / np.pi), tau / 3]).T
    weights = np.sqrt(len(rate) / factors)
    amounts, _ = nnls(shapes / variances[:, None] * weights[:, None], weights)
    return np.sqrt(amounts)


start = time.perf_counter()
log = np.load(sys.argv[1])
for channel in range(log.shape[1]):
    identify(np.ascontiguousarray(log[:, channel]), 0.01)
print(time.perf_counter() - start)
