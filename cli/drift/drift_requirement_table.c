/* SPDX-License-Identifier: Apache-2.0 */
/* The answer to --want: what each term must become, and which devices of the catalogue would do. */
#include "drift_parts.h"

#include "imukit/model_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Improvements below this are none. */
static const double same = 0.9995;

/* ---- devices ---- */

typedef struct search {
    const drift_result *result;
    imk_drift_settings settings; /* of the one time */
    drift_candidate *candidate;
} search;

static bool states_bias(const imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++)
        if (triad->bias.repeatability.value[i] > 0)
            return true;
    return false;
}

/* Each device by itself, on one thread. One that has no complete triads is left unusable. */
static void try_device(void *context, size_t item)
{
    const search *s = context;
    drift_candidate *c = &s->candidate[item];
    imk_model *model = malloc(sizeof *model);
    void *memory = NULL;
    imk_drift_analysis *analysis;
    c->no_memory = !model;
    if (!model)
        return;
    imk_device_model(c->device, model);
    c->no_bias = !states_bias(&model->gyro) || !states_bias(&model->accel);
    if (imk_drift_validate(model, &s->settings, NULL) == IMK_OK) {
        const size_t size = imk_drift_covariance_size(model, &s->settings);
        memory = drift_memory(size);
        c->no_memory = !memory;
        if (memory && imk_drift_covariance(model, &s->settings, memory, size, NULL, &analysis,
                                           NULL) == IMK_OK) {
            c->figures = imk_drift_figures_of(&analysis->total[0]);
            c->usable = isfinite(imk_drift_wished(&c->figures, s->result->scene->want.figure));
        }
    }
    free(memory);
    free(model);
}

typedef struct ranked {
    double figure;
    drift_candidate candidate;
} ranked;

static int by_figure(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    if (x->figure != y->figure)
        return x->figure > y->figure ? 1 : -1;
    return strcmp(x->candidate.device->name, y->candidate.device->name);
}

static bool sort_candidates(drift_answer *answer, imk_drift_wish wish)
{
    ranked *list = calloc(answer->candidate_count + 1, sizeof *list);
    if (!list)
        return false;
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const drift_candidate *c = &answer->candidate[i];
        list[i] = (ranked){c->usable ? imk_drift_wished(&c->figures, wish) : (double)INFINITY, *c};
    }
    qsort(list, answer->candidate_count, sizeof *list, by_figure);
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i] = list[i].candidate;
    free(list);
    return true;
}

int drift_answer_find(const drift_result *r, const imk_executor *executor, drift_answer *answer)
{
    const drift_case *one = &r->cases[r->case_count - 1];
    const drift_wished *want = &r->scene->want;
    imk_error error;
    *answer =
        (drift_answer){.time = drift_budget_time(r, one), .candidate_count = imk_device_count()};
    if (imk_drift_require(one->analysis, answer->time, want->figure, want->goal,
                          &answer->requirement, &error) != IMK_OK)
        return command_error(&error, one->name);
    answer->candidate = calloc(answer->candidate_count, sizeof *answer->candidate);
    if (!answer->candidate)
        return command_failed("memory is exhausted");
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i].device = imk_device_get(i);
    search s = {r, one->settings, answer->candidate};
    s.settings.time = &r->scene->time[answer->time];
    s.settings.time_count = 1;
    imk_execute(executor, answer->candidate_count, try_device, &s);
    bool good = true;
    for (size_t i = 0; i < answer->candidate_count; i++)
        good = good && !answer->candidate[i].no_memory;
    if (!good || !sort_candidates(answer, want->figure))
        return command_failed("memory is exhausted");
    return -1;
}

void drift_answer_free(drift_answer *answer)
{
    free(answer->candidate);
}

/* ---- terms ---- */

/* The model as the file has it, for the values; NULL when it cannot be had. */
static json_t *json_of_model(const imk_model *model)
{
    char *text = NULL;
    size_t size;
    if (command_unless_memory(imk_model_print_json(model, NULL, &text, &size, NULL)) != IMK_OK)
        return NULL;
    json_t *tree = json_loadb(text, size, 0, NULL);
    free(text);
    return tree;
}

/* What stands at the start: of the settings, not of the model. */
static void initial_value(const imk_drift_settings *s, const char *source, double factor,
                          char *text, size_t size)
{
    const int group = strstr(source, "position") ? 0 : strstr(source, "velocity") ? 3 : 6;
    double largest = 0;
    char number[DRIFT_TEXT];
    for (int i = group; i < group + 3; i++)
        largest = s->initial_sigma[i] > largest ? s->initial_sigma[i] : largest;
    largest *= factor;
    snprintf(text, size, "%s",
             group == 0   ? drift_length(largest, number)
             : group == 3 ? drift_speed(largest, number)
                          : drift_angle(largest, number));
}

static void value_text(const drift_case *one, const json_t *model, size_t source, double factor,
                       char *text, size_t size)
{
    const char *name = one->analysis->source[source].name;
    if (strncmp(name, "initial.", 8) == 0)
        initial_value(&one->settings, name, factor, text, size);
    else
        drift_term_value(model, name, one->settings.compensated, factor, text, size);
}

static void set_alone(text_table *table, size_t column, double alone)
{
    if (alone == 0)
        text_table_set(table, column, "not enough");
    else if (alone < same)
        text_table_set(table, column, "%.3g times smaller", 1 / alone);
    else
        text_table_set(table, column, "-");
}

