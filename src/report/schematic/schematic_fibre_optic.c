/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro: source, coupler, modulator, coil and detector, and the operating point on
 * the curve of interference. */
#include "schematic_internal.h"

#include "imukit/elementary.h"
#include "imukit/fibre_optic.h"

static const double pi = 3.14159265358979323846, light_speed = 299792458.0;

/* ---- the tables ------------------------------------------------------------------------------ */

enum { CLOCKWISE, COUNTER, LIGHT, PHASE, POWER, PARTS };

/* The curve: its middle, half its width for 2 pi, its foot and height [px]. */
#define CURVE_X 170
#define CURVE_HALF 140
#define CURVE_Y 350
#define CURVE_HEIGHT 100

static double two_pi(const void *design)
{
    (void)design;
    return 2 * pi;
}

static double bright(const void *design)
{
    const imk_fibre_optic *d = design;
    return imk_fibre_optic_detector_power(d) * 0.5 * (1 + d->visibility);
}

static const imk_schematic_part parts[PARTS] = {
    [CLOCKWISE] = {.id = "clockwise", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -48},
    [COUNTER] = {.id = "counterclockwise", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = 48},
    [LIGHT] = {.id = "light",
               .signal = "detector_power",
               .move = IMK_MOVE_GLOW,
               .reach = 1,
               .full = bright,
               .still = 0.3},
    [PHASE] = {.id = "phase",
               .signal = "phase",
               .move = IMK_MOVE_SHIFT_X,
               .reach = CURVE_HALF,
               .full = two_pi,
               .still = 1.0 / 3},
    [POWER] = {.id = "power",
               .signal = "detector_power",
               .move = IMK_MOVE_SHIFT_Y,
               .reach = -CURVE_HEIGHT,
               .full = bright,
               .still = 0.26},
};

static double sagnac_phase(const void *design, const imk_schematic_moment *moment)
{
    return imk_fibre_optic_scale(design) * moment->exposure->angular_rate[0];
}

static double delay(const void *design, const imk_schematic_moment *moment)
{
    const imk_fibre_optic *d = design;
    return d->coil_length * d->coil_diameter * moment->exposure->angular_rate[0] /
           (light_speed * light_speed);
}

static double power(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_fibre_optic_instrument, "detector_power", moment);
}

static const imk_schematic_quantity quantities[] = {
    {"time delay of the waves", "Δt", "s", "s", "Δt = 4 N A Ω/c²", delay},
    {"Sagnac phase", "φ", "rad", "mrad", "φ = 8 π N A Ω/(λ c)", sagnac_phase},
    {"power on the detector", "P", "W", "uW", "P = ½ P_0 (1 + V cos(φ + δ))", power},
    {"Sagnac phase per rate", NULL, NULL, NULL, NULL, NULL},
    {"enclosed area", NULL, NULL, NULL, NULL, NULL},
    {"transit time", NULL, NULL, NULL, NULL, NULL},
    {"rate of a fringe", NULL, NULL, NULL, NULL, NULL},
    {"resets of the ramp per rate", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -60, 60, "deg/s", false},        {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 70, "degC", false},  {"coil.length", 200, 1000, NULL, true},
    {"coil.diameter", 100, 320, NULL, false}, {"modulator.depth", 60, 130, NULL, false},
    {"loop.gain", 0.02, 0.8, NULL, true},
};

