/* SPDX-License-Identifier: Apache-2.0 */
/* The track as a record. */
#include "imukit/navigate_log.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *unit;
    int decimals;
} columns[IMK_TRACK_COLUMNS] = {{"time", "s", 3},
                                {"latitude", "deg", 9},
                                {"longitude", "deg", 9},
                                {"height", "m", 4},
                                {"north", "m", 4},
                                {"east", "m", 4},
                                {"down", "m", 4},
                                {"velocity_north", "m/s", 6},
                                {"velocity_east", "m/s", 6},
                                {"velocity_down", "m/s", 6},
                                {"roll", "deg", 6},
                                {"pitch", "deg", 6},
                                {"yaw", "deg", 6},
                                {"acceleration_north", "m/s^2", 6},
                                {"acceleration_east", "m/s^2", 6},
                                {"acceleration_down", "m/s^2", 6},
                                {"sigma_north", "m", 4},
                                {"sigma_east", "m", 4},
                                {"sigma_down", "m", 4},
                                {"sigma_velocity_north", "m/s", 6},
                                {"sigma_velocity_east", "m/s", 6},
                                {"sigma_velocity_down", "m/s", 6},
                                {"sigma_attitude_north", "deg", 6},
                                {"sigma_attitude_east", "deg", 6},
                                {"sigma_attitude_down", "deg", 6}};

static bool is_written(const imk_navigate_log *n, size_t column)
{
    if (column >= IMK_TRACK_SIGMA)
        return n->settings.model != NULL;
    return column < IMK_TRACK_ACCELERATION || n->settings.gravity_free;
}

imk_status imk_navigate_log_track(const imk_navigate_log *log, const imk_record_sink *sink,
                                  imk_error *error)
{
    size_t count = 0;
    imk_log_column column[IMK_TRACK_COLUMNS];
    int decimals[IMK_TRACK_COLUMNS];
    const double *data[IMK_TRACK_COLUMNS];
    memset(column, 0, sizeof column);
    for (size_t k = 0; k < IMK_TRACK_COLUMNS; k++) {
        if (!is_written(log, k))
            continue;
        snprintf(column[count].name, sizeof column[count].name, "%s", columns[k].name);
        column[count].unit = imk_unit_of(columns[k].unit);
        column[count].axis = -1;
        decimals[count] = columns[k].decimals;
        data[count++] = log->track[k];
    }
    const imk_status status =
        sink->begin(sink->context, count, column, decimals, log->track_rows, error);
    return status == IMK_OK ? sink->write(sink->context, log->track_rows, data, NULL, error)
                            : status;
}
