/* SPDX-License-Identifier: Apache-2.0 */
/* How fast the instruments run: simulated seconds per second, on one core.
 *
 * Rows physics_NAME: as users run them, with noise and an input that changes from sample to sample,
 * at the step that the tests' check values hold for: the default one, and 10 us for accelerometers.
 * Their targets are a remark. Rows cvode_NAME: without noise, beside CVODE of SUNDIALS at equal
 * accuracy. The equations are those of the instrument's header, written anew for CVODE
 * (instrument_equations.c); the truth is a far finer solution of them by extrapolation
 * (ode_yardstick.c). CVODE gets the loosest of the tolerances 1e-1, 1e-2, … with which it and the
 * next tighter one are at least as accurate as we are, and the faster of its two methods. Both
 * solve the same run of the same length. Nothing is asserted here: the tests do that. */
#include "bench.h"

#include "instrument_equations.h"

#include "imukit/fibre_optic.h"
#include "imukit/instrument.h"
#include "physics/tuning_fork/tuning_fork_internal.h"

enum { REPEATS = 5, MANY = 40, TABLE = 256 };
static const double pi = 3.14159265358979323846;
static const double degree = 3.14159265358979323846 / 180.0, gravity = 9.80665;

/* ---- instruments ----------------------------------------------------------------------------- */

/* An instrument as it is run. */
typedef struct subject {
    const char *name;
    const imk_instrument *instrument;
    const void *design;
    imk_physics_settings settings;
    const imk_exposure *exposure; /* TABLE of them, in turn */
    const char *cycle;            /* what the step is to be compared with: "nutation" */
    double frequency;             /* of it [Hz]; 0: nothing */
} subject;

static void *allocate(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory) {
        fprintf(stderr, "bench_physics: memory is exhausted\n");
        exit(1);
    }
    memset(memory, 0, size);
    return memory;
}

static void *started(const subject *s)
{
    imk_error error = {0};
    void *state = allocate(s->instrument->state_size);
    if (imk_instrument_init(s->instrument, s->design, &s->settings, state, &error) != IMK_OK) {
        fprintf(stderr, "bench_physics: %s: the design is refused: %s %s\n", s->name, error.field,
                error.expected);
        exit(1);
    }
    return state;
}

static imk_physics_settings settings_of(imk_level level, double rate, bool noise)
{
    imk_physics_settings settings = imk_physics_default();
    settings.level = level;
    settings.rate = rate;
    settings.noise = noise;
    return settings;
}

/* Input: a sine, held over a sample; `offset` and amplitude of both kinds of input. */
static imk_exposure *inputs(double offset, double amplitude, bool force)
{
    imk_exposure *table = allocate(TABLE * sizeof *table);
    for (int i = 0; i < TABLE; i++) {
        table[i] = imk_exposure_default();
        double *axis = force ? table[i].specific_force : table[i].angular_rate;
        axis[0] = offset + amplitude * sin(2.0 * pi * 5.0 * i / TABLE);
    }
    return table;
}

/* ---- speed ----------------------------------------------------------------------------------- */

typedef struct running {
    const subject *subject;
    void *state;
    size_t samples;
} running;

static void run(void *context)
{
    const running *r = context;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    for (size_t i = 0; i < r->samples; i++)
        r->subject->instrument->step(r->state, &r->subject->exposure[i % TABLE], outputs);
    bench_use(outputs);
}

static double step_of(const subject *s)
{
    return s->settings.step > 0.0 ? s->settings.step
                                  : s->instrument->step_length(s->design, &s->settings);
}

static void print_step(const subject *s)
{
    const double step = step_of(s);
    fprintf(stderr, "bench_physics: %s: step %.4g us", s->name, 1e6 * step);
    if (s->frequency > 0.0)
        fprintf(stderr, ", %.1f to a cycle of the %s", 1.0 / (s->frequency * step), s->cycle);
}

