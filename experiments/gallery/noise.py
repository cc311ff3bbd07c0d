# SPDX-License-Identifier: Apache-2.0
"""Noise of a second generator, which shares no code and no method with imukit's.

Every process is Gaussian white noise times a transfer function in the frequency domain. The period
of the transform is longer than the record, so that the ends of the record do not know each other.
Strengths follow docs/theory/noise-terms.md: densities are two-sided.
"""
import zlib

import numpy as np


def generator(*key):
    """A generator of random numbers of its own for each key (texts and whole numbers)."""
    return np.random.default_rng([zlib.crc32(str(k).encode()) for k in key])


def _padded(count, memory):
    """Length of a transform that holds the record and the memory: 2^a or 3 * 2^a."""
    need = int(count + memory)
    power = 1 << (need - 1).bit_length()
    return power * 3 // 4 if power * 3 // 4 >= need else power


def _through(rng, count, memory, gain):
    """White noise of unit variance through gain(f), f in cycles per sample, 0 to 1/2."""
    length = _padded(count, memory)
    f = np.arange(length // 2 + 1) / length
    spectrum = np.fft.rfft(rng.standard_normal(length))
    spectrum *= gain(f)
    return np.fft.irfft(spectrum, length)[:count]


def white(rng, count, dt, n, tails="normal"):
    """White noise of density n^2. tails: normal, student5, laplace; all of the same variance."""
    draw = {"normal": lambda: rng.standard_normal(count),
            "student5": lambda: rng.standard_t(5, count) * np.sqrt(3 / 5),
            "laplace": lambda: rng.laplace(0, np.sqrt(0.5), count)}[tails]
    return n / np.sqrt(dt) * draw()


def flicker(rng, count, b):
    """Fractional differencing of order 1/2: S(f) = b^2/(2 pi f) for f far below 1/dt."""
    def gain(f):
        f[0] = 1
        g = b * (1 - np.exp(-2j * np.pi * f)) ** -0.5
        g[0] = 0
        return g
    return _through(rng, count, (3 if count < 1000000 else 1) * count, gain)


def random_walk(rng, count, dt, k):
    """Sums of white steps, from 0."""
    walk = np.cumsum(k * np.sqrt(dt) * rng.standard_normal(count))
    return walk - walk[0]


def gauss_markov(rng, count, dt, sigma, time):
    """First-order process of variance sigma^2 and correlation time `time` [s]."""
    phi = np.exp(-dt / time)
    def gain(f):
        return sigma * np.sqrt(1 - phi * phi) / (1 - phi * np.exp(-2j * np.pi * f))
    return _through(rng, count, 20 * time / dt, gain)


def _folded(density, dt, f):
    """A density of continuous time, sampled: the sum of its aliases. f in cycles per sample."""
    return sum(density((f + j) / dt) for j in range(-8, 9))


def resonance(rng, count, dt, sigma, frequency, q):
    """Displacement of a damped oscillator that white noise drives; variance sigma^2."""
    def density(f):
        r = f / frequency
        return sigma ** 2 * 2 / (np.pi * frequency * q) / ((1 - r * r) ** 2 + (r / q) ** 2) / 2
    def gain(f):
        return np.sqrt(_folded(density, dt, f) / dt)
    return _through(rng, count, 20 * q / (frequency * dt), gain)


def low_pass(rng, count, dt, n, bandwidth, damping):
    """White noise through a low-pass and averaged over dt; damping 0: first order."""
    def density(f):
        r = f / bandwidth
        filtered = 1 / (1 + r * r)
        if damping:  # the bandwidth is where the gain is 1/sqrt(2)
            a = 1 - 2 * damping ** 2
            corner = bandwidth / np.sqrt(a + np.sqrt(a * a + 1))
            r = f / corner
            filtered = 1 / ((1 - r * r) ** 2 + (2 * damping * r) ** 2)
        return n * n * filtered * np.sinc(f * dt) ** 2
    def gain(f):
        return np.sqrt(_folded(density, dt, f) / dt)
    return _through(rng, count, 50 / (bandwidth * dt), gain)


def quantization(rng, count, dt, q):
    """White noise of the angle, as differences over dt."""
    return np.diff(rng.standard_normal(count + 1)) * q / dt


def round_angle(rate, dt, step):
    """Increments of an angle that is kept in whole steps; step [unit of rate * s]."""
    angle = np.concatenate(([0.0], np.cumsum(rate) * dt))
    return np.diff(np.round(angle / step)) * step / dt


def tone(time, amplitude, frequency, phase):
    return amplitude * np.sin(2 * np.pi * frequency * time + phase)
