/* SPDX-License-Identifier: Apache-2.0 */
/* Where models stand among classes, technologies and applications: bias stability against scale
 * factor stability, of gyros and of accelerometers, and cost against performance.
 *
 * A model that does not state one of the two is a line along it; what it costs none states. */
#include "grade_parts.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where an error that is no position any more stands on the map of costs [nmi]. */
static const double beyond = 1800;

/* A point, or a line over the range of the axis that is not known. */
static void place(grade_map *m, size_t model, double x, double y, const double x_range[2],
                  const double y_range[2])
{
    const bool point = !isnan(x) && !isnan(y);
    for (size_t i = 0; i < 2; i++) {
        m->x[model][i] = isnan(x) ? x_range[i] : x;
        m->y[model][i] = isnan(y) ? y_range[i] : y;
    }
    m->curve[m->panel.curve_count++] =
        (imk_curve){.label = m->label[model],
                    .style = point ? IMK_CURVE_MARKS : IMK_CURVE_DASHES,
                    .color = (int)model % 6,
                    .count = point ? 1 : 2,
                    .x = m->x[model],
                    .y = m->y[model]};
}

/* The presets show what the classes look like here. */
static void add_presets(grade_map *m, bool gyro)
{
    imk_model *model = command_memory(NULL, sizeof *model);
    for (size_t i = 0; i < 5; i++) {
        imk_device_model(imk_device_get(i), model);
        const imk_grade_result table = imk_grade_model(model);
        const imk_triad *triad = gyro ? &model->gyro : &model->accel;
        m->preset_x[i] = triad->scale_factor.repeatability.value[0] / imk_unit_of("ppm").scale;
        m->preset_y[i] = gyro ? table.gyro_bias / imk_unit_of("deg/h").scale
                              : table.accel_bias / imk_unit_of("ug").scale;
    }
    m->curve[m->panel.curve_count++] = (imk_curve){.label = "presets, strategic to control",
                                                   .style = IMK_CURVE_POINTS,
                                                   .color = 7,
                                                   .count = 5,
                                                   .x = m->preset_x,
                                                   .y = m->preset_y};
    free(model);
}

static bool stability_map(const grade_result *r, bool gyro, grade_map *m)
{
    static const double scale_range[2] = {1, 1e5}, gyro_range[2] = {1e-4, 1e4},
                        accel_range[2] = {0.1, 1e5};
    const double ppm = imk_unit_of("ppm").scale;
    const double unit = imk_unit_of(gyro ? "deg/h" : "ug").scale;
    size_t placed = 0;
    m->panel.title = gyro ? "Gyros: applications, classes and technologies"
                          : "Accelerometers: applications and technologies";
    m->panel.x_label = "stability of the scale factor [ppm]";
    m->panel.y_label = gyro ? "stability of the bias [deg/h]" : "stability of the bias [ug]";
    add_presets(m, gyro);
    for (size_t k = 0; k < r->count; k++) {
        const grade_case *one = &r->cases[k];
        const double bias = gyro ? one->table.gyro_bias : one->table.accel_bias;
        const double scale = gyro ? one->gyro_scale : one->accel_scale;
        if (isnan(bias) && isnan(scale))
            continue;
        snprintf(m->label[k], sizeof m->label[k], "%.60s%s", one->operand,
                 isnan(scale)  ? ", scale factor not stated"
                 : isnan(bias) ? ", bias not stated"
                               : "");
        place(m, k, scale / ppm, bias / unit, scale_range, gyro ? gyro_range : accel_range);
        placed++;
    }
    return placed > 0;
}

static bool cost_map(const grade_result *r, grade_map *m)
{
    static const double cost_range[2] = {1, 2e6};
    const double mile = imk_unit_of("nmi").scale;
    size_t placed = 0;
    m->panel.title = "Cost class against performance";
    m->panel.x_label = "error of position after an hour [nmi]";
    m->panel.y_label = "cost of a unit [dollars]";
    for (size_t k = 0; k < r->count; k++) {
        const grade_case *one = &r->cases[k];
        if (!one->has_position)
            continue;
        const double cep = one->way[GRADE_GIVEN].cep[GRADE_HOUR];
        snprintf(m->label[k], sizeof m->label[k], "%.60s%s", one->operand,
                 isnan(cep) ? ", no longer a position" : "");
        place(m, k, isnan(cep) ? beyond : cep / mile, (double)NAN, cost_range, cost_range);
        placed++;
    }
    return placed > 0;
}

bool grade_map_make(const grade_result *r, int map, grade_map *m)
{
    size_t count;
    const grade_region *regions = grade_regions(map, &count);
    memset(m, 0, sizeof *m);
    for (size_t i = 0; i < count; i++)
        m->region[i] = regions[i].region;
    m->panel.x_logarithmic = m->panel.y_logarithmic = true;
    m->panel.region_count = count;
    m->panel.regions = m->region;
    m->panel.curves = m->curve;
    m->panel.key = IMK_KEY_BELOW;
    return map == GRADE_MAP_COST ? cost_map(r, m) : stability_map(r, map == GRADE_MAP_GYRO, m);
}

int grade_draw(const grade_result *r, const char *path)
{
    imk_error error;
    const grade_options *o = r->options;
    imk_panel panel[GRADE_MAPS];
    imk_figure figure = {.title = "Grade", .columns = 2, .panels = panel};
    grade_map *maps = command_memory(NULL, GRADE_MAPS * sizeof *maps);
    for (int map = 0; map < GRADE_MAPS; map++)
        if ((o->map == 0 || o->map == map + 1) && grade_map_make(r, map, &maps[map]))
            panel[figure.panel_count++] = maps[map].panel;
    int code = -1;
    if (figure.panel_count == 0)
        code = command_failed("--map: nothing of the model stands on this map");
    else if (imk_figure_write(&figure, path, &error) != IMK_OK)
        code = command_error(&error, NULL);
    free(maps);
    return code;
}
