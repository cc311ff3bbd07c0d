/* SPDX-License-Identifier: Apache-2.0 */
/* The suspension and the oscillations of the beams.
 *
 *     x'' + 2 zeta w x' + w^2 x = w^2 (f + n)      suspension, exact for a held force
 *     (x, v/w)  turns by w h in a step             beam: exact, whatever the step
 *
 * The drive balances the damping; what is left of the difference pulls the amplitude back to its
 * nominal value with the time constant below, and does not touch the phase. Thermal force adds
 * 2 k T m w/Q (two-sided) to the force: a variance of k T h/(m Q w) to x and v/w each, of which the
 * part along the motion is pulled back, and the part across it stays in the phase. */
#include "vibrating_beam_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* Sources of randomness, fixed for ever. */
enum { SOURCE_SUSPENSION = 0, SOURCE_BEAM_1 = 1, SOURCE_EDGES_1 = 3 };
enum { WANDER_MOUNT = 0 };

static const double drive_cycles = 50.0; /* time constant of the amplitude control */

/* No beam is faster at T_0: f^2 = 1.906 f_0^2 under IMKI_BEAM_LOAD_MAX. */
static double highest_frequency(const imk_vibrating_beam *d)
{
    const double f1 = imk_vibrating_beam_frequency(d, 0), f2 = imk_vibrating_beam_frequency(d, 1);
    return 1.4 * (f1 > f2 ? f1 : f2);
}

double imki_beams_step_length(const void *design, const imk_physics_settings *settings)
{
    const imk_vibrating_beam *d = design;
    const double hold = 1.0 / (16.0 * d->suspension_frequency);
    const double step = 1.0 / (8.0 * highest_frequency(d));
    return settings->level == IMK_LEVEL_SLOW || hold < step ? hold : step;
}

static size_t parts_of(double whole, double longest)
{
    const double parts = ceil(whole / longest * (1.0 - 1e-9));
    return parts > 1.0 ? (size_t)parts : 1;
}

static imk_status divide(imki_beams *s, const imk_physics_settings *settings, imk_error *error)
{
    const imk_vibrating_beam *d = &s->d;
    const double slowest = 1.0 / (8.0 * d->suspension_frequency);
    const double fastest = 1.0 / (4.0 * highest_frequency(d));
    const double limit = s->slow || slowest < fastest ? slowest : fastest;
    const double step = imki_beams_step_length(d, settings);
    size_t count = 0;
    const imk_status status = imki_divide_sample(
        settings, step, limit,
        "at least 4 steps to a cycle of the beams and 8 to a cycle of the suspension", &count,
        &s->h, error);
    if (status != IMK_OK)
        return status;
    const double wanted = settings->step > 0.0 ? settings->step : step;
    const double hold = 1.0 / (16.0 * d->suspension_frequency);
    s->forces = parts_of(1.0 / settings->rate, s->slow || wanted > hold ? wanted : hold);
    s->hold = 1.0 / (settings->rate * (double)s->forces);
    s->steps = s->slow ? 1 : parts_of(s->hold, wanted);
    s->h = s->hold / (double)s->steps;
    return IMK_OK;
}

static void start_suspension(imki_beams *s)
{
    const double w = 2.0 * IMKI_PI * s->d.suspension_frequency;
    const double a[4] = {0.0, 1.0, -w * w, -2.0 * s->d.suspension_damping * w};
    const double b[2] = {0.0, w * w};
    const double density[4] = {0.0, 0.0, 0.0, w * w * w * w * imki_suspension_density(&s->d)};
    imki_discretise(2, 1, a, b, s->hold, s->phi, s->gamma);
    imki_step_covariance(2, a, density, s->hold, s->root);
    imki_covariance_root(2, s->root, s->root);
}

imk_status imki_beams_start(const void *design, const imk_physics_settings *settings, void *state,
                            imk_error *error)
{
    const imk_vibrating_beam *d = design;
    imki_beams *s = state;
    s->d = *d;
    s->slow = settings->level == IMK_LEVEL_SLOW;
    imk_status status = divide(s, settings, error);
    if (status != IMK_OK)
        return status;
    start_suspension(s);
    s->square = imk_vibrating_beam_frequency(d, 0) * imk_vibrating_beam_frequency(d, 0);
    s->load_per_force = imki_beam_load_per_force(d);
    imki_load_series_make(s->series);
    s->pull = -imk_expm1(-s->h * imk_vibrating_beam_frequency(d, 0) / drive_cycles);
    for (int i = 0; i < 2; i++) {
        imki_beam *b = &s->beam[i];
        const double turn = sqrt(imki_beam_phase_density(d, i) * s->h); /* 1 sigma in a step */
        b->kick = s->slow ? turn / (2.0 * IMKI_PI) : turn * d->amplitude;
        b->y = d->amplitude;
        b->frequency = imk_vibrating_beam_frequency(d, i);
        imki_draws_start(&b->noise, settings, (uint8_t)(SOURCE_BEAM_1 + i));
        imki_draws_start(&b->edges, settings, (uint8_t)(SOURCE_EDGES_1 + i));
    }
    imki_draws_start(&s->suspension, settings, SOURCE_SUSPENSION);
    imki_wander_start(&s->mount, settings, WANDER_MOUNT, d->mount_force_repeatability,
                      d->mount_force_instability);
    return IMK_OK;
}

