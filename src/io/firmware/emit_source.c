/* SPDX-License-Identifier: Apache-2.0 */
/* NAME.c: the operations of a plan as one function. Operations that have a meaning, or are used
 * more than once, get a name; the others are written where they are used. All constants stand in
 * one table, exactly, with their decimal and what they are. */
#include "emit_internal.h"

#include "imukit/decimal.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The table of constants, written while the body is. */
typedef struct source {
    imki_emission *emission;
    const imk_firmware *plan;
    imki_text table, body;
    int constants;
    bool uses_clip, uses_size;
} source;

static bool is_fixed(const source *s)
{
    return s->plan->arithmetic == IMK_FIRMWARE_FIXED;
}

/* ---- constants ------------------------------------------------------------------------------- */

/* What a constant of an operation is: `what` for the rest of the message. */
static void describe(imki_text *out, const imk_firmware_operation *o,
                     const imk_firmware_operation *of, imk_firmware_role within)
{
    const char *sensor = imki_emit_sensor[o->sensor], *motion = imki_emit_motion[o->sensor];
    switch (within) {
    case IMK_FIRMWARE_CELSIUS:
        imki_text_add(out, "end of the valid range [degC]");
        break;
    case IMK_FIRMWARE_SCALED:
        imki_text_add(out, of ? "per degC" : "temperature to -1 ... 1");
        break;
    case IMK_FIRMWARE_BIAS:
        imki_text_add(out, "bias of %s[%d], t^%d", sensor, o->axis, o->step + (of ? 1 : 0));
        break;
    case IMK_FIRMWARE_INPUT:
        imki_text_add(out, "bias of %s[%d]", sensor, o->axis);
        break;
    case IMK_FIRMWARE_SLOPE:
        imki_text_add(out, "scale factor of %s[%d], t^%d", sensor, o->axis, o->step + (of ? 1 : 0));
        break;
    case IMK_FIRMWARE_WITHIN:
        imki_text_add(out, "limit of %s[%d]", motion, o->axis);
        break;
    case IMK_FIRMWARE_ALONG:
        imki_text_add(out, "direction of %s[%d]", sensor, o->axis);
        break;
    case IMK_FIRMWARE_MOTION:
        imki_text_add(out, "%s[%d]", motion, o->axis);
        if (of)
            imki_text_add(out, " per %s[%d]%s", imki_emit_sensor[of->sensor], of->axis,
                          of->role == IMK_FIRMWARE_REST ? ", not linear" : "");
        break;
    default:
        imki_text_add(out, "not linear in %s[%d]", sensor, o->axis);
    }
}

/* The row of the table with this text: a new one, unless it is there already. */
static void row(source *s, const imki_text *text)
{
    int number = 0;
    s->table.failed = s->table.failed || text->failed;
    if (s->table.failed)
        return;
    const char *at = s->table.bytes;
    for (; number < s->constants; number++) {
        const size_t length = strcspn(at, "\n");
        if (length == text->size && memcmp(at, text->bytes, length) == 0)
            break;
        at += length + 1;
    }
    if (number == s->constants) {
        imki_text_add(&s->table, "%s\n", text->bytes);
        s->constants++;
    }
    imki_text_add(&s->body, "c[%d]", number);
}

/* The rest of a row, behind the number. */
static void end_row(source *s, imki_text *text, double value, const imk_firmware_operation *o,
                    const imk_firmware_operation *of, imk_firmware_role within)
{
    imki_text_add(text, ", /* ");
    imki_emit_decimal(text, value, 9);
    imki_text_add(text, "  ");
    describe(text, o, of, within);
    imki_text_add(text, " */");
    row(s, text);
    free(text->bytes);
}

/* A constant of the operation `o`, its part with `of`; `within`: the role of what it belongs to. */
static void constant(source *s, double value, const imk_firmware_operation *o,
                     const imk_firmware_operation *of, imk_firmware_role within)
{
    imki_text text = {.bytes = NULL};
    imki_emit_number(&text, s->plan->arithmetic, value);
    end_row(s, &text, value, o, of, within);
}

