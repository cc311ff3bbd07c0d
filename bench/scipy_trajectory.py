# SPDX-License-Identifier: Apache-2.0
"""Angular rate and specific force along a table of poses, the way they are made with SciPy: cubic
splines of position and attitude, differentiated.

usage: scipy_trajectory.py means|points POSES COUNT SAMPLE_RATE SAMPLES [RESULT]

`means` takes the mean over each sample from the two nodes of Gauss's formula, the cheapest whose
error is of fourth order; `points` evaluates once, in the middle of each sample. POSES holds COUNT rows of 8 doubles: time [s], Earth-fixed position less that of the first pose
[m], quaternion x y z w of body to Earth-fixed axes; the first row is the origin [m] in columns 1 to
3. Prints the best time of three runs [s], splines included; writes 6 doubles a sample to RESULT,
and to standard error how the time divides.
"""
import sys
import time

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

EARTH_RATE = np.array([0.0, 0.0, 7.292115e-5])
A, F = 6378137.0, 1 / 298.257223563
B = A * (1 - F)
E2 = F * (2 - F)
GAMMA_E, K, M = 9.7803253359, 0.00193185265241, 0.00344978650684


def gravity(position):
    """Normal gravity of WGS84: Bowring's latitude, Somigliana's formula, second order in height."""
    x, y, z = position.T
    p = np.hypot(x, y)
    # sine and cosine of Bowring's parametric latitude, then of the geodetic one: no arc functions
    u, v = z * A, p * B
    norm = np.hypot(u, v)
    u /= norm
    v /= norm
    s = z + E2 / (1 - E2) * B * u**3
    c = p - E2 * A * v**3
    norm = np.hypot(s, c)
    s /= norm
    c /= norm
    s2 = s * s
    w = np.sqrt(1 - E2 * s2)
    height = p * c + z * s - A * w
    surface = GAMMA_E * (1 + K * s2) / w
    g = surface * (1 - 2 / A * (1 + F + M - 2 * F * s2) * height + 3 / A**2 * height**2)
    # toward the equator, over sine and cosine
    north = -2 * 8.1486e-9 * height * (1 - (0.7365 - 0.353 * height / A) * height / A)
    north += 2 * 7.911e-12 * height * s2
    g_p = -(g + s2 * north) * c / p
    return np.column_stack((x * g_p, y * g_p, (c * c * north - g) * s))


def truth(t, position, quaternion, origin, instant):
    marks = [time.perf_counter()]
    path = CubicSpline(t, position)
    attitude = RotationSpline(t, Rotation.from_quat(quaternion))
    marks.append(time.perf_counter())
    c_be = attitude(instant).inv()
    rate = attitude(instant, 1) + c_be.apply(EARTH_RATE)
    marks.append(time.perf_counter())
    velocity = path(instant, 1)
    acceleration = path(instant, 2)
    acceleration[:, 0] -= 2 * EARTH_RATE[2] * velocity[:, 1]
    acceleration[:, 1] += 2 * EARTH_RATE[2] * velocity[:, 0]
    force = c_be.apply(acceleration - gravity(path(instant) + origin))
    marks.append(time.perf_counter())
    return rate, force, np.diff(marks)


def means(values):
    """Of the two nodes in each sample."""
    return 0.5 * (values[0::2] + values[1::2])


def nodes(kind, count, sample_rate):
    """The instants at which a kind of record is evaluated."""
    middle = np.arange(count) + 0.5
    if kind == "points":
        return middle / sample_rate
    away = 0.5 / np.sqrt(3)
    return np.column_stack((middle - away, middle + away)).ravel() / sample_rate


kind, path, count, sample_rate, samples = sys.argv[1:6]
rows = np.fromfile(path).reshape(-1, 8)
origin, poses = rows[0, 1:4], rows[1 : int(count) + 1]
columns = poses[:, 0].copy(), poses[:, 1:4].copy(), poses[:, 4:].copy()
instant = nodes(kind, int(samples), float(sample_rate))
best = float("inf")
for _ in range(5):
    start = time.perf_counter()
    rate, force, parts = truth(*columns, origin, instant)
    if kind == "means":
        rate, force = means(rate), means(force)
    elapsed = time.perf_counter() - start
    if elapsed < best:
        best, best_parts = elapsed, parts
if len(sys.argv) > 6:
    np.hstack((rate, force)).tofile(sys.argv[6])
print(best)
print(
    "scipy_trajectory: %d poses, %s: splines %.1f ms, attitude %.1f ms, force %.1f ms"
    % (len(poses), kind, *(1e3 * best_parts)),
    file=sys.stderr,
)
