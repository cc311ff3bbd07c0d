/* SPDX-License-Identifier: Apache-2.0 */
/** @file report.h
 *  Figures as data, drawn as SVG, and self-contained HTML pages. Figures and animations need memory
 *  and arithmetic only; as files: imukit/figure_file.h. Part of libimukit-io. */
#ifndef IMUKIT_REPORT_H
#define IMUKIT_REPORT_H

#include "imukit/status.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/** The figure as SVG text obtained from malloc(). A curve of any number of points is drawn by
 *  20 000 at most: those are left out that fall on the same pixel. A drawing has less than half a
 *  megabyte for each of its curves. Equal figures give equal bytes, in any locale.
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

/** A self-contained HTML page being built: styles and drawings are inside, nothing is fetched,
 * every text is escaped. Functions accept the NULL of a failed imk_page_create(), which
 * imk_page_write() then reports. */
typedef struct imk_page imk_page;

/** Start a page; NULL when memory is exhausted, which every function below allows. */
IMK_API imk_page *imk_page_create(const char *title, const char *subtitle);
/** A heading, escaped. */
IMK_API void imk_page_heading(imk_page *page, const char *text);
/** A paragraph of plain text (escaped). */
IMK_API void imk_page_text(imk_page *page, const char *text);
/** A coloured box: 0 good, 1 note, 2 warning. */
IMK_API void imk_page_verdict(imk_page *page, int level, const char *text);
/** A table of rows x columns texts, the first row the header. */
IMK_API void imk_page_table(imk_page *page, size_t rows, size_t columns, const char *const *cells);
/** A figure, drawn into the page. Of one without a point to draw a note says what is missing; any
 *  other failure becomes that of imk_page_write(). */
IMK_API void imk_page_figure(imk_page *page, const imk_figure *figure, const char *caption);
/** An animation, drawn into the page. */
IMK_API void imk_page_animation(imk_page *page, const imk_animation *animation,
                                const char *caption);
/** On paper, and in a PDF, what follows begins a new sheet; nothing on the screen. */
IMK_API void imk_page_break(imk_page *page);
/** Preformatted text, such as a model file. */
IMK_API void imk_page_code(imk_page *page, const char *text);
/** The page as text obtained from malloc(); frees the page.
 *  @return as imk_page_write(), but for files */
IMK_API imk_status imk_page_take(imk_page *page, char **text, size_t *size, imk_error *error);
/** Write the page and free it; NULL path only frees.
 *  @return IMK_ERROR_MEMORY, IMK_ERROR_OPEN, IMK_ERROR_WRITE, and why a figure was not drawn, as of
 *          imk_figure_svg(): then nothing is written */
IMK_API imk_status imk_page_write(imk_page *page, const char *path, imk_error *error);

#ifdef __cplusplus
}
#endif
#endif
