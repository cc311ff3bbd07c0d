/* SPDX-License-Identifier: Apache-2.0 */
/* What the axes do at rest, and how much more than that a window may show.
 *
 * The variance s^2 of n samples within a window about its mean is, at rest, about
 * E s^2 chi-square(nu)/nu with
 *
 *     nu = (n - 1)/(1 + 2 sum (1 - k/n) rho_k^2)                              [BARTLETT1946]
 *
 * for noise with the autocorrelation rho_k. E s^2 is itself only an estimate with nu_2 degrees of
 * freedom, which turns chi-square(nu)/nu into F(nu, nu_2); its quantile follows from that of
 * chi-square by the ratio of cube-root approximations [PAULSON1942]. The difference of the means of
 * the two halves of a window, which betrays slow turning long before the variance does, has the
 * variance 4 s^2 tau/n, tau = 1 + 2 sum rho_k.
 *
 * Readings coarser than their noise: its variance changes with where the value lies within a step
 * q, by up to q^2/4, and one that drifts across the edge of a step shifts a half by up to q. */
#include "base/sort_internal.h"
#include "imukit/distributions.h"
#include "static_internal.h"

#include <math.h>

enum {
    CORRELATED_SAMPLES = 4096, /* of the rest, for autocorrelations */
    CORRELATED_LAGS = 48,
    SORTED = 1024,   /* windows that tell the usual scatter */
    STRETCHES = 4096 /* that are looked at: of a longer log every second or third */
};

/* No gyro or accelerometer has so much noise; hands and engines do [rad/s], [m/s^2]. */
static const double NOISE_MAX[2] = {0.2, 2.0};
/* Rates at rest that differ by less are not told apart: the Earth's rate changes by up to twice
 * 7.3e-5 rad/s with attitude. */
static const double EARTH_RATE_CHANGE = 1.5e-4;

/* ---- autocorrelation within windows -----------------------------------------------------------
 */

typedef struct correlation_sums {
    double square, linear; /* 1 + 2 sum (1 - k/n) rho_k^2, and of rho_k */
} correlation_sums;

/* Products of neighbours within windows, each about its own mean. Of windows longer than
 * CORRELATED_SAMPLES the beginning. */
static correlation_sums correlate(const imki_static_job *job, int a, size_t begin, size_t end)
{
    const imki_static_blocks *b = &job->blocks;
    const size_t whole = b->length * IMKI_WINDOW_BLOCKS;
    const size_t n = whole < CORRELATED_SAMPLES ? whole : CORRELATED_SAMPLES;
    const size_t lags = n / 2 < CORRELATED_LAGS ? n / 2 : CORRELATED_LAGS;
    double product[CORRELATED_LAGS + 1] = {0.0}, off[CORRELATED_SAMPLES];
    size_t samples = 0;
    for (size_t w = begin; w + IMKI_WINDOW_BLOCKS <= end && samples < CORRELATED_SAMPLES;
         w += IMKI_WINDOW_BLOCKS) {
        const double *x = job->axis[a].reading + w * b->length;
        const double mean = imki_static_window(b, a, w).mean;
        for (size_t k = 0; k < n; k++)
            off[k] = x[k] - mean;
        for (size_t lag = 0; lag <= lags; lag++)
            product[lag] += imki_lagged_product(off, n, lag);
        samples += n;
    }
    correlation_sums sums = {1.0, 1.0};
    if (!(product[0] > 0.0))
        return sums;
    /* The product at lag k has n - k of n terms: its ratio is (1 - k/n) rho_k already. Squares of
     * pure noise would add up to lags/samples. */
    double previous = 1.0;
    bool open = true;
    for (size_t lag = 1; lag <= lags; lag++) {
        const double r = product[lag] / product[0];
        const double share = 1.0 - (double)lag / (double)n;
        const double excess = r * r / share - share / (double)samples;
        sums.square += excess > 0.0 ? 2.0 * excess : 0.0;
        if (lag % 2 == 1)
            open = open && previous + r > 0.0;
        if (open)
            sums.linear += 2.0 * r;
        previous = r;
    }
    return sums;
}

