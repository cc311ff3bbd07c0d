# SPDX-License-Identifier: Apache-2.0
"""Steady state of an aided navigator at rest, by SciPy's solver of the discrete algebraic Riccati
equation: the values in tests/navigate/drift/aided_riccati.inc.

A unit rests at 45 deg north on the ellipsoid, level, heading north. Gyros and accelerometers have
white noise and a Gauss-Markov bias; position, velocity and heading are read once a second. The
equations are those of docs/theory/navigation-filter.md in north-east-down axes, in two steps of
half a second between readings; gravity is Somigliana's formula.

    python3 tests/reference/aided_riccati.py > tests/navigate/drift/aided_riccati.inc
"""
import numpy as np
from scipy.linalg import solve_discrete_are

RATE = 7.292115e-5
A, FLAT = 6378137.0, 1 / 298.257223563
E2 = FLAT * (2 - FLAT)
SINE2 = 0.5  # of the latitude, squared
GRAVITY = 9.7803253359 * (1 + 0.00193185265241 * SINE2) / np.sqrt(1 - 0.00669437999013 * SINE2)
N = A / np.sqrt(1 - E2 * SINE2)
DISTANCE = np.hypot(N * np.sqrt(0.5), N * (1 - E2) * np.sqrt(0.5))

GYRO_WHITE, GYRO_SIGMA, GYRO_TIME = 1e-4, 2e-5, 40.0
ACCEL_WHITE, ACCEL_SIGMA, ACCEL_TIME = 1e-3, 1e-2, 20.0
POSITION, VELOCITY, HEADING = 1.0, 0.05, 0.01


def cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


# Position, velocity, attitude, gyro bias, accelerometer bias.
w = RATE * np.array([np.sqrt(0.5), 0, -np.sqrt(0.5)])
up = np.array([0, 0, -1.0])
force = GRAVITY * up
F = np.zeros((9, 9))
F[0:3, 3:6] = np.eye(3)
F[3:6, 0:3] = GRAVITY / DISTANCE * (3 * np.outer(up, up) - np.eye(3))
F[3:6, 3:6] = -2 * cross(w)
F[3:6, 6:9] = -cross(force)
F[6:9, 6:9] = -cross(w)
B = np.zeros((9, 6))
B[6:9, 0:3] = np.eye(3)
B[3:6, 3:6] = np.eye(3)


def half_step(h):
    i9 = np.eye(9)
    phi = np.zeros((15, 15))
    phi[:9, :9] = i9 + h * F + h**2 / 2 * F @ F + h**3 / 6 * F @ F @ F
    phi[:9, 9:] = (h * i9 + h**2 / 2 * F + h**3 / 6 * F @ F) @ B
    decay = np.exp(-h / np.repeat([GYRO_TIME, ACCEL_TIME], 3))
    phi[9:, 9:] = np.diag(decay)
    q = np.zeros((15, 15))
    power = np.diag(np.repeat([GYRO_WHITE, ACCEL_WHITE], 3) ** 2) * h
    for s, weight in ((0.0, 1 / 6), (h / 2, 2 / 3), (h, 1 / 6)):
        a = (i9 + s * F + s**2 / 2 * F @ F) @ B
        q[:9, :9] += weight * a @ power @ a.T
    q[9:, 9:] = np.diag(np.repeat([GYRO_SIGMA, ACCEL_SIGMA], 3) ** 2 * (1 - decay**2))
    return phi, q


phi, q = half_step(0.5)
q = phi @ q @ phi.T + q
phi = phi @ phi
H = np.zeros((7, 15))
H[0:6, 0:6] = np.eye(6)
H[6, 8] = 1.0
H[6, 1] = np.sqrt(0.5) / (N * np.sqrt(0.5))  # the meridians converge: sin L / distance from the axis
R = np.diag(np.repeat([POSITION, VELOCITY], 3).tolist() + [HEADING]) ** 2
before = solve_discrete_are(phi.T, H.T, q, R)
gain = before @ H.T @ np.linalg.inv(H @ before @ H.T + R)
after = (np.eye(15) - gain @ H) @ before
loop = np.max(np.abs(np.linalg.eigvals((np.eye(15) - gain @ H) @ phi)))
print("/* SPDX-License-Identifier: Apache-2.0 */")
print("/* 1 sigma before and after a reading, by tests/reference/aided_riccati.py. */")
for name, p in (("before", before), ("after", after)):
    print(f"static const double riccati_{name}[9] = {{")
    values = [repr(float(np.sqrt(p[i, i]))) for i in range(9)]
    for i in range(0, 9, 3):
        print("    " + ", ".join(values[i : i + 3]) + ("," if i < 6 else "};"))
import sys
print("largest eigenvalue of the loop", loop, file=sys.stderr)
