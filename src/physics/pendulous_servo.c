/* SPDX-License-Identifier: Apache-2.0 */
/* Pendulous servo accelerometer. The captured pendulum and its controller are linear in the state
 * (phi, phi', z, c), where z integrates the pickoff's reading and c the control torque:
 *
 *     J phi'' = T - b phi' - (K_h + K_p) phi - K_i z - K_p n
 *     z'      = phi + n
 *     c'      = K_p phi + K_i z + K_p n                    mean torque of a step: its change / h
 *
 * What is not linear, P (f_x (cos phi - 1) + f_z sin phi), kicks phi' by half a step before and
 * behind each exact step of the rest. */
#include "imukit/pendulous_servo.h"

#include "base/linear_system_internal.h"
#include "imukit/elementary.h"
#include "imukit/units.h"
#include "physics/physics_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x494D4B3B, STATES = 4 };
enum { PHI, OMEGA, INTEGRAL, CONTROL };

/* Sources of randomness, fixed for ever. */
enum { SOURCE_LOOP = 0, SOURCE_READOUT = 1 };
enum { WANDER_HINGE = 0, WANDER_TORQUER = 1 };

typedef imk_pendulous_servo design_type;

imk_pendulous_servo imk_pendulous_servo_default(void)
{
    const double pendulosity = 3.2e-6, inertia = 3e-8, loop = 2.0 * IMKI_PI * 800.0;
    const double torquer = pendulosity * IMK_STANDARD_GRAVITY / 1.3e-3;
    const double micro_g = 1e-6 * IMK_STANDARD_GRAVITY * pendulosity;
    const double stiffness = inertia * loop * loop;
    return (imk_pendulous_servo){.cookie = COOKIE,
                                 .pendulosity = pendulosity,
                                 .inertia = inertia,
                                 .damping = 2.0 * 0.7 * inertia * loop,
                                 .hinge_stiffness = 0.01,
                                 .stop = 0.002,
                                 .hinge_torque = 1500.0 * micro_g,
                                 .hinge_torque_temperature = 10.0 * micro_g,
                                 .hinge_torque_repeatability = 40.0 * micro_g,
                                 .hinge_torque_instability = 1.0 * micro_g,
                                 .proportional = stiffness,
                                 .integral = 300.0 * stiffness,
                                 .torquer_constant = torquer,
                                 .torquer_error = 0.0,
                                 .torquer_temperature = 120.0 * 1e-6,
                                 .torquer_repeatability = 80.0 * 1e-6,
                                 .torquer_quadratic = -0.004,
                                 .largest_current = 60.0 * 1.3e-3,
                                 .readout_noise = 1.5e-6 * 1.3e-3,
                                 .pickoff_noise = 1e-10,
                                 .misalignment_y = 0.0005,
                                 .misalignment_z = 0.0005,
                                 .temperature = 293.15};
}

#define NUMBER(path, member, unit, minimum, maximum, open, help)                                   \
    {                                                                                              \
        path, IMK_DESIGN_NUMBER, offsetof(imk_pendulous_servo, member), unit, minimum, maximum,    \
            open, NULL, help                                                                       \
    }

