/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of DataFlash, the logs of ArduPilot.
 * Reads: src/io/log/flight/log_dataflash.c src/io/log/flight/dataflash_messages.c
 * src/io/log/flight/dataflash_formats.c src/io/log/flight/dataflash_sensors.c
 * src/io/log/flight/flight_log.c src/io/log/flight/flight_rows.c */
#include "flight_checks.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const topics[] = {"IMU", "GYR", "ACC", "ISBD/gyro", "ISBD/accel", NULL};
    check_flight_log(data, size, "dataflash", sizeof topics / sizeof topics[0], topics);
    return 0;
}
