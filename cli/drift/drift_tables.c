/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as tables and sentences. */
#include "drift_parts.h"

#include <math.h>
#include <string.h>

/* Shares below this are summed up in one line. */
static const double least_share = 0.002;

static bool is_free(const drift_result *r)
{
    return r->scene->settings.vertical == IMK_VERTICAL_FREE;
}

static void set_position(text_table *table, size_t column, const imk_drift_figures *f, double value)
{
    char text[DRIFT_TEXT];
    text_table_set(table, column, "%s",
                   drift_validity_of(f) == DRIFT_LOST ? "-" : drift_length(value, text));
}

/* Claims are in nautical miles; where they are less than a hundredth the column is empty. */
static void set_miles(text_table *table, size_t column, double value)
{
    const imk_unit mile = imk_unit_of("nmi");
    char text[DRIFT_TEXT];
    if (value >= 0.01 * mile.scale)
        text_table_set(table, column, "%s", drift_in_unit(value, &mile, text));
}

/* Seconds where a part of one would be lost. */
void drift_time_text(double time, char *text, size_t size)
{
    if (time < 3600 && fabs(time - floor(time + 0.5)) > 1e-6)
        snprintf(text, size, "%.6g s", time);
    else
        format_duration(time, text, size);
}

void drift_set_time(text_table *table, double time, drift_validity validity)
{
    char text[80];
    drift_time_text(time, text, sizeof text);
    text_table_set(table, 0, "%s%s", text, validity == DRIFT_ROUGH ? " ~" : "");
}

/* ---- growth ---- */

enum { GROWTH_COLUMNS = 10 };

text_table drift_growth_table(const drift_result *r, const drift_case *one)
{
    static const char *const heads[GROWTH_COLUMNS] = {
        "time", "CEP", "", "R95", "DRMS", "height", "velocity", "climb", "tilt", "heading"};
    size_t at[GROWTH_COLUMNS], columns = 0;
    for (size_t c = 0; c < GROWTH_COLUMNS; c++) {
        at[c] = columns;
        columns += is_free(r) || (c != 5 && c != 7);
    }
    text_table table = text_table_make(columns);
    table.right = (1u << columns) - 2;
    text_table_row(&table);
    for (size_t c = 0; c < GROWTH_COLUMNS; c++)
        if (is_free(r) || (c != 5 && c != 7))
            text_table_set(&table, at[c], "%s", heads[c]);
    for (size_t k = 0; k < r->scene->row_count; k++) {
        char text[DRIFT_TEXT];
        const size_t t = r->scene->row[k];
        const imk_drift_figures *f = &one->figures[t];
        const drift_validity validity = drift_validity_of(f);
        text_table_row(&table);
        drift_set_time(&table, r->scene->time[t], validity);
        if (validity == DRIFT_LOST) {
            text_table_set(&table, at[1], "no position");
            continue;
        }
        set_position(&table, at[1], f, f->cep);
        set_miles(&table, at[2], f->cep);
        set_position(&table, at[3], f, f->r95);
        set_position(&table, at[4], f, f->drms);
        if (is_free(r)) {
            text_table_set(&table, at[5], "%s", drift_length(f->height, text));
            text_table_set(&table, at[7], "%s", drift_speed(f->climb, text));
        }
        text_table_set(&table, at[6], "%s", drift_speed(f->velocity, text));
        text_table_set(&table, at[8], "%s", drift_angle(f->tilt, text));
        text_table_set(&table, at[9], "%s", drift_angle(f->heading, text));
    }
    return table;
}

