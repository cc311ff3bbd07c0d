/* SPDX-License-Identifier: Apache-2.0 */
/* What became of the readings of aids: data, a table, and their innovations against time. */
#include "navigate_aids_show_internal.h"

#include <math.h>
#include <stdio.h>

enum { POINTS_MAX = 4000, AXES = 3, BAND_COLOR = 7 };

static const double degree = 0.017453292519943295;
static const char *const axis_names[2][AXES] = {{"north", "east", "down"},
                                                {"forward", "right", "down"}};

static double per_degree(double square, uint64_t degrees)
{
    return degrees > 0 ? square / (double)degrees : (double)NAN;
}

/* ---- data ---- */

static void show_one(const imk_navigate_aid *a, imk_result *result)
{
    const imk_navigation_filter_counts *c = &a->counts;
    const char *unit = imk_aid_unit(a->aid.kind);
    imk_result_object(result, NULL);
    imk_result_text(result, "kind", imk_aid_kind_name(a->aid.kind));
    imk_result_text(result, "unit", unit);
    if (a->sigma_columns)
        imk_result_null(result, "sigma");
    else
        imk_result_numbers(result, "sigma", imk_aid_axes(a->aid.kind), a->aid.sigma);
    imk_result_numbers(result, "lever_arm", AXES, a->aid.lever_arm);
    imk_result_count(result, "readings", (long long)a->readings);
    imk_result_count(result, "outside", (long long)a->outside);
    imk_result_count(result, "accepted", (long long)c->accepted);
    imk_result_count(result, "refused", (long long)c->refused);
    imk_result_count(result, "recovered", (long long)c->recovered);
    imk_result_quantity(result, "first", a->first, "s");
    imk_result_quantity(result, "last", a->last, "s");
    imk_result_number(result, "chi_square_per_degree", per_degree(c->chi_square, c->degrees));
    imk_result_number(result, "correlation", imk_navigation_filter_correlation(&a->counts));
    imk_result_count(result, "compared", (long long)a->compared);
    imk_result_number(result, "compared_chi_square_per_degree",
                      per_degree(a->compared_square, a->compared_degrees));
    if (a->compared > 0) {
        imk_result_numbers(result, "compared_last_off", imk_aid_axes(a->aid.kind), a->last_off);
        imk_result_numbers(result, "compared_last_sigma", imk_aid_axes(a->aid.kind), a->last_sigma);
    }
    imk_result_end(result);
}

void imki_show_aids_data(const imk_navigate_log *n, imk_result *result)
{
    imk_result_array(result, "aids");
    for (size_t k = 0; k < n->aid_count; k++)
        show_one(&n->aid[k], result);
    imk_result_end(result);
}

/* ---- text ---- */

static void add_number(imk_table *table, double value)
{
    if (isnan(value))
        imk_table_add(table, "-");
    else
        imk_table_add(table, "%.2f", value);
}

/* An outage: how far off the estimate is from the last reading that was only compared. */
static void show_outage(const imk_navigate_log *n, const imk_navigate_aid *a, imk_result *result)
{
    const bool angle = a->aid.kind == IMK_AID_HEADING;
    const size_t axes = imk_aid_axes(a->aid.kind);
    char text[160] = "";
    size_t used = 0;
    for (size_t i = 0; i < axes && used < sizeof text; i++) {
        if (isnan(a->last_off[i]))
            continue;
        const double scale = angle ? degree : 1.0;
        const int length =
            snprintf(text + used, sizeof text - used, "%s%s%s%.2g ± %.2g", used > 0 ? ", " : "",
                     axes == 1 ? "" : axis_names[a->aid.kind == IMK_AID_ODOMETER][i],
                     axes == 1 ? "" : " ", a->last_off[i] / scale, a->last_sigma[i] / scale);
        used += length > 0 ? (size_t)length : 0;
    }
    imk_result_line(result,
                    "After %.4g s without aids the estimate is off the %s read by %s %s "
                    "(± 1 sigma predicted, of both)",
                    a->time[a->tested - 1] - (n->record.first_time + n->settings.aid_until),
                    imk_aid_kind_name(a->aid.kind), text,
                    angle ? "deg" : imk_aid_unit(a->aid.kind));
}

void imki_show_aids_table(const imk_navigate_log *n, imk_result *result)
{
    if (n->aid_count == 0)
        return;
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 1U << 1 | 1U << 2 | 1U << 3 | 1U << 4);
    imk_table_row(table, "aid\tused\trefused\tinnovations squared\tcorrelation");
    for (size_t k = 0; k < n->aid_count; k++) {
        const imk_navigate_aid *a = &n->aid[k];
        imk_table_row(table, "%s", imk_aid_kind_name(a->aid.kind));
        imk_table_add(table, "%llu", (unsigned long long)a->counts.accepted);
        imk_table_add(table, "%llu", (unsigned long long)a->counts.refused);
        add_number(table, per_degree(a->counts.chi_square, a->counts.degrees));
        add_number(table, imk_navigation_filter_correlation(&a->counts));
    }
    imk_result_gap(result);
    for (size_t k = 0; k < n->aid_count; k++)
        if (n->aid[k].compared > 0)
            show_outage(n, &n->aid[k], result);
}

/* ---- figure ---- */

static void add_band(const imk_navigate_aid *a, imk_figure_builder *figure)
{
    for (int side = -1; side <= 1; side += 2) {
        imki_begin_curve(figure, side < 0 ? "± 2 sigma" : "", IMK_CURVE_DASHES, BAND_COLOR);
        imk_figure_point(figure, a->time[0], 2.0 * side);
        imk_figure_point(figure, a->time[a->tested - 1], 2.0 * side);
    }
}

static void add_axis(const imk_navigate_aid *a, size_t axis, imk_figure_builder *figure)
{
    const size_t every = a->tested / POINTS_MAX + 1;
    const bool single = imk_aid_axes(a->aid.kind) == 1;
    bool any = false;
    for (size_t k = 0; k < a->tested && !any; k++)
        any = isfinite(a->innovation[axis][k]);
    if (!any)
        return;
    imki_begin_curve(figure, single ? "" : axis_names[a->aid.kind == IMK_AID_ODOMETER][axis],
                     IMK_CURVE_POINTS, (int)axis);
    for (size_t k = 0; k < a->tested; k += every)
        if (isfinite(a->innovation[axis][k]))
            imk_figure_point(figure, a->time[k], a->innovation[axis][k]);
}

void imki_show_aids_panels(const imk_navigate_log *n, imk_figure_builder *figure)
{
    for (size_t k = 0; k < n->aid_count; k++) {
        const imk_navigate_aid *a = &n->aid[k];
        char title[60];
        if (a->tested == 0)
            continue;
        snprintf(title, sizeof title, "innovations of the %s", imk_aid_kind_name(a->aid.kind));
        imk_figure_panel(figure, &(imk_panel){.title = title,
                                              .x_label = "time [s]",
                                              .y_label = "prediction - reading [sigma]",
                                              .key = IMK_KEY_BELOW});
        add_band(a, figure);
        for (size_t axis = 0; axis < AXES; axis++)
            add_axis(a, axis, figure);
    }
}