/* A row with noise. `target` is in simulated seconds per second; 0: none. */
static void speed(const subject *s, double target)
{
    char name[64];
    running r = {s, started(s), 1};
    while (bench_once(run, &r) < 0.005)
        r.samples *= 2;
    const double time = bench_best(MANY, run, &r);
    const double simulated = (double)r.samples / s->settings.rate;
    snprintf(name, sizeof name, "physics_%s", s->name);
    print_step(s);
    fprintf(stderr, ", %.3g ns each", 1e9 * time * step_of(s) / simulated);
    if (target > 0.0)
        fprintf(stderr, "; target %g: %s (%.4g)", target,
                simulated / time >= target ? "holds" : "MISSED", simulated / time);
    fprintf(stderr, "\n");
    bench_row_speed(name, simulated / time, (double)NAN, "s/s",
                    imk_kernel_name(imk_random_seeded(0).kernel), 1);
    free(r.state);
}

/* ---- beside CVODE ---------------------------------------------------------------------------- */

/* The same run of both. Readings of ours are signals times a scale; signal -1: output 0. */
typedef struct comparison {
    subject subject;
    const void *start; /* state of the instrument at the beginning */
    size_t samples, pieces_per_sample;
    int signal[ODE_READINGS_MAX];
    double scale[ODE_READINGS_MAX];
    int forms; /* of the same equations: CVODE gets the one that suits it */
    ode_problem form[2];
    double unit; /* in which errors are told */
    const char *unit_name;
    void *state; /* to run in */
    double *readings;
} comparison;

static void run_ours(void *context)
{
    comparison *c = context;
    const imk_instrument *instrument = c->subject.instrument;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    memcpy(c->state, c->start, instrument->state_size);
    for (size_t i = 0; i < c->samples; i++) {
        instrument->step(c->state, &c->subject.exposure[i % TABLE], outputs);
        if (!c->readings)
            continue;
        instrument->observe(c->state, signals);
        for (int k = 0; k < c->form[0].readings; k++)
            c->readings[i * (size_t)c->form[0].readings + (size_t)k] =
                c->scale[k] * (c->signal[k] < 0 ? outputs[0] : signals[c->signal[k]]);
    }
    bench_use(outputs);
}

typedef struct choice {
    const ode_problem *problem;
    ode_method method;
    double tolerance, error, time;
    long calls;
    bool good;
} choice;

static void run_cvode(void *context)
{
    choice *c = context;
    if (!ode_cvode(c->problem, c->method, c->tolerance, INT64_MAX / 2, NULL, &c->calls))
        c->good = false;
}

/* The loosest tolerance that is good enough together with the next tighter one (by itself it might
 * be so by chance), or the most accurate there is. */
static choice find_tolerance(const ode_problem *problem, ode_method method, const double *truth,
                             double bound, long most, double *readings)
{
    choice loosest = {.error = (double)INFINITY};
    for (int decade = 1; decade <= 14; decade++) {
        choice now = {.problem = problem, .method = method, .tolerance = pow(10.0, -decade)};
        if (!ode_cvode(problem, method, now.tolerance, most, readings, &now.calls))
            break;
        now.error = ode_distance(problem, 1, truth, readings);
        now.good = now.error <= bound;
        if (now.good && loosest.good)
            break;
        if (now.good || loosest.good || now.error < loosest.error)
            loosest = now;
    }
    return loosest;
}

static choice find_cvode(comparison *c, const double *truth, double bound, double *readings)
{
    choice best = {.time = (double)INFINITY};
    long most = 5000000;
    for (int form = 0; form < c->forms; form++)
        for (int method = ODE_ADAMS; method <= ODE_BDF; method++) {
            choice found =
                find_tolerance(&c->form[form], (ode_method)method, truth, bound, most, readings);
            if (!isfinite(found.error) || (best.good && !found.good))
                continue;
            found.time = bench_best(1, run_cvode, &found);
            if (found.good == best.good ? found.time < best.time : found.good)
                best = found;
            if (best.good)
                most = 5 * best.calls;
        }
    return best;
}

