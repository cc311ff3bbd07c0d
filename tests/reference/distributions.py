#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reference values of the distribution functions, and the coefficient tables of their sources.

Everything is computed here with 60-digit decimal arithmetic from the defining series, except the
chi-square quantiles, which are found from it by bisection.

    distributions.py vectors > distributions.inc
    distributions.py tables                       (the tables in gamma_function.c and incomplete_gamma.c)
"""
import sys
from decimal import Decimal as D, getcontext
from fractions import Fraction as F
from math import comb

getcontext().prec = 60
PI = D("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")


def bernoulli(count):
    b = [F(1)]
    for m in range(1, count):
        b.append(-sum(comb(m + 1, k) * b[k] for k in range(m)) / (m + 1))
    return b


BERNOULLI = bernoulli(62)


def decimal(fraction):
    return D(fraction.numerator) / D(fraction.denominator)


def log_gamma(x):
    """Stirling's series beyond 60, by the recurrence below."""
    shift = D(1)
    while x < 60:
        shift *= x
        x += 1
    total = (x - D("0.5")) * x.ln() - x + (2 * PI).ln() / 2
    for k in range(1, 30):
        total += decimal(BERNOULLI[2 * k]) / (2 * k * (2 * k - 1) * x ** (2 * k - 1))
    return total - shift.ln()


def gamma_lower_upper(a, x):
    """P by the series of positive terms, and Q = 1 - P."""
    prefactor = (a * x.ln() - x - log_gamma(a + 1)).exp()
    term, total, k = D(1), D(1), 0
    while term > total * D(10) ** (3 - getcontext().prec):
        k += 1
        term *= x / (a + k)
        total += term
    p = prefactor * total
    return p, 1 - p


def normal_upper(x):
    """1 - Phi(x): from P(1/2, x^2/2), or by Laplace's continued fraction where that would cancel."""
    if x < 3:
        return gamma_lower_upper(D("0.5"), x * x / 2)[1] / 2
    fraction = x
    for n in range(4000, 0, -1):
        fraction = x + n / fraction
    return (-x * x / 2).exp() / (2 * PI).sqrt() / fraction


def zeta_minus_one(s):
    """Euler-Maclaurin from 40."""
    n = 40
    total = sum(D(k) ** -s for k in range(2, n))
    total += D(n) ** (1 - s) / (s - 1) + D(n) ** -s / 2
    rising = D(s)
    power = D(n) ** (-s - 1)
    for k in range(1, 25):
        factorial = 1
        for i in range(2, 2 * k + 1):
            factorial *= i
        total += decimal(BERNOULLI[2 * k]) / factorial * rising * power
        rising *= (s + 2 * k - 1) * (s + 2 * k)
        power /= n * n
    return total


def temme(count):
    """eta/(lambda - 1) in powers of eta, where lambda - 1 - log(lambda) = eta^2/2."""
    alpha = [F(0), F(1)]
    for n in range(2, count + 2):
        rest = sum(alpha[i] * alpha[n + 1 - i] for i in range(2, n))
        alpha.append((2 * alpha[n - 1] / (n + 1) - rest) / 2)
    d = [F(1)]
    for n in range(1, count):
        d.append(-sum(alpha[k + 1] * d[n - k] for k in range(1, n + 1)))
    return d


def text(x):
    return repr(float(x))


def tables():
    print("/* eta/(lambda - 1) */")
    for d in temme(32):
        print(f"    {float(d)!r},")
    print("/* (zeta(k) - 1)/k (-1)^k, k = 2 … */")
    for k in range(2, 32):
        print(f"    {text((-1) ** k * zeta_minus_one(k) / k)},")
    print("/* B(2k)/(2k (2k-1)) */")
    for k in range(1, 11):
        print(f"    {BERNOULLI[2 * k] / (2 * k * (2 * k - 1))}")
    print("1 - Euler's constant:", text(1 + digamma_one()))


