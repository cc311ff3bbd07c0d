/* SPDX-License-Identifier: Apache-2.0 */
/* From the sources of the drift to what goes sample by sample: which elements are vectors, which
 * are noise, and how noise is made, exactly as the generators make it.
 *
 * What a filter takes for bias (constants, warm-up, ramp, first-order processes, walks along an
 * axis) enters as its difference from the mean m of the n samples before the window. Of a process
 * of variance v with factor f per sample, y the last of them, and u independent of y:
 *
 *     m = C y + u,   C = (1 - f^n)/(n (1 - f)),
 *     var u = v [(n (1 - f^2) - 2 f (1 - f^n))/(n (1 - f))^2 - C^2]
 *
 * and of a walk with steps q: m = y - u, var u = q (n - 1)(2n - 1)/(6n), which is also the limit of
 * the other. The flicker's held stages are taken as if they changed at every sample. */
#include "tuning_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

bool imki_tuning_is_constant(const imki_drift_driver *driver)
{
    return driver->states == 1 && driver->a[0][0] == 0.0;
}

bool imki_tuning_is_ramp(const imki_drift_driver *driver)
{
    return driver->states == 2 && driver->a[1][0] == 0.0;
}

bool imki_tuning_has_series(const imki_tuning_plan *plan, size_t element)
{
    const imki_role role = plan->element[element].role;
    const imki_column_kind kind = plan->drift.column[plan->drift.element[element].column].kind;
    return (role == IMKI_ROLE_MEAN || role == IMKI_ROLE_SIZE) && kind != IMKI_COLUMN_SKEW &&
           kind != IMKI_COLUMN_CLOCK;
}

/* ---- noise ---- */

static imki_sampled white_of(double sigma)
{
    return (imki_sampled){.d = sigma};
}

/* Of a mean of n samples of a walk of unit steps, from the last. */
static double walk_before(double n)
{
    return (n - 1.0) * (2.0 * n - 1.0) / (6.0 * n);
}

static imki_sampled walk_of(double step, double n)
{
    return (imki_sampled){.states = 1,
                          .a = {{1.0, 0.0}, {0.0, 0.0}},
                          .b = {step, 0.0},
                          .c = {1.0, 0.0},
                          .d = step,
                          .start = {{step * step * walk_before(n), 0.0}, {0.0, 0.0}}};
}

/* The logarithm of the factor per sample: of a process that is sampled, and of one whose samples
 * have the density of the process at 0 Hz, (2 x - 1)/(2 x + 1), x = T/h. */
static double decay_of(const imki_process *p, double h)
{
    const double x = p->time / h;
    if (!p->matched)
        return -1.0 / x;
    return x > 1e3 ? -(1.0 + 1.0 / (12.0 * x * x)) / x : imk_ln((2.0 * x - 1.0) / (2.0 * x + 1.0));
}

/* States y - m and m. */
static imki_sampled first_order_of(double variance, double decay, double n)
{
    const double less = -imk_expm1(decay), f = 1.0 - less;
    const double all = -imk_expm1(n * decay), q = -variance * imk_expm1(2.0 * decay);
    const double kept = all / (n * less),
                 lost = n * less < 1e-4 ? 0.5 * (n - 1.0) * less : 1.0 - kept;
    double apart = q * walk_before(n);
    if (!(n * less < 1e-4))
        apart = variance *
                ((n * less * (1.0 + f) - 2.0 * f * all) / (n * less * n * less) - kept * kept);
    if (!(apart > 0.0)) /* one sample */
        apart = 0.0;
    const double both = variance * lost * kept - apart;
    return (imki_sampled){
        .states = 2,
        .a = {{f, -less}, {0.0, 1.0}},
        .b = {sqrt(q), 0.0},
        .c = {f, -less},
        .d = sqrt(q),
        .start = {{variance * lost * lost + apart, both}, {both, variance * kept * kept + apart}}};
}

/* Of a filter's bias with this correlation time, unit driving noise, from its known value: in h it
 * gains T/2 (1 - e^(-2 h/T)). */
