/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of ULog, the logs of PX4.
 * Reads: src/io/log/flight/log_ulog.c src/io/log/flight/ulog_messages.c
 * src/io/log/flight/ulog_formats.c src/io/log/flight/ulog_topics.c src/io/log/flight/flight_log.c
 * src/io/log/flight/flight_rows.c */
#include "flight_checks.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const topics[] = {"sensor_combined",   "sensor_gyro", "sensor_accel",
                                         "sensor_gyro_fifo",  "vehicle_imu", NULL,
                                         "sensor_accel_fifo", "acceleration"};
    check_flight_log(data, size, "ulog", sizeof topics / sizeof topics[0], topics);
    return 0;
}