/* A period of the modulation. */
static double cycle(const void *design)
{
    return 2 * imk_fibre_optic_transit_time(design);
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_coil(imki_drawing *d)
{
    static const char *const clockwise =
        "M282 100C325 100 350 50 430 50A82 82 0 0 1 430 214C350 214 325 124 282 124";
    static const char *const counter =
        "M282 106C328 106 354 57 430 57A75 75 0 0 1 430 207C354 207 328 118 282 118";
    for (int k = 0; k < 4; k++)
        imki_draw_circle(d, "thin", 430, 132, 50 + 5 * k);
    imki_part_begin(d, CLOCKWISE);
    imki_dashes_begin(d, 17, 7);
    imki_draw_path(d, "one", clockwise);
    imki_group_end(d);
    imki_part_end(d);
    imki_part_begin(d, COUNTER);
    imki_dashes_begin(d, 17, 7);
    imki_draw_path(d, "two", counter);
    imki_group_end(d);
    imki_part_end(d);
    imki_draw_turn(d, "line", 430, 132, 30, -150, 60);
    imki_draw_text(d, IMKI_MIDDLE, 428, 140, "Ω");
}

/* Source, detector, and what divides the light. */
static void draw_optics(imki_drawing *d)
{
    imki_draw_path(d, "line", "M106 82C130 82 130 106 148 108H200M106 142C130 142 130 116 148 116");
    imki_draw_box(d, "body", 10, 66, 96, 32, 4);
    imki_draw_text(d, IMKI_MIDDLE, 58, 89, "source");
    imki_draw_box(d, "body", 10, 126, 96, 32, 4);
    imki_part_begin(d, LIGHT);
    imki_draw_box(d, "glowing", 10, 126, 96, 32, 4);
    imki_part_end(d);
    imki_draw_text(d, IMKI_MIDDLE, 58, 149, "detector");
    imki_draw_box(d, "glass", 142, 102, 32, 20, 3);
    imki_draw_box(d, "glass", 200, 84, 82, 56, 3);
    imki_draw_path(d, "line",
                   "M200 112H218C234 112 232 100 246 100H282M218 112C234 112 232 124 "
                   "246 124H282");
    imki_draw_box(d, "fill-one", 248, 90, 28, 5, 1);
    imki_draw_box(d, "fill-one", 248, 129, 28, 5, 1);
}

static void draw_electronics(imki_drawing *d, bool closed)
{
    imki_draw_box(d, "field", 208, 180, 66, 30, 3);
    imki_draw_text(d, IMKI_MIDDLE, 241, 202, closed ? "ramp" : "sine");
    imki_draw_arrow(d, "line", 241, 180, 241, 142);
    if (closed) {
        imki_draw_line(d, "line", 58, 158, 58, 195);
        imki_draw_arrow(d, "line", 58, 195, 206, 195);
    } else {
        imki_draw_arrow(d, "line", 58, 158, 58, 204);
    }
    imki_draw_text(d, IMKI_START, 66, 188, closed ? "loop" : "output");
}

/* Power against phase. */
static void draw_curve(imki_drawing *d, double visibility)
{
    double points[2 * 81];
    for (int i = 0; i <= 80; i++) {
        const double phase = (i - 40) / 40.0 * 2 * pi;
        points[2 * i] = CURVE_X + (i - 40) / 40.0 * CURVE_HALF;
        points[2 * i + 1] =
            CURVE_Y - CURVE_HEIGHT * (1 + visibility * imk_cos(phase)) / (1 + visibility);
    }
    imki_draw_arrow(d, "thin", CURVE_X - CURVE_HALF, CURVE_Y, CURVE_X + CURVE_HALF + 14, CURVE_Y);
    imki_draw_arrow(d, "thin", CURVE_X, CURVE_Y, CURVE_X, CURVE_Y - CURVE_HEIGHT - 22);
    imki_draw_polygon(d, "line", 81, points, false);
    imki_draw_text(d, IMKI_END, CURVE_X - 8, CURVE_Y - CURVE_HEIGHT - 8, "P");
    imki_draw_text(d, IMKI_START, CURVE_X + CURVE_HALF + 18, CURVE_Y + 7, "φ + δ");
    imki_part_begin(d, PHASE);
    imki_part_begin(d, POWER);
    imki_draw_circle(d, "fill-accent", CURVE_X, CURVE_Y, 7);
    imki_part_end(d);
    imki_part_end(d);
}

static void draw(imki_drawing *d, const void *design)
{
    const imk_fibre_optic *gyro = design;
    draw_coil(d);
    draw_optics(d);
    draw_electronics(d, gyro->loop == IMK_FIBRE_OPTIC_CLOSED);
    draw_curve(d, gyro->visibility);
    imki_draw_label(d, IMKI_MIDDLE, 158, 58, "coupler", 158, 65, 158, 101);
    imki_draw_label(d, IMKI_START, 222, 58, "modulator", 262, 65, 262, 91);
    imki_draw_label(d, IMKI_START, 396, 244, "coil, N turns", 460, 227, 468, 206);
    imki_draw_text(d, IMKI_END, 530, 278, "Δt = 4NAΩ/c²");
    imki_draw_text(d, IMKI_END, 530, 308, "φ = 8πNAΩ/λc");
}

const imk_schematic imki_schematic_fibre_optic = {
    .instrument = &imk_fibre_optic_instrument,
    .description =
        "Light of a source is divided and runs both ways through a coil of fibre, past a phase "
        "modulator, and back to a detector. A curve shows the power on the detector against the "
        "phase between the two waves, with the operating point that the modulation moves.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 2,
    .cycles = 3,
    .settle = 2e-3,
    .input = 10 * 3.14159265358979323846 / 180,
    .draw = draw,
};
