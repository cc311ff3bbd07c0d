# SPDX-License-Identifier: Apache-2.0
"""Strapdown mechanisation in inertial axes, written from the equations and sharing nothing with the
library: for tests/navigate/test_independent.c.

    python3 tests/reference/mechanisation.py SAMPLES

SAMPLES holds doubles: rate [Hz]; latitude, longitude [rad], height [m]; velocity north, east, down
[m/s]; roll, pitch, yaw [rad]; then rows of six means over successive samples, angular rate x, y, z
[rad/s] and specific force x, y, z [m/s^2]. Printed is the state after the last: Earth-fixed
position [m] and velocity [m/s], and the quaternion body to Earth-fixed axes, scalar first.

The inertial axes i are the Earth-fixed ones of the start. In them

    dq_ib/dt = q_ib (0, rate)/2,   d^2 r/dt^2 = C_ib force + G(r)

with G the gravitation, normal gravity without its centrifugal part. Within a sample rate and force
are the parabolas that have the means of this sample, the one before and the one after. The body's
turn within each sample is integrated by Runge and Kutta's formula of fourth order, the force on the
turned axes by Simpson's; the turns then make the attitudes, and r follows from sample to sample
with the gravitation of the middle of each.
"""
import math
import sys

import numpy

A, FLATTENING, RATE = 6378137.0, 1.0 / 298.257223563, 7.292115e-5
E2 = FLATTENING * (2.0 - FLATTENING)
# Somigliana's formula and the change with height [NIMA-TR8350.2, eqs. 4-1 and 4-3].
EQUATOR, POLE_EXCESS, RATIO = 9.7803253359, 1.93185265241e-3, 3.44978650684e-3


def product(a, b):
    """Quaternions a b, each as four arrays."""
    (aw, ax, ay, az), (bw, bx, by, bz) = a, b
    return numpy.array([aw * bw - ax * bx - ay * by - az * bz,
                        aw * bx + ax * bw + ay * bz - az * by,
                        aw * by - ax * bz + ay * bw + az * bx,
                        aw * bz + ax * by - ay * bx + az * bw])


def rotated(q, v):
    """Vectors v, three arrays, turned by the quaternions q."""
    w, x, y, z = q
    ww, xx, yy, zz = w * w, x * x, y * y, z * z
    matrix = numpy.array([[ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                          [2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)],
                          [2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz]])
    return numpy.einsum("ijk,jk->ik", matrix / (ww + xx + yy + zz), v)


def parabola(mean, at):
    """Values at `at`, from -1/2 to 1/2 of each sample, of what has these means: three arrays."""
    before = numpy.concatenate([mean[:, :1], mean[:, :-1]], axis=1)
    after = numpy.concatenate([mean[:, 1:], mean[:, -1:]], axis=1)
    return mean + (after - before) / 2 * at + (after - 2 * mean + before) * (at * at / 2 - 1 / 24)


def half_sample(q, first, middle, last, step):
    """Runge-Kutta for dq/dt = q (0, rate)/2 over `step`, with the rates at its start, middle and
    end."""
    def slope(turn, rate):
        return 0.5 * product(turn, numpy.array([numpy.zeros_like(rate[0]), *rate]))

    k1 = slope(q, first)
    k2 = slope(q + step / 2 * k1, middle)
    k3 = slope(q + step / 2 * k2, middle)
    k4 = slope(q + step * k3, last)
    return q + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def samples_alone(rate, force, dt):
    """Of each sample, in body axes at its start: the turn, and the first and the second integral of
    the force."""
    w = [parabola(rate, at) for at in (-0.5, -0.25, 0.0, 0.25, 0.5)]
    f = [parabola(force, at) for at in (-0.5, 0.0, 0.5)]
    none = numpy.zeros((4, rate.shape[1]))
    none[0] = 1.0
    middle = half_sample(none, w[0], w[1], w[2], dt / 2)
    end = half_sample(middle, w[2], w[3], w[4], dt / 2)
    f[1], f[2] = rotated(middle, f[1]), rotated(end, f[2])
    return end, (f[0] + 4 * f[1] + f[2]) * (dt / 6), (f[0] + 2 * f[1]) * (dt * dt / 6)


def attitudes(start, turns):
    """q_ib at the start of each sample and after the last."""
    w, x, y, z = start
    out = [start]
    for a, b, c, d in turns.T.tolist():
        w, x, y, z = (w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c,
                      w * c - x * d + y * a + z * b, w * d + x * c - y * b + z * a)
        length = math.sqrt(w * w + x * x + y * y + z * z)
        w, x, y, z = w / length, x / length, y / length, z / length
        out.append((w, x, y, z))
    return numpy.array(out).T


