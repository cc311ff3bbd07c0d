/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations as CSV, tables, JSON, a figure and a page. */
#include "allan_output.h"

#include "log/channel_units.h"
#include "shell/json_output.h"
#include "shell/page_table.h"
#include "shell/text_table.h"

#include "imukit/figure_file.h"

#include <stdlib.h>

/* Unit of the deviation as programs read it: phase is per second, TDEV times a second. */
static imk_unit plain_unit(const allan_result *result, const imk_log_column *column,
                           imk_allan_statistic statistic)
{
    imk_unit unit = channel_plain_unit(column);
    const bool phase = result->options->type == 1, time = statistic == IMK_ALLAN_TIME;
    if (phase != time) {
        const imk_unit column_unit = unit;
        snprintf(unit.text, sizeof unit.text, phase ? "%.40s/s" : "%.40s*s", column_unit.text);
    }
    return unit;
}

/* Unit a person reads the deviation in. */
static imk_unit readable_unit(const allan_result *result, const imk_log_column *column,
                              imk_allan_statistic statistic, double magnitude)
{
    if (result->options->type == 1)
        return plain_unit(result, column, statistic);
    imk_unit unit = channel_readable_unit(column, magnitude);
    if (statistic == IMK_ALLAN_TIME) {
        const imk_unit rate = unit;
        snprintf(unit.text, sizeof unit.text, "%.40s*s", rate.text);
    }
    return unit;
}

static const char *noise_name(imk_power_law type)
{
    switch (type) {
    case IMK_WHITE_PHASE:
        return "white-phase";
    case IMK_FLICKER_PHASE:
        return "flicker-phase";
    case IMK_WHITE_RATE:
        return "white-rate";
    case IMK_FLICKER_RATE:
        return "flicker-rate";
    case IMK_RANDOM_WALK_RATE:
        return "random-walk-rate";
    case IMK_FLICKER_WALK_RATE:
        return "flicker-walk-rate";
    case IMK_RANDOM_RUN_RATE:
        return "random-run-rate";
    }
    return "";
}

static void write_rows(const allan_result *result, size_t channel, size_t k, imk_output_file *file)
{
    const imk_log_column *column = log_channel_column(&result->channels, channel);
    const allan_curve *curve = &result->curve[channel][k];
    const imk_unit unit = plain_unit(result, column, result->statistic[k]);
    for (size_t i = 0; i < curve->count; i++) {
        const imk_allan_point *point = &curve->point[i];
        const double values[] = {curve->tau[i], point->deviation / unit.scale,
                                 point->lower / unit.scale, point->upper / unit.scale};
        imk_output_file_print(file, "%s", column->name);
        for (int j = 0; j < 4; j++) {
            char text[IMK_DECIMAL_SIZE];
            text[imk_decimal_shortest(values[j], text)] = '\0';
            imk_output_file_print(file, ",%s", text);
        }
        char edf[IMK_DECIMAL_SIZE], used[IMK_DECIMAL_SIZE];
        edf[imk_decimal_significant(point->edf, 6, edf)] = '\0';
        used[imk_decimal_significant(curve->used ? curve->used[i] : 1, 6, used)] = '\0';
        imk_output_file_print(file, ",%s,%zu,%s,%s,%s,%s\n", edf, point->count, unit.text,
                              imk_allan_name(result->statistic[k]), noise_name(point->type), used);
    }
}

