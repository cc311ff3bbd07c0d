/* SPDX-License-Identifier: Apache-2.0 */
/* NAME.h: what the code does, how well and at which cost, and the declaration of its function. */
#include "emit_internal.h"

#include "model/model_schema_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- terms ----------------------------------------------------------------------------------- */

static void add_key(imk_term_keys *keys, const char *sensor, const char *key)
{
    char text[40];
    snprintf(text, sizeof text, "%s.%s", sensor, key);
    for (int i = 0; i < keys->count; i++)
        if (strcmp(keys->key[i], text) == 0)
            return;
    if (keys->count < IMK_TERM_KEYS_MAX)
        memcpy(keys->key[keys->count++], text, sizeof text);
}

void imk_firmware_terms(const imk_firmware *firmware, const imk_model *model,
                        imk_term_keys *taken_out, imk_term_keys *left_in)
{
    const imk_triad *device[2] = {&firmware->model.gyro, &firmware->model.accel};
    const imk_triad *whole[2] = {&model->gyro, &model->accel};
    taken_out->count = left_in->count = 0;
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; whole[kind]->present && i < imki_triad_field_count; i++) {
            const imki_field *field = &imki_triad_fields[i];
            const char *key = field->path[kind];
            if (!key || field->flags & IMKI_COMPANION || imki_field_absent(field, whole[kind]))
                continue;
            const char *name =
                strncmp(key, "noise.", 6) == 0 ? "noise" : imki_field_name(field, kind);
            /* The device's model has only what its code takes out. */
            add_key(imki_field_taken_out(field) && !imki_field_absent(field, device[kind])
                        ? taken_out
                        : left_in,
                    imki_emit_sensor[kind], name);
        }
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (*imki_field_values(&imki_timing_fields[i], &model->timing) != 0)
            add_key(left_in, "timing", imki_timing_fields[i].path[0]);
}

/* ---- comment --------------------------------------------------------------------------------- */

/* Keys in lines of the comment. */
static void print_keys(imki_text *out, const char *label, const imk_term_keys *keys)
{
    size_t column = strlen(label) + 4;
    imki_text_add(out, " * %s:", label);
    for (int i = 0; i < keys->count; i++) {
        const size_t length = strlen(keys->key[i]) + 2;
        if (column + length > 96) {
            imki_text_add(out, "\n *    ");
            column = 7;
        }
        imki_text_add(out, " %s%s", keys->key[i], i + 1 < keys->count ? "," : "");
        column += length;
    }
    imki_text_add(out, keys->count > 0 ? "\n" : " nothing\n");
}

static void print_scale(imki_text *out, const char *unit, int bits)
{
    imki_text_add(out, "in units of 2^-%d %s", bits, unit);
}

static void print_inputs(const imki_emission *e)
{
    const imk_firmware *f = e->plan;
    imki_text *out = e->out;
    const bool fixed = f->arithmetic == IMK_FIRMWARE_FIXED;
    for (int sensor = 0; sensor < 2; sensor++) {
        if (f->axis_count[sensor] == 0)
            continue;
        imki_text_add(out, " *  %-12s in: readings ", imki_emit_sensor[sensor]);
        if (f->channel[sensor][0].in_counts) {
            imki_text_add(out, "[count]");
        } else if (fixed) {
            for (int i = 0; i < f->axis_count[sensor]; i++) {
                imki_text_add(out, i > 0 ? ", " : "");
                print_scale(out, imki_emit_unit[sensor], f->channel[sensor][i].bits);
            }
        } else {
            imki_text_add(out, "[%s]", imki_emit_unit[sensor]);
        }
        imki_text_add(out, "\n");
    }
    if (f->needs_temperature) {
        imki_text_add(out, " *  temperature  in: ");
        if (fixed)
            print_scale(out, "degC", f->temperature_bits);
        else
            imki_text_add(out, "[degC]");
        imki_text_add(out, "; the terms are valid from ");
        imki_emit_decimal(out, f->temperature_minimum, 6);
        imki_text_add(out, " to ");
        imki_emit_decimal(out, f->temperature_maximum, 6);
        imki_text_add(out, ", and stay constant beyond\n");
    }
}

static void print_outputs(const imki_emission *e)
{
    static const char *const what[2] = {"angular rate", "specific force"};
    const imk_firmware *f = e->plan;
    for (int sensor = 0; sensor < 2; sensor++) {
        if (f->axis_count[sensor] == 0)
            continue;
        imki_text_add(e->out, " *  %-12s out: %s, ", imki_emit_motion[sensor], what[sensor]);
        imki_text_add(e->out,
                      f->correction.solves[sensor] ? "body axes x y z, " : "one for each axis, ");
        if (f->arithmetic == IMK_FIRMWARE_FIXED)
            print_scale(e->out, imki_emit_unit[sensor], f->output_bits[sensor]);
        else
            imki_text_add(e->out, "[%s]", imki_emit_unit[sensor]);
        imki_text_add(e->out, "\n");
    }
    imki_text_add(
        e->out, " *  returned     the flags below; the outputs may be the arrays of the inputs\n");
}

