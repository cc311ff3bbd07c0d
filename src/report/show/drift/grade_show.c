/* SPDX-License-Identifier: Apache-2.0 */
/* A grade as a result: classes, errors of position and what limits them, in figures, messages and
 * tables. */
#include "grade_show_internal.h"
#include "unstated_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char assumption[] =
    "Computed by covariance from all terms of the model: at rest at 45 deg N, level, 100 Hz, the "
    "height held by other means, position and velocity perfect at the start. CEP is the radius of "
    "the circle that holds half of all outcomes.";

/* With a larger error of the heading there is no heading. */
static const double no_north = 1; /* [rad] */

static const char *grade_name(imk_grade grade)
{
    const imk_grade_row *row = imk_grade_table(grade);
    return row ? row->name : "below every class";
}

/* Nautical miles, as in the claims, from 0.1 nmi on; metres below. */
static const char *grade_length(double metres, char text[IMK_READABLE_SIZE])
{
    const imk_unit mile = imk_unit_of("nmi");
    if (isfinite(metres) && metres >= 0.1 * mile.scale)
        return imk_readable_quantity(metres, &mile, text);
    return imk_readable_figure(IMK_REQUIRED_CEP, metres, text);
}

static const char *name_or(bool known, imk_grade grade, const char *otherwise)
{
    return known ? grade_name(grade) : otherwise;
}

static const char *at_best(bool holds)
{
    return holds ? "at best " : "";
}

/* A class, unless it is only the best that is possible. */
static void show_class(const char *key, const char *best_key, bool known, bool is_best,
                       imk_grade grade, imk_result *result)
{
    const char *name = name_or(known, grade, NULL);
    imk_result_text(result, key, is_best ? NULL : name);
    imk_result_text(result, best_key, is_best ? name : NULL);
}

/* ---- data ---- */

