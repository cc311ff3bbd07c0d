/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro: design, checks and description. Equations: tuned_gyro_formulas.c; the
 * rotor and its loop: tuned_gyro_rotor.c; the instrument's steps: tuned_gyro_dynamics.c. */
#include "tuned_gyro_internal.h"

#include "physics/design_rows_internal.h"

#include <math.h>

enum { COOKIE = 0x44544721 };

imk_tuned_gyro imk_tuned_gyro_default(void)
{
    /* Damping: H/(N d) of 100 s. Torques: 0.05 deg/h fixed, 0.001
     * deg/h/K, 0.03 deg/h repeatability, 0.005 deg/h instability, 0.002 deg/sqrt(h), times H. */
    imk_tuned_gyro d = {
        .cookie = COOKIE,
        .spin_frequency = 200.0,
        .axial_inertia = 8e-6,
        .transverse_inertia = 4.6e-6,
        .gimbal_inertia_x = 1e-7,
        .gimbal_inertia_y = 1e-7,
        .gimbal_inertia_z = 1.6e-7,
        .hinge_damping = 8e-8,
        .mass = 0.04,
        .axial_offset = 1e-7,
        .quadrature_offset = 2e-8,
        .axial_compliance = 3e-8,
        .radial_compliance = 2.5e-8,
        .torque = {2.46e-9, 4.9e-11, 1.48e-9, 2.46e-10, 5.9e-9},
        .pickoff_noise = 1e-9,
        .pickoff_offset_x = 1e-5,
        .pickoff_offset_y = 1e-5,
        .pickoff_range = 0.01,
        .torquer_limit = 0.0177,
        .torquer_temperature = 2e-5,
        .captured = true,
        .loop_frequency = 4.0,
        .loop_damping = 2.5, /* a peak of 4 % */
        .loop_filter = 120.0,
    };
    /* Equal flexures with P D = Q^2 (see ellipse_at() below): P (P + b) = (J N^2)^2. */
    const double speed = 2.0 * IMKI_PI * d.spin_frequency, dynamic = 4e-8 * speed * speed;
    const double b = 4.0 * (d.axial_inertia - 2.0 * d.transverse_inertia) * speed * speed;
    const double p = -2.0 * dynamic * dynamic / (sqrt(b * b + 4.0 * dynamic * dynamic) - b);
    d.stiffness_x = d.stiffness_y = 0.5 * (dynamic + p);
    return d;
}

