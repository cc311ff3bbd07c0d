/* SPDX-License-Identifier: Apache-2.0 */
/* From the identified terms to a model file, and back to a log: the twin. */
#include "identify_parts.h"
#include "shell/model_changes.h"

#include "imukit/simulate.h"
#include "imukit/utf8.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triad and evidence of a kind of channel. */
static imk_triad *triad_of(imk_model *model, channel_kind kind)
{
    return kind == CHANNEL_GYRO ? &model->gyro : &model->accel;
}

static imk_evidence *evidence_of(imk_model *model, channel_kind kind)
{
    return kind == CHANNEL_GYRO ? &model->gyro_evidence : &model->accel_evidence;
}

double identify_duration(const identification *i)
{
    return i->duration > 0 ? i->duration : i->channels.dt * (double)i->channels.rows;
}

const char *identify_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void store_kind(const identification *i, channel_kind kind, imk_model *model)
{
    imk_triad *triad = triad_of(model, kind);
    imk_evidence *evidence = evidence_of(model, kind);
    int axes = 0;
    for (size_t c = 0; c < i->channels.count; c++) {
        const imk_log_column *column = log_channel_column(&i->channels, c);
        if (channel_kind_of(column) != kind)
            continue;
        /* A log of single axes keeps their directions. */
        for (int k = 0; k < 3; k++)
            triad->direction[axes][k] = k == column->axis % 3 ? 1 : 0;
        imk_identification_store(&i->result[c], model, kind == CHANNEL_ACCEL, axes++);
    }
    triad->present = axes > 0;
    if (axes == 0)
        return;
    triad->axis_count = axes;
    if (fabs(i->options->confidence - 0.95) > 1e-12)
        evidence->interval_count = 0; /* the file's intervals are of 95 % */
    imk_utf8_clean(identify_base_name(i->path), evidence->source, sizeof evidence->source);
    char length[60];
    format_duration(identify_duration(i), length, sizeof length);
    snprintf(evidence->method, sizeof evidence->method, "imukit %s identify: %s, %s at %.6g Hz",
             IMK_VERSION,
             i->options->method == METHOD_ALLAN || i->options->curve
                 ? "generalised least squares on Allan deviations"
                 : "maximum likelihood on the cosine spectrum",
             length, 1 / i->channels.dt);
}

void identify_noise_model(const identification *i, imk_model *model)
{
    imk_model_default(model);
    store_kind(i, CHANNEL_GYRO, model);
    store_kind(i, CHANNEL_ACCEL, model);
    identify_round_model(model);
    command_model_name(i->options->name, i->path, model->name, sizeof model->name);
}

/* Replace the noise, the output filter and the evidence of a triad, and nothing else. */
static int merge_kind(identification *i, channel_kind kind, imk_model *noise)
{
    imk_model *model = &i->model;
    imk_triad *from = triad_of(noise, kind), *to = triad_of(model, kind);
    if (!from->present)
        return -1;
    if (to->present && to->axis_count != from->axis_count)
        return command_failed("%s has %d %s axes, the log has %d: they cannot be matched",
                              i->options->into, to->axis_count, channel_kind_name(kind),
                              from->axis_count);
    if (!to->present)
        *to = *from;
    to->noise = from->noise;
    to->bandwidth = from->bandwidth;
    to->damping = from->damping;
    *evidence_of(model, kind) = *evidence_of(noise, kind);
    return -1;
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
    code = merge_kind(i, CHANNEL_GYRO, noise);
    if (code < 0)
        code = merge_kind(i, CHANNEL_ACCEL, noise);
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
    imk_model *noise = malloc(sizeof *noise);
    if (!noise)
        return command_failed("memory is exhausted");
    identify_noise_model(i, noise);
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

/* Which simulated column stands for a channel: gyros and accelerometers come in the same order. */
static imk_status twin_curves(identification *i, double *const *columns,
                              const imk_executor *executor)
{
    imk_allan_settings settings = imk_allan_default();
    size_t n = i->channels.rows, count = 0;
    size_t *factors = allan_factors_of_grid(IMK_ALLAN_OCTAVE, n, &count);
    imk_status status = factors ? IMK_OK : IMK_ERROR_MEMORY;
    settings.confidence = i->options->confidence;
    for (size_t c = 0; c < i->channels.count && status == IMK_OK; c++) {
        imk_allan_sums(n, columns[c], columns[c], NULL);
        status = allan_curve_compute(&settings, n, columns[c], i->channels.dt, count, factors,
                                     "Allan deviation of the twin", executor, &i->twin[c]);
    }
    free(factors);
    return status;
}

static imk_status simulate_twin(identification *i, const imk_model *noise,
                                const imk_executor *executor, imk_error *error)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = 1 / i->channels.dt;
    simulation.seed = i->options->seed.value;
    simulation.earth = false;
    size_t n = i->channels.rows, channels = i->channels.count;
    size_t size = imk_simulator_size(noise, &simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    double *columns[IMK_LOG_COLUMNS_MAX];
    double *data = malloc((n + 1) * channels * sizeof *data);
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, "twin", NULL, NULL);
    if (memory && data) {
        imk_simulator *simulator;
        for (size_t c = 0; c < channels; c++)
            columns[c] = data + c * (n + 1);
        status = imk_simulator_start(memory, size, noise, &simulation, &simulator, error);
        if (status == IMK_OK) {
            imk_simulator_next(simulator, n, columns, executor);
            status = twin_curves(i, columns, executor);
        }
    }
    free(memory);
    free(data);
    return status;
}

int identify_twin(identification *i, const imk_executor *executor)
{
    imk_error error;
    imk_model *noise = malloc(sizeof *noise);
    if (!noise)
        return command_failed("memory is exhausted");
    identify_noise_model(i, noise);
    imk_status status = IMK_OK;
    if (noise->gyro.present || noise->accel.present)
        status = simulate_twin(i, noise, executor, &error);
    free(noise);
    return status == IMK_OK ? -1 : command_error(&error, "the model's twin");
}
