/* SPDX-License-Identifier: Apache-2.0 */
/* PX4: calibration parameters of one IMU, as QGroundControl writes them (vehicle, component, name,
 * value, type, separated by tabs) or as lines `NAME VALUE`.
 *
 *     corrected = (reading - thermal offset - CAL_…_XOFF) CAL_…_XSCALE     (sensor_calibration)
 *     thermal offset = X0 + X1 d + X2 d^2 + X3 d^3,   d = T - TREF, T clipped to TMIN … TMAX
 *
 * so that forward bias = XOFF + X0 and scale factor = 1/XSCALE - 1. Units are rad/s, m/s^2 and
 * degC. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SENSORS_MAX = 4, ORDER = 3 };

/* What a file says about one gyro or accelerometer. */
typedef struct px4_sensor {
    bool calibrated, thermal; /* some parameter is there */
    double id, thermal_id;    /* of the device; 0: none, NaN: not given */
    double offset[3], scale[3], coefficient[ORDER + 1][3];
    double reference, minimum, maximum; /* [degC] */
    double rotation;
    size_t line; /* of the last parameter */
} px4_sensor;

typedef struct px4_file {
    px4_sensor sensor[2][SENSORS_MAX];
    double enable[2]; /* of thermal compensation; NaN: not given */
} px4_file;

static const double kelvin = 273.15;
static const char *const calibration_names[2] = {"GYRO", "ACC"};
static const char thermal_letters[2] = {'G', 'A'};

/* ---- reading --------------------------------------------------------------------------------- */

static double *calibration_value(px4_sensor *s, const char *name)
{
    static const char axes[] = "XYZ";
    const char *axis = strchr(axes, name[0]);
    if (strcmp(name, "ID") == 0)
        return &s->id;
    if (strcmp(name, "ROT") == 0)
        return &s->rotation;
    if (axis && *axis && strcmp(name + 1, "OFF") == 0)
        return &s->offset[axis - axes];
    if (axis && *axis && strcmp(name + 1, "SCALE") == 0)
        return &s->scale[axis - axes];
    return NULL;
}

static double *thermal_value(px4_sensor *s, const char *name)
{
    if (strcmp(name, "ID") == 0)
        return &s->thermal_id;
    if (strcmp(name, "TREF") == 0)
        return &s->reference;
    if (strcmp(name, "TMIN") == 0)
        return &s->minimum;
    if (strcmp(name, "TMAX") == 0)
        return &s->maximum;
    if (name[0] == 'X' && name[1] >= '0' && name[1] <= '3' && name[2] == '_' && name[3] >= '0' &&
        name[3] <= '2' && name[4] == '\0')
        return &s->coefficient[name[1] - '0'][name[3] - '0'];
    return NULL;
}

/* Where the value of a parameter goes; NULL when it is none of ours. */
static double *target_of(void *context, const char *name, size_t line)
{
    px4_file *file = context;
    for (int kind = 0; kind < 2; kind++) {
        char prefix[16];
        int length = snprintf(prefix, sizeof prefix, "CAL_%s", calibration_names[kind]);
        px4_sensor *sensors = file->sensor[kind];
        if (strncmp(name, prefix, (size_t)length) == 0 && name[length] >= '0' &&
            name[length] < '0' + SENSORS_MAX && name[length + 1] == '_') {
            px4_sensor *s = &sensors[name[length] - '0'];
            double *value = calibration_value(s, name + length + 2);
            s->calibrated = s->calibrated || value;
            s->line = value ? line : s->line;
            return value;
        }
        if (strncmp(name, "TC_", 3) != 0 || name[3] != thermal_letters[kind])
            continue;
        if (strcmp(name + 4, "_ENABLE") == 0)
            return &file->enable[kind];
        if (name[4] >= '0' && name[4] < '0' + SENSORS_MAX && name[5] == '_') {
            px4_sensor *s = &sensors[name[4] - '0'];
            double *value = thermal_value(s, name + 6);
            s->thermal = s->thermal || value;
            s->line = value ? line : s->line;
            return value;
        }
    }
    return NULL;
}

static void read_file(imki_parameters *p, px4_file *file)
{
    file->enable[0] = file->enable[1] = NAN;
    for (int i = 0; i < 2 * SENSORS_MAX; i++) {
        px4_sensor *s = &file->sensor[i / SENSORS_MAX][i % SENSORS_MAX];
        *s = (px4_sensor){.scale = {1, 1, 1}, .reference = 25, .maximum = 100, .rotation = -1};
        s->id = s->thermal_id = NAN;
    }
    imki_read_assignments(p, &(imki_assignments){.separators = " \t,\r",
                                                 .numbers = 2, /* vehicle and component */
                                                 .target_of = target_of,
                                                 .context = file});
}

