/* SPDX-License-Identifier: Apache-2.0 */
/* Drift in tables: growth, budgets, runs. */
#include "drift_show_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdio.h>

/* Smaller shares are added up in one line. */
static const double least_share = 0.002;

/* Seconds, if a fraction of a second would be lost otherwise. */
const char *imki_drift_time(double time, imk_drift_validity validity, char text[IMKI_DRIFT_TIME])
{
    char plain[IMKI_DRIFT_TIME - 4];
    if (time < 3600 && fabs(time - floor(time + 0.5)) > 1e-6)
        snprintf(plain, sizeof plain, "%.6g s", time);
    else
        imk_readable_duration(time, plain, sizeof plain);
    snprintf(text, IMKI_DRIFT_TIME, "%s%s", plain, validity == IMK_DRIFT_ROUGH ? " ~" : "");
    return text;
}

static void begin_row(const imk_drift_models *r, imk_table *table, double time,
                      imk_drift_validity validity)
{
    char text[IMKI_DRIFT_TIME];
    imk_table_row(table, "%s", imki_drift_row_label(r, time, validity, text));
}

static void add_figure(imk_table *table, const imk_drift_figures *f,
                       imk_drift_requirement requirement)
{
    char text[IMK_READABLE_SIZE];
    imk_table_add(table, "%s",
                  imk_readable_figure(requirement, imk_drift_required(f, requirement), text));
}

static imk_table *begin_table(imk_result *result, unsigned right)
{
    imk_result_gap(result);
    return imk_result_table(result, right);
}

/* ---- growth ---- */

/* Claims are in nautical miles; where they are less than a hundredth the cell is empty. */
static void add_miles(imk_table *table, double value)
{
    const imk_unit mile = imk_unit_of("nmi");
    char text[IMK_READABLE_SIZE] = "";
    if (value >= 0.01 * mile.scale)
        imk_readable_quantity(value, &mile, text);
    imk_table_add(table, "%s", text);
}

static void show_one(const imk_drift_models *r, const imk_drift_case *one, imk_result *result)
{
    const bool is_free = imk_drift_vertical(&r->settings.drift) == IMK_VERTICAL_FREE;
    const imk_drift_moments *believed = one->analysis->believed;
    imk_table *table = begin_table(result, is_free ? 0x7FEU : 0x1FEU);
    imk_table_row(table, "%s\tCEP\t\tR95\tDRMS",
                  one->missing_count > 0 ? "at least, after" : "time");
    imk_table_add(table,
                  is_free ? "height\tvelocity\tclimb\ttilt\theading" : "velocity\ttilt\theading");
    if (believed)
        imk_table_add(table, "CEP believed");
    for (size_t k = 0; k < r->times->row_count; k++) {
        const size_t t = r->times->row[k];
        const imk_drift_figures *f = &one->figures[t];
        const imk_drift_validity validity = imk_drift_validity_of(f);
        char text[IMK_READABLE_SIZE];
        begin_row(r, table, r->times->time[t], validity);
        if (validity == IMK_DRIFT_LOST) {
            imk_table_add(table, "no position");
            continue;
        }
        add_figure(table, f, IMK_REQUIRED_CEP);
        add_miles(table, f->cep);
        add_figure(table, f, IMK_REQUIRED_R95);
        add_figure(table, f, IMK_REQUIRED_DRMS);
        if (is_free)
            add_figure(table, f, IMK_REQUIRED_HEIGHT);
        add_figure(table, f, IMK_REQUIRED_VELOCITY);
        if (is_free)
            imk_table_add(table, "%s", imk_readable_figure(IMK_REQUIRED_VELOCITY, f->climb, text));
        add_figure(table, f, IMK_REQUIRED_TILT);
        add_figure(table, f, IMK_REQUIRED_HEADING);
        if (believed) {
            const imk_drift_figures own = imk_drift_figures_of(&believed[t]);
            add_figure(table, &own, IMK_REQUIRED_CEP);
        }
    }
}

/* Before and after calibration, side by side: the two cases of one model. */
static void show_both(const imk_drift_models *r, imk_result *result)
{
    static const imk_drift_requirement shown[] = {IMK_REQUIRED_CEP, IMK_REQUIRED_R95,
                                                  IMK_REQUIRED_VELOCITY, IMK_REQUIRED_HEADING};
    imk_table *table = begin_table(result, 0x1FEU);
    imk_table_row(table,
                  "%s\tCEP before\tafter\tR95 before\tafter\tvelocity before\tafter\t"
                  "heading before\tafter",
                  r->cases[0].missing_count + r->cases[1].missing_count > 0 ? "at least, after"
                                                                            : "time");
    for (size_t k = 0; k < r->times->row_count; k++) {
        const size_t t = r->times->row[k];
        const imk_drift_figures *f[2] = {&r->cases[0].figures[t], &r->cases[1].figures[t]};
        const imk_drift_validity v[2] = {imk_drift_validity_of(f[0]), imk_drift_validity_of(f[1])};
        begin_row(r, table, r->times->time[t], v[0] > v[1] ? v[0] : v[1]);
        for (size_t cell = 0; cell < 2 * sizeof shown / sizeof shown[0]; cell++)
            if (v[cell % 2] != IMK_DRIFT_LOST)
                add_figure(table, f[cell % 2], shown[cell / 2]);
            else
                imk_table_add(table, "%s", cell < 2 ? "no position" : "-");
    }
}