static imki_sampled first_order_from(double time, double h)
{
    const double f = imk_exp(-h / time), gain = sqrt(-0.5 * time * imk_expm1(-2.0 * h / time));
    return (imki_sampled){
        .states = 1, .a = {{f, 0.0}, {0.0, 0.0}}, .b = {gain, 0.0}, .c = {f, 0.0}, .d = gain};
}

/* y = a1 y1 + a2 y2 + b0 e + b1 e1 + b2 e2, stationary: Z = a Z a^T + b b^T, by doubling. */
static imki_sampled arma_of(const imk_arma *arma)
{
    imki_sampled s = {.states = 2,
                      .a = {{arma->a1, 1.0}, {arma->a2, 0.0}},
                      .b = {arma->a1 * arma->b0 + arma->b1, arma->a2 * arma->b0 + arma->b2},
                      .c = {1.0, 0.0},
                      .d = arma->b0};
    double power[2][2], z[2][2];
    memcpy(power, s.a, sizeof power);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            z[i][j] = s.b[i] * s.b[j];
    for (int doubling = 0; doubling < 48; doubling++) {
        double more[2][2] = {{0.0}}, square[2][2] = {{0.0}};
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++)
                for (int k = 0; k < 2; k++) {
                    square[i][j] += power[i][k] * power[k][j];
                    for (int l = 0; l < 2; l++)
                        more[i][j] += power[i][k] * z[k][l] * power[j][l];
                }
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++)
                z[i][j] += more[i][j];
        memcpy(power, square, sizeof power);
    }
    memcpy(s.start, z, sizeof z);
    return s;
}

/* Differences of readings of an integral. */
static imki_sampled reading_of(double sigma, double h)
{
    return (imki_sampled){.states = 1,
                          .b = {1.0, 0.0},
                          .c = {-sigma / h, 0.0},
                          .d = sigma / h,
                          .start = {{1.0, 0.0}, {0.0, 0.0}}};
}

static imk_status white_through(const imki_drift_element *element, const imk_triad *triad, int axis,
                                double h, imki_sampled *s)
{
    const imk_low_pass filter = {triad->bandwidth.value[axis], triad->damping.value[axis]};
    imk_arma arma;
    *s = white_of(element->process.size * sqrt(element->process.share / h));
    if (!element->term->filtered || filter.bandwidth == 0.0)
        return IMK_OK;
    const imk_status status = imk_filtered_white_arma(element->process.size, filter, h, &arma);
    if (status == IMK_OK)
        *s = arma_of(&arma);
    return status;
}

static imk_status sampled_of(const imki_tuning_plan *plan, const imki_drift_element *element,
                             const imk_model *model, imki_sampled *s)
{
    const imki_drift_column *column = &plan->drift.column[element->column];
    const imki_process *p = &element->process;
    const double h = plan->h, n = (double)plan->bias_samples;
    imk_arma arma;
    if (column->kind == IMKI_COLUMN_JITTER) {
        *s = reading_of(element->state[0], 1.0); /* both signs are in the columns */
        s->c[0] = s->d;
        return IMK_OK;
    }
    if (element->use == IMKI_ELEMENT_ROUNDING) {
        *s = reading_of(element->state[0], h);
        return IMK_OK;
    }
    *s = white_of(sqrt(element->size / h));
    if (!element->term)
        return IMK_OK;
    switch (p->kind) {
    case IMKI_PROCESS_WHITE:
        return white_through(element, imk_model_triad(model, column->sensor), column->axis, h, s);
    case IMKI_PROCESS_WALK:
        *s = walk_of(p->size * sqrt(h), n);
        return IMK_OK;
    case IMKI_PROCESS_FIRST_ORDER:
        *s = first_order_of(p->share * p->size * p->size, decay_of(p, h), n);
        return IMK_OK;
    case IMKI_PROCESS_RESONANCE: {
        const imk_status status =
            imk_resonance_arma((imk_resonance){p->size, p->frequency, p->q}, h, &arma);
        if (status == IMK_OK)
            *s = arma_of(&arma);
        return status;
    }
    default:
        return IMK_OK;
    }
}

