/* SPDX-License-Identifier: Apache-2.0 */
/* The states of an aided navigator behind its nine errors: y, what its filter has estimated of
 * biases and of the errors of aids, with the sign of an error, so that what is left of a bias b is
 * b + y. Over a step, with G what a constant error of the six readings does, and S the sum over
 * the parts of a bias,
 *
 *     x <- phi x + G S y + what the errors of the readings do,      y <- E y,
 *
 * E being the decay of the estimates of Gauss-Markov processes, which the filter applies where it
 * propagates its covariance. At an update with the filter's own gain K and matrix H
 * [GELB1974, 7.1],
 *
 *     (x, y) <- (I - K H) (x, y) - K v,
 *
 * v being what true errors are in what is measured: those of the aid, the unestimated part of which
 * is H y + v, and what a column carries (x - c s is kept, so that v has H c s). */
#include "drift_aided_internal.h"

#include <string.h>

enum { ROWS = IMKI_UPDATE_ROWS };

/* S y: six sums. */
static void add_up(const imki_aided_step *step, const double *x, double sum[6])
{
    const double *y = x + 9;
    for (int i = 0; i < 6; i++)
        sum[i] = 0.0;
    for (size_t sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < step->parts[sensor]; p++, y += 3)
            for (size_t axis = 0; axis < 3; axis++)
                sum[3 * sensor + axis] += y[axis];
}

void imki_feed_vector(const imki_aided_step *step, double *x, double moved[9])
{
    double sum[6];
    add_up(step, x, sum);
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 6; k++)
            moved[i] += step->gamma[i][k] * sum[k];
    if (step->decays)
        for (size_t i = 9; i < step->states; i++)
            x[i] *= step->decay[i - 9];
}

void imki_feed_states(size_t n, imki_drift_element *element, int states, double b[2][9],
                      const imki_driver_step *driver, double *p)
{
    double *first = element->cross[0], *second = element->cross[1];
    for (int s = 0; s < states; s++)
        for (size_t i = 0; i < 9; i++)
            for (size_t j = 9; j < n; j++) {
                const double part = b[s][i] * element->cross[s][j];
                p[i * n + j] += part;
                p[j * n + i] += part;
            }
    for (size_t j = 9; j < n && states > 0; j++) {
        const double z[2] = {first[j], states > 1 ? second[j] : 0.0};
        first[j] = driver->phi[0][0] * z[0] + driver->phi[0][1] * z[1];
        if (states > 1)
            second[j] = driver->phi[1][0] * z[0] + driver->phi[1][1] * z[1];
    }
}

/* The sums of the rows of P that belong to the same bias. */
static void add_up_rows(const imki_aided_step *step, const double *p, size_t n,
                        double sum[6][IMKI_FILTER_STATES_MAX])
{
    const double *row = p + 9 * n;
    for (size_t k = 0; k < 6; k++)
        memset(sum[k], 0, n * sizeof sum[k][0]);
    for (size_t sensor = 0; sensor < 2; sensor++)
        for (size_t part = 0; part < step->parts[sensor]; part++)
            for (size_t axis = 0; axis < 3; axis++, row += n)
                for (size_t j = 0; j < n; j++)
                    sum[3 * sensor + axis][j] += row[j];
}

void imki_feed_covariance(size_t n, const imki_drift_step *step, double *p)
{
    const imki_aided_step *aided = step->aided;
    double sum[6][IMKI_FILTER_STATES_MAX], moved[9][IMKI_FILTER_STATES_MAX];
    add_up_rows(aided, p, n, sum);
    for (size_t i = 0; i < 9; i++) {
        memset(moved[i], 0, n * sizeof moved[i][0]);
        for (size_t k = 0; k < 9; k++)
            for (size_t j = 0; j < n; j++)
                moved[i][j] += step->phi.m[i][k] * p[k * n + j];
        for (size_t k = 0; k < 6; k++)
            for (size_t j = 0; j < n; j++)
                moved[i][j] += aided->gamma[i][k] * sum[k][j];
    }
    for (size_t i = 0; i < 9; i++) {
        double turned[9] = {0.0}, along[6];
        add_up(aided, moved[i], along);
        for (size_t j = 0; j < 9; j++) {
            for (size_t k = 0; k < 9; k++)
                turned[j] += moved[i][k] * step->phi.m[j][k];
            for (size_t k = 0; k < 6; k++)
                turned[j] += along[k] * aided->gamma[j][k];
        }
        memcpy(p + i * n, turned, sizeof turned);
        for (size_t j = 9; j < n; j++)
            p[i * n + j] = p[j * n + i] = moved[i][j] * (aided->decays ? aided->decay[j - 9] : 1.0);
    }
    for (size_t i = 9; i < n && aided->decays; i++)
        for (size_t j = 9; j < n; j++)
            p[i * n + j] *= aided->decay[i - 9] * aided->decay[j - 9];
}

/* ---- updates -----------------------------------------------------------------------------------
 */

