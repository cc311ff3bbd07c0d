/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of the readings of the integral at several rates,
 *
 *     sigma^2(dt) = r^2 + A^2/dt,
 *
 * by least squares of the squares with weights 1/sigma_i^2, in which neither part is negative. Each
 * part's chi-square, minimised over the other, is convex, so its interval ends where it has grown
 * by the square of a normal quantile. A part at the boundary is half of the time 0 by chance, so
 * the one-sided quantile decides whether it is there. */
#include "imukit/identify_joint.h"

#include "model/model_internal.h"

#include "imukit/distributions.h"

#include <math.h>

enum { READING, WHITE, PARTS };

typedef struct readings {
    size_t count;
    const double *dt, *square, *sigma;
} readings;

static double basis(const readings *s, int part, size_t i)
{
    return part == READING ? 1 : 1 / s->dt[i];
}

static double chi_square(const readings *s, const double *part)
{
    double sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double d = s->square[i] - part[READING] - part[WHITE] / s->dt[i];
        sum += d * d / (s->sigma[i] * s->sigma[i]);
    }
    return sum;
}

/* The likeliest other part, at least 0, where `part` has a value; *curvature: of it alone. */
static double other_of(const readings *s, int part, double value, double *curvature)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double w = 1 / (s->sigma[i] * s->sigma[i]), b = basis(s, !part, i);
        sum += w * b * (s->square[i] - value * basis(s, part, i));
        squares += w * b * b;
    }
    if (curvature)
        *curvature = squares;
    return fmax(0, sum / squares);
}

static double profile(const readings *s, int part, double value)
{
    double pair[PARTS];
    pair[part] = value;
    pair[!part] = other_of(s, part, value, NULL);
    return chi_square(s, pair);
}

/* Both parts free but not negative. */
static void solve(const readings *s, double *pair)
{
    double a[PARTS][PARTS] = {{0}}, c[PARTS] = {0};
    for (size_t i = 0; i < s->count; i++)
        for (int p = 0; p < PARTS; p++) {
            const double w = basis(s, p, i) / (s->sigma[i] * s->sigma[i]);
            c[p] += w * s->square[i];
            for (int q = 0; q < PARTS; q++)
                a[p][q] += w * basis(s, q, i);
        }
    const double determinant = a[0][0] * a[1][1] - a[0][1] * a[0][1];
    pair[READING] = (a[1][1] * c[0] - a[0][1] * c[1]) / determinant;
    pair[WHITE] = (a[0][0] * c[1] - a[0][1] * c[0]) / determinant;
    if (pair[READING] >= 0 && pair[WHITE] >= 0)
        return;
    const double white[PARTS] = {0, other_of(s, READING, 0, NULL)};
    const double reading[PARTS] = {other_of(s, WHITE, 0, NULL), 0};
    const bool first = chi_square(s, reading) <= chi_square(s, white);
    pair[READING] = first ? reading[READING] : 0;
    pair[WHITE] = first ? 0 : white[WHITE];
}

/* Where the profile of a part has grown to a limit, between a value below it and one above. */
static double crossing(const readings *s, int part, double inside, double outside, double limit)
{
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (inside + outside);
        if (profile(s, part, middle) < limit)
            inside = middle;
        else
            outside = middle;
    }
    return inside;
}

/* @param lone  its square if the other is not there; 0: the other is, or neither is told
 * @param z     quantile of the confidence */
static imk_estimate estimate_of(const readings *s, int part, const double *best, bool present,
                                double lone, double z)
{
    const double limit = chi_square(s, best) + z * z;
    double lower = 0, outside = best[part], curvature;
    (void)other_of(s, !part, 0, &curvature);
    while (outside = 2 * outside + z / sqrt(curvature), profile(s, part, outside) < limit)
        ;
    double upper = crossing(s, part, best[part], outside, limit);
    if (profile(s, part, 0) > limit)
        lower = crossing(s, part, best[part], 0, limit);
    double square = best[part], sigma = (upper - lower) / (2 * z);
    if (lone > 0) {
        square = lone;
        sigma = 1 / sqrt(curvature);
        lower = fmin(lower, fmax(0, lone - z * sigma));
        upper = fmax(upper, lone + z * sigma);
    }
    imk_estimate e = {.present = present, .upper = sqrt(upper), .free_value = sqrt(best[part])};
    if (present && square > 0) {
        e.value = sqrt(square);
        e.sigma = sigma / (2 * e.value);
        e.lower = sqrt(lower);
    }
    return e;
}

