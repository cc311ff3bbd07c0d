/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of MCAP files.
 * Reads: src/io/log/ros/log_mcap.c src/io/log/ros/log_mcap_read.c
 * src/io/log/ros/log_mcap_shape.c src/io/log/ros/log_mcap_summary.c
 * src/io/log/ros/log_ros_chunk.c src/io/log/ros/log_ros_search.c src/io/log/ros/log_ros_rows.c
 * src/io/log/ros/log_ros_topics.c src/io/log/ros/log_ros_records.c src/io/log/ros/log_ros_imu.c */
#define _POSIX_C_SOURCE 200809L
#include "bags.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bags_check(data, size, "mcap");
    bags_check_pipe(data, size, "mcap");
    return 0;
}
