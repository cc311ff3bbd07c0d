/* SPDX-License-Identifier: Apache-2.0 */
/* The noise of a filter: the numbers, how consistent they are, and what makes the errors. */
#include "tune_show_internal.h"

#include "report/show/drift/unstated_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const imki_tune_unit imki_tune_units[4] = {{"gyro N", "deg/sqrt(h)"},
                                           {"gyro K", "deg/h/sqrt(h)"},
                                           {"accel N", "m/s/sqrt(h)"},
                                           {"accel K", "ug/sqrt(h)"}};

static const char *const sensors[2] = {"gyro", "accel"};
/* N and K as the model file calls them. */
static const struct {
    const char *key, *unused, *si;
} terms[2][2] = {
    {{"angle_random_walk", "angle_random_walk_unused", "rad/sqrt(s)"},
     {"rate_random_walk", "rate_random_walk_unused", "rad/s/sqrt(s)"}},
    {{"velocity_random_walk", "velocity_random_walk_unused", "m/s/sqrt(s)"},
     {"acceleration_random_walk", "acceleration_random_walk_unused", "m/s^2/sqrt(s)"}}};
static const char *const bias_unit[2] = {"rad/s", "m/s^2"};
static const char *const keys[IMK_FILTER_ANSWERS] = {
    "data_sheet", "data_sheet_x10", "fit", "safe", "fit_scale_factors", "safe_scale_factors"};

/* ---- judgement ---- */

/* Smallest and largest NEES of an answer. */
static void range_of(const imk_tune_model *r, int kind, double *low, double *high)
{
    *low = (double)INFINITY;
    *high = 0.0;
    for (size_t t = 0; t < r->tuning->time_count; t++) {
        *low = fmin(*low, r->tuning->answer[kind].consistency[t].nees);
        *high = fmax(*high, r->tuning->answer[kind].consistency[t].nees);
    }
}

/* Does a constant noise describe the errors, and what is it? */
static void judge(const imk_tune_model *r, imk_result *result)
{
    const imk_filter_tuning *t = r->tuning;
    imki_reasons reasons = {.result = result};
    double low, high;
    range_of(r, IMK_FILTER_FIT, &low, &high);
    if (t->inconstant)
        imki_reason(&reasons,
                    "no constant noise describes these errors, of which %s is the largest: the fit "
                    "has a NEES of %.3g to %.3g",
                    t->source[t->worst_source].text, low, high);
    else
        imki_reason(
            &reasons,
            "with the noise \"fit\" the filter is consistent at all times, its NEES %.3g to "
            "%.3g",
            low, high);
    range_of(r, IMK_FILTER_STATED, &low, &high);
    imki_reason(&reasons, "with that of the data sheet it is %.3g to %.3g", low, high);
    if (t->inconstant)
        imki_reason(&reasons, "\"safe\" is nowhere overconfident");
    imki_judge(&reasons, t->inconstant ? IMK_USABLE_WITH_CARE : IMK_USABLE, "");
}

/* ---- data ---- */

