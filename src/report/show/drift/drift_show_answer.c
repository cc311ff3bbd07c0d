/* SPDX-License-Identifier: Apache-2.0 */
/* The answer to --want as a result. */
#include "drift_show_internal.h"
#include "unstated_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void imki_drift_show_answer_data(const imk_drift_models *r, imk_result *result)
{
    const imk_drift_answer *answer = r->answer;
    const imk_drift_wanted *want = &r->settings.want;
    const imk_drift_analysis *a = imki_drift_last_case(r)->analysis;
    const imk_drift_allocation *need = &answer->allocation;
    const char *unit = imk_drift_requirement_unit(want->figure);
    imk_result_object(result, "want");
    imk_result_text(result, "figure", imk_drift_requirement_name(want->figure));
    imk_result_quantity(result, "goal", want->goal, unit);
    imk_result_quantity(result, "time", want->time, "s");
    imk_result_quantity(result, "present", need->present, unit);
    imk_result_number(result, "all", need->all);
    imk_result_flag(result, "lower_bound", imki_drift_last_case(r)->missing_count > 0);
    if (r->settings.drift.aid_count > 0)
        imk_result_text(result, "gains", want->retuned ? "retuned" : "held");
    imk_result_array(result, "terms");
    for (size_t k = 0; k < a->source_count; k++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "source", a->source[k].name);
        imk_result_number(result, "factor", need->source[k]);
        imk_result_number(result, "alone", need->alone[k]);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_array(result, "devices");
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const imk_drift_candidate *c = &answer->candidate[i];
        if (!c->usable)
            continue;
        imk_result_object(result, NULL);
        imk_result_text(result, "name", c->device->name);
        imk_result_flag(result, "preset", c->device->is_preset);
        imk_result_quantity(result, "figure", imk_drift_required(&c->figures, want->figure), unit);
        imk_result_flag(result, "meets",
                        c->missing_count == 0 && imki_drift_would_do(r, c, c->device->is_preset));
        imki_show_missing_data(c->missing_count, c->missing, result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

/* ---- terms ---- */

/* The initial errors: they are settings, not terms of the model. */
static void add_initial(const imk_drift_settings *s, const char *source, double factor,
                        imki_text *text)
{
    const int group = strstr(source, "position") ? 0 : strstr(source, "velocity") ? 3 : 6;
    const imk_drift_requirement kind = group == 0   ? IMK_REQUIRED_CEP
                                       : group == 3 ? IMK_REQUIRED_VELOCITY
                                                    : IMK_REQUIRED_HEADING;
    double largest = 0;
    char number[IMK_READABLE_SIZE];
    for (int i = group; i < group + 3; i++)
        largest = s->initial_sigma[i] > largest ? s->initial_sigma[i] : largest;
    imki_text_add(text, "%s", imk_readable_figure(kind, largest * factor, number));
}

/* A source made so many times as large. */
static void add_value(const imk_drift_case *one, const imk_result *model, size_t source,
                      double factor, imk_table *table)
{
    const char *name = one->analysis->source[source].name;
    imki_text text = {.bytes = NULL};
    if (strncmp(name, "initial.", 8) == 0)
        add_initial(&one->settings, name, factor, &text);
    else if (strcmp(name, "gravity.deflection") == 0) /* a setting, too */
        imki_text_add(&text, "%.3g ug", one->settings.gravity_deflection * factor / 9.80665e-6);
    else if (strncmp(name, "aid.", 4) == 0)
        imki_drift_aid_value(&one->settings, name, factor, &text);
    else
        imki_drift_term_value(model, name, one->settings.compensated, factor, &text);
    imk_table_add(table, "%s", text.size > 0 ? text.bytes : "");
    free(text.bytes);
}

/* 0 means a factor below the resolution of the search. */
static void add_factor(double factor, const char *none, imk_table *table)
{
    if (factor == 0)
        imk_table_add(table, "%s", none);
    else if (factor < IMK_DRIFT_SAME)
        imk_table_add(table, "%.3g times smaller", 1 / factor);
    else
        imk_table_add(table, "-");
}

static void show_terms(const imk_drift_models *r, const imk_result *model, imk_result *result)
{
    const imk_drift_case *one = imki_drift_last_case(r);
    const imk_drift_answer *answer = r->answer;
    const imk_drift_allocation *need = &answer->allocation;
    if (answer->order_count == 0)
        return;
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 0x18U);
    imk_table_row(table, "term\tis\tmust become\tfactor");
    if (answer->alone)
        imk_table_add(table, "if changed alone");
    for (size_t i = 0; i < answer->order_count; i++) {
        const size_t k = answer->order[i];
        imk_table_row(table, "%s", one->analysis->source[k].text);
        add_value(one, model, k, 1, table);
        if (need->source[k] > 0)
            add_value(one, model, k, need->source[k], table);
        else
            imk_table_add(table, "-");
        add_factor(need->source[k], "too small to tell", table);
        if (answer->alone)
            add_factor(need->alone[k], "not enough", table);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s",
                    answer->alone
                        ? "\nIf changed alone: the factor when only this term becomes smaller."
                        : "\nImproving only one of them would not be enough.");
}

/* ---- devices ---- */

/* Lists of devices, each with what is said above it. */
typedef enum device_list { MEETING, PERHAPS, PRESETS, LISTS } device_list;

static void begin_list(device_list list, imk_result *result)
{
    static const char *const titles[LISTS] = {
        "Devices of the catalogue that meet the requirement",
        "Devices that meet it at best: their sources leave out what matters",
        "Grade presets that meet the requirement"};
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "\n%s:", titles[list]);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, titles[list]);
    imk_result_for(result, IMK_FOR_BOTH);
}

