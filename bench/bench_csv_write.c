/* SPDX-License-Identifier: Apache-2.0 */
/* Speed of writing logs of time and six axes to /dev/null, so that only the formatting counts; the
 * yardstick is fprintf("%.9g") to /dev/null, a row per call. A .npy goes to memory (/dev/shm)
 * against write() of the finished matrix, and to /dev/null against interleaving the columns only:
 * both are the least there can be, not alternatives. Units: ns per cell. */
#include "bench.h"

#include "imukit/io.h"

#include <fcntl.h>
#include <unistd.h>

enum {
    ROWS = 8000, /* some ms a run, so that the shortest of many is free of interruptions */
    COLUMNS = 7,
    CELLS = ROWS * COLUMNS,
    REPEATS = 61,
    CALLS = 16,        /* of ROWS rows where starting and ending would count too much */
    LONG_ROWS = 65536, /* of a call for two threads, as the command makes them */
    LONG_CALLS = 8,
    LONG_REPEATS = 15
};

static double data[COLUMNS][LONG_ROWS];
static double matrix[ROWS][COLUMNS];
static const double *const columns[COLUMNS] = {data[0], data[1], data[2], data[3],
                                               data[4], data[5], data[6]};

/* About normal: the sum of twelve uniforms. */
static double noise(void)
{
    static uint64_t state = 1;
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        state = 6364136223846793005u * state + 1442695040888963407u;
        sum += (double)(state >> 11) * 0x1p-53;
    }
    return sum;
}

static void make_data(void)
{
    for (size_t row = 0; row < LONG_ROWS; row++) {
        data[0][row] = 0.01 * (double)row;
        for (size_t axis = 0; axis < 3; axis++) {
            data[1 + axis][row] = 2e-3 * noise();
            data[4 + axis][row] = 0.05 * noise() - (axis == 2 ? 9.80665 : 0.0);
        }
        for (size_t i = 0; row < ROWS && i < COLUMNS; i++)
            matrix[row][i] = data[i][row];
    }
}

/* What a run writes, and to where. */
typedef struct target {
    const char *path;
    imk_log_precision precision;
    bool field_units; /* deg/s and g instead of SI */
    int calls;
    size_t rows; /* of a call */
    const imk_executor *executor;
} target;

static imk_log_column column_of(const char *name, const char *unit_text, double scale)
{
    imk_log_column column = {.axis = -1, .unit = {.scale = scale}};
    snprintf(column.name, sizeof column.name, "%s", name);
    snprintf(column.unit.text, sizeof column.unit.text, "%s", unit_text);
    return column;
}

static void write_log(void *context)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    static const int decimals[COLUMNS] = {3, 9, 9, 9, 8, 8, 8};
    const target *t = context;
    imk_log_column described[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        if (i == 0)
            described[i] = column_of(names[i], "s", 1.0);
        else if (i < 4)
            described[i] = t->field_units ? column_of(names[i], "deg/s", 0.017453292519943295)
                                          : column_of(names[i], "rad/s", 1.0);
        else
            described[i] = t->field_units ? column_of(names[i], "g", IMK_STANDARD_GRAVITY)
                                          : column_of(names[i], "m/s^2", 1.0);
    }
    imk_log_writer *writer;
    imk_error error;
    imk_status status = imk_log_create(t->path, COLUMNS, described, t->precision, decimals,
                                       (uint64_t)t->calls * t->rows, &writer, &error);
    if (status == IMK_OK) {
        for (int i = 0; i < t->calls; i++)
            imk_log_write(writer, t->rows, columns, t->executor);
        status = imk_log_commit(writer, &error);
    }
    if (status != IMK_OK) {
        fprintf(stderr, "bench_csv_write: %s: %s\n", error.field, error.found);
        exit(1);
    }
}

static void write_with_fprintf(void *context)
{
    (void)context;
    FILE *file = fopen("/dev/null", "w");
    for (size_t row = 0; file && row < ROWS; row++)
        fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", data[0][row], data[1][row],
                data[2][row], data[3][row], data[4][row], data[5][row], data[6][row]);
    if (file)
        fclose(file);
}

