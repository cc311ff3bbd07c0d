/* SPDX-License-Identifier: Apache-2.0 */
/** @file result.h
 *  What a job found, ready to be shown: one result, and renderers that make JSON, text and an HTML
 *  page of it.
 *
 *  A result has two parts. The data is a tree of named values: what `--json` prints. The display is
 *  a list of headings, lines, tables and figures, each for the terminal, the page, or both.
 *
 *  Memory that fails is remembered: no function that adds need be checked, the renderers return
 *  IMK_ERROR_MEMORY. Texts and numbers are copied. Part of libimukit-io; no file is opened and no
 *  program is run. */
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
 *  @return NULL when memory is exhausted, which every function here allows */
IMK_API imk_result *imk_result_create(const imk_allocator *allocator);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_result_free(imk_result *result);

/** @name Data
 *  Members of the object that was begun last, elements of the array (then `key` is NULL). The root
 *  is an object. Keys are kept, not copied: texts that outlive the result.
 *  @{ */
/** Begin an object. */
IMK_API void imk_result_object(imk_result *result, const char *key);
/** Begin an array. */
IMK_API void imk_result_array(imk_result *result, const char *key);
/** End the object or array that was begun last. */
IMK_API void imk_result_end(imk_result *result);
/** A key that is made at run time, which lives as long as the result. */
IMK_API const char *imk_result_key(imk_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** null when it is not finite. */
IMK_API void imk_result_number(imk_result *result, const char *key, double value);
/** A whole number. */
IMK_API void imk_result_count(imk_result *result, const char *key, long long value);
/** What is no UTF-8 becomes U+FFFD; NULL is null. */
IMK_API void imk_result_text(imk_result *result, const char *key, const char *text);
/** true or false. */
IMK_API void imk_result_flag(imk_result *result, const char *key, bool value);
/** null. */
IMK_API void imk_result_null(imk_result *result, const char *key);
/** {"value": …, "unit": …} */
IMK_API void imk_result_quantity(imk_result *result, const char *key, double value,
                                 const char *unit);
/** An array of numbers. */
IMK_API void imk_result_numbers(imk_result *result, const char *key, size_t count,
                                const double *values);
/** The text at a path of the data, "model.gyro.noise.gauss_markov[1].sigma"; NULL: none is there.
 */
IMK_API const char *imk_result_find(const imk_result *result, const char *path);
/** @} */

/** For whom what is added to the display from here on is meant; at first for both. */
typedef enum imk_audience {
    IMK_FOR_TERMINAL = 1,
    IMK_FOR_PAGE = 2,
    IMK_FOR_BOTH = 3,
    IMK_FOR_PLOT = 4 /**< a figure that stands nowhere: what a plot draws before all others */
} imk_audience;
/** Until it is called again. */
IMK_API void imk_result_for(imk_result *result, imk_audience audience);

/** @name Display
 *  @{ */
/** Title and the line below it, of the page. */
IMK_API void imk_result_title(imk_result *result, const char *title, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** A heading of the page; on the terminal a line. */
IMK_API void imk_result_heading(imk_result *result, const char *text);
/** What stands between the two is bold, in a line for the terminal alone. */
#define IMK_BOLD "\x0e"
#define IMK_PLAIN "\x0f"
/** A paragraph of the page; on the terminal a line, where control characters and what is no UTF-8
 *  become "?". */
IMK_API void imk_result_line(imk_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** An empty line on the terminal; nothing on the page. */
IMK_API void imk_result_gap(imk_result *result);
/** A finding in words: a coloured box of the page, a line on the terminal.
 *  @param level  0 good, 1 note, 2 warning */
IMK_API void imk_result_finding(imk_result *result, int level, const char *text);
/** Text as it is, such as a model file. */
IMK_API void imk_result_code(imk_result *result, const char *text);
/** On paper what follows begins a new sheet; nothing on the terminal. */
IMK_API void imk_result_break(imk_result *result);
/** A moving picture of the page; nothing on the terminal. */
IMK_API void imk_result_animation(imk_result *result, const imk_animation *animation,
                                  const char *caption);

/** Tables grow row by row; the first row is the header. One without rows is not shown. */
typedef struct imk_table imk_table;
/** @param right  bit c: the numbers of column c stand to the right
 *  @return NULL when memory is exhausted, which the functions of tables allow */
IMK_API imk_table *imk_result_table(imk_result *result, unsigned right);
/** Begin a row. Cells are what stands between tabs of the text: "tau [s]\t%s [%s]". Control
 *  characters and what is no UTF-8 become "?". */
IMK_API void imk_table_row(imk_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Add cells to the last row. */
IMK_API void imk_table_add(imk_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Rows so far, the header among them. */
IMK_API size_t imk_table_rows(const imk_table *table);
/** @} */

/** @name Figures
 *  @{ */
typedef struct imk_figure_builder imk_figure_builder;
/** Begin a figure of the display; for the terminal it is what a plot draws.
 *  @param columns  panels beside one another */
IMK_API imk_figure_builder *imk_result_figure(imk_result *result, const char *title, size_t columns,
                                              const char *caption);
/** Add a panel: its texts, scales and key; curves and regions are added after it. */
IMK_API void imk_figure_panel(imk_figure_builder *figure, const imk_panel *panel);
/** Add a curve to the last panel. @param scale  its y, lower and upper are divided by it */
IMK_API void imk_figure_curve(imk_figure_builder *figure, const imk_curve *curve, double scale);
/** Add a point to the last curve, which was begun without any. */
IMK_API void imk_figure_point(imk_figure_builder *figure, double x, double y);
/** The same with its error bar, or a piece of a band: all points of a curve have one, or none. */
IMK_API void imk_figure_bar(imk_figure_builder *figure, double x, double y, double lower,
                            double upper);
/** Add a region to the last panel. */
IMK_API void imk_figure_region(imk_figure_builder *figure, const imk_region *region);
/** The figure number `index` of those meant for all of `audience`; NULL beyond the last. */
IMK_API const imk_figure *imk_result_figure_get(const imk_result *result, imk_audience audience,
                                                size_t index);
/** @} */

/** @name Renderers
 *  Each makes a text obtained from malloc(), which is the caller's.
 *  @return IMK_ERROR_MEMORY
 *  @{ */
/** The data. Numbers are the shortest decimals that read back to the same double. */
IMK_API imk_status imk_result_to_json(const imk_result *result, char **text, size_t *size);
/** The data on one line, members in the order of their keys and numbers to 17 digits: equal data
 *  give equal text. */
IMK_API imk_status imk_result_to_key(const imk_result *result, char **text, size_t *size);
/** What is meant for the terminal. @param bold,plain  escape sequences around the heads of tables;
 *  NULL: none */
IMK_API imk_status imk_result_to_text(const imk_result *result, const char *bold, const char *plain,
                                      char **text, size_t *size);
/** What is meant for the page, self-contained. @param error  also says why a figure could not be
 *  drawn */
IMK_API imk_status imk_result_to_page(const imk_result *result, char **text, size_t *size,
                                      imk_error *error);
/** @} */

IMK_END_C
#endif
