/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo of drift: the runs as a campaign, and its statistics. */
#include "campaign/campaign_run.h"
#include "drift_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const state_names[IMK_DRIFT_STATES] = {
    "position_north", "position_east",  "position_down", "velocity_north", "velocity_east",
    "velocity_down",  "attitude_north", "attitude_east", "attitude_down"};
static const char *const state_units[IMK_DRIFT_STATES] = {"m",   "m",   "m",   "m/s", "m/s",
                                                          "m/s", "rad", "rad", "rad"};

/* ---- runs ---- */

typedef struct crew {
    const drift_case *one;
    imk_drift_settings settings;
    uint64_t seed;
    size_t size; /* of the memory of a thread */
    size_t threads;
    void **memory;
} crew;

/* A thread's memory is made by itself, where it runs. */
static imk_status compute(void *context, size_t thread, uint64_t first, size_t count,
                          double *values, imk_error *error)
{
    crew *c = context;
    if (!c->memory[thread])
        c->memory[thread] = drift_memory(c->size);
    if (!c->memory[thread])
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    return imk_drift_runs(c->one->model, &c->settings, c->seed, (uint32_t)first, count,
                          c->memory[thread], c->size, values, error);
}

/* "3/10" -> 3 and 10. */
static int read_shard(const char *text, uint64_t *index, uint64_t *count)
{
    unsigned long long i, n;
    int used = 0;
    if (sscanf(text, "%llu/%llu%n", &i, &n, &used) != 2 || text[used] || i < 1 || i > n ||
        strchr(text, '-'))
        return command_misused("--shard %s: expected I/N, such as 3/10: the third of ten parts",
                               text);
    if (n > UINT32_MAX) /* as many as runs; what is no number of 64 bits is read as the largest */
        return command_misused("--shard %s: expected at most 4294967295 parts", text);
    *index = i;
    *count = n;
    return -1;
}

/* Times of the table, for the runs. */
static double *row_times(const drift_scene *scene)
{
    double *time = command_memory(NULL, scene->row_count * sizeof *time);
    for (size_t k = 0; k < scene->row_count; k++)
        time[k] = scene->time[scene->row[k]];
    return time;
}

static void keep_statistics(drift_result *r, size_t rows, uint64_t runs, const double *values)
{
    double *workspace = command_memory(NULL, (runs + 1) * sizeof *workspace);
    r->run_count = runs;
    r->found = command_zeroed(rows * sizeof *r->found);
    r->low = command_zeroed(rows * sizeof *r->low);
    r->high = command_zeroed(rows * sizeof *r->high);
    r->used = command_zeroed(rows * sizeof *r->used);
    for (size_t k = 0; k < rows; k++)
        r->found[k] =
            imk_drift_figures_of_runs(runs, rows * IMK_DRIFT_STATES, values + k * IMK_DRIFT_STATES,
                                      workspace, &r->low[k], &r->high[k], &r->used[k]);
    free(workspace);
}

static int run_campaign(drift_result *r, crew *c, imk_campaign *campaign)
{
    const drift_options *o = r->options;
    uint64_t index = 1, count = 1, first, runs;
    double *values = NULL;
    int code = o->shard ? read_shard(o->shard, &index, &count) : -1;
    if (code >= 0)
        return code;
    imk_campaign_shard(campaign->run_count, index, count, &first, &runs);
    if (runs == 0)
        return command_misused("--shard %s: there is no run in it; --monte-carlo %llu has fewer "
                               "runs than shards",
                               o->shard, (unsigned long long)campaign->run_count);
    c->threads = campaign_threads(o->threads.value);
    c->memory = command_zeroed(c->threads * sizeof *c->memory);
    const campaign_work work = {IMK_DRIFT_LANES, compute, c, c->threads};
    code = campaign_run(campaign, first, runs, &work, o->output, &values);
    if (code < 0)
        keep_statistics(r, campaign->time_count, runs, values);
    free(values);
    for (size_t t = 0; t < c->threads; t++)
        free(c->memory[t]);
    free(c->memory);
    return code;
}

int drift_runs(drift_result *r)
{
    const drift_scene *scene = r->scene;
    crew c = {.one = drift_last_case(r), .seed = r->options->seed.value};
    double *time = row_times(scene);
    char *parameters = drift_parameters(scene, &c.one->settings, c.one->model);
    c.settings = c.one->settings;
    c.settings.time = time;
    c.settings.time_count = scene->row_count;
    c.size = imk_drift_runs_size(c.one->model, &c.settings);
    imk_campaign campaign = {.version = IMK_VERSION,
                             .parameters = parameters,
                             .seed = c.seed,
                             .run_count = r->options->monte_carlo.value,
                             .time_count = scene->row_count,
                             .time = time,
                             .state_count = IMK_DRIFT_STATES,
                             .state = state_names,
                             .unit = state_units};
    const int code = run_campaign(r, &c, &campaign);
    free(time);
    free(parameters);
    return code;
}

/* ---- a results file ---- */

static int check_results(const imk_campaign_results *results, const char *path)
{
    const imk_campaign *c = &results->campaign;
    bool ours = c->state_count == IMK_DRIFT_STATES && results->runs > 0;
    for (size_t i = 0; ours && i < IMK_DRIFT_STATES; i++)
        ours = strcmp(c->state[i], state_names[i]) == 0;
    return ours ? -1
                : command_failed("%s: the results of another kind of campaign, not of imukit drift",
                                 path);
}

/* A scene of the times of the file alone, so that tables and figures of runs can be made. */
static drift_scene scene_of_results(const imk_campaign *c)
{
    const size_t count = c->time_count;
    drift_scene scene = {.time_count = count,
                         .row_count = count,
                         .time = command_memory(NULL, count * sizeof *scene.time),
                         .row = command_memory(NULL, count * sizeof *scene.row)};
    for (size_t k = 0; k < count; k++) {
        scene.time[k] = c->time[k];
        scene.row[k] = k;
    }
    return scene;
}

static int show(drift_result *r, const imk_campaign_results *results)
{
    const drift_options *o = r->options;
    keep_statistics(r, r->scene->row_count, results->runs, results->values);
    const int code = o->output ? drift_write_csv(r, o->output) : -1;
    if (code >= 0)
        return code;
    imk_result *result = show_begin("drift");
    drift_show_results(r, results, result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    EXIT_DONE);
}

int drift_results(const drift_options *o, const char *path)
{
    imk_campaign_results *results;
    imk_error error;
    if (imk_campaign_load(path, &results, &error) != IMK_OK)
        return command_error(&error, path);
    int code = check_results(results, path);
    if (code < 0) {
        drift_result *r = command_zeroed(sizeof *r);
        drift_scene scene = scene_of_results(&results->campaign);
        r->options = o;
        r->scene = &scene;
        r->name[0] = path;
        code = show(r, results);
        drift_scene_free(&scene);
        drift_result_free(r);
        free(r);
    }
    imk_campaign_free(results);
    return code;
}
