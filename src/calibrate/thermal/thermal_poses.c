/* SPDX-License-Identifier: Apache-2.0 */
/* The thermal procedure with several poses, or a reference: each stretch at rest is cut where its
 * temperature moves by more than a bin; the observations have unknown attitudes, or the reference.
 * Bias and scale factor are told apart. */
#include "base/refuse_internal.h"
#include "calibrate/procedures/procedure_internal.h"
#include "thermal_internal.h"
#include "thermal_procedure_internal.h"

#include <math.h>
#include <string.h>

enum { INTERVALS_MAX = 1024, LEVELS_MAX = IMK_TEMPERATURE_ORDER_MAX + 1 };

/* Temperatures met: each at least a tenth of the range, or a kelvin, from the others. */
static int levels_of(size_t count, const imk_static_interval *interval, double range)
{
    double level[LEVELS_MAX];
    int levels = 0;
    for (size_t k = 0; k < count && levels < LEVELS_MAX; k++) {
        bool known = !isfinite(interval[k].temperature);
        for (int l = 0; l < levels; l++)
            known = known || fabs(interval[k].temperature - level[l]) < fmax(0.1 * range, 1.0);
        if (!known)
            level[levels++] = interval[k].temperature;
    }
    return levels;
}

static int order_of(int wanted, int usual, int levels)
{
    const int order = wanted > 0 ? wanted : usual;
    return order < levels ? order : levels - 1;
}

static imk_status free_poses(const imki_procedure_call *call, int levels, double reference,
                             double minimum, double maximum)
{
    imk_calibration *c = call->calibration;
    const imk_test_record *record = c->record[call->record];
    const bool has[2] = {record->reference_rate[0] != NULL, record->reference_force[0] != NULL};
    const int wanted = call->settings->scale_temperature_order;
    /* A scale factor changes with temperature almost in proportion. */
    const int bias = order_of(call->settings->temperature_order, 2, levels);
    const int scale = wanted == 0 ? 0 : order_of(wanted, 1, levels);
    imk_status status = IMK_OK;
    for (int sensor = 0; sensor < 2 && status == IMK_OK; sensor++) {
        imk_triad *triad = imk_model_triad_to_set(&c->model, sensor);
        const bool scaled = sensor == IMK_ACCEL || has[IMK_GYRO];
        if (record->axis_count[sensor] == 0)
            continue;
        imki_thermal_set_range(&triad->bias.temperature, bias, reference, minimum, maximum,
                               imki_thermal_is_free(c, sensor, IMK_MODEL_BIAS_TEMPERATURE));
        status = imki_free_term(call, sensor, IMK_MODEL_BIAS, 1, has[sensor]);
        if (status == IMK_OK)
            status = imki_free_term(call, sensor, IMK_MODEL_BIAS_TEMPERATURE, bias, has[sensor]);
        if (!scaled || status != IMK_OK)
            continue;
        imki_thermal_set_range(&triad->scale_factor.temperature, scale, reference, minimum, maximum,
                               imki_thermal_is_free(c, sensor, IMK_MODEL_SCALE_TEMPERATURE));
        status = imki_free_term(call, sensor, IMK_MODEL_SCALE_FACTOR, 1, has[sensor]);
        if (status == IMK_OK)
            status = imki_free_term(call, sensor, IMK_MODEL_MISALIGNMENT, 3, has[sensor]);
        if (status == IMK_OK)
            status = imki_free_term(call, sensor, IMK_MODEL_SCALE_TEMPERATURE, scale, has[sensor]);
    }
    return status;
}

static double mean_of(const double *x, size_t begin, size_t end)
{
    double sum = 0.0;
    for (size_t k = begin; k < end; k++)
        sum += x[k] - x[begin];
    return x[begin] + sum / (double)(end - begin);
}

