/* SPDX-License-Identifier: Apache-2.0 */
/* ArduPilot: calibration parameters of one IMU, as the ground stations write them (NAME,VALUE) or
 * as lines `NAME VALUE`, `NAME=VALUE`.
 *
 *     corrected = (reading - p(T) + p(T_cal) - offset) scale,   a gyro without scale,
 *     p(T) = 1e-6 (c1 d + c2 d^2 + c3 d^3),   d = T - 35 degC,
 *
 * T and T_cal, the temperature at which offset and scale were found, clipped to TMIN … TMAX. So
 * forward bias = offset + p(T) - p(T_cal), and scale factor = 1/scale - 1. Units are rad/s, m/s^2
 * and degC. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { IMUS = 3, ORDER = 3 };

static const double kelvin = 273.15, thermal_reference = 35, thermal_unit = 1e-6;

/* AP_InertialSensor: a temperature of calibration that was never set. */
static const double no_temperature = -300;

typedef struct ardupilot_sensor {
    bool there; /* offset or scale */
    double offset[3], scale[3], coefficient[ORDER][3], temperature;
    size_t line; /* of the last parameter */
} ardupilot_sensor;

typedef struct ardupilot_imu {
    ardupilot_sensor sensor[2];
    double enable, minimum, maximum; /* of the thermal correction; NaN: not given */
    bool any;
} ardupilot_imu;

static const char axis_letters[] = "XYZ";

/* ---- names ----------------------------------------------------------------------------------- */

/* "INS_ACCOFFS_", "INS_ACC2OFFS_": the number of the first IMU is left out. */
static void offset_name(char *name, size_t size, int kind, int imu, const char *what, int axis)
{
    char number[12] = "";
    if (imu > 0)
        snprintf(number, sizeof number, "%d", imu + 1);
    /* "GYROFFS" of the first, "GYR2OFFS" of others */
    snprintf(name, size, "INS_%s%s%s_%c", kind == IMK_GYRO ? "GYR" : "ACC", number, what,
             axis_letters[axis]);
}

static void thermal_name(char *name, size_t size, int kind, int imu, int order, int axis)
{
    snprintf(name, size, "INS_TCAL%d_%s%d_%c", imu + 1, kind == IMK_GYRO ? "GYR" : "ACC", order,
             axis_letters[axis]);
}

static void temperature_name(char *name, size_t size, int kind, int imu)
{
    snprintf(name, size, "INS_%s%d_CALTEMP", kind == IMK_GYRO ? "GYR" : "ACC", imu + 1);
}

/* Axis of a name that is the pattern but for its last letter, X, Y or Z; -1 for others. */
static int axis_of(const char *name, const char *pattern)
{
    const size_t length = strlen(pattern) - 1;
    for (int axis = 0; axis < 3; axis++)
        if (strncmp(name, pattern, length) == 0 && name[length] == axis_letters[axis] &&
            name[length + 1] == '\0')
            return axis;
    return -1;
}

static bool find_target(ardupilot_sensor *s, const char *name, int kind, int imu, double **target)
{
    char pattern[32];
    int offset, scale = -1;
    offset_name(pattern, sizeof pattern, kind, imu, "OFFS", 0);
    offset = axis_of(name, pattern);
    if (kind == IMK_ACCEL) {
        offset_name(pattern, sizeof pattern, kind, imu, "SCAL", 0);
        scale = axis_of(name, pattern);
    }
    if (offset >= 0 || scale >= 0) {
        s->there = true;
        *target = offset >= 0 ? &s->offset[offset] : &s->scale[scale];
        return true;
    }
    for (int k = 0; k < ORDER; k++) {
        thermal_name(pattern, sizeof pattern, kind, imu, k + 1, 0);
        const int axis = axis_of(name, pattern);
        if (axis >= 0) {
            *target = &s->coefficient[k][axis];
            return true;
        }
    }
    temperature_name(pattern, sizeof pattern, kind, imu);
    *target = &s->temperature;
    return strcmp(name, pattern) == 0;
}

/* Where the value of a parameter goes; NULL when it is none of ours. */
static double *target_of(void *context, const char *name, size_t line)
{
    ardupilot_imu *imus = context;
    for (int imu = 0; imu < IMUS; imu++) {
        static const char *const names[3] = {"ENABLE", "TMIN", "TMAX"};
        ardupilot_imu *m = &imus[imu];
        double *const targets[3] = {&m->enable, &m->minimum, &m->maximum};
        for (int kind = 0; kind < 2; kind++) {
            double *target;
            if (find_target(&m->sensor[kind], name, kind, imu, &target)) {
                m->sensor[kind].line = line;
                m->any = true;
                return target;
            }
        }
        for (int i = 0; i < 3; i++) {
            char full[32];
            snprintf(full, sizeof full, "INS_TCAL%d_%s", imu + 1, names[i]);
            if (strcmp(name, full) == 0)
                return targets[i];
        }
    }
    return NULL;
}

/* ---- reading --------------------------------------------------------------------------------- */

