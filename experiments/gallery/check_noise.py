#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Is the noise of noise.py what it says? Each figure beside its theory and the limit, which is five
standard deviations of the figure or more; exits with 1 where one is beyond."""
import sys

import numpy as np

import noise
import sessions
import sound

COUNT, DT = 400000, 0.01
FAILED = []


def check(what, value, expected, limit):
    good = abs(value - expected) <= limit
    print(f"{what:44} {value:10.4g} {expected:10.4g} +- {limit:.2g}{'' if good else '  WRONG'}")
    if not good:
        FAILED.append(what)


def density(x, low, high, segment=4000):
    """Mean two-sided density of a white or smooth spectrum between two frequencies [Hz]."""
    rows = x.reshape(-1, segment)
    power = (np.abs(np.fft.rfft(rows)) ** 2).mean(0) * DT / segment
    f = np.fft.rfftfreq(segment, DT)
    return power[(f >= low) & (f <= high) & (f > 0)].mean()


def allan(x, m):
    means = x[:len(x) // m * m].reshape(-1, m).mean(1)
    return np.sqrt(np.mean(np.diff(means) ** 2) / 2)


def check_noise():
    rng = noise.generator("check", 1)
    for tails in ("normal", "student5", "laplace"):
        x = noise.white(rng, COUNT, DT, 2, tails)
        check(f"white, {tails}: density", density(x, 1, 49), 4, 0.08)
    flicker = np.mean([allan(noise.flicker(rng, COUNT, 1), 1000) ** 2 for _ in range(12)]) ** 0.5
    check("flicker: Allan deviation at 10 s", flicker, np.sqrt(2 * np.log(2) / np.pi), 0.05)
    flicker = np.mean([allan(noise.flicker(rng, COUNT, 1), 40) ** 2 for _ in range(12)]) ** 0.5
    check("flicker: the same at 0.4 s", flicker, np.sqrt(2 * np.log(2) / np.pi), 0.02)
    walk = noise.random_walk(rng, COUNT, DT, 3)
    check("random walk: steps", np.std(np.diff(walk)), 3 * np.sqrt(DT), 0.003)
    gm = noise.gauss_markov(rng, COUNT, DT, 3, 0.2)
    check("Gauss-Markov: variance", gm.var(), 9, 0.6)
    check("Gauss-Markov: correlation at its time", np.corrcoef(gm[:-20], gm[20:])[0, 1],
          np.exp(-1), 0.05)
    ring = noise.resonance(rng, COUNT, DT, 2, 20, 16)
    check("resonance: variance", ring.var(), 4, 0.25)
    check("resonance: share within its half-width", density(ring, 19.375, 20.625) * 2.5 / 4, 0.5,
          0.05)
    for damping in (0, 0.7):
        x = noise.low_pass(rng, COUNT, DT, 1, 15, damping)
        share = np.sinc(15 * DT) ** 2 / 2
        check(f"low-pass, damping {damping}: density at 15 Hz", density(x, 14.5, 15.5),
              share + (0.02 if damping == 0 else 0), 0.04)
    q = noise.quantization(rng, COUNT, DT, 1)
    check("quantization: variance", q.var() * DT * DT, 2, 0.03)
    x = noise.white(rng, COUNT, DT, 1) + 3.7
    error = np.cumsum(noise.round_angle(x, DT, 0.2) - x) * DT
    check("rounded angle: variance of the error", error.var(), 0.04 / 12, 5e-5)
    check("rounded angle: neighbours' correlation", np.corrcoef(error[1:], error[:-1])[0, 1], 0,
          0.02)


def check_sessions():
    """Rates that are integrated lead to the attitude, and its forces are gravity."""
    rng = noise.generator("check", 2)
    session = sessions.poses(rng, 5)
    rates, forces = np.vstack(session.rates), np.vstack(session.forces)
    check("session: |force|", np.abs(np.linalg.norm(forces, axis=1) - sessions.GRAVITY).max(), 0,
          1e-9)
    attitude, up = np.eye(3), forces[0] / sessions.GRAVITY
    for rate in rates:
        attitude = attitude @ sessions.rotation(rate * session.dt)
    tilt = np.linalg.norm(attitude @ forces[-1] / sessions.GRAVITY - up)
    turned = sessions.EARTH_RATE * len(rates) * session.dt  # of the vertical, by the Earth at most
    check("session: vertical carried by the rates [rad]", tilt, 0, turned * 1.01)


def white_at_the_end(kind):
    """Density of the white noise at half the sampling rate, of that at 0."""
    if not kind.sensor.low_pass:
        return 1
    bandwidth, damping = kind.sensor.low_pass
    falls = kind.rate / 2 / bandwidth
    return 0.4 / (1 + falls ** (4 if damping else 2))


def check_sound():
    """At half the sampling rate the flicker noise is a matter of definition, by a half. This must
    move N by less than a third of its half-width, and flicker noise must not show there behind a
    filter, where B would follow from it."""
    check("sound kinds", len(sound.KINDS), 60, 0)
    shares, shows = {}, {}
    for kind in sound.KINDS:
        flicker = kind.sensor.b ** 2 / (np.pi * kind.rate)  # of N's density
        half_width = 1.96 / np.sqrt(2 * kind.rate * kind.seconds)
        shares[kind.name] = 0.06 * flicker / half_width
        shows[kind.name] = flicker / white_at_the_end(kind)
    worst = max(shares, key=shares.get)
    check(f"shape of the flicker noise, {worst}", shares[worst], 0, 0.3)
    worst = max(shows, key=shows.get)
    check(f"flicker noise of white at the end, {worst}", shows[worst], 0, 0.05)


check_noise()
check_sessions()
check_sound()
sys.exit(bool(FAILED))
