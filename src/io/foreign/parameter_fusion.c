/* SPDX-License-Identifier: Apache-2.0 */
/* xioTechnologies/Fusion: the constants that its calibration functions take, as C.
 *
 * FusionCalibrationInertial(), later FusionModelInertial(): calibrated = M (s o (raw - offset)),
 * o being the product by elements (FusionCalibration.h, FusionModel.h). For raw = T v + b that is
 * offset = b and M diag(s) = T^-1; of the ways to divide it, s has the diagonal, so that M has ones
 * there, or, where axes are turned, the lengths of the columns. FusionCalibrationMagnetic():
 * soft (raw - hard): soft = T^-1, hard = b. The algorithm works in deg/s and g; the magnetometer's
 * unit is of no account to it, and is uT here. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct sensor {
    const char *name;
    const char *matrix, *sensitivity, *offset;
    imki_unit unit;
} sensors[IMK_KINDS] = {{"gyro",
                         "gyroscopeMisalignment",
                         "gyroscopeSensitivity",
                         "gyroscopeOffset",
                         {"deg/s", 0.017453292519943295}}, /* pi/180 */
                        {"accel",
                         "accelerometerMisalignment",
                         "accelerometerSensitivity",
                         "accelerometerOffset",
                         {"g", 9.80665}},
                        {"mag", "softIronMatrix", NULL, "hardIronOffset", {"uT", 1e-6}}};

/* ---- reading --------------------------------------------------------------------------------- */

static bool is_word_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Behind the = of `name = `, from `at` on; NULL: it is not assigned to. */
static const char *find_assignment(const imki_parameters *p, const char *at, const char *name)
{
    const size_t length = strlen(name);
    for (at = strstr(at, name); at; at = strstr(at + 1, name)) {
        const char *behind = at + length + strspn(at + length, " \t\r\n");
        if ((at == p->text || !is_word_character(at[-1])) && *behind == '=')
            return behind + 1;
    }
    return NULL;
}

static imki_place place_of(const imki_parameters *p, const char *field, const char *at)
{
    imki_place place = {field, 1, 1};
    for (const char *c = p->text; c < at; c++) {
        place.column = *c == '\n' ? 1 : place.column + 1;
        place.line += *c == '\n';
    }
    return place;
}

/* `count` numbers between braces, which may be nested, or follow `.array =`. */
static bool read_list(const char *at, int count, double *values)
{
    bool opened = false;
    for (int i = 0; i < count;) {
        at += strspn(at, " \t\r\n,{");
        opened = opened || at[-1] == '{';
        if (strncmp(at, ".array", 6) == 0) {
            at += 6 + strspn(at + 6, " \t\r\n=");
            continue;
        }
        const char *end = at + strcspn(at, ",}; \t\r\n");
        const char *digits_end = end > at && (end[-1] == 'f' || end[-1] == 'F') ? end - 1 : end;
        if (*at == '}' && i > 0 && at[1] != ';') { /* of a row */
            at++;
            continue;
        }
        if (!opened || !imki_number(at, digits_end, &values[i]))
            return false;
        i++;
        at = end;
    }
    at += strspn(at, " \t\r\n,}");
    return *at == ';';
}

/* @return false when there is no such constant */
static bool read_constant(imki_parameters *p, const char *name, int count, double *values,
                          imki_place *place)
{
    const char *at = name ? find_assignment(p, p->text, name) : NULL;
    if (!at)
        return false;
    *place = place_of(p, name, at);
    if (find_assignment(p, at, name))
        imki_parameter_refuse_at(p, *place, IMK_ERROR_KEY_DUPLICATE, "",
                                 "one constant of this name");
    if (!read_list(at, count, values))
        imki_parameter_refuse_at(p, *place, IMK_ERROR_SYNTAX, "",
                                 count == 9 ? "nine numbers in braces: {1.0f, 0.0f, …}"
                                            : "three numbers in braces: {1.0f, 2.0f, 3.0f}");
    return true;
}