static void read_file(imki_parameters *p, ardupilot_imu imus[IMUS])
{
    for (int imu = 0; imu < IMUS; imu++) {
        imus[imu] = (ardupilot_imu){.enable = (double)NAN, .minimum = 0, .maximum = 70};
        for (int kind = 0; kind < 2; kind++)
            imus[imu].sensor[kind] =
                (ardupilot_sensor){.scale = {1, 1, 1}, .temperature = no_temperature};
    }
    imki_read_assignments(
        p, &(imki_assignments){.separators = " \t,=\r", .target_of = target_of, .context = imus});
}

static bool has_numbers(const ardupilot_imu *imu)
{
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < 3; i++) {
            const ardupilot_sensor *s = &imu->sensor[kind];
            if (s->offset[i] != 0 || s->scale[i] != 1)
                return true;
            for (int k = 0; k < ORDER; k++)
                if (s->coefficient[k][i] != 0)
                    return true;
        }
    return false;
}

/* A file from a vehicle lists all IMUs, those it has not with the default values. */
static int choose(imki_parameters *p, const ardupilot_imu imus[IMUS])
{
    imki_choice choice = {.found = 0};
    for (int i = 0; i < IMUS; i++)
        if (imus[i].any && (i == 0 || has_numbers(&imus[i])))
            imki_choice_add(p, &choice, (char[2]){(char)('1' + i), '\0'}, i);
    if (choice.count == 0)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "INS_ACCOFFS_X", "INS_ACCOFFS_X",
                              "a file with calibration parameters INS_ACC…, INS_GYR… or INS_TCAL…");
    imki_choice_end(p, choice.found, choice.names, "NUMBER", "the file has several IMUs");
    return choice.chosen;
}

/* p(T) - p(T_cal), as a polynomial about T_cal. */
static void fill_thermal(imki_parameters *p, const ardupilot_imu *imu, const ardupilot_sensor *s,
                         int number, imk_triad *triad)
{
    imk_temperature_polynomial *t = &triad->bias.temperature;
    int order = 0;
    for (int k = 0; k < ORDER; k++)
        for (int i = 0; i < 3; i++)
            if (s->coefficient[k][i] != 0)
                order = k + 1;
    if (order == 0)
        return;
    if (imu->enable == 0 || imu->enable == 2) {
        imki_note(p, true,
                  "INS_TCAL%d_ENABLE is %g: ArduPilot does not use INS_TCAL%d_…, which "
                  "are left out",
                  number, imu->enable, number);
        return;
    }
    if (isnan(imu->enable))
        imki_note(p, false,
                  "INS_TCAL%d_ENABLE is not in the file: INS_TCAL%d_… are taken to be in "
                  "use",
                  number, number);
    if (!(imu->minimum < imu->maximum && imu->minimum >= -kelvin))
        imki_parameter_refuse_at(p, (imki_place){"TMIN", s->line, 0}, IMK_ERROR_RANGE,
                                 "TMIN and TMAX",
                                 "a TMIN above absolute zero and below TMAX [degC]");
    const double calibrated = fmin(fmax(s->temperature, imu->minimum), imu->maximum);
    imk_temperature_polynomial about = {.order = order, .reference = thermal_reference + kelvin};
    for (int k = 0; k < order; k++)
        for (int i = 0; i < 3; i++)
            about.coefficient[k].value[i] = thermal_unit * s->coefficient[k][i];
    for (int i = 0; i < 3; i++) {
        double c[4];
        (void)imki_cubic(&about, i, calibrated + kelvin, c);
        for (int k = 0; k < order; k++)
            t->coefficient[k].value[i] = c[k + 1];
    }
    t->order = order;
    t->reference = calibrated + kelvin;
    t->minimum = imu->minimum + kelvin;
    t->maximum = imu->maximum + kelvin;
}

static void fill(imki_parameters *p, const ardupilot_imu *imu, int number, int kind)
{
    const ardupilot_sensor *s = &imu->sensor[kind];
    imk_triad *triad = p->triad[kind];
    triad->present = s->line > 0;
    if (!triad->present)
        return;
    fill_thermal(p, imu, s, number, triad);
    imki_accept(p, (imki_place){"OFFS", s->line, 0}, kind, IMKI_BIAS, s->offset,
                (imki_unit){imki_kind_units[kind], 1}, triad->bias.fixed.value);
    for (int i = 0; i < 3; i++) {
        /* ArduPilot's own limits are 0.8 and 1.2, which files of raw sensors may pass. */
        if (!(s->scale[i] >= 0.1 && s->scale[i] <= 10))
            imki_parameter_refuse_at(p, (imki_place){"SCAL", s->line, 0}, IMK_ERROR_RANGE, "",
                                     "a scale between 0.8 and 1.2");
        triad->scale_factor.fixed.value[i] = s->scale[i] == 1 ? 0 : 1 / s->scale[i] - 1;
    }
}

