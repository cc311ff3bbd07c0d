/* SPDX-License-Identifier: Apache-2.0 */
/* Thermal analysis: the order of decisions.
 *
 * 1. The log becomes block means (thermal_blocks.c), the make-up of their noise is weighed with the
 *    fullest fit (thermal_noise.c), so that no later decision changes it.
 * 2. What makes warming and cooling differ: the more likely of hysteresis and rate first, when its
 *    estimate is significant, then the other if it is so beside it.
 * 3. The order, by cross-validation with that cause: the lowest whose error exceeds that of the
 *    best order by no more than one sigma of the difference, fold by fold [HASTIE2009, 7.10].
 * 4. The fit, and what is left without the cause. */
#include "imukit/thermal.h"

#include "base/workspace_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "thermal_internal.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { COOKIE = 0x494D4B52, N = IMKI_THERMAL_COLUMNS };

/* Share of the range that must be crossed both ways for a loop to be seen apart from the
 * polynomial. */
static const double least_overlap = 0.2;

imk_thermal_settings imk_thermal_default(void)
{
    return (imk_thermal_settings){.cookie = COOKIE,
                                  .order = -1,
                                  .order_max = IMK_TEMPERATURE_ORDER_MAX,
                                  .reference_temperature = (double)NAN,
                                  .significance = 1e-3};
}

const char *imk_thermal_cause_name(imk_thermal_cause cause)
{
    static const char *const names[IMK_THERMAL_CAUSES] = {"none", "temperature rate", "hysteresis",
                                                          "hysteresis and temperature rate"};
    return (unsigned)cause < IMK_THERMAL_CAUSES ? names[cause] : NULL;
}

size_t imk_thermal_workspace_size(void)
{
    return sizeof(imki_thermal_work) + IMKI_ALIGNMENT_SLACK;
}

imki_thermal_work *imki_thermal_work_of(void *workspace)
{
    return (void *)imki_align(workspace);
}

static unsigned columns_of(imk_thermal_cause cause)
{
    return (cause == IMK_THERMAL_RATE || cause == IMK_THERMAL_BOTH ? 1u << IMKI_THERMAL_RATE : 0u) |
           (cause == IMK_THERMAL_HYSTERESIS || cause == IMK_THERMAL_BOTH ? 1u << IMKI_THERMAL_STATE
                                                                         : 0u);
}

unsigned imki_thermal_columns(const imk_thermal_axis *axis)
{
    return imki_thermal_powers(axis->order) | columns_of(axis->cause);
}

/* ---- cause ----------------------------------------------------------------------------------- */

/* ln of the likelihood over that of no cause, at the noise's most likely point. */
static double likelihood_over(const imki_thermal_work *work, int axis, unsigned powers,
                              unsigned also)
{
    const int point = work->best[axis];
    const double none = imki_thermal_weighted_rss(work, axis, powers, point, NULL);
    const double with = imki_thermal_weighted_rss(work, axis, powers | also, point, NULL);
    return none > 0.0 && with > 0.0 ? 0.5 * (double)work->blocks.count * imk_ln(none / with) : 0.0;
}

static void find_cause(const imki_thermal_work *work, int axis,
                       const imk_thermal_settings *settings, imk_thermal_axis *out)
{
    const unsigned powers = imki_thermal_powers(settings->order_max);
    const double limit = settings->significance;
    imki_thermal_estimate e;
    out->cause = IMK_THERMAL_NONE;
    for (int c = 0; c < IMK_THERMAL_CAUSES; c++)
        out->likelihood[c] = likelihood_over(work, axis, powers, columns_of(c));
    const bool hysteresis =
        out->likelihood[IMK_THERMAL_HYSTERESIS] >= out->likelihood[IMK_THERMAL_RATE];
    const imk_thermal_cause first = hysteresis ? IMK_THERMAL_HYSTERESIS : IMK_THERMAL_RATE;
    const int column = hysteresis ? IMKI_THERMAL_STATE : IMKI_THERMAL_RATE;
    const int other = hysteresis ? IMKI_THERMAL_RATE : IMKI_THERMAL_STATE;
    if (!imki_thermal_fit(work, axis, powers | columns_of(first), &e) || e.chance[column] > limit)
        return;
    out->cause = first;
    if (imki_thermal_fit(work, axis, powers | columns_of(IMK_THERMAL_BOTH), &e) &&
        e.chance[other] <= limit && e.chance[column] <= limit)
        out->cause = IMK_THERMAL_BOTH;
}

