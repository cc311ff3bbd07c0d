/* SPDX-License-Identifier: Apache-2.0 */
/* Zero-velocity filter: what it believes of its errors against what they are, on units simulated
 * here, without the library's generators: a level turntable that turns between stops, so that
 * biases and tilts can be told apart. Statistical limits have a false-alarm rate of 1e-6 each; the
 * distribution of normalised errors is that of chi-square. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "imukit/navigation_filter.h"
#include "imukit/noise.h"
#include "imukit/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846, degree = 0.017453292519943295;
static const double false_alarm = 1e-6;

/* ---- a unit, drawn ----------------------------------------------------------------------------
 */

enum { DRAWS = 4096 };
typedef struct draws {
    imk_random random;
    uint64_t stream, next;
    double value[DRAWS];
} draws;

static double draw(draws *d)
{
    if (d->next % DRAWS == 0)
        imk_random_normals(d->random, d->stream, d->next, DRAWS, d->value);
    return d->value[d->next++ % DRAWS];
}

typedef struct unit {
    draws draws;
    imk_navigation_filter_settings settings;
    double part[2][IMK_BIAS_PARTS_MAX][3];
    double decay[2][IMK_BIAS_PARTS_MAX], drive[2][IMK_BIAS_PARTS_MAX]; /* of a sample */
    double rate;                                                       /* samples [Hz] */
    double turn;                 /* of the table between stops [rad/s] */
    double stop_every, stop_for; /* [s] */
    double yaw, time;
    imk_geodetic place;
} unit;

static imk_matrix3 true_attitude(const unit *u)
{
    return imk_matrix3_from_euler(0.0, 0.0, u->yaw);
}

static bool stops(const unit *u, double time)
{
    return u->turn == 0.0 || fmod(time, u->stop_every) >= u->stop_every - u->stop_for;
}

static double bias_of(const unit *u, int sensor, int axis)
{
    const size_t count = sensor == 0 ? u->settings.gyro.part_count : u->settings.accel.part_count;
    double sum = 0.0;
    for (size_t p = 0; p < count; p++)
        sum += u->part[sensor][p][axis];
    return sum;
}

static const imk_triad_errors *triad_of(const unit *u, int sensor)
{
    return sensor == 0 ? &u->settings.gyro : &u->settings.accel;
}

static unit make_unit(const imk_navigation_filter_settings *settings, uint32_t run, double rate)
{
    unit u = {.draws = {imk_random_seeded(20), 1000 + run, 0}, .settings = *settings};
    u.rate = rate;
    u.turn = 3.0 * degree;
    u.stop_every = 60.0;
    u.stop_for = 10.0;
    u.place = (imk_geodetic){0.8, 0.3, 100.0};
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < triad_of(&u, sensor)->part_count; p++) {
            const imk_bias_part *part = &triad_of(&u, sensor)->part[p];
            const double phi = exp(-1.0 / (u.rate * part->correlation_time));
            u.decay[sensor][p] = phi;
            u.drive[sensor][p] = sqrt(1.0 - phi * phi);
            for (int i = 0; i < 3; i++)
                u.part[sensor][p][i] = part->sigma[i] * draw(&u.draws);
        }
    return u;
}

/* The next sample: biases from the values at its start to those at its end, as their mean. */
static void sample(unit *u, imk_vector3 *angle, imk_vector3 *velocity)
{
    const double dt = 1.0 / u->rate;
    const double turn = stops(u, u->time + 0.5 * dt) ? 0.0 : u->turn;
    const imk_matrix3 c =
        imk_matrix3_transpose(imk_matrix3_from_euler(0.0, 0.0, u->yaw + 0.5 * turn * dt));
    const imk_vector3 earth = imk_matrix3_apply(c, imk_earth_rate(u->place.latitude));
    imk_vector3 *out[2] = {angle, velocity};
    *angle = imk_vector3_scale(earth, dt);
    angle->v[2] += turn * dt;
    *velocity =
        (imk_vector3){{0.0, 0.0, -imk_normal_gravity(u->place.latitude, u->place.height) * dt}};
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad_errors *t = triad_of(u, sensor);
        for (int i = 0; i < 3; i++) {
            double bias = 0.5 * bias_of(u, sensor, i);
            for (size_t p = 0; p < t->part_count; p++) {
                double *b = &u->part[sensor][p][i];
                const imk_bias_part *part = &t->part[p];
                if (part->correlation_time > 0.0)
                    *b = u->decay[sensor][p] * *b +
                         part->sigma[i] * u->drive[sensor][p] * draw(&u->draws);
                else if (part->walk[i] > 0.0)
                    *b += part->walk[i] * sqrt(dt) * draw(&u->draws);
            }
            bias += 0.5 * bias_of(u, sensor, i);
            out[sensor]->v[i] += bias * dt + t->white[i] * sqrt(dt) * draw(&u->draws);
        }
    }
    u->yaw += turn * dt;
    u->time += dt;
}