static void fixed_constant(source *s, int32_t integer, double value,
                           const imk_firmware_operation *o, const imk_firmware_operation *of,
                           imk_firmware_role within)
{
    imki_text text = {.bytes = NULL};
    imki_text_add(&text, "%" PRId32, integer);
    end_row(s, &text, value, o, of, within);
}

/* ---- operations ------------------------------------------------------------------------------ */

/* The name of an operation's value. */
static void name_of(imki_text *out, const source *s, int n)
{
    static const char *const of_axis[IMK_FIRMWARE_MOTION + 1] = {
        [IMK_FIRMWARE_BIAS] = "bias_", [IMK_FIRMWARE_INPUT] = "", [IMK_FIRMWARE_SLOPE] = "scale_"};
    static const char *const others[IMK_FIRMWARE_MOTION + 1] = {[IMK_FIRMWARE_CELSIUS] = "celsius",
                                                                [IMK_FIRMWARE_SCALED] = "t",
                                                                [IMK_FIRMWARE_WITHIN] = "within",
                                                                [IMK_FIRMWARE_ALONG] = "along",
                                                                [IMK_FIRMWARE_REST] = "rest"};
    const imk_firmware_operation *o = &s->plan->operation[n];
    if (o->role == IMK_FIRMWARE_MOTION)
        imki_text_add(out, "%s_%d_%d", imki_emit_motion[o->sensor], o->axis, o->step);
    else if (of_axis[o->role])
        imki_text_add(out, "%s%s_%d", of_axis[o->role], imki_emit_sensor[o->sensor], o->axis);
    else
        imki_text_add(out, "%s_%d", others[o->role] ? others[o->role] : "part", n);
}

static bool is_inline(const source *s, int n)
{
    const imk_firmware_operation *o = &s->plan->operation[n];
    return o->kind == IMK_FIRMWARE_TEMPERATURE ||
           (o->role == IMK_FIRMWARE_STEP && s->emission->uses[n] == 1);
}

static void expression(source *s, int n, imk_firmware_role within);

/* An operand: its name, or what it is. */
static void operand(source *s, int n, imk_firmware_role within)
{
    const imk_firmware_operation *o = &s->plan->operation[n];
    const bool shifted = is_fixed(s) && o->kind == IMK_FIRMWARE_READING &&
                         s->plan->channel[o->sensor][o->axis].origin != 0;
    const bool compound = o->kind == IMK_FIRMWARE_PRODUCT || o->kind == IMK_FIRMWARE_SUM || shifted;
    if (!is_inline(s, n)) {
        name_of(&s->body, s, n);
        return;
    }
    imki_text_add(&s->body, compound ? "(" : "");
    expression(s, n, within);
    imki_text_add(&s->body, compound ? ")" : "");
}

static void reading(source *s, const imk_firmware_operation *o)
{
    const imk_firmware_channel *channel = &s->plan->channel[o->sensor][o->axis];
    const char *sensor = imki_emit_sensor[o->sensor];
    imki_text *out = &s->body;
    if (is_fixed(s)) {
        s->uses_clip = true;
        imki_text_add(out, "clip(%s[%d], %" PRId32 ", %" PRId32 ")", sensor, o->axis,
                      o->fixed_lower, o->fixed_upper);
        if (channel->origin != 0)
            imki_text_add(out, " %c %" PRId32, channel->origin < 0 ? '+' : '-',
                          abs(channel->origin));
        return;
    }
    if (!channel->in_counts)
        imki_text_add(out, "%s[%d]", sensor, o->axis);
    else if (channel->origin == 0)
        imki_text_add(out, "(%s)%s[%d]", imki_emit_type(s->plan), sensor, o->axis);
    else /* far beyond the range the difference would overflow, which unsigned numbers may */
        imki_text_add(out, "(%s)(int32_t)((uint32_t)%s[%d] - (uint32_t)%" PRId32 ")",
                      imki_emit_type(s->plan), sensor, o->axis, channel->origin);
}

