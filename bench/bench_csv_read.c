/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
/* Reading CSV logs from memory, against a loop of strtod() over the same bytes in the same program.
 * Prints rows  name,ours,yardstick,ratio,unit,isa,threads.  The two take turns on one core; the
 * best of the repetitions counts, so that what else runs on the machine disturbs least. Both write
 * into arrays that are already resident. */
#include "imukit/log.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COLUMNS = 6, REPETITIONS = 15 };

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct text {
    char *bytes;
    size_t size;
} text;

/* The yardstick: what a plain C program does. */
static size_t read_with_strtod(const text *csv, double *const *columns)
{
    char *p = strchr(csv->bytes, '\n') + 1;
    size_t row = 0;
    for (; *p; row++)
        for (int j = 0; j < COLUMNS; j++) {
            columns[j][row] = strtod(p, &p);
            p++;
        }
    return row;
}

static size_t read_with_imukit(const text *csv, double *const *columns)
{
    imk_log_settings settings = imk_log_default();
    settings.rate = 100.0;
    imk_log_reader *reader;
    if (imk_log_open_memory(csv->bytes, csv->size, &settings, &reader, NULL) != IMK_OK)
        return 0;
    size_t rows = 0, total = 0;
    do {
        double *place[COLUMNS];
        for (int j = 0; j < COLUMNS; j++)
            place[j] = columns[j] + total;
        if (imk_log_read(reader, 1 << 16, place, &rows, NULL) != IMK_OK)
            rows = 0;
        total += rows;
    } while (rows > 0);
    imk_log_close(reader);
    return total;
}

static bool measure(const char *name, const text *csv)
{
    size_t lines = 0;
    for (size_t i = 0; i < csv->size; i++)
        lines += csv->bytes[i] == '\n';
    double *ours[COLUMNS], *theirs[COLUMNS];
    for (int j = 0; j < COLUMNS; j++) {
        ours[j] = calloc(lines, sizeof(double));
        theirs[j] = calloc(lines, sizeof(double));
        if (!ours[j] || !theirs[j])
            return false;
        memset(ours[j], 1, lines * sizeof(double));
        memset(theirs[j], 1, lines * sizeof(double));
    }
    double best_ours = 1e9, best_theirs = 1e9;
    size_t rows = 0, rows_theirs = 0;
    for (int i = 0; i < REPETITIONS; i++) {
        double start = seconds();
        rows = read_with_imukit(csv, ours);
        double took = seconds() - start;
        best_ours = took < best_ours ? took : best_ours;
        start = seconds();
        rows_theirs = read_with_strtod(csv, theirs);
        took = seconds() - start;
        best_theirs = took < best_theirs ? took : best_theirs;
    }
    /* The header states SI units, so the numbers must be the same to the last bit. */
    bool equal = rows == rows_theirs;
    for (int j = 0; j < COLUMNS; j++) {
        equal = equal && memcmp(ours[j], theirs[j], rows * sizeof(double)) == 0;
        free(ours[j]);
        free(theirs[j]);
    }
    const char *isa = getenv("IMUKIT_ISA");
    const double megabytes = (double)csv->size * 1e-6;
    printf("%s,%.1f,%.1f,%.2f,MB/s,%s,1\n", name, megabytes / best_ours, megabytes / best_theirs,
           best_theirs / best_ours, isa ? isa : "best");
    if (!equal)
        fprintf(stderr, "%s: the values differ from those of strtod()\n", name);
    return equal;
}

static const char header[] = "gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],"
                             "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n";

/* Uniform numbers of a sensor's size in a printf format. */
static text make_text(const char *format, size_t rows)
{
    text csv = {malloc(sizeof header + rows * COLUMNS * 27), sizeof header - 1};
    if (!csv.bytes)
        exit(EXIT_FAILURE);
    memcpy(csv.bytes, header, sizeof header);
    unsigned long long state = 1;
    for (size_t row = 0; row < rows; row++)
        for (int j = 0; j < COLUMNS; j++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            const double unit = (double)(state >> 11) * 0x1p-53 - 0.5;
            csv.size += (size_t)sprintf(csv.bytes + csv.size, format, j < 3 ? unit : 10.0 * unit);
            csv.bytes[csv.size++] = j < COLUMNS - 1 ? ',' : '\n';
        }
    csv.bytes[csv.size] = '\0';
    return csv;
}

/* A real log, its header replaced by one in SI. @return bytes NULL when it is not there */
static text load_text(const char *path)
{
    text csv = {NULL, 0};
    char command[512];
    snprintf(command, sizeof command, "gzip -dc '%s' 2>/dev/null | tail -n +2", path);
    FILE *pipe = popen(command, "r");
    size_t capacity = 1 << 27;
    csv.bytes = malloc(capacity);
    if (!pipe || !csv.bytes)
        exit(EXIT_FAILURE);
    memcpy(csv.bytes, header, sizeof header);
    const size_t size = fread(csv.bytes + sizeof header - 1, 1, capacity - sizeof header, pipe);
    pclose(pipe);
    csv.size = sizeof header - 1 + size;
    csv.bytes[csv.size] = '\0';
    if (size == 0) {
        free(csv.bytes);
        csv.bytes = NULL;
    }
    return csv;
}

int main(int count, char **arguments)
{
    const char *path =
        count > 1 ? arguments[1] : SHARED_DIRECTORY "/data/static/adis16405_imu1_100hz.csv.gz";
    static const struct {
        const char *name, *format;
    } synthetic[] = {
        {"csv_read_fixed6", "%.6f"}, {"csv_read_g9", "%.9g"}, {"csv_read_g17", "%.17g"}};
    bool good = true;
    puts("name,ours,yardstick,ratio,unit,isa,threads");
    text csv = load_text(path);
    if (csv.bytes)
        good = measure("csv_read_adis16405", &csv) && good;
    else
        fprintf(stderr, "%s is not there: skipped\n", path);
    free(csv.bytes);
    for (size_t i = 0; i < sizeof synthetic / sizeof synthetic[0]; i++) {
        csv = make_text(synthetic[i].format, 300000);
        good = measure(synthetic[i].name, &csv) && good;
        free(csv.bytes);
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
