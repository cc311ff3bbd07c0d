/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify of several logs: each is identified alone and its samples are freed; then all are
 * compared. */
#include "identify_parts.h"
#include "shell/growing_list.h"
#include "shell/job_progress.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct several_logs {
    const identify_options *options;
    size_t count;
    imk_identify_log *log[IMK_JOINT_RECORDS_MAX];
    imk_identify_shown shown[IMK_JOINT_RECORDS_MAX];
    const char *label[IMK_JOINT_RECORDS_MAX]; /* the names without folders, if all differ */
} several_logs;

static int check_request(const identify_options *o)
{
    if (o->runs && o->method == METHOD_ALLAN)
        return command_misused("--method allan fits one log at a time; the joint estimate of "
                               "--runs needs --method likelihood");
    if (o->devices && (o->output || o->into || o->name || o->twin || o->truth))
        return command_misused(
            "--devices compares sensors and makes no model: leave out %s, or identify each log "
            "alone",
            o->output ? "--output"
            : o->into ? "--into"
            : o->name ? "--name"
            : o->twin ? "--twin"
                      : "--truth");
    return -1;
}

/* @param all  the names of all in one */
static void label_logs(several_logs *s, const char *const *paths, growing_list *all)
{
    bool same = false;
    for (size_t r = 0; r < s->count; r++) {
        list_add_item(all, "%s", identify_base_name(paths[r]));
        for (size_t q = 0; q < r; q++)
            same = same || strcmp(identify_base_name(paths[r]), identify_base_name(paths[q])) == 0;
    }
    for (size_t r = 0; r < s->count; r++) {
        s->label[r] = s->shown[r].label = same ? paths[r] : identify_base_name(paths[r]);
        s->shown[r].name = paths[r];
    }
}

/* Runs at several rates are compared for the errors of their readings alone. @return the exit code
 */
static int refuse_rates(const several_logs *s, size_t record)
{
    const imk_even_record *first = &s->log[0]->record, *other = &s->log[record]->record;
    return command_failed_by("rates_differ", NULL, s->label[record],
                             "%s was sampled at %.6g Hz, %s at %.6g Hz: runs of one sensor have "
                             "one sampling rate; identify them separately, or with --devices",
                             s->label[0], 1 / first->dt, s->label[record], 1 / other->dt);
}

/* A copy is no evidence. @return the exit code */
static int refuse_copy(const several_logs *s, size_t record, size_t of)
{
    return command_failed_by("same_readings", NULL, s->label[record],
                             "%s holds the readings of %s again: they would count as those of two "
                             "logs; leave one of the two out",
                             s->label[record], s->label[of]);
}

/* Why two logs cannot be compared. @return -1 or the exit code */
static int check_channels(const several_logs *s, size_t record)
{
    const imk_even_record *first = &s->log[0]->record, *other = &s->log[record]->record;
    if (imk_identify_comparable(s->log[0], s->log[record], false, NULL) == IMK_OK)
        return -1;
    return command_failed_by("column", NULL, s->label[record],
                             "%s and %s do not have the same channels (%zu from %s on, %zu from %s "
                             "on): only logs with the same columns can be compared",
                             s->label[0], s->label[record], first->count,
                             imk_even_record_column(first, 0)->name, other->count,
                             imk_even_record_column(other, 0)->name);
}

static int identify_each(several_logs *s, const imk_executor *executor, imk_result *result)
{
    for (size_t r = 0; r < s->count; r++) /* before the others have taken their time */
        if (strcmp(s->shown[r].name, "-") != 0 && access(s->shown[r].name, R_OK) != 0)
            return command_failed("%s cannot be read", s->shown[r].name);
    int code = -1;
    for (size_t r = 0; r < s->count && code < 0; r++) {
        imk_identify_shown *shown = &s->shown[r];
        code = identify_run(s->options, shown->name, executor, &s->log[r]);
        if (code >= 0)
            break;
        imk_identify_log_let_samples_go(s->log[r]);
        shown->log = s->log[r];
        shown->verdict = imk_identify_verdict(s->log[r], shown->label, result);
        identify_warn(s->options, &shown->verdict);
        code = check_channels(s, r);
    }
    return code;
}

static int compare(several_logs *s, identification *joint, const imk_executor *executor,
                   imk_result *result)
{
    imk_identify_several *several;
    imk_error error;
    const imk_identify_log *const *logs = (const imk_identify_log *const *)s->log;
    const imk_status status = s->options->runs
                                  ? imk_identify_runs(s->count, logs, NULL, &several, &error)
                                  : imk_identify_devices(s->count, logs, NULL, &several, &error);
    if (command_unless_memory(status) != IMK_OK) {
        imk_result_free(result);
        if (strcmp(error.field, "rate") == 0)
            return refuse_rates(s, (size_t)error.index);
        if (strcmp(error.field, "readings") == 0)
            return refuse_copy(s, (size_t)error.index, (size_t)error.value);
        return command_error(&error, joint->shown.name);
    }
    joint->shown.log = &several->joint;
    joint->shown.verdict = imk_several_verdict(several, s->label, result);
    identify_warn(s->options, &joint->shown.verdict);
    bool warns = imk_verdict_warns(&joint->shown.verdict);
    for (size_t r = 0; r < s->count; r++)
        warns = warns || imk_verdict_warns(&s->shown[r].verdict);
    int code = several->runs ? identify_make_model(joint, executor) : -1;
    if (code < 0) {
        imk_show_identify_several(several, &joint->shown, s->shown, result);
        imk_result_for(result, IMK_FOR_PAGE);
        show_origin(result);
        code = identify_end(joint, result, warns);
    } else {
        imk_result_free(result);
    }
    imk_identify_several_free(several);
    return code;
}

int identify_several(identification *joint, size_t count, const char *const *paths,
                     const imk_executor *executor)
{
    int code = check_request(joint->options);
    if (code >= 0)
        return code;
    growing_list all = {0};
    several_logs *s = command_zeroed(sizeof *s);
    imk_result *result = show_begin("identify");
    s->options = joint->options;
    s->count = count;
    label_logs(s, paths, &all);
    joint->shown.name = all.text;
    code = identify_each(s, executor, result);
    if (code < 0)
        code = compare(s, joint, executor, result);
    else
        imk_result_free(result);
    for (size_t r = 0; r < count; r++)
        imk_identify_log_free(s->log[r]);
    list_free(&all);
    free(s);
    return code;
}
