/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro in time. Light reaches the detector with the phase difference of the moment;
 * the electronics act once per transit tau, so that nothing lies between transits and the map from
 * one to the next is exact:
 *
 *   closed   ramp   <- ramp + step, less 2 pi when it overflows
 *            error   = K W + nonreciprocal + (ramp - ramp of the transit before)
 *            power   = P0/2 [1 + V cos(error + b)], then with - b, in turn
 *            step   <- step - g (power(-) - power(+))/(P0 V sin b), every second transit
 *   open     16 powers P0/2 [1 + V cos(error + b cos t)] over a period 2 tau and their harmonic
 *
 * A sample may end anywhere within a transit; the rest of it belongs to the next sample. */
#include "base/algebra/linear_system_internal.h"
#include "fibre_optic_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { SOURCE_DETECTOR = 0, SOURCE_PHASE = 0, SOURCE_WAVELENGTH = 1 }; /* fixed for ever */
enum { INSTANTS = IMKI_FIBRE_OPTIC_INSTANTS };

typedef imki_fibre_optic_state gyro;
typedef imki_fibre_optic_loop loop;

/* Nearest whole number for |x| < 2^51, ties to even. */
static inline double nearest(double x)
{
    const double shift = 0x1.8p52;
    return (x + shift) - shift;
}

/* Sine and cosine of x. In lock the angle is small, and Taylor's series to x^11 and x^10 are exact
 * to 1e-18 and 2e-16 at 0.25. */
static inline void sine_cosine(double x, double *sine, double *cosine)
{
    const double turns = nearest(x * (0.5 / IMKI_PI));
    const double r = x - turns * (2.0 * IMKI_PI);
    if (fabs(r) > 0.25) {
        *sine = imk_sin(r);
        *cosine = imk_cos(r);
        return;
    }
    const double w = r * r, w2 = w * w;
    const double s = (-1.0 / 6 + w * (1.0 / 120)) +
                     w2 * ((-1.0 / 5040 + w * (1.0 / 362880)) - w2 * (1.0 / 39916800));
    const double c =
        (-0.5 + w * (1.0 / 24)) + w2 * ((-1.0 / 720 + w * (1.0 / 40320)) - w2 * (1.0 / 3628800));
    *sine = r + r * w * s;
    *cosine = 1.0 + w * c;
}

static inline double clamp(double x, double limit)
{
    x = x > limit ? limit : x;
    return x < -limit ? -limit : x;
}

/* The detector's noise at this power, for the time the reading lasts. */
static inline double noisy(gyro *g, double power)
{
    const double variance = g->noise[0] + power * (g->noise[1] + power * g->noise[2]);
    return power + sqrt(variance) * imki_draw(&g->draws);
}

static inline double converted(const gyro *g, double power)
{
    const double x = clamp(power, g->converter_limit);
    return g->rounds ? nearest(x * g->per_count) * g->count : x;
}

/* One transit of the closed loop. */
static inline void transit(gyro *g, loop *l, double phase)
{
    double ramp = l->ramp + l->step;
    if (ramp >= g->wrap) {
        ramp -= g->wrap;
        l->resets += 1.0;
    } else if (ramp < 0.0) {
        ramp += g->wrap;
        l->resets -= 1.0;
    }
    l->ramp = ramp;
    const double applied =
        g->ramp_count > 0.0 ? nearest(ramp * g->per_ramp_count) * g->ramp_count : ramp;
    double error = phase + g->ramp_gain * (applied - l->applied);
    l->applied = applied;
    if (g->design.crosstalk > 0.0)
        error += g->design.crosstalk * imk_sin(ramp);

    double sine, cosine;
    sine_cosine(error, &sine, &cosine);
    const double swing = l->second ? sine * g->sine : -(sine * g->sine);
    l->error = error;
    l->power = g->half_power * (1.0 + (cosine * g->cosine + swing));
    const double reading = converted(g, noisy(g, l->power) - g->centre);
    if (l->second)
        l->step = clamp(l->step - g->gain * (reading - l->first), g->step_limit);
    else
        l->first = reading;
    l->second = !l->second;
}

/* One period of the open loop, at the beginning of its first transit. The amplitude of the first
 * harmonic is -P0 V J1(b) sin(error). */
static void period(gyro *g, loop *l, double phase)
{
    double sine, cosine, sum = 0.0;
    sine_cosine(phase, &sine, &cosine);
    for (int i = 0; i < INSTANTS; i++) {
        const double power =
            g->half_power * (1.0 + (g->instant_even[i] * cosine - g->instant_odd[i] * sine));
        sum += noisy(g, power) * g->instant_cosine[i];
        l->power = power;
    }
    l->error = phase;
    l->step = clamp(g->gain * converted(g, sum * (2.0 / INSTANTS)), g->step_limit);
}

static inline void next(gyro *g, loop *l, double phase)
{
    if (!g->open) {
        transit(g, l, phase);
        return;
    }
    if (!l->second)
        period(g, l, phase);
    l->second = !l->second;
}

