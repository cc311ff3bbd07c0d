/* SPDX-License-Identifier: Apache-2.0 */
/* What schematics (imukit/schematic.h) are drawn with.
 *
 * To add the schematic of an instrument:
 *
 * 1. A file schematic_NAME.c beside this one with `const imk_schematic imki_schematic_NAME`, and
 *    its name in IMKI_SCHEMATICS below.
 * 2. Its table of parts, an enum giving their indices. `full` is a function of the design that
 *    returns the size of the signal at which the part moves by `reach`; take closed forms of the
 *    instrument's header. imki_scale_bar() and imki_magnified() state how large motions are drawn.
 *    A spring between the case and a mass that shifts is stretched about its fixed end, `with` the
 *    mass: of a length of 40 px its reach is 1/40 and its base 1.
 * 3. A function that draws from the back to the front, in pixels of a sheet of 540 x 400: the title
 *    stands above y = 34, the time scale below y = 376. A moving part is what is drawn between
 *    imki_part_begin() and imki_part_end(); parts may be nested: an inner one moves with the outer.
 * 4. Colours are classes, so that they are others in the dark:
 *        line    outline, no filling        body    what stands still: case, block, frame
 *        thin    thin grey line             mass    what moves: rotor, proof mass, float
 *        axis    dash-dotted centre line    spring  springs, flexures, torsion bars
 *        one     first beam, drive: orange  two     second beam, sense: blue
 *        field   electrodes, coils, magnets glass   optics
 *        accent  what the eye shall follow: pickoff, detector
 *    `shaft` is a thick line, `rim` a filling without an outline in the colour of the class before;
 *    `fill-one`, `fill-two`, `fill-accent` are fillings without an outline; `hatch` is drawn by
 *    imki_draw_anchor().
 * 5. Names of the parts by imki_draw_label(), with a line to what they name. Texts are of 20 px,
 *    about 11 px a letter: few words. In a text `_x`, `_{xyz}` lower and `^x`, `^{xyz}` raise;
 *    letters like Ω, λ and Δ are written as such.
 * 6. Quantities by the names of imk_derived, and those of the moment with a function; sliders.
 *
 * Look at it: `imukit physics NAME --view -o x.svg`, light and dark, 540 and 360 px wide.
 * tests/report/test_schematic.c checks the tables, that no two texts overlap, and that parts move.
 *
 * Coordinates are written in tenths of a pixel by whole numbers, so that no locale matters; only
 * elementary.h is used besides arithmetic, so that the bytes are the same everywhere. */
#ifndef IMUKI_SCHEMATIC_INTERNAL_H
#define IMUKI_SCHEMATIC_INTERNAL_H

#include "imukit/schematic.h"
#include "report/growing_text_internal.h"

/* The schematics there are. */
#define IMKI_SCHEMATICS(kind)                                                                      \
    kind(free_gyro) kind(rate_gyro) kind(rate_integrating_gyro) kind(tuned_gyro)                   \
        kind(suspended_rotor) kind(fibre_optic) kind(ring_laser) kind(tuning_fork)                 \
            kind(shell_gyro) kind(mems_accelerometer) kind(pendulous_servo) kind(vibrating_beam)

#define IMKI_SCHEMATIC_LENGTH(array) (sizeof(array) / sizeof((array)[0]))

typedef enum imki_side { IMKI_START = 0, IMKI_MIDDLE, IMKI_END } imki_side;

/* The values of every part at every moment of an animation. */
typedef struct imki_film {
    size_t frames;
    double *value; /* of part p at moment k: value[p * frames + k] */
    long milliseconds;
} imki_film;

typedef struct imki_drawing {
    imki_text text;
    const imk_schematic *schematic;
    const void *design;
    const imki_film *film; /* NULL: the still drawing */
    int begun[IMK_SCHEMATIC_PARTS_MAX], depth;
} imki_drawing;

/* A moving part of the table; what is drawn until the end belongs to it. A line that
 * flows has dashes: imki_dashes_begin(). */
void imki_part_begin(imki_drawing *d, size_t part);
void imki_part_end(imki_drawing *d);

