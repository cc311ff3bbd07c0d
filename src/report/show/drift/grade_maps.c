/* SPDX-License-Identifier: Apache-2.0 */
/* Where models stand among classes, technologies and applications: bias stability against scale
 * factor stability, of gyros and of accelerometers, and cost against performance. A model that
 * states only one of the two is a line along the other axis; no model states a cost.
 *
 * Grades with their applications, errors of position and costs are those of [ELSHEIMY2020], table
 * 1, which states no scale factors, so they are bands across the map. Classes of gyros by bias
 * drift and scale factor accuracy are those of [YAZDI1998], table 1. Technologies are those which
 * the table of classes (grades.c) lists for a bias; it states no scale factors either, so they are
 * columns at the left edge, where no sensor is; their place along the axis has no meaning.
 *
 * An open range of a source ("< 0.01 deg/h") ends at the limit of the better class or at the edge.
 * A single number ("0.1 deg/s", "about 100,000 $") is drawn as a range of a factor of two to either
 * side. */
#include "grade_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdio.h>

typedef struct grade_region {
    imk_region region;  /* in the units of its map */
    const char *source; /* key of docs/references.md and the place in it */
} grade_region;

/* Edges of the maps: of the columns, of the bands. */
#define EDGE 0.001
#define LOW 1.0
#define HIGH 1e5

enum { BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK, GREY };

static const char grades[] = "[ELSHEIMY2020] table 1";
static const char classes[] = "[YAZDI1998] table 1";
static const char technology[] = "the table of classes: technology by bias";

/* x: scale factor [ppm], y: bias [deg/h] */
static const grade_region gyro_regions[] = {
    {{"submarines, missiles", PURPLE, LOW, HIGH, 1e-4, 1e-3, true}, grades},
    {{"aircraft, survey", GREEN, LOW, HIGH, 1e-3, 1e-2, true}, grades},
    {{"weapons, mapping", ORANGE, LOW, HIGH, 1, 10, true}, grades},
    {{"cars, walking", RED, LOW, HIGH, 180, 720, true}, grades},
    {{"inertial class", BLUE, LOW, 10, 1e-4, 1e-2, false}, classes},
    {{"tactical class", BLUE, 100, 1000, 0.1, 10, false}, classes},
    {{"rate class", BLUE, 1000, 1e4, 10, 1000, false}, classes},
    {{"ESG", BLACK, EDGE, 0.005, 1e-4, 0.005, false}, technology},
    {{"RLG, FOG", BLACK, 0.005, 0.035, 1e-4, 10, false}, technology},
    {{"MEMS", BLACK, 0.035, 0.14, 1, 10, false}, technology},
    {{"Coriolis", BLACK, 0.14, 0.9, 1, 1000, false}, technology},
};

/* x: scale factor [ppm], y: bias [ug] */
static const grade_region accel_regions[] = {
    {{"submarines, missiles", PURPLE, LOW, HIGH, 0.1, 1, true}, grades},
    {{"aircraft, survey", GREEN, LOW, HIGH, 1, 100, true}, grades},
    {{"cars, walking", RED, LOW, HIGH, 100, 1000, true}, grades},
    {{"weapons, mapping", ORANGE, LOW, HIGH, 1000, 5000, true}, grades},
    {{"servo", BLACK, EDGE, 0.006, 0.1, 1000, false}, technology},
    {{"vibrating beam", BLACK, 0.006, 0.14, 30, 1000, false}, technology},
    {{"MEMS", BLACK, 0.14, 0.9, 50, 10000, false}, technology},
};

/* x: error of position after an hour [nmi], y: cost of a unit [dollars]; 30 … 100 m/h,
 * 1 nmi/h, 10 … 20 nmi/h, "large variation". The commercial row states the cost of one sensor. */
static const grade_region cost_regions[] = {
    {{"strategic", PURPLE, 30 / 1852.0, 100 / 1852.0, 5e5, 2e6, false}, grades},
    {{"navigation", GREEN, 0.5, 2, 5e4, 2e5, false}, grades},
    {{"tactical", ORANGE, 10, 20, 2e3, 5e4, false}, grades},
    {{"commercial: each sensor", RED, 20, 2000, 1, 10, false}, grades},
};

typedef struct grade_map {
    const char *title, *x_label, *y_label;
    double x_range[2], y_range[2]; /* of the lines */
    const char *caption;
    size_t region_count;
    const grade_region *regions;
} grade_map;

#define REGIONS(table) sizeof(table) / sizeof(table)[0], table