/* Before and after calibration, side by side: the two cases of one model. */
text_table drift_before_after_table(const drift_result *r)
{
    static const char *const heads[] = {"time",       "CEP before",     "after",
                                        "R95 before", "after",          "velocity before",
                                        "after",      "heading before", "after"};
    enum { COLUMNS = sizeof heads / sizeof heads[0] };
    text_table table = text_table_make(COLUMNS);
    table.right = (1u << COLUMNS) - 2;
    text_table_row(&table);
    for (size_t c = 0; c < COLUMNS; c++)
        text_table_set(&table, c, "%s", heads[c]);
    for (size_t k = 0; k < r->scene->row_count; k++) {
        const size_t t = r->scene->row[k];
        drift_validity worst = DRIFT_LINEAR;
        text_table_row(&table);
        for (size_t c = 0; c < 2; c++) {
            char text[DRIFT_TEXT];
            const imk_drift_figures *f = &r->cases[c].figures[t];
            const drift_validity validity = drift_validity_of(f);
            worst = validity > worst ? validity : worst;
            set_position(&table, 1 + c, f, f->cep);
            set_position(&table, 3 + c, f, f->r95);
            if (validity == DRIFT_LOST) {
                text_table_set(&table, 1 + c, "no position");
                text_table_set(&table, 5 + c, "-");
                text_table_set(&table, 7 + c, "-");
                continue;
            }
            text_table_set(&table, 5 + c, "%s", drift_speed(f->velocity, text));
            text_table_set(&table, 7 + c, "%s", drift_angle(f->heading, text));
        }
        drift_set_time(&table, r->scene->time[t], worst);
    }
    return table;
}

text_table drift_comparison_table(const drift_result *r)
{
    text_table table = text_table_make(1 + r->case_count);
    table.right = (1u << (1 + r->case_count)) - 2;
    text_table_row(&table);
    text_table_set(&table, 0, "CEP after");
    for (size_t c = 0; c < r->case_count; c++)
        text_table_set(&table, 1 + c, "%.30s", r->cases[c].label);
    for (size_t k = 0; k < r->scene->row_count; k++) {
        const size_t t = r->scene->row[k];
        char text[80];
        text_table_row(&table);
        drift_time_text(r->scene->time[t], text, sizeof text);
        text_table_set(&table, 0, "%s", text);
        for (size_t c = 0; c < r->case_count; c++) {
            const imk_drift_figures *f = &r->cases[c].figures[t];
            char length[DRIFT_TEXT];
            const drift_validity validity = drift_validity_of(f);
            text_table_set(&table, 1 + c, "%s%s",
                           validity == DRIFT_LOST ? "no position" : drift_length(f->cep, length),
                           validity == DRIFT_ROUGH ? " ~" : "");
        }
    }
    return table;
}

/* ---- budget ---- */

text_table drift_budget_table(const drift_case *one, size_t time, imk_drift_wish wish)
{
    static drift_share share[IMK_DRIFT_SOURCES_MAX];
    const size_t count = drift_budget(one, time, wish, share);
    const imk_drift_wish other = wish == IMK_WISH_HEADING ? IMK_WISH_CEP : IMK_WISH_HEADING;
    double rest = 0;
    size_t rest_count = 0;
    text_table table = text_table_make(4);
    table.right = 0xEu;
    for (size_t i = 0; i < count; i++) {
        char text[DRIFT_TEXT];
        if (share[i].share < least_share) {
            rest += share[i].share;
            rest_count += share[i].share > 0;
            continue;
        }
        if (table.rows == 0) {
            text_table_row(&table);
            text_table_set(&table, 0, "term");
            text_table_set(&table, 1, "share");
            text_table_set(&table, 2, "%s alone", drift_wish_name(wish));
            text_table_set(&table, 3, "%s alone", drift_wish_name(other));
        }
        text_table_row(&table);
        text_table_set(&table, 0, "%s", one->analysis->source[share[i].source].text);
        text_table_set(&table, 1, "%.1f %%", 100 * share[i].share);
        text_table_set(&table, 2, "%s",
                       drift_figure_text(wish, imk_drift_wished(&share[i].random, wish), text));
        text_table_set(&table, 3, "%s",
                       drift_figure_text(other, imk_drift_wished(&share[i].random, other), text));
    }
    if (rest_count > 0 && table.rows > 0) {
        text_table_row(&table);
        text_table_set(&table, 0, "%zu other%s", rest_count, rest_count > 1 ? "s" : "");
        if (rest < 0.0005)
            text_table_set(&table, 1, "< 0.1 %%");
        else
            text_table_set(&table, 1, "%.1f %%", 100 * rest);
    }
    return table;
}

