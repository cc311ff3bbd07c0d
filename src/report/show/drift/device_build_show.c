/* SPDX-License-Identifier: Apache-2.0 */
/* Size, mass and supply of a device, as cells of a table and as data. */
#include "report/show/show_internal.h"

static void add_supply(const imk_device_build *build, imk_table *table)
{
    const double value = build->power > 0 ? build->power : build->current;
    if (value > 0)
        imk_table_add(table, "%s%g %s", build->is_limit ? "< " : "", 1e3 * value,
                      build->power > 0 ? "mW" : "mA");
    else
        imk_table_add(table, "-");
}

void imk_show_build_cells(const imk_device_build *build, imk_table *table)
{
    if (!build) {
        imk_table_add(table, "-\t-\t-");
        return;
    }
    if (build->size[0] > 0)
        imk_table_add(table, "%g x %g x %g", 1e3 * build->size[0], 1e3 * build->size[1],
                      1e3 * build->size[2]);
    else
        imk_table_add(table, "-");
    if (build->mass > 0)
        imk_table_add(table, "%g", 1e3 * build->mass);
    else
        imk_table_add(table, "-");
    add_supply(build, table);
}

static void show_figure(const char *key, double value, const char *unit, imk_result *result)
{
    if (value > 0)
        imk_result_quantity(result, key, value, unit);
    else
        imk_result_null(result, key);
}

void imk_show_build(const imk_device_build *build, imk_result *result)
{
    if (!imki_begin_object(result, "build", build != NULL) || !build)
        return;
    if (imki_begin_object(result, "size", build->size[0] > 0)) {
        imk_result_numbers(result, "value", 3, build->size);
        imk_result_text(result, "unit", "m");
        imk_result_end(result);
    }
    show_figure("mass", build->mass, "kg", result);
    show_figure("power", build->power, "W", result);
    show_figure("current", build->current, "A", result);
    imk_result_flag(result, "supply_is_limit", build->is_limit);
    imk_result_text(result, "source", build->source);
    imk_result_end(result);
}