/* ---- order ----------------------------------------------------------------------------------- */

/* What the error of an order is above the best one's, in sigmas of the difference over the folds.
 */
static double excess_of(const double *error, const double *best)
{
    double mean = 0.0, square = 0.0;
    for (int f = 0; f < IMKI_THERMAL_FOLDS; f++)
        mean += (error[f] - best[f]) / IMKI_THERMAL_FOLDS;
    if (!isfinite(mean))
        return (double)INFINITY;
    for (int f = 0; f < IMKI_THERMAL_FOLDS; f++) {
        const double d = error[f] - best[f] - mean;
        square += d * d;
    }
    const double sigma = sqrt(square / (IMKI_THERMAL_FOLDS * (IMKI_THERMAL_FOLDS - 1.0)));
    return mean <= 0.0 ? 0.0 : mean / sigma;
}

/* The folds are few, and noise correlated over many of them can look like a curve: the highest
 * coefficient must also be significant by the noise's own measure. */
static int significant_order(const imki_thermal_work *work, int axis,
                             const imk_thermal_settings *settings, const imk_thermal_axis *out)
{
    int order = out->order;
    imki_thermal_estimate e;
    while (order > 0 && (!imki_thermal_fit(
                             work, axis, imki_thermal_powers(order) | columns_of(out->cause), &e) ||
                         e.chance[order] > settings->significance))
        order--;
    return order;
}

static void find_order(const imki_thermal_work *work, int axis,
                       const imk_thermal_settings *settings, imk_thermal_axis *out)
{
    double error[IMK_TEMPERATURE_ORDER_MAX + 1][IMKI_THERMAL_FOLDS], least = (double)INFINITY;
    for (int k = 0; k <= IMK_TEMPERATURE_ORDER_MAX; k++) {
        out->score[k] = out->excess[k] = (double)NAN;
        if (k > settings->order_max || (k > 0 && !(work->available >> k & 1u)))
            continue;
        imki_thermal_validate(work, axis, imki_thermal_powers(k) | columns_of(out->cause),
                              error[k]);
        double mean = 0.0;
        for (int f = 0; f < IMKI_THERMAL_FOLDS; f++)
            mean += error[k][f] / IMKI_THERMAL_FOLDS;
        out->score[k] = sqrt(mean);
        if (mean < least) {
            least = mean;
            out->order_best = k;
        }
    }
    out->order = out->order_best;
    for (int k = IMK_TEMPERATURE_ORDER_MAX; k >= 0; k--)
        if (out->score[k] == out->score[k]) {
            out->excess[k] = excess_of(error[k], error[out->order_best]);
            if (out->excess[k] <= 1.0 && k < out->order_best)
                out->order = k;
        }
    out->order = significant_order(work, axis, settings, out);
    out->order_given = settings->order >= 0;
    if (out->order_given)
        out->order = settings->order;
}

/* ---- results --------------------------------------------------------------------------------- */

static imk_scalar scalar_of(const imki_thermal_estimate *e, int column, double factor)
{
    return (imk_scalar){factor * e->value[column],
                        factor * sqrt(fmax(0.0, e->covariance[column * N + column]))};
}

/* Hysteresis and rate, also where the cause does not contain them: what is found beside it. */
static void report_causes(const imki_thermal_work *work, int axis, imk_thermal_axis *out)
{
    const unsigned columns = imki_thermal_columns(out);
    imki_thermal_estimate e;
    if (imki_thermal_fit(work, axis, columns | 1u << IMKI_THERMAL_STATE, &e))
        out->hysteresis = scalar_of(&e, IMKI_THERMAL_STATE, 2.0);
    if (imki_thermal_fit(work, axis, columns | 1u << IMKI_THERMAL_RATE, &e))
        out->temperature_rate = scalar_of(&e, IMKI_THERMAL_RATE, 1.0 / work->blocks.rate_scale);
}

