/* SPDX-License-Identifier: Apache-2.0 */
/* imukit simulate: model -> log of a sensor at rest, written as it is made. */
#include "command.h"
#include "progress.h"

#include "imukit/model_file.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct simulate_options {
    double rate, duration, latitude, height, roll, pitch, yaw;
    uint64_t seed, run, decimals, threads;
    bool no_earth;
    const char *output, *gyro_unit, *accel_unit;
} simulate_options;

static const option simulate_option_table[] = {
    {"rate", 'r', OPTION_QUANTITY, "RATE", "Hz", NULL, "sample rate, such as 100Hz; required",
     offsetof(simulate_options, rate)},
    {"duration", 'd', OPTION_QUANTITY, "TIME", "s", NULL, "length, such as 2h; required",
     offsetof(simulate_options, duration)},
    {"output", 'o', OPTION_FILE, "LOG", NULL, NULL,
     "where to write: .csv (also .gz, .zst) or .npy; - (the default) is standard output",
     offsetof(simulate_options, output)},
    {"seed", 's', OPTION_INTEGER, "N", NULL, NULL,
     "the same seed makes the same bytes on every machine; default 1",
     offsetof(simulate_options, seed)},
    {"run", 0, OPTION_INTEGER, "N", NULL, NULL,
     "another run of the same sensor: other noise, other run-to-run biases; default 0",
     offsetof(simulate_options, run)},
    {"decimals", 0, OPTION_INTEGER, "N", NULL, NULL,
     "digits after the point, 0 to 17; default: as many as the number needs",
     offsetof(simulate_options, decimals)},
    {"gyro-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL, "of the gyro columns; default deg/s",
     offsetof(simulate_options, gyro_unit)},
    {"accel-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "of the accelerometer columns; default m/s^2", offsetof(simulate_options, accel_unit)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, NULL,
     "threads to use; default: all processors. The bytes do not depend on it",
     offsetof(simulate_options, threads)},
};

static const option place_option_table[] = {
    {"latitude", 0, OPTION_QUANTITY, "ANGLE", "deg", NULL, "geodetic; default 45deg",
     offsetof(simulate_options, latitude)},
    {"height", 0, OPTION_QUANTITY, "LENGTH", "m", NULL, "above the ellipsoid; default 0m",
     offsetof(simulate_options, height)},
    {"roll", 0, OPTION_QUANTITY, "ANGLE", "deg", NULL, "default 0deg: level",
     offsetof(simulate_options, roll)},
    {"pitch", 0, OPTION_QUANTITY, "ANGLE", "deg", NULL, "default 0deg: level",
     offsetof(simulate_options, pitch)},
    {"yaw", 0, OPTION_QUANTITY, "ANGLE", "deg", NULL, "from north to east; default 0deg",
     offsetof(simulate_options, yaw)},
    {"no-earth", 0, OPTION_FLAG, NULL, NULL, NULL, "without Earth rate and gravity",
     offsetof(simulate_options, no_earth)},
};

static int run(int count, char **words);

const verb simulate_verb = {
    .name = "simulate",
    .summary = "model -> log of a sensor at rest with all its errors",
    .operands = "MODEL",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit simulate AHRS --rate 100Hz --duration 1h --seed 1 -o static.csv",
                  "an hour of a unit of AHRS grade, level at 45 degrees north"},
                 {"imukit simulate model.yaml --rate 200Hz --duration 10min --no-earth -o - | head",
                  "a model file, errors alone, to standard output"}},
    .description =
        "MODEL is a model file or a name from `imukit devices`. The log has a time column and one "
        "column per axis; a model with a sensitivity makes counts. Axes are "
        "forward-right-down, so at rest and level accel_z is about -9.8 m/s^2.",
    .groups = {{"Options", sizeof simulate_option_table / sizeof simulate_option_table[0],
                simulate_option_table, 0},
               {"Place and attitude", sizeof place_option_table / sizeof place_option_table[0],
                place_option_table, 0}},
    .run = run};

/* Rows made and written at a time: long enough to share among threads, short enough for the
 * cache of a small machine. */
enum { BLOCK_ROWS = 65536 };

