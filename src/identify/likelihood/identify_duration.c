/* SPDX-License-Identifier: Apache-2.0 */
/* How long a record must be: bisection of its logarithm on the bounds of identify_bounds.c. */
#include "imukit/identify_plan.h"

#include <math.h>

static bool met(const imk_identification_bounds *bounds,
                const imk_identify_requirement *requirement)
{
    const int i = requirement->term - IMK_NOISE_TERMS;
    const imk_bound *bound = i < 0               ? &bounds->term[requirement->term]
                             : requirement->time ? &bounds->correlation_time[i]
                                                 : &bounds->sigma[i];
    return (!(requirement->relative > 0) || bound->relative <= requirement->relative) &&
           (!(requirement->detection > 0) || bound->detection >= requirement->detection);
}

imk_status imk_identify_duration(const imk_expected_noise *noise,
                                 const imk_bounds_settings *settings,
                                 const imk_identify_requirement *requirement, double *duration,
                                 void *workspace, size_t workspace_size, imk_error *error)
{
    if (requirement->term < 0 || requirement->term >= IMK_NOISE_TERMS + noise->gauss_markov_count ||
        !(requirement->relative > 0 || requirement->detection > 0) || !(requirement->detection < 1))
        return imk_error_set(error, IMK_ERROR_RANGE, "requirement", NULL,
                             "a term of the noise, a relative sigma > 0 or a chance below 1");
    const double dt = settings->dt;
    double low = 256 * dt, high = low;
    for (;; low = high, high = fmin(2 * high, 1e12 * dt)) {
        imk_identification_bounds bounds;
        const imk_status status =
            imk_identify_bounds(noise, settings, high, &bounds, workspace, workspace_size, error);
        if (status != IMK_OK && status != IMK_ERROR_SINGULAR)
            return status;
        if (status == IMK_OK && met(&bounds, requirement))
            break;
        if (!(high < 1e12 * dt))
            return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, "requirement", NULL,
                                 "a requirement that a record of 1e12 samples can meet");
    }
    while (high > 1.001 * low) {
        imk_identification_bounds bounds;
        const double middle = sqrt(low * high);
        const imk_status status =
            imk_identify_bounds(noise, settings, middle, &bounds, workspace, workspace_size, error);
        *(status == IMK_OK && met(&bounds, requirement) ? &high : &low) = middle;
    }
    *duration = high;
    return IMK_OK;
}
