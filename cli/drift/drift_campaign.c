/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo of drift: the runs as a campaign, and its statistics. */
#define _POSIX_C_SOURCE 200809L
#include "campaign/campaign_run.h"
#include "drift_parts.h"
#include "shell/growing_list.h"

#include "imukit/model_file.h"
#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By imk_attitude_errors: so a file says which attitude its errors are of, and one from before
 * there was a choice is read as what it holds. The last, of an aided navigator, is e^T P^-1 e of 7
 * or 9 errors. */
#define FIRST_STATES                                                                               \
    "position_north", "position_east", "position_down", "velocity_north", "velocity_east",         \
        "velocity_down"
#define DISPLAYED_STATES FIRST_STATES, "displayed_north", "displayed_east", "displayed_down"
#define EARTH_STATES FIRST_STATES, "attitude_north", "attitude_east", "attitude_down"
static const char *const state_names[2][2][IMK_DRIFT_AIDED_STATES] = {
    {{DISPLAYED_STATES, "nees_9"}, {DISPLAYED_STATES, "nees_7"}},
    {{EARTH_STATES, "nees_9"}, {EARTH_STATES, "nees_7"}}};
static const char *const state_units[IMK_DRIFT_AIDED_STATES] = {"m",   "m",   "m",   "m/s", "m/s",
                                                                "m/s", "rad", "rad", "rad", "1"};

/* ---- runs ---- */

typedef struct crew {
    const imk_drift_case *one;
    imk_drift_settings settings;
    uint64_t seed;
    size_t size; /* of the memory of a thread */
    size_t threads;
    void **memory;
} crew;

static void *thread_memory(size_t size)
{
    void *memory = NULL;
    return posix_memalign(&memory, 64, size) == 0 ? memory : NULL;
}

/* Each thread allocates its own memory, where it runs. */
static imk_status compute(void *context, size_t thread, uint64_t first, size_t count,
                          double *values, imk_error *error)
{
    crew *c = context;
    if (!c->memory[thread])
        c->memory[thread] = thread_memory(c->size);
    if (!c->memory[thread])
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    return (c->settings.aid_count > 0 ? imk_drift_aided_runs : imk_drift_runs)(
        c->one->model, &c->settings, c->seed, (uint32_t)first, count, values, c->memory[thread],
        c->size, error);
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
    if (n > UINT32_MAX) /* at most as many as runs; a number beyond 64 bits is read as the largest
                         * one */
        return command_misused("--shard %s: expected at most 4294967295 parts", text);
    *index = i;
    *count = n;
    return -1;
}

/* Times of the table, for the runs. */
static double *row_times(const drift_scene *scene)
{
    const imk_drift_times *t = &scene->times;
    double *time = command_memory(NULL, t->row_count * sizeof *time);
    for (size_t k = 0; k < t->row_count; k++)
        time[k] = t->time[t->row[k]];
    return time;
}

static int keep_statistics(imk_drift_models *r, uint64_t runs, int degrees, const double *values)
{
    imk_error error;
    return imk_drift_models_take_runs(r, runs, degrees, values, &error) == IMK_OK
               ? -1
               : command_error(&error, NULL);
}

static int nees_degrees(const imk_drift_settings *settings)
{
    return settings->aid_count > 0 ? imk_drift_nees_degrees(settings) : 0;
}

static int run_campaign(const drift_options *o, imk_drift_models *r, crew *c,
                        imk_campaign *campaign)
{
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
        code = keep_statistics(r, runs, nees_degrees(&c->settings), values);
    free(values);
    for (size_t t = 0; t < c->threads; t++)
        free(c->memory[t]);
    free(c->memory);
    return code;
}

int drift_runs(const drift_options *o, const drift_scene *scene, imk_drift_models *r)
{
    crew c = {.one = &r->cases[r->case_count - 1], .seed = o->seed.value};
    double *time = row_times(scene);
    char *parameters = drift_parameters(scene, &c.one->settings, c.one->model);
    c.settings = c.one->settings;
    c.settings.time = time;
    c.settings.time_count = scene->times.row_count;
    c.size = imk_drift_runs_workspace_size(c.one->model, &c.settings);
    const int degrees = nees_degrees(&c.settings);
    imk_campaign campaign = {.version = imk_version(),
                             .parameters = parameters,
                             .seed = c.seed,
                             .run_count = o->monte_carlo.value,
                             .time_count = scene->times.row_count,
                             .time = time,
                             .state_count = degrees > 0 ? IMK_DRIFT_AIDED_STATES : IMK_DRIFT_STATES,
                             .state = state_names[c.settings.attitude_errors][degrees == 7],
                             .unit = state_units};
    const int code = run_campaign(o, r, &c, &campaign);
    free(time);
    free(parameters);
    return code;
}

/* ---- a results file ---- */

