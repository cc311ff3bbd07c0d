/* SPDX-License-Identifier: Apache-2.0 */
/* Figures of runs beside those of the covariance. */
#include "drift_parts.h"

#include <math.h>

/* A linear figure and one of runs differ when the interval of the runs leaves out this much on
 * either side of the linear figure: what fourth-order terms explain is left aside. Of a table of
 * 95 % intervals some leave out the truth: they are widened by 2.5, to 1e-6 each for a figure that
 * is near normal. */
static const double tolerance = 0.05, widening = 2.5;

static const drift_case *last_case(const drift_result *r)
{
    return &r->cases[r->case_count - 1];
}

/* "12.3 m (11.9 to 12.8)" */
static void set_interval(text_table *table, size_t column, imk_drift_wish wish, double value,
                         double low, double high)
{
    char a[DRIFT_TEXT], b[DRIFT_TEXT], c[DRIFT_TEXT];
    const imk_unit unit = drift_unit_of(wish, value);
    text_table_set(table, column, "%s (%s to %s)", drift_in_unit(value, &unit, a),
                   drift_number(low / unit.scale, b),
                   isinf(high) ? "?" : drift_number(high / unit.scale, c));
}

text_table drift_runs_table(const drift_result *r)
{
    static const imk_drift_wish shown[] = {IMK_WISH_CEP, IMK_WISH_R95, IMK_WISH_VELOCITY,
                                           IMK_WISH_HEADING};
    enum { SHOWN = sizeof shown / sizeof shown[0] };
    text_table table = text_table_make(2 + SHOWN);
    text_table_row(&table);
    text_table_set(&table, 0, "time");
    text_table_set(&table, 1, "runs");
    for (size_t c = 0; c < SHOWN; c++)
        text_table_set(&table, 2 + c, "%s", drift_wish_name(shown[c]));
    for (size_t k = 0; k < r->scene->row_count; k++) {
        text_table_row(&table);
        drift_set_time(&table, r->scene->time[r->scene->row[k]], DRIFT_LINEAR);
        text_table_set(&table, 1, "%zu", r->used[k]);
        for (size_t c = 0; c < SHOWN; c++)
            set_interval(&table, 2 + c, shown[c], imk_drift_wished(&r->found[k], shown[c]),
                         imk_drift_wished(&r->low[k], shown[c]),
                         imk_drift_wished(&r->high[k], shown[c]));
    }
    return table;
}

/* Ratio of the linear figure to that of the runs. */
static text_table ratio_table(const drift_result *r)
{
    const drift_case *one = last_case(r);
    text_table table = text_table_make(4);
    table.right = 0xEu;
    text_table_row(&table);
    text_table_set(&table, 0, "runs / covariance");
    text_table_set(&table, 1, "CEP");
    text_table_set(&table, 2, "velocity");
    text_table_set(&table, 3, "heading");
    for (size_t k = 0; k < r->scene->row_count; k++) {
        static const imk_drift_wish shown[] = {IMK_WISH_CEP, IMK_WISH_VELOCITY, IMK_WISH_HEADING};
        const imk_drift_figures *f = &one->figures[r->scene->row[k]];
        text_table_row(&table);
        drift_set_time(&table, r->scene->time[r->scene->row[k]], drift_validity_of(f));
        for (size_t c = 0; c < 3; c++) {
            const double linear = imk_drift_wished(f, shown[c]),
                         ratio = imk_drift_wished(&r->found[k], shown[c]) / linear;
            if (linear > 0 && isfinite(ratio))
                text_table_set(&table, 1 + c, "%.3f", ratio);
            else
                text_table_set(&table, 1 + c, "-");
        }
    }
    return table;
}

/* First row where an interval of the runs leaves the linear figure out; -1: none. */
static int disagreement(const drift_result *r, imk_drift_wish *wish)
{
    static const imk_drift_wish looked_at[] = {IMK_WISH_CEP, IMK_WISH_DRMS, IMK_WISH_VELOCITY,
                                               IMK_WISH_TILT, IMK_WISH_HEADING};
    for (size_t k = 0; k < r->scene->row_count; k++) {
        const imk_drift_figures *f = &last_case(r)->figures[r->scene->row[k]];
        for (size_t c = 0; c < sizeof looked_at / sizeof looked_at[0]; c++) {
            *wish = looked_at[c];
            const double linear = imk_drift_wished(f, *wish),
                         found = imk_drift_wished(&r->found[k], *wish);
            const double low = imk_drift_wished(&r->low[k], *wish),
                         high = imk_drift_wished(&r->high[k], *wish);
            if (found * pow(low / found, widening) > (1 + tolerance) * linear ||
                found * pow(high / found, widening) < (1 - tolerance) * linear)
                return (int)k;
        }
    }
    return -1;
}

void drift_warn_of_runs(const drift_result *r)
{
    imk_drift_wish wish;
    char text[80];
    const size_t last = r->scene->row_count - 1;
    if (r->used[last] < r->run_count)
        command_warn("lost_runs",
                     "%llu of %llu runs left the Earth or found no attitude; the figures are of "
                     "the others",
                     (unsigned long long)(r->run_count - r->used[last]),
                     (unsigned long long)r->run_count);
    const int row = disagreement(r, &wish);
    if (row < 0)
        return;
    drift_time_text(r->scene->time[r->scene->row[row]], text, sizeof text);
    command_warn("disagreement",
                 "from %s on the runs differ from the covariance by more than %g %% (%s): the "
                 "runs are right, the linear theory leaves something out",
                 text, 100 * tolerance, drift_wish_name(wish));
}

void drift_print_runs(const drift_result *r)
{
    printf("\nMonte Carlo of %s: %llu runs of the whole mechanisation; in brackets 95 %% "
           "intervals.\n",
           last_case(r)->label, (unsigned long long)r->run_count);
    drift_print_table(drift_runs_table(r));
    drift_print_table(ratio_table(r));
}
