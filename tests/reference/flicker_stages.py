# SPDX-License-Identifier: Apache-2.0
"""Derives FASTEST of src/noise/flicker.c, the variance of the fastest stage relative to the others,
and prints how far the Allan deviation of the sum is from the ideal one.

    python3 tests/reference/flicker_stages.py        (needs numpy and scipy)
"""
import numpy as np
from scipy.optimize import minimize_scalar

STAGES = 16
VARIANCE = np.log(4) / np.pi
IDEAL = 2 * np.log(2) / np.pi


def variance_of_sum(n, hold, phi):
    """Of n samples of a stage of unit variance held for `hold` samples, at random phase."""
    a, p = np.floor(n / hold), 1 - phi
    b = n - a * hold
    decay = np.exp(a * np.log(phi))
    e0 = hold - p * (hold - 1) / 2
    e1 = hold * (hold - 1) / 2 - p * (hold - 1) * (2 * hold - 1) / 6
    g0 = (1 - decay) / p
    g1 = (phi * g0 - a * decay) / p
    rest = b * (b + 1) / 2 - p / hold * (b - 1) * b * (b + 1) / 6
    return 2 * ((n * e0 - e1) * g0 - hold * e0 * g1 + decay * rest) - n


def allan_variance(n, hold, phi):
    return (4 * variance_of_sum(n, hold, phi) - variance_of_sum(2 * n, hold, phi)) / (2 * n**2)


def deviation(fastest, n):
    n = np.asarray(n, float)
    total = fastest * allan_variance(n, 1, np.exp(-1.0))
    for stage in range(1, STAGES):
        total += allan_variance(n, 4.0 ** (stage - 1), np.exp(-0.25))
    return np.sqrt(VARIANCE * total / IDEAL)


tuned = np.arange(2, 301)
best = minimize_scalar(
    lambda fastest: np.max(np.abs(deviation(fastest, tuned) - 1)), bounds=(1.1, 1.3), method="bounded"
)
print(f"fastest {best.x:.5f}, largest deviation over 2 ... 300 dt {best.fun:.2e}")
for lower, upper in ((2, 1e7), (1e7, 1e8), (1e8, 2e8), (2e8, 1e9)):
    n = np.unique(np.round(np.geomspace(lower, upper, 1000)))
    values = deviation(1.20785, n) - 1
    print(f"{lower:.0e} ... {upper:.0e} dt: {values.min():+.2e} ... {values.max():+.2e}")
