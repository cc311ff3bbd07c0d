/* SPDX-License-Identifier: Apache-2.0 */
/* A log, or a table of Allan deviations, through the library's job. */
#include "identify_parts.h"

#include "shell/job_progress.h"

#include "imukit/identify_curve.h"

#include <math.h>
#include <string.h>

static imk_status run_log(const identify_options *o, const imk_record_source *source,
                          const imk_job *job, imk_identify_log **log, imk_error *error)
{
    imk_identify_log_settings settings = imk_identify_log_default();
    settings.gaps = (imk_gap_policy)o->log.gaps;
    settings.confidence = o->confidence;
    settings.significance = o->significance;
    settings.from_allan = o->method == METHOD_ALLAN;
    settings.tolerance = isnan(o->tolerance) ? 0 : o->tolerance;
    settings.gauss_markov_max = (int)o->gauss_markov.value;
    settings.summarise = o->runs;
    settings.take_out = o->take_out;
    return imk_identify_log_run(source, &settings, job, log, error);
}

static imk_status run_curve(const identify_options *o, const imk_record_source *source,
                            const imk_job *job, imk_identify_log **log, imk_error *error)
{
    imk_identify_curve_settings settings = imk_identify_curve_default();
    settings.rate = o->log.file.rate;
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
    return command_failed_by(imk_finding_code(failure), &error, path, "%s %s", path, text);
}