static void add_missing(const imk_drift_candidate *c, imk_table *table)
{
    imki_text names = {.bytes = NULL};
    imki_missing_names(c->missing_count, c->missing, &names);
    imk_table_add(table, "not stated: %s", names.size > 0 ? names.bytes : "");
    free(names.bytes);
}

/* The least that does comes first. */
static void show_devices(const imk_drift_models *r, const imk_drift_answer *answer,
                         device_list list, imk_result *result)
{
    imk_table *table = NULL;
    for (size_t i = answer->candidate_count; i-- > 0;) {
        const imk_drift_candidate *c = &answer->candidate[i];
        char text[IMK_READABLE_SIZE];
        if (!imki_drift_would_do(r, c, list == PRESETS) ||
            (list != PRESETS && (c->missing_count > 0) != (list == PERHAPS)))
            continue;
        if (!table) {
            begin_list(list, result);
            table = imk_result_table(result, 2);
        }
        const double figure = imk_drift_required(&c->figures, r->settings.want.figure);
        imk_table_row(table, "%s\t%s%s\t%s", c->device->name, list == PERHAPS ? "at least " : "",
                      imk_readable_quantity(figure, &r->settings.want.unit, text),
                      list == PRESETS ? "grade preset" : c->device->grade);
        if (list == PERHAPS)
            add_missing(c, table);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (!table && list == MEETING)
        imk_result_line(result, "\nNo device of the catalogue is known to meet the requirement.");
}

static void show_remarks(const imk_drift_models *r, const imk_drift_answer *answer,
                         imk_result *result)
{
    size_t left_out = 0;
    for (size_t i = 0; i < answer->candidate_count; i++)
        left_out += !answer->candidate[i].usable;
    if (r->settings.assume)
        imk_result_line(result, "What sources of devices do not state is assumed, too.");
    if (left_out > 0)
        imk_result_line(result, "%zu entries have no complete set of gyros and accelerometers.",
                        left_out);
}

/* ---- all ---- */

void imki_drift_show_answer(const imk_drift_models *r, const imk_result *model, imk_result *result)
{
    const imk_drift_answer *answer = r->answer;
    const imk_drift_wanted *want = &r->settings.want;
    const imk_drift_allocation *need = &answer->allocation;
    const bool met = need->present <= want->goal;
    const bool at_best = met && imki_drift_last_case(r)->missing_count > 0;
    const char *word = at_best ? "Met at best" : met ? "Met" : "Not met";
    char title[160], factor[120] = "no term contributes to it.";
    char now[IMK_READABLE_SIZE], goal[IMK_READABLE_SIZE], time[IMKI_DRIFT_TIME];
    snprintf(title, sizeof title, "Wanted: %s %s after %s",
             imk_drift_requirement_name(want->figure),
             imk_readable_quantity(want->goal, &want->unit, goal),
             imki_drift_moment(r, want->time, time));
    if (!met && !(need->all > 0))
        snprintf(factor, sizeof factor, "no improvement of its terms meets the requirement.");
    else if (!met)
        snprintf(factor, sizeof factor,
                 "all terms would have to be %.3g times smaller. The smallest improvement that "
                 "meets the requirement:",
                 1 / need->all);
    else if (!isinf(need->all))
        snprintf(factor, sizeof factor, "all terms may be %.3g times larger.", need->all);
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "\n" IMK_BOLD "%s." IMK_PLAIN " %s: the figure is %s; %s", title, word,
                    imk_readable_quantity(need->present, &want->unit, now), factor);
    if (!met && r->settings.drift.aid_count > 0)
        imk_result_line(result, "%s",
                        want->retuned ? "The filter is made anew for the improved terms."
                                      : "The filter keeps its gains; --gains retuned makes it anew "
                                        "for the improved terms.");
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, title);
    imk_result_finding(
        result, met && !at_best ? 0 : 1,
        at_best ? "Met at best: the model does not state all that matters."
        : met
            ? "Met."
            : "Not met. The smallest improvement that meets the requirement, counted in factors:");
    imk_result_for(result, IMK_FOR_BOTH);
    show_terms(r, model, result);
    show_devices(r, answer, MEETING, result);
    show_devices(r, answer, PERHAPS, result);
    show_devices(r, answer, PRESETS, result);
    show_remarks(r, answer, result);
}
