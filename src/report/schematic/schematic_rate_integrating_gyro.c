/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro, seen along its output axis: a wheel in a float that turns in a
 * liquid. x is upwards and z to the right, so y points out of the sheet. */
#include "schematic_internal.h"

#include "imukit/rate_integrating_gyro.h"

/* ---- the tables ------------------------------------------------------------------------------ */

enum { FLOAT, RIM, TORQUE, PARTS };

#define MIDDLE_X 190
#define MIDDLE_Y 202
#define STRIPE 18
#define DEGREE (3.14159265358979323846 / 180)
#define LARGEST (10 * DEGREE) /* rate of the drawing [rad/s] */

/* The float's angle under that rate before the integral of the loop acts; open, the stop. */
static double largest_angle(const void *design)
{
    const imk_rate_integrating_gyro *d = design;
    const double angle = d->momentum / d->damping * LARGEST /
                         (2 * d->loop_damping * 2 * 3.14159265358979323846 * d->loop_frequency);
    return d->rebalance == IMK_REBALANCE_ANALOG && angle < d->stop ? angle : d->stop;
}

static double largest_torque(const void *design)
{
    const imk_rate_integrating_gyro *d = design;
    return d->momentum * LARGEST;
}

/* An angle about y is counterclockwise in the sheet. The signal of the torquer has the sign of the
 * reading: the torque acts against it. */
static const imk_schematic_part parts[PARTS] = {
    [FLOAT] = {.id = "float",
               .signal = "float_angle",
               .move = IMK_MOVE_TURN,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = -25,
               .full = largest_angle},
    [RIM] = {.id = "rim", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -60},
    [TORQUE] = {.id = "torque",
                .signal = "torquer_torque",
                .move = IMK_MOVE_STRETCH_X,
                .x = 452,
                .y = 296,
                .reach = -1,
                .full = largest_torque,
                .still = 0.5},
};

static double gyroscopic(const void *design, const imk_schematic_moment *moment)
{
    const imk_rate_integrating_gyro *d = design;
    return d->momentum * (1 + d->momentum_error) * moment->exposure->angular_rate[0];
}

static double observed(const char *name, const imk_schematic_moment *moment)
{
    return imki_signal(&imk_rate_integrating_gyro_instrument, name, moment);
}

static double float_angle(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("float_angle", moment);
}

static double torquer(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return -observed("torquer_torque", moment);
}

static double held_rate(const void *design, const imk_schematic_moment *moment)
{
    const imk_rate_integrating_gyro *d = design;
    return -torquer(design, moment) / (d->momentum * (1 + d->momentum_error));
}

static const imk_schematic_quantity quantities[] = {
    {"angular momentum", NULL, NULL, NULL, NULL, NULL},
    {"gyroscopic torque", "M", "N*m", "mN*m", "M = H Ω", gyroscopic},
    {"torque of the torquer", "T", "N*m", "mN*m", "T = −(K_1 θ + K_2 ∫θ dt)", torquer},
    {"precession under that torque", "Ω_p", "rad/s", "deg/s", "Ω_p = −T/H", held_rate},
    {"float angle", "θ", "rad", "arcsec", "I θ'' + C θ' = H Ω + T", float_angle},
    {"gyro gain", NULL, NULL, NULL, NULL, NULL},
    {"float time constant", NULL, NULL, NULL, NULL, NULL},
    {"drift per torque", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -25, 25, "deg/s", false},           {"acceleration", -10, 10, "g", false},
    {"temperature", 0, 80, "degC", false},       {"rebalance", 0, 0, NULL, false},
    {"wheel.momentum", 0.02, 0.04, NULL, false}, {"float.damping", 0.03, 0.08, NULL, true},
    {"loop.frequency", 2, 6, NULL, true},
};

