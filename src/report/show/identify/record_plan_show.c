/* SPDX-License-Identifier: Apache-2.0 */
/* The display of the plan of a record: required lengths, the precision of each length, a figure. */
#include "report/show/show_internal.h"

#include <math.h>
#include <stdio.h>

static const char *kind_of(const imk_plan_parameter *parameter)
{
    return parameter->sensor == IMK_ACCEL ? "accel" : "gyro";
}

/* "2 h 46 min" is enough for a plan. */
static imki_words rough_duration(double seconds)
{
    const double step = seconds < 600 ? 1 : seconds < 36000 ? 60 : 1800;
    imki_words words;
    if (seconds <= 90 * 86400.0)
        return imki_duration(ceil(seconds / step * 0.9999) * step);
    snprintf(words.text, sizeof words.text, "%.3g days", seconds / 86400);
    return words;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void show_requirements(const imk_record_plan *p, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "requirement\tterm\trecord length");
    for (size_t k = 0; k < p->requirement_count; k++) {
        const imk_plan_requirement *asked = &p->requirement[k];
        const imk_plan_parameter *parameter = &p->parameter[asked->parameter];
        imk_table_row(table, "%s\t%s.%s", asked->text, kind_of(parameter), parameter->key);
        if (isfinite(asked->duration))
            imk_table_add(table, "%s%s", rough_duration(asked->duration).text,
                          asked->duration > p->duration ? " (longer than planned)" : "");
        else
            imk_table_add(table, "no record is long enough");
    }
    imk_result_gap(result);
}

/* "3.0 %", with the chance that the term is found if this is not certain. */
static void show_cell(imk_table *table, const imk_plan_record *record, size_t parameter, bool time)
{
    const double relative = record->relative[parameter], found = record->detection[parameter];
    char sigma[40] = "-", chance[40] = "";
    if (!record->told) { /* too short or too long for any statement */
        imk_table_add(table, "-");
        return;
    }
    if (relative < 10)
        snprintf(sigma, sizeof sigma, relative < 0.995 ? "%.2g %%" : "%.0f %%", 100 * relative);
    if (!time && found < 0.995)
        snprintf(chance, sizeof chance, " (found: %.0f %%)", 100 * found);
    imk_table_add(table, "%s%s", sigma, chance);
}

static void show_records(const imk_record_plan *p, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "1 sigma, worst axis\tmodel\tunit");
    for (size_t d = 0; d < p->record_count; d++)
        imk_table_add(table, "%s%s", rough_duration(p->record[d].duration).text,
                      p->record[d].planned ? " *" : "");
    for (size_t k = 0; k < p->parameter_count; k++) {
        const imk_plan_parameter *parameter = &p->parameter[k];
        const double low = parameter->low / parameter->unit.scale;
        imk_table_row(table, "%s.%s", kind_of(parameter), parameter->key);
        if (parameter->high > 1.0005 * parameter->low)
            imk_table_add(table, "%.3g ... %.3g", low, parameter->high / parameter->unit.scale);
        else
            imk_table_add(table, "%.4g", low);
        imk_table_add(table, "%s", parameter->unit.text);
        for (size_t d = 0; d < p->record_count; d++)
            show_cell(table, &p->record[d], k, parameter->time);
    }
    imk_result_gap(result);
    imk_result_line(result,
                    "No unbiased method is more precise; imukit identify comes within a few per "
                    "cent of this limit. \"found\" is the chance that a record of that length "
                    "shows the term at all, at a significance of %g %%.",
                    100 * p->settings.significance);
    if (p->duration > 0)
        imk_result_line(result, "* planned length: keep the sensor at rest and its temperature "
                                "constant for this time.");
}

/* ---- judgement ------------------------------------------------------------------------------- */

/* A term that a record shows with less than this chance is not one to rely on. */
static const double surely_found = 0.95;

static size_t found_in(const imk_record_plan *p, const imk_plan_record *record, size_t *terms)
{
    size_t found = 0;
    *terms = 0;
    for (size_t k = 0; k < p->parameter_count; k++) {
        if (p->parameter[k].time)
            continue;
        *terms += 1;
        found += record->told && record->detection[k] >= surely_found;
    }
    return found;
}

static void judge_wishes(const imk_record_plan *p, imki_reasons *reasons)
{
    size_t unmet = 0;
    for (size_t k = 0; k < p->requirement_count; k++) {
        const imk_plan_requirement *asked = &p->requirement[k];
        if (asked->duration <= p->duration)
            continue;
        unmet++;
        imki_reason(reasons, "\"%s\" of the %s needs %s", asked->text,
                    kind_of(&p->parameter[asked->parameter]),
                    isfinite(asked->duration) ? rough_duration(asked->duration).text
                                              : "more than any record");
    }
    if (unmet == 0)
        imki_reason(reasons, "a record of %s meets what is wanted",
                    rough_duration(p->duration).text);
    imki_judge(reasons, unmet == 0 ? IMK_USABLE : IMK_NOT_USABLE,
               unmet == 0 ? "" : " for what is wanted");
}

