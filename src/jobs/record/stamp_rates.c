/* SPDX-License-Identifier: Apache-2.0 */
/* Stamps on an even grid that are not those of one sensor at one rate. */
#include "record_stamps_internal.h"

#include "jobs/job_internal.h"

#include <math.h>

/* Steps that scatter by less do not change a result. Independent ones are not correlated, and of
 * even samples with independent delays they have the correlation -1/2. */
static const double scatter_told = 0.02, alternating_scatter = 0.1;
static const double lasting = 0.5, alternating = -0.8;
/* Rows that show it, and by how much two statements of a rate may differ: crystals keep 1e-4. */
enum { ROWS_LEAST = 100 };

static const double rates_differ = 2e-3;

/* Do steps that alternate differ by a unit of the clock? */
static bool is_unit(double step)
{
    const double digits = log10(step);
    return fabs(digits - round(digits)) < 0.02;
}

void imki_tell_steps(const imk_log_findings *f, imk_findings *findings)
{
    if (f->rows < ROWS_LEAST || !(f->step_scatter > scatter_told))
        return;
    if (f->step_correlation > lasting && f->bursts + f->repeats == 0)
        imki_find(findings, IMK_FINDING_WARNING, "stamps:two_rates", NULL,
                  IMKI_NUMBERS(1 / f->interval));
    else if (f->step_correlation < alternating && f->step_scatter > alternating_scatter &&
             !is_unit(2 * f->step_scatter * f->interval))
        imki_find(findings, IMK_FINDING_WARNING, "stamps:alternate", NULL,
                  IMKI_NUMBERS(2 * f->step_scatter * f->interval));
}

void imki_tell_rate(double rate, double own, imk_findings *findings)
{
    if (rate > 0 && own > 0 && fabs(own * rate - 1) > rates_differ)
        imki_find(findings, IMK_FINDING_WARNING, "stamps:rate_differs", NULL,
                  IMKI_NUMBERS(rate, 1 / own));
}
