/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit allan`, `spectrum` and `identify` do, as functions: a log in, text and JSON out.
 *
 *     example_log_jobs log.csv */
#include "imukit/io.h"
#include "imukit/jobs.h"

#include <stdio.h>
#include <stdlib.h>

typedef imk_status (*job)(const imk_record_source *source, imk_result *result, imk_error *error);

static imk_status allan(const imk_record_source *source, imk_result *result, imk_error *error)
{
    const imk_allan_log_settings settings = imk_allan_log_default();
    imk_allan_log *found;
    const imk_status status = imk_allan_log_run(source, &settings, NULL, &found, error);
    if (status == IMK_OK)
        imk_show_allan_log(found, "the log", result);
    imk_allan_log_free(found);
    return status;
}

static imk_status spectrum(const imk_record_source *source, imk_result *result, imk_error *error)
{
    const imk_spectrum_log_settings settings = imk_spectrum_log_default();
    imk_spectrum_log *found;
    const imk_status status = imk_spectrum_log_run(source, &settings, NULL, &found, error);
    if (status == IMK_OK)
        imk_show_spectrum_log(found, "the log", result);
    imk_spectrum_log_free(found);
    return status;
}

static imk_status identify(const imk_record_source *source, imk_result *result, imk_error *error)
{
    const imk_identify_log_settings settings = imk_identify_log_default();
    imk_identify_log *found;
    const imk_status status = imk_identify_log_run(source, &settings, NULL, &found, error);
    for (size_t c = 0; status == IMK_OK && c < found->record.count; c++)
        imk_result_line(result, "%s: white noise %.3g +- %.1g (SI)",
                        imk_even_record_column(&found->record, c)->name,
                        found->result[c].term[IMK_NOISE_WHITE].value,
                        found->result[c].term[IMK_NOISE_WHITE].sigma);
    imk_identify_log_free(found);
    return status;
}

/* Open the log, do the job, print its text. */
static int run(job of, const char *path)
{
    imk_error error;
    imk_log_reader *reader;
    char *text = NULL, reason[512];
    size_t size;
    imk_result *result = imk_result_create(NULL);
    imk_status status = imk_log_open(path, NULL, &reader, &error);
    if (status == IMK_OK) {
        const imk_record_source source = imk_log_source(reader);
        status = of(&source, result, &error);
        imk_log_close(reader);
    }
    if (status == IMK_OK && imk_result_to_text(result, NULL, NULL, &text, &size) == IMK_OK)
        fputs(text, stdout);
    if (status != IMK_OK && imk_error_text(&error, path, reason, sizeof reason) > 0)
        fprintf(stderr, "%s\n", reason);
    free(text);
    imk_result_free(result);
    return status == IMK_OK ? 0 : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    const job jobs[] = {allan, spectrum, identify};
    int failed = argc == 2 ? 0 : 2;
    for (size_t k = 0; k < 3 && failed == 0; k++)
        failed = run(jobs[k], argv[1]);
    return failed;
}
