/* SPDX-License-Identifier: Apache-2.0 */
/* The ring laser gyro: a block with its beams on the dither spring, and the fringes. */
#include "schematic_internal.h"

#include "imukit/elementary.h"
#include "imukit/ring_laser.h"

#include <math.h>

static const double pi = 3.14159265358979323846, light_speed = 299792458.0;

/* ---- the tables ------------------------------------------------------------------------------ */

enum { BODY, CLOCKWISE, COUNTER, FRINGES, PARTS };

static double dither_angle(const void *design)
{
    return imk_ring_laser_dither_angle(design);
}

static double one_fringe(const void *design)
{
    (void)design;
    return 2 * pi;
}

/* Along the beams, and between two fringes [px]. */
static const double dash = 17, gap = 7;
enum { FRINGE = 28 };

static const imk_schematic_part parts[PARTS] = {
    [BODY] = {.id = "body",
              .signal = "dither_angle",
              .move = IMK_MOVE_TURN,
              .x = 170,
              .y = 212,
              .reach = 5.5,
              .full = dither_angle,
              .still = 0.5},
    [CLOCKWISE] = {.id = "clockwise", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = -36},
    [COUNTER] = {.id = "counterclockwise", .signal = "screen", .move = IMK_MOVE_FLOW, .reach = 36},
    [FRINGES] = {.id = "fringes",
                 .signal = "phase",
                 .move = IMK_MOVE_FLOW,
                 .reach = -FRINGE,
                 .full = one_fringe},
};

static double delay(const void *design, const imk_schematic_moment *moment)
{
    return 4 * imk_ring_laser_area(design) * moment->exposure->angular_rate[0] /
           (light_speed * light_speed);
}

static double beat(const void *design, const imk_schematic_moment *moment)
{
    return imk_ring_laser_fringes_per_radian(design) * moment->exposure->angular_rate[0];
}

static double dithered_beat(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_ring_laser_instrument, "beat_frequency", moment);
}

static const imk_schematic_quantity quantities[] = {
    {"enclosed area", NULL, NULL, NULL, NULL, NULL},
    {"time delay of the beams", "Δt", "s", "s", "Δt = 4AΩ/c²", delay},
    {"scale factor, beat frequency per rate", NULL, NULL, NULL, NULL, NULL},
    {"beat frequency by the rate", "Δf", "Hz", "Hz", "Δf = 4AΩ/(λP)", beat},
    {"beat frequency with the dither", "f", "Hz", "kHz", "f = S (Ω + Ω_d cos ωt) − pull",
     dithered_beat},
    {"lock-in frequency", NULL, NULL, NULL, NULL, NULL},
    {"lock-in dead band that is left, half width", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -100, 100, "deg/s", false},         {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 70, "degC", false},     {"cavity.perimeter", 4, 130, "cm", true},
    {"lock_in.rate", 10, 3600, "deg/h", true},   {"dither.rate", 30, 300, "deg/s", false},
    {"dither.frequency", 300, 900, "Hz", false},
};

/* A cycle of the dither; without it some fringes at the lock-in rate. */
static double cycle(const void *design)
{
    const imk_ring_laser *d = design;
    const double fringes = imk_ring_laser_fringes_per_radian(d), slow = pi / 18;
    if (d->dither.rate > 0)
        return 1 / d->dither.frequency;
    return 40 / (fringes * (d->lock_in.rate > 0 ? d->lock_in.rate : slow));
}

/* ---- the drawing ----------------------------------------------------------------------------- */

/* The middle of the ring, the mirrors from it, and half the width of the block beyond the beams. */
static const double middle_x = 170, middle_y = 212, mirror = 108, wall = 27;

typedef struct ring {
    int corners;
    double first, half; /* direction of the first corner; half of the angle between two [rad] */
} ring;

static ring ring_of(const imk_ring_laser *design)
{
    if (design->cavity.shape == IMK_RING_LASER_SQUARE)
        return (ring){4, pi / 4, pi / 4};
    return (ring){3, pi / 6, pi / 3}; /* the first to the lower right, the last one on top */
}

