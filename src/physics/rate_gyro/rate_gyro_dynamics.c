/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of a spring-restrained gimbal. With x = (th, th', integral of th),
 *
 *     x[k+1] = phi x[k] + gamma (N(th[k]) + N(th[k+1]))/2 + noise,
 *
 * phi and gamma exact for I th'' + c th' + k th = N, N the torque that depends on the angle. The
 * scheme is its own reverse, of second order, and exact where the gimbal comes to rest. The
 * equation for th[k+1] is solved by iteration; a step contracts the error by h^2 N'/(4 I) < 1e-3.
 */
#include "rate_gyro_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <math.h>
#include <string.h>

/* Sources of randomness; fixed for ever. */
enum { TORQUE_NOISE = 0, PICKOFF_NOISE = 1, TORQUE_WANDER = 0 };
enum { N = IMKI_RATE_GYRO_STATES, ITERATIONS = 3 };

/* Steps to a cycle of the gimbal: 1/64 leaves 8e-4 of the part of the stiffness that depends on the
 * rate as an error of the frequency; at 8 the iteration still converges. */
static const double steps_per_cycle = 64.0, fewest_steps = 8.0;

static double cycle(const imk_rate_gyro *design)
{
    return 2.0 * IMKI_PI / imk_rate_gyro_natural_frequency(design);
}

double imki_rate_gyro_step_length(const void *design, const imk_physics_settings *settings)
{
    size_t count;
    double step = 0.0;
    const double longest =
        settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate : cycle(design) / steps_per_cycle;
    imk_physics_settings own = *settings;
    own.step = 0.0;
    imki_divide_sample(&own, longest, longest, "", &count, &step, NULL);
    return step;
}

static void start_linear_part(imki_rate_gyro_state *s, const imk_rate_gyro *d)
{
    const double inertia = d->output_inertia;
    const double a[N * N] = {0.0, 1.0, 0.0, -s->stiffness / inertia, -d->damping / inertia, 0.0,
                             1.0, 0.0, 0.0};
    const double b[N] = {0.0, 1.0 / inertia, 0.0};
    const double thermal = imk_thermal_torque(d->damping);
    const double density = thermal * thermal + d->torque.noise * d->torque.noise;
    const double w[N * N] = {[N + 1] = density / (inertia * inertia)};
    imki_discretise(N, 1, a, b, s->step, s->phi, s->gamma);
    imki_step_covariance(N, a, w, s->step, s->root);
    imki_covariance_root(N, s->root, s->root);
    s->torque_sigma = sqrt(density * s->rate);
}

imk_status imki_rate_gyro_init(const void *design, const imk_physics_settings *settings,
                               void *state, imk_error *error)
{
    const imk_rate_gyro *d = design;
    imki_rate_gyro_state *s = state;
    const bool slow = settings->level == IMK_LEVEL_SLOW;
    const double sample = 1.0 / settings->rate;
    imk_status status =
        imki_divide_sample(settings, slow ? sample : cycle(d) / steps_per_cycle,
                           slow ? (double)INFINITY : cycle(d) / fewest_steps,
                           "at least 8 steps to a cycle of the gimbal", &s->count, &s->step, error);
    if (status != IMK_OK)
        return status;
    s->level = settings->level;
    s->rate = settings->rate;
    s->gimbal = imki_rate_gyro_gimbal(d);
    s->stiffness = imki_rate_gyro_stiffness(d);
    s->stiffness_temperature = s->stiffness * d->stiffness_temperature;
    s->friction = d->friction;
    s->stop = d->stop;
    s->fixed_torque = d->torque.fixed;
    s->torque_temperature = d->torque.temperature;
    s->reading = d->stiffness / d->momentum;
    s->noise = d->pickoff_noise * sqrt(settings->rate);
    s->resolution = d->pickoff_resolution;
    start_linear_part(s, d);
    imki_draws_start(&s->torque_draws, settings, TORQUE_NOISE);
    imki_draws_start(&s->pickoff_draws, settings, PICKOFF_NOISE);
    imki_wander_start(&s->wander, settings, TORQUE_WANDER, d->torque.repeatability,
                      d->torque.instability);
    return IMK_OK;
}

/* The torque that does not belong to the linear part. */
static double torque_at(const imki_rate_gyro_state *s, const imk_exposure *exposure, double th)
{
    const double warmer = exposure->temperature - IMKI_DESIGN_TEMPERATURE;
    return imki_gimbal_torque(&s->gimbal, exposure, th) + s->error_torque -
           s->stiffness_temperature * warmer * th;
}

static void propagate(const imki_rate_gyro_state *s, double torque, double next[N])
{
    for (int i = 0; i < N; i++)
        next[i] = s->phi[N * i] * s->x[0] + s->phi[N * i + 1] * s->x[1] +
                  s->phi[N * i + 2] * s->x[2] + s->gamma[i] * torque;
}

/* One step without noise, friction `held` along the motion. */
static void swing(imki_rate_gyro_state *s, const imk_exposure *exposure, double first, double held,
                  double next[N])
{
    propagate(s, first + held, next);
    for (int i = 0; i < ITERATIONS; i++)
        propagate(s, 0.5 * (first + torque_at(s, exposure, next[0])) + held, next);
}

/* One step with friction: it holds a gimbal at rest while it can, and opposes one that moves; where
 * the gimbal would turn back within the step it stops instead. */
static void swing_or_stick(imki_rate_gyro_state *s, const imk_exposure *exposure, double first,
                           double next[N])
{
    const double net = first - s->stiffness * s->x[0], speed = s->x[1];
    if (speed == 0.0 && fabs(net) <= s->friction) {
        next[0] = s->x[0];
        next[1] = 0.0;
        next[2] = s->x[2] + s->x[0] * s->step;
        return;
    }
    const double along = speed != 0.0 ? speed : net,
                 held = along > 0.0 ? -s->friction : s->friction;
    swing(s, exposure, first, held, next);
    if (next[1] * along < 0.0) {
        const double time = s->step * speed / (speed - next[1]); /* until it stands */
        next[0] = s->x[0] + 0.5 * speed * time;
        next[1] = 0.0;
        next[2] = s->x[2] + next[0] * s->step;
    }
}

static void advance(imki_rate_gyro_state *s, const imk_exposure *exposure)
{
    double next[N], draw[N];
    const double first = torque_at(s, exposure, s->x[0]), before = s->x[0], sum = s->x[2];
    if (s->friction > 0.0)
        swing_or_stick(s, exposure, first, next);
    else
        swing(s, exposure, first, 0.0, next);
    for (int i = 0; i < N; i++)
        draw[i] = imki_draw(&s->torque_draws);
    for (int i = 0; i < N; i++) {
        s->x[i] = next[i];
        for (int j = 0; j <= i; j++)
            s->x[i] += s->root[N * i + j] * draw[j];
    }
    if (fabs(s->x[0]) > s->stop) {
        s->x[0] = s->x[0] > 0.0 ? s->stop : -s->stop;
        s->x[1] = 0.0;
        s->x[2] = sum + 0.5 * (before + s->x[0]) * s->step;
    }
}

/* The angle at which the torques balance, by iteration from the last one (the torque depends on it
 * weakly). Friction lets the gimbal stand anywhere within friction/k of the balance. */
static double balance(const imki_rate_gyro_state *s, const imk_exposure *exposure, double noise)
{
    const double play = s->friction / s->stiffness;
    double th = s->x[0];
    for (int i = 0; i < 8; i++)
        th = (torque_at(s, exposure, th) + noise) / s->stiffness;
    if (s->x[0] > th + play)
        th += play;
    else if (s->x[0] < th - play)
        th -= play;
    else
        th = s->x[0];
    return th > s->stop ? s->stop : th < -s->stop ? -s->stop : th;
}

void imki_rate_gyro_step(void *state, const imk_exposure *exposure, double *outputs)
{
    imki_rate_gyro_state *s = state;
    const double warmer = exposure->temperature - IMKI_DESIGN_TEMPERATURE;
    s->error_torque =
        s->fixed_torque + s->torque_temperature * warmer + imki_wander_next(&s->wander);
    double angle;
    if (s->level == IMK_LEVEL_SLOW) {
        s->x[0] = balance(s, exposure, s->torque_sigma * imki_draw(&s->torque_draws));
        angle = s->x[0];
    } else {
        s->x[2] = 0.0;
        for (size_t i = 0; i < s->count; i++)
            advance(s, exposure);
        angle = s->x[2] * s->rate;
    }
    angle += s->noise * imki_draw(&s->pickoff_draws);
    angle = imki_quantised(angle, s->resolution);
    outputs[0] = s->reading * angle;
}

void imki_rate_gyro_observe(const void *state, double *signals)
{
    const imki_rate_gyro_state *s = state;
    signals[0] = s->x[0];
    signals[1] = s->x[1];
    signals[2] = s->error_torque;
    signals[3] = s->stiffness * s->x[0];
}
