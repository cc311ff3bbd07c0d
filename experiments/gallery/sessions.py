# SPDX-License-Identifier: Apache-2.0
"""Bench sessions with a known truth: attitudes, turns, readings of a unit.

Body and navigation axes are north, east, down; f = -g at rest. Readings are means over a sample:
(I + E) input + bias, and for gyros also G force, plus noise.
"""
from dataclasses import dataclass

import numpy as np

import noise
from records import Column, Record

LATITUDE, EARTH_RATE, GRAVITY = np.radians(48.1), 7.292115e-5, 9.80739  # at 520 m
POSITION = ["--position", "48.1 deg, 11.6 deg, 520 m"]
STANDARD_GRAVITY = 9.80665
DEG_H_G = np.radians(1) / 3600 / STANDARD_GRAVITY
AXES = "xyz"


@dataclass
class Unit:
    """Errors of a consumer part; a triad of accelerometers is upper triangular. The slow noise is
    weak: without a model of it, the intervals of calibrate assume that there is none."""
    gyro_bias: np.ndarray
    gyro_matrix: np.ndarray  # scale factor and misalignment, without the identity
    g_sensitivity: np.ndarray
    accel_bias: np.ndarray
    accel_matrix: np.ndarray
    gyro_white: np.ndarray  # [rad/sqrt(s)]
    accel_white: np.ndarray  # [m/s/sqrt(s)]
    gyro_flicker: float = np.radians(1) / 3600
    accel_flicker: float = 5e-6 * STANDARD_GRAVITY

    def truth(self):
        """Parameters by the names of --json."""
        named = {}
        for sensor in ("gyro", "accel"):
            bias, matrix = getattr(self, sensor + "_bias"), getattr(self, sensor + "_matrix")
            for i, a in enumerate(AXES):
                named[f"{sensor}.bias.fixed.{a}"] = bias[i]
                named[f"{sensor}.scale_factor.fixed.{a}"] = matrix[i, i]
                for j, b in enumerate(AXES):
                    if i != j:
                        named[f"{sensor}.misalignment.{a}.{b}"] = matrix[i, j]
        for i, a in enumerate(AXES):
            for j, b in enumerate(AXES):
                named[f"gyro.g_sensitivity.{a}.{b}"] = self.g_sensitivity[i, j]
        return named


def draw_unit(rng, full_frame=False, g_sensitivity=10.0):
    """A unit by chance. full_frame: misalignments of the accelerometers in the housing's frame."""
    accel = np.diag(rng.normal(0, 6e-3, 3)) + (1 - np.eye(3)) * rng.normal(0, 3e-3, (3, 3))
    gyro = np.diag(rng.normal(0, 6e-3, 3)) + (1 - np.eye(3)) * rng.normal(0, 3e-3, (3, 3))
    return Unit(rng.normal(0, np.radians(0.5), 3), gyro,
                rng.normal(0, g_sensitivity, (3, 3)) * DEG_H_G, rng.normal(0, 0.3, 3),
                accel if full_frame else np.triu(accel),
                np.full(3, np.radians(0.3) / 60), np.full(3, 0.05 / 60))


