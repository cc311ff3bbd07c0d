/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro, seen from the side: a rotor on a Hooke joint on the shaft of a motor.
 * The sheet is the plane of y and z, so a tilt about x turns the rotor in it. */
#include "schematic_internal.h"

#include "imukit/tuned_gyro.h"

#include <math.h>

/* ---- the tables ------------------------------------------------------------------------------ */

enum { ROTOR, RIM, GIMBAL, SHAFT_MARKS, PARTS };

#define MIDDLE_X 200
#define MIDDLE_Y 150
#define STRIPE 26
#define DEGREE (3.14159265358979323846 / 180)
#define LARGEST (20 * DEGREE) /* rate of the drawing [rad/s] */

/* The tilt under that rate before the integral of the loop acts. */
static double largest_tilt(const void *design)
{
    const imk_tuned_gyro *d = design;
    const double tilt =
        LARGEST / (2 * d->loop_damping * 2 * 3.14159265358979323846 * d->loop_frequency);
    return d->captured && tilt < d->pickoff_range ? tilt : d->pickoff_range;
}

/* x points out of the sheet and z upwards, so y to the right is turned towards z: to the left. */
static const imk_schematic_part parts[PARTS] = {
    [ROTOR] = {.id = "rotor",
               .signal = "tilt_x",
               .move = IMK_MOVE_TURN,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = -16,
               .full = largest_tilt},
    [RIM] = {.id = "rim", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -78},
    [GIMBAL] = {.id = "gimbal",
                .signal = "tilt_x",
                .move = IMK_MOVE_TURN,
                .with = "rotor",
                .x = MIDDLE_X,
                .y = MIDDLE_Y,
                .reach = 0.5},
    [SHAFT_MARKS] = {.id = "shaft", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -26},
};

static double observed(const char *name, const imk_schematic_moment *moment)
{
    return imki_signal(&imk_tuned_gyro_instrument, name, moment);
}

static double tilt_x(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("tilt_x", moment);
}

static double tilt_y(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("tilt_y", moment);
}

static double command(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("command_x", moment);
}

static double torque(const void *design, const imk_schematic_moment *moment)
{
    const imk_derived *momentum =
        imk_instrument_derived(&imk_tuned_gyro_instrument, "angular momentum");
    return momentum ? imk_derived_value(momentum, design) * command(design, moment) : (double)NAN;
}

static const imk_schematic_quantity quantities[] = {
    {"angular momentum", NULL, NULL, NULL, NULL, NULL},
    {"tilt about x", "θ_x", "rad", "arcsec", "θ_x' = −Ω_x + loop", tilt_x},
    {"tilt about y", "θ_y", "rad", "arcsec", "θ_y' = −Ω_y + loop", tilt_y},
    {"rate that the loop asks for", "Ω_p", "rad/s", "deg/s", "Ω_p = −(2zω θ + ω^2 ∫θ dt)", command},
    {"torque that turns the rotor so", "M", "N*m", "uN*m", "M = H Ω_p", torque},
    {"tuned speed, exact", NULL, NULL, NULL, NULL, NULL},
    {"residual spring", NULL, NULL, NULL, NULL, NULL},
    {"nutation frequency", NULL, NULL, NULL, NULL, NULL},
    {"figure of merit", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -60, 60, "deg/s", false},       {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 80, "degC", false}, {"wheel.spin_frequency", 195, 205, NULL, false},
    {"loop.frequency", 2, 5, NULL, true},    {"rotor.axial_offset", -1000, 1000, NULL, false},
    {"loop.captured", 0, 0, NULL, false},
};