/* ---- vectors ---- */

/* Samples of a sinusoid are taken as they are, not as their integral would be. */
static void point_samples(imki_drift_element *element)
{
    for (int i = 0; i < 2; i++)
        if (element->state[i] != 0.0)
            element->state[i] = element->process.size * sqrt(0.5);
}

static imk_status take_element(imki_tuning_plan *plan, size_t i, const imk_model *model)
{
    imki_tuning_element *made = &plan->element[i];
    imki_drift_element *element = &plan->drift.element[i];
    const imki_drift_driver *driver = &plan->drift.driver[element->driver];
    const imki_column_kind kind = plan->drift.column[element->column].kind;
    memset(made, 0, sizeof *made);
    if (element->use == IMKI_ELEMENT_NOISE || element->use == IMKI_ELEMENT_ROUNDING) {
        made->role = kind == IMKI_COLUMN_JITTER ? IMKI_ROLE_JITTER : IMKI_ROLE_NOISE;
        return sampled_of(plan, element, model, &made->sampled);
    }
    made->role = element->use == IMKI_ELEMENT_MEAN ? IMKI_ROLE_MEAN : IMKI_ROLE_SIZE;
    if (kind == IMKI_COLUMN_ONE && imki_tuning_is_constant(driver))
        made->role = IMKI_ROLE_NONE;
    if (element->term)
        point_samples(element);
    else
        made->slow = kind == IMKI_COLUMN_ONE;
    imki_driver_step step;
    imki_driver_over(driver, plan->h, 1, &step);
    memcpy(made->phi, step.phi, sizeof made->phi);
    return IMK_OK;
}

/* ---- all ---- */

/* What the drift needs to know of the motion: that there is one, without vibration. */
static imk_drift_settings drift_settings(const imk_filter_tuning_settings *settings,
                                         const imk_trajectory *some)
{
    imk_drift_settings drift = imk_drift_default();
    drift.rate = settings->rate;
    drift.compensated = settings->compensated;
    drift.motion = some;
    return drift;
}

void imki_tuning_plan_size(const imk_model *model, const imk_filter_tuning_settings *settings,
                           size_t *sources, size_t *elements)
{
    const imk_trajectory some = {.earth = true};
    const imk_drift_settings drift = drift_settings(settings, &some);
    imki_drift_plan count = {.source_count = 0};
    imki_drift_sources(&count, model, &drift, (imk_geodetic){0.0, 0.0, 0.0});
    *sources = count.source_count + IMKI_TUNING_OWN;
    *elements = count.element_count;
}

imk_status imki_tuning_plan_make(imki_tuning_plan *plan, const imk_model *model,
                                 const imk_filter_tuning_settings *settings,
                                 const imki_tuning_grid *grid, imk_error *error)
{
    const imk_trajectory some = {.earth = true};
    const imk_drift_settings drift = drift_settings(settings, &some);
    plan->h = 1.0 / settings->rate;
    plan->bias_samples = grid->bias_samples;
    imki_drift_sources(&plan->drift, model, &drift, (imk_geodetic){0.0, 0.0, 0.0});
    const size_t elements = plan->drift.element_count;
    for (size_t i = 0; i < elements; i++) {
        const imk_status status = take_element(plan, i, model);
        if (status != IMK_OK)
            return imk_error_set(error, status, "rate", "",
                                 "a rate that fits the bandwidths and resonances of the model");
    }
    imki_drift_add_source(&plan->drift, "start", "gyro_bias", "", "gyro bias known at the start");
    imki_drift_add_source(&plan->drift, "start", "accel_bias", "",
                          "accelerometer bias known at the start");
    imki_drift_add_source(&plan->drift, "motion", "sampling", "",
                          "coning and sculling within samples");
    plan->white = white_of(1.0 / sqrt(plan->h));
    plan->walk = settings->correlation_time > 0.0
                     ? first_order_from(settings->correlation_time, plan->h)
                     : walk_of(sqrt(plan->h), 1.0);
    return IMK_OK;
}