static void show_three(const char *key, const double value[3], const char *unit, imk_result *result)
{
    imk_result_object(result, key);
    imk_result_numbers(result, "value", 3, value);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

static void show_time(const imk_tune_model *r, int kind, size_t t, imk_result *result)
{
    const imk_filter_tuning *tuning = r->tuning;
    const imk_filter_consistency *c = &tuning->answer[kind].consistency[t];
    imk_result_object(result, NULL);
    imk_result_quantity(result, "time", tuning->time[t], "s");
    imk_result_number(result, "nees", c->nees);
    imk_result_numbers(result, "attitude_velocity_position", 3, c->block);
    imk_result_numbers(result, "axes", IMK_TUNING_STATES, c->axis);
    imk_result_number(result, "largest_eigenvalue", c->largest);
    imk_result_number(result, "smallest_eigenvalue", c->smallest);
    imk_result_number(result, "beyond_95", c->beyond);
    if (r->found) {
        const imk_tune_found *found = &r->found[(size_t)kind * tuning->time_count + t];
        imk_result_object(result, "runs");
        imk_result_number(result, "nees", found->nees);
        imk_result_number(result, "lower", found->lower);
        imk_result_number(result, "upper", found->upper);
        imk_result_end(result);
    }
    imk_result_object(result, "shares");
    for (size_t s = 0; s < tuning->source_count; s++) {
        const double share = tuning->answer[kind].share[s * tuning->time_count + t];
        if (fabs(share) >= 1e-4)
            imk_result_number(result, imk_result_key(result, "%s", tuning->source[s].name), share);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_answer(const imk_tune_model *r, int kind, imk_result *result)
{
    const imk_filter_answer *a = &r->tuning->answer[kind];
    if (!imki_begin_object(result, keys[kind], a->found))
        return;
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_result_object(result, sensors[sensor]);
        show_three(terms[sensor][0].key, a->parameters.white[sensor], terms[sensor][0].si, result);
        show_three(terms[sensor][1].key, a->parameters.walk[sensor], terms[sensor][1].si, result);
        if (a->parameters.correlation_time > 0.0)
            imk_result_quantity(result, "correlation_time", a->parameters.correlation_time, "s");
        else
            imk_result_null(result, "correlation_time");
        imk_result_quantity(result, "bias_sigma", a->parameters.bias_sigma[sensor],
                            bias_unit[sensor]);
        show_three("scale_factor_sigma", a->parameters.scale_factor[sensor], "1", result);
        for (int term = 0; term < 2; term++)
            imk_result_flag(result, terms[sensor][term].unused, a->unused[sensor][term]);
        imk_result_end(result);
    }
    imk_result_number(result, "mean_nees", a->mean_nees);
    imk_result_array(result, "times");
    for (size_t t = 0; t < r->tuning->time_count; t++)
        show_time(r, kind, t, result);
    imk_result_end(result);
    imk_result_end(result);
}

static void show_data(const imk_tune_model *r, const imk_unstated *assumed, imk_result *result)
{
    const imk_filter_tuning *tuning = r->tuning;
    const imk_filter_tuning_settings *s = &r->settings.tuning;
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", r->name);
    imki_show_texts(result, "motions", s->motion_count, r->settings.motion);
    imk_result_quantity(result, "rate", s->rate, "Hz");
    imk_result_count(result, "windows", (long long)tuning->window_count);
    imk_result_quantity(result, "bias_time", s->bias_time, "s");
    imk_result_quantity(result, "gyro_bias_sigma", tuning->bias_sigma[0], bias_unit[0]);
    imk_result_quantity(result, "accel_bias_sigma", tuning->bias_sigma[1], bias_unit[1]);
    imk_result_flag(result, "learned", s->learned);
    imk_result_flag(result, "compensated", s->compensated);
    imk_result_count(result, "runs", (long long)r->settings.run_count);
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(r, result);
    imk_result_flag(result, "inconstant", tuning->inconstant);
    imk_result_text(result, "largest_error", tuning->source[tuning->worst_source].name);
    imki_show_texts(result, "omitted", tuning->omitted_count, tuning->omitted);
    imk_result_object(result, "answers");
    for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++)
        show_answer(r, kind, result);
    imk_result_end(result);
    imki_show_assumed_data(assumed, result);
    imk_result_end(result);
}

/* ---- text ---- */

static double rms(const double v[3])
{
    return sqrt((v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 3.0);
}

/* N and K of a triad, rms of the axes, in the unit shown. */
static double number_of(const imk_filter_answer *a, int column)
{
    const double *v =
        column % 2 == 0 ? a->parameters.white[column / 2] : a->parameters.walk[column / 2];
    return rms(v) / imk_unit_of(imki_tune_units[column].unit).scale;
}

static void add_number(const imk_tune_model *r, int kind, int column, imk_table *table)
{
    const imk_filter_answer *a = &r->tuning->answer[kind];
    const double value = number_of(a, column);
    const double stated = number_of(&r->tuning->answer[IMK_FILTER_STATED], column);
    if (stated > 0.0)
        imk_table_add(table, "\t%.3g\tx%.3g", value, value / stated);
    else
        imk_table_add(table, "\t%.3g\t-", value);
}

/* What a filter is to be given, and by how much that is more than what is stated. */
static void show_numbers(const imk_tune_model *r, imk_result *result)
{
    imk_result_gap(result);
    imk_result_heading(result, "Noise of the filter");
    imk_table *table = imk_result_table(result, ~1u);
    imk_table_row(table, "noise");
    for (int column = 0; column < 4; column++)
        imk_table_add(table, "\t%s [%s]\t", imki_tune_units[column].name,
                      imki_tune_units[column].unit);
    imk_table_add(table, "\tmean NEES");
    for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++) {
        const imk_filter_answer *a = &r->tuning->answer[kind];
        if (!a->found)
            continue;
        imk_table_row(table, "%s", imk_filter_answer_name((imk_filter_answer_kind)kind));
        for (int column = 0; column < 4; column++)
            add_number(r, kind, column, table);
        imk_table_add(table, "\t%.3g", a->mean_nees);
    }
    const double time = r->settings.tuning.correlation_time;
    if (time > 0.0)
        imk_result_line(result,
                        "K: driving noise of biases that are Gauss-Markov processes of %g s; their "
                        "sigma is K sqrt(%g s)",
                        time, 0.5 * time);
    const imk_filter_answer *scaled = &r->tuning->answer[IMK_FILTER_FIT_SCALED];
    if (scaled->found)
        imk_result_line(result,
                        "scale factors as states: %.3g and %.3g ppm of gyros and "
                        "accelerometers at the start (1 sigma)",
                        1e6 * rms(scaled->parameters.scale_factor[0]),
                        1e6 * rms(scaled->parameters.scale_factor[1]));
}

/* The runs are shown of two answers; the data have all. */
static bool shows_runs(const imk_tune_model *r, int kind)
{
    return r->found && (kind == IMK_FILTER_FIT || kind == IMK_FILTER_SAFE);
}

static void add_found(const imk_tune_model *r, int kind, size_t t, imk_table *table)
{
    if (!shows_runs(r, kind))
        return;
    const imk_tune_found *found = &r->found[(size_t)kind * r->tuning->time_count + t];
    imk_table_add(table, "\t%.3g … %.3g", found->lower, found->upper);
}

/* NEES of all answers against time. */
static void show_nees(const imk_tune_model *r, imk_result *result)
{
    imk_result_gap(result);
    imk_result_heading(result,
                       "NEES over its degrees of freedom (1: consistent; more: overconfident)");
    imk_table *table = imk_result_table(result, ~0u);
    imk_table_row(table, "time [s]");
    for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++) {
        if (!r->tuning->answer[kind].found)
            continue;
        imk_table_add(table, "\t%s", imk_filter_answer_name((imk_filter_answer_kind)kind));
        if (shows_runs(r, kind))
            imk_table_add(table, "\truns, 99 %%");
    }
    for (size_t t = 0; t < r->tuning->time_count; t++) {
        imk_table_row(table, "%.3g", r->tuning->time[t]);
        for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++)
            if (r->tuning->answer[kind].found) {
                imk_table_add(table, "\t%.3g", r->tuning->answer[kind].consistency[t].nees);
                add_found(r, kind, t, table);
            }
    }
}