static void show_way(const char *key, const imk_grade_way *p, bool is_best, imk_result *result)
{
    static const char *const validity[] = {"linear", "rough", "no position"};
    imk_result_object(result, key);
    show_class("class", "class_at_best", p->grade != IMK_GRADE_NONE, is_best, p->grade, result);
    imk_result_array(result, "times");
    for (size_t t = 0; t < IMK_GRADE_TIMES; t++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "time", imk_grade_time(t), "s");
        imk_result_quantity(result, "cep", p->cep[t], "m");
        imk_result_quantity(result, "tilt", p->figures[t].tilt, "rad");
        imk_result_quantity(result, "heading", p->figures[t].heading, "rad");
        imk_result_text(result, "validity", validity[p->validity[t]]);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void show_shares(const char *key, size_t count, const imk_grade_share *share,
                        const char *value, imk_result *result)
{
    imk_result_array(result, key);
    for (size_t i = 0; i < count; i++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "term", share[i].text);
        imk_result_number(result, value, share[i].value);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_computed(const imk_graded *one, imk_result *result)
{
    static const char *const names[IMK_GRADE_WAYS] = {"given", "self", "given_compensated",
                                                      "self_compensated"};
    if (!imki_begin_object(result, "position", !one->no_position))
        return;
    for (int way = 0; way < IMK_GRADE_WAYS; way++)
        show_way(names[way], &one->way[way], one->missing_count > 0, result);
    imki_show_missing_data(one->missing_count, one->missing, result);
    show_shares("shares", one->share_count, one->share, "share", result);
    if (imki_begin_object(result, "next", one->next != IMK_GRADE_NONE)) {
        imk_result_text(result, "class", grade_name(one->next));
        imk_result_number(result, "all", one->next_all);
        show_shares("terms", one->need_count, one->need, "times_better", result);
        imk_result_end(result);
    }
    imk_result_text(result, "assumption", assumption);
    imk_result_end(result);
}

static void show_data(const imk_graded *one, const char *name, const imk_unstated *assumed,
                      imk_result *result)
{
    const imk_grade_result *t = &one->table;
    const bool known = t->limiting[0];
    const imk_grade_row *row = imk_grade_table(t->overall);
    imk_result_object(result, NULL);
    imk_result_text(result, "model", name);
    show_class("overall", "overall_at_best", known, t->at_best, t->overall, result);
    show_class("gyro", "gyro_at_best", !isnan(t->gyro_bias), t->gyro_at_best, t->gyro, result);
    show_class("accel", "accel_at_best", !isnan(t->accel_bias), t->accel_at_best, t->accel, result);
    imk_result_quantity(result, "gyro_bias", t->gyro_bias, "rad/s");
    imk_result_quantity(result, "accel_bias", t->accel_bias, "m/s^2");
    imk_result_quantity(result, "gyro_scale_factor", one->gyro_scale, "1");
    imk_result_quantity(result, "accel_scale_factor", one->accel_scale, "1");
    imk_result_text(result, "limiting", t->limiting);
    imk_result_text(result, "position_performance",
                    known && row && !t->at_best ? row->position_performance : NULL);
    show_computed(one, result);
    imk_result_text(result, "no_position", one->no_position);
    imki_show_assumed_data(assumed, result);
    imki_show_place_data(one, result);
    imk_show_build(imk_device_build_find(name), result);
    imk_result_end(result);
}

/* ---- messages ---- */

static void show_bias(const imk_graded *one, bool gyro, imk_result *result)
{
    const char *unit = gyro ? "deg/h" : "ug", *sensor = gyro ? "Gyro" : "Accelerometer";
    const double scale = imk_unit_of(unit).scale;
    const double bias = gyro ? one->table.gyro_bias : one->table.accel_bias;
    const imk_grade grade = gyro ? one->table.gyro : one->table.accel;
    const bool is_best = gyro ? one->table.gyro_at_best : one->table.accel_at_best;
    if (!(gyro ? one->model->gyro : one->model->accel).present)
        return;
    if (isnan(bias)) {
        imk_result_line(result,
                        "%s: the model states neither repeatability nor instability of the bias",
                        sensor);
        return;
    }
    const imk_grade_row *row = imk_grade_table(grade);
    const imk_grade_row *better =
        grade > IMK_GRADE_STRATEGIC ? imk_grade_table((imk_grade)((int)grade - 1)) : NULL;
    char allows[80] = "", needs[80] = "", number[IMK_READABLE_SIZE];
    if (row)
        snprintf(allows, sizeof allows, ", the class allows %.6g",
                 (gyro ? row->gyro_bias_limit : row->accel_bias_limit) / scale);
    if (better)
        snprintf(needs, sizeof needs, "; the next better class, %s, needs %.6g", better->name,
                 (gyro ? better->gyro_bias_limit : better->accel_bias_limit) / scale);
    imk_result_line(result, "%s: %s%s; remaining bias %s%s %s%s%s", sensor, at_best(is_best),
                    grade_name(grade), is_best ? "at least " : "",
                    imk_readable_number(bias / scale, number), unit, allows, needs);
}

/* A line on the terminal, a finding of the page. */
static void show_position(const imk_graded *one, imk_result *result)
{
    const imk_grade_way *p = &one->way[IMK_GRADE_GIVEN];
    const bool is_best = one->missing_count > 0;
    const char *least = is_best ? "at least " : "";
    char text[600], hour[IMK_READABLE_SIZE], day[IMK_READABLE_SIZE];
    if (one->no_position)
        snprintf(text, sizeof text, "Position: not computed; %s%s", one->no_position,
                 one->model->gyro.present && one->model->accel.present
                     ? ""
                     : " (imukit join makes a unit of gyros and accelerometers)");
    else if (p->validity[IMK_GRADE_HOUR] == IMK_DRIFT_LOST)
        snprintf(text, sizeof text,
                 "Position: below every class that claims one; no position any more after 1 h");
    else if (p->validity[IMK_GRADE_DAY] == IMK_DRIFT_LOST)
        snprintf(text, sizeof text,
                 "Position: %s%s; CEP %s%s after 1 h, no position any more after 24 h",
                 at_best(is_best), grade_name(p->grade), least,
                 grade_length(p->cep[IMK_GRADE_HOUR], hour));
    else
        snprintf(text, sizeof text, "Position: %s%s; CEP %s%s after 1 h, %s after 24 h",
                 at_best(is_best), grade_name(p->grade), least,
                 grade_length(p->cep[IMK_GRADE_HOUR], hour),
                 grade_length(p->cep[IMK_GRADE_DAY], day));
    imk_result_finding(result, !one->no_position ? 1 : 2, text);
}

static void show_limits(const imk_graded *one, imk_result *result)
{
    imki_text text = {.bytes = NULL};
    for (size_t i = 0; i < one->share_count; i++)
        imki_text_add(&text, "%s%s %.0f %%",
                      i == 0 ? "Contributions after 1 h, by variance: " : ", ", one->share[i].text,
                      100 * one->share[i].value);
    if (one->shifted)
        imki_text_add(&text,
                      "%sMost of the error is not scatter but a shift by known values; "
                      "compensation takes it out",
                      text.size > 0 ? ". " : "");
    imki_show_text(&text, result);
}

static void show_needs(const imk_graded *one, imk_result *result)
{
    const imk_grade_row *row = imk_grade_table(one->next);
    imki_text text = {.bytes = NULL};
    if (!row || one->no_position || !(one->next_all > 0))
        return;
    imki_text_add(&text, "For %s (%s) every term would have to be %.3g times smaller", row->name,
                  isinf(row->position_limit) ? "a position at all after 1 h"
                                             : row->position_performance,
                  1 / one->next_all);
    for (size_t i = 0; i < one->need_count; i++)
        imki_text_add(&text, "%s%s %.3g times", i == 0 ? "; or only " : ", ", one->need[i].text,
                      one->need[i].value);
    if (one->need_more > 0)
        imki_text_add(&text, ", and %zu more", one->need_more);
    imki_show_text(&text, result);
}

/* ---- tables ---- */

/* The computed error for the time of a claim. */
static void add_answer(imk_table *table, const imk_graded *one, const imk_grade_row *row)
{
    char length[IMK_READABLE_SIZE];
    const size_t time =
        row->position_time > imk_grade_time(IMK_GRADE_HOUR) ? IMK_GRADE_DAY : IMK_GRADE_HOUR;
    const double cep = one->way[IMK_GRADE_GIVEN].cep[time];
    if (one->no_position || isnan(row->position_time))
        imk_table_add(table, "-");
    else if (isnan(cep))
        imk_table_add(table, "no position");
    else
        imk_table_add(
            table, "%s%s%s", one->missing_count > 0 ? "at least " : "", grade_length(cep, length),
            one->missing_count == 0 && cep <= row->position_limit * (1 + 1e-9) ? ", met" : "");
}

static const char *met(imk_grade grade, double bias, bool is_best, int row)
{
    return isnan(bias) || is_best || (int)grade > row ? "" : ", met";
}

/* Claims beside figures. */
static void show_classes(const imk_graded *one, imk_result *result)
{
    const imk_grade_result *t = &one->table;
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "\tclass\tclaimed\tcomputed\tgyro [deg/h]\tgyros are\taccel [ug]\t"
                         "accelerometers are");
    for (int g = 0; g < IMK_GRADE_NONE; g++) {
        const imk_grade_row *row = imk_grade_table((imk_grade)g);
        imk_table_row(table, "%s\t%s\t%s",
                      t->limiting[0] && (int)t->overall == g ? (t->at_best ? "at best" : "->") : "",
                      row->name, row->position_performance);
        add_answer(table, one, row);
        imk_table_add(table, "%.4g%s\t%s\t%.6g%s\t%s",
                      row->gyro_bias_limit / imk_unit_of("deg/h").scale,
                      met(t->gyro, t->gyro_bias, t->gyro_at_best, g), row->gyro_technology,
                      row->accel_bias_limit / imk_unit_of("ug").scale,
                      met(t->accel, t->accel_bias, t->accel_at_best, g), row->accel_technology);
    }
}

static bool finds_north(const imk_grade_way *p, int way)
{
    const bool self = way == IMK_GRADE_SELF || way == IMK_GRADE_SELF_COMPENSATED;
    return !(self && p->figures[IMK_GRADE_MINUTE].heading > no_north);
}

static void add_cep(imk_table *table, const imk_grade_way *p, size_t t, const char *rough)
{
    char text[IMK_READABLE_SIZE];
    imk_table_add(table, "%s%s",
                  p->validity[t] == IMK_DRIFT_LOST ? "no position" : grade_length(p->cep[t], text),
                  p->validity[t] == IMK_DRIFT_ROUGH ? rough : "");
}

static void show_ways(const imk_graded *one, imk_result *result)
{
    static const char *const names[IMK_GRADE_WAYS] = {
        "attitude perfect at the start", "self-aligned, 5 min at rest",
        "perfect start, compensated", "self-aligned, compensated"};
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 0x3eU);
    imk_table_row(table, "CEP after\t1 min\t1 h\t24 h\ttilt (1 h)\theading (1 h)\tclass%s",
                  one->missing_count > 0 ? ", at best" : "");
    for (int way = 0; way < (one->compensation_matters ? IMK_GRADE_WAYS : 2); way++) {
        const imk_grade_way *p = &one->way[way];
        char tilt[IMK_READABLE_SIZE] = "", heading[IMK_READABLE_SIZE] = "";
        imk_table_row(table, "%s", names[way]);
        if (!finds_north(p, way)) {
            imk_table_add(table, "no north");
            continue;
        }
        for (size_t t = 0; t < IMK_GRADE_TIMES; t++)
            add_cep(table, p, t, " ~");
        if (p->validity[IMK_GRADE_HOUR] != IMK_DRIFT_LOST) {
            imk_readable_figure(IMK_REQUIRED_HEADING, p->figures[IMK_GRADE_HOUR].tilt, tilt);
            imk_readable_figure(IMK_REQUIRED_HEADING, p->figures[IMK_GRADE_HOUR].heading, heading);
        }
        imk_table_add(table, "%s\t%s\t%s", tilt, heading,
                      name_or(p->grade != IMK_GRADE_NONE, p->grade, "no class claims it"));
    }
}