static void bound(source *s, const imk_firmware_operation *o, int32_t fixed, double value)
{
    if (is_fixed(s))
        fixed_constant(s, fixed, value, o, NULL, o->role);
    else
        constant(s, value, o, NULL, o->role);
}

static void clip(source *s, const imk_firmware_operation *o, imk_firmware_role within)
{
    s->uses_clip = true;
    imki_text_add(&s->body, "clip(");
    operand(s, o->a, within);
    imki_text_add(&s->body, ", ");
    bound(s, o, o->fixed_lower, o->lower);
    imki_text_add(&s->body, ", ");
    bound(s, o, o->fixed_upper, o->upper);
    imki_text_add(&s->body, ")");
}

static void product(source *s, const imk_firmware_operation *o, imk_firmware_role within)
{
    if (is_fixed(s))
        imki_text_add(&s->body, "(int32_t)(((int64_t)");
    operand(s, o->a, within);
    imki_text_add(&s->body, " * ");
    operand(s, o->b, within);
    if (is_fixed(s)) {
        imki_text_add(&s->body, " + INT64_C(%" PRId64 ")) >> %d)", (int64_t)1 << (o->shift - 1),
                      o->shift);
        if (o->fixed_constant != 0) {
            imki_text_add(&s->body, " + ");
            fixed_constant(s, (int32_t)o->fixed_constant, o->constant, o, NULL, within);
        }
    } else if (o->constant != 0) {
        imki_text_add(&s->body, " + ");
        constant(s, o->constant, o, NULL, within);
    }
}

/* Between the addends: a new line when the old one is long. */
static void join(source *s, const char *sign)
{
    size_t length = 0;
    while (length < s->body.size && s->body.bytes[s->body.size - 1 - length] != '\n')
        length++;
    imki_text_add(&s->body, length > 72 ? "\n        %s" : " %s", sign);
}

static void sum(source *s, const imk_firmware_operation *o, imk_firmware_role within)
{
    bool any = false;
    if (o->constant != 0 || o->count == 0) {
        constant(s, o->constant, o, NULL, within);
        any = true;
    }
    for (int k = o->first; k < o->first + o->count; k++) {
        const imk_firmware_term *term = &s->plan->term[k];
        const bool is_one = fabs(term->coefficient) == 1;
        if (any)
            join(s, is_one && term->coefficient < 0 ? "- " : "+ ");
        else if (is_one && term->coefficient < 0)
            imki_text_add(&s->body, "-");
        if (!is_one) {
            constant(s, term->coefficient, o, &s->plan->operation[term->operand], within);
            imki_text_add(&s->body, " * ");
        }
        operand(s, term->operand, within);
        any = true;
    }
}

static void fixed_sum(source *s, const imk_firmware_operation *o, imk_firmware_role within)
{
    imki_text_add(&s->body, "(int32_t)((");
    for (int k = o->first; k < o->first + o->count; k++) {
        const imk_firmware_term *term = &s->plan->term[k];
        if (k > o->first)
            join(s, "+ ");
        fixed_constant(s, term->fixed, term->coefficient, o, &s->plan->operation[term->operand],
                       within);
        imki_text_add(&s->body, " * (int64_t)");
        operand(s, term->operand, within);
    }
    if (o->count > 0)
        join(s, "+ ");
    imki_text_add(&s->body, "INT64_C(%" PRId64 ")) >> %d)", o->fixed_constant, o->shift);
}