static const imk_design_field fields[] = {
    NUMBER("pendulum.pendulosity", pendulosity, "kg m", 1e-12, 1.0, false,
           "mass times its distance from the hinge"),
    NUMBER("pendulum.inertia", inertia, "kg m^2", 0.0, 1.0, true,
           "moment of inertia about the hinge"),
    NUMBER("pendulum.damping", damping, "N m s", 0.0, 1.0, false, "torque per angular rate"),
    NUMBER("pendulum.stop", stop, "rad", 0.0, 0.5, true, "largest angle"),
    NUMBER("pendulum.misalignment_y", misalignment_y, "mrad", -0.1, 0.1, false,
           "input axis towards the output axis y"),
    NUMBER("pendulum.misalignment_z", misalignment_z, "mrad", -0.1, 0.1, false,
           "input axis towards the pendulous axis z"),
    NUMBER("hinge.stiffness", hinge_stiffness, "N m/rad", 0.0, 1e3, false, "torque per angle"),
    NUMBER("hinge.torque", hinge_torque, "N m", -1.0, 1.0, false, "constant error torque"),
    NUMBER("hinge.torque_temperature", hinge_torque_temperature, "N m/K", -1.0, 1.0, false,
           "its change with temperature"),
    NUMBER("hinge.torque_repeatability", hinge_torque_repeatability, "N m", 0.0, 1.0, false,
           "1 sigma from run to run"),
    NUMBER("hinge.torque_instability", hinge_torque_instability, "N m", 0.0, 1.0, false,
           "flicker B within a run"),
    NUMBER("controller.proportional", proportional, "N m/rad", 0.0, 1e6, true,
           "torque per angle of the pickoff"),
    NUMBER("controller.integral", integral, "N m/(rad s)", 0.0, 1e12, false,
           "torque per integral of that angle"),
    NUMBER("controller.pickoff_noise", pickoff_noise, "rad/sqrt(Hz)", 0.0, 1.0, false,
           "two-sided density of the pickoff's noise"),
    NUMBER("torquer.constant", torquer_constant, "N m/A", 0.0, 1e3, true,
           "nominal torque per current"),
    NUMBER("torquer.error", torquer_error, "ppm", -0.5, 0.5, false,
           "relative error of the constant"),
    NUMBER("torquer.temperature", torquer_temperature, "ppm/K", -0.01, 0.01, false,
           "relative change with temperature"),
    NUMBER("torquer.repeatability", torquer_repeatability, "ppm", 0.0, 0.5, false,
           "1 sigma from run to run, relative"),
    NUMBER("torquer.quadratic", torquer_quadratic, "1/A", -10.0, 10.0, false,
           "relative change with current"),
    NUMBER("torquer.largest_current", largest_current, "mA", 0.0, 1e3, true, "limit of the driver"),
    NUMBER("readout.noise", readout_noise, "A/sqrt(Hz)", 0.0, 1.0, false,
           "two-sided density of the current's noise"),
    NUMBER("readout.step", readout_step, "A", 0.0, 1.0, false, "resolution of the sampled current"),
    NUMBER("temperature", temperature, "degC", 1.0, 1000.0, false,
           "temperature of the gas, and where errors are stated"),
};

/* ---- what a designer computes ---------------------------------------------------------------- */

static double stiffness(const design_type *d)
{
    return d->proportional + d->hinge_stiffness;
}

double imk_pendulous_servo_scale(const imk_pendulous_servo *d)
{
    return d->pendulosity / d->torquer_constant;
}

double imk_pendulous_servo_frequency(const imk_pendulous_servo *d)
{
    return sqrt(stiffness(d) / d->inertia) / (2.0 * IMKI_PI);
}

typedef struct complex_number {
    double re, im;
} complex_number;

static double magnitude(complex_number z)
{
    return sqrt(z.re * z.re + z.im * z.im);
}

/* K_c(jw), times jw so that 0 is allowed: (K - J w^2) jw - b w^2 + K_i. */
static complex_number captured_stiffness(const design_type *d, double w)
{
    return (complex_number){d->integral - d->damping * w * w,
                            (stiffness(d) - d->inertia * w * w) * w};
}

double imk_pendulous_servo_gain(const imk_pendulous_servo *d, double frequency)
{
    const double w = 2.0 * IMKI_PI * frequency;
    if (w <= 0.0)
        return d->integral > 0.0 ? 1.0 : d->proportional / stiffness(d);
    const complex_number controller = {d->integral, d->proportional * w};
    return magnitude(controller) / magnitude(captured_stiffness(d, w));
}

