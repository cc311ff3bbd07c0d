/* SPDX-License-Identifier: Apache-2.0 */
/* The terms taken out of a record, the samples that were flagged, and whether it can be used. */
#include "show_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void imk_show_terms(const char *key, const char *label, const imk_term_keys *keys,
                    imk_result *result)
{
    char line[IMK_TERM_KEYS_MAX * (sizeof keys->key[0] + 2)] = "nothing";
    size_t length = 0;
    imk_result_array(result, key);
    for (int i = 0; i < keys->count; i++) {
        imk_result_text(result, NULL, keys->key[i]);
        length += (size_t)snprintf(line + length, sizeof line - length, "%s%s", i > 0 ? ", " : "",
                                   keys->key[i]);
    }
    imk_result_end(result);
    imk_result_line(result, "%s: %s", label, line);
}

static const char *const flag_codes[IMK_FLAG_COUNT] = {"saturated", "temperature", "limit",
                                                       "not_finite", "acceleration"};

static void show_flags(const imk_compensate_counts *counts, imk_result *result)
{
    imk_result_object(result, "flagged");
    for (int i = 0; i < IMK_FLAG_COUNT; i++) {
        imk_result_object(result, flag_codes[i]);
        imk_result_count(result, "count", (long long)counts->flagged[i]);
        if (counts->flagged[i] > 0)
            imk_result_count(result, "first_row", (long long)counts->first_flagged[i]);
        else
            imk_result_null(result, "first_row");
        imk_result_end(result);
    }
    imk_result_end(result);
}

/* Sensors that the model does not describe: all their errors are left in. */
static void show_copied(const imk_findings *findings, imk_result *result)
{
    static const char *const keys[IMK_KINDS] = {"gyro", "accel", "mag"};
    static const char *const words[IMK_KINDS] = {"gyros", "accelerometers", "magnetometer"};
    imk_result_array(result, "copied");
    for (const imk_finding *f = findings->item; f < findings->item + findings->count; f++) {
        const bool magnetometer = strcmp(f->code, "magnetometer_left") == 0;
        if (!magnetometer && strcmp(f->code, "not_in_model") != 0)
            continue;
        const int sensor = magnetometer ? IMK_MAG : (int)f->number[0];
        imk_result_text(result, NULL, keys[sensor]);
        imk_result_line(result, "Left as it came: every column of the %s", words[sensor]);
    }
    imk_result_end(result);
}

/* ---- judgement ------------------------------------------------------------------------------- */

/* "12 saturated, 3 with no finite reading" */
static void judge_flags(const imk_compensate_counts *counts, imki_reasons *reasons)
{
    static const char *const words[IMK_FLAG_COUNT] = {
        "saturated", "outside the temperatures of the model", "beyond the limits of the correction",
        "with a reading that is not finite", "without an angular acceleration"};
    imki_text text = {0};
    for (int i = 0; i < IMK_FLAG_COUNT; i++)
        if (counts->flagged[i] > 0)
            imki_text_add(&text, "%s%llu %s", text.size > 0 ? ", " : "",
                          (unsigned long long)counts->flagged[i], words[i]);
    if (text.size > 0)
        imki_reason(reasons, "%llu of %llu samples are flagged, %s",
                    (unsigned long long)counts->any_flag, (unsigned long long)counts->rows,
                    text.bytes);
    free(text.bytes);
}

static bool is_flag(const imk_finding *f)
{
    bool is = false;
    for (int i = 0; i < IMK_FLAG_COUNT; i++)
        is = is || (strncmp(f->code, "compensate:", strlen("compensate:")) == 0 &&
                    strcmp(imk_finding_code(f), flag_codes[i]) == 0);
    return is;
}

static void judge(const imk_compensate_log *log, imk_result *result)
{
    const imk_compensate_counts *counts = &log->counts;
    imki_reasons reasons = {.result = result};
    imk_findings others = {.count = 0}; /* warnings that are no flags */
    for (size_t k = 0; k < log->findings.count; k++)
        if (!is_flag(&log->findings.item[k]))
            others.item[others.count++] = log->findings.item[k];
    judge_flags(counts, &reasons);
    imki_reasons_of_warnings(&reasons, &others);
    const bool none = log->taken_out.count == 0 || counts->any_flag == counts->rows;
    const imk_usability usability = none               ? IMK_NOT_USABLE
                                    : reasons.told > 0 ? IMK_USABLE_WITH_CARE
                                                       : IMK_USABLE;
    imki_reason(&reasons, "%d term%s taken out, and %d stay in", log->taken_out.count,
                log->taken_out.count == 1 ? " is" : "s are", log->left_in.count);
    imki_judge(&reasons, usability, "");
}

/* ---- the whole ------------------------------------------------------------------------------- */

void imk_show_compensate_log(const imk_compensate_log *log, const char *name, const char *model,
                             imk_result *result)
{
    const imk_correction *correction = &log->compensator.correction;
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", name);
    imk_result_text(result, "model", model);
    imk_result_quantity(result, "interval", log->compensator.dt, "s");
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(log, result);
    imk_result_count(result, "rows", (long long)log->counts.rows);
    imk_result_count(result, "stretches", (long long)log->counts.stretches);
    show_flags(&log->counts, result);
    imk_result_count(result, "iterations", correction->iterations);
    imk_result_number(result, "contraction", correction->contraction);
    imk_result_quantity(result, "rate_bound", correction->bound[IMK_GYRO], "rad/s");
    imk_result_quantity(result, "force_bound", correction->bound[IMK_ACCEL], "m/s^2");
    imk_show_terms("taken_out", "Taken out", &log->taken_out, result);
    imk_show_terms("left_in", "Left in", &log->left_in, result);
    show_copied(&log->findings, result);
    imk_result_end(result);
    imk_result_line(result, "%llu samples, %llu flagged", (unsigned long long)log->counts.rows,
                    (unsigned long long)log->counts.any_flag);
}