/* What a source must become; a factor of 0 is below what the search for it can tell. */
static void set_needed(text_table *table, const drift_case *one, const json_t *model, size_t source,
                       double factor)
{
    char value[CELL_SIZE];
    value_text(one, model, source, factor, value, sizeof value);
    text_table_set(table, 2, "%s", factor > 0 ? value : "-");
    if (factor > 0)
        text_table_set(table, 3, "%.3g times smaller", 1 / factor);
    else
        text_table_set(table, 3, "too small to tell");
}

/* Terms that must become better, the one that needs most first. */
static size_t improvements(const drift_case *one, const imk_drift_requirement *need, size_t *order)
{
    size_t count = 0;
    for (size_t k = 0; k < one->analysis->source_count; k++) {
        if (!(need->source[k] < same))
            continue;
        size_t i = count++;
        for (; i > 0 && need->source[order[i - 1]] > need->source[k]; i--)
            order[i] = order[i - 1];
        order[i] = k;
    }
    return count;
}

/* True when one of the terms to be made better would do alone. */
static bool one_would_do(const imk_drift_requirement *need, const size_t *order, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (need->alone[order[i]] > 0)
            return true;
    return false;
}

text_table drift_answer_table(const drift_result *r, const drift_answer *answer)
{
    static const char *const heads[] = {"term", "is", "must become", "factor", "this one alone"};
    const drift_case *one = &r->cases[r->case_count - 1];
    const imk_drift_requirement *need = &answer->requirement;
    size_t order[IMK_DRIFT_SOURCES_MAX];
    const size_t count = improvements(one, need, order);
    const bool alone = one_would_do(need, order, count);
    text_table table = text_table_make(alone ? 5 : 4);
    table.right = 0x18u;
    json_t *model = json_of_model(one->model);
    for (size_t i = 0; i < count; i++) {
        char value[CELL_SIZE];
        if (i == 0) {
            text_table_row(&table);
            for (size_t c = 0; c < table.columns; c++)
                text_table_set(&table, c, "%s", heads[c]);
        }
        text_table_row(&table);
        text_table_set(&table, 0, "%s", one->analysis->source[order[i]].text);
        value_text(one, model, order[i], 1, value, sizeof value);
        text_table_set(&table, 1, "%s", value);
        set_needed(&table, one, model, order[i], need->source[order[i]]);
        if (alone)
            set_alone(&table, 4, need->alone[order[i]]);
    }
    json_decref(model);
    return table;
}

text_table drift_device_table(const drift_result *r, const drift_answer *answer, bool presets)
{
    const drift_wished *want = &r->scene->want;
    text_table table = text_table_make(3);
    table.right = 2;
    for (size_t i = answer->candidate_count; i-- > 0;) { /* the least that does comes first */
        const drift_candidate *c = &answer->candidate[i];
        char text[DRIFT_TEXT];
        const double figure = imk_drift_wished(&c->figures, want->figure);
        if (c->device->is_preset != presets || !c->usable || figure > want->goal)
            continue;
        text_table_row(&table);
        text_table_set(&table, 0, "%s%s", c->device->name, c->no_bias ? " *" : "");
        text_table_set(&table, 1, "%s", drift_in_unit(figure, &want->unit, text));
        text_table_set(&table, 2, "%s", presets ? "grade preset" : c->device->grade);
    }
    return table;
}

/* ---- printing ---- */

static void print_verdict(const drift_result *r, const drift_answer *answer)
{
    const drift_wished *want = &r->scene->want;
    const imk_drift_requirement *need = &answer->requirement;
    const bool met = need->present <= want->goal;
    char now[DRIFT_TEXT], goal[DRIFT_TEXT], time[80];
    drift_time_text(want->time, time, sizeof time);
    printf("\n%sWanted: %s %s after %s.%s %s: it is %s, ", command_color(stdout, COLOR_BOLD),
           drift_wish_name(want->figure), drift_in_unit(want->goal, &want->unit, goal), time,
           command_color(stdout, COLOR_RESET), met ? "Met" : "Not met",
           drift_in_unit(need->present, &want->unit, now));
    if (met && isinf(need->all))
        printf("nothing makes it.\n");
    else if (met)
        printf("all terms may be %.3g times larger.\n", need->all);
    else
        printf("all terms would have to be %.3g times smaller. The least work:\n", 1 / need->all);
}

static void print_devices(const drift_result *r, const drift_answer *answer)
{
    bool starred = false;
    size_t left_out = 0;
    for (int presets = 0; presets < 2; presets++) {
        text_table table = drift_device_table(r, answer, presets);
        if (table.rows > 0)
            printf("\n%s that would do:\n", presets ? "Grade presets" : "Devices of the catalogue");
        else if (!presets)
            printf("\nNo device of the catalogue would do.\n");
        text_table_print(&table, stdout);
        text_table_free(&table);
    }
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const drift_candidate *c = &answer->candidate[i];
        left_out += !c->usable;
        starred = starred ||
                  (c->usable && c->no_bias &&
                   imk_drift_wished(&c->figures, r->scene->want.figure) <= r->scene->want.goal);
    }
    if (starred)
        printf("* Its source states no run-to-run bias of gyros or accelerometers: it is as good "
               "as this only after a calibration at every start.\n");
    if (left_out > 0)
        printf("%zu entries have no complete set of gyros and accelerometers.\n", left_out);
}

void drift_answer_print(const drift_result *r, const drift_answer *answer)
{
    print_verdict(r, answer);
    text_table table = drift_answer_table(r, answer);
    if (table.rows > 0) {
        putchar('\n');
        text_table_print(&table, stdout);
        printf(table.columns == 5
                   ? "\nThis one alone: made so much smaller, with the others as they are.\n"
                   : "\nTo make one of them better alone would not be enough.\n");
    }
    text_table_free(&table);
    print_devices(r, answer);
}
