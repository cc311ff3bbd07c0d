# SPDX-License-Identifier: Apache-2.0
"""Sixty kinds of sound logs: of each, the sentence "usable" is true.

Strengths are relative to a white noise of 1 and scaled to a gyro of 0.3 deg/sqrt(h) or an
accelerometer of 0.05 m/s/sqrt(h). A record holds its flicker noise to 5 to 15 %. At half the
sampling rate the flicker noise is too weak for its shape there to matter, also behind a filter.
"""
from dataclasses import dataclass, field

import numpy as np

import noise
from records import Column, Record

GYRO = np.radians(0.3) / 60  # [rad/sqrt(s)]
ACCEL = 0.05 / 60  # [m/s/sqrt(s)]


@dataclass
class Sensor:
    """Noise of one channel, in units of its white noise: n [1], b [1/sqrt(s)], k [1/s], q
    [sqrt(s)], r [s^-3/2]. gm: (sigma, time), resonances: (sigma, frequency, q), tones:
    (amplitude, frequency), sigma and amplitude in standard deviations of a white sample.
    low_pass: (bandwidth, damping). step: rounding in standard deviations of a white sample.
    angle_step: rounding of the angle, in white noise's angle of one interval; up to 2, the error
    is white (correlation of neighbours exp(-2 pi^2/angle_step^2))."""
    n: float = 1
    b: float = 0
    k: float = 0
    q: float = 0
    r: float = 0
    gm: tuple = ()
    resonances: tuple = ()
    tones: tuple = ()
    low_pass: tuple = ()
    tails: str = "normal"
    step: float = 0
    angle_step: float = 0


@dataclass
class Kind:
    name: str
    about: str
    rate: float
    seconds: float
    sensor: Sensor
    channels: str = "g3"  # g1, g3, a3, 6
    time: str = "exact"  # none, exact, ms, us, jitter, epoch
    gaps: tuple = ()  # (kind, amount): rows (fraction), blocks (count, seconds), nan (fraction)
    temperature: str = ""  # constant, wandering
    unit: str = "SI"
    text: bool = False
    level: str = "down"  # attitude of the accelerometers: down, tilted
    extra: dict = field(default_factory=dict)


NB = Sensor(b=0.45)
NBK = Sensor(b=0.45, k=0.03)

