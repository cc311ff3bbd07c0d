/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the stochastic terms. */
#include "noise_terms_internal.h"

const imki_noise_term *const imki_noise_terms[IMKI_NOISE_TERMS] = {
    &imki_white_term,        &imki_flicker_term,  &imki_random_walk_term,
    &imki_gauss_markov_term, &imki_sinusoid_term, &imki_resonance_term,
};

int imki_term_count(const imki_noise_term *term, const imk_noise *noise)
{
    return term->count ? term->count(noise) : 1;
}

const imki_generator *imki_term_generator(const imki_noise_term *term, imki_term_place place)
{
    const bool filtered = place.triad->bandwidth.value[place.axis] > 0.0;
    return filtered && term->filtered ? term->filtered : term->generator;
}
