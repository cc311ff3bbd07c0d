/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of several logs side by side: a table and a panel for each channel and
 * statistic, a column and a colour for each log. Channels are the same if they have one name and
 * dimension. */
#include "allan_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- data ------------------------------------------------------------------------------------ */

/* The log of which least can be said judges all. */
static void judge_all(const imk_allan_shown *shown, const imki_allan_judgement *judged,
                      imk_result *result)
{
    size_t worst = 0;
    for (size_t l = 1; l < shown->count; l++)
        if (judged[l].usability > judged[worst].usability)
            worst = l;
    imk_result_judge(result, judged[worst].usability, "%s: %s", shown->label[worst],
                     judged[worst].text);
}

static void show_data(const imk_allan_shown *shown, imk_result *result)
{
    imki_allan_judgement judged[IMK_ALLAN_LOGS_MAX] = {{IMK_USABLE, ""}};
    imk_result_object(result, "inputs");
    imk_result_array(result, "logs");
    for (size_t l = 0; l < shown->count; l++)
        imk_result_text(result, NULL, shown->name[l]);
    imk_result_end(result);
    imki_show_allan_settings(&shown->log[0]->settings, result);
    imk_result_end(result);
    imk_result_object(result, "result");
    for (size_t l = 0; l < shown->count; l++)
        judged[l] = imki_allan_judge(shown->log[l], result);
    judge_all(shown, judged, result);
    imk_result_array(result, "logs");
    for (size_t l = 0; l < shown->count; l++) {
        imk_result_object(result, NULL);
        imki_show_allan_record(shown->log[l], shown->name[l], result);
        imk_result_usability(result, judged[l].usability, judged[l].text);
        imki_show_allan_channels(shown->log[l], result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

/* ---- channels -------------------------------------------------------------------------------- */

/* One channel and statistic of all logs. */
typedef struct group {
    const char *channel;
    imk_allan_statistic statistic;
    imk_channel_kind kind;
    imk_unit unit;
    const imk_allan_curve *curve[IMK_ALLAN_LOGS_MAX]; /* NULL: the log has none */
} group;

static const imk_log_column *column_of(const imk_allan_log *a, size_t channel)
{
    return imk_even_record_column(&a->record, channel);
}

static bool is_same(const imk_log_column *a, const imk_log_column *b)
{
    const imk_unit one = imk_channel_plain_unit(a), other = imk_channel_plain_unit(b);
    return strcmp(a->name, b->name) == 0 &&
           memcmp(one.dimension.half, other.dimension.half, sizeof one.dimension.half) == 0;
}

/* The channel of a log that is that of another; record.count: none. */
static size_t find_channel(const imk_allan_log *a, const imk_log_column *column)
{
    size_t c = 0;
    while (c < a->record.count && !is_same(column_of(a, c), column))
        c++;
    return c;
}

/* Statistic k of channel c of log `first`. @return false: an earlier log has it, or none */
static bool make_group(const imk_allan_shown *shown, size_t first, size_t c, size_t k, group *g)
{
    const imk_log_column *column = column_of(shown->log[first], c);
    const imk_allan_curve *longest = NULL;
    *g = (group){.channel = column->name,
                 .statistic = shown->log[0]->settings.statistic[k],
                 .kind = imk_channel_kind_of(column)};
    for (size_t l = 0; l < shown->count; l++) {
        const imk_allan_log *a = shown->log[l];
        const size_t found = find_channel(a, column);
        if (found == a->record.count)
            continue;
        if (l < first)
            return false;
        const imk_allan_curve *curve = &a->curve[found][k];
        g->curve[l] = curve->count > 0 ? curve : NULL;
        if (g->curve[l] && (!longest || curve->count > longest->count))
            longest = curve;
    }
    if (longest)
        g->unit = imki_allan_readable_unit(shown->log[first], c, g->statistic,
                                           longest->deviation[longest->count / 2]);
    return longest != NULL;
}

/* ---- tables and panels ----------------------------------------------------------------------- */

/* The averaging time after `last` of any log; infinite at the end. */
static double next_time(const group *g, size_t count, double last)
{
    double next = HUGE_VAL;
    for (size_t l = 0; l < count; l++)
        for (size_t i = 0; g->curve[l] && i < g->curve[l]->count; i++)
            if (g->curve[l]->tau[i] > last * (1 + 1e-9))
                next = fmin(next, g->curve[l]->tau[i]);
    return next;
}

static void add_cell(const imk_allan_curve *curve, double tau, double scale, imk_table *table)
{
    for (size_t i = 0; i < curve->count; i++)
        if (fabs(curve->tau[i] - tau) <= 1e-9 * tau) {
            imk_table_add(table, "%.4g (%.4g to %.4g)", curve->deviation[i] / scale,
                          curve->lower[i] / scale, curve->upper[i] / scale);
            return;
        }
    imk_table_add(table, "-");
}

static void group_title(const imk_allan_shown *shown, const group *g, size_t size, char *title)
{
    const bool alone = shown->log[0]->settings.statistic_count == 1;
    snprintf(title, size, "%.60s%s%s", g->channel, alone ? "" : ", ",
             alone ? "" : imk_allan_title(g->statistic));
}

static void show_table(const imk_allan_shown *shown, const group *g, imk_result *result)
{
    char title[160];
    group_title(shown, g, sizeof title, title);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, title);
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s [%s]", title, g->unit.text);
    imk_result_for(result, IMK_FOR_BOTH);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "tau [s]");
    for (size_t l = 0; l < shown->count; l++)
        if (g->curve[l])
            imk_table_add(table, "%s [%s]", shown->label[l], g->unit.text);
    for (double tau = next_time(g, shown->count, 0); tau < HUGE_VAL;
         tau = next_time(g, shown->count, tau)) {
        imk_table_row(table, "%.6g", tau);
        for (size_t l = 0; l < shown->count; l++)
            if (g->curve[l])
                add_cell(g->curve[l], tau, g->unit.scale, table);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s", "");
}

static void show_panel(const imk_allan_shown *shown, const group *g, imk_figure_builder *figure)
{
    const imk_allan_log_settings *s = &shown->log[0]->settings;
    char label[120], title[160];
    const bool plain = s->statistic_count == 1 && g->statistic == IMK_ALLAN_OVERLAPPING;
    snprintf(label, sizeof label, "%.40s [%s]",
             plain ? "Allan deviation" : imk_allan_title(g->statistic), g->unit.text);
    group_title(shown, g, sizeof title, title);
    const imk_panel panel = {.title = title,
                             .x_label = "averaging time [s]",
                             .y_label = label,
                             .x_logarithmic = true,
                             .y_logarithmic = true,
                             .allan_deviation = g->statistic != IMK_ALLAN_TIME && !s->phase};
    imk_figure_panel(figure, &panel);
    for (size_t l = 0; l < shown->count; l++)
        if (g->curve[l])
            imki_show_allan_curve(g->curve[l], shown->label[l], (int)l, g->unit.scale, figure);
}

/* Each group once, by kind of sensor, in the order of the logs. */
static void show_groups(const imk_allan_shown *shown, imk_figure_builder *figure,
                        imk_result *result)
{
    group g;
    for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
        for (size_t k = 0; k < shown->log[0]->settings.statistic_count; k++)
            for (size_t l = 0; l < shown->count; l++)
                for (size_t c = 0; c < shown->log[l]->record.count; c++) {
                    if (imk_channel_kind_of(column_of(shown->log[l], c)) != kind ||
                        !make_group(shown, l, c, k, &g))
                        continue;
                    if (figure)
                        show_panel(shown, &g, figure);
                    else
                        show_table(shown, &g, result);
                }
}

void imk_show_allan_logs(const imk_allan_shown *shown, imk_result *result)
{
    if (shown->count == 1) {
        imk_show_allan_log(shown->log[0], shown->name[0], result);
        return;
    }
    show_data(shown, result);
    imk_result_title(result, "Allan deviation of several logs", "%zu logs, from %.60s to %.60s",
                     shown->count, shown->label[0], shown->label[shown->count - 1]);
    show_groups(shown,
                imk_result_figure(result, "Allan deviation of several logs", 3,
                                  "Points: the deviations of each log. Bands: their confidence "
                                  "intervals."),
                result);
    show_groups(shown, NULL, result);
    imk_result_line(result, "In brackets: %g %% confidence.",
                    100 * shown->log[0]->settings.confidence);
}
