/* SPDX-License-Identifier: Apache-2.0 */
/* PX4: calibration parameters of one IMU, as QGroundControl writes them (vehicle, component, name,
 * value, type, separated by tabs) or as lines `NAME VALUE`.
 *
 *     corrected = (reading - thermal offset - CAL_…_XOFF) CAL_…_XSCALE     (sensor_calibration)
 *     thermal offset = X0 + X1 d + X2 d^2 + X3 d^3,   d = T - TREF, T clipped to TMIN … TMAX
 *
 * so that forward bias = XOFF + X0 and scale factor = 1/XSCALE - 1. Units are rad/s, m/s^2 and
 * degC. */
#include "model/model_schema_internal.h"
#include "parameter_internal.h"

#include "imukit/decimal.h"

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
static double *target_of(px4_file *file, const char *name, size_t line)
{
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

/* The next word of a line; separators are blanks, tabs and commas. */
static const char *next_word(const char *at, const char *end, const char **word_end)
{
    while (at < end && (*at == ' ' || *at == '\t' || *at == ',' || *at == '\r'))
        at++;
    const char *stop = at;
    while (stop < end && *stop != ' ' && *stop != '\t' && *stop != ',' && *stop != '\r')
        stop++;
    *word_end = stop;
    return at;
}

static imk_status take_line(imki_parameters *p, px4_file *file, const char *line, const char *end,
                            size_t number)
{
    char name[24];
    const char *stop, *word = next_word(line, end, &stop);
    for (int i = 0; i < 2 && stop > word && *word >= '0' && *word <= '9'; i++)
        word = next_word(stop, end, &stop); /* vehicle and component */
    if (stop == word || *word == '#' || stop - word >= (ptrdiff_t)sizeof name)
        return IMK_OK;
    memcpy(name, word, (size_t)(stop - word));
    name[stop - word] = '\0';
    double *target = target_of(file, name, number);
    if (!target)
        return IMK_OK;
    word = next_word(stop, end, &stop);
    if (imki_number(word, stop, target) && isfinite(*target))
        return IMK_OK;
    char found[32];
    snprintf(found, sizeof found, "%.*s", (int)(stop - word > 30 ? 30 : stop - word), word);
    imki_place place = {name, number, (size_t)(word - line) + 1};
    return imki_place_error(p, place, IMK_ERROR_SYNTAX, found, "a finite number");
}

static imk_status read_file(imki_parameters *p, px4_file *file)
{
    const char *end = p->text + p->size;
    imk_status status = IMK_OK;
    file->enable[0] = file->enable[1] = NAN;
    for (int i = 0; i < 2 * SENSORS_MAX; i++) {
        px4_sensor *s = &file->sensor[i / SENSORS_MAX][i % SENSORS_MAX];
        *s = (px4_sensor){.scale = {1, 1, 1}, .reference = 25, .maximum = 100, .rotation = -1};
        s->id = s->thermal_id = NAN;
    }
    size_t number = 1;
    for (const char *line = p->text; line < end && status == IMK_OK; number++) {
        const char *line_end = memchr(line, '\n', (size_t)(end - line));
        if (!line_end)
            line_end = end;
        status = take_line(p, file, line, line_end, number);
        line = line_end < end ? line_end + 1 : end;
    }
    return status;
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

static imk_status choose(imki_parameters *p, const px4_file *file, int *chosen)
{
    const char *wanted = p->settings->sensor;
    char list[16] = "", expected[64];
    int found = 0;
    *chosen = 0;
    for (int i = 0; i < SENSORS_MAX; i++) {
        if (!in_use(file, 0, i) && !in_use(file, 1, i))
            continue;
        size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%d", length > 0 ? ", " : "", i);
        if (!wanted || (wanted[0] == '0' + i && wanted[1] == '\0')) {
            *chosen = i;
            found++;
        }
    }
    if (found == 1)
        return IMK_OK;
    if (list[0] == '\0')
        return imk_error_set(p->error, IMK_ERROR_KEY_MISSING, "CAL_GYRO0_XOFF", "CAL_GYRO0_XOFF",
                             "calibration parameters CAL_GYRO…, CAL_ACC…, TC_G… or TC_A… that are "
                             "set");
    snprintf(expected, sizeof expected, "add --sensor NUMBER with one of %s", list);
    return imk_error_set(
        p->error, wanted ? IMK_ERROR_NAME_UNKNOWN : IMK_ERROR_KEY_MISSING, "sensor",
        wanted ? wanted : "\"sensor\" is missing: the file has several IMUs", expected);
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

static imk_status fill_thermal(imki_parameters *p, const px4_sensor *thermal, int kind,
                               double enable, imk_triad *triad, double offset[3])
{
    imk_temperature_polynomial *polynomial = &triad->bias.temperature;
    imki_place place = {"TMIN", thermal->line, 0};
    int order = 0;
    bool any = false;
    for (int k = 0; k <= ORDER; k++)
        for (int i = 0; i < 3; i++)
            if (thermal->coefficient[k][i] != 0) {
                order = k;
                any = true;
            }
    if (!any)
        return IMK_OK;
    if (enable == 0) {
        imki_note(p, true, "TC_%c_ENABLE is 0: PX4 does not use TC_%c…, which are left out",
                  thermal_letters[kind], thermal_letters[kind]);
        return IMK_OK;
    }
    if (isnan(enable))
        imki_note(p, false, "TC_%c_ENABLE is not in the file: TC_%c… are taken to be in use",
                  thermal_letters[kind], thermal_letters[kind]);
    if (order > 0 && !(thermal->minimum < thermal->maximum && thermal->minimum >= -kelvin))
        return imki_place_error(p, place, IMK_ERROR_RANGE, "TMIN and TMAX",
                                "temperatures from a lower to a higher one [degC]");
    for (int i = 0; i < 3; i++)
        offset[i] += thermal->coefficient[0][i];
    polynomial->order = order;
    for (int k = 0; k < order; k++)
        imki_to_axes(thermal->coefficient[k + 1], &polynomial->coefficient[k]);
    polynomial->reference = thermal->reference + kelvin;
    polynomial->minimum = thermal->minimum + kelvin;
    polynomial->maximum = thermal->maximum + kelvin;
    return IMK_OK;
}

static imk_status fill(imki_parameters *p, const px4_file *file, int kind, int chosen,
                       imk_triad *triad)
{
    const px4_sensor *s = &file->sensor[kind][chosen];
    const px4_sensor *thermal = thermal_of(file->sensor[kind], chosen);
    const imki_unit unit = {kind == IMK_GYRO ? "rad/s" : "m/s^2", 1};
    triad->present = in_use(file, kind, chosen);
    if (!triad->present)
        return IMK_OK;
    double offset[3] = {s->offset[0], s->offset[1], s->offset[2]};
    imk_status status =
        thermal ? fill_thermal(p, thermal, kind, file->enable[kind], triad, offset) : IMK_OK;
    imki_place place = {"XOFF", s->line, 0};
    if (status == IMK_OK)
        status = imki_accept(p, place, kind, IMKI_BIAS, offset, unit, triad->bias.fixed.value);
    for (int i = 0; i < 3 && status == IMK_OK; i++) {
        place.field = "XSCALE";
        /* The limits of PX4's own parameter definition. */
        if (!(s->scale[i] >= 0.1 && s->scale[i] <= 3))
            return imki_place_error(p, place, IMK_ERROR_RANGE, "", "a scale between 0.1 and 3");
        triad->scale_factor.fixed.value[i] = s->scale[i] == 1 ? 0 : 1 / s->scale[i] - 1;
    }
    if (s->rotation > 0)
        imki_note(p, true, "CAL_%s%d_ROT %g: the model is in the axes of the sensor, not rotated",
                  calibration_names[kind], chosen, s->rotation);
    return status;
}

imk_status imki_px4_read(imki_parameters *p)
{
    px4_file file;
    int chosen = 0;
    imk_status status = read_file(p, &file);
    if (status == IMK_OK)
        status = choose(p, &file, &chosen);
    if (status == IMK_OK)
        status = fill(p, &file, IMK_GYRO, chosen, &p->model->gyro);
    if (status == IMK_OK)
        status = fill(p, &file, IMK_ACCEL, chosen, &p->model->accel);
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_parameter(imki_parameters *p, const char *name, double value, bool integer)
{
    imki_text_add(&p->out, "1\t1\t%s\t", name);
    imki_text_numbers(&p->out, &value, 1, "");
    imki_text_add(&p->out, "\t%d\n", integer ? 6 : 9); /* MAV_PARAM_TYPE: INT32, REAL32 */
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
                  "%s.bias.temperature: PX4 has cubics; the nearest one is up to %.2g %s off",
                  kind == IMK_GYRO ? "gyro" : "accel", worst, kind == IMK_GYRO ? "rad/s" : "m/s^2");
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
                  calibration_names[kind], kind == IMK_GYRO ? "rad/s" : "m/s^2");
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

imk_status imki_px4_write(imki_parameters *p)
{
    imki_text_add(&p->out, "# PX4 calibration parameters; temperatures [degC], TC_…_Xk [unit of "
                           "the offset/degC^k]\n#\n# Vehicle-Id Component-Id Name Value Type\n");
    if (p->source->gyro.present)
        write_sensor(p, IMK_GYRO, &p->source->gyro);
    if (p->source->accel.present)
        write_sensor(p, IMK_ACCEL, &p->source->accel);
    imki_note(p, true,
              "CAL_GYRO0_ID, CAL_ACC0_ID are not known: set them to the IDs of the devices");
    return IMK_OK;
}
