# SPDX-License-Identifier: Apache-2.0
"""A calibration solved once more: all unknowns in one dense system, derivatives by differences.

    calibration_oracle.py PROBLEM

PROBLEM is written by tests/calibrate/test_calibration_oracle.c, all float64: see Problem. Shares
nothing with the library: the equations are those of docs/theory/measurement-model.md and
calibration.md. The unknowns are the parameters, the mountings of fixtures, the Earth's vertical
rate when the latitude is not known, and of each observation two angles of the vertical or three of
its placement; where turns join rests and the gyros are good enough for it, also two components of
the Earth's horizontal rate at each rest.

Prints, one number a line: the parameters' values; their covariance; of the three groups (gyros,
accelerometers, turns) chi-square by the stated sigmas, redundancy, and what the equation of the
variance factor multiplies the square of the factor by."""

import sys

import numpy as np

(BIAS, SCALE, MISALIGNMENT, CROSS_AXIS, K2, KOQ, K3, ASYMMETRY, CROSS_PRODUCTS, G, G2, LEVER,
 BIAS_T, SCALE_T, T_RATE) = range(15)
KNOWN, PLACED, GRAVITY = range(3)


class Problem:
    def __init__(self, path):
        self.data = np.fromfile(path)
        self.at = 0
        (self.gravity, self.latitude, self.earth, free, fixtures, observations, turns, samples,
         self.dt) = self.take(9)
        self.factor = self.take(3)
        self.axis_factor, self.axis_added = self.take(2, 8), self.take(2, 8)
        self.assumed_factor = self.take(2)  # of placements, of terms
        self.model = self.take(2, 15, 8, 6)
        self.direction = self.take(2, 8, 3)
        self.axes = self.take(2).astype(int)
        self.polynomial = self.take(2, 2, 4)  # bias, scale: order, reference, minimum, maximum
        free = self.take(free, 5)
        self.free = free[:, :4].astype(int)
        self.prior = free[:, 4]
        self.fixture_sigma = self.take(fixtures)
        o = self.take(observations, 47)
        self.knowledge, self.fixture = o[:, 0].astype(int), o[:, 1].astype(int)
        self.rate, self.force, self.acceleration = o[:, 2:5], o[:, 5:8], o[:, 8:11]
        self.temperature, self.temperature_rate = o[:, 11], o[:, 12]
        self.placement, self.weight = o[:, 13], o[:, 14]
        self.reading, self.sigma = o[:, 15:31].reshape(-1, 2, 8), o[:, 31:47].reshape(-1, 2, 8)
        t = self.take(turns, 7)  # from, to, begin, end, sigma, weight, Earth's part of sigma;
                                 # all of one length
        self.turn_from, self.turn_to = t[:, 0].astype(int), t[:, 1].astype(int)
        self.turn_begin, self.turn_end = t[:, 2].astype(int), t[:, 3].astype(int)
        self.turn_sigma, self.turn_weight, self.turn_earth = t[:, 4], t[:, 5], t[:, 6]
        self.record = self.take(samples, 6)  # gyros x y z, accelerometers x y z

    def take(self, *shape):
        shape = [int(n) for n in shape]
        size = int(np.prod(shape))
        part = self.data[self.at:self.at + size].reshape(shape).copy()
        self.at += size
        return part


def exponential(a):
    """Rotation matrices of rotation vectors, (..., 3), by Rodrigues' formula."""
    angle = np.linalg.norm(a, axis=-1)[..., None, None]
    k = np.zeros(a.shape + (3,))
    k[..., 0, 1], k[..., 0, 2], k[..., 1, 2] = -a[..., 2], a[..., 1], -a[..., 0]
    k -= np.swapaxes(k, -1, -2)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    s = np.where(small, 1 - angle**2 / 6, np.sin(safe) / safe)
    c = np.where(small, 0.5 - angle**2 / 24, 2 * np.sin(safe / 2)**2 / safe**2)
    return np.eye(3) + s * k + c * (k @ k)


def warmth(polynomial, temperature):
    order, reference, minimum, maximum = polynomial
    t = np.clip(temperature, minimum, maximum) if order > 0 else temperature
    return np.where(np.isnan(temperature), 0.0, t - reference)


