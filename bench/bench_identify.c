/* SPDX-License-Identifier: Apache-2.0 */
/* From a .npy of 1e7 rows and six channels to a model: the command as a whole process on two
 * threads, its time and peak memory, against the same estimator on the transform of the whole
 * record (loaded, a channel to a thread), and against NumPy with overlapped Allan variances and
 * least squares (numpy_identify.py). Files are in the page cache. Then the gathering of one channel
 * in ns a sample, beside the cosine transform of its segments, which is the least it can cost.
 *
 * bench_identify 86400000: one run of so many rows (4.1 GB at 24 h of 1 kHz) for time and memory;
 * the file is removed afterwards. IMUKIT_BENCH_FILES names the directory, else /tmp. */
#include "bench.h"

#include "imukit/fourier.h"
#include "imukit/identify_record.h"
#include "imukit/io.h"
#include "imukit/log.h"
#include "imukit/random.h"
#include "imukit/thread_pool.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ROWS = 10000000, CHANNELS = 6, BLOCK = 1 << 16, REPEATS = 3, SAMPLES = 1 << 22 };

static char path[256];

static void stop(const char *what)
{
    fprintf(stderr, "bench_identify: %s\n", what);
    exit(1);
}

/* White noise with a random walk in it, as many bits as a double has. */
static void write_log(size_t rows)
{
    static double data[CHANNELS][BLOCK], steps[BLOCK];
    static const char *const names[CHANNELS] = {"gyro_x",  "gyro_y",  "gyro_z",
                                                "accel_x", "accel_y", "accel_z"};
    imk_log_column columns[CHANNELS];
    double level[CHANNELS] = {0};
    memset(columns, 0, sizeof columns);
    for (int c = 0; c < CHANNELS; c++) {
        snprintf(columns[c].name, sizeof columns[c].name, "%s", names[c]);
        columns[c].unit = imk_unit_of(c < 3 ? "rad/s" : "m/s^2");
        columns[c].quantity = c < 3 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE;
        columns[c].axis = c % 3;
    }
    imk_log_writer *writer;
    if (imk_log_create(path, CHANNELS, columns, IMK_LOG_SHORTEST, NULL, rows, &writer, NULL) !=
        IMK_OK)
        stop("cannot write the log");
    const imk_random random = imk_random_seeded(1);
    const double *pointers[CHANNELS];
    for (size_t row = 0; row < rows; row += BLOCK) {
        const size_t count = rows - row < BLOCK ? rows - row : BLOCK;
        for (int c = 0; c < CHANNELS; c++) {
            imk_random_normals(random, (uint64_t)(2 * c), row, count, data[c]);
            imk_random_normals(random, (uint64_t)(2 * c + 1), row, count, steps);
            for (size_t i = 0; i < count; i++) {
                level[c] += 1e-6 * steps[i];
                data[c][i] = 1e-3 * data[c][i] + level[c] - (c == 5 ? 9.80665 : 0);
            }
            pointers[c] = data[c];
        }
        imk_log_write(writer, count, pointers, NULL);
    }
    if (imk_log_commit(writer, NULL) != IMK_OK)
        stop("cannot write the log");
}

/* One run of the command; its peak memory [MB] goes to *memory. */
static double run_command(const char *rate, double *memory)
{
    const double begin = bench_now();
    const pid_t child = fork();
    if (child == 0) {
        if (!freopen("/dev/null", "w", stdout))
            _exit(127);
        execl(IMUKIT_COMMAND, "imukit", "identify", path, "--rate", rate, "--threads", "2",
              (char *)NULL);
        _exit(127);
    }
    int status = 0;
    struct rusage usage;
    if (child < 0 || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
        WEXITSTATUS(status) != 0)
        stop("the command failed");
    *memory = (double)usage.ru_maxrss / 1024;
    return bench_now() - begin;
}

typedef struct whole_work {
    imk_log log;
    imk_identify_settings settings;
} whole_work;

static void identify_whole(void *context, size_t channel)
{
    whole_work *w = context;
    const size_t size = imk_identify_workspace_size(w->log.rows);
    void *workspace = malloc(size);
    imk_identification result;
    if (!workspace || imk_identify_channel(&w->settings, w->log.rows, w->log.data[channel], &result,
                                           workspace, size, NULL) != IMK_OK)
        stop("the whole record could not be identified");
    free(workspace);
}

