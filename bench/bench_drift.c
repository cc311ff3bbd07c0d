/* SPDX-License-Identifier: Apache-2.0 */
/* What drift costs, with every deterministic term at constant temperature, on six axes, and with
 * two lists of noise: the complete model of bench_simulate.c (N, B, K, Q and two Gauss-Markov), and
 * every term there is (N, B, K, R, Q, a Gauss-Markov, a sinusoid and a resonance).
 *
 *   drift_runs_complete, _complete_car   Monte Carlo at 100 Hz on one core, in millions of samples
 *   drift_every_term, _every_term_car    a second, of simulation and navigation together, at rest
 *                                        and through the car profile
 *   drift_1000_hours        a thousand runs of an hour at 100 Hz on two cores, with every term [s]
 *   drift_covariance_24h    covariance of a day with the budget of all terms [ms]
 *   drift_two_shards        two processes with --shard against one with all runs [s]
 *   drift_two_ranks         two ranks of imukit-mpi against one [s], where it has been built
 *   campaign_merge_1000     merging a thousand shards of one run [ms]
 *
 * There is nothing to compare the others with; their targets are a remark. */
#include "bench.h"

#include "car_profile.h"

#include "imukit/campaign.h"
#include "imukit/drift.h"
#include "imukit/thread_pool.h"

#include <sys/wait.h>
#include <unistd.h>

enum {
    RUNS = IMK_DRIFT_LANES,
    REPEATS = 25,
    THREADS = 2,
    SHARDS = 1000,
    TIMES_MAX = 24,
    COMMAND = 2048
};
static const double pi = 3.14159265358979323846;

static void *allocate(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory) {
        fprintf(stderr, "bench_drift: memory is exhausted\n");
        exit(1);
    }
    return memory;
}

static void expect(imk_status status, const imk_error *error)
{
    if (status != IMK_OK) {
        fprintf(stderr, "bench_drift: %s: %s %s\n", imk_status_name(status), error->field,
                error->expected);
        exit(1);
    }
}

static void remark(const char *what, double value, const char *unit, bool holds, const char *target)
{
    fprintf(stderr, "bench_drift: %s: %.3g %s; target %s: %s\n", what, value, unit, target,
            holds ? "holds" : "MISSED");
}

/* ---- the models --------------------------------------------------------------------------------
 */

static imk_axes axes(double value)
{
    return (imk_axes){.value = {value, value, value},
                      .sigma = {0.1 * value, 0.1 * value, 0.1 * value}};
}

static imk_rows rows(double value)
{
    imk_rows r = {.value = {{0.0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            r.value[i][j] = i == j ? 0.0 : value * (i + 2 * j + 1);
            r.sigma[i][j] = 0.1 * r.value[i][j];
        }
    return r;
}

/* Of a tactical unit; `size` is the unit of the bias [rad/s, m/s^2]. */
static void set_deterministic(imk_triad *triad, double size)
{
    triad->bias.fixed = triad->bias.repeatability = axes(size);
    triad->bias.warm_up_amplitude = axes(0.1 * size);
    triad->bias.warm_up_time.value = 300.0;
    triad->scale_factor.fixed = triad->scale_factor.repeatability = axes(1e-4);
    triad->nonlinearity.k2 = triad->nonlinearity.koq = axes(1e-5);
    triad->nonlinearity.k3 = axes(1e-6);
    triad->nonlinearity.asymmetry = axes(1e-5);
    triad->misalignment = rows(1e-5);
    triad->cross_axis = rows(1e-5);
    triad->range = axes(1000.0 * pi);
}

static void set_noise(imk_noise *noise, double size)
{
    noise->density = IMK_DENSITY_TWO_SIDED;
    noise->white = axes(3.0 * size);
    noise->bias_instability = axes(0.1 * size);
    noise->random_walk = axes(1e-3 * size);
    noise->quantization = axes(0.1 * size);
    noise->gauss_markov_count = 1;
    noise->gauss_markov[0].sigma = axes(0.1 * size);
    noise->gauss_markov[0].correlation_time = axes(300.0);
}

static void set_second_process(imk_noise *noise, double size)
{
    noise->gauss_markov_count = 2;
    noise->gauss_markov[1].sigma = axes(0.2 * size);
    noise->gauss_markov[1].correlation_time = axes(20.0);
}

static void set_other_terms(imk_noise *noise, double size)
{
    noise->ramp = axes(1e-6 * size);
    noise->sinusoid_count = noise->resonance_count = 1;
    noise->sinusoid[0].amplitude = axes(0.1 * size);
    noise->sinusoid[0].frequency = axes(20.0);
    noise->resonance[0].sigma = axes(0.1 * size);
    noise->resonance[0].frequency = axes(20.0);
    noise->resonance[0].q = axes(12.0);
}

static imk_model make_model(bool every_term)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    for (int i = 0; i < 2; i++) {
        const double size = i == 0 ? 5e-6 : 1e-2;
        set_deterministic(triads[i], size);
        set_noise(&triads[i]->noise, size);
        (every_term ? set_other_terms : set_second_process)(&triads[i]->noise, size);
    }
    model.gyro.g_sensitivity = rows(1e-8);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++)
            model.gyro.g2_sensitivity.value[i][j] = 1e-10 * (i + j + 1);
    model.accel.nonlinearity.cross_products = rows(1e-6);
    model.accel.lever_arm = rows(0.01);
    return model;
}

