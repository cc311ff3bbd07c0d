#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The filter that makes white noise of unit variance to flicker noise of B = 1, for
BiasInstabilityCoefficients of MATLAB's imuSensor: the tables of src/io/foreign/matlab_flicker.c.

Five first-order sequences with correlation times from 1.5 to 1e5 samples in geometric progression;
their variances make the largest relative error of the Allan deviation smallest from 1 to 5e4
samples (least squares, weighted anew by the error). With s = 2 - z - 1/z the spectrum is

    sum v_k (1 - p_k^2) / ((1 - p_k)^2 + p_k s),

whose four zeros in s lie between its five poles. A zero at s = -c is (1 - q)^2/q = c. Coefficients
are rounded to doubles, and the last one so that their sum, the response at 0 Hz, has its right
value: it is 1e-13, of coefficients up to 10."""

from decimal import Decimal, getcontext

import numpy as np

getcontext().prec = 60
STAGES, SHORTEST, LONGEST, FARTHEST = 5, 1.5, 1e5, 5e4
IDEAL = 2 * np.log(2) / np.pi


def allan_variances(decay, n):
    """Of a first-order sequence of unit variance: (4 V(n) - V(2 n))/(2 n^2)."""
    step = 1 - decay

    def of_sum(n):
        return n * (1 + decay) / step - 2 * decay * (1 - decay**n) / step**2
    return (4 * of_sum(n) - of_sum(2 * n)) / (2 * n * n)


def fit(decay):
    n = np.unique(np.round(np.exp(np.linspace(0, np.log(FARTHEST), 150))))
    parts = np.array([allan_variances(d, n) for d in decay]).T / IDEAL
    weight, best = np.ones(len(n)), (np.inf, None)
    for _ in range(500):
        root = np.sqrt(weight)
        variance = np.linalg.lstsq(parts * root[:, None], root, rcond=None)[0]
        error = np.abs(np.sqrt(parts @ variance) - 1)
        best = min(best, (error.max(), variance.tolist()))
        weight = weight * error
        weight /= weight.sum()
    return best


def product(roots):
    """Coefficients of the product of (1 - r/z)."""
    result = [Decimal(1)]
    for root in roots:
        shifted = [Decimal(0)] + [-root * c for c in result]
        result = [a + b for a, b in zip(result + [Decimal(0)], shifted)]
    return result


def rounded(exact):
    """As doubles of the right sum."""
    values = [float(c) for c in exact]
    rest = sum(exact) - sum(Decimal(v) for v in values)
    values[-1] = float(Decimal(values[-1]) + rest)
    return values


def zeros(decay, variance):
    def spectrum(s):
        return sum(v * (1 - p * p) / ((1 - p)**2 + p * s) for v, p in zip(variance, decay))
    places = sorted(-(1 - p)**2 / p for p in decay)
    for low, high in zip(places, places[1:]):
        width = high - low
        low, high = low + width * Decimal("1e-40"), high - width * Decimal("1e-40")
        for _ in range(180):
            middle = (low + high) / 2
            if spectrum(middle) > 0:
                low = middle  # above a pole it is positive
            else:
                high = middle
        c = -low
        yield 1 + c / 2 - (c + c * c / 4).sqrt()


def main():
    times = [Decimal(t) for t in SHORTEST * (LONGEST / SHORTEST)**(np.arange(STAGES) / (STAGES - 1))]
    decay = [Decimal(float((-1 / t).exp())) for t in times]
    error, variance = fit([float(d) for d in decay])
    exact_variance = [Decimal(v) for v in variance]
    roots = list(zeros(decay, exact_variance))
    shape = product(roots)
    below = product(decay)
    # The variance of the filter's output at 0 Hz: sum v (1 + p)/(1 - p).
    at_zero = sum(v * (1 + p) / (1 - p) for v, p in zip(exact_variance, decay))
    gain = at_zero.sqrt() * sum(below) / sum(shape)
    for name, values in (("decay", [float(d) for d in decay]), ("variance", variance),
                         ("numerator", rounded([gain * c for c in shape])),
                         ("denominator", rounded(below))):
        print(f"{name} = {{{', '.join(map(repr, values))}}}")
    print(f"largest error {error:.4f}")


if __name__ == "__main__":
    main()
