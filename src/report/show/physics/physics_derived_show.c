/* SPDX-License-Identifier: Apache-2.0 */
/* What follows from the parts of a design, as a table with the equations and as data. */
#include "imukit/decimal.h"
#include "physics_show_internal.h"

#include <math.h>
#include <stdio.h>

/* In the unit of the row, six digits; "-" when this design has none. */
static void value_text(const imk_derived *derived, double value, char *text, size_t size)
{
    char digits[64] = "-";
    if (isfinite(value))
        (void)imk_decimal_significant(value / imk_unit_of(derived->unit).scale, 6, digits);
    snprintf(text, size, "%s", digits);
}

void imki_show_derived(const imk_physics_shown *p, imk_result *result)
{
    const void *design = p->settings->design;
    const imk_derived *first = p->settings->instrument->derived;
    char text[64];
    imk_table *table = imk_result_table(result, 2u);
    imk_table_row(table, "quantity\tvalue\tunit\tequation\tsource");
    for (const imk_derived *d = first; d->name; d++) {
        value_text(d, imk_derived_value(d, design), text, sizeof text);
        imk_table_row(table, "%s\t%s\t%s\t%s\t%s", d->name, text, imki_unit_text(d->unit),
                      d->equation, d->source);
    }
    for (const imk_derived *d = first; d->name; d++)
        if (!isfinite(imk_derived_value(d, design)))
            imk_result_line(result, "No %s: %s.", d->name, d->absent ? d->absent : "none");
}

void imki_derived_data(const imk_physics_shown *p, imk_result *result)
{
    const void *design = p->settings->design;
    imk_result_array(result, "derived");
    for (const imk_derived *d = p->settings->instrument->derived; d->name; d++) {
        const double value = imk_derived_value(d, design);
        imk_result_object(result, NULL);
        imk_result_text(result, "name", d->name);
        imk_result_text(result, "symbol", d->symbol);
        imk_result_number(result, "value", value);
        imk_result_text(result, "unit", d->si);
        imk_result_text(result, "equation", d->equation);
        imk_result_text(result, "source", d->source);
        imk_result_text(result, "absent", isfinite(value) ? NULL : d->absent);
        imk_result_end(result);
    }
    imk_result_end(result);
}
