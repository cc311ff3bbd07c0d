/* SPDX-License-Identifier: Apache-2.0 */
/* The covariance analysis where it could be wrong unnoticed: what sampling makes of noise, the
 * clock, short manoeuvres, the climb of a slaved vertical, and what is refused or left out. */
#include "check.h"

#include "imukit/drift.h"
#include "imukit/motion_file.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NORTH, EAST, DOWN, V_NORTH, V_EAST, V_DOWN, TILT_NORTH, TILT_EAST, HEADING };
static const double pi = 3.14159265358979323846;

/* ---- helpers ------------------------------------------------------------------------------------
 */

static imk_drift_analysis *analyse(const imk_model *model, const imk_drift_settings *settings)
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = aligned_alloc(64, size);
    imk_drift_analysis *analysis = NULL;
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, settings, NULL, &analysis, memory, size, NULL));
    return analysis;
}

static imk_drift_moments total_at(const imk_model *model, imk_drift_settings settings, double time)
{
    settings.time = &time;
    settings.time_count = 1;
    imk_drift_analysis *analysis = analyse(model, &settings);
    const imk_drift_moments moments = analysis->total[0];
    free(analysis);
    return moments;
}

static bool has_source(const imk_drift_analysis *analysis, const char *name)
{
    for (size_t i = 0; i < analysis->source_count; i++)
        if (strcmp(analysis->source[i].name, name) == 0)
            return true;
    return false;
}

static bool omits(const imk_drift_analysis *analysis, const char *name)
{
    for (size_t i = 0; i < analysis->omitted_count; i++)
        if (strcmp(analysis->omitted[i], name) == 0)
            return true;
    return false;
}

static imk_motion_file *motion_of(const char *text)
{
    imk_motion_file *file = NULL;
    imk_error error = {0};
    const imk_status status = imk_motion_parse(text, strlen(text), NULL, 0, &file, &error);
    if (status != IMK_OK)
        print_error("%s: %s\n", error.field, error.expected);
    CHECK_OK(status);
    return file;
}

static imk_drift_settings on(const imk_motion_file *file)
{
    imk_drift_settings settings = imk_drift_default();
    settings.motion = imk_motion_file_motion(file)->trajectory;
    return settings;
}

/* ---- what sampling makes of noise --------------------------------------------------------------
 */

/* The angle of a gyro at rest is the sum of its samples, but for the Earth's turn in so short a
 * time (1e-5). With V its variance, (4 V(T) - V(2T))/(2 T^2) is the Allan variance of the samples,
 * which the generators of noise.h state exactly. */
static double allan_variance(const imk_model *model, double rate, double duration)
{
    imk_drift_settings settings = imk_drift_default();
    settings.rate = rate;
    settings.latitude = 0.0;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    const imk_drift_moments one = total_at(model, settings, duration),
                            two = total_at(model, settings, 2.0 * duration);
    return (4.0 * one.covariance[TILT_EAST][TILT_EAST] - two.covariance[TILT_EAST][TILT_EAST]) /
           (2.0 * duration * duration);
}

/* Stages held for four samples and more are taken as if they were not: some per cent of the whole
 * over so few samples. Without the share of the fastest stage it would be 5 % at 10 samples,
 * without the sampling of the first two 15 %. */
static void flicker_is_that_of_the_samples(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.bias_instability.value[1] = 1e-6;
    for (size_t n = 10; n <= 1000; n *= 10)
        CHECK_RELATIVE(allan_variance(&model, 10.0, (double)n / 10.0),
                       imk_flicker_sampled_allan_variance((imk_flicker){1e-6, 0}, 0.1, n),
                       n == 10 ? 0.02 : 0.01);
}

