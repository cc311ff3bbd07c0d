/* SPDX-License-Identifier: Apache-2.0 */
/* What the observations do not determine, by name. The information about the globals, scaled to
 * unit diagonal, has an eigenvalue near zero for a combination that nothing tells apart; and a
 * response known to no better than a third of itself is not known. */
#include "estimator_internal.h"

#include "model/model_schema_internal.h"

#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Rounding of the sums leaves some 1e-14; what noise alone determines is met by the second test. */
static const double least_eigenvalue = 1e-12;
/* Of scale factors, misalignments, cross-axis terms, asymmetries [1]. */
static const double largest_sigma = 0.3;

static imk_status not_determined(const imki_estimator *e, size_t p, double value, double limit,
                                 imk_error *error)
{
    char name[IMK_MODEL_PARAMETER_NAME] = "fixture";
    if (p < e->parameters && imk_model_parameter_name(e->problem->parameter[p], name) != IMK_OK)
        name[0] = '\0';
    imk_error_set(
        error, IMK_ERROR_SINGULAR, name, "the observations do not determine this parameter",
        "add poses or inputs in which this parameter changes the readings, or do not estimate it");
    if (error) {
        error->value = value;
        error->limit = limit;
    }
    return IMK_ERROR_SINGULAR;
}

/* Information about the globals with the locals eliminated, from what is left of the factors. */
static void schur_complement(const imki_normal *n, double *schur)
{
    const size_t g = n->globals;
    memcpy(schur, n->core, g * g * sizeof *schur);
    for (size_t k = 0; k < n->locals; k++)
        for (size_t i = 0; i < g; i++)
            for (size_t j = 0; j < g; j++)
                schur[i * g + j] -= n->half[k * g + i] * n->half[k * g + j];
}

static bool is_ratio(imk_model_parameter p)
{
    const imki_form form = imki_terms[p.term].form;
    return form == IMKI_FORM_INPUT || form == IMKI_FORM_SEEN ||
           (form == IMKI_FORM_POWER && imki_power_degree(p.term) == 1);
}

imk_status imki_check_determined(imki_estimator *e, double *weakest, imk_error *error)
{
    imki_normal *n = &e->normal;
    const size_t g = n->globals;
    double value[IMKI_GLOBALS_MAX], scale[IMKI_GLOBALS_MAX];
    double *information = n->covariance, *vector = n->schur; /* both are made anew afterwards */
    e->cost = imki_build(e, &e->now);
    (void)imki_normal_factor(n, 0.0); /* fails when singular, and leaves the band's part */
    schur_complement(n, information);
    for (size_t i = 0; i < g; i++) {
        const double own = n->core[i * g + i], left = information[i * g + i];
        if (!(left > 1e-14 * own) || !(own > 0.0))
            return not_determined(e, i, 0.0, least_eigenvalue, error);
        scale[i] = 1.0 / sqrt(left);
    }
    for (size_t i = 0; i < g; i++)
        for (size_t j = 0; j < g; j++)
            information[i * g + j] *= scale[i] * scale[j];
    if (imk_symmetric_eigen(g, information, value, vector) != IMK_OK)
        return not_determined(e, 0, (double)NAN, least_eigenvalue, error);
    *weakest = sqrt(value[g - 1] / value[0]);
    if (!(value[0] > least_eigenvalue)) {
        size_t largest = 0;
        for (size_t i = 0; i < e->parameters; i++)
            if (fabs(vector[i * g]) > fabs(vector[largest * g]))
                largest = i;
        return not_determined(e, largest, value[0], least_eigenvalue, error);
    }
    if (imki_built_covariance(e) != IMK_OK)
        return not_determined(e, 0, 0.0, least_eigenvalue, error);
    size_t worst = 0;
    double sigma = 0.0;
    for (size_t p = 0; p < e->parameters; p++)
        if (is_ratio(e->problem->parameter[p]) && n->covariance[p * g + p] > sigma * sigma) {
            sigma = sqrt(n->covariance[p * g + p]);
            worst = p;
        }
    return sigma > largest_sigma ? not_determined(e, worst, sigma, largest_sigma, error) : IMK_OK;
}