/* ---- errors ------------------------------------------------------------------------------------
 */

/* Estimate minus truth, nine numbers in north-east-down axes. */
static void error_of(const unit *u, const imk_navigation_state *state, double e[9])
{
    const imk_navigation_state truth =
        imk_navigation_state_ned(u->time, u->place, (imk_vector3){{0}}, true_attitude(u));
    imk_vector3 velocity;
    imk_matrix3 c;
    imk_navigation_state_to_ned(state, NULL, &velocity, &c);
    const imk_vector3 off = imk_navigation_difference_ned(state, &truth);
    const imk_vector3 turn = imk_quaternion_to_rotation_vector(imk_quaternion_from_matrix(
        imk_matrix3_multiply(c, imk_matrix3_transpose(true_attitude(u)))));
    for (int i = 0; i < 3; i++) {
        e[i] = off.v[i];
        e[3 + i] = velocity.v[i];
        e[6 + i] = turn.v[i];
    }
}

/* e^T P^-1 e over the chosen states; scaled, since metres and radians differ by much. */
static double normalised(const double e[9], double p[9][9], size_t count, const int *state)
{
    double l[81], x[9] = {0}, scale[9], sum = 0.0;
    for (size_t i = 0; i < count; i++)
        scale[i] = 1.0 / sqrt(p[state[i]][state[i]]);
    for (size_t i = 0; i < count; i++) {
        x[i] = e[state[i]] * scale[i];
        for (size_t j = 0; j < count; j++)
            l[i * count + j] = p[state[i]][state[j]] * scale[i] * scale[j];
    }
    double y[9];
    memcpy(y, x, sizeof y);
    CHECK_OK(imk_cholesky_factor(count, l));
    imk_cholesky_solve(count, l, y);
    for (size_t i = 0; i < count; i++)
        sum += x[i] * y[i];
    return sum;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sum and distribution (Kolmogorov's distance, [MASSART1990]) of values that should be chi-square.
 */
static void check_chi_square(const char *what, size_t count, double *value, double degrees)
{
    double sum = 0.0, distance = 0.0;
    const double n = (double)count;
    qsort(value, count, sizeof *value, ascending);
    for (size_t i = 0; i < count; i++) {
        const double p = imk_chi_square_probability(value[i], degrees);
        sum += value[i];
        distance = fmax(distance, fmax(fabs(p - (double)i / n), fabs(p - (double)(i + 1) / n)));
    }
    const double low = imk_chi_square_quantile(0.5 * false_alarm, n * degrees);
    const double high = imk_chi_square_quantile(1.0 - 0.5 * false_alarm, n * degrees);
    print_message("%s: mean %.3f of %g (%.3f to %.3f), distance %.3f\n", what, sum / n, degrees,
                  low / n, high / n, distance);
    CHECK_BELOW(low, sum);
    CHECK_BELOW(sum, high);
    CHECK_BELOW(distance, sqrt(log(2.0 / false_alarm) / (2.0 * n)));
}

/* ---- filters -----------------------------------------------------------------------------------
 */

static void set3(double v[3], double value)
{
    v[0] = v[1] = v[2] = value;
}

/* Gyros of 0.1 deg/sqrt(h), with a bias of 3 deg/h that walks and a Gauss-Markov part, all times
 * `gyros`; accelerometers of 500 ug. */
static imk_navigation_filter_settings tactical(double gyros)
{
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const double deg_h = gyros * degree / 3600.0, ug = 9.80665e-6;
    set3(s.gyro.white, 6.0 * deg_h);
    s.gyro.part_count = 2;
    set3(s.gyro.part[0].sigma, 3.0 * deg_h);
    set3(s.gyro.part[0].walk, 1.0 * deg_h / 60.0);
    s.gyro.part[1].correlation_time = 100.0;
    set3(s.gyro.part[1].sigma, 1.0 * deg_h);
    set3(s.accel.white, 50.0 * ug);
    s.accel.part_count = 2;
    set3(s.accel.part[0].sigma, 500.0 * ug);
    s.accel.part[1].correlation_time = 300.0;
    set3(s.accel.part[1].sigma, 100.0 * ug);
    s.velocity_sigma = 1e-5;
    s.false_alarm = 1e-9;
    s.step = 1.0;
    for (int i = 0; i < 3; i++) {
        s.initial_sigma[i] = 1.0;
        s.initial_sigma[3 + i] = 0.01;
        s.initial_sigma[6 + i] = i < 2 ? 5e-4 : 5e-3;
    }
    return s;
}

typedef struct memory {
    double bytes[40000];
} memory;

static imk_navigation_filter *start_filter(memory *m, const imk_navigation_filter_settings *s,
                                           const imk_navigation_state *start)
{
    imk_navigation_filter *filter;
    imk_error error;
    assert_true(imk_navigation_filter_size(s) <= sizeof *m);
    CHECK_OK(imk_navigation_filter_start(s, start, &filter, m, sizeof *m, &error));
    return filter;
}

static imk_navigation_state drawn_start(unit *u)
{
    const imk_navigation_filter_settings *s = &u->settings;
    const int held = s->hold_height;
    imk_navigation_state start =
        imk_navigation_state_ned(0.0, u->place, (imk_vector3){{0}}, true_attitude(u));
    const imk_matrix3 axes = imk_ned_axes(u->place.latitude, u->place.longitude);
    imk_vector3 e[3];
    for (int block = 0; block < 3; block++) {
        for (int i = 0; i < 3; i++)
            e[block].v[i] = s->initial_sigma[3 * block + i] * draw(&u->draws);
        if (held && block < 2)
            e[block].v[2] = 0.0;
        e[block] = imk_matrix3_apply(axes, e[block]);
    }
    start.position = imk_vector3_add(start.position, e[0]);
    start.velocity = e[1];
    start.attitude =
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(e[2]), start.attitude);
    return start;
}

/* Errors before each of the first and the last stop of some minutes, and innovations, over many
 * units; the updates come every second of a stop. */
static void check_consistency(const char *what, const imk_navigation_filter_settings *s,
                              size_t runs, double duration)
{
    static const int free_states[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    static const int held_states[7] = {0, 1, 3, 4, 6, 7, 8};
    static memory m;
    const size_t count = s->hold_height ? 7 : 9;
    const int *states = s->hold_height ? held_states : free_states;
    double *value[2] = {malloc(runs * sizeof(double)), malloc(runs * sizeof(double))};
    double chi_square = 0.0;
    uint64_t degrees = 0;
    char label[80];
    for (size_t run = 0; run < runs; run++) {
        unit u = make_unit(s, (uint32_t)run, 5.0);
        const imk_navigation_state start = drawn_start(&u);
        imk_navigation_filter *filter = start_filter(&m, s, &start);
        imk_navigation_filter_estimate estimate;
        double e[9];
        const long samples = lround(duration * u.rate);
        for (long k = 1; k <= samples; k++) {
            imk_vector3 angle, velocity;
            sample(&u, &angle, &velocity);
            imk_navigation_filter_step(filter, 1.0 / u.rate, angle, velocity);
            const bool standing = stops(&u, ((double)k - 0.5) / u.rate);
            if (!standing)
                imk_navigation_filter_moved(filter);
            else if (k % lround(u.rate) == 0)
                assert_true(imk_navigation_filter_stand(filter));
            if (k == lround(49.0 * u.rate) || k == samples - lround(11.0 * u.rate)) {
                imk_navigation_filter_get(filter, &estimate);
                error_of(&u, &estimate.state, e);
                value[k > lround(49.0 * u.rate)][run] =
                    normalised(e, estimate.covariance, count, states);
            }
        }
        const imk_navigation_filter_counts counts = imk_navigation_filter_counted(filter);
        assert_int_equal(counts.refused, 0);
        chi_square += counts.chi_square;
        degrees += counts.degrees;
    }
    snprintf(label, sizeof label, "%s, before any stop", what);
    check_chi_square(label, runs, value[0], (double)count);
    snprintf(label, sizeof label, "%s, before the last stop", what);
    check_chi_square(label, runs, value[1], (double)count);
    const double all = (double)degrees;
    print_message("%s: innovations %.4f per degree of freedom, %g in all\n", what, chi_square / all,
                  all);
    CHECK_BELOW(imk_chi_square_quantile(0.5 * false_alarm, all), chi_square);
    CHECK_BELOW(chi_square, imk_chi_square_quantile(1.0 - 0.5 * false_alarm, all));
    free(value[0]);
    free(value[1]);
}

static void test_consistency(void **state)
{
    (void)state;
    imk_navigation_filter_settings s = tactical(1.0);
    check_consistency("free vertical", &s, check_runs(200), 180.0);
    s.hold_height = true;
    s.rotation_sigma = 1e-9;
    check_consistency("held height, zero rotation", &s, check_runs(200), 180.0);
}

/* The unit of tactical() as a model. */
static imk_model tactical_model(double gyros)
{
    const double deg_h = gyros * degree / 3600.0, ug = 9.80665e-6;
    imk_model model;
    imk_model_default(&model);
    set3(model.gyro.noise.white.value, 6.0 * deg_h);
    set3(model.gyro.bias.repeatability.value, 3.0 * deg_h);
    set3(model.gyro.noise.random_walk.value, 1.0 * deg_h / 60.0);
    model.gyro.noise.gauss_markov_count = 1;
    set3(model.gyro.noise.gauss_markov[0].sigma.value, 1.0 * deg_h);
    set3(model.gyro.noise.gauss_markov[0].correlation_time.value, 100.0);
    set3(model.accel.noise.white.value, 50.0 * ug);
    set3(model.accel.bias.repeatability.value, 500.0 * ug);
    model.accel.noise.gauss_markov_count = 1;
    set3(model.accel.noise.gauss_markov[0].sigma.value, 100.0 * ug);
    set3(model.accel.noise.gauss_markov[0].correlation_time.value, 300.0);
    return model;
}

/* A unit that aligns itself: its attitude error and its biases belong together, so that it drifts
 * by much less than the two apart would. Free for two minutes, then corrected, then free again. */
static void check_self_alignment(const char *name, imk_alignment_method method)
{
    enum { RUNS = 200 };
    const uint32_t runs = check_runs(RUNS);
    static const int states[7] = {0, 1, 3, 4, 6, 7, 8};
    static memory m, am;
    static double value[2][RUNS];
    /* With 3 deg/h a heading would be 17 deg off: not small. */
    const double gyros = 0.02;
    const imk_model model = tactical_model(gyros);
    const double aligned = 100.0;
    imk_error error;
    for (uint32_t run = 0; run < runs; run++) {
        imk_navigation_filter_settings s = tactical(gyros);
        unit u = make_unit(&s, 5000 + run, 10.0);
        u.turn = 0.0;
        u.yaw = 0.7;
        imk_vector3 angle, velocity;
        imk_alignment_settings settings = imk_alignment_default();
        imk_alignment *alignment;
        imk_alignment_result result;
        settings.method = method;
        settings.place = u.place;
        settings.duration = aligned;
        settings.model = &model;
        assert_true(imk_alignment_size(&settings) <= sizeof am);
        CHECK_OK(imk_alignment_start(&settings, &alignment, &am, sizeof am, &error));
        for (long k = 0; k < lround(aligned * u.rate); k++) {
            sample(&u, &angle, &velocity);
            imk_alignment_add(alignment, 1.0 / u.rate, angle, velocity, NULL);
        }
        CHECK_OK(imk_alignment_finish(alignment, &result, &error));
        for (int i = 0; i < IMK_NAVIGATION_ERRORS; i++)
            s.initial_sigma[i] = i < 6 ? 1e-4 : 0.0;
        s.hold_height = true;
        const imk_vector3 up = {{0.0, 0.0, -9.8}};
        CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, up, &s, &error));
        CHECK_OK(imk_navigation_filter_aligned(&result, settings.method, true, aligned, &s));
        imk_navigation_filter *filter = start_filter(&m, &s, &result.state);
        u.time = 0.0;
        for (long k = 1; k <= 1900; k++) {
            sample(&u, &angle, &velocity);
            imk_navigation_filter_step(filter, 1.0 / u.rate, angle, velocity);
            if (k == 1200 || k == 1900) {
                imk_navigation_filter_estimate estimate;
                double e[9];
                imk_navigation_filter_get(filter, &estimate);
                error_of(&u, &estimate.state, e);
                value[k == 1900][run] = normalised(e, estimate.covariance, 7, states);
            }
            if (k >= 1250 && k <= 1300 && k % 10 == 0)
                assert_true(imk_navigation_filter_stand(filter));
        }
    }
    char label[80];
    snprintf(label, sizeof label, "self-aligned (%s), free", name);
    check_chi_square(label, runs, value[0], 7.0);
    snprintf(label, sizeof label, "self-aligned (%s), after a stop", name);
    check_chi_square(label, runs, value[1], 7.0);
}