static double run_whole(const imk_executor *executor)
{
    whole_work w = {.settings = imk_identify_default()};
    w.settings.dt = 0.01;
    imk_log_settings settings = imk_log_settings_default();
    settings.rate = 100;
    const double begin = bench_now();
    if (imk_log_load(path, &settings, NULL, &w.log, NULL) != IMK_OK)
        stop("cannot read the log");
    imk_execute(executor, CHANNELS, identify_whole, &w);
    imk_log_free(&w.log);
    return bench_now() - begin;
}

typedef struct gather_run {
    const double *samples;
    void *memory, *transform;
    double *copy;
    size_t transform_size;
} gather_run;

static void gather(void *context)
{
    const gather_run *g = context;
    imk_identify_record *record;
    imk_identify_record_begin(SAMPLES, &record, g->memory, imk_identify_record_size(SAMPLES), NULL);
    imk_identify_record_add(record, SAMPLES, g->samples, NULL);
}

static void transform_segments(void *context)
{
    const gather_run *g = context;
    for (size_t i = 0; i < SAMPLES; i += BLOCK) {
        memcpy(g->copy, g->samples + i, BLOCK * sizeof(double));
        imk_cosine(BLOCK, g->copy, g->transform, g->transform_size);
    }
}

static void compare_gathering(void)
{
    gather_run g = {.memory = malloc(imk_identify_record_size(SAMPLES)),
                    .transform_size = imk_cosine_workspace_size(BLOCK),
                    .copy = malloc(BLOCK * sizeof(double))};
    double *samples = malloc(SAMPLES * sizeof *samples);
    g.transform = malloc(g.transform_size);
    if (!g.memory || !g.copy || !g.transform || !samples)
        stop("memory is exhausted");
    imk_random_normals(imk_random_seeded(1), 1, 0, SAMPLES, samples);
    g.samples = samples;
    double ours, least;
    bench_compare(REPEATS, gather, &g, transform_segments, &g, &ours, &least);
    bench_row_time("identify_gather_per_sample", 1e9 * ours / SAMPLES, 1e9 * least / SAMPLES, "ns",
                   "-", 1);
}

int main(int argument_count, char **arguments)
{
    const char *directory = getenv("IMUKIT_BENCH_FILES");
    const size_t rows = argument_count > 1 ? strtoull(arguments[1], NULL, 10) : ROWS;
    char names[300], command[600];
    snprintf(path, sizeof path, "%s/bench_identify_%d.npy", directory ? directory : "/tmp",
             (int)getpid());
    snprintf(names, sizeof names, "%s.columns", path);
    write_log(rows);
    double memory, best = (double)INFINITY;
    if (argument_count > 1) {
        best = run_command("1000Hz", &memory);
        fprintf(stderr, "bench_identify: %zu rows: %.1f s, peak memory %.0f MB\n", rows, best,
                memory);
        bench_row_time("identify_long_log", best, (double)NAN, "s", "-", 2);
        bench_row_time("identify_long_log_memory", memory, (double)NAN, "MB", "-", 2);
    } else {
        snprintf(command, sizeof command, "/usr/bin/python3 %s/bench/numpy_identify.py %s",
                 SOURCE_DIRECTORY, path);
        const double numpy = bench_program(command);
        imk_thread_pool *pool = imk_thread_pool_create(2);
        const imk_executor executor = imk_thread_pool_executor(pool);
        const double whole = run_whole(&executor);
        imk_thread_pool_destroy(pool);
        for (int i = 0; i < REPEATS; i++)
            best = fmin(best, run_command("100Hz", &memory));
        bench_row_time("identify_npy_1e7_to_model", 1e3 * best, 1e3 * numpy, "ms", "-", 2);
        bench_row_time("identify_two_scales_1e7", 1e3 * best, 1e3 * whole, "ms", "-", 2);
        bench_row_time("identify_npy_1e7_memory", memory, (double)NAN, "MB", "-", 2);
        bench_pin();
        compare_gathering();
    }
    unlink(path);
    unlink(names);
    return 0;
}
