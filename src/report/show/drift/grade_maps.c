/* SPDX-License-Identifier: Apache-2.0 */
/* Where models stand among technologies, classes and applications: the regions of technology_map.h
 * as drawings, as tables and as data. A model that states only one of the two values is a line
 * along the other axis; no model states a price. */
#include "grade_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLACK = 6, GREY = 7, HUES = 6 };

/* Where regions are drawn whose source states nothing along x, in the units of the map: bands of
 * applications, and columns of technologies at the left edge, where no sensor is. */
static const double band[] = {1, 1e5}, column[] = {0.2, 0.7}, price_band[] = {1e-4, 1e4};

const char *imki_region_name(const imk_map_region *region, char text[IMKI_WORDS])
{
    (void)snprintf(text, IMKI_WORDS, "%s%s%s", region->name, region->detail[0] ? ", " : "",
                   region->detail);
    return text;
}

/* Technologies have the colour of their kind; the first one that is named counts. */
static int color_of(const imk_map_region *region)
{
    const imk_technology *technology;
    if (region->kind != IMK_MAP_TECHNOLOGY)
        return region->kind == IMK_MAP_CLASS ? BLACK : GREY;
    for (size_t i = 0; (technology = imk_technology_get(i)); i++)
        if (strncmp(region->name, technology->name, strlen(technology->name)) == 0)
            return (int)(i % HUES);
    return BLACK;
}

static void add_region(const imk_map_region *region, int map, imk_figure_builder *figure)
{
    const imki_grade_map *m = imki_grade_map_of(map);
    const bool ranged = !isnan(region->x_low), technology = region->kind == IMK_MAP_TECHNOLOGY;
    const double *stand_in = map > IMK_GRADE_MAP_ACCEL ? price_band : technology ? column : band;
    const double x = imk_unit_of(m->x.unit).scale, y = imk_unit_of(m->y.unit).scale;
    char name[IMKI_WORDS];
    imk_figure_region(figure, &(imk_region){.label = imki_region_name(region, name),
                                            .color = color_of(region),
                                            .x_low = ranged ? region->x_low / x : stand_in[0],
                                            .x_high = ranged ? region->x_high / x : stand_in[1],
                                            .y_low = region->y_low / y,
                                            .y_high = region->y_high / y,
                                            .label_right = !technology,
                                            .dashed = region->doubt > 1});
}

/* The presets show what the classes look like here. */
static void add_presets(bool gyro, imk_figure_builder *figure)
{
    imk_model *model = figure ? imki_arena_take(figure->arena, sizeof *model) : NULL;
    if (!model)
        return;
    imki_begin_curve(figure, "presets, strategic to control", IMK_CURVE_POINTS, GREY);
    for (size_t i = 0; i < 5; i++) {
        imk_device_model(imk_device_get(i), model);
        const imk_grade_result table = imk_grade_model(model);
        const imk_triad *triad = gyro ? &model->gyro : &model->accel;
        imk_figure_point(figure,
                         triad->scale_factor.repeatability.value[0] / imk_unit_of("ppm").scale,
                         gyro ? table.gyro_bias / imk_unit_of("deg/h").scale
                              : table.accel_bias / imk_unit_of("ug").scale);
    }
}

/* A point, or a line along the axis whose value is unknown. */
static void add_model(const imk_graded *one, const char *name, int color, int map,
                      imk_figure_builder *figure)
{
    const imki_grade_map *m = imki_grade_map_of(map);
    const imki_grade_place p = imki_grade_place_of(one, map);
    const bool line = isnan(p.at[0]) || isnan(p.at[1]);
    char label[80];
    if (!imki_grade_is_drawn(&p))
        return;
    snprintf(label, sizeof label, "%.60s", name);
    imki_begin_curve(figure, label, line ? IMK_CURVE_DASHES : IMK_CURVE_MARKS, color);
    for (int i = 0; i < (line ? 2 : 1); i++)
        imk_figure_point(figure,
                         !isnan(p.at[0]) ? p.at[0]
                         : i == 0        ? m->x.low
                                         : m->x.high,
                         !isnan(p.at[1]) ? p.at[1]
                         : i == 0        ? m->y.low
                                         : m->y.high);
}

