/* SPDX-License-Identifier: Apache-2.0 */
/* From the identified terms to a model, and back to a record: the twin. */
#include "identify_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"

#include "imukit/channel_units.h"
#include "imukit/readable.h"
#include "imukit/simulate.h"
#include "imukit/utf8.h"

#include <math.h>
#include <stdio.h>

static void store_kind(const imk_identify_log *log, imk_channel_kind kind, const char *source,
                       imk_model *model)
{
    const int sensor = kind == IMK_CHANNEL_ACCEL ? IMK_ACCEL : IMK_GYRO;
    imk_triad *triad = imk_model_triad_to_set(model, sensor);
    imk_evidence *evidence = sensor == IMK_GYRO ? &model->gyro_evidence : &model->accel_evidence;
    int axes = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_log_column *column = imk_even_record_column(&log->record, c);
        if (imk_channel_kind_of(column) != kind)
            continue;
        /* A record of single axes keeps their directions. */
        for (int k = 0; k < 3; k++)
            triad->direction[axes][k] = k == column->axis % 3 ? 1 : 0;
        imk_identification_store(&log->result[c], model, sensor, axes);
        if (log->readings)
            imk_reading_parts_store(&log->readings[c], model, sensor, axes);
        axes++;
    }
    triad->present = axes > 0;
    if (axes == 0)
        return;
    triad->axis_count = axes;
    if (fabs(log->settings.confidence - 0.95) > 1e-12)
        evidence->interval_count = 0; /* the file's intervals are of 95 % */
    imk_utf8_clean(source, evidence->source, sizeof evidence->source);
    char length[60];
    imk_readable_duration(log->duration, length, sizeof length);
    snprintf(evidence->method, sizeof evidence->method, "imukit %s identify: %s, %s at %.6g Hz%s",
             IMK_VERSION,
             log->settings.from_allan ? "generalised least squares on Allan deviations"
                                      : "maximum likelihood on the cosine spectrum",
             length, 1 / log->record.dt, log->readings ? "; readings at several rates" : "");
}

void imk_identify_log_model(const imk_identify_log *log, const char *source, imk_model *model)
{
    imk_model_default(model);
    store_kind(log, IMK_CHANNEL_GYRO, source, model);
    store_kind(log, IMK_CHANNEL_ACCEL, source, model);
    imki_round_model(model);
}

static bool axes_differ(const imk_triad *to, const imk_triad *from)
{
    return from->present && to->present && to->axis_count != from->axis_count;
}

static void take_triad(imk_triad *to, const imk_triad *from)
{
    if (!to->present)
        *to = *from;
    to->noise = from->noise;
    to->bandwidth = from->bandwidth;
    to->damping = from->damping;
}

imk_status imk_model_take_noise(imk_model *model, const imk_model *noise, imk_error *error)
{
    const bool gyros_differ = axes_differ(&model->gyro, &noise->gyro);
    if (gyros_differ || axes_differ(&model->accel, &noise->accel)) {
        return imki_refuse(error, IMK_ERROR_CONFLICT, gyros_differ ? "gyro" : "accel",
                           gyros_differ ? model->gyro.axis_count : model->accel.axis_count,
                           gyros_differ ? noise->gyro.axis_count : noise->accel.axis_count,
                           "the number of axes of the noise (the limit)");
    }
    if (noise->gyro.present) {
        take_triad(&model->gyro, &noise->gyro);
        model->gyro_evidence = noise->gyro_evidence;
    }
    if (noise->accel.present) {
        take_triad(&model->accel, &noise->accel);
        model->accel_evidence = noise->accel_evidence;
    }
    return IMK_OK;
}

/* Which simulated column stands for a channel: gyros and accelerometers come in the same order. */
static imk_status take_curves(const imk_identify_log *log, double *const *columns,
                              const imk_job *job, imk_allan_curve *curves)
{
    imk_allan_settings settings = imk_allan_default();
    const size_t n = log->record.rows;
    size_t count = 0;
    size_t *factors =
        imki_allan_factors(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_OCTAVE, n, &job->allocator, &count);
    imk_status status = factors ? IMK_OK : IMK_ERROR_MEMORY;
    settings.confidence = log->settings.confidence;
    for (size_t c = 0; c < log->record.count && status == IMK_OK; c++) {
        imk_allan_sums(n, columns[c], columns[c], NULL);
        status = imki_allan_curve_compute(&settings, n, columns[c], log->record.dt, count, factors,
                                          "Allan deviation of the twin", job, &curves[c]);
    }
    imki_resize(&job->allocator, factors, 0);
    return status;
}

imk_status imk_identify_log_twin(const imk_identify_log *log, const imk_model *noise, uint64_t seed,
                                 const imk_job *job, imk_allan_curve *curves, imk_error *error)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = 1 / log->record.dt;
    simulation.seed = seed;
    simulation.earth = false;
    const size_t n = log->record.rows, channels = log->record.count;
    const size_t size = imk_simulator_size(noise, &simulation);
    imki_arena scratch = {.allocator = job->allocator};
    void *memory = imki_arena_room(&scratch, size > 256 ? size : 256); /* 64-byte aligned */
    double *data = imki_arena_room(&scratch, (n + 1) * channels * sizeof *data);
    double *columns[IMK_LOG_COLUMNS_MAX];
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, "twin", NULL, NULL);
    imk_simulator *simulator;
    if (memory && data)
        status = imk_simulator_start(noise, &simulation, &simulator, memory, size, error);
    if (status == IMK_OK) {
        for (size_t c = 0; c < channels; c++)
            columns[c] = data + c * (n + 1);
        imk_simulator_next(simulator, n, columns, job->executor);
        status = take_curves(log, columns, job, curves);
        if (status != IMK_OK)
            imk_error_set(error, status, "twin", NULL, NULL);
    }
    imki_arena_free(&scratch);
    return status;
}
