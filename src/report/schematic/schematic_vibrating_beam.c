/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer from above: a proof mass between two beams, of which a force
 * pulls one and pushes the other. The beams' motion is drawn to the scale of its amplitude. */
#include "schematic_internal.h"

#include "imukit/vibrating_beam.h"

#include <math.h>

/* ---- the tables ------------------------------------------------------------------------------ */

enum { MASS, FIRST_SPAN, FIRST, SECOND_SPAN, SECOND, PARTS };

#define BEAM 120  /* length of a beam [px] */
#define LEFT 60   /* its clamp on the left */
#define RIGHT 480 /* on the right */
#define LINE 185  /* height of both */

static double full_force(const void *design)
{
    const imk_vibrating_beam *d = design;
    return d->proof_mass * d->range;
}

static double full_amplitude(const void *design)
{
    const imk_vibrating_beam *d = design;
    return d->amplitude;
}

/* A force along x leaves the mass behind, on the left, and pulls the first beam, on the right. */
static const imk_schematic_part parts[PARTS] = {
    [MASS] = {.id = "mass",
              .signal = "force",
              .move = IMK_MOVE_SHIFT_X,
              .reach = -14,
              .full = full_force},
    [FIRST_SPAN] = {.id = "first-span",
                    .signal = "force",
                    .move = IMK_MOVE_STRETCH_X,
                    .with = "mass",
                    .x = RIGHT,
                    .y = LINE,
                    .reach = -1.0 / BEAM,
                    .base = 1},
    [FIRST] = {.id = "first",
               .x = RIGHT,
               .y = LINE,
               .signal = "displacement_1",
               .move = IMK_MOVE_STRETCH_Y,
               .reach = 22,
               .full = full_amplitude,
               .still = 0.8},
    [SECOND_SPAN] = {.id = "second-span",
                     .signal = "force",
                     .move = IMK_MOVE_STRETCH_X,
                     .with = "mass",
                     .x = LEFT,
                     .y = LINE,
                     .reach = 1.0 / BEAM,
                     .base = 1},
    [SECOND] = {.id = "second",
                .x = LEFT,
                .y = LINE,
                .signal = "displacement_2",
                .move = IMK_MOVE_STRETCH_Y,
                .reach = 22,
                .full = full_amplitude,
                .still = -0.8},
};

static double axial(const void *design, const imk_schematic_moment *moment)
{
    (void)design;
    return imki_signal(&imk_vibrating_beam_instrument, "force", moment);
}

/* A beam whose modulus is e times that at the reference temperature: its load counts 1/e, its
 * square e times. */
static double loaded(const imk_vibrating_beam *d, int beam, const imk_schematic_moment *moment)
{
    const double warm = moment->exposure->temperature - d->temperature;
    const double per_kelvin = d->frequency_temperature + (beam == 1 ? d->temperature_mismatch : 0);
    const double grown = 1 + per_kelvin * warm, e = grown > 0.01 ? grown : 0.01;
    const double force = beam == 1 ? -axial(d, moment) : axial(d, moment);
    return sqrt(e) * imk_vibrating_beam_loaded(d, beam, force / e);
}

static double first(const void *design, const imk_schematic_moment *moment)
{
    return loaded(design, 0, moment);
}

static double second(const void *design, const imk_schematic_moment *moment)
{
    const imk_vibrating_beam *d = design;
    return d->arrangement == IMK_BEAM_PAIR ? loaded(d, 1, moment) : (double)NAN;
}

static const imk_schematic_quantity quantities[] = {
    {"axial force on the first beam", "N", "N", "mN", "N = m f + M", axial},
    {"frequency of the first beam, pulled", "f_1", "Hz", "Hz", "f_1^2 ≈ f_01^2 (1 + c ΔT) + κ N",
     first},
    {"frequency of the second beam, pushed", "f_2", "Hz", "Hz", "f_2^2 ≈ f_02^2 (1 + c ΔT) − κ N",
     second},
    {"frequency of the first beam, unloaded", NULL, NULL, NULL, NULL, NULL},
    {"frequency of the second beam, unloaded", NULL, NULL, NULL, NULL, NULL},
    {"change of the squared frequency per load", NULL, NULL, NULL, NULL, NULL},
    {"frequency per specific force, first beam", NULL, NULL, NULL, NULL, NULL},
    {"differential scale factor", NULL, NULL, NULL, NULL, NULL},
    {"buckling load", NULL, NULL, NULL, NULL, NULL},
    {"displacement of the proof mass per specific force", NULL, NULL, NULL, NULL, NULL},
};