/* Two periods of the loop. */
static double cycle(const void *design)
{
    const imk_tuned_gyro *d = design;
    return 2 / d->loop_frequency;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_motor(imki_drawing *d)
{
    imki_draw_path(d, "body", "M50 240H350V352H50Z");
    imki_draw_box(d, "field", 118, 262, 40, 74, 3);
    imki_draw_box(d, "field", 242, 262, 40, 74, 3);
    imki_draw_box(d, "mass", 170, 262, 60, 74, 3);
    imki_draw_box(d, "body", MIDDLE_X - 10, MIDDLE_Y, 20, 112, 0);
    imki_part_begin(d, SHAFT_MARKS);
    imki_dashes_begin(d, 2, 11);
    imki_draw_line(d, "thin", MIDDLE_X - 10, 200, MIDDLE_X + 10, 200);
    imki_draw_line(d, "thin", MIDDLE_X - 10, 226, MIDDLE_X + 10, 226);
    imki_group_end(d);
    imki_part_end(d);
}

/* A ring that is cut: its two sides, right and left of the joint, and its rim in front. */
static void draw_rotor(imki_drawing *d)
{
    imki_part_begin(d, ROTOR);
    imki_draw_box(d, "mass", MIDDLE_X - 130, MIDDLE_Y - 30, 62, 60, 5);
    imki_draw_box(d, "mass", MIDDLE_X + 68, MIDDLE_Y - 30, 62, 60, 5);
    imki_draw_line(d, "thin", MIDDLE_X - 68, MIDDLE_Y - 30, MIDDLE_X + 68, MIDDLE_Y - 30);
    imki_draw_line(d, "thin", MIDDLE_X - 68, MIDDLE_Y + 30, MIDDLE_X + 68, MIDDLE_Y + 30);
    imki_part_begin(d, RIM);
    imki_dashes_begin(d, 2, STRIPE - 2);
    imki_draw_line(d, "rim-marks", MIDDLE_X - 126, MIDDLE_Y, MIDDLE_X - 72, MIDDLE_Y);
    imki_draw_line(d, "rim-marks", MIDDLE_X + 72, MIDDLE_Y, MIDDLE_X + 126, MIDDLE_Y);
    imki_group_end(d);
    imki_part_end(d);
    imki_draw_line(d, "spring", MIDDLE_X - 68, MIDDLE_Y, MIDDLE_X - 46, MIDDLE_Y);
    imki_draw_line(d, "spring", MIDDLE_X + 46, MIDDLE_Y, MIDDLE_X + 68, MIDDLE_Y);
    imki_part_end(d);
    imki_part_begin(d, GIMBAL);
    imki_draw_path(d, "body", "M154 132H246V168H154ZM164 142V158H236V142Z");
    imki_part_end(d);
    imki_draw_circle(d, "field", MIDDLE_X, MIDDLE_Y, 9); /* the flexure of the shaft, along x */
}

/* On the case, above and below the rotor. */
static void draw_pickoffs(imki_drawing *d)
{
    imki_draw_box(d, "fill-accent", MIDDLE_X - 122, 88, 36, 6, 1);
    imki_draw_box(d, "fill-accent", MIDDLE_X + 86, 88, 36, 6, 1);
    imki_draw_box(d, "fill-one", MIDDLE_X - 122, 206, 36, 8, 1);
    imki_draw_box(d, "fill-one", MIDDLE_X + 86, 206, 36, 8, 1);
    imki_draw_line(d, "line", MIDDLE_X - 104, 214, MIDDLE_X - 104, 240);
    imki_draw_line(d, "line", MIDDLE_X + 104, 214, MIDDLE_X + 104, 240);
}

static void draw(imki_drawing *d, const void *design)
{
    (void)design;
    imki_draw_line(d, "axis", MIDDLE_X, 62, MIDDLE_X, 372);
    draw_motor(d);
    draw_rotor(d);
    draw_pickoffs(d);
    imki_draw_arrow(d, "two", MIDDLE_X, 118, MIDDLE_X, 52);
    imki_draw_text(d, IMKI_START, 214, 66, "H, spin z");
    imki_draw_label(d, IMKI_START, 372, 92, "pickoff", 368, 88, 318, 90);
    imki_draw_label(d, IMKI_START, 372, 136, "rotor", 368, 132, 316, 140);
    imki_draw_label(d, IMKI_START, 372, 170, "gimbal", 368, 166, 241, 163);
    imki_draw_label(d, IMKI_START, 372, 204, "flexures k_x, k_y", 368, 199, 207, 154);
    imki_draw_label(d, IMKI_START, 372, 238, "torquer", 368, 232, 316, 211);
    imki_draw_label(d, IMKI_START, 372, 284, "motor", 368, 280, 270, 290);
    imki_draw_circle(d, "line", 392, 326, 11);
    imki_draw_circle(d, "head", 392, 326, 3.5);
    imki_draw_text(d, IMKI_START, 414, 333, "input x: Ω");
    imki_draw_text(d, IMKI_END, 530, 390, "N^2 = (k_x + k_y)/J");
    imki_magnified(d, ROTOR, IMKI_END, 530, 362, "tilt");
}

const imk_schematic imki_schematic_tuned_gyro = {
    .instrument = &imk_tuned_gyro_instrument,
    .description =
        "A rotor hangs by flexures on a small gimbal and this by flexures on the shaft of "
        "a motor. At the tuned speed the nodding of the gimbal cancels the springs, and "
        "the rotor keeps its direction. Pickoffs above it see the case tilt against "
        "it, and torquers turn it after the case.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 5,
    .cycles = 1,
    .input = LARGEST,
    .sine = true,
    .draw = draw,
};