static imk_status check(const readings *s, double confidence, double significance)
{
    double shortest = INFINITY, longest = 0;
    for (size_t i = 0; i < s->count; i++) {
        if (!isfinite(s->square[i]) || !isfinite(s->sigma[i]) || !isfinite(s->dt[i]))
            return IMK_ERROR_NOT_FINITE;
        if (!(s->sigma[i] > 0) || !(s->dt[i] > 0))
            return IMK_ERROR_RANGE;
        shortest = fmin(shortest, s->dt[i]);
        longest = fmax(longest, s->dt[i]);
    }
    if (!(confidence > 0 && confidence < 1 && significance > 0 && significance < 1))
        return IMK_ERROR_RANGE;
    return longest > shortest * (1 + 1e-3) ? IMK_OK : IMK_ERROR_TOO_SHORT;
}

imk_status imk_reading_parts_estimate(size_t count, const double *dt, const double *squares,
                                      const double *sigmas, double confidence, double significance,
                                      imk_reading_parts *parts)
{
    const readings s = {count, dt, squares, sigmas};
    *parts = (imk_reading_parts){0};
    const imk_status status = check(&s, confidence, significance);
    if (status != IMK_OK)
        return status;
    const double z = imk_normal_quantile(0.5 + confidence / 2);
    const double needed = imk_normal_quantile(1 - significance);
    double best[PARTS];
    solve(&s, best);
    const double least = chi_square(&s, best);
    bool there[PARTS], any = false;
    for (int p = 0; p < PARTS; p++) {
        there[p] = profile(&s, p, 0) - least > needed * needed;
        any = any || there[p];
    }
    const bool both = there[READING] && there[WHITE];
    parts->count = count;
    parts->kind = both             ? IMK_READING_BOTH
                  : there[READING] ? IMK_READING_ALIKE
                  : there[WHITE]   ? IMK_READING_WHITE
                                   : IMK_READING_UNTOLD;
    imk_estimate *const estimate[PARTS] = {&parts->reading_noise, &parts->angle_white};
    for (int p = 0; p < PARTS; p++) {
        const double lone = there[p] && !both ? other_of(&s, !p, 0, NULL) : 0;
        *estimate[p] = estimate_of(&s, p, best, there[p], lone, z);
        if (lone > 0)
            parts->chi_square = profile(&s, !p, 0);
    }
    if (both || !any)
        parts->chi_square = least;
    parts->degrees = count - (both ? 2 : 1);
    parts->probability =
        parts->degrees > 0 ? imk_gamma_upper(0.5 * (double)parts->degrees, 0.5 * parts->chi_square)
                           : 1;
    return IMK_OK;
}

static void store(const imk_estimate *e, imk_axes *axes, imk_evidence *evidence, const char *key,
                  int axis)
{
    imk_interval *interval = imki_evidence_interval(evidence, key, 0);
    axes->value[axis] = e->value;
    axes->sigma[axis] = e->sigma;
    if (interval) {
        interval->lower.value[axis] = e->lower;
        interval->upper.value[axis] = e->upper;
    }
}

void imk_reading_parts_store(const imk_reading_parts *parts, imk_model *model, int sensor, int axis)
{
    static const char *const white[2] = {"noise.angle_white", "noise.velocity_white"};
    imk_noise *noise = &imk_model_triad_to_set(model, sensor)->noise;
    imk_evidence *evidence = sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    if (parts->count == 0 || parts->kind == IMK_READING_UNTOLD)
        return;
    store(&parts->reading_noise, &noise->reading_noise, evidence, "noise.reading_noise", axis);
    store(&parts->angle_white, &noise->angle_white, evidence, white[sensor], axis);
}
