/* SPDX-License-Identifier: Apache-2.0 */
/* Pendulous servo accelerometer: the design, its checks and its description. */
#include "pendulous_servo_internal.h"

#include "imukit/units.h"
#include "physics/design_rows_internal.h"

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

#define DESIGN imk_pendulous_servo
static const imk_design_field fields[] = {
    NUMBER("pendulum.pendulosity", pendulosity, "kg m", 1e-12, 1.0,
           "mass times its distance from the hinge"),
    ABOVE("pendulum.inertia", inertia, "kg m^2", 0.0, 1.0, "moment of inertia about the hinge"),
    NUMBER("pendulum.damping", damping, "N m s", 0.0, 1.0, "torque per angular rate"),
    ABOVE("pendulum.stop", stop, "rad", 0.0, 0.5, "largest angle"),
    NUMBER("pendulum.misalignment_y", misalignment_y, "mrad", -0.1, 0.1,
           "input axis towards the output axis y"),
    NUMBER("pendulum.misalignment_z", misalignment_z, "mrad", -0.1, 0.1,
           "input axis towards the pendulous axis z"),
    NUMBER("hinge.stiffness", hinge_stiffness, "N m/rad", 0.0, 1e3, "torque per angle"),
    NUMBER("hinge.torque", hinge_torque, "N m", -1.0, 1.0, "constant error torque"),
    NUMBER("hinge.torque_temperature", hinge_torque_temperature, "N m/K", -1.0, 1.0,
           "its change with temperature"),
    NUMBER("hinge.torque_repeatability", hinge_torque_repeatability, "N m", 0.0, 1.0,
           "1 sigma from run to run"),
    NUMBER("hinge.torque_instability", hinge_torque_instability, "N m", 0.0, 1.0,
           "flicker B within a run"),
    ABOVE("controller.proportional", proportional, "N m/rad", 0.0, 1e6,
          "torque per angle of the pickoff"),
    NUMBER("controller.integral", integral, "N m/(rad s)", 0.0, 1e12,
           "torque per integral of that angle"),
    NUMBER("controller.pickoff_noise", pickoff_noise, "rad/sqrt(Hz)", 0.0, 1.0,
           "two-sided density of the pickoff's noise"),
    ABOVE("torquer.constant", torquer_constant, "N m/A", 0.0, 1e3, "nominal torque per current"),
    NUMBER("torquer.error", torquer_error, "ppm", -0.5, 0.5, "relative error of the constant"),
    NUMBER("torquer.temperature", torquer_temperature, "ppm/K", -0.01, 0.01,
           "relative change with temperature"),
    NUMBER("torquer.repeatability", torquer_repeatability, "ppm", 0.0, 0.5,
           "1 sigma from run to run, relative"),
    NUMBER("torquer.quadratic", torquer_quadratic, "1/A", -10.0, 10.0,
           "relative change with current"),
    ABOVE("torquer.largest_current", largest_current, "mA", 0.0, 1e3, "limit of the driver"),
    NUMBER("readout.noise", readout_noise, "A/sqrt(Hz)", 0.0, 1.0,
           "two-sided density of the current's noise"),
    NUMBER("readout.step", readout_step, "A", 0.0, 1.0, "resolution of the sampled current"),
    NUMBER("temperature", temperature, "degC", 1.0, 1000.0,
           "temperature of the gas, and where errors are stated"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check(const void *design, imk_error *error)
{
    const design_type *d = design;
    const double weakest = 1.0 + d->torquer_error - 6.0 * d->torquer_repeatability;
    if (!(weakest > 0.0))
        return imki_conflict(error, "torquer.repeatability", d->torquer_repeatability,
                             (1.0 + d->torquer_error) / 6.0,
                             "a value below a sixth of the torquer's constant, so that the torquer "
                             "pulls in every run");
    const double bend = fabs(d->torquer_quadratic) * d->largest_current;
    if (!(bend < 0.25))
        return imki_conflict(error, "torquer.quadratic", bend, 0.25,
                             "a value below a quarter over the largest current, so that the torque "
                             "grows with the current");
    const double largest = d->torquer_constant * (1.0 + d->torquer_error) * d->largest_current;
    const double error_torque = fabs(d->hinge_torque) + 6.0 * d->hinge_torque_repeatability;
    if (!(error_torque < largest))
        return imki_conflict(error, "hinge.torque", error_torque, largest,
                             "a hinge torque (and six times its repeatability) below the "
                             "largest torque of the torquer");
    /* Routh: J s^3 + b s^2 + K s + K_i has its roots on the left when b K > J K_i. */
    const double limit = d->damping * imki_servo_stiffness(d) / d->inertia;
    if (d->integral > 0.0 && !(d->integral < limit))
        return imki_conflict(
            error, "controller.integral", d->integral, limit,
            "a value below damping x stiffness / inertia, so that the loop is stable");
    return IMK_OK;
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
     .caption = "Deflection of the pendulum after the input begins: the loop answers within a "
                "millisecond, and the integral brings the angle back to zero.",
     .x = -1,
     .curve_count = 1,
     .y = {0},
     .duration = 0.02,
     .rate = 50000.0,
     .input = IMK_STANDARD_GRAVITY},
    {.title = "The torquer takes over",
     .caption = "Control torque: it settles where it balances the input.",
     .x = -1,
     .curve_count = 1,
     .y = {1},
     .duration = 0.02,
     .rate = 50000.0,
     .input = IMK_STANDARD_GRAVITY},
};

IMKI_DESIGN_FUNCTIONS(pendulous_servo);

const imk_instrument imk_pendulous_servo_instrument = {
    IMKI_DESCRIBED(pendulous_servo),
    .title = "pendulous servo accelerometer",
    .technology = "servo",
    .source = "datasheet Honeywell QA-3000; pendulum and loop chosen",
    .sensor = IMK_ACCEL,
    .cookie = COOKIE,
    .state_size = sizeof(imki_servo),
    .init = imki_servo_init,
    .step = imki_servo_step,
    .observe = imki_servo_observe,
    .step_length = imki_servo_step_length,
};
