/* SPDX-License-Identifier: Apache-2.0 */
/* Knocks, a hand on the unit, a power cut: pieces of the log that are away from what is beside them
 * on both sides are put to the level between the sides. The fullest fit is taken out first, so that
 * what remains is flat; it is repeated without them, since large ones bend the first fit. */
#include "calibrate/standstill/median_internal.h"
#include "imukit/linear_algebra.h"
#include "thermal_internal.h"

#include <math.h>
#include <string.h>

enum { N = IMKI_THERMAL_COLUMNS, ROUNDS = 8 };

/* The fit of all columns to what is not disturbed, and residuals of one axis about it; where two
 * columns are one, a ten-millionth of the diagonal keeps them apart, which is far below what is
 * looked for. */
static void residuals(const imki_thermal_blocks *blocks, int axis, const bool *disturbed,
                      double *fitted, double *residual)
{
    const double ridge = 1e-7;
    double a[N * N], b[N];
    for (int i = 0; i < N; i++) {
        b[i] = 0.0;
        for (size_t p = 0; p < blocks->count; p++)
            if (!disturbed[p])
                b[i] += blocks->column[i][p] * blocks->reading[axis][p];
        for (int j = 0; j < N; j++) {
            a[i * N + j] = 0.0;
            for (size_t p = 0; p < blocks->count; p++)
                if (!disturbed[p])
                    a[i * N + j] += blocks->column[i][p] * blocks->column[j][p];
        }
        a[i * N + i] *= 1.0 + ridge;
    }
    const bool fits = imk_cholesky_factor(N, a) == IMK_OK;
    if (fits)
        imk_cholesky_solve(N, a, b);
    for (size_t p = 0; p < blocks->count; p++) {
        fitted[p] = 0.0;
        for (int i = 0; fits && i < N; i++)
            fitted[p] += b[i] * blocks->column[i][p];
        residual[p] = blocks->reading[axis][p] - fitted[p];
    }
}

/* Median of the next undisturbed pieces in a direction; NaN: there are none. Fifteen of them
 * outvote a disturbance of seven pieces that is not known yet. */
static double level_beside(size_t n, const double *residual, const bool *disturbed, size_t from,
                           int step)
{
    enum { SIDE = 15 };
    double near[SIDE];
    size_t count = 0;
    for (size_t p = from + (size_t)step; p < n && count < SIDE; p += (size_t)step)
        if (!disturbed[p])
            near[count++] = residual[p];
    return count > 0 ? imki_median(near, count) : (double)NAN;
}

/* How far a piece is beyond the levels on both sides: what goes on from one to the other is no
 * disturbance. @param level  what it is put to instead */
static double stands_out(size_t n, const double *residual, const bool *disturbed, size_t p,
                         double *level)
{
    const double before = level_beside(n, residual, disturbed, p, -1);
    const double after = level_beside(n, residual, disturbed, p, 1);
    const double a = isnan(before) ? after : before, b = isnan(after) ? before : after;
    const double low = fmin(a, b), high = fmax(a, b), r = residual[p];
    *level = 0.5 * (a + b);
    return r > high ? r - high : r < low ? low - r : 0.0;
}

/* Six sigmas of what neighbours differ by, and four of the residuals, so that what the fit cannot
 * follow, such as the turn of a loop, is not taken for a disturbance; both by medians. */
static double limit_of(size_t n, const double *residual)
{
    const double sigma_of_median = 1.4826;
    double step[IMKI_THERMAL_PIECES], size[IMKI_THERMAL_PIECES];
    for (size_t p = 0; p + 1 < n; p++)
        step[p] = fabs(residual[p + 1] - residual[p]) / sqrt(2.0);
    for (size_t p = 0; p < n; p++)
        size[p] = fabs(residual[p]);
    return sigma_of_median * fmax(6.0 * imki_median(step, n - 1), 4.0 * imki_median(size, n));
}

/* Every round assesses all pieces anew, by the fit without those of the round before. */
static void screen_axis(imki_thermal_blocks *blocks, int axis)
{
    const size_t n = blocks->count;
    bool *disturbed = blocks->disturbed[axis], now[IMKI_THERMAL_PIECES];
    double fitted[IMKI_THERMAL_PIECES], residual[IMKI_THERMAL_PIECES], level;
    size_t refused = 0;
    bool changed = true;
    for (int round = 0; round < ROUNDS && changed; round++) {
        residuals(blocks, axis, disturbed, fitted, residual);
        const double limit = limit_of(n, residual);
        changed = false;
        for (size_t p = 0; p < n; p++) {
            now[p] = stands_out(n, residual, disturbed, p, &level) > limit;
            changed = changed || now[p] != disturbed[p];
        }
        memcpy(disturbed, now, n * sizeof *now);
    }
    for (size_t p = 0; p < n; p++) {
        if (!disturbed[p])
            continue;
        stands_out(n, residual, disturbed, p, &level);
        if (!isnan(level))
            blocks->reading[axis][p] = fitted[p] + level;
        refused++;
    }
    blocks->refused[axis] = (double)refused / (double)n;
}

void imki_thermal_screen(imki_thermal_blocks *blocks)
{
    for (int axis = 0; axis < IMKI_THERMAL_AXES; axis++)
        if (blocks->used[axis])
            screen_axis(blocks, axis);
}
