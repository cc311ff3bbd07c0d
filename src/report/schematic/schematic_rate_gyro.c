/* SPDX-License-Identifier: Apache-2.0 */
/* The spring-restrained rate gyro: a wheel in one gimbal, seen from in front and above.
 *
 * The output axis lies in the sheet. A point at z along the spin axis and x along the input axis is
 * drawn at z sin(e + th) - x cos(e + th) below the middle, where e is the height of the view and th
 * the angle of the gimbal: a stretch of the gimbal, and one of the wheel, that are linear for small
 * angles. */
#include "schematic_internal.h"

#include "imukit/rate_gyro.h"

/* ---- the tables ------------------------------------------------------------------------------ */

enum { NEEDLE, BACK, ROTOR, SPIN, FRONT, PARTS };

#define MIDDLE_X 205
#define MIDDLE_Y 190
/* Height of the view, 25 deg. */
#define SINE 0.42
#define COSINE 0.91
#define DEGREE (3.14159265358979323846 / 180)

static double largest_angle(const void *design)
{
    const imk_rate_gyro *d = design;
    return d->stop;
}

static const imk_schematic_part parts[PARTS] = {
    [NEEDLE] = {.id = "needle",
                .signal = "gimbal_angle",
                .move = IMK_MOVE_TURN,
                .x = 455,
                .y = 336,
                .reach = 55,
                .full = largest_angle},
    [BACK] = {.id = "gimbal-back",
              .signal = "gimbal_angle",
              .move = IMK_MOVE_STRETCH_Y,
              .x = MIDDLE_X,
              .y = MIDDLE_Y,
              .reach = COSINE * DEGREE,
              .with = "needle",
              .base = SINE},
    [ROTOR] = {.id = "rotor",
               .signal = "gimbal_angle",
               .move = IMK_MOVE_STRETCH_Y,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = -SINE * DEGREE,
               .with = "needle",
               .base = COSINE},
    [SPIN] = {.id = "spin",
              .signal = "screen",
              .move = IMK_MOVE_TURN,
              .x = MIDDLE_X,
              .y = MIDDLE_Y + 9,
              .reach = 90},
    [FRONT] = {.id = "gimbal-front",
               .signal = "gimbal_angle",
               .move = IMK_MOVE_STRETCH_Y,
               .x = MIDDLE_X,
               .y = MIDDLE_Y,
               .reach = COSINE * DEGREE,
               .with = "needle",
               .base = SINE},
};

static double torque(const void *design, const imk_schematic_moment *moment)
{
    const imk_rate_gyro *d = design;
    return d->momentum * (1 + d->momentum_error) * moment->exposure->angular_rate[0];
}

static double angle(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_rate_gyro_instrument, "gimbal_angle", moment);
}

/* The signal is the torque that the bar withstands. */
static double spring(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return -imki_signal(&imk_rate_gyro_instrument, "spring_torque", moment);
}

static double held_rate(const void *design, const imk_schematic_moment *moment)
{
    const imk_rate_gyro *d = design;
    return -spring(design, moment) / (d->momentum * (1 + d->momentum_error));
}

static const imk_schematic_quantity quantities[] = {
    {"angular momentum", NULL, NULL, NULL, NULL, NULL},
    {"gyroscopic torque", "M", "N*m", "uNm", "M = H Ω", torque},
    {"torque of the torsion bar", "M_k", "N*m", "uNm", "M_k = −k θ", spring},
    {"precession under that torque", "Ω_p", "rad/s", "deg/s", "Ω_p = −M_k/H", held_rate},
    {"gimbal angle", "θ", "rad", "deg", "I θ'' + c θ' + k θ = H Ω", angle},
    {"gimbal angle per rate", NULL, NULL, NULL, NULL, NULL},
    {"natural frequency", NULL, NULL, NULL, NULL, NULL},
    {"damping ratio", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"rate", -250, 250, "deg/s", false},         {"acceleration", -10, 10, "g", false},
    {"temperature", -40, 70, "degC", false},     {"wheel.momentum", 3e-4, 2e-3, NULL, true},
    {"spring.stiffness", 0.04, 0.4, NULL, true}, {"gimbal.damping", 0, 2e-3, NULL, false},
};

/* Eight periods of the gimbal. */
static double cycle(const void *design)
{
    return 8 * 2 * 3.14159265358979323846 / imk_rate_gyro_natural_frequency(design);
}

/* ---- the drawing ----------------------------------------------------------------------------- */

