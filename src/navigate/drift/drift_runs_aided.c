/* SPDX-License-Identifier: Apache-2.0 */
/* Runs of an aided navigator: the filter itself, with readings of aids whose errors are drawn.
 *
 * Of aid k, white noise of reading j on axis i is normal j of the stream (run, IMK_TERM_AID, k, i),
 * and its correlated error s, at the times of the readings whether they are used or not,
 *
 *     s_0 = c n_0,   s_j = a s_(j-1) + c sqrt(1 - a^2) n_j,   a = e^(-interval/T),
 *
 * n_j normal j of the stream (…, k, 3 + i). The error of a lever arm along body axis i is normal 0
 * of (…, k, 6 + i), k the first of the aids at its point. */
#include "drift_aided_internal.h"
#include "drift_runs_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "imukit/noise.h"
#include "imukit/simulate.h"

#include <math.h>
#include <string.h>

/* ---- draws ---- */

static double draw(const imki_aided_run *r, size_t aid, int axis, uint64_t number)
{
    double normal;
    imk_random_normals(r->random, imk_stream(r->number, IMK_TERM_AID, (uint8_t)aid, (uint8_t)axis),
                       number, 1, &normal);
    return normal;
}

/* The errors of the next reading. */
static void next_errors(imki_aided_run *r, size_t aid, double off[3])
{
    const imk_aid *of = &r->settings->aid[aid];
    const uint64_t number = r->next[aid];
    const double time = of->correlation_time;
    const double lost = time > 0.0 ? -imk_expm1(-of->interval / time) : 1.0;
    for (int i = 0; i < 3; i++) {
        const bool measured = isfinite(of->sigma[i]);
        double *slow = &r->slow[aid][i];
        off[i] = 0.0;
        if (measured && of->correlated_sigma[i] > 0.0) {
            const double fresh = number == 0 ? 1.0 : sqrt(lost * (2.0 - lost));
            *slow = (number == 0 ? 0.0 : (1.0 - lost) * *slow) +
                    of->correlated_sigma[i] * fresh * draw(r, aid, 3 + i, number);
            off[i] += *slow;
        }
        if (measured)
            off[i] += of->sigma[i] * draw(r, aid, i, number);
    }
}

/* ---- a run ---- */

imk_status imki_aided_run_start(imki_aided_run *r, const imk_drift_settings *settings,
                                const imk_navigation_filter_settings *filter,
                                const imk_navigation_state *start, imk_random random,
                                uint32_t number, imk_error *error)
{
    void *memory = r->memory;
    const size_t size = r->memory_size;
    memset(r, 0, sizeof *r);
    r->memory = memory;
    r->memory_size = size;
    r->settings = settings;
    r->random = random;
    r->number = number;
    for (size_t k = 0; k < settings->aid_count; k++) {
        const imk_aid *aid = &settings->aid[k];
        const size_t point = imki_aid_point(settings->aid, k);
        for (int i = 0; i < 3; i++)
            r->arm[k][i] =
                aid->lever_arm[i] + (aid->lever_arm_sigma[i] > 0.0
                                         ? aid->lever_arm_sigma[i] * draw(r, point, 6 + i, 0)
                                         : 0.0);
    }
    return imk_navigation_filter_start(filter, start, &r->filter, memory, size, error);
}

/* Is an aid read at the end of a row, counted from the start of navigation? */
static bool reads(const imki_aided_run *r, uint64_t row)
{
    for (size_t k = 0; k < r->settings->aid_count; k++)
        if (imki_aid_row(&r->settings->aid[k], r->next[k], r->settings->rate) <= row)
            return true;
    return false;
}

static void read_aids(imki_aided_run *r, uint64_t row, const imk_motion_state *truth)
{
    for (size_t k = 0; k < r->settings->aid_count; k++) {
        const imk_aid *aid = &r->settings->aid[k];
        while (imki_aid_row(aid, r->next[k], r->settings->rate) <= row) {
            imk_aid_reading reading = {.time = imk_navigation_filter_state(r->filter).time};
            double off[3];
            next_errors(r, k, off);
            r->next[k]++;
            if (aid->kind == IMK_AID_ZERO_VELOCITY && !imki_drift_stands(truth))
                continue;
            imki_aid_reading(aid, truth, r->arm[k], off, reading.value);
            (void)imk_navigation_filter_aid(r->filter, k, &reading);
        }
    }
}

