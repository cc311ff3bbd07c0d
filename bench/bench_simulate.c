/* SPDX-License-Identifier: Apache-2.0 */
/* Speed of simulating six channels, in ns per row of six:
 *
 *   white_and_walk        white noise and random walk, against the C++ loop of mt19937_loop.cpp
 *   white_and_walk_2      the same on two threads, against one thread: the ratio is the speed-up
 *   complete              every deterministic term of a moving unit whose temperature changes, N,
 *                         B, K, two Gauss-Markov and Q, against drawing its normals alone: the
 *                         yardstick's share of our time. The motion is given (a recorded one)
 *   complete_against_loop the same against the C++ loop, which has white noise and random walk only
 *   terms one by one      each alone, against the normals it draws */
#include "bench.h"
#include "complete_model.h"

#include "imukit/simulate.h"
#include "imukit/thread_pool.h"

/* Calls of 8192 rows, whose columns stay in cache, for one thread; of 65536, as the command makes
 * them, for two. Short runs, because the shortest of many is taken. */
enum { CALL = 8192, CALLS = 6, ROWS = CALL * CALLS, CHANNELS = 6, REPEATS = 40 };
enum { LONG_CALL = 65536, LONG_CALLS = 4 };

static double block[CHANNELS][LONG_CALL];

typedef struct job {
    imk_simulator *simulator;
    const imk_executor *executor;
    bool long_calls;
} job;

static void run_job(void *context)
{
    const job *work = context;
    double *const columns[CHANNELS] = {block[0], block[1], block[2], block[3], block[4], block[5]};
    for (int i = 0; i < (work->long_calls ? LONG_CALLS : CALLS); i++)
        imk_simulator_next(work->simulator, work->long_calls ? LONG_CALL : CALL, columns,
                           work->executor);
    bench_use(block);
}

/* Normals in hundredths per sample and channel, in long draws: at the speed of bench_normals. */
typedef struct draws {
    imk_random random;
    int hundredths;
} draws;

static void run_draws(void *context)
{
    enum { DRAW = 4096 };
    const draws *work = context;
    size_t left = (size_t)ROWS * CHANNELS / 100 * (size_t)work->hundredths;
    for (uint64_t stream = 0; left > 0; stream++) {
        const size_t count = left < DRAW ? left : DRAW;
        imk_random_normals(work->random, stream, 0, count, block[0]);
        bench_use(block);
        left -= count;
    }
}

/* A motion known row by row, and a temperature that rises and falls as a table says, without the
 * lag of the unit: what they cost is not the model's. The rows fit the cache and are aligned to its
 * lines, as those of a trajectory are, which are made a stretch at a time just before they are
 * used. */
enum { MOTION_CALLS = 2, MOTION_ROWS = CALL * MOTION_CALLS };

static imk_recorded_motion make_motion(void)
{
    imk_recorded_motion motion = {.count = MOTION_ROWS, .rate = 100.0};
    for (int i = 0; i < 3; i++) {
        double *column[3];
        for (int c = 0; c < 3; c++) {
            column[c] = aligned_alloc(64, MOTION_ROWS * sizeof(double));
            for (size_t k = 0; column[c] && k < MOTION_ROWS; k++)
                column[c][k] = sin(1e-3 * (double)k * (i + 1) + c);
        }
        motion.angular_rate[i] = column[0];
        motion.specific_force[i] = column[1];
        motion.angular_acceleration[i] = column[2];
    }
    return motion;
}

static const double profile_time[] = {0.0, 6e3, 2e4};
static const double profile_temperature[] = {290.0, 330.0, 280.0};
static const imk_temperature_profile profile = {
    .point_count = 3, .time = profile_time, .temperature = profile_temperature};

static imk_simulation simulation_of(const imk_recorded_motion *motion)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.recorded = motion;
    simulation.temperature = motion ? &profile : NULL;
    return simulation;
}

static void *memory_for(const imk_model *model, const imk_simulation *simulation)
{
    return aligned_alloc(64, (imk_simulator_size(model, simulation) + 63) / 64 * 64);
}

/* A simulator stands at the beginning of its memory, which free() gives back. */
static imk_simulator *start(const imk_model *model, const imk_simulation *simulation, void *memory)
{
    imk_simulator *simulator = NULL;
    if (!memory || imk_simulator_start(model, simulation, &simulator, memory,
                                       imk_simulator_size(model, simulation), NULL) != IMK_OK) {
        fprintf(stderr, "bench: the simulator does not start\n");
        exit(1);
    }
    return simulator;
}

static imk_simulator *start_at_rest(const imk_model *model)
{
    const imk_simulation simulation = simulation_of(NULL);
    return start(model, &simulation, memory_for(model, &simulation));
}