static bool any_rough(const imk_graded *one)
{
    for (int way = 0; way < IMK_GRADE_WAYS; way++)
        for (size_t t = 0; t < IMK_GRADE_TIMES; t++)
            if (one->way[way].validity[t] == IMK_DRIFT_ROUGH && finds_north(&one->way[way], way))
                return true;
    return false;
}

static void add_value(imk_table *table, double value, const char *unit)
{
    char text[IMK_READABLE_SIZE];
    const imk_unit of = imk_unit_of(unit);
    imk_table_add(table, "%s", isnan(value) ? "-" : imk_readable_quantity(value, &of, text));
}

/* Several models side by side. */
static void show_comparison(const imk_graded_several *r, imk_audience audience, imk_result *result)
{
    if (r->count < 2)
        return;
    imk_result_for(result, audience);
    if (audience == IMK_FOR_PAGE)
        imk_result_heading(result, "Comparison");
    imk_result_gap(result);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "model\tby biases\tby position\tCEP 1 min\tCEP 1 h\tCEP 24 h\tgyro bias\t"
                         "scale factor\taccel bias\tscale factor");
    for (size_t m = 0; m < r->count; m++) {
        const imk_graded *one = r->graded[m];
        const imk_grade_way *p = &one->way[IMK_GRADE_GIVEN];
        imk_table_row(table, "%.40s\t%s%s\t%s%s", r->name[m],
                      at_best(one->table.limiting[0] && one->table.at_best),
                      name_or(one->table.limiting[0], one->table.overall, "-"),
                      at_best(one->missing_count > 0 && p->grade != IMK_GRADE_NONE),
                      one->no_position
                          ? "-"
                          : name_or(p->grade != IMK_GRADE_NONE, p->grade, "no class claims it"));
        for (size_t t = 0; t < IMK_GRADE_TIMES; t++)
            if (!one->no_position)
                add_cep(table, p, t, "");
            else
                imk_table_add(table, "-");
        add_value(table, one->table.gyro_bias, "deg/h");
        add_value(table, one->gyro_scale, "ppm");
        add_value(table, one->table.accel_bias, "ug");
        add_value(table, one->accel_scale, "ppm");
    }
}