static const imk_schematic_slider sliders[] = {
    {"acceleration", -65, 65, "g", false},     {"temperature", -40, 85, "degC", false},
    {"beam.thickness", 150, 220, NULL, false}, {"beam.length", 4, 5, NULL, false},
    {"beam.quality", 1000, 50000, NULL, true}, {"mount.force", -0.01, 0.01, NULL, false},
};

static double cycle(const void *design)
{
    return 1 / imk_vibrating_beam_frequency(design, 0);
}

/* ---- the drawing ----------------------------------------------------------------------------- */

/* A beam from its clamp to the mass, bent by 1 px. */
static void draw_beam(imki_drawing *d, size_t span, size_t beam, const char *class,
                      const char *mode)
{
    imki_part_begin(d, span);
    imki_part_begin(d, beam);
    imki_draw_path(d, class, mode);
    imki_part_end(d);
    imki_part_end(d);
}

static void draw_mass(imki_drawing *d)
{
    imki_part_begin(d, MASS);
    imki_draw_box(d, "mass", LEFT + BEAM, 130, RIGHT - LEFT - 2 * BEAM, 110, 4);
    imki_draw_text(d, IMKI_MIDDLE, 270, 192, "m");
    imki_part_end(d);
}

static void draw(imki_drawing *d, const void *design)
{
    const imk_vibrating_beam *beams = design;
    const bool pair = beams->arrangement == IMK_BEAM_PAIR;
    imki_draw_anchor(d, LEFT, 120, LEFT, 250);
    imki_draw_anchor(d, RIGHT, 250, RIGHT, 120);
    imki_draw_spring(d, 270, 84, 270, 130, 4, 9);
    imki_draw_spring(d, 270, 240, 270, 286, 4, 9);
    imki_draw_anchor(d, 240, 84, 300, 84);
    imki_draw_anchor(d, 300, 286, 240, 286);
    imki_draw_box(d, "field", RIGHT - BEAM / 2 - 18, 146, 36, 8, 2);
    draw_beam(d, FIRST_SPAN, FIRST, "one",
              "M480 185C453.6 185 446.4 186 420 186S386.4 185 360 185");
    if (pair)
        imki_draw_box(d, "field", LEFT + BEAM / 2 - 18, 146, 36, 8, 2);
    if (pair)
        draw_beam(d, SECOND_SPAN, SECOND, "two",
                  "M60 185C86.4 185 93.6 186 120 186S153.6 185 180 185");
    draw_mass(d);
    imki_draw_text(d, IMKI_END, 530, 76, "beam 1:");
    imki_draw_label(d, IMKI_END, 530, 102, "f_1^2 ≈ f_{01}^2 + κN", 440, 110, 440, 180);
    if (pair) {
        imki_draw_text(d, IMKI_START, 12, 76, "beam 2:");
        imki_draw_label(d, IMKI_START, 12, 102, "f_2^2 ≈ f_{02}^2 − κN", 100, 110, 100, 180);
    }
    imki_draw_label(d, IMKI_START, 310, 66, "flexure", 318, 72, 279, 100);
    imki_draw_label(d, IMKI_END, 228, 300, "proof mass", 170, 282, 200, 232);
    imki_draw_label(d, IMKI_START, 330, 300, "drive and pickoff", 420, 282, 424, 156);
    imki_draw_arrow(d, "accent", 440, 338, 520, 338);
    imki_draw_text(d, IMKI_END, 430, 345, "force f along x");
    imki_scale_bar(d, FIRST, 30, 330);
    imki_draw_text(d, IMKI_END, 530, 390, "N = mf + M (mount)");
}

const imk_schematic imki_schematic_vibrating_beam = {
    .instrument = &imk_vibrating_beam_instrument,
    .description = "A proof mass between two beams that vibrate across their length. A specific "
                   "force moves the mass a little, so it pulls one beam, whose frequency rises, "
                   "and pushes the other, whose frequency falls.",
    .part_count = PARTS,
    .quantity_count = IMKI_SCHEMATIC_LENGTH(quantities),
    .slider_count = IMKI_SCHEMATIC_LENGTH(sliders),
    .parts = parts,
    .quantities = quantities,
    .sliders = sliders,
    .cycle = cycle,
    .cycle_screen = 0.8,
    .cycles = 10,
    .input = 30 * 9.80665,
    .draw = draw,
};
