/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms are estimated: --estimate names them; --with and --without change what a procedure
 * looks for of itself. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

/* The next item of a list separated by commas or blanks; false at its end. */
static bool next_item(const char **list, char *item, size_t size)
{
    *list += strspn(*list, ", ");
    const size_t length = strcspn(*list, ", ");
    snprintf(item, size, "%.*s", (int)(length < size ? length : size - 1), *list);
    *list += length;
    return length > 0;
}

/* ---- --with, --without ----------------------------------------------------------------------- */

static const char *const switches[] = {"nonlinearity", "cross_products", "g_sensitivity",
                                       "g2_sensitivity", "gyro"};
enum { SWITCHES = sizeof switches / sizeof switches[0] };

static int switch_items(const char *option_name, const char *list, bool on,
                        imk_procedure_settings *s)
{
    bool *const target[SWITCHES] = {&s->nonlinear, &s->cross_products, &s->g_sensitivity,
                                    &s->g2_sensitivity, &s->gyro_turns};
    char item[48];
    while (next_item(&list, item, sizeof item)) {
        int which = 0;
        while (which < SWITCHES && strcmp(switches[which], item) != 0)
            which++;
        if (which == SWITCHES) {
            const char *nearest = command_nearest(item, SWITCHES, switches);
            return command_misused("--%s %s: expected nonlinearity, cross_products, g_sensitivity, "
                                   "g2_sensitivity or gyro%s%s%s",
                                   option_name, item, nearest ? "; did you mean " : "",
                                   nearest ? nearest : "", nearest ? "?" : "");
        }
        *target[which] = on;
    }
    return -1;
}

int session_switch_terms(const calibrate_options *o, imk_procedure procedure,
                         imk_procedure_settings *settings)
{
    (void)procedure;
    if (o->estimate && (o->with || o->without))
        return command_misused("--estimate names all that is estimated: leave --with and --without "
                               "out");
    int code = o->with ? switch_items("with", o->with, true, settings) : -1;
    return code < 0 && o->without ? switch_items("without", o->without, false, settings) : code;
}

/* ---- --estimate ------------------------------------------------------------------------------ */

/* "gyro.nonlinearity.k2" without the sensor and the axis: "nonlinearity.k2". */
static bool term_path(int sensor, int term, char *path, size_t size)
{
    char name[IMK_MODEL_PARAMETER_NAME];
    const imk_model_parameter first = {(uint8_t)sensor, (uint8_t)term, 0, 0};
    if (imk_model_parameter_name(first, name) != IMK_OK)
        return false;
    const char *begin = strchr(name, '.') + 1;
    const char *axis = strstr(begin, ".x");
    snprintf(path, size, "%.*s", (int)(axis - begin), begin);
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

static bool frame_leaves(const session *b, int axis, int element)
{
    switch (b->found->calibration->frame) {
    case IMK_FRAME_UPPER:
        return element > axis;
    case IMK_FRAME_LOWER:
        return element < axis;
    default:
        return true;
    }
}

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

/* All numbers of a term; polynomials as high as --temperature-order, or 3. */
static void collect_term(const session *b, int sensor, int term, parameter_list *list)
{
    imk_model *model = &b->found->calibration->model;
    const imk_triad *triad = imk_model_triad(model, sensor);
    const bool powers = term == IMK_MODEL_BIAS_TEMPERATURE || term == IMK_MODEL_SCALE_TEMPERATURE;
    const bool pairs = term == IMK_MODEL_MISALIGNMENT || term == IMK_MODEL_CROSS_AXIS;
    const option_integer order = b->options->temperature_order;
    const int elements =
        powers ? (order.given ? (int)order.value : 3) : imk_model_term_elements(sensor, term);
    for (int axis = 0; axis < triad->axis_count; axis++)
        for (int element = 0; element < elements; element++) {
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, (uint8_t)axis,
                                           (uint8_t)element};
            if ((!pairs || sensor == 0 || frame_leaves(b, axis, element)) &&
                imk_model_parameter_at(model, p, NULL))
                collect(list, p);
        }
}

/* "k2, koq, " and so on. */
static void name_powers(char *text, size_t size)
{
    static const char group[] = "nonlinearity.";
    size_t length = 0;
    for (int term = 0; term < IMK_MODEL_TERMS && length < size; term++) {
        char path[IMK_MODEL_PARAMETER_NAME];
        if (term_path(0, term, path, sizeof path) && strncmp(path, group, sizeof group - 1) == 0)
            length +=
                (size_t)snprintf(text + length, size - length, "%s, ", path + sizeof group - 1);
    }
}