/* What is left are the ends of the sum: of n samples T/(n dt). */
static void gauss_markov_is_that_of_the_samples(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_noise *noise = &model.gyro.noise;
    noise->gauss_markov_count = 1;
    noise->gauss_markov[0].sigma.value[1] = 1e-6;
    static const double times[3] = {0.03, 0.1, 1.0};
    for (int i = 0; i < 3; i++) {
        noise->gauss_markov[0].correlation_time.value[1] = times[i];
        const imk_gauss_markov process = {1e-6, times[i]};
        CHECK_RELATIVE(allan_variance(&model, 10.0, 500.0),
                       imk_gauss_markov_sampled_allan_variance(process, 0.1, 5000), 1e-3);
    }
}

static void resonances_are_those_of_the_samples(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_noise *noise = &model.gyro.noise;
    noise->resonance_count = 1;
    noise->resonance[0].sigma.value[1] = 1e-6;
    /* Slow against the time, where its start matters; faster; folded, where it is white. */
    static const double frequency[5] = {0.01, 0.3, 4.0, 13.37, 0.0},
                        tolerance[5] = {1e-3, 2e-3, 1e-2, 1e-2, 0.0};
    for (int i = 0; frequency[i] > 0.0; i++) {
        noise->resonance[0].frequency.value[1] = frequency[i];
        noise->resonance[0].q.value[1] = 2.0;
        const imk_resonance resonance = {1e-6, frequency[i], 2.0};
        const double duration = frequency[i] < 0.1 ? 20.0 : 500.0;
        CHECK_RELATIVE(
            allan_variance(&model, 10.0, duration),
            imk_resonance_sampled_allan_variance(resonance, 0.1, (size_t)(10.0 * duration)),
            tolerance[i]);
    }
    /* Beyond what can be designed samples are independent. */
    noise->resonance[0].frequency.value[1] = 2e7;
    CHECK_RELATIVE(allan_variance(&model, 10.0, 10.0), 1e-12 / 100.0, 1e-5);
}

/* The sum of n samples of a sinusoid of random phase: a^2/2 (sin(pi f n dt)/sin(pi f dt))^2. */
static void sinusoids_add_up_like_samples(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_noise *noise = &model.gyro.noise;
    noise->sinusoid_count = 1;
    noise->sinusoid[0].amplitude.value[1] = 1e-6;
    imk_drift_settings settings = imk_drift_default();
    settings.rate = 10.0;
    settings.latitude = 0.0;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    static const double frequency[4] = {0.0123, 1.0123, 4.0123, 10.0123}; /* the last one folds */
    for (int i = 0; i < 4; i++) {
        noise->sinusoid[0].frequency.value[1] = frequency[i];
        const double sum = sin(pi * frequency[i] * 30.0) / sin(pi * frequency[i] * 0.1) * 0.1;
        const imk_drift_moments m = total_at(&model, settings, 30.0);
        CHECK_RELATIVE(m.covariance[TILT_EAST][TILT_EAST], 0.5e-12 * sum * sum, 1e-5);
    }
}

/* Rounding to a step d has the variance d^2/12 in each sample, if noise of d/2 carries it across;
 * without it nothing is said but the name. */
static void rounding_is_a_twelfth(void **state)
{
    (void)state;
    imk_drift_settings settings = imk_drift_default();
    settings.latitude = 0.0;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    static const double one_time[1] = {30.0};
    settings.time = one_time;
    settings.time_count = 1;
    const double step = 1e-4, noise = 0.5 * step * sqrt(0.01);
    for (int which = 0; which < 2; which++) {
        imk_model model;
        imk_model_default(&model);
        for (int i = 0; i < 3; i++) {
            model.gyro.noise.white.value[i] = 1.001 * noise;
            if (which == 0)
                model.gyro.resolution.value[i] = step;
            else
                model.gyro.sensitivity.value[i] = -1.0 / step;
        }
        imk_drift_analysis *analysis = analyse(&model, &settings);
        assert_int_equal(analysis->source_count, 2);
        assert_int_equal(analysis->omitted_count, 0);
        CHECK_RELATIVE(analysis->contribution[1].covariance[TILT_EAST][TILT_EAST],
                       step * step / 12.0 * 0.01 * 30.0, 1e-5);
        free(analysis);
        model.gyro.noise.white.value[1] = 0.999 * noise;
        analysis = analyse(&model, &settings);
        assert_int_equal(analysis->source_count, 1);
        assert_true(omits(analysis, which == 0 ? "gyro.resolution" : "gyro.sensitivity"));
        free(analysis);
    }
}

