/* SPDX-License-Identifier: Apache-2.0 */
/* The runs behind a repeatability: holds of a log or whole calibrations, and the result in a model.
 */
#include "imukit/repeatability.h"

#include "model/model_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

imk_status imk_repeatability_runs(const imk_test_record *record, double trim, double settle,
                                  double minimum, size_t capacity, imk_static_interval *run,
                                  size_t *count, imk_error *error)
{
    if (!(trim >= 0.0) || !(settle >= 0.0) || !(minimum >= 0.0) || !(record->dt > 0.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "trim, settle, minimum", NULL,
                             "0 or more seconds, and a sample interval above 0");
    const double head = (trim + settle) / record->dt, tail = trim / record->dt;
    size_t found = 0;
    for (size_t k = 0; k < record->count;) {
        size_t end = record->section ? k + 1 : record->count;
        while (end < record->count && record->section[end] == record->section[k])
            end++;
        const bool labelled = !record->section || record->section[k] >= 0;
        const double samples = (double)(end - k) - head - tail;
        if (labelled && samples >= 2.0 && samples * record->dt >= minimum) {
            if (found < capacity)
                run[found] = imk_static_summary(record, k + (size_t)(head + 0.5),
                                                end - (size_t)(tail + 0.5));
            found++;
        }
        k = end;
    }
    if (found == 0)
        return imk_error_set(
            error, IMK_ERROR_TOO_SHORT, "hold", NULL,
            "a stretch at rest that is longer than settle, twice trim and minimum together");
    *count = found;
    return IMK_OK;
}

/* ---- holds -------------------------------------------------------------------------------------
 */

static double si(const imk_triad *triad, bool counts, int axis, double reading)
{
    return counts ? (reading - triad->zero_offset.value[axis]) / triad->sensitivity.value[axis]
                  : reading;
}

/* Largest angle between the forces of two runs. */
static double attitude_change(const imk_triad *accel, bool counts, size_t runs,
                              const imk_static_interval *run)
{
    double largest = 0.0;
    for (size_t a = 0; a < runs; a++)
        for (size_t b = 0; b < a; b++) {
            double aa = 0.0, bb = 0.0, ab = 0.0;
            for (int i = 0; i < accel->axis_count; i++) {
                const double x = si(accel, counts, i, run[a].mean[IMK_ACCEL][i]),
                             y = si(accel, counts, i, run[b].mean[IMK_ACCEL][i]);
                aa += x * x;
                bb += y * y;
                ab += x * y;
            }
            largest = fmax(largest, imk_atan2(sqrt(fmax(0.0, aa * bb - ab * ab)), ab));
        }
    return largest;
}

static imk_status holds_of_axis(const imk_triad *triad, int sensor, int axis, bool counts,
                                size_t runs, const imk_static_interval *run, double attitude_sigma,
                                double confidence, imk_repeatability *result, imk_error *error)
{
    double value[IMK_RUNS_MAX], sigma[IMK_RUNS_MAX];
    const double per_unit = counts ? fabs(triad->sensitivity.value[axis]) : 1.0;
    for (size_t k = 0; k < runs; k++) {
        double square = 0.0;
        for (int j = 0; sensor == IMK_ACCEL && j < triad->axis_count; j++) {
            const double f = si(triad, counts, j, run[k].mean[IMK_ACCEL][j]);
            square += j == axis ? 0.0 : f * f;
        }
        value[k] = si(triad, counts, axis, run[k].mean[sensor][axis]);
        sigma[k] = run[k].sigma[sensor][axis] / per_unit;
        sigma[k] = sqrt(sigma[k] * sigma[k] + attitude_sigma * attitude_sigma * square);
    }
    return imk_repeatability_estimate(runs, value, sigma, NULL, confidence, result, error);
}

imk_status imk_repeatability_of_holds(const imk_model *model, const bool counts[2], size_t runs,
                                      const imk_static_interval *run, double attitude_sigma,
                                      double confidence, imk_repeatability_result *result,
                                      imk_error *error)
{
    imk_repeatability_result found;
    if (runs > IMK_RUNS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "runs", NULL, "at most 1024 runs");
    if (!(attitude_sigma >= 0.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "attitude_sigma", NULL, "0 or more");
    memset(&found, 0, sizeof found);
    found.attitude = (double)NAN;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(model, sensor);
        found.axis_count[sensor] = triad->present ? triad->axis_count : 0;
        for (int i = 0; i < found.axis_count[sensor]; i++) {
            if (counts[sensor] && triad->sensitivity.value[i] == 0.0)
                return imk_error_set(error, IMK_ERROR_UNIT_MISSING,
                                     sensor == IMK_GYRO ? "gyro" : "accel", NULL,
                                     "a model with the sensitivity of readings in counts");
            const imk_status status =
                holds_of_axis(triad, sensor, i, counts[sensor], runs, run, attitude_sigma,
                              confidence, &found.bias[sensor][i], error);
            if (status != IMK_OK)
                return status;
        }
    }
    if (found.axis_count[IMK_ACCEL] == 3)
        found.attitude = attitude_change(&model->accel, counts[IMK_ACCEL], runs, run);
    *result = found;
    return IMK_OK;
}

/* ---- calibrations ------------------------------------------------------------------------------
 */

/* A parameter in every run. @return false: one does not state it */
static bool collect(size_t runs, const imk_calibration_result *const *run,
                    imk_model_parameter wanted, double *value, double *sigma, double *freedom)
{
    for (size_t k = 0; k < runs; k++) {
        size_t p = 0;
        while (p < run[k]->parameter_count &&
               memcmp(&run[k]->parameter[p], &wanted, sizeof wanted) != 0)
            p++;
        if (p == run[k]->parameter_count)
            return false;
        value[k] = run[k]->value[p];
        sigma[k] = run[k]->sigma[p];
        freedom[k] = run[k]->freedom[p];
    }
    return runs > 0;
}

imk_status imk_repeatability_of_calibrations(size_t runs, const imk_calibration_result *const *run,
                                             double confidence, imk_repeatability_result *result,
                                             imk_error *error)
{
    double value[IMK_RUNS_MAX], sigma[IMK_RUNS_MAX], freedom[IMK_RUNS_MAX];
    imk_repeatability_result found;
    if (runs > IMK_RUNS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "runs", NULL, "at most 1024 runs");
    memset(&found, 0, sizeof found);
    found.attitude = (double)NAN;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int term = IMK_MODEL_BIAS; term <= IMK_MODEL_SCALE_FACTOR; term++)
            for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
                const imk_model_parameter wanted = {(uint8_t)sensor, (uint8_t)term, (uint8_t)axis,
                                                    0};
                if (!collect(runs, run, wanted, value, sigma, freedom))
                    continue;
                imk_repeatability *to = term == IMK_MODEL_BIAS ? &found.bias[sensor][axis]
                                                               : &found.scale_factor[sensor][axis];
                found.axis_count[sensor] = axis + 1;
                const imk_status status =
                    imk_repeatability_estimate(runs, value, sigma, freedom, confidence, to, error);
                if (status != IMK_OK)
                    return status;
            }
    *result = found;
    return IMK_OK;
}

/* ---- into a model ------------------------------------------------------------------------------
 */

static void store(const imk_repeatability *from, int axes, imk_axes *to, imk_evidence *evidence,
                  const char *key)
{
    bool any = false;
    for (int i = 0; i < axes; i++)
        any = any || from[i].runs > 0;
    imk_interval *interval = any ? imki_evidence_interval(evidence, key, 0) : NULL;
    for (int i = 0; i < axes; i++) {
        if (from[i].runs == 0)
            continue;
        to->value[i] = from[i].value;
        to->sigma[i] = from[i].sigma;
        if (interval) {
            interval->lower.value[i] = from[i].lower;
            interval->upper.value[i] = from[i].upper;
        }
    }
}

void imk_repeatability_to_model(const imk_repeatability_result *result, imk_model *model)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_triad *triad = imk_model_triad_to_set(model, sensor);
        imk_evidence *evidence =
            sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
        const int axes = result->axis_count[sensor];
        store(result->bias[sensor], axes, &triad->bias.repeatability, evidence,
              "bias.repeatability");
        store(result->scale_factor[sensor], axes, &triad->scale_factor.repeatability, evidence,
              "scale_factor.repeatability");
    }
}
