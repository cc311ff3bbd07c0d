#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The frequency of a clamped beam under an axial load, by Ritz's method.

usage: clamped_beam.py [TERMS]

The shape is a sum of Legendre polynomials of even degree, from 2 on, integrated twice: they and
their slopes are 0 at both clamps, and their bending energies are independent. No characteristic
equation takes part. Prints for loads n = N L^2/(E I) the square of the frequency over that at
n = 0, and by how much it falls from two thirds of the terms; the series at n = 0 by perturbation;
and where the beam buckles. With 12 terms the digits of a double are reached (2e-12 near buckling);
with more, rounding takes some of them away."""
import sys

import numpy as np
from numpy.polynomial import legendre

LOADS = (-39.0, -35.5, -30.0, -20.0, -12.0, -5.0, -1.0, 1.0, 5.0, 12.0, 20.0, 30.0, 35.5, 100.0)


def matrices(terms):
    """Bending, slopes and mass of even shapes on -1 ... 1, integrated exactly by Gauss's rule."""
    points, weights = legendre.leggauss(2 * terms + 8)
    values = ([], [], [])
    for k in range(2, 2 * terms + 2, 2):
        curvature = np.zeros(k + 1)
        curvature[k] = np.sqrt(k + 0.5)
        slope = legendre.legint(curvature, lbnd=-1)
        shape = legendre.legint(slope, lbnd=-1)
        for list_, series in zip(values, (curvature, slope, shape)):
            list_.append(legendre.legval(points, series))
    return [np.array(v) @ (weights * np.array(v)).T for v in values]


def squares(terms, loads):
    """L = 2: n = N L^2/(E I) is 4 N/(E I), and the square of the frequency in units of x1^4 is 16
    times the eigenvalue."""
    bending, slopes, mass = matrices(terms)
    root = np.linalg.cholesky(mass)

    def lowest(n):
        half = np.linalg.solve(root, bending + 0.25 * n * slopes)
        return np.linalg.eigvalsh(np.linalg.solve(root, half.T))[0] * 16.0

    return np.array([lowest(n) for n in loads])


def series(terms):
    """Three orders of perturbation theory about n = 0."""
    bending, slopes, mass = matrices(terms)
    root = np.linalg.cholesky(mass)
    energy, modes = np.linalg.eigh(
        np.linalg.solve(root, np.linalg.solve(root, bending).T))
    load = modes.T @ np.linalg.solve(root, np.linalg.solve(root, 0.25 * slopes).T) @ modes
    gap = energy[0] - energy[1:]
    to = load[0, 1:]
    first = load[0, 0]
    second = np.sum(to ** 2 / gap)
    third = to / gap @ load[1:, 1:] @ (to / gap) - first * np.sum(to ** 2 / gap ** 2)
    return np.array([first, second, third]) / energy[0]


def buckling(terms):
    bending, slopes, _ = matrices(terms)
    root = np.linalg.cholesky(slopes)
    return -4.0 * np.linalg.eigvalsh(np.linalg.solve(root, np.linalg.solve(root, bending).T))[0]


def main():
    terms = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    found, fewer = squares(terms, (0.0,) + LOADS), squares(2 * terms // 3, (0.0,) + LOADS)
    print(f"first root x1 of cos x cosh x = 1: {found[0] ** 0.25:.15f}")
    print("      n  square of the frequency  change")
    for n, one, other in zip(LOADS, found[1:], fewer[1:]):
        print(f"{n:7.1f}  {one / found[0]:.13f}          {other / found[0] - one / found[0]:8.1e}")
    print("series at n = 0: {:.12f} n {:+.9e} n^2 {:+.9e} n^3".format(*series(terms)))
    print(f"buckles at n = {buckling(terms):.12f}, -4 pi^2 = {-4 * np.pi ** 2:.12f}")


if __name__ == "__main__":
    main()
