/* SPDX-License-Identifier: Apache-2.0 */
/* Names of terms as numbers of the model, and what is estimated because it is named. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Highest power of a temperature polynomial, unless told. */
enum { USUAL_ORDER = 3 };

/* Numbers collected so far. */
typedef struct parameter_list {
    imk_model_parameter *parameter;
    size_t count, capacity;
} parameter_list;

static void collect(parameter_list *list, imk_model_parameter parameter)
{
    for (size_t k = 0; k < list->count; k++)
        if (memcmp(&list->parameter[k], &parameter, sizeof parameter) == 0)
            return;
    if (list->count < list->capacity)
        list->parameter[list->count] = parameter;
    list->count++;
}

/* ---- names ----------------------------------------------------------------------------------- */

bool imk_calibrate_term_path(int sensor, int term, char path[IMK_MODEL_PARAMETER_NAME])
{
    char name[IMK_MODEL_PARAMETER_NAME];
    const imk_model_parameter first = {(uint8_t)sensor, (uint8_t)term, 0, 0};
    if (imk_model_parameter_name(first, name) != IMK_OK)
        return false;
    const char *begin = strchr(name, '.') + 1;
    const char *axis = strstr(begin, ".x");
    snprintf(path, IMK_MODEL_PARAMETER_NAME, "%.*s", (int)(axis - begin), begin);
    return true;
}

/* "k2", "nonlinearity.k2", "nonlinearity" and for "bias.fixed" also "bias". */
static bool names_term(const char *item, const char *path)
{
    const size_t length = strlen(item), whole = strlen(path);
    const bool is_end = length < whole && path[whole - length - 1] == '.' &&
                        strcmp(path + whole - length, item) == 0;
    const bool is_beginning = strncmp(path, item, length) == 0 && path[length] == '.';
    if (strcmp(item, path) == 0 || is_end)
        return true;
    return is_beginning &&
           (strcmp(path + length, ".fixed") == 0 || strcmp(item, "nonlinearity") == 0);
}

/* The frame has this element of an accelerometer's misalignment. */
static bool frame_leaves(imk_triad_frame frame, int axis, int element)
{
    return frame == IMK_FRAME_UPPER ? element > axis : frame != IMK_FRAME_LOWER || element < axis;
}

static void collect_term(const imk_calibration *c, int order, int sensor, int term,
                         parameter_list *list)
{
    imk_model *model = (imk_model *)&c->model; /* asked for places only */
    const bool powers = term == IMK_MODEL_BIAS_TEMPERATURE || term == IMK_MODEL_SCALE_TEMPERATURE;
    const bool pairs = term == IMK_MODEL_MISALIGNMENT || term == IMK_MODEL_CROSS_AXIS;
    const int elements = !powers     ? imk_model_term_elements(sensor, term)
                         : order > 0 ? order
                                     : (int)USUAL_ORDER;
    for (int axis = 0; axis < imk_model_triad(model, sensor)->axis_count; axis++)
        for (int element = 0; element < elements; element++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, (uint8_t)axis,
                                           (uint8_t)element};
            if ((!pairs || sensor == 0 || frame_leaves(c->frame, axis, element)) &&
                imk_model_parameter_at(model, p, NULL))
                collect(list, p);
        }
}

/* The terms of one sensor that the name means. @return whether there is one */
static bool collect_named(const imk_calibration *c, int order, int sensor, const char *name,
                          parameter_list *list)
{
    static const char *const sensors[2] = {"gyro.", "accel."};
    bool found = false;
    const bool stated = strncmp(name, sensors[sensor], strlen(sensors[sensor])) == 0;
    const bool other = strncmp(name, sensors[1 - sensor], strlen(sensors[1 - sensor])) == 0;
    if (other || !imk_model_triad(&c->model, sensor)->present)
        return false;
    for (int term = 0; term < IMK_MODEL_TERMS; term++) {
        char path[IMK_MODEL_PARAMETER_NAME];
        if (!imk_calibrate_term_path(sensor, term, path) ||
            !names_term(stated ? name + strlen(sensors[sensor]) : name, path))
            continue;
        found = true;
        collect_term(c, order, sensor, term, list);
    }
    return found;
}

/* "k2, koq, " and so on. */
static void name_powers(char *text, size_t size)
{
    static const char group[] = "nonlinearity.";
    size_t length = 0;
    for (int term = 0; term < IMK_MODEL_TERMS && length < size; term++) {
        char path[IMK_MODEL_PARAMETER_NAME];
        if (imk_calibrate_term_path(0, term, path) && strncmp(path, group, sizeof group - 1) == 0)
            length +=
                (size_t)snprintf(text + length, size - length, "%s, ", path + sizeof group - 1);
    }
}

