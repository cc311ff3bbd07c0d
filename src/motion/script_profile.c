/* SPDX-License-Identifier: Apache-2.0 */
/* Smooth changes. The step
 *
 *     S(x) = 10 x^3 - 15 x^4 + 6 x^5,     S' = 30 x^2 (1-x)^2,     S'' = 60 x (1-x) (1-2x)
 *
 * is the polynomial of lowest degree from 0 to 1 whose first two derivatives vanish at both ends
 * [FLASH1985]. A change of amount A at the rate p has the rate p S(t/h) while it begins, p, and
 * p S((T-t)/h) while it ends. As the integral of S is
 *
 *     x^6 - 3 x^5 + 5/2 x^4       (1/2 at x = 1),
 *
 * it takes T = A/p + h: a plateau of A/p - h between two ramps of h. */
#include "script_profile_internal.h"

#include "imukit/elementary.h"

#include <math.h>

#define PI 3.14159265358979323846

imki_jet imki_smooth_step(double time, double length)
{
    const double x = time / length;
    if (!(x > 0.0))
        return imki_jet_constant(0.0);
    if (!(x < 1.0))
        return imki_jet_constant(1.0);
    const double y = 1.0 - x;
    return (imki_jet){{x * x * x * (10.0 - x * (15.0 - 6.0 * x)), 30.0 * (x * y) * (x * y) / length,
                       60.0 * x * y * (y - x) / (length * length),
                       60.0 * (1.0 - 6.0 * x * y) / (length * length * length)}};
}

imki_jet imki_jet_product(imki_jet a, imki_jet b)
{
    return (imki_jet){
        {a.d[0] * b.d[0], a.d[1] * b.d[0] + a.d[0] * b.d[1],
         a.d[2] * b.d[0] + 2.0 * a.d[1] * b.d[1] + a.d[0] * b.d[2],
         a.d[3] * b.d[0] + 3.0 * a.d[2] * b.d[1] + 3.0 * a.d[1] * b.d[2] + a.d[0] * b.d[3]}};
}

/* atan(a)' = a'/(1 + a^2),   atan(a)'' = a''/(1 + a^2) - 2 a a'^2/(1 + a^2)^2 */
imki_jet imki_jet_arc_tangent(imki_jet a)
{
    const double q = 1.0 / (1.0 + a.d[0] * a.d[0]);
    const double rate = a.d[1] * q;
    return (imki_jet){{imk_atan2(a.d[0], 1.0), rate, a.d[2] * q - 2.0 * a.d[0] * rate * rate, 0.0}};
}

/* Whole cycles are taken away first: they are exact in cycles, not in radians. */
imki_jet imki_jet_sine(double time, double frequency)
{
    const double cycles = time * frequency;
    const double phase = 2.0 * PI * (cycles - floor(cycles));
    const double w = 2.0 * PI * frequency;
    const double sine = imk_sin(phase), cosine = imk_cos(phase);
    return (imki_jet){{sine, w * cosine, -w * w * sine, -w * w * w * cosine}};
}

imki_profile imki_profile_make(double amount, double rate, double smoothing)
{
    const double plateau = fabs(amount) / rate - smoothing;
    if (!(plateau > 0.0))
        return (imki_profile){amount, amount / smoothing, smoothing, 0.0};
    return (imki_profile){amount, amount < 0.0 ? -rate : rate, smoothing, plateau};
}

double imki_profile_length(const imki_profile *profile)
{
    return 2.0 * profile->ramp + profile->plateau;
}

/* Integral of S(t/length) from 0 to t, 0 <= t <= length, and its derivatives. */
static imki_jet ramp_integral(double time, double length)
{
    const imki_jet s = imki_smooth_step(time, length);
    const double x = time / length;
    const double integral = x * x * x * x * (2.5 - x * (3.0 - x)) * length;
    return (imki_jet){{integral, s.d[0], s.d[1], s.d[2]}};
}

imki_jet imki_profile_at(const imki_profile *profile, double time)
{
    const double length = imki_profile_length(profile), ramp = profile->ramp;
    if (!(time > 0.0))
        return imki_jet_constant(0.0);
    if (!(time < length))
        return imki_jet_constant(profile->amount);
    imki_jet done;
    if (time < ramp) {
        const imki_jet r = ramp_integral(time, ramp);
        for (int i = 0; i < 4; i++)
            done.d[i] = profile->peak * r.d[i];
    } else if (time <= ramp + profile->plateau) {
        done = (imki_jet){{profile->peak * (time - 0.5 * ramp), profile->peak, 0.0, 0.0}};
    } else {
        /* Mirrored in time: the odd derivatives of what is left change sign twice. */
        const imki_jet r = ramp_integral(length - time, ramp);
        for (int i = 0; i < 4; i++)
            done.d[i] = (i % 2 == 1 ? profile->peak : -profile->peak) * r.d[i];
        done.d[0] += profile->amount;
    }
    return done;
}