static void show_several(const imk_drift_models *r, imk_result *result)
{
    imk_table *table = begin_table(result, (1U << (1 + r->case_count)) - 2);
    imk_table_row(table, "CEP after");
    for (size_t c = 0; c < r->case_count; c++)
        imk_table_add(table, "%.30s%s", r->cases[c].label,
                      r->cases[c].missing_count > 0 ? ", at least" : "");
    for (size_t k = 0; k < r->times->row_count; k++) {
        const size_t t = r->times->row[k];
        begin_row(r, table, r->times->time[t], IMK_DRIFT_LINEAR);
        for (size_t c = 0; c < r->case_count; c++) {
            const imk_drift_figures *f = &r->cases[c].figures[t];
            const imk_drift_validity validity = imk_drift_validity_of(f);
            char length[IMK_READABLE_SIZE];
            imk_table_add(table, "%s%s",
                          validity == IMK_DRIFT_LOST
                              ? "no position"
                              : imk_readable_figure(IMK_REQUIRED_CEP, f->cep, length),
                          validity == IMK_DRIFT_ROUGH ? " ~" : "");
        }
    }
}

void imki_drift_show_growth(const imk_drift_models *r, imk_result *result)
{
    if (r->model_count > 1)
        show_several(r, result);
    else if (r->case_count > 1)
        show_both(r, result);
    else
        show_one(r, &r->cases[0], result);
}

/* ---- budget ---- */

static void show_shares(const imk_drift_models *r, const imk_drift_case *one, imk_result *result)
{
    const imk_drift_requirement requirement = imki_drift_looked_at(r);
    const imk_drift_requirement other =
        requirement == IMK_REQUIRED_HEADING ? IMK_REQUIRED_CEP : IMK_REQUIRED_HEADING;
    double rest = 0;
    size_t rest_count = 0;
    imk_table *table = begin_table(result, 0xEU);
    imk_table_row(table, "term\tshare\t%s alone\t%s alone", imk_drift_requirement_name(requirement),
                  imk_drift_requirement_name(other));
    for (size_t i = 0; i < one->share_count; i++) {
        const imk_drift_share *s = &one->share[i];
        if (s->share < least_share) {
            rest += s->share;
            rest_count += s->share > 0;
            continue;
        }
        imk_table_row(table, "%s\t%.1f %%", one->analysis->source[s->source].text, 100 * s->share);
        add_figure(table, &s->random, requirement);
        add_figure(table, &s->random, other);
    }
    if (rest_count > 0)
        imk_table_row(table, "%zu other%s", rest_count, rest_count > 1 ? "s" : "");
    if (rest_count > 0 && rest < 0.0005)
        imk_table_add(table, "< 0.1 %%");
    else if (rest_count > 0)
        imk_table_add(table, "%.1f %%", 100 * rest);
    if (fabs(one->correlation_share) >= 0.0005)
        imk_table_row(table, "correlation of calibrated values\t%.1f %%",
                      100 * one->correlation_share);
}

/* The moments of a source, or of all sources together (index after the last), if its shift is at
 * least a thousandth of the scatter; otherwise NULL. */
static const imk_drift_moments *shift_of(const imk_drift_case *one, size_t source)
{
    const double least = 1e-3;
    const imk_drift_analysis *a = one->analysis;
    const imk_drift_figures *whole = &one->figures[one->time];
    const imk_drift_moments *m = source == a->source_count
                                     ? &a->total[one->time]
                                     : &a->contribution[source * a->time_count + one->time];
    return hypot(m->mean[0], m->mean[1]) > least * whole->drms ||
                   fabs(m->mean[8]) > least * whole->heading
               ? m
               : NULL;
}

static void show_shifts(const imk_drift_case *one, imk_result *result)
{
    const imk_drift_analysis *a = one->analysis;
    imk_table *table = begin_table(result, 0xEU);
    imk_table_row(table, "known value\tnorth\teast\theading");
    for (size_t k = 0; k <= a->source_count; k++) {
        const imk_drift_moments *m = shift_of(one, k);
        const bool total = k == a->source_count;
        char north[IMK_READABLE_SIZE], east[IMK_READABLE_SIZE], heading[IMK_READABLE_SIZE];
        if (!m || (total && imk_table_rows(table) < 3))
            continue;
        imk_table_row(table, "%s\t%s\t%s\t%s", total ? "together" : a->source[k].text,
                      imk_readable_figure(IMK_REQUIRED_CEP, m->mean[0], north),
                      imk_readable_figure(IMK_REQUIRED_CEP, m->mean[1], east),
                      imk_readable_figure(IMK_REQUIRED_HEADING, m->mean[8], heading));
    }
}

