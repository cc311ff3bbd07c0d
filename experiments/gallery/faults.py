# SPDX-License-Identifier: Apache-2.0
"""Faults, made from clean logs of sound kinds. Strengths are weak, middle, strong.

Levels are in the unit that the fault says; sigma is the standard deviation of a sample's white
noise, B the bias instability of the kind (or where it has none, what 100 s of white noise give).
"""
from dataclasses import dataclass

import numpy as np

import noise
import sound


@dataclass
class Fault:
    name: str
    item: str  # of the list that the gallery answers
    base: str  # the sound kind
    strengths: tuple
    unit: str
    apply: callable  # (record, rng, strength): changes the record
    about: str
    undecidable: str = ""  # why another sound device explains the log as well
    says: str = ""  # code of the note in which the output says so
    factor: callable = None  # (strength): what the fault does to the true N, where it is a property
    harmless: str = ""  # why the right answer is an all-clear with unmoved estimates
    most: int = 40  # pairs at the middle strength


def sigma_of(record, column):
    base = sound.GYRO if column.name.startswith("gyro") else sound.ACCEL
    return base / np.sqrt(record.dt)


def level_of(record, column):
    """B of the common kinds at their rates, 0.45 of the white noise's density."""
    return sigma_of(record, column) * np.sqrt(record.dt) * 0.45


def seconds(record):
    return np.arange(record.rows) * record.dt


# ---- samples ---------------------------------------------------------------------------------


def spikes(count):
    def apply(record, rng, strength):
        for column in record.columns:
            at = rng.choice(record.rows, count, replace=False)
            signs = rng.choice((-1, 1), count)
            column.values[at] += signs * strength * sigma_of(record, column)
    return apply


def contaminated_bursts(record, rng, strength):
    """9 % of the samples, in bursts of 0.05 to 2 s, have `strength` times the noise."""
    for column in record.columns:
        inside = np.zeros(record.rows, bool)
        while inside.mean() < 0.09:
            start = rng.integers(record.rows)
            inside[start:start + rng.integers(5, 200)] = True
        extra = np.sqrt(strength ** 2 - 1) * sigma_of(record, column)
        column.values[inside] += extra * rng.standard_normal(inside.sum())


def contaminated_samples(record, rng, strength):
    for column in record.columns:
        inside = rng.random(record.rows) < 0.09
        extra = np.sqrt(strength ** 2 - 1) * sigma_of(record, column)
        column.values[inside] += extra * rng.standard_normal(inside.sum())


def stuck(record, rng, strength):
    """A share of the log in runs of one value, 0.5 to 5 s each."""
    for column in record.columns:
        held = 0
        while held < strength * record.rows:
            start, run = rng.integers(record.rows), int(rng.uniform(0.5, 5) / record.dt)
            column.values[start:start + run] = column.values[start]
            held += run


def clip(lower, upper):
    def apply(record, rng, strength):
        for column in record.columns:
            middle = np.nanmedian(column.values)
            limit = strength * sigma_of(record, column)
            column.values = np.clip(column.values, middle - limit if lower else -np.inf,
                                    middle + limit if upper else np.inf)
    return apply


def saturates_softly(record, rng, strength):
    """A stage of which the output is s tanh(x/s), s = `strength` sigma."""
    for column in record.columns:
        middle, scale = np.nanmedian(column.values), strength * sigma_of(record, column)
        column.values = middle + scale * np.tanh((column.values - middle) / scale)


def despiked(record, rng, strength):
    """A filter in the driver that takes what is `strength` sigma from the median of seven for a
    spike, and puts the median there."""
    for column in record.columns:
        padded = np.pad(column.values, 3, mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, 7)
        median = np.median(windows, axis=1)
        spread = 1.4826 * np.median(np.abs(windows - median[:, None]), axis=1)
        far = np.abs(column.values - median) > strength * spread
        column.values = np.where(far, median, column.values)


def averaged(record, rng, strength):
    """Each value is the mean of so many samples."""
    for column in record.columns:
        sums = np.cumsum(np.insert(column.values, 0, np.full(strength, column.values[0])))
        column.values = (sums[strength:] - sums[:-strength]) / strength


