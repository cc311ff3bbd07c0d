/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a model by their path, found in the rows of the schema. */
#include "imukit/model_path.h"

#include "base/nearest_name_internal.h"
#include "model_schema_internal.h"

#include "imukit/units.h"

#include <string.h>

static const char *const polynomial_keys[] = {"reference_temperature", "valid_range",
                                              "coefficients"};
enum { REFERENCE, VALID_RANGE, COEFFICIENTS, POLYNOMIAL_KEYS };

/* A path in parts: its sensor, the row of its field, and what follows. */
typedef struct place {
    int kind; /* IMK_KINDS: the timing */
    const imki_field *field, *list;
    int element; /* of a list, or coefficient of a polynomial */
    int key;     /* of a polynomial */
} place;

/* ---- the paths there are --------------------------------------------------------------------- */

static void append_to(char *text, size_t size, const char *more)
{
    size_t length = strlen(text);
    while (*more && length + 1 < size)
        text[length++] = *more++;
    text[length] = '\0';
}

static void append(char path[IMK_MODEL_PATH], const char *more)
{
    append_to(path, IMK_MODEL_PATH, more);
}

/* Paths of a row. */
static size_t count_paths(const imki_field *field, int kind)
{
    if (kind < IMK_KINDS && !field->path[kind])
        return 0;
    return field->shape == IMKI_DENSITY      ? 0
           : field->shape == IMKI_LIST       ? imki_list_of(field).field_count
           : field->shape == IMKI_POLYNOMIAL ? POLYNOMIAL_KEYS
                                             : 1;
}

/* Path number `index` of a row. */
static void write_path(const imki_field *field, int kind, size_t index, char path[IMK_MODEL_PATH])
{
    path[0] = '\0';
    append(path, kind < IMK_KINDS ? imki_kind_names[kind] : "timing");
    append(path, ".");
    append(path, field->path[kind < IMK_KINDS ? kind : 0]);
    if (field->shape == IMKI_LIST) {
        append(path, "[].");
        append(path, imki_list_of(field).field[index].path[kind]);
    } else if (field->shape == IMKI_POLYNOMIAL) {
        append(path, ".");
        append(path, polynomial_keys[index]);
        if (index == COEFFICIENTS)
            append(path, "[]");
    }
}

bool imk_model_path(size_t index, char path[IMK_MODEL_PATH])
{
    for (int kind = 0; kind <= IMK_KINDS; kind++) {
        const bool timing = kind == IMK_KINDS;
        const imki_field *rows = timing ? imki_timing_fields : imki_triad_fields;
        const size_t count = timing ? imki_timing_field_count : imki_triad_field_count;
        for (size_t i = 0; i < count; i++) {
            const size_t paths = count_paths(&rows[i], kind);
            if (index < paths) {
                write_path(&rows[i], kind, index, path);
                return true;
            }
            index -= paths;
        }
    }
    return false;
}

/* ---- finding a path -------------------------------------------------------------------------- */

/* The path with its first "[number]" taken out. @return the number; -1: there is none that can be
 */
static int take_element(char path[IMK_MODEL_PATH])
{
    char *open = strchr(path, '['), *close = open ? strchr(open, ']') : NULL;
    int element = 0;
    if (!close || close - open < 2 || close - open > 3)
        return -1;
    for (const char *c = open + 1; c < close; c++) {
        if (!(*c >= '0' && *c <= '9'))
            return -1;
        element = 10 * element + (*c - '0');
    }
    memmove(open, close + 1, strlen(close + 1) + 1);
    return element;
}

/* The key of a polynomial at the end of a path, which is cut off. */
static int take_key(char path[IMK_MODEL_PATH])
{
    char *dot = strrchr(path, '.');
    for (int key = 0; dot && key < POLYNOMIAL_KEYS; key++)
        if (strcmp(dot + 1, polynomial_keys[key]) == 0) {
            *dot = '\0';
            return key;
        }
    return -1;
}

static bool find_timing(const char *name, place *p)
{
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (strcmp(name, imki_timing_fields[i].path[0]) == 0) {
            *p = (place){.kind = IMK_KINDS, .field = &imki_timing_fields[i], .element = -1};
            return true;
        }
    return false;
}