/* Are the states those of runs, with `degrees` of what is normalised? */
static bool has_states(const imk_campaign *c, imk_attitude_errors stated, int degrees)
{
    const size_t count = degrees > 0 ? IMK_DRIFT_AIDED_STATES : IMK_DRIFT_STATES;
    bool same = c->state_count == count;
    for (size_t i = 0; same && i < count; i++)
        same = strcmp(c->state[i], state_names[stated][degrees == 7][i]) == 0;
    return same;
}

static imk_attitude_errors stated_in(const imk_campaign *c)
{
    return strcmp(c->state[6], state_names[IMK_ATTITUDE_EARTH][0][6]) == 0 ? IMK_ATTITUDE_EARTH
                                                                           : IMK_ATTITUDE_LOCAL;
}

static int check_results(const imk_campaign_results *results, const char *path, int *degrees)
{
    const imk_campaign *c = &results->campaign;
    const bool wide = c->state_count >= IMK_DRIFT_STATES;
    const imk_attitude_errors stated = wide ? stated_in(c) : IMK_ATTITUDE_LOCAL;
    *degrees = has_states(c, stated, 9) ? 9 : has_states(c, stated, 7) ? 7 : 0;
    return results->runs > 0 && has_states(c, stated, *degrees)
               ? -1
               : command_failed("%s: the results of another kind of campaign, not of imukit drift",
                                path);
}

/* The times of the file alone, so that tables and figures of runs can be made. */
static imk_drift_times times_of_results(const imk_campaign *c)
{
    imk_drift_times times = {.count = c->time_count, .row_count = c->time_count};
    times.time = command_memory(NULL, times.count * sizeof *times.time);
    times.row = command_memory(NULL, times.count * sizeof *times.row);
    for (size_t k = 0; k < times.count; k++) {
        times.time[k] = c->time[k];
        times.row[k] = k;
    }
    return times;
}

static void show_inputs(const imk_campaign_results *file, const char *path, imk_result *result)
{
    const imk_campaign *c = &file->campaign;
    imk_result_object(result, "inputs");
    imk_result_text(result, "results", path);
    imk_result_text(result, "version", c->version);
    imk_result_count(result, "seed", (long long)c->seed);
    imk_result_count(result, "run_count", (long long)c->run_count);
    imk_result_count(result, "first", (long long)file->run[0]);
    imk_result_count(result, "runs", (long long)file->runs);
    imk_result_text(result, "attitude_errors",
                    stated_in(c) == IMK_ATTITUDE_EARTH ? "earth" : "local");
    (void)imk_result_json(result, "parameters", c->parameters);
    imk_result_end(result);
}

static int show(const imk_drift_models *r, const imk_campaign_results *file, const drift_options *o,
                const char *path)
{
    const imk_campaign *c = &file->campaign;
    const unsigned long long whole = c->run_count, there = file->runs, first = file->run[0];
    growing_list words = {0};
    const int code = o->output ? drift_write_csv(r, o->output) : -1;
    if (code >= 0)
        return code;
    imk_result *result = show_begin("drift");
    show_inputs(file, path, result);
    list_add(&words, "%s: %llu", path, there);
    if (there < whole)
        list_add(&words, " of %llu runs, from run %llu on", whole, first);
    else
        list_add(&words, " runs");
    list_add(&words, ", seed %llu, imukit %s.%s In brackets 95 %% intervals.",
             (unsigned long long)c->seed, c->version,
             stated_in(c) == IMK_ATTITUDE_EARTH
                 ? " The heading is that against Earth-fixed axes, not the displayed one."
                 : "");
    imk_show_drift_runs(r, words.text, result);
    list_free(&words);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (there < whole)
        imk_result_line(result, "\nThis is a part of the campaign. All parts together: imukit "
                                "merge PART.h5... -o WHOLE.h5");
    imk_result_for(result, IMK_FOR_PAGE);
    show_origin(result);
    return show_end(result, &(show_options){.report = o->report, .plot = o->plot, .json = o->json},
                    EXIT_DONE);
}

static int show_results(const drift_options *o, const char *path, const imk_campaign_results *file,
                        int degrees)
{
    imk_drift_models *r;
    imk_error error;
    imk_drift_models_settings settings = imk_drift_models_default();
    imk_drift_times times = times_of_results(&file->campaign);
    memset(&settings.drift, 0, sizeof settings.drift);
    int code = EXIT_FAILED;
    if (imk_drift_models_run(0, NULL, NULL, &times, &settings, NULL, &r, &error) == IMK_OK) {
        r->name[0] = path;
        code = keep_statistics(r, file->runs, degrees, file->values);
    } else {
        code = command_error(&error, NULL);
    }
    if (code < 0)
        code = show(r, file, o, path);
    imk_drift_models_free(r);
    imk_drift_times_free(&times);
    return code;
}

int drift_results(const drift_options *o, const char *path)
{
    imk_campaign_results *results;
    imk_error error;
    if (imk_campaign_load(path, &results, &error) != IMK_OK)
        return command_error(&error, path);
    int degrees;
    int code = check_results(results, path, &degrees);
    if (code < 0)
        code = show_results(o, path, results, degrees);
    imk_campaign_free(results);
    return code;
}
