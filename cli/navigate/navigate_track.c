/* SPDX-License-Identifier: Apache-2.0 */
/* The track as a file. */
#include "navigate_parts.h"

#include <string.h>

static const struct {
    const char *name, *unit;
    int decimals;
} columns[TRACK_COLUMNS] = {{"time", "s", 3},
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

static bool is_written(const navigation *n, size_t column)
{
    if (column >= TRACK_SIGMA)
        return n->has_model;
    return column < TRACK_ACCELERATION || n->options->gravity_free;
}

int navigate_write_track(const navigation *n, const char *path)
{
    size_t count = 0;
    imk_log_column column[TRACK_COLUMNS];
    int decimals[TRACK_COLUMNS];
    const double *data[TRACK_COLUMNS];
    imk_log_writer *writer;
    imk_error error;
    memset(column, 0, sizeof column);
    for (size_t k = 0; k < TRACK_COLUMNS; k++) {
        if (!is_written(n, k))
            continue;
        snprintf(column[count].name, sizeof column[count].name, "%s", columns[k].name);
        column[count].unit = imk_unit_of(columns[k].unit);
        column[count].axis = -1;
        decimals[count] = columns[k].decimals;
        data[count++] = n->track[k];
    }
    if (imk_log_create(path, count, column, IMK_LOG_FIXED, decimals, n->track_rows, &writer,
                       &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_log_write(writer, n->track_rows, data, NULL);
    if (imk_log_commit(writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}
