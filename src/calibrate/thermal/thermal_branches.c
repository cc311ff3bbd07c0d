/* SPDX-License-Identifier: Apache-2.0 */
/* Warming against cooling: passes, the gap between them at given temperatures, and the lag that
 * could be its cause.
 *
 * A gap is the difference of mean readings where passes cross a temperature, read off between the
 * two blocks beside it: a weighted sum a of blocks whose weights add up to zero, with the variance
 * a^T V a.
 *
 * A lag tau of the sensor behind its thermometer makes it follow T_s, tau dT_s/dt = T - T_s,
 * instead of T; where the thermometer is the slower one, T_s = T - tau dT/dt with tau < 0. */
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "thermal_internal.h"

#include <math.h>
#include <string.h>

/* A turn is one when the temperature has come back by so much of the range: less is the
 * thermometer's noise, or the chamber's controller. */
static const double turn_share = 0.03;

void imki_thermal_passes(imki_thermal_blocks *blocks, imk_thermal_findings *findings)
{
    const double play = turn_share * (blocks->maximum - blocks->minimum);
    double highest = blocks->temperature[0], lowest = highest;
    size_t highest_at = 0, lowest_at = 0;
    int direction = 0, pass = 0;
    findings->warming = findings->cooling = 0;
    for (size_t b = 0; b < blocks->count; b++) {
        const double t = blocks->temperature[b];
        if (t > highest) {
            highest = t;
            highest_at = b;
        }
        if (t < lowest) {
            lowest = t;
            lowest_at = b;
        }
        const int turned = direction >= 0 && t < highest - play  ? -1
                           : direction <= 0 && t > lowest + play ? 1
                                                                 : 0;
        if (turned) {
            /* The new pass begins behind the extreme. */
            pass += direction != 0;
            for (size_t i = turned < 0 ? highest_at + 1 : lowest_at + 1; i <= b; i++) {
                blocks->direction[i] = turned;
                blocks->pass[i] = pass;
            }
            if (direction == 0)
                for (size_t i = 0; i <= b; i++)
                    blocks->direction[i] = turned;
            direction = turned;
            highest = lowest = t;
            highest_at = lowest_at = b;
            *(turned > 0 ? &findings->warming : &findings->cooling) += 1;
        }
        blocks->direction[b] = direction;
        blocks->pass[b] = pass;
    }
}

/* Add to `weight` the reading where the passes in a direction cross a temperature.
 * @return number of crossings */
static int crossings(const imki_thermal_blocks *blocks, int direction, double temperature,
                     double *weight)
{
    int count = 0, last = -1;
    for (size_t b = 0; b + 1 < blocks->count; b++) {
        const double from = blocks->temperature[b], to = blocks->temperature[b + 1];
        if (blocks->direction[b] != direction || blocks->pass[b] == last ||
            blocks->pass[b + 1] != blocks->pass[b] ||
            !((double)direction * (temperature - from) >= 0.0 &&
              (double)direction * (to - temperature) > 0.0))
            continue;
        const double share = (temperature - from) / (to - from);
        weight[b] += 1.0 - share;
        weight[b + 1] += share;
        last = blocks->pass[b]; /* a pass crosses once; noise may bring it back */
        count++;
    }
    for (size_t b = 0; b < blocks->count; b++)
        weight[b] /= count > 0 ? (double)count : 1.0;
    return count;
}

static double weighted(const imki_thermal_blocks *blocks, int axis, const double *weight)
{
    double sum = 0.0;
    for (size_t b = 0; b < blocks->count; b++)
        sum += weight[b] * blocks->reading[axis][b];
    return sum;
}

/* a^T V a of each kind of noise, for variances of 1. */
typedef struct noise_parts {
    double white, flicker, walk;
} noise_parts;

static noise_parts parts_of(const imki_thermal_work *work, const double *a)
{
    const size_t n = work->blocks.count;
    noise_parts sum = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < n; i++) {
        if (a[i] == 0.0)
            continue;
        sum.white += a[i] * a[i] * work->blocks.per_block / work->blocks.size[i];
        for (size_t j = 0; j < n; j++) {
            sum.flicker += a[i] * a[j] * work->flicker[i * n + j];
            sum.walk += a[i] * a[j] * work->walk[i * n + j];
        }
    }
    return sum;
}

double imki_thermal_gaps(imki_thermal_work *work, int axis, const imk_thermal_findings *findings,
                         imk_thermal_axis *out)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    const imki_thermal_variance *v = &work->variance[axis];
    double least = 1.0;
    for (int g = 0; g < findings->gap_count; g++) {
        double up[IMKI_THERMAL_BLOCKS] = {0.0}, down[IMKI_THERMAL_BLOCKS] = {0.0};
        const double t = findings->gap_temperature[g], mean = blocks->mean[axis];
        const bool warms = crossings(blocks, 1, t, up) > 0;
        const bool cools = crossings(blocks, -1, t, down) > 0;
        out->warming[g] = warms ? mean + weighted(blocks, axis, up) : (double)NAN;
        out->cooling[g] = cools ? mean + weighted(blocks, axis, down) : (double)NAN;
        out->gap[g] = (imk_scalar){(double)NAN, (double)NAN};
        if (!warms || !cools)
            continue;
        for (size_t b = 0; b < blocks->count; b++)
            up[b] -= down[b];
        const noise_parts parts = parts_of(work, up);
        const double gap = weighted(blocks, axis, up);
        out->gap[g].value = gap;
        out->gap[g].sigma =
            sqrt(v->white * parts.white + v->flicker * parts.flicker + v->walk * parts.walk);
        least = fmin(least, imki_thermal_chance(work, axis, gap * gap, parts.white, parts.flicker,
                                                parts.walk));
        if (fabs(out->gap[g].value) > out->gap_largest)
            out->gap_largest = fabs(out->gap[g].value);
    }
    return least;
}

