/* SPDX-License-Identifier: Apache-2.0 */
/* What a source stands for, made so many times as large: numbers of the model, of the start, or of
 * an aid. Names of sources are paths of the model file (drift_sources.c). */
#include "drift_aided_internal.h"

#include "model/model_schema_internal.h"

#include <string.h>

enum { PATH = 80 };

static void scale_numbers(double *number, size_t count, double factor)
{
    for (size_t i = 0; i < count; i++)
        number[i] *= factor;
}

/* "noise.gauss_markov[1]" -> "noise.gauss_markov" and 1. @return -1: no index */
static int split(const char *name, char path[PATH])
{
    const size_t length = strcspn(name, "[");
    int index = -1;
    path[0] = '\0';
    if (length < PATH) {
        memcpy(path, name, length);
        path[length] = '\0';
    }
    if (name[length] == '[')
        index = name[length + 1] - '0';
    return index;
}

static const imki_field *find(const char *path, int sensor, const imki_field **list)
{
    static const char *const behind[] = {"", ".amplitude", ".sigma"};
    for (size_t i = 0; i < sizeof behind / sizeof behind[0]; i++) {
        char whole[PATH + 16];
        const size_t length = strlen(path);
        memcpy(whole, path, length);
        memcpy(whole + length, behind[i], strlen(behind[i]) + 1);
        const imki_field *field = imki_field_find(whole, sensor, list);
        if (field && field->shape != IMKI_LIST)
            return field;
    }
    return NULL;
}

/* @return false: the model has no such number */
static bool scale_triad(imk_triad *triad, int sensor, const char *name, bool compensated,
                        double factor)
{
    char path[PATH];
    const imki_field *list;
    const int index = split(name, path), known = IMKI_TERMS;
    const imki_field *field = find(path, sensor, &list);
    if (!field || (list && (index < 0 || index >= imki_list_count(list, triad))))
        return false;
    char *base = (char *)triad;
    if (list)
        base += list->offset + (size_t)index * imki_list_of(list).size;
    const int term = list ? -1 : imki_field_term(field);
    /* A delay is the inverse of a bandwidth, and a step that of counts per unit. */
    if (strcmp(path, "bandwidth") == 0 || strcmp(path, "sensitivity") == 0)
        factor = 1.0 / factor;
    if (field->shape == IMKI_POLYNOMIAL)
        return false;
    const bool sigma = compensated && term >= 0 && term < known;
    const double *from = sigma ? imki_field_sigmas(field, base) : imki_field_values(field, base);
    double *number = (double *)(void *)(base + ((const char *)from - base));
    scale_numbers(number,
                  (size_t)imki_field_rows(field, triad->axis_count) *
                      (size_t)imki_row_length(field->shape),
                  factor);
    return true;
}

static bool scale_timing(imk_timing *timing, const char *name, bool compensated, double factor)
{
    imk_scalar *scalar = strcmp(name, "rate_error") == 0 ? &timing->rate_error
                         : strcmp(name, "skew") == 0     ? &timing->skew
                         : strcmp(name, "jitter") == 0   ? &timing->jitter
                                                         : NULL;
    if (!scalar)
        return false;
    *(compensated && scalar != &timing->jitter ? &scalar->sigma : &scalar->value) *= factor;
    return true;
}

static bool scale_initial(imk_drift_settings *settings, const char *name, double factor)
{
    static const char *const names[3] = {"position", "velocity", "attitude"};
    for (int group = 0; group < 3; group++)
        if (strcmp(name, names[group]) == 0) {
            scale_numbers(settings->initial_sigma + (ptrdiff_t)3 * group, 3, factor);
            return true;
        }
    return false;
}

bool imk_drift_scale_source(const char *source, double factor, imk_model *model,
                            imk_drift_settings *settings, imk_aid *aids)
{
    if (strncmp(source, "gyro.", 5) == 0)
        return scale_triad(&model->gyro, IMK_GYRO, source + 5, settings->compensated, factor);
    if (strncmp(source, "accel.", 6) == 0)
        return scale_triad(&model->accel, IMK_ACCEL, source + 6, settings->compensated, factor);
    if (strncmp(source, "timing.", 7) == 0)
        return scale_timing(&model->timing, source + 7, settings->compensated, factor);
    if (strncmp(source, "initial.", 8) == 0)
        return scale_initial(settings, source + 8, factor);
    return strncmp(source, "aid.", 4) == 0 &&
           imki_aid_scale(source + 4, factor, settings->aid_count, aids);
}
