/* SPDX-License-Identifier: Apache-2.0 */
/* The free gyro: a wheel in two gimbals that keeps its direction while the case turns, seen along
 * the outer axis, so that the case and the outer angle turn in the sheet; the inner angle is that
 * of a needle. */
#include "schematic_internal.h"

#include "imukit/earth.h"
#include "imukit/free_gyro.h"

/* ---- the tables ------------------------------------------------------------------------------ */

enum { CASE, OUTER, RIM, NEEDLE, PARTS };

#define MIDDLE_X 190
#define MIDDLE_Y 208
#define DEGREE (3.14159265358979323846 / 180)
#define PER_RADIAN (1 / DEGREE)
enum { STRIPE = 12 }; /* from one mark of the rim to the next [px] */

static double tenth_degree(const void *design)
{
    (void)design;
    return 0.1 * DEGREE;
}

/* x points out of the sheet: a positive turn is against the clock. */
static const imk_schematic_part parts[PARTS] = {
    [CASE] = {.id = "case",
              .signal = "turned",
              .move = IMK_MOVE_TURN,
              .x = MIDDLE_X,
              .y = MIDDLE_Y,
              .reach = -PER_RADIAN,
              .still = 0.2},
    [OUTER] = {.id = "outer-gimbal",
               .signal = "outer_angle",
               .move = IMK_MOVE_TURN,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = -PER_RADIAN,
               .still = -0.2},
    [RIM] = {.id = "rim", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -5 * STRIPE},
    [NEEDLE] = {.id = "inner-angle",
                .signal = "inner_angle",
                .move = IMK_MOVE_TURN,
                .x = 452,
                .y = 300,
                .reach = 10,
                .full = tenth_degree},
};

static double outer_angle(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_free_gyro_instrument, "outer_angle", moment);
}

static double inner_torque(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_free_gyro_instrument, "inner_torque", moment);
}

static double precession(const void *design, const imk_schematic_moment *moment)
{
    return -inner_torque(design, moment) / imk_free_gyro_momentum(design);
}

static const imk_schematic_quantity quantities[] = {
    {"angular momentum", NULL, NULL, NULL, NULL, NULL},
    {"outer angle", "α", "rad", "deg", "α' = −Ω − M/H", outer_angle},
    {"torque about the inner axis", "M", "N*m", "uNm", "M = m (d × f) + friction + error",
     inner_torque},
    {"precession under that torque", "Ω_p", "rad/s", "deg/h", "Ω_p = −M/H", precession},
    {"precession per torque", NULL, NULL, NULL, NULL, NULL},
    {"nutation frequency", NULL, NULL, NULL, NULL, NULL},
    {"torque to precess it at Earth's rate", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -60, 60, "deg/s", false},          {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 70, "degC", false},    {"spin.rate", 5000, 30000, NULL, false},
    {"torque.inner", -1e-4, 1e-4, NULL, false}, {"unbalance.z", -5, 5, NULL, false},
};

/* The case swings to and fro. */
static double cycle(const void *design)
{
    (void)design;
    return 6;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_case(imki_drawing *d)
{
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, 146);
    imki_draw_circle(d, "paper", MIDDLE_X, MIDDLE_Y, 122);
    for (int k = 0; k < 36; k++) {
        imki_turned_begin(d, 10 * k, MIDDLE_X, MIDDLE_Y);
        imki_draw_line(d, "line", MIDDLE_X, MIDDLE_Y - 122, MIDDLE_X,
                       MIDDLE_Y - (k % 9 == 0   ? 140
                                   : k % 3 == 0 ? 134
                                                : 129));
        imki_group_end(d);
    }
}

