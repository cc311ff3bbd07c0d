/* SPDX-License-Identifier: Apache-2.0 */
/* Terms of a model switched off by name. A name is any run of whole components of a field's path in
 * the file: with the path gyro.noise.gauss_markov, "gauss_markov", "noise", "gyro.noise" and "gyro"
 * name it, and "gyro.gauss_markov" that of the gyros. So one rule serves keys, terms, groups and
 * sensors, and a new row of the schema has its names at once. */
#include "model_schema_internal.h"

#include "base/nearest_name_internal.h"

#include <stddef.h>
#include <string.h>

enum { PATH_SIZE = 96, CANDIDATES_MAX = 256 };

/* ---- names ----------------------------------------------------------------------------------- */

/* "first.second", or "first.second.third". */
static void join(char path[PATH_SIZE], const char *first, const char *second, const char *third)
{
    const char *const parts[3] = {first, second, third};
    size_t length = 0;
    for (int i = 0; i < 3 && parts[i]; i++) {
        if (i > 0 && length + 1 < PATH_SIZE)
            path[length++] = '.';
        for (const char *c = parts[i]; *c && length + 1 < PATH_SIZE; c++)
            path[length++] = *c;
    }
    path[length] = '\0';
}

/* True when the name is a run of whole components of the path. */
static bool names_path(const char *name, const char *path)
{
    const size_t length = strlen(name);
    if (length == 0)
        return false;
    for (const char *at = strstr(path, name); at; at = strstr(at + 1, name))
        if ((at == path || at[-1] == '.') && (at[length] == '\0' || at[length] == '.'))
            return true;
    return false;
}

/* Of a name that begins with the sensor the rest is what any name is: "gyro.angle_random_walk". */
static bool names_of_sensor(const char *name, int kind, const char *first, const char *second)
{
    const size_t length = strlen(imki_kind_names[kind]);
    char path[PATH_SIZE];
    join(path, imki_kind_names[kind], first, second);
    if (names_path(name, path))
        return true;
    return strncmp(name, imki_kind_names[kind], length) == 0 && name[length] == '.' &&
           names_path(name + length + 1, path + length + 1);
}

/* A list is named by the keys of its elements too. */
static bool names_field(const char *name, const imki_field *field, int kind)
{
    if (!field->path[kind])
        return false;
    if (names_of_sensor(name, kind, field->path[kind], NULL))
        return true;
    if (field->shape != IMKI_LIST)
        return false;
    const imki_list list = imki_list_of(field);
    for (size_t i = 0; i < list.field_count; i++)
        if (names_of_sensor(name, kind, field->path[kind], list.field[i].path[kind]))
            return true;
    return false;
}

static bool names_timing(const char *name, const imki_field *field)
{
    char path[PATH_SIZE];
    join(path, "timing", field->path[0], NULL);
    return names_path(name, path);
}

static bool is_known(const char *name)
{
    for (size_t i = 0; i < imki_triad_field_count; i++)
        if (names_field(name, &imki_triad_fields[i], IMK_GYRO) ||
            names_field(name, &imki_triad_fields[i], IMK_ACCEL) ||
            names_field(name, &imki_triad_fields[i], IMK_MAG))
            return true;
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (names_timing(name, &imki_timing_fields[i]))
            return true;
    return false;
}

static void add_path(const char **candidates, size_t *count, const char *path)
{
    if (!path || *count + 2 > CANDIDATES_MAX)
        return;
    const char *last = strrchr(path, '.');
    candidates[(*count)++] = path;
    if (last)
        candidates[(*count)++] = last + 1;
}

/* Names that could have been meant, below the sensor that is named already. */
static size_t find_candidates(bool has_sensor, const char **candidates)
{
    static const char *const groups[] = {"bias",         "bias.warm_up", "warm_up", "scale_factor",
                                         "nonlinearity", "noise",        "timing",  "gyro",
                                         "accel",        "mag"};
    enum { GROUPS = sizeof groups / sizeof groups[0], OF_A_SENSOR = 6 };
    size_t count = 0;
    for (size_t i = 0; i < imki_triad_field_count; i++) {
        const imki_field *field = &imki_triad_fields[i];
        add_path(candidates, &count, field->path[IMK_GYRO]);
        if (!field->path[IMK_GYRO] || field->path[IMK_GYRO] != field->path[IMK_ACCEL])
            add_path(candidates, &count, field->path[IMK_ACCEL]);
        if (field->path[IMK_MAG] != field->path[IMK_GYRO])
            add_path(candidates, &count, field->path[IMK_MAG]);
    }
    for (size_t i = 0; !has_sensor && i < imki_timing_field_count; i++)
        add_path(candidates, &count, imki_timing_fields[i].path[0]);
    for (size_t i = 0; i < (size_t)(has_sensor ? OF_A_SENSOR : GROUPS); i++)
        candidates[count++] = groups[i];
    return count;
}