def read_axis(q, model, sensor, i, w, f, alpha, temperature, temperature_rate):
    """What an axis reads: the measurement equation without its output stage."""
    p, e = model[sensor, :, i], q.direction[sensor, i]
    tb, ts = (warmth(q.polynomial[sensor, k], temperature) for k in (0, 1))
    v = w
    if sensor == 1:
        r = p[LEVER, :3]
        v = f + np.cross(alpha, r) + np.cross(w, np.cross(w, r))
    u = v @ e
    scale = p[SCALE, 0] + sum(p[SCALE_T, k] * ts**(k + 1) for k in range(5))
    y = p[BIAS, 0] + sum(p[BIAS_T, k] * tb**(k + 1) for k in range(5))
    y = y + p[T_RATE, 0] * np.where(np.isnan(temperature), 0.0, temperature_rate)
    y = y + (1 + scale) * u + v @ (p[MISALIGNMENT, :3] + p[CROSS_AXIS, :3])
    y = y + p[K2, 0] * u**2 + p[KOQ, 0] * u * abs(u) + p[K3, 0] * u**3 + p[ASYMMETRY, 0] * abs(u) / 2
    if sensor == 0:
        products = (f[:, 0]**2, f[:, 1]**2, f[:, 2]**2, f[:, 0] * f[:, 1], f[:, 1] * f[:, 2],
                    f[:, 2] * f[:, 0])
        return y + f @ p[G, :3] + sum(c * x for c, x in zip(p[G2], products))
    if np.any(p[CROSS_PRODUCTS]):  # axes of a plain triad: input k, pendulous k + 2
        pendulous = np.eye(3)[(int(np.argmax(abs(e))) + 2) % 3]
        a, b = v @ pendulous, v @ np.cross(pendulous, e)
        y = y + p[CROSS_PRODUCTS, 0] * u * a + p[CROSS_PRODUCTS, 1] * u * b
        y = y + p[CROSS_PRODUCTS, 2] * a * b
    return y


def across(n):
    """Two unit vectors across each of some unit vectors: any will do."""
    helper = np.eye(3)[np.argmin(abs(n), axis=1)]
    a = np.cross(n, helper)
    a /= np.linalg.norm(a, axis=1)[:, None]
    return a, np.cross(n, a)


def carry(q, models):
    """Rotations that carry a direction over the turns, of each of some models: product of
    exponentials of corrected rates.

    Samples are means over their intervals; coning to second order by the sample before."""
    shape = (len(models), len(q.turn_from), 3)
    total = np.broadcast_to(np.eye(3), shape + (3,))
    before = np.zeros(shape)
    response = [(1 + models[:, s, SCALE, :3, 0])[..., None] * q.direction[s, :3] +
                models[:, s, MISALIGNMENT, :3, :3] + models[:, s, CROSS_AXIS, :3, :3]
                for s in (0, 1)]
    inverse = [np.swapaxes(np.linalg.inv(r), 1, 2) for r in response]
    bias = [models[:, s, None, BIAS, :3, 0] for s in (0, 1)]
    sensitivity = np.swapaxes(models[:, 0, G, :3, :3], 1, 2)
    for k in range(q.turn_end[0] - q.turn_begin[0]):
        sample = q.record[q.turn_begin + k]
        f = (sample[:, 3:] - bias[1]) @ inverse[1]
        w = (sample[:, :3] - bias[0] - f @ sensitivity) @ inverse[0]
        theta = w * q.dt
        total = exponential(-(theta + np.cross(before, theta) / 12)) @ total
        before = theta
    return total