/* True when a shift shows beside the scatter: a thousandth of it. */
static bool is_shift(const imk_drift_moments *m, const imk_drift_figures *whole)
{
    const double least = 1e-3;
    return hypot(m->mean[0], m->mean[1]) > least * whole->drms ||
           fabs(m->mean[8]) > least * whole->heading;
}

text_table drift_shift_table(const drift_case *one, size_t time)
{
    const imk_drift_analysis *a = one->analysis;
    char text[DRIFT_TEXT];
    text_table table = text_table_make(4);
    table.right = 0xEu;
    for (size_t k = 0; k <= a->source_count; k++) {
        const bool total = k == a->source_count;
        const imk_drift_moments *m =
            total ? &a->total[time] : &a->contribution[k * a->time_count + time];
        if (!is_shift(m, &one->figures[time]) || (total && table.rows < 3))
            continue;
        if (table.rows == 0) {
            text_table_row(&table);
            text_table_set(&table, 0, "known value");
            text_table_set(&table, 1, "north");
            text_table_set(&table, 2, "east");
            text_table_set(&table, 3, "heading");
        }
        text_table_row(&table);
        text_table_set(&table, 0, "%s", total ? "together" : a->source[k].text);
        text_table_set(&table, 1, "%s", drift_length(m->mean[0], text));
        text_table_set(&table, 2, "%s", drift_length(m->mean[1], text));
        text_table_set(&table, 3, "%s", drift_angle(m->mean[8], text));
    }
    return table;
}

/* ---- sentences ---- */

/* Omitted terms of one case in a list. */
static void warn_of_omitted(const drift_case *one)
{
    char list[240] = "";
    const imk_drift_analysis *a = one->analysis;
    for (size_t i = 0; i < a->omitted_count; i++) {
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", a->omitted[i]);
    }
    if (a->omitted_count > 0)
        command_warn("omitted",
                     "%s: left out by the linear theory: %s; --monte-carlo has all that needs no "
                     "temperature",
                     one->label, list);
}

static void warn_of_range(const drift_result *r, const drift_case *one)
{
    const drift_scene *scene = r->scene;
    char text[80];
    for (size_t k = 0; k < scene->row_count; k++) {
        if (drift_validity_of(&one->figures[scene->row[k]]) != DRIFT_LOST)
            continue;
        drift_time_text(scene->time[scene->row[k]], text, sizeof text);
        command_warn("no_position",
                     "%s: at %s the error is beyond a tenth of the Earth's radius: no longer a "
                     "position",
                     one->label, text);
        return;
    }
    for (size_t k = 0; k < scene->row_count; k++) {
        if (drift_validity_of(&one->figures[scene->row[k]]) != DRIFT_ROUGH)
            continue;
        drift_time_text(scene->time[scene->row[k]], text, sizeof text);
        command_warn("nonlinear",
                     "%s: at %s attitude errors exceed 0.1 rad: linear figures are rough from "
                     "there (~)%s",
                     one->label, text, r->found ? "" : "; --monte-carlo 1000 shows the whole");
        return;
    }
}

void drift_warn(const drift_result *r)
{
    for (size_t c = 0; c < r->case_count; c++) {
        if (c == 0 || r->cases[c].model != r->cases[c - 1].model)
            warn_of_omitted(&r->cases[c]);
        warn_of_range(r, &r->cases[c]);
    }
    if (r->found)
        drift_warn_of_runs(r);
}

/* ---- printing ---- */

void drift_print_table(text_table table)
{
    if (table.rows > 0) {
        putchar('\n');
        text_table_print(&table, stdout);
    }
    text_table_free(&table);
}

void drift_conditions(const drift_result *r, char *text, size_t size)
{
    const imk_drift_settings *s = &r->scene->settings;
    char where[80];
    snprintf(where, sizeof where, "at rest at %.4g deg %s",
             fabs(s->latitude) / imk_unit_of("deg").scale, s->latitude < 0 ? "south" : "north");
    snprintf(text, size, "%s%s; attitude %s at the start, height %s.",
             r->scene->motion ? "on " : where, r->scene->motion ? r->options->motion : "",
             s->alignment == IMK_ALIGNED_SELF ? "found by the unit itself"
             : s->initial_sigma[6] + s->initial_sigma[7] + s->initial_sigma[8] > 0 ? "given"
                                                                                   : "true",
             is_free(r) ? "free" : "held by other means");
}