double imk_pendulous_servo_bandwidth(const imk_pendulous_servo *d)
{
    const double limit = imk_pendulous_servo_gain(d, 0.0) / sqrt(2.0);
    double low = 0.0, high = imk_pendulous_servo_frequency(d);
    while (imk_pendulous_servo_gain(d, high) > limit)
        high *= 2.0;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        if (imk_pendulous_servo_gain(d, middle) > limit)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

double imk_pendulous_servo_rectification(const imk_pendulous_servo *d, double frequency)
{
    const double w = 2.0 * IMKI_PI * frequency;
    if (w <= 0.0)
        return d->integral > 0.0 ? 0.0 : 0.5 * d->pendulosity / stiffness(d);
    /* 1/K_c = jw/(K_c jw); its real part is w Im(K_c jw)/|K_c jw|^2 */
    const complex_number k = captured_stiffness(d, w);
    return 0.5 * d->pendulosity * w * k.im / (k.re * k.re + k.im * k.im);
}

double imk_pendulous_servo_noise(const imk_pendulous_servo *d)
{
    const double held = d->integral > 0.0 ? 1.0 : d->proportional / stiffness(d);
    const double share = held / (1.0 + d->torquer_error);
    const double brownian = 2.0 * IMKI_BOLTZMANN * d->temperature * d->damping;
    const double pickoff = d->hinge_stiffness * d->pickoff_noise;
    const double readout = d->readout_noise * d->torquer_constant;
    return sqrt(share * share * (brownian + pickoff * pickoff) + readout * readout) /
           d->pendulosity;
}

/* The loop without its output: (phi, phi', z), or (phi, phi') where there is no integral action,
 * under its noise. A step of many time constants gives the stationary covariance. */
double imk_pendulous_servo_quantization(const imk_pendulous_servo *d)
{
    const double j = d->inertia, k = stiffness(d), b = d->damping;
    const int n = d->integral > 0.0 ? 3 : 2;
    const double a[9] = {0.0, 1.0, 0.0, -k / j, -b / j, -d->integral / j, 1.0, 0.0, 0.0};
    const double pickoff[3] = {0.0, -d->proportional / j, 1.0};
    const double density = d->pickoff_noise * d->pickoff_noise;
    double system[9], w[9], covariance[9];
    if (b <= 0.0)
        return 0.0; /* nothing holds the noise */
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++) {
            system[r * n + c] = a[r * 3 + c];
            w[r * n + c] = density * pickoff[r] * pickoff[c];
        }
    w[OMEGA * n + OMEGA] += 2.0 * IMKI_BOLTZMANN * d->temperature * b / (j * j);
    const double slowest = 2.0 * j / b + b / k + (d->integral > 0.0 ? k / d->integral : 0.0);
    imki_step_covariance(n, system, w, 40.0 * slowest, covariance);
    const double variance = j * j * covariance[OMEGA * n + OMEGA] +
                            2.0 * j * b * covariance[PHI * n + OMEGA] +
                            b * b * covariance[PHI * n + PHI];
    return sqrt(variance) / (d->pendulosity * (1.0 + d->torquer_error));
}

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status validate(const void *design, imk_error *error)
{
    const design_type *d = design;
    if (d->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "pendulous_servo", NULL,
                             "a design made by imk_pendulous_servo_default()");
    const imk_status status = imk_design_check(&imk_pendulous_servo_instrument, d, error);
    if (status != IMK_OK)
        return status;
    const double weakest = 1.0 + d->torquer_error - 6.0 * d->torquer_repeatability;
    if (!(weakest > 0.0))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "torquer.repeatability",
                                  d->torquer_repeatability, (1.0 + d->torquer_error) / 6.0,
                                  "so little that the torquer pulls in every run: less than a "
                                  "sixth of its constant");
    const double bend = fabs(d->torquer_quadratic) * d->largest_current;
    if (!(bend < 0.25))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "torquer.quadratic", bend, 0.25,
                                  "less than a quarter over the largest current: the torque grows "
                                  "with it");
    const double largest = d->torquer_constant * (1.0 + d->torquer_error) * d->largest_current;
    const double error_torque = fabs(d->hinge_torque) + 6.0 * d->hinge_torque_repeatability;
    if (!(error_torque < largest))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "hinge.torque", error_torque, largest,
                                  "a hinge torque (and six times its repeatability) below the "
                                  "largest torque of the torquer");
    /* Routh: J s^3 + b s^2 + K s + K_i has its roots on the left when b K > J K_i. */
    const double limit = d->damping * stiffness(d) / d->inertia;
    if (d->integral > 0.0 && !(d->integral < limit))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "controller.integral", d->integral,
                                  limit,
                                  "less than damping x stiffness / inertia: the loop would not be "
                                  "stable");
    return IMK_OK;
}

imk_status imk_pendulous_servo_validate(const imk_pendulous_servo *design, imk_error *error)
{
    return validate(design, error);
}

/* ---- the run --------------------------------------------------------------------------------- */

typedef struct servo {
    imk_pendulous_servo d;
    bool slow;
    size_t steps;
    double h;
    double x[STATES];
    double phi[STATES * STATES], gamma[STATES], root[STATES * STATES];
    double readout_deviation; /* of a sample's mean current [A] */
    double constant_torquer;  /* relative, of this run */
    double torque, current;   /* of the last step [N m], [A] */
    imki_draws loop, readout;
    imki_wander hinge;
} servo;

