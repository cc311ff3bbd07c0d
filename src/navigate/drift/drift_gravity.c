/* SPDX-License-Identifier: Apache-2.0 */
/* Deviations of gravity from normal gravity across the vertical: along the path two independent
 * Gauss-Markov processes, north and east, of first order in the distance d that the unit has gone,
 *
 *     E[g(x) g(y)] = sigma^2 exp(-|x - y|/d)
 *
 * so that at the ground speed v they decay in time with v/d, and at rest not at all. The truth has
 * them and the navigator has not: what is read is the force with normal gravity, less them. */
#include "drift_runs_internal.h"

#include "drift_covariance_internal.h"
#include "imukit/elementary.h"
#include "imukit/noise.h"

#include <math.h>

static double ground_speed(const imk_motion_state *state)
{
    return hypot(state->velocity_ned.v[0], state->velocity_ned.v[1]);
}

double imki_gravity_decay(const imk_drift_settings *settings, const imk_motion_state *state)
{
    return settings->gravity_distance > 0.0 ? ground_speed(state) / settings->gravity_distance
                                            : 0.0;
}

/* ---- covariance ---- */

void imki_drift_gravity_source(imki_drift_plan *plan, const imk_drift_settings *settings)
{
    const double sigma = settings->gravity_deflection;
    const imki_drift_driver standing = {.states = 1, .start = {1.0, 0.0}};
    if (sigma == 0.0)
        return;
    imki_drift_add_source(plan, "gravity", "deflection", "", "deflection of gravity");
    for (int axis = 0; axis < 2; axis++) {
        const imki_drift_column column =
            imki_drift_column_of(IMKI_COLUMN_GRAVITY, IMK_ACCEL, axis, 0);
        imki_drift_add_noise(plan, IMKI_ELEMENT_NOISE, &column, &standing, sigma * sigma);
    }
}

/* The speed over a step by Simpson's rule. */
void imki_drift_gravity_step(const imk_drift_settings *settings, bool rests, imki_drift_step *step)
{
    const imki_drift_node *node = step->node;
    imki_drift_driver driver = {.states = 1, .start = {1.0, 0.0}};
    if (settings->gravity_deflection == 0.0)
        return;
    if (!rests) {
        const double rate = (imki_gravity_decay(settings, &node[0].state) +
                             4.0 * imki_gravity_decay(settings, &node[2].state) +
                             imki_gravity_decay(settings, &node[4].state)) /
                            6.0;
        driver.a[0][0] = -rate;
        driver.w[0] = 2.0 * rate;
    }
    imki_driver_over(&driver, step->h, step->moments, &step->gravity);
}

/* ---- Monte Carlo ---- */

/* In the middle of the row: a tenth of a row would not be seen. */
void imki_gravity_rows(const imk_drift_settings *settings, const imk_trajectory *trajectory,
                       double start, double interval, uint64_t first, size_t count,
                       imki_gravity_row *row)
{
    imk_motion_state state;
    for (size_t k = 0; k < count; k++) {
        const bool known = k > 0 && settings->motion == NULL;
        if (!known)
            imk_trajectory_state(trajectory, start + ((double)first + (double)k - 0.5) * interval,
                                 &state);
        for (int i = 0; i < 3; i++) {
            row[k].north[i] = state.c_nb.m[0][i];
            row[k].east[i] = state.c_nb.m[1][i];
        }
        const double rate = settings->motion ? imki_gravity_decay(settings, &state) : 0.0;
        row[k].keep = rate > 0.0 ? imk_exp(-rate * interval) : 1.0;
    }
}

/* Axis i is the stream (run, IMK_TERM_GRAVITY, 0, i); row k draws its normal k. */
void imki_gravity_deflect(const imk_drift_settings *settings, imk_random random, uint32_t run,
                          uint64_t first, size_t count, const imki_gravity_row *row,
                          double deflection[2], double *const force[3])
{
    enum { DRAWS = IMK_NOISE_BLOCK };
    double normal[2][DRAWS];
    for (size_t done = 0; done < count; done += DRAWS) {
        const size_t rows = count - done < DRAWS ? count - done : DRAWS;
        for (uint8_t axis = 0; axis < 2; axis++)
            imk_random_normals(random, imk_stream(run, IMK_TERM_GRAVITY, 0, axis), first + done,
                               rows, normal[axis]);
        for (size_t k = done; k < done + rows; k++) {
            const double keep = first + k == 0 ? 0.0 : row[k].keep;
            const double fresh = settings->gravity_deflection * sqrt((1.0 - keep) * (1.0 + keep));
            for (int axis = 0; axis < 2; axis++)
                deflection[axis] = keep * deflection[axis] + fresh * normal[axis][k - done];
            for (int i = 0; i < 3; i++)
                force[i][k] -= deflection[0] * row[k].north[i] + deflection[1] * row[k].east[i];
        }
    }
}
