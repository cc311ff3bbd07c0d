/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of an interval by profile likelihood: the parameter is held, everything else fitted again.
 */
#include "identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Everything that was chosen, with white noise, bias instability, random walk and the term itself
 * free as well. */
void imki_intervals_free(imki_work *w, int term)
{
    static const bool always[IMK_NOISE_TERMS] = {false, true, true, true, false};
    imki_fit *fit = w->fit;
    for (int j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++)
        if ((always[j] || j == term) && !fit->active[j]) {
            fit->active[j] = true;
            fit->amount[j] = 1e-6 * w->bands->power[0] / fit->shape[j][0];
        }
    fit->ramp_active = fit->ramp_active || term == IMK_NOISE_RAMP;
    imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
}

void imki_quantization_switch(imki_work *w)
{
    imki_fit *fit = w->fit;
    const bool on = !fit->active[IMK_NOISE_QUANTIZATION];
    fit->active[IMK_NOISE_QUANTIZATION] = on;
    fit->amount[IMK_NOISE_QUANTIZATION] =
        on ? 0.1 * fit->amount[IMK_NOISE_WHITE] * w->bands->dt * w->bands->dt : 0;
    imki_gauss_markov_settle(fit, w->bands, IMKI_HELD_NONE, IMKI_HELD_NONE);
}

/* Log-likelihood at the fit. Of strengths and times beside a ramp it is the restricted one
 * [PATTERSON1971]: the ramp takes up part of the slow noise, and without this that noise would seem
 * less than it is. */
static double height(const imki_interval_profile *p)
{
    const imki_fit *fit = p->fit;
    if (p->held == IMKI_HELD_RAMP || !fit->ramp_active || p->bands->singles == 0)
        return fit->log_likelihood;
    return fit->log_likelihood - 0.5 * imk_ln(imki_fit_ramp_information(fit, p->bands));
}

/* Signed root of twice the fall of the likelihood, less what it is at the interval's end: nearly
 * linear in the place. The fit is left at the place, so that the next one starts from there. */
double imki_interval_beyond(const imki_interval_profile *p, double place)
{
    if (p->held_time >= 0) {
        const size_t term = (size_t)p->held_time;
        p->fit->correlation_time[term] = imk_exp(place);
        imki_gauss_markov_shape(p->fit, p->bands, imk_exp(place),
                                p->fit->shape[IMKI_FIRST_GAUSS_MARKOV + term]);
    } else if (p->held == IMKI_HELD_RAMP) {
        p->fit->ramp = place;
    } else {
        p->fit->amount[p->held] = place * place;
    }
    imki_gauss_markov_settle(p->fit, p->bands, p->held, p->held_time);
    return sqrt(fmax(0, 2 * (p->top - height(p)))) - sqrt(2 * p->drop);
}

/* End of the interval in the direction of `step`, at most at `limit`: bracketed by growing steps,
 * then by regula falsi, the value of an end that stays halved [DOWELL1971]. */
double imki_interval_end(const imki_interval_profile *p, double start, double step, double limit)
{
    double inside = start, outside = start, at_inside = -sqrt(2 * p->drop), at_outside = 0;
    imki_fit_restore(p->fit, p->bands, &p->best);
    for (int i = 0; i < 60; i++) {
        outside = step > 0 ? fmin(outside + step, limit) : fmax(outside + step, limit);
        at_outside = imki_interval_beyond(p, outside);
        if (at_outside > 0)
            break;
        if (outside == limit)
            return limit;
        inside = outside;
        at_inside = at_outside;
        step *= at_inside < -0.8 * sqrt(2 * p->drop) ? 4 : 1.5;
    }
    for (int i = 0, side = 0; i < 30 && fabs(outside - inside) > 1e-4 * fabs(outside - start);
         i++) {
        double place = inside - at_inside * (outside - inside) / (at_outside - at_inside);
        if (!(fabs(place - inside) < fabs(outside - inside)))
            place = 0.5 * (inside + outside);
        const double at = imki_interval_beyond(p, place);
        if (fabs(at) < 1e-4)
            return place;
        if (at > 0) {
            outside = place;
            at_outside = at;
            at_inside *= side > 0 ? 0.5 : 1;
            side = 1;
        } else {
            inside = place;
            at_inside = at;
            at_outside *= side < 0 ? 0.5 : 1;
            side = -1;
        }
    }
    return 0.5 * (inside + outside);
}

/* Bartlett's factor of the likelihood ratio [BARTLETT1937]: for a variance estimated with v degrees
 * of freedom its mean is v [log(v/2) - digamma(v/2)] ~ 1 + 1/(3v), not 1. Here v = 2 (amount/sd)^2,
 * at least 2. */
static double small_sample_factor(double amount, double sd)
{
    const double degrees = 2 * (amount / sd) * (amount / sd);
    return 1 + 1 / (3 * (degrees > 2 ? degrees : 2));
}

/* Twice the gain of a normal mean whose variance is known with v degrees, (v + 1) log(1 + t^2/v) at
 * a quantile t of Student's distribution, over z^2 at the normal one. With Wallace's approximation
 * z ~ (8v + 1)/(8v + 3) sqrt(v log(1 + t^2/v)) [WALLACE1959]. */
double imki_student_factor(double v)
{
    const double ratio = (8 * v + 3) / (8 * v + 1);
    return (v + 1) / v * ratio * ratio;
}

/* Where a random walk is estimated as 0, next to nothing tells the variance of a ramp; but there
 * the walk, which is free, widens the interval by itself. With two degrees it then holds in 97 %
 * beside a walk that is there and not found (docs/theory/identification.md). */
static const double LEAST_RAMP_DEGREES = 2;

/* Centre of the interval of a strength or of the ramp at the fit, and a first step from it; allows
 * in the drop for a strength, or the variance of the ramp, known from few coefficients. */
imki_interval_profile imki_interval_profile_at(const imki_work *w, int held, double drop,
                                               double *centre, double *step)
{
    const imki_fit *fit = w->fit;
    imki_interval_profile p = {w->fit, w->bands, held, IMKI_HELD_NONE, imki_fit_keep(w->fit),
                               0,      drop};
    p.top = height(&p);
    if (held == IMKI_HELD_RAMP) {
        *step = 1 / sqrt(imki_fit_ramp_information(fit, w->bands));
        *centre = fit->ramp;
        const double degrees = imki_fit_ramp_degrees(w->fit, w->bands);
        p.drop *= imki_student_factor(fmax(LEAST_RAMP_DEGREES, degrees));
        return p;
    }
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    imki_fit_covariance(w->fit, w->bands, covariance);
    const double sd = sqrt(covariance[(size_t)held * fit->templates + (size_t)held]);
    *centre = sqrt(fit->amount[held]);
    p.drop *= small_sample_factor(fit->amount[held], sd);
    *step = 2 * (sqrt(fit->amount[held] + sd) - *centre); /* near the end of 95 % */
    return p;
}