/* ---- the clock and the filter ------------------------------------------------------------------
 */

static const char turntable[] = "imukit_motion: 1\n"
                                "start: {latitude: 0 deg}\n"
                                "smoothing: 0.4 s\n"
                                "steps:\n"
                                "  - hold 5 s\n"
                                "  - rotate z 900 deg at 90 deg/s\n"
                                "  - hold 5 s\n"
                                "  - accelerate to 30 m/s at 3 m/s^2\n"
                                "  - hold 5 s\n"
                                "then: stop\n";

/* Every boundary of a sample is off by j of its own. The angle is then off by what the rate changes
 * there, the sum of j dw, and the last one by w j: sigma^2 (w^2 + dt integral of w'^2); the
 * velocity likewise with the acceleration, and the position with the velocity. Steps
 * follow the force, not its slope: 1 % of the variance of a velocity. */
static void jitter_acts_on_changes_and_at_the_end(void **state)
{
    (void)state;
    const double sigma = 1e-4, dt = 0.01;
    imk_motion_file *file = motion_of(turntable);
    imk_drift_settings settings = on(file);
    imk_model model;
    imk_model_default(&model);
    model.timing.jitter.value = sigma;
    settings.rate = 1.0 / dt;
    static const double times[4] = {5.2, 10.0, 22.0, 33.0};
    settings.time = times;
    settings.time_count = 4;
    imk_drift_analysis *analysis = analyse(&model, &settings);
    double of_rate = 0.0, of_force = 0.0, moved = 0.0, before[2] = {0.0, 0.0};
    const double h = 1e-3;
    int look = 0;
    for (int i = 1; look < 4; i++) {
        imk_motion_state now;
        imk_trajectory_state(settings.motion, h * i, &now);
        const double rate = now.angular_rate.v[2], force = now.specific_force.v[0];
        const double left = times[3] - h * i,
                     change = (force - before[1]) * (force - before[1]) / h;
        of_rate += (rate - before[0]) * (rate - before[0]) / h;
        of_force += change;
        moved += change * left * left;
        before[0] = rate;
        before[1] = force;
        if (fabs(h * i - times[look]) > 0.5 * h)
            continue;
        const imk_drift_moments *m = &analysis->total[look];
        CHECK_RELATIVE(m->covariance[HEADING][HEADING],
                       sigma * sigma * (rate * rate + dt * of_rate), 3e-3);
        if (look >= 2)
            CHECK_RELATIVE(m->covariance[V_NORTH][V_NORTH],
                           sigma * sigma * (force * force + dt * of_force), 2e-2);
        if (look == 3) {
            const double speed = imk_vector3_norm(now.velocity);
            CHECK_RELATIVE(m->covariance[NORTH][NORTH],
                           sigma * sigma * (speed * speed + dt * moved), 3e-3);
        }
        look++;
    }
    free(analysis);
    imk_motion_file_free(file);
}

/* A filter of second order delays by 2 zeta/w; w from where |H|^2 = 1/2, found here by bisection.
 */