static bool has_numbers(const px4_sensor *s)
{
    for (int i = 0; i < 3; i++) {
        if (s->offset[i] != 0 || s->scale[i] != 1)
            return true;
        for (int k = 0; k <= ORDER; k++)
            if (s->coefficient[k][i] != 0)
                return true;
    }
    return false;
}

/* The slots that are in use: those of CAL_… parameters, of TC_… only where there are none, since
 * the two are numbered apart. A slot of no device (ID 0) is not in use, unless it holds numbers all
 * the same. */
static bool in_use(const px4_file *file, int kind, int slot)
{
    bool any = false;
    for (int i = 0; i < 2 * SENSORS_MAX; i++)
        any = any || file->sensor[i / SENSORS_MAX][i % SENSORS_MAX].calibrated;
    const px4_sensor *s = &file->sensor[kind][slot];
    double id = any ? s->id : s->thermal_id;
    return (any ? s->calibrated : s->thermal) && (id != 0 || has_numbers(s));
}

static int choose(imki_parameters *p, const px4_file *file)
{
    imki_choice choice = {.found = 0};
    for (int i = 0; i < SENSORS_MAX; i++)
        if (in_use(file, 0, i) || in_use(file, 1, i))
            imki_choice_add(p, &choice, (char[2]){(char)('0' + i), '\0'}, i);
    if (choice.count == 0)
        imki_parameter_refuse(
            p, IMK_ERROR_KEY_MISSING, "CAL_GYRO0_XOFF", "CAL_GYRO0_XOFF",
            "a file with calibration parameters CAL_GYRO…, CAL_ACC…, TC_G… or TC_A… that are set");
    imki_choice_end(p, choice.found, choice.names, "NUMBER", "the file has several IMUs");
    return choice.chosen;
}

/* The thermal parameters belong to a device: of the same ID, or of the same slot without IDs. */
static const px4_sensor *thermal_of(const px4_sensor sensors[SENSORS_MAX], int chosen)
{
    double id = sensors[chosen].id, same_slot = sensors[chosen].thermal_id;
    for (int i = 0; i < SENSORS_MAX; i++)
        if (id != 0 && sensors[i].thermal_id == id)
            return &sensors[i];
    bool other = !isnan(id) && id != 0 && !isnan(same_slot) && same_slot != 0;
    return other ? NULL : &sensors[chosen];
}

static void fill_thermal(imki_parameters *p, const px4_sensor *thermal, int kind, double enable,
                         double offset[3])
{
    imk_temperature_polynomial *polynomial = &p->triad[kind]->bias.temperature;
    int order = 0;
    bool any = false;
    for (int k = 0; k <= ORDER; k++)
        for (int i = 0; i < 3; i++)
            if (thermal->coefficient[k][i] != 0) {
                order = k;
                any = true;
            }
    if (!any)
        return;
    if (enable == 0) {
        imki_note(p, true, "TC_%c_ENABLE is 0: PX4 does not use TC_%c…, which are left out",
                  thermal_letters[kind], thermal_letters[kind]);
        return;
    }
    if (isnan(enable))
        imki_note(p, false, "TC_%c_ENABLE is not in the file: TC_%c… are taken to be in use",
                  thermal_letters[kind], thermal_letters[kind]);
    if (order > 0 && !(thermal->minimum < thermal->maximum && thermal->minimum >= -kelvin))
        imki_parameter_refuse_at(p, (imki_place){"TMIN", thermal->line, 0}, IMK_ERROR_RANGE,
                                 "TMIN and TMAX",
                                 "a TMIN above absolute zero and below TMAX [degC]");
    for (int i = 0; i < 3; i++)
        offset[i] += thermal->coefficient[0][i];
    polynomial->order = order;
    for (int k = 0; k < order; k++)
        memcpy(polynomial->coefficient[k].value, thermal->coefficient[k + 1],
               sizeof thermal->coefficient[k + 1]);
    polynomial->reference = thermal->reference + kelvin;
    polynomial->minimum = thermal->minimum + kelvin;
    polynomial->maximum = thermal->maximum + kelvin;
}

