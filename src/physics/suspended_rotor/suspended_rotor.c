/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro as an instrument. Closed forms: suspended_rotor_reduce.c; of
 * the ball at its stops: suspended_rotor_cavity.c. */
#include "suspended_rotor_internal.h"

#include "imukit/units.h"
#include "physics/design_rows_internal.h"

#include <math.h>

enum { COOKIE = 0x53524F54 };

#define ARCSECOND (IMKI_DEGREE / 3600.0)

imk_suspended_rotor imk_suspended_rotor_default(void)
{
    return (imk_suspended_rotor){
        .cookie = COOKIE,
        .spin_rate = 150000.0 * (IMKI_PI / 30.0),
        .diameter = 0.01,
        .density = 1848.0,
        .inertia_difference = 0.02,
        .unbalance = 1e-9,
        .oblateness = -20e-9,
        .pear = 0.3e-9,
        .limit = 25.0 * IMK_STANDARD_GRAVITY,
        .gap = 10e-6,
        .clearance = 5e-6,
        .bandwidth = 2000.0,
        .restitution = 0.5,
        .friction = 0.2,
        .preload_error = {1e-3, -1e-3, 0.0},
        .torque_temperature = 2e-14,
        .torque_repeatability = 1.5e-12,
        .torque_instability = 3.7e-13,
        .torque_noise = 1.3e-11,
        .readout_resolution = ARCSECOND,
        .readout_noise = 2.0 * ARCSECOND,
        .wobble_time = 600.0,
    };
}

#define DESIGN imk_suspended_rotor
static const imk_design_field fields[] = {
    ABOVE("spin.rate", spin_rate, "rpm", 0.0, 1e6, "speed of the ball"),
    ABOVE("ball.diameter", diameter, "mm", 0.0, 1.0, "diameter of the ball"),
    NUMBER("ball.hollow", hollow, "mm", 0.0, 1.0, "diameter of its hollow, 0 for solid"),
    ABOVE("ball.density", density, "kg/m^3", 0.0, 1e5, "density of its metal"),
    ABOVE("ball.inertia_difference", inertia_difference, "1", 0.0, 1.0,
          "polar less transverse inertia over transverse, above 0"),
    NUMBER("ball.unbalance", unbalance, "nm", -1e-3, 1e-3,
           "centre of mass from the centre, along the spin"),
    NUMBER("ball.oblateness", oblateness, "nm", -1e-3, 1e-3,
           "height of the second harmonic of the spinning shape"),
    NUMBER("ball.pear", pear, "nm", -1e-3, 1e-3, "height of the third harmonic"),
    ABOVE("suspension.limit", limit, "g", 0.0, 1e6,
          "specific force the suspension carries along each axis"),
    NUMBER("suspension.gap", gap, "um", 1e-7, 0.01, "distance of the ball from the electrodes"),
    NUMBER("suspension.clearance", clearance, "um", 1e-7, 0.01,
           "distance of the ball from its stops, smaller than the gap"),
    NUMBER("suspension.bandwidth", bandwidth, "Hz", 1.0, 1e5,
           "natural frequency of the ball in the control"),
    NUMBER("suspension.restitution", restitution, "1", 0.0, 0.95,
           "speed after an impact on a stop over speed before it"),
    NUMBER("suspension.friction", friction, "1", 0.0, 2.0, "friction of the ball on a stop"),
    NUMBER("suspension.preload_error_x", preload_error[0], "1", -0.9, 9.0,
           "relative error of the preload of the electrodes along x"),
    NUMBER("suspension.preload_error_y", preload_error[1], "1", -0.9, 9.0, "the same along y"),
    NUMBER("suspension.preload_error_z", preload_error[2], "1", -0.9, 9.0, "the same along z"),
    NUMBER("torque.x", torque[0], "N*m", -1.0, 1.0, "constant error torque about case x"),
    NUMBER("torque.y", torque[1], "N*m", -1.0, 1.0, "the same about y"),
    NUMBER("torque.z", torque[2], "N*m", -1.0, 1.0, "the same about z"),
    NUMBER("torque.temperature", torque_temperature, "N*m/K", -1.0, 1.0,
           "change of each component with temperature, from 20 degC"),
    NUMBER("torque.repeatability", torque_repeatability, "N*m", 0.0, 1.0,
           "1 sigma per run of each component of the error torque"),
    NUMBER("torque.instability", torque_instability, "N*m", 0.0, 1.0,
           "flicker (bias instability B) of each component"),
    NUMBER("torque.noise", torque_noise, "N*m/sqrt(Hz)", 0.0, 1.0,
           "white part of each component, two-sided density"),
    NUMBER("readout.resolution", readout_resolution, "arcsec", 0.0, 0.1,
           "step of the direction cosines, 0 for none"),
    NUMBER("readout.noise", readout_noise, "arcsec", 0.0, 0.1, "1 sigma of each direction cosine"),
    NUMBER("start.tilt", start_tilt, "deg", 0.0, IMKI_PI,
           "angle of the spin axis from case z at the start"),
    NUMBER("start.azimuth", start_azimuth, "deg", -2.0 * IMKI_PI, 2.0 * IMKI_PI,
           "direction of that tilt, from x towards y"),
    NUMBER("wobble.start", start_wobble, "arcsec", 0.0, 0.5,
           "angle of the axis of figure from the angular momentum at the start"),
    ABOVE("wobble.time", wobble_time, "s", 0.0, 1e9, "time in which it falls by e"),
};

