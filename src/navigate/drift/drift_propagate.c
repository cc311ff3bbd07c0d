/* SPDX-License-Identifier: Apache-2.0 */
/* One source of error over a step: with phi and the polynomial coefficients a_k of its column, and
 * the driver's transition p, gains m_k and noise (drift_driver.c),
 *
 *     constants  x <- phi x + B z,   z <- p z,   B = sum a_k m_k^T
 *     noise      P <- phi P phi^T + phi S B^T + B S^T phi^T + B Z B^T + sum a_k a_l^T q_kl
 *                S <- (phi S + B Z) p^T + sum a_k c_k^T,   Z <- p Z p^T + Q
 *
 * P being the covariance of x, S that of x with the driver's states z, and Z that of these. A
 * source adds up its elements, which are independent: one P for all, an S and Z for each. Behind
 * these nine, an aided navigator has more states: drift_feedback.c. */
#include "drift_aided_internal.h"
#include "drift_correlation_internal.h"

#include "imukit/distort.h"

#include <string.h>

/* ---- constants ---- */

static void move_constant(imki_drift_element *element, const imki_drift_step *step,
                          const imki_driver_step *driver)
{
    double(*a)[9] = step->column[element->column];
    double x[9];
    for (int i = 0; i < 9; i++) {
        double sum = 0.0;
        for (int j = 0; j < 9; j++)
            sum += step->phi.m[i][j] * element->x[j];
        x[i] = sum;
    }
    const double z[2] = {element->state[0], element->state[1]};
    for (int k = 0; k < step->moments; k++) {
        const double integral = driver->gain[k][0] * z[0] + driver->gain[k][1] * z[1];
        for (int i = 0; i < 9; i++)
            x[i] += a[k][i] * integral;
    }
    if (step->aided)
        imki_feed_vector(step->aided, element->x, x);
    memcpy(element->x, x, sizeof x);
    for (int i = 0; i < 2; i++)
        element->state[i] = driver->phi[i][0] * z[0] + driver->phi[i][1] * z[1];
}

/* ---- noise ---- */

/* Of p, n x n, the first nine rows and columns: so all of them here. */
void imki_drift_turn_covariance(double *p, size_t n, const imki_matrix9 *phi)
{
    imki_matrix9 half = {{{0.0}}}, turned, whole = {{{0.0}}};
    for (int i = 0; i < 9; i++)
        for (size_t k = 0; k < 9; k++)
            for (size_t j = 0; j < 9; j++)
                half.m[i][j] += phi->m[i][k] * p[k * n + j];
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            turned.m[i][j] = phi->m[j][i];
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 9; k++)
            for (int j = 0; j < 9; j++)
                whole.m[i][j] += half.m[i][k] * turned.m[k][j];
    for (size_t i = 0; i < 9; i++)
        memcpy(p + i * n, whole.m[i], sizeof whole.m[i]);
}

/* p += sum a_k a_l^T weight_kl, symmetric */
static void add_columns(double *p, size_t n, double (*a)[9], int moments,
                        double weight[IMKI_DRIFT_MOMENTS][IMKI_DRIFT_MOMENTS])
{
    for (int k = 0; k < moments; k++) {
        double b[9] = {0.0};
        for (int l = 0; l < moments; l++)
            for (int j = 0; j < 9; j++)
                b[j] += weight[k][l] * a[l][j];
        for (size_t i = 0; i < 9; i++)
            for (size_t j = 0; j < 9; j++)
                p[i * n + j] += a[k][i] * b[j];
    }
}

/* p += a b^T + b a^T */
static void add_both(double *p, size_t n, const double a[9], const double b[9])
{
    for (size_t i = 0; i < 9; i++)
        for (size_t j = 0; j < 9; j++)
            p[i * n + j] += a[i] * b[j] + b[i] * a[j];
}