/* One answer in detail: blocks, axes, directions, errors that the filter does not expect. */
static void show_detail(const imk_tune_model *r, int kind, imk_result *result)
{
    const imk_filter_answer *a = &r->tuning->answer[kind];
    if (!a->found)
        return;
    char title[100];
    snprintf(title, sizeof title, "The answer \"%s\": variance over that of the filter",
             imk_filter_answer_name((imk_filter_answer_kind)kind));
    imk_result_gap(result);
    imk_result_heading(result, title);
    imk_table *table = imk_result_table(result, ~0u);
    imk_table_row(table, "time [s]\tattitude x\ty\tz\tvelocity x\ty\tz\tposition x\ty\tz\t"
                         "eigenvalues\tbeyond 95 %%");
    for (size_t t = 0; t < r->tuning->time_count; t++) {
        const imk_filter_consistency *c = &a->consistency[t];
        imk_table_row(table, "%.3g", r->tuning->time[t]);
        for (int i = 0; i < IMK_TUNING_STATES; i++)
            imk_table_add(table, "\t%.2g", c->axis[i]);
        imk_table_add(table, "\t%.2g … %.3g\t%.1f %%", c->smallest, c->largest, 100.0 * c->beyond);
    }
}

/* The largest shares at the first time, one in the middle and the last. */
static void show_shares(const imk_tune_model *r, imk_result *result)
{
    enum { ROWS = 10 };
    const imk_filter_tuning *tuning = r->tuning;
    const imk_filter_answer *a = &tuning->answer[IMK_FILTER_FIT];
    const size_t times = tuning->time_count;
    const size_t at[3] = {0, times / 2, times - 1};
    bool shown[IMK_DRIFT_SOURCES_MAX] = {false};
    imk_result_gap(result);
    imk_result_heading(result, "What makes the errors: shares of the NEES of the fit");
    imk_table *table = imk_result_table(result, ~1u);
    imk_table_row(table, "error\t%.3g s\t%.3g s\t%.3g s", tuning->time[at[0]], tuning->time[at[1]],
                  tuning->time[at[2]]);
    for (int row = 0; row < ROWS; row++) {
        double most = 0.005;
        size_t chosen = tuning->source_count;
        for (size_t s = 0; s < tuning->source_count; s++) {
            double share = 0.0;
            for (int k = 0; k < 3; k++)
                share = fmax(share, fabs(a->share[s * times + at[k]]));
            if (share > most && !shown[s]) {
                most = share;
                chosen = s;
            }
        }
        if (chosen == tuning->source_count)
            break;
        shown[chosen] = true;
        imk_table_row(table, "%s", tuning->source[chosen].text);
        for (int k = 0; k < 3; k++)
            imk_table_add(table, "\t%.1f %%", 100.0 * a->share[chosen * times + at[k]]);
    }
}