def digamma_one():
    """-Euler's constant, by Euler-Maclaurin on the harmonic numbers."""
    n = 100
    total = sum(1 / D(k) for k in range(1, n + 1)) - D(n).ln() - 1 / D(2 * n)
    for k in range(1, 25):
        total += decimal(BERNOULLI[2 * k]) / (2 * k * D(n) ** (2 * k))
    return -total


def quantile(p, a):
    """x with P(a, x) = p, for 1e-12 <= p <= 1 - 1e-12, by bisection in log x."""
    getcontext().prec = 40
    low = min((p.ln() + log_gamma(a + 1)) / a, a.ln()) - 1
    high = (a + 8 * a.sqrt() + 40).ln()
    for _ in range(75):
        middle = (low + high) / 2
        if gamma_lower_upper(a, middle.exp())[0] < p:
            low = middle
        else:
            high = middle
    getcontext().prec = 60
    return low.exp()


def vectors():
    print("/* SPDX-License-Identifier: Apache-2.0 */")
    print("/* Written by tests/reference/distributions.py: 60-digit arithmetic, rounded to double. */")
    print("static const double normal_upper[][2] = { /* x, 1 - Phi(x) */")
    for x in ("0.001 0.1 0.5 0.999 1 1.5 2 2.5758293035489004 3 4.5 6 8.25 12.3 17 20.7 25 30 34.5 37.6"
              ).split():
        exact = D(float(x))
        print(f"    {{{text(exact)}, {text(normal_upper(exact))}}},")
    print("};")
    print("static const double log_gamma[][2] = { /* x, log Gamma(x) */")
    for x in ("1e-10 1e-3 0.05 0.25 0.5 0.75 0.999 1.0001 1.2 1.4616321449683622 1.5 1.75 1.9999 "
              "2.001 2.3 2.6 3 4.5 7.25 9.99 10.1 17.5 50 171.6 1e3 123456.789 1e8 1e15").split():
        exact = D(float(x))
        print(f"    {{{text(exact)}, {text(log_gamma(exact))}}},")
    print("};")
    print("static const double gamma_pq[][4] = { /* a, x, P, Q */")
    pairs = [(a, a * r) for a in (1e-10, 1e-3, .05, .3, .5, .9, 1, 1.5, 3, 7.7, 12, 19.9, 20.1, 30, 75, 250,
                                  1e3, 1e4)
             for r in (1e-3, .1, .3, .31, .5, .8, .95, 1, 1.05, 1.3, 2, 2.35, 2.4, 4)]
    pairs += [(a, x) for a in (1e-10, 1e-3, .05, .3, .5, .9, 1.0)
              for x in (1e-8, .01, .4, 1.2, 1.49, 1.51, 2, 5, 20)]
    pairs += [(a, a + s * a ** .5) for a in (1e5, 1e6, 1e8) for s in (-8, -3, -1, -.01, 0, .01, 1, 3, 8)]
    for a, x in pairs:
        getcontext().prec = 60 if x < 100 else 60 + min(int(x / 2), 200)
        p, q = gamma_lower_upper(D(a), D(x))
        getcontext().prec = 60
        if min(p, q) < D("1e-150"):
            continue
        print(f"    {{{a!r}, {x!r}, {text(+p)}, {text(+q)}}},")
    print("};")
    print("static const double chi_square[][3] = { /* degrees, probability, quantile */")
    for degrees in (.1, .5, 1, 1.7, 2, 3, 4.4, 10, 39, 41, 100, 1234.5, 1e5):
        for p in (1e-12, 1e-6, .005, .025, .16, .5, .84, .975, .995, 1 - 1e-6, 1 - 1e-12):
            if degrees >= 1e5 and p in (.005, .16, .84, .995):
                continue
            x = 2 * quantile(D(p), D(degrees) / 2)
            print(f"    {{{degrees!r}, {p!r}, {text(x)}}},")
    print("};")


if __name__ == "__main__":
    {"vectors": vectors, "tables": tables}[sys.argv[1]]()
