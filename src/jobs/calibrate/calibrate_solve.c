/* SPDX-License-Identifier: Apache-2.0 */
/* The one estimate of all observations together; of tables that do not say how well their means are
 * known, with the scatter of the residuals as their sigma.
 *
 * The variance of such a reading is s^2, all alike, and perhaps what no factor multiplies, the
 * Earth's rate at an unknown heading. With F the factor of the group the next s is F s, until F is
 * about 1. F is estimated, so that intervals are Student's. Where the Earth's rate covers s, chance
 * may leave nothing for s: of the scatter of all residuals, 2/sqrt(degrees of freedom) is taken for
 * noise at least. Where the estimator finds no factor, the scatter less the Earth's part is. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>

/* F in the end. Sigmas that are all alike do not tell an added sigma from a factor, and the
 * estimator looks for an added one above 0.9 only. */
static const double aimed_at = 0.85;
/* F^2 is about 1. */
static const double agreed = 0.03;
/* Least s over the first one, which is 1e-4 of gravity: means without noise, made by a formula,
 * have none to be found. */
static const double least_square = 1e-4;
/* Fewer degrees of freedom give no factor, as in the estimator. */
static const double least_freedom = 3;

/* Sensitivities that were found are names for what the parameters are relative to: short ones do
 * as well. */
static void shorten_nominal(imk_calibrate_log *b)
{
    imk_triad *triad[2] = {&b->calibration->model.gyro, &b->calibration->model.accel};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; b->nominal[sensor] && i < triad[sensor]->axis_count; i++) {
            double *s = &triad[sensor]->sensitivity.value[i];
            double *zero = &triad[sensor]->zero_offset.value[i];
            if (*s == 0 || !isfinite(*s))
                continue;
            const double step = pow(10, floor(log10(fabs(*s))) - 3);
            *s = step < 1 ? floor(*s / step + 0.5) / (1 / step) : floor(*s / step + 0.5) * step;
            *zero = floor(*zero + 0.5);
        }
}

/* ---- tables without sigmas ------------------------------------------------------------------- */

static const imk_group_fit *fit_of(const imk_calibrate_log *b, int sensor)
{
    return &b->result->group[sensor == 0 ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL];
}

/* The first table that does not say how well its means of a sensor are known, b->count: none; are
 * there others that observe the sensor? */
static size_t find_table(const imk_calibrate_log *b, int sensor, bool *others)
{
    size_t first = b->count;
    *others = false;
    for (size_t k = b->count; k-- > 0;) {
        const imk_procedure_findings *f = &b->record[k].findings;
        const imk_observation *o = b->calibration->observation + f->first_observation;
        bool observed = false;
        for (size_t i = 0; i < f->observations && !observed; i++)
            observed = isfinite(o[i].reading[sensor][0]);
        if (observed && b->record[k].no_sigma[sensor])
            first = k;
        else
            *others = *others || observed;
    }
    return first;
}

/* Is the scatter of the residuals to be seen? */
static imk_status check_scatter(imk_calibrate_log *b, int sensor, size_t first, bool others,
                                imk_error *error)
{
    const imk_group_fit *fit = fit_of(b, sensor);
    char words[64];
    snprintf(words, sizeof words, "%s\t%s", imki_sensor_titles[sensor], imki_sensor_keys[sensor]);
    if (!others && fit->degrees_of_freedom >= least_freedom)
        return IMK_OK;
    b->failed = first;
    if (others)
        return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "means_mixed", words, 0, NULL);
    return imki_fail(&b->findings, error, IMK_ERROR_TOO_SHORT, "means_noise", words,
                     IMKI_NUMBERS((double)fit->count, fit->degrees_of_freedom, least_freedom));
}

/* Over the readings of a sensor. */
typedef struct scatter {
    double residual;     /* sum of (residual/s)^2 */
    double earth, count; /* sum of the Earth's variance/s^2 as far as residuals show it, readings */
} scatter;

static scatter sum_scatter(const imk_calibrate_log *b, int sensor)
{
    const imk_calibration *c = b->calibration;
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    scatter sum = {0, 0, 0};
    for (size_t i = 0; i < c->observation_count; i++)
        for (int axis = 0; axis < triad->axis_count; axis++) {
            const imk_observation *o = &c->observation[i];
            const imk_test_record *record = c->record[o->record];
            const double unit = record->counts[sensor] ? triad->sensitivity.value[axis] : 1;
            if (!record->means || !isfinite(o->residual[sensor][axis]) || !(o->weight > 0))
                continue;
            const double s = record->mean_sigma[sensor][axis][o->begin];
            const double residual = unit * o->residual[sensor][axis] / s;
            sum.residual += residual * residual;
            sum.count += 1;
            if (sensor == 0 && !o->heading_depends)
                sum.earth += unit * unit * o->heading_variance[axis] / (s * s);
        }
    return sum;
}

/* Multiply s by a factor, given as its square. */
static void scale_sigmas(imk_calibrate_log *b, int sensor, double square)
{
    imk_calibration *c = b->calibration;
    for (size_t i = 0; i < c->observation_count; i++) {
        imk_observation *o = &c->observation[i];
        const imk_test_record *record = c->record[o->record];
        for (int axis = 0; axis < record->axis_count[sensor] && record->means; axis++)
            o->sigma[sensor][axis] *= sqrt(square);
    }
    for (imk_calibrate_record *log = b->record; log < b->record + b->count; log++) {
        size_t first = sensor == 0 ? 0 : (size_t)log->record.axis_count[0] * log->record.count;
        for (size_t k = 0; k < (size_t)log->record.axis_count[sensor] * log->record.count; k++)
            if (log->mean_sigma)
                log->mean_sigma[first + k] *= sqrt(square);
    }
}

/* A factor was estimated, by which intervals are Student's. */
static bool has_factor(const imk_calibration_result *r, int sensor)
{
    for (size_t p = 0; p < r->parameter_count; p++)
        if (r->parameter[p].sensor == sensor && r->freedom[p] < HUGE_VAL)
            return true;
    return false;
}

/* The next s of a sensor, whose square is `now` times that of the first.
 * @return whether to solve again */
static bool take_scatter(imk_calibrate_log *b, int sensor, int round, double *now)
{
    const imk_group_fit *fit = fit_of(b, sensor);
    const double factor = fit->factor / aimed_at;
    const scatter sum = sum_scatter(b, sensor);
    const double whole = sum.residual / fit->degrees_of_freedom;
    double square = whole - sum.earth / sum.count;
    if (has_factor(b->result, sensor))
        square = factor * factor;
    else if (round > 0)
        return false;
    square = fmax(square, fmin(1, 2 / sqrt(fit->degrees_of_freedom)) * whole);
    square = fmax(square, least_square / *now);
    if (fabs(square - 1) < agreed)
        return false;
    *now *= square;
    scale_sigmas(b, sensor, square);
    return true;
}

imk_status imki_solve(imk_calibrate_log *b, imk_error *error)
{
    enum { ROUNDS = 8 };
    bool again = true;
    double now[2] = {1, 1};
    imk_status status = IMK_OK;
    shorten_nominal(b);
    for (int round = 0; status == IMK_OK && again; round++) {
        status = imki_solve_once(b, error);
        again = false;
        for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++) {
            bool others;
            const size_t first = find_table(b, sensor, &others);
            if (first == b->count)
                continue;
            status = check_scatter(b, sensor, first, others, error);
            if (status == IMK_OK && round < ROUNDS && take_scatter(b, sensor, round, &now[sensor]))
                again = true;
        }
    }
    return status;
}
