/* SPDX-License-Identifier: Apache-2.0 */
/** @file schematic.h
 *  Labelled drawings of the instruments (instrument.h), made from their designs and moved by their
 *  simulations.
 *
 *  A schematic is a table beside a drawing: which parts move and by which signal, which quantities
 *  are shown beside it, and which numbers of the design can be varied. The still drawing, the
 *  animation without script (SMIL), and a page that moves the parts by a running simulation all
 *  use this table. In the drawing a moving part is a group
 *
 *      <g id="drive" class="part" data-move="shift-x" data-signal="drive_displacement"
 *         data-gain="5e6" data-base="0" data-origin="270 200">
 *
 *  At any moment it has the value v = base + gain * signal, the signal in SI, and is placed by
 *
 *      turn       transform="rotate(v x y)"       v [deg], x and y of data-origin
 *      shift-x    transform="translate(v 0)"      v [px of the drawing]
 *      shift-y    transform="translate(0 v)"
 *      stretch-x  transform="scale(v 1)"          about the origin of its own group; |v| >= 0.001,
 *      stretch-y  transform="scale(1 v)"          because a drawing without width vanishes
 *      squeeze    transform="scale(1+v 1-v)"      a circle becomes an ellipse, as a shell does
 *      flow       style stroke-dashoffset = v     a dashed line moves along itself [px]
 *      glow       style opacity = v               0 … 1
 *
 *  The text that states the time scale has the class "pace".
 *
 *  Needs memory and arithmetic only. Part of libimukit-io. */
#ifndef IMUKIT_SCHEMATIC_H
#define IMUKIT_SCHEMATIC_H

#include "imukit/job.h"
#include "imukit/physics_log.h"

IMK_BEGIN_C

/** Size of a drawing [px]; its texts are of 20 px, and still of 13 px when it is 360 px wide. */
enum { IMK_SCHEMATIC_WIDTH = 540, IMK_SCHEMATIC_HEIGHT = 400, IMK_SCHEMATIC_PARTS_MAX = 16 };

/** How a part moves. */
typedef enum imk_move {
    IMK_MOVE_TURN = 0,
    IMK_MOVE_SHIFT_X,
    IMK_MOVE_SHIFT_Y,
    IMK_MOVE_STRETCH_X,
    IMK_MOVE_STRETCH_Y,
    IMK_MOVE_SQUEEZE,
    IMK_MOVE_FLOW,
    IMK_MOVE_GLOW
} imk_move;
/** "shift-x". */
IMK_API const char *imk_move_name(imk_move move);

/** A moment of a running instrument. */
typedef struct imk_schematic_moment {
    const imk_exposure *exposure;
    const double *outputs, *signals; /**< of the instrument */
    double turned; /**< integral of the input since the beginning: the angle of the case [rad], or
                        its speed [m/s] */
    double screen; /**< time on the screen since the beginning [s] */
} imk_schematic_moment;

/** A part that moves. */
typedef struct imk_schematic_part {
    const char *id;
    /** Internal signal or output of the instrument; or "input": rate or force along x; "turned":
     *  its integral; "screen": the time on the screen, for what runs at a pace for the eye. */
    const char *signal;
    imk_move move;
    double x, y;  /**< centre of a turn, stretch or squeeze [px] */
    double reach; /**< how far it moves [px], [deg], [1] … */
    /** … when the signal has this value in SI; NULL: 1. An angle that turns a part is magnified by
     *  a round number, 1, 2, 3 or 5 times a power of ten, that the drawing states; then the part
     *  may move less far. */
    double (*full)(const void *design);
    /** Moves with another part, of this id: the gain is `reach` times its gain; NULL: by itself. */
    const char *with;
    double base;
    bool held;    /**< a loop of the default design holds it: it may rest in the animation */
    double still; /**< in the still drawing the signal is this part of `full` */
} imk_schematic_part;

/** A quantity to show beside the drawing. */
typedef struct imk_schematic_quantity {
    const char *name; /**< of a derived quantity of the instrument (imk_derived), or another */
    /** NULL: those of the derived quantity. */
    const char *symbol, *si, *unit, *equation;
    /** Value in SI at a moment; NULL: the derived quantity. */
    double (*value)(const void *design, const imk_schematic_moment *moment);
} imk_schematic_quantity;

