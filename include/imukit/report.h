/* SPDX-License-Identifier: Apache-2.0 */
/** @file report.h
 *  Figures as data, and functions that draw them as SVG. They need memory and arithmetic only;
 *  imukit/figure_file.h writes them to files. Part of libimukit-io. */
#ifndef IMUKIT_REPORT_H
#define IMUKIT_REPORT_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** How one curve is drawn. */
typedef enum imk_curve_style {
    IMK_CURVE_LINE = 0,
    IMK_CURVE_POINTS,
    IMK_CURVE_DASHES,
    IMK_CURVE_BAND,  /**< filled between lower and upper */
    IMK_CURVE_LAYER, /**< a band in a strong colour, for bands stacked on one another */
    IMK_CURVE_MARKS  /**< large points that stand out on a map */
} imk_curve_style;

/** One curve of a panel. The arrays belong to the caller. Values that are not finite (or not
 *  positive on a logarithmic axis) are left out. */
typedef struct imk_curve {
    const char *label; /**< text in the key; "": not in the key */
    imk_curve_style style;
    int color; /**< index into the palette, whose colours colour-blind readers can tell apart */
    size_t count;
    const double *x, *y;
    const double *lower, *upper; /**< error bars or band; NULL: none */
} imk_curve;

/** A tinted rectangle behind the curves, with its label in the upper left corner (label_right:
 *  upper right). */
typedef struct imk_region {
    const char *label;
    int color;                           /**< index into the palette */
    double x_low, x_high, y_low, y_high; /**< infinite: to the frame */
    bool label_right;
    bool dashed; /**< outline of dashes, for limits that are not certain */
} imk_region;

/** Where the key of a panel stands. A key that would hide something in each corner goes below. */
typedef enum imk_key_place {
    IMK_KEY_UPPER = 0, /**< in the upper right corner, or in another corner where it hides much
                          less; if the figure has one panel, beside the axes */
    IMK_KEY_LOWER,     /**< in the lower right corner, which rising curves leave free, or in another
                          corner */
    IMK_KEY_BELOW      /**< below the axes */
} imk_key_place;

/** One pair of axes. The axes span points, error bars, bands and regions with some margin. They
 *  span lines only if there is nothing else, so an asymptote may leave the frame. Texts are drawn
 *  as they are, without markup. */
typedef struct imk_panel {
    const char *title, *x_label, *y_label;
    bool x_logarithmic, y_logarithmic;
    size_t curve_count;
    const imk_curve *curves;
    size_t region_count;
    const imk_region *regions;
    imk_key_place key;
    const char
        *note; /**< lines below the label of the x axis, separated by line feeds; NULL: none */
    bool allan_deviation; /**< of a rate against averaging time: a page can lay the deviations of
                             other sensors over it */
    double y_low, y_high; /**< what the y axis spans, if y_low < y_high; then x spans lines, too */
} imk_panel;

/** Panels on a grid, row by row. Panels are larger if regions have labels. The title is drawn only
 *  above two or more panels. */
typedef struct imk_figure {
    const char *title;
    size_t panel_count, columns;
    const imk_panel *panels;
} imk_figure;

/** Draw a figure as SVG text, obtained from malloc(); the caller frees it. Points of a curve that
 *  fall on the same pixel are left out, and at most 20000 are drawn, so a curve takes less than 1
 *  MB (a line along its axis less than 0.1 MB). Equal figures give equal bytes, in any locale.
 *  @return IMK_ERROR_EMPTY (error.field: the panel without a drawable point), IMK_ERROR_MEMORY */
IMK_API imk_status imk_figure_svg(const imk_figure *figure, char **svg, size_t *size,
                                  imk_error *error);

/** A point that moves along its path again and again: an SVG animation (SMIL) without script, for
 *  any browser and as an image of a page. Only the path is shown in print, and to readers whose
 *  system is set to reduced motion. */
typedef struct imk_animation {
    const char *title, *x_label, *y_label; /**< drawn as they are: no markup */
    size_t count;                          /**< >= 2 */
    const double *x, *y;                   /**< at equal intervals of time; all finite */
    bool points;                           /**< the path is drawn as separate points */
    size_t law_count;                      /**< points of a line behind the path; 0: none */
    const double *law_x, *law_y;           /**< all finite */
    double duration;                       /**< time of one round on the screen [s], 1 … 3600 */
    const char *clock;                     /**< true time of one round, "600 us"; "": not shown */
} imk_animation;

/** Draw an animation as SVG text, obtained from malloc(); the caller frees it. Paths of more than
 *  4000 points are thinned.
 *  @return IMK_ERROR_EMPTY for fewer than two points or a path that never moves,
 *          IMK_ERROR_NOT_FINITE, IMK_ERROR_RANGE (error.field "duration"), IMK_ERROR_MEMORY */
IMK_API imk_status imk_animation_svg(const imk_animation *animation, char **svg, size_t *size,
                                     imk_error *error);

IMK_END_C
#endif