static void report_noise(const imki_thermal_work *work, int axis, imk_thermal_axis *out)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    const double length = blocks->end[blocks->count - 1] - blocks->begin[0];
    const imki_thermal_variance *v = &work->variance[axis];
    out->white = sqrt(v->white * blocks->per_block);
    out->flicker = sqrt(v->flicker * PI);
    out->random_walk = sqrt(v->walk / length);
}

/* Value between the middles of blocks, straight. */
static double between(const imki_thermal_blocks *blocks, const double *value, double time,
                      size_t *near)
{
    size_t b = *near;
    while (b + 2 < blocks->count && 0.5 * (blocks->begin[b + 1] + blocks->end[b + 1]) < time)
        b++;
    *near = b;
    const double from = 0.5 * (blocks->begin[b] + blocks->end[b]);
    const double to = 0.5 * (blocks->begin[b + 1] + blocks->end[b + 1]);
    const double share = fmin(1.0, fmax(0.0, (time - from) / (to - from)));
    return value[b] + share * (value[b + 1] - value[b]);
}

static double rms_about(const imk_test_record *record, const imk_model *model,
                        const imki_thermal_blocks *blocks, int axis,
                        const imki_thermal_estimate *fit)
{
    double square = 0.0, count = 0.0;
    size_t near = 0;
    for (size_t k = 0; k < record->count; k++) {
        const double z = (record->temperature[k] - blocks->reference) / blocks->scale;
        double y = imki_thermal_reading(record, model, axis / IMK_AXES_MAX, axis % IMK_AXES_MAX, k);
        if (!isfinite(y) || !isfinite(z))
            continue;
        const double time = imki_thermal_time(record, k) - 0.5 * record->dt;
        y -= blocks->mean[axis];
        double power = 1.0;
        for (int i = 0; i <= IMK_TEMPERATURE_ORDER_MAX; i++, power *= z)
            y -= fit->value[i] * power;
        for (int c = IMKI_THERMAL_RATE; c < N; c++)
            if (fit->value[c] != 0.0)
                y -= fit->value[c] * between(blocks, blocks->column[c], time, &near);
        square += y * y;
        count += 1.0;
    }
    return sqrt(square / count);
}

static void analyse_axis(const imk_test_record *record, const imk_model *model,
                         const imk_thermal_settings *settings, imki_thermal_work *work, int axis,
                         const imk_thermal_findings *findings, imk_thermal_axis *out)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    imki_thermal_estimate fit, single;
    find_cause(work, axis, settings, out);
    find_order(work, axis, settings, out);
    double power = 1.0;
    if (!imki_thermal_fit(work, axis, imki_thermal_columns(out), &fit))
        memset(&fit, 0, sizeof fit);
    out->constant = scalar_of(&fit, 0, 1.0);
    out->constant.value += blocks->mean[axis];
    out->freedom = work->variance[axis].freedom;
    for (int i = 0; i < out->order; i++) {
        power /= blocks->scale;
        out->coefficient[i] = scalar_of(&fit, i + 1, power);
    }
    out->rms = rms_about(record, model, blocks, axis, &fit);
    if (imki_thermal_fit(work, axis, imki_thermal_powers(out->order), &single))
        out->rms_polynomial = rms_about(record, model, blocks, axis, &single);
    fit.value[IMKI_THERMAL_STATE] = 0.0;
    out->rms_compensated = rms_about(record, model, blocks, axis, &fit);
    out->refused = blocks->refused[axis];
    out->scatter = blocks->scatter[axis];
    report_causes(work, axis, out);
    report_noise(work, axis, out);
    const double level = settings->significance / (double)(findings->gap_count + 1);
    const double chance = imki_thermal_gaps(work, axis, findings, out);
    out->single_valued = out->cause == IMK_THERMAL_NONE && !(chance < level);
    if (findings->both_directions) {
        imki_thermal_lag(work, axis, settings->order_max, out);
        const double least = 0.5 * imk_chi_square_quantile(1.0 - settings->significance, 1.0);
        out->lag_likelier = out->lag_likelihood > least &&
                            out->lag_likelihood > out->likelihood[out->cause] &&
                            out->cause != IMK_THERMAL_NONE;
    }
}