static void print_title(const drift_result *r)
{
    const char *bold = command_color(stdout, COLOR_BOLD),
               *reset = command_color(stdout, COLOR_RESET);
    char conditions[DRIFT_CONDITIONS];
    drift_conditions(r, conditions, sizeof conditions);
    printf("%sError growth%s", bold, reset);
    for (size_t m = 0; m < r->model_count; m++)
        printf("%s %s", m == 0 ? " of" : ",", r->name[m]);
    printf(" %s\n", conditions);
}

static void print_budget(const drift_result *r, const drift_case *one)
{
    char text[80];
    const imk_drift_wish wish = r->scene->want.asked ? r->scene->want.figure : IMK_WISH_CEP;
    const size_t time = drift_budget_time(r, one);
    text_table budget = drift_budget_table(one, time, wish);
    text_table shift = drift_shift_table(one, time);
    drift_time_text(r->scene->time[time], text, sizeof text);
    if (budget.rows + shift.rows > 0)
        printf("\nWhat makes it after %s%s%s\n", text, r->case_count > r->model_count ? ", " : "",
               r->case_count <= r->model_count ? ""
               : one->settings.compensated     ? "after calibration"
                                               : "before calibration");
    else
        printf("\nNo term of %s makes an error of position.\n", one->label);
    drift_print_table(budget);
    drift_print_table(shift);
}

/* Of several models only what decides. */
static void print_comparison(const drift_result *r)
{
    drift_print_table(drift_comparison_table(r));
    putchar('\n');
    for (size_t c = 0; c < r->case_count; c++) {
        static drift_share share[IMK_DRIFT_SOURCES_MAX];
        char text[80];
        const drift_case *one = &r->cases[c];
        const size_t time = drift_budget_time(r, one);
        drift_time_text(r->scene->time[time], text, sizeof text);
        if (drift_budget(one, time, IMK_WISH_CEP, share) > 0 && share[0].share > 0)
            printf("%s: after %s %s makes %.0f %% of the variance\n", one->label, text,
                   one->analysis->source[share[0].source].text, 100 * share[0].share);
    }
}

/* A wish that can be typed: half of what there is, at a time of the table. */
static void print_wish(const drift_result *r)
{
    char length[DRIFT_TEXT];
    const drift_case *one = &r->cases[r->case_count - 1];
    const size_t at = drift_budget_time(r, one);
    const double time = r->scene->time[at], hours = time / 3600, minutes = time / 60;
    const bool whole_hours = hours == floor(hours), whole_minutes = minutes == floor(minutes);
    if (!(one->figures[at].cep > 0) || drift_validity_of(&one->figures[at]) == DRIFT_LOST)
        return;
    printf("\nNext: what would halve it?  %s --want \"CEP %s @ %.8g%s\"\n", command_line(),
           drift_length(0.5 * one->figures[at].cep, length),
           whole_hours     ? hours
           : whole_minutes ? minutes
                           : time,
           whole_hours     ? "h"
           : whole_minutes ? "min"
                           : "s");
}

/* What a reader may want to know next. */
static void print_next(const drift_result *r)
{
    if (r->model_count > 1 || r->scene->want.asked)
        return;
    if (!r->found)
        print_wish(r);
    else if (!r->options->output)
        printf("\nNext: keep the runs with -o RESULTS.h5\n");
}

void drift_print(const drift_result *r)
{
    print_title(r);
    if (r->model_count > 1)
        print_comparison(r);
    else if (r->case_count > 1)
        drift_print_table(drift_before_after_table(r));
    else
        drift_print_table(drift_growth_table(r, &r->cases[0]));
    for (size_t c = 0; c < r->case_count && r->model_count == 1; c++)
        print_budget(r, &r->cases[c]);
    if (r->found)
        drift_print_runs(r);
    print_next(r);
}
