/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro, cut open across the input axis x, which points out of the
 * sheet: y is to the right, z upwards. The case turns; the ball in it keeps its axis
 * as long as it spins. */
#include "schematic_internal.h"

#include "imukit/suspended_rotor.h"

/* ---- the tables ------------------------------------------------------------------------------ */

enum { CASE, KEEPS, SPINS, SPIN, STANDS, ALONG, FALLEN, PARTS };

#define MIDDLE_X 200
#define MIDDLE_Y 208
#define RADIUS 92
#define GAP 22      /* [px] */
#define ALONG_X 440 /* the small picture */
#define ALONG_Y 318
#define SMALL 20 /* radius of the ball in it */
#define RADIAN (180 / 3.14159265358979323846)

static double gap_of(const void *design)
{
    const imk_suspended_rotor *d = design;
    return d->gap;
}

static double full_spin(const void *design)
{
    const imk_suspended_rotor *d = design;
    return d->spin_rate;
}

/* A positive angle about x is counterclockwise in the sheet. What belongs to the spin fades with
 * it; a ball that stands is taken along by the case. */
static const imk_schematic_part parts[PARTS] = {
    [CASE] = {.id = "case",
              .signal = "turned",
              .move = IMK_MOVE_TURN,
              .x = MIDDLE_X,
              .y = MIDDLE_Y,
              .reach = -RADIAN},
    [KEEPS] = {.id = "keeps",
               .signal = "turned",
               .move = IMK_MOVE_TURN,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = RADIAN},
    [SPIN] = {.id = "spin", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -60},
    [SPINS] = {.id = "spins",
               .signal = "spin",
               .move = IMK_MOVE_GLOW,
               .reach = 1,
               .full = full_spin,
               .held = true,
               .still = 1},
    [STANDS] = {.id = "stands",
                .signal = "spin",
                .move = IMK_MOVE_GLOW,
                .reach = -1,
                .full = full_spin,
                .base = 1,
                .held = true,
                .still = 1},
    [FALLEN] =
        {.id = "fallen", .signal = "fallen", .move = IMK_MOVE_GLOW, .reach = 1, .held = true},
    [ALONG] = {.id = "along",
               .signal = "displacement_x",
               .move = IMK_MOVE_SHIFT_X,
               .reach = GAP,
               .full = gap_of,
               .held = true},
};

static double observed(const char *name, const imk_schematic_moment *moment)
{
    return imki_signal(&imk_suspended_rotor_instrument, name, moment);
}

static double along_y(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("axis_y", moment);
}

static double along_z(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("axis_z", moment);
}

static double drift(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("drift", moment);
}

static double momentum(const void *design, const imk_schematic_moment *moment)
{
    return imk_suspended_rotor_momentum(design) * (observed("spin", moment) / full_spin(design));
}

static double spin(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("spin", moment);
}

static const imk_schematic_quantity quantities[] = {
    {"angular momentum of the ball", "H", "kg*m^2/s", "kg*m^2/s", "H = C ω", momentum},
    {"direction cosine of the axis along y", "s_y", "1", "1", "s' = s × Ω + drift", along_y},
    {"direction cosine of the axis along z", "s_z", "1", "1", "s' = s × Ω + drift", along_z},
    {"drift by unbalance and shape", "Ω_d", "rad/s", "deg/h", "Ω_d = M/H", drift},
    {"speed of the ball", "ω", "rad/s", "rpm", "ω = H/C", spin},
    {"drift per torque", NULL, NULL, NULL, NULL, NULL},
    {"mass unbalance drift, force across the spin axis", NULL, NULL, NULL, NULL, NULL},
    {"touch-down force", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -90, 90, "deg/s", false},       {"acceleration", -30, 30, "g", false},
    {"temperature", -40, 80, "degC", false}, {"ball.unbalance", 0, 50, NULL, false},
    {"suspension.limit", 5, 50, NULL, true}, {"ball.oblateness", -100, 100, NULL, false},
    {"start.tilt", 0, 90, NULL, false},
};

static double cycle(const void *design)
{
    (void)design;
    return 8;
}

/* ---- the drawing ----------------------------------------------------------------------------- */