static const imk_signal outputs[] = {
    {"rate", "rad/s", "deg/s", "rate about case x, less the part along the spin axis"},
    {"rate_y", "rad/s", "deg/s", "rate about case y, less the part along the spin axis"},
    {"cosine_x", "1", "1", "reading: direction cosine of the spin axis along x"},
    {"cosine_y", "1", "1", "reading: direction cosine of the spin axis along y"},
    {"cosine_z", "1", "1", "reading: direction cosine of the spin axis along z"},
};

static const imk_signal signals[] = {
    [IMKI_SUSPENDED_AXIS_X] = {"axis_x", "1", "1",
                               "direction cosine of the angular momentum along x"},
    [IMKI_SUSPENDED_AXIS_Y] = {"axis_y", "1", "1", "the same along y"},
    [IMKI_SUSPENDED_AXIS_Z] = {"axis_z", "1", "1", "the same along z"},
    [IMKI_SUSPENDED_DRIFT] = {"drift", "rad/s", "deg/h",
                              "rate at which the axis drifts by unbalance and shape"},
    [IMKI_SUSPENDED_WOBBLE] = {"wobble", "rad", "arcsec", "angle of the axis of figure from it"},
    [IMKI_SUSPENDED_FALLEN] = {"fallen", "1", "1",
                               "1 since the force was too much and the ball touched a stop"},
    [IMKI_SUSPENDED_DISPLACEMENT_X] = {"displacement_x", "m", "um",
                                       "centre of the ball from the middle, along x"},
    [IMKI_SUSPENDED_DISPLACEMENT_Y] = {"displacement_y", "m", "um", "the same along y"},
    [IMKI_SUSPENDED_DISPLACEMENT_Z] = {"displacement_z", "m", "um", "the same along z"},
    [IMKI_SUSPENDED_CONTACT] = {"contact", "N", "mN",
                                "force of the stops on the ball, mean over the sample"},
    [IMKI_SUSPENDED_SPIN] = {"spin", "rad/s", "rpm", "speed of the ball about its spin axis"},
};

static const imk_view views[] = {
    {.title = "The axis stays, the case turns",
     .caption = "Direction cosines of the spin axis in the case, which turns once",
     .x = -1,
     .curve_count = 3,
     .y = {IMKI_SUSPENDED_AXIS_Y, IMKI_SUSPENDED_AXIS_Z, IMKI_SUSPENDED_AXIS_X},
     .duration = 36.0,
     .rate = 20.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "Drift by the shape of the ball",
     .caption = "Unequal preloads turn an oblate ball: not at all where its axis is along or "
                "across their field, most in between",
     .x = IMKI_SUSPENDED_AXIS_Y,
     .curve_count = 1,
     .y = {IMKI_SUSPENDED_DRIFT},
     .duration = 36.0,
     .rate = 20.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "The ball falls on its stop",
     .caption = "A force above the suspension's limit begins: the ball falls away from the "
                "electrode that pulls with all it has, meets the stop and bounces",
     .x = -1,
     .curve_count = 3,
     .y = {IMKI_SUSPENDED_DISPLACEMENT_X, IMKI_SUSPENDED_DISPLACEMENT_Y,
           IMKI_SUSPENDED_DISPLACEMENT_Z},
     .duration = 0.002,
     .rate = 200000.0,
     .force = 26.0 * IMK_STANDARD_GRAVITY},
    {.title = "The fallen ball runs down",
     .caption = "Friction on the stop takes the spin across the force",
     .x = -1,
     .curve_count = 1,
     .y = {IMKI_SUSPENDED_SPIN},
     .duration = 1.5,
     .rate = 1000.0,
     .force = 26.0 * IMK_STANDARD_GRAVITY},
};

