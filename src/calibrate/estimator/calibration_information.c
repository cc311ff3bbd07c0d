/* SPDX-License-Identifier: Apache-2.0 */
/* Information about the parameters that observations would hold: the normal matrix at the model's
 * values, attitudes, placements, fixtures and the Earth's unknown part eliminated. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Locals eliminated from the core, in place. */
static void eliminate_locals(imki_normal *n)
{
    const size_t g = n->globals;
    for (size_t k = 0; k < n->locals; k++)
        for (size_t i = 0; i < g; i++)
            for (size_t j = 0; j < g; j++)
                n->core[i * g + j] -= n->half[k * g + i] * n->half[k * g + j];
}

/* One further global, with what it tells about the others before it taken along. */
static void eliminate_last(size_t last, size_t globals, double *core)
{
    const double *row = core + last * globals;
    const double pivot = row[last];
    for (size_t i = 0; i < last; i++)
        for (size_t j = 0; pivot > 0.0 && j < last; j++)
            core[i * globals + j] -= row[i] * row[j] / pivot;
}

static imk_status check_forces(const imk_calibration *c, imk_error *error)
{
    for (size_t i = 0; i < c->observation_count; i++) {
        const imk_observation *o = &c->observation[i];
        if (o->knowledge != IMK_INPUT_GRAVITY || imki_dot3(o->force, o->force) > 0.0)
            continue;
        imk_error_set(error, IMK_ERROR_KEY_MISSING, "force", NULL,
                      "state the direction of gravity in the pose");
        if (error)
            error->index = (int)i;
        return IMK_ERROR_KEY_MISSING;
    }
    return IMK_OK;
}

imk_status imk_calibration_information(const imk_calibration *calibration, double *information,
                                       void *workspace, size_t workspace_size, imk_error *error)
{
    imki_estimator e;
    if (!calibration || !workspace || !information)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "calibration", NULL, "see calibration.h");
    imk_status status =
        imki_estimator_start(&e, calibration, false, workspace, workspace_size, error);
    if (status == IMK_OK)
        status = check_forces(calibration, error);
    if (status != IMK_OK)
        return status;
    (void)imki_turns_linearise(&e, 0.0);
    (void)imki_build(&e, &e.now);
    (void)imki_normal_factor(&e.normal, 0.0); /* may be singular: only the locals' part is used */
    eliminate_locals(&e.normal);
    for (size_t last = e.globals; last-- > e.parameters;)
        eliminate_last(last, e.globals, e.normal.core);
    /* Parameters that the frame holds have none. */
    const size_t count = calibration->parameter_count;
    size_t from[IMK_CORRELATED_MAX];
    for (size_t p = 0, q = 0; p < count; p++) {
        const bool kept =
            q < e.parameters && memcmp(&e.problem->parameter[q], &calibration->parameter[p],
                                       sizeof calibration->parameter[p]) == 0;
        from[p] = kept ? q++ : e.parameters;
    }
    for (size_t p = 0; p < count; p++)
        for (size_t q = 0; q < count; q++)
            information[p * count + q] = from[p] < e.parameters && from[q] < e.parameters
                                             ? e.normal.core[from[p] * e.globals + from[q]]
                                             : 0.0;
    return IMK_OK;
}