/* The outer gimbal is seen from the end of its axis: a bar with the bearings of the inner one. */
static void draw_outer(imki_drawing *d)
{
    imki_draw_box(d, "field", MIDDLE_X - 112, MIDDLE_Y - 12, 32, 24, 3);
    imki_draw_box(d, "field", MIDDLE_X + 80, MIDDLE_Y - 12, 32, 24, 3);
    imki_draw_line(d, "shaft", MIDDLE_X - 84, MIDDLE_Y, MIDDLE_X - 60, MIDDLE_Y);
    imki_draw_line(d, "shaft", MIDDLE_X + 60, MIDDLE_Y, MIDDLE_X + 84, MIDDLE_Y);
}

static void draw_wheel(imki_drawing *d)
{
    imki_draw_path(d, "body", "M120 126H260V290H120ZM132 138H248V278H132Z"); /* the inner gimbal */
    imki_draw_line(d, "shaft", MIDDLE_X, MIDDLE_Y - 70, MIDDLE_X, MIDDLE_Y + 70);
    imki_draw_box(d, "mass", MIDDLE_X - 54, MIDDLE_Y - 22, 108, 44, 4);
    imki_part_begin(d, RIM);
    imki_dashes_begin(d, 2, STRIPE - 2);
    imki_draw_line(d, "rim-marks", MIDDLE_X - 50, MIDDLE_Y, MIDDLE_X + 50, MIDDLE_Y);
    imki_group_end(d);
    imki_part_end(d);
    imki_draw_arrow(d, "two", MIDDLE_X, MIDDLE_Y - 22, MIDDLE_X, MIDDLE_Y - 114);
}

static void draw_inner_dial(imki_drawing *d)
{
    imki_draw_path(d, "line", "M403.2 265.8A60 60 0 0 1 500.8 265.8");
    for (int k = -1; k <= 1; k++) {
        imki_turned_begin(d, 45 * k, 452, 300);
        imki_draw_line(d, "line", 452, 240, 452, 248);
        imki_group_end(d);
    }
    imki_part_begin(d, NEEDLE);
    imki_draw_arrow(d, "accent", 452, 300, 452, 248);
    imki_part_end(d);
    imki_draw_circle(d, "fill-accent", 452, 300, 5);
    imki_magnified(d, NEEDLE, IMKI_MIDDLE, 446, 330, "inner angle");
}

static void draw(imki_drawing *d, const void *design)
{
    (void)design;
    imki_part_begin(d, CASE);
    draw_case(d);
    imki_part_begin(d, OUTER);
    draw_outer(d);
    draw_wheel(d);
    imki_draw_polygon(d, "fill-accent", 3,
                      (const double[]){MIDDLE_X, MIDDLE_Y - 128, MIDDLE_X - 8, MIDDLE_Y - 114,
                                       MIDDLE_X + 8, MIDDLE_Y - 114},
                      true);
    imki_part_end(d);
    imki_part_end(d);
    draw_inner_dial(d);
    imki_draw_turn(d, "one", MIDDLE_X, MIDDLE_Y, 158, -32, -62);
    imki_draw_text(d, IMKI_START, 316, 92, "Ω of the case");
    imki_draw_label(d, IMKI_START, 366, 128, "outer pickoff", 362, 124, 198, 92);
    imki_draw_label(d, IMKI_START, 366, 160, "wheel H = Iω", 362, 156, 222, 196);
    imki_draw_label(d, IMKI_START, 366, 192, "outer gimbal", 362, 188, 290, 204);
    imki_draw_label(d, IMKI_START, 366, 224, "inner gimbal", 362, 220, 255, 250);
    imki_draw_text(d, IMKI_END, 530, 390, "Ω_p = M/H");
}

const imk_schematic imki_schematic_free_gyro = {
    .instrument = &imk_free_gyro_instrument,
    .description = "A spinning wheel in an inner gimbal, which hangs in an outer gimbal, seen "
                   "along the outer axis. The case with its scale turns; the wheel keeps its "
                   "direction, so a pointer on the outer gimbal shows how far the case has turned.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 6,
    .cycles = 1,
    .input = 30 * DEGREE,
    .sine = true,
    .draw = draw,
};
