/* SPDX-License-Identifier: Apache-2.0 */
/* Reading logs of arrays (.npz, .mat, .h5) and of a matrix (.npy), against fread() of the same
 * bytes into memory, which makes no columns of them. A million rows of seven float64, from the page
 * cache; an .h5 is read by a process of its own. MB are of the values. */
#include "bench.h"

#include "imukit/log.h"

#include <unistd.h>

enum { COLUMNS = 7, ROWS = 1000000, PIECE = 65536, REPEATS = 7 };

typedef struct run {
    const char *path;
    double *column[COLUMNS];
    size_t rows;
    char *bytes;
} run;

static bool write_log(const char *path, run *r)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    imk_log_column column[COLUMNS];
    imk_log_writer *writer = NULL;
    imk_error error;
    for (int c = 0; c < COLUMNS; c++) {
        column[c] = (imk_log_column){.axis = -1};
        snprintf(column[c].name, sizeof column[c].name, "%s", names[c]);
        column[c].unit = imk_unit_of(c == 0 ? "s" : c < 4 ? "rad/s" : "m/s^2");
    }
    return imk_log_create(path, COLUMNS, column, IMK_LOG_SHORTEST, NULL, ROWS, &writer, &error) ==
               IMK_OK &&
           imk_log_write(writer, ROWS, (const double *const *)r->column, NULL) == IMK_OK &&
           imk_log_commit(writer, &error) == IMK_OK;
}

static void read_log(void *context)
{
    run *r = context;
    imk_log_reader *reader = NULL;
    r->rows = 0;
    if (imk_log_open(r->path, NULL, &reader, NULL) != IMK_OK)
        return;
    size_t rows = 0;
    do {
        double *place[COLUMNS];
        for (int c = 0; c < COLUMNS; c++)
            place[c] = r->column[c] + r->rows;
        if (imk_log_read(reader, PIECE, place, &rows, NULL) != IMK_OK)
            rows = 0;
        r->rows += rows;
    } while (rows > 0);
    imk_log_close(reader);
}

static void read_bytes(void *context)
{
    run *r = context;
    FILE *file = fopen(r->path, "rb");
    if (!file)
        return;
    while (fread(r->bytes, 1, (size_t)8 * COLUMNS * ROWS, file) > 0)
        ;
    fclose(file);
}

int main(void)
{
    static const char *const endings[] = {"npy", "npz", "mat", "h5"};
    run r = {.bytes = malloc((size_t)8 * COLUMNS * ROWS)};
    bool good = r.bytes != NULL;
    bench_pin();
    for (int c = 0; c < COLUMNS && good; c++) {
        r.column[c] = malloc((ROWS + PIECE) * sizeof(double));
        good = r.column[c] != NULL;
        for (size_t i = 0; i < ROWS && good; i++)
            r.column[c][i] = c == 0 ? (double)i * 0.01 : (double)(i * 2654435761u % 1000003) * 1e-6;
    }
    for (size_t e = 0; e < sizeof endings / sizeof endings[0] && good; e++) {
        char path[300], names[320];
        double ours = HUGE_VAL, theirs = HUGE_VAL;
        snprintf(path, sizeof path, BENCH_DIRECTORY "/arrays.%s", endings[e]);
        snprintf(names, sizeof names, "%s.columns", path);
        r.path = path;
        good = write_log(path, &r);
        for (int i = 0; i < REPEATS && good; i++) {
            const double one = bench_once(read_log, &r), other = bench_once(read_bytes, &r);
            ours = one < ours ? one : ours;
            theirs = other < theirs ? other : theirs;
            good = r.rows == ROWS;
        }
        const double megabytes = 8e-6 * COLUMNS * ROWS;
        printf("read_%s,%.0f,%.0f,%.2f,MB/s,best,1\n", endings[e], megabytes / ours,
               megabytes / theirs, theirs / ours);
        unlink(path);
        unlink(names);
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