/* ---- Monte Carlo ------------------------------------------------------------------------------
 */

typedef struct monte_carlo {
    imk_model model;
    imk_drift_settings settings;
    uint32_t runs;
    void *memory[THREADS];
    size_t size;
    double *errors;
} monte_carlo;

static monte_carlo *make_campaign(bool every_term, const imk_trajectory *motion, const double *end,
                                  uint32_t runs)
{
    monte_carlo *c = allocate(sizeof *c);
    *c = (monte_carlo){
        .model = make_model(every_term), .settings = imk_drift_default(), .runs = runs};
    c->settings.motion = motion;
    c->settings.time = end;
    c->settings.time_count = 1;
    imk_error error = {0};
    expect(imk_drift_validate(&c->model, &c->settings, &error), &error);
    c->size = imk_drift_runs_workspace_size(&c->model, &c->settings);
    for (int i = 0; i < THREADS; i++)
        c->memory[i] = allocate(c->size);
    c->errors = allocate(runs * IMK_DRIFT_STATES * sizeof(double));
    return c;
}

static void free_campaign(monte_carlo *c)
{
    for (int i = 0; i < THREADS; i++)
        free(c->memory[i]);
    free(c->errors);
    free(c);
}

static void run_eight(monte_carlo *c, size_t thread, uint32_t first)
{
    imk_error error = {0};
    expect(imk_drift_runs(&c->model, &c->settings, 1, first, RUNS,
                          c->errors + first * IMK_DRIFT_STATES, c->memory[thread], c->size, &error),
           &error);
}

static void run_first(void *context)
{
    monte_carlo *c = context;
    run_eight(c, 0, 0);
    bench_use(c->errors);
}

static void bench_runs(const char *name, bool every_term, const imk_trajectory *motion,
                       const char *isa)
{
    /* Short, since the shortest of many is taken; long enough for the start to be a small part, as
     * it is of a campaign of hours. */
    const double end = 300.0;
    monte_carlo *c = make_campaign(every_term, motion, &end, RUNS);
    const double time = bench_best(REPEATS, run_first, c);
    const double speed = 1e-6 * RUNS * end * c->settings.rate / time;
    remark(name, speed, "M/s", speed >= 10.0, "10 M/s");
    bench_row_speed(name, speed, (double)NAN, "M/s", isa, 1);
    free_campaign(c);
}

static void bench_car(const char *isa)
{
    imk_motion_step step[CAR_PROFILE_STEPS];
    imk_motion_script script;
    imk_trajectory trajectory;
    imk_error error = {0};
    size_t count;
    car_profile(&script, step);
    expect(imk_motion_script_pieces(&script, &count, &error), &error);
    imk_trajectory_piece *piece = allocate(count * sizeof *piece);
    expect(imk_motion_script_compile(&script, piece, count, &trajectory, &error), &error);
    bench_runs("drift_runs_complete_car", false, &trajectory, isa);
    bench_runs("drift_every_term_car", true, &trajectory, isa);
    free(piece);
}

/* Each thread has a share of the runs: every other eight. */
static void run_share(void *context, size_t thread)
{
    monte_carlo *c = context;
    for (uint32_t first = RUNS * (uint32_t)thread; first < c->runs; first += RUNS * THREADS)
        run_eight(c, thread, first);
}