/** A number to vary. */
typedef struct imk_schematic_slider {
    const char *path;        /**< of a field of the design; or "rate", "acceleration" (both along
                                  x) or "temperature" */
    double minimum, maximum; /**< in `unit`. Of a choice: not used. With the other numbers as in the
                                  default design, every value between is valid */
    const char *unit;        /**< NULL: the unit of the field */
    bool logarithmic;
} imk_schematic_slider;

struct imki_drawing;

/** The schematic of an instrument. */
typedef struct imk_schematic {
    const imk_instrument *instrument;
    const char *description; /**< what is seen, for readers who cannot see it */
    size_t part_count, quantity_count, slider_count;
    const imk_schematic_part *parts;
    const imk_schematic_quantity *quantities;
    const imk_schematic_slider *sliders;
    /** Simulated duration of what is to be seen, such as a cycle of the carrier [s]. */
    double (*cycle)(const void *design);
    double cycle_screen; /**< its duration on the screen [s] */
    int cycles;          /**< so many of them are one round of the animation */
    double settle;       /**< time simulated before the animation begins [s] */
    double input;        /**< of the animation: rate [rad/s] or specific force [m/s^2] along x */
    bool sine;           /**< it is the amplitude of a sine, whose period is `cycle` */
    double force;        /**< specific force along x of a gyro [m/s^2] */
    /** Draw it (src/report/schematic). */
    void (*draw)(struct imki_drawing *drawing, const void *design);
} imk_schematic;

/** Schematic of an instrument; NULL when it has none. */
IMK_API const imk_schematic *imk_schematic_of(const imk_instrument *instrument);

/** Simulated seconds per second on the screen. The design must be valid. */
IMK_API double imk_schematic_pace(const imk_schematic *schematic, const void *design);
/** Gain of part `index`: px, deg or 1 per SI unit of its signal. The design must be valid. */
IMK_API double imk_schematic_gain(const imk_schematic *schematic, const void *design, size_t index);
/** base + gain * signal of part `index` at a moment. */
IMK_API double imk_schematic_place(const imk_schematic *schematic, const void *design, size_t index,
                                   const imk_schematic_moment *moment);
/** Quantity `index` with the texts of its derived quantity filled in. */
IMK_API imk_schematic_quantity imk_schematic_quantity_get(const imk_schematic *schematic,
                                                          size_t index);
/** Value of quantity `index` in SI at a moment; NaN: this design has none. */
IMK_API double imk_schematic_quantity_value(const imk_schematic *schematic, const void *design,
                                            size_t index, const imk_schematic_moment *moment);

/** Draw an instrument as it rests: SVG text, obtained from malloc(); the caller frees it. It
 *  follows the colours that the reader prefers, light or dark.
 *  @return IMK_ERROR_UNSUPPORTED (no schematic), errors of imk_design_check(), IMK_ERROR_MEMORY */
IMK_API imk_status imk_schematic_svg(const imk_instrument *instrument, const void *design,
                                     char **svg, size_t *size, imk_error *error);

/** Run the instrument and draw it in motion: the same drawing with the values of each part. In
 *  print, and for readers whose system is set to reduced motion, the still drawing stands there.
 *  @param settings  instrument, design, physics, and with view_input the input
 *  @param seconds   of one round on the screen, 1 … 3600; 0: as the schematic states
 *  @param frames    moments that are drawn, 2 … 120; 0: 120
 *  @param job       NULL: the memory of the C library
 *  @return IMK_ERROR_UNSUPPORTED (no schematic), _RANGE (error.field "seconds", "frames"), errors
 *          of the instrument's init; IMK_ERROR_NOT_FINITE, _MEMORY */
IMK_API imk_status imk_schematic_animated(const imk_physics_log_settings *settings, double seconds,
                                          size_t frames, const imk_job *job, char **svg,
                                          size_t *size, imk_error *error);

IMK_END_C
#endif