class Point:
    """The unknowns: globals (parameters, fixtures, vertical rate) and attitudes."""

    def __init__(self, q):
        self.model = q.model
        self.values = np.array([q.model[tuple(place)] for place in places(q)])
        self.fixture = np.zeros((len(q.fixture_sigma), 3))
        self.vertical_rate = 0.0
        self.attitude = np.zeros((len(q.knowledge), 3))
        self.horizontal = np.zeros((len(q.knowledge), 3))
        gravity = q.knowledge == GRAVITY
        forces = q.reading[gravity, 1, :3]
        self.attitude[gravity] = forces / np.linalg.norm(forces, axis=1)[:, None]

    def moved(self, q, globals_step, local_step):
        new = Point.__new__(Point)
        n, m = len(self.values), 3 * len(self.fixture)
        new.values = self.values + globals_step[:n]
        new.fixture = self.fixture + globals_step[n:n + m].reshape(-1, 3)
        new.vertical_rate = self.vertical_rate + (globals_step[n + m] if free_earth(q) else 0.0)
        new.model = q.model.copy()
        for value, place in zip(new.values, places(q)):
            new.model[place] = value
        a, b = across_of(q, self.attitude)
        gravity = (q.knowledge == GRAVITY)[:, None]
        turned = self.attitude + a * local_step[:, :1] + b * local_step[:, 1:2]
        turned /= np.where(gravity, np.linalg.norm(turned, axis=1)[:, None], 1.0)
        new.attitude = np.where(gravity, turned, self.attitude + local_step[:, :3])
        h = self.horizontal + a * local_step[:, 3:4] + b * local_step[:, 4:5]
        new.horizontal = h - np.sum(h * new.attitude, axis=1)[:, None] * new.attitude
        return new


def places(q):
    return [tuple(place) for place in q.free]


def free_earth(q):
    rests = (q.knowledge == GRAVITY) & ~np.all(np.isnan(q.reading[:, 0]), axis=1)
    return bool(np.isnan(q.latitude) and q.earth > 0 and np.any(rests))


def horizontal_variance(q):
    """Of the Earth's rate along each direction across the vertical, heading unknown."""
    return q.earth**2 / 3 if np.isnan(q.latitude) else (q.earth * np.cos(q.latitude))**2 / 2


def chained(q):
    """Per observation: the Earth's horizontal rate is unknown, and carried by turns."""
    seen = ~np.isnan(q.reading[:, 0]) & (q.knowledge == GRAVITY)[:, None]
    joined = np.zeros(len(q.knowledge), bool)
    if len(q.turn_from) and np.median(q.sigma[:, 0][seen]**2) < horizontal_variance(q) / 0.02:
        joined[q.turn_from] = joined[q.turn_to] = True
    return joined


def across_of(q, attitude):
    vertical = attitude.copy()
    vertical[q.knowledge != GRAVITY] = (0, 0, 1)
    return across(vertical)


def predict(q, point):
    """Readings, (observations, 2, 8)."""
    w, f, alpha = q.rate.copy(), q.force.copy(), q.acceleration.copy()
    turned = exponential(-point.attitude)
    mounted = q.fixture >= 0
    if len(point.fixture):
        turned[mounted] = turned[mounted] @ exponential(-point.fixture)[q.fixture[mounted]]
    w, f, alpha = (np.einsum('nij,nj->ni', turned, x) for x in (w, f, alpha))
    rest = q.knowledge == GRAVITY
    vertical = q.earth * np.sin(q.latitude) if not np.isnan(q.latitude) else point.vertical_rate
    f[rest] = q.gravity * point.attitude[rest]
    w[rest] = vertical * point.attitude[rest] + point.horizontal[rest]
    alpha[rest] = 0
    y = np.full(q.reading.shape, np.nan)
    for sensor in (0, 1):
        for i in range(q.axes[sensor]):
            y[:, sensor, i] = read_axis(q, point.model, sensor, i, w, f, alpha, q.temperature,
                                        q.temperature_rate)
    return y


def miss(q, rotations, start, end, a, b):
    """How far turns end from the verticals after them, components across these."""
    e = np.einsum('nij,nj->ni', rotations, start)
    u, v, along = (np.sum(x * e, axis=1) for x in (a, b, end))
    s = np.hypot(u, v)
    stretch = np.where(s > 1e-9, np.arctan2(s, along) / np.where(s > 1e-9, s, 1.0), 1.0)
    return np.stack((stretch * u, stretch * v), axis=1)