/* Size, mass and supply of models that are devices of the catalogue. */
static void show_builds(const imk_graded_several *r, imk_result *result)
{
    imk_table *table = NULL;
    for (size_t m = 0; m < r->count; m++) {
        const imk_device_build *build = imk_device_build_find(r->name[m]);
        if (!build)
            continue;
        if (!table) {
            imk_result_gap(result);
            table = imk_result_table(result, 0xeU);
            imk_table_row(table, "model\tsize [mm]\tmass [g]\tsupply\tread in");
        }
        imk_table_row(table, "%s", build->device);
        imk_show_build_cells(build, table);
        imk_table_add(table, "%s", build->source);
    }
}

/* ---- all ---- */

/* The remarks below the table of computed positions. */
static void show_notes(const imk_graded *one, imk_result *result)
{
    imk_result_gap(result);
    imk_result_line(result, "%s", assumption);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (any_rough(one))
        imk_result_line(result, "~ The errors of attitude are too large for the linear theory.");
    if (!one->compensation_matters)
        imk_result_line(result,
                        "The model states no known value that compensation would take out.");
    imki_text omitted = {.bytes = NULL};
    for (size_t i = 0; i < one->omitted_count; i++)
        imki_text_add(&omitted, "%s%s", i == 0 ? "Not in these figures: " : ", ", one->omitted[i]);
    if (omitted.size > 0)
        imki_text_put(&omitted, ".");
    imki_show_text(&omitted, result);
}

