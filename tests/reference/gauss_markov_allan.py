# SPDX-License-Identifier: Apache-2.0
"""Makes gauss_markov_sampled.inc and gauss_markov_continuous.inc: Allan variances of Gauss-Markov
processes of unit variance from the textbook forms, with 80 digits to survive their cancellation.

    python3 tests/reference/gauss_markov_allan.py
"""
from decimal import Decimal, getcontext
from pathlib import Path

getcontext().prec = 80
here = Path(__file__).parent

rows = []
for exponent in range(-34, 5, 2):
    x = 2.0**exponent * 1.3
    for n in (1, 2, 3, 10, 1000, 123457):
        phi = (-Decimal(x)).exp()
        bracket = n - 3 * phi - n * phi**2 + 4 * phi ** (n + 1) - phi ** (2 * n + 1)
        rows.append(f"{{{x!r}, {n}, {float(bracket / (n * (1 - phi)) ** 2)!r}}},\n")
(here / "gauss_markov_sampled.inc").write_text("".join(rows))

rows = []
for exponent in range(-40, 9, 2):
    x = 2.0**exponent * 1.3
    d = Decimal(x)
    rows.append(f"{{{x!r}, {float((2 * d - 3 + 4 * (-d).exp() - (-2 * d).exp()) / d**2)!r}}},\n")
(here / "gauss_markov_continuous.inc").write_text("".join(rows))
