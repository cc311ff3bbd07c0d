/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify of several logs: each is identified alone, its samples let go, and all are
 * compared. */
#include "identify_several.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int identify_one_log(identification *i, const imk_identify_log_settings *settings,
                            const imk_executor *executor)
{
    const int code = identify_run(i, settings, executor);
    if (code < 0) {
        imk_identify_log_let_samples_go(i->found);
        identify_judge(i);
        identify_warn(i);
    }
    return code;
}

/* Base names, unless two are the same. */
static void label_logs(several_logs *s, const char *const *paths)
{
    bool same = false;
    for (size_t r = 0; r < s->count; r++)
        for (size_t q = 0; q < r; q++)
            same = same || strcmp(identify_base_name(paths[r]), identify_base_name(paths[q])) == 0;
    size_t used = 0;
    for (size_t r = 0; r < s->count; r++) {
        s->label[r] = same ? paths[r] : identify_base_name(paths[r]);
        if (used < sizeof s->path)
            used += (size_t)snprintf(s->path + used, sizeof s->path - used, "%s%s", r ? ", " : "",
                                     identify_base_name(paths[r]));
    }
}

static int check_channels(const several_logs *s, size_t record)
{
    const log_channels *first = &s->log[0]->found->record, *other = &s->log[record]->found->record;
    bool same = first->count == other->count;
    for (size_t c = 0; c < first->count && same; c++)
        same = strcmp(log_channel_column(first, c)->name, log_channel_column(other, c)->name) == 0;
    if (!same)
        return command_failed("%s and %s do not have the same channels (%zu from %s on, %zu from "
                              "%s on): only logs of the same columns can be compared",
                              s->label[0], s->label[record], first->count,
                              log_channel_column(first, 0)->name, other->count,
                              log_channel_column(other, 0)->name);
    if (s->options->runs && fabs(other->dt / first->dt - 1) > 1e-3)
        return command_failed("%s was sampled at %.6g Hz, %s at %.6g Hz: runs of one sensor have "
                              "one sample rate; identify them apart, or with --devices",
                              s->label[0], 1 / first->dt, s->label[record], 1 / other->dt);
    return -1;
}

static int load_logs(several_logs *s, const char *const *paths,
                     const imk_identify_log_settings *settings, const imk_executor *executor)
{
    for (size_t r = 0; r < s->count; r++) /* before the others have taken their time */
        if (strcmp(paths[r], "-") != 0 && access(paths[r], R_OK) != 0)
            return command_failed("%s cannot be read", paths[r]);
    for (size_t r = 0; r < s->count; r++) {
        identification *i = s->log[r] = calloc(1, sizeof *i);
        if (!i)
            return command_failed("memory is exhausted");
        i->options = s->options;
        i->path = paths[r];
        i->label = s->label[r];
        int code = identify_one_log(i, settings, executor);
        if (code < 0)
            code = check_channels(s, r);
        if (code >= 0)
            return code;
    }
    return -1;
}

/* The channels of the first log, the rows of the longest, the time of all. */
static int start_joint(several_logs *s, const imk_model *truth)
{
    identification *j = s->joint = calloc(1, sizeof *j);
    s->agreement = calloc(IMK_LOG_COLUMNS_MAX, sizeof *s->agreement);
    s->term = calloc(IMK_LOG_COLUMNS_MAX, sizeof *s->term);
    if (j)
        j->found = calloc(1, sizeof *j->found);
    if (!j || !j->found || !s->agreement || !s->term)
        return command_failed("memory is exhausted");
    j->found->settings = s->log[0]->found->settings;
    j->found->settings.summarise = false;
    j->options = s->options;
    j->path = s->path;
    j->joint = true;
    j->truth = *truth;
    for (size_t r = 0; r < s->count; r++) {
        const log_channels *channels = &s->log[r]->found->record;
        const size_t longest = j->found->record.rows;
        if (r == 0)
            j->found->record = *channels;
        j->found->record.rows = channels->rows > longest ? channels->rows : longest;
        j->found->duration += channels->dt * (double)channels->rows;
    }
    return -1;
}

static bool is_bad(const several_logs *s)
{
    for (size_t r = 0; r < s->count; r++)
        if (identify_is_bad(s->log[r]))
            return true;
    return identify_is_bad(s->joint);
}

static int present(several_logs *s, const imk_executor *executor)
{
    const identify_options *o = s->options;
    int code = -1;
    identify_warn(s->joint);
    if (o->runs && o->twin)
        code = identify_twin(s->joint, executor);
    if (code < 0 && o->runs)
        code = identify_write_model(s->joint);
    if (code < 0 && o->report)
        code = several_report(s, o->report);
    if (code >= 0)
        return code;
    code = o->strict && is_bad(s) ? EXIT_FAILED : EXIT_DONE;
    if (o->json)
        code = several_json(s, code);
    else if (!options_stdout_taken())
        several_print(s);
    const int drawn = o->plot ? identify_draw(s->joint, o->plot) : -1;
    return drawn < 0 ? code : drawn;
}

static int check_request(const identify_options *o)
{
    if (o->runs && o->method == METHOD_ALLAN)
        return command_misused("--method allan fits one log at a time; the joint estimate of "
                               "--runs is by likelihood");
    if (o->devices && (o->output || o->into || o->name || o->twin || o->plot || o->truth))
        return command_misused(
            "--devices compares sensors and makes no model: leave out %s, or identify each log "
            "alone",
            o->output ? "--output"
            : o->into ? "--into"
            : o->name ? "--name"
            : o->twin ? "--twin"
            : o->plot ? "--plot"
                      : "--truth");
    return -1;
}

int identify_several(const identify_options *options, size_t count, const char *const *paths,
                     const imk_identify_log_settings *settings, const imk_model *truth,
                     const imk_executor *executor)
{
    int code = check_request(options);
    if (code >= 0)
        return code;
    several_logs *s = calloc(1, sizeof *s);
    if (!s)
        return command_failed("memory is exhausted");
    s->options = options;
    s->count = count;
    label_logs(s, paths);
    code = load_logs(s, paths, settings, executor);
    if (code < 0)
        code = start_joint(s, truth);
    if (code < 0)
        code = options->runs ? several_join_runs(s) : several_compare_devices(s);
    if (code < 0)
        code = present(s, executor);
    for (size_t r = 0; r < count; r++) {
        if (s->log[r])
            identify_free(s->log[r]);
        free(s->log[r]);
    }
    if (s->joint) {
        identify_free(s->joint);
        free(s->joint);
    }
    free(s->agreement);
    free(s->term);
    free(s);
    return code;
}
