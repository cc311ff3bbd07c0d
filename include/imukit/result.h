/* SPDX-License-Identifier: Apache-2.0 */
/** @file result.h
 *  Results of jobs, ready for display: one result object, and renderers that make JSON, text and an
 *  HTML page of it.
 *
 *  A result has two parts. The data is a tree of named values, which `--json` prints. The display
 *  is a list of headings, lines, tables and figures; each is for the terminal, the page, or both.
 *
 *  A result remembers that memory was exhausted. So functions that add need no check: the renderers
 *  return IMK_ERROR_MEMORY. Texts and numbers are copied. Part of libimukit-io; no file is opened
 *  and no program is run. */
#ifndef IMUKIT_RESULT_H
#define IMUKIT_RESULT_H

#include "imukit/allocator.h"
#include "imukit/readable.h"
#include "imukit/report.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

typedef struct imk_result imk_result;

/** An empty result. @param allocator  NULL: the C library's
 *  @return NULL when memory is exhausted; every function here accepts NULL */
IMK_API imk_result *imk_result_create(const imk_allocator *allocator);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_result_free(imk_result *result);

/** @name Data
 *  Each function adds a member to the object, or an element to the array, that was begun last. In
 *  an array `key` is NULL. The root is an object. Keys are not copied: they must outlive the
 *  result.
 *  @{ */
