/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms a model leaves out, and what the presets of the classes have for them. */
#include "imukit/model_unstated.h"

#include "devices/device_table_internal.h"
#include "model_schema_internal.h"

#include "imukit/units.h"

#include <stddef.h>
#include <string.h>

#define AT(member) offsetof(imk_triad, member)
#define IN_TABLE(member) offsetof(imki_device_figures, member)
#define NOWHERE ((size_t)-1)

/* A term that every sensor has. */
typedef struct expected_term {
    size_t offset, other; /* the field that gets the typical value, and one that states it, too */
    size_t figure;        /* of the preset */
    const char *unit[2];  /* of this figure; NULL: the kind of sensor has no such term */
    const char *text[2];
    bool tells_class;
} expected_term;

static const expected_term expected_terms[] = {
    {AT(bias.repeatability),
     NOWHERE,
     IN_TABLE(repeatability),
     {"deg/h", "ug"},
     {"gyro run-to-run bias", "accelerometer run-to-run bias"},
     true},
    {AT(noise.white),
     NOWHERE,
     IN_TABLE(white),
     {"deg/sqrt(h)", "m/s/sqrt(h)"},
     {"gyro angle random walk", "accelerometer velocity random walk"},
     true},
    {AT(noise.bias_instability),
     AT(noise.gauss_markov),
     IN_TABLE(instability),
     {"deg/h", "ug"},
     {"gyro bias instability", "accelerometer bias instability"},
     true},
    {AT(noise.random_walk),
     NOWHERE,
     IN_TABLE(random_walk),
     {"deg/h/sqrt(h)", "ug/sqrt(h)"},
     {"gyro rate random walk", "accelerometer acceleration random walk"},
     true},
    {AT(scale_factor.repeatability),
     AT(scale_factor.fixed),
     IN_TABLE(scale_factor),
     {"ppm", "ppm"},
     {"gyro scale factor", "accelerometer scale factor"},
     true},
    {AT(misalignment),
     AT(cross_axis),
     IN_TABLE(misalignment),
     {"mrad", "mrad"},
     {"gyro misalignment", "accelerometer misalignment"},
     false},
    {AT(g_sensitivity),
     NOWHERE,
     IN_TABLE(g_sensitivity),
     {"deg/h/g", NULL},
     {"gyro g-sensitivity", NULL},
     false},
    {AT(g2_sensitivity),
     NOWHERE,
     IN_TABLE(g2_sensitivity),
     {"deg/h/g^2", NULL},
     {"gyro g2-sensitivity", NULL},
     false},
    {AT(nonlinearity.k2),
     NOWHERE,
     IN_TABLE(k2),
     {NULL, "ppm/g"},
     {NULL, "accelerometer nonlinearity, second order"},
     false},
};
enum { EXPECTED = sizeof expected_terms / sizeof expected_terms[0], SENSORS = 2 };

static const imki_field *field_at(size_t offset)
{
    const imki_field *field = imki_triad_fields;
    while (field->offset != offset)
        field++;
    return field;
}

bool imki_field_expected(const imki_field *field, int kind)
{
    for (int i = 0; i < EXPECTED && kind < SENSORS; i++)
        if (expected_terms[i].offset == field->offset && expected_terms[i].unit[kind])
            return true;
    return false;
}

/* ---- what is stated -------------------------------------------------------------------------- */

/* The largest value that the data allow of a term that was looked for and not found, on the worst
 * axis; infinite: it was not looked for. */
static double bound_of(const imk_model *model, int sensor, const char *key)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    const imk_evidence *evidence =
        sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    double bound = 0;
    for (int i = 0; triad->present && i < evidence->interval_count; i++) {
        if (strcmp(evidence->interval[i].key, key) != 0)
            continue;
        for (int axis = 0; axis < triad->axis_count; axis++)
            bound = fmax(bound, evidence->interval[i].upper.value[axis]);
    }
    return bound > 0 ? bound : (double)INFINITY;
}

static bool states_field(const imk_triad *triad, size_t offset)
{
    const imki_field *field = field_at(offset);
    return !imki_field_absent(field, triad) || imki_field_stated_zero(field, triad);
}

static bool has_any(const double *number, int count)
{
    for (int i = 0; i < count; i++)
        if (number[i] != 0)
            return true;
    return false;
}

static bool is_stated(const imk_model *model, int sensor, const expected_term *term)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    if (!triad->present)
        return false;
    if (states_field(triad, term->offset))
        return true;
    if (term->offset == AT(bias.repeatability))
        return model->residual_of[0] && has_any(triad->bias.fixed.sigma, triad->axis_count);
    return term->other != NOWHERE && states_field(triad, term->other);
}

/* ---- the class that fits --------------------------------------------------------------------- */

static const imki_device_figures *figures_of(int grade, int sensor)
{
    const imki_device_entry *entry = &imki_grade_presets[grade];
    return sensor == IMK_GYRO ? &entry->gyro : &entry->accel;
}

static double typical(int grade, int sensor, const expected_term *term)
{
    const char *figures = (const char *)figures_of(grade, sensor);
    const double figure = *(const double *)(const void *)(figures + term->figure);
    return figure * imk_unit_of(term->unit[sensor]).scale;
}

static double worst_of(const imk_triad *triad, const expected_term *term)
{
    const double *value = imki_field_values(field_at(term->offset), triad);
    double worst = 0;
    for (int i = 0; i < triad->axis_count; i++)
        worst = fmax(worst, value[i]);
    return worst;
}

