#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares imukit with the reference programs of ROS 1 bags, MCAP and rosbag2, to the last bit.

    experiments/formats/check_bags.py [SAMPLES]

Files that rosbag, @mcap/core and SQLite wrote are read by imukit, from a file and from a pipe; logs
that imukit wrote are read by them. Needs build/imukit; the Debian packages python3-rosbag and
python3-sensor-msgs, zstd and lz4; and npm, which fetches @mcap/core and the like into
build/formats. Prints a line for each comparison."""
import os
import pathlib
import random
import sqlite3
import struct
import subprocess
import sys

import samples

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
IMUKIT = str(ROOT / "build/imukit")
FILES = ROOT / "build/formats"
PACKAGES = ["@mcap/core@2", "@mcap/support@1", "@foxglove/rosmsg@5", "@foxglove/cdr@3",
            "@foxglove/rosmsg-serialization@2", "@foxglove/rosmsg2-serialization@3"]
NODE = dict(os.environ, NODE_PATH=str(FILES / "node_modules"))
PYTHON = "/usr/bin/python3"


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE,
                          **options).stdout


def bits(value):
    return struct.pack(">d", float(value)).hex()


def convert(*arguments, data=None):
    """The rows that imukit reads, as texts of bits."""
    rows = run(IMUKIT, "convert", *arguments, "-", input=data).decode().splitlines()[1:]
    return [tuple(bits(cell) for cell in row.split(",")) for row in rows]


def told(name, rows, due):
    good = rows == due
    print(f"{'equal' if good else 'DIFFERENT'}  {len(rows):7} rows  {name}")
    return good


def check_reading(count):
    def due(first, last, columns):
        return [tuple(bits(v) for v in [(samples.stamp(i) - samples.START) / 1e9]
                      + (samples.gyro(i) if "g" in columns else [])
                      + (samples.accel(i) if "a" in columns else []))
                for i in range(first, last)]

    run(PYTHON, HERE / "write_ros1.py", FILES, count)
    run("node", HERE / "write_mcap.cjs", FILES, count, env=NODE)
    run(PYTHON, HERE / "write_rosbag2.py", FILES, count)
    whole = due(0, count, "ga")
    cases = [(f"{name}.bag", whole) for name in ("none", "bz2", "lz4", "outside")]
    cases += [(f"{name}.mcap", whole)
              for name in ("cdr_none", "cdr_lz4", "cdr_zstd", "ros1_lz4", "big", "unchunked",
                           "no_summary")]
    cases += [("single.db3", whole), ("two", whole), ("packed", whole), ("parts", whole + whole),
              ("messages", due(0, min(count, 24), "ga")), ("no_gyro.bag", due(0, 3, "a")),
              ("no_accel.bag", due(0, 3, "g"))]
    good = True
    for name, rows in cases:
        path = FILES / name
        good &= told(f"read {name}", convert(path), rows)
        if path.is_file():
            good &= told(f"read {name}, from a pipe", convert("-", data=path.read_bytes()), rows)
    # Without stamps the times are those of recording.
    delayed = due(0, 3, "ga")
    return good & told("read unstamped.bag", convert(FILES / "unstamped.bag"), delayed)


def read_db3(path):
    """The messages of /imu by Python's SQLite and struct."""
    rows = []
    base = sqlite3.connect(path)
    assert base.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    (topic,), = base.execute("SELECT id FROM topics WHERE name = '/imu' AND "
                             "type = 'sensor_msgs/msg/Imu' AND serialization_format = 'cdr'")
    for received, data in base.execute(
            "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp, id",
            (topic,)):
        seconds, nanoseconds, size = struct.unpack_from("<iII", data, 4)
        assert data[:4] == b"\0\1\0\0" and data[16:16 + size] == b"imu\0"
        numbers = struct.unpack_from("<37d", data, 20)
        assert received == seconds * 10**9 + nanoseconds and numbers[4] == -1
        values = (numbers[13:16] if numbers[16] != -1 else ()) \
            + (numbers[25:28] if numbers[28] != -1 else ())
        rows.append((received, *(bits(v) for v in values)))
    return rows


def read_lines(text, number):
    return [(int(line[0]), *(number(v) for v in line[1:]))
            for line in map(str.split, text.decode().splitlines())]


def check_writing(count):
    random.seed(1)
    rows = [(n * 5000001, *(random.gauss(0, 0.1) for _ in range(3)),
             *(random.gauss(0, 10) for _ in range(3))) for n in range(count)]
    names = ["time [s]"] + [f"gyro_{a} [rad/s]" for a in "xyz"] + [f"accel_{a} [m/s^2]" for a in "xyz"]
    source = FILES / "source.csv"
    source.write_text(",".join(names) + "\n" + "".join(
        f"{r[0] / 1e9!r}," + ",".join(repr(v) for v in r[1:]) + "\n" for r in rows))
    good = True
    for label, columns in (("all", (0, 1, 2, 3, 4, 5, 6)), ("gyro", (0, 1, 2, 3)),
                           ("accel", (0, 4, 5, 6))):
        chosen = ",".join(names[c].split()[0] for c in columns)
        due = [(r[0], *(bits(r[c]) for c in columns[1:])) for r in rows]
        paths = {ending: FILES / f"written_{label}.{ending}" for ending in ("bag", "mcap", "db3")}
        for path in paths.values():
            run(IMUKIT, "convert", source, path, "--select", chosen)
        read = {
            "bag, rosbag": read_lines(run(PYTHON, HERE / "read_ros1.py", paths["bag"]),
                                      lambda v: bits(float.fromhex(v))),
            "mcap, @mcap/core by the index": read_lines(
                run("node", HERE / "read_mcap.cjs", paths["mcap"], env=NODE), str),
            "mcap, @mcap/core from the beginning": read_lines(
                run("node", HERE / "read_mcap.cjs", paths["mcap"], "--stream", env=NODE), str),
            "db3, sqlite3": read_db3(paths["db3"])}
        for name, got in read.items():
            good &= told(f"written with {label}: .{name}", got, due)
    return good


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20000
    FILES.mkdir(parents=True, exist_ok=True)
    if not (FILES / "node_modules/@mcap/core").exists():
        run("npm", "install", "--silent", "--prefix", FILES, *PACKAGES)
    good = check_reading(24)
    good &= check_reading(count)
    good &= check_writing(count)
    print("all equal" if good else "NOT ALL EQUAL")
    sys.exit(0 if good else 1)


main()
