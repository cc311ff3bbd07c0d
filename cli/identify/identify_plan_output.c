/* SPDX-License-Identifier: Apache-2.0 */
/* What a plan of identify says: durations wanted, what each duration tells, and a figure. */
#include "identify_plan_parts.h"

#include "identify_parts.h"
#include "shell/json_output.h"
#include "shell/text_table.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DURATIONS = 6, CURVE_POINTS = 61 };

static const char *kind_of(const plan_row *row)
{
    return row->accel ? "accel" : "gyro";
}

/* 10 min to a day, and what is planned, in order; returns how many. */
static size_t durations(const identify_plan *p, double *duration)
{
    static const double usual[] = {600, 3600, 10800, 43200, 86400};
    size_t count = 0;
    bool placed = !(p->duration > 0);
    for (size_t k = 0; k < sizeof usual / sizeof usual[0]; k++) {
        if (!placed && p->duration <= usual[k] * 1.001) {
            placed = true;
            if (p->duration < usual[k] * 0.999)
                duration[count++] = p->duration;
        }
        duration[count++] = usual[k];
    }
    if (!placed)
        duration[count++] = p->duration;
    return count;
}

/* "2 h 46 min" is enough for a plan. */
static void format_rough(double seconds, char *text, size_t size)
{
    const double step = seconds < 600 ? 1 : seconds < 36000 ? 60 : 1800;
    if (seconds > 90 * 86400.0)
        snprintf(text, size, "%.3g days", seconds / 86400);
    else
        format_duration(ceil(seconds / step * 0.9999) * step, text, size);
}

static void put_header(text_table *table, const identify_plan *p, size_t count,
                       const double *duration)
{
    text_table_row(table);
    text_table_set(table, 0, "1 sigma, worst axis");
    text_table_set(table, 1, "model");
    text_table_set(table, 2, "unit");
    for (size_t d = 0; d < count; d++) {
        char text[60];
        format_rough(duration[d], text, sizeof text);
        text_table_set(table, 3 + d, "%s%s", text, duration[d] == p->duration ? " *" : "");
    }
}

/* "3.0 %", with the chance of being found where that is in doubt. */
static void put_cell(text_table *table, size_t column, const plan_cell *cell)
{
    char sigma[40];
    if (cell->relative < 10)
        snprintf(sigma, sizeof sigma, "%.2g %%", 100 * cell->relative);
    else
        snprintf(sigma, sizeof sigma, "-");
    if (cell->relative >= 0.995 && cell->relative < 10)
        snprintf(sigma, sizeof sigma, "%.0f %%", 100 * cell->relative);
    if (cell->detection < 0.995)
        text_table_set(table, column, "%s (found: %.0f %%)", sigma, 100 * cell->detection);
    else
        text_table_set(table, column, "%s", sigma);
}