/* The planned record; if none is planned, the shortest that shows all terms, or the longest. */
static void judge(const imk_record_plan *p, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    const imk_plan_record *best = NULL;
    size_t terms = 0;
    if (p->requirement_count > 0) {
        judge_wishes(p, &reasons);
        return;
    }
    for (size_t d = 0; d < p->record_count; d++) {
        const imk_plan_record *record = &p->record[d];
        const bool all = best && found_in(p, best, &terms) == terms;
        if (record->told && (record->planned || (p->duration <= 0 && !all)))
            best = record;
    }
    const size_t found = best ? found_in(p, best, &terms) : 0;
    if (best)
        imki_reason(&reasons,
                    "a record of %s shows %zu of the %zu noise terms of the model, each with a "
                    "chance of 95 %% or more",
                    rough_duration(best->duration).text, found, terms);
    else
        imki_reason(&reasons, "a record of this length shows nothing of the noise");
    imki_judge(&reasons,
               found == 0      ? IMK_NOT_USABLE
               : found < terms ? IMK_USABLE_WITH_CARE
                               : IMK_USABLE,
               "");
}

/* ---- data ------------------------------------------------------------------------------------ */

static const char *key_of(const imk_plan_parameter *parameter, imk_result *result)
{
    return imk_result_key(result, "%s.%s", kind_of(parameter), parameter->key);
}

static void requirement_data(const imk_record_plan *p, const imk_plan_requirement *asked,
                             imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "wish", asked->text);
    imk_result_text(result, "term", key_of(&p->parameter[asked->parameter], result));
    imk_result_quantity(result, "duration", asked->duration, "s");
    if (asked->relative > 0)
        imk_result_number(result, "relative_sigma", asked->relative);
    else
        imk_result_number(result, "found", asked->detection);
    imk_result_end(result);
}

static void record_data(const imk_record_plan *p, const imk_plan_record *record, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_quantity(result, "duration", record->duration, "s");
    imk_result_flag(result, "planned", record->planned);
    imk_result_object(result, "terms");
    for (size_t k = 0; k < p->parameter_count && record->told; k++) {
        imk_result_object(result, key_of(&p->parameter[k], result));
        imk_result_number(result, "relative_sigma", record->relative[k]);
        imk_result_number(result, "found", record->detection[k]);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_data(const imk_record_plan *p, const char *name, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", name);
    imk_result_quantity(result, "rate", p->settings.rate, "Hz");
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(p, result);
    imk_result_array(result, "wishes");
    for (size_t k = 0; k < p->requirement_count; k++)
        requirement_data(p, &p->requirement[k], result);
    imk_result_end(result);
    imk_result_array(result, "records");
    for (size_t d = 0; d < p->record_count; d++)
        record_data(p, &p->record[d], result);
    imk_result_end(result);
    imk_result_end(result);
}

/* ---- figure ---------------------------------------------------------------------------------- */

/* A panel for the gyros and one for the accelerometers. */
static void show_figure(const imk_record_plan *p, imk_result *result)
{
    size_t first = 0;
    imk_figure_builder *figure =
        imk_result_figure(result, "Precision against the length of the record", 2, "");
    for (size_t k = 0; k < p->parameter_count; k++) {
        const imk_plan_parameter *parameter = &p->parameter[k];
        if (k == 0 || parameter->sensor != p->parameter[k - 1].sensor) {
            first = k;
            imk_figure_panel(figure, &(imk_panel){.title = kind_of(parameter),
                                                  .x_label = "record [h]",
                                                  .y_label = "1 sigma, worst axis [%]",
                                                  .x_logarithmic = true,
                                                  .y_logarithmic = true});
        }
        imki_begin_curve(figure, parameter->key,
                         parameter->time ? IMK_CURVE_DASHES : IMK_CURVE_LINE, (int)(k - first));
        for (size_t d = 0; d < p->curve_count; d++) {
            const imk_plan_record *record = &p->curve[d];
            const bool known = record->told && record->relative[k] < 2;
            imk_figure_point(figure, record->duration / 3600,
                             known ? 100 * record->relative[k] : (double)NAN);
        }
    }
}

void imk_show_record_plan(const imk_record_plan *p, const char *name, imk_result *result)
{
    show_data(p, name, result);
    if (p->curve_count > 0)
        show_figure(p, result);
    if (p->requirement_count > 0)
        show_requirements(p, result);
    show_records(p, result);
}
