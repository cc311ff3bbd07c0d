/* SPDX-License-Identifier: Apache-2.0 */
/* Motion files: the public functions. */
#include "imukit/motion_file.h"

#include "io/file/text_file_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "motion_file_internal.h"

#include <stdlib.h>
#include <string.h>

static imk_status finish(imk_status status, imk_motion_file *made, imk_motion_file **file)
{
    if (status == IMK_OK)
        *file = made;
    else
        imk_motion_file_free(made);
    return status;
}

static imk_status make(imk_motion_file **made, imk_error *error)
{
    *made = calloc(1, sizeof **made);
    return *made ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
}

static imk_status keep_text(imk_motion_file *file, const char *text, size_t size, imk_error *error)
{
    file->text = malloc(size + 1);
    if (!file->text)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    memcpy(file->text, text, size);
    file->text[size] = '\0';
    return IMK_OK;
}

imk_status imk_motion_parse(const char *text, size_t size, const imk_geodetic *place, uint64_t seed,
                            imk_motion_file **file, imk_error *error)
{
    imk_document *document = NULL;
    imk_motion_file *made = NULL;
    imk_status status = make(&made, error);
    if (status == IMK_OK)
        status = imki_document_parse_as("motion", "imukit_motion: 1", text, size, &document, error);
    if (status == IMK_OK)
        status = imki_motion_script_open(document, place, seed, made, error);
    if (status == IMK_OK)
        status = keep_text(made, text, size, error);
    imk_document_free(document);
    return finish(status, made, file);
}

imk_status imk_motion_read(const char *path, const imk_log_settings *settings,
                           const imk_geodetic *place, uint64_t seed, imk_motion_file **file,
                           imk_error *error)
{
    if (!imki_is_script(path, "imukit_motion")) {
        const imk_log_settings from_header = imk_log_default();
        imk_motion_file *made = NULL;
        settings = settings ? settings : &from_header;
        imk_status status = make(&made, error);
        if (status == IMK_OK)
            status = imk_log_load(path, settings, NULL, &made->log, error);
        if (status == IMK_OK)
            status = imki_motion_table_take(settings->rate, place, made, error);
        return finish(status, made, file);
    }
    char *text = NULL;
    size_t size = 0;
    imk_status status = imki_text_file_read(path, IMKI_DOCUMENT_SIZE_MAX, &text, &size, error);
    if (status == IMK_OK)
        status = imk_motion_parse(text, size, place, seed, file, error);
    free(text);
    return status;
}

imk_status imk_motion_of_record(const imk_record_source *source, const imk_geodetic *place,
                                imk_motion_file **file, imk_error *error)
{
    imk_motion_file *made = NULL;
    imk_status status = make(&made, error);
    if (status == IMK_OK)
        status = imki_record_load(source, imki_job_of(NULL), &made->log, error);
    if (status == IMK_OK)
        status = imki_motion_table_take(source->rate, place, made, error);
    return finish(status, made, file);
}

void imk_motion_file_free(imk_motion_file *file)
{
    if (!file)
        return;
    imk_log_free(&file->log);
    free(file->piece);
    free(file->line);
    free(file->text);
    free(file);
}

imk_motion_kind imk_motion_file_kind(const imk_motion_file *file)
{
    return file->kind;
}

const imk_motion *imk_motion_file_motion(const imk_motion_file *file)
{
    return &file->motion;
}

double imk_motion_file_duration(const imk_motion_file *file)
{
    return file->duration;
}

const char *imk_motion_file_name(const imk_motion_file *file)
{
    return file->name;
}

const char *imk_motion_file_text(const imk_motion_file *file)
{
    return file->text;
}

const char *imk_motion_file_note(const imk_motion_file *file)
{
    return file->note;
}