static void filters_delay(void **state)
{
    (void)state;
    imk_motion_file *file = motion_of(turntable);
    const imk_drift_settings settings = on(file);
    const double rate = pi / 2.0; /* 90 deg/s */
    static const double damping[3] = {0.0, 0.3, 2.0};
    for (int i = 0; i < 3; i++) {
        const double zeta = damping[i];
        imk_model model;
        imk_model_default(&model);
        for (int axis = 0; axis < 3; axis++) {
            model.gyro.bandwidth.value[axis] = 20.0;
            model.gyro.damping.value[axis] = zeta;
        }
        double low = 0.0, high = 10.0; /* of x = w(-3 dB)/w */
        for (int k = 0; k < 60; k++) {
            const double x = 0.5 * (low + high), a = 1.0 - x * x, b = 2.0 * zeta * x;
            if (a * a + b * b < 2.0)
                low = x;
            else
                high = x;
        }
        const double delay = (zeta == 0.0 ? 1.0 : 2.0 * zeta * low) / (2.0 * pi * 20.0);
        const imk_drift_moments m = total_at(&model, settings, 10.0);
        CHECK_RELATIVE(m.mean[HEADING], -rate * delay, 1e-4);
        assert_int_equal((int)(m.covariance[HEADING][HEADING] == 0.0), 1);
        imk_drift_settings at_rest = imk_drift_default();
        static const double one_time[1] = {10.0};
        at_rest.time = one_time;
        at_rest.time_count = 1;
        imk_drift_analysis *analysis = analyse(&model, &at_rest);
        assert_false(has_source(analysis, "gyro.bandwidth"));
        free(analysis);
    }
    imk_motion_file_free(file);
}

/* Compensated, the sigma of skew and rate error is what is left of them. */
static void clocks_are_compensated(void **state)
{
    (void)state;
    imk_motion_file *file = motion_of(turntable);
    imk_drift_settings settings = on(file);
    imk_model known, calibrated;
    imk_model_default(&known);
    imk_model_default(&calibrated);
    known.timing.skew.value = 2e-3;
    known.timing.rate_error.value = 3e-5;
    calibrated.timing.skew = (imk_scalar){7e-3, 2e-3};
    calibrated.timing.rate_error = (imk_scalar){8e-5, 3e-5};
    static const double one_time[1] = {22.0};
    settings.time = one_time;
    settings.time_count = 1;
    imk_drift_analysis *a = analyse(&known, &settings);
    settings.compensated = true;
    imk_drift_analysis *b = analyse(&calibrated, &settings);
    assert_int_equal(a->source_count, 2);
    assert_int_equal(b->source_count, 2);
    for (size_t source = 0; source < 2; source++)
        for (int i = 0; i < 9; i++) {
            CHECK_CLOSE(b->contribution[source].mean[i], 0.0, 0.0);
            const double mean = a->contribution[source].mean[i];
            CHECK_RELATIVE(b->contribution[source].covariance[i][i], mean * mean, 1e-9);
        }
    free(a);
    free(b);
    imk_motion_file_free(file);
}

/* ---- short manoeuvres ---------------------------------------------------------------------------
 */

/* A scale factor error e turns the heading by e times the angle; the Earth adds its own turn. */
static void quick_turns_are_seen(void **state)
{
    (void)state;
    imk_motion_file *file = motion_of("imukit_motion: 1\n"
                                      "start: {latitude: 0 deg}\n"
                                      "smoothing: 0.02 s\n"
                                      "steps:\n"
                                      "  - hold 2.013 s\n"
                                      "  - rotate z 90 deg at 200 deg/s\n"
                                      "  - hold 5 s\n");
    imk_model model;
    imk_model_default(&model);
    model.gyro.scale_factor.fixed.value[2] = 1e-5;
    const imk_drift_moments m = total_at(&model, on(file), 5.0);
    CHECK_RELATIVE(m.mean[HEADING], 1e-5 * pi / 2.0, 1e-4);
    imk_motion_file_free(file);
    /* There and back within two seconds, long after anything has moved: steps are long by then. */
    file = motion_of("imukit_motion: 1\n"
                     "start: {latitude: 0 deg}\n"
                     "smoothing: 0.1 s\n"
                     "steps:\n"
                     "  - hold 66.2 s\n"
                     "  - rotate z 70 deg at 100 deg/s\n"
                     "  - rotate z -70 deg at 100 deg/s\n"
                     "  - hold 30 s\n");
    imk_model_default(&model);
    model.gyro.nonlinearity.asymmetry.value[2] = 1e-5;
    const imk_drift_moments n = total_at(&model, on(file), 90.0);
    CHECK_RELATIVE(n.mean[HEADING], 0.5e-5 * 140.0 / 180.0 * pi, 1e-4);
    imk_motion_file_free(file);
}