static void bench_hours(const char *isa)
{
    const double end = 3600.0;
    monte_carlo *c = make_campaign(true, NULL, &end, 1000);
    imk_thread_pool *pool = imk_thread_pool_create(THREADS);
    const imk_executor executor = imk_thread_pool_executor(pool);
    const double start = bench_now();
    imk_execute(&executor, THREADS, run_share, c);
    const double time = bench_now() - start;
    imk_thread_pool_destroy(pool);
    remark("drift_1000_hours", time, "s", time <= 30.0, "30 s");
    bench_row_time("drift_1000_hours", time, (double)NAN, "s", isa, THREADS);
    free_campaign(c);
}

/* ---- covariance -------------------------------------------------------------------------------
 */

typedef struct day {
    const imk_model *model;
    const imk_drift_settings *settings;
    void *memory;
    size_t size, sources;
} day;

static void run_day(void *context)
{
    day *d = context;
    imk_drift_analysis *analysis;
    imk_error error = {0};
    expect(imk_drift_covariance(d->model, d->settings, NULL, &analysis, d->memory, d->size, &error),
           &error);
    d->sources = analysis->source_count;
    bench_use(analysis);
}

static void bench_day(void)
{
    const imk_model model = make_model(true);
    double time[TIMES_MAX];
    for (int i = 0; i < TIMES_MAX; i++)
        time[i] = 3600.0 * (i + 1);
    imk_drift_settings settings = imk_drift_default();
    settings.time = time;
    settings.time_count = TIMES_MAX;
    day d = {.model = &model, .settings = &settings};
    d.size = imk_drift_covariance_size(&model, &settings);
    d.memory = allocate(d.size);
    const double ms = 1e3 * bench_best(REPEATS, run_day, &d);
    fprintf(stderr, "bench_drift: the budget of %zu sources at %d times\n", d.sources, TIMES_MAX);
    remark("drift_covariance_24h", ms, "ms", ms < 1000.0, "1 s");
    bench_row_time("drift_covariance_24h", ms, (double)NAN, "ms", "-", 1);
    free(d.memory);
}

/* ---- processes --------------------------------------------------------------------------------
 */