/* Dashes and gaps [px] of what is drawn until the end of the group, for parts that flow. */
void imki_dashes_begin(imki_drawing *d, double dash, double gap);
/* Turn what is drawn until the end of the group about a point [deg], clockwise. */
void imki_turned_begin(imki_drawing *d, double degrees, double x, double y);
/* Show only what is inside a rectangle, until the end of the group. */
void imki_window_begin(imki_drawing *d, const char *name, double x, double y, double width,
                       double height);
void imki_group_end(imki_drawing *d);

void imki_draw_line(imki_drawing *d, const char *class, double x1, double y1, double x2, double y2);
void imki_draw_circle(imki_drawing *d, const char *class, double x, double y, double radius);
void imki_draw_ellipse(imki_drawing *d, const char *class, double x, double y, double rx,
                       double ry);
/* With rounded corners. */
void imki_draw_box(imki_drawing *d, const char *class, double x, double y, double width,
                   double height, double corner);
/* Data of an SVG path in pixels: "M10 10L20 20". */
void imki_draw_path(imki_drawing *d, const char *class, const char *data);
/* @param points  x and y of each */
void imki_draw_polygon(imki_drawing *d, const char *class, size_t count, const double *points,
                       bool closed);
/* The head of an arrow, its tip at a point, in the direction (x, y) of length 1. */
void imki_draw_head(imki_drawing *d, const char *class, double at_x, double at_y, double x,
                    double y);
/* With its head at the second point. */
void imki_draw_arrow(imki_drawing *d, const char *class, double x1, double y1, double x2,
                     double y2);
/* Along a circle from one angle to another [deg], 0 to the right, clockwise; its head at the
 * second. */
void imki_draw_turn(imki_drawing *d, const char *class, double x, double y, double radius,
                    double from, double to);
/* A zigzag from one point to another. @param width  to each side */
void imki_draw_spring(imki_drawing *d, double x1, double y1, double x2, double y2, int turns,
                      double width);
/* An edge that is fixed to the case, hatched on the right of the way from one point to the
 * other. */
void imki_draw_anchor(imki_drawing *d, double x1, double y1, double x2, double y2);

/* A text; y is its baseline. */
void imki_draw_text(imki_drawing *d, imki_side side, double x, double y, const char *text);
/* A grey one, of scales. */
void imki_draw_note(imki_drawing *d, imki_side side, double x, double y, const char *text);
/* A text with a line from one point, near it, to what it names. */
void imki_draw_label(imki_drawing *d, imki_side side, double x, double y, const char *text,
                     double x1, double y1, double x2, double y2);
/* A bar that shows a true length of a shifted part: "1 um". Its middle is at (x, y), its text is
 * below it. Of a vertical shift it stands upright, with its text on the right. */
void imki_scale_bar(imki_drawing *d, size_t part, double x, double y);
/* How many times larger an angle is drawn: "dither x 100" of the words "dither". */
void imki_magnified(imki_drawing *d, size_t part, imki_side side, double x, double y,
                    const char *words);

/* The name of the instrument, at the top. */
void imki_draw_title(imki_drawing *d);
/* The line at the bottom: how slow the drawing moves. */
void imki_draw_time(imki_drawing *d);
/* A number in whole tenths. */
void imki_put_tenths(imki_text *out, double value);

/* A signal or an output of an instrument by its name, "input", "turned" or "screen", in SI. */
double imki_signal(const imk_instrument *instrument, const char *name,
                   const imk_schematic_moment *moment);
/* The value of a part in the still drawing. */
double imki_still_value(const imk_schematic *schematic, const void *design, size_t index);
/* The largest of 1, 2, 3 and 5 times a power of ten that is not above a number > 0. */
double imki_round_down(double value);

/* The whole drawing. @param film  NULL: still */
imk_status imki_schematic_sheet(const imk_schematic *schematic, const void *design,
                                const imki_film *film, char **svg, size_t *size, imk_error *error);
/* The schematic of an instrument, for a valid design. */
imk_status imki_schematic_find(const imk_instrument *instrument, const void *design,
                               const imk_schematic **schematic, imk_error *error);

#define IMKI_DECLARE_SCHEMATIC(name) extern const imk_schematic imki_schematic_##name;
IMKI_SCHEMATICS(IMKI_DECLARE_SCHEMATIC)

#endif
