/* SPDX-License-Identifier: Apache-2.0 */
/* imukit merge: the shards of a Monte Carlo campaign become one results file. */
#define _POSIX_C_SOURCE 200809L
#include "shell/growing_list.h"
#include "shell/show.h"

#include "imukit/campaign.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct merge_options {
    const char *output;
    bool partial, json;
} merge_options;

#define AT(field) offsetof(merge_options, field)

static const option merge_option_table[] = {
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "FILE",
     .help = "results file: .h5 or .csv (.csv.gz, .csv.zst)"},
    {"partial", OPTION_FLAG, AT(partial),
     .help = "write the existing runs although others are missing"},
    JSON_OPTION(AT(json), "print as JSON"),
};

/* More than a command line holds. */
enum { FILES_MAX = 1000000 };

static void warn_complaints(const imk_campaign_merge_report *report)
{
    for (size_t i = 0; i < report->complaint_count; i++) {
        char text[900];
        imk_error_text(&report->complaint[i].error, report->complaint[i].path, text, sizeof text);
        command_warn("file_left_out", "%s", text);
    }
}

/* Is there a file that could not be read, and may have runs that are missing? */
static bool has_unreadable(const imk_campaign_merge_report *r)
{
    for (size_t i = 0; i < r->complaint_count; i++)
        if (r->complaint[i].error.status == IMK_ERROR_OPEN &&
            (strcmp(r->complaint[i].path, "-") == 0 || access(r->complaint[i].path, F_OK) == 0))
            return true;
    return false;
}

/* What to do about the missing runs. */
static void describe_missing(const imk_campaign_merge_report *r, growing_list *text)
{
    list_add(text, "runs %s of %llu are missing", r->missing, (unsigned long long)r->run_count);
    if (has_unreadable(r))
        list_add(text,
                 "; they may be in a file that could not be read: merge again with readable files");
    else if (r->shard_count > 0 && r->shards[0])
        list_add(text,
                 "; compute again with --shard i/%llu for i = %s (Slurm: sbatch --array=%s), then "
                 "merge again",
                 (unsigned long long)r->shard_count, r->shards, r->shards);
}

/* Of what is not written only the data speaks: the error is told. */
static void judge(const char *output, const imk_campaign_merge_report *r, imk_result *result)
{
    const unsigned long long present = r->present, all = r->run_count;
    if (!output)
        imk_result_usability(
            result, IMK_NOT_USABLE,
            imk_result_key(result, "Not usable: %llu of %llu runs are there.", present, all));
    else if (r->missing[0])
        imk_result_judge(result, IMK_USABLE_WITH_CARE,
                         "Usable with care: runs %s of %llu are missing, %llu are there.",
                         r->missing, all, present);
    else
        imk_result_judge(result, IMK_USABLE, "Usable: all %llu runs are there.", all);
}

/* @param output  NULL: nothing was written */
static void show_data(const char *output, size_t count, const char *const *paths,
                      const imk_campaign_merge_report *r, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_array(result, "shards");
    for (size_t i = 0; i < count; i++)
        imk_result_text(result, NULL, paths[i]);
    imk_result_end(result);
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(output, r, result);
    imk_result_text(result, "output", output);
    imk_result_count(result, "run_count", (long long)r->run_count);
    imk_result_count(result, "runs", (long long)r->present);
    imk_result_text(result, "missing_runs", r->missing);
    imk_result_count(result, "shard_count", (long long)r->shard_count);
    imk_result_text(result, "missing_shards", r->shards);
    imk_result_array(result, "left_out");
    for (size_t i = 0; i < r->complaint_count; i++) {
        char text[900];
        imk_error_text(&r->complaint[i].error, NULL, text, sizeof text);
        imk_result_object(result, NULL);
        imk_result_text(result, "file", r->complaint[i].path);
        imk_result_text(result, "reason", text);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static int merge(const merge_options *o, size_t count, const char *const *paths,
                 imk_campaign_complaint *complaints)
{
    imk_campaign_merge_report report = {.complaint = complaints};
    imk_error error;
    growing_list missing = {0};
    int code = EXIT_DONE;
    const imk_status status =
        imk_campaign_merge(count, paths, o->output, o->partial, &report, &error);
    warn_complaints(&report);
    describe_missing(&report, &missing);
    if (status == IMK_ERROR_CONFLICT && report.missing[0])
        code = command_failed_by("runs_missing", &error, NULL,
                                 "%s (--partial merges the existing runs)", missing.text);
    else if (status != IMK_OK)
        code = command_error(&error, NULL);
    else if (report.missing[0])
        command_warn("runs_missing", "%s", missing.text);
    list_free(&missing);
    imk_result *result = show_begin("merge");
    show_data(code == EXIT_DONE ? o->output : NULL, count, paths, &report, result);
    if (code == EXIT_DONE)
        imk_result_line(result, "%s: %llu of %llu runs from %zu of %zu files", o->output,
                        (unsigned long long)report.present, (unsigned long long)report.run_count,
                        count - report.complaint_count, count);
    return show_end(result, &(show_options){.json = o->json}, code);
}

static int run(int count, char **words)
{
    merge_options o = {0};
    const char **paths = command_zeroed(FILES_MAX * sizeof *paths);
    int code = options_parse(&merge_verb, count, words, &o, paths);
    if (code < 0 && !o.output)
        code = command_misused("-o FILE is missing: the results file to write");
    size_t files = 0;
    while (files < FILES_MAX && paths[files])
        files++;
    if (code < 0) {
        imk_campaign_complaint *complaints = command_zeroed((files + 1) * sizeof *complaints);
        code = merge(&o, files, paths, complaints);
        free(complaints);
    }
    free(paths);
    return code;
}

const verb merge_verb = {
    .name = "merge",
    .summary = "shards of a Monte Carlo campaign into one results file",
    .operands = "SHARD...",
    .operands_minimum = 1,
    .operands_maximum = FILES_MAX,
    .examples = {{"imukit merge shard-*.h5 -o all.h5",
                  "the same file, byte for byte, as of a campaign computed in one piece"},
                 {"imukit merge shard-*.h5 -o some.h5 --partial",
                  "the existing runs, with their numbers; the others can be merged later"}},
    .description = "SHARD is a results file of imukit drift --monte-carlo … --shard i/N, or of an "
                   "earlier merge. The order does not matter.\n\nA file that is damaged, or of "
                   "another campaign, seed or version than most, is reported and left out. If runs "
                   "are then missing, nothing is written, and the shards to compute again are "
                   "listed; --partial writes the existing runs.\n\ndocs/clusters.md shows "
                   "campaigns on many machines, docs/campaign-file.md the format.",
    .groups = {OPTION_GROUP("Options", merge_option_table, 0)},
    .run = run};
