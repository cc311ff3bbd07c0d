/* SPDX-License-Identifier: Apache-2.0 */
/* A grade as JSON and as an HTML page. */
#include "grade_parts.h"

#include "shell/page_table.h"

#include "imukit/model_file.h"

#include <math.h>
#include <stdlib.h>

/* ---- JSON ---- */

static json_t *name_or_null(bool known, imk_grade grade)
{
    return known ? json_string(grade_name(grade)) : json_null();
}

static json_t *position_json(const grade_position *p)
{
    static const char *const names[] = {"linear", "rough", "no position"};
    json_t *times = json_array();
    for (size_t t = 0; t < GRADE_TIMES; t++)
        json_array_append_new(times, json_pack("{s:o, s:o, s:o, s:o, s:s}", "time",
                                               json_quantity(grade_time[t], "s"), "cep",
                                               json_quantity(p->cep[t], "m"), "tilt",
                                               json_quantity(p->figures[t].tilt, "rad"), "heading",
                                               json_quantity(p->figures[t].heading, "rad"),
                                               "validity", names[p->validity[t]]));
    return json_pack("{s:o, s:o}", "class", name_or_null(p->grade != IMK_GRADE_NONE, p->grade),
                     "times", times);
}

static json_t *shares_json(size_t count, const grade_share *share, const char *key)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(
            list, json_pack("{s:s, s:o}", "term", share[i].text, key, json_number(share[i].value)));
    return list;
}

static json_t *computed_json(const grade_case *one)
{
    static const char *const names[GRADE_WAYS] = {"given", "self", "given_compensated",
                                                  "self_compensated"};
    if (!one->has_position)
        return json_null();
    json_t *computed = json_object();
    for (int way = 0; way < GRADE_WAYS; way++)
        json_object_set_new(computed, names[way], position_json(&one->way[way]));
    json_object_set_new(computed, "shares", shares_json(one->share_count, one->share, "share"));
    json_object_set_new(computed, "next",
                        one->next == IMK_GRADE_NONE
                            ? json_null()
                            : json_pack("{s:s, s:o, s:o}", "class", grade_name(one->next), "all",
                                        json_number(one->next_all), "terms",
                                        shares_json(one->need_count, one->need, "times_better")));
    json_object_set_new(computed, "assumption", json_string(grade_assumption));
    return computed;
}

static json_t *case_json(const grade_case *one)
{
    const imk_grade_result *t = &one->table;
    const bool known = t->limiting[0];
    const imk_grade_row *row = imk_grade_table(t->overall);
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:o}", "model",
        json_text(one->operand), "overall", name_or_null(known, t->overall), "gyro",
        name_or_null(!isnan(t->gyro_bias), t->gyro), "accel",
        name_or_null(!isnan(t->accel_bias), t->accel), "gyro_bias",
        json_quantity(t->gyro_bias, "rad/s"), "accel_bias", json_quantity(t->accel_bias, "m/s^2"),
        "gyro_scale_factor", json_quantity(one->gyro_scale, "1"), "accel_scale_factor",
        json_quantity(one->accel_scale, "1"), "limiting", t->limiting, "position_performance",
        known && row ? json_string(row->position_performance) : json_null(), "position",
        computed_json(one), "no_position",
        one->has_position ? json_null() : json_text(one->no_position));
}

int grade_print_json(const grade_result *r)
{
    json_t *models = json_array(), *names = json_array();
    for (size_t m = 0; m < r->count; m++) {
        json_array_append_new(models, case_json(&r->cases[m]));
        json_array_append_new(names, json_text(r->cases[m].operand));
    }
    return json_print("grade", json_pack("{s:o}", "models", names),
                      json_pack("{s:o}", "models", models), EXIT_DONE);
}

/* ---- page ---- */

static void put_table(imk_page *page, const char *title, text_table table)
{
    if (table.rows > 0 && title)
        imk_page_heading(page, title);
    page_put_table(page, &table);
    text_table_free(&table);
}

static void put_text(imk_page *page, const char *text)
{
    if (text[0])
        imk_page_text(page, text);
}

static void put_case(imk_page *page, const grade_case *one)
{
    char text[600];
    imk_page_heading(page, one->operand);
    if (one->table.limiting[0]) {
        snprintf(text, sizeof text, "By its biases: %s, decided by the %s.",
                 grade_name(one->table.overall), one->table.limiting);
        imk_page_verdict(page, 1, text);
    }
    grade_position_sentence(one, text, sizeof text);
    imk_page_verdict(page, one->has_position ? 1 : 2, text);
    for (int gyro = 1; gyro >= 0; gyro--) {
        grade_bias_sentence(one, gyro == 1, text, sizeof text);
        put_text(page, text);
    }
    grade_share_sentence(one, text, sizeof text);
    put_text(page, text);
    grade_need_sentence(one, text, sizeof text);
    put_text(page, text);
    put_table(page, NULL, grade_class_table(one));
    put_table(page, NULL, grade_position_table(one));
    if (one->has_position)
        imk_page_text(page, grade_assumption);
    grade_flattery_sentence(one, text, sizeof text);
    put_text(page, text);
}

static text_table source_table(int map)
{
    size_t count;
    const grade_region *regions = grade_regions(map, &count);
    text_table table = text_table_make(2);
    text_table_row(&table);
    text_table_set(&table, 0, "region");
    text_table_set(&table, 1, "published in");
    for (size_t i = 0; i < count; i++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%s", regions[i].region.label);
        text_table_set(&table, 1, "%s", regions[i].source);
    }
    return table;
}

static const char *caption(int map)
{
    switch (map) {
    case GRADE_MAP_GYRO:
        return "Bands are applications, whose source says nothing of scale factors; boxes are "
               "classes of gyros. The columns at the left edge are technologies by bias alone: "
               "their place along the axis means nothing.";
    case GRADE_MAP_ACCEL:
        return "Bands are applications; the columns at the left edge are technologies by bias "
               "alone.";
    default:
        return "A model states no cost: it is a line at its computed CEP. Published figures that "
               "are one number are drawn as a factor of two to either side.";
    }
}

static void put_maps(imk_page *page, const grade_result *r)
{
    grade_map *map = command_memory(NULL, sizeof *map);
    for (int i = 0; i < GRADE_MAPS; i++) {
        if (!grade_map_make(r, i, map))
            continue;
        const imk_figure figure = {.title = "", .panel_count = 1, .panels = &map->panel};
        imk_page_figure(page, &figure, caption(i));
        put_table(page, NULL, source_table(i));
    }
    free(map);
}

int grade_report(const grade_result *r, const char *path)
{
    imk_page *page = imk_page_create("Grade", r->count > 1 ? "" : r->cases[0].operand);
    put_table(page, "Comparison", grade_comparison_table(r));
    for (size_t m = 0; m < r->count; m++)
        put_case(page, &r->cases[m]);
    imk_page_heading(page, "Maps");
    put_maps(page, r);
    imk_page_text(page, "[ELSHEIMY2020]: doi 10.1186/s43020-019-0001-5. [YAZDI1998]: doi "
                        "10.1109/5.704269. The table of classes is the one above.");
    for (size_t m = 0; m < r->count; m++)
        page_put_model(page, r->cases[m].operand, r->cases[m].model);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
