/* SPDX-License-Identifier: Apache-2.0 */
/* An experiment: power cycles, a linear law for the readings of each, as many cycles as its figures
 * need. */
#include "laboratory_internal.h"

#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { CYCLES_MAX = 100000 };

/* Diagonal of (A^T A)^-1. */
static bool variances(size_t rows, size_t columns, const double *a, double *variance)
{
    double qr[IMKI_TRIALS * IMKI_COEFFICIENTS], beta[IMKI_COEFFICIENTS];
    double covariance[IMKI_COEFFICIENTS * IMKI_COEFFICIENTS];
    memcpy(qr, a, rows * columns * sizeof *a);
    if (imk_qr_factor(rows, columns, qr, beta) != IMK_OK ||
        imk_qr_covariance(rows, columns, qr, covariance) != IMK_OK)
        return false;
    for (size_t k = 0; k < columns; k++)
        variance[k] = covariance[k * (columns + 1)];
    return true;
}

bool imki_fit(size_t rows, size_t columns, const double *a, const double *y, double *x,
              double *sigma)
{
    double qr[IMKI_TRIALS * IMKI_COEFFICIENTS], b[IMKI_TRIALS], beta[IMKI_COEFFICIENTS];
    double variance = 0.0;
    if (rows < columns || rows > IMKI_TRIALS || columns > IMKI_COEFFICIENTS)
        return false;
    memcpy(qr, a, rows * columns * sizeof *a);
    memcpy(b, y, rows * sizeof *y);
    if (!variances(rows, columns, a, sigma) || imk_qr_factor(rows, columns, qr, beta) != IMK_OK ||
        imk_qr_solve(rows, columns, qr, beta, b, x) != IMK_OK)
        return false;
    for (size_t i = columns; i < rows; i++) /* b is Q^T y: its tail is what the fit leaves */
        variance += b[i] * b[i] / (double)(rows - columns);
    for (size_t k = 0; k < columns; k++)
        sigma[k] = sqrt(variance * sigma[k]);
    return true;
}

imki_experiment *imki_experiment_begin(imki_bench *bench, const char *stage)
{
    imki_experiment *e = &bench->experiment;
    memset(e, 0, sizeof *e);
    e->stage = stage;
    e->ramps = true;
    e->dwell = bench->laboratory->dwell;
    return e;
}

void imki_experiment_column(imki_experiment *experiment, const char *key, double unit,
                            double *value, double *sigma)
{
    experiment->column[experiment->columns++] = (imki_column){key, unit, value, sigma};
}

/* Means over cycles, and sums of squares about them [Welford]. */
typedef struct running {
    double count, row[IMKI_TRIALS], change[IMKI_TRIALS], x[IMKI_COEFFICIENTS];
    double row_square[IMKI_TRIALS], change_square[IMKI_TRIALS], x_square[IMKI_COEFFICIENTS];
    double misfit_square[IMKI_COEFFICIENTS]; /* sums of what the residuals of each say */
} running;

static void add(double count, double value, double *mean, double *square)
{
    const double step = value - *mean;
    *mean += step / count;
    *square += step * (value - *mean);
}

static bool fit_cycle(const imki_experiment *e, const double *y, double *x, double *sigma)
{
    double rest[IMKI_TRIALS];
    for (size_t i = 0; i < e->rows; i++)
        rest[i] = y[i] - e->offset[i];
    return imki_fit(e->rows, e->columns, e->a, rest, x, sigma);
}

static bool add_cycle(const imki_experiment *e, const double *y, running *r)
{
    double x[IMKI_COEFFICIENTS], sigma[IMKI_COEFFICIENTS];
    if (!fit_cycle(e, y, x, sigma))
        return false;
    r->count++;
    for (size_t i = 0; i < e->rows; i++) {
        add(r->count, y[i], &r->row[i], &r->row_square[i]);
        add(r->count, y[i] - y[e->rest], &r->change[i], &r->change_square[i]);
    }
    for (size_t k = 0; k < e->columns; k++) {
        add(r->count, x[k], &r->x[k], &r->x_square[k]);
        r->misfit_square[k] += sigma[k] * sigma[k];
    }
    return true;
}

static double sigma_of_mean(double square, double count)
{
    return count > 1.0 ? sqrt(square / (count * (count - 1.0))) : 0.0;
}