/* What the states of an element's driver do to P and S, of which phi P phi^T is done, and Z. */
static void move_states(imki_drift_element *element, double *p, size_t n,
                        const imki_drift_step *step, const imki_driver_step *driver, int states)
{
    double(*a)[9] = step->column[element->column];
    double moved[2][9] = {{0.0}}, b[2][9] = {{0.0}}, bz[2][9];
    double(*z)[2] = element->covariance;
    for (int s = 0; s < states; s++) {
        for (int i = 0; i < 9; i++)
            for (int j = 0; j < 9; j++)
                moved[s][i] += step->phi.m[i][j] * element->cross[s][j];
        if (step->aided)
            imki_feed_vector(step->aided, element->cross[s], moved[s]);
        for (int k = 0; k < step->moments; k++)
            for (int i = 0; i < 9; i++)
                b[s][i] += a[k][i] * driver->gain[k][s];
    }
    for (int s = 0; s < states; s++) {
        double half[9];
        for (int i = 0; i < 9; i++) {
            bz[s][i] = b[0][i] * z[0][s] + b[1][i] * z[1][s];
            half[i] = moved[s][i] + 0.5 * bz[s][i];
            moved[s][i] += bz[s][i];
        }
        add_both(p, n, half, b[s]);
    }
    if (step->aided)
        imki_feed_states(n, element, states, b, driver, p);
    double next[2][2];
    for (int s = 0; s < states; s++) {
        for (int i = 0; i < 9; i++) {
            double sum = moved[0][i] * driver->phi[s][0] + moved[1][i] * driver->phi[s][1];
            for (int k = 0; k < step->moments; k++)
                sum += element->size * a[k][i] * driver->cross_noise[k][s];
            element->cross[s][i] = sum;
        }
        for (int t = 0; t < states; t++) {
            next[s][t] = element->size * driver->state_noise[s][t];
            for (int i = 0; i < 2; i++)
                for (int j = 0; j < 2; j++)
                    next[s][t] += driver->phi[s][i] * z[i][j] * driver->phi[t][j];
        }
    }
    for (int s = 0; s < states; s++)
        for (int t = 0; t < states; t++)
            z[s][t] = next[s][t];
}

/* ---- a source ---- */

static bool is_noise(const imki_drift_element *element)
{
    return element->use == IMKI_ELEMENT_NOISE || element->use == IMKI_ELEMENT_ROUNDING;
}

/* Elements on one column follow one another: their noises are added first, then put on it. */
static void move_elements(const imki_drift_plan *plan, imki_drift_part *part,
                          const imki_drift_step *step, imki_driver_step (*over)[IMKI_DRIFT_SLOTS])
{
    double weight[IMKI_DRIFT_MOMENTS][IMKI_DRIFT_MOMENTS] = {{0.0}};
    for (size_t i = part->first; i < part->first + part->count; i++) {
        imki_drift_element *element = &plan->element[i];
        const bool of_step = plan->column[element->column].kind == IMKI_COLUMN_GRAVITY;
        const imki_driver_step *driver =
            of_step ? &step->gravity : &over[element->driver][step->slot];
        if (!is_noise(element)) {
            move_constant(element, step, driver);
            continue;
        }
        move_states(element, part->covariance, plan->states, step, driver,
                    plan->driver[element->driver].states);
        for (int k = 0; k < step->moments; k++)
            for (int l = 0; l < step->moments; l++)
                weight[k][l] += element->size * driver->moment_noise[k][l];
        if (i + 1 < part->first + part->count && element[1].column == element->column)
            continue;
        add_columns(part->covariance, plan->states, step->column[element->column], step->moments,
                    weight);
        memset(weight, 0, sizeof weight);
    }
}

void imki_drift_propagate(const imki_drift_plan *plan, imki_drift_part *part,
                          const imki_drift_step *step, imki_driver_step (*over)[IMKI_DRIFT_SLOTS])
{
    const bool noisy = part->count > 0 && is_noise(&plan->element[part->first]);
    for (size_t repeat = 0; repeat < step->repeat; repeat++) {
        if (noisy && step->aided)
            imki_feed_covariance(plan->states, step, part->covariance);
        else if (noisy)
            imki_drift_turn_covariance(part->covariance, plan->states, &step->phi);
        move_elements(plan, part, step, over);
    }
    if (step->aided)
        imki_drift_update_part(plan, part, step->aided);
}

static void add_square(double *p, size_t n, double factor, const double x[9])
{
    for (size_t i = 0; i < 9; i++)
        for (size_t j = 0; j < 9; j++)
            p[i * n + j] += factor * (x[i] * x[j]);
}

