#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Table of src/base/arc_tangent.c and expected values of tests/base/test_arc_tangent.c.

Arc tangents in 60-digit decimal arithmetic, standard library only. Prints atan(i/16) as the sum of
two doubles, pi/2 and pi likewise, and the exact angles of some points, rounded once to a double
and the rest, so that a test can see fractions of an ulp. Run: python3 tests/reference/arc_tangent.py
"""
from decimal import Decimal as D, getcontext
from random import Random

getcontext().prec = 60


def arc_tangent(x):
    """Halved four times, atan x = 2 atan(x/(1 + sqrt(1 + x^2))), then the series."""
    halvings = 8
    for _ in range(halvings):
        x = x / (1 + (1 + x * x).sqrt())
    term, total, k = x, D(0), 1
    while abs(term) > abs(x) * D("1e-58"):
        total += term / k
        term *= -x * x
        k += 2
    return total * 2**halvings


PI = 4 * arc_tangent(D(1))


def angle(y, x):
    y, x = D(y), D(x)
    if x == 0:
        return (PI / 2).copy_sign(y)
    a = arc_tangent(y / x)
    return a if x > 0 else a + PI.copy_sign(y)


def parts(value):
    high = float(value)
    return high, float(value - D(high))


for i in range(17):
    high, low = parts(arc_tangent(D(i) / 16))
    print(f"    {{{high.hex()}, {low.hex()}}},")
for value in (PI / 2, PI):
    print("pi:", *(p.hex() for p in parts(value)))

random = Random(1)
points = [(1.0, 1.0), (1.0, -1.0), (-1.0, -3.0), (0.03125, 1.0), (1.0, 0.03125), (5e-324, 1e-323),
          (1.7e308, 1.6e308), (1e-300, 1e-290), (2.0**-28, 1.0), (2.0**-29, 1.0)]
for _ in range(60):
    scale = 2.0 ** random.randrange(-300, 300)
    ratio = 2.0 ** random.uniform(-12, 12)
    points.append((random.choice((-1, 1)) * scale, random.choice((-1, 1)) * scale * ratio))
for i in range(16):  # where the entry of the table changes
    points.append(((2 * i + 1) / 32, 1.0))
    points.append((1.0, -(2 * i + 1) / 32))
for y, x in points:
    high, low = parts(angle(y, x))
    print(f"    {{{y.hex()}, {x.hex()}, {high.hex()}, {low.hex()}}},")