static void remark(const comparison *c, double error, double doubt, const choice *best)
{
    print_step(&c->subject);
    fprintf(stderr, ", %g s without noise: error %.2g %s (the reference is good to %.1g)",
            (double)c->samples / c->subject.settings.rate, error * c->unit, c->unit_name,
            doubt * c->unit);
    if (!isfinite(best->time)) {
        fprintf(stderr, "; no yardstick: %s\n",
                ode_has_cvode() ? "CVODE gave up" : "built without SUNDIALS");
        return;
    }
    fprintf(stderr, "; CVODE by %s, tolerance %.0e%s: error %.2g %s, %ld calls%s\n",
            best->method == ODE_ADAMS ? "Adams" : "BDF", best->tolerance,
            best->problem == &c->form[1] ? ", rotation and dither taken out" : "",
            best->error * c->unit, c->unit_name, best->calls,
            best->good ? "" : ", its best: NOT as accurate as ours");
}

static void compare(comparison *c)
{
    const ode_problem *problem = &c->form[0];
    const size_t pieces = c->samples * c->pieces_per_sample;
    for (int i = 0; i < c->forms; i++) {
        c->form[i].pieces = pieces;
        c->form[i].piece = 1.0 / (c->subject.settings.rate * (double)c->pieces_per_sample);
    }
    const size_t size = pieces * (size_t)problem->readings * sizeof(double);
    double *truth = allocate(size), *finer = allocate(size), *ours = allocate(size);
    c->state = allocate(c->subject.instrument->state_size);
    c->readings = ours;
    run_ours(c);
    c->readings = NULL;
    const double step = fmin(problem->reference_step, problem->piece);
    ode_reference(problem, step, finer);
    ode_reference(problem, 0.6 * step, truth);
    const double doubt = ode_distance(problem, 1, truth, finer);
    const double error = ode_distance(problem, c->pieces_per_sample, truth, ours);
    choice best = {.time = (double)INFINITY};
    if (ode_has_cvode())
        best = find_cvode(c, truth, fmax(error, doubt), finer);
    double ours_time, cvode_time = (double)NAN;
    const bool found = isfinite(best.time);
    choice usual = best;
    usual.tolerance = 1e-6;
    bench_compare(REPEATS, run_ours, c, found ? run_cvode : NULL, &best, &ours_time, &cvode_time);
    ours_time = fmin(ours_time, bench_best(MANY, run_ours, c));
    remark(c, error, doubt, &best);
    const double simulated = (double)c->samples / c->subject.settings.rate;
    if (found &&
        ode_cvode(best.problem, best.method, usual.tolerance, INT64_MAX / 2, finer, &usual.calls))
        fprintf(stderr,
                "bench_physics: %s: CVODE at a tolerance of 1e-6: error %.2g %s, %.3g s/s\n",
                c->subject.name, ode_distance(problem, 1, truth, finer) * c->unit, c->unit_name,
                simulated / bench_best(2, run_cvode, &usual));
    char name[64];
    snprintf(name, sizeof name, "cvode_%s", c->subject.name);
    bench_row_speed(name, simulated / ours_time, simulated / cvode_time, "s/s", "-", 1);
    free(truth);
    free(finer);
    free(ours);
    free(c->state);
}

/* ---- the instruments ------------------------------------------------------------------------- */

/* The gyro of the check values, nutation 269 Hz; with noise, that of the default design. */
static void bench_free_gyro(void)
{
    imk_free_gyro design = imk_free_gyro_default();
    design.rotor_polar = 5e-5;
    design.spin_rate = 2000.0;
    design.rotor_transverse = 4e-5;
    for (int i = 0; i < 3; i++) {
        design.outer_inertia[i] = 2e-5;
        design.inner_inertia[i] = 1e-5;
        design.unbalance[i] = design.compliance[i] = 0.0;
    }
    design.viscous_friction = design.coulomb_friction = 0.0;
    imk_exposure *moving = inputs(0.1, 0.2, false), *still = inputs(0.0, 0.0, false);
    subject s = {"free_gyro",
                 &imk_free_gyro_instrument,
                 &design,
                 settings_of(IMK_LEVEL_FULL, 100.0, true),
                 moving,
                 "nutation",
                 imk_free_gyro_nutation(&design, 0.0)};
    speed(&s, 500.0);
    design.pickoff_resolution = 0.0;
    design.start_inner = 30.0 * degree;
    design.start_nutation = 1.0 * degree;
    s.settings.noise = false;
    s.exposure = still;
    free_gyro_equations equations;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = 50,
                    .pieces_per_sample = 1,
                    .signal = {0, 1},
                    .scale = {1.0, 1.0},
                    .forms = 1,
                    .unit = 1e6,
                    .unit_name = "urad"};
    free_gyro_problem(&design, &equations, &c.form[0]);
    compare(&c);
    free((void *)c.start);
    free(moving);
    free(still);
}