static int collect_item(const session *b, const char *option_name, const char *item,
                        parameter_list *list)
{
    static const char *const sensors[2] = {"gyro.", "accel."};
    imk_model_parameter single;
    if (imk_model_parameter_parse(item, &single) == IMK_OK) {
        if (!imk_model_parameter_at(&b->found->calibration->model, single, NULL))
            return command_misused("--%s %s: there is no such axis", option_name, item);
        collect(list, single);
        return -1;
    }
    bool found = false;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(&b->found->calibration->model, sensor);
        const size_t length = strlen(sensors[sensor]);
        const bool stated = strncmp(item, sensors[sensor], length) == 0;
        const bool other = strncmp(item, sensors[1 - sensor], strlen(sensors[1 - sensor])) == 0;
        for (int term = 0; term < IMK_MODEL_TERMS && triad->present && !other; term++) {
            char path[IMK_MODEL_PARAMETER_NAME];
            if (!term_path(sensor, term, path, sizeof path) ||
                !names_term(stated ? item + length : item, path))
                continue;
            found = true;
            collect_term(b, sensor, term, list);
        }
    }
    if (found)
        return -1;
    char powers[128];
    name_powers(powers, sizeof powers);
    return command_misused("--%s %s: no such term; expected bias, scale_factor, misalignment, "
                           "nonlinearity, %scross_products, g_sensitivity, g2_sensitivity, "
                           "lever_arm, bias.temperature, scale_factor.temperature or "
                           "temperature_rate, with gyro. or accel. before it for one sensor only, "
                           "or a single number such as accel.bias.fixed.x",
                           option_name, item, powers);
}

int session_list_terms(const session *b, const char *option_name, const char *item, size_t capacity,
                       imk_model_parameter *parameter, size_t *count)
{
    parameter_list list = {parameter, *count, capacity};
    const int code = collect_item(b, option_name, item, &list);
    if (code < 0 && list.count > capacity)
        return command_misused("--%s: these are more than %zu numbers", option_name, capacity);
    *count = list.count;
    return code;
}

/* What the logs saw of the temperature; false when none did. */
static bool temperature_range(const session *b, double *low, double *high)
{
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (size_t k = 0; k < b->found->count; k++)
        for (size_t row = 0;
             b->found->record[k].record.temperature && row < b->found->record[k].record.count;
             row++) {
            const double now = b->found->record[k].record.temperature[row];
            *low = now < *low ? now : *low;
            *high = now > *high ? now : *high;
        }
    return *low < *high;
}

/* Room in the model for a power of the temperature. */
static int make_room(session *b, imk_model_parameter p)
{
    imk_model *model = &b->found->calibration->model;
    imk_triad *triad = imk_model_triad_to_set(model, p.sensor);
    imk_temperature_polynomial *polynomial = p.term == IMK_MODEL_BIAS_TEMPERATURE
                                                 ? &triad->bias.temperature
                                                 : &triad->scale_factor.temperature;
    if (p.term != IMK_MODEL_BIAS_TEMPERATURE && p.term != IMK_MODEL_SCALE_TEMPERATURE)
        return -1;
    double low, high;
    if (polynomial->order == 0) {
        const double usual = 298.15;
        if (!temperature_range(b, &low, &high))
            return command_failed("no log has a column temperature [degC] that changes, so that "
                                  "nothing over temperature can be estimated");
        polynomial->minimum = low;
        polynomial->maximum = high;
        polynomial->reference = !isnan(b->options->reference_temperature)
                                    ? b->options->reference_temperature
                                : low <= usual && usual <= high ? usual
                                                                : 0.5 * (low + high);
    }
    if (polynomial->order <= p.element)
        polynomial->order = p.element + 1;
    return -1;
}

int session_free_terms(session *b)
{
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    const char *names = b->options->estimate;
    size_t count = 0;
    char item[64];
    int code = -1;
    while (code < 0 && next_item(&names, item, sizeof item))
        code = session_list_terms(b, "estimate", item, IMK_CORRELATED_MAX, parameter, &count);
    if (code < 0 && count == 0)
        code = command_misused("--estimate: no term is named");
    for (size_t k = 0; code < 0 && k < count; k++) {
        code = make_room(b, parameter[k]);
        (void)imk_calibration_free(b->found->calibration, parameter[k].sensor, parameter[k].term,
                                   parameter[k].axis, parameter[k].element);
    }
    return code;
}