static void print_bound(const imki_emission *e)
{
    const imk_firmware *f = e->plan;
    imki_text *out = e->out;
    imki_text_add(out, " *\n * Differs from the exact correction, computed by imk_correct(), by at "
                       "most\n");
    for (int sensor = 0; sensor < 2; sensor++) {
        double limit = HUGE_VAL;
        if (f->axis_count[sensor] == 0)
            continue;
        for (int j = 0; j < f->output_count[sensor]; j++)
            limit = fmin(limit, f->limit[sensor][j]);
        imki_text_add(out, " *  %-12s ", imki_emit_motion[sensor]);
        imki_emit_decimal(out, f->bound[sensor], 2);
        imki_text_add(out, " %s, for motion up to ", imki_emit_unit[sensor]);
        imki_emit_decimal(out, limit, 4);
        imki_text_add(out, " %s%s\n", imki_emit_unit[sensor],
                      f->limit_stated[sensor] ? "" : " (the model states no range)");
    }
    imki_text_add(out,
                  " * in samples without flags, whether the compiler fuses multiplications and "
                  "additions or not.\n * The proof needs IEEE arithmetic: no -ffast-math.\n");
    imki_text_add(
        out,
        " *\n * Cost of a sample: %d multiplications, %d additions, %d comparisons; no RAM "
        "but the stack,\n * no heap, no libm.\n",
        f->cost.multiplications, f->cost.additions, f->cost.comparisons);
}

static void print_comment(const imki_emission *e)
{
    static const char *const arithmetics[3] = {"single precision", "double precision",
                                               "32-bit fixed point"};
    imk_term_keys taken_out, left_in;
    imki_text *out = e->out;
    imki_text_add(out, IMKI_EMIT_MARK ": change the model, not this file. */\n");
    imki_text_add(out, "/* Corrects the readings of an inertial sensor: ");
    imki_emit_plain(out, e->model->name[0] ? e->model->name : "a unit without a name");
    imki_text_add(out, "\n");
    if (e->model->description[0]) {
        imki_text_add(out, " * ");
        imki_emit_plain(out, e->model->description);
        imki_text_add(out, "\n");
    }
    imki_text_add(out, " *\n * In %s", arithmetics[e->plan->arithmetic]);
    if (e->plan->iterations > 1)
        imki_text_add(out, ", %d steps", e->plan->iterations);
    imki_text_add(out, ".\n");
    imk_firmware_terms(e->plan, e->model, &taken_out, &left_in);
    print_keys(out, "Taken out", &taken_out);
    print_keys(out, "Left in", &left_in);
    imki_text_add(out, " *\n");
    print_inputs(e);
    print_outputs(e);
    print_bound(e);
    imki_text_add(out, " */\n");
}

/* ---- declarations ---------------------------------------------------------------------------- */

static void print_flags(const imki_emission *e)
{
    static const struct {
        const char *name, *meaning;
        unsigned flag;
    } flags[] = {
        {"SATURATED", "a reading at or beyond the range", IMK_FLAG_SATURATED},
        {"TEMPERATURE", "outside the valid range", IMK_FLAG_TEMPERATURE},
        {"LIMIT", "motion beyond the limit up to which the bound holds", IMK_FLAG_LIMIT},
        {"NOT_FINITE", "an input is NaN or infinite, and each output made from it",
         IMK_FLAG_NOT_FINITE},
    };
    imki_text_add(e->out, "/* Flags. */\nenum {\n");
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        imki_text_add(e->out, "    ");
        imki_emit_capitals(e->out, e->name);
        imki_text_add(e->out, "_%s = %u%s /* %s */\n", flags[i].name, flags[i].flag,
                      i + 1 < sizeof flags / sizeof flags[0] ? "," : "", flags[i].meaning);
    }
    imki_text_add(e->out, "};\n\n");
}

void imki_emit_header(imki_emission *e)
{
    imki_text *out = e->out;
    print_comment(e);
    imki_text_add(out, "#ifndef ");
    imki_emit_capitals(out, e->name);
    imki_text_add(out, "_H\n#define ");
    imki_emit_capitals(out, e->name);
    imki_text_add(out,
                  "_H\n\n#include <stdint.h>\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
    print_flags(e);
    imki_emit_prototype(e);
    imki_text_add(
        out,
        ";\n\n/* In %s_test.c, to be linked for a test only: returns how many of its %lu samples\n "
        "* the function above corrects outside the bound, or flags differently. */\nunsigned long "
        "%s_self_test(void);\n\n#ifdef __cplusplus\n}\n#endif\n#endif\n",
        e->name, (unsigned long)e->vectors, e->name);
}
