/* SPDX-License-Identifier: Apache-2.0 */
/* Smooth functions of time, carried together with their derivatives. */
#ifndef IMUKI_SCRIPT_PROFILE_INTERNAL_H
#define IMUKI_SCRIPT_PROFILE_INTERNAL_H

/* A number and its first three derivatives with respect to time. */
typedef struct imki_jet {
    double d[4];
} imki_jet;

static inline imki_jet imki_jet_constant(double value)
{
    return (imki_jet){{value, 0.0, 0.0, 0.0}};
}

/* S(x) = 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1 over `length`, constant before and after. */
imki_jet imki_smooth_step(double time, double length);

/* The product. */
imki_jet imki_jet_product(imki_jet a, imki_jet b);

/* atan(a), its first two derivatives; the third is 0. */
imki_jet imki_jet_arc_tangent(imki_jet a);

/* sin(2 pi frequency t). */
imki_jet imki_jet_sine(double time, double frequency);

/* A change by `amount` whose rate grows by S over `ramp` to `peak`, stays for `plateau` and dies
 * away over `ramp`. */
typedef struct imki_profile {
    double amount, peak; /* of the same sign */
    double ramp, plateau;
} imki_profile;

/* The profile of a stated rate > 0; when the amount is too small for it, the plateau vanishes and
 * the peak is lower. */
imki_profile imki_profile_make(double amount, double rate, double smoothing);
double imki_profile_length(const imki_profile *profile);
/* What has been done of the amount at a time since the beginning. */
imki_jet imki_profile_at(const imki_profile *profile, double time);

#endif