/* 1 sigma of a coefficient from the rounding of the integral at the ends of the dwell, which
 * differs from cycle to cycle but may be alike within one. */
static double rounding_sigma(const imki_bench *bench, size_t column, double cycles)
{
    const imki_experiment *e = &bench->experiment;
    return sqrt(2.0 / cycles) * bench->rounding / e->dwell * e->gain[column];
}

static double wanted_sigma(const imki_bench *bench, size_t column)
{
    const imki_column *c = &bench->experiment.column[column];
    return IMKI_WANTED * c->unit * bench->result->matters[imki_figure_of(bench, c->key)];
}

/* A gyro without a range tells the angle that it was turned by; a tenth of a radian is little. */
static double longest_turn(const imki_bench *bench)
{
    static const double angle = 0.1;
    const imki_experiment *e = &bench->experiment;
    double fastest = 0.0;
    for (size_t i = 0; i < e->rows; i++)
        for (size_t k = 0; k < 3; k++)
            fastest = fmax(fastest, fabs(e->trial[i].exposure.angular_rate[k]));
    return bench->ranged || !(fastest > 0.0) ? (double)INFINITY : angle / fastest;
}

/* A dwell in which the rounding is as small as wanted, for as many figures as time allows. */
static bool choose_dwell(imki_bench *bench)
{
    imki_experiment *e = &bench->experiment;
    const double cycles = bench->laboratory->cycles, shortest = e->dwell;
    const double longest = bench->longest[e->quick] / ((double)e->rows * cycles) - bench->settle;
    if (!variances(e->rows, e->columns, e->a, e->gain))
        return false;
    for (size_t k = 0; k < e->columns; k++)
        e->gain[k] = sqrt(e->gain[k]);
    const double turn = fmax(shortest, longest_turn(bench));
    double dwell = shortest;
    for (size_t k = 0; k < e->columns; k++) {
        if (!e->column[k].key)
            continue;
        /* what differs from run to run needs many cycles, in each of which little is enough */
        const double wanted = wanted_sigma(bench, k) * (e->repeats ? 8.0 / sqrt(cycles) : 1.0);
        const double needed =
            fmin(1.25 * shortest * rounding_sigma(bench, k, cycles) / wanted, turn);
        if (needed <= longest && needed > dwell)
            dwell = needed;
    }
    e->dwell = dwell;
    return true;
}

/* Cycles at which the scatter of this coefficient would be as small as wanted; infinite when the
 * law itself does not hold so well. */
static double cycles_needed(const imki_bench *bench, const running *r, size_t column, double misfit)
{
    const double wanted = wanted_sigma(bench, column);
    const double rounding = rounding_sigma(bench, column, r->count);
    double sigma = fmax(sigma_of_mean(r->x_square[column], r->count), rounding);
    /* residuals that are noise become smaller in the mean over cycles */
    const double noise = sqrt(r->misfit_square[column]) / r->count;
    if (misfit > wanted && misfit > 3.0 * noise && misfit > 2.0 * rounding)
        return (double)INFINITY;
    sigma = fmax(sigma, misfit);
    return sigma <= wanted ? r->count : r->count * (sigma / wanted) * (sigma / wanted);
}

static bool make_cycles(imki_bench *bench, size_t until, running *r)
{
    const imki_experiment *e = &bench->experiment;
    double y[IMKI_STATES];
    while (r->count < (double)until) {
        const size_t first = (size_t)r->count, room = IMKI_STATES / e->rows;
        const size_t count = until - first < room ? until - first : room;
        if (!imki_progress(bench, e->stage, first * e->rows, until * e->rows))
            return false;
        imki_readings(bench, first, count, y);
        for (size_t i = 0; i < count; i++)
            if (!add_cycle(e, y + i * e->rows, r))
                return false;
    }
    return true;
}

/* More cycles, as long as there are figures that they would tell within the time allowed. */
static bool make_all_cycles(imki_bench *bench, running *r, double *misfit)
{
    const imki_experiment *e = &bench->experiment;
    const double longest = bench->longest[e->quick] / ((double)e->rows * imki_trial_time(bench));
    double until = bench->laboratory->cycles, x[IMKI_COEFFICIENTS];
    for (;;) {
        if (!make_cycles(bench, (size_t)until, r) || !fit_cycle(e, r->row, x, misfit))
            return false;
        for (size_t k = 0; k < e->columns; k++) {
            if (!e->column[k].key)
                continue;
            const double needed = ceil(cycles_needed(bench, r, k, misfit[k]));
            if (needed <= longest && needed <= CYCLES_MAX && needed > until)
                until = needed;
        }
        if (!(until > r->count))
            return true;
    }
}

