/* SPDX-License-Identifier: Apache-2.0 */
/* A sensor axis as a Kalman filter has it: white noise and bias states, continuous and discrete.
 *
 * Flicker noise has no finite state: over a stated range of averaging times it is replaced by a
 * random walk that has its Allan deviation in the middle, K^2 tau/3 = (2 ln 2/pi) B^2, or by one or
 * two Gauss-Markov processes that bring the Allan deviation of all terms together as near to the
 * model's as they can, in the mean square of its logarithm. */
#include "imukit/filter_noise.h"

#include "imukit/elementary.h"
#include "imukit/least_squares.h"
#include "imukit/noise.h"

#include <math.h>

static const uint32_t settings_cookie = 0x666c6e31; /* "fln1" */
enum { POINTS = 40, PARAMETERS_MAX = 4, WORKSPACE = 1024 /* doubles; 40 x 4 residuals need 700 */ };

imk_filter_noise_settings imk_filter_noise_default(void)
{
    return (imk_filter_noise_settings){.cookie = settings_cookie, .from = 1, .to = 1000};
}

/* ---- states ---------------------------------------------------------------------------------- */

static imk_filter_state markov_state(imk_filter_source source, double sigma, double time)
{
    return (imk_filter_state){.source = source,
                              .correlation_time = time,
                              .driving = sigma * sqrt(2 / time),
                              .sigma = sigma,
                              .initial = sigma};
}

static void add_state(imk_filter_noise *noise, imk_filter_state state)
{
    noise->state[noise->state_count++] = state;
}

static double state_allan_variance(const imk_filter_state *s, double tau)
{
    if (s->correlation_time > 0 && s->correlation_time < HUGE_VAL)
        return imk_gauss_markov_allan_variance((imk_gauss_markov){s->sigma, s->correlation_time},
                                               tau);
    return imk_random_walk_allan_variance(s->driving, tau);
}

double imk_filter_noise_allan_variance(const imk_filter_noise *noise, double tau)
{
    double sum = imk_white_allan_variance(noise->white, tau);
    for (int i = 0; i < noise->state_count; i++)
        sum += state_allan_variance(&noise->state[i], tau);
    return sum;
}

/* ---- flicker --------------------------------------------------------------------------------- */

typedef struct flicker_fit {
    const imk_filter_noise *rest; /* all but the flicker */
    double instability, tau[POINTS], floor;
} flicker_fit;

static double markov_variance(const double *x, double tau)
{
    return imk_gauss_markov_allan_variance((imk_gauss_markov){imk_exp(x[0]), imk_exp(x[1])}, tau);
}

/* ln of the Allan variance with one or two processes over that with flicker noise; the parameters
 * are ln sigma/B and ln T of each. */
static imk_status residuals_of(const flicker_fit *fit, size_t processes, const double *x,
                               double *residuals)
{
    for (size_t i = 0; i < POINTS; i++) {
        const double tau = fit->tau[i], rest = imk_filter_noise_allan_variance(fit->rest, tau);
        double processed = 0;
        for (size_t k = 0; k < processes; k++)
            processed += markov_variance(x + 2 * k, tau);
        const double b2 = fit->instability * fit->instability;
        residuals[i] = imk_ln((rest / b2 + processed) / (rest / b2 + fit->floor));
    }
    return IMK_OK;
}

static imk_status one_process(void *context, const double *x, double *residuals, double *jacobian)
{
    (void)jacobian;
    return residuals_of(context, 1, x, residuals);
}

static imk_status two_processes(void *context, const double *x, double *residuals, double *jacobian)
{
    (void)jacobian;
    return residuals_of(context, 2, x, residuals);
}

/* Starts: processes spread over the range, each with the floor's height at its own hump, which is
 * 0.617 sigma high at 1.89 T. Correlation times stay within a factor 30 of the range, where they
 * still act. The best point found will do: where white noise covers the floor, many are as good. */
static void fit_processes(imk_filter_noise *noise, const imk_filter_noise_settings *settings,
                          double instability, size_t processes)
{
    flicker_fit fit = {.rest = noise, .instability = instability};
    const double from = imk_ln(settings->from), range = imk_ln(settings->to) - from;
    double x[PARAMETERS_MAX], lower[PARAMETERS_MAX], upper[PARAMETERS_MAX], workspace[WORKSPACE];
    fit.floor = imk_flicker_allan_variance(1, 1);
    for (size_t i = 0; i < POINTS; i++)
        fit.tau[i] = imk_exp(from + range * (double)i / (POINTS - 1));
    for (size_t k = 0; k < processes; k++) {
        const double place = from + range * ((double)k + 0.5) / (double)processes;
        x[2 * k] = 0.0;
        x[2 * k + 1] = place - imk_ln(1.89);
        lower[2 * k] = imk_ln(1e-3);
        upper[2 * k] = imk_ln(1e2);
        lower[2 * k + 1] = from - imk_ln(30);
        upper[2 * k + 1] = from + range + imk_ln(30);
    }
    imk_least_squares problem = imk_least_squares_default();
    problem.parameter_count = 2 * processes;
    problem.residual_count = POINTS;
    problem.residuals = processes == 1 ? one_process : two_processes;
    problem.context = &fit;
    problem.lower = lower;
    problem.upper = upper;
    (void)imk_least_squares_solve(&problem, x, NULL, NULL, workspace, sizeof workspace);
    for (size_t k = 0; k < processes; k++)
        add_state(noise, markov_state(IMK_FILTER_FROM_BIAS_INSTABILITY,
                                      instability * imk_exp(x[2 * k]), imk_exp(x[2 * k + 1])));
}