/* ---- the vertical -------------------------------------------------------------------------------
 */

/* The velocity stays level where the unit believes to be: displaced by d along its way, v leans
 * down by d/radius, M of the meridian to the north, N to the east, which at the equator differ by
 * e^2 = 0.7 %. */
static void slaved_velocity_leans(void **state)
{
    (void)state;
    for (int direction = 0; direction < 2; direction++) {
        char text[256];
        snprintf(text, sizeof text,
                 "imukit_motion: 1\n"
                 "start: {latitude: 0 deg, heading: %d deg, speed: 100 m/s}\n"
                 "steps: [hold 20 s]\n",
                 90 * direction);
        imk_motion_file *file = motion_of(text);
        imk_drift_settings settings = on(file);
        settings.initial_sigma[direction] = 10.0;
        imk_model model;
        imk_model_default(&model);
        const imk_drift_moments m = total_at(&model, settings, 0.5);
        double radius[2];
        imk_curvature_radii(0.0, &radius[0], &radius[1]);
        const double lean = 100.0 / radius[direction];
        CHECK_RELATIVE(m.covariance[V_DOWN][V_DOWN], lean * lean * 100.0, 1e-3);
        CHECK_RELATIVE(m.covariance[V_DOWN][direction], lean * 100.0, 1e-3);
        CHECK_CLOSE(m.covariance[DOWN][DOWN], 0.0, 0.0);
        imk_motion_file_free(file);
    }
}

/* North and vertical are those of the place where the unit believes to be: displaced by d to the
 * east it turns by d/N about north, and by -tan(latitude) d/N about down. */
static void alignment_is_that_of_the_believed_place(void **state)
{
    (void)state;
    imk_drift_settings settings = imk_drift_default();
    settings.alignment = IMK_ALIGNED_SELF;
    settings.latitude = -0.8;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    settings.initial_sigma[EAST] = 10.0;
    settings.initial_sigma[HEADING] = 1e-3; /* not with self-alignment */
    const double time = 1e-3;
    settings.time = &time;
    settings.time_count = 1;
    imk_model model;
    imk_model_default(&model);
    imk_drift_analysis *analysis = analyse(&model, &settings);
    double meridian, prime_vertical;
    imk_curvature_radii(-0.8, &meridian, &prime_vertical);
    assert_int_equal(analysis->source_count, 1);
    assert_true(has_source(analysis, "initial.position"));
    const imk_drift_moments *m = analysis->total;
    CHECK_RELATIVE(m->covariance[TILT_NORTH][EAST], 100.0 / prime_vertical, 1e-6);
    CHECK_RELATIVE(m->covariance[HEADING][EAST], -tan(-0.8) * 100.0 / prime_vertical, 1e-6);
    free(analysis);
}

/* An alignment as long as a step of the navigation is nothing special. */
static void alignment_may_last_a_step(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.random_walk.value[i] = 1e-9;
        model.accel.noise.random_walk.value[i] = 1e-6;
    }
    imk_drift_settings settings = imk_drift_default();
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 60.0;
    const imk_drift_moments same = total_at(&model, settings, 600.0);
    settings.alignment_time = 60.0 + 1e-6;
    const imk_drift_moments other = total_at(&model, settings, 600.0);
    for (int i = 0; i < 9; i++)
        CHECK_CLOSE(same.covariance[i][i], other.covariance[i][i], 1e-6 * same.covariance[i][i]);
}

/* ---- what is left out, and what is refused ------------------------------------------------------
 */

