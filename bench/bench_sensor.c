/* SPDX-License-Identifier: Apache-2.0 */
/* Speed of a sensor that is stepped, six channels. It first compares a million steps of three
 * models with what the simulator makes of the same motion, byte for byte, and ends if they differ.
 *
 *   step_complete         one sensor: the mean of a step [ns], against drawing its normals alone
 *   step_white_and_walk   the same of a model with white noise and random walk alone
 *   step_longest          the step that makes 512 samples of noise ahead, and the longest of others
 *                         beside it [us]
 *   batch_…               4096 sensors, one motion each: millions of steps of a sensor in a second,
 *                         against drawing their normals alone
 *   batch_…_shared        the same, one motion for all
 *   batch_longest         of 4096 sensors with a motion each, complete: the longest step of a
 * block, and the mean beside it [ms] memory_…              of a sensor [KiB] */
#include "bench.h"
#include "complete_model.h"

#include "imukit/noise.h"
#include "imukit/sensor.h"
#include "imukit/simulate.h"

enum { CHANNELS = 6, QUANTITIES = 11, SENSORS = 4096, BLOCK = IMK_NOISE_BLOCK };

static void *need(void *memory)
{
    if (!memory) {
        fprintf(stderr, "bench: no memory\n");
        exit(1);
    }
    return memory;
}

/* In memory of its own, which free() gives back. */
static imk_sensor *start(const imk_model *model, size_t count, double rate, void **memory)
{
    imk_sensor_settings settings = imk_sensor_default();
    imk_sensor *sensor = NULL;
    settings.rate = rate;
    settings.count = count;
    settings.temperature = true;
    const size_t size = imk_sensor_size(model, &settings);
    *memory = need(malloc(size));
    if (imk_sensor_start(model, &settings, &sensor, *memory, size, NULL) != IMK_OK) {
        fprintf(stderr, "bench: the sensor does not start\n");
        exit(1);
    }
    return sensor;
}

static size_t size_of(const imk_model *model, size_t count)
{
    imk_sensor_settings settings = imk_sensor_default();
    settings.count = count;
    settings.temperature = true;
    return imk_sensor_size(model, &settings);
}

static imk_model white_and_walk(void)
{
    imk_model model;
    imk_model_default(&model);
    each_triad(&model, set_white);
    each_triad(&model, set_walk);
    return model;
}

static imk_model complete(void)
{
    imk_model model;
    imk_model_default(&model);
    set_everything(&model);
    return model;
}

/* ---- the same bytes as a simulation ---- */

enum { COMPARED = 1000000 };

static const double profile_time[] = {0.0, 3e3, 7e3, 1e4},
                    profile_temperature[] = {290.0, 330.0, 270.0, 310.0};
static const imk_temperature_profile profile = {.point_count = 4,
                                                .time = profile_time,
                                                .temperature = profile_temperature,
                                                .time_constant = 30.0};

static void set_rest(imk_triad *triad)
{
    set_sinusoid(triad);
    set_resonance(triad);
    triad->noise.ramp = triad->noise.angle_white = axes(1e-8);
    triad->noise.reading_noise = axes(1e-7);
    triad->bandwidth = axes(30.0);
    triad->damping = axes(0.7);
    triad->range = axes(0.9);
}

static double *truth_of(double rate)
{
    double *row = need(malloc(QUANTITIES * COMPARED * sizeof *row));
    double *time = need(malloc(COMPARED * sizeof *time));
    for (int i = 0; i < 9; i++)
        for (size_t k = 0; k < COMPARED; k++)
            row[(size_t)i * COMPARED + k] = sin(1e-3 * (double)k * (i + 1) + i);
    for (size_t k = 0; k < COMPARED; k++)
        time[k] = ((double)k - 0.5) * (1.0 / rate);
    imk_temperature_at(&profile, COMPARED, time, row + (size_t)9 * COMPARED,
                       row + (size_t)10 * COMPARED);
    free(time);
    return row;
}

static imk_sensor_truth at(const double *row, size_t k)
{
    double value[QUANTITIES];
    for (int i = 0; i < QUANTITIES; i++)
        value[i] = row[(size_t)i * COMPARED + k];
    return (imk_sensor_truth){{value[0], value[1], value[2]},
                              {value[3], value[4], value[5]},
                              {value[6], value[7], value[8]},
                              value[9],
                              value[10]};
}