int allan_write_csv(const allan_result *result, const char *output)
{
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(output, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "channel,tau [s],deviation [unit],lower,upper,edf,count,unit,"
                                "statistic,noise,used\n");
    for (size_t c = 0; c < result->channels.count; c++)
        for (size_t k = 0; k < result->statistic_count; k++)
            write_rows(result, c, k, file);
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

/* Averaging times down, the channels of one kind across; no rows when there are none. */
static text_table make_table(const allan_result *result, channel_kind kind, size_t k)
{
    const log_channels *channels = &result->channels;
    size_t member[IMK_LOG_COLUMNS_MAX], members = 0;
    bool gaps = false;
    for (size_t c = 0; c < channels->count; c++)
        if (channel_kind_of(log_channel_column(channels, c)) == kind &&
            result->curve[c][k].count > 0) {
            member[members++] = c;
            gaps = gaps || result->curve[c][k].used;
        }
    text_table table = text_table_make(1 + members + (gaps ? members : 0));
    if (members == 0)
        return table;
    const allan_curve *first = &result->curve[member[0]][k];
    imk_unit unit = readable_unit(result, log_channel_column(channels, member[0]),
                                  result->statistic[k], first->deviation[first->count / 2]);
    text_table_row(&table);
    text_table_set(&table, 0, "tau [s]");
    for (size_t j = 0; j < members; j++) {
        const char *name = log_channel_column(channels, member[j])->name;
        text_table_set(&table, 1 + j, "%s [%s]", name, unit.text);
        if (gaps)
            text_table_set(&table, 1 + members + j, "%s used [%%]", name);
    }
    for (size_t i = 0; i < first->count; i++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%.6g", first->tau[i]);
        for (size_t j = 0; j < members; j++) {
            const allan_curve *curve = &result->curve[member[j]][k];
            text_table_set(&table, 1 + j, "%.4g (%.4g to %.4g)", curve->deviation[i] / unit.scale,
                           curve->lower[i] / unit.scale, curve->upper[i] / unit.scale);
            if (gaps)
                text_table_set(&table, 1 + members + j, "%.3g",
                               curve->used ? 100 * curve->used[i] : 100);
        }
    }
    return table;
}

/* What a statistic cannot be taken of is said, not left out in silence. */
static void print_missing(const allan_result *result, size_t k)
{
    if (result->curve[0][k].count == 0)
        printf("%s: the record allows no such averaging time\n\n",
               imk_allan_title(result->statistic[k]));
}

void allan_print_tables(const allan_result *result)
{
    for (size_t k = 0; k < result->statistic_count; k++) {
        print_missing(result, k);
        for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
            text_table table = make_table(result, kind, k);
            if (table.rows > 0) {
                if (result->statistic_count > 1)
                    printf("%s (%s)\n", imk_allan_title(result->statistic[k]),
                           imk_allan_name(result->statistic[k]));
                text_table_print(&table, stdout);
                putchar('\n');
            }
            text_table_free(&table);
        }
    }
    printf("In brackets: %g %% confidence.\n", 100 * result->options->confidence);
}

static json_t *json_points(const allan_curve *curve, imk_unit unit)
{
    json_t *points = json_array();
    for (size_t i = 0; i < curve->count; i++) {
        const imk_allan_point *p = &curve->point[i];
        json_array_append_new(points,
                              json_pack("{s:o, s:o, s:o, s:o, s:o, s:I, s:s, s:o}", "tau",
                                        json_quantity(curve->tau[i], "s"), "deviation",
                                        json_quantity(p->deviation / unit.scale, unit.text),
                                        "lower", json_quantity(p->lower / unit.scale, unit.text),
                                        "upper", json_quantity(p->upper / unit.scale, unit.text),
                                        "edf", json_number(p->edf), "count", (json_int_t)p->count,
                                        "noise", noise_name(p->type), "used",
                                        json_number(curve->used ? curve->used[i] : 1)));
    }
    return points;
}

int allan_print_json(const allan_result *result)
{
    static const char *const biases[] = {"removed", "published", "left"};
    const allan_options *o = result->options;
    const log_channels *channels = &result->channels;
    json_t *list = json_array();
    for (size_t c = 0; c < channels->count; c++)
        for (size_t k = 0; k < result->statistic_count; k++) {
            const imk_log_column *column = log_channel_column(channels, c);
            json_array_append_new(
                list, json_pack("{s:o, s:s, s:o}", "name", json_text(column->name), "statistic",
                                imk_allan_name(result->statistic[k]), "points",
                                json_points(&result->curve[c][k],
                                            plain_unit(result, column, result->statistic[k]))));
        }
    json_t *inputs =
        json_pack("{s:o, s:I, s:o, s:s, s:f, s:s, s:s}", "log", json_text(result->path), "rows",
                  (json_int_t)channels->rows, "interval", json_quantity(channels->dt, "s"),
                  "statistic", o->statistic ? o->statistic : "oadev", "confidence", o->confidence,
                  "edf", o->edf ? "greenhall-riley" : "exact", "bias", biases[o->bias]);
    int code = json_print("allan", inputs, json_pack("{s:o}", "channels", list), EXIT_DONE);
    return code == EXIT_DONE ? -1 : code;
}

/* One panel per kind of sensor (TDEV has panels of its own), one colour per channel and statistic,
 * intervals as bands. */
