/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as an HTML page. */
#include "drift_figure.h"
#include "shell/page_table.h"

#include "imukit/model_file.h"

#include <stdlib.h>

static void put_table(imk_page *page, const char *title, text_table table)
{
    if (table.rows > 0 && title)
        imk_page_heading(page, title);
    page_put_table(page, &table);
    text_table_free(&table);
}

static void put_figure(imk_page *page, const drift_result *r)
{
    drift_figure *d = command_memory(NULL, sizeof *d);
    drift_figure_make(r, d);
    imk_page_figure(page, &d->figure,
                    "CEP is the radius of the circle that holds half of all outcomes, R95 that of "
                    "95 %. Shares are of the variance: a term with 25 % makes half as much error "
                    "as the whole.");
    drift_figure_free(d);
    free(d);
}

static void put_budgets(imk_page *page, const drift_result *r)
{
    const imk_drift_wish wish = r->scene->want.asked ? r->scene->want.figure : IMK_WISH_CEP;
    for (size_t c = 0; c < r->case_count; c++) {
        const drift_case *one = &r->cases[c];
        const size_t time = drift_budget_time(r, one);
        char title[240], text[80];
        drift_time_text(r->scene->time[time], text, sizeof text);
        snprintf(title, sizeof title, "What makes it after %s: %s", text, one->label);
        put_table(page, title, drift_budget_table(one, time, wish));
        put_table(page, NULL, drift_shift_table(one, time));
    }
}

static void put_answer(imk_page *page, const drift_result *r, const drift_answer *answer)
{
    char title[160], goal[DRIFT_TEXT], time[80];
    const drift_wished *want = &r->scene->want;
    drift_time_text(want->time, time, sizeof time);
    snprintf(title, sizeof title, "Wanted: %s %s after %s", drift_wish_name(want->figure),
             drift_in_unit(want->goal, &want->unit, goal), time);
    const bool met = answer->requirement.present <= want->goal;
    imk_page_heading(page, title);
    imk_page_verdict(page, met ? 0 : 1,
                     met ? "Met." : "Not met. The least work that would do, counted in factors:");
    put_table(page, NULL, drift_answer_table(r, answer));
    put_table(page, "Devices of the catalogue that would do", drift_device_table(r, answer, false));
    put_table(page, "Grade presets that would do", drift_device_table(r, answer, true));
}

static void put_models(imk_page *page, const drift_result *r)
{
    for (size_t m = 0; m < r->model_count; m++)
        page_put_model(page, r->name[m], r->model[m]);
}

int drift_report(const drift_result *r, const drift_answer *answer, const char *path)
{
    char conditions[DRIFT_CONDITIONS];
    imk_page *page = imk_page_create("Error growth", r->model_count > 1 ? "" : r->name[0]);
    drift_conditions(r, conditions, sizeof conditions);
    conditions[0] = (char)(conditions[0] - 'a' + 'A');
    imk_page_text(page, conditions);
    for (size_t i = 0; i < command_warning_count(); i++)
        imk_page_verdict(page, 2, command_warning_get(i)->message);
    put_figure(page, r);
    if (r->model_count > 1)
        put_table(page, "Comparison", drift_comparison_table(r));
    else if (r->case_count > 1)
        put_table(page, "Before and after calibration", drift_before_after_table(r));
    else if (r->case_count == 1)
        put_table(page, "Against time", drift_growth_table(r, &r->cases[0]));
    put_budgets(page, r);
    if (r->found)
        put_table(page, "Monte Carlo", drift_runs_table(r));
    if (answer)
        put_answer(page, r, answer);
    put_models(page, r);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
