/* SPDX-License-Identifier: Apache-2.0 */
/* From the identified terms to a model file, and back to a log: the twin. */
#include "identify_parts.h"
#include "shell/job_progress.h"
#include "shell/model_changes.h"

#include "imukit/utf8.h"

#include <stdlib.h>
#include <string.h>

const char *identify_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* @return -1 or the exit code */
static int write_into(identification *i, const imk_model *noise)
{
    const identify_options *o = i->options;
    imk_error error;
    imk_document *document = NULL;
    int code = command_model(o->into, &i->model, &document);
    if (code >= 0)
        return code;
    imk_model *before = command_memory(NULL, sizeof *before);
    *before = i->model;
    if (imk_model_take_noise(&i->model, noise, &error) != IMK_OK) {
        code = command_failed("%s has %.0f %s axes, the log has %.0f: they cannot be matched",
                              o->into, error.value, error.field, error.limit);
    } else {
        if (o->name)
            imk_utf8_clean(o->name, i->model.name, sizeof i->model.name);
        model_print_changes(o->into, before, &i->model, document);
        if (o->output && imk_model_write(o->output, &i->model, document, &error) != IMK_OK)
            code = command_error(&error, NULL);
    }
    free(before);
    imk_document_free(document);
    return code;
}

/* Is a reading of a gyro or an accelerometer in counts? */
static bool has_counts(const imk_even_record *record)
{
    const imk_dimension count = imk_unit_of("count").dimension;
    for (size_t k = 0; k < record->count; k++) {
        const imk_log_column *column = &record->log.column[record->column[k]];
        if ((column->quantity == IMK_QUANTITY_ANGULAR_RATE ||
             column->quantity == IMK_QUANTITY_SPECIFIC_FORCE) &&
            imk_dimension_equal(column->unit.dimension, count))
            return true;
    }
    return false;
}

/* There is no model: of what is no sensor, and of counts that are no rates and forces. */
static int refuse_model(const identification *i)
{
    if (i->shown.log && has_counts(&i->shown.log->record))
        return command_failed_by(
            "counts", NULL, i->shown.name,
            "the readings of %s are counts, and a model needs rates and forces: "
            "state what a count is with --gyro-scale and --accel-scale, or the "
            "part with --device PART, --gyro-range and --accel-range",
            i->shown.name);
    return command_failed_by(
        "no_sensor_column", NULL, i->shown.name,
        "%s has no gyro or accelerometer column, so there is no model to write; "
        "name them with --columns, such as gyro_x",
        i->shown.name);
}

static int write_model(identification *i, const imk_model *noise)
{
    const identify_options *o = i->options;
    imk_error error;
    if (!noise->gyro.present && !noise->accel.present)
        return !o->output && !o->into ? -1 : refuse_model(i);
    if (o->into)
        return write_into(i, noise);
    i->model = *noise;
    if (o->output && imk_model_write(o->output, &i->model, NULL, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

static int make_twin(identification *i, const imk_model *noise, const imk_executor *executor)
{
    imk_error error;
    job_progress shown = job_progress_begin(i->shown.name);
    const imk_job job = job_progress_job(&shown, executor);
    const imk_status status =
        imk_identify_log_twin(i->shown.log, noise, i->options->seed.value, &job, i->twin, &error);
    job_progress_end(&shown);
    i->shown.twin = i->twin;
    return status == IMK_OK ? -1 : command_error(&error, "the model's twin");
}

int identify_make_model(identification *i, const imk_executor *executor)
{
    imk_model *noise = command_memory(NULL, sizeof *noise);
    imk_identify_log_model(i->shown.log, identify_base_name(i->shown.name), noise);
    command_model_name(i->options->name, i->shown.name, noise->name, sizeof noise->name);
    int code = -1;
    if (i->options->twin && (noise->gyro.present || noise->accel.present))
        code = make_twin(i, noise, executor);
    if (code < 0)
        code = write_model(i, noise);
    free(noise);
    return code;
}
