/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro: design, checks and description. Equations:
 * rate_integrating_gyro_formulas.c; dynamics: rate_integrating_gyro_dynamics.c. */
#include "rate_integrating_gyro_internal.h"

#include "physics/design_rows_internal.h"

enum { COOKIE = 0x52494721 };

imk_rate_integrating_gyro imk_rate_integrating_gyro_default(void)
{
    /* Gain H/C of 1, time constant 1.6 ms. 1 arcsec/h is 1.3467e-9 rad/s: the repeatability is 4,
     * the instability 1 of them times H. Noise 1e-4 deg/sqrt(h). */
    return (imk_rate_integrating_gyro){
        .cookie = COOKIE,
        .momentum = 0.04,
        .output_inertia = 6.4e-5,
        .input_inertia = 6.2e-5,
        .spin_inertia = 7e-5,
        .damping = 0.04,
        .stop = IMKI_PI / 180.0, /* 1 deg */
        .balance = {0.3, 2e-9, 3e-9, 2e-9, 2.5e-9},
        .torque = {1e-9, 2e-12, 2.1547e-10, 5.3867e-11, 1.1636e-9},
        .pickoff_noise = 1e-10,
        .rebalance = IMK_REBALANCE_ANALOG,
        .torquer_limit = 0.0215,
        .torquer_temperature = 1e-5,
        .pulse_frequency = 6400.0,
        .pulse_lead = 1.6e-3,
        .loop_frequency = 4.0,
        .loop_damping = 2.5, /* a peak of 4 % */
    };
}

#define DESIGN imk_rate_integrating_gyro
static const imk_design_field fields[] = {
    NUMBER("wheel.momentum", momentum, "kg*m^2/s", 1e-8, 1e3, "angular momentum of the wheel"),
    NUMBER("wheel.momentum_error", momentum_error, "ppm", -0.5, 0.5,
           "relative error of the wheel's speed"),
    ABOVE("float.output_inertia", output_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of the float about the output axis"),
    ABOVE("float.input_inertia", input_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of the float about the input axis"),
    ABOVE("float.spin_inertia", spin_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of the float about the spin axis"),
    ABOVE("float.damping", damping, "N*m*s/rad", 0.0, 1e4, "viscous damping by the liquid"),
    NUMBER("float.stiffness", stiffness, "N*m/rad", 0.0, 1e3, "spring of the flex leads"),
    ABOVE("float.stop", stop, "deg", 0.0, 0.5, "largest angle of the float"),
    IMKI_BALANCE_FIELDS,
    IMKI_TORQUE_FIELDS,
    NUMBER("pickoff.noise", pickoff_noise, "nrad/sqrt(Hz)", 0.0, 1.0,
           "white noise of the angle pickoff, two-sided"),
    NUMBER("pickoff.resolution", pickoff_resolution, "urad", 0.0, 0.1,
           "step of the angle pickoff, read in the open loop; 0: none"),
    CHOICE("rebalance", rebalance, "open|analog|ternary|binary",
           "how the torquer brings the float back"),
    ABOVE("torquer.limit", torquer_limit, "N*m", 0.0, 100.0,
          "largest torque, and that of the pulses"),
    NUMBER("torquer.error", torquer_error, "ppm", -0.5, 0.5,
           "relative error of the torque per current"),
    NUMBER("torquer.temperature", torquer_temperature, "ppm/K", -2e-3, 2e-3,
           "relative change of the torque per current with temperature"),
    ABOVE("pulse.frequency", pulse_frequency, "Hz", 0.0, 1e7, "torque pulses per second"),
    NUMBER("pulse.lead", pulse_lead, "ms", 0.0, 10.0,
           "lead of the pulse logic against the lag of the float"),
    ABOVE("loop.frequency", loop_frequency, "Hz", 0.0, 1e5, "natural frequency of the analog loop"),
    ABOVE("loop.damping", loop_damping, "1", 0.0, 50.0, "damping ratio of the analog loop"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check(const void *given, imk_error *error)
{
    const imk_rate_integrating_gyro *d = given;
    double k1, k2;
    if (!imki_inertias_possible(d->output_inertia, d->input_inertia, d->spin_inertia))
        return imki_conflict(error, "float.output_inertia", d->output_inertia,
                             d->input_inertia + d->spin_inertia,
                             "a moment of inertia of at most the sum of the others, for each axis");
    imk_rate_integrating_gyro_loop(d, &k1, &k2);
    /* Routh: C (K1 + k) > I K2, with the gain of the torquer in both */
    if (d->rebalance == IMK_REBALANCE_ANALOG &&
        !(d->damping * (k1 + d->stiffness / (1.0 + d->torquer_error)) > d->output_inertia * k2)) {
        const double highest = d->loop_frequency * d->damping * k1 / (d->output_inertia * k2);
        return imki_conflict(error, "loop.frequency", d->loop_frequency, highest,
                             "a loop slow enough for the lag I/C of the float");
    }
    if (d->rebalance == IMK_REBALANCE_OPEN)
        return IMK_OK;
    return imki_check_torque(d->torque.fixed, imk_rate_integrating_gyro_default().torque.fixed,
                             d->torquer_limit, "torquer.limit", d->torquer_limit,
                             "a fixed torque below the largest of the torquer, which balances it",
                             error);
}

/* ---- description ----------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"angular_rate", "rad/s", "deg/s", "measured rate about x, the mean over the sample"}};

static const imk_signal signals[IMKI_RATE_INTEGRATING_GYRO_SIGNALS] = {
    {"float_angle", "rad", "arcsec", "angle of the float against the case"},
    {"float_rate", "rad/s", "deg/s", "rate of the float against the case"},
    {"error_torque", "N*m", "uNm", "slow error torque on the float"},
    {"torquer_torque", "N*m", "mNm", "torque that the torquer is told to give"},
    {"stored_angle", "rad", "arcsec", "case angle that the float holds, (C th + I th')/H"}};

static const imk_view views[] = {
    {.title = "Float angle after the rate begins",
     .caption = "The float starts to turn with the rate of the case, and the loop brings it back "
                "while its "
                "integral takes over the torque.",
     .x = -1,
     .curve_count = 1,
     .y = {0},
     .duration = 0.2,
     .rate = 3200.0,
     .input = 10.0 * IMKI_PI / 180.0},
    {.title = "Torquer and float",
     .caption =
         "The torque that the loop asks for: smooth in the analog loop, pulses in the others.",
     .x = -1,
     .curve_count = 1,
     .y = {3},
     .duration = 0.1,
     .rate = 6400.0,
     .input = 10.0 * IMKI_PI / 180.0},
};

IMKI_DESIGN_FUNCTIONS(rate_integrating_gyro);

const imk_instrument imk_rate_integrating_gyro_instrument = {
    IMKI_DESCRIBED(rate_integrating_gyro),
    .title = "floated rate-integrating gyro",
    .technology = "floated",
    .source =
        "drift of the floated gyros in R. A. Harris, Navigation 21 (1974); dimensions chosen, see "
        "rate_integrating_gyro.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_rate_integrating_gyro_state),
    .init = imki_rate_integrating_gyro_init,
    .step = imki_rate_integrating_gyro_step,
    .observe = imki_rate_integrating_gyro_observe,
    .step_length = imki_rate_integrating_gyro_step_length};
