/* SPDX-License-Identifier: Apache-2.0 */
/** @file report.h
 *  Figures as data, drawn as SVG, and self-contained HTML pages. Figures and animations need memory
 *  and arithmetic only; as files: imukit/figure_file.h. Part of libimukit-io. */
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
    IMK_CURVE_LAYER, /**< the same in a strong colour: layers that lie on one another */
    IMK_CURVE_MARKS  /**< large points that stand out from a map */
} imk_curve_style;

/** One curve of a panel. Arrays are the caller's. Values that are not finite (or not positive on a
 *  logarithmic axis) are left out. */
typedef struct imk_curve {
    const char *label; /**< "" leaves it out of the key */
    imk_curve_style style;
    int color; /**< index into the house palette, which colour-blind readers can tell apart */
    size_t count;
    const double *x, *y;
    const double *lower, *upper; /**< error bars or band; NULL: none */
} imk_curve;

/** A tinted rectangle behind the curves, with its name in the upper left corner, or the right. */
typedef struct imk_region {
    const char *label;
    int color; /**< as of a curve */
    double x_low, x_high, y_low, y_high;
    bool label_right;
} imk_region;

/** Where the key of a panel stands. */
typedef enum imk_key_place {
    IMK_KEY_UPPER = 0, /**< the upper right corner, or another where it hides much less; beside the
                            axes of a single panel */
    IMK_KEY_LOWER,     /**< the lower right corner, which rising curves leave free, or another */
    IMK_KEY_BELOW      /**< below the axes */
} imk_key_place;

/** One pair of axes. They span the points, error bars, bands and regions with some air, and the
 *  lines only where there is nothing else: an asymptote may leave the frame. Texts are drawn as
 *  they are: no markup. */
typedef struct imk_panel {
    const char *title, *x_label, *y_label;
    bool x_logarithmic, y_logarithmic;
    size_t curve_count;
    const imk_curve *curves;
    size_t region_count;
    const imk_region *regions;
    imk_key_place key;
} imk_panel;

/** Panels on a grid, row by row; larger ones where regions have names to be read. The title is
 *  drawn over two or more panels. */
typedef struct imk_figure {
    const char *title;
    size_t panel_count, columns;
    const imk_panel *panels;
} imk_figure;

/** The figure as SVG text obtained from malloc(). Of a curve with very many points those are left
 *  out that fall on the same pixel, and 20000 are drawn at most: no curve takes a megabyte, a line
 *  along its axis less than 0.1. Equal figures give equal bytes, in any locale.
 *  @return IMK_ERROR_EMPTY (error.field: the panel without a drawable point), IMK_ERROR_MEMORY */
IMK_API imk_status imk_figure_svg(const imk_figure *figure, char **svg, size_t *size,
                                  imk_error *error);

/** A point that walks along its path as time passes, again and again: an SVG that moves by itself
 *  (SMIL), without script, in any browser and as an image of a page. Readers who have asked their
 *  system for less motion see the path alone; so does what cannot move, such as print. */
typedef struct imk_animation {
    const char *title, *x_label, *y_label; /**< drawn as they are: no markup */
    size_t count;                          /**< >= 2 */
    const double *x, *y;                   /**< at equal intervals of time; all finite */
    bool points;                           /**< separate points: the path jumps */
    double duration;                       /**< of a round on the screen [s], 1 … 3600 */
    const char *clock;                     /**< what a round stands for, "600 us"; "": nothing */
} imk_animation;

/** The animation as SVG text obtained from malloc(). Paths beyond 4000 points are thinned.
 *  @return IMK_ERROR_EMPTY for less than two points or a path that stays where it is,
 *          IMK_ERROR_NOT_FINITE, IMK_ERROR_RANGE (error.field "duration"), IMK_ERROR_MEMORY */
IMK_API imk_status imk_animation_svg(const imk_animation *animation, char **svg, size_t *size,
                                     imk_error *error);

IMK_END_C
#endif
