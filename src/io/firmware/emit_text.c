/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of the emitted code share: numbers, types, names. */
#include "emit_internal.h"

#include "imukit/decimal.h"

#include <inttypes.h>
#include <math.h>

const char *const imki_emit_sensor[2] = {"gyro", "accel"};
const char *const imki_emit_motion[2] = {"rate", "force"};
const char *const imki_emit_unit[2] = {"rad/s", "m/s^2"};

const char *imki_emit_type(const imk_firmware *plan)
{
    static const char *const types[3] = {"float", "double", "int32_t"};
    return types[plan->arithmetic];
}

const char *imki_emit_reading_type(const imk_firmware *plan, int sensor)
{
    return plan->channel[sensor][0].in_counts ? "int32_t" : imki_emit_type(plan);
}

void imki_emit_prototype(const imki_emission *e)
{
    const imk_firmware *f = e->plan;
    const char *separator = "";
    bool is_first = true;
    imki_text_add(e->out, "unsigned %s_correct(", e->name);
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0) {
            imki_text_add(e->out, "%sconst %s %s[%d]", separator, imki_emit_reading_type(f, sensor),
                          imki_emit_sensor[sensor], f->axis_count[sensor]);
            separator = ", ";
        }
    if (f->needs_temperature)
        imki_text_add(e->out, "%s%s temperature", separator, imki_emit_type(f));
    for (int sensor = 0; sensor < 2; sensor++)
        if (f->axis_count[sensor] > 0) {
            imki_text_add(e->out, "%s%s %s[%d]", is_first ? ",\n    " : ", ", imki_emit_type(f),
                          imki_emit_motion[sensor], f->output_count[sensor]);
            is_first = false;
        }
    imki_text_add(e->out, ")");
}

/* printf's %a depends on the locale and the C library. */
void imki_emit_number(imki_text *out, imk_firmware_arithmetic arithmetic, double value)
{
    int exponent = 0;
    const double size = fabs(frexp(value, &exponent)); /* 0.5 … 1 */
    uint64_t digits = size > 0 ? (uint64_t)ldexp(size, 53) - ((uint64_t)1 << 52) : 0;
    const char *suffix = arithmetic == IMK_FIRMWARE_FLOAT ? "f" : "";
    char text[16];
    int length = 13;
    if (size == 0) {
        imki_text_add(out, "0.0%s", suffix);
        return;
    }
    for (int i = 12; i >= 0; i--, digits >>= 4)
        text[i] = "0123456789abcdef"[digits & 15];
    while (length > 0 && text[length - 1] == '0')
        length--;
    text[length] = '\0';
    imki_text_add(out, "%s0x1%s%sp%d%s", value < 0 ? "-" : "", length > 0 ? "." : "", text,
                  exponent - 1, suffix);
}

void imki_emit_decimal(imki_text *out, double value, int digits)
{
    char text[IMK_DECIMAL_SIZE];
    imk_decimal_significant(value, digits, text);
    imki_text_add(out, "%s", text);
}

void imki_emit_plain(imki_text *out, const char *text)
{
    for (char before = ' '; *text; before = *text++) {
        const bool control = (unsigned char)*text < ' ' || *text == 0x7F;
        /* The end of the comment, the beginning of another, and a trigraph or line join. */
        const bool harmful = (before == '*' && *text == '/') || (before == '/' && *text == '*') ||
                             *text == '\\' || (before == '?' && *text == '?');
        imki_text_add(out, "%c", control || harmful ? ' ' : *text);
    }
}

void imki_emit_capitals(imki_text *out, const char *name)
{
    for (; *name; name++)
        imki_text_add(out, "%c", *name >= 'a' && *name <= 'z' ? *name - 'a' + 'A' : *name);
}
