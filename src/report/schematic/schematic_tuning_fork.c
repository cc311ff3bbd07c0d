/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro: two masses in frames that swing against each other, from above or, if they
 * respond along the normal of the chip, from the side. */
#include "schematic_internal.h"

#include "imukit/tuning_fork.h"

#include <math.h>

/* ---- the tables ------------------------------------------------------------------------------ */

enum {
    DRIVE,
    SPRING_LEFT,
    SENSE,
    UPPER_LEFT,
    LOWER_LEFT,
    DRIVE_RIGHT,
    SPRING_RIGHT,
    SENSE_RIGHT,
    UPPER_RIGHT,
    LOWER_RIGHT,
    PARTS
};

static double drive_size(const void *design)
{
    const imk_tuning_fork *d = design;
    return d->drive.amplitude;
}

/* By the rate of the picture and the quadrature. */
static double sense_size(const void *design)
{
    const imk_tuning_fork *d = design;
    const double rate = 100 * 3.14159265358979323846 / 180;
    return imk_tuning_fork_response(d) * sqrt(rate * rate + d->quadrature * d->quadrature);
}

/* Lengths of the springs [px]. */
#define OUTER 40
#define INNER 18

#define DRIVEN(name, way, ...)                                                                     \
    {                                                                                              \
        .id = name, .signal = "drive_displacement", .reach = way, __VA_ARGS__                      \
    }
#define SENSED(name, way, ...)                                                                     \
    {                                                                                              \
        .id = name, .signal = "sense_displacement", .reach = way, __VA_ARGS__                      \
    }

/* x to the right, y upwards. */
static const imk_schematic_part parts[PARTS] = {
    [DRIVE] = DRIVEN("drive", 13, .move = IMK_MOVE_SHIFT_X, .full = drive_size, .still = 0.5),
    [SPRING_LEFT] = DRIVEN("spring-left", 1.0 / OUTER, .move = IMK_MOVE_STRETCH_X, .with = "drive",
                           .base = 1, .x = 30),
    [SENSE] = SENSED("sense", -8, .move = IMK_MOVE_SHIFT_Y, .full = sense_size),
    [UPPER_LEFT] = SENSED("upper-left", 1.0 / INNER, .move = IMK_MOVE_STRETCH_Y, .with = "sense",
                          .base = 1, .y = 142),
    [LOWER_LEFT] = SENSED("lower-left", -1.0 / INNER, .move = IMK_MOVE_STRETCH_Y, .with = "sense",
                          .base = 1, .y = 258),
    [DRIVE_RIGHT] = DRIVEN("drive-right", -1, .move = IMK_MOVE_SHIFT_X, .with = "drive"),
    [SPRING_RIGHT] = DRIVEN("spring-right", 1.0 / OUTER, .move = IMK_MOVE_STRETCH_X,
                            .with = "drive", .base = 1, .x = 470),
    [SENSE_RIGHT] = SENSED("sense-right", -1, .move = IMK_MOVE_SHIFT_Y, .with = "sense"),
    [UPPER_RIGHT] = SENSED("upper-right", -1.0 / INNER, .move = IMK_MOVE_STRETCH_Y, .with = "sense",
                           .base = 1, .y = 142),
    [LOWER_RIGHT] = SENSED("lower-right", 1.0 / INNER, .move = IMK_MOVE_STRETCH_Y, .with = "sense",
                           .base = 1, .y = 258),
};

static double coriolis(const void *design, const imk_schematic_moment *moment)
{
    const imk_tuning_fork *d = design;
    const double speed = 2 * 3.14159265358979323846 * d->drive.frequency * d->drive.amplitude;
    return 2 * d->angular_gain * d->mass * speed * moment->exposure->angular_rate[0];
}

static double drive_motion(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_tuning_fork_instrument, "drive_displacement", moment);
}

static double sense_motion(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_tuning_fork_instrument, "sense_displacement", moment);
}

static double sense_amplitude(const void *design, const imk_schematic_moment *moment)
{
    return imk_tuning_fork_response(design) * moment->exposure->angular_rate[0];
}

