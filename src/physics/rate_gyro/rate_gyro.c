/* SPDX-License-Identifier: Apache-2.0 */
/* The spring-restrained rate gyro: design, checks and description. Equations:
 * rate_gyro_formulas.c; dynamics: rate_gyro_dynamics.c. */
#include "rate_gyro_internal.h"

#include "physics/design_rows_internal.h"

enum { COOKIE = 0x52415447 };

imk_rate_gyro imk_rate_gyro_default(void)
{
    /* w0 = 2 pi 30 Hz and a ratio of 0.7: I = k/w0^2, c = 1.4 k/w0. The repeatability is 0.02
     * deg/s, the instability 0.002 deg/s, the noise 0.02 deg/sqrt(h), the scale -200 ppm/K. */
    return (imk_rate_gyro){
        .cookie = COOKIE,
        .momentum = 1e-3,
        .output_inertia = 2.25e-6,
        .input_inertia = 2.2e-6,
        .spin_inertia = 2.5e-6,
        .stiffness = 0.08,
        .stiffness_temperature = 2e-4,
        .damping = 5.94e-4,
        .stop = IMKI_PI / 60.0, /* 3 deg */
        .balance = {0.03, 3e-8, 5e-8, 2e-8, 3e-8},
        .torque = {2e-7, 5e-9, 3.5e-7, 3.5e-8, 5.8e-9},
        .pickoff_noise = 1e-8,
    };
}

#define DESIGN imk_rate_gyro
static const imk_design_field fields[] = {
    ABOVE("wheel.momentum", momentum, "kg*m^2/s", 0.0, 1e3, "angular momentum of the wheel"),
    NUMBER("wheel.momentum_error", momentum_error, "ppm", -0.5, 0.5,
           "relative error of the wheel's speed"),
    ABOVE("gimbal.output_inertia", output_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of gimbal and wheel about the output axis"),
    ABOVE("gimbal.input_inertia", input_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of gimbal and wheel about the input axis"),
    ABOVE("gimbal.spin_inertia", spin_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of gimbal and wheel about the spin axis"),
    ABOVE("spring.stiffness", stiffness, "N*m/rad", 0.0, 1e6, "stiffness of the torsion bar"),
    NUMBER("spring.error", stiffness_error, "ppm", -0.5, 0.5, "relative error of the stiffness"),
    NUMBER("spring.temperature", stiffness_temperature, "ppm/K", -2e-3, 2e-3,
           "relative change of the stiffness with temperature"),
    NUMBER("gimbal.damping", damping, "N*m*s/rad", 0.0, 1e4, "viscous damping of the gimbal"),
    NUMBER("gimbal.friction", friction, "N*m", 0.0, 1.0,
           "Coulomb friction of the gimbal's bearings"),
    ABOVE("gimbal.stop", stop, "deg", 0.0, 0.5, "largest angle of the gimbal"),
    IMKI_BALANCE_FIELDS,
    IMKI_TORQUE_FIELDS,
    NUMBER("pickoff.noise", pickoff_noise, "urad/sqrt(Hz)", 0.0, 1.0,
           "white noise of the angle pickoff, two-sided"),
    NUMBER("pickoff.resolution", pickoff_resolution, "urad", 0.0, 0.1,
           "step of the angle pickoff; 0: none"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check(const void *given, imk_error *error)
{
    const imk_rate_gyro *d = given;
    if (!imki_inertias_possible(d->output_inertia, d->input_inertia, d->spin_inertia))
        return imki_conflict(error, "gimbal.output_inertia", d->output_inertia,
                             d->input_inertia + d->spin_inertia,
                             "a moment of inertia of at most the sum of the others, for each axis");
    const double range = d->stop / imk_rate_gyro_sensitivity(d);
    const double softening = (d->spin_inertia - d->input_inertia) * range * range;
    if (!(softening < imki_rate_gyro_stiffness(d)))
        return imki_conflict(error, "spring.stiffness", d->stiffness, softening,
                             "a spring that holds against the anisoinertia");
    const imk_rate_gyro usual = imk_rate_gyro_default();
    const bool narrow = !(usual.torque.fixed < imki_rate_gyro_stiffness(&usual) * d->stop);
    return imki_check_torque(
        d->torque.fixed, usual.torque.fixed, imki_rate_gyro_stiffness(d) * d->stop,
        narrow ? "gimbal.stop" : "spring.stiffness", narrow ? d->stop : d->stiffness,
        "a fixed torque that the spring balances before the stop", error);
}

/* ---- description ----------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"angular_rate", "rad/s", "deg/s", "measured rate about x, the mean over the sample"}};

static const imk_signal signals[IMKI_RATE_GYRO_SIGNALS] = {
    {"gimbal_angle", "rad", "deg", "angle of the gimbal against the case"},
    {"gimbal_rate", "rad/s", "deg/s", "rate of the gimbal against the case"},
    {"error_torque", "N*m", "uNm", "slow error torque on the gimbal"},
    {"spring_torque", "N*m", "uNm", "torque of the torsion bar"}};

static const imk_view views[] = {
    {.title = "Gimbal angle after the rate begins",
     .caption = "The gimbal swings to the angle at which the torsion bar balances the gyroscopic "
                "torque; the "
                "damper decides how often it overshoots.",
     .x = -1,
     .curve_count = 1,
     .y = {0},
     .duration = 0.2,
     .rate = 2000.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "Phase portrait of the gimbal",
     .caption = "Rate against angle: a spiral into the balance, an ellipse without a damper.",
     .x = 0,
     .curve_count = 1,
     .y = {1},
     .duration = 0.2,
     .rate = 4000.0,
     .input = 10.0 * IMKI_DEGREE},
};

IMKI_DESIGN_FUNCTIONS(rate_gyro);

const imk_instrument imk_rate_gyro_instrument = {
    IMKI_DESCRIBED(rate_gyro),
    .title = "spring-restrained rate gyro",
    .technology = "wheel",
    .source = "figures chosen, of the size of miniature torsion-bar rate gyros; see rate_gyro.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_rate_gyro_state),
    .init = imki_rate_gyro_init,
    .step = imki_rate_gyro_step,
    .observe = imki_rate_gyro_observe,
    .step_length = imki_rate_gyro_step_length};
