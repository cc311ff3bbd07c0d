/* SPDX-License-Identifier: Apache-2.0 */
/* What a model does not state, and what was assumed for it. */
#include "unstated_show_internal.h"

#include "report/result_internal.h"

#include <stdio.h>
#include <string.h>

static const char *class_name(imk_grade grade)
{
    return imk_grade_table(grade)->name;
}

static const char *value_of(const imk_unstated_term *term, char text[IMKI_WORDS])
{
    snprintf(text, IMKI_WORDS, "%.6g %s", term->typical / imk_unit_of(term->unit).scale,
             term->unit);
    return text;
}

/* ---- data ---- */

static void show_term(const imk_unstated_term *term, imk_result *result)
{
    imk_result_text(result, "sensor", term->sensor == IMK_GYRO ? "gyro" : "accel");
    imk_result_text(result, "key", term->key);
    imk_result_text(result, "text", term->text);
    imk_result_text(result, "class", class_name(term->grade));
    imk_result_quantity(result, "typical", term->typical, term->si);
}

void imki_show_missing_data(size_t count, const imk_drift_missing *missing, imk_result *result)
{
    imk_result_flag(result, "lower_bound", count > 0);
    imk_result_array(result, "unstated");
    for (size_t i = 0; i < count; i++) {
        imk_result_object(result, NULL);
        show_term(&missing[i].term, result);
        imk_result_number(result, "share", missing[i].share);
        imk_result_text(result, "figure", imk_drift_requirement_name(missing[i].figure));
        imk_result_quantity(result, "time", missing[i].time, "s");
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imki_show_assumed_data(const imk_unstated *assumed, imk_result *result)
{
    imk_result_array(result, "assumed");
    for (size_t i = 0; assumed && i < assumed->count; i++) {
        imk_result_object(result, NULL);
        show_term(&assumed->term[i], result);
        imk_result_end(result);
    }
    imk_result_end(result);
}

/* ---- words ---- */

void imki_missing_names(size_t count, const imk_drift_missing *missing, imki_text *text)
{
    for (size_t i = 0; i < count; i++)
        imki_text_add(text, "%s%s",
                      i == 0           ? ""
                      : i + 1 == count ? " and "
                                       : ", ",
                      missing[i].term.text);
}

void imki_unstated_biases(const imk_model *model, bool gyro, bool accel, imki_text *text)
{
    imk_unstated unstated;
    size_t told = 0;
    imk_model_unstated(model, &unstated);
    for (size_t i = 0; i < unstated.count; i++) {
        const imk_unstated_term *term = &unstated.term[i];
        const bool is_bias = strcmp(term->key, "bias.repeatability") == 0 ||
                             strcmp(term->key, "noise.bias_instability") == 0;
        if (is_bias && (term->sensor == IMK_GYRO ? gyro : accel))
            imki_text_add(text, "%s%s", told++ > 0 ? ", " : "", term->text);
    }
}

void imki_show_missing(size_t count, const imk_drift_missing *missing, imk_result *result)
{
    char number[IMKI_WORDS], after[IMKI_WORDS];
    if (count == 0)
        return;
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 0xaU);
    imk_table_row(table, "not stated\ttypically\tin class\twould be\tafter");
    for (size_t i = 0; i < count; i++) {
        const imk_drift_missing *m = &missing[i];
        const bool radius = m->figure == IMK_REQUIRED_CEP || m->figure == IMK_REQUIRED_R95 ||
                            m->figure == IMK_REQUIRED_DRMS;
        imk_readable_duration(m->time, after, sizeof after);
        imk_table_row(table, "%s\t%s\t%s\t%.0f %% of %s\t%s", m->term.text,
                      value_of(&m->term, number), class_name(m->term.grade), 100 * m->share,
                      radius ? "position" : imk_drift_requirement_name(m->figure), after);
    }
}

void imki_show_assumed(const imk_unstated *assumed, const char *name, imk_result *result)
{
    char number[IMKI_WORDS];
    if (!assumed)
        return;
    if (assumed->count == 0)
        imk_result_line(result, "%s states all terms: nothing is assumed.", name);
    for (size_t i = 0; i < assumed->count; i++)
        imk_result_line(result, "%s: assumed: %s %s (%s)", name, assumed->term[i].text,
                        value_of(&assumed->term[i], number), class_name(assumed->term[i].grade));
}
