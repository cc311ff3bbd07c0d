/* SPDX-License-Identifier: Apache-2.0 */
/* The topics of PX4 that hold inertial sensors, and what their fields are; PX4 defines them with
 * their units, in the folder `msg` of its source [ULOG]. The frame of all is forward, right, down.
 *
 * A field that a version of PX4 does not have yet, or no more, is looked for in vain; the types and
 * the places are those of the file. */
#include "ulog_internal.h"

#include <stdio.h>
#include <string.h>

/* A field that becomes a column. */
typedef struct row {
    const char *field, *column;
    const char *divisor; /* field; [us] */
    const char *mark;    /* field */
    enum { ANY, WHOLE, REAL } type;
    bool optional;
} row;

typedef struct definition {
    const char *name;
    const char *first[2]; /* fields of the stamp: taken unless it is missing or 0; else */
    bool arrays;          /* with the fields samples, dt [us] and scale */
    row rows[12];
} definition;

#define GYRO(x, y, z)                                                                              \
    {.field = x, .column = "gyro_x [rad/s]"}, {.field = y, .column = "gyro_y [rad/s]"},            \
    {                                                                                              \
        .field = z, .column = "gyro_z [rad/s]"                                                     \
    }
#define ACCEL(x, y, z)                                                                             \
    {.field = x, .column = "accel_x [m/s^2]"}, {.field = y, .column = "accel_y [m/s^2]"},          \
    {                                                                                              \
        .field = z, .column = "accel_z [m/s^2]"                                                    \
    }
#define TEMPERATURE                                                                                \
    {                                                                                              \
        .field = "temperature", .column = "temperature [degC]", .optional = true                   \
    }
#define SAMPLE                                                                                     \
    {                                                                                              \
        "timestamp_sample", "timestamp"                                                            \
    }
/* Where this field is the largest int32, the forces of the message are not valid. */
#define RELATIVE "accelerometer_timestamp_relative"
#define FORCE(i, name)                                                                             \
    {                                                                                              \
        .field = "accelerometer_m_s2[" #i "]", .column = name " [m/s^2]", .mark = RELATIVE         \
    }
/* In the versions before 1.9 it is a float, in seconds. */
#define DURATION(name)                                                                             \
    {.field = name, .column = name " [us]", .type = WHOLE, .optional = true},                      \
    {                                                                                              \
        .field = name, .column = name " [s]", .type = REAL, .optional = true                       \
    }
/* Increments over their own time are mean rates. */
#define MEAN(name, i, title)                                                                       \
    {                                                                                              \
        .field = name "[" #i "]", .column = title, .divisor = name "_dt"                           \
    }

static const definition topics[IMKI_ULOG_TOPICS] = {
    {"sensor_combined",
     {"timestamp", "timestamp"},
     false,
     {GYRO("gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"),
      FORCE(0, "accel_x"),
      FORCE(1, "accel_y"),
      FORCE(2, "accel_z"),
      {.field = RELATIVE, .column = RELATIVE " [us]", .optional = true},
      DURATION("gyro_integral_dt"),
      DURATION("accelerometer_integral_dt")}},
    {"sensor_gyro", SAMPLE, false, {GYRO("x", "y", "z"), TEMPERATURE}},
    {"sensor_accel", SAMPLE, false, {ACCEL("x", "y", "z"), TEMPERATURE}},
    {"sensor_gyro_fifo", SAMPLE, true, {GYRO("x", "y", "z")}},
    {"sensor_accel_fifo", SAMPLE, true, {ACCEL("x", "y", "z")}},
    {"vehicle_imu",
     SAMPLE,
     false,
     {MEAN("delta_angle", 0, "gyro_x [rad/s]"), MEAN("delta_angle", 1, "gyro_y [rad/s]"),
      MEAN("delta_angle", 2, "gyro_z [rad/s]"), MEAN("delta_velocity", 0, "accel_x [m/s^2]"),
      MEAN("delta_velocity", 1, "accel_y [m/s^2]"), MEAN("delta_velocity", 2, "accel_z [m/s^2]")}},
    {"vehicle_angular_velocity", SAMPLE, false, {GYRO("xyz[0]", "xyz[1]", "xyz[2]")}},
    {"vehicle_acceleration", SAMPLE, false, {ACCEL("xyz[0]", "xyz[1]", "xyz[2]")}},
    {"sensor_mag", SAMPLE, false, {{.field = NULL}}}, /* no inertial sensor: only listed */
};

int imki_ulog_topic(const char *name, size_t size)
{
    for (int i = 0; i < IMKI_ULOG_TOPICS; i++)
        if (strlen(topics[i].name) == size && memcmp(topics[i].name, name, size) == 0)
            return i;
    return -1;
}

static bool fits(imki_flight_type type, const row *due)
{
    const bool real = type == IMKI_FLIGHT_FLOAT || type == IMKI_FLIGHT_DOUBLE;
    return type != IMKI_FLIGHT_NONE && (due->type == ANY || real == (due->type == REAL));
}

void imki_ulog_plan(imki_ulog_formats *formats, imki_ulog_format *format, int topic,
                    imki_flight_plan *plan)
{
    *plan = (imki_flight_plan){.stamp_unit = 1};
    plan->stamp = imki_ulog_field(formats, format, topics[topic].first[0]);
    plan->stamp_else = imki_ulog_field(formats, format, topics[topic].first[1]);
    plan->usable = topics[topic].rows[0].field && plan->stamp_else.type == IMKI_FLIGHT_UINT64;
    for (const row *r = topics[topic].rows; r->field; r++) {
        imki_flight_cell *cell = &plan->cell[plan->cell_count];
        *cell = (imki_flight_cell){.optional = r->optional, .factor = 1};
        cell->value = imki_ulog_field(formats, format, r->field);
        if (r->optional && !fits(cell->value.type, r))
            continue;
        plan->usable &= fits(cell->value.type, r);
        snprintf(cell->column, sizeof cell->column, "%s", r->column);
        if (r->divisor) {
            cell->divisor = imki_ulog_field(formats, format, r->divisor);
            cell->factor = 1e6; /* exact: 24 bits times 20 */
            plan->usable &= cell->divisor.type != IMKI_FLIGHT_NONE;
        }
        if (r->mark) {
            cell->mark = imki_ulog_field(formats, format, r->mark);
            cell->marked = cell->mark.type == IMKI_FLIGHT_INT32;
        }
        plan->cell_count++;
    }
    if (topics[topic].arrays) {
        plan->samples = imki_ulog_field(formats, format, "samples");
        plan->interval = imki_ulog_field(formats, format, "dt");
        plan->scale = imki_ulog_field(formats, format, "scale");
        plan->usable &= plan->samples.type == IMKI_FLIGHT_UINT8 &&
                        plan->interval.type != IMKI_FLIGHT_NONE &&
                        plan->scale.type != IMKI_FLIGHT_NONE;
        for (size_t i = 1; i < plan->cell_count; i++)
            plan->usable &= plan->cell[i].value.count == plan->cell[0].value.count &&
                            plan->cell[i].value.type == plan->cell[0].value.type;
    }
}
