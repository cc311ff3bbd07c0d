/* SPDX-License-Identifier: Apache-2.0 */
/* What a source of rows is: a table of references and readings, a record of a test, or one at rest.
 */
#include "evaluate_job_internal.h"

#include "jobs/record/even_record_internal.h"

static imk_status add_table(imk_evaluate_log *evaluation, const imk_record_source *source,
                            const imk_job *job, imk_error *error)
{
    imk_log table;
    imk_status status = imki_record_load(source, job, &table, error);
    if (status != IMK_OK)
        return status;
    status = imk_evaluate_table(evaluation, &table, error);
    imk_log_free(&table);
    return status;
}

/* The findings of the record become those of the evaluation. */
static void take_findings(imk_evaluate_log *evaluation, const imk_findings *loaded)
{
    imk_findings *all = &evaluation->findings;
    for (size_t k = 0; k < loaded->count && all->count < IMK_FINDINGS_MAX; k++)
        all->item[all->count++] = loaded->item[k];
}

imk_status imk_evaluate_source(imk_evaluate_log *evaluation, const char *name,
                               const imk_record_source *source,
                               const imk_calibrate_log_settings *settings, const imk_job *job,
                               imk_error *error)
{
    job = imki_job_of(job);
    if (imk_evaluate_is_table(source->column_count, source->columns))
        return add_table(evaluation, source, job, error);
    imki_arena scratch = {.allocator = job->allocator};
    imk_calibrate_record *record = imki_arena_take(&scratch, sizeof *record);
    if (!record)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status = imk_calibrate_record_load(settings, name, source, job, record, error);
    take_findings(evaluation, &record->loaded);
    if (status == IMK_OK)
        status = imk_evaluate_record(evaluation, record, error);
    imk_calibrate_record_free(record);
    imki_arena_free(&scratch);
    return status;
}

imk_status imk_evaluate_check_used(const imk_evaluate_log *evaluation,
                                   const imk_calibrate_log_settings *settings, imk_error *error)
{
    const struct {
        const char *field;
        bool given;
    } of_records[] = {{"motion", settings->motion != NULL},
                      {"motion_offset", settings->find_offset || settings->motion_offset != 0},
                      {"table_axis", settings->table_axis >= 0},
                      {"section", settings->section != NULL}};
    for (size_t k = 0; evaluation->record_count == 0 && k < sizeof of_records / sizeof *of_records;
         k++)
        if (of_records[k].given)
            return imk_error_set(error, IMK_ERROR_CONFLICT, of_records[k].field,
                                 "is for logs, and all files are tables", "leave it out");
    return IMK_OK;
}

imk_status imk_evaluate_rest_source(imk_evaluate_log *evaluation, const imk_record_source *source,
                                    imk_gap_policy gaps, const imk_job *job, imk_error *error)
{
    imk_even_record record = {.rows = 0};
    imk_status status =
        imk_even_record_load(source, gaps, job, &record, &evaluation->findings, error);
    if (status == IMK_OK)
        status = imk_evaluate_at_rest(evaluation, &record, error);
    imk_even_record_free(&record);
    return status;
}