static void compare(const char *name, const imk_model *model, const double *row, double rate)
{
    enum { CALL = 4096 };
    static double log[CHANNELS][CALL];
    double *const columns[CHANNELS] = {log[0], log[1], log[2], log[3], log[4], log[5]};
    imk_recorded_motion motion = {.count = COMPARED, .rate = rate};
    for (size_t i = 0; i < 3; i++) {
        motion.angular_rate[i] = row + i * COMPARED;
        motion.specific_force[i] = row + (3 + i) * COMPARED;
        motion.angular_acceleration[i] = row + (6 + i) * COMPARED;
    }
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = rate;
    simulation.motion.recorded = &motion;
    simulation.temperature = &profile;
    const size_t size = imk_simulator_size(model, &simulation);
    void *memory = need(malloc(size)), *sensor_memory;
    imk_simulator *simulator = NULL;
    imk_sensor *sensor = start(model, 1, rate, &sensor_memory);
    size_t different =
        imk_simulator_start(model, &simulation, &simulator, memory, size, NULL) != IMK_OK;
    for (size_t k = 0; k < COMPARED && different == 0; k++) {
        double readings[CHANNELS];
        const imk_sensor_truth now = at(row, k);
        if (k % CALL == 0)
            imk_simulator_next(simulator, CALL, columns, NULL);
        if (imk_sensor_step(sensor, &now, readings) != IMK_OK)
            different++;
        for (size_t c = 0; c < CHANNELS; c++)
            different += memcmp(&readings[c], &log[c][k % CALL], sizeof readings[c]) != 0;
    }
    free(memory);
    free(sensor_memory);
    fprintf(stderr, "bench: %s: %s\n", name,
            different ? "NOT the bytes of a simulation" : "1e6 steps, the bytes of a simulation");
    if (different)
        exit(1);
}

static void compare_models(void)
{
    static const double rate = 100.0;
    double *row = truth_of(rate);
    imk_model everything = complete(), device;
    each_triad(&everything, set_rest);
    imk_device_model(imk_device_get(0), &device);
    device.accel.sensitivity = axes(1000.0);
    const imk_model simple = white_and_walk();
    compare("every term", &everything, row, rate);
    compare(imk_device_get(0)->name, &device, row, rate);
    compare("white noise and random walk", &simple, row, rate);
    free(row);
}

/* ---- speed ---- */

/* Steps of some blocks, so that each repetition makes noise as often as it uses it. */
typedef struct job {
    imk_sensor *sensor;
    size_t count, steps;
    bool shared;
    double *truth[QUANTITIES], *readings;
} job;

static void run_job(void *context)
{
    const job *work = context;
    imk_stimulus each = {.temperature = work->truth[9], .temperature_rate = work->truth[10]};
    for (int i = 0; i < 3; i++) {
        each.angular_rate[i] = work->truth[i];
        each.specific_force[i] = work->truth[3 + i];
        each.angular_acceleration[i] = work->truth[6 + i];
    }
    imk_sensor_truth all = {.specific_force = {0.1, 0.2, -9.8}, .temperature = 300.0};
    for (size_t k = 0; k < work->steps; k++) {
        if (work->shared) {
            all.angular_rate[0] = 1e-3 * (double)k;
            all.temperature += 1e-5;
            (void)imk_sensor_step(work->sensor, &all, work->readings);
        } else {
            work->truth[9][k % work->count] += 1e-5;
            (void)imk_sensor_step_each(work->sensor, &each, work->readings);
        }
    }
    bench_use(work->readings);
}

typedef struct draws {
    imk_random random;
    size_t count; /* normals */
} draws;

static void run_draws(void *context)
{
    enum { DRAW = 4096 };
    static double normals[DRAW];
    const draws *work = context;
    size_t left = work->count;
    for (uint64_t stream = 0; left > 0; stream++) {
        const size_t count = left < DRAW ? left : DRAW;
        imk_random_normals(work->random, stream, 0, count, normals);
        bench_use(normals);
        left -= count;
    }
}

static job job_of(imk_sensor *sensor, size_t count, size_t steps, bool shared)
{
    job work = {sensor, count, steps, shared, {NULL}, need(malloc(CHANNELS * count * 8))};
    for (int i = 0; i < QUANTITIES; i++) {
        work.truth[i] = need(aligned_alloc(64, (count * 8 + 63) / 64 * 64));
        for (size_t k = 0; k < count; k++)
            work.truth[i][k] = i == 9 ? 300.0 : 0.1 * i + 1e-4 * (double)k;
    }
    return work;
}

static void end_job(job *work)
{
    for (int i = 0; i < QUANTITIES; i++)
        free(work->truth[i]);
    free(work->readings);
}