/* The class by the table, and why it is none. */
static void show_headline(const imk_graded *one, const char *name, imk_result *result)
{
    const imk_grade_result *t = &one->table;
    imki_text unstated = {.bytes = NULL};
    char text[600];
    imki_unstated_biases(one->model, t->gyro_at_best, t->accel_at_best, &unstated);
    const char *gap = t->at_best && unstated.size > 0 ? "; not stated: " : "";
    const char *why = *gap ? unstated.bytes : "";
    imk_result_for(result, IMK_FOR_TERMINAL);
    imk_result_line(result, "%s: " IMK_BOLD "%s%s" IMK_PLAIN "%s%s",
                    one->model->name[0] ? one->model->name : name,
                    at_best(t->limiting[0] && t->at_best),
                    name_or(t->limiting[0], t->overall, "no biases stated"),
                    t->limiting[0] ? gap : "", t->limiting[0] ? why : "");
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, name);
    if (t->limiting[0]) {
        snprintf(text, sizeof text, "By its biases: %s%s, decided by the %s%s%.400s.",
                 at_best(t->at_best), grade_name(t->overall), t->limiting, gap, why);
        imk_result_finding(result, t->at_best ? 2 : 1, text);
    }
    free(unstated.bytes);
}

static void show_case(const imk_graded *one, const char *name, const imk_unstated *assumed,
                      imk_result *result)
{
    const imk_grade_result *t = &one->table;
    show_headline(one, name, result);
    show_position(one, result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_bias(one, true, result);
    show_bias(one, false, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (t->limiting[0] && !t->at_best)
        imk_result_line(result, "The class is decided by the %s.", t->limiting);
    show_position(one, result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_limits(one, result);
    show_needs(one, result);
    imki_show_assumed(assumed, name, result);
    imki_show_missing(one->missing_count, one->missing, result);
    show_classes(one, result);
    if (one->no_position)
        return;
    show_ways(one, result);
    show_notes(one, result);
}

void imk_show_grade(const imk_graded_several *r, imk_grade_map map, imk_result *result)
{
    imk_result_object(result, "inputs");
    imki_show_texts(result, "models", r->count, r->name);
    imk_result_end(result);
    imk_result_object(result, "result");
    imki_judge_grade(r, result);
    imk_result_array(result, "models");
    for (size_t m = 0; m < r->count; m++)
        show_data(r->graded[m], r->name[m], r->assumed ? &r->assumed[m] : NULL, result);
    imk_result_end(result);
    imki_show_map_data(result);
    imk_result_end(result);
    imk_result_title(result, "Grade", "%s", r->count > 1 ? "" : r->name[0]);
    show_comparison(r, IMK_FOR_PAGE, result);
    for (size_t m = 0; m < r->count; m++) {
        if (m > 0)
            imk_result_gap(result);
        show_case(r->graded[m], r->name[m], r->assumed ? &r->assumed[m] : NULL, result);
    }
    show_comparison(r, IMK_FOR_TERMINAL, result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_builds(r, result);
    imk_result_for(result, IMK_FOR_PLOT);
    imki_show_grade_plot(r, map, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imki_show_grade_noise(r, result);
    imki_show_grade_maps(r, result);
}