/* ---- validation and start -------------------------------------------------------------------- */

/* Heights of the shape's harmonics beyond this part of the radius are not first-order any more. */
#define LARGEST_HEIGHT 1e-3
/* The pull of an electrode grows e-fold towards it in more than a microsecond [1/s]. */
#define FASTEST_FALL 1e6

static imk_status check_cavity(const imk_suspended_rotor *design, imk_error *error)
{
    const double nearest = 2.0 * design->limit / (FASTEST_FALL * FASTEST_FALL);
    if (!(design->clearance < design->gap))
        return imki_conflict(error, "suspension.clearance", design->clearance, design->gap,
                             "a clearance smaller than suspension.gap");
    if (!(design->gap >= nearest))
        return imki_conflict(error, "suspension.gap", design->gap, nearest,
                             "a gap across which a ball under suspension.limit takes more than a "
                             "microsecond");
    return IMK_OK;
}

/* Torques turn the axis slowly against the ball's spin: at most by this part of a radian in the
 * time of a radian of the spin. */
#define LARGEST_PART 1e-3
/* As much white noise as a step of a microsecond has, and flicker and constants of a run at the
 * ends of what is drawn. */
#define NOISE_STEP 1e-6
#define DRAWN 6.0
/* A gyro's axis stays: faster than this bias and scale factor hold for a moment only [rad/s]. */
#define FASTEST_DRIFT 0.01

static imk_status check_torques(const imk_suspended_rotor *design, imk_error *error)
{
    const imki_suspended_ball ball = imki_suspended_ball_of(design);
    const double weight = ball.mass * design->limit;
    double largest = 0.0;
    for (int k = 0; k < 3; k++) /* gradient of G at the limit, and what else acts */
        largest += fabs(ball.moment) * design->limit +
                   3.0 * fabs(ball.second) * (ball.pull[k] + weight * weight * ball.per_pull) +
                   6.0 * fabs(ball.third) * weight + fabs(design->torque[k]) +
                   DRAWN * (design->torque_repeatability + design->torque_instability +
                            design->torque_noise / sqrt(NOISE_STEP));
    largest += 3.0 * fabs(design->torque_temperature) * IMKI_DESIGN_TEMPERATURE;
    const double most = LARGEST_PART * imk_suspended_rotor_momentum(design) * design->spin_rate;
    static const char *const names[3] = {"torque.x", "torque.y", "torque.z"};
    const double drift = FASTEST_DRIFT * imk_suspended_rotor_momentum(design);
    for (int k = 0; k < 3; k++)
        if (fabs(design->torque[k]) > drift)
            return imki_conflict(error, names[k], design->torque[k], drift,
                                 "a torque that turns the axis by at most 0.01 rad/s (2060 deg/h)");
    if (largest <= most)
        return IMK_OK;
    return imki_conflict(error, "spin.rate", design->spin_rate,
                         design->spin_rate * sqrt(largest / most),
                         "a faster or heavier ball, or smaller torques of shape, unbalance and "
                         "errors: they must turn the axis slowly against the spin");
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_suspended_rotor *design = given;
    const double most = LARGEST_HEIGHT * 0.5 * design->diameter;
    const struct {
        const char *field;
        double value;
    } heights[] = {{"ball.unbalance", design->unbalance},
                   {"ball.oblateness", design->oblateness},
                   {"ball.pear", design->pear}};
    if (!(design->hollow < design->diameter))
        return imki_conflict(error, "ball.hollow", design->hollow, design->diameter,
                             "a hollow smaller than ball.diameter");
    for (int i = 0; i < 3; i++)
        if (!(fabs(heights[i].value) <= most))
            return imki_conflict(error, heights[i].field, heights[i].value, most,
                                 "at most a thousandth of the ball's radius");
    const imk_status status = check_cavity(design, error);
    return status == IMK_OK ? check_torques(design, error) : status;
}

IMKI_DESIGN_FUNCTIONS(suspended_rotor);

const imk_instrument imk_suspended_rotor_instrument = {
    IMKI_DESCRIBED(suspended_rotor),
    .title = "electrostatically suspended gyro",
    .technology = "ESG",
    .source = "Autonetics MICRON (N57A): solid beryllium ball of 10 mm at 2500 rev/s [Lawrence "
              "1998]; shape, torques and readout chosen: suspended_rotor.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_suspended_state),
    .init = imki_suspended_init,
    .step = imki_suspended_step,
    .observe = imki_suspended_observe,
    .happened = imki_suspended_happened,
    .step_length = imki_suspended_step_length,
};