static double step_length(const void *design, const imk_physics_settings *settings)
{
    return settings->level == IMK_LEVEL_SLOW ? 1.0 / settings->rate
                                             : 1.0 / (32.0 * imk_pendulous_servo_frequency(design));
}

static void linear_loop(const design_type *d, double h, servo *s)
{
    const double j = d->inertia, k = stiffness(d);
    const double a[STATES * STATES] = {
        0.0,         1.0, 0.0, 0.0, -k / j, -d->damping / j, -d->integral / j,
        0.0,         1.0, 0.0, 0.0, 0.0,    d->proportional, 0.0,
        d->integral, 0.0};
    const double b[STATES] = {0.0, 1.0 / j, 0.0, 0.0};
    const double pickoff[STATES] = {0.0, -d->proportional / j, 1.0, d->proportional};
    const double brownian = 2.0 * IMKI_BOLTZMANN * d->temperature * d->damping / (j * j);
    const double density = d->pickoff_noise * d->pickoff_noise;
    double w[STATES * STATES];
    for (int i = 0; i < STATES * STATES; i++)
        w[i] = density * pickoff[i / STATES] * pickoff[i % STATES];
    w[OMEGA * STATES + OMEGA] += brownian;
    imki_discretise(STATES, 1, a, b, h, s->phi, s->gamma);
    imki_step_covariance(STATES, a, w, h, s->root);
    imki_covariance_root(STATES, s->root, s->root);
}

static imk_status init(const void *design, const imk_physics_settings *settings, void *state,
                       imk_error *error)
{
    servo *s = state;
    imki_wander torquer;
    imk_status status = validate(design, error);
    if (status == IMK_OK)
        status = imki_settings_check(settings, error);
    if (status != IMK_OK)
        return status;
    const design_type *d = design;
    memset(s, 0, sizeof *s);
    s->slow = settings->level == IMK_LEVEL_SLOW;
    const double longest = step_length(d, settings);
    status = imki_divide_sample(settings, longest, s->slow ? longest * 1.000001 : 4.0 * longest,
                                "at least 8 steps to a cycle of the captured pendulum", &s->steps,
                                &s->h, error);
    if (status != IMK_OK)
        return status;
    s->d = *d;
    linear_loop(d, s->h, s);
    s->readout_deviation = settings->noise ? d->readout_noise * sqrt(settings->rate) : 0.0;
    imki_draws_start(&s->loop, settings, SOURCE_LOOP);
    imki_draws_start(&s->readout, settings, SOURCE_READOUT);
    status = imki_wander_start(&torquer, settings, WANDER_TORQUER, d->torquer_repeatability, 0.0);
    s->constant_torquer = torquer.constant;
    if (status == IMK_OK)
        status = imki_wander_start(&s->hinge, settings, WANDER_HINGE, d->hinge_torque_repeatability,
                                   d->hinge_torque_instability);
    return status == IMK_OK ? status
                            : imki_design_refuse(error, status, "hinge.torque_instability",
                                                 d->hinge_torque_instability, 0.0, NULL);
}

static double angle_torque(const servo *s, double fx, double fz)
{
    return s->d.pendulosity * (fx * (imk_cos(s->x[PHI]) - 1.0) + fz * imk_sin(s->x[PHI]));
}

/* The linear loop under a torque, and its noise; the control torque of the step. */
static double captured_step(servo *s, double torque)
{
    double next[STATES], normal[STATES];
    for (int i = 0; i < STATES; i++)
        normal[i] = imki_draw(&s->loop);
    for (int i = 0; i < STATES; i++) {
        double sum = s->gamma[i] * torque;
        for (int k = 0; k < STATES; k++)
            sum += s->phi[i * STATES + k] * s->x[k];
        for (int k = 0; k <= i; k++)
            sum += s->root[i * STATES + k] * normal[k];
        next[i] = sum;
    }
    const double mean = next[CONTROL] / s->h;
    memcpy(s->x, next, sizeof next);
    s->x[CONTROL] = 0.0;
    return mean;
}

/* The torquer is at its limit: the pendulum falls under the rest of the torque until a stop holds
 * it, and the integrator waits. Damping and hinge act as they are at the step's middle. */