/* A random walk of density q, on top of the one that is there. */
static void add_flicker_walk(imk_filter_noise *noise, double q)
{
    imk_filter_state *last = noise->state_count > 0 ? &noise->state[noise->state_count - 1] : NULL;
    if (last && last->source == IMK_FILTER_FROM_RANDOM_WALK) {
        last->driving = sqrt(last->driving * last->driving + q * q);
        last->flicker_walk = q;
    } else {
        add_state(noise, (imk_filter_state){.source = IMK_FILTER_FROM_BIAS_INSTABILITY,
                                            .correlation_time = HUGE_VAL,
                                            .driving = q,
                                            .flicker_walk = q});
    }
}

static void add_flicker(imk_filter_noise *noise, const imk_filter_noise_settings *settings,
                        double instability)
{
    const double tau = sqrt(settings->from * settings->to);
    const double floor = imk_flicker_allan_variance(instability, tau);
    switch (settings->flicker) {
    case IMK_FILTER_FLICKER_RANDOM_WALK:
        add_flicker_walk(noise, sqrt(3 * floor / tau));
        break;
    case IMK_FILTER_FLICKER_GAUSS_MARKOV:
        fit_processes(noise, settings, instability, 1);
        break;
    case IMK_FILTER_FLICKER_TWO_GAUSS_MARKOV:
        fit_processes(noise, settings, instability, 2);
        break;
    default:
        noise->lost |= IMK_FILTER_LOST_FLICKER;
    }
}

/* Largest relative error of the Allan deviation that the approximation of flicker makes. */
static void assess_flicker(imk_filter_noise *noise, const imk_filter_noise *rest,
                           const imk_filter_noise_settings *settings, double instability)
{
    const double range = imk_ln(settings->to / settings->from);
    for (int i = 0; i < POINTS; i++) {
        const double tau = settings->from * imk_exp(range * i / (POINTS - 1));
        const double truth = imk_filter_noise_allan_variance(rest, tau) +
                             imk_flicker_allan_variance(instability, tau);
        const double error = fabs(sqrt(imk_filter_noise_allan_variance(noise, tau) / truth) - 1);
        if (error >= noise->misfit) {
            noise->misfit = error;
            noise->misfit_tau = tau;
        }
    }
}

/* ---- axis ------------------------------------------------------------------------------------ */

static imk_status check(const imk_triad *triad, int axis, const imk_filter_noise_settings *settings,
                        imk_error *error)
{
    if (!settings || settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_filter_noise_default()");
    if (axis < 0 || axis >= triad->axis_count)
        return imk_error_set(error, IMK_ERROR_RANGE, "axis", "", "an axis of the triad");
    if (!(settings->from >= 1e-9 && settings->to >= settings->from && settings->to <= 1e9))
        return imk_error_set(error, IMK_ERROR_RANGE, "from", "",
                             "two averaging times from 1e-9 s to 1e9 s, the shorter first");
    if ((unsigned)settings->flicker > IMK_FILTER_FLICKER_LEFT_OUT)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "flicker", "",
                             "one of the values of the enumeration");
    return IMK_OK;
}

static unsigned lost_terms(const imk_triad *triad, int axis)
{
    const imk_noise *n = &triad->noise;
    unsigned lost = n->ramp.value[axis] != 0 ? IMK_FILTER_LOST_RAMP : 0;
    for (int i = 0; i < n->sinusoid_count; i++)
        if (n->sinusoid[i].amplitude.value[axis] > 0)
            lost |= IMK_FILTER_LOST_SINUSOID;
    for (int i = 0; i < n->resonance_count; i++)
        if (n->resonance[i].sigma.value[axis] > 0)
            lost |= IMK_FILTER_LOST_RESONANCE;
    return triad->bandwidth.value[axis] > 0 ? lost | IMK_FILTER_LOST_LOW_PASS : lost;
}

