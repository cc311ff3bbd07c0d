/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations as a table in a file, and as a result to be shown. */
#include "allan_output.h"

#include "log/channel_units.h"

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

/* Averaging times down, the channels of one kind across; nothing when there are none. */
static void show_table(const allan_result *a, channel_kind kind, size_t k, imk_result *result)
{
    const log_channels *channels = &a->channels;
    const allan_curve *member[IMK_LOG_COLUMNS_MAX], *first = NULL;
    const imk_log_column *column[IMK_LOG_COLUMNS_MAX];
    size_t members = 0;
    bool gaps = false;
    for (size_t c = 0; c < channels->count; c++) {
        const imk_log_column *of = log_channel_column(channels, c);
        if (channel_kind_of(of) != kind || a->curve[c][k].count == 0)
            continue;
        column[members] = of;
        member[members++] = &a->curve[c][k];
        gaps = gaps || a->curve[c][k].used;
    }
    if (members == 0)
        return;
    first = member[0];
    const imk_unit unit =
        readable_unit(a, column[0], a->statistic[k], first->deviation[first->count / 2]);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (a->statistic_count > 1)
        imk_result_line(result, "%s (%s)", imk_allan_title(a->statistic[k]),
                        imk_allan_name(a->statistic[k]));
    imk_result_for(result, IMK_FOR_BOTH);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "tau [s]");
    for (size_t j = 0; j < members; j++)
        imk_table_add(table, "%s [%s]", column[j]->name, unit.text);
    for (size_t j = 0; gaps && j < members; j++)
        imk_table_add(table, "%s used [%%]", column[j]->name);
    for (size_t i = 0; i < first->count; i++) {
        imk_table_row(table, "%.6g", first->tau[i]);
        for (size_t j = 0; j < members; j++)
            imk_table_add(table, "%.4g (%.4g to %.4g)", member[j]->deviation[i] / unit.scale,
                          member[j]->lower[i] / unit.scale, member[j]->upper[i] / unit.scale);
        for (size_t j = 0; gaps && j < members; j++)
            imk_table_add(table, "%.3g", member[j]->used ? 100 * member[j]->used[i] : 100);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s", "");
}

static void show_tables(const allan_result *a, imk_result *result)
{
    for (size_t k = 0; k < a->statistic_count; k++) {
        imk_result_for(result, IMK_FOR_PAGE);
        if (a->statistic_count > 1)
            imk_result_heading(result, imk_allan_title(a->statistic[k]));
        /* What a statistic cannot be taken of is said, not left out in silence. */
        imk_result_for(result, IMK_FOR_TERMINAL);
        if (a->curve[0][k].count == 0)
            imk_result_line(result, "%s: the record allows no such averaging time\n",
                            imk_allan_title(a->statistic[k]));
        for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
            show_table(a, kind, k, result);
    }
    imk_result_line(result, "In brackets: %g %% confidence.", 100 * a->options->confidence);
}

static void show_points(const allan_curve *curve, imk_unit unit, imk_result *result)
{
    imk_result_array(result, "points");
    for (size_t i = 0; i < curve->count; i++) {
        const imk_allan_point *p = &curve->point[i];
        imk_result_object(result, NULL);
        imk_result_quantity(result, "tau", curve->tau[i], "s");
        imk_result_quantity(result, "deviation", p->deviation / unit.scale, unit.text);
        imk_result_quantity(result, "lower", p->lower / unit.scale, unit.text);
        imk_result_quantity(result, "upper", p->upper / unit.scale, unit.text);
        imk_result_number(result, "edf", p->edf);
        imk_result_count(result, "count", (long long)p->count);
        imk_result_text(result, "noise", noise_name(p->type));
        imk_result_number(result, "used", curve->used ? curve->used[i] : 1);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_data(const allan_result *a, imk_result *result)
{
    static const char *const biases[] = {"removed", "published", "left"};
    const allan_options *o = a->options;
    const log_channels *channels = &a->channels;
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", a->path);
    imk_result_count(result, "rows", (long long)channels->rows);
    imk_result_quantity(result, "interval", channels->dt, "s");
    imk_result_text(result, "statistic", o->statistic ? o->statistic : "oadev");
    imk_result_number(result, "confidence", o->confidence);
    imk_result_text(result, "edf", o->edf ? "greenhall-riley" : "exact");
    imk_result_text(result, "bias", biases[o->bias]);
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_array(result, "channels");
    for (size_t c = 0; c < channels->count; c++)
        for (size_t k = 0; k < a->statistic_count; k++) {
            const imk_log_column *column = log_channel_column(channels, c);
            imk_result_object(result, NULL);
            imk_result_text(result, "name", column->name);
            imk_result_text(result, "statistic", imk_allan_name(a->statistic[k]));
            show_points(&a->curve[c][k], plain_unit(a, column, a->statistic[k]), result);
            imk_result_end(result);
        }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_curve(const allan_curve *curve, const char *name, int color, double scale,
                       imk_figure_builder *figure)
{
    const imk_curve band = {"",         IMK_CURVE_BAND,   color,        curve->count,
                            curve->tau, curve->deviation, curve->lower, curve->upper};
    imk_curve points = {name,       IMK_CURVE_POINTS, color, curve->count,
                        curve->tau, curve->deviation, NULL,  NULL};
    imk_figure_curve(figure, &band, scale);
    imk_figure_curve(figure, &points, scale);
}

/* One panel per kind of sensor (TDEV has panels of its own), one colour per channel and statistic,
 * intervals as bands. */
static void show_panel(const allan_result *a, channel_kind kind, bool time,
                       imk_figure_builder *figure)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    imk_unit unit = {.scale = 0};
    int color = 0;
    for (size_t c = 0; c < a->channels.count; c++)
        for (size_t k = 0; k < a->statistic_count; k++) {
            const imk_log_column *column = log_channel_column(&a->channels, c);
            const allan_curve *curve = &a->curve[c][k];
            const imk_allan_statistic statistic = a->statistic[k];
            const bool alone = a->statistic_count == 1;
            char text[120];
            if (channel_kind_of(column) != kind || (statistic == IMK_ALLAN_TIME) != time ||
                curve->count == 0)
                continue;
            if (color == 0) {
                unit = readable_unit(a, column, statistic, curve->deviation[curve->count / 2]);
                const char *what = alone && statistic == IMK_ALLAN_OVERLAPPING ? "Allan deviation"
                                   : alone || time ? imk_allan_title(statistic)
                                                   : "deviation";
                snprintf(text, sizeof text, "%.40s [%s]", what, unit.text);
                const imk_panel panel = {.title = titles[kind],
                                         .x_label = "averaging time [s]",
                                         .y_label = text,
                                         .x_logarithmic = true,
                                         .y_logarithmic = true};
                imk_figure_panel(figure, &panel);
            }
            snprintf(text, sizeof text, "%.50s%s%s", column->name, alone ? "" : " ",
                     alone ? "" : imk_allan_name(statistic));
            show_curve(curve, text, color++, unit.scale, figure);
        }
}

void allan_show(const allan_result *a, imk_result *result)
{
    const log_channels *channels = &a->channels;
    show_data(a, result);
    imk_result_title(result, "Allan deviation", "%.120s: %zu samples of %zu channels, %g Hz",
                     a->path, channels->rows, channels->count, 1 / channels->dt);
    imk_figure_builder *figure = imk_result_figure(
        result, a->path, 2, "Points: the deviations. Bands: their confidence intervals.");
    for (int time = 0; time < 2; time++)
        for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
            show_panel(a, kind, time == 1, figure);
    show_tables(a, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
}