static const uint64_t decimals_shortest = UINT64_MAX;

static int parse_unit(const char *option_name, const char *text, const char *fallback,
                      imk_unit *unit)
{
    imk_error error;
    if (!text)
        text = fallback;
    if (imk_unit_parse(text, text + strlen(text), unit, &error) != IMK_OK)
        return command_misused("--%s %s: the unit is not known%s%s", option_name, text,
                               error.expected[0] ? "; " : "", error.expected);
    imk_dimension due = imk_unit_of(fallback).dimension;
    if (!imk_dimension_equal(unit->dimension, due))
        return command_misused("--%s %s: expected %s such as %s", option_name, text,
                               imk_dimension_name(due), imk_dimension_examples(due));
    return -1;
}

static void name_axis(imk_log_column *column, const char *sensor, int axis)
{
    static const char letters[] = "xyz";
    if (axis < 3)
        snprintf(column->name, sizeof column->name, "%s_%c", sensor, letters[axis]);
    else
        snprintf(column->name, sizeof column->name, "%s_%d", sensor, axis);
    column->axis = axis;
}

/* The body axis a sensor points along, or -1. */
static int body_axis(const double direction[3])
{
    for (int k = 0; k < 3; k++)
        if (direction[k] >= 1)
            return k;
    return -1;
}

/* Up to three sensors along body axes are called by them; others are numbered. */
static bool along_body_axes(const imk_triad *triad)
{
    bool taken[3] = {false};
    for (int axis = 0; axis < triad->axis_count; axis++) {
        int k = body_axis(triad->direction[axis]);
        if (k < 0 || taken[k])
            return false;
        taken[k] = true;
    }
    return true;
}

static size_t describe_triad(const imk_triad *triad, const char *sensor, imk_quantity quantity,
                             imk_unit unit, imk_log_column *columns)
{
    if (!triad->present)
        return 0;
    bool named = along_body_axes(triad);
    for (int axis = 0; axis < triad->axis_count; axis++) {
        columns[axis] = (imk_log_column){.quantity = quantity, .unit = unit};
        if (triad->sensitivity.value[axis] > 0)
            columns[axis].unit = imk_unit_of("count");
        name_axis(&columns[axis], sensor, named ? body_axis(triad->direction[axis]) : axis);
    }
    return (size_t)triad->axis_count;
}

/* Fewest decimals that hold every multiple of 1/rate, up to nine. */
static int time_decimals(double rate)
{
    double scale = 1;
    for (int decimals = 0; decimals < 9; decimals++, scale *= 10)
        if (scale / rate == floor(scale / rate))
            return decimals;
    return 9;
}

typedef struct recording {
    imk_simulator *simulator;
    imk_log_writer *writer;
    imk_executor executor;
    size_t columns; /* with time */
    double *block;  /* BLOCK_ROWS per column */
    double rate;
    uint64_t rows;
    const char *output;
} recording;

