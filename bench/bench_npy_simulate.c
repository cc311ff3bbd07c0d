/* SPDX-License-Identifier: Apache-2.0 */
/* A day at 100 Hz to .npy with the complete model, ns per row of the time and six channels: every
 * deterministic term, N, B, K, two Gauss-Markov processes and quantization, on a unit whose
 * temperature swings, at rest and on a moving vehicle. The yardstick is the least that such a log
 * can cost: writing as many bytes from one finished block, and drawing the same normals. Both go to
 * memory (/dev/shm) where there is some. One core. */
#include "bench.h"

#include "imukit/elementary.h"
#include "imukit/io.h"
#include "imukit/simulate.h"

#include <fcntl.h>
#include <unistd.h>

enum {
    RATE = 100,
    ROWS = 24 * 3600 * RATE,
    BLOCK = 8192, /* rows of a call: the columns stay in cache */
    CHANNELS = 6,
    COLUMNS = 1 + CHANNELS,
    POSES = 24 * 3600 + 1, /* one a second */
    DRAWS = 633,           /* normals in hundredths per sample: white, walk, two Gauss-Markov and
                              flicker's 2 + 1/3 */
    REPEATS = 3
};

static double block[COLUMNS][BLOCK], matrix[BLOCK][COLUMNS];

typedef struct job {
    imk_model model;
    imk_simulation simulation;
    char path[64], names_path[80];
} job;

static void stop(const char *what, const imk_error *error)
{
    fprintf(stderr, "bench_npy_simulate: %s%s%s\n", what, error ? ": " : "",
            error ? error->field : "");
    exit(1);
}

static void *allocate(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory)
        stop("memory is exhausted", NULL);
    return memory;
}

/* ---- the model and what the unit is exposed to ------------------------------------------------
 */

static imk_axes axes(double value)
{
    return (imk_axes){.value = {value, -0.8 * value, 1.1 * value}};
}

static imk_axes sizes(double value)
{
    return (imk_axes){.value = {value, 0.8 * value, 1.1 * value}};
}

static void set_rows(imk_rows *rows, double value, bool diagonal)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows->value[i][j] = i == j && !diagonal ? 0 : value * (i - 2 * j + 0.5);
}

static imk_temperature_polynomial polynomial(double slope)
{
    return (imk_temperature_polynomial){
        .order = 3,
        .coefficient = {axes(slope), axes(1e-2 * slope), axes(-1e-4 * slope)},
        .reference = 298,
        .minimum = 240,
        .maximum = 350};
}

/* Terms of a tactical unit, for a signal of size `unit`. */
static void set_triad(imk_triad *triad, double unit)
{
    triad->bias.fixed = axes(1e-4 * unit);
    triad->bias.repeatability = sizes(1e-4 * unit);
    triad->bias.temperature = polynomial(1e-6 * unit);
    triad->bias.temperature_rate = axes(1e-3 * unit);
    triad->bias.warm_up_amplitude = axes(1e-4 * unit);
    triad->bias.warm_up_time.value = 600;
    triad->bias.hysteresis = sizes(2e-5 * unit);
    triad->scale_factor.fixed = axes(2e-4);
    triad->scale_factor.repeatability = sizes(1e-4);
    triad->scale_factor.temperature = polynomial(2e-6);
    triad->nonlinearity.k2 = axes(1e-5 / unit);
    triad->nonlinearity.koq = axes(1e-5 / unit);
    triad->nonlinearity.k3 = axes(1e-6 / (unit * unit));
    triad->nonlinearity.asymmetry = axes(1e-5);
    set_rows(&triad->misalignment, 1e-4, false);
    set_rows(&triad->cross_axis, 5e-5, false);
    triad->noise.white = sizes(1e-4 * unit);
    triad->noise.bias_instability = sizes(1e-5 * unit);
    triad->noise.random_walk = sizes(1e-7 * unit);
    triad->noise.quantization = sizes(1e-6 * unit);
    triad->noise.gauss_markov_count = 2;
    triad->noise.gauss_markov[0].sigma = sizes(1e-5 * unit);
    triad->noise.gauss_markov[0].correlation_time = sizes(300);
    triad->noise.gauss_markov[1].sigma = sizes(2e-5 * unit);
    triad->noise.gauss_markov[1].correlation_time = sizes(20);
    triad->range = sizes(50 * unit);
}

static imk_model complete_model(void)
{
    imk_model model;
    imk_model_default(&model);
    set_triad(&model.gyro, 1);
    set_triad(&model.accel, 10);
    set_rows(&model.gyro.g_sensitivity, 1e-6, true);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++)
            model.gyro.g2_sensitivity.value[i][j] = 1e-8 * (i - j);
    set_rows(&model.accel.lever_arm, 5e-3, true);
    set_rows(&model.accel.nonlinearity.cross_products, 1e-6, true);
    imk_error error;
    if (imk_model_validate(&model, &error) != IMK_OK)
        stop("the model", &error);
    return model;
}

/* Eights of some kilometres that take five minutes, climbing and banking. */
static void set_pose(size_t i, imk_geodetic place, double *time, double *const position[3],
                     imk_quaternion *attitude)
{
    const double phase = 2 * 3.14159265358979323846 * (double)(i % 300) / 300;
    const imk_vector3 ned = {
        {4000 * imk_sin(phase), 1000 * imk_sin(2 * phase), -300 * (1 - imk_cos(phase))}};
    const imk_matrix3 c_en = imk_ned_axes(place.latitude, place.longitude);
    const imk_vector3 shift = imk_matrix3_apply(c_en, ned);
    const imk_matrix3 c_nb =
        imk_matrix3_from_euler(0.4 * imk_sin(phase), 0.1 * imk_cos(phase), 1.2 * imk_sin(phase));
    time[i] = (double)i;
    for (int axis = 0; axis < 3; axis++)
        position[axis][i] = shift.v[axis];
    attitude[i] = imk_quaternion_from_matrix(imk_matrix3_multiply(c_en, c_nb));
}