#define DESIGN imk_tuned_gyro
static const imk_design_field fields[] = {
    NUMBER("wheel.spin_frequency", spin_frequency, "Hz", 0.1, 1e4, "turns of the shaft per second"),
    NUMBER("wheel.speed_error", speed_error, "ppm", -0.5, 0.5, "relative error of the speed"),
    NUMBER("rotor.axial_inertia", axial_inertia, "kg*m^2", 1e-12, 10.0,
           "inertia of the rotor about its axis"),
    ABOVE("rotor.transverse_inertia", transverse_inertia, "kg*m^2", 0.0, 10.0,
          "inertia of the rotor across its axis"),
    ABOVE("gimbal.inertia_x", gimbal_inertia_x, "kg*m^2", 0.0, 10.0,
          "inertia of the gimbal about the flexures of the shaft"),
    ABOVE("gimbal.inertia_y", gimbal_inertia_y, "kg*m^2", 0.0, 10.0,
          "inertia of the gimbal about the flexures of the rotor"),
    ABOVE("gimbal.inertia_z", gimbal_inertia_z, "kg*m^2", 0.0, 10.0,
          "inertia of the gimbal about the shaft"),
    ABOVE("hinge.stiffness_x", stiffness_x, "N*m/rad", 0.0, 1e4,
          "stiffness between shaft and gimbal"),
    ABOVE("hinge.stiffness_y", stiffness_y, "N*m/rad", 0.0, 1e4,
          "stiffness between gimbal and rotor"),
    NUMBER("hinge.damping", hinge_damping, "N*m*s/rad", 0.0, 1.0,
           "damping of either pair of flexures"),
    ABOVE("rotor.mass", mass, "kg", 0.0, 100.0, "mass of the rotor"),
    NUMBER("rotor.axial_offset", axial_offset, "nm", -1e-3, 1e-3,
           "centre of mass from the joint, along the shaft"),
    NUMBER("rotor.quadrature_offset", quadrature_offset, "nm", -1e-3, 1e-3,
           "effective offset of the torque that is along the force"),
    NUMBER("rotor.axial_compliance", axial_compliance, "nm/N", 0.0, 1e-3,
           "shift of the rotor per force along the shaft"),
    NUMBER("rotor.radial_compliance", radial_compliance, "nm/N", 0.0, 1e-3,
           "shift of the rotor per force across the shaft"),
    IMKI_TORQUE_FIELDS,
    NUMBER("pickoff.noise", pickoff_noise, "nrad/sqrt(Hz)", 0.0, 1.0,
           "white noise of the tilt pickoffs, two-sided"),
    NUMBER("pickoff.offset_x", pickoff_offset_x, "urad", -0.1, 0.1, "reading without tilt about x"),
    NUMBER("pickoff.offset_y", pickoff_offset_y, "urad", -0.1, 0.1, "reading without tilt about y"),
    ABOVE("pickoff.range", pickoff_range, "mrad", 0.0, 0.5, "largest tilt that is read"),
    ABOVE("torquer.limit", torquer_limit, "N*m", 0.0, 100.0, "largest torque of the torquers"),
    NUMBER("torquer.error", torquer_error, "ppm", -0.5, 0.5,
           "relative error of the torque per current"),
    NUMBER("torquer.temperature", torquer_temperature, "ppm/K", -2e-3, 2e-3,
           "relative change of the torque per current with temperature"),
    SWITCH("loop.captured", captured, "the loop keeps the rotor in line with the shaft"),
    ABOVE("loop.frequency", loop_frequency, "Hz", 0.0, 1e4, "natural frequency of the loop"),
    ABOVE("loop.damping", loop_damping, "1", 0.0, 50.0, "damping ratio of the loop"),
    ABOVE("loop.filter", loop_filter, "Hz", 0.0, 1e5, "corner of the filter of the pickoffs"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check(const void *given, imk_error *error)
{
    const imk_tuned_gyro *d = given;
    if (!(d->axial_inertia <= 2.0 * d->transverse_inertia))
        return imki_conflict(error, "rotor.axial_inertia", d->axial_inertia,
                             2.0 * d->transverse_inertia,
                             "at most twice the transverse inertia, as of every body");
    if (!(d->axial_inertia > d->transverse_inertia))
        return imki_conflict(error, "rotor.axial_inertia", d->axial_inertia, d->transverse_inertia,
                             "a flat rotor: a long one does not turn steadily about its axis");
    if (!imki_inertias_possible(d->gimbal_inertia_x, d->gimbal_inertia_y, d->gimbal_inertia_z))
        return imki_conflict(error, "gimbal.inertia_z", d->gimbal_inertia_z,
                             d->gimbal_inertia_x + d->gimbal_inertia_y,
                             "a moment of inertia of at most the sum of the others, for each axis");
    if (!(imki_tuned_gyro_gimbal_sum(d) > 0.0))
        return imki_conflict(
            error, "gimbal.inertia_z", d->gimbal_inertia_z,
            d->gimbal_inertia_x + d->gimbal_inertia_y,
            "a value below the sum of the other two inertias: otherwise no speed tunes the gyro");
    if (!(2.0 * (2.0 * d->transverse_inertia - d->axial_inertia) > imki_tuned_gyro_gimbal_sum(d)))
        return imki_conflict(
            error, "rotor.transverse_inertia", d->transverse_inertia,
            0.5 * d->axial_inertia + 0.25 * imki_tuned_gyro_gimbal_sum(d),
            "a nutation well below twice the speed of the shaft, where the gimbal drives "
            "it");
    if (d->captured && !imki_capture_loop_stable(d, imki_tuned_gyro_longest_step(d)))
        return imki_conflict(
            error, "loop.frequency", d->loop_frequency, d->loop_filter,
            "a loop that excites neither itself nor the nutation: lower its frequency, and put its "
            "filter between this frequency and the nutation");
    if (!d->captured)
        return IMK_OK;
    return imki_check_torque(d->torque.fixed, imk_tuned_gyro_default().torque.fixed,
                             d->torquer_limit, "torquer.limit", d->torquer_limit,
                             "a fixed torque below the largest of the torquers, which balance it",
                             error);
}

/* ---- description ----------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"angular_rate", "rad/s", "deg/s", "measured rate about x, the mean over the sample"},
    {"angular_rate_y", "rad/s", "deg/s", "measured rate about y, the mean over the sample"}};

static const imk_signal signals[IMKI_TUNED_GYRO_SIGNALS] = {
    {"tilt_x", "rad", "arcsec", "tilt of the rotor about x"},
    {"tilt_y", "rad", "arcsec", "tilt of the rotor about y"},
    {"hinge_1", "rad", "arcsec", "angle of the flexures of the shaft"},
    {"hinge_2", "rad", "arcsec", "angle of the flexures of the rotor"},
    {"command_x", "rad/s", "deg/s", "rate about x that the loop asks for"},
    {"command_y", "rad/s", "deg/s", "rate about y that the loop asks for"}};

static const imk_view views[] = {
    {.title = "Rotor after the rate begins",
     .caption = "The rotor is left behind by the case, nutates, and the loop brings it back.",
     .x = -1,
     .curve_count = 2,
     .y = {0, 1},
     .duration = 0.1,
     .rate = 6400.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "Path of the rotor",
     .caption = "Tilt about y against tilt about x: nutation on the way back.",
     .x = 0,
     .curve_count = 1,
     .y = {1},
     .duration = 0.1,
     .rate = 12800.0,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "What the flexures see",
     .caption = "Angles of the two pairs of flexures, in axes that turn with the shaft.",
     .x = -1,
     .curve_count = 2,
     .y = {2, 3},
     .duration = 0.05,
     .rate = 12800.0,
     .input = 10.0 * IMKI_DEGREE},
};

IMKI_DESIGN_FUNCTIONS(tuned_gyro);

const imk_instrument imk_tuned_gyro_instrument = {
    IMKI_DESCRIBED(tuned_gyro),
    .title = "dynamically tuned gyro",
    .technology = "DTG",
    .source = "figures chosen, of the size of small strapdown tuned gyros; see tuned_gyro.h",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_tuned_gyro_state),
    .init = imki_tuned_gyro_init,
    .step = imki_tuned_gyro_step,
    .observe = imki_tuned_gyro_observe,
    .step_length = imki_tuned_gyro_step_length};