/* Height and climb that are held: those of the truth, without the jitter of the clock. */
static void make_heights(const imki_aided_rows *rows, size_t from, size_t to)
{
    size_t place[IMK_NOISE_BLOCK];
    for (size_t k = from; k < to; k++) {
        place[k - from] = k;
        rows->time[k - from] = rows->start + (double)(rows->first + k) * rows->interval;
    }
    imki_drift_heights(rows->trajectory, to - from, place, rows->time, rows->height, rows->climb);
}

void imki_aided_run_take(imki_aided_run *r, const imki_aided_rows *rows, size_t from, size_t to)
{
    const bool held = r->filter->settings.hold_height;
    if (held && rows->moves)
        make_heights(rows, from, to);
    for (size_t k = from; k < to; k++) {
        const uint64_t row = rows->first + k - rows->before;
        imk_vector3 turn, gain;
        for (int i = 0; i < 3; i++) {
            turn.v[i] = rows->column[i][k] * rows->dt;
            gain.v[i] = rows->column[3 + i][k] * rows->dt;
        }
        if (held) {
            r->filter->strapdown.height = rows->height[k];
            r->filter->strapdown.climb = rows->climb[k];
        }
        imk_navigation_filter_step(r->filter, rows->dt, turn, gain);
        if (!reads(r, row))
            continue;
        imk_motion_state truth;
        imk_trajectory_state(rows->trajectory,
                             imk_simulator_true_time(rows->simulator, (int64_t)(rows->first + k)),
                             &truth);
        read_aids(r, row, &truth);
    }
}

/* ---- consistency ---- */

enum { ERRORS = IMK_NAVIGATION_ERRORS };

/* Estimate minus truth in north-east-down axes. */
static void error_of(const imk_navigation_state *state, const imk_navigation_state *truth,
                     const imk_matrix3 *axes, double e[ERRORS])
{
    const imk_matrix3 to = imk_matrix3_transpose(*axes);
    const imk_quaternion turn =
        imk_quaternion_multiply(state->attitude, imk_quaternion_conjugate(truth->attitude));
    const imk_vector3 error[3] = {imk_vector3_subtract(state->position, truth->position),
                                  imk_vector3_subtract(state->velocity, truth->velocity),
                                  imk_quaternion_to_rotation_vector(turn)};
    for (int part = 0; part < 3; part++) {
        const imk_vector3 ned = imk_matrix3_apply(to, error[part]);
        memcpy(e + (ptrdiff_t)3 * part, ned.v, sizeof ned.v);
    }
}

/* The filter's covariance in the same axes. */
static void covariance_of(const imki_aided_run *r, const imk_matrix3 *axes,
                          double a[ERRORS][ERRORS])
{
    const double *p = imki_navigation_filter_covariance(r->filter);
    const size_t n = r->filter->states;
    for (size_t i = 0; i < ERRORS; i++)
        for (size_t j = 0; j < ERRORS; j++) {
            a[i][j] = 0.0;
            for (size_t k = 0; k < 3; k++)
                for (size_t l = 0; l < 3; l++)
                    a[i][j] += axes->m[k][i % 3] * axes->m[l][j % 3] *
                               p[(i / 3 * 3 + k) * n + j / 3 * 3 + l];
        }
}

/* e^T A^-1 e of the rows `index`, scaled, as units differ by orders of magnitude. */
static double normalised(const double e[ERRORS], double a[ERRORS][ERRORS], const size_t *index,
                         size_t count)
{
    double scaled[ERRORS * ERRORS], x[ERRORS], solved[ERRORS], sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        const size_t u = index[i];
        x[i] = solved[i] = e[u] / sqrt(a[u][u]);
        for (size_t j = 0; j < count; j++)
            scaled[i * count + j] = a[u][index[j]] / sqrt(a[u][u] * a[index[j]][index[j]]);
    }
    if (imk_cholesky_factor(count, scaled) != IMK_OK)
        return (double)NAN;
    imk_cholesky_solve(count, scaled, solved);
    for (size_t i = 0; i < count; i++)
        sum += x[i] * solved[i];
    return sum;
}

double imki_aided_run_nees(imki_aided_run *r, const imk_navigation_state *truth)
{
    const imk_navigation_state state = imk_navigation_filter_state(r->filter);
    const imk_geodetic place = imk_geodetic_from_ecef(state.position);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const bool held = imk_drift_vertical(r->settings) == IMK_VERTICAL_SLAVED;
    double a[ERRORS][ERRORS], e[ERRORS];
    size_t index[ERRORS], count = 0;
    for (size_t i = 0; i < ERRORS; i++)
        if (!(held && (i == 2 || i == 5)))
            index[count++] = i;
    error_of(&state, truth, &axes, e);
    covariance_of(r, &axes, a);
    return normalised(e, a, index, count);
}