static void test_self_alignment(void **state)
{
    (void)state;
    check_self_alignment("means", IMK_ALIGNMENT_MEANS);
    check_self_alignment("inertial", IMK_ALIGNMENT_INERTIAL);
    check_self_alignment("fine", IMK_ALIGNMENT_FINE);
}

/* A closed form: at rest and given perfect attitude, an accelerometer bias of 1 sigma b makes a
 * position error of (b/W^2)(1 - cos W t), W Schuler's rate, in the covariance; half a period on
 * that is 2 b/W^2. The two radii of curvature differ from the filter's one by 0.4 %, and Foucault's
 * term turns by 10 deg, which keeps the root sum of squares. */
static void test_schuler(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const double b = 1e-4;
    s.hold_height = true;
    s.step = 1.0;
    s.accel.part_count = 1;
    set3(s.accel.part[0].sigma, b);
    const imk_geodetic place = {0.785, 0.0, 0.0};
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity());
    imk_navigation_filter *filter = start_filter(&m, &s, &start);
    const double g = imk_normal_gravity(place.latitude, 0.0);
    const double schuler = sqrt(g / imk_vector3_norm(imk_ecef_from_geodetic(place)));
    const imk_vector3 earth = imk_earth_rate(place.latitude);
    const long steps = lround(pi / schuler);
    for (long k = 0; k < steps; k++)
        imk_navigation_filter_step(filter, 1.0, earth, (imk_vector3){{0.0, 0.0, -g}});
    imk_navigation_filter_estimate estimate;
    imk_navigation_filter_get(filter, &estimate);
    const double rms = sqrt(estimate.covariance[0][0] + estimate.covariance[1][1]);
    CHECK_RELATIVE(rms, sqrt(2.0) * 2.0 * b / (schuler * schuler), 5e-3);
    CHECK_BELOW(fabs(estimate.covariance[2][2]), 1e-15 * rms * rms);
}