def place(p, z, latitude):
    """Latitude and height, from an approximate latitude: each round leaves 0.007 of the error."""
    for _ in range(3):
        sine = math.sin(latitude)
        radius = A / math.sqrt(1.0 - E2 * sine * sine)
        height = p / math.cos(latitude) - radius
        latitude = math.atan2(z, p * (1.0 - E2 * radius / (radius + height)))
    return latitude, height


def bend(s, height):
    """What gravity aloft has toward the equator, over height and sin(2 latitude): as a field
    without curl needs it, the derivative with s = sin^2(latitude) of the gravity between the
    ellipsoid and the height, over the meridian's radius; second order in height."""
    root = math.sqrt(1.0 - E2 * s)
    surface = EQUATOR * (1.0 + POLE_EXCESS * s) / root
    slope = EQUATOR * (POLE_EXCESS + E2 / 2 * (1.0 + POLE_EXCESS * s) / root**2) / root
    meridian = A * (1.0 - E2) / root**3
    linear = 1.0 + FLATTENING + RATIO - 2.0 * FLATTENING * s
    return (slope * (1.0 - linear * height / A) + 2.0 * FLATTENING * surface * height / A) / (
        meridian + height)


def fly(position, velocity, gain, way, dt, latitude):
    """r and v after all samples, given the force's integrals in inertial axes."""
    (x, y, z), (u, v, w) = position, velocity
    for (a, b, c), (d, e, f) in zip(gain.T.tolist(), way.T.tolist()):
        mx, my, mz = x + u * dt / 2, y + v * dt / 2, z + w * dt / 2
        p = math.hypot(mx, my)
        latitude, height = place(p, mz, latitude)
        s, relative = math.sin(latitude) ** 2, height / A
        gravity = (EQUATOR * (1.0 + POLE_EXCESS * s) / math.sqrt(1.0 - E2 * s) *
                   (1.0 - 2.0 * (1.0 + FLATTENING + RATIO - 2.0 * FLATTENING * s) * relative +
                    3.0 * relative * relative))
        north = -height * bend(s, height)
        across = (-gravity - 2.0 * s * north) * math.cos(latitude) / p - RATE * RATE
        gx, gy = across * mx, across * my
        gz = (-gravity + 2.0 * (1.0 - s) * north) * math.sin(latitude)
        x, y, z = (x + u * dt + d + gx * dt * dt / 2, y + v * dt + e + gy * dt * dt / 2,
                   z + w * dt + f + gz * dt * dt / 2)
        u, v, w = u + a + gx * dt, v + b + gy * dt, w + c + gz * dt
    return numpy.array([x, y, z]), numpy.array([u, v, w])


def axes(latitude, longitude):
    """North, east, down as columns, Earth-fixed."""
    sp, cp = math.sin(latitude), math.cos(latitude)
    sl, cl = math.sin(longitude), math.cos(longitude)
    return numpy.array([[-sp * cl, -sl, -cp * cl], [-sp * sl, cl, -cp * sl], [cp, 0.0, -sp]])


def about(axis, angle):
    q = numpy.zeros(4)
    q[0], q[1 + axis] = math.cos(angle / 2), math.sin(angle / 2)
    return q


def main():
    data = numpy.fromfile(sys.argv[1])
    rate, latitude, longitude, height = data[:4]
    roll, pitch, yaw = data[7:10]
    means = data[10:].reshape(-1, 6).T
    dt = 1.0 / rate

    radius = A / math.sqrt(1.0 - E2 * math.sin(latitude) ** 2)
    across = (radius + height) * math.cos(latitude)
    position = numpy.array([across * math.cos(longitude), across * math.sin(longitude),
                            (radius * (1.0 - E2) + height) * math.sin(latitude)])
    spin = numpy.array([0.0, 0.0, RATE])
    velocity = axes(latitude, longitude) @ data[4:7] + numpy.cross(spin, position)
    # Longitude about z, then latitude about the west axis, from down along -x to north, east, down.
    q = product(about(2, longitude), about(1, -latitude - math.pi / 2))
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        q = product(q, about(axis, angle))

    turns, gain, way = samples_alone(means[:3], means[3:], dt)
    attitude = attitudes(tuple(q.tolist()), turns)
    position, velocity = fly(position.tolist(), velocity.tolist(),
                             rotated(attitude[:, :-1], gain), rotated(attitude[:, :-1], way), dt,
                             latitude)

    back = about(2, -RATE * dt * means.shape[1])
    velocity = velocity - numpy.cross(spin, position)
    position, velocity = (rotated(back[:, None], v[:, None])[:, 0] for v in (position, velocity))
    print(*[repr(float(v)) for v in (*position, *velocity, *product(back, attitude[:, -1]))])


if __name__ == "__main__":
    main()