/* x <- x - K z */
static void take_out(const imki_drift_update *update, size_t n, const double z[ROWS], double *x)
{
    for (size_t i = 0; i < n; i++)
        for (size_t r = 0; r < update->rows; r++)
            x[i] -= update->gain[i * update->rows + r] * z[r];
}

static void measure(const imki_drift_update *update, size_t n, const double *x, double z[ROWS])
{
    for (size_t r = 0; r < update->rows; r++) {
        z[r] = 0.0;
        for (size_t k = 0; k < n; k++)
            z[r] += update->h[r * n + k] * x[k];
    }
}

/* P <- (I - K H) P (I - K H)^T, symmetric to the bit: what rounding makes unsymmetric would not be
 * taken out by the updates, and grow. */
static void update_covariance(const imki_drift_update *update, size_t n, double *p)
{
    const size_t rows = update->rows;
    double hp[ROWS][IMKI_FILTER_STATES_MAX], s[ROWS][ROWS];
    for (size_t r = 0; r < rows; r++) {
        memset(hp[r], 0, n * sizeof hp[r][0]);
        for (size_t k = 0; k < n; k++)
            if (update->h[r * n + k] != 0.0)
                for (size_t j = 0; j < n; j++)
                    hp[r][j] += update->h[r * n + k] * p[k * n + j];
    }
    for (size_t r = 0; r < rows; r++)
        measure(update, n, hp[r], s[r]);
    for (size_t i = 0; i < n; i++) {
        const double *gain = update->gain + i * rows;
        double scaled[ROWS];
        for (size_t r = 0; r < rows; r++) {
            scaled[r] = -hp[r][i];
            for (size_t q = 0; q < rows; q++)
                scaled[r] += gain[q] * s[q][r];
        }
        for (size_t j = 0; j <= i; j++) {
            double sum = 0.5 * (p[i * n + j] + p[j * n + i]);
            for (size_t r = 0; r < rows; r++)
                sum += scaled[r] * update->gain[j * rows + r] - gain[r] * hp[r][j];
            p[i * n + j] = p[j * n + i] = sum;
        }
    }
}

/* P += factor g g^T */
static void add_square(double *p, size_t n, double factor, const double *g)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            p[i * n + j] += factor * (g[i] * g[j]);
}

/* An element of noise: S <- (I - K H) S - g Z, and what g = K a of its driver's output does to P.
 * Of rounding this is the last remainder, which is white; `white` is the variance per size of other
 * white noise. */
static void update_noise(const imki_drift_update *update, size_t n, imki_drift_element *element,
                         int states, double white, double *p)
{
    double g[IMKI_FILTER_STATES_MAX] = {0.0}, z[ROWS];
    const double *a = update->enter[element->column];
    bool enters = false;
    for (size_t r = 0; r < update->rows; r++) {
        enters = enters || a[r] != 0.0;
        z[r] = -a[r];
    }
    if (enters)
        take_out(update, n, z, g);
    for (int s = 0; s < states; s++) {
        measure(update, n, element->cross[s], z);
        take_out(update, n, z, element->cross[s]);
    }
    if (!enters)
        return;
    const double variance = element->use == IMKI_ELEMENT_ROUNDING
                                ? element->state[0] * element->state[0]
                            : states == 0 ? element->size * white
                                          : element->covariance[0][0];
    if (element->use != IMKI_ELEMENT_ROUNDING && states > 0) {
        const double *cross = element->cross[0];
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                p[i * n + j] -= cross[i] * g[j] + g[i] * cross[j];
        for (int s = 0; s < states; s++)
            for (size_t i = 0; i < n; i++)
                element->cross[s][i] -= g[i] * element->covariance[0][s];
    }
    add_square(p, n, variance, g);
}

static void update_constant(const imki_drift_update *update, size_t n, imki_drift_element *element)
{
    double z[ROWS];
    measure(update, n, element->x, z);
    for (size_t r = 0; r < update->rows; r++)
        z[r] += update->enter[element->column][r] * element->state[0];
    take_out(update, n, z, element->x);
}

void imki_drift_update_part(const imki_drift_plan *plan, imki_drift_part *part,
                            const imki_aided_step *step)
{
    const size_t n = plan->states;
    for (size_t u = 0; u < step->update_count; u++) {
        const imki_drift_update *update = &step->update[u];
        bool noisy = false;
        for (size_t i = part->first; i < part->first + part->count; i++) {
            imki_drift_element *element = &plan->element[i];
            const bool noise =
                element->use == IMKI_ELEMENT_NOISE || element->use == IMKI_ELEMENT_ROUNDING;
            if (noise && !noisy)
                update_covariance(update, n, part->covariance);
            noisy = noisy || noise;
            const bool of_aid = plan->column[element->column].kind == IMKI_COLUMN_AID;
            if (noise)
                update_noise(update, n, element, plan->driver[element->driver].states,
                             of_aid ? 1.0 : step->rate, part->covariance);
            else
                update_constant(update, n, element);
        }
    }
}
