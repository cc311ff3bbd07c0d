/* SPDX-License-Identifier: Apache-2.0 */
/* The least-squares line of the levels' means, weighted by their readings, and what follows from
 * it. Every estimate is linear in the means, a = sum of w_L m_L, so its variance is
 * sum of w_L^2 sigma_L^2 whatever the noise was found from. */
#include "evaluate_internal.h"

#include "imukit/attitude.h"
#include "imukit/distributions.h"

#include <string.h>

/* References closer together than this part of the largest are no line. */
static const double narrow = 1e-9;

static double weight_of(const imki_evaluation *e, size_t level)
{
    const imki_cell *cell = &e->cell[level * IMKI_CELLS];
    return (double)(cell[0].count + cell[1].count + cell[2].count);
}

/* Weighted centre and sum of squares of the references. */
static void centre(const imki_evaluation *e, double *middle, double *squares)
{
    double weights = 0.0;
    *middle = *squares = 0.0;
    for (size_t k = 0; k < e->levels; k++) {
        weights += weight_of(e, k);
        *middle += weight_of(e, k) * e->reference[k];
    }
    *middle /= weights;
    for (size_t k = 0; k < e->levels; k++) {
        const double d = e->reference[k] - *middle;
        *squares += weight_of(e, k) * d * d;
    }
}

void imki_least_squares_line(imki_evaluation *e)
{
    double middle, squares, variance, mean = 0.0, slope = 0.0, deviation = 0.0;
    imk_evaluation_line *line = &e->result->line;
    if (e->levels < 2)
        return;
    centre(e, &middle, &squares);
    for (size_t k = 0; k < e->levels; k++) {
        const double m = imki_level_mean(e, k, &variance);
        mean += weight_of(e, k) / (double)e->rows * m;
        slope += weight_of(e, k) * (e->reference[k] - middle) / squares * m;
    }
    for (size_t k = 0; k < e->levels; k++) {
        const double m = imki_level_mean(e, k, &variance);
        deviation = fmax(deviation, fabs(m - mean - slope * (e->reference[k] - middle)));
    }
    *line = (imk_evaluation_line){mean - slope * middle, slope, deviation};
}

static imk_evaluation_figure around(double value, double half)
{
    return (imk_evaluation_figure){value, value - half, value + half};
}

void imki_line_intervals(imki_evaluation *e)
{
    double middle, squares, zero = 0.0, slope = 0.0;
    if (e->levels < 2)
        return;
    centre(e, &middle, &squares);
    for (size_t k = 0; k < e->levels; k++) {
        const double w = weight_of(e, k) * (e->reference[k] - middle) / squares;
        const double v = weight_of(e, k) / (double)e->rows - w * middle;
        const double variance = e->level_sigma[k] * e->level_sigma[k];
        slope += w * w * variance;
        zero += v * v * variance;
    }
    e->result->sensitivity = around(e->result->line.sensitivity, e->student * sqrt(slope));
    e->result->zero = around(e->result->line.zero, e->student * sqrt(zero));
}

/* ---- asymmetry ------------------------------------------------------------------------------- */

/* Limits of a/k, two normal estimates: where (a - r k)^2 = t^2 var(a - r k) [FIELLER1954]. */
static imk_evaluation_figure ratio(double a, double k, double aa, double ak, double kk, double t)
{
    const double p = k * k - t * t * kk, q = a * k - t * t * ak, s = a * a - t * t * aa;
    const double root = q * q - p * s;
    if (!(p > 0.0) || !(root >= 0.0))
        return (imk_evaluation_figure){a / k, (double)NAN, (double)NAN};
    return (imk_evaluation_figure){a / k, (q - sqrt(root)) / p, (q + sqrt(root)) / p};
}

