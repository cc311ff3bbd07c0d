/* SPDX-License-Identifier: Apache-2.0 */
/* The MEMS accelerometer: a proof mass on springs, its fingers between fixed plates. The motion is
 * drawn to the scale of the gap. */
#include "schematic_internal.h"

#include "imukit/mems_accelerometer.h"

/* ---- the tables ------------------------------------------------------------------------------ */

enum { MASS, LEFT, RIGHT, PARTS };

#define GAP 30    /* [px] */
#define SPRING 90 /* length of a spring [px] */

static double gap_of(const void *design)
{
    const imk_mems_accelerometer *d = design;
    return d->gap;
}

static const imk_schematic_part parts[PARTS] = {
    [MASS] = {.id = "mass",
              .signal = "displacement",
              .move = IMK_MOVE_SHIFT_X,
              .reach = GAP,
              .full = gap_of},
    [LEFT] = {.id = "spring-left",
              .signal = "displacement",
              .move = IMK_MOVE_STRETCH_X,
              .with = "mass",
              .x = 60,
              .reach = 1.0 / SPRING,
              .base = 1},
    [RIGHT] = {.id = "spring-right",
               .signal = "displacement",
               .move = IMK_MOVE_STRETCH_X,
               .with = "mass",
               .x = 480,
               .reach = -1.0 / SPRING,
               .base = 1},
};

static double displacement(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_mems_accelerometer_instrument, "displacement", moment);
}

static double feedback(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_mems_accelerometer_instrument, "feedback", moment);
}

static const imk_schematic_quantity quantities[] = {
    {"displacement of the mass", "x", "m", "nm", "x'' + b/m x' + (k − k_e)/m x = −a", displacement},
    {"acceleration by the loop", "a_f", "m/s^2", "g", "a_f = F/m", feedback},
    {"displacement per specific force", NULL, NULL, NULL, NULL, NULL},
    {"natural frequency, softened", NULL, NULL, NULL, NULL, NULL},
    {"capacitance of a plate, mass in the middle", NULL, NULL, NULL, NULL, NULL},
    {"change of capacitance per specific force", NULL, NULL, NULL, NULL, NULL},
    {"pull-in voltage", NULL, NULL, NULL, NULL, NULL},
    {"voltage, share of pull-in", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"acceleration", -5, 5, "g", false},         {"rate", -360, 360, "deg/s", false},
    {"temperature", -40, 85, "degC", false},     {"proof_mass.frequency", 1600, 4000, NULL, true},
    {"proof_mass.quality", 0.3, 10, NULL, true}, {"electrodes.gap", 1.8, 4, NULL, false},
    {"electrodes.voltage", 0, 2, NULL, false},
};

/* Ten periods of the mass. */
static double cycle(const void *design)
{
    const imk_mems_accelerometer *d = design;
    return 10 / d->frequency;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static const double finger_x[] = {210, 330};

/* From the mass upwards or downwards. */
static void draw_mass(imki_drawing *d)
{
    imki_part_begin(d, MASS);
    for (int k = 0; k < 2; k++) {
        imki_draw_box(d, "mass", finger_x[k] - 4, 100, 8, 62, 0);
        imki_draw_box(d, "mass", finger_x[k] - 4, 228, 8, 62, 0);
    }
    imki_draw_box(d, "mass", 150, 160, 240, 70, 3);
    for (int k = 0; k < 16; k++)
        if (k / 2 != 3 && k / 2 != 4) /* holes; in the middle stands the name */
            imki_draw_box(d, "paper", 170 + 27 * (k / 2.0 - k % 2 / 2.0), k % 2 ? 208 : 174, 10, 10,
                          0);
    imki_draw_text(d, IMKI_MIDDLE, 270, 202, "m");
    imki_part_end(d);
}

static void draw_springs(imki_drawing *d)
{
    imki_draw_anchor(d, 60, 150, 60, 240);
    imki_draw_anchor(d, 480, 240, 480, 150);
    imki_part_begin(d, LEFT);
    imki_draw_spring(d, 60, 175, 60 + SPRING, 175, 6, 9);
    imki_draw_spring(d, 60, 215, 60 + SPRING, 215, 6, 9);
    imki_part_end(d);
    imki_part_begin(d, RIGHT);
    imki_draw_spring(d, 480, 175, 480 - SPRING, 175, 6, 9);
    imki_draw_spring(d, 480, 215, 480 - SPRING, 215, 6, 9);
    imki_part_end(d);
}

/* Fixed plates on both sides of each finger; with single plates, only where the gap closes. */
static void draw_plates(imki_drawing *d, bool both)
{
    for (int k = 0; k < 2; k++) {
        const double right = finger_x[k] + 4 + GAP, left = finger_x[k] - 4 - GAP - 8;
        imki_draw_box(d, "fill-one", right, 92, 8, 52, 1);
        imki_draw_box(d, "fill-one", right, 246, 8, 52, 1);
        if (both) {
            imki_draw_box(d, "fill-two", left, 92, 8, 52, 1);
            imki_draw_box(d, "fill-two", left, 246, 8, 52, 1);
        }
    }
    imki_draw_path(d, "one", "M248 92V82H372M368 92V82");
    if (both)
        imki_draw_path(d, "two", "M292 92V72H168M172 92V72");
}

static void draw(imki_drawing *d, const void *design)
{
    const imk_mems_accelerometer *mems = design;
    const bool both = mems->plates == IMK_MEMS_DOUBLE;
    draw_springs(d);
    draw_mass(d);
    draw_plates(d, both);
    imki_draw_text(d, IMKI_START, 380, 89, "C_+");
    if (both)
        imki_draw_text(d, IMKI_END, 160, 79, "C_−");
    imki_draw_text(d, IMKI_START, 12, 340, both ? "C_± = εA/(d ∓ x)" : "C_+ = εA/(d − x)");
    imki_draw_label(d, IMKI_START, 12, 282, "spring k", 50, 263, 80, 220);
    imki_draw_label(d, IMKI_START, 402, 282, "proof mass", 430, 263, 378, 228);
    imki_draw_line(d, "bar", 214, 306, 214, 318);
    imki_draw_line(d, "bar", 244, 306, 244, 318);
    imki_draw_line(d, "bar", 214, 312, 244, 312);
    imki_draw_text(d, IMKI_MIDDLE, 229, 340, "gap d");
    imki_draw_arrow(d, "accent", 440, 330, 510, 330);
    imki_draw_text(d, IMKI_MIDDLE, 472, 356, "input a");
    imki_scale_bar(d, MASS, 340, 312);
    imki_draw_text(d, IMKI_END, 530, 390, "x = −a/ω_n^2");
}

const imk_schematic imki_schematic_mems_accelerometer = {
    .instrument = &imk_mems_accelerometer_instrument,
    .description = "A proof mass on springs between two anchors. Its fingers stand between fixed "
                   "plates. A specific force moves the mass, so one gap and its capacitance grows "
                   "and the other shrinks.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 4,
    .cycles = 1,
    .input = 5 * 9.80665,
    .sine = true,
    .draw = draw,
};