KINDS = [
    # ---- mixtures ----
    Kind("n_5min", "white noise, 5 minutes", 100, 300, Sensor(), "g1"),
    Kind("n_1h", "white noise, an hour", 100, 3600, Sensor(), "g1"),
    Kind("n_20hz", "white noise, 20 Hz, 3.6 hours", 20, 13107, Sensor(), "g1"),
    Kind("n_1khz", "white noise, 1 kHz, 5 minutes", 1000, 300, Sensor(), "g1"),
    Kind("n_accel", "white noise of accelerometers", 100, 900, Sensor(), "a3"),
    Kind("nb_30min", "white and flicker noise, 30 minutes", 100, 1800, NB),
    Kind("nb_5min", "white and strong flicker noise, 5 minutes", 100, 300, Sensor(b=1)),
    Kind("nb_20hz", "white and flicker noise, 20 Hz, 3 hours", 20, 10800, Sensor(b=0.15), "g1"),
    Kind("nb_200hz", "white and flicker noise, 200 Hz", 200, 900, Sensor(b=0.6)),
    Kind("nb_1khz", "white and flicker noise, 1 kHz", 1000, 300, Sensor(b=1), "g1"),
    Kind("nbk_3h", "N, B and K at the edge of what 3 hours show", 10, 10800,
         Sensor(b=0.4444, k=0.0185)),
    Kind("nbk_1h", "N, B and a strong K", 50, 3600, Sensor(b=0.4, k=0.1)),
    Kind("nk", "white noise and random walk", 20, 10800, Sensor(k=0.01), "g1"),
    Kind("k_strong", "random walk that rules from 1 s on", 100, 1800, Sensor(k=1), "a3"),
    Kind("b_strong", "flicker noise that rules from 0.6 s on", 100, 1200, Sensor(b=2), "g1"),
    Kind("qnbk", "Q, N, B and K", 50, 5400, Sensor(q=0.01, b=0.45, k=0.05), "g1"),
    Kind("qnr", "Q, N and a ramp", 20, 10800, Sensor(q=0.05, r=2.3e-5), "g1"),
    Kind("q_strong", "white noise of the angle hides white noise above 0.1 Hz", 20, 7200,
         Sensor(q=3, b=0.3), "g1"),
    Kind("qn", "white noise and a weak Q", 100, 1800, Sensor(q=0.004), "g1"),
    Kind("nr", "white noise and a ramp", 20, 10800, Sensor(r=2.3e-5), "g1"),
    Kind("nbr", "N, B and a ramp", 20, 10800, Sensor(b=0.15, r=1.3e-4), "g1"),
    Kind("gm_40ms", "a Gauss-Markov process of 0.04 s", 200, 900, Sensor(gm=((0.7, 0.04),)), "g1"),
    Kind("gm_1s", "a Gauss-Markov process of 1 s", 20, 7200, Sensor(gm=((0.11, 1),)), "g1"),
    Kind("gm_10s", "a Gauss-Markov process of 10 s", 20, 7200, Sensor(gm=((0.07, 10),)), "g1"),
    Kind("gm_100s", "a Gauss-Markov process of 100 s", 20, 13107, Sensor(gm=((0.11, 100),)), "g1"),
    Kind("nb_gm_10s", "N, B and a Gauss-Markov process of 10 s", 20, 10800,
         Sensor(b=0.15, gm=((0.15, 10),)), "g1"),
    Kind("nbk_gm_1s", "N, B, K and a Gauss-Markov process of 1 s", 20, 10800,
         Sensor(b=0.15, k=0.03, gm=((0.25, 1),)), "g1"),
    Kind("two_gm", "two Gauss-Markov processes, 1 s and 100 s", 20, 13107,
         Sensor(gm=((0.25, 1), (0.25, 100))), "g1"),
    Kind("nk_gm_100s", "N, K and a Gauss-Markov process of 100 s", 20, 13107,
         Sensor(k=0.1, gm=((0.5, 100),)), "g1"),
    # ---- output filters, resonances, tones ----
    Kind("low_pass_1", "first-order output filter, 20 Hz of 100", 100, 1800,
         Sensor(b=0.45, low_pass=(20, 0)), "g1"),
    Kind("low_pass_2", "second-order output filter, 40 Hz of 100", 100, 1800,
         Sensor(b=0.45, low_pass=(40, 0.7))),
    Kind("low_pass_200", "second-order output filter, 50 Hz of 200", 200, 900,
         Sensor(b=0.6, low_pass=(50, 0.7)), "g1"),
    Kind("low_pass_1khz", "second-order output filter, 250 Hz of 1000", 1000, 200,
         Sensor(b=1, low_pass=(250, 0.6)), "g1"),
    Kind("resonance_20hz", "resonance at 20 Hz, quality 16", 100, 1800,
         Sensor(b=0.45, resonances=((0.6, 20, 16),))),
    Kind("resonance_3hz", "resonance at 3 Hz, quality 16", 20, 7200,
         Sensor(b=0.15, resonances=((0.22, 3, 16),)), "g1"),
    Kind("resonance_wide", "resonance at 12 Hz, quality 4", 100, 1800,
         Sensor(b=0.45, resonances=((0.7, 12, 4),)), "g1"),
    Kind("two_resonances", "resonances at 9 and 31 Hz", 100, 1800,
         Sensor(b=0.45, resonances=((0.4, 9, 12), (0.5, 31, 20))), "g1"),
    Kind("tone_25hz", "a tone of 25 Hz on one of three channels", 100, 1800, NB, "g3",
         extra={"tones_on": (0,), "tones": ((0.5, 25.013),)}),
    Kind("tone_mains", "mains at 50 Hz", 200, 900, Sensor(b=0.6, tones=((0.3, 49.98),)), "g1"),
    Kind("sway", "a building that sways at 0.564 Hz with the third harmonic", 100, 1800,
         Sensor(b=0.45, tones=((0.25, 0.564), (0.15, 1.692))), "a3"),
    Kind("fan", "a fan at 17 Hz with its harmonic on all six channels", 100, 900,
         Sensor(b=0.6, tones=((0.4, 17.03), (0.2, 34.06))), "6"),
    # ---- digits and tails ----
    Kind("step_sigma", "rounded to steps of one standard deviation", 100, 1800,
         Sensor(b=0.45, step=1)),
    Kind("step_third", "rounded to steps of a third of a standard deviation", 100, 1800,
         Sensor(b=0.45, step=0.33), "a3"),
    Kind("angle_steps", "angle kept in whole steps of twice an interval's noise", 100, 1800,
         Sensor(b=0.45, angle_step=2), "g1"),
    Kind("angle_fine", "angle kept in whole steps of 1.5 times an interval's noise", 200, 900,
         Sensor(b=0.6, angle_step=1.5), "g1"),
    Kind("student_n", "white noise with Student's t of 5 degrees", 100, 1800,
         Sensor(tails="student5"), "g1"),
    Kind("student_nb", "the same, with flicker noise", 100, 1800,
         Sensor(b=0.45, tails="student5")),
    Kind("laplace_nb", "white noise with Laplace's density, with flicker noise", 100, 1800,
         Sensor(b=0.45, tails="laplace"), "g1"),
    # ---- time ----
    Kind("no_time", "no time column, --rate", 100, 1800, NB, time="none"),
    Kind("ms_128hz", "128 Hz, stamps in whole milliseconds", 128, 1200, Sensor(b=0.55), time="ms"),
    Kind("us_200hz", "200 Hz, stamps in whole microseconds with a crystal 40 ppm off", 200, 900,
         Sensor(b=0.6), "a3", time="us"),
    Kind("jitter", "stamps that scatter by 1 % of the interval", 100, 1800, NB, time="jitter"),
    Kind("epoch", "stamps in seconds since 1970", 100, 1800, NB, "g1", time="epoch"),
    Kind("csv_deg", "text, deg/s, with stamps", 100, 600, Sensor(b=0.8), "g1", unit="common",
         text=True),
    # ---- gaps and temperature ----
    Kind("gaps_rows", "1 % of the rows missing at random", 100, 1800, NB, gaps=("rows", 0.01)),
    Kind("gaps_blocks", "eight holes of 5 s", 100, 1800, NB, gaps=("blocks", 8, 5.0)),
    Kind("nan_cells", "0.5 % of the cells are NaN", 100, 1800, NB, gaps=("nan", 0.005)),
    Kind("temperature", "a temperature that wanders by a degree and has no effect", 100, 1800,
         NB, "a3", temperature="wandering", level="tilted"),
    # ---- six channels, long ----
    Kind("six_g", "six channels in deg/s and g, constant temperature", 100, 1200, Sensor(b=0.55),
         "6", unit="common", temperature="constant"),
    Kind("nbk_12h", "N, B and K, 12 hours at 100 Hz: the streaming path", 100, 43200,
         Sensor(b=0.15, k=0.01), "g1"),
]