/* Observe samples begin … end - 1. */
static imk_status observe_piece(const imki_procedure_call *call, size_t begin, size_t end)
{
    const imk_test_record *record = call->calibration->record[call->record];
    const imk_static_interval s = imk_static_summary(record, begin, end);
    imk_observation o = {.knowledge = record->reference_force[0] || record->reference_rate[0]
                                          ? IMK_INPUT_KNOWN
                                          : IMK_INPUT_GRAVITY,
                         .record = call->record,
                         .begin = begin,
                         .end = end,
                         .temperature = s.temperature,
                         .temperature_rate = s.temperature_rate,
                         .fixture = -1};
    for (int k = 0; k < 3; k++) {
        if (record->reference_rate[k])
            o.rate[k] = mean_of(record->reference_rate[k], begin, end);
        if (record->reference_force[k])
            o.force[k] = mean_of(record->reference_force[k], begin, end);
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const bool there = i < record->axis_count[sensor];
            /* With a reference of one kind only, the other sensor is not observed. */
            const bool told =
                o.knowledge == IMK_INPUT_GRAVITY ||
                (sensor == IMK_GYRO ? record->reference_rate : record->reference_force)[0];
            o.reading[sensor][i] = there && told ? s.mean[sensor][i] : (double)NAN;
            o.sigma[sensor][i] = there && s.sigma[sensor][i] > 0.0 ? s.sigma[sensor][i] : 1.0;
        }
    return imki_thermal_add(call, &o);
}

imk_status imki_thermal_observe_poses(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    const imk_test_record *record = c->record[call->record];
    imk_static_interval *interval = call->workspace;
    size_t count = 0;
    imk_status status =
        imk_static_detect(record, &call->settings->stationary, &c->model, interval, INTERVALS_MAX,
                          &count, NULL, &call->findings->stationary, interval + INTERVALS_MAX,
                          call->workspace_size - INTERVALS_MAX * sizeof *interval, call->error);
    if (status != IMK_OK)
        return status;
    count = count < INTERVALS_MAX ? count : INTERVALS_MAX;
    double low = (double)INFINITY, high = -(double)INFINITY;
    for (size_t k = 0; k < count; k++)
        if (isfinite(interval[k].temperature)) {
            low = fmin(low, interval[k].temperature);
            high = fmax(high, interval[k].temperature);
        }
    const int levels = levels_of(count, interval, high - low);
    if (levels < 2) {
        return imki_refuse(call->error, IMK_ERROR_TOO_SHORT, "temperature", levels, 2.0,
                           "add poses: at least two temperatures are needed");
    }
    const double usual = 298.15, set = call->settings->reference_temperature;
    const double reference = isfinite(set)                   ? set
                             : usual >= low && usual <= high ? usual
                                                             : 0.5 * (low + high);
    status = free_poses(call, levels, reference, low, high);
    /* The mean of a square over a piece differs from the square of the mean by bin^2/12: with 24
     * bins over the range a 7000th part of what it is at its end. */
    const double bin = call->settings->temperature_bin > 0.0 ? call->settings->temperature_bin
                                                             : (high - low) / 24.0;
    for (size_t k = 0; k < count && status == IMK_OK; k++) {
        const size_t length = interval[k].end - interval[k].begin;
        const double change = fabs(interval[k].temperature_rate) * (double)length * record->dt;
        size_t pieces = change > bin ? (size_t)ceil(change / bin) : 1;
        pieces = pieces < length / 2 + 1 ? pieces : length / 2 + 1;
        for (size_t p = 0; p < pieces && status == IMK_OK; p++)
            status = observe_piece(call, interval[k].begin + length * p / pieces,
                                   interval[k].begin + length * (p + 1) / pieces);
    }
    call->findings->intervals = count;
    return status;
}

size_t imki_thermal_poses_workspace(const imk_test_record *record,
                                    const imk_procedure_settings *settings)
{
    return INTERVALS_MAX * sizeof(imk_static_interval) +
           imk_static_workspace_size(record, &settings->stationary);
}
