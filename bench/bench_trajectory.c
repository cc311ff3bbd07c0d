/* SPDX-License-Identifier: Apache-2.0 */
/* Truth along a table of poses: ten minutes of a vehicle, 60 000 samples at 100 Hz, from poses at
 * 10 Hz and at 100 Hz. Ours: the pieces through the poses, then means over each sample, exact by
 * quadrature. The yardstick, scipy_trajectory.py: CubicSpline and RotationSpline, differentiated,
 * with the same gravity and Earth rate, and means by Gauss's formula with two nodes, the cheapest
 * that a careful user would take: rows trajectory_poses. Rows trajectory_points tell what it takes
 * to evaluate once in the middle of each sample, which is no mean. Making the splines is counted on
 * both sides; what the results differ by is a remark. */
#include "bench.h"

#include "imukit/elementary.h"
#include "imukit/motion.h"

#include <unistd.h>

enum { SAMPLES = 60000, REPEATS = 7 };
static const double sample_rate = 100.0, duration = 600.0; /* [Hz], [s] */

/* A table of poses with the memory to use it. */
typedef struct table {
    size_t count;
    double *time, *position[3];
    imk_quaternion *attitude;
    imk_trajectory_piece *piece;
    double *workspace, *boundary, *rate[3], *force[3];
    imk_vector3 origin;
    imk_kernel kernel;
} table;

static void *allocate(size_t size)
{
    void *memory = calloc(1, size); /* touched below, in the first run */
    if (!memory) {
        fprintf(stderr, "bench_trajectory: memory is exhausted\n");
        exit(1);
    }
    return memory;
}

/* Eights of some kilometres at up to 130 m/s, climbing and banking, with some roll and pitch of
 * their own. */
static void set_pose(table *poses, size_t i, imk_geodetic place)
{
    const double t = duration * (double)i / (double)(poses->count - 1);
    const double phase = 2 * 3.14159265358979323846 * t / 300;
    const imk_vector3 ned = {{4000 * imk_sin(phase), 1000 * imk_sin(2 * phase),
                              -300 * (1 - imk_cos(phase)) - 2 * imk_sin(7 * phase)}};
    const imk_matrix3 c_en = imk_ned_axes(place.latitude, place.longitude);
    const imk_vector3 shift = imk_matrix3_apply(c_en, ned);
    const imk_matrix3 c_nb = imk_matrix3_from_euler(
        0.4 * imk_sin(phase) + 0.02 * imk_sin(40 * phase),
        0.1 * imk_cos(phase) + 0.01 * imk_sin(31 * phase), 1.2 * imk_sin(phase) + 0.3 * phase);
    poses->time[i] = t;
    for (int axis = 0; axis < 3; axis++)
        poses->position[axis][i] = shift.v[axis];
    poses->attitude[i] = imk_quaternion_from_matrix(imk_matrix3_multiply(c_en, c_nb));
}

static table make_table(double rate)
{
    const imk_geodetic place = {0.8, 0.2, 300};
    table poses = {.count = (size_t)(duration * rate) + 1};
    const size_t array = poses.count * sizeof(double);
    poses.time = allocate(array);
    poses.attitude = allocate(poses.count * sizeof *poses.attitude);
    poses.piece = allocate(poses.count * sizeof *poses.piece);
    poses.workspace = allocate(imk_trajectory_poses_workspace_size(poses.count));
    poses.boundary = allocate((SAMPLES + 1) * sizeof(double));
    for (int axis = 0; axis < 3; axis++) {
        poses.position[axis] = allocate(array);
        poses.rate[axis] = allocate(SAMPLES * sizeof(double));
        poses.force[axis] = allocate(SAMPLES * sizeof(double));
    }
    for (size_t i = 0; i < poses.count; i++)
        set_pose(&poses, i, place);
    for (size_t k = 0; k <= SAMPLES; k++)
        poses.boundary[k] = (double)k / sample_rate;
    poses.origin = imk_ecef_from_geodetic(place);
    poses.kernel = imk_random_seeded(0).kernel;
    return poses;
}

static void free_table(table *poses)
{
    for (int axis = 0; axis < 3; axis++) {
        free(poses->position[axis]);
        free(poses->rate[axis]);
        free(poses->force[axis]);
    }
    free(poses->time);
    free(poses->attitude);
    free(poses->piece);
    free(poses->workspace);
    free(poses->boundary);
}