static void add_panel(const imk_graded_several *r, int map, imk_figure_builder *figure)
{
    const imki_grade_map *m = imki_grade_map_of(map);
    const imk_map_region *region;
    imki_text note = {.bytes = NULL};
    imki_grade_note(r, map, &note);
    size_t size;
    if (note.failed && figure)
        figure->arena->failed = true;
    char *lines = imki_text_take(&note, &size);
    imk_figure_panel(figure, &(imk_panel){.title = m->title,
                                          .x_label = m->x.label,
                                          .y_label = m->y.label,
                                          .x_logarithmic = true,
                                          .y_logarithmic = true,
                                          .key = IMK_KEY_BELOW,
                                          .note = lines});
    free(lines);
    for (size_t i = 0; (region = imk_map_region_get((imk_grade_map)map, i)); i++)
        add_region(region, map, figure);
    if (map <= IMK_GRADE_MAP_ACCEL)
        add_presets(map == IMK_GRADE_MAP_GYRO, figure);
    for (size_t k = 0; k < r->count; k++)
        add_model(r->graded[k], r->name[k], (int)k, map, figure);
}

void imki_show_grade_plot(const imk_graded_several *r, int map, imk_result *result)
{
    imk_figure_builder *figure = imk_result_figure(result, "Grade", 2, "");
    for (int i = 0; i < IMK_GRADE_MAPS; i++)
        if ((map == IMK_GRADE_MAPS || i == (int)map) && imk_grade_stands(r, (imk_grade_map)i))
            add_panel(r, i, figure);
}

/* ---- tables ---- */

static void add_sources(int map, imk_result *result)
{
    const imk_map_region *region;
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "region\tpublished in\tyear\tlimits");
    for (size_t i = 0; (region = imk_map_region_get((imk_grade_map)map, i)); i++) {
        char name[IMKI_WORDS];
        imk_table_row(table, "%s\t%s", imki_region_name(region, name), region->source);
        if (region->year > 0)
            imk_table_add(table, "%d", region->year);
        else
            imk_table_add(table, "undated");
        if (region->doubt > 1)
            imk_table_add(table, "from memory, each within a factor of %g", region->doubt);
        else
            imk_table_add(table, "as read");
    }
}

void imki_show_grade_maps(const imk_graded_several *r, imk_result *result)
{
    imk_result_heading(result, "Maps");
    for (int i = 0; i < IMK_GRADE_MAPS; i++) {
        if (!imk_grade_stands(r, (imk_grade_map)i))
            continue;
        add_panel(r, i, imk_result_figure(result, "", 0, imki_grade_map_of(i)->caption));
        add_sources(i, result);
    }
    imk_result_line(result, "The keys of the sources are those of docs/references.md. "
                            "[ELSHEIMY2020]: doi 10.1186/s43020-019-0001-5. [YAZDI1998]: doi "
                            "10.1109/5.704269.");
}

/* ---- data ---- */

static void show_range(const char *key, double low, double high, const char *unit,
                       imk_result *result)
{
    if (!imki_begin_object(result, key, !isnan(low)))
        return;
    imk_result_number(result, "low", low);
    imk_result_number(result, "high", high);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

static void show_region(const imk_map_region *region, int map, imk_result *result)
{
    static const char *const kinds[] = {"technology", "class", "application"};
    static const char *const units[IMK_GRADE_MAPS][2] = {
        {"1", "rad/s"}, {"1", "m/s^2"}, {"rad/s", "USD"}, {"rad/s", "USD"}};
    imk_result_object(result, NULL);
    imk_result_text(result, "kind", kinds[region->kind]);
    imk_result_text(result, "name", region->name);
    imk_result_text(result, "detail", region->detail);
    show_range("x", region->x_low, region->x_high, units[map][0], result);
    show_range("y", region->y_low, region->y_high, units[map][1], result);
    if (region->year > 0)
        imk_result_count(result, "year", region->year);
    else
        imk_result_null(result, "year");
    imk_result_flag(result, "from_memory", region->doubt > 1);
    imk_result_number(result, "doubt_factor", region->doubt);
    imk_result_text(result, "source", region->source);
    imk_result_end(result);
}

void imki_show_map_data(imk_result *result)
{
    const imk_map_region *region;
    imk_result_object(result, "maps");
    for (int map = 0; map < IMK_GRADE_MAPS; map++) {
        imk_result_object(result, imki_grade_map_of(map)->key);
        imk_result_text(result, "x", imki_grade_map_of(map)->x.quantity);
        imk_result_text(result, "y", imki_grade_map_of(map)->y.quantity);
        imk_result_array(result, "regions");
        for (size_t i = 0; (region = imk_map_region_get((imk_grade_map)map, i)); i++)
            show_region(region, map, result);
        imk_result_end(result);
        imk_result_end(result);
    }
    imk_result_end(result);
}
