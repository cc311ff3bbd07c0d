/* SPDX-License-Identifier: Apache-2.0 */
/* One log through the library's job. */
#include "identify_parts.h"

#include "shell/job_progress.h"

#include <stdlib.h>
#include <string.h>

/* What --keep leaves of everything that can be taken out. @return -1 or the exit code */
static int parse_keep(const char *text, unsigned *take_out)
{
    static const struct {
        const char *name;
        unsigned bit;
    } parts[] = {{"outliers", IMK_SCREEN_OUTLIERS},       {"stuck", IMK_SCREEN_STUCK},
                 {"saturated", IMK_SCREEN_SATURATED},     {"warm-up", IMK_SCREEN_WARM_UP},
                 {"temperature", IMK_SCREEN_TEMPERATURE}, {"all", IMK_SCREEN_ALL}};
    enum { PARTS = sizeof parts / sizeof parts[0] };
    while (text && *text) {
        const size_t length = strcspn(text, ",");
        size_t k = 0;
        while (k < PARTS &&
               (strlen(parts[k].name) != length || strncmp(parts[k].name, text, length) != 0))
            k++;
        if (k == PARTS)
            return command_misused("--keep: \"%.*s\" is none of outliers, stuck, saturated, "
                                   "warm-up, temperature, all",
                                   (int)length, text);
        *take_out &= ~parts[k].bit;
        text += length + (text[length] == ',');
    }
    return -1;
}

int identify_settings(const identify_options *options, imk_identify_log_settings *settings)
{
    *settings = imk_identify_log_default();
    settings->gaps = (imk_gap_policy)options->log.gaps;
    settings->confidence = options->confidence;
    settings->significance = options->significance;
    settings->from_allan = options->method == METHOD_ALLAN;
    settings->tolerance = options->tolerance;
    settings->gauss_markov_max = (int)options->gauss_markov.value;
    settings->summarise = options->runs;
    return parse_keep(options->keep, &settings->take_out);
}

/* Notes of the job are part of the verdict; its warnings have been told. */
static void take_notes(identification *i)
{
    const imk_findings *findings = &i->found->findings;
    char text[900];
    for (size_t k = 0; k < findings->count; k++) {
        const imk_finding *f = &findings->item[k];
        if (f->level != IMK_FINDING_NOTE)
            continue;
        imk_finding_text(f, text, sizeof text);
        identify_add_sentence(i, VERDICT_NOTE, f->code, "%s", text);
    }
}

int identify_run(identification *i, const imk_identify_log_settings *settings,
                 const imk_executor *executor)
{
    imk_log_reader *reader;
    imk_error error;
    const imk_findings none = {.count = 0};
    int code = log_input_open(&i->options->log, i->path, true, &reader);
    if (code >= 0)
        return code;
    job_progress shown = job_progress_begin(i->path);
    const imk_job job = job_progress_job(&shown, executor);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = imk_identify_log_run(&source, settings, &job, &i->found, &error);
    job_progress_end(&shown);
    imk_log_close(reader);
    code = log_input_tell(i->path, i->found ? &i->found->findings : &none, status, &error);
    if (code < 0)
        take_notes(i);
    return code;
}

void identify_free(identification *i)
{
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        imk_allan_curve_free(&i->twin[c], &(imk_allocator){0});
    imk_identify_log_free(i->found);
}