/* An angle random walk N alone: velocity variance g^2 N^2 t^3/3, position g^2 N^2 t^5/20 for times
 * short against Schuler's; whatever the step. */
static void test_random_walk(void **state)
{
    (void)state;
    static memory m;
    static const double steps[] = {0.01, 0.5, 2.0};
    for (int i = 0; i < 3; i++) {
        imk_navigation_filter_settings s;
        imk_navigation_filter_default(&s);
        const double n = 1e-5, t = 20.0;
        set3(s.gyro.white, n);
        s.hold_height = true;
        s.step = steps[i];
        const imk_geodetic place = {0.5, 0.0, 0.0};
        const imk_navigation_state start =
            imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity());
        imk_navigation_filter *filter = start_filter(&m, &s, &start);
        const double g = imk_normal_gravity(place.latitude, 0.0);
        const imk_vector3 earth = imk_vector3_scale(imk_earth_rate(place.latitude), 0.01);
        for (long k = 0; k < 2000; k++)
            imk_navigation_filter_step(filter, 0.01, earth, (imk_vector3){{0.0, 0.0, -0.01 * g}});
        imk_navigation_filter_estimate estimate;
        imk_navigation_filter_get(filter, &estimate);
        /* (W t)^2 = 6e-4, and Simpson's rule for s^4: (h/t)^4/6 of it per step at most. */
        CHECK_RELATIVE(estimate.covariance[3][3], g * g * n * n * t * t * t / 3.0, 1e-3);
        CHECK_RELATIVE(estimate.covariance[0][0], g * g * n * n * t * t * t * t * t / 20.0, 2e-3);
        CHECK_RELATIVE(estimate.covariance[8][8], n * n * t, 1e-6);
    }
}