/* Two periods of the loop. */
static double cycle(const void *design)
{
    const imk_rate_integrating_gyro *d = design;
    return 2 / d->loop_frequency;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_case(imki_drawing *d)
{
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, 150);
    imki_draw_circle(d, "glass", MIDDLE_X, MIDDLE_Y, 130);
    for (int k = -3; k <= 3; k++) {
        imki_turned_begin(d, 10 * k, MIDDLE_X, MIDDLE_Y);
        imki_draw_line(d, "line", MIDDLE_X, MIDDLE_Y - 130, MIDDLE_X, MIDDLE_Y - (k ? 137 : 144));
        imki_group_end(d);
    }
}

static void draw_float(imki_drawing *d)
{
    imki_part_begin(d, FLOAT);
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, 114);
    imki_draw_circle(d, "paper", MIDDLE_X, MIDDLE_Y, 102);
    imki_draw_polygon(d, "fill-accent", 3,
                      (const double[]){MIDDLE_X, MIDDLE_Y - 127, MIDDLE_X - 8, MIDDLE_Y - 113,
                                       MIDDLE_X + 8, MIDDLE_Y - 113},
                      true);
    imki_draw_line(d, "shaft", MIDDLE_X - 102, MIDDLE_Y, MIDDLE_X + 102, MIDDLE_Y);
    imki_draw_box(d, "field", MIDDLE_X - 84, MIDDLE_Y - 12, 22, 24, 2);
    imki_draw_box(d, "field", MIDDLE_X + 62, MIDDLE_Y - 12, 22, 24, 2);
    imki_draw_box(d, "mass", MIDDLE_X - 22, MIDDLE_Y - 68, 44, 136, 4);
    imki_part_begin(d, RIM);
    imki_dashes_begin(d, 2, STRIPE - 2);
    imki_draw_line(d, "rim-marks", MIDDLE_X, MIDDLE_Y - 64, MIDDLE_X, MIDDLE_Y + 64);
    imki_group_end(d);
    imki_part_end(d);
    imki_part_end(d);
}

static void draw_torquer(imki_drawing *d)
{
    imki_draw_line(d, "thin", 452, 280, 452, 312);
    imki_part_begin(d, TORQUE);
    imki_draw_box(d, "fill-one", 452, 290, 60, 12, 0);
    imki_part_end(d);
    imki_draw_text(d, IMKI_MIDDLE, 452, 270, "torque T");
}

static void draw(imki_drawing *d, const void *design)
{
    (void)design;
    draw_case(d);
    draw_float(d);
    imki_draw_box(d, "field", MIDDLE_X - 142, MIDDLE_Y - 20, 14, 40, 3);
    imki_draw_box(d, "field", MIDDLE_X + 128, MIDDLE_Y - 20, 14, 40, 3);
    imki_draw_text(d, IMKI_START, 352, 96, "input x, up: Ω");
    imki_draw_arrow(d, "two", 340, 104, 340, 72);
    imki_draw_line(d, "axis", MIDDLE_X - 176, MIDDLE_Y, MIDDLE_X + 168, MIDDLE_Y);
    imki_draw_label(d, IMKI_START, 352, 130, "float I", 348, 125, 282, 150);
    imki_draw_label(d, IMKI_START, 352, 162, "liquid C", 348, 157, 310, 176);
    imki_draw_label(d, IMKI_START, 366, 208, "spin z: H = Iω", 362, 203, MIDDLE_X + 22, MIDDLE_Y);
    imki_draw_label(d, IMKI_START, 352, 240, "torquer", 348, 234, 326, 218);
    draw_torquer(d);
    imki_draw_label(d, IMKI_START, 12, 66, "pickoff", 82, 60, 170, 72);
    imki_draw_text(d, IMKI_END, 530, 344, "Cθ = H∫Ω dt");
    imki_magnified(d, FLOAT, IMKI_END, 530, 390, "angle θ");
}

const imk_schematic imki_schematic_rate_integrating_gyro = {
    .instrument = &imk_rate_integrating_gyro_instrument,
    .description =
        "A spinning wheel in a float that turns in a liquid about the output axis, which "
        "points out of the drawing. When the case turns about the input axis, the float "
        "turns against the liquid by an angle that is the integral of the rate. A "
        "torquer brings it back, and its torque is the reading.",
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
