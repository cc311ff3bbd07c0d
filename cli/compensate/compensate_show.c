/* SPDX-License-Identifier: Apache-2.0 */
/* What was taken out of a log, and what was met on the way. */
#include "compensate_parts.h"
#include "shell/growing_list.h"

static const struct {
    const char *code, *meaning;
} flag_texts[IMK_FLAG_COUNT] = {
    {"saturated", "saturated, at or beyond the range of an axis"},
    {"temperature", "temperature outside the valid range of the model's terms, whose end was used"},
    {"limit", "corrected values beyond the limits up to which the correction is proven"},
    {"not_finite",
     "readings that are no finite number, or no temperature yet; what depends on it is nan"},
    {"acceleration",
     "angular acceleration for the lever arms not known, or from a saturated rate"}};

void compensate_warn(const compensate_counts *counts)
{
    for (int i = 0; i < IMK_FLAG_COUNT; i++)
        if (counts->flagged[i] > 0)
            command_warn(flag_texts[i].code, "%s: %llu of %llu samples (first: row %llu)",
                         flag_texts[i].meaning, (unsigned long long)counts->flagged[i],
                         (unsigned long long)counts->rows,
                         (unsigned long long)counts->first_flagged[i]);
    if (counts->temperatures_held > 0)
        command_warn("temperature_held", "no temperature, the last one used: %llu of %llu samples",
                     (unsigned long long)counts->temperatures_held,
                     (unsigned long long)counts->rows);
    if (counts->times_missing > 0)
        command_warn(
            "time_missing",
            "the time is no finite number: %llu of %llu samples (first: row %llu); each is "
            "taken for the one after the sample before it",
            (unsigned long long)counts->times_missing, (unsigned long long)counts->rows,
            (unsigned long long)counts->first_time_missing);
    if (counts->stretches > 1)
        command_warn("gaps",
                     "gaps and steps back in time: %llu (first: row %llu); each begins a "
                     "new stretch",
                     (unsigned long long)(counts->stretches - 1),
                     (unsigned long long)counts->first_gap);
}

void compensate_show_keys(const char *key, const char *label, const imk_firmware_keys *keys,
                          imk_result *result)
{
    growing_list line = {0};
    imk_result_array(result, key);
    for (int i = 0; i < keys->count; i++) {
        imk_result_text(result, NULL, keys->key[i]);
        list_add_item(&line, "%s", keys->key[i]);
    }
    imk_result_end(result);
    imk_result_line(result, "%s: %s", label, line.text ? line.text : "nothing");
    list_free(&line);
}

static void show_flags(const compensate_counts *counts, imk_result *result)
{
    imk_result_object(result, "flagged");
    for (int i = 0; i < IMK_FLAG_COUNT; i++) {
        imk_result_object(result, flag_texts[i].code);
        imk_result_count(result, "count", (long long)counts->flagged[i]);
        if (counts->flagged[i] > 0)
            imk_result_count(result, "first_row", (long long)counts->first_flagged[i]);
        else
            imk_result_null(result, "first_row");
        imk_result_end(result);
    }
    imk_result_end(result);
}

void compensate_show(const compensation *c, imk_result *result)
{
    const imk_correction *correction = &c->compensator.correction;
    const imk_firmware_keys taken_out = compensate_taken_out(&c->model);
    const imk_firmware_keys left_in = compensate_left_in(&c->model, &c->whole);
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", c->log);
    imk_result_text(result, "model", c->name);
    imk_result_quantity(result, "interval", c->compensator.dt, "s");
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_count(result, "rows", (long long)c->counts.rows);
    imk_result_count(result, "stretches", (long long)c->counts.stretches);
    show_flags(&c->counts, result);
    imk_result_count(result, "iterations", correction->iterations);
    imk_result_number(result, "contraction", correction->contraction);
    imk_result_quantity(result, "rate_bound", correction->bound[IMK_GYRO], "rad/s");
    imk_result_quantity(result, "force_bound", correction->bound[IMK_ACCEL], "m/s^2");
    compensate_show_keys("taken_out", "Taken out", &taken_out, result);
    compensate_show_keys("left_in", "Left in", &left_in, result);
    imk_result_end(result);
    imk_result_line(result, "%llu samples, %llu flagged", (unsigned long long)c->counts.rows,
                    (unsigned long long)c->counts.any_flag);
}

int compensate_end(const compensate_options *o, imk_result *result)
{
    const int code = o->strict && command_warning_count() > 0 ? EXIT_FAILED : EXIT_DONE;
    if (!o->json)
        show_aside(result);
    return show_end(result, &(show_options){.json = o->json, .quiet = true}, code);
}