/* The four decades of Gauss-Markov processes stand for flicker, S(f) = B^2/(2 pi f), within 12 % of
 * its density where they should. */
static void test_flicker(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_error error;
    const double b = 2e-7;
    set3(model.gyro.noise.bias_instability.value, b);
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, (imk_vector3){{0}},
                                            &s, &error));
    assert_int_equal(s.gyro.part_count, 5);
    double worst = 0.0;
    for (double f = 1e-4; f < 1.001e-2; f *= 1.1) {
        double density = 0.0;
        for (size_t p = 1; p < s.gyro.part_count; p++) {
            const double t = s.gyro.part[p].correlation_time, sigma = s.gyro.part[p].sigma[1];
            density += 2.0 * sigma * sigma * t / (1.0 + 4.0 * pi * pi * f * f * t * t);
        }
        worst = fmax(worst, fabs(density * 2.0 * pi * f / (b * b) - 1.0));
    }
    print_message("flicker: density off by %.1f %% at most\n", 100.0 * worst);
    CHECK_BELOW(worst, 0.12);
}

/* What is constant at rest joins the constant part. */
static void test_description(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_error error;
    set3(model.gyro.bias.repeatability.value, 3e-6);
    model.gyro.bias.fixed.sigma[2] = 4e-6;
    model.gyro.g_sensitivity.sigma[0][2] = 4e-7;
    model.accel.scale_factor.repeatability.value[2] = 1e-3;
    model.accel.misalignment.sigma[1][2] = 2e-4;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const imk_vector3 force = {{0.0, 0.0, -10.0}};
    CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, force, &s, &error));
    CHECK_RELATIVE(s.gyro.part[0].sigma[0], 5e-6, 1e-14);
    CHECK_RELATIVE(s.gyro.part[0].sigma[1], 3e-6, 1e-14);
    CHECK_RELATIVE(s.gyro.part[0].sigma[2], 5e-6, 1e-14);
    CHECK_RELATIVE(s.accel.part[0].sigma[2], 1e-2, 1e-14);
    CHECK_RELATIVE(s.accel.part[0].sigma[1], 2e-3, 1e-14);
    /* Two correlation times in one term: two parts. */
    model.gyro.noise.gauss_markov_count = 1;
    set3(model.gyro.noise.gauss_markov[0].sigma.value, 1e-6);
    set3(model.gyro.noise.gauss_markov[0].correlation_time.value, 100.0);
    model.gyro.noise.gauss_markov[0].correlation_time.value[1] = 50.0;
    CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, force, &s, &error));
    assert_int_equal(s.gyro.part_count, 3);
    CHECK_CLOSE(s.gyro.part[1].sigma[1], 0.0, 0.0);
    CHECK_CLOSE(s.gyro.part[1].sigma[2], 1e-6, 0.0);
    CHECK_CLOSE(s.gyro.part[2].sigma[1], 1e-6, 0.0);
    CHECK_CLOSE(s.gyro.part[2].sigma[2], 0.0, 0.0);
    /* Errors of readings, of which the white ones are A/sqrt(dt). */
    set3(model.gyro.noise.quantization.value, 3e-6);
    set3(model.gyro.noise.reading_noise.value, 4e-6);
    set3(model.accel.noise.angle_white.value, 1e-4);
    CHECK_OK(imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, force, &s, &error));
    CHECK_RELATIVE(s.gyro.quantization[1], 5e-6, 1e-14);
    CHECK_RELATIVE(s.accel.quantization[1], 1e-3, 1e-14);
    model.gyro.axis_count = 4;
    CHECK_STATUS(
        imk_navigation_filter_describe(&model, 0.01, (imk_vector3){{0}}, force, &s, &error),
        IMK_ERROR_UNSUPPORTED);
}