static imk_status refuse_name(const char *name, imk_error *error)
{
    const char *candidates[CANDIDATES_MAX + 16], *sensor = NULL, *below = name;
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const size_t length = strlen(imki_kind_names[kind]);
        if (strncmp(name, imki_kind_names[kind], length) == 0 && name[length] == '.') {
            sensor = imki_kind_names[kind];
            below = name + length + 1;
        }
    }
    const size_t count = find_candidates(sensor != NULL, candidates);
    const size_t nearest = imki_nearest_name(below, count, candidates);
    char expected[PATH_SIZE] = "a key, a term or a group of the model file";
    if (nearest != SIZE_MAX && sensor)
        join(expected, sensor, candidates[nearest], NULL);
    else if (nearest != SIZE_MAX)
        join(expected, candidates[nearest], NULL, NULL);
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "", name, expected);
}

/* ---- fields ---------------------------------------------------------------------------------- */

/* What is no error: it says what the outputs are. */
static bool is_no_error(const imki_field *field)
{
    return field->flags & IMKI_OUTPUT || field->shape == IMKI_PENDULOUS ||
           field->shape == IMKI_DENSITY;
}

static void clear(const imki_field *field, void *base)
{
    static const int none = 0;
    char *at = (char *)base + field->offset;
    switch (field->shape) {
    case IMKI_SCALAR:
        memset(at, 0, sizeof(imk_scalar));
        break;
    case IMKI_AXES:
        memset(at, 0, sizeof(imk_axes));
        break;
    case IMKI_QUADRATIC:
        memset(at, 0, sizeof(imk_quadratic_rows));
        break;
    case IMKI_POLYNOMIAL:
        memset(at, 0, sizeof(imk_temperature_polynomial));
        break;
    case IMKI_LIST:
        memset(at, 0, IMK_TERMS_MAX * imki_list_of(field).size);
        memcpy((char *)base + field->count_offset, &none, sizeof none);
        break;
    default:
        memset(at, 0, sizeof(imk_rows));
    }
}

/* Parameters without which another one means nothing are kept, and go, with it. */
static bool shares_term(const imki_field *a, const imki_field *b, bool keep)
{
    const size_t amplitude = offsetof(imk_triad, bias.warm_up_amplitude);
    const size_t time = offsetof(imk_triad, bias.warm_up_time);
    const size_t bandwidth = offsetof(imk_triad, bandwidth), damping = offsetof(imk_triad, damping);
    if (a->offset == b->offset) /* bias_instability and allan_floor too */
        return true;
    if (a->offset == amplitude || a->offset == time)
        return b->offset == amplitude || b->offset == time;
    /* A damping needs a bandwidth; the opposite is a filter of first order. */
    return keep ? a->offset == bandwidth && b->offset == damping
                : a->offset == damping && b->offset == bandwidth;
}

static bool is_named(const imki_field *field, int kind, bool keep, size_t count,
                     const char *const *names)
{
    for (size_t i = 0; i < imki_triad_field_count; i++)
        for (size_t j = 0; j < count && shares_term(field, &imki_triad_fields[i], keep); j++)
            if (names_field(names[j], &imki_triad_fields[i], kind))
                return true;
    return false;
}

imk_status imk_model_select(imk_model *model, bool keep, size_t count, const char *const *names,
                            imk_error *error)
{
    imk_triad *const triads[IMK_KINDS] = {&model->gyro, &model->accel, &model->mag};
    for (size_t j = 0; j < count; j++)
        if (!is_known(names[j]))
            return refuse_name(names[j], error);
    for (int kind = 0; kind < IMK_KINDS; kind++)
        for (size_t i = 0; i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            if (field->path[kind] && !is_no_error(field) &&
                is_named(field, kind, keep, count, names) != keep) {
                clear(field, triads[kind]);
                if (triads[kind]->present && imki_field_expected(field, kind))
                    triads[kind]->stated_zero |= imki_field_bit(field);
            }
        }
    for (size_t i = 0; i < imki_timing_field_count; i++) {
        bool named = false;
        for (size_t j = 0; j < count; j++)
            named = named || names_timing(names[j], &imki_timing_fields[i]);
        if (named != keep)
            clear(&imki_timing_fields[i], &model->timing);
    }
    return IMK_OK;
}
