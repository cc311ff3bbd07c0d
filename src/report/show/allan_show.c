/* SPDX-License-Identifier: Apache-2.0 */
/* The display of Allan deviations: data, tables, a figure. */
#include "allan_show_internal.h"

#include <math.h>
#include <stdio.h>

imk_unit imk_allan_log_unit(const imk_allan_log *allan, size_t channel,
                            imk_allan_statistic statistic)
{
    imk_unit unit = imk_channel_plain_unit(imk_even_record_column(&allan->record, channel));
    const bool phase = allan->settings.phase, time = statistic == IMK_ALLAN_TIME;
    if (phase != time) {
        const imk_unit column_unit = unit;
        snprintf(unit.text, sizeof unit.text, phase ? "%.40s/s" : "%.40s*s", column_unit.text);
    }
    return unit;
}

imk_unit imki_allan_readable_unit(const imk_allan_log *a, size_t channel,
                                  imk_allan_statistic statistic, double magnitude)
{
    if (a->settings.phase)
        return imk_allan_log_unit(a, channel, statistic);
    imk_unit unit =
        imk_channel_readable_unit(imk_even_record_column(&a->record, channel), magnitude);
    if (statistic == IMK_ALLAN_TIME) {
        const imk_unit rate = unit;
        snprintf(unit.text, sizeof unit.text, "%.40s*s", rate.text);
    }
    return unit;
}

const char *imk_power_law_name(imk_power_law type)
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

/* Averaging times down, the channels of one kind across; nothing when there are none. */
static void show_table(const imk_allan_log *a, imk_channel_kind kind, size_t k, imk_result *result)
{
    const imk_allan_statistic statistic = a->settings.statistic[k];
    const imk_allan_curve *curve[IMK_LOG_COLUMNS_MAX];
    size_t member[IMK_LOG_COLUMNS_MAX], members = 0;
    bool gaps = false;
    for (size_t c = 0; c < a->record.count; c++) {
        if (imk_channel_kind_of(imk_even_record_column(&a->record, c)) != kind ||
            a->curve[c][k].count == 0)
            continue;
        curve[members] = &a->curve[c][k];
        gaps = gaps || curve[members]->used;
        member[members++] = c;
    }
    if (members == 0)
        return;
    const imk_allan_curve *first = curve[0];
    const imk_unit unit =
        imki_allan_readable_unit(a, member[0], statistic, first->deviation[first->count / 2]);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (a->settings.statistic_count > 1)
        imk_result_line(result, "%s (%s)", imk_allan_title(statistic), imk_allan_name(statistic));
    imk_result_for(result, IMK_FOR_BOTH);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "tau [s]");
    for (size_t j = 0; j < members; j++)
        imk_table_add(table, "%s [%s]", imk_even_record_column(&a->record, member[j])->name,
                      unit.text);
    for (size_t j = 0; gaps && j < members; j++)
        imk_table_add(table, "%s used [%%]", imk_even_record_column(&a->record, member[j])->name);
    for (size_t i = 0; i < first->count; i++) {
        imk_table_row(table, "%.6g", first->tau[i]);
        for (size_t j = 0; j < members; j++)
            imk_table_add(table, "%.4g (%.4g to %.4g)", curve[j]->deviation[i] / unit.scale,
                          curve[j]->lower[i] / unit.scale, curve[j]->upper[i] / unit.scale);
        for (size_t j = 0; gaps && j < members; j++)
            imk_table_add(table, "%.3g", curve[j]->used ? 100 * curve[j]->used[i] : 100);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s", "");
}

static void show_tables(const imk_allan_log *a, imk_result *result)
{
    for (size_t k = 0; k < a->settings.statistic_count; k++) {
        imk_result_for(result, IMK_FOR_PAGE);
        if (a->settings.statistic_count > 1)
            imk_result_heading(result, imk_allan_title(a->settings.statistic[k]));
        /* A statistic that cannot be computed gets a line; it is not left out silently. */
        imk_result_for(result, IMK_FOR_TERMINAL);
        if (a->curve[0][k].count == 0)
            imk_result_line(result, "%s: the record allows none of these averaging times\n",
                            imk_allan_title(a->settings.statistic[k]));
        for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
            show_table(a, kind, k, result);
    }
    imk_result_line(result, "In brackets: %g %% confidence.", 100 * a->settings.confidence);
}

