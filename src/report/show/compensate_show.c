/* SPDX-License-Identifier: Apache-2.0 */
/* The terms taken out of a record, and the samples that were flagged. */
#include "show_internal.h"

#include <stdio.h>
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

static void show_flags(const imk_compensate_counts *counts, imk_result *result)
{
    static const char *const codes[IMK_FLAG_COUNT] = {"saturated", "temperature", "limit",
                                                      "not_finite", "acceleration"};
    imk_result_object(result, "flagged");
    for (int i = 0; i < IMK_FLAG_COUNT; i++) {
        imk_result_object(result, codes[i]);
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
