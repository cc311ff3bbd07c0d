# SPDX-License-Identifier: Apache-2.0
"""Normal gravity of WGS84 above the ellipsoid from the closed potential in ellipsoidal-harmonic
coordinates [HEISKANEN1967, section 2-7], differentiated numerically: the values in
tests/motion/test_earth.c.

    python3 tests/reference/ellipsoidal_gravity.py
"""
from decimal import Decimal as D, getcontext

getcontext().prec = 50
A, B = D(6378137), D(6378137) * (1 - 1 / D("298.257223563"))
GM, RATE = D("3986004.418e8"), D("7.292115e-5")
E2 = A * A - B * B
E = E2.sqrt()


def arctangent(x):
    """For |x| < 0.1."""
    term, total, k = x, x, 1
    while abs(term) > D("1e-48"):
        term *= -x * x
        k += 2
        total += term / k
    return total


def q(u):
    return ((1 + 3 * u * u / E2) * arctangent(E / u) - 3 * u / E) / 2


def potential(x, z):
    r2 = x * x + z * z
    u2 = ((r2 - E2) + ((r2 - E2) ** 2 + 4 * E2 * z * z).sqrt()) / 2
    u = u2.sqrt()
    shape = RATE**2 * A * A / 2 * q(u) / q(B) * (z * z / u2 - D(1) / 3)
    return GM / E * arctangent(E / u) + shape + RATE**2 * x * x / 2


def gravity(sine_squared, height):
    s, c = sine_squared.sqrt(), (1 - sine_squared).sqrt()
    n = A / (1 - E2 / (A * A) * sine_squared).sqrt()
    x, z, d = (n + height) * c, (n * (1 - E2 / (A * A)) + height) * s, D("1e-8")
    gx = (potential(x + d, z) - potential(x - d, z)) / (2 * d)
    gz = (potential(x, z + d) - potential(x, z - d)) / (2 * d)
    return (gx * gx + gz * gz).sqrt()


for degrees, square in ((0, D(0)), (30, D("0.25")), (45, D("0.5")), (90, D(1))):
    for height in (0, 1000, 10000):
        print(degrees, height, f"{gravity(square, D(height)):.10f}")