def rotation(vector):
    """Rotation matrix of a rotation vector."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def between(a, b):
    """Rotation vector in body axes that leads from attitude a to b (body to navigation)."""
    r = a.T @ b
    angle = np.arccos(np.clip((np.trace(r) - 1) / 2, -1, 1))
    if angle > np.pi - 1e-6:  # the axis is the largest column of r + 1
        m = r + np.eye(3)
        axis = m[:, np.argmax(np.diag(m))]
        return np.pi * axis / np.linalg.norm(axis)
    axis = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    length = np.linalg.norm(axis)
    return angle * axis / length if length > 0 else np.zeros(3)


class Session:
    """Mean rates and forces over samples, in body axes, as the unit is turned and rests."""

    def __init__(self, rate=100.0, attitude=None):
        self.dt = 1 / rate
        self.attitude = np.eye(3) if attitude is None else attitude
        self.rates, self.forces = [], []

    def _add(self, vector, shares):
        """Turn about `vector` (body axes); shares of the turn at the ends of the samples."""
        angle = np.linalg.norm(vector)
        axis = vector / angle if angle > 0 else np.array([1.0, 0, 0])
        middle = angle * (shares[1:] + shares[:-1]) / 2
        earth = EARTH_RATE * np.array([np.cos(LATITUDE), 0, -np.sin(LATITUDE)])
        for input_, out, extra in ((earth, self.rates, np.diff(shares)[:, None] * vector / self.dt),
                                   (np.array([0, 0, -GRAVITY]), self.forces, 0)):
            v = self.attitude.T @ input_
            along, across = axis * (axis @ v), v - axis * (axis @ v)
            turned = np.outer(np.cos(middle), across) - np.outer(np.sin(middle),
                                                                 np.cross(axis, across))
            out.append(along + turned + extra)
        self.attitude = self.attitude @ rotation(vector * shares[-1])

    def rest(self, seconds):
        self._add(np.zeros(3), np.linspace(0, 1, int(round(seconds / self.dt)) + 1))

    def turn(self, vector, seconds):
        u = np.linspace(0, 1, int(round(seconds / self.dt)) + 1)
        self._add(np.asarray(vector, float), u - np.sin(2 * np.pi * u) / (2 * np.pi))

    def turn_to(self, attitude, seconds):
        self.turn(between(self.attitude, attitude), seconds)

    def spin(self, axis, rate, seconds):
        """A step of a table: rate [rad/s] about a body axis."""
        vector = np.zeros(3)
        vector[axis] = rate * seconds
        self._add(vector, np.linspace(0, 1, int(round(seconds / self.dt)) + 1))

    def read(self, rng, unit):
        """The log of a unit: time, gyros, accelerometers; and the inputs."""
        rates, forces = np.vstack(self.rates), np.vstack(self.forces)
        n = len(rates)
        gyro = rates @ (np.eye(3) + unit.gyro_matrix).T + unit.gyro_bias
        gyro += forces @ unit.g_sensitivity.T
        accel = forces @ (np.eye(3) + unit.accel_matrix).T + unit.accel_bias
        columns = []
        for name, unit_name, values, white, b in (
                ("gyro", "rad/s", gyro, unit.gyro_white, unit.gyro_flicker),
                ("accel", "m/s^2", accel, unit.accel_white, unit.accel_flicker)):
            for i, a in enumerate(AXES):
                x = values[:, i] + noise.white(rng, n, self.dt, white[i])
                slow = noise.flicker(rng, n, b)
                columns.append(Column(f"{name}_{a}", unit_name, x + slow - slow.mean()))
        return Record(self.dt, np.arange(n) * self.dt, columns), rates, forces


FACES = [rotation(v) for v in (np.array([0, 0, 0.0]), np.array([np.pi, 0, 0]),
                               np.array([np.pi / 2, 0, 0]), np.array([-np.pi / 2, 0, 0]),
                               np.array([0, np.pi / 2, 0]), np.array([0, -np.pi / 2, 0]))]


def random_attitude(rng):
    q = rng.standard_normal(4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def poses(rng, count, attitudes=None):
    """The unit by hand in random attitudes, after a rest of 20 s. attitudes: only so many different
    ones, in turn, each found again to 2 degrees."""
    some = [random_attitude(rng) for _ in range(attitudes or count)]
    s = Session(attitude=some[0])
    s.rest(20)
    for k in range(1, count):
        near = rotation(rng.normal(0, np.radians(2), 3)) if attitudes else np.eye(3)
        s.turn_to(some[k % len(some)] @ near, rng.uniform(1.5, 2.5))
        s.rest(4)
    return s


def six_faces(rng, rounds, placement, faces=6):
    """Each of the faces `rounds` times, at any heading; placement: 1 sigma of the error about each
    axis [rad]."""
    s = Session()
    for k in range(faces * rounds):
        heading = rotation(np.array([0, 0, rng.uniform(0, 2 * np.pi)]))
        s.turn_to(heading @ FACES[k % faces] @ rotation(rng.normal(0, placement, 3)), 2)
        s.rest(6)
    return s


def rate_table(rng, rates=(20, -20, 60, -60, 120, -120)):
    """Steps about the vertical with each axis up in turn."""
    s = Session()
    for face, axis in ((0, 2), (2, 1), (4, 0)):
        s.turn_to(FACES[face], 3)
        s.rest(5)
        for rate in rates:
            s.spin(axis, np.radians(rate), 5)
        s.rest(5)
    return s
