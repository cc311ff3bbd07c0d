/* SPDX-License-Identifier: Apache-2.0 */
/* The experiments of a laboratory on an instrument, beside what its closed forms say. */
#include "physics_parts.h"

#include "imukit/thread_pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A figure agrees when the difference is within this many 1-sigma values, or within the part of
 * the figure that the closed forms leave out: small terms of higher order. */
static const double sigmas_allowed = 4, part_allowed = 0.1;

int physics_laboratory_make(const physics *p, physics_laboratory *laboratory)
{
    imk_error error = {.status = IMK_OK};
    imk_laboratory settings = imk_laboratory_default();
    settings.instrument = p->file.instrument;
    settings.design = p->file.design;
    settings.physics = p->settings;
    settings.surroundings.temperature = p->input.exposure.temperature;
    if (!p->settings.noise)
        settings.record = 0;
    const size_t size = imk_laboratory_workspace_size(&settings);
    void *workspace = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!workspace)
        return command_failed("memory is exhausted");
    imk_thread_pool *pool = imk_thread_pool_create(p->options->threads.value);
    const imk_executor executor = imk_thread_pool_executor(pool);
    const imk_status status =
        imk_laboratory_run(&settings, workspace, size, &executor, &laboratory->result, &error);
    imk_thread_pool_destroy(pool);
    free(workspace);
    if (status != IMK_OK)
        return physics_refused(p, &error);
    const int sensor = p->file.instrument->sensor;
    laboratory->count = imk_laboratory_figures(p->model, sensor, laboratory->computed);
    (void)imk_laboratory_figures(&laboratory->result.model, sensor, laboratory->found);
    return -1;
}

/* Worth a line: one of the two says something. */
static bool says_something(const imk_laboratory_figure *computed,
                           const imk_laboratory_figure *found)
{
    return computed->value != 0 || fabs(found->value) > sigmas_allowed * found->sigma;
}

static const char *judge(const imk_laboratory_figure *computed, const imk_laboratory_figure *found)
{
    const double difference = fabs(found->value - computed->value);
    const double sigma = hypot(found->sigma, computed->sigma);
    if (isnan(found->value) || (found->value == 0 && found->sigma == 0))
        return "not measured";
    if (difference <= sigmas_allowed * sigma)
        return "agrees";
    if (difference <= part_allowed * fabs(computed->value))
        return "close";
    return "differs";
}

text_table physics_sweep_table(const physics *p, const physics_laboratory *l)
{
    static const char *const headers[] = {"parameter", "closed form", "experiment",
                                          "1 sigma",   "unit",        ""};
    text_table table = text_table_make(6);
    (void)p;
    table.right = 0xeu;
    text_table_row(&table);
    for (size_t c = 0; c < 6; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t i = 0; i < l->count; i++) {
        const imk_laboratory_figure *computed = &l->computed[i], *found = &l->found[i];
        const double scale = imk_unit_of(found->unit).scale;
        if (!says_something(computed, found))
            continue;
        text_table_row(&table);
        text_table_set(&table, 0, "%s", found->key);
        text_table_set(&table, 1, "%.5g", computed->value / scale);
        text_table_set(&table, 2, "%.5g", found->value / scale);
        text_table_set(&table, 3, "%.2g", found->sigma / scale);
        text_table_set(&table, 4, "%s", strcmp(found->unit, "1") == 0 ? "" : found->unit);
        text_table_set(&table, 5, "%s", judge(computed, found));
    }
    return table;
}

static json_t *points_json(const imk_laboratory_result *r, const char *si)
{
    json_t *list = json_array();
    for (int i = 0; i < r->point_count; i++)
        json_array_append_new(list, json_pack("{s:o, s:o, s:o}", "input",
                                              json_quantity(r->point[i].input, si), "output",
                                              json_quantity(r->point[i].output, si), "sigma",
                                              json_quantity(r->point[i].sigma, si)));
    return list;
}

static json_t *responses_json(const imk_laboratory_result *r)
{
    json_t *list = json_array();
    for (int i = 0; i < r->response_count; i++)
        json_array_append_new(list, json_pack("{s:o, s:o, s:o}", "frequency",
                                              json_quantity(r->response[i].frequency, "Hz"), "gain",
                                              json_quantity(r->response[i].gain, "1"), "phase",
                                              json_quantity(r->response[i].phase, "rad")));
    return list;
}

json_t *physics_sweep_json(const physics *p, const physics_laboratory *l)
{
    const char *si = p->file.instrument->sensor == IMK_GYRO ? "rad/s" : "m/s^2";
    const imk_laboratory_result *r = &l->result;
    json_t *figures = json_object();
    for (size_t i = 0; i < l->count; i++)
        json_object_set_new(figures, l->found[i].key,
                            json_pack("{s:o, s:o, s:o, s:s}", "closed_form",
                                      json_quantity(l->computed[i].value, l->found[i].si),
                                      "experiment",
                                      json_quantity(l->found[i].value, l->found[i].si), "sigma",
                                      json_quantity(l->found[i].sigma, l->found[i].si), "verdict",
                                      judge(&l->computed[i], &l->found[i])));
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "figures", figures, "full_scale",
                     json_quantity(r->full_scale, si), "line_deviation",
                     json_quantity(r->line_deviation, "1"), "threshold",
                     json_quantity(r->threshold, si), "bandwidth",
                     json_quantity(r->bandwidth, "Hz"), "points", points_json(r, si), "responses",
                     responses_json(r));
}