/* Motion where a stop is announced: refused, counted, and nothing changed. */
static void test_gate(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter_settings s = tactical(1.0);
    s.aid_count = 1;
    s.aid[0] = imk_aid_default(IMK_AID_POSITION);
    const imk_geodetic place = {0.5, 0.1, 0.0};
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, place, (imk_vector3){{5.0, 0.0, 0.0}}, imk_matrix3_identity());
    imk_navigation_filter *filter = start_filter(&m, &s, &start);
    imk_navigation_filter_estimate before, after;
    imk_navigation_filter_get(filter, &before);
    assert_false(imk_navigation_filter_stand(filter));
    imk_navigation_filter_get(filter, &after);
    assert_memory_equal(&before, &after, sizeof before);
    const imk_navigation_filter_counts counts = imk_navigation_filter_counted(filter);
    assert_int_equal(counts.refused, 1);
    assert_int_equal(counts.refused_in_row, 1);
    assert_int_equal(counts.accepted, 0);
    CHECK_CLOSE(counts.first_refused, 0.0, 0.0);
    /* Where it is: the error there is taken out, in the height alone when only that is known. */
    const double no = (double)INFINITY;
    imk_aid_reading there = {.value = {0.5, 0.1, 1.0}, .sigma = {no, no, 1.0}};
    assert_int_equal(imk_navigation_filter_aid(filter, 0, &there), IMK_AID_USED);
    imk_navigation_filter_get(filter, &after);
    const imk_vector3 moved = imk_navigation_difference_ned(&after.state, &before.state);
    CHECK_CLOSE(moved.v[2], -0.5, 1e-9); /* both are known to 1 m */
    CHECK_CLOSE(moved.v[0], 0.0, 1e-9);
    CHECK_RELATIVE(after.covariance[2][2], 0.5, 1e-9);
    CHECK_RELATIVE(after.covariance[0][0], 1.0, 1e-9);
    assert_int_equal(imk_navigation_filter_counted(filter).refused_in_row, 1);
    assert_int_equal(imk_navigation_filter_aided(filter, 0).accepted, 1);
    there.sigma[2] = no;
    assert_int_equal(imk_navigation_filter_aid(filter, 0, &there), IMK_AID_NOT_USED);
    const imk_aid_reading away = {.value = {0.5, 0.1001, 0.0}, .sigma = {1.0, 1.0, no}};
    assert_int_equal(imk_navigation_filter_aid(filter, 0, &away), IMK_AID_REFUSED);
    assert_int_equal(imk_navigation_filter_aided(filter, 0).refused, 1);
}