BY_NAME = {kind.name: kind for kind in KINDS}


def _channels(kind):
    gyros = [("gyro_" + a, GYRO, "rad/s") for a in "xyz"]
    accels = [("accel_" + a, ACCEL, "m/s^2") for a in "xyz"]
    return {"g1": gyros[2:], "g3": gyros, "a3": accels, "6": gyros + accels}[kind.channels]


def _signal(rng, s, base, count, dt):
    """Noise of one channel, in units of its white noise's density."""
    sample = 1 / np.sqrt(dt)
    if s.low_pass:
        x = noise.low_pass(rng, count, dt, s.n, *s.low_pass)
    else:
        x = noise.white(rng, count, dt, s.n, s.tails)
    if s.b:
        x += noise.flicker(rng, count, s.b)
    if s.k:
        x += noise.random_walk(rng, count, dt, s.k)
    if s.q:
        x += noise.quantization(rng, count, dt, s.q)
    if s.r:
        x += s.r * dt * np.arange(count)
    for sigma, time in s.gm:
        x += noise.gauss_markov(rng, count, dt, sigma * sample, time)
    for sigma, frequency, q in s.resonances:
        x += noise.resonance(rng, count, dt, sigma * sample, frequency, q)
    return x * base


def _tones(kind, channel, s):
    if "tones" in kind.extra:
        return kind.extra["tones"] if channel in kind.extra["tones_on"] else ()
    return s.tones


