#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes ROS 1 bags with rosbag, the reference program, and the samples that are in them.

    write_ros1.py DIRECTORY [SAMPLES]

The samples are those of samples.py. Each bag has a topic of another type, too."""
import struct
import sys

import genpy
import rosbag
from sensor_msgs.msg import Imu
from std_msgs.msg import String

import samples


def message(i, missing=None, stamped=True):
    imu = Imu()
    seconds, nanoseconds = divmod(samples.stamp(i), 10**9)
    if stamped:
        imu.header.stamp = genpy.Time(seconds, nanoseconds)
    imu.header.frame_id = "sensor"
    gyro, accel = samples.gyro(i), samples.accel(i)
    imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z = gyro
    imu.linear_acceleration.x, imu.linear_acceleration.y, imu.linear_acceleration.z = accel
    if missing == "gyro":
        imu.angular_velocity_covariance[0] = -1
    if missing == "accel":
        imu.linear_acceleration_covariance[0] = -1
    return imu


def write(path, count, compression="none", chunk=2000, **options):
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=chunk) as bag:
        for i in range(count):
            at = samples.stamp(i) + samples.DELAY
            received = genpy.Time(at // 10**9, at % 10**9)
            if i % 8 == 0:
                bag.write("/chatter", String(f"text {i}"), received)
            bag.write("/imu/data", message(i, **options), received)


def write_two(path):
    """Two sensors, of which one begins later."""
    with rosbag.Bag(path, "w", chunk_threshold=2000) as bag:
        for i in range(6):
            at = samples.stamp(i) + samples.DELAY
            for topic in ["/left/imu"] + (["/right/imu"] if i > 2 else []):
                bag.write(topic, message(i), genpy.Time(at // 10**9, at % 10**9))


def write_outside(path, source):
    """The records of the chunks of a bag as records of the file, without an index."""
    with open(source, "rb") as file:
        bag = file.read()
    head = 13 + 8 + 4096
    place = bag.index(b"index_pos=") + 10
    out, at = bag[:place] + bytes(8) + bag[place + 8:head], head
    while at < len(bag):
        size, = struct.unpack_from("<I", bag, at)
        header = bag[at + 4:at + 4 + size]
        length, = struct.unpack_from("<I", bag, at + 4 + size)
        at += 8 + size
        if b"op=\5" in header:
            out += bag[at:at + length]
        at += length
    with open(path, "wb") as file:
        file.write(out)


def main():
    directory = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 24
    chunk = 2000 if count < 1000 else 768 * 1024
    for compression in ("none", "bz2", "lz4"):
        write(f"{directory}/{compression}.bag", count, compression, chunk)
    for missing in ("gyro", "accel"):
        write(f"{directory}/no_{missing}.bag", 3, missing=missing)
    write(f"{directory}/unstamped.bag", 3, stamped=False)
    write_two(f"{directory}/two_topics.bag")
    write_outside(f"{directory}/outside.bag", f"{directory}/none.bag")


main()
