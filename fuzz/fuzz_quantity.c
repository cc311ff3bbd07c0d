/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of units, quantities and what a count is: what is read is written and reads back
 * with the same bits; a count is read as a positive number, or refused.
 * Reads: src/base/units/units.c src/base/units/unit_table.c src/base/units/quantity.c
 * src/base/units/quantity_format.c src/base/units/dimension_table.c src/base/units/count_scale.c
 * src/base/nearest_name.c */
#include "harness.h"

#include "imukit/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS = 6, TEXT = 1024 };

/* The dimension of the unit a text ends with: that of its longest end behind a blank that is a
 * unit. */
static imk_dimension dimension_of(const char *begin, const char *end)
{
    imk_unit unit = {.scale = 0.0};
    for (const char *at = begin; at < end; at++)
        if ((at == begin || at[-1] == ' ') && imk_unit_parse(at, end, &unit, NULL) == IMK_OK)
            break;
    return unit.dimension;
}

static void check_unit(const char *begin, const char *end)
{
    imk_unit unit, again;
    char si[64];
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_unit_parse(begin, end, &unit, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    require(isfinite(unit.scale) && unit.scale > 0.0 && isfinite(unit.offset));
    require(imk_unit_parse(unit.text, unit.text + strlen(unit.text), &again, NULL) == IMK_OK);
    require(again.scale == unit.scale && again.offset == unit.offset &&
            imk_dimension_equal(again.dimension, unit.dimension));
    require(strlen(imk_dimension_name(unit.dimension)) > 0);
    const size_t length = imk_dimension_si(unit.dimension, si, sizeof si);
    require(length < sizeof si);
    if (length > 0 && imk_unit_parse(si, si + length, &again, NULL) == IMK_OK)
        require(again.scale == 1.0 && imk_dimension_equal(again.dimension, unit.dimension));
}

static void check_quantity(const char *begin, const char *end)
{
    double value[NUMBERS], sigma[NUMBERS], back[NUMBERS], back_sigma[NUMBERS];
    size_t count = 0, back_count = 0;
    imk_unit unit;
    imk_error error = {.status = IMK_OK};
    char text[TEXT];
    const imk_dimension dimension = dimension_of(begin, end);
    const imk_status status =
        imk_quantity_parse(begin, end, dimension, NUMBERS, value, sigma, &count, &unit, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    require(count >= 1 && count <= NUMBERS);
    for (size_t i = 0; i < count; i++)
        require(isfinite(value[i]) && sigma[i] >= 0.0 && isfinite(sigma[i]));
    const size_t length = imk_quantity_format(value, sigma, count, &unit, text, sizeof text);
    require(length > 0 && length < sizeof text);
    require(imk_quantity_parse(text, text + length, dimension, NUMBERS, back, back_sigma,
                               &back_count, NULL, NULL) == IMK_OK);
    require(back_count == count);
    require(memcmp(back, value, count * sizeof *value) == 0);
    require(memcmp(back_sigma, sigma, count * sizeof *sigma) == 0);
}

static void check_scale(const char *begin, const char *end)
{
    static const char *const quantities[] = {"rad/s", "m/s^2", "K", "m*A"};
    for (size_t i = 0; i < sizeof quantities / sizeof quantities[0]; i++) {
        double per_count = -1;
        imk_error error = {.status = IMK_OK};
        const imk_status status = imk_count_scale_parse(
            begin, end, imk_unit_of(quantities[i]).dimension, &per_count, &error);
        require_told(status, &error);
        require(status == IMK_OK ? per_count > 0 && isfinite(per_count) : per_count == -1);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    check_unit(text, text + size);
    check_quantity(text, text + size);
    check_scale(text, text + size);
    free(text);
    return 0;
}
