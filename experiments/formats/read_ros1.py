#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the messages of /imu in a ROS 1 bag, as rosbag reads them: time, rates, forces."""
import sys

import rosbag

with rosbag.Bag(sys.argv[1]) as bag:
    print(f"# {bag.get_message_count()} messages", file=sys.stderr)
    for _, message, received in bag.read_messages("/imu"):
        stamp = message.header.stamp.to_nsec()
        assert received.to_nsec() == stamp
        assert message.orientation_covariance[0] == -1
        rate, force = message.angular_velocity, message.linear_acceleration
        values = []
        if message.angular_velocity_covariance[0] != -1:
            values += [rate.x, rate.y, rate.z]
        if message.linear_acceleration_covariance[0] != -1:
            values += [force.x, force.y, force.z]
        print(stamp, *(value.hex() for value in values))
