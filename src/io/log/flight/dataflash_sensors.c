/* SPDX-License-Identifier: Apache-2.0 */
/* The messages of ArduPilot that hold inertial sensors. Their fields, and the units that hold where
 * the log does not say them, are those of its source [DATAFLASH]. The frame of all is forward,
 * right, down. */
#include "dataflash_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { GYRO = 1, ACCEL = 2, TEMPERATURE = 4, BATCHES = 8, OTHERS = 0 };

/* Until 2021 each instance had a name of its own. */
static const struct {
    const char *name;
    int holds;
} sensors[IMKI_DATAFLASH_SENSORS] = {{"IMU", GYRO | ACCEL | TEMPERATURE},
                                     {"IMU2", GYRO | ACCEL | TEMPERATURE},
                                     {"IMU3", GYRO | ACCEL | TEMPERATURE},
                                     {"GYR", GYRO},
                                     {"GYR1", GYRO},
                                     {"GYR2", GYRO},
                                     {"GYR3", GYRO},
                                     {"ACC", ACCEL},
                                     {"ACC1", ACCEL},
                                     {"ACC2", ACCEL},
                                     {"ACC3", ACCEL},
                                     {"ISBD/gyro", GYRO | BATCHES},
                                     {"ISBD/accel", ACCEL | BATCHES},
                                     {"IMT", OTHERS},
                                     {"IMT2", OTHERS},
                                     {"IMT3", OTHERS},
                                     {"RISI", OTHERS},
                                     {"MAG", OTHERS},
                                     {"MAG2", OTHERS},
                                     {"MAG3", OTHERS}};

int imki_dataflash_sensor(const char *name)
{
    for (int i = 0; i < IMKI_DATAFLASH_SENSORS; i++)
        if (strcmp(sensors[i].name, name) == 0)
            return i;
    return -1;
}

const char *imki_dataflash_sensor_name(int sensor)
{
    return sensors[sensor].name;
}

int imki_dataflash_batches(bool gyro)
{
    return imki_dataflash_sensor(gyro ? "ISBD/gyro" : "ISBD/accel");
}

/* The unit by the log, or that of ArduPilot: a log without FMTU says none, and "?" and "-" say that
 * there is none or that nobody has looked. */
static const char *unit_of(const imki_dataflash *flash, char letter, const char *due)
{
    const char *unit = flash->unit[(unsigned char)letter];
    if (letter == '\0' || letter == '?' || letter == '-' || !unit[0])
        return due;
    return strcmp(unit, "m/s/s") == 0 ? "m/s^2" : unit;
}

/* Factor of the raw number: what FMTU says; without it that of the types with a factor. */
static double factor_of(const imki_dataflash *flash, char letter, char type)
{
    const double multiplier = flash->multiplier[(unsigned char)letter];
    if (letter != '\0' && letter != '?' && letter != '-' && isfinite(multiplier) && multiplier != 0)
        return multiplier;
    return strchr("cCeE", type) ? 0.01 : type == 'L' ? 1e-7 : 1;
}

/* @return whether the field is there */
static bool add_cell(const imki_dataflash *flash, const imki_dataflash_format *format,
                     const char *label, const char *column, const char *unit, bool batches,
                     imki_flight_plan *plan)
{
    size_t index;
    imki_flight_cell *cell = &plan->cell[plan->cell_count];
    const imki_flight_field field = imki_dataflash_field(format, label, &index);
    if (field.type == IMKI_FLIGHT_NONE || (field.count > 1) != batches)
        return false;
    *cell = (imki_flight_cell){.value = field, .factor = 1};
    if (!batches) { /* their FMTU has the unit of accelerations for gyros, too */
        unit = unit_of(flash, format->units[index], unit);
        cell->factor = factor_of(flash, format->multipliers[index], format->types[index]);
    }
    snprintf(cell->column, sizeof cell->column, "%s [%s]", column, unit);
    plan->cell_count++;
    return true;
}

/* Samples have times of their own, which are 0 in some versions. */
static void find_stamps(const imki_dataflash_format *format, imki_flight_plan *plan)
{
    plan->stamp_else = imki_dataflash_field(format, "TimeUS", NULL);
    plan->stamp = imki_dataflash_field(format, "SampleUS", NULL);
    plan->stamp_unit = 1;
    if (plan->stamp_else.type == IMKI_FLIGHT_NONE) { /* logs before 2015 */
        plan->stamp_else = imki_dataflash_field(format, "TimeMS", NULL);
        plan->stamp = plan->stamp_else;
        plan->stamp_unit = 1000;
    }
    plan->usable = imki_flight_size(plan->stamp_else.type) >= 4 &&
                   plan->stamp_else.type != IMKI_FLIGHT_FLOAT &&
                   plan->stamp_else.type != IMKI_FLIGHT_DOUBLE;
}

void imki_dataflash_plan(const imki_dataflash *flash, const imki_dataflash_format *format,
                         int sensor, imki_flight_plan *plan)
{
    static const char *const names[2][3] = {{"GyrX", "GyrY", "GyrZ"}, {"AccX", "AccY", "AccZ"}};
    static const char *const arrays[3] = {"x", "y", "z"};
    static const char *const columns[2][3] = {{"gyro_x", "gyro_y", "gyro_z"},
                                              {"accel_x", "accel_y", "accel_z"}};
    static const char *const units[2] = {"rad/s", "m/s^2"};
    const int holds = sensors[sensor].holds;
    const bool batches = (holds & BATCHES) != 0;
    *plan = (imki_flight_plan){.usable = false};
    find_stamps(format, plan);
    for (int kind = 0; kind < 2; kind++)
        for (int axis = 0; axis < 3 && (holds & (kind == 0 ? GYRO : ACCEL)) != 0; axis++)
            plan->usable &= add_cell(flash, format, batches ? arrays[axis] : names[kind][axis],
                                     columns[kind][axis], units[kind], batches, plan);
    plan->usable &= plan->cell_count > 0;
    if ((holds & TEMPERATURE) != 0 &&
        (add_cell(flash, format, "T", "temperature", "degC", false, plan) ||
         add_cell(flash, format, "Temp", "temperature", "degC", false, plan)))
        plan->cell[plan->cell_count - 1].optional = true;
}

/* Until a new format has an FMTU of its own, the units of a field are those that it had. */
static void keep_units(const imki_dataflash_format *before, imki_dataflash_format *format)
{
    const char *label = format->labels;
    for (size_t i = 0; format->types[i]; i++) {
        const size_t size = strcspn(label, ",");
        char name[sizeof format->labels];
        size_t index;
        snprintf(name, sizeof name, "%.*s", (int)size, label);
        label += size + (label[size] == ',');
        format->units[i] = format->multipliers[i] = '?';
        if (imki_dataflash_field(before, name, &index).type == IMKI_FLIGHT_NONE)
            continue;
        format->units[i] = before->units[index] ? before->units[index] : '?';
        format->multipliers[i] = before->multipliers[index] ? before->multipliers[index] : '?';
    }
}

bool imki_dataflash_follow(imki_dataflash *flash, int sensor, int number)
{
    imki_dataflash_format format = flash->format[number], *basis = &flash->basis[sensor];
    if (basis->length == 0)
        *basis = format;
    else if (basis->number == number && basis->place == format.place)
        format = *basis;
    else if (!format.units[0])
        keep_units(basis, &format);
    imki_dataflash_plan(flash, &format, sensor, &flash->plan[sensor]);
    flash->planned[sensor] = number + 1;
    return imki_flight_follow(&flash->log, &flash->plan[sensor]);
}