/* ---- quantiles ---------------------------------------------------------------------------------
 */

/* Cube root of the quantile of F(nu, nu_2) at the normal quantile z [PAULSON1942]. */
static double paulson_root(double z, double nu, double nu_2)
{
    const double a = 2.0 / (9.0 * nu), b = nu_2 > 0.0 ? 2.0 / (9.0 * nu_2) : 0.0;
    const double p = (1.0 - b) * (1.0 - b) - z * z * b, q = (1.0 - a) * (1.0 - b);
    const double r = (1.0 - a) * (1.0 - a) - z * z * a;
    return (q + sqrt(q * q - p * r)) / p;
}

/* Quantile of F(nu, nu_2) for a small probability beyond it. */
static double variance_ratio(double beyond, double nu, double nu_2)
{
    const double z = imk_normal_quantile(1.0 - beyond);
    const double chi_square = imk_chi_square_quantile(1.0 - beyond, nu) / nu;
    /* Fewer than z^2 degrees of freedom bound no ratio at all; the search for rest gives more. */
    const double least = z * z / 2.0;
    const double ratio =
        paulson_root(z, nu, nu_2 > least ? nu_2 : least) / paulson_root(z, nu, 0.0);
    return chi_square * ratio * ratio * ratio;
}

/* Quantile of Student's t by its first correction to the normal one. */
static double student(double beyond, double freedom)
{
    const double z = imk_normal_quantile(1.0 - 0.5 * beyond);
    return z * (1.0 + (z * z + 1.0) / (4.0 * freedom));
}

/* ---- learning ----------------------------------------------------------------------------------
 */

/* Length of the mean reading of the accelerometers at rest and their noise, as an angle: how far
 * the unit may tilt and not show it in a sample. 0: not known. */
static double noise_angle(const imki_static_job *job)
{
    double force = 0.0, noise = 0.0;
    int axes = 0;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        if (axis->sensor != IMK_ACCEL || axis->unit == 0.0)
            continue;
        const double f = (job->limit[a].mean - axis->zero) * axis->unit;
        const double s = job->limit[a].noise * axis->unit;
        force += f * f;
        noise += s * s;
        axes++;
    }
    return axes >= 3 && force > 0.0 ? sqrt(noise / axes / force) : 0.0;
}

/* A hand trembles, and so does a table: gyros see it long before it matters. Turning to and fro
 * within a window by less than the noise of one sample of the accelerometers is standing. */
static void allow_tremor(imki_static_job *job)
{
    const double angle = noise_angle(job);
    const double window = (double)(job->blocks.length * IMKI_WINDOW_BLOCKS) * job->record->dt;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        imki_static_limit *limit = &job->limit[a];
        if (axis->sensor != IMK_GYRO || axis->unit == 0.0 || limit->scatter_squared == 0.0)
            continue;
        const double rate = 2.0 * angle / window / fabs(axis->unit);
        limit->scatter_squared += rate * rate;
        limit->half += rate;
        limit->mean_off += 0.5 * rate + EARTH_RATE_CHANGE / fabs(axis->unit);
    }
}