/* Vibration is left out and named, and so is a range that the motion comes near to. */
static void what_is_left_out_is_named(void **state)
{
    (void)state;
    imk_motion_file *smooth = motion_of(turntable);
    char text[512];
    snprintf(text, sizeof text, "%svibration: [sine z 5 m/s^2 at 20 Hz]\n", turntable);
    imk_motion_file *rough = motion_of(text);
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.scale_factor.fixed.value[i] = 1e-4;
        model.accel.nonlinearity.k2.value[i] = 1e-4;
        model.gyro.range.value[i] = 1.5;
        model.accel.range.value[i] = 12.0;
    }
    static const double one_time[1] = {25.0};
    imk_drift_settings settings = on(smooth);
    settings.time = one_time;
    settings.time_count = 1;
    imk_drift_analysis *a = analyse(&model, &settings);
    settings.motion = imk_motion_file_motion(rough)->trajectory;
    imk_drift_analysis *b = analyse(&model, &settings);
    assert_true(omits(a, "gyro.range"));
    assert_false(omits(a, "accel.range"));
    assert_false(omits(a, "motion.vibration"));
    assert_true(omits(b, "motion.vibration"));
    for (int i = 0; i < 9; i++)
        CHECK_CLOSE(b->total->mean[i], a->total->mean[i], 1e-12 * fabs(a->total->mean[i]));
    free(a);
    free(b);
    imk_motion_file_free(smooth);
    imk_motion_file_free(rough);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    static const double twice[2] = {5.0, 5.0};
    imk_drift_settings settings = imk_drift_default();
    settings.time = twice;
    settings.time_count = 2;
    imk_error error;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_TIME_ORDER);
    assert_int_equal(error.index, 1);
    settings.time_count = 1;
    settings.alignment = IMK_ALIGNED_SELF;
    CHECK_OK(imk_drift_validate(&model, &settings, &error));
    settings.alignment_time = 0.99;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "alignment_time");
    settings.alignment_time = 60.0;
    static const char *const begins[2] = {
        "imukit_motion: 1\nstart: {speed: 10 mm/s}\nsteps: [hold 20 s]\n",
        "imukit_motion: 1\nsteps: [hold 20 s]\n"};
    for (int i = 0; i < 2; i++) {
        imk_motion_file *file = motion_of(begins[i]);
        settings.motion = imk_motion_file_motion(file)->trajectory;
        CHECK_STATUS(imk_drift_validate(&model, &settings, &error),
                     i == 0 ? IMK_ERROR_CONFLICT : IMK_OK);
        imk_motion_file_free(file);
    }
    /* In its place, but turning by 2e-6 rad/s from the first instant on. */
    imk_trajectory_piece piece;
    imk_trajectory turning;
    static const double level[3] = {0.0, 0.0, 0.0};
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){0.5, 0.0, 0.0}, level, true, &piece, &turning,
                                       NULL));
    piece.length = 10.0;
    for (int i = 0; i < 2; i++) {
        settings.motion = &turning;
        CHECK_STATUS(imk_drift_validate(&model, &settings, &error),
                     i == 0 ? IMK_OK : IMK_ERROR_CONFLICT);
        const double w = piece.quaternion[0][0], z = piece.quaternion[3][0];
        piece.quaternion[0][1] = -1e-6 * z;
        piece.quaternion[3][1] = 1e-6 * w;
        piece.quaternion[1][1] = -1e-6 * piece.quaternion[2][0];
        piece.quaternion[2][1] = 1e-6 * piece.quaternion[1][0];
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flicker_is_that_of_the_samples),
        cmocka_unit_test(gauss_markov_is_that_of_the_samples),
        cmocka_unit_test(resonances_are_those_of_the_samples),
        cmocka_unit_test(sinusoids_add_up_like_samples),
        cmocka_unit_test(rounding_is_a_twelfth),
        cmocka_unit_test(jitter_acts_on_changes_and_at_the_end),
        cmocka_unit_test(filters_delay),
        cmocka_unit_test(clocks_are_compensated),
        cmocka_unit_test(quick_turns_are_seen),
        cmocka_unit_test(slaved_velocity_leans),
        cmocka_unit_test(alignment_is_that_of_the_believed_place),
        cmocka_unit_test(alignment_may_last_a_step),
        cmocka_unit_test(what_is_left_out_is_named),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