static void expression(source *s, int n, imk_firmware_role within)
{
    const imk_firmware_operation *o = &s->plan->operation[n];
    if (o->role != IMK_FIRMWARE_STEP)
        within = o->role;
    switch (o->kind) {
    case IMK_FIRMWARE_READING:
        reading(s, o);
        break;
    case IMK_FIRMWARE_TEMPERATURE:
        imki_text_add(&s->body, "temperature");
        break;
    case IMK_FIRMWARE_CLIP:
        clip(s, o, within);
        break;
    case IMK_FIRMWARE_SIZE:
        s->uses_size = true;
        imki_text_add(&s->body, "size(");
        operand(s, o->a, within);
        imki_text_add(&s->body, ")");
        break;
    case IMK_FIRMWARE_PRODUCT:
        product(s, o, within);
        break;
    case IMK_FIRMWARE_SUM:
        if (is_fixed(s))
            fixed_sum(s, o, within);
        else
            sum(s, o, within);
    }
}

/* ---- flags ----------------------------------------------------------------------------------- */

static void flag_name(source *s, unsigned flag)
{
    imki_emit_capitals(&s->body, s->emission->name);
    imki_text_add(&s->body, flag == IMK_FLAG_SATURATED     ? "_SATURATED"
                            : flag == IMK_FLAG_TEMPERATURE ? "_TEMPERATURE"
                            : flag == IMK_FLAG_LIMIT       ? "_LIMIT"
                                                           : "_NOT_FINITE");
}

/* The end of a condition, and the flag; where `number` is none, that one. NULL: it always is. */
static void raise_flag(source *s, unsigned flag, const char *number)
{
    imki_text_add(&s->body, ")\n        flags |= ");
    if (number)
        imki_text_add(&s->body, "%s - %s == 0 ? ", number, number);
    flag_name(s, flag);
    if (number) {
        imki_text_add(&s->body, " : ");
        flag_name(s, IMK_FLAG_NOT_FINITE);
    }
    imki_text_add(&s->body, ";\n");
}

/* A number of the arithmetic, or an integer for fixed-point values and counts. */
static void threshold(source *s, double value, bool integer, int bits)
{
    if (integer)
        imki_text_add(&s->body, "%" PRId64, (int64_t)floor(ldexp(value, bits)));
    else
        imki_emit_number(&s->body, s->plan->arithmetic, value);
}

static void reading_flags(source *s, int sensor, int i)
{
    const imk_firmware_channel *channel = &s->plan->channel[sensor][i];
    const bool integer = channel->in_counts || is_fixed(s);
    imki_text *out = &s->body;
    char name[32];
    snprintf(name, sizeof name, "%s[%d]", imki_emit_sensor[sensor], i);
    imki_text_add(out, "    if (!(%s > ", name);
    threshold(s, channel->lower, integer, channel->bits);
    imki_text_add(out, " && %s < ", name);
    if (is_fixed(s) && !channel->in_counts) /* of two integers beside it the one above */
        imki_text_add(out, "%" PRId64, (int64_t)ceil(ldexp(channel->upper, channel->bits)));
    else
        threshold(s, channel->upper, integer, channel->bits);
    imki_text_add(out, ")");
    raise_flag(s, channel->flag, integer ? NULL : name);
}

static void temperature_flags(source *s)
{
    const imk_firmware *f = s->plan;
    imki_text *out = &s->body;
    if (!f->needs_temperature)
        return;
    imki_text_add(out, "    if (!(temperature >= ");
    if (is_fixed(s))
        imki_text_add(out, "%" PRId64,
                      (int64_t)ceil(ldexp(f->temperature_minimum, f->temperature_bits)));
    else
        threshold(s, f->temperature_minimum, false, 0);
    imki_text_add(out, " && temperature <= ");
    threshold(s, f->temperature_maximum, is_fixed(s), f->temperature_bits);
    imki_text_add(out, ")");
    raise_flag(s, IMK_FLAG_TEMPERATURE, is_fixed(s) ? NULL : "temperature");
}

static void output(source *s, int sensor, int j)
{
    const imk_firmware *f = s->plan;
    imki_text *out = &s->body;
    imki_text_add(out, "    %s[%d] = ", imki_emit_motion[sensor], j);
    name_of(out, s, f->output[sensor][j]);
    imki_text_add(out, ";\n");
    if (!f->limited[sensor])
        return;
    s->uses_size = true;
    imki_text_add(out, "    if (size(");
    name_of(out, s, f->output[sensor][j]);
    imki_text_add(out, ") > ");
    threshold(s, f->limit[sensor][j], is_fixed(s), f->output_bits[sensor]);
    raise_flag(s, IMK_FLAG_LIMIT, NULL);
}