/* The bias of a run sits in the first state that does not decay; without one it gets its own. */
static void add_constant(imk_filter_noise *noise, double repeatability)
{
    for (int i = 0; i < noise->state_count; i++)
        if (noise->state[i].correlation_time == HUGE_VAL) {
            noise->state[i].initial = repeatability;
            return;
        }
    if (repeatability > 0 || noise->state_count == 0)
        add_state(noise, (imk_filter_state){.source = IMK_FILTER_FROM_CONSTANT,
                                            .correlation_time = HUGE_VAL,
                                            .initial = repeatability});
}

imk_status imk_filter_noise_of(const imk_triad *triad, int axis,
                               const imk_filter_noise_settings *settings, imk_filter_noise *noise,
                               imk_error *error)
{
    const imk_status status = check(triad, axis, settings, error);
    if (status != IMK_OK)
        return status;
    const imk_noise *n = &triad->noise;
    imk_filter_noise made = {.white = n->white.value[axis],
                             .quantization = n->quantization.value[axis],
                             .reading_noise = n->reading_noise.value[axis],
                             .angle_white = n->angle_white.value[axis],
                             .lost = lost_terms(triad, axis)};
    for (int i = 0; i < n->gauss_markov_count; i++)
        if (n->gauss_markov[i].sigma.value[axis] > 0)
            add_state(&made, markov_state(IMK_FILTER_FROM_GAUSS_MARKOV,
                                          n->gauss_markov[i].sigma.value[axis],
                                          n->gauss_markov[i].correlation_time.value[axis]));
    if (n->random_walk.value[axis] > 0)
        add_state(&made, (imk_filter_state){.source = IMK_FILTER_FROM_RANDOM_WALK,
                                            .correlation_time = HUGE_VAL,
                                            .driving = n->random_walk.value[axis]});
    const double instability = n->bias_instability.value[axis];
    if (instability > 0) {
        const imk_filter_noise rest = made;
        add_flicker(&made, settings, instability);
        assess_flicker(&made, &rest, settings, instability);
    }
    add_constant(&made, triad->bias.repeatability.value[axis]);
    *noise = made;
    return IMK_OK;
}

/* ---- matrices -------------------------------------------------------------------------------- */

void imk_filter_continuous(const imk_filter_noise *noise, double *f, double *q_c)
{
    const size_t n = 1 + (size_t)noise->state_count;
    for (size_t i = 0; i < n * n; i++) {
        if (f)
            f[i] = 0;
        if (q_c)
            q_c[i] = 0;
    }
    if (q_c)
        q_c[0] = noise->white * noise->white;
    for (size_t i = 1; i < n; i++) {
        const imk_filter_state *s = &noise->state[i - 1];
        if (f) {
            f[i] = 1;
            f[i * n + i] = s->correlation_time < HUGE_VAL ? -1 / s->correlation_time : 0;
        }
        if (q_c)
            q_c[i * n + i] = s->driving * s->driving;
    }
}

/* [a - 2 (1 - e^-a) + (1 - e^-2a)/2]/a^3 -> 1/3. Below 1 by its series, whose terms are
 * (-1)^(k+1) (2^(k-1) - 2) a^(k-3)/k!: 30 of them leave less than 1e-17. */
static double integrated_walk(double a)
{
    if (a >= 1)
        return (a + 2 * imk_expm1(-a) - 0.5 * imk_expm1(-2 * a)) / (a * a * a);
    double sum = 0, power = 1.0 / 6, two = 4; /* a^(k-3)/k!, 2^(k-1) at k = 3 */
    for (int k = 3; k < 33; k++) {
        sum += (k % 2 == 1 ? power : -power) * (two - 2);
        power *= a / (k + 1);
        two *= 2;
    }
    return sum;
}

/* (1 - e^-a)/a -> 1 */
static double decayed(double a)
{
    return a > 0 ? -imk_expm1(-a) / a : 1;
}

void imk_filter_discrete(const imk_filter_noise *noise, double dt, double *phi, double *q_d)
{
    const size_t n = 1 + (size_t)noise->state_count;
    for (size_t i = 0; i < n * n; i++) {
        if (phi)
            phi[i] = 0;
        if (q_d)
            q_d[i] = 0;
    }
    if (phi)
        phi[0] = 1;
    if (q_d)
        q_d[0] = noise->white * noise->white * dt;
    for (size_t i = 1; i < n; i++) {
        const imk_filter_state *s = &noise->state[i - 1];
        const double a = dt / s->correlation_time; /* 0 for a walk */
        const double one = decayed(a), power = s->driving * s->driving * dt;
        if (phi) {
            phi[i] = dt * one;
            phi[i * n + i] = imk_exp(-a);
        }
        if (q_d) {
            q_d[0] += power * dt * dt * integrated_walk(a);
            q_d[i] = q_d[i * n] = 0.5 * power * dt * one * one;
            q_d[i * n + i] = power * decayed(2 * a);
        }
    }
}