/* Half of the gimbal and of the shaft in it. */
static void draw_gimbal(imki_drawing *d, size_t part, bool front)
{
    imki_part_begin(d, part);
    imki_draw_line(d, "shaft", MIDDLE_X, MIDDLE_Y + (front ? 20 : -20), MIDDLE_X,
                   MIDDLE_Y + (front ? 100 : -100));
    imki_draw_path(d, "body",
                   front ? "M95 190A110 110 0 0 0 315 190H301A96 96 0 0 1 109 190Z"
                         : "M95 190A110 110 0 0 1 315 190H301A96 96 0 0 0 109 190Z");
    imki_part_end(d);
}

static void draw_rotor(imki_drawing *d)
{
    imki_part_begin(d, ROTOR);
    imki_draw_circle(d, "mass", MIDDLE_X, MIDDLE_Y - 9, 74);
    imki_draw_box(d, "mass rim", MIDDLE_X - 74, MIDDLE_Y - 9, 148, 18, 0);
    imki_draw_circle(d, "mass", MIDDLE_X, MIDDLE_Y + 9, 74);
    imki_draw_circle(d, "thin", MIDDLE_X, MIDDLE_Y + 9, 56);
    imki_part_begin(d, SPIN);
    for (int k = 0; k < 3; k++) {
        imki_turned_begin(d, 120 * k, MIDDLE_X, MIDDLE_Y + 9);
        imki_draw_line(d, "thin", MIDDLE_X, MIDDLE_Y - 7, MIDDLE_X, MIDDLE_Y - 47);
        imki_group_end(d);
    }
    imki_part_end(d);
    imki_draw_circle(d, "body", MIDDLE_X, MIDDLE_Y + 9, 16);
    imki_part_end(d);
}

/* The gimbal's shaft with torsion bar, damper and pickoff. */
static void draw_shaft(imki_drawing *d)
{
    imki_draw_anchor(d, 34, 168, 34, 212);
    imki_draw_spring(d, 34, MIDDLE_Y, 95, MIDDLE_Y, 6, 8);
    imki_draw_line(d, "shaft", 315, MIDDLE_Y, 402, MIDDLE_Y);
    imki_draw_box(d, "glass", 334, 172, 30, 36, 3);
    imki_draw_box(d, "field", 378, 174, 24, 32, 3);
}

static void draw_dial(imki_drawing *d)
{
    imki_draw_path(d, "line", "M398.6 296.5A69 69 0 0 1 511.4 296.5");
    for (int k = -2; k <= 2; k++) {
        imki_turned_begin(d, 27 * k, 455, 336);
        imki_draw_line(d, "line", 455, 267, 455, 275);
        imki_group_end(d);
    }
    imki_part_begin(d, NEEDLE);
    imki_draw_arrow(d, "accent", 455, 336, 455, 274);
    imki_part_end(d);
    imki_draw_circle(d, "fill-accent", 455, 336, 5);
}

static void draw(imki_drawing *d, const void *design)
{
    (void)design;
    imki_draw_line(d, "axis", 12, MIDDLE_Y, 425, MIDDLE_Y);
    imki_draw_text(d, IMKI_START, 432, 197, "output y");
    imki_draw_line(d, "axis", MIDDLE_X, 60, MIDDLE_X, 300);
    draw_gimbal(d, BACK, false);
    draw_shaft(d);
    draw_rotor(d);
    draw_gimbal(d, FRONT, true);
    imki_draw_turn(d, "one", MIDDLE_X, 84, 22, 130, 400);
    imki_draw_text(d, IMKI_START, 240, 70, "input x: Ω");
    imki_draw_arrow(d, "two", MIDDLE_X, 240, MIDDLE_X, 312);
    imki_draw_text(d, IMKI_START, 216, 312, "spin z: H = Iω");
    draw_dial(d);
    imki_draw_label(d, IMKI_START, 12, 132, "torsion bar k", 48, 140, 60, 180);
    imki_draw_label(d, IMKI_START, 12, 262, "gimbal", 52, 244, 108, 212);
    imki_draw_label(d, IMKI_START, 322, 106, "rotor", 318, 102, 258, 150);
    imki_draw_label(d, IMKI_START, 372, 146, "damper c", 368, 142, 350, 176);
    imki_draw_label(d, IMKI_START, 416, 236, "pickoff", 412, 230, 391, 203);
    imki_draw_text(d, IMKI_END, 530, 366, "θ = HΩ/k");
    imki_magnified(d, NEEDLE, IMKI_END, 530, 390, "angle θ");
}

const imk_schematic imki_schematic_rate_gyro = {
    .instrument = &imk_rate_gyro_instrument,
    .description = "A spinning wheel in a gimbal. When the case turns about the input axis, the "
                   "gyroscopic torque turns the gimbal about the output axis, against a torsion "
                   "bar and a damper, until the torques balance. A pickoff measures the angle.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 5,
    .cycles = 1,
    .input = 150 * DEGREE,
    .sine = true,
    .draw = draw,
};