/* The finished matrix in one piece: no conversion, no temporary file, no sync. */
static void write_matrix(void *context)
{
    const int file = open(context, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    bool good = file >= 0;
    for (int i = 0; good && i < CALLS; i++)
        good = write(file, matrix, sizeof matrix) == (ssize_t)sizeof matrix;
    if (!good)
        fprintf(stderr, "bench_csv_write: %s cannot be written\n", (const char *)context);
    if (file >= 0)
        close(file);
}

/* Interleave the columns into memory that is there: the least work there can be. */
static void interleave(void *context)
{
    (void)context;
    for (int call = 0; call < CALLS; call++) {
        for (size_t row = 0; row < ROWS; row++)
            for (size_t i = 0; i < COLUMNS; i++)
                matrix[row][i] = data[i][row];
        bench_use(matrix);
    }
}

static void compare_text(const char *name, imk_log_precision precision, bool field_units)
{
    target ours = {"/dev/null", precision, field_units, 1, ROWS, NULL};
    double time, yardstick;
    bench_compare(REPEATS, write_log, &ours, write_with_fprintf, NULL, &time, &yardstick);
    bench_row_time(name, 1e9 * time / CELLS, 1e9 * yardstick / CELLS, "ns/cell", "-", 1);
}

/* One thread is the yardstick of two. */
static void compare_threads(const char *name, imk_log_precision precision,
                            const imk_executor *executor)
{
    const double cells = (double)LONG_CALLS * LONG_ROWS * COLUMNS;
    target two = {"/dev/null", precision, false, LONG_CALLS, LONG_ROWS, executor};
    target one = {"/dev/null", precision, false, LONG_CALLS, LONG_ROWS, NULL};
    double time, yardstick;
    bench_two_core_limit(name, LONG_REPEATS, write_log, &one);
    bench_compare(LONG_REPEATS, write_log, &two, write_log, &one, &time, &yardstick);
    bench_row_time(name, 1e9 * time / cells, 1e9 * yardstick / cells, "ns/cell", "-",
                   executor->threads);
}

static void compare_npy(void)
{
    char path[64], names_path[80], yardstick_path[64];
    snprintf(path, sizeof path, "/dev/shm/imukit_bench_%ld.npy", (long)getpid());
    snprintf(names_path, sizeof names_path, "%s.columns", path);
    snprintf(yardstick_path, sizeof yardstick_path, "/dev/shm/imukit_bench_%ld.bin",
             (long)getpid());
    if (access("/dev/shm", W_OK) != 0) {
        fprintf(stderr, "bench_csv_write: no /dev/shm, .npy left out\n");
        return;
    }
    target ours = {path, IMK_LOG_SHORTEST, false, CALLS, ROWS, NULL};
    double time, yardstick;
    bench_compare(REPEATS, write_log, &ours, write_matrix, yardstick_path, &time, &yardstick);
    bench_row_time("npy_write_file", 1e9 * time / (CALLS * CELLS),
                   1e9 * yardstick / (CALLS * CELLS), "ns/cell", "-", 1);
    unlink(yardstick_path);
    unlink(path);

    /* Through a link the same name leads to /dev/null. */
    if (symlink("/dev/null", path) == 0) {
        bench_compare(REPEATS, write_log, &ours, interleave, NULL, &time, &yardstick);
        bench_row_time("npy_write_memory", 1e9 * time / (CALLS * CELLS),
                       1e9 * yardstick / (CALLS * CELLS), "ns/cell", "-", 1);
        unlink(path);
    }
    unlink(names_path);
}

int main(void)
{
    make_data();
    bench_pin();
    compare_text("csv_write_fixed", IMK_LOG_FIXED, false);
    compare_text("csv_write_fixed_deg_g", IMK_LOG_FIXED, true);
    compare_text("csv_write_shortest", IMK_LOG_SHORTEST, false);
    compare_text("csv_write_shortest_deg_g", IMK_LOG_SHORTEST, true);
    compare_npy();

    bench_unpin();
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    compare_threads("csv_write_fixed_threads", IMK_LOG_FIXED, &executor);
    compare_threads("csv_write_shortest_threads", IMK_LOG_SHORTEST, &executor);
    imk_thread_pool_destroy(pool);
    return 0;
}