static const imk_schematic_quantity quantities[] = {
    {"drive motion", "x", "m", "um", "x = x0 cos ωd t", drive_motion},
    {"sense motion", "y", "m", "nm", "y = (y/Ω)(Ω sin ωd t + quadrature cos ωd t)", sense_motion},
    {"drive frequency", NULL, NULL, NULL, NULL, NULL},
    {"frequency split", NULL, NULL, NULL, NULL, NULL},
    {"peak Coriolis force", "F_c", "N", "pN", "F_c = 2 k m x0 ωd Ω", coriolis},
    {"sense amplitude by the rate", "y_Ω", "m", "pm", "y_Ω = (y/Ω) Ω", sense_amplitude},
    {"Coriolis gain, sense motion per rate", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -150, 150, "deg/s", false},       {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 125, "degC", false},  {"drive.amplitude", 1, 8, "um", false},
    {"sense.split", 100, 3000, "Hz", true},    {"sense.q", 20, 1000, "1", true},
    {"quadrature", -100, 100, "deg/s", false}, {"arrangement", 0, 0, NULL, false},
};

static double cycle(const void *design)
{
    const imk_tuning_fork *d = design;
    return 1 / d->drive.frequency;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

/* The frame of a side with its springs and mass; `middle` is its x. */
static void draw_inside(imki_drawing *d, double middle, size_t sense, size_t upper, size_t lower)
{
    imki_part_begin(d, upper);
    imki_draw_spring(d, middle - 33, 142, middle - 33, 142 + INNER, 3, 5);
    imki_draw_spring(d, middle + 33, 142, middle + 33, 142 + INNER, 3, 5);
    imki_part_end(d);
    imki_part_begin(d, lower);
    imki_draw_spring(d, middle - 33, 258, middle - 33, 258 - INNER, 3, 5);
    imki_draw_spring(d, middle + 33, 258, middle + 33, 258 - INNER, 3, 5);
    imki_part_end(d);
    imki_part_begin(d, sense);
    imki_draw_box(d, "mass", middle - 42, 142 + INNER, 84, 116 - 2 * INNER, 2);
    imki_draw_text(d, IMKI_MIDDLE, middle, 207, "m");
    imki_part_end(d);
}

static void draw_frame(imki_drawing *d, double left, double comb, double finger)
{
    imki_draw_path(d, "mass",
                   left < 200 ? "M70 130H200V270H70ZM82 142H188V258H82Z"
                              : "M300 130H430V270H300ZM312 142H418V258H312Z");
    for (int k = 0; k < 5; k++)
        imki_draw_box(d, "mass", finger > 0 ? comb : comb + finger, 168 + 15 * k, fabs(finger), 4,
                      0);
}

/* The comb between the two frames, fixed. */
static void draw_comb(imki_drawing *d)
{
    imki_draw_box(d, "field", 244, 158, 12, 86, 2);
    for (int k = 0; k < 6; k++) {
        imki_draw_box(d, "field", 216, 160.5 + 15 * k, 28, 4, 0);
        imki_draw_box(d, "field", 256, 160.5 + 15 * k, 28, 4, 0);
    }
}

/* Fixed plates above and below a mass. */
static void draw_plates(imki_drawing *d, double middle)
{
    imki_draw_box(d, "fill-two", middle - 13, 145, 26, 5, 1);
    imki_draw_box(d, "fill-two", middle - 13, 250, 26, 5, 1);
}

static void draw_axis(imki_drawing *d)
{
    imki_draw_circle(d, "line", 506, 186, 12);
    imki_draw_circle(d, "head", 506, 186, 3.5);
    imki_draw_text(d, IMKI_MIDDLE, 506, 222, "Ω");
}

/* The springs between the case and the frames, at two heights. */
static void draw_drive_springs(imki_drawing *d, double upper, double lower)
{
    imki_draw_anchor(d, 30, upper - 30, 30, lower + 30);
    imki_draw_anchor(d, 470, lower + 30, 470, upper - 30);
    imki_part_begin(d, SPRING_LEFT);
    imki_draw_spring(d, 30, upper, 30 + OUTER, upper, 4, 7);
    imki_draw_spring(d, 30, lower, 30 + OUTER, lower, 4, 7);
    imki_part_end(d);
    imki_part_begin(d, SPRING_RIGHT);
    imki_draw_spring(d, 470, upper, 470 - OUTER, upper, 4, 7);
    imki_draw_spring(d, 470, lower, 470 - OUTER, lower, 4, 7);
    imki_part_end(d);
}

static void draw_from_above(imki_drawing *d)
{
    draw_drive_springs(d, 160, 240);
    imki_part_begin(d, DRIVE);
    draw_frame(d, 70, 200, 27);
    draw_inside(d, 135, SENSE, UPPER_LEFT, LOWER_LEFT);
    imki_part_end(d);
    imki_part_begin(d, DRIVE_RIGHT);
    draw_frame(d, 300, 300, -27);
    draw_inside(d, 365, SENSE_RIGHT, UPPER_RIGHT, LOWER_RIGHT);
    imki_part_end(d);
    draw_comb(d);
    draw_plates(d, 135);
    draw_plates(d, 365);
    imki_draw_label(d, IMKI_START, 20, 72, "proof mass", 80, 78, 108, 172);
    imki_draw_label(d, IMKI_MIDDLE, 250, 72, "drive comb", 250, 79, 250, 157);
    imki_draw_label(d, IMKI_END, 530, 72, "sense electrode", 400, 78, 367, 146);
    imki_draw_label(d, IMKI_START, 12, 312, "drive spring", 40, 294, 52, 247);
}

/* A mass between its springs, over the chip. */
static void draw_slab(imki_drawing *d, double middle, size_t drive, size_t sense)
{
    imki_part_begin(d, drive);
    imki_part_begin(d, sense);
    imki_draw_box(d, "mass", middle - 65, 166, 130, 44, 2);
    imki_draw_text(d, IMKI_MIDDLE, middle, 195, "m");
    imki_part_end(d);
    imki_part_end(d);
}

static void draw_from_the_side(imki_drawing *d)
{
    draw_drive_springs(d, 180, 196);
    draw_slab(d, 135, DRIVE, SENSE);
    draw_slab(d, 365, DRIVE_RIGHT, SENSE_RIGHT);
    imki_draw_anchor(d, 470, 254, 30, 254);
    imki_draw_box(d, "field", 238, 162, 24, 52, 2);
    imki_draw_line(d, "line", 250, 214, 250, 254);
    imki_draw_box(d, "fill-two", 85, 244, 100, 7, 1);
    imki_draw_box(d, "fill-two", 315, 244, 100, 7, 1);
    imki_draw_label(d, IMKI_START, 20, 112, "proof mass", 80, 118, 100, 176);
    imki_draw_label(d, IMKI_MIDDLE, 250, 112, "drive comb", 250, 119, 250, 161);
    imki_draw_label(d, IMKI_END, 530, 112, "sense electrode", 492, 118, 412, 245);
    imki_draw_label(d, IMKI_START, 12, 312, "drive spring", 40, 294, 50, 203);
    imki_draw_note(d, IMKI_END, 530, 26, "from the side");
}

static void draw(imki_drawing *d, const void *design)
{
    const imk_tuning_fork *fork = design;
    if (fork->arrangement == IMK_TUNING_FORK_IN_PLANE)
        draw_from_above(d);
    else
        draw_from_the_side(d);
    imki_draw_arrow(d, "one", 250, 318, 214, 318);
    imki_draw_arrow(d, "one", 250, 318, 286, 318);
    imki_draw_text(d, IMKI_MIDDLE, 250, 306, "drive x");
    imki_scale_bar(d, DRIVE, 250, 334);
    imki_draw_text(d, IMKI_MIDDLE, 385, 300, "sense y");
    imki_draw_arrow(d, "two", 356, 330, 356, 308);
    imki_draw_arrow(d, "two", 356, 330, 356, 352);
    imki_scale_bar(d, SENSE, 374, 330);
    draw_axis(d);
    imki_draw_text(d, IMKI_END, 530, 390, "F_c = 2kmΩẋ");
}

const imk_schematic imki_schematic_tuning_fork = {
    .instrument = &imk_tuning_fork_instrument,
    .description =
        "Two frames on springs, driven against each other along x by a comb between them. In each "
        "frame a mass hangs on springs along y. When the gyro turns about the normal of the "
        "drawing, the Coriolis force moves the masses along y, in opposite directions, between "
        "sense electrodes.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 1.5,
    .cycles = 4,
    .settle = 0.05,
    .input = 100 * 3.14159265358979323846 / 180,
    .draw = draw,
};