void imk_tune_verdict(const imk_tune_model *r, char *text, size_t size)
{
    const imk_filter_tuning *tuning = r->tuning;
    double low, high;
    *text = '\0';
    if (!tuning->inconstant)
        return;
    range_of(r, IMK_FILTER_FIT, &low, &high);
    int used =
        snprintf(text, size,
                 "no constant noise describes these errors: the NEES of the fit is %.3g to "
                 "%.2g. The largest of them where it is highest is %s: calibrate or estimate "
                 "it, or take \"safe\"",
                 low, high, tuning->source[tuning->worst_source].text);
    if (!tuning->answer[IMK_FILTER_FIT_SCALED].found || used < 0 || (size_t)used >= size)
        return;
    range_of(r, IMK_FILTER_FIT_SCALED, &low, &high);
    snprintf(text + used, size - (size_t)used,
             ". With scale factors among the states of the filter it is %.3g to %.3g", low, high);
}

/* What was assumed, term by term. */
static void show_assumed(const imk_unstated *assumed, imk_result *result)
{
    for (size_t i = 0; assumed && i < assumed->count; i++) {
        const imk_unstated_term *term = &assumed->term[i];
        imk_result_line(result, "assumed: %s %.3g %s (%s)", term->text,
                        term->typical / imk_unit_of(term->unit).scale, term->unit,
                        imk_grade_table(term->grade) ? imk_grade_table(term->grade)->name : "-");
    }
}

void imk_show_tune(const imk_tune_model *r, const imk_unstated *assumed, imk_result *result)
{
    const imk_filter_tuning *tuning = r->tuning;
    show_assumed(assumed, result);
    show_data(r, assumed, result);
    imk_result_title(result, "Noise of a filter", "%s on %zu motion%s", r->name,
                     r->settings.tuning.motion_count,
                     r->settings.tuning.motion_count > 1 ? "s" : "");
    imk_result_line(result, "%s: %zu windows, %zu times of %.3g s to %.3g s at %g Hz", r->name,
                    tuning->window_count, tuning->time_count, tuning->time[0],
                    tuning->time[tuning->time_count - 1], r->settings.tuning.rate);
    imk_result_line(result, "  the bias is known to %.3g deg/h and %.3g ug (1 sigma), from %g s",
                    tuning->bias_sigma[0] / imk_unit_of("deg/h").scale,
                    tuning->bias_sigma[1] / imk_unit_of("ug").scale, r->settings.tuning.bias_time);
    if (r->settings.tuning.learned)
        imk_result_line(result, "  it is learned: the mean of all slow errors of the readings");
    if (tuning->short_count > 0)
        imk_result_line(result, "  left out: %zu time%s below two samples", tuning->short_count,
                        tuning->short_count > 1 ? "s" : "");
    if (tuning->long_count > 0)
        imk_result_line(result, "  left out: %zu time%s longer than a motion allows",
                        tuning->long_count, tuning->long_count > 1 ? "s" : "");
    imki_tune_figure(r, result);
    show_numbers(r, result);
    show_nees(r, result);
    show_detail(r, IMK_FILTER_FIT, result);
    show_detail(r, IMK_FILTER_SAFE, result);
    show_shares(r, result);
}