/* ---- judgement ------------------------------------------------------------------------------- */

/* A deviation whose interval ends less than this part above it can be read off; a value of which
 * nothing is known but that it is not twice as large cannot. */
static const double known_well = 0.3, known_at_all = 1;

/* How far above the deviations their intervals end at averaging time `i`, at worst. */
static double uncertainty_at(const imk_allan_log *a, size_t k, size_t i)
{
    double most = 0;
    for (size_t c = 0; c < a->record.count; c++) {
        const imk_allan_curve *curve = &a->curve[c][k];
        most = i < curve->count ? fmax(most, curve->upper[i] / curve->deviation[i] - 1) : HUGE_VAL;
    }
    return most;
}

/* Curves that still fall at averaging time `last`, whose floor is not seen. */
static size_t falling(const imk_allan_log *a, size_t k, size_t last)
{
    size_t count = 0;
    for (size_t c = 0; c < a->record.count; c++) {
        const double *deviation = a->curve[c][k].deviation;
        bool lowest = true;
        for (size_t i = 0; i < last; i++)
            lowest = lowest && deviation[i] > deviation[last];
        count += lowest;
    }
    return count;
}

static void judge_floors(const imk_allan_log *a, size_t k, size_t last, imki_reasons *reasons)
{
    const size_t count = falling(a, k, last);
    if (a->settings.phase || a->settings.statistic[k] == IMK_ALLAN_TIME || count == 0)
        return;
    if (count == a->record.count)
        imki_reason(reasons, "no curve has reached its floor there");
    else
        imki_reason(reasons, "%zu of %zu curves have not reached their floor there", count,
                    a->record.count);
}

/* To which averaging time the first statistic can be read. */
imki_allan_judgement imki_allan_judge(const imk_allan_log *a, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    char use[80] = "";
    size_t k = 0, points = 0;
    while (k + 1 < a->settings.statistic_count && a->curve[0][k].count == 0)
        k++;
    const imk_allan_curve *curve = &a->curve[0][k];
    while (points < curve->count && uncertainty_at(a, k, points) <= known_well)
        points++;
    const bool poor = points == 0;
    while (points < curve->count && poor && uncertainty_at(a, k, points) <= known_at_all)
        points++;
    if (points > 0)
        snprintf(use, sizeof use, " up to tau = %.4g s", curve->tau[points - 1]);
    imki_reasons_of_warnings(&reasons, &a->findings);
    const imk_usability usability = points == 0                ? IMK_NOT_USABLE
                                    : poor || reasons.told > 0 ? IMK_USABLE_WITH_CARE
                                                               : IMK_USABLE;
    if (points == 0)
        imki_reason(&reasons,
                    "no deviation is known to a factor of two, as the record has only %zu rows",
                    a->record.rows);
    else if (points < curve->count && isfinite(uncertainty_at(a, k, curve->count - 1)))
        imki_reason(&reasons, "each deviation is known to %.0f %% there, and to %.0f %% at %.4g s",
                    100 * uncertainty_at(a, k, points - 1),
                    100 * uncertainty_at(a, k, curve->count - 1), curve->tau[curve->count - 1]);
    else
        imki_reason(&reasons, "each deviation is known to %.0f %% there",
                    100 * uncertainty_at(a, k, points - 1));
    if (points > 2)
        judge_floors(a, k, points - 1, &reasons);
    return (imki_allan_judgement){usability, imki_judgement(&reasons, usability, use)};
}

/* ---- data ------------------------------------------------------------------------------------ */

static void show_points(const imk_allan_curve *curve, imk_unit unit, imk_result *result)
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
        imk_result_text(result, "noise", imk_power_law_name(p->type));
        imk_result_number(result, "used", curve->used ? curve->used[i] : 1);
        imk_result_end(result);
    }
    imk_result_end(result);
}

/* "oadev,mdev", as they are asked for */
static void show_statistics(const imk_allan_log_settings *s, imk_result *result)
{
    char text[16 * IMK_ALLAN_STATISTICS] = "all";
    for (size_t k = 0, used = 0;
         s->statistic_count < IMK_ALLAN_STATISTICS && k < s->statistic_count; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", k > 0 ? "," : "",
                                 imk_allan_name(s->statistic[k]));
    imk_result_text(result, "statistic", text);
}