static void bench_one(const char *name, const imk_model *model, int hundredths, const char *isa)
{
    void *memory;
    imk_sensor *sensor = start(model, 1, 100.0, &memory);
    const size_t steps = (size_t)64 * BLOCK;
    job work = job_of(sensor, 1, steps, true);
    draws normals = {imk_random_seeded(1), steps * CHANNELS * (size_t)hundredths / 100};
    double ours, drawing;
    bench_compare(40, run_job, &work, run_draws, &normals, &ours, &drawing);
    bench_row_time(name, 1e9 * ours / (double)steps, 1e9 * drawing / (double)steps, "ns", isa, 1);
    end_job(&work);
    free(memory);
}

/* Shortest times of the same step in many blocks. */
static void bench_longest(const imk_model *model, const char *isa)
{
    void *memory;
    imk_sensor *sensor = start(model, 1, 100.0, &memory);
    job work = job_of(sensor, 1, 1, true);
    double first = (double)INFINITY, others = 0.0;
    static double best[BLOCK];
    for (int k = 0; k < BLOCK; k++) /* the first was made at the start */
        run_job(&work);
    for (int block = 0; block < 200; block++)
        for (size_t k = 0; k < BLOCK; k++) {
            const double time = bench_once(run_job, &work);
            best[k] = block == 0 ? time : fmin(best[k], time);
        }
    first = best[0];
    for (size_t k = 1; k < BLOCK; k++)
        others = fmax(others, best[k]);
    bench_row_time("step_longest", 1e6 * first, 1e6 * others, "us", isa, 1);
    end_job(&work);
    free(memory);
}

static void bench_batch(const char *name, const imk_model *model, int hundredths, bool shared,
                        const char *isa)
{
    void *memory;
    imk_sensor *sensor = start(model, SENSORS, 100.0, &memory);
    const size_t steps = BLOCK, all = SENSORS * steps;
    job work = job_of(sensor, SENSORS, steps, shared);
    draws normals = {imk_random_seeded(1), all / 100 * CHANNELS * (size_t)hundredths};
    double ours, drawing;
    bench_compare(16, run_job, &work, run_draws, &normals, &ours, &drawing);
    bench_row_speed(name, 1e-6 * (double)all / ours, 1e-6 * (double)all / drawing, "M/s", isa, 1);
    end_job(&work);
    free(memory);
}

/* Shortest times of the same step in some blocks. */
static void bench_longest_of_batch(const imk_model *model, const char *isa)
{
    void *memory;
    imk_sensor *sensor = start(model, SENSORS, 100.0, &memory);
    job work = job_of(sensor, SENSORS, 1, false);
    static double best[BLOCK];
    double longest = 0.0, mean = 0.0;
    for (int k = 0; k < BLOCK; k++)
        run_job(&work);
    for (int block = 0; block < 6; block++)
        for (size_t k = 0; k < BLOCK; k++) {
            const double time = bench_once(run_job, &work);
            best[k] = block == 0 ? time : fmin(best[k], time);
        }
    for (size_t k = 0; k < BLOCK; k++) {
        longest = fmax(longest, best[k]);
        mean += best[k] / BLOCK;
    }
    bench_row_time("batch_longest", 1e3 * longest, 1e3 * mean, "ms", isa, 1);
    end_job(&work);
    free(memory);
}

int main(void)
{
    bench_pin();
    const char *isa = imk_kernel_name(imk_random_seeded(0).kernel);
    const imk_model everything = complete(), simple = white_and_walk();
    compare_models();
    bench_one("step_complete", &everything, COMPLETE_NORMALS, isa);
    bench_one("step_white_and_walk", &simple, 200, isa);
    bench_longest(&everything, isa);
    bench_batch("batch_complete", &everything, COMPLETE_NORMALS, false, isa);
    bench_batch("batch_complete_shared", &everything, COMPLETE_NORMALS, true, isa);
    bench_batch("batch_white_and_walk", &simple, 200, false, isa);
    bench_batch("batch_white_and_walk_shared", &simple, 200, true, isa);
    bench_longest_of_batch(&everything, isa);
    const double kib = 1024.0;
    bench_row_time("memory_one", (double)size_of(&everything, 1) / kib, (double)NAN, "KiB", "-", 1);
    bench_row_time("memory_of_4096", (double)size_of(&everything, SENSORS) / kib / SENSORS,
                   (double)NAN, "KiB", "-", 1);
    return 0;
}