/* The path below a sensor. */
static bool find_below(const char *below, int kind, place *p)
{
    char path[IMK_MODEL_PATH] = "";
    append(path, below);
    *p = (place){.kind = kind, .element = take_element(path)};
    p->key = take_key(path);
    p->field = imki_field_find(path, kind, &p->list);
    if (!p->field || p->field->shape == IMKI_LIST || p->field->shape == IMKI_DENSITY)
        return false;
    const bool polynomial = p->field->shape == IMKI_POLYNOMIAL;
    const bool counted = p->list || (polynomial && p->key == COEFFICIENTS);
    const int most = polynomial ? IMK_TEMPERATURE_ORDER_MAX : IMK_TERMS_MAX;
    return polynomial == (p->key >= 0) && counted == (p->element >= 0) && p->element < most;
}

/* The sensor of a path, and what follows it; NULL: it begins with none. */
static const char *below_sensor(const char *path, int *kind)
{
    for (*kind = 0; *kind < IMK_KINDS; (*kind)++) {
        const size_t length = strlen(imki_kind_names[*kind]);
        if (strncmp(path, imki_kind_names[*kind], length) == 0 && path[length] == '.')
            return path + length + 1;
    }
    return NULL;
}

static const char *polynomial_unit(const place *p)
{
    return p->key == COEFFICIENTS ? imki_polynomial_si(p->field, p->kind, p->element + 1) : "K";
}

static const char *unit_of(const place *p)
{
    const int kind = p->kind < IMK_KINDS ? p->kind : 0;
    return p->field->shape == IMKI_POLYNOMIAL ? polynomial_unit(p)
           : p->field->flags & IMKI_BARE      ? ""
                                              : p->field->si[kind];
}

/* What stands behind `begin` in a path; NULL: it begins otherwise. */
static const char *behind(const char *path, const char *begin)
{
    const size_t length = strlen(begin);
    return strncmp(path, begin, length) == 0 ? path + length : NULL;
}

/* @return false where no numbers have this path */
static bool find(const char *path, place *p)
{
    int kind;
    const char *below = below_sensor(path, &kind), *timing = behind(path, "timing.");
    return below ? find_below(below, kind, p) : timing && find_timing(timing, p);
}

/* The key of an interval or bound of the evidence of a sensor; NULL: the path is of no such thing.
 */
static const char *evidence_key(const char *path, int *kind, bool *bound)
{
    const char *below = below_sensor(path, kind);
    const char *interval = below ? behind(below, "evidence.interval_95.") : NULL;
    *bound = !interval;
    return interval || !below ? interval : behind(below, "evidence.upper_bound.");
}

const char *imk_model_path_unit(const char *path)
{
    place p;
    int kind;
    bool bound;
    const char *key = evidence_key(path, &kind, &bound);
    return (key ? find_below(key, kind, &p) : find(path, &p)) ? unit_of(&p) : NULL;
}

static imk_status refuse_unknown(const char *path, imk_error *error)
{
    char candidate[2][IMK_MODEL_PATH] = {""}, expected[160] = "a path of the model file";
    const char *const names[2] = {candidate[0], candidate[1]};
    for (size_t i = 0; imk_model_path(i, candidate[1]); i++)
        if (imki_nearest_name(path, 2, names) == 1)
            memcpy(candidate[0], candidate[1], IMK_MODEL_PATH);
    if (candidate[0][0]) {
        expected[0] = '\0';
        append_to(expected, sizeof expected, "did you mean \"");
        append_to(expected, sizeof expected, candidate[0]);
        append_to(expected, sizeof expected, "\"?");
    }
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "model", path, expected);
}

static imk_status refuse_missing(const char *path, const char *expected, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_KEY_MISSING, path, path, expected);
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* In the unit that is told: of "count/uT" a number of the struct is not in it. */
static void copy(imk_model_numbers *numbers, const double *value, const double *sigma)
{
    const double scale = numbers->unit[0] ? imk_unit_of(numbers->unit).scale : 1;
    const int axes = numbers->axes > 0 ? numbers->axes : 1;
    for (int k = 0; k < axes * numbers->columns; k++) {
        numbers->value[k] = value[k] / scale;
        numbers->sigma[k] = sigma ? sigma[k] / scale : 0;
    }
}