void imki_show_allan_record(const imk_allan_log *a, const char *name, imk_result *result)
{
    imk_result_text(result, "log", name);
    imk_result_count(result, "rows", (long long)a->record.rows);
    imk_result_quantity(result, "interval", a->record.dt, "s");
}

void imki_show_allan_settings(const imk_allan_log_settings *s, imk_result *result)
{
    static const char *const biases[] = {"removed", "published", "left"};
    show_statistics(s, result);
    imk_result_number(result, "confidence", s->confidence);
    imk_result_text(result, "edf", s->greenhall_riley ? "greenhall-riley" : "exact");
    imk_result_text(result, "bias", biases[s->bias]);
}

void imki_show_allan_channels(const imk_allan_log *a, imk_result *result)
{
    const imk_allan_log_settings *s = &a->settings;
    imk_result_array(result, "channels");
    for (size_t c = 0; c < a->record.count; c++)
        for (size_t k = 0; k < s->statistic_count; k++) {
            imk_result_object(result, NULL);
            imk_result_text(result, "name", imk_even_record_column(&a->record, c)->name);
            imk_result_text(result, "statistic", imk_allan_name(s->statistic[k]));
            show_points(&a->curve[c][k], imk_allan_log_unit(a, c, s->statistic[k]), result);
            imk_result_end(result);
        }
    imk_result_end(result);
}

static void show_data(const imk_allan_log *a, const char *name, imk_result *result)
{
    imk_result_object(result, "inputs");
    imki_show_allan_record(a, name, result);
    imki_show_allan_settings(&a->settings, result);
    imk_result_end(result);
    imk_result_object(result, "result");
    const imki_allan_judgement judged = imki_allan_judge(a, result);
    imk_result_judge(result, judged.usability, "%s", judged.text);
    imki_show_allan_channels(a, result);
    imk_result_end(result);
}

/* ---- figure ---------------------------------------------------------------------------------- */

void imki_show_allan_curve(const imk_allan_curve *curve, const char *name, int color, double scale,
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
static void show_panel(const imk_allan_log *a, imk_channel_kind kind, bool time,
                       imk_figure_builder *figure)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    imk_unit unit = {.scale = 0};
    int color = 0;
    for (size_t c = 0; c < a->record.count; c++)
        for (size_t k = 0; k < a->settings.statistic_count; k++) {
            const imk_log_column *column = imk_even_record_column(&a->record, c);
            const imk_allan_curve *curve = &a->curve[c][k];
            const imk_allan_statistic statistic = a->settings.statistic[k];
            const bool alone = a->settings.statistic_count == 1;
            char text[120];
            if (imk_channel_kind_of(column) != kind || (statistic == IMK_ALLAN_TIME) != time ||
                curve->count == 0)
                continue;
            if (color == 0) {
                unit =
                    imki_allan_readable_unit(a, c, statistic, curve->deviation[curve->count / 2]);
                const char *what = alone && statistic == IMK_ALLAN_OVERLAPPING ? "Allan deviation"
                                   : alone || time ? imk_allan_title(statistic)
                                                   : "deviation";
                snprintf(text, sizeof text, "%.40s [%s]", what, unit.text);
                const imk_panel panel = {.title = titles[kind],
                                         .x_label = "averaging time [s]",
                                         .y_label = text,
                                         .x_logarithmic = true,
                                         .y_logarithmic = true,
                                         .allan_deviation = !time && !a->settings.phase};
                imk_figure_panel(figure, &panel);
            }
            snprintf(text, sizeof text, "%.50s%s%s", column->name, alone ? "" : " ",
                     alone ? "" : imk_allan_name(statistic));
            imki_show_allan_curve(curve, text, color++, unit.scale, figure);
        }
}

void imk_show_allan_log(const imk_allan_log *a, const char *name, imk_result *result)
{
    show_data(a, name, result);
    imk_result_title(result, "Allan deviation", "%.120s: %zu samples of %zu channels, %g Hz", name,
                     a->record.rows, a->record.count, 1 / a->record.dt);
    imk_figure_builder *figure = imk_result_figure(
        result, name, 2, "Points: the deviations. Bands: their confidence intervals.");
    for (int time = 0; time < 2; time++)
        for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
            show_panel(a, kind, time == 1, figure);
    show_tables(a, result);
}
