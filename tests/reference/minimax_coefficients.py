#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Minimax coefficients of the polynomials in src/base (elementary.c, normals_kernel.h,
distributions/error_function.c).

Remez exchange in 60-digit decimal arithmetic, standard library only. Prints each polynomial's
coefficients, lowest power first, as decimals that read back to the same double, and its largest
weighted error before that rounding. Run: python3 tests/reference/minimax_coefficients.py
"""
from decimal import Decimal as D, getcontext

getcontext().prec = 60


def series(first, ratio, argument):
    """Sum of first * argument^k * ratio(1) * ... * ratio(k) until the terms vanish."""
    total, term, k = D(0), first, 0
    while abs(term) > D(10) ** -58:
        total += term
        k += 1
        term *= argument * ratio(k)
    return total


def solve(matrix, right):
    """Gaussian elimination with partial pivoting."""
    n = len(right)
    rows = [row[:] + [value] for row, value in zip(matrix, right)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(i + 1, n):
            factor = rows[r][i] / rows[i][i]
            rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    result = [D(0)] * n
    for i in reversed(range(n)):
        rest = sum(rows[i][j] * result[j] for j in range(i + 1, n))
        result[i] = (rows[i][n] - rest) / rows[i][i]
    return result


def powers(x, degree):
    """1, x, ... x^degree (Decimal refuses 0 ** 0)."""
    result = [D(1)]
    for _ in range(degree):
        result.append(result[-1] * x)
    return result


def minimax(function, weight, low, high, degree, rounds=7, points=400):
    """Coefficients c of the polynomial that minimises max |weight (sum c_k x^k - function)|."""
    pi = D("3.14159265358979323846264338327950288419716939937510582097494")

    def cosine(x):
        return series(D(1), lambda k: -D(1) / ((2 * k - 1) * (2 * k)), x * x)

    middle, half = (low + high) / 2, (high - low) / 2
    nodes = [middle - half * cosine(pi * i / (degree + 1)) for i in range(degree + 2)]
    grid = [middle - half * cosine(pi * i / points) for i in range(points + 1)]
    values = [(x, function(x), weight(x)) for x in grid]
    for _ in range(rounds):
        matrix = [powers(x, degree) + [(-1) ** i / (weight(x) or D(10) ** -30)]
                  for i, x in enumerate(nodes)]
        c = solve(matrix, [function(x) for x in nodes])[:-1]
        errors = [w * (sum(a * b for a, b in zip(c, powers(x, degree))) - f) for x, f, w in values]
        # One extremum per run of equal sign.
        extrema, start = [], 0
        for i in range(1, len(grid) + 1):
            if i == len(grid) or (errors[i] > 0) != (errors[start] > 0):
                extrema.append(max(range(start, i), key=lambda j: abs(errors[j])))
                start = i
        if len(extrema) != degree + 2:
            break
        nodes = [grid[i] for i in extrema]
    return c, max(abs(e) for e in errors)


def show(title, coefficients, error):
    print(f"{title}: error {float(error):.2e}")
    for c in coefficients:
        print(f"    {float(c)!r}")


def main():
    pi = D("3.14159265358979323846264338327950288419716939937510582097494")
    eighth = (D(2).sqrt() - 1) ** 4   # largest ((m - 1)/(m + 1))^2 for m in [sqrt 1/2, sqrt 2]
    quarter = (pi / 4) ** 2 * (1 + D(10) ** -9)

    def atanh_tail(z):                # (atanh(s)/s - 1)/z, z = s^2
        return series(D(1) / 3, lambda k: D(2 * k + 1) / (2 * k + 3), z)

    def sine_tail(w):                 # (sin(t)/t - 1)/w, w = t^2
        return series(-D(1) / 6, lambda k: -D(1) / ((2 * k + 2) * (2 * k + 3)), w)

    def cosine_tail(w):               # (cos t - 1 + w/2)/w^2
        return series(D(1) / 24, lambda k: -D(1) / ((2 * k + 3) * (2 * k + 4)), w)

    def exp_tail(r):                  # (e^r - 1 - r)/r^2
        return series(D(1) / 2, lambda k: D(1) / (k + 2), r)

    def cosine_of_turns(y):           # cos(pi sqrt y)
        w = pi * pi * y
        return 1 - w / 2 + w * w * cosine_tail(w)

    print("normals: relative error of log, of sin; absolute error of cos")
    fifth = (D(1) / 5) ** 2           # the same for m in [3/4, 3/2)
    show("log: 1 + z P(z)", *minimax(atanh_tail, lambda z: z, fifth / 1000, fifth, 4))
    show("sin(pi x) = x P(x^2)", *minimax(lambda y: pi * (1 + pi * pi * y * sine_tail(pi * pi * y)),
                                          lambda y: 1 / pi, D(0), D(1) / 16, 5))
    show("cos(pi x) = P(x^2)", *minimax(cosine_of_turns, lambda y: D(1), D(0), D(1) / 16, 5))
    print("elementary: all relative")
    show("log: 1 + z P(z)", *minimax(atanh_tail, lambda z: z, eighth / 1000, eighth, 6))
    show("sin: 1 + w P(w)", *minimax(sine_tail, lambda w: w, quarter / 1000, quarter, 5))
    show("cos: 1 - w/2 + w^2 P(w)",
         *minimax(cosine_tail, lambda w: w * w, quarter / 1000, quarter, 5))
    half_ln2 = D(2).ln() / 2 * (1 + D(10) ** -6)
    show("exp: 1 + r + r^2 P(r)",
         *minimax(exp_tail, lambda r: r * r, -half_ln2, half_ln2, 10))

    def odd_part(x):                  # e^(x^2) erf(x) / x
        return 2 / pi.sqrt() * series(D(1), lambda k: D(2) / (2 * k + 1), x * x)

    def tail(t):                      # e^(x^2) erfc(x) (1 + 2 x), x = 4 (1 + t)/(1 - t)
        x = 4 * (1 + t) / (1 - t)
        if x < 2:
            return ((x * x).exp() - x * odd_part(x)) * (1 + 2 * x)
        fraction = x                  # [ABRAMOWITZ1964, 7.1.14]
        for k in range(900, 0, -1):
            fraction = x + D(k) / 2 / fraction
        return (1 + 2 * x) / (pi.sqrt() * fraction)

    def centre(z):                    # erf(x)/x, z = x^2
        return (-z).exp() * odd_part(z.sqrt())

    print("error function: all relative")
    show("erf = x P(x^2)", *minimax(centre, lambda z: 1 / centre(z), D(0), D(1) / 4, 9, points=200))
    show("erfc = e^(-x^2)/(1 + 2 x) R(t)", *minimax(tail, lambda t: 1 / tail(t), D(-7) / 9,
                                                    D(24) / 32, 22, points=300))


if __name__ == "__main__":
    main()