static imk_status refuse_name(const char *name, imk_error *error)
{
    char powers[128], expected[sizeof error->expected];
    name_powers(powers, sizeof powers);
    snprintf(expected, sizeof expected,
             "expected bias, scale_factor, misalignment, nonlinearity, %scross_products, "
             "g_sensitivity, g2_sensitivity, lever_arm, bias.temperature, "
             "scale_factor.temperature or temperature_rate, with gyro. or accel. before it for one "
             "sensor only, or a single number such as accel.bias.fixed.x",
             powers);
    return imk_error_set(error, IMK_ERROR_KEY_UNKNOWN, name, NULL, expected);
}

imk_status imk_calibrate_terms(const imk_calibration *calibration, int temperature_order,
                               const char *name, size_t capacity, imk_model_parameter *parameter,
                               size_t *count, imk_error *error)
{
    parameter_list list = {parameter, *count, capacity};
    imk_model_parameter single;
    bool found = false;
    if (imk_model_parameter_parse(name, &single) == IMK_OK && single.sensor != IMK_MAG) {
        if (!imk_model_parameter_at((imk_model *)&calibration->model, single, NULL))
            return imk_error_set(error, IMK_ERROR_RANGE, name, NULL, "there is no such axis");
        collect(&list, single);
        found = true;
    } else {
        for (int sensor = 0; sensor < 2; sensor++)
            if (collect_named(calibration, temperature_order, sensor, name, &list))
                found = true;
    }
    if (!found)
        return refuse_name(name, error);
    if (list.count > capacity)
        return imk_error_set(error, IMK_ERROR_WORKSPACE, name, NULL, NULL);
    *count = list.count;
    return IMK_OK;
}

/* ---- what is estimated ----------------------------------------------------------------------- */

/* What the records saw of the temperature; false when none did. */
static bool temperature_range(const imk_calibrate_log *b, double *low, double *high)
{
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (size_t k = 0; k < b->count; k++) {
        const imk_test_record *record = &b->record[k].record;
        for (size_t row = 0; record->temperature && row < record->count; row++) {
            const double now = record->temperature[row];
            *low = now < *low ? now : *low;
            *high = now > *high ? now : *high;
        }
    }
    return *low < *high;
}

/* Room in the model for a power of the temperature. */
static imk_status make_room(imk_calibrate_log *b, imk_model_parameter p, imk_error *error)
{
    const double usual = 298.15, told = b->settings.reference_temperature;
    imk_triad *triad = imk_model_triad_to_set(&b->calibration->model, p.sensor);
    imk_temperature_polynomial *polynomial = p.term == IMK_MODEL_BIAS_TEMPERATURE
                                                 ? &triad->bias.temperature
                                                 : &triad->scale_factor.temperature;
    if (p.term != IMK_MODEL_BIAS_TEMPERATURE && p.term != IMK_MODEL_SCALE_TEMPERATURE)
        return IMK_OK;
    double low, high;
    if (polynomial->order == 0) {
        if (!temperature_range(b, &low, &high))
            return imki_fail(&b->findings, error, IMK_ERROR_COLUMN, "no_change_of_temperature",
                             NULL, 0, NULL);
        polynomial->minimum = low;
        polynomial->maximum = high;
        polynomial->reference = !isnan(told)                    ? told
                                : low <= usual && usual <= high ? usual
                                                                : 0.5 * (low + high);
    }
    if (polynomial->order <= p.element)
        polynomial->order = p.element + 1;
    return IMK_OK;
}

imk_status imki_free_terms(imk_calibrate_log *b, imk_error *error)
{
    static const char between[] = ", ";
    imk_calibration *c = b->calibration;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    size_t count = 0;
    imk_status status = IMK_OK;
    const char *next = b->settings.estimate + strspn(b->settings.estimate, between);
    while (status == IMK_OK && *next) {
        char name[64];
        const size_t length = strcspn(next, between);
        snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1),
                 next);
        status = imk_calibrate_terms(c, b->settings.temperature_order, name, IMK_CORRELATED_MAX,
                                     parameter, &count, error);
        next += length;
        next += strspn(next, between);
    }
    if (status == IMK_OK && count == 0)
        status = imki_fail(&b->findings, error, IMK_ERROR_ARGUMENT, "no_term", NULL, 0, NULL);
    for (size_t k = 0; status == IMK_OK && k < count; k++) {
        status = make_room(b, parameter[k], error);
        if (status == IMK_OK)
            (void)imk_calibration_free(c, parameter[k].sensor, parameter[k].term, parameter[k].axis,
                                       parameter[k].element);
    }
    return status;
}