/* IMK_GRADE_NONE when it states nothing that tells. */
static imk_grade class_of(const imk_triad *triad, int sensor)
{
    double least = (double)INFINITY;
    int nearest = IMK_GRADE_NONE;
    for (int grade = 0; triad->present && grade < IMKI_PRESETS; grade++) {
        double sum = 0;
        int count = 0;
        for (int i = 0; i < EXPECTED; i++) {
            const double stated =
                expected_terms[i].tells_class ? worst_of(triad, &expected_terms[i]) : 0;
            if (!(stated > 0))
                continue;
            const double ratio = log(stated / typical(grade, sensor, &expected_terms[i]));
            sum += ratio * ratio;
            count++;
        }
        if (count > 0 && sum < least) {
            least = sum;
            nearest = grade;
        }
    }
    return (imk_grade)nearest;
}

imk_grade imk_model_class(const imk_model *model, int sensor)
{
    if (sensor != IMK_GYRO && sensor != IMK_ACCEL)
        return IMK_GRADE_NONE;
    const int other = IMK_GYRO + IMK_ACCEL - sensor;
    const imk_grade own = class_of(imk_model_triad(model, sensor), sensor);
    return own != IMK_GRADE_NONE ? own : class_of(imk_model_triad(model, other), other);
}

/* ---- what is not ----------------------------------------------------------------------------- */

static void find(const imk_model *model, imk_grade grade, imk_unstated *unstated)
{
    unstated->count = 0;
    for (int sensor = IMK_GYRO; sensor <= IMK_ACCEL; sensor++) {
        const imk_grade own = grade != IMK_GRADE_NONE ? grade : imk_model_class(model, sensor);
        const imk_grade found = own != IMK_GRADE_NONE ? own : IMK_GRADE_CONTROL;
        for (int i = 0; i < EXPECTED; i++) {
            if (!expected_terms[i].unit[sensor] || is_stated(model, sensor, &expected_terms[i]))
                continue;
            const imki_field *field = field_at(expected_terms[i].offset);
            const char *key = field->path[sensor];
            unstated->term[unstated->count++] =
                (imk_unstated_term){.sensor = sensor,
                                    .key = key,
                                    .text = expected_terms[i].text[sensor],
                                    .grade = found,
                                    .typical = fmin(typical(found, sensor, &expected_terms[i]),
                                                    bound_of(model, sensor, key)),
                                    .unit = expected_terms[i].unit[sensor],
                                    .si = field->si[sensor]};
        }
    }
}

void imk_model_unstated(const imk_model *model, imk_unstated *unstated)
{
    find(model, IMK_GRADE_NONE, unstated);
}

/* ---- to assume it ---------------------------------------------------------------------------- */

/* A sensitivity is along the axis itself, a misalignment towards the body axes across it. */
static void set_row(const imki_field *field, imk_triad *triad, int axis, double value)
{
    const double *e = triad->direction[axis];
    for (int j = 0; j < 3; j++)
        if (field->shape == IMKI_OFF_DIAGONAL)
            triad->misalignment.value[axis][j] = e[j] == 0 && j != axis ? value : 0;
        else if (field->shape == IMKI_ROWS)
            triad->g_sensitivity.value[axis][j] = value * e[j];
        else
            triad->g2_sensitivity.value[axis][j] = value * e[j] * e[j];
}

static void assume(imk_triad *triad, const imk_unstated_term *term)
{
    const imki_field *field = imki_field_find(term->key, term->sensor, NULL);
    for (int axis = 0; axis < triad->axis_count; axis++)
        if (field->shape == IMKI_AXES)
            ((imk_axes *)(void *)((char *)triad + field->offset))->value[axis] = term->typical;
        else
            set_row(field, triad, axis, term->typical);
}

void imk_model_assume_class(imk_model *model, imk_grade grade, imk_unstated *assumed)
{
    imk_unstated all;
    find(model, grade, &all);
    while (imk_model_complete(model) >= 0) {
    }
    size_t kept = 0;
    for (size_t i = 0; i < all.count; i++) {
        if (!(all.term[i].typical > 0))
            continue;
        assume(imk_model_triad_to_set(model, all.term[i].sensor), &all.term[i]);
        all.term[kept++] = all.term[i];
    }
    all.count = kept;
    if (assumed)
        *assumed = all;
}

/* ---- one key --------------------------------------------------------------------------------- */

bool imk_model_states(const imk_model *model, int sensor, const char *key)
{
    const imki_field *list = NULL;
    if (sensor < 0 || sensor >= IMK_KINDS || !key)
        return false;
    const imk_triad *triad = imk_model_triad(model, sensor);
    const imki_field *field = imki_field_find(key, sensor, &list);
    return field && !list && triad->present && states_field(triad, field->offset);
}

imk_status imk_model_state_zero(imk_model *model, int sensor, const char *key, imk_error *error)
{
    const imki_field *list = NULL;
    const bool known = sensor >= 0 && sensor < IMK_KINDS && key;
    const imki_field *field = known ? imki_field_find(key, sensor, &list) : NULL;
    if (!field || list || imki_field_bit(field) == 0)
        return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "key", key,
                             "a key of the sensor with plain numbers");
    imk_model_triad_to_set(model, sensor)->stated_zero |= imki_field_bit(field);
    return IMK_OK;
}
