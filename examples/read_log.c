/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a log as a stream: the mean and standard deviation of every column, in SI units, and
 * what the reader found on the way.
 *
 *     example_read_log log.csv */
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BLOCK = 4096 };

static int fail(const imk_error *error, const char *source)
{
    char text[512];
    imk_error_text(error, source, text, sizeof text);
    fprintf(stderr, "%s\n", text);
    return EXIT_FAILURE;
}

/* Mean and sum of squared deviations, updated sample by sample. */
typedef struct moments {
    double count, mean, squares;
} moments;

static void add(moments *m, size_t count, const double *sample)
{
    for (size_t i = 0; i < count; i++) {
        double deviation = sample[i] - m->mean;
        m->count += 1;
        m->mean += deviation / m->count;
        m->squares += deviation * (sample[i] - m->mean);
    }
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: %s LOG\n", argv[0]);
        return 2;
    }
    imk_error error;
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    if (imk_log_open(argv[1], &settings, &reader, &error) != IMK_OK)
        return fail(&error, argv[1]);

    static double data[IMK_LOG_COLUMNS_MAX][BLOCK];
    static moments moment[IMK_LOG_COLUMNS_MAX];
    double *block[IMK_LOG_COLUMNS_MAX];
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        block[i] = data[i];
    size_t columns = imk_log_column_count(reader);
    for (size_t rows = 1; rows > 0;) {
        if (imk_log_read(reader, BLOCK, block, &rows, &error) != IMK_OK)
            return fail(&error, argv[1]);
        for (size_t i = 0; i < columns; i++)
            add(&moment[i], rows, data[i]);
    }

    imk_log_findings findings = imk_log_findings_get(reader);
    printf("%zu rows, one every %g s; %zu gaps, %zu repeats, %zu reversals, %zu not finite\n",
           findings.rows, findings.interval, findings.gaps, findings.repeats, findings.reversals,
           findings.not_finite);
    for (size_t i = 0; i < columns; i++)
        printf("%-12s mean %13.6g   deviation %12.6g\n", imk_log_column_get(reader, i)->name,
               moment[i].mean, sqrt(moment[i].squares / moment[i].count));
    imk_log_close(reader);
    return EXIT_SUCCESS;
}
