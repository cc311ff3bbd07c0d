#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes bags of ROS 2 with SQLite's own library.

    write_rosbag2.py DIRECTORY [SAMPLES]

single.db3 as Foxy writes it, two/ a folder of two databases, packed/ the same compressed by file,
messages/ by message; parts/ of two MCAP files, made of DIRECTORY/cdr_none.mcap if that is there."""
import os
import shutil
import sqlite3
import struct
import subprocess
import sys

import samples

IMU = "sensor_msgs/msg/Imu"
TEXT = "std_msgs/msg/String"


def cdr(i):
    """Little-endian; the text "sensor" and its zero end at byte 19 behind the head."""
    seconds, nanoseconds = divmod(samples.stamp(i), 10**9)
    numbers = [0, 0, 0, 1] + [0] * 9 + samples.gyro(i) + [0] * 9 + samples.accel(i) + [0] * 9
    return (b"\0\1\0\0" + struct.pack("<iII7s5x", seconds, nanoseconds, 7, b"sensor")
            + struct.pack("<37d", *numbers))


def zstd(data):
    return subprocess.run(["zstd", "-q", "-c", "-"], input=data, stdout=subprocess.PIPE,
                          check=True).stdout


def write(path, first, last, pack=None):
    if os.path.exists(path):
        os.remove(path)
    base = sqlite3.connect(path)
    base.executescript("""
        PRAGMA page_size = 1024;
        CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
            serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
            timestamp INTEGER NOT NULL, data BLOB NOT NULL);
        CREATE INDEX timestamp_idx ON messages (timestamp ASC);""")
    base.execute("INSERT INTO topics VALUES(1, '/chatter', ?, 'cdr', '')", (TEXT,))
    base.execute("INSERT INTO topics VALUES(2, '/imu/data', ?, 'cdr', '')", (IMU,))
    for i in range(first, last):
        at = samples.stamp(i) + samples.DELAY
        rows = [(1, at, b"\0\1\0\0\2\0\0\0a\0")] if i % 8 == 0 else []
        for topic, when, data in rows + [(2, at, cdr(i))]:
            base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                         (topic, when, pack(data) if pack else data))
    base.commit()
    base.close()


def metadata(folder, files, count, storage="sqlite3", packing="", mode=""):
    listed = "".join(f"    - {name}\n" for name in files)
    duration = (count - 1) * samples.STEP
    start = samples.stamp(0) + samples.DELAY

    def topic(name, kind, messages):
        return (f"    - topic_metadata:\n        name: {name}\n        type: {kind}\n"
                "        serialization_format: cdr\n"
                '        offered_qos_profiles: "- history: 3\\n  depth: 0"\n'
                f"      message_count: {messages}\n")

    with open(f"{folder}/metadata.yaml", "w", encoding="utf-8") as out:
        out.write(f"""rosbag2_bagfile_information:
  version: 5
  storage_identifier: {storage}
  duration:
    nanoseconds: {duration}
  starting_time:
    nanoseconds_since_epoch: {start}
  message_count: {count + (count + 7) // 8}
  topics_with_message_count:
{topic('/chatter', TEXT, (count + 7) // 8)}{topic('/imu/data', IMU, count)}\
  compression_format: "{packing}"
  compression_mode: "{mode}"
  relative_file_paths:
{listed}""")


def folder(directory, name):
    path = f"{directory}/{name}"
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)
    return path


def main():
    directory = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 24
    half = count // 2
    write(f"{directory}/single.db3", 0, count)
    two = folder(directory, "two")
    write(f"{two}/two_0.db3", 0, half)
    write(f"{two}/two_1.db3", half, count)
    metadata(two, ["two_0.db3", "two_1.db3"], count)
    packed = folder(directory, "packed")
    for part in (0, 1):
        with open(f"{two}/two_{part}.db3", "rb") as plain, \
                open(f"{packed}/packed_{part}.db3.zstd", "wb") as out:
            out.write(zstd(plain.read()))
    metadata(packed, ["packed_0.db3.zstd", "packed_1.db3.zstd"], count, packing="zstd",
             mode="FILE")
    messages = folder(directory, "messages")
    write(f"{messages}/messages_0.db3", 0, min(count, 24), zstd)
    metadata(messages, ["messages_0.db3"], min(count, 24), packing="zstd", mode="MESSAGE")
    if os.path.exists(f"{directory}/cdr_none.mcap"):
        parts = folder(directory, "parts")
        for part, name in enumerate(("cdr_none", "cdr_zstd")):
            shutil.copy(f"{directory}/{name}.mcap", f"{parts}/parts_{part}.mcap")
        metadata(parts, ["parts_0.mcap", "parts_1.mcap"], 2 * count, "mcap")


main()
