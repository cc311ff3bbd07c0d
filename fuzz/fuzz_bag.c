/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of ROS 1 bags.
 * Reads: src/io/log/ros/log_bag.c src/io/log/ros/log_bag_index.c
 * src/io/log/ros/log_ros_chunk.c src/io/log/ros/log_ros_search.c src/io/log/ros/log_ros_rows.c
 * src/io/log/ros/log_ros_topics.c
 * src/io/log/ros/log_ros_records.c src/io/log/ros/log_ros_imu.c */
#define _POSIX_C_SOURCE 200809L
#include "bags.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bags_check(data, size, "bag");
    bags_check_pipe(data, size, "bag");
    return 0;
}