static double saturated_step(servo *s, double torque, double limit)
{
    const design_type *d = &s->d;
    const double half = 0.5 * s->h;
    s->x[PHI] += half * s->x[OMEGA];
    const double rest = torque - limit - d->hinge_stiffness * s->x[PHI];
    s->x[OMEGA] = (s->x[OMEGA] + s->h * rest / d->inertia) / (1.0 + s->h * d->damping / d->inertia);
    s->x[PHI] += half * s->x[OMEGA];
    return limit;
}

static void hold_at_stop(servo *s)
{
    if (fabs(s->x[PHI]) <= s->d.stop)
        return;
    s->x[PHI] = s->x[PHI] > 0.0 ? s->d.stop : -s->d.stop;
    s->x[OMEGA] = 0.0;
}

/* i of  torque = K_t i (1 + a i), the root that vanishes with the torque. */
static double current_of(const servo *s, double torque, double constant)
{
    const double linear = torque / constant;
    const double under_root = 1.0 + 4.0 * s->d.torquer_quadratic * linear;
    return 2.0 * linear / (1.0 + sqrt(under_root > 0.0 ? under_root : 0.0));
}

static double internal_step(servo *s, double torque, double fx, double fz, double constant)
{
    const design_type *d = &s->d;
    const double demand = d->proportional * s->x[PHI] + d->integral * s->x[INTEGRAL];
    if (!s->slow)
        s->x[OMEGA] += 0.5 * s->h / d->inertia * angle_torque(s, fx, fz);
    const double current = demand > 0.0 ? d->largest_current : -d->largest_current;
    const double limit = constant * current * (1.0 + d->torquer_quadratic * current);
    const double control =
        fabs(demand) < fabs(limit) ? captured_step(s, torque) : saturated_step(s, torque, limit);
    if (!s->slow)
        s->x[OMEGA] += 0.5 * s->h / d->inertia * angle_torque(s, fx, fz);
    hold_at_stop(s);
    return control;
}

static void step(void *state, const imk_exposure *exposure, double *outputs)
{
    servo *s = state;
    const design_type *d = &s->d;
    const double *f = exposure->specific_force, *w = exposure->angular_rate;
    const double warm = exposure->temperature - d->temperature;
    const double constant = d->torquer_constant * (1.0 + d->torquer_error + s->constant_torquer +
                                                   d->torquer_temperature * warm);
    const double fx = f[0] + d->misalignment_y * f[1] + d->misalignment_z * f[2];
    const double torque =
        d->pendulosity * fx + d->inertia * (exposure->angular_acceleration[1] + w[0] * w[2]) +
        d->hinge_torque + d->hinge_torque_temperature * warm + imki_wander_next(&s->hinge);
    double sum = 0.0;
    for (size_t i = 0; i < s->steps; i++) {
        s->torque = internal_step(s, torque, fx, f[2], constant);
        s->current = current_of(s, s->torque, constant);
        sum += s->current;
    }
    double mean = sum / (double)s->steps + s->readout_deviation * imki_draw(&s->readout);
    if (!(fabs(mean) <= d->largest_current))
        mean = mean > 0.0 ? d->largest_current : -d->largest_current;
    if (d->readout_step > 0.0)
        mean = d->readout_step * floor(mean / d->readout_step + 0.5);
    outputs[0] = mean / imk_pendulous_servo_scale(d);
    outputs[1] = mean;
}

static void observe(const void *state, double *signals)
{
    const servo *s = state;
    signals[0] = s->x[PHI];
    signals[1] = s->torque;
    signals[2] = s->current;
}

/* ---- reduction ------------------------------------------------------------------------------- */

/* Without integral action the pendulum stays deflected by (P f + M)/K, M the hinge's torque, and
 * the torque of the angle is P f_z (P f_x + M)/K - P f_x (P f_x)^2/(2 K^2). `seen`: reading per
 * specific force. */
static void deflected(const design_type *d, double seen, imk_triad *triad)
{
    const double k = stiffness(d), angle = d->pendulosity / k;
    triad->nonlinearity.cross_products.value[0][0] = seen * angle;
    triad->cross_axis.value[0][2] = seen * d->hinge_torque / k;
    triad->nonlinearity.k3.value[0] -= 0.5 * seen * angle * angle;
}