/* ---- file ------------------------------------------------------------------------------------ */

static void count_uses(source *s)
{
    const imk_firmware *f = s->plan;
    int *uses = s->emission->uses;
    memset(uses, 0, sizeof s->emission->uses);
    for (int n = 0; n < f->operation_count; n++) {
        const imk_firmware_operation *o = &f->operation[n];
        if (o->a >= 0)
            uses[o->a]++;
        if (o->b >= 0)
            uses[o->b]++;
        for (int k = o->first; k < o->first + o->count; k++)
            uses[f->term[k].operand]++;
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++)
            uses[f->output[sensor][j]] += 2; /* always a name */
}

static void write_body(source *s)
{
    const imk_firmware *f = s->plan;
    imki_text_add(&s->body, "{\n    unsigned flags = 0;\n");
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++)
            reading_flags(s, sensor, i);
    temperature_flags(s);
    imki_text_add(&s->body, "\n");
    for (int n = 0; n < f->operation_count; n++) {
        if (is_inline(s, n))
            continue;
        imki_text_add(&s->body, "    const %s ", imki_emit_type(f));
        name_of(&s->body, s, n);
        imki_text_add(&s->body, " = ");
        expression(s, n, IMK_FIRMWARE_STEP);
        imki_text_add(&s->body, ";\n");
    }
    imki_text_add(&s->body, "\n");
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++)
            output(s, sensor, j);
    imki_text_add(&s->body, "    return flags;\n}\n");
}

/* The constants with their numbers. */
static void write_table(const source *s, imki_text *out)
{
    const char *at = s->table.bytes;
    for (int number = 0; number < s->constants && !s->table.failed; number++) {
        const int length = (int)strcspn(at, "\n"), value = (int)strcspn(at, "*");
        imki_text_add(out, "    %.*s %d:%.*s\n", value + 1, at, number, length - value - 1,
                      at + value + 1);
        at += length + 1;
    }
}

static void write_helpers(const source *s, imki_text *out)
{
    const char *type = imki_emit_type(s->plan);
    if (s->uses_clip)
        imki_text_add(out,
                      "static inline %s clip(%s x, %s lower, %s upper)\n{\n    return x < lower ? "
                      "lower : x > upper ? upper : x;\n}\n\n",
                      type, type, type, type);
    if (s->uses_size)
        imki_text_add(out, "static inline %s size(%s x)\n{\n    return x < 0 ? -x : x;\n}\n\n",
                      type, type);
}

void imki_emit_source(imki_emission *e)
{
    imki_text *out = e->out;
    source s = {.emission = e, .plan = e->plan};
    count_uses(&s);
    write_body(&s);
    imki_text_add(out, IMKI_EMIT_MARK ": change the model, not this file. */\n");
    imki_text_add(out, "#include \"%s.h\"\n\n", e->name);
    if (is_fixed(&s)) {
        imki_text_add(out, "/* Shifting a negative number to the right must round it down, as all "
                           "common compilers do. */\ntypedef char ");
        imki_text_add(out, "%s_shifts_round_down[(-1 >> 1) == -1 ? 1 : -1];\n\n", e->name);
    }
    if (s.constants > 0 && !s.table.failed) {
        imki_text_add(out, "static const %s c[%d] = {\n", imki_emit_type(e->plan), s.constants);
        write_table(&s, out);
        imki_text_add(out, "};\n\n");
    }
    write_helpers(&s, out);
    imki_emit_prototype(e);
    imki_text_add(out, "\n");
    imki_text_put_bytes(out, s.body.bytes, s.body.size);
    out->failed = out->failed || s.body.failed || s.table.failed;
    free(s.body.bytes);
    free(s.table.bytes);
}