/* Windows at rest taken for motion are as rare as stated, and motion is seen. 4000 windows of white
 * noise: 4 false ones are expected; 25 have a probability of 1e-12, and as a threshold learnt from
 * 300 windows is uncertain, some more than 4 must be allowed. */
static void test_standstill(void **state)
{
    (void)state;
    imk_standstill d = imk_standstill_start(1.0, 1e-3);
    imk_error error;
    draws noise = {.random = imk_random_seeded(3), .stream = 1};
    const double dt = 0.02, rate = 1e-3, force = 0.01;
    CHECK_STATUS(imk_standstill_ready(&d, &error), IMK_ERROR_TOO_SHORT);
    size_t moving = 0, seen = 0;
    const imk_rest_readings rest = {{{5e-5, 0.0, -5e-5}}, {{0.0, 0.0, -9.8}}, 0.0, 0.0};
    for (long k = 0; k < 50L * 4600; k++) {
        imk_vector3 angle, velocity;
        const long at = k / 50;
        /* At last: a turn of 0.1 deg/s, a braking that grows by 0.1 m/s^2 in a second, and a steady
         * one of 0.05 m/s^2. */
        const double turn = at >= 4300 && at < 4450 ? 0.1 * degree : 0.0;
        const double jerk = at < 4450 ? 0.0 : at < 4550 ? 0.1 * (double)(k % 50) / 50.0 : 0.05;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = (rest.rate.v[i] + rate * draw(&noise) + (i == 2 ? turn : 0.0)) * dt;
            velocity.v[i] =
                (force * draw(&noise) + (i == 2 ? -9.8 : 0.0) + (i == 0 ? jerk : 0.0)) * dt;
        }
        if (at < 300) {
            imk_standstill_learn(&d, dt, angle, velocity);
            continue;
        }
        if (k == 50L * 300)
            CHECK_OK(imk_standstill_ready(&d, &error));
        const imk_standstill_verdict verdict = imk_standstill_add(&d, dt, angle, velocity, &rest);
        assert_int_equal(verdict != IMK_STANDSTILL_UNDECIDED, k % 50 == 49);
        if (verdict == IMK_STANDSTILL_MOVES)
            *(at < 4300 ? &moving : &seen) += 1;
    }
    print_message("standstill: %zu of 4000 windows at rest and %zu of 300 in motion move\n", moving,
                  seen);
    assert_in_range(moving, 0, 25);
    assert_int_equal(seen, 300);
}