static void bench_fibre_optic(void)
{
    const imk_fibre_optic design = imk_fibre_optic_default();
    imk_exposure *moving = inputs(0.1, 0.2, false);
    subject s = {"fibre_optic",
                 &imk_fibre_optic_instrument,
                 &design,
                 settings_of(IMK_LEVEL_FULL, 100.0, true),
                 moving,
                 "transits",
                 1.0 / imk_fibre_optic_transit_time(&design)};
    speed(&s, 50.0);
    fprintf(stderr, "bench_physics: fibre_optic: no yardstick: the loop acts once per transit, so "
                    "that it is a map and no differential equation\n");
    s.name = "fibre_optic_slow";
    s.settings.level = IMK_LEVEL_SLOW;
    s.frequency = 0.0;
    speed(&s, 0.0);
    free(moving);
}

/* The triangle of the check values: 28 cm, dither 400 Hz and 100 deg/s, lock-in at 0.1 deg/s. */
static void bench_ring_laser_level(const imk_ring_laser *design, imk_level level)
{
    const bool full = level == IMK_LEVEL_FULL;
    const double rate = 1.0 * degree;
    imk_exposure *moving = inputs(0.1, 0.2, false), *constant = inputs(rate, 0.0, false);
    subject s = {full ? "ring_laser" : "ring_laser_slow",
                 &imk_ring_laser_instrument,
                 design,
                 settings_of(level, 100.0, true),
                 moving,
                 "dither",
                 design->dither.frequency};
    speed(&s, full ? 10.0 : 1e4);
    s.settings.noise = false;
    s.settings.rate =
        full ? 1000.0 : 100.0; /* whole cycles of the dither: no angle of it is left */
    s.exposure = constant;
    ring_laser_equations plain, moved;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = full ? 50 : 20,
                    .pieces_per_sample = 1,
                    .signal = {full ? 0 : 1},
                    .scale = {1.0},
                    .forms = 2,
                    .unit = 1.0,
                    .unit_name = "rad of the beat"};
    ring_laser_problem(design, rate, false, &plain, &c.form[0]);
    ring_laser_problem(design, rate, true, &moved, &c.form[1]);
    compare(&c);
    free((void *)c.start);
    free(moving);
    free(constant);
}

static void bench_ring_laser(void)
{
    imk_ring_laser design = imk_ring_laser_default();
    design.cavity.perimeter = 0.28;
    design.lock_in.rate = 0.1 * degree;
    design.dither.frequency = 400.0;
    design.dither.rate = 100.0 * degree;
    bench_ring_laser_level(&design, IMK_LEVEL_FULL);
    bench_ring_laser_level(&design, IMK_LEVEL_SLOW);
}

/* The mass and its drive, the loops settled: CVODE is spared the electronics. */
static void compare_tuning_fork(const imk_tuning_fork *design, subject s)
{
    const double rate = 20.0 * degree;
    imk_exposure *constant = inputs(rate, 0.0, false);
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    s.settings.noise = false;
    s.exposure = constant;
    imki_fork_state *state = started(&s);
    for (int i = 0; i < 100; i++)
        s.instrument->step(state, &constant[0], outputs);
    const imki_fork_frame *frame = &state->frame;
    const imki_phasor turn = state->reference_turn;
    const double phase =
        atan2(turn.im, turn.re) + 0.5 * pi - 0.5 * ((double)frame->steps + 1.0) * frame->angle;
    const double frequency = frame->angle / state->step + state->detuning;
    oscillator_equations equations;
    comparison c = {.subject = s,
                    .start = state,
                    .samples = 5,
                    .pieces_per_sample = 1,
                    .signal = {0, 1},
                    .forms = 1,
                    .unit = 1.0,
                    .unit_name = "of the amplitude"};
    tuning_fork_problem(design, rate, state->drive_force, phase, frequency, state->motion,
                        &equations, &c.form[0]);
    c.scale[0] = 1.0 / equations.size_x;
    c.scale[1] = 1.0 / equations.size_y;
    compare(&c);
    free(state);
    free(constant);
}