/* @return whether the file is about this sensor */
static bool read_sensor(imki_parameters *p, int kind, imk_triad *triad)
{
    double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, s[3] = {1, 1, 1}, raw[3] = {0}, correction[3][3];
    imki_place place = {sensors[kind].matrix, 0, 0}, offset_place = place, other;
    const bool has_matrix = read_constant(p, sensors[kind].matrix, 9, m, &place);
    const bool has_sensitivity = read_constant(p, sensors[kind].sensitivity, 3, s, &other);
    const bool has_offset = read_constant(p, sensors[kind].offset, 3, raw, &offset_place);
    for (int i = 0; i < 9; i++)
        correction[i / 3][i % 3] = m[i] * s[i % 3];
    if (p->status == IMK_OK && (has_matrix || has_sensitivity))
        imki_correction_set(p, place, triad, correction);
    /* A magnetometer has no limits of its own here. */
    if (p->status == IMK_OK)
        imki_accept(p, offset_place, kind == IMK_MAG ? IMK_GYRO : kind,
                    kind == IMK_MAG ? IMKI_PLAIN : IMKI_BIAS, raw, sensors[kind].unit,
                    triad->bias.fixed.value);
    return has_matrix || has_sensitivity || has_offset;
}

void imki_fusion_read(imki_parameters *p)
{
    bool any = false;
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        imk_triad *triad = imk_model_triad_to_set(p->model, kind);
        triad->present = read_sensor(p, kind, triad);
        any = any || triad->present;
    }
    if (!any)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, sensors[0].matrix, "",
                              "assignments to gyroscopeMisalignment, accelerometerOffset and the "
                              "like, numbers in braces");
    if (p->model->gyro.present || p->model->accel.present)
        imki_note(p, false,
                  "raw readings are taken to be in deg/s and g; sensitivities that convert "
                  "from counts are refused");
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_constant(imki_parameters *p, const char *type, const char *name, int count,
                           const double *values)
{
    imki_text_add(&p->out, "static const %s %s = {{", type, name);
    for (int i = 0; i < count; i++) {
        char text[IMK_DECIMAL_SIZE];
        snprintf(text, sizeof text, "%s", imki_shortest(values[i]).text);
        imki_text_add(&p->out, "%s%s%sf", i > 0 ? ", " : "", text,
                      text[strcspn(text, ".e")] ? "" : ".0");
    }
    imki_text_add(&p->out, "}};\n");
}

static void write_sensor(imki_parameters *p, int kind, const imk_triad *triad)
{
    const struct sensor *sensor = &sensors[kind];
    double correction[3][3], m[9], s[3], offset[3];
    bool upright = true;
    imki_correction_of(p, triad, sensor->name, correction);
    if (p->status != IMK_OK)
        return;
    for (int i = 0; i < 3; i++)
        upright = upright && correction[i][i] > 0.1;
    for (int j = 0; j < 3; j++) {
        const double length =
            sqrt(correction[0][j] * correction[0][j] + correction[1][j] * correction[1][j] +
                 correction[2][j] * correction[2][j]);
        s[j] = !sensor->sensitivity ? 1 : upright ? correction[j][j] : length;
        offset[j] = triad->bias.fixed.value[j] / sensor->unit.scale;
        for (int i = 0; i < 3; i++)
            m[3 * i + j] = correction[i][j] / s[j];
    }
    imki_text_add(&p->out, "\n");
    write_constant(p, "FusionMatrix", sensor->matrix, 9, m);
    if (sensor->sensitivity)
        write_constant(p, "FusionVector", sensor->sensitivity, 3, s);
    imki_text_add(&p->out, "/* [%s] */\n", sensor->unit.name);
    write_constant(p, "FusionVector", sensor->offset, 3, offset);
}

void imki_fusion_write(imki_parameters *p)
{
    imki_text_add(
        &p->out,
        "/* Fusion: arguments of FusionCalibrationInertial() and FusionCalibrationMagnetic()"
        ", later\n * FusionModelInertial() and FusionModelMagnetic(), for raw readings in "
        "deg/s, g and uT:\n *     calibrated = misalignment (sensitivity o (raw - "
        "offset)),  soft iron (raw - hard iron).\n * Readings in another unit: multiply "
        "them first. */\n#include \"Fusion.h\"\n");
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const imk_triad *triad = imk_model_triad(p->source, kind);
        if (triad->present && triad->axis_count == 3)
            write_sensor(p, kind, triad);
    }
}