/* Advance by a sample. Returns the integral of the step over it, per transit [rad s]. */
static double advance(gyro *g, double phase)
{
    loop l = g->loop;
    double left = g->sample, sum = 0.0;
    l.resets = 0.0;
    if (g->remaining > left) {
        sum = l.step * left;
        g->remaining -= left;
    } else {
        sum = l.step * g->remaining;
        left -= g->remaining;
        const double whole = floor(left / g->transit);
        double total = 0.0;
        const size_t count = (size_t)whole;
        for (size_t i = 0; i < count; i++) {
            next(g, &l, phase);
            total += l.step;
        }
        left -= whole * g->transit; /* rounding may leave it a hair below 0 */
        next(g, &l, phase);
        sum += total * g->transit + l.step * left;
        g->remaining = g->transit - left;
    }
    g->loop = l;
    return sum;
}

/* ---- the slow level -------------------------------------------------------------------------- */

/* y' = a (u - y) + a n, z' = y: reading and its integral, n white of density N. */
static double slow_closed(gyro *g, double phase)
{
    const double trim = 1.0 + g->design.reset_error, fringe = 2.0 * IMKI_PI * trim * g->reading;
    const double dead = g->design.crosstalk * trim * g->reading;
    double input = phase * trim * g->reading;
    input -= fringe * nearest((input - g->slow_rate) / fringe);
    if (dead > 0.0) {
        const double beyond = input * input - dead * dead;
        const double moving = beyond > 0.0 ? sqrt(beyond) : 0.0;
        input = input < 0.0 ? -moving : moving;
    }
    const double first = imki_draw(&g->draws), second = imki_draw(&g->draws);
    const double y = g->slow_rate;
    g->slow_rate = g->phi[0][0] * y + g->gamma[0] * input + g->root[0][0] * first;
    const double angle =
        g->phi[1][0] * y + g->gamma[1] * input + (g->root[1][0] * first + g->root[1][1] * second);
    g->loop.step = -g->slow_rate * g->scale;
    return angle / g->sample;
}

static double slow_open(gyro *g, double phase)
{
    double sine, cosine;
    sine_cosine(phase, &sine, &cosine);
    g->slow_rate = g->harmonic_gain * sine * g->reading + g->white * imki_draw(&g->draws);
    g->loop.step = -g->slow_rate * g->scale;
    return g->slow_rate;
}

/* ---- step ------------------------------------------------------------------------------------ */

/* Counts of the angle, the rest carried to the next sample. */
static double counted(gyro *g, double rate)
{
    if (!(g->angle_count > 0.0))
        return rate;
    g->residual += rate * g->sample;
    const double angle = nearest(g->residual / g->angle_count) * g->angle_count;
    g->residual -= angle;
    return angle / g->sample;
}

void imki_fibre_optic_step(void *state, const imk_exposure *exposure, double *outputs)
{
    gyro *g = state;
    const imk_fibre_optic *design = &g->design;
    const double ratio =
        imki_fibre_optic_scale_ratio(design, g->wavelength_run, exposure->temperature);
    g->scale_error = ratio - 1.0;
    g->nonreciprocal =
        design->phase_fixed +
        design->phase_temperature * (exposure->temperature - IMKI_DESIGN_TEMPERATURE) +
        imk_fibre_optic_shupe_coefficient(design) * g->scale * exposure->temperature_rate +
        imki_wander_next(&g->phase);
    g->input = exposure->angular_rate[0];
    const double phase = g->scale * ratio * g->input + g->nonreciprocal;
    double rate;
    if (g->slow) {
        rate = g->open ? slow_open(g, phase) : slow_closed(g, phase);
        rate = clamp(rate, design->range);
        g->loop.error = g->open ? phase : phase + g->loop.step;
        g->loop.resets = 0.0;
    } else {
        rate = -advance(g, phase) * g->reading / g->sample;
    }
    outputs[0] = counted(g, rate);
    outputs[1] = g->loop.resets / g->sample;
}

void imki_fibre_optic_observe(const void *state, double *signals)
{
    const gyro *g = state;
    const loop *l = &g->loop;
    const imki_fibre_optic_point point = imki_fibre_optic_operate(&g->design);
    /* second: the transit shown is the first of its pair, modulated by +b */
    const double modulation = g->open ? 0.0 : l->second ? point.depth : -point.depth;
    signals[IMKI_FIBRE_OPTIC_INPUT] = g->input;
    signals[IMKI_FIBRE_OPTIC_FEEDBACK] = -l->step * g->reading;
    signals[IMKI_FIBRE_OPTIC_ERROR] = l->error;
    signals[IMKI_FIBRE_OPTIC_DIFFERENCE] = l->error + modulation;
    signals[IMKI_FIBRE_OPTIC_POWER] = l->power;
    signals[IMKI_FIBRE_OPTIC_RAMP] = l->ramp;
    signals[IMKI_FIBRE_OPTIC_NONRECIPROCAL] = g->nonreciprocal;
    signals[IMKI_FIBRE_OPTIC_SCALE] = g->scale_error;
}

