/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations as CSV, tables, JSON, a figure and a page. */
#include "allan_output.h"

#include "channel_units.h"
#include "json_output.h"
#include "page_table.h"
#include "text_table.h"

#include <stdlib.h>

/* Unit of the deviation as programs read it: phase is per second. */
static imk_unit plain_unit(const allan_result *result, const imk_log_column *column)
{
    imk_unit unit = channel_plain_unit(column);
    if (result->options->type == 1) {
        imk_unit phase = unit;
        snprintf(unit.text, sizeof unit.text, "%.40s/s", phase.text);
    }
    return unit;
}

/* Unit a person reads the deviation in. */
static imk_unit readable_unit(const allan_result *result, const imk_log_column *column,
                              double magnitude)
{
    return result->options->type == 1 ? plain_unit(result, column)
                                      : channel_readable_unit(column, magnitude);
}

int allan_write_csv(const allan_result *result, const char *output)
{
    const log_channels *channels = &result->channels;
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(output, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "channel,tau [s],deviation [unit],lower,upper,edf,count,unit\n");
    for (size_t c = 0; c < channels->count; c++) {
        const imk_log_column *column = log_channel_column(channels, c);
        const allan_curve *curve = &result->curve[c];
        imk_unit unit = plain_unit(result, column);
        for (size_t i = 0; i < curve->count; i++) {
            const imk_allan_point *point = &curve->point[i];
            const double values[] = {curve->tau[i], point->deviation / unit.scale,
                                     point->lower / unit.scale, point->upper / unit.scale};
            imk_output_file_print(file, "%s", column->name);
            for (int k = 0; k < 4; k++) {
                char text[IMK_DECIMAL_SIZE];
                text[imk_decimal_shortest(values[k], text)] = '\0';
                imk_output_file_print(file, ",%s", text);
            }
            char edf[IMK_DECIMAL_SIZE];
            edf[imk_decimal_significant(point->edf, 6, edf)] = '\0';
            imk_output_file_print(file, ",%s,%zu,%s\n", edf, point->count, unit.text);
        }
    }
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

/* Averaging times down, the channels of one kind across; no rows when there are none. */
static text_table make_table(const allan_result *result, channel_kind kind)
{
    const log_channels *channels = &result->channels;
    size_t member[IMK_LOG_COLUMNS_MAX], members = 0;
    for (size_t c = 0; c < channels->count; c++)
        if (channel_kind_of(log_channel_column(channels, c)) == kind)
            member[members++] = c;
    text_table table = text_table_make(1 + members);
    if (members == 0)
        return table;
    const allan_curve *first = &result->curve[member[0]];
    imk_unit unit = readable_unit(result, log_channel_column(channels, member[0]),
                                  first->deviation[first->count / 2]);
    text_table_row(&table);
    text_table_set(&table, 0, "tau [s]");
    for (size_t k = 0; k < members; k++)
        text_table_set(&table, 1 + k, "%s [%s]", log_channel_column(channels, member[k])->name,
                       unit.text);
    for (size_t i = 0; i < first->count; i++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%.6g", first->tau[i]);
        for (size_t k = 0; k < members; k++) {
            const allan_curve *curve = &result->curve[member[k]];
            text_table_set(&table, 1 + k, "%.4g (%.4g to %.4g)", curve->deviation[i] / unit.scale,
                           curve->lower[i] / unit.scale, curve->upper[i] / unit.scale);
        }
    }
    return table;
}

void allan_print_tables(const allan_result *result)
{
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = make_table(result, kind);
        if (table.rows > 0) {
            text_table_print(&table, stdout);
            putchar('\n');
        }
        text_table_free(&table);
    }
    printf("In brackets: %g %% confidence.\n", 100 * result->options->confidence);
}

int allan_print_json(const allan_result *result)
{
    const allan_options *o = result->options;
    const log_channels *channels = &result->channels;
    json_t *list = json_array();
    for (size_t c = 0; c < channels->count; c++) {
        const allan_curve *curve = &result->curve[c];
        imk_unit unit = plain_unit(result, log_channel_column(channels, c));
        json_t *points = json_array();
        for (size_t i = 0; i < curve->count; i++) {
            const imk_allan_point *p = &curve->point[i];
            json_array_append_new(
                points, json_pack("{s:o, s:o, s:o, s:o, s:o, s:I}", "tau",
                                  json_quantity(curve->tau[i], "s"), "deviation",
                                  json_quantity(p->deviation / unit.scale, unit.text), "lower",
                                  json_quantity(p->lower / unit.scale, unit.text), "upper",
                                  json_quantity(p->upper / unit.scale, unit.text), "edf",
                                  json_number(p->edf), "count", (json_int_t)p->count));
        }
        json_array_append_new(list,
                              json_pack("{s:s, s:o}", "name", log_channel_column(channels, c)->name,
                                        "points", points));
    }
    json_t *inputs = json_pack(
        "{s:s, s:I, s:o, s:s, s:f, s:s}", "log", result->path, "rows", (json_int_t)channels->rows,
        "interval", json_quantity(channels->dt, "s"), "statistic", o->statistic ? "adev" : "oadev",
        "confidence", o->confidence, "edf", o->edf ? "greenhall-riley" : "exact");
    int code = json_print("allan", inputs, json_pack("{s:o}", "channels", list), EXIT_DONE);
    return code == EXIT_DONE ? -1 : code;
}