static void compare_tuning_fork_envelope(const imk_tuning_fork *design, subject s)
{
    s.settings.noise = false;
    envelope_equations equations;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = TABLE,
                    .pieces_per_sample = 1,
                    .signal = {-1},
                    .scale = {1.0},
                    .forms = 1,
                    .unit = 3600.0 / degree,
                    .unit_name = "deg/h"};
    tuning_fork_envelope_problem(design, s.exposure, 1.0 / s.settings.rate, &equations, &c.form[0]);
    compare(&c);
    free((void *)c.start);
}

static void bench_tuning_fork(void)
{
    imk_tuning_fork design = imk_tuning_fork_default();
    design.drive.frequency = 15e3;
    imk_exposure *moving = inputs(0.1, 0.2, false);
    subject s = {"tuning_fork",
                 &imk_tuning_fork_instrument,
                 &design,
                 settings_of(IMK_LEVEL_FULL, 100.0, true),
                 moving,
                 "drive",
                 design.drive.frequency};
    speed(&s, 300.0);
    compare_tuning_fork(&design, s);
    s.name = "tuning_fork_slow";
    s.settings.level = IMK_LEVEL_SLOW;
    s.frequency = 0.0;
    speed(&s, 1e5);
    compare_tuning_fork_envelope(&design, s);
    free(moving);
}

/* A pattern left alone, as the loops of the other modes act in steps. */
static void compare_shell_gyro(imk_shell_gyro design, subject s)
{
    const double rate = 1.0;
    imk_exposure *constant = inputs(rate, 0.0, false);
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    design.mode = IMK_SHELL_FREE;
    design.package.misalignment_y = design.package.misalignment_z = 0.0;
    s.settings.noise = false;
    s.design = &design;
    s.exposure = constant;
    void *state = started(&s);
    s.instrument->observe(state, signals);
    oscillator_equations equations;
    comparison c = {.subject = s,
                    .start = state,
                    .samples = 5,
                    .pieces_per_sample = 1,
                    .signal = {0, 1},
                    .scale = {1.0 / design.pattern.amplitude, 1.0 / design.pattern.amplitude},
                    .forms = 1,
                    .unit = 1.0,
                    .unit_name = "of the amplitude"};
    shell_gyro_problem(&design, rate, signals[0], signals[1], &equations, &c.form[0]);
    compare(&c);
    free(state);
    free(constant);
}

/* Steady reading at the slow level. */
static double settled_reading(const subject *given, double rate)
{
    subject s = *given;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX] = {0.0};
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = rate;
    s.settings.noise = false;
    void *state = started(&s);
    for (int i = 0; i < 200; i++)
        s.instrument->step(state, &exposure, outputs);
    free(state);
    return outputs[0];
}

static void bench_shell_gyro(void)
{
    imk_shell_gyro design = imk_shell_gyro_default();
    design.resonator.frequency = 15e3;
    imk_exposure *moving = inputs(0.1, 0.2, false);
    subject s = {"shell_gyro",
                 &imk_shell_gyro_instrument,
                 &design,
                 settings_of(IMK_LEVEL_FULL, 100.0, true),
                 moving,
                 "vibration",
                 design.resonator.frequency};
    speed(&s, 300.0);
    compare_shell_gyro(design, s);
    s.name = "shell_gyro_slow";
    s.settings.level = IMK_LEVEL_SLOW;
    s.frequency = 0.0;
    speed(&s, 1e5);
    s.settings.noise = false;
    const double bias = settled_reading(&s, 0.0);
    envelope_equations equations;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = TABLE,
                    .pieces_per_sample = 1,
                    .signal = {-1},
                    .scale = {1.0},
                    .forms = 1,
                    .unit = 3600.0 / degree,
                    .unit_name = "deg/h"};
    shell_gyro_lag_problem(&design, bias, (settled_reading(&s, 0.5) - bias) / 0.5, moving,
                           1.0 / s.settings.rate, &equations, &c.form[0]);
    compare(&c);
    free((void *)c.start);
    free(moving);
}