static double direction(const ring *r, int corner)
{
    return r->first + 2 * r->half * corner;
}

static void draw_block(imki_drawing *d, const ring *r)
{
    double points[16];
    const double face = mirror + 6;
    const double aside =
        ((mirror - face) * imk_cos(r->half) + wall) / imk_sin(r->half); /* of a corner's face */
    for (int k = 0; k < r->corners; k++) {
        const double x = imk_cos(direction(r, k)), y = imk_sin(direction(r, k));
        points[4 * k] = middle_x + face * x + aside * y;
        points[4 * k + 1] = middle_y + face * y - aside * x;
        points[4 * k + 2] = middle_x + face * x - aside * y;
        points[4 * k + 3] = middle_y + face * y + aside * x;
    }
    imki_draw_polygon(d, "body", 2 * (size_t)r->corners, points, true);
}

static void draw_beam(imki_drawing *d, const ring *r, size_t part, const char *class, double radius)
{
    double points[10];
    for (int k = 0; k <= r->corners; k++) {
        points[2 * k] = middle_x + radius * imk_cos(direction(r, k));
        points[2 * k + 1] = middle_y + radius * imk_sin(direction(r, k));
    }
    imki_part_begin(d, part);
    imki_dashes_begin(d, dash, gap);
    imki_draw_polygon(d, class, (size_t)r->corners + 1, points, false);
    imki_group_end(d);
    imki_part_end(d);
}

/* Which way a beam goes round: a head on the side that is opposite to the second corner. */
static void draw_way(imki_drawing *d, const ring *r, const char *class, double radius, int way)
{
    const double side = direction(r, r->corners - 1) + r->half, out = radius * imk_cos(r->half);
    const double x = -way * imk_sin(side), y = way * imk_cos(side), on = way * 34;
    imki_draw_head(d, class, middle_x + out * imk_cos(side) - on * imk_sin(side),
                   middle_y + out * imk_sin(side) + on * imk_cos(side), x, y);
}

/* The cathode below, the anodes on the sides next to it. */
static void draw_electrodes(imki_drawing *d, const ring *r)
{
    const double out = mirror * imk_cos(r->half) + wall;
    const double turns[] = {0, r->corners == 3 ? 120 : 90, r->corners == 3 ? 240 : 270};
    for (int k = 0; k < 3; k++) {
        imki_turned_begin(d, turns[k], middle_x, middle_y);
        imki_draw_box(d, "field", middle_x - 13, middle_y + out, 26, 10, 2);
        imki_group_end(d);
    }
}

/* Mirrors; a prism and a detector behind the first one, a piezo behind the second. */
static void draw_mirrors(imki_drawing *d, const ring *r)
{
    for (int k = 0; k < r->corners; k++) {
        const double x = middle_x + mirror + 6, y = middle_y;
        imki_turned_begin(d, direction(r, k) * 180 / pi, middle_x, middle_y);
        imki_draw_box(d, "glass", x, y - 21, 11, 42, 0);
        if (k == 0) {
            const double prism[] = {x + 11, y - 18, x + 28, y, x + 11, y + 18};
            imki_draw_polygon(d, "glass", 3, prism, true);
            imki_draw_box(d, "fill-accent", x + 32, y - 10, 8, 20, 1);
        } else if (k == 1) {
            imki_draw_box(d, "field", x + 11, y - 9, 16, 18, 0);
        }
        imki_group_end(d);
    }
}

static void draw_spring(imki_drawing *d)
{
    const double hole = 38, hub = 14;
    imki_draw_circle(d, "paper edge", middle_x, middle_y, hole);
    for (int k = 0; k < 3; k++) {
        const double x = imk_cos(pi / 2 + k * 2 * pi / 3), y = imk_sin(pi / 2 + k * 2 * pi / 3);
        imki_draw_line(d, "spring", middle_x + hub * x, middle_y + hub * y, middle_x + hole * x,
                       middle_y + hole * y);
    }
}