/* Start a shell command on a core; -1: on any. */
static pid_t begin(const char *command, int core)
{
    const pid_t child = fork();
    if (child == 0) {
        if (core >= 0) {
            cpu_set_t set;
            CPU_ZERO(&set);
            CPU_SET(core, &set);
            sched_setaffinity(0, sizeof set, &set);
        }
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    return child;
}

static bool end(pid_t child)
{
    int status;
    return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
}

static double time_of(size_t count, char command[][COMMAND], const int *core)
{
    pid_t child[THREADS];
    bool good = true;
    const double start = bench_now();
    for (size_t i = 0; i < count; i++)
        child[i] = begin(command[i], core[i]);
    for (size_t i = 0; i < count; i++)
        good = end(child[i]) && good;
    return good ? bench_now() - start : (double)NAN;
}

/* A file that is there already would not be computed again: PATH, command and PATH. */
#define CAMPAIGN                                                                                   \
    "rm -f %s; %s drift tactical --monte-carlo 1600 --duration 15min --threads 1 %s -o %s "        \
    ">/dev/null 2>&1"

/* The same runs by one process and by two at once, in turns; of one on the faster core. */
static void bench_shards(const char *directory, const char *isa)
{
    char whole[1][COMMAND], half[THREADS][COMMAND], path[256];
    double one = (double)INFINITY, two = (double)INFINITY;
    static const int cores[THREADS] = {0, 1};
    snprintf(path, sizeof path, "%s/whole.h5", directory);
    snprintf(whole[0], sizeof whole[0], CAMPAIGN, path, IMUKIT_COMMAND, "", path);
    for (int i = 0; i < THREADS; i++) {
        char shard[32];
        snprintf(shard, sizeof shard, "--shard %d/%d", i + 1, THREADS);
        snprintf(path, sizeof path, "%s/part%d.h5", directory, i);
        snprintf(half[i], sizeof half[i], CAMPAIGN, path, IMUKIT_COMMAND, shard, path);
    }
    for (int repeat = 0; repeat < 2; repeat++) {
        for (int core = 0; core < THREADS; core++)
            one = fmin(one, time_of(1, whole, &cores[core]));
        two = fmin(two, time_of(THREADS, half, cores));
    }
    remark("drift_two_shards", one / two, "times one process", one / two >= 1.9, "1.9");
    bench_row_time("drift_two_shards", two, one, "s", isa, THREADS);
}

static void bench_ranks(const char *directory, const char *isa)
{
    static const int any[1] = {-1};
    char command[1][COMMAND], path[256], name[256];
    double time[THREADS] = {(double)INFINITY, (double)INFINITY};
    snprintf(name, sizeof name, "%s-mpi", IMUKIT_COMMAND);
    if (access(name, X_OK) != 0) {
        fprintf(stderr, "bench_drift: no %s\n", name);
        return;
    }
    snprintf(path, sizeof path, "%s/ranks.h5", directory);
    for (int repeat = 0; repeat < 2; repeat++)
        for (int ranks = 1; ranks <= THREADS; ranks++) {
            char run[512];
            snprintf(run, sizeof run, "mpirun --allow-run-as-root --bind-to core -n %d %s", ranks,
                     name);
            snprintf(command[0], sizeof command[0], CAMPAIGN, path, run, "", path);
            time[ranks - 1] = fmin(time[ranks - 1], time_of(1, command, any));
        }
    remark("drift_two_ranks", time[0] / time[1], "times one rank", time[0] / time[1] >= 1.9, "1.9");
    bench_row_time("drift_two_ranks", time[1], time[0], "s", isa, THREADS);
}

/* ---- merging ----------------------------------------------------------------------------------
 */

static void write_shards(const char *directory, const imk_campaign *campaign, char **path)
{
    double values[TIMES_MAX * IMK_DRIFT_STATES];
    imk_error error = {0};
    for (uint64_t i = 0; i < SHARDS; i++) {
        uint64_t first, runs;
        imk_campaign_writer *writer;
        for (size_t k = 0; k < TIMES_MAX * IMK_DRIFT_STATES; k++)
            values[k] = (double)(i * 1000 + k) / 7.0;
        imk_campaign_shard(campaign->run_count, i + 1, SHARDS, &first, &runs);
        path[i] = allocate(256);
        snprintf(path[i], 256, "%s/shard%04d.h5", directory, (int)i);
        expect(imk_campaign_create(path[i], campaign, first, runs, &writer, &error), &error);
        expect(imk_campaign_add(writer, first, runs, values, &error), &error);
        expect(imk_campaign_commit(writer, &error), &error);
    }
}

static void bench_merge(const char *directory)
{
    static const char *const state[IMK_DRIFT_STATES] = {"a", "b", "c", "d", "e",
                                                        "f", "g", "h", "i"};
    static const char *const unit[IMK_DRIFT_STATES] = {"m", "m", "m", "m", "m", "m", "m", "m", "m"};
    double time[TIMES_MAX];
    for (int i = 0; i < TIMES_MAX; i++)
        time[i] = i + 1;
    const imk_campaign campaign = {.version = "bench",
                                   .parameters = "{}",
                                   .seed = 1,
                                   .run_count = SHARDS,
                                   .time_count = TIMES_MAX,
                                   .time = time,
                                   .state_count = IMK_DRIFT_STATES,
                                   .state = state,
                                   .unit = unit};
    char *path[SHARDS], output[256];
    write_shards(directory, &campaign, path);
    snprintf(output, sizeof output, "%s/merged.h5", directory);
    imk_campaign_merge_report report = {.complaint = allocate(SHARDS * sizeof *report.complaint)};
    double best = (double)INFINITY;
    for (int repeat = 0; repeat < 3; repeat++) {
        imk_error error = {0};
        const double start = bench_now();
        expect(
            imk_campaign_merge(SHARDS, (const char *const *)path, output, false, &report, &error),
            &error);
        best = fmin(best, bench_now() - start);
    }
    remark("campaign_merge_1000", 1e3 * best, "ms", best < 1.0, "1 s");
    bench_row_time("campaign_merge_1000", 1e3 * best, (double)NAN, "ms", "-", 1);
    for (int i = 0; i < SHARDS; i++)
        free(path[i]);
    free(report.complaint);
}

int main(void)
{
    const char *isa = imk_kernel_name(imk_random_seeded(0).kernel);
    bench_pin();
    bench_runs("drift_runs_complete", false, NULL, isa);
    bench_runs("drift_every_term", true, NULL, isa);
    bench_car(isa);
    bench_day();
    char directory[] = "/tmp/imukit_bench_XXXXXX", command[64];
    if (!mkdtemp(directory))
        return 1;
    bench_merge(directory);
    bench_unpin();
    bench_shards(directory, isa);
    bench_ranks(directory, isa);
    bench_hours(isa);
    snprintf(command, sizeof command, "rm -r %s", directory);
    return system(command) == 0 ? 0 : 1;
}