/* Whole degrees Celsius: every 1, 5 or 25, as many as there is room for. */
static void choose_gaps(imk_thermal_findings *findings)
{
    const double zero_celsius = 273.15;
    const double low = findings->minimum - zero_celsius, high = findings->maximum - zero_celsius;
    double step = 1.0;
    while ((high - low) / step > IMK_THERMAL_GAPS_MAX)
        step *= 5.0;
    findings->gap_count = 0;
    for (double t = ceil(low / step) * step;
         t <= high && findings->gap_count < IMK_THERMAL_GAPS_MAX; t += step)
        findings->gap_temperature[findings->gap_count++] = t + zero_celsius;
}

/* Share of the range that both warming and cooling crossed, by fifty temperatures. */
static double overlap_of(const imki_thermal_blocks *blocks)
{
    enum { STEPS = 50 };
    int both = 0;
    for (int i = 0; i < STEPS; i++) {
        const double t =
            blocks->minimum + (blocks->maximum - blocks->minimum) * ((double)i + 0.5) / STEPS;
        bool crossed[2] = {false, false};
        for (size_t b = 0; b + 1 < blocks->count; b++) {
            const double from = blocks->temperature[b], to = blocks->temperature[b + 1];
            if (blocks->direction[b] != 0 && blocks->pass[b] == blocks->pass[b + 1] &&
                (t - from) * (to - t) >= 0.0)
                crossed[blocks->direction[b] > 0] = true;
        }
        both += crossed[0] && crossed[1];
    }
    return (double)both / STEPS;
}

static void describe(const imk_test_record *record, const imk_model *model,
                     imki_thermal_blocks *blocks, imk_thermal_findings *findings)
{
    const size_t n = blocks->count;
    findings->reference = blocks->reference;
    findings->minimum = blocks->minimum;
    findings->maximum = blocks->maximum;
    findings->duration = blocks->end[n - 1] - blocks->begin[0];
    findings->samples = blocks->samples;
    findings->left_out = blocks->left_out;
    findings->blocks = n;
    for (size_t b = 0; b < n; b++) {
        findings->mean += blocks->temperature[b] * blocks->size[b] / (double)blocks->samples;
        findings->fastest = fmax(findings->fastest, fabs(blocks->rate[b]));
    }
    for (int k = 0; k < 3; k++)
        findings->force[k] =
            record->axis_count[IMK_ACCEL] == 3 ? blocks->mean[IMK_AXES_MAX + k] : (double)NAN;
    findings->accel_shared = record->axis_count[IMK_ACCEL] > 0 && !record->reference_force[0];
    memcpy(findings->residual_of, model->residual_of, sizeof findings->residual_of);
    imki_thermal_passes(blocks, findings);
    findings->overlap = overlap_of(blocks);
    findings->both_directions = findings->overlap >= least_overlap;
    choose_gaps(findings);
}

/* ---- interface ------------------------------------------------------------------------------- */

static imk_status check(const imk_test_record *record, const imk_thermal_settings *settings,
                        const imk_model *model, size_t workspace_size, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_thermal_default()");
    if (settings->order_max < 1 || settings->order_max > IMK_TEMPERATURE_ORDER_MAX ||
        settings->order < -1 || settings->order > settings->order_max)
        return imk_error_set(error, IMK_ERROR_RANGE, "order", NULL, "0 … 5");
    if (!(settings->significance > 0.0 && settings->significance < 1.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "significance", NULL, "between 0 and 1");
    if (workspace_size < imk_thermal_workspace_size())
        return imk_error_set(error, IMK_ERROR_WORKSPACE, NULL, NULL,
                             "imk_thermal_workspace_size() bytes");
    if (!(record->dt > 0.0) || !isfinite(record->dt))
        return imk_error_set(error, IMK_ERROR_RATE_MISSING, record->name, NULL,
                             "a sample interval above 0");
    if (!record->temperature)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, "temperature", NULL,
                             "a temperature column");
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(model, sensor);
        for (int axis = 0; axis < record->axis_count[sensor]; axis++)
            if (record->counts[sensor] && !(triad->sensitivity.value[axis] != 0.0))
                return imk_error_set(error, IMK_ERROR_UNIT_MISSING,
                                     sensor == IMK_GYRO ? "gyro.sensitivity" : "accel.sensitivity",
                                     NULL, "state the sensitivity of readings in counts");
    }
    return IMK_OK;
}