/* Its pieces live as long as the program. */
static imk_trajectory day_of_eights(void)
{
    const imk_geodetic place = {0.8, 0.2, 300};
    double *time = allocate(POSES * sizeof *time), *position[3];
    for (int axis = 0; axis < 3; axis++)
        position[axis] = allocate(POSES * sizeof **position);
    imk_quaternion *attitude = allocate(POSES * sizeof *attitude);
    for (size_t i = 0; i < POSES; i++)
        set_pose(i, place, time, position, attitude);
    void *workspace = allocate(imk_trajectory_poses_workspace_size(POSES));
    imk_trajectory_piece *piece = allocate((POSES - 1) * sizeof *piece);
    const double *const columns[3] = {position[0], position[1], position[2]};
    imk_error error;
    if (imk_trajectory_from_poses(POSES, time, columns, attitude, piece, workspace,
                                  imk_trajectory_poses_workspace_size(POSES), &error) != IMK_OK)
        stop("the poses", &error);
    free(workspace);
    free(attitude);
    free(time);
    for (int axis = 0; axis < 3; axis++)
        free(position[axis]);
    const imk_vector3 origin = imk_ecef_from_geodetic(place);
    return (imk_trajectory){.earth = true,
                            .origin = {origin.v[0], origin.v[1], origin.v[2]},
                            .piece_count = POSES - 1,
                            .piece = piece};
}

/* ---- a run ------------------------------------------------------------------------------------
 */

static imk_log_writer *create_log(const job *work)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    imk_log_column column[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = (imk_log_column){.axis = i == 0 ? -1 : (i - 1) % 3, .unit = {.scale = 1}};
        snprintf(column[i].name, sizeof column[i].name, "%s", names[i]);
        snprintf(column[i].unit.text, sizeof column[i].unit.text, "%s",
                 i == 0  ? "s"
                 : i < 4 ? "rad/s"
                         : "m/s^2");
    }
    imk_log_writer *writer;
    imk_error error;
    if (imk_log_create(work->path, COLUMNS, column, IMK_LOG_SHORTEST, NULL, ROWS, &writer,
                       &error) != IMK_OK)
        stop("the log", &error);
    return writer;
}

static void simulate_day(void *context)
{
    job *work = context;
    double *columns[COLUMNS];
    const double *written[COLUMNS];
    for (int i = 0; i < COLUMNS; i++)
        written[i] = columns[i] = block[i];
    const size_t size = imk_simulator_size(&work->model, &work->simulation);
    void *memory = allocate(size);
    imk_simulator *simulator;
    imk_error error;
    if (imk_simulator_start(&work->model, &work->simulation, &simulator, memory, size, &error) !=
        IMK_OK)
        stop("the simulator", &error);
    imk_log_writer *writer = create_log(work);
    for (size_t first = 0; first < ROWS; first += BLOCK) {
        const size_t count = ROWS - first < BLOCK ? ROWS - first : BLOCK;
        for (size_t k = 0; k < count; k++)
            block[0][k] = (double)(first + k) / RATE;
        imk_simulator_next(simulator, count, columns + 1, NULL);
        imk_log_write(writer, count, written, NULL);
    }
    if (imk_log_commit(writer, &error) != IMK_OK)
        stop("the log is not written", NULL);
    free(memory);
}

/* The normals of a day, in long draws at the speed of bench_normals, and its bytes. */
static void draw_and_write(void *context)
{
    enum { DRAW = 4096 };
    const job *work = context;
    const imk_random random = imk_random_seeded(1);
    const int file = open(work->path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0)
        stop("the yardstick's file", NULL);
    for (size_t first = 0; first < ROWS; first += BLOCK) {
        const size_t count = ROWS - first < BLOCK ? ROWS - first : BLOCK;
        size_t left = count * CHANNELS * DRAWS / 100;
        for (uint64_t stream = 0; left > 0; stream++) {
            const size_t now = left < DRAW ? left : DRAW;
            imk_random_normals(random, stream, first / DRAW * DRAW, now, block[0]);
            bench_use(block);
            left -= now;
        }
        const size_t bytes = count * sizeof matrix[0];
        if (write(file, matrix, bytes) != (ssize_t)bytes)
            stop("the yardstick's file is not written", NULL);
    }
    close(file);
}

static void compare(const char *name, job *work)
{
    double ours, yardstick;
    bench_compare(REPEATS, simulate_day, work, draw_and_write, work, &ours, &yardstick);
    bench_row_time(name, 1e9 / ROWS * ours, 1e9 / ROWS * yardstick, "ns/row",
                   imk_kernel_name(imk_random_seeded(0).kernel), 1);
    unlink(work->path);
    unlink(work->names_path);
}

int main(void)
{
    bench_pin();
    job work = {.model = complete_model(), .simulation = imk_simulation_default()};
    snprintf(work.path, sizeof work.path, "%s/imukit_bench_%ld.npy",
             access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", (long)getpid());
    snprintf(work.names_path, sizeof work.names_path, "%s.columns", work.path);

    static const double time[4] = {0, 6 * 3600, 18 * 3600, 24 * 3600};
    static const double temperature[4] = {298, 318, 268, 298};
    const imk_temperature_profile profile = {
        .point_count = 4, .time = time, .temperature = temperature, .time_constant = 600};
    work.simulation.temperature = &profile;
    compare("npy_day_at_rest", &work);

    const imk_trajectory trajectory = day_of_eights();
    work.simulation.motion.trajectory = &trajectory;
    compare("npy_day_moving", &work);
    return 0;
}