void imk_pendulous_servo_reduce(const imk_pendulous_servo *d, imk_model *model)
{
    imk_triad *triad = imki_reduction_begin(model, &imk_pendulous_servo_instrument);
    const double p = d->pendulosity, scale = imk_pendulous_servo_scale(d);
    const double gain = 1.0 / (1.0 + d->torquer_error);
    const double seen = gain * (d->integral > 0.0 ? 1.0 : d->proportional / stiffness(d));
    triad->bias.temperature.order = triad->scale_factor.temperature.order = 1;
    triad->scale_factor.fixed.value[0] = seen - 1.0;
    triad->scale_factor.repeatability.value[0] = seen * gain * d->torquer_repeatability;
    triad->scale_factor.temperature.coefficient[0].value[0] = -seen * gain * d->torquer_temperature;
    imki_temperature_range(&triad->bias.temperature, d->temperature);
    imki_temperature_range(&triad->scale_factor.temperature, d->temperature);
    /* i (1 + a i) = M/K_t:  i = M/K_t - a (M/K_t)^2 … */
    triad->nonlinearity.k2.value[0] = -d->torquer_quadratic * seen * seen * scale;
    triad->nonlinearity.k3.value[0] =
        2.0 * d->torquer_quadratic * d->torquer_quadratic * seen * seen * seen * scale * scale;
    if (d->integral <= 0.0)
        deflected(d, seen, triad);
    const double shows =
        imki_reduction_offset(triad, d->hinge_torque / p, d->hinge_torque_temperature / p);
    triad->bias.repeatability.value[0] = shows * d->hinge_torque_repeatability / p;
    triad->noise.bias_instability.value[0] = shows * d->hinge_torque_instability / p;
    triad->misalignment.value[0][1] = seen * d->misalignment_y;
    triad->misalignment.value[0][2] = seen * d->misalignment_z;
    triad->lever_arm.value[0][2] = d->inertia / p;
    triad->noise.white.value[0] = imk_pendulous_servo_noise(d);
    if (d->readout_step > 0.0)
        triad->resolution.value[0] = d->readout_step / scale;
    else
        triad->noise.quantization.value[0] = imk_pendulous_servo_quantization(d);
    triad->bandwidth.value[0] = imk_pendulous_servo_bandwidth(d);
    triad->damping.value[0] =
        imki_model_damping(d->damping / (2.0 * sqrt(d->inertia * stiffness(d))));
    triad->range.value[0] = d->largest_current / scale;
}

static void set_default(void *design)
{
    *(design_type *)design = imk_pendulous_servo_default();
}

static void reduce(const void *design, imk_model *model)
{
    imk_pendulous_servo_reduce(design, model);
}

static const imk_signal outputs[] = {
    {"specific_force", "m/s^2", "m/s^2", "reading"},
    {"current", "A", "mA", "mean current of the torquer"},
};
static const imk_signal signals[] = {
    {"angle", "rad", "urad", "deflection of the pendulum"},
    {"torque", "N m", "uN m", "control torque"},
    {"current", "A", "mA", "current of the torquer"},
};
static const imk_view views[] = {
    {.title = "The pendulum is pulled back",
     .caption =
         "Deflection of the pendulum behind the beginning of the input: "
         "the loop answers within a millisecond, and the integral brings the angle back to zero.",
     .x = -1,
     .curve_count = 1,
     .y = {0},
     .duration = 0.02,
     .rate = 50000.0,
     .input = IMK_STANDARD_GRAVITY},
    {.title = "The torquer takes over",
     .caption = "Control torque: it ends where it balances the input.",
     .x = -1,
     .curve_count = 1,
     .y = {1},
     .duration = 0.02,
     .rate = 50000.0,
     .input = IMK_STANDARD_GRAVITY},
};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

const imk_instrument imk_pendulous_servo_instrument = {
    .name = "pendulous_servo",
    .title = "pendulous servo accelerometer",
    .technology = "servo",
    .source = "datasheet Honeywell QA-3000; pendulum and loop chosen",
    .sensor = IMK_ACCEL,
    .design_size = sizeof(design_type),
    .state_size = sizeof(servo),
    .field_count = COUNT(fields),
    .fields = fields,
    .output_count = COUNT(outputs),
    .outputs = outputs,
    .signal_count = COUNT(signals),
    .signals = signals,
    .view_count = COUNT(views),
    .views = views,
    .set_default = set_default,
    .validate = validate,
    .init = init,
    .step = step,
    .observe = observe,
    .reduce = reduce,
    .step_length = step_length,
};
