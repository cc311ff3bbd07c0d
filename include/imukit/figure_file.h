/* SPDX-License-Identifier: Apache-2.0 */
/** @file figure_file.h
 *  Figures, animations and schematics as files and on the terminal. Part of libimukit-io. */
#ifndef IMUKIT_FIGURE_FILE_H
#define IMUKIT_FIGURE_FILE_H

#include "imukit/report.h"
#include "imukit/schematic.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** True when the program is on PATH that a plot with this name needs: rsvg-convert for FILE.png and
 *  FILE.pdf, gnuplot for "term", none for FILE.svg. False for another name. */
IMK_API bool imk_plot_available(const char *path);

/** Draw a figure to FILE.svg, FILE.png or FILE.pdf, or to standard output with "term" (in letters,
 *  as large as the terminal; in colours on a terminal unless NO_COLOR is set). SVG is drawn by
 *  imk_figure_svg(); of it rsvg-convert makes PNG, twice as large, and PDF; gnuplot draws letters.
 *  These run in a folder of TMPDIR and see no names but their own there, so none is a command to
 *  them; they have 120 s, or IMUKIT_DRAWING_SECONDS.
 *  @return IMK_ERROR_EMPTY (error.field: the panel without a drawable point), IMK_ERROR_FORMAT
 *          (another ending), IMK_ERROR_UNSUPPORTED (the program is missing, or failed),
 *          IMK_ERROR_OPEN, IMK_ERROR_WRITE, IMK_ERROR_MEMORY */
IMK_API imk_status imk_figure_write(const imk_figure *figure, const char *path, imk_error *error);

/** Write an animation to a file whose name ends in .svg.
 *  @return errors of imk_animation_svg(); IMK_ERROR_FORMAT (another ending), _OPEN, _WRITE */
IMK_API imk_status imk_animation_write(const imk_animation *animation, const char *path,
                                       imk_error *error);

/** Write the schematic of an instrument in motion (imk_schematic_animated()) to a file whose name
 *  ends in .svg, or to standard output ("-").
 *  @return errors of imk_schematic_animated(); IMK_ERROR_FORMAT (another ending), _OPEN, _WRITE */
IMK_API imk_status imk_schematic_write(const imk_physics_log_settings *settings, double seconds,
                                       size_t frames, const char *path, imk_error *error);

IMK_END_C
#endif
