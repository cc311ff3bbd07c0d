/* SPDX-License-Identifier: Apache-2.0 */
/* Pendulous servo accelerometer: the design, its closed forms, and what they reduce to. */
#include "pendulous_servo_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/units.h"

#include <math.h>

enum { COOKIE = 0x494D4B3B };

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

double imk_pendulous_servo_scale(const imk_pendulous_servo *d)
{
    return d->pendulosity / d->torquer_constant;
}

double imk_pendulous_servo_frequency(const imk_pendulous_servo *d)
{
    return sqrt(imki_servo_stiffness(d) / d->inertia) / (2.0 * IMKI_PI);
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
                            (imki_servo_stiffness(d) - d->inertia * w * w) * w};
}

double imk_pendulous_servo_gain(const imk_pendulous_servo *d, double frequency)
{
    const double w = 2.0 * IMKI_PI * frequency;
    if (w <= 0.0)
        return d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d);
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
        return d->integral > 0.0 ? 0.0 : 0.5 * d->pendulosity / imki_servo_stiffness(d);
    /* 1/K_c = jw/(K_c jw); its real part is w Im(K_c jw)/|K_c jw|^2 */
    const complex_number k = captured_stiffness(d, w);
    return 0.5 * d->pendulosity * w * k.im / (k.re * k.re + k.im * k.im);
}

double imk_pendulous_servo_noise(const imk_pendulous_servo *d)
{
    const double held = d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d);
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
    const double j = d->inertia, k = imki_servo_stiffness(d), b = d->damping;
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
    w[IMKI_SERVO_RATE * n + IMKI_SERVO_RATE] += 2.0 * IMKI_BOLTZMANN * d->temperature * b / (j * j);
    const double slowest = 2.0 * j / b + b / k + (d->integral > 0.0 ? k / d->integral : 0.0);
    imki_step_covariance(n, system, w, 40.0 * slowest, covariance);
    const double variance = j * j * covariance[IMKI_SERVO_RATE * n + IMKI_SERVO_RATE] +
                            2.0 * j * b * covariance[IMKI_SERVO_ANGLE * n + IMKI_SERVO_RATE] +
                            b * b * covariance[IMKI_SERVO_ANGLE * n + IMKI_SERVO_ANGLE];
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
    const double limit = d->damping * imki_servo_stiffness(d) / d->inertia;
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

/* ---- reduction ------------------------------------------------------------------------------- */

/* Without integral action the pendulum stays deflected by (P f + M)/K, M the hinge's torque, and
 * the torque of the angle is P f_z (P f_x + M)/K - P f_x (P f_x)^2/(2 K^2). `seen`: reading per
 * specific force. */
static void deflected(const design_type *d, double seen, imk_triad *triad)
{
    const double k = imki_servo_stiffness(d), angle = d->pendulosity / k;
    triad->nonlinearity.cross_products.value[0][0] = seen * angle;
    triad->cross_axis.value[0][2] = seen * d->hinge_torque / k;
    triad->nonlinearity.k3.value[0] -= 0.5 * seen * angle * angle;
}

void imk_pendulous_servo_reduce(const imk_pendulous_servo *d, imk_model *model)
{
    imk_triad *triad = imki_reduction_begin(model, &imk_pendulous_servo_instrument);
    const double p = d->pendulosity, scale = imk_pendulous_servo_scale(d);
    const double gain = 1.0 / (1.0 + d->torquer_error);
    const double seen =
        gain * (d->integral > 0.0 ? 1.0 : d->proportional / imki_servo_stiffness(d));
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
        imki_model_damping(d->damping / (2.0 * sqrt(d->inertia * imki_servo_stiffness(d))));
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

const imk_instrument imk_pendulous_servo_instrument = {
    .name = "pendulous_servo",
    .title = "pendulous servo accelerometer",
    .technology = "servo",
    .source = "datasheet Honeywell QA-3000; pendulum and loop chosen",
    .sensor = IMK_ACCEL,
    .design_size = sizeof(design_type),
    .state_size = sizeof(imki_servo),
    IMKI_TABLES,
    .set_default = set_default,
    .validate = validate,
    .init = imki_servo_init,
    .step = imki_servo_step,
    .observe = imki_servo_observe,
    .reduce = reduce,
    .step_length = imki_servo_step_length,
};