void imki_drift_show_budget(const imk_drift_models *r, const imk_drift_case *one,
                            imk_result *result)
{
    const bool shares = one->share_count > 0 && one->share[0].share >= least_share;
    bool shifts = false;
    for (size_t k = 0; k < one->analysis->source_count; k++)
        shifts = shifts || shift_of(one, k);
    const imk_audience audience = r->model_count > 1 ? IMK_FOR_PAGE : IMK_FOR_BOTH;
    char title[240], time[IMKI_DRIFT_TIME];
    imki_drift_moment(r, r->times->time[one->time], time);
    snprintf(title, sizeof title, "Contributions after %s: %s", time, one->label);
    imk_result_for(result, IMK_FOR_PAGE);
    if (shares)
        imk_result_heading(result, title);
    imk_result_for(result, audience & IMK_FOR_TERMINAL);
    if (!shares && !shifts)
        imk_result_line(result, "\nNo term of %s causes a position error.", one->label);
    else
        imk_result_line(result, "\nContributions after %s%s", time,
                        r->case_count == 1          ? ""
                        : one->settings.compensated ? ", after calibration"
                                                    : ", before calibration");
    imk_result_for(result, audience);
    if (shares)
        show_shares(r, one, result);
    if (shifts)
        show_shifts(one, result);
}

/* ---- runs ---- */

/* "12.3 m (11.9 to 12.8)" */
static void add_interval(imk_table *table, imk_drift_requirement requirement, double value,
                         double low, double high)
{
    char a[IMK_READABLE_SIZE], b[IMK_READABLE_SIZE], c[IMK_READABLE_SIZE];
    const imk_unit unit = imk_readable_figure_unit(requirement, value);
    imk_table_add(table, "%s (%s to %s)", imk_readable_quantity(value, &unit, a),
                  imk_readable_number(low / unit.scale, b),
                  isinf(high) ? "?" : imk_readable_number(high / unit.scale, c));
}

void imki_drift_nees_due(const imk_drift_models *r, size_t row, double *low, double *high)
{
    const double n = (double)r->used[row], degrees = n * r->nees_degrees;
    *low = n > 0 ? imk_chi_square_quantile(0.025, degrees) / n : (double)NAN;
    *high = n > 0 ? imk_chi_square_quantile(0.975, degrees) / n : (double)NAN;
}

void imki_drift_show_runs(const imk_drift_models *r, imk_result *result)
{
    static const imk_drift_requirement shown[] = {IMK_REQUIRED_CEP, IMK_REQUIRED_R95,
                                                  IMK_REQUIRED_VELOCITY, IMK_REQUIRED_HEADING};
    imk_table *table = begin_table(result, 0);
    imk_table_row(table, "time\truns\tCEP\tR95\tvelocity\theading");
    if (r->nees_degrees > 0)
        imk_table_add(table, "NEES\tdue");
    for (size_t k = 0; k < r->times->row_count; k++) {
        begin_row(r, table, imki_drift_row_time(r, k), IMK_DRIFT_LINEAR);
        imk_table_add(table, "%zu", r->used[k]);
        for (size_t c = 0; c < sizeof shown / sizeof shown[0]; c++)
            add_interval(table, shown[c], imk_drift_required(&r->found[k], shown[c]),
                         imk_drift_required(&r->low[k], shown[c]),
                         imk_drift_required(&r->high[k], shown[c]));
        if (r->nees_degrees > 0) {
            double low, high;
            imki_drift_nees_due(r, k, &low, &high);
            imk_table_add(table, "%.3g\t%.3g to %.3g", r->nees[k], low, high);
        }
    }
}

void imki_drift_show_ratios(const imk_drift_models *r, imk_result *result)
{
    static const imk_drift_requirement shown[] = {IMK_REQUIRED_CEP, IMK_REQUIRED_VELOCITY,
                                                  IMK_REQUIRED_HEADING};
    imk_table *table = begin_table(result, 0xEU);
    imk_table_row(table, "runs / covariance\tCEP\tvelocity\theading");
    for (size_t k = 0; k < r->times->row_count; k++) {
        const size_t t = r->times->row[k];
        const imk_drift_figures *f = &imki_drift_last_case(r)->figures[t];
        begin_row(r, table, r->times->time[t], imk_drift_validity_of(f));
        for (size_t c = 0; c < 3; c++) {
            const double linear = imk_drift_required(f, shown[c]),
                         ratio = imk_drift_required(&r->found[k], shown[c]) / linear;
            if (linear > 0 && isfinite(ratio))
                imk_table_add(table, "%.3f", ratio);
            else
                imk_table_add(table, "-");
        }
    }
}