/* A filter is refused with the field that is wrong. */
static void test_refusals(void **state)
{
    (void)state;
    static memory m;
    imk_navigation_filter *filter = NULL;
    imk_error error;
    const imk_navigation_state start = imk_navigation_state_ned(
        0.0, (imk_geodetic){0.5, 0.0, 0.0}, (imk_vector3){{0}}, imk_matrix3_identity());
    const struct {
        size_t offset;
        double value;
        const char *field;
        imk_status status;
    } cases[] = {
        {offsetof(imk_navigation_filter_settings, step), 20.0, "step", IMK_ERROR_RANGE},
        {offsetof(imk_navigation_filter_settings, velocity_sigma), 0.0, "velocity_sigma",
         IMK_ERROR_RANGE},
        {offsetof(imk_navigation_filter_settings, rotation_sigma), -1.0, "rotation_sigma",
         IMK_ERROR_RANGE},
        {offsetof(imk_navigation_filter_settings, false_alarm), 0.5, "false_alarm",
         IMK_ERROR_RANGE},
        {offsetof(imk_navigation_filter_settings, alignment_time), (double)NAN, "alignment_time",
         IMK_ERROR_NOT_FINITE},
        {offsetof(imk_navigation_filter_settings, initial_sigma), (double)INFINITY, "initial_sigma",
         IMK_ERROR_NOT_FINITE},
        {offsetof(imk_navigation_filter_settings, gyro.white), -1.0, "gyro", IMK_ERROR_RANGE},
        {offsetof(imk_navigation_filter_settings, accel.part[1].sigma), -1.0, "accel",
         IMK_ERROR_RANGE},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        imk_navigation_filter_settings s = tactical(1.0);
        *(double *)(void *)((char *)&s + cases[k].offset) = cases[k].value;
        CHECK_STATUS(imk_navigation_filter_start(&s, &start, &filter, &m, sizeof m, &error),
                     cases[k].status);
        assert_string_equal(error.field, cases[k].field);
        assert_null(filter);
    }
    imk_navigation_filter_settings s = tactical(1.0);
    CHECK_STATUS(imk_navigation_filter_start(&s, &start, &filter, &m,
                                             imk_navigation_filter_size(&s) - 1, &error),
                 IMK_ERROR_WORKSPACE);
    s.cookie = 0;
    CHECK_STATUS(imk_navigation_filter_start(&s, &start, &filter, &m, sizeof m, &error),
                 IMK_ERROR_UNINITIALISED);
    assert_null(filter);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_consistency), cmocka_unit_test(test_self_alignment),
        cmocka_unit_test(test_schuler),     cmocka_unit_test(test_random_walk),
        cmocka_unit_test(test_flicker),     cmocka_unit_test(test_description),
        cmocka_unit_test(test_gate),        cmocka_unit_test(test_standstill),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