/* Simulated time at which the sigma would be as wanted. Rounding becomes smaller as the dwell
 * grows, as far as it may grow; noise as the root of the number of cycles. */
static double time_needed(const imki_bench *bench, const running *r, size_t column, double misfit)
{
    const imki_experiment *e = &bench->experiment;
    const double needed = cycles_needed(bench, r, column, misfit);
    const double noise = fmax(misfit, sigma_of_mean(r->x_square[column], r->count));
    const double cycles = bench->laboratory->cycles, wanted = wanted_sigma(bench, column);
    const double rounding = rounding_sigma(bench, column, cycles);
    if (!(rounding > wanted && rounding > noise && isfinite(needed)))
        return e->seconds / r->count * needed;
    const double dwell = 1.25 * e->dwell * rounding / wanted;
    const double longest = fmin(dwell, fmax(e->dwell, longest_turn(bench)));
    const double more = dwell / longest;
    return (double)e->rows * cycles * more * more * (bench->settle + longest);
}

static void keep(imki_bench *bench, const running *r, const double *misfit)
{
    imki_experiment *e = &bench->experiment;
    e->cycles = (size_t)r->count;
    e->seconds = r->count * (double)e->rows * imki_trial_time(bench);
    for (size_t i = 0; i < e->rows; i++) {
        e->mean[i] = r->row[i];
        e->change[i] = r->change[i];
        e->spread[i] = sigma_of_mean(r->row_square[i], r->count);
        e->scatter[i] = sigma_of_mean(r->change_square[i], r->count);
    }
    for (size_t k = 0; k < e->columns; k++) {
        const imki_column *c = &e->column[k];
        e->x[k] = r->x[k];
        e->sigma[k] = fmax(fmax(misfit[k], sigma_of_mean(r->x_square[k], r->count)),
                           rounding_sigma(bench, k, r->count));
        if (!c->key)
            continue;
        *c->value = e->x[k] / c->unit;
        *c->sigma = e->sigma[k] / c->unit;
        const double needs = time_needed(bench, r, k, misfit[k]);
        bench->result->effort[imki_figure_of(bench, c->key)] = (imk_laboratory_effort){
            r->count - 1.0, e->seconds, needs, isinf(needs) ? e->limit : NULL};
    }
}

/* Are there figures that take too long at the level of the laboratory, but not at the slow one? */
static bool slow_level_helps(const imki_bench *bench, const running *r, const double *misfit)
{
    const imki_experiment *e = &bench->experiment;
    const double longest = bench->longest[1] / ((double)e->rows * imki_trial_time(bench));
    if (e->quick || !bench->laboratory->quick || bench->slow == bench->laboratory->physics.level)
        return false;
    for (size_t k = 0; k < e->columns; k++) {
        const double needed = e->column[k].key ? cycles_needed(bench, r, k, misfit[k]) : 0.0;
        if (needed > r->count && needed <= fmin(longest, CYCLES_MAX))
            return true;
    }
    return false;
}

void imki_experiment_run(imki_bench *bench)
{
    imki_experiment *e = &bench->experiment;
    double misfit[IMKI_COEFFICIENTS];
    for (int attempt = 0; attempt < 2; attempt++) {
        running r = {.count = 0.0};
        if (!choose_dwell(bench) || !make_all_cycles(bench, &r, misfit))
            return;
        keep(bench, &r, misfit);
        if (!slow_level_helps(bench, &r, misfit))
            return;
        e->quick = true;
    }
}

static double row_computed(const imki_bench *bench, size_t row)
{
    const imki_experiment *e = &bench->experiment;
    double sum = e->offset[row];
    for (size_t k = 0; k < e->columns; k++)
        if (e->column[k].key)
            sum += e->a[row * e->columns + k] * e->column[k].unit *
                   bench->computed[imki_figure_of(bench, e->column[k].key)].value;
    return sum;
}

double imki_experiment_computed(const imki_bench *bench, size_t row)
{
    return row_computed(bench, row) - row_computed(bench, bench->experiment.rest);
}