static int stream(recording *r)
{
    double *data[IMK_LOG_COLUMNS_MAX];
    for (size_t c = 0; c < r->columns; c++)
        data[c] = r->block + c * BLOCK_ROWS;
    imk_error error;
    progress p = progress_begin("simulating", "rows", 1);
    imk_status status = IMK_OK;
    for (uint64_t first = 0; first < r->rows && status == IMK_OK; first += BLOCK_ROWS) {
        size_t count = r->rows - first < BLOCK_ROWS ? (size_t)(r->rows - first) : BLOCK_ROWS;
        for (size_t k = 0; k < count; k++)
            data[0][k] = (double)(first + k) / r->rate;
        imk_simulator_next(r->simulator, count, data + 1, &r->executor);
        status = imk_log_write(r->writer, count, (const double *const *)data, &r->executor);
        progress_update(&p, first + count, r->rows);
    }
    progress_end(&p);
    /* A failed write is told by commit, which knows the system's reason. */
    if (imk_log_commit(r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return status == IMK_OK ? EXIT_DONE : command_failed("%s", imk_status_text(status));
}

static int create_log(const simulate_options *o, const imk_model *model, recording *r)
{
    imk_log_column columns[1 + 2 * IMK_AXES_MAX] = {
        {.name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")}};
    int decimals[1 + 2 * IMK_AXES_MAX];
    imk_unit gyro_unit, accel_unit;
    int code = parse_unit("gyro-unit", o->gyro_unit, "deg/s", &gyro_unit);
    if (code < 0)
        code = parse_unit("accel-unit", o->accel_unit, "m/s^2", &accel_unit);
    if (code >= 0)
        return code;
    size_t count = 1;
    count +=
        describe_triad(&model->gyro, "gyro", IMK_QUANTITY_ANGULAR_RATE, gyro_unit, columns + count);
    count += describe_triad(&model->accel, "accel", IMK_QUANTITY_SPECIFIC_FORCE, accel_unit,
                            columns + count);
    for (size_t c = 0; c < count; c++)
        decimals[c] = c == 0 ? time_decimals(o->rate) : (int)o->decimals;
    bool fixed = o->decimals != decimals_shortest;
    imk_error error;
    r->columns = count;
    if (imk_log_create(r->output, count, columns, fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST,
                       fixed ? decimals : NULL, r->rows, &r->writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

static imk_simulation simulation_of(const simulate_options *o)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = o->rate;
    simulation.seed = o->seed;
    simulation.run = (uint32_t)o->run;
    simulation.earth = !o->no_earth;
    simulation.latitude = isnan(o->latitude) ? simulation.latitude : o->latitude;
    simulation.height = o->height;
    simulation.roll = o->roll;
    simulation.pitch = o->pitch;
    simulation.yaw = o->yaw;
    return simulation;
}

static int simulate(const simulate_options *o, const imk_model *model, const char *name)
{
    imk_error error;
    imk_simulation simulation = simulation_of(o);
    recording r = {.rate = o->rate,
                   .rows = (uint64_t)llround(o->duration * o->rate),
                   .output = o->output ? o->output : "-"};
    size_t size = imk_simulator_size(model);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    r.block = malloc((1 + 2 * IMK_AXES_MAX) * BLOCK_ROWS * sizeof *r.block);
    int code = -1;
    if (!memory || !r.block)
        code = command_failed("memory is exhausted");
    else if (imk_simulator_start(memory, size, model, &simulation, &r.simulator, &error) != IMK_OK)
        code = command_error(&error, name);
    if (code < 0)
        code = create_log(o, model, &r);
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o->threads);
        r.executor = imk_thread_pool_executor(pool);
        code = stream(&r);
        imk_thread_pool_destroy(pool);
    }
    free(r.block);
    free(memory);
    return code;
}

static int check(const simulate_options *o)
{
    if (!(o->rate > 0))
        return command_misused(isnan(o->rate) ? "the sample rate is missing: add --rate 100Hz"
                                              : "--rate must be positive");
    if (!(o->duration > 0))
        return command_misused(isnan(o->duration) ? "the length is missing: add --duration 1h"
                                                  : "--duration must be positive");
    if (!(o->rate * o->duration >= 0.5 && o->rate * o->duration < 1e15))
        return command_misused("%g s at %g Hz is %.3g rows: expected 1 to 1e15", o->duration,
                               o->rate, o->rate * o->duration);
    if (o->decimals != decimals_shortest && o->decimals > 17)
        return command_misused("--decimals %llu: expected 0 to 17",
                               (unsigned long long)o->decimals);
    if (o->run > UINT32_MAX)
        return command_misused("--run %llu: expected at most %u", (unsigned long long)o->run,
                               UINT32_MAX);
    return -1;
}

static int run(int count, char **words)
{
    double missing = (double)NAN;
    simulate_options o = {.rate = missing,
                          .duration = missing,
                          .latitude = missing,
                          .seed = 1,
                          .decimals = decimals_shortest};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&simulate_verb, count, words, &o, operands);
    if (code < 0)
        code = check(&o);
    if (code >= 0)
        return code;
    imk_model *model = malloc(sizeof *model);
    if (!model)
        return command_failed("memory is exhausted");
    code = command_model(operands[0], model, NULL);
    if (code < 0)
        code = simulate(&o, model, operands[0]);
    free(model);
    return code;
}