static void fill(imki_parameters *p, const px4_file *file, int kind, int chosen)
{
    imk_triad *triad = p->triad[kind];
    const px4_sensor *s = &file->sensor[kind][chosen];
    const px4_sensor *thermal = thermal_of(file->sensor[kind], chosen);
    triad->present = in_use(file, kind, chosen);
    if (!triad->present)
        return;
    double offset[3] = {s->offset[0], s->offset[1], s->offset[2]};
    if (thermal)
        fill_thermal(p, thermal, kind, file->enable[kind], offset);
    imki_accept(p, (imki_place){"XOFF", s->line, 0}, kind, IMKI_BIAS, offset,
                (imki_unit){imki_kind_units[kind], 1}, triad->bias.fixed.value);
    for (int i = 0; i < 3; i++) {
        /* The limits of PX4's own parameter definition. */
        if (!(s->scale[i] >= 0.1 && s->scale[i] <= 3))
            imki_parameter_refuse_at(p, (imki_place){"XSCALE", s->line, 0}, IMK_ERROR_RANGE, "",
                                     "a scale between 0.1 and 3");
        triad->scale_factor.fixed.value[i] = s->scale[i] == 1 ? 0 : 1 / s->scale[i] - 1;
    }
    if (s->rotation > 0)
        imki_note(p, true, "CAL_%s%d_ROT %g: the model is in the axes of the sensor, not rotated",
                  calibration_names[kind], chosen, s->rotation);
}

void imki_px4_read(imki_parameters *p)
{
    px4_file file;
    read_file(p, &file);
    const int chosen = choose(p, &file);
    for (int kind = 0; kind < 2; kind++)
        fill(p, &file, kind, chosen);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_parameter(imki_parameters *p, const char *name, double value, bool integer)
{
    /* MAV_PARAM_TYPE: INT32, REAL32 */
    imki_text_add(&p->out, "1\t1\t%s\t%s\t%d\n", name, imki_shortest(value).text, integer ? 6 : 9);
}

static void write_thermal(imki_parameters *p, int kind, const imk_temperature_polynomial *t)
{
    char name[24], letter = thermal_letters[kind];
    const double temperatures[3] = {t->reference - kelvin, t->minimum - kelvin,
                                    t->maximum - kelvin};
    static const char *const names[3] = {"TREF", "TMIN", "TMAX"};
    snprintf(name, sizeof name, "TC_%c_ENABLE", letter);
    write_parameter(p, name, t->order > 0, true);
    if (t->order == 0)
        return;
    imki_note(p, true, "TC_%c0_ID is not known: set it to the ID of the device", letter);
    double cubic[3][ORDER + 1], worst = 0;
    for (int i = 0; i < 3; i++)
        worst = fmax(worst, imki_cubic(t, i, t->reference, cubic[i]));
    if (worst > 0)
        imki_note(p, true,
                  "%s.bias.temperature: PX4 has cubic polynomials; the nearest one differs by up "
                  "to %.2g %s",
                  imki_kind_names[kind], worst, imki_kind_units[kind]);
    for (int k = 0; k <= ORDER; k++)
        for (int i = 0; i < 3; i++) {
            snprintf(name, sizeof name, "TC_%c0_X%d_%d", letter, k, i);
            write_parameter(p, name, cubic[i][k], false);
        }
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "TC_%c0_%s", letter, names[i]);
        write_parameter(p, name, temperatures[i], false);
    }
}

static void write_sensor(imki_parameters *p, int kind, const imk_triad *triad)
{
    char name[24];
    bool scaled = kind == IMK_ACCEL;
    for (int i = 0; i < 3; i++)
        scaled = scaled || triad->scale_factor.fixed.value[i] != 0;
    if (kind == IMK_GYRO && scaled)
        imki_note(p, false, "CAL_GYRO0_XSCALE …: only early versions of PX4 have a gyro scale");
    imki_text_add(&p->out,
                  "# CAL_%s0: offset [%s], scale [1]; corrected = (reading - offset) "
                  "scale\n",
                  calibration_names[kind], imki_kind_units[kind]);
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "CAL_%s0_%cOFF", calibration_names[kind], 'X' + i);
        write_parameter(p, name, triad->bias.fixed.value[i], false);
    }
    for (int i = 0; i < 3 && scaled; i++) {
        double s = triad->scale_factor.fixed.value[i];
        snprintf(name, sizeof name, "CAL_%s0_%cSCALE", calibration_names[kind], 'X' + i);
        write_parameter(p, name, s == 0 ? 1 : 1 / (1 + s), false);
    }
    write_thermal(p, kind, &triad->bias.temperature);
}

void imki_px4_write(imki_parameters *p)
{
    imki_text_add(&p->out, "# PX4 calibration parameters; temperatures [degC], TC_…_Xk [unit of "
                           "the offset/degC^k]\n#\n# Vehicle-Id Component-Id Name Value Type\n");
    for (int kind = 0; kind < 2; kind++)
        if (p->origin[kind]->present)
            write_sensor(p, kind, p->origin[kind]);
    imki_note(p, true,
              "CAL_GYRO0_ID, CAL_ACC0_ID are not known: set them to the IDs of the devices");
}