/* One panel per kind of sensor, one colour per channel, intervals as bands. */
typedef struct allan_figure {
    imk_figure figure;
    imk_panel panel[CHANNEL_KINDS];
    imk_curve curve[2 * IMK_LOG_COLUMNS_MAX];
    char label[CHANNEL_KINDS][80];
    double *memory; /* deviations and limits in the unit of their panel */
} allan_figure;

static void add_channel(allan_figure *f, size_t *used, const char *name, const allan_curve *curve,
                        double scale, int color, double **rest)
{
    double *deviation = *rest, *lower = deviation + curve->count, *upper = lower + curve->count;
    *rest = upper + curve->count;
    for (size_t i = 0; i < curve->count; i++) {
        deviation[i] = curve->deviation[i] / scale;
        lower[i] = curve->lower[i] / scale;
        upper[i] = curve->upper[i] / scale;
    }
    f->curve[(*used)++] =
        (imk_curve){"", IMK_CURVE_BAND, color, curve->count, curve->tau, deviation, lower, upper};
    f->curve[(*used)++] =
        (imk_curve){name, IMK_CURVE_POINTS, color, curve->count, curve->tau, deviation, NULL, NULL};
}

static void add_panel(allan_figure *f, const allan_result *result, channel_kind kind, size_t *used,
                      double **rest)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    size_t first = *used, panel = f->figure.panel_count;
    imk_unit unit = {.scale = 0};
    for (size_t c = 0; c < result->channels.count; c++) {
        const imk_log_column *column = log_channel_column(&result->channels, c);
        const allan_curve *curve = &result->curve[c];
        if (channel_kind_of(column) != kind)
            continue;
        if (!(unit.scale > 0))
            unit = readable_unit(result, column, curve->deviation[curve->count / 2]);
        add_channel(f, used, column->name, curve, unit.scale, (int)(*used - first) / 2, rest);
    }
    if (*used == first)
        return;
    snprintf(f->label[panel], sizeof f->label[panel], "Allan deviation [%s]", unit.text);
    f->panel[panel] = (imk_panel){titles[kind], "averaging time [s]", f->label[panel],  true,
                                  true,         *used - first,        f->curve + first, 0,
                                  NULL,         IMK_KEY_UPPER};
    f->figure.panel_count++;
}

static bool make_figure(const allan_result *result, allan_figure *f)
{
    size_t points = 0, used = 0;
    for (size_t c = 0; c < result->channels.count; c++)
        points += result->curve[c].count;
    f->memory = malloc((3 * points + 1) * sizeof *f->memory);
    if (!f->memory)
        return false;
    double *rest = f->memory;
    f->figure = (imk_figure){result->path, 0, 2, f->panel};
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
        add_panel(f, result, kind, &used, &rest);
    return true;
}

int allan_draw(const allan_result *result, const char *plot)
{
    allan_figure f;
    imk_error error;
    if (!make_figure(result, &f))
        return command_failed("memory is exhausted");
    imk_status status = imk_figure_write(&f.figure, plot, &error);
    free(f.memory);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

int allan_write_report(const allan_result *result, const char *path)
{
    allan_figure f;
    imk_error error;
    char subtitle[300];
    if (!make_figure(result, &f))
        return command_failed("memory is exhausted");
    snprintf(subtitle, sizeof subtitle, "%.120s: %zu samples of %zu channels, %g Hz", result->path,
             result->channels.rows, result->channels.count, 1 / result->channels.dt);
    imk_page *page = imk_page_create("Allan deviation", subtitle);
    imk_page_figure(page, &f.figure, "Points: the deviations. Bands: their confidence intervals.");
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = make_table(result, kind);
        page_put_table(page, &table);
        text_table_free(&table);
    }
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    imk_status status = imk_page_write(page, path, &error);
    free(f.memory);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