def smoothed(record, rng, strength):
    """Each value goes this part of the way from the one before to the sample."""
    for column in record.columns:
        level = column.values[0]
        for i, value in enumerate(column.values):
            level += strength * (value - level)
            column.values[i] = level


def zeroed(record, rng, strength):
    """The mean of each stretch of `strength` seconds becomes that of the log."""
    length = int(strength / record.dt)
    for column in record.columns:
        whole = column.values.mean()
        for first in range(0, record.rows, length):
            part = column.values[first:first + length]
            part += whole - part.mean()


def drop_by_value(record, rng, strength):
    """A driver that drops the rows in which the first channel is beyond `strength` sigma."""
    column = record.columns[0]
    away = np.abs(column.values - np.median(column.values))
    record.keep(away <= strength * sigma_of(record, column))


# ---- noise that changes ----------------------------------------------------------------------


def _white_factor(record, rng, factor):
    """Make the white noise factor(t) times as strong, by adding independent noise."""
    extra = np.sqrt(np.maximum(factor ** 2 - 1, 0))
    for column in record.columns:
        column.values += extra * sigma_of(record, column) * rng.standard_normal(record.rows)


def noise_halfway(record, rng, strength):
    _white_factor(record, rng, np.where(seconds(record) < seconds(record)[-1] / 2, 1, strength))


def noise_grows(record, rng, strength):
    _white_factor(record, rng, np.linspace(1, strength, record.rows))


def noise_bursts(record, rng, strength):
    """Six stretches of 20 s with more noise."""
    factor = np.ones(record.rows)
    length = int(20 / record.dt)
    for start in rng.choice(record.rows - length, 6, replace=False):
        factor[start:start + length] = strength
    _white_factor(record, rng, factor)


def flicker_changes(record, rng, strength):
    """The second half has `strength` times the flicker noise."""
    half = record.rows // 2
    for column in record.columns:
        b = np.sqrt(strength ** 2 - 1) * level_of(record, column)
        extra = noise.flicker(rng, record.rows - half, b)
        column.values[half:] += extra - extra[0]


# ---- level -----------------------------------------------------------------------------------


def jumps(count):
    def apply(record, rng, strength):
        for column in record.columns:
            places = rng.uniform(0.1, 0.9, count) if count > 1 else rng.uniform(0.3, 0.7, 1)
            for place in places:
                at = int(place * record.rows)
                column.values[at:] += strength * level_of(record, column) * rng.choice((-1, 1))
    return apply


def jump_at_hole(record, rng, strength):
    """The level jumps during a hole of 10 s."""
    at, hole = int(rng.uniform(0.3, 0.7) * record.rows), int(10 / record.dt)
    for column in record.columns:
        column.values[at:] += strength * level_of(record, column) * rng.choice((-1, 1))
    record.keep(np.r_[0:at, at + hole:record.rows])


def warm_up(record, rng, strength):
    for column in record.columns:
        size = strength * level_of(record, column) * rng.choice((-1, 1))
        column.values += size * np.exp(-seconds(record) / rng.uniform(150, 250))


def temperature_cycle(told):
    def apply(record, rng, strength):
        """An air conditioner: 10 minutes' period, 2 degC, delayed by 20 s."""
        t, period = seconds(record), 600
        cycle = 2 * np.sin(2 * np.pi * t / period)
        late = np.sin(2 * np.pi * (t - 20) / period)
        for column in record.columns:
            column.values += strength * level_of(record, column) * late
        if told:
            record.temperature = 25 + cycle + 0.05 * rng.standard_normal(record.rows)
    return apply


def moved(record, rng, strength):
    """Somebody moves the unit in the middle for 3 s: rates of `strength` sigma, then as before."""
    at, length = int(rng.uniform(0.3, 0.7) * record.rows), int(3 / record.dt)
    shape = np.sin(np.linspace(0, 2 * np.pi, length)) * np.hanning(length)
    for column in record.columns:
        size = strength * sigma_of(record, column) * rng.uniform(0.3, 1)
        column.values[at:at + length] += size * shape


