/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the stochastic terms. */
#include "noise_terms_internal.h"

#define ROW(NAME, name, number) &imki_##name##_term,
const imki_noise_term *const imki_noise_terms[IMKI_NOISE_TERMS] = {IMK_NOISE_TERM_LIST(ROW)};
#undef ROW

int imki_term_count(const imki_noise_term *term, const imk_noise *noise)
{
    return term->count ? term->count(noise) : 1;
}

const imki_generator *imki_term_generator(const imki_noise_term *term, imki_term_place place)
{
    const bool filtered = place.triad->bandwidth.value[place.axis] > 0.0;
    return filtered && term->filtered ? term->filtered : term->generator;
}