/* y = zero + K x + A |x|/2, so that K+ - K- = A and K is their mean. */
void imki_asymmetry(imki_evaluation *e)
{
    imk_matrix3 normal = {{{0.0}}}, inverse;
    double largest = 0.0, value[2] = {0.0, 0.0}, cov[2][2] = {{0.0}};
    if (e->levels < 3 || !(e->reference[0] < 0.0) || !(e->reference[e->levels - 1] > 0.0))
        return;
    for (size_t k = 0; k < e->levels; k++) {
        const double u = e->reference[k] / e->scale, row[3] = {1.0, u, 0.5 * fabs(u)};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                normal.m[i][j] += weight_of(e, k) * row[i] * row[j];
    }
    if (imk_matrix3_inverse(normal, &inverse) != IMK_OK)
        return;
    /* Of what the determinant is summed up from, it is a billionth or less: rounding. */
    for (int k = 0; k < 3; k++)
        largest = fmax(largest, fabs(normal.m[0][k] * inverse.m[k][0]));
    if (!(largest < 1e9))
        return;
    for (size_t k = 0; k < e->levels; k++) {
        const double u = e->reference[k] / e->scale, row[3] = {1.0, u, 0.5 * fabs(u)};
        double w[2] = {0.0, 0.0}, variance;
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 3; j++)
                w[i] += weight_of(e, k) * inverse.m[i + 1][j] * row[j];
        const double mean = imki_level_mean(e, k, &variance);
        for (int i = 0; i < 2; i++) {
            value[i] += w[i] * mean;
            for (int j = 0; j < 2; j++)
                cov[i][j] += w[i] * w[j] * variance;
        }
    }
    e->result->asymmetry = ratio(value[1], value[0], cov[1][1], cov[0][1], cov[0][0], e->student);
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Sums of one run's readings, and its line. */
typedef struct run_line {
    double count, x, y, xx, xy; /* the latter two about the means */
    double zero, slope, zero_sigma, slope_sigma;
} run_line;

static void add_row(const imki_evaluation *e, size_t row, run_line *line)
{
    const double x = e->table->reference[row], y = e->table->reading[row];
    line->count += 1.0;
    const double dx = x - line->x;
    line->x += dx / line->count;
    line->y += (y - line->y) / line->count;
    line->xx += dx * (x - line->x);
    line->xy += dx * (y - line->y);
}

/* A run at one level only: along the line of all. */
static void finish(const imki_evaluation *e, double sigma, run_line *line)
{
    const bool own = line->xx > narrow * narrow * e->scale * e->scale * line->count;
    line->slope = own ? line->xy / line->xx : e->result->line.sensitivity;
    line->zero = line->x == 0.0 ? line->y : line->y - line->slope * line->x;
    line->zero_sigma = sigma * sqrt(1.0 / line->count + (own ? line->x * line->x / line->xx : 0.0));
    line->slope_sigma = own ? sigma / sqrt(line->xx) : (double)NAN;
}

static double noise_of_run(const imki_evaluation *e, int run, double count)
{
    double variance = 0.0;
    if (e->result->source == IMK_SCATTER_RESIDUALS)
        return 0.0; /* which contain what runs differ by */
    for (size_t row = 0; row < e->rows; row++)
        variance += imki_run_of(e, row) == run ? imki_reading_variance(e, row) / count : 0.0;
    return sqrt(variance);
}

void imki_run_lines(imki_evaluation *e)
{
    double value[2][IMK_EVALUATION_RUNS_MAX], sigma[2][IMK_EVALUATION_RUNS_MAX];
    double freedom[IMK_EVALUATION_RUNS_MAX];
    imk_evaluation *r = e->result;
    run_line line[IMK_EVALUATION_RUNS_MAX];
    memset(line, 0, sizeof line);
    size_t zeros = 0, slopes = 0;
    for (size_t row = 0; row < e->rows; row++)
        add_row(e, row, &line[imki_run_of(e, row)]);
    for (int run = 0; run < e->runs; run++) {
        if (line[run].count == 0.0)
            continue;
        finish(e, noise_of_run(e, run, line[run].count), &line[run]);
        r->run_line[run][0] = line[run].zero;
        r->run_line[run][1] = line[run].slope;
        freedom[zeros] = r->freedom;
        if (isfinite(line[run].zero)) {
            value[0][zeros] = line[run].zero;
            sigma[0][zeros++] = line[run].zero_sigma;
        }
        if (isfinite(line[run].slope_sigma)) {
            value[1][slopes] = line[run].slope / r->line.sensitivity - 1.0;
            sigma[1][slopes++] = line[run].slope_sigma / fabs(r->line.sensitivity);
        }
    }
    const double confidence = e->settings->confidence;
    if (zeros > 1)
        (void)imk_repeatability_estimate(zeros, value[0], sigma[0], freedom, confidence,
                                         &r->run_zero, NULL);
    if (slopes > 1)
        (void)imk_repeatability_estimate(slopes, value[1], sigma[1], freedom, confidence,
                                         &r->run_sensitivity, NULL);
}