typedef struct allan_figure {
    imk_figure figure;
    imk_panel panel[2 * CHANNEL_KINDS];
    imk_curve curve[2 * IMK_LOG_COLUMNS_MAX * IMK_ALLAN_STATISTICS];
    char name[IMK_LOG_COLUMNS_MAX * IMK_ALLAN_STATISTICS][80];
    char label[2 * CHANNEL_KINDS][100];
    double *memory; /* deviations and limits in the unit of their panel */
} allan_figure;

static void add_curve(allan_figure *f, size_t *used, const char *name, const allan_curve *curve,
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

static void add_panel(allan_figure *f, const allan_result *result, channel_kind kind, bool time,
                      size_t *used, double **rest)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    size_t first = *used, panel = f->figure.panel_count;
    imk_unit unit = {.scale = 0};
    for (size_t c = 0; c < result->channels.count; c++)
        for (size_t k = 0; k < result->statistic_count; k++) {
            const imk_log_column *column = log_channel_column(&result->channels, c);
            const allan_curve *curve = &result->curve[c][k];
            const imk_allan_statistic statistic = result->statistic[k];
            if (channel_kind_of(column) != kind || (statistic == IMK_ALLAN_TIME) != time ||
                curve->count == 0)
                continue;
            if (!(unit.scale > 0))
                unit = readable_unit(result, column, statistic, curve->deviation[curve->count / 2]);
            char *name = f->name[*used / 2];
            snprintf(name, sizeof f->name[0], "%.50s%s%s", column->name,
                     result->statistic_count > 1 ? " " : "",
                     result->statistic_count > 1 ? imk_allan_name(statistic) : "");
            add_curve(f, used, name, curve, unit.scale, (int)(*used - first) / 2, rest);
        }
    if (*used == first)
        return;
    const char *what = result->statistic_count == 1 ? imk_allan_title(result->statistic[0])
                       : time                       ? imk_allan_title(IMK_ALLAN_TIME)
                                                    : "deviation";
    snprintf(f->label[panel], sizeof f->label[panel], "%.40s [%s]",
             result->statistic_count == 1 && result->statistic[0] == IMK_ALLAN_OVERLAPPING
                 ? "Allan deviation"
                 : what,
             unit.text);
    f->panel[panel] = (imk_panel){titles[kind], "averaging time [s]", f->label[panel],  true,
                                  true,         *used - first,        f->curve + first, 0,
                                  NULL,         IMK_KEY_UPPER};
    f->figure.panel_count++;
}

static allan_figure *make_figure(const allan_result *result)
{
    size_t points = 0, used = 0;
    for (size_t c = 0; c < result->channels.count; c++)
        for (size_t k = 0; k < result->statistic_count; k++)
            points += result->curve[c][k].count;
    allan_figure *f = command_memory(NULL, sizeof *f);
    *f = (allan_figure){.memory = command_memory(NULL, (3 * points + 1) * sizeof *f->memory),
                        .figure = {result->path, 0, 2, f->panel}};
    double *rest = f->memory;
    for (int time = 0; time < 2; time++)
        for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
            add_panel(f, result, kind, time == 1, &used, &rest);
    return f;
}

static void free_figure(allan_figure *f)
{
    free(f->memory);
    free(f);
}

int allan_draw(const allan_result *result, const char *plot)
{
    imk_error error;
    allan_figure *f = make_figure(result);
    imk_status status = imk_figure_write(&f->figure, plot, &error);
    free_figure(f);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

int allan_write_report(const allan_result *result, const char *path)
{
    char subtitle[300];
    allan_figure *f = make_figure(result);
    snprintf(subtitle, sizeof subtitle, "%.120s: %zu samples of %zu channels, %g Hz", result->path,
             result->channels.rows, result->channels.count, 1 / result->channels.dt);
    imk_page *page = imk_page_create("Allan deviation", subtitle);
    imk_page_figure(page, &f->figure, "Points: the deviations. Bands: their confidence intervals.");
    for (size_t k = 0; k < result->statistic_count; k++) {
        if (result->statistic_count > 1)
            imk_page_heading(page, imk_allan_title(result->statistic[k]));
        for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
            text_table table = make_table(result, kind, k);
            page_put_table(page, &table);
            text_table_free(&table);
        }
    }
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    free_figure(f);
    return page_write(page, path);
}