static void learn_axis(imki_static_job *job, int a, size_t begin, size_t end, double beyond)
{
    const imki_static_blocks *b = &job->blocks;
    const imki_static_axis *axis = &job->axis[a];
    imki_static_limit *limit = &job->limit[a];
    const double n = (double)(b->length * IMKI_WINDOW_BLOCKS);
    *limit = (imki_static_limit){.effective = n, .inefficiency = 1.0, .mean_off = (double)INFINITY};
    if (axis->step == 0.0) { /* says nothing about motion */
        limit->mean = axis->reading[begin * b->length];
        return;
    }
    double variance = 0.0, half = 0.0, mean = 0.0, windows = 0.0;
    const double first = b->mean[a][begin];
    for (size_t w = begin; w + IMKI_WINDOW_BLOCKS <= end; w += IMKI_WINDOW_BLOCKS) {
        const imki_window_moments m = imki_static_window(b, a, w);
        variance += m.variance;
        half += m.half * m.half;
        mean += m.mean - first;
        windows += 1.0;
    }
    variance /= windows;
    half /= windows;
    const correlation_sums sums = correlate(job, a, begin, end);
    double freedom = (n - 1.0) / sums.square;
    if (freedom < 1.0)
        freedom = 1.0;
    const double tau = sums.linear > 0.2 ? sums.linear : 0.2, square = axis->step * axis->step;
    limit->mean = first + mean / windows;
    limit->effective = freedom + 1.0;
    limit->inefficiency = tau;
    limit->noise = sqrt(variance > square / 12.0 ? variance : square / 12.0);
    const bool coarse = variance < square;
    const double reference = coarse ? variance + 0.25 * square : variance;
    limit->scatter_squared = reference * variance_ratio(beyond, freedom, windows * freedom);
    const double expected = 4.0 * reference * tau / n;
    const double quantile = student(beyond, 4.0 * windows);
    limit->half = quantile * sqrt(half > expected ? half : expected) + (coarse ? axis->step : 0.0);
    if (axis->sensor == IMK_GYRO)
        limit->mean_off = quantile * sqrt(expected / 4.0) + 3.0 * limit->noise;
}

void imki_static_learn(imki_static_job *job, size_t begin, size_t end)
{
    int tests = 0;
    for (int a = 0; a < job->axis_count; a++)
        tests += job->axis[a].sensor == IMK_GYRO ? 3 : 2;
    for (int a = 0; a < job->axis_count; a++)
        learn_axis(job, a, begin, end, job->false_alarm / tests);
    allow_tremor(job);
    job->rest_begin = begin;
    job->rest_end = end;
}

/* ---- the quietest stretch ----------------------------------------------------------------------
 */

/* A variance that windows of this axis often have: what they are compared by. */
static double usual_variance(const imki_static_job *job, int a)
{
    const imki_static_blocks *b = &job->blocks;
    const size_t windows = imki_static_windows(b), stride = windows / SORTED + 1;
    double value[SORTED];
    size_t count = 0;
    for (size_t w = 0; w < windows && count < SORTED; w += stride)
        if (imki_static_window_valid(b, w))
            value[count++] = imki_static_window(b, a, w).variance;
    if (count == 0)
        return 1.0;
    imki_sort(value, count);
    return value[count / 10] + 0.25 * job->axis[a].step * job->axis[a].step;
}

/* Variance of a stretch of windows about its mean: within them and between them. */
static double stretch_variance(const imki_static_blocks *b, int a, size_t begin, size_t windows,
                               double *between)
{
    const double first = b->mean[a][begin];
    double within = 0.0, sum = 0.0, square = 0.0;
    for (size_t i = 0; i < windows; i++) {
        const imki_window_moments m = imki_static_window(b, a, begin + i * IMKI_WINDOW_BLOCKS);
        within += m.variance;
        sum += m.mean - first;
        square += (m.mean - first) * (m.mean - first);
    }
    const double n = (double)windows;
    const double spread = (square - sum * sum / n) / (n - 1.0);
    *between = spread > 0.0 ? spread : 0.0;
    return within / n;
}

static bool stretch_valid(const imki_static_blocks *b, size_t begin, size_t windows)
{
    for (size_t k = begin; k < begin + windows * IMKI_WINDOW_BLOCKS; k++)
        if (b->flag[k] & IMKI_BLOCK_INVALID || (k > begin && b->flag[k] & IMKI_BLOCK_BREAK))
            return false;
    return true;
}