static void make_pieces(void *context)
{
    table *poses = context;
    const double *const position[3] = {poses->position[0], poses->position[1], poses->position[2]};
    imk_error error;
    if (imk_trajectory_from_poses(
            poses->count, poses->time, position, poses->attitude, poses->piece, poses->workspace,
            imk_trajectory_poses_workspace_size(poses->count), &error) != IMK_OK) {
        fprintf(stderr, "bench_trajectory: the poses are refused: %s\n", error.field);
        exit(1);
    }
    bench_use(poses->piece);
}

static void make_truth(void *context)
{
    table *poses = context;
    make_pieces(poses);
    const imk_trajectory trajectory = {
        .earth = true,
        .origin = {poses->origin.v[0], poses->origin.v[1], poses->origin.v[2]},
        .piece_count = poses->count - 1,
        .piece = poses->piece};
    imk_trajectory_means(&trajectory, poses->kernel, SAMPLES, poses->boundary, poses->rate, NULL,
                         poses->force);
    bench_use(poses->force);
}

/* For the yardstick: a row with the origin, then the poses. */
static void write_table(const table *poses, const char *path)
{
    FILE *file = fopen(path, "wb");
    const double first[8] = {0, poses->origin.v[0], poses->origin.v[1], poses->origin.v[2]};
    bool good = file && fwrite(first, sizeof first, 1, file) == 1;
    for (size_t i = 0; good && i < poses->count; i++) {
        const imk_quaternion q = poses->attitude[i];
        const double row[8] = {poses->time[i],
                               poses->position[0][i],
                               poses->position[1][i],
                               poses->position[2][i],
                               q.x,
                               q.y,
                               q.z,
                               q.w};
        good = fwrite(row, sizeof row, 1, file) == 1;
    }
    if ((file && fclose(file) != 0) || !good) {
        fprintf(stderr, "bench_trajectory: %s cannot be written\n", path);
        exit(1);
    }
}

/* Root mean squares of the differences, but for the ends, where the two kinds of attitude spline
 * have their own conditions. */
static void print_differences(const table *poses, const char *kind, const char *path)
{
    FILE *file = fopen(path, "rb");
    double row[6], rate = 0, force = 0;
    size_t count = 0;
    for (size_t k = 0; file && k < SAMPLES && fread(row, sizeof row, 1, file) == 1; k++) {
        if (k < 1000 || k >= SAMPLES - 1000)
            continue;
        for (int axis = 0; axis < 3; axis++) {
            rate += pow(row[axis] - poses->rate[axis][k], 2);
            force += pow(row[3 + axis] - poses->force[axis][k], 2);
        }
        count += 3;
    }
    if (file)
        fclose(file);
    if (count > 0)
        fprintf(stderr, "bench_trajectory: %zu poses, %s: rms differences %.2g rad/s, %.2g m/s^2\n",
                poses->count, kind, sqrt(rate / (double)count), sqrt(force / (double)count));
}

/* Time of the yardstick [s], means or points. */
static double yardstick_time(const table *poses, const char *kind, const char *path)
{
    char result[80], command[512];
    snprintf(result, sizeof result, "%s.result", path);
    snprintf(command, sizeof command,
             "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 "
             "%s/bench/scipy_trajectory.py %s %s %zu %g %d %s",
             SOURCE_DIRECTORY, kind, path, poses->count, sample_rate, SAMPLES, result);
    const double time = bench_program(command);
    print_differences(poses, kind, result);
    unlink(result);
    return time;
}

static void bench_poses(double rate)
{
    table poses = make_table(rate);
    char path[64], name[64];
    snprintf(path, sizeof path, "/tmp/imukit_bench_%ld.poses", (long)getpid());
    write_table(&poses, path);
    double ours = bench_best(REPEATS, make_truth, &poses);
    const double means = yardstick_time(&poses, "means", path);
    const double points = yardstick_time(&poses, "points", path);
    ours = fmin(ours, bench_best(REPEATS, make_truth, &poses));
    fprintf(stderr, "bench_trajectory: %zu poses: of ours, the pieces take %.2f ms\n", poses.count,
            1e3 * bench_best(REPEATS, make_pieces, &poses));
    snprintf(name, sizeof name, "trajectory_poses_%ghz", rate);
    bench_row_time(name, 1e3 * ours, 1e3 * means, "ms", imk_kernel_name(poses.kernel), 1);
    snprintf(name, sizeof name, "trajectory_points_%ghz", rate);
    bench_row_time(name, 1e3 * ours, 1e3 * points, "ms", imk_kernel_name(poses.kernel), 1);
    unlink(path);
    free_table(&poses);
}

int main(void)
{
    bench_pin();
    bench_poses(10.0);
    bench_poses(100.0);
    return 0;
}
