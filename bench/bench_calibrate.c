/* SPDX-License-Identifier: Apache-2.0 */
/* A multi-position calibration of a real log, from the file to parameters with their covariance:
 * 51175 samples of six channels in counts. The yardstick is the reference implementation, which
 * takes 0.39 s on a machine of this class (shared design notes, golden.md), reading included. It
 * reads plain text; so the log is timed as such, in a temporary file, and compressed as it comes.
 * Parts are printed as remarks. */
#define _DEFAULT_SOURCE /* mkstemps() */
#include "bench.h"

#include "imukit/imukit.h"
#include "imukit/log.h"

#include <unistd.h>
#include <zlib.h>

static const double reference_seconds = 0.39;

enum { REPETITIONS = 15, POSES = 256 };

typedef struct job {
    const char *path;
    imk_calibration calibration;
    imk_calibration_result result;
    imk_observation observation[POSES];
    imk_turn turn[POSES];
    double read, observe, solve; /* best times of the parts [s] */
    imk_status status;
} job;

static void refer(const imk_log *log, imk_test_record *record)
{
    *record = (imk_test_record){.name = "log",
                                .count = log->rows,
                                .dt = log->findings.interval,
                                .time = log->data[imk_log_find(log, IMK_QUANTITY_TIME, -1)],
                                .axis_count = {3, 3},
                                .counts = {true, true}};
    for (int i = 0; i < 3; i++) {
        record->reading[IMK_GYRO][i] = log->data[imk_log_find(log, IMK_QUANTITY_ANGULAR_RATE, i)];
        record->reading[IMK_ACCEL][i] =
            log->data[imk_log_find(log, IMK_QUANTITY_SPECIFIC_FORCE, i)];
    }
}

static void calibrate(void *context)
{
    job *j = context;
    imk_calibration *c = &j->calibration;
    imk_log log;
    imk_test_record record;
    const double start = bench_now();
    const imk_log_settings reading = imk_log_settings_default();
    j->status = imk_log_load(j->path, &reading, NULL, &log, NULL);
    if (j->status != IMK_OK)
        return;
    refer(&log, &record);
    const double loaded = bench_now();
    imk_calibration_default(c);
    c->gravity = 9.81744;
    c->observation = j->observation;
    c->turn = j->turn;
    c->observation_capacity = c->turn_capacity = POSES;
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    size_t size = imk_procedure_workspace_size(IMK_PROCEDURE_MULTIPOSITION, &record, &settings);
    void *workspace = malloc(size);
    j->status = imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, c, &record, &settings, false,
                                      NULL, workspace, size, NULL);
    free(workspace);
    const double observed = bench_now();
    if (j->status == IMK_OK) {
        size = imk_calibration_workspace_size(c);
        workspace = malloc(size);
        j->status = imk_calibration_solve(c, &j->result, workspace, size, NULL);
        free(workspace);
    }
    const double solved = bench_now();
    imk_log_free(&log);
    j->read = fmin(j->read, loaded - start);
    j->observe = fmin(j->observe, observed - loaded);
    j->solve = fmin(j->solve, solved - observed);
}

/* The log as plain text. @return false: not made */
static bool expand(const char *path, const char *plain, int descriptor)
{
    static char buffer[1 << 16];
    gzFile from = gzopen(path, "rb"); /* reads plain text too */
    FILE *to = fdopen(descriptor, "wb");
    int size = 0;
    bool written = from && to;
    while (written && (size = gzread(from, buffer, sizeof buffer)) > 0)
        written = fwrite(buffer, 1, (size_t)size, to) == (size_t)size;
    if (from)
        gzclose(from);
    if (!to || fclose(to) != 0 || !written || size < 0) {
        fprintf(stderr, "%s: not written\n", plain);
        return false;
    }
    return true;
}

static bool measure(job *j, const char *path, const char *name)
{
    j->path = path;
    j->read = j->observe = j->solve = (double)INFINITY;
    const double best = bench_best(REPETITIONS, calibrate, j);
    if (j->status != IMK_OK) {
        fprintf(stderr, "%s: %s: skipped\n", path, imk_status_name(j->status));
        return j->status == IMK_ERROR_OPEN;
    }
    fprintf(stderr, "bench: read %.1f ms, holds and turns %.1f ms, solve %.1f ms (%d rounds)\n",
            1e3 * j->read, 1e3 * j->observe, 1e3 * j->solve, j->result.iterations);
    bench_row_time(name, 1e3 * best, 1e3 * reference_seconds, "ms",
                   imk_kernel_name(imk_random_seeded(0).kernel), 1);
    return true;
}

int main(int count, char **arguments)
{
    static job j;
    char plain[] = "/tmp/imukit_bench_XXXXXX.csv";
    const char *path = count > 1 ? arguments[1]
                                 : SHARED_DIRECTORY
                           "/data/calibration/xsens_mti_multiposition_raw_counts.csv.gz";
    bench_pin();
    puts("name,ours,yardstick,ratio,unit,isa,threads");
    if (access(path, R_OK) != 0) {
        fprintf(stderr, "%s: not there: skipped\n", path);
        return EXIT_SUCCESS;
    }
    const int descriptor = mkstemps(plain, 4);
    bool fine = descriptor >= 0 && expand(path, plain, descriptor);
    fine = fine && measure(&j, plain, "calibrate_multiposition_xsens");
    if (descriptor >= 0)
        unlink(plain);
    fine = measure(&j, path, "calibrate_multiposition_xsens_gz") && fine;
    return fine ? EXIT_SUCCESS : EXIT_FAILURE;
}