/* Smaller is quieter; the worst axis counts. */
static double loudness(const imki_static_job *job, const double *usual, size_t begin,
                       size_t windows)
{
    double worst = 0.0;
    for (int a = 0; a < job->axis_count; a++) {
        if (job->axis[a].step == 0.0)
            continue;
        double between;
        const double within = stretch_variance(&job->blocks, a, begin, windows, &between);
        const double ratio = (within + between) / usual[a];
        worst = ratio > worst ? ratio : worst;
    }
    return worst;
}

/* How fast a stretch turns, in SI where that is known; else 0. */
static double turning(const imki_static_job *job, size_t begin, size_t windows)
{
    double square = 0.0;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        if (axis->sensor != IMK_GYRO || axis->unit == 0.0)
            continue;
        double rate = 0.0;
        for (size_t i = 0; i < windows; i++)
            rate += imki_static_window(&job->blocks, a, begin + i * IMKI_WINDOW_BLOCKS).mean -
                    axis->zero;
        rate *= axis->unit / (double)windows;
        square += rate * rate;
    }
    return sqrt(square);
}

static bool looks_at_rest(const imki_static_job *job, const double *usual, size_t begin,
                          size_t windows)
{
    if (windows < 2)
        return false;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_axis *axis = &job->axis[a];
        if (axis->step == 0.0)
            continue;
        double between;
        const double within = stretch_variance(&job->blocks, a, begin, windows, &between);
        if (axis->unit != 0.0 && !(sqrt(within) * fabs(axis->unit) <= NOISE_MAX[axis->sensor]))
            return false;
        /* Windows that stand are among the quieter ones, whatever the log holds besides. */
        if (usual && within > 4.0 * usual[a])
            return false;
        /* White noise has between/within = 1/n, flicker noise about 1/2; motion much more. */
        if (between > 2.0 * within + 0.25 * axis->step * axis->step)
            return false;
    }
    return true;
}

/* Of the stretches about as quiet as the quietest, the one that turns least: on a rate table every
 * step is quiet. */
static void search(imki_static_job *job, const double *usual, size_t windows)
{
    const imki_static_blocks *b = &job->blocks;
    const size_t length = windows * IMKI_WINDOW_BLOCKS;
    const size_t hop =
        IMKI_WINDOW_BLOCKS * (1 + b->count / ((size_t)IMKI_WINDOW_BLOCKS * STRETCHES));
    double quietest = (double)INFINITY;
    for (size_t k = 0; k + length <= b->count; k += hop) {
        job->scratch[k] =
            stretch_valid(b, k, windows) ? loudness(job, usual, k, windows) : (double)INFINITY;
        quietest = job->scratch[k] < quietest ? job->scratch[k] : quietest;
    }
    double slowest = (double)INFINITY;
    size_t best = 0;
    for (size_t k = 0; k + length <= b->count; k += hop) {
        if (!(job->scratch[k] <= 1.5 * quietest) || isinf(job->scratch[k]))
            continue;
        /* Without rates the loudness itself decides. */
        double speed = turning(job, k, windows);
        speed = speed > 0.0 ? speed : job->scratch[k];
        if (speed < slowest) {
            slowest = speed;
            best = k;
        }
    }
    if (isinf(slowest))
        return;
    job->rests = looks_at_rest(job, usual, best, windows);
    imki_static_learn(job, best, best + length);
}

bool imki_static_looks_at_rest(const imki_static_job *job, size_t begin, size_t end)
{
    return looks_at_rest(job, NULL, begin, (end - begin) / IMKI_WINDOW_BLOCKS);
}

/* A long stretch tells the noise better, a short one is found in short holds too. */
void imki_static_find_rest(imki_static_job *job)
{
    double usual[IMKI_STATIC_AXES];
    for (int a = 0; a < job->axis_count; a++)
        usual[a] = usual_variance(job, a);
    job->rests = false;
    for (size_t windows = IMKI_REST_WINDOWS; !job->rests && windows >= 2; windows /= 2)
        search(job, usual, windows);
}