void imki_ardupilot_read(imki_parameters *p)
{
    ardupilot_imu imus[IMUS];
    read_file(p, imus);
    const int chosen = choose(p, imus);
    for (int kind = 0; kind < 2; kind++)
        fill(p, &imus[chosen], chosen + 1, kind);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_parameter(imki_parameters *p, const char *name, double value)
{
    imki_text_add(&p->out, "%s,%s\n", name, imki_shortest(value).text);
}

/* Of the polynomial about its reference; the constant is what p(T_cal) changes of the offset. */
static void write_sensor(imki_parameters *p, int kind, const imk_triad *triad, double cubic[3][4],
                         double calibrated)
{
    const imk_temperature_polynomial *t = &triad->bias.temperature;
    char name[32];
    for (int i = 0; i < 3; i++) {
        double offset = triad->bias.fixed.value[i];
        if (t->order > 0) {
            double there[4];
            (void)imki_cubic(t, i, calibrated + kelvin, there);
            offset += there[0];
        }
        offset_name(name, sizeof name, kind, 0, "OFFS", i);
        write_parameter(p, name, offset);
    }
    for (int i = 0; i < 3 && kind == IMK_ACCEL; i++) {
        const double s = triad->scale_factor.fixed.value[i];
        offset_name(name, sizeof name, kind, 0, "SCAL", i);
        write_parameter(p, name, s == 0 ? 1 : 1 / (1 + s));
        if (!(1 / (1 + s) >= 0.8 && 1 / (1 + s) <= 1.2))
            imki_note(p, false, "%s is outside 0.8 to 1.2, the range of ArduPilot's documentation",
                      name);
    }
    if (t->order == 0)
        return;
    temperature_name(name, sizeof name, kind, 0);
    write_parameter(p, name, calibrated);
    for (int k = 0; k < ORDER; k++)
        for (int i = 0; i < 3; i++) {
            thermal_name(name, sizeof name, kind, 0, k + 1, i);
            write_parameter(p, name, cubic[i][k + 1] / thermal_unit);
        }
}

static void write_thermal(imki_parameters *p, double minimum, double maximum)
{
    const bool any = minimum < maximum;
    write_parameter(p, "INS_TCAL1_ENABLE", any);
    if (!any)
        return;
    write_parameter(p, "INS_TCAL1_TMIN", minimum);
    write_parameter(p, "INS_TCAL1_TMAX", maximum);
    for (int kind = 0; kind < 2; kind++)
        if (!p->origin[kind]->present || p->origin[kind]->bias.temperature.order == 0)
            imki_note(p, false, "INS_TCAL1_%s1_X … are not written: they must be 0, their default",
                      kind == IMK_GYRO ? "GYR" : "ACC");
}

void imki_ardupilot_write(imki_parameters *p)
{
    double minimum = -HUGE_VAL, maximum = HUGE_VAL;
    bool any = false;
    /* Both sensors share the range: where they differ it is what they have in common. */
    for (int kind = 0; kind < 2; kind++) {
        const imk_temperature_polynomial *t = &p->origin[kind]->bias.temperature;
        if (!p->origin[kind]->present || t->order == 0)
            continue;
        minimum = fmax(minimum, t->minimum - kelvin);
        maximum = fmin(maximum, t->maximum - kelvin);
        any = true;
    }
    if (any && !(minimum < maximum))
        imki_parameter_refuse(p, IMK_ERROR_UNSUPPORTED, "gyro.bias.temperature",
                              "the temperature ranges of gyros and accelerometers do not overlap; "
                              "ArduPilot has one range",
                              "remove one of the two polynomials");
    imki_text_add(
        &p->out, "# ArduPilot calibration of IMU 1: offsets [rad/s], [m/s^2], scale [1]; corrected "
                 "= (reading - thermal\n# - offset) scale; temperatures [degC], INS_TCAL1_…k [1e-6 "
                 "of the offset's unit/degC^k], from 35 degC\n");
    for (int kind = 0; kind < 2; kind++) {
        const imk_temperature_polynomial *t = &p->origin[kind]->bias.temperature;
        const double calibrated = fmin(fmax(t->reference - kelvin, minimum), maximum);
        double cubic[3][4] = {{0}}, worst = 0;
        if (!p->origin[kind]->present)
            continue;
        for (int i = 0; i < 3 && t->order > 0; i++)
            worst = fmax(worst, imki_cubic(t, i, thermal_reference + kelvin, cubic[i]));
        if (worst > 0)
            imki_note(p, true,
                      "%s.bias.temperature: ArduPilot has cubic polynomials; the nearest one "
                      "differs by up to %.2g %s",
                      imki_kind_names[kind], worst, imki_kind_units[kind]);
        write_sensor(p, kind, p->origin[kind], cubic, calibrated);
    }
    write_thermal(p, any ? minimum : 0, any ? maximum : 0);
    if (p->origin[IMK_GYRO]->present)
        imki_note(p, false,
                  "INS_GYROFFS_X …: ArduPilot measures them anew at each start, unless INS_GYR_CAL "
                  "is 0");
}
