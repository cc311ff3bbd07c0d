/* SPDX-License-Identifier: Apache-2.0 */
/* A log, or a table of Allan deviations, through the library's job. */
#include "identify_parts.h"

#include "shell/job_progress.h"

#include "imukit/identify_curve.h"

#include <string.h>

int identify_take_out(const identify_options *o, unsigned *take_out)
{
    static const struct {
        const char *name;
        unsigned bit;
    } parts[] = {{"outliers", IMK_SCREEN_OUTLIERS},       {"stuck", IMK_SCREEN_STUCK},
                 {"saturated", IMK_SCREEN_SATURATED},     {"warm-up", IMK_SCREEN_WARM_UP},
                 {"temperature", IMK_SCREEN_TEMPERATURE}, {"all", IMK_SCREEN_ALL}};
    enum { PARTS = sizeof parts / sizeof parts[0] };
    *take_out = IMK_SCREEN_ALL;
    for (const char *text = o->keep; text && *text;) {
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

static imk_status run_log(const identify_options *o, const imk_record_source *source,
                          const imk_job *job, imk_identify_log **log, imk_error *error)
{
    imk_identify_log_settings settings = imk_identify_log_default();
    settings.gaps = (imk_gap_policy)o->log.gaps;
    settings.confidence = o->confidence;
    settings.significance = o->significance;
    settings.from_allan = o->method == METHOD_ALLAN;
    settings.tolerance = o->tolerance;
    settings.gauss_markov_max = (int)o->gauss_markov.value;
    settings.summarise = o->runs;
    (void)identify_take_out(o, &settings.take_out);
    return imk_identify_log_run(source, &settings, job, log, error);
}

static imk_status run_curve(const identify_options *o, const imk_record_source *source,
                            const imk_job *job, imk_identify_log **log, imk_error *error)
{
    imk_identify_curve_settings settings = imk_identify_curve_default();
    settings.rate = o->log.rate;
    settings.duration = o->duration;
    settings.confidence = o->confidence;
    settings.significance = o->significance;
    settings.tolerance = o->tolerance;
    settings.gauss_markov_max = (int)o->gauss_markov.value;
    settings.plain = o->plain;
    return imk_identify_curve_run(source, &settings, job, log, error);
}

int identify_run(const identify_options *o, const char *path, const imk_executor *executor,
                 imk_identify_log **log)
{
    imk_log_reader *reader;
    imk_error error;
    const imk_findings none = {.count = 0};
    imk_log_settings reading = log_input_settings(&o->log);
    reading.any_columns = o->curve;
    reading.reopened = !o->curve;
    *log = NULL;
    if (imk_log_open(path, &reading, &reader, &error) != IMK_OK)
        return command_log_error(&error, path);
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, executor);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = o->curve ? run_curve(o, &source, &job, log, &error)
                                       : run_log(o, &source, &job, log, &error);
    job_progress_end(&shown);
    imk_log_close(reader);
    const imk_findings *findings = *log ? &(*log)->findings : &none;
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(findings) : NULL;
    if (!failure || strcmp(failure->code, "long_table") != 0)
        return log_input_tell(path, findings, status, &error);
    char text[400];
    imk_finding_text(failure, text, sizeof text);
    return command_failed("%s %s", path, text);
}