static const grade_map maps[IMK_GRADE_MAPS] = {
    {"Gyros: applications, classes and technologies",
     "stability of the scale factor [ppm]",
     "stability of the bias [deg/h]",
     {1, 1e5},
     {1e-4, 1e4},
     "Bands are applications; their source states no scale factors. Boxes are classes of gyros. "
     "The columns at the left edge are technologies by bias alone: their place along the axis has "
     "no meaning.",
     REGIONS(gyro_regions)},
    {"Accelerometers: applications and technologies",
     "stability of the scale factor [ppm]",
     "stability of the bias [ug]",
     {1, 1e5},
     {0.1, 1e5},
     "Bands are applications; the columns at the left edge are technologies by bias alone.",
     REGIONS(accel_regions)},
    {"Cost class against performance",
     "error of position after an hour [nmi]",
     "cost of a unit [dollars]",
     {1, 2e6},
     {1, 2e6},
     "A model states no cost, so it is drawn as a line at its computed CEP. A published single "
     "number is drawn as a range of a factor of two to either side.",
     REGIONS(cost_regions)},
};

/* Place on the map of costs for an error that is too large to be a position [nmi]. */
static const double beyond = 1800;

/* A place on a map, in its units; NaN if the model does not state the value. */
typedef struct spot {
    double x, y;
    const char *remark;
} spot;

static spot find_spot(const imk_graded *one, int map)
{
    const bool gyro = map == IMK_GRADE_MAP_GYRO;
    if (map == IMK_GRADE_MAP_COST) {
        const double cep =
            !one->no_position ? one->way[IMK_GRADE_GIVEN].cep[IMK_GRADE_HOUR] : (double)NAN;
        const bool lost = !one->no_position && isnan(cep);
        return (spot){lost ? beyond : cep / imk_unit_of("nmi").scale, (double)NAN,
                      lost ? ", no longer a position" : ""};
    }
    const double bias = gyro ? one->table.gyro_bias : one->table.accel_bias;
    const double scale = gyro ? one->gyro_scale : one->accel_scale;
    return (spot){scale / imk_unit_of("ppm").scale, bias / imk_unit_of(gyro ? "deg/h" : "ug").scale,
                  isnan(scale)  ? ", scale factor not stated"
                  : isnan(bias) ? ", bias not stated"
                                : ""};
}

bool imk_grade_stands(const imk_graded_several *r, imk_grade_map map)
{
    for (int i = 0; i < IMK_GRADE_MAPS; i++)
        for (size_t m = 0; m < r->count && (map == IMK_GRADE_MAPS || i == (int)map); m++) {
            const spot s = find_spot(r->graded[m], i);
            if (!isnan(s.x) || !isnan(s.y))
                return true;
        }
    return false;
}

/* The presets show what the classes look like here. */
static void add_presets(bool gyro, imk_figure_builder *figure)
{
    imk_model *model = figure ? imki_arena_take(figure->arena, sizeof *model) : NULL;
    if (!model)
        return;
    imki_begin_curve(figure, "presets, strategic to control", IMK_CURVE_POINTS, 7);
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
    const spot s = find_spot(one, map);
    const bool line = isnan(s.x) || isnan(s.y);
    char label[120];
    if (isnan(s.x) && isnan(s.y))
        return;
    snprintf(label, sizeof label, "%.60s%s", name, s.remark);
    imki_begin_curve(figure, label, line ? IMK_CURVE_DASHES : IMK_CURVE_MARKS, color % 6);
    for (size_t i = 0; i < (line ? 2 : 1); i++)
        imk_figure_point(figure, isnan(s.x) ? maps[map].x_range[i] : s.x,
                         isnan(s.y) ? maps[map].y_range[i] : s.y);
}

static void add_panel(const imk_graded_several *r, int map, imk_figure_builder *figure)
{
    const grade_map *m = &maps[map];
    imk_figure_panel(figure, &(imk_panel){.title = m->title,
                                          .x_label = m->x_label,
                                          .y_label = m->y_label,
                                          .x_logarithmic = true,
                                          .y_logarithmic = true,
                                          .key = IMK_KEY_BELOW});
    for (size_t i = 0; i < m->region_count; i++)
        imk_figure_region(figure, &m->regions[i].region);
    if (map != IMK_GRADE_MAP_COST)
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

void imki_show_grade_maps(const imk_graded_several *r, imk_result *result)
{
    imk_result_heading(result, "Maps");
    for (int i = 0; i < IMK_GRADE_MAPS; i++) {
        if (!imk_grade_stands(r, (imk_grade_map)i))
            continue;
        add_panel(r, i, imk_result_figure(result, "", 0, maps[i].caption));
        imk_table *table = imk_result_table(result, 0);
        imk_table_row(table, "region\tpublished in");
        for (size_t k = 0; k < maps[i].region_count; k++)
            imk_table_row(table, "%s\t%s", maps[i].regions[k].region.label,
                          maps[i].regions[k].source);
    }
    imk_result_line(result, "[ELSHEIMY2020]: doi 10.1186/s43020-019-0001-5. [YAZDI1998]: doi "
                            "10.1109/5.704269. The table of classes is the one above.");
}