/* What the detector sees. */
static void draw_fringes(imki_drawing *d)
{
    imki_window_begin(d, "fringe-window", 372, 252, 156, 46);
    imki_part_begin(d, FRINGES);
    imki_dashes_begin(d, FRINGE / 2.0, FRINGE / 2.0);
    imki_draw_line(d, "accent wide", 344, 275, 560, 275);
    imki_group_end(d);
    imki_part_end(d);
    imki_group_end(d);
    imki_draw_box(d, "line", 372, 252, 156, 46, 0);
    imki_draw_text(d, IMKI_START, 372, 242, "fringes");
    imki_draw_text(d, IMKI_START, 372, 326, "Δf = 4AΩ/λP");
}

static void draw_names(imki_drawing *d, const ring *r)
{
    const double detector = mirror + 6 + 36;
    imki_draw_line(d, "thin", middle_x + detector * imk_cos(r->first) + 8,
                   middle_y + detector * imk_sin(r->first), 372, 275);
    imki_draw_turn(d, "line", middle_x, middle_y, 150, -62, -20);
    imki_draw_text(d, IMKI_START, 290, 96, "Ω");
    imki_draw_line(d, "one", 372, 66, 396, 66);
    imki_draw_text(d, IMKI_START, 404, 73, "CW beam");
    imki_draw_line(d, "two", 372, 94, 396, 94);
    imki_draw_text(d, IMKI_START, 404, 101, "CCW beam");
    const double last = r->first + 2 * r->half * (r->corners - 1);
    imki_draw_label(d, IMKI_START, 12, 84, "mirror", 82, 80,
                    middle_x + (mirror + 11) * imk_cos(last) - 12,
                    middle_y + (mirror + 11) * imk_sin(last));
    imki_draw_label(d, IMKI_START, 372, 186, "dither spring", 368, 180, middle_x + 26,
                    middle_y - 14);
    imki_draw_label(d, IMKI_START, 372, 146, "glass block", 368, 140, middle_x + 52, middle_y - 44);
    imki_draw_label(d, IMKI_START, 292, 334, "prism", 304, 317,
                    middle_x + (mirror + 22) * imk_cos(r->first),
                    middle_y + (mirror + 22) * imk_sin(r->first));
    const double second = r->first + 2 * r->half;
    imki_draw_label(d, IMKI_START, 12, 362, "path length control", 44, 343,
                    middle_x + (mirror + 26) * imk_cos(second),
                    middle_y + (mirror + 26) * imk_sin(second));
    imki_draw_label(d, IMKI_START, 236, 362, "cathode", 246, 348, middle_x + 8,
                    middle_y + mirror * imk_cos(r->half) + wall + 7);
    imki_magnified(d, BODY, IMKI_END, 530, 390, "dither");
}

static void draw(imki_drawing *d, const void *design)
{
    const ring r = ring_of(design);
    imki_part_begin(d, BODY);
    draw_block(d, &r);
    draw_electrodes(d, &r);
    draw_mirrors(d, &r);
    draw_beam(d, &r, CLOCKWISE, "one", mirror + 3);
    draw_beam(d, &r, COUNTER, "two", mirror - 7);
    draw_way(d, &r, "one", mirror + 3, 1);
    draw_way(d, &r, "two", mirror - 7, -1);
    draw_spring(d);
    imki_part_end(d);
    imki_draw_circle(d, "line", middle_x, middle_y, 14);
    imki_draw_text(d, IMKI_MIDDLE, middle_x, 166, "A");
    draw_fringes(d);
    draw_names(d, &r);
}

const imk_schematic imki_schematic_ring_laser = {
    .instrument = &imk_ring_laser_instrument,
    .description =
        "A block of glass with a closed path between mirrors. Two laser beams run round it in "
        "opposite directions. A spring in the middle lets the block dither. Behind one mirror a "
        "prism brings both beams to a detector, on which fringes move.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 12,
    .cycles = 1,
    .input = 10 * 3.14159265358979323846 / 180,
    .draw = draw,
};
