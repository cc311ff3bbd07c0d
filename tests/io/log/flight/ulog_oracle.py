#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What real logs of PX4 hold, by a reader that has nothing in common with imukit; it is the rows of
test_ulog. Call it with the logs: the samples of pyulog, test/*.ulg.

    ulog_oracle.py LOG.ulg... > ulog_oracle.inc
"""
import math
import pathlib
import re
import struct
import sys

NUMBERS = {"int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i",
           "uint32_t": "I", "int64_t": "q", "uint64_t": "Q", "float": "f", "double": "d",
           "bool": "?", "char": "c"}


def fields_of(text):
    """Name and letter of each number of a flat format."""
    for field in filter(None, text.split(";")):
        kind, name = field.split(" ")
        base, count = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", kind).groups()
        if count is None:
            yield name, NUMBERS[base]
        else:
            for i in range(int(count)):
                yield f"{name}[{i}]", NUMBERS[base]


def messages(content):
    at = 16
    while at + 3 <= len(content):
        size, kind = struct.unpack_from("<Hc", content, at)
        yield kind.decode(), content[at + 3:at + 3 + size]
        at += 3 + size


def rows_of(content):
    formats, numbers, found = {}, {}, {}
    for kind, body in messages(content):
        if kind == "F":
            name, text = body.decode().split(":", 1)
            formats[name] = text
        elif kind == "A":
            instance, number = struct.unpack_from("<BH", body)
            numbers[number] = body[3:].decode(), instance
        elif kind == "D":
            sensor = numbers[struct.unpack_from("<H", body)[0]]
            if sensor[0] not in COLUMNS:
                continue
            fields = list(fields_of(formats[sensor[0]]))
            while fields[-1][0].startswith("_padding"):
                fields.pop()
            numbers_of = struct.unpack_from("<" + "".join(f[1] for f in fields), body, 2)
            found.setdefault(sensor, []).append(dict(zip((f[0] for f in fields), numbers_of)))
    return found


COLUMNS = {
    "sensor_combined": lambda r: (r["timestamp"], [r[f"gyro_rad[{i}]"] for i in range(3)],
                                  [r[f"accelerometer_m_s2[{i}]"] for i in range(3)]),
    "sensor_gyro": lambda r: (r["timestamp_sample"], [r[axis] for axis in "xyz"], []),
    "sensor_accel": lambda r: (r["timestamp_sample"], [], [r[axis] for axis in "xyz"]),
    "vehicle_imu": lambda r: (
        r["timestamp_sample"],
        [r[f"delta_angle[{i}]"] * 1e6 / r["delta_angle_dt"] for i in range(3)],
        [r[f"delta_velocity[{i}]"] * 1e6 / r["delta_velocity_dt"] for i in range(3)]),
    "vehicle_angular_velocity": lambda r: (r["timestamp_sample"],
                                           [r[f"xyz[{i}]"] for i in range(3)], []),
}


def total(vectors):
    return math.fsum((axis + 1) * v[axis] for v in vectors if v for axis in range(3))


for path in map(pathlib.Path, sys.argv[1:]):
    for (name, instance), records in rows_of(path.read_bytes()).items():
        rows = [COLUMNS[name](record) for record in records]
        print(f'    {{"{path.name}", "{name}", {instance}, {len(rows)}, {rows[0][0] / 1e6!r}, '
              f"{rows[-1][0] / 1e6!r},\n     {total([r[1] for r in rows])!r}, "
              f"{total([r[2] for r in rows])!r}}},")
