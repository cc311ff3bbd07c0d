/* SPDX-License-Identifier: Apache-2.0 */
/* The pendulous servo accelerometer, seen along its hinge: the pendulum hangs between magnets and
 * pickoff plates, and the torquer's coils on it hold it upright. */
#include "schematic_internal.h"

#include "imukit/pendulous_servo.h"

#include <math.h>

/* ---- the tables ------------------------------------------------------------------------------ */

enum { PENDULUM, CURRENT, PARTS };

#define HINGE_X 215
#define HINGE_Y 88
#define LARGEST (20 * 9.80665) /* specific force of the drawing [m/s^2] */

/* The angle by a force of 20 g that comes as fast as the loop answers. */
static double largest_angle(const void *design)
{
    const imk_pendulous_servo *d = design;
    return d->pendulosity * LARGEST / (d->proportional + d->hinge_stiffness);
}

static double largest_torque(const void *design)
{
    const imk_pendulous_servo *d = design;
    return d->pendulosity * LARGEST;
}

static const imk_schematic_part parts[PARTS] = {
    [PENDULUM] = {.id = "pendulum",
                  .signal = "angle",
                  .move = IMK_MOVE_TURN,
                  .x = HINGE_X,
                  .y = HINGE_Y,
                  .reach = 7,
                  .full = largest_angle},
    [CURRENT] = {.id = "torque",
                 .signal = "torque",
                 .move = IMK_MOVE_STRETCH_X,
                 .x = HINGE_X,
                 .y = 340,
                 .reach = 1,
                 .full = largest_torque,
                 .still = 0.4},
};

static double observed(const char *name, const imk_schematic_moment *moment)
{
    return imki_signal(&imk_pendulous_servo_instrument, name, moment);
}

static double angle(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("angle", moment);
}

static double torque(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return observed("torque", moment);
}

static double current(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_pendulous_servo_instrument, "current", moment);
}

static double load(const void *design, const imk_schematic_moment *moment)
{
    const imk_pendulous_servo *d = design;
    return d->pendulosity * moment->exposure->specific_force[0];
}

static const imk_schematic_quantity quantities[] = {
    {"torque of the force on the pendulum", "M_f", "N*m", "uN*m", "M_f = P f", load},
    {"torque of the torquer", "M_c", "N*m", "uN*m", "M_c = K_p φ + K_i ∫φ dt", torque},
    {"current", "i", "A", "mA", "i = M_c/K_t", current},
    {"deflection", "φ", "rad", "urad", "J φ'' + b φ' + K_h φ = P f − M_c", angle},
    {"scale factor of the current", NULL, NULL, NULL, NULL, NULL},
    {"pendulosity, torque per specific force", NULL, NULL, NULL, NULL, NULL},
    {"natural frequency of the loop", NULL, NULL, NULL, NULL, NULL},
    {"largest specific force of the torquer", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"acceleration", -30, 30, "g", false},        {"rate", -360, 360, "deg/s", false},
    {"temperature", -40, 95, "degC", false},      {"controller.proportional", 0.5, 1.5, NULL, true},
    {"controller.integral", 20, 230, NULL, true}, {"pendulum.damping", 2e-4, 6e-4, NULL, true},
    {"hinge.torque", -1e-6, 1e-6, NULL, false},
};

/* Sixteen periods of the loop. */
static double cycle(const void *design)
{
    return 16 / imk_pendulous_servo_frequency(design);
}

/* ---- the drawing ----------------------------------------------------------------------------- */

static void draw_case(imki_drawing *d)
{
    imki_draw_path(d, "body", "M60 50H370V358H60ZM76 66H354V342H76Z");
    imki_draw_anchor(d, HINGE_X - 26, 66, HINGE_X + 26, 66);
    imki_draw_line(d, "spring", HINGE_X, 66, HINGE_X, 104); /* the flexure */
    imki_draw_box(d, "field", 92, 196, 50, 60, 3);
    imki_draw_box(d, "field", 288, 196, 50, 60, 3);
    imki_draw_text(d, IMKI_MIDDLE, 117, 233, "N S");
    imki_draw_text(d, IMKI_MIDDLE, 313, 233, "S N");
    imki_draw_box(d, "fill-accent", HINGE_X - 32, 284, 6, 40, 1);
    imki_draw_box(d, "fill-accent", HINGE_X + 26, 284, 6, 40, 1);
}

static void draw_pendulum(imki_drawing *d)
{
    imki_part_begin(d, PENDULUM);
    imki_draw_box(d, "mass", HINGE_X - 7, 102, 14, 222, 3);
    imki_draw_box(d, "mass", HINGE_X - 26, 148, 52, 36, 4);
    imki_draw_text(d, IMKI_MIDDLE, HINGE_X, 173, "m");
    for (int side = -1; side <= 1; side += 2) /* windings around both ends of the magnets */
        for (int k = 0; k < 4; k++)
            imki_draw_box(d, "fill-one", HINGE_X + side * (22 + 12 * k) - 4, 216, 8, 20, 3);
    imki_draw_line(d, "one", HINGE_X - 62, 226, HINGE_X + 62, 226);
    imki_part_end(d);
}

/* From the pickoff to the coils. */
static void draw_loop(imki_drawing *d)
{
    imki_draw_line(d, "line", HINGE_X + 32, 304, 424, 304);
    imki_draw_arrow(d, "line", 424, 304, 424, 264);
    imki_draw_box(d, "glass", 384, 214, 84, 50, 5);
    imki_draw_text(d, IMKI_MIDDLE, 426, 246, "servo");
    imki_draw_line(d, "one", 424, 214, 424, 120);
    imki_draw_arrow(d, "one", 424, 120, HINGE_X + 10, 120);
    imki_draw_text(d, IMKI_START, 434, 150, "current i");
}

static void draw(imki_drawing *d, const void *design)
{
    (void)design;
    draw_case(d);
    draw_pendulum(d);
    draw_loop(d);
    imki_part_begin(d, CURRENT);
    imki_draw_box(d, "fill-one", HINGE_X, 329, 70, 10, 0);
    imki_part_end(d);
    imki_draw_label(d, IMKI_START, 384, 74, "hinge K_h", 380, 68, HINGE_X + 2, 82);
    imki_draw_label(d, IMKI_START, 384, 330, "pickoff φ", 380, 325, HINGE_X + 29, 316);
    imki_draw_label(d, IMKI_START, 380, 196, "coil", 376, 190, 256, 216);
    imki_draw_text(d, IMKI_MIDDLE, 117, 186, "magnet");
    imki_draw_text(d, IMKI_END, 174, 338, "torque");
    imki_draw_arrow(d, "two", 458, 362, 528, 362);
    imki_draw_text(d, IMKI_END, 450, 369, "force f");
    imki_draw_text(d, IMKI_END, 530, 390, "i = f P/K_t");
    imki_magnified(d, PENDULUM, IMKI_MIDDLE, 320, 390, "φ");
}

const imk_schematic imki_schematic_pendulous_servo = {
    .instrument = &imk_pendulous_servo_instrument,
    .description =
        "A pendulum hangs from a flexure in a case. A specific force deflects it; plates "
        "beside its tip measure the deflection, and a servo sends a current through the "
        "coils on the pendulum, between magnets, that brings it back. The current is the "
        "reading. A bar at the bottom shows the torque of the coils.",
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