static const double per_row = 1e9 / ROWS;

static void bench_against_loop(const char *isa)
{
    imk_model model;
    imk_model_default(&model);
    each_triad(&model, set_white);
    each_triad(&model, set_walk);
    job work = {start_at_rest(&model), NULL, false};
    double ours = (double)INFINITY, loop = (double)INFINITY;
    for (int i = 0; i < 3; i++) {
        ours = fmin(ours, bench_best(REPEATS, run_job, &work) * per_row);
        loop = fmin(loop, bench_program(BENCH_DIRECTORY "/mt19937_loop 20000 30 2>/dev/null"));
    }
    bench_row_time("white_and_walk", ours, loop, "ns/row", isa, 1);

    bench_unpin();
    imk_thread_pool *pool = imk_thread_pool_create(2);
    imk_executor executor = imk_thread_pool_executor(pool);
    job one = {work.simulator, NULL, true}, two = {work.simulator, &executor, true};
    double one_time, two_time;
    const double per_long_row = 1e9 / (LONG_CALL * LONG_CALLS);
    bench_two_core_limit("white_and_walk_2", REPEATS, run_job, &one);
    bench_compare(REPEATS, run_job, &two, run_job, &one, &two_time, &one_time);
    bench_row_time("white_and_walk_2", two_time * per_long_row, one_time * per_long_row, "ns/row",
                   isa, 2);
    imk_thread_pool_destroy(pool);
    bench_pin();
    free(work.simulator);
}

static void bench_against_normals(const char *name, void (*set)(imk_triad *triad), int hundredths,
                                  const char *isa)
{
    imk_model model;
    imk_model_default(&model);
    each_triad(&model, set);
    job work = {start_at_rest(&model), NULL, false};
    draws normals = {imk_random_seeded(1), hundredths};
    double ours, drawing;
    bench_compare(REPEATS, run_job, &work, hundredths > 0 ? run_draws : NULL, &normals, &ours,
                  &drawing);
    bench_row_time(name, ours * per_row, drawing * per_row, "ns/row", isa, 1);
    free(work.simulator);
}

static void run_moving(void *context)
{
    const job *work = context;
    double *const columns[CHANNELS] = {block[0], block[1], block[2], block[3], block[4], block[5]};
    for (int i = 0; i < MOTION_CALLS; i++)
        imk_simulator_next(work->simulator, CALL, columns, work->executor);
    bench_use(block);
}

/* Every repetition begins anew, at the beginning of the motion; the start is not timed. */
static void bench_complete(const char *isa)
{
    const imk_recorded_motion motion = make_motion();
    imk_model model;
    imk_model_default(&model);
    set_everything(&model);
    draws normals = {imk_random_seeded(1), COMPLETE_NORMALS};
    double ours = (double)INFINITY, drawing = (double)INFINITY, loop = (double)INFINITY;
    const imk_simulation simulation = simulation_of(&motion);
    void *memory = memory_for(&model, &simulation);
    for (int i = 0; i < 3 * REPEATS; i++) {
        job work = {start(&model, &simulation, memory), NULL, false};
        ours = fmin(ours, bench_once(run_moving, &work) / MOTION_ROWS * 1e9);
        drawing = fmin(drawing, bench_once(run_draws, &normals) * per_row);
    }
    free(memory);
    for (int i = 0; i < 3; i++)
        loop = fmin(loop, bench_program(BENCH_DIRECTORY "/mt19937_loop 20000 30 2>/dev/null"));
    bench_row_time("complete", ours, drawing, "ns/row", isa, 1);
    bench_row_time("complete_against_loop", ours, loop, "ns/row", isa, 1);
    for (int i = 0; i < 3; i++) {
        free((void *)motion.angular_rate[i]);
        free((void *)motion.specific_force[i]);
        free((void *)motion.angular_acceleration[i]);
    }
}

int main(void)
{
    bench_pin();
    const char *isa = imk_kernel_name(imk_random_seeded(0).kernel);
    bench_against_loop(isa);
    bench_complete(isa);
    bench_against_normals("complete_noise", set_complete_noise, COMPLETE_NORMALS, isa);
    bench_against_normals("white", set_white, 100, isa);
    bench_against_normals("random_walk", set_walk, 100, isa);
    bench_against_normals("gauss_markov", set_gauss_markov, 100, isa);
    bench_against_normals("flicker", set_flicker, 233, isa);
    bench_against_normals("quantization", set_quantization, 0, isa);
    bench_against_normals("resonance", set_resonance, 100, isa);
    bench_against_normals("sinusoid", set_sinusoid, 0, isa);
    return 0;
}