def _rounded(s, x, base, dt):
    if s.step:
        step = s.step * base / np.sqrt(dt)
        x = np.round(x / step) * step
    if s.angle_step:
        x = noise.round_angle(x, dt, s.angle_step * base * np.sqrt(dt))
    return x


def _mean(rng, kind, name):
    """Bias and Earth's rotation of a gyro, gravity and bias of an accelerometer; SI units."""
    if name.startswith("gyro"):
        return np.radians(rng.uniform(-0.3, 0.3))
    tilted = {"accel_x": 3.1, "accel_y": -4.2, "accel_z": -8.2995}
    level = {"accel_x": 0.0, "accel_y": 0.0, "accel_z": -9.81}
    return (tilted if kind.level == "tilted" else level)[name] + rng.uniform(-0.02, 0.02)


def _stamps(rng, kind, count):
    t = np.arange(count) / kind.rate
    if kind.time == "none":
        return None, kind.rate
    if kind.time == "ms":
        t = np.round(t * 1000) / 1000
    elif kind.time == "us":
        t = np.round(t * 1.00004 * 1e6) / 1e6
    elif kind.time == "jitter":
        t = t + rng.normal(0, 0.01 / kind.rate, count)
    elif kind.time == "epoch":
        t = t + 1.79e9
    return t, None


def _make_gaps(rng, kind, record):
    what, *amount = kind.gaps
    if what == "rows":
        record.keep(rng.random(record.rows) >= amount[0])
    elif what == "blocks":
        keep = np.ones(record.rows, bool)
        length = int(amount[1] * kind.rate)
        for start in rng.choice(record.rows // length - 2, amount[0], replace=False) + 1:
            keep[start * length:(start + 1) * length] = False
        record.keep(keep)
    elif what == "nan":
        for column in record.columns:
            column.values[rng.random(record.rows) < amount[0]] = np.nan


def make(kind, seed):
    """The log of a kind and a seed."""
    rng = noise.generator("sound", kind.name, seed)
    count, dt = int(kind.rate * kind.seconds), 1 / kind.rate
    phases = rng.uniform(0, 2 * np.pi, 4)
    t = np.arange(count) * dt
    columns = []
    for c, (name, base, unit) in enumerate(_channels(kind)):
        s = kind.sensor
        x = _signal(rng, s, base, count, dt)
        for j, (amplitude, frequency) in enumerate(_tones(kind, c, s)):
            share = (1, 0.7, 0.85)[c % 3]
            x += noise.tone(t, share * amplitude * base / np.sqrt(dt), frequency, phases[j])
        x = _rounded(s, x + _mean(rng, kind, name), base, dt)
        scale = 1.0
        if kind.unit == "common":
            unit, scale = ("deg/s", np.pi / 180) if name[0] == "g" else ("g", 9.80665)
        columns.append(Column(name, unit, x, scale))
    time, rate = _stamps(rng, kind, count)
    record = Record(dt, time, columns, rate, text=kind.text)
    record.time_unit = {"ms": 1e-3, "us": 1e-6}.get(kind.time, 1.0)
    if kind.temperature:
        wander = 0.02 * noise.random_walk(rng, count, dt, 1)
        record.temperature = 25 + 0.01 * rng.standard_normal(count)
        record.temperature += wander if kind.temperature == "wandering" else 0
    if kind.gaps:
        _make_gaps(rng, kind, record)
    return record


def truth(kind, name):
    """True strengths of a channel by the letters of the terms; rounding counts as white noise, or
    as white noise of the angle. A term that the kind does not hold is 0; None: not known."""
    s, dt = kind.sensor, 1 / kind.rate
    base = GYRO if name.startswith("gyro") else ACCEL
    n, q = s.n, s.q
    if s.step:
        n = np.sqrt(n * n + s.step ** 2 / 12)
    if s.angle_step:
        q = np.sqrt(q * q + s.angle_step ** 2 * dt / 12)
    return {"Q": q * base, "N": n * base, "B": s.b * base, "K": s.k * base, "R": s.r * base}
