# SPDX-License-Identifier: Apache-2.0
"""The samples of the test files, by formula: the readers' tests compute the same."""

START = 1700000000 * 10**9 + 123456789  # [ns]
STEP = 5000001  # [ns]
DELAY = 1500000  # [ns] from the measurement to the recording


def stamp(i):
    return START + i * STEP


def gyro(i):
    return [i * 0.001 + axis * 0.1 for axis in range(3)]


def accel(i):
    return [i * -0.01 + axis * 9.80665 for axis in range(3)]