/* Readings have the differences e_k - e_(k-1) of what is carried. Navigation sees x - g e, which is
 * -g e_0 at its start; after self-alignment, whose mean is a (e_N - e_0), it is (a - g) e_N
 * - a e_0. */
static void rounding_at_start(const imki_drift_plan *plan, imki_drift_part *part,
                              const imki_drift_node *node, const imki_drift_step *alignment)
{
    for (size_t i = part->first; i < part->first + part->count; i++) {
        const imki_drift_element *element = &plan->element[i];
        double g[9], a[9] = {0.0};
        if (element->use != IMKI_ELEMENT_ROUNDING)
            continue;
        imki_drift_carried_at(&plan->column[element->column], node, g);
        if (alignment)
            memcpy(a, alignment->column[element->column][0], sizeof a);
        for (int j = 0; j < 9; j++)
            g[j] = a[j] - g[j];
        const double variance = element->state[0] * element->state[0];
        add_square(part->covariance, plan->states, variance, g);
        add_square(part->covariance, plan->states, variance, a);
    }
}

/* Initial errors are brought to what the vertical leaves of them; what constants carry is taken
 * off.
 */
static void start_constants(const imki_drift_plan *plan, imki_drift_part *part,
                            const imki_drift_node *node)
{
    for (size_t i = part->first; i < part->first + part->count; i++) {
        imki_drift_element *element = &plan->element[i];
        double x[9], c[9];
        imki_drift_carried_at(&plan->column[element->column], node, c);
        for (int j = 0; j < 9; j++) {
            x[j] = -c[j] * element->state[0];
            for (int k = 0; k < 9; k++)
                x[j] += node->keep.m[j][k] * element->x[k];
        }
        memcpy(element->x, x, sizeof x);
    }
}

void imki_drift_begin(const imki_drift_plan *plan, imki_drift_part *part,
                      const imki_drift_node *node, const imki_drift_step *alignment,
                      imki_driver_step (*over)[IMKI_DRIFT_SLOTS])
{
    if (plan->element[part->first].use == IMKI_ELEMENT_ROUNDING) {
        rounding_at_start(plan, part, node, alignment);
        return;
    }
    start_constants(plan, part, node);
    if (alignment)
        imki_drift_propagate(plan, part, alignment, over);
}

/* ---- results ---- */

void imki_drift_element_at(const imki_drift_plan *plan, const imki_drift_element *element,
                           const imki_drift_node *node, double x[9])
{
    imki_drift_carried_at(&plan->column[element->column], node, x);
    for (int j = 0; j < 9; j++)
        x[j] = element->x[j] + x[j] * element->state[0]; /* of rounding there is no x */
}

void imki_drift_moments_at(const imki_drift_plan *plan, const imki_drift_part *part,
                           const imki_drift_node *node, imk_drift_moments *moments)
{
    imki_matrix9 t, p;
    double mean[9] = {0.0}, c[9];
    for (size_t i = 0; i < 9; i++)
        memcpy(p.m[i], part->covariance + i * plan->states, sizeof p.m[i]);
    for (size_t i = part->first; i < part->first + part->count; i++) {
        const imki_drift_element *element = &plan->element[i];
        if (element->use == IMKI_ELEMENT_NOISE)
            continue;
        imki_drift_element_at(plan, element, node, c);
        if (element->use == IMKI_ELEMENT_MEAN)
            for (int j = 0; j < 9; j++)
                mean[j] += c[j];
        else
            add_square(&p.m[0][0], 9, 1.0, c);
    }
    imki_drift_add_correlated(plan, part, part, node, &p);
    imki_drift_result_axes(node, &t);
    imki_drift_turn_covariance(&p.m[0][0], 9, &t);
    for (int i = 0; i < 9; i++) {
        moments->mean[i] = 0.0;
        for (int j = 0; j < 9; j++)
            moments->mean[i] += t.m[i][j] * mean[j];
        for (int j = 0; j < 9; j++) /* symmetric to the bit */
            moments->covariance[i][j] = 0.5 * (p.m[i][j] + p.m[j][i]);
        if (!(moments->covariance[i][i] > 0.0)) /* rounding */
            moments->covariance[i][i] = 0.0;
    }
}