def system(q, point):
    """Rows of derivatives and residuals, priors last; sigma of rows, what no factor multiplies of
    their variance, weight, group."""
    n, fixtures = len(point.values), 3 * len(point.fixture)
    globals_count = n + fixtures + free_earth(q)
    local = np.full((len(q.knowledge), 5), -1)
    earth = chained(q)
    count = globals_count
    for k, knowledge in enumerate(q.knowledge):
        own = 2 if knowledge == GRAVITY else 3 if knowledge == PLACED else 0
        local[k, :own] = count + np.arange(own)
        count += own
        if earth[k]:
            local[k, 3:] = count, count + 1
            count += 2
    none = np.zeros((len(q.knowledge), 5))

    def differences(of, is_global, size):
        """Central differences of a function of a point by all unknowns of one kind."""
        for k in range(globals_count if is_global else 5):
            step = np.zeros(globals_count)
            change = none.copy()
            if is_global:
                step[k] = size[k]
            else:
                change[:, k] = size
            h = size[k] if is_global else size
            high, low = (of(point.moved(q, s * step, s * change)) for s in (1, -1))
            yield (high - low) / (2 * h)

    # Steps large enough for rounding, small enough for the cubic terms of angles.
    size = np.full(globals_count, 1e-4)
    observed = ~np.isnan(q.reading)
    index = np.argwhere(observed)
    rows = np.zeros((len(index), count))
    for k, d in enumerate(differences(lambda x: predict(q, x), True, size)):
        rows[:, k] = d[observed]
    for k, d in enumerate(differences(lambda x: predict(q, x), False, 1e-5)):
        column = local[index[:, 0], k]
        rows[np.arange(len(index)), column] = np.where(column >= 0, d[observed], rows[
            np.arange(len(index)), column])
    residual = (q.reading - predict(q, point))[observed]
    sigma = q.sigma[observed]
    along = np.einsum('nj,ij->ni', point.attitude, q.direction[0])
    horizontal = horizontal_variance(q)
    spread = np.zeros_like(q.reading)
    spread[:, 0] = np.where(((q.knowledge == GRAVITY) & ~earth)[:, None],
                            horizontal * (1 - along**2), 0.0)
    known = spread[observed]
    weight = q.weight[index[:, 0]]
    group = index[:, 1]
    factor, added = q.axis_factor[index[:, 1], index[:, 2]], q.axis_added[index[:, 1], index[:, 2]]

    if len(q.turn_from):
        time = (q.turn_end[0] - q.turn_begin[0]) * q.dt

        def leaving(x):
            """Where a turn carries from: the vertical, and what the Earth turns it by."""
            n, h = x.attitude[q.turn_from], x.horizontal[q.turn_from]
            return n + time * np.cross(h, n)

        start, end = leaving(point), point.attitude[q.turn_to]
        a, b = across(end)
        t = np.zeros((len(q.turn_from), 2, count))
        gyro = [k for k, place in enumerate(places(q)) if place[0] == 0]
        steps = [x for k in gyro for x in size[k] * np.eye(globals_count)[k] * [[1], [-1]]]
        base, *moved = carry(q, np.stack([point.model] + [point.moved(q, x, none).model
                                                          for x in steps]))
        for k, high, low in zip(gyro, moved[::2], moved[1::2]):
            t[:, :, k] = (miss(q, high, start, end, a, b) -
                          miss(q, low, start, end, a, b)) / (2 * size[k])
        each = np.arange(len(q.turn_from))
        for k in (0, 1, 3, 4):
            change = none.copy()
            change[:, k] = 1e-5
            high, low = (point.moved(q, np.zeros(globals_count), s * change) for s in (1, -1))
            if k < 2 or np.any(earth):
                t[each, :, local[q.turn_from, k]] = (
                    miss(q, base, leaving(high), end, a, b) -
                    miss(q, base, leaving(low), end, a, b)) / 2e-5
            if k > 2:
                continue
            # The vertical after the turn comes towards the end, or goes.
            moved = across_of(q, point.attitude)[k][q.turn_to]
            t[each, 0, local[q.turn_to, k]] -= np.sum(moved * a, axis=1)
            t[each, 1, local[q.turn_to, k]] -= np.sum(moved * b, axis=1)
        rows = np.vstack((rows, t.reshape(-1, count)))
        residual = np.append(residual, -miss(q, base, start, end, a, b).ravel())
        own = np.where(earth[q.turn_from], q.turn_sigma**2 - q.turn_earth**2, q.turn_sigma**2)
        sigma = np.append(sigma, np.repeat(np.sqrt(own), 2))
        known = np.append(known, np.zeros(2 * len(q.turn_from)))
        weight = np.append(weight, np.repeat(q.turn_weight, 2))
        group = np.append(group, np.full(2 * len(q.turn_from), 2))
        factor = np.append(factor, np.full(2 * len(q.turn_from), q.factor[2]))
        added = np.append(added, np.zeros(2 * len(q.turn_from)))

    def prior(column, value, sigma_of, of=1.0):
        nonlocal rows, residual, sigma, known, weight, group, factor, added
        row = np.zeros((1, count))
        row[0, column] = 1
        rows, residual = np.vstack((rows, row)), np.append(residual, -value)
        sigma, known = np.append(sigma, sigma_of), np.append(known, 0.0)
        weight, group = np.append(weight, 1.0), np.append(group, 3)
        factor, added = np.append(factor, of), np.append(added, 0.0)

    for k, (place, own) in enumerate(zip(places(q), q.prior)):
        if own > 0:
            prior(k, point.values[k] - q.model[place], own, q.assumed_factor[1])
    for k in range(fixtures):
        prior(n + k, point.fixture.ravel()[k], q.fixture_sigma[k // 3])
    if free_earth(q):
        prior(globals_count - 1, point.vertical_rate, q.earth / np.sqrt(3))
    def add_known(row, value, sigma_of):
        """One row of derivatives and what is known of it, 0 +- sigma."""
        nonlocal rows, residual, sigma, known, weight, group, factor, added
        rows, residual = np.vstack((rows, row)), np.append(residual, -value)
        sigma, known = np.append(sigma, sigma_of), np.append(known, 0.0)
        weight, group = np.append(weight, 1.0), np.append(group, 3)
        factor, added = np.append(factor, 1.0), np.append(added, 0.0)

    for k in np.flatnonzero(earth):
        into = np.flatnonzero((q.turn_to == k) & (q.turn_from < k))[:1]
        into = into[q.turn_weight[into] > 0.5]
        a, b = (x[k] for x in across_of(q, point.attitude))
        for axis, column in ((a, 3), (b, 4)):
            row, value = np.zeros(count), axis @ point.horizontal[k]
            row[local[k, column]] = 1.0
            for j in into:  # what the gyros carried there, good to 3 %
                f = q.turn_from[j]
                value -= axis @ base[j] @ point.horizontal[f]
                for d, other in zip(across_of(q, point.attitude), (3, 4)):
                    row[local[f, other]] = -axis @ base[j] @ d[f]
            add_known(row, value, (0.03 if len(into) else 1.0) * np.sqrt(horizontal))
    for k in np.flatnonzero(q.knowledge == PLACED):
        for j in range(3):
            prior(local[k, j], point.attitude[k, j], q.placement[k], q.assumed_factor[0])
    variance = (sigma * factor)**2 + added**2 + known
    return rows, residual, sigma, known, weight, group, globals_count, local, variance


def solve(q):
    point = Point(q)
    for _ in range(20):
        (rows, residual, sigma, known, weight, group, globals_count, local,
         variance) = system(q, point)
        scale = np.sqrt(weight / variance)
        unit = 1 / np.linalg.norm(rows * scale[:, None], axis=0)  # columns of length 1
        white = rows * (scale[:, None] * unit)
        step = unit * np.linalg.lstsq(white, residual * scale, rcond=None)[0]
        change = np.zeros(local.shape)
        change[local >= 0] = step[local[local >= 0]]
        point = point.moved(q, step[:globals_count], change)
        if np.max(abs(step / unit)) < 1e-5:  # sigmas; what is left is its square
            break
    rows, residual, sigma, known, weight, group, _, _, variance = system(q, point)
    scale = np.sqrt(weight / variance)
    unit = 1 / np.linalg.norm(rows * scale[:, None], axis=0)
    white = rows * (scale[:, None] * unit)
    inverse = np.linalg.pinv(white)
    covariance = (inverse @ inverse.T) * unit[:, None] * unit
    left = 1 - np.einsum('ij,ji->i', white, inverse)
    n = len(point.values)
    figures = []
    for g in range(3):
        used = (group == g) & (weight >= 1)
        share = (sigma[used] * q.factor[g])**2 / variance[used]
        square = residual[used]**2 / variance[used]
        freedom = np.sum(share**2 * left[used])
        stated = residual[used]**2 / (sigma[used]**2 + known[used])
        figures += [np.sum(stated), np.sum(left[used]),
                    1 + np.sum(share * (square - left[used])) / freedom if freedom > 0 else 1.0]
    return np.concatenate((point.values, covariance[:n, :n].ravel(), figures))


if __name__ == '__main__':
    for x in solve(Problem(sys.argv[1])):
        print(f'{x:.17g}')
