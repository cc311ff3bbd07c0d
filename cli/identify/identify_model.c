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

/* Noise model of the log under the name it is to have. */
static imk_model *noise_model(const identification *i)
{
    imk_model *noise = command_memory(NULL, sizeof *noise);
    imk_identify_log_model(i->found, identify_base_name(i->path), noise);
    command_model_name(i->options->name, i->path, noise->name, sizeof noise->name);
    return noise;
}

static int take_noise(identification *i, const imk_model *noise)
{
    imk_error error;
    if (imk_model_take_noise(&i->model, noise, &error) == IMK_OK)
        return -1;
    return command_failed("%s has %.0f %s axes, the log has %.0f: they cannot be matched",
                          i->options->into, error.value, error.field, error.limit);
}

static int write_into(identification *i, imk_model *noise)
{
    imk_error error;
    imk_document *document = NULL;
    int code = command_model(i->options->into, &i->model, &document);
    if (code >= 0)
        return code;
    imk_model *before = command_memory(NULL, sizeof *before);
    *before = i->model;
    code = take_noise(i, noise);
    if (code < 0 && i->options->name)
        imk_utf8_clean(i->options->name, i->model.name, sizeof i->model.name);
    if (code < 0)
        model_print_changes(i->options->into, before, &i->model, document);
    if (code < 0 && i->options->output &&
        imk_model_write(i->options->output, &i->model, document, &error) != IMK_OK)
        code = command_error(&error, NULL);
    free(before);
    imk_document_free(document);
    return code;
}

int identify_write_model(identification *i)
{
    imk_error error;
    imk_model *noise = noise_model(i);
    int code = -1;
    if (!noise->gyro.present && !noise->accel.present) {
        if (i->options->output || i->options->into)
            code = command_failed("%s has no gyro or accelerometer column, so there is no model to "
                                  "write; name them with --columns, such as gyro_x",
                                  i->path);
    } else if (i->options->into) {
        code = write_into(i, noise);
    } else {
        i->model = *noise;
        if (i->options->output &&
            imk_model_write(i->options->output, &i->model, NULL, &error) != IMK_OK)
            code = command_error(&error, NULL);
    }
    free(noise);
    return code;
}

int identify_twin(identification *i, const imk_executor *executor)
{
    imk_error error;
    imk_model *noise = noise_model(i);
    job_progress shown = job_progress_begin(i->path);
    const imk_job job = job_progress_job(&shown, executor);
    imk_status status = IMK_OK;
    if (noise->gyro.present || noise->accel.present)
        status =
            imk_identify_log_twin(i->found, noise, i->options->seed.value, &job, i->twin, &error);
    job_progress_end(&shown);
    free(noise);
    return status == IMK_OK ? -1 : command_error(&error, "the model's twin");
}