/* Two pairs of electrodes around the ball, in the insulator of the case. */
static void draw_case(imki_drawing *d)
{
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y, RADIUS + GAP + 34);
    imki_draw_circle(d, "paper", MIDDLE_X, MIDDLE_Y, RADIUS + GAP);
    imki_draw_circle(d, "line", MIDDLE_X, MIDDLE_Y, RADIUS + GAP);
    for (int k = 0; k < 4; k++) { /* radii 114 and 128, from -35 to 35 deg */
        imki_turned_begin(d, 90 * k, MIDDLE_X, MIDDLE_Y);
        imki_draw_path(d, "field",
                       "M134.6 114.6A114 114 0 0 1 265.4 114.6L273.4 103.1"
                       "A128 128 0 0 0 126.6 103.1Z");
        imki_group_end(d);
    }
    for (int k = 0; k < 8; k++) {
        imki_turned_begin(d, 45 * k, MIDDLE_X, MIDDLE_Y);
        imki_draw_line(d, "line", MIDDLE_X, MIDDLE_Y - 148, MIDDLE_X, MIDDLE_Y - (k ? 141 : 132));
        imki_group_end(d);
    }
}

static void draw_marks(imki_drawing *d)
{
    imki_dashes_begin(d, 3, 17);
    imki_draw_line(d, "rim-marks", MIDDLE_X - 86, MIDDLE_Y, MIDDLE_X + 86, MIDDLE_Y);
    imki_group_end(d);
}

static void draw_ball(imki_drawing *d)
{
    imki_draw_circle(d, "mass", MIDDLE_X, MIDDLE_Y, RADIUS);
    imki_part_begin(d, STANDS);
    draw_marks(d);
    imki_part_end(d);
    imki_part_begin(d, KEEPS);
    imki_part_begin(d, SPINS);
    imki_part_begin(d, SPIN);
    draw_marks(d);
    imki_part_end(d);
    imki_draw_line(d, "axis", MIDDLE_X, MIDDLE_Y + 112, MIDDLE_X, MIDDLE_Y - 60);
    imki_draw_arrow(d, "two", MIDDLE_X, MIDDLE_Y - 24, MIDDLE_X, MIDDLE_Y - 88);
    imki_part_end(d);
    imki_part_end(d);
}

/* A small picture of the gap along x, which the drawing does not show, with the stops. */
static void draw_along(imki_drawing *d, const imk_suspended_rotor *rotor)
{
    const double clear = GAP * rotor->clearance / rotor->gap;
    const double thick = GAP - clear < 5 ? GAP - clear : 5;
    for (int side = -1; side <= 1; side += 2) {
        const double electrode = ALONG_X + side * (SMALL + GAP),
                     stop = ALONG_X + side * (SMALL + clear);
        imki_draw_box(d, "field", side > 0 ? electrode : electrode - 8, ALONG_Y - 22, 8, 44, 1);
        imki_draw_box(d, "body", side > 0 ? stop : stop - thick, ALONG_Y - 8, thick, 16, 1);
    }
    imki_part_begin(d, ALONG);
    imki_draw_circle(d, "mass", ALONG_X, ALONG_Y, SMALL);
    imki_part_end(d);
    imki_draw_text(d, IMKI_MIDDLE, ALONG_X, ALONG_Y - 32, "gap along x");
}

static void draw(imki_drawing *d, const void *design)
{
    imki_part_begin(d, CASE);
    draw_case(d);
    draw_ball(d);
    imki_part_end(d);
    draw_along(d, design);
    imki_draw_label(d, IMKI_START, 372, 96, "electrode", 368, 92, 270, 104);
    imki_draw_label(d, IMKI_START, 372, 130, "ball, H = Cω", 368, 126, 262, 160);
    imki_draw_label(d, IMKI_START, 372, 164, "vacuum, gap", 368, 160, 304, 178);
    imki_draw_label(d, IMKI_START, 372, 198, "case, turns: Ω", 368, 194, 336, 198);
    imki_draw_text(d, IMKI_START, 372, 234, "input x: to you");
    imki_scale_bar(d, ALONG, ALONG_X, ALONG_Y + 34);
    imki_part_begin(d, FALLEN);
    imki_draw_text(d, IMKI_START, 150, 390, "the ball has fallen");
    imki_part_end(d);
    imki_draw_text(d, IMKI_END, 530, 66, "Ω = −s × s'");
}

const imk_schematic imki_schematic_suspended_rotor = {
    .instrument = &imk_suspended_rotor_instrument,
    .description =
        "A ball spins in a vacuum between electrodes that hold it by electric fields. The "
        "case with the electrodes turns about the line of sight, and the ball keeps the "
        "direction of its axis. A small picture shows where the ball is in its gap along "
        "the line of sight; too large a force lets it fall on its stop, where it loses its spin.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 8,
    .cycles = 1,
    .input = 30 * 3.14159265358979323846 / 180,
    .force = 15 * 9.80665,
    .sine = true,
    .draw = draw,
};