/* What the beams feel at the end of a hold [m/s^2], within the stops. */
static double suspended(imki_beams *s, double force)
{
    const double n0 = imki_draw(&s->suspension), n1 = imki_draw(&s->suspension);
    const double x =
        s->phi[0] * s->mass[0] + s->phi[1] * s->mass[1] + s->gamma[0] * force + s->root[0] * n0;
    const double v = s->phi[2] * s->mass[0] + s->phi[3] * s->mass[1] + s->gamma[1] * force +
                     s->root[2] * n0 + s->root[3] * n1;
    s->mass[0] = x;
    s->mass[1] = v;
    if (fabs(x) > s->d.range) {
        s->mass[0] = x > 0.0 ? s->d.range : -s->d.range;
        s->mass[1] = 0.0;
    }
    return s->mass[0];
}

/* What temperature makes of both beams; a push on one is a pull on the other. */
static void warm_up(imki_beams *s, double warm)
{
    for (int k = 0; k < 2; k++) {
        const double stiffness = imki_beam_stiffness(&s->d, k, warm);
        s->beam[k].square = s->square * stiffness;
        s->beam[k].load_per_force = (k == 0 ? 1.0 : -1.0) * s->load_per_force / stiffness;
    }
}

/* Frequency of a beam under the force on the first, and the turn of a step. */
static void tune(const imki_beams *s, imki_beam *b)
{
    const double load = b->load_per_force * s->force;
    b->frequency = sqrt(b->square * imki_load_series_at(s->series, load));
    if (s->slow)
        return;
    const double w = 2.0 * IMKI_PI * b->frequency;
    if (b->w > 0.0)
        b->y *= b->w / w; /* the velocity is continuous */
    b->w = w;
    b->turn_cos = imk_cos(w * s->h);
    b->turn_sin = imk_sin(w * s->h);
}

/* The drive pulls the square r of the amplitude back by r' = r (1 - r)/tau. A large r, which a jump
 * of temperature may leave, needs the whole solution. */
static void oscillate(const imki_beams *s, imki_beam *b)
{
    const double nominal = s->d.amplitude * s->d.amplitude;
    for (size_t i = 0; i < s->steps; i++) {
        const double x = b->turn_cos * b->x + b->turn_sin * b->y + b->kick * imki_draw(&b->noise);
        const double y = b->turn_cos * b->y - b->turn_sin * b->x + b->kick * imki_draw(&b->noise);
        const double excess = (x * x + y * y) / nominal;
        const double factor = excess < 4.0 ? 1.0 + 0.5 * s->pull * (1.0 - excess)
                                           : 1.0 / sqrt(1.0 + s->pull * (excess - 1.0));
        b->cycles += b->x < 0.0 && x >= 0.0;
        b->x = x * factor;
        b->y = y * factor;
    }
}

static void count_phase(const imki_beams *s, imki_beam *b)
{
    b->phase += b->frequency * s->h + b->kick * imki_draw(&b->noise);
    const double whole = floor(b->phase);
    b->cycles += (int64_t)whole;
    b->phase -= whole;
}

/* Cycles since the last upward crossing, 0 … 1. */
static double fraction_of(const imki_beams *s, const imki_beam *b)
{
    if (s->slow)
        return b->phase;
    const double fraction = imk_atan2(b->x, b->y) / (2.0 * IMKI_PI);
    return fraction < 0.0 ? fraction + 1.0 : fraction;
}

/* How long ago the last crossing was, by the comparator's edge and the ticks of the clock. */
static double rounded_age(const imki_beams *s, double age)
{
    if (s->d.clock <= 0.0)
        return age;
    return (s->clock_time - floor(s->clock_time - age * s->d.clock)) / s->d.clock;
}

/* Whole cycles between the last crossings of this sample and the one before, by their time. A
 * sample without a crossing keeps the reading. */
static double read_counter(const imki_beams *s, imki_beam *b, double sample, double before)
{
    const double edge = imki_beam_edge(&s->d, b->frequency) * imki_draw(&b->edges);
    const double age = rounded_age(s, fraction_of(s, b) / b->frequency + edge);
    const double time = sample + b->crossing - age;
    double reading = before;
    if (b->started && b->cycles > 0)
        reading = (double)b->cycles / time;
    else if (!b->started)
        reading = b->frequency;
    b->crossing = b->started && b->cycles == 0 ? b->crossing + sample : age;
    b->started = true;
    b->cycles = 0;
    return reading;
}

void imki_beams_advance(void *state, const imk_exposure *exposure, double frequency[2])
{
    imki_beams *s = state;
    const imk_vibrating_beam *d = &s->d;
    const double mass = d->proof_mass * (1.0 + d->proof_mass_error);
    const double mount = d->mount_force + imki_wander_next(&s->mount);
    const double sample = s->hold * (double)s->forces;
    warm_up(s, exposure->temperature - d->temperature);
    for (size_t i = 0; i < s->forces; i++) {
        s->force = mass * suspended(s, exposure->specific_force[0]) + mount;
        for (int k = 0; k < 2; k++) {
            imki_beam *b = &s->beam[k];
            tune(s, b);
            if (s->slow)
                count_phase(s, b);
            else
                oscillate(s, b);
        }
    }
    s->clock_time += sample * d->clock;
    s->clock_time -= floor(s->clock_time);
    for (int k = 0; k < 2; k++) {
        frequency[k] = s->reading[k] = read_counter(s, &s->beam[k], sample, s->reading[k]);
    }
}

void imki_beams_observe(const void *state, double *signals)
{
    const imki_beams *s = state;
    for (int k = 0; k < 2; k++) {
        const imki_beam *b = &s->beam[k];
        signals[k] = s->slow ? s->d.amplitude * imk_sin(2.0 * IMKI_PI * b->phase) : b->x;
        signals[3 + k] = s->slow ? s->d.amplitude : sqrt(b->x * b->x + b->y * b->y);
    }
    signals[2] = s->force;
}
