# SPDX-License-Identifier: Apache-2.0
"""Derives the two cubics of src/noise/flicker.c: variance (relative to the others) and phi of the
fastest stage as functions of ln x, x the time of the next one in sample intervals. Prints them and
how far the Allan deviation of the sum is from that of ideal flicker noise.

    python3 tests/reference/flicker_stages.py        (needs numpy and scipy; half a minute)
"""
import numpy as np
from scipy.optimize import minimize

SHORTEST = 1.5
VARIANCE = np.log(4) / np.pi
ENDLESS = 28  # stages that stand for all slower ones
DIGITS = 5
LONGEST = 3 * np.pi / (8 * np.log(4))


def variance_of_sum(n, hold, phi):
    """Of n samples of a stage of unit variance held for `hold` samples, at random phase."""
    a, p = np.floor(n / hold), 1 - phi
    b = n - a * hold
    decay = phi**a
    e0 = hold - p * (hold - 1) / 2
    e1 = hold * (hold - 1) / 2 - p * (hold - 1) * (2 * hold - 1) / 6
    g0 = (1 - decay) / p
    g1 = (phi * g0 - a * decay) / p
    rest = b * (b + 1) / 2 - p / hold * (b - 1) * b * (b + 1) / 6
    return 2 * ((n * e0 - e1) * g0 - hold * e0 * g1 + decay * rest) - n


def allan_variance(n, hold, phi):
    return (4 * variance_of_sum(n, hold, phi) - variance_of_sum(2 * n, hold, phi)) / (2 * n**2)


def slower(x, n, stages=ENDLESS):
    """Of stage 1, whose time is x sample intervals, and the next, in units of the ideal floor,
    which is the variance of each, (ln 4/pi) B^2 = (2 ln 2/pi) B^2."""
    return sum(allan_variance(n, 4.0**j, (2 * x - 1) / (2 * x + 1)) for j in range(stages))


def best_fastest(x, n, start):
    others = slower(x, n)

    def worst(p):
        total = p[0] * allan_variance(n, 1.0, p[1]) + others
        return np.max(np.abs(np.sqrt(np.maximum(total, 1e-9)) - 1))

    for _ in range(3):
        start = minimize(worst, start, method="Nelder-Mead", bounds=[(0, 5), (0, 0.99)],
                         options=dict(xatol=1e-10, fatol=1e-13, maxiter=8000)).x
    return start


def cubic(coefficients, x):
    return np.polynomial.polynomial.polyval(np.log(x), coefficients)


tuned = np.unique(np.concatenate([np.arange(2, 65), np.round(np.geomspace(64, 1000, 150))])) * 1.0
places = np.geomspace(SHORTEST, 4 * SHORTEST, 21)
found, p = [], [0.5, 0.28]
for place in places:
    p = best_fastest(place, tuned, p)
    found.append(p)
found = np.array(found)
variance, decay = (
    np.round(np.polynomial.polynomial.polyfit(np.log(places), found[:, k], 3), DIGITS)
    for k in range(2)
)
print("variance:", *variance)
print("phi:     ", *decay)

n = np.unique(np.round(np.concatenate([np.arange(1, 400), np.geomspace(400, 1e7, 800)]))) * 1.0
worst = {"1": [], "2 ...": [], "100 ...": []}
for x in np.geomspace(SHORTEST, 4 * SHORTEST * 0.999, 60):
    total = cubic(variance, x) * allan_variance(n, 1.0, cubic(decay, x)) + slower(x, n)
    error = np.sqrt(total) - 1
    worst["1"] += [error[0]]
    worst["2 ..."] += [error[1:].min(), error[1:].max()]
    worst["100 ..."] += [error[99:].min(), error[99:].max()]
for where, errors in worst.items():
    print(f"tau = {where} dt: {min(errors):+.2e} ... {max(errors):+.2e}")

# The end: 16 stages up to the longest time, 3 pi/(8 ln 4) T_L.
for part in (1e-3, 1e-2, 0.03, 0.1, 0.3, 1):
    errors = []
    for x in np.geomspace(SHORTEST, 4 * SHORTEST * 0.999, 20):
        m = np.round(part * x * 4.0**15 / LONGEST)
        total = cubic(variance, x) * allan_variance(m, 1.0, cubic(decay, x)) + slower(x, m, 16)
        errors.append(np.sqrt(total) - 1)
    print(f"tau = {part} T_L: {min(errors):+.2e} ... {max(errors):+.2e}")

# The spectrum, times 2 pi f/B^2, from T 1e-3 to 0.1/dt; and its mean over whole ratios of 4.
extremes, means = [], []
for x in np.geomspace(SHORTEST, 4 * SHORTEST * 0.999, 20):
    f = 0.1 / 4.0 ** np.linspace(0, 9, 1801)[:-1]
    s = np.sin(np.pi * f) ** 2
    phi = cubic(decay, x)
    total = cubic(variance, x) * (1 - phi**2) / ((1 - phi) ** 2 + 4 * phi * s)
    phi = (2 * x - 1) / (2 * x + 1)
    for j in range(ENDLESS):
        held = np.sin(np.pi * f * 4.0**j) ** 2
        total += (1 - phi**2) * held / s / 4.0**j / ((1 - phi) ** 2 + 4 * phi * held)
    ratio = VARIANCE * total * 2 * np.pi * f
    extremes += [ratio.min(), ratio.max()]
    means.append(ratio[600:].mean())
print(f"spectrum below 0.1/dt: {min(extremes):.3f} ... {max(extremes):.3f} of B^2/(2 pi f)")
print(f"its mean over seven ratios of 4: {min(means):.4f} ... {max(means):.4f}")