static void get_polynomial(const place *p, const imk_triad *triad, imk_model_numbers *numbers)
{
    const imk_temperature_polynomial *of = (const void *)((const char *)triad + p->field->offset);
    const double range[2] = {of->minimum, of->maximum};
    numbers->axes = p->key == COEFFICIENTS ? triad->axis_count : 0;
    numbers->columns = p->key == VALID_RANGE ? 2 : 1;
    if (p->key == COEFFICIENTS)
        copy(numbers, of->coefficient[p->element].value, of->coefficient[p->element].sigma);
    else
        copy(numbers, p->key == VALID_RANGE ? range : &of->reference, NULL);
}

static void get_field(const place *p, const imk_model *model, imk_model_numbers *numbers)
{
    const imk_triad *triad = p->kind < IMK_KINDS ? imk_model_triad(model, p->kind) : NULL;
    const bool direction = p->field->shape == IMKI_DIRECTION || p->field->shape == IMKI_PENDULOUS;
    const void *base = !triad    ? (const void *)&model->timing
                       : p->list ? imki_list_element(p->list, triad, p->element)
                                 : (const void *)triad;
    numbers->axes = triad && p->field->shape != IMKI_SCALAR ? triad->axis_count : 0;
    numbers->columns = imki_row_length(p->field->shape);
    copy(numbers, imki_field_values(p->field, base),
         direction ? NULL : imki_field_sigmas(p->field, base));
    for (int k = 0; (p->field->flags & IMKI_FLOOR) && k < numbers->axes; k++) {
        numbers->value[k] *= IMKI_ALLAN_FLOOR;
        numbers->sigma[k] *= IMKI_ALLAN_FLOOR;
    }
}

/* Elements of the list or polynomial of a place; 1: it is neither. */
static int elements(const place *p, const imk_triad *triad)
{
    if (p->list)
        return imki_list_count(p->list, triad);
    if (p->field->shape != IMKI_POLYNOMIAL)
        return 1;
    return ((const imk_temperature_polynomial *)(const void *)((const char *)triad +
                                                               p->field->offset))
        ->order;
}

/* An interval of the evidence, or the upper bound of a term that is absent. */
static imk_status get_evidence(const imk_model *model, int kind, const char *path, const char *key,
                               bool bound, imk_model_numbers *numbers, imk_error *error)
{
    const imk_evidence *const evidence[IMK_KINDS] = {&model->gyro_evidence, &model->accel_evidence,
                                                     &model->mag_evidence};
    const imk_triad *triad = imk_model_triad(model, kind);
    char name[IMK_MODEL_PATH] = "";
    place p;
    if (!find_below(key, kind, &p))
        return refuse_unknown(path, error);
    append(name, key);
    const int instance = take_element(name);
    for (int i = 0; i < evidence[kind]->interval_count; i++) {
        const imk_interval *of = &evidence[kind]->interval[i];
        if (strcmp(of->key, name) != 0 || of->instance != (instance < 0 ? 0 : instance))
            continue;
        *numbers = (imk_model_numbers){
            .unit = unit_of(&p), .axes = triad->axis_count, .columns = bound ? 1 : 2};
        double value[2 * IMK_AXES_MAX] = {0};
        for (int k = 0; k < triad->axis_count; k++) {
            value[k * numbers->columns] = bound ? of->upper.value[k] : of->lower.value[k];
            if (!bound)
                value[2 * k + 1] = of->upper.value[k];
        }
        copy(numbers, value, NULL);
        return IMK_OK;
    }
    return refuse_missing(path, "evidence that the model has", error);
}

imk_status imk_model_numbers_get(const imk_model *model, const char *path,
                                 imk_model_numbers *numbers, imk_error *error)
{
    place p;
    int kind;
    bool bound;
    const char *key = evidence_key(path, &kind, &bound);
    if (key)
        return get_evidence(model, kind, path, key, bound, numbers, error);
    if (!find(path, &p))
        return refuse_unknown(path, error);
    const imk_triad *triad = p.kind < IMK_KINDS ? imk_model_triad(model, p.kind) : NULL;
    if (triad && !triad->present)
        return refuse_missing(path, "a sensor that the model has", error);
    if (triad && p.element >= elements(&p, triad))
        return refuse_missing(path, "an element that the list has", error);
    *numbers = (imk_model_numbers){.unit = unit_of(&p)};
    if (triad && p.field->shape == IMKI_POLYNOMIAL)
        get_polynomial(&p, triad, numbers);
    else
        get_field(&p, model, numbers);
    return IMK_OK;
}