/** Begin an object. */
IMK_API void imk_result_object(imk_result *result, const char *key);
/** Begin an array. */
IMK_API void imk_result_array(imk_result *result, const char *key);
/** End the object or array that was begun last. */
IMK_API void imk_result_end(imk_result *result);
/** Make a key at run time; it lives as long as the result. */
IMK_API const char *imk_result_key(imk_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Add a number; null when it is not finite. */
IMK_API void imk_result_number(imk_result *result, const char *key, double value);
/** Add a whole number. */
IMK_API void imk_result_count(imk_result *result, const char *key, long long value);
/** Add a text. Bytes that are not UTF-8 become U+FFFD; NULL becomes null. */
IMK_API void imk_result_text(imk_result *result, const char *key, const char *text);
/** Add true or false. */
IMK_API void imk_result_flag(imk_result *result, const char *key, bool value);
/** Add null. */
IMK_API void imk_result_null(imk_result *result, const char *key);
/** Add a quantity, {"value": …, "unit": …}. */
IMK_API void imk_result_quantity(imk_result *result, const char *key, double value,
                                 const char *unit);
/** Add an array of numbers. */
IMK_API void imk_result_numbers(imk_result *result, const char *key, size_t count,
                                const double *values);
/** The text at a path of the data, such as "model.gyro.noise.gauss_markov[1].sigma"; NULL: there is
 *  none. */
IMK_API const char *imk_result_find(const imk_result *result, const char *path);
/** @} */

/** @name Judgement
 *  @{ */
/** What something can be used for. */
typedef enum imk_usability {
    IMK_USABLE = 0,       /**< no test found a fault */
    IMK_USABLE_WITH_CARE, /**< a fault or a doubt affects some of it */
    IMK_NOT_USABLE
} imk_usability;
/** Add the object "usability" of a part of the data: {"grade": …, "sentence": …}. */
IMK_API void imk_result_usability(imk_result *result, imk_usability usability,
                                  const char *sentence);
/** Judge the result as a whole: whether it can be used, for what, because of what. The sentence
 *  becomes the first line of the text and of the page; imk_result_usability() is called, too.
 *  @param format  one sentence, such as "Usable: no test found a fault." */
IMK_API void imk_result_judge(imk_result *result, imk_usability usability, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** @} */

/** Where an element of the display is shown. */
typedef enum imk_audience {
    IMK_FOR_TERMINAL = 1,
    IMK_FOR_PAGE = 2,
    IMK_FOR_BOTH = 3,
    IMK_FOR_PLOT = 4 /**< a figure that is neither on the terminal nor on the page: a plot draws it
                        before all others */
} imk_audience;
/** State where the elements added from now on are shown, until the next call. At first:
 *  IMK_FOR_BOTH. */
IMK_API void imk_result_for(imk_result *result, imk_audience audience);

/** @name Display
 *  @{ */
/** Set the title of the page and the line below the title. */
IMK_API void imk_result_title(imk_result *result, const char *title, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** Add a heading; on the terminal a line. */
IMK_API void imk_result_heading(imk_result *result, const char *text);
/** Text between these two is bold, in lines for the terminal only. */
#define IMK_BOLD "\x0e"
#define IMK_PLAIN "\x0f"
/** Add a paragraph; on the terminal a line, in which control characters and bytes that are not
 *  UTF-8 become "?". */
IMK_API void imk_result_line(imk_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Add an empty line on the terminal; nothing on the page. */
IMK_API void imk_result_gap(imk_result *result);
/** Add the message of a finding: a coloured box on the page, a line on the terminal.
 *  @param level  0 good, 1 note, 2 warning */
IMK_API void imk_result_finding(imk_result *result, int level, const char *text);
/** Add a text that is shown unchanged, such as a model file. */
IMK_API void imk_result_code(imk_result *result, const char *text);
/** Begin a new sheet when the page is printed; nothing on the terminal. */
IMK_API void imk_result_break(imk_result *result);
/** Add an animation to the page; nothing on the terminal. */
IMK_API void imk_result_animation(imk_result *result, const imk_animation *animation,
                                  const char *caption);

/** Add a drawing to the page, the SVG text of imk_schematic_svg() or imk_schematic_animated();
 *  nothing on the terminal.
 *  @param svg  NULL: there was no memory for it, which the result remembers */
IMK_API void imk_result_drawing(imk_result *result, const char *svg, const char *caption);

/** A table, filled row by row; the first row is the header. A table without rows is not shown. */
typedef struct imk_table imk_table;
/** Begin a table.
 *  @param right  bit c set: column c is aligned to the right
 *  @return NULL when memory is exhausted; the functions of tables accept NULL */
IMK_API imk_table *imk_result_table(imk_result *result, unsigned right);
/** Begin a row. Tabs separate the cells: "tau [s]\t%s [%s]". Control characters and bytes that are
 *  not UTF-8 become "?". */
IMK_API void imk_table_row(imk_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Add cells to the last row. */
IMK_API void imk_table_add(imk_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Number of rows so far, header included. */
IMK_API size_t imk_table_rows(const imk_table *table);
/** @} */

/** @name Figures
 *  @{ */
typedef struct imk_figure_builder imk_figure_builder;
/** Begin a figure. For the terminal, the figure is drawn when a plot is requested.
 *  @param columns  number of panels side by side */
IMK_API imk_figure_builder *imk_result_figure(imk_result *result, const char *title, size_t columns,
                                              const char *caption);
/** Add a panel: its texts, scales and key; curves and regions are added after it. */
IMK_API void imk_figure_panel(imk_figure_builder *figure, const imk_panel *panel);
/** Add a curve to the last panel. @param scale  y, lower and upper are divided by this */
IMK_API void imk_figure_curve(imk_figure_builder *figure, const imk_curve *curve, double scale);
/** Add a point to the last curve, which must have been added without points. */
IMK_API void imk_figure_point(imk_figure_builder *figure, double x, double y);
/** Add a point with its error bar, or a piece of a band. Either all points of a curve have one, or
 *  none. */
IMK_API void imk_figure_bar(imk_figure_builder *figure, double x, double y, double lower,
                            double upper);
/** Add a region to the last panel. */
IMK_API void imk_figure_region(imk_figure_builder *figure, const imk_region *region);
/** Figure `index` (from 0) among those shown in all places of `audience`; NULL beyond the last. */
IMK_API const imk_figure *imk_result_figure_get(const imk_result *result, imk_audience audience,
                                                size_t index);
/** @} */

/** @name Renderers
 *  Each makes a text obtained from malloc(), which the caller frees. `size` is its length [bytes].
 *  @return IMK_ERROR_MEMORY
 *  @{ */
/** Render the data as JSON. Numbers are the shortest decimals that read back to the same double. */
IMK_API imk_status imk_result_to_json(const imk_result *result, char **text, size_t *size);
/** Render the data on one line, members sorted by key and numbers to 17 digits, so that equal data
 *  give equal text. */
IMK_API imk_status imk_result_to_key(const imk_result *result, char **text, size_t *size);
/** Render the display for the terminal.
 *  @param bold,plain  escape sequences around the headers of tables; NULL: none */
IMK_API imk_status imk_result_to_text(const imk_result *result, const char *bold, const char *plain,
                                      char **text, size_t *size);
/** Render the display as a self-contained HTML page. Its figures and tables are interactive where
 *  scripts run, and complete where none do. It fetches nothing, and its Content-Security-Policy
 *  forbids it to.
 *  @param error  also tells why a figure could not be drawn */
IMK_API imk_status imk_result_to_page(const imk_result *result, char **text, size_t *size,
                                      imk_error *error);
/** Render the display as the <article> of that page, to be put into a page of others. That page
 *  needs the style sheet and the scripts of src/report/page, whose
 *  `imukitFigures.attach(element)` makes what is below an element interactive.
 *  @param error  also tells why a figure could not be drawn */
IMK_API imk_status imk_result_to_fragment(const imk_result *result, char **text, size_t *size,
                                          imk_error *error);
/** @} */

IMK_END_C
#endif