/* ---- start ----------------------------------------------------------------------------------- */

static void start_detector(gyro *g, const imk_physics_settings *settings)
{
    const imk_fibre_optic *design = &g->design;
    const imki_fibre_optic_point point = imki_fibre_optic_operate(design);
    /* a mean over the time T of white noise of the one-sided density S has the variance S/(2 T) */
    const double duration = g->open ? 2.0 * g->transit / INSTANTS : g->transit;
    for (int i = 0; i < 3; i++)
        g->noise[i] = settings->noise ? point.noise[i] / (2.0 * duration) : 0.0;
    g->half_power = point.half_power;
    g->cosine = design->visibility * imk_cos(point.depth);
    g->sine = design->visibility * imk_sin(point.depth);
    g->centre = g->open ? 0.0 : point.centre;
    g->converter_limit = design->converter_range > 0.0 ? design->converter_range : (double)INFINITY;
    g->rounds = settings->noise && point.count > 0.0;
    g->count = point.count;
    g->per_count = point.count > 0.0 ? 1.0 / point.count : 0.0;
    const double slope = imki_fibre_optic_nominal_slope(design);
    const double share = g->open ? 1.0 : 0.5 * design->loop_gain;
    g->gain = share * (1.0 + design->demodulation_error) / slope;
    for (int i = 0; i < INSTANTS; i++) {
        const double c = imk_cos(2.0 * IMKI_PI * (i + 0.5) / INSTANTS);
        g->instant_cosine[i] = c;
        g->instant_even[i] = design->visibility * imk_cos(point.depth * c);
        g->instant_odd[i] = design->visibility * imk_sin(point.depth * c);
    }
}

static void start_loop(gyro *g)
{
    const imk_fibre_optic *design = &g->design;
    g->wrap = 2.0 * IMKI_PI * (1.0 + design->reset_error);
    g->ramp_gain = 1.0 + design->gain_error;
    g->ramp_count = design->ramp_bits > 0 ? 2.0 * IMKI_PI / (double)(1 << design->ramp_bits) : 0.0;
    g->per_ramp_count = design->ramp_bits > 0 ? 1.0 / g->ramp_count : 0.0;
    g->step_limit = design->range * g->scale;
    g->angle_count = imki_fibre_optic_count_angle(design);
}

static void start_slow(gyro *g, const imk_physics_settings *settings)
{
    const double density = settings->noise ? imk_fibre_optic_angle_random_walk(&g->design) : 0.0;
    g->harmonic_gain = imk_fibre_optic_harmonic_gain(&g->design);
    g->white = g->harmonic_gain * density / sqrt(g->sample);
    if (g->open)
        return;
    /* An effective gain of 1 and more settles within a pair of transits or rings at half their
     * rate; the slow level takes it for a loop that settles to 1e-3 in a pair. */
    const double rest = 1.0 - imk_fibre_optic_effective_gain(&g->design);
    const double pole = -imk_ln(rest > 1e-3 ? rest : 1e-3) / (2.0 * g->transit);
    const double a[] = {-pole, 0.0, 1.0, 0.0}, b[] = {pole, 0.0};
    const double noise = pole * density, w[] = {noise * noise, 0.0, 0.0, 0.0};
    double root[4], phi[4];
    imki_discretise(2, 1, a, b, g->sample, phi, g->gamma);
    imki_step_covariance(2, a, w, g->sample, root);
    imki_covariance_root(2, root, root);
    memcpy(g->phi, phi, sizeof phi);
    memcpy(g->root, root, sizeof root);
}

double imki_fibre_optic_step_length(const void *design, const imk_physics_settings *settings)
{
    return settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate
                                             : imk_fibre_optic_transit_time(design);
}

imk_status imki_fibre_optic_init(const void *design, const imk_physics_settings *settings,
                                 void *state, imk_error *error)
{
    const imk_fibre_optic *d = design;
    size_t count;
    double step;
    const double longest = imki_fibre_optic_step_length(d, settings);
    imk_status status =
        imki_divide_sample(settings, longest, longest * (1.0 + 1e-9),
                           "at most the transit time (slow level: the sample interval): the light "
                           "is modulated and read once a transit",
                           &count, &step, error);
    if (status != IMK_OK)
        return status;
    gyro *g = state;
    g->design = *d;
    g->open = d->loop == IMK_FIBRE_OPTIC_OPEN;
    g->slow = settings->level == IMK_LEVEL_SLOW;
    g->sample = 1.0 / settings->rate;
    g->transit = imk_fibre_optic_transit_time(d);
    g->scale = imk_fibre_optic_scale(d);
    g->reading = 1.0 / g->scale;
    start_detector(g, settings);
    start_loop(g);
    start_slow(g, settings);
    g->wavelength_run = imki_run_constant(settings, SOURCE_WAVELENGTH, d->wavelength_repeatability);
    imki_wander_start(&g->phase, settings, SOURCE_PHASE, d->phase_repeatability,
                      d->phase_instability);
    imki_draws_start(&g->draws, settings, SOURCE_DETECTOR);
    return IMK_OK;
}