static void bench_mems_open(imk_exposure *moving)
{
    const imk_mems_accelerometer design = imk_mems_accelerometer_default();
    subject s = {"mems_accelerometer",
                 &imk_mems_accelerometer_instrument,
                 &design,
                 settings_of(IMK_LEVEL_FULL, 1000.0, true),
                 moving,
                 "springs",
                 design.frequency};
    s.settings.step = 1e-5;
    speed(&s, 100.0);
    s.settings.noise = false;
    mems_equations equations;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = TABLE,
                    .pieces_per_sample = 1,
                    .signal = {-1},
                    .scale = {1.0},
                    .forms = 1,
                    .unit = 1e6 / gravity,
                    .unit_name = "ug"};
    mems_open_problem(&design, moving, 1.0 / s.settings.rate, &equations, &c.form[0]);
    compare(&c);
    free((void *)c.start);
    s.name = "mems_accelerometer_slow";
    s.settings = settings_of(IMK_LEVEL_SLOW, 100.0, true);
    s.frequency = 0.0;
    speed(&s, 1e5);
}

static void bench_mems_closed(imk_exposure *moving)
{
    const imk_mems_accelerometer analog = imk_mems_accelerometer_analog();
    const imk_mems_accelerometer design = imk_mems_accelerometer_sigma_delta();
    subject s = {"mems_analog",   &imk_mems_accelerometer_instrument,
                 &analog,         settings_of(IMK_LEVEL_FULL, 1000.0, true),
                 moving,          "loop",
                 analog.bandwidth};
    speed(&s, 100.0);
    s.name = "mems_sigma_delta";
    s.design = &design;
    s.cycle = "clock";
    s.frequency = design.clock;
    speed(&s, 100.0);
    s.settings.noise = false;
    mems_equations equations;
    comparison c = {.subject = s,
                    .start = started(&s),
                    .samples = 20,
                    .pieces_per_sample = 100,
                    .signal = {0},
                    .scale = {1.0 / design.gap},
                    .forms = 1,
                    .unit = 1.0,
                    .unit_name = "of the gap"};
    mems_sigma_delta_problem(&design, moving, 1.0 / s.settings.rate, c.pieces_per_sample,
                             &equations, &c.form[0]);
    compare(&c);
    free((void *)c.start);
}

/* The instruments that have no target: their default designs. */
static void bench_others(imk_exposure *forces)
{
    static const char *const names[] = {"rate_gyro",       "rate_integrating_gyro",
                                        "tuned_gyro",      "suspended_rotor",
                                        "pendulous_servo", "vibrating_beam"};
    imk_exposure *rates = inputs(0.1, 0.2, false);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const imk_instrument *instrument = imk_instrument_find(names[i]);
        void *design = allocate(instrument->design_size);
        instrument->set_default(design);
        const subject s = {.name = names[i],
                           .instrument = instrument,
                           .design = design,
                           .settings = settings_of(IMK_LEVEL_FULL, 100.0, true),
                           .exposure = instrument->sensor == IMK_GYRO ? rates : forces};
        speed(&s, 0.0);
        free(design);
    }
    free(rates);
}

int main(void)
{
    imk_exposure *moving = inputs(0.1 * gravity, gravity, true);
    bench_pin();
    bench_free_gyro();
    bench_fibre_optic();
    bench_ring_laser();
    bench_tuning_fork();
    bench_shell_gyro();
    bench_mems_open(moving);
    bench_mems_closed(moving);
    bench_others(moving);
    free(moving);
    return 0;
}
