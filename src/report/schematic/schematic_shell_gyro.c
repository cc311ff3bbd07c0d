/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating shell gyro, seen along its axis: the rim of the shell becomes an ellipse and back,
 * by two modes 45 deg apart, between electrodes. The drawing is of n = 2. */
#include "schematic_internal.h"

#include "imukit/shell_gyro.h"

#include <math.h>
#include <stdio.h>

/* ---- the tables ------------------------------------------------------------------------------ */

enum { MODE_X, MODE_Y, PATTERN, PARTS };

#define MIDDLE_X 190
#define MIDDLE_Y 206
#define RADIUS 92
#define SWING 0.17 /* of the radius */
#define RADIAN (180 / 3.14159265358979323846)

static double amplitude(const void *design)
{
    const imk_shell_gyro *d = design;
    return d->pattern.amplitude;
}

/* y points to the right and z upwards, x to the eye: angles are counterclockwise. */
static const imk_schematic_part parts[PARTS] = {
    [MODE_X] = {.id = "mode-x",
                .signal = "x",
                .move = IMK_MOVE_SQUEEZE,
                .x = MIDDLE_X,
                .y = MIDDLE_Y,
                .reach = SWING,
                .full = amplitude,
                .still = 0.9},
    [MODE_Y] = {.id = "mode-y",
                .signal = "y",
                .move = IMK_MOVE_SQUEEZE,
                .x = MIDDLE_X,
                .y = MIDDLE_Y,
                .reach = SWING,
                .full = amplitude,
                .held = true},
    [PATTERN] = {.id = "pattern",
                 .signal = "modal_angle",
                 .move = IMK_MOVE_TURN,
                 .x = MIDDLE_X,
                 .y = MIDDLE_Y,
                 .reach = -0.5 * RADIAN,
                 .held = true},
};

static double observed(const char *name, const imk_schematic_moment *moment)
{
    return imki_signal(&imk_shell_gyro_instrument, name, moment);
}

static double mode_x(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("x", moment);
}

static double mode_y(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("y", moment);
}

static double pattern_angle(const void *design, const imk_schematic_moment *moment)
{
    const imk_shell_gyro *d = design;
    return observed("modal_angle", moment) / d->resonator.mode_number;
}

static double rebalance(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("rebalance_force", moment);
}

static const imk_schematic_quantity quantities[] = {
    {"motion of mode x (drive)", "x", "m", "um", "x = a cos θ cos ωt", mode_x},
    {"motion of mode y (sense)", "y", "m", "nm", "y = a sin θ cos ωt", mode_y},
    {"angle of the pattern on the shell", "θ/n", "rad", "deg", "(θ/n)' = −κ Ω", pattern_angle},
    {"force that holds the pattern", "f_v", "N", "nN", "f_v = 2 m ω a k Ω", rebalance},
    {"Bryan's factor (angular gain)", NULL, NULL, NULL, NULL, NULL},
    {"rebalance force per rate", NULL, NULL, NULL, NULL, NULL},
    {"decay time constant", NULL, NULL, NULL, NULL, NULL},
    {"largest drift by unequal damping", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -250, 250, "deg/s", false},
    {"temperature", -40, 85, "degC", false},
    {"mode", 0, 0, NULL, false},
    {"pattern.angle", 0, 180, NULL, false},
    {"pattern.amplitude", 2, 8, NULL, false},
    {"anisotropy.frequency_split", 0, 1, NULL, false},
    {"anisotropy.damping_difference", 0, 0.3, NULL, false},
};

static double cycle(const void *design)
{
    const imk_shell_gyro *d = design;
    return 1 / d->resonator.frequency;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_case(imki_drawing *d)
{
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, 150);
    imki_draw_circle(d, "paper", MIDDLE_X, MIDDLE_Y, 134);
    imki_draw_circle(d, "line", MIDDLE_X, MIDDLE_Y, 134);
    for (int k = 0; k < 8; k++) { /* radii 120 and 128, from -14 to 14 deg */
        imki_turned_begin(d, 45 * k, MIDDLE_X, MIDDLE_Y);
        imki_draw_path(d, k % 2 ? "fill-two" : "fill-one",
                       "M161 89.6A120 120 0 0 1 219 89.6L221 81.8A128 128 0 0 0 159 81.8Z");
        imki_group_end(d);
    }
}

/* The squeeze along y and z of a circle that is squeezed along the lines between. */
static void draw_shell(imki_drawing *d)
{
    imki_draw_circle(d, "thin", MIDDLE_X, MIDDLE_Y, RADIUS);
    imki_part_begin(d, MODE_X);
    imki_turned_begin(d, -45, MIDDLE_X, MIDDLE_Y);
    imki_part_begin(d, MODE_Y);
    imki_draw_circle(d, "line ring", MIDDLE_X, MIDDLE_Y, RADIUS);
    imki_part_end(d);
    imki_group_end(d);
    imki_part_end(d);
    imki_part_begin(d, PATTERN);
    imki_draw_line(d, "accent", MIDDLE_X - 66, MIDDLE_Y, MIDDLE_X + 66, MIDDLE_Y);
    imki_draw_line(d, "axis", MIDDLE_X, MIDDLE_Y - 66, MIDDLE_X, MIDDLE_Y + 66);
    imki_part_end(d);
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, 9);
}

/* How far the rim swings, in words: "swing a = 5 µm". */
static void draw_swing(imki_drawing *d, double length)
{
    char text[60];
    const long tenths = lround(length * 1e7);
    if (tenths % 10)
        snprintf(text, sizeof text, "swing a = %ld.%ld µm", tenths / 10, tenths % 10);
    else
        snprintf(text, sizeof text, "swing a = %ld µm", tenths / 10);
    imki_draw_note(d, IMKI_START, 356, 330, text);
}

static void draw(imki_drawing *d, const void *design)
{
    const imk_shell_gyro *shell = design;
    draw_case(d);
    draw_shell(d);
    imki_draw_label(d, IMKI_START, 356, 96, "drive electrode", 352, 90, 196, 84);
    imki_draw_label(d, IMKI_START, 356, 130, "sense electrode", 352, 124, 276, 124);
    imki_draw_label(d, IMKI_START, 356, 164, "rim of the shell", 352, 158, 268, 170);
    imki_draw_label(d, IMKI_START, 356, 220, "pattern, θ/n", 352, 214, 252, MIDDLE_Y);
    imki_draw_label(d, IMKI_START, 356, 254, "case: Ω", 352, 248, 330, 238);
    imki_draw_text(d, IMKI_START, 356, 288, "input x: to you");
    if (shell->resonator.mode_number != 2)
        imki_draw_note(d, IMKI_START, 356, 66, "drawn for n = 2");
    draw_swing(d, shell->pattern.amplitude);
    imki_draw_text(d, IMKI_END, 530, 390, "(θ/n)' = −κΩ");
}

const imk_schematic imki_schematic_shell_gyro = {
    .instrument = &imk_shell_gyro_instrument,
    .description =
        "The rim of a shell swings between two ellipses that lie across one another. When "
        "the case turns, the pattern lags behind by a part of the angle. Electrodes of "
        "two groups, 45 degrees apart, drive the vibration, read it, and hold the "
        "pattern, if the force that holds it is to be the reading.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 1.2,
    .cycles = 5,
    .settle = 0.05,
    .input = 100 * 3.14159265358979323846 / 180,
    .draw = draw,
};
