/* SPDX-License-Identifier: Apache-2.0 */
/* What is kept of a record for a joint estimate from several. */
#include "identify_internal.h"
#include "imukit/identify_joint.h"

#include <string.h>

size_t imk_spectral_summary_size(void)
{
    return sizeof(imk_spectral_summary);
}

void imki_summary_save(const imki_work *w, imk_spectral_summary *summary)
{
    if (!summary)
        return;
    summary->cookie = IMKI_SUMMARY_COOKIE;
    summary->scale = w->scale;
    summary->bands = *w->bands;
    imki_bands *bands = &summary->bands;
    for (size_t b = 0; b < bands->singles; b++) {
        const double ramp = w->fit->ramp_active ? w->fit->ramp : 0;
        const double c = bands->coefficient[b] - ramp * bands->ramp[b];
        bands->power[b] = c * c * bands->dt;
    }
    bands->singles = 0;
    memset(bands->end_product, 0, sizeof bands->end_product);
    memset(bands->end_square, 0, sizeof bands->end_square);
}