/* ---- lag ------------------------------------------------------------------------------------- */

/* Temperature of the sensor, block by block; the thermometer's runs straight from the middle of one
 * block to that of the next, and at the beginning sensor and thermometer agree. */
static void follow(const imki_thermal_blocks *blocks, double lag, double *temperature)
{
    double behind = 0.0, t = blocks->temperature[0]; /* T - T_s */
    for (size_t b = 0; b < blocks->count; b++) {
        if (lag <= 0.0) {
            temperature[b] = blocks->temperature[b] - lag * blocks->rate[b];
            continue;
        }
        if (b > 0) {
            const double dt = 0.5 * (blocks->end[b] + blocks->begin[b] - blocks->end[b - 1] -
                                     blocks->begin[b - 1]);
            const double slope = (blocks->temperature[b] - t) / dt;
            const double keep = imk_exp(-dt / lag);
            behind = keep * behind + slope * lag * (1.0 - keep);
            t = blocks->temperature[b];
        }
        temperature[b] = t - behind;
    }
}

/* Residual sum of squares of a polynomial in the sensor's temperature, by the noise of the factor
 * in place. */
static double lagged_rss(const imki_thermal_work *work, int axis, int order, double lag)
{
    enum { Q = IMK_TEMPERATURE_ORDER_MAX + 1 };
    const imki_thermal_blocks *blocks = &work->blocks;
    const size_t n = blocks->count, q = (size_t)order + 1;
    double t[IMKI_THERMAL_BLOCKS], x[Q][IMKI_THERMAL_BLOCKS], y[IMKI_THERMAL_BLOCKS];
    double a[Q * Q], b[Q], c[Q], rss = 0.0;
    follow(blocks, lag, t);
    for (size_t i = 0; i < n; i++) {
        const double z = (t[i] - blocks->reference) / blocks->scale;
        y[i] = blocks->reading[axis][i];
        x[0][i] = 1.0;
        for (size_t k = 1; k < q; k++)
            x[k][i] = x[k - 1][i] * z;
    }
    imki_thermal_whiten(work, y);
    for (size_t k = 0; k < q; k++)
        imki_thermal_whiten(work, x[k]);
    for (size_t i = 0; i < n; i++)
        rss += y[i] * y[i];
    for (size_t k = 0; k < q; k++) {
        b[k] = 0.0;
        for (size_t i = 0; i < n; i++)
            b[k] += x[k][i] * y[i];
        c[k] = b[k];
        for (size_t l = 0; l < q; l++) {
            a[k * q + l] = 0.0;
            for (size_t i = 0; i < n; i++)
                a[k * q + l] += x[k][i] * x[l][i];
        }
    }
    if (imk_cholesky_factor(q, a) != IMK_OK)
        return (double)INFINITY;
    imk_cholesky_solve(q, a, b);
    for (size_t k = 0; k < q; k++)
        rss -= b[k] * c[k];
    return rss;
}

/* The best of lags on a grid, then by parabolas through three points that close in on it. */
void imki_thermal_lag(imki_thermal_work *work, int axis, int order, imk_thermal_axis *out)
{
    enum { GRID = 8 };
    const imki_thermal_blocks *blocks = &work->blocks;
    const size_t n = blocks->count;
    const double block = (blocks->end[n - 1] - blocks->begin[0]) / (double)n;
    imki_thermal_factor(work, work->best[axis]);
    const double none = lagged_rss(work, axis, order, 0.0);
    double lag = 0.0, least = none, width = 0.25 * block, trial = 0.25 * block;
    /* A quarter of a block to some thirty blocks, a third of the log. */
    for (int i = 0; i < GRID; i++, trial *= 2.0)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double rss = lagged_rss(work, axis, order, sign * trial);
            if (rss < least) {
                least = rss;
                lag = sign * trial;
                width = 0.5 * trial;
            }
        }
    double curvature = 0.0;
    for (int i = 0; i < 6; i++) {
        const double below = lagged_rss(work, axis, order, lag - width);
        const double above = lagged_rss(work, axis, order, lag + width);
        curvature = (below - 2.0 * least + above) / (width * width);
        if (!(curvature > 0.0))
            break;
        double step = 0.5 * (below - above) / (curvature * width);
        step = fmin(fmax(step, -width), width);
        const double rss = lagged_rss(work, axis, order, lag + step);
        if (rss < least) {
            least = rss;
            lag += step;
        }
        width *= 0.5;
    }
    out->lag.value = lag;
    /* RSS/s^2 grows by 1 at one sigma. */
    const double freedom = (double)n - (double)order - 2.0;
    out->lag.sigma = curvature > 0.0 ? sqrt(2.0 * least / freedom / curvature) : (double)NAN;
    out->lag_likelihood = 0.5 * (double)n * imk_ln(none / least);
}