imk_status imk_thermal_analyse(const imk_test_record *record, const imk_thermal_settings *settings,
                               const imk_model *model, imk_thermal_findings *findings,
                               void *workspace, size_t workspace_size, imk_error *error)
{
    imk_status status = check(record, settings, model, workspace_size, error);
    if (status != IMK_OK)
        return status;
    const size_t turned = imki_thermal_turned(record, model);
    if (turned < record->count) {
        imk_error_set(error, IMK_ERROR_CONFLICT, "pose", NULL,
                      "one pose; calibrate several poses with the thermal procedure");
        if (error)
            error->index = turned > INT32_MAX ? INT32_MAX : (int)turned;
        return IMK_ERROR_CONFLICT;
    }
    imki_thermal_work *work = imki_thermal_work_of(workspace);
    status =
        imki_thermal_divide(record, model, settings->reference_temperature, &work->blocks, error);
    if (status != IMK_OK)
        return status;
    imki_thermal_screen(&work->blocks);
    imki_thermal_merge(&work->blocks);
    memset(findings, 0, sizeof *findings);
    describe(record, model, &work->blocks, findings);
    imki_thermal_weigh(work, settings->order_max, findings->both_directions);
    for (int sensor = 0; sensor < 2; sensor++) {
        findings->axis_count[sensor] = record->axis_count[sensor];
        for (int axis = 0; axis < record->axis_count[sensor]; axis++)
            if (work->blocks.used[sensor * IMK_AXES_MAX + axis])
                analyse_axis(record, model, settings, work, sensor * IMK_AXES_MAX + axis, findings,
                             &findings->axis[sensor][axis]);
    }
    return IMK_OK;
}

static void apply_axis(const imk_thermal_axis *axis, int i, bool polynomials, imk_bias *bias)
{
    const bool loop = axis->cause == IMK_THERMAL_HYSTERESIS || axis->cause == IMK_THERMAL_BOTH;
    const bool rate = axis->cause == IMK_THERMAL_RATE || axis->cause == IMK_THERMAL_BOTH;
    bias->hysteresis.value[i] = loop ? axis->hysteresis.value : 0.0;
    bias->hysteresis.sigma[i] = loop ? axis->hysteresis.sigma : 0.0;
    bias->temperature_rate.value[i] = rate ? axis->temperature_rate.value : 0.0;
    bias->temperature_rate.sigma[i] = rate ? axis->temperature_rate.sigma : 0.0;
    for (int k = 0; polynomials && k < IMK_TEMPERATURE_ORDER_MAX; k++) {
        bias->temperature.coefficient[k].value[i] = axis->coefficient[k].value;
        bias->temperature.coefficient[k].sigma[i] = axis->coefficient[k].sigma;
    }
}

imk_status imk_thermal_apply(const imk_thermal_findings *findings, bool polynomials,
                             imk_model *model, imk_error *error)
{
    imk_triad *triads[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        if (findings->axis_count[sensor] > 0 &&
            (!triads[sensor]->present ||
             triads[sensor]->axis_count != findings->axis_count[sensor]))
            return imk_error_set(error, IMK_ERROR_CONFLICT, sensor == IMK_GYRO ? "gyro" : "accel",
                                 NULL, "a model with as many axes as the log");
    if (strcmp(findings->residual_of, model->residual_of) != 0)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "residual_of", findings->residual_of,
                             "a model of the same residual: the errors left after compensation do "
                             "not replace the errors that were taken out");
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_temperature_polynomial *p = &triads[sensor]->bias.temperature;
        int order = 0;
        if (findings->axis_count[sensor] == 0)
            continue;
        for (int i = 0; i < findings->axis_count[sensor]; i++) {
            apply_axis(&findings->axis[sensor][i], i, polynomials, &triads[sensor]->bias);
            if (findings->axis[sensor][i].order > order)
                order = findings->axis[sensor][i].order;
        }
        if (!polynomials && p->order > 0)
            continue; /* the coefficients that are there belong to their own reference */
        p->order = order;
        p->reference = findings->reference;
        p->minimum = findings->minimum;
        p->maximum = findings->maximum;
    }
    return IMK_OK;
}