def table_vibrates(record, rng, strength):
    """A machine of 23 Hz that comes and goes; amplitude in sigma."""
    t = seconds(record)
    slow = np.abs(noise.gauss_markov(rng, record.rows // 100 + 2, record.dt * 100, 1, 60))
    amplitude = np.interp(np.arange(record.rows) / 100, np.arange(len(slow)), slow)
    for c, column in enumerate(record.columns):
        share = (1, 0.6, 0.8)[c % 3]
        column.values += share * strength * sigma_of(record, column) * amplitude * np.sin(
            2 * np.pi * 23 * t)


def machine_starts(record, rng, strength):
    """A machine of 23 Hz that runs in the second half."""
    t = seconds(record)
    for column in record.columns:
        column.values += np.where(t > t[-1] / 2, strength * sigma_of(record, column) * np.sin(
            2 * np.pi * 23.017 * t), 0)


# ---- rows and stamps -------------------------------------------------------------------------


def nan_stretches(record, rng, strength):
    for column in record.columns:
        lost = 0
        while lost < strength * record.rows:
            start, run = rng.integers(record.rows), rng.integers(50, 2000)
            column.values[start:start + run] = np.nan
            lost += run


def stamps_floored(record, rng, strength):
    """Stamps are whole multiples of `strength` seconds, rounded down."""
    record.time = np.floor(record.time / strength + 1e-9) * strength


def rows_share_stamps(record, rng, strength):
    """In this share of the log, two rows have one stamp."""
    rows = np.arange(record.rows)
    pair = (rows % 2 == 1) & (rng.random(record.rows // 2 + 1).repeat(2)[:record.rows] < strength)
    record.time[pair] = record.time[np.maximum(rows - 1, 0)][pair]


def rows_twice(record, rng, strength):
    """A share of the rows is written twice, with stamp and values."""
    record.keep(np.repeat(np.arange(record.rows),
                          1 + (rng.random(record.rows) < strength).astype(int)))


def stamps_in_ms(record, rng, strength):
    """Stamps in whole milliseconds of a host that is late by up to `strength` ms."""
    late = rng.exponential(strength / 3, record.rows) * 1e-3
    record.time = np.floor((record.time + np.minimum(late, strength * 1e-3)) * 1000) / 1000
    record.time = np.maximum.accumulate(record.time)


def bunched(record, rng, strength):
    """Rows arrive in packets of `strength` and are stamped on arrival, 0.2 ms apart."""
    rows, packet = np.arange(record.rows), int(strength)
    last = np.minimum((rows // packet + 1) * packet - 1, record.rows - 1)
    record.time = record.time[last] + (rows % packet) * 2e-4


def latency(record, rng, strength):
    """Every 10 s the transport stops for up to `strength` seconds; then all rows come at once."""
    arrival = record.time.copy()
    for at in rng.choice(record.rows, int(record.rows * record.dt / 10), replace=False):
        hold = record.time[at] + rng.uniform(0.3, 1) * strength
        end = min(record.rows, at + int(strength / record.dt) + 2)
        arrival[at:end] = np.maximum(arrival[at:end], hold)
    record.time = np.maximum.accumulate(arrival)
    record.time += 1e-7 * np.arange(record.rows)


def late_and_drifting(record, rng, strength):
    """Stamps of a host: its clock is 100 ppm off, and each row is `strength` intervals late."""
    late = rng.gamma(2, strength / 2, record.rows) * record.dt
    record.time = np.maximum.accumulate(record.time * 1.0001 + late)
    record.time += 1e-9 * np.arange(record.rows)


def two_rates(record, rng, strength):
    """For this share of the time, in stretches of 60 s, only every second sample is written."""
    t = seconds(record)
    slow = (t % 60) < 60 * strength
    record.keep(~slow | (np.arange(record.rows) % 2 == 0))


def repeated(record, rng, strength):
    """Logged at `strength` times the rate of the sensor: the last value is repeated."""
    count = int(record.rows * strength)
    record.keep(np.minimum((np.arange(count) / strength + 1e-9).astype(int), record.rows - 1))
    record.time = np.arange(count) * record.dt / strength


def interpolated(record, rng, strength):
    """Resampled on straight lines to `strength` times the rate."""
    count = int((record.rows - 1) * strength)
    at, rows = np.arange(count) / strength, np.arange(record.rows)
    for column in record.columns:
        column.values = np.interp(at, rows, column.values)
    record.time = at * record.dt


def alternating(record, rng, strength):
    """Every second row is of another sensor, with `strength` times the noise."""
    _white_factor(record, rng, np.where(np.arange(record.rows) % 2 == 0, 1, strength))


def clock_back(record, rng, strength):
    record.time[int(rng.uniform(0.3, 0.7) * record.rows):] -= strength


def clock_forward(record, rng, strength):
    record.time[int(rng.uniform(0.3, 0.7) * record.rows):] += strength


# ---- zeros, movement, averages ---------------------------------------------------------------


def dead_band(record, rng, strength):
    for column in record.columns:
        small = np.abs(column.values) < strength * sigma_of(record, column)
        column.values[small] = 0


def cut_off(record, rng, strength):
    """Cut off toward zero, not rounded."""
    for column in record.columns:
        step = strength * sigma_of(record, column)
        column.values = np.trunc(column.values / step) * step


def lost_rows(record, rng, strength):
    """Rows of zeros, one to twenty at a time."""
    left = int(strength * record.rows)
    while left > 0:
        run = min(left, int(rng.integers(1, 21)))
        first = int(rng.integers(0, record.rows - run))
        for column in record.columns:
            column.values[first:first + run] = 0
        left -= run


def handled(record, rng, strength):
    """The first 5 s are of a sensor in a hand."""
    t = seconds(record)[:int(5 / record.dt)]
    for column in record.columns:
        swing = np.sin(2 * np.pi * rng.uniform(0.3, 1.5) * t + rng.uniform(0, 6))
        column.values[:len(t)] += strength * sigma_of(record, column) * swing * (1 - t / 5)


# ---- values, repeats and axes ----------------------------------------------------------------


def filled(step):
    def apply(record, rng, strength):
        """This share of the samples is replaced by the mean of the record."""
        for column in record.columns:
            if step:
                q = step * sigma_of(record, column)
                column.values = np.round(column.values / q) * q
            mean = np.mean(column.values)
            inside = rng.random(record.rows) < strength
            column.values[inside] = np.round(mean / q) * q if step else mean
    return apply


def stuck_bit(record, rng, strength):
    """A bit of the converter that weighs `strength` sigma is always 0; steps of an eighth of it."""
    for column in record.columns:
        bit = strength * sigma_of(record, column)
        code = np.round(column.values / bit * 8).astype(int)
        column.values = (code & ~8) * bit / 8


def axis_repeats(step):
    def apply(record, rng, strength):
        """The last axis alone repeats its last sample in this share of the rows."""
        column = record.columns[-1]
        if step:
            q = step * sigma_of(record, column)
            column.values = np.round(column.values / q) * q
        inside = rng.random(record.rows) < strength
        inside[0] = False
        column.values = column.values[np.maximum.accumulate(
            np.where(inside, 0, np.arange(record.rows)))]
    return apply


def rows_interpolated(step):
    def apply(record, rng, strength):
        """This share of the rows, each alone, is the mean of the rows beside it."""
        inside = np.flatnonzero(rng.random(record.rows) < strength)
        inside = inside[(inside > 0) & (inside < record.rows - 1)]
        inside = inside[np.diff(inside, prepend=-2) > 1]
        for column in record.columns:
            x = column.values
            x[inside] = (x[inside - 1] + x[inside + 1]) / 2
            if step:
                q = step * sigma_of(record, column)
                column.values = np.round(x / q) * q
    return apply


def crosstalk(record, rng, strength):
    """`strength` times the noise of the first axis is on the second."""
    first, second = record.columns[:2]
    second.values += strength * (first.values - first.values.mean())


def axis_of_two(record, rng, strength):
    """The last axis is the mean of the others, with `strength` of its own noise."""
    first, second, last = record.columns[:3]
    last.values = (first.values + second.values) / 2 + strength * (
        last.values - last.values.mean())


def axis_late(record, rng, strength):
    """The last axis is the first one, some rows later, with a tenth of its own noise."""
    first, last = record.columns[0], record.columns[-1]
    last.values = np.roll(first.values, int(strength)) + 0.1 * (last.values - last.values.mean())


def accel_leaks(record, rng, strength):
    """`strength` times the noise of the first accelerometer is on the first gyro, by its size."""
    gyro = next(c for c in record.columns if c.name.startswith("gyro"))
    accel = next(c for c in record.columns if c.name.startswith("accel"))
    scale = np.std(np.diff(gyro.values)) / np.std(np.diff(accel.values))
    gyro.values += strength * scale * (accel.values - accel.values.mean())


def packets_again(record, rng, strength):
    """A share of the packets of ten rows are those before, written again."""
    packet = np.arange(record.rows) // 10
    again = rng.random(packet[-1] + 1) < strength
    again[0] = False
    for column in record.columns:
        column.values = column.values[np.arange(record.rows) - 10 * again[packet]]


def written_twice(record, rng, strength):
    """This share of the rows, from the beginning, is written again behind the others; stamps go
    on."""
    again = int(strength * record.rows)
    for column in record.columns:
        column.values = np.concatenate((column.values, column.values[:again]))
    record.time = np.arange(record.rows) * record.dt


# ---- units -----------------------------------------------------------------------------------


def wrong_scale(record, rng, strength):
    for column in record.columns:
        column.values = column.values * strength


def wrong_rate(record, rng, strength):
    record.time, record.rate = None, strength / record.dt


SAME_DEVICE = "a device with this noise would write the same log"

FAULTS = [
    Fault("spikes_87", "1", "nbk_12h", (40, 400, 4000), "sigma", spikes(87),
          "87 one-sample spikes in 12 hours at 100 Hz"),
    Fault("step_12h", "1", "nbk_12h", (4, 15, 150), "B", jumps(1), "a step in 12 hours"),
    Fault("noise_12h", "1", "nbk_12h", (1.1, 2, 4), "noise x", noise_halfway,
          "white noise rises half-way in 12 hours", most=8),
    Fault("stuck_12h", "1", "nbk_12h", (0.0003, 0.003, 0.03), "share", stuck,
          "stuck values in 12 hours", most=8),
    Fault("clip_12h", "1", "nbk_12h", (3, 2.5, 2), "sigma", clip(True, True),
          "clipped on both sides, 12 hours", most=8),
    Fault("warm_up_12h", "1", "nbk_12h", (5, 20, 100), "B", warm_up,
          "a warm-up of 3 minutes in 12 hours", most=8),
    Fault("spikes", "1", "nb_30min", (8, 30, 1000), "sigma", spikes(20), "20 spikes in 30 minutes"),
    Fault("spikes_many", "2", "nb_30min", (5, 10, 50), "sigma", spikes(1800),
          "spikes in 1 % of the samples",
          undecidable="a device whose noise has such tails writes the same log; N is of the whole",
          says="gaussian", factor=lambda s: np.sqrt(1 + 0.01 * s * s)),
    Fault("bursts_9", "2", "nb_30min", (2, 4.3, 10), "noise x", contaminated_bursts,
          "9 % of the samples in bursts of more noise"),
    Fault("samples_9", "2", "nb_30min", (2, 4.3, 10), "noise x", contaminated_samples,
          "9 % of the samples, each by chance, with more noise",
          harmless="heavy tails that do not change are a property; N is of the whole process",
          factor=lambda s: np.sqrt(1 + 0.09 * (s * s - 1))),
    Fault("noise_halfway", "2", "nb_30min", (1.1, 2, 4), "noise x", noise_halfway,
          "white noise rises half-way"),
    Fault("noise_grows", "2", "nb_30min", (1.2, 2, 4), "noise x", noise_grows,
          "white noise grows all the time"),
    Fault("noise_bursts", "2", "nb_30min", (1.5, 3, 10), "noise x", noise_bursts,
          "six stretches of 20 s with more white noise"),
    Fault("flicker_changes", "2", "nb_30min", (2, 4, 10), "B x", flicker_changes,
          "flicker noise rises half-way"),
    Fault("rows_share_stamps", "3", "nb_200hz", (0.05, 0.5, 1), "share", rows_share_stamps,
          "two rows with one stamp"),
    Fault("rows_twice", "3", "nb_200hz", (0.01, 0.1, 1), "share", rows_twice,
          "rows written twice, with their stamp"),
    Fault("whole_seconds", "3", "nb_30min", (0.05, 1, 10), "s", stamps_floored,
          "stamps of 100 Hz rounded down to 0.05, 1 and 10 s"),
    Fault("coarse_200hz", "3", "nb_200hz", (0.007, 0.010, 0.015625), "s", stamps_floored,
          "stamps of 200 Hz rounded down to ticks"),
    Fault("ms_1khz", "3", "nb_1khz", (0.3, 1.0, 5.0), "ms late", stamps_in_ms,
          "stamps of 1 kHz in whole milliseconds of a late host"),
    Fault("bunched", "3", "nb_200hz", (2, 8, 50), "rows", bunched,
          "rows stamped in packets on arrival"),
    Fault("latency", "3", "nb_30min", (0.03, 0.15, 1), "s", latency,
          "the transport stops every 10 s"),
    Fault("late", "3", "nb_30min", (0.03, 0.2, 0.8), "interval", late_and_drifting,
          "stamps late by chance, of a drifting host clock"),
    Fault("two_rates", "3", "nb_30min", (0.1, 0.5, 0.9), "share", two_rates,
          "every second sample missing for a part of each minute"),
    Fault("repeated", "3", "nb_30min", (1.1, 1.5, 4), "rate x", repeated,
          "logged faster than the sensor measures"),
    Fault("interpolated", "3", "nb_30min", (1.1, 1.5, 2), "rate x", interpolated,
          "interpolated to a higher rate"),
    Fault("alternating", "3", "nb_30min", (1.1, 1.5, 3), "noise x", alternating,
          "rows of two sensors in turn"),
    Fault("clock_back", "3", "nb_30min", (0.05, 2, 600), "s", clock_back, "the clock jumps back"),
    Fault("clock_forward", "3", "nb_30min", (1, 60, 600), "s", clock_forward,
          "the clock jumps ahead", undecidable="missing rows look the same", says="missing"),
    Fault("clip_both", "4", "nb_30min", (3, 2.5, 2), "sigma", clip(True, True),
          "clipped on both sides"),
    Fault("clip_above", "4", "nb_30min", (3, 2.5, 2), "sigma", clip(False, True),
          "clipped on one side"),
    Fault("saturates_softly", "4", "nb_30min", (4, 3, 2), "sigma", saturates_softly,
          "a stage that saturates softly"),
    Fault("despiked", "4", "nb_30min", (3, 2.5, 2), "sigma", despiked,
          "a filter that replaces spikes by a median"),
    Fault("averaged", "6", "nb_30min", (2, 4, 8), "samples", averaged,
          "the driver writes a moving average"),
    Fault("smoothed", "6", "nb_30min", (0.7, 0.4, 0.1), "of the way", smoothed,
          "the driver smooths exponentially"),
    Fault("zeroed", "8", "nb_30min", (60, 20, 5), "s", zeroed,
          "an automatic zero, which takes the slow noise away"),
    Fault("drop_by_value", "4", "nb_30min", (3, 2.5, 2), "sigma", drop_by_value,
          "rows dropped because of their value"),
    Fault("jump", "8", "nb_30min", (3, 6, 30), "B", jumps(1), "the level jumps once"),
    Fault("jumps", "8", "nb_30min", (3, 6, 30), "B", jumps(6), "the level jumps six times"),
    Fault("jump_at_hole", "8", "nb_30min", (3, 6, 30), "B", jump_at_hole,
          "the level jumps in a hole of 10 s"),
    Fault("warm_up", "8", "nb_30min", (5, 20, 100), "B", warm_up, "a warm-up of 3 minutes"),
    Fault("temperature_told", "8", "nb_30min", (3, 10, 50), "B", temperature_cycle(True),
          "an air conditioner, with a temperature column"),
    Fault("temperature_untold", "8", "nb_30min", (3, 10, 50), "B", temperature_cycle(False),
          "an air conditioner, without a temperature column"),
    Fault("moved", "8", "nb_30min", (3, 30, 1000), "sigma", moved, "moved for 3 s"),
    Fault("vibration_changes", "8", "nb_30min", (0.3, 1, 5), "sigma", table_vibrates,
          "a table on which a machine of 23 Hz comes and goes"),
    Fault("machine_starts", "2", "nb_30min", (0.3, 1, 5), "sigma", machine_starts,
          "a machine of 23 Hz in the second half"),
    Fault("stuck", "4", "nb_30min", (0.001, 0.01, 0.1), "share", stuck, "stuck values"),
    Fault("nan_stretches", "3", "nb_30min", (0.01, 0.1, 0.3), "share", nan_stretches,
          "stretches of NaN", harmless="missing independently of their values"),
    Fault("dead_band", "4", "nb_30min", (0.5, 1, 1.5), "sigma", dead_band,
          "small values are put to zero"),
    Fault("cut_off", "4", "nb_30min", (0.1, 0.3, 0.8), "sigma", cut_off,
          "values are cut off toward zero", factor=lambda s: np.sqrt(1 + s * s / 12)),
    Fault("filled", "4", "nb_30min", (0.05, 0.1, 0.3), "share", filled(0),
          "samples are replaced by the mean"),
    Fault("filled_steps", "4", "nb_30min", (0.05, 0.1, 0.3), "share", filled(0.7),
          "the same, on steps of 0.7 sigma"),
    Fault("stuck_bit", "4", "nb_30min", (0.5, 1, 2), "sigma", stuck_bit,
          "a bit of the converter is always 0"),
    Fault("axis_repeats", "3", "nb_30min", (0.03, 0.1, 0.3), "share", axis_repeats(0),
          "one axis repeats its last sample"),
    Fault("axis_repeats_steps", "3", "nb_30min", (0.05, 0.1, 0.3), "share", axis_repeats(0.7),
          "the same, on steps of 0.7 sigma"),
    Fault("rows_interpolated", "3", "nb_30min", (0.05, 0.1, 0.2), "share", rows_interpolated(0),
          "single rows are the means of those beside them"),
    Fault("rows_interpolated_steps", "3", "nb_30min", (0.05, 0.1, 0.2), "share",
          rows_interpolated(0.7), "the same, on steps of 0.7 sigma"),
    Fault("crosstalk", "10", "nb_30min", (0.7, 1, 2), "x", crosstalk,
          "the noise of an axis is on another"),
    Fault("axis_of_two", "10", "nb_30min", (0.5, 0.1, 0.01), "x", axis_of_two,
          "an axis is the mean of the two others"),
    Fault("axis_late", "10", "nb_30min", (1, 3, 8), "rows", axis_late,
          "an axis is another one, some rows later"),
    Fault("accel_leaks", "10", "six_g", (0.4, 0.7, 1.5), "x", accel_leaks,
          "the noise of an accelerometer is on a gyro"),
    Fault("packets_again", "3", "nb_30min", (0.03, 0.05, 0.1), "share", packets_again,
          "packets of ten rows are lost, those before written again"),
    Fault("written_twice", "3", "nb_30min", (0.1, 0.4, 1), "share", written_twice,
          "a part of the log is written again at its end"),
    Fault("lost_rows", "3", "six_g", (0.001, 0.01, 0.05), "share", lost_rows,
          "lost rows are written as zeros"),
    Fault("handled", "8", "six_g", (30, 300, 3000), "sigma", handled,
          "the log begins in a hand"),
    Fault("accel_unit", "10", "temperature", (1 / 9.80665, 1000 / 9.80665, 0.01), "x", wrong_scale,
          "accelerometers in g, mg and Gal under a header of m/s^2"),
    Fault("gyro_unit", "10", "nb_30min", (0.01745329252, 57.29578, 206264.8), "x", wrong_scale,
          "gyros in another unit than the header says", undecidable=SAME_DEVICE,
          says="not_testable"),
    Fault("wrong_rate", "11", "nb_30min", (1.02, 0.5, 2), "rate x", wrong_rate,
          "without a time column and with a wrong --rate", undecidable=SAME_DEVICE,
          says="not_testable"),
]

BY_NAME = {fault.name: fault for fault in FAULTS}
LEVELS = ("weak", "middle", "strong")


def make(fault, level, clean, seed):
    """The faulty log of a clean one. clean is left as it is."""
    record = clean.copy()
    fault.apply(record, noise.generator("fault", fault.name, seed), fault.strengths[level])
    return record
