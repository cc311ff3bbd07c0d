/* SPDX-License-Identifier: Apache-2.0 */
/* One run into one log, written as it is made. */
#include "shell/progress.h"
#include "simulate_parts.h"

#include <stdlib.h>

/* Rows made and written at a time: long enough to share among threads, short enough for the
 * cache of a small machine. */
enum { BLOCK_ROWS = 65536 };

typedef struct recording {
    const scene *scene;
    const log_layout *layout;
    imk_simulator *simulator;
    imk_log_writer *writer;
    const imk_executor *executor;
    bool drops;
    double *column[SIMULATE_COLUMNS_MAX]; /* BLOCK_ROWS each */
} recording;

/* Take out the rows that are lost. @return how many stay */
static size_t drop_rows(recording *r, uint64_t first, size_t count)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        if (imk_simulator_dropped(r->simulator, first + k))
            continue;
        for (size_t c = 0; c < r->layout->count; c++)
            r->column[c][kept] = r->column[c][k];
        kept++;
    }
    return kept;
}

static imk_status write_rows(recording *r, uint64_t first, size_t count)
{
    const log_layout *layout = r->layout;
    double *time = r->column[0];
    for (size_t k = 0; k < count; k++)
        time[k] = (double)(first + k) / r->scene->simulation.rate;
    if (layout->temperature)
        imk_temperature_at(r->scene->simulation.temperature, count, time,
                           r->column[1 + layout->channels], NULL);
    for (size_t k = 0; k < count && r->scene->start != 0; k++)
        time[k] += r->scene->start;
    imk_simulator_next(r->simulator, count, r->column + 1, r->executor);
    for (size_t c = 1; c <= layout->channels; c++)
        if (layout->factor[c] != 1)
            for (size_t k = 0; k < count; k++)
                r->column[c][k] *= layout->factor[c];
    if (r->drops)
        count = drop_rows(r, first, count);
    return imk_log_write(r->writer, count, (const double *const *)r->column, r->executor);
}

/* Vibration makes rows so slow to compute that fewer at a time keep the progress going. */
static size_t rows_at_once(const imk_simulation *simulation)
{
    const imk_trajectory *trajectory = simulation->motion.trajectory;
    size_t parts = trajectory ? imk_trajectory_substeps(trajectory, 1 / simulation->rate) : 1;
    return parts < BLOCK_ROWS / 1024 ? BLOCK_ROWS / parts : 1024;
}

static int stream(recording *r, const char *label)
{
    imk_error error;
    progress p = progress_begin(label, "rows", 1);
    imk_status status = IMK_OK;
    const uint64_t rows = r->scene->rows;
    const size_t step = rows_at_once(&r->scene->simulation);
    for (uint64_t first = 0; first < rows && status == IMK_OK; first += step) {
        size_t count = rows - first < step ? (size_t)(rows - first) : step;
        status = write_rows(r, first, count);
        progress_update(&p, first + count, rows);
    }
    progress_end(&p);
    /* A failed write is told by commit, which knows the system's reason. */
    if (imk_log_commit(r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return status == IMK_OK ? EXIT_DONE : command_failed("%s", imk_status_text(status));
}

static int create(const simulate_options *o, recording *r, const char *path)
{
    imk_error error;
    bool fixed = o->decimals.given;
    if (imk_log_create(path, r->layout->count, r->layout->column,
                       fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST, fixed ? r->layout->decimals : NULL,
                       r->drops ? 0 : r->scene->rows, &r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

int simulate_log(const simulate_options *o, const imk_model *model, const scene *s,
                 const log_layout *layout, const imk_executor *executor, const log_target *target)
{
    imk_error error;
    recording r = {
        .scene = s, .layout = layout, .executor = executor, .drops = model->timing.drops.value > 0};
    const size_t size = imk_simulator_size(model, &s->simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    double *block = malloc(layout->count * BLOCK_ROWS * sizeof *block);
    int code = -1;
    for (size_t c = 0; block && c < layout->count; c++)
        r.column[c] = block + c * BLOCK_ROWS;
    if (!memory || !block)
        code = command_failed("memory is exhausted");
    else if (imk_simulator_start(memory, size, model, &s->simulation, &r.simulator, &error) !=
             IMK_OK)
        code = command_error(&error, NULL);
    if (code < 0)
        code = create(o, &r, target->path);
    if (code < 0)
        code = stream(&r, target->label);
    free(block);
    free(memory);
    return code;
}
