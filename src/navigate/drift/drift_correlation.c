/* SPDX-License-Identifier: Apache-2.0 */
/* Correlations of calibrated values: parameters j and k with the responses x_j and x_k, each of 1
 * sigma, add r_jk (x_j x_k^T + x_k x_j^T) to the covariance. Of two parameters of one source it is
 * a part of this source, of two sources a cross covariance of these.
 *
 * For runs the matrix R of correlations is factored, R = L L^T, and L n with independent normals n
 * has the correlations R. R may be singular, as where a sum of parameters is known exactly, and in
 * a file it is rounded to six decimals. */
#include "drift_correlation_internal.h"

#include <math.h>
#include <string.h>

/* Of a pivot of 1: below the first a pivot is rounding, and below minus the second the numbers are
 * no correlations. */
static const double singular = 1e-5, impossible = 1e-3;

int imki_correlation_index(const imk_correlation *correlation, imk_model_parameter parameter)
{
    for (int i = 0; correlation && i < correlation->count; i++)
        if (memcmp(&correlation->parameter[i], &parameter, sizeof parameter) == 0)
            return i;
    return -1;
}

double imki_correlation_value(const imk_correlation *correlation, int i, int j)
{
    if (i == j)
        return 1.0;
    const int high = i > j ? i : j, low = i > j ? j : i;
    return (double)correlation->value[high * (high - 1) / 2 + low];
}

bool imki_correlation_factor(const imk_correlation *correlation,
                             double factor[IMKI_CORRELATION_FACTOR])
{
    for (int i = 0; i < correlation->count; i++) {
        double *row = factor + (ptrdiff_t)i * (i + 1) / 2;
        for (int j = 0; j <= i; j++) {
            const double *other = factor + (ptrdiff_t)j * (j + 1) / 2;
            double rest = imki_correlation_value(correlation, i, j);
            for (int k = 0; k < j; k++)
                rest -= row[k] * other[k];
            if (i == j && rest < -impossible)
                return false;
            if (i == j)
                row[j] = rest > singular ? sqrt(rest) : 0.0;
            else
                row[j] = other[j] > 0.0 ? rest / other[j] : 0.0;
        }
    }
    return true;
}

/* ---- of the covariance ----------------------------------------------------------------------- */

size_t imki_drift_cross_max(const imk_model *model, const imk_drift_settings *settings)
{
    const imk_correlation *c = &model->correlation;
    size_t terms = 0;
    for (int i = 0; settings->compensated && i < c->count; i++) {
        bool seen = false;
        for (int j = 0; j < i; j++)
            seen = seen || (c->parameter[j].sensor == c->parameter[i].sensor &&
                            c->parameter[j].term == c->parameter[i].term);
        terms += !seen;
    }
    return terms > 1 ? terms * (terms - 1) / 2 : 0;
}

/* Correlation of two elements; 0: none. */
static double correlation_of(const imki_drift_plan *plan, size_t i, size_t j)
{
    const int a = plan->element[i].correlated, b = plan->element[j].correlated;
    return a > 0 && b > 0 ? imki_correlation_value(plan->correlation, a - 1, b - 1) : 0.0;
}

static bool are_correlated(const imki_drift_plan *plan, const imki_drift_part *a,
                           const imki_drift_part *b)
{
    for (size_t i = a->first; i < a->first + a->count; i++)
        for (size_t j = b->first; j < b->first + b->count; j++)
            if (correlation_of(plan, i, j) != 0.0)
                return true;
    return false;
}

size_t imki_drift_cross_pairs(const imki_drift_plan *plan, size_t max, imk_drift_cross *cross)
{
    size_t count = 0;
    for (size_t a = 0; plan->correlation && a < plan->source_count; a++)
        for (size_t b = a + 1; b < plan->source_count && count < max; b++)
            if (are_correlated(plan, &plan->part[a], &plan->part[b]))
                cross[count++] = (imk_drift_cross){.first = a, .second = b};
    return count;
}

void imki_drift_add_correlated(const imki_drift_plan *plan, const imki_drift_part *a,
                               const imki_drift_part *b, const imki_drift_node *node,
                               imki_matrix9 *p)
{
    for (size_t i = a->first; plan->correlation && i < a->first + a->count; i++) {
        double x[9], y[9];
        if (plan->element[i].correlated == 0)
            continue;
        imki_drift_element_at(plan, &plan->element[i], node, x);
        for (size_t j = b->first; j < (a == b ? i : b->first + b->count); j++) {
            const double r = correlation_of(plan, i, j);
            if (r == 0.0)
                continue;
            imki_drift_element_at(plan, &plan->element[j], node, y);
            for (int k = 0; k < 9; k++)
                for (int l = 0; l < 9; l++)
                    p->m[k][l] += r * (x[k] * y[l] + y[k] * x[l]);
        }
    }
}

void imki_drift_cross_at(const imki_drift_plan *plan, const imk_drift_cross *cross,
                         const imki_drift_node *node, imk_drift_moments *moments)
{
    imki_matrix9 t, p = {{{0.0}}};
    imki_drift_add_correlated(plan, &plan->part[cross->first], &plan->part[cross->second], node,
                              &p);
    imki_drift_result_axes(node, &t);
    imki_drift_turn_covariance(&p.m[0][0], 9, &t);
    memset(moments, 0, sizeof *moments);
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++) /* symmetric to the bit */
            moments->covariance[i][j] = 0.5 * (p.m[i][j] + p.m[j][i]);
}