static void print_cells(identify_plan *p)
{
    double duration[DURATIONS];
    const size_t count = durations(p, duration);
    plan_cell cell[DURATIONS][PLAN_ROWS_MAX];
    bool told[DURATIONS];
    for (size_t d = 0; d < count; d++)
        told[d] = identify_plan_cells(p, duration[d], cell[d]);
    text_table table = text_table_make(3 + count);
    put_header(&table, p, count, duration);
    for (size_t r = 0; r < p->row_count; r++) {
        const plan_row *row = &p->row[r];
        text_table_row(&table);
        text_table_set(&table, 0, "%s.%s", kind_of(row), row->key);
        if (row->high > 1.0005 * row->low)
            text_table_set(&table, 1, "%.3g ... %.3g", row->low / row->unit.scale,
                           row->high / row->unit.scale);
        else
            text_table_set(&table, 1, "%.4g", row->low / row->unit.scale);
        text_table_set(&table, 2, "%s", row->unit.text);
        for (size_t d = 0; d < count; d++)
            if (told[d])
                put_cell(&table, 3 + d,
                         row->time ? &(plan_cell){cell[d][r].relative, 1} : &cell[d][r]);
            else
                text_table_set(&table, 3 + d, "-"); /* too short or too long for any statement */
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
}

static void print_wishes(const identify_plan *p)
{
    text_table table = text_table_make(3);
    text_table_row(&table);
    text_table_set(&table, 0, "wanted");
    text_table_set(&table, 1, "of");
    text_table_set(&table, 2, "record");
    for (size_t k = 0; k < p->wish_count; k++) {
        const plan_wish *wish = &p->wish[k];
        char text[60] = "no record is long enough";
        if (isfinite(wish->duration))
            format_rough(wish->duration, text, sizeof text);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", wish->text);
        text_table_set(&table, 1, "%s.%s", kind_of(&p->row[wish->row]), p->row[wish->row].key);
        text_table_set(&table, 2, "%s%s", text,
                       isfinite(wish->duration) && wish->duration > p->duration ? " (longer than "
                                                                                  "planned)"
                                                                                : "");
    }
    if (p->wish_count > 0) {
        text_table_print(&table, stdout);
        putchar('\n');
    }
    text_table_free(&table);
}

void identify_plan_print(identify_plan *p)
{
    print_wishes(p);
    print_cells(p);
    printf("\nNo unbiased method does better; imukit identify comes within some per cent of it. "
           "\"found\" is the chance that a record of that length shows the term at all, at a "
           "significance of %g %%.\n",
           100 * p->settings.significance);
    if (p->duration > 0)
        printf("* as planned: keep the sensor at rest and its temperature constant so long.\n");
}

static json_t *cells_json(identify_plan *p)
{
    double duration[DURATIONS];
    const size_t count = durations(p, duration);
    json_t *list = json_array();
    for (size_t d = 0; d < count; d++) {
        plan_cell cell[PLAN_ROWS_MAX];
        json_t *terms = json_object();
        if (identify_plan_cells(p, duration[d], cell))
            for (size_t r = 0; r < p->row_count; r++) {
                char name[64];
                snprintf(name, sizeof name, "%s.%s", kind_of(&p->row[r]), p->row[r].key);
                json_object_set_new(terms, name,
                                    json_pack("{s:o, s:o}", "relative_sigma",
                                              json_number(cell[r].relative), "found",
                                              json_number(cell[r].detection)));
            }
        json_array_append_new(list, json_pack("{s:o, s:b, s:o}", "duration",
                                              json_quantity(duration[d], "s"), "planned",
                                              duration[d] == p->duration, "terms", terms));
    }
    return list;
}

int identify_plan_json(identify_plan *p, int code)
{
    json_t *wishes = json_array();
    for (size_t k = 0; k < p->wish_count; k++) {
        const plan_wish *wish = &p->wish[k];
        char name[64];
        snprintf(name, sizeof name, "%s.%s", kind_of(&p->row[wish->row]), p->row[wish->row].key);
        json_t *item = json_pack("{s:o, s:s, s:o}", "wish", json_text(wish->text), "term", name,
                                 "duration", json_quantity(wish->duration, "s"));
        json_object_set_new(item, wish->relative > 0 ? "relative_sigma" : "found",
                            json_number(wish->relative > 0 ? wish->relative : wish->detection));
        json_array_append_new(wishes, item);
    }
    return json_print("identify",
                      json_pack("{s:o, s:o}", "model", json_text(p->request->model), "rate",
                                json_quantity(p->request->rate, "Hz")),
                      json_pack("{s:o, s:o}", "wishes", wishes, "records", cells_json(p)), code);
}

int identify_plan_draw(identify_plan *p)
{
    static double hours[CURVE_POINTS];
    const size_t rows = p->row_count;
    double *value = malloc(rows * CURVE_POINTS * sizeof *value);
    char(*label)[64] = malloc(rows * sizeof *label);
    imk_curve *curve = calloc(rows, sizeof *curve);
    imk_panel panel[2];
    size_t panels = 0, first = 0;
    imk_error error;
    imk_status status = imk_error_set(&error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    if (value && label && curve) {
        const double low = log(256 * p->settings.dt > 60 ? 256 * p->settings.dt : 60);
        const double high = log(fmax(86400 * 7.0, 3 * p->duration));
        for (size_t k = 0; k < CURVE_POINTS; k++) {
            plan_cell cell[PLAN_ROWS_MAX];
            const double duration = exp(low + (high - low) * (double)k / (CURVE_POINTS - 1));
            const bool told = identify_plan_cells(p, duration, cell);
            hours[k] = duration / 3600;
            for (size_t r = 0; r < rows; r++)
                value[r * CURVE_POINTS + k] =
                    told && cell[r].relative < 2 ? 100 * cell[r].relative : (double)NAN;
        }
        for (size_t r = 0; r < rows; r++) {
            snprintf(label[r], sizeof label[r], "%s", p->row[r].key);
            curve[r] = (imk_curve){.label = label[r],
                                   .color = (int)(r - first),
                                   .style = p->row[r].time ? IMK_CURVE_DASHES : IMK_CURVE_LINE,
                                   .count = CURVE_POINTS,
                                   .x = hours,
                                   .y = value + r * CURVE_POINTS};
            if (r + 1 == rows || p->row[r + 1].accel != p->row[r].accel) {
                panel[panels++] = (imk_panel){.title = kind_of(&p->row[r]),
                                              .x_label = "record [h]",
                                              .y_label = "1 sigma, worst axis [%]",
                                              .x_logarithmic = true,
                                              .y_logarithmic = true,
                                              .curve_count = r + 1 - first,
                                              .curves = curve + first};
                first = r + 1;
            }
        }
        const imk_figure figure = {"What a record tells", panels, 2, panel};
        status = imk_figure_write(&figure, p->request->plot, &error);
    }
    free(value), free(label), free(curve);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
