/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance analysis at rest: the table of grades, single sources on a sphere and on the Earth,
 * Schuler and Foucault, one joint covariance of everything, self-alignment in closed form, and what
 * the result promises of itself. The motion is tested in test_drift_response.c. */
#include "check.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/drift.h"
#include "imukit/thread_pool.h"
#include "model/horizontal_error.h"
#include "navigate/drift/drift_covariance_internal.h"

#include <stdlib.h>
#include <string.h>

static const double degree_per_hour = 3.14159265358979323846 / 180 / 3600;
static const double micro_g = 9.80665e-6;
static const imki_drift_earth sphere = {6371e3, 9.80665}, wgs84 = {0, 0};

static void set_all(imk_axes *axes, double value)
{
    for (int i = 0; i < 3; i++)
        axes->value[i] = value;
}

/* The caller frees what the analysis stands in: itself. */
static imk_drift_analysis *analyse_on(imki_drift_earth earth, const imk_model *model,
                                      const imk_drift_settings *settings,
                                      const imk_executor *executor)
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = aligned_alloc(64, size);
    imk_drift_analysis *analysis = NULL;
    imk_error error;
    assert_non_null(memory);
    CHECK_OK(imki_drift_covariance_on(earth, model, settings, memory, size, executor, &analysis,
                                      &error));
    assert_ptr_equal(analysis, memory);
    return analysis;
}

static imk_drift_moments total_at(imki_drift_earth earth, const imk_model *model,
                                  imk_drift_settings settings, double time)
{
    settings.time = &time;
    settings.time_count = 1;
    imk_drift_analysis *analysis = analyse_on(earth, model, &settings, NULL);
    const imk_drift_moments moments = analysis->total[0];
    free(analysis);
    return moments;
}

static double sigma(const imk_drift_moments *moments, int state)
{
    return sqrt(moments->covariance[state][state]);
}

static double horizontal(const imk_drift_moments *moments)
{
    return sqrt(moments->covariance[0][0] + moments->covariance[1][1]);
}

/* ---- known figures ----------------------------------------------------------------------------
 */

/* Independent arithmetic for biases alone: CEP and DRMS, with the two or three digits given. */
static void grades_have_the_known_figures(void **state)
{
    (void)state;
    static const struct {
        double gyro, accel, t, cep, drms, unit;
    } known[] = {
        {0.005, 30, 60, 0.62, 0.75, 1},       {0.005, 30, 3600, 0.455, 0.547, 1852},
        {0.005, 30, 86400, 3.45, 5.11, 1852}, {0.01, 50, 60, 1.04, 1.25, 1},
        {0.01, 50, 3600, 0.895, 1.08, 1852},  {0.01, 50, 86400, 6.90, 10.2, 1852},
        {1, 1000, 60, 20.9, 25.1, 1},         {1, 1000, 3600, 86, 103, 1852},
        {1, 1000, 86400, 689, 1022, 1852},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        imk_model model;
        imk_model_default(&model);
        set_all(&model.gyro.bias.repeatability, known[i].gyro * degree_per_hour);
        set_all(&model.accel.bias.repeatability, known[i].accel * micro_g);
        const imk_drift_moments m = total_at(wgs84, &model, imk_drift_default(), known[i].t);
        const imk_drift_figures figures = imk_drift_figures_of(&m);
        CHECK_RELATIVE(figures.drms, known[i].drms * known[i].unit, 0.01);
        CHECK_RELATIVE(figures.cep, known[i].cep * known[i].unit, 0.01);
        CHECK_RELATIVE(
            figures.cep,
            cep((covariance){m.covariance[0][0], m.covariance[0][1], m.covariance[1][1]}), 1e-4);
    }
}

static imk_drift_moments of_gyro(imki_drift_earth earth, int axis, double size, double t)
{
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability.value[axis] = size * degree_per_hour;
    return total_at(earth, &model, imk_drift_default(), t);
}

static imk_drift_moments of_accel(imki_drift_earth earth, int axis, double size, double t,
                                  imk_vertical vertical)
{
    imk_model model;
    imk_model_default(&model);
    model.accel.bias.repeatability.value[axis] = size * micro_g;
    imk_drift_settings settings = imk_drift_default();
    settings.vertical = vertical;
    return total_at(earth, &model, settings, t);
}

/* Single sources at 45 deg north: on the sphere to half the last digit given, on the ellipsoid,
 * whose radii and gravity are other ones, to 1.5 %. */
static void single_sources_have_the_known_figures(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const imki_drift_earth earth = i == 0 ? sphere : wgs84;
        const double fine = i == 0 ? 5e-4 : 0.015, coarse = i == 0 ? 4e-3 : 0.015;
        imk_drift_moments m = of_gyro(earth, 0, 0.01, 3600);
        CHECK_RELATIVE(sigma(&m, 1), 1340.6, fine);
        m = of_gyro(earth, 1, 0.01, 3600);
        CHECK_RELATIVE(sigma(&m, 0), 1336.5, fine);
        m = of_gyro(earth, 2, 0.01, 3600);
        CHECK_RELATIVE(sigma(&m, 0), 89.6, fine);
        m = of_gyro(earth, 0, 0.01, 60);
        CHECK_RELATIVE(sigma(&m, 1), 0.0171, coarse);
        m = of_gyro(earth, 0, 0.01, 86400);
        CHECK_RELATIVE(sigma(&m, 1), 13400, coarse);
        m = of_accel(earth, 0, 50, 3600, IMK_VERTICAL_SLAVED);
        CHECK_RELATIVE(sigma(&m, 0), 396.0, i == 0 ? fine : 0.015);
        m = of_accel(earth, 0, 50, 5064.3 / 2, IMK_VERTICAL_SLAVED);
        CHECK_RELATIVE(sigma(&m, 0), 634.4, fine); /* the peak, half a Schuler period on */
        m = of_accel(earth, 2, 50, 3600, IMK_VERTICAL_FREE);
        /* An integration of r'' = G r - 2 w x r' + b on the sphere by Runge and Kutta's method in
         * steps of 1 s; without the Earth's rotation it gives b/w^2 (cosh wt - 1) = 43929. */
        CHECK_RELATIVE(sigma(&m, 2), 43677.286, fine);
    }
    static const double times[3] = {60, 3600, 86400};
    static const double arw_known[3] = {0.0503, 440, 1890}, vrw_known[3] = {0.0372, 4.61, 23.2};
    for (int i = 0; i < 3; i++) {
        imk_model model;
        imk_model_default(&model);
        set_all(&model.gyro.noise.white, 0.002 * pi / 180 / 60);
        imk_drift_moments m = total_at(sphere, &model, imk_drift_default(), times[i]);
        CHECK_RELATIVE(horizontal(&m), arw_known[i], 2e-3);
        imk_model_default(&model);
        set_all(&model.accel.noise.white, 10 * micro_g);
        m = total_at(sphere, &model, imk_drift_default(), times[i]);
        CHECK_RELATIVE(horizontal(&m), vrw_known[i], 2e-3);
    }
}

/* Schuler's pendulum [BRITTING1971]: a north velocity v at the start swings as v/w sin(w t), and
 * the free vertical grows as the hyperbolic sine of sqrt(2) w t. Over 100 s the Earth's rotation
 * turns the swing by 0.5 %, and takes (0.005)^2/2 of it. */
static void schuler_and_the_vertical(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    const double w = sqrt(sphere.gravity / sphere.radius), t = 100;
    imk_drift_settings settings = imk_drift_default();
    settings.initial_sigma[3] = 1;
    imk_drift_moments m = total_at(sphere, &model, settings, t);
    CHECK_RELATIVE(sigma(&m, 0), sin(w * t) / w, 3e-5);
    settings.initial_sigma[3] = 0;
    settings.initial_sigma[5] = 1;
    m = total_at(sphere, &model, settings, t);
    assert_true(m.covariance[2][2] == 0 && m.covariance[5][5] == 0); /* slaved */
    settings.vertical = IMK_VERTICAL_FREE;
    m = total_at(sphere, &model, settings, t);
    CHECK_RELATIVE(sigma(&m, 2), sinh(sqrt(2) * w * t) / (sqrt(2) * w), 3e-5);
}

/* Power of the swing at a (signed) frequency: north + i east, less its mean, with Hann's window. */
static double power_at(const imk_drift_analysis *analysis, double step, double frequency)
{
    double real = 0, imaginary = 0, mean[2] = {0, 0};
    const size_t n = analysis->time_count;
    for (size_t k = 0; k < n; k++)
        for (int i = 0; i < 2; i++)
            mean[i] += analysis->total[k].mean[i] / (double)n;
    for (size_t k = 0; k < n; k++) {
        const double window = 1 - cos(2 * pi * ((double)k + 0.5) / (double)n);
        const double north = window * (analysis->total[k].mean[0] - mean[0]);
        const double east = window * (analysis->total[k].mean[1] - mean[1]);
        const double angle = frequency * step * (double)k;
        real += north * cos(angle) + east * sin(angle);
        imaginary += east * cos(angle) - north * sin(angle);
    }
    return real * real + imaginary * imaginary;
}

/* The frequency of most power near a guess, by thirds. */
static double strongest(const imk_drift_analysis *analysis, double step, double low, double high)
{
    for (int i = 0; i < 40; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (power_at(analysis, step, a) < power_at(analysis, step, b))
            low = a;
        else
            high = b;
    }
    return 0.5 * (low + high);
}

/* A horizontal swing turns as Foucault's pendulum does: 84.4 minutes split into 80.97 and 87.99
 * (+-0.005, as they are printed; the window over two days leaves 1e-4 of the other line). */
static void periods_of_schuler_and_foucault(void **state)
{
    (void)state;
    enum { COUNT = 480 };
    const double step = 360;
    static double time[COUNT];
    for (int i = 0; i < COUNT; i++)
        time[i] = step * (i + 1);
    imk_model model;
    imk_model_default(&model);
    model.accel.bias.fixed.value[0] = 50 * micro_g;
    imk_drift_settings settings = imk_drift_default();
    settings.time = time;
    settings.time_count = COUNT;
    imk_drift_analysis *analysis = analyse_on(sphere, &model, &settings, NULL);
    const double first = 2 * pi / (80.97 * 60), second = 2 * pi / (87.99 * 60);
    double found[2] = {0, 0};
    for (int sign = 0; sign < 2; sign++) {
        const double s = sign == 0 ? 1 : -1;
        /* which of the two turns which way is the hemisphere's; take what is strong there */
        for (int i = 0; i < 2; i++) {
            const double guess = i == 0 ? first : second, width = 1.2e-5;
            const double a = s > 0 ? guess - width : -guess - width;
            const double at = strongest(analysis, step, a, a + 2 * width);
            if (power_at(analysis, step, at) >
                100 * power_at(analysis, step, s * (i == 0 ? second : first)))
                found[i] = 2 * pi / fabs(at) / 60;
        }
    }
    CHECK_CLOSE(found[0], 80.97, 0.01);
    CHECK_CLOSE(found[1], 87.99, 0.01);
    CHECK_RELATIVE(2 / (1 / found[0] + 1 / found[1]), 84.4, 1e-3);
    free(analysis);
}

/* ---- independent computations -----------------------------------------------------------------
 */

/* Constants and every kind of noise against the impulse responses of
 * horizontal_error.h, which integrates over the past instead of stepping forward: 0.1 % for
 * its 2000 points; flicker 0.5 %, since its fastest stages are below those. */
static void noise_agrees_with_impulse_responses(void **state)
{
    (void)state;
    static const double times[] = {60, 3600, 86400};
    for (int which = 0; which < 5; which++)
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < 3; i++) {
                imk_model model;
                imk_model_default(&model);
                imk_triad *triad = sensor == 0 ? &model.gyro : &model.accel;
                imk_axes *const terms[5] = {
                    &triad->noise.white, &triad->noise.random_walk, &triad->noise.bias_instability,
                    &triad->noise.gauss_markov[0].sigma, &triad->bias.repeatability};
                set_all(terms[which], 1e-6);
                triad->noise.gauss_markov_count = which == 3;
                set_all(&triad->noise.gauss_markov[0].correlation_time, 500);
                const imk_drift_moments m = total_at(sphere, &model, imk_drift_default(), times[i]);
                covariance expected = {0, 0, 0};
                for (int input = 0; input < (sensor == 0 ? 3 : 2); input++) {
                    const int at = sensor == 0 ? input : 3 + input;
                    const double t = times[i];
                    add(&expected, 1e-12,
                        which == 0   ? unit_white(at, t)
                        : which == 1 ? unit_random_walk(at, t)
                        : which == 2 ? unit_flicker(at, t)
                        : which == 4 ? unit_constant(at, t)
                                     : unit_gauss_markov(at, 500, t));
                }
                CHECK_RELATIVE(horizontal(&m), drms(expected), which == 2 ? 5e-3 : 1e-3);
            }
}

/* ---- one joint covariance ---- */

static void put_cross(double *a, int row, int column, double factor, const double v[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a[(row + i) * 12 + column + j] -= factor * v[k];
        a[(row + i) * 12 + column + k] += factor * v[j];
    }
}

/* Position, velocity, attitude in north-east-down axes and three Gauss-Markov gyro biases as one
 * system of twelve states on the sphere, vertical free, with white noise on all six axes. */
static void joint(const imk_drift_settings *s, double white_gyro, double white_accel, double markov,
                  double correlation_time, double t, double p[12][12])
{
    const double rate[3] = {earth_rate * cos(s->latitude), 0, -earth_rate * sin(s->latitude)};
    const double force[3] = {0, 0, -sphere.gravity};
    const double w2 = sphere.gravity / sphere.radius;
    const imk_matrix3 c = imk_matrix3_from_euler(s->roll, s->pitch, s->yaw);
    double a[144] = {0}, density[144] = {0}, phi[144], q[144];
    for (int i = 0; i < 3; i++) {
        a[i * 12 + 3 + i] = 1;
        a[(3 + i) * 12 + i] = i < 2 ? -w2 : 2 * w2;
        a[(9 + i) * 12 + 9 + i] = -1 / correlation_time;
        for (int j = 0; j < 3; j++)
            a[(6 + i) * 12 + 9 + j] = c.m[i][j];
        density[(3 + i) * 13] = white_accel * white_accel;
        density[(6 + i) * 13] = white_gyro * white_gyro;
        density[(9 + i) * 13] = 2 * markov * markov / correlation_time;
    }
    put_cross(a, 3, 3, -2, rate);
    put_cross(a, 3, 6, -1, force);
    put_cross(a, 6, 6, -1, rate);
    imki_exponential(12, a, t, phi);
    imki_step_covariance(12, a, density, t, q);
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
            p[i][j] = q[i * 12 + j];
            for (int k = 0; k < 12; k++) {
                const double start = k < 9 ? s->initial_sigma[k] : markov;
                p[i][j] += phi[i * 12 + k] * start * start * phi[j * 12 + k];
            }
        }
}

/* 1e-6 of the product of sigmas: steps of a minute leave 1e-7 (drift_steps.c). */
static void sources_add_up_to_one_joint_covariance(void **state)
{
    (void)state;
    const double white_gyro = 2e-5, white_accel = 3e-4, markov = 4e-6, correlation_time = 700;
    imk_model model;
    imk_model_default(&model);
    set_all(&model.gyro.noise.white, white_gyro);
    set_all(&model.accel.noise.white, white_accel);
    model.gyro.noise.gauss_markov_count = 1;
    set_all(&model.gyro.noise.gauss_markov[0].sigma, markov);
    set_all(&model.gyro.noise.gauss_markov[0].correlation_time, correlation_time);
    imk_drift_settings settings = imk_drift_default();
    settings.latitude = 0.6;
    settings.roll = 0.4, settings.pitch = -0.3, settings.yaw = 2;
    settings.vertical = IMK_VERTICAL_FREE;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    for (int i = 0; i < 9; i++)
        settings.initial_sigma[i] = (double[]){10, 20, 5, 0.1, 0.3, 0.2, 1e-4, 2e-4, 1e-3}[i];
    const double times[2] = {100, 1800};
    for (int k = 0; k < 2; k++) {
        double expected[12][12];
        joint(&settings, white_gyro, white_accel, markov, correlation_time, times[k], expected);
        const imk_drift_moments m = total_at(sphere, &model, settings, times[k]);
        for (int i = 0; i < 9; i++)
            for (int j = 0; j < 9; j++)
                CHECK_CLOSE(m.covariance[i][j], expected[i][j],
                            1e-6 * sqrt(expected[i][i] * expected[j][j]));
    }
}

/* The claims of the classes (imk_grade_table()) by their presets; and the figures their notes
 * print, which another computation gave (tests/model/test_position_claims.c): to 3 %, since there
 * what is known counts as random. */
static void presets_meet_their_claims(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double t, printed, at_most, at_least; /* CEP [m] */
    } preset[] = {
        {"strategic", 86400, 0.43 * 1852, 1852, 0},
        {"strategic", 3600, 0.056 * 1852, 1852, 0},
        {"navigation", 3600, 0.71 * 1852, 1852, 0},
        {"navigation", 86400, 6.0 * 1852, 44448, 0},
        {"tactical", 3600, 80 * 1852, 1e9, 10 * 1852},
        {"tactical", 60, 17, 1e9, 0},
        {"AHRS", 60, 35, 1e9, 17},
        {"control", 60, 1200, 1e9, 36},
    };
    for (size_t i = 0; i < sizeof preset / sizeof preset[0]; i++) {
        imk_model model;
        imk_device_model(imk_device_find(preset[i].name), &model);
        const imk_drift_moments m = total_at(wgs84, &model, imk_drift_default(), preset[i].t);
        const double cep_found = imk_drift_figures_of(&m).cep;
        CHECK_RELATIVE(cep_found, preset[i].printed, 0.03);
        CHECK_BELOW(cep_found, preset[i].at_most);
        CHECK_BELOW(preset[i].at_least, cep_found);
    }
}

/* ---- limits of the drivers ----------------------------------------------------------------------
 */

static double after_an_hour(const imk_model *model, int state)
{
    const imk_drift_moments m = total_at(wgs84, model, imk_drift_default(), 3600);
    return sigma(&m, state);
}

/* A slow sinusoid is a constant of a/sqrt 2, one as fast as the samples a constant too; a fast
 * resonance is white noise of sigma sqrt(2/(w Q)); a slow process is a constant. */
static void drivers_have_their_limits(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability.value[0] = 1e-8;
    const double constant = after_an_hour(&model, 1);
    imk_model_default(&model);
    model.gyro.noise.gauss_markov_count = 1;
    model.gyro.noise.gauss_markov[0].sigma.value[0] = 1e-8;
    model.gyro.noise.gauss_markov[0].correlation_time.value[0] = 1e10;
    CHECK_RELATIVE(after_an_hour(&model, 1), constant, 1e-6); /* t/T */
    static const double frequency[2] = {1e-9, 100};
    for (int i = 0; i < 2; i++) {
        imk_model_default(&model);
        model.gyro.noise.sinusoid_count = 1;
        model.gyro.noise.sinusoid[0].amplitude.value[0] = 1e-8 * sqrt(2);
        model.gyro.noise.sinusoid[0].frequency.value[0] = frequency[i];
        CHECK_RELATIVE(after_an_hour(&model, 1), constant, 1e-8); /* (2 pi f t)^2 */
    }
    imk_model_default(&model);
    model.gyro.noise.white.value[0] = 1e-6;
    const double white = after_an_hour(&model, 1);
    imk_model_default(&model);
    model.gyro.noise.resonance_count = 1;
    const double w = 2 * pi * 5, q = 3;
    model.gyro.noise.resonance[0].sigma.value[0] = 1e-6 / sqrt(2 / (w * q));
    model.gyro.noise.resonance[0].frequency.value[0] = 5;
    model.gyro.noise.resonance[0].q.value[0] = q;
    CHECK_RELATIVE(after_an_hour(&model, 1), white, 1e-3);
    model.gyro.noise.resonance[0].frequency.value[0] = 30; /* folded, at 100 Hz */
    model.gyro.noise.resonance[0].sigma.value[0] = 1e-6 / sqrt(2 / (6 * w * q));
    CHECK_RELATIVE(after_an_hour(&model, 1), white, 0.2); /* folding adds some per cent */
}

/* The angle carried is seen as it is; of velocity, sqrt 2 of what is carried at start and end. */
static void check_readings(imk_model model)
{
    const imk_drift_moments m = total_at(wgs84, &model, imk_drift_default(), 1);
    for (int i = 0; i < 3; i++)
        CHECK_RELATIVE(sigma(&m, 6 + i), 1e-5 * sqrt(2), 1e-3);
    /* and the accelerometers', with what tilts of 1e-5 at both ends make of gravity in a second:
     * the start's acts all the time, the others' as white noise of 1e-5 sqrt(dt) */
    const double tilted = 1e-5 * 9.806 * sqrt(1 + 0.01);
    CHECK_RELATIVE(sigma(&m, 3), sqrt(2e-6 + tilted * tilted), 1e-3);
}

/* Other errors of readings do the same; white ones are A/sqrt(dt) of 1/dt = 100 Hz. */
static void quantization_stays_what_is_carried(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        imk_model model;
        imk_model_default(&model);
        imk_noise *gyro = &model.gyro.noise, *accel = &model.accel.noise;
        const double size = kind == 2 ? 0.1 : 1.0;
        set_all(kind == 0   ? &gyro->quantization
                : kind == 1 ? &gyro->reading_noise
                            : &gyro->angle_white,
                size * 1e-5);
        set_all(kind == 0   ? &accel->quantization
                : kind == 1 ? &accel->reading_noise
                            : &accel->angle_white,
                size * 1e-3);
        check_readings(model);
    }
}

/* ---- self-alignment ---- */

/* An accelerometer's bias b tilts by b/g, which takes its effect away, and turns the heading by
 * tan L b/g; a gyro's turns it by d/(W cos L); white noise N by N/sqrt(T)/(W cos L) [BRITTING1971].
 */
static void self_alignment_in_closed_form(void **state)
{
    (void)state;
    imk_drift_settings settings = imk_drift_default();
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 400;
    settings.latitude = 0.5;
    const double across = earth_rate * cos(0.5), g = imk_normal_gravity(0.5, 0), b = 1e-3;
    imk_model model;
    imk_model_default(&model);
    set_all(&model.accel.bias.repeatability, b);
    imk_drift_moments m = total_at(wgs84, &model, settings, 1e-3);
    CHECK_RELATIVE(sigma(&m, 6), b / g, 1e-6);
    CHECK_RELATIVE(sigma(&m, 7), b / g, 1e-6);
    CHECK_RELATIVE(sigma(&m, 8), tan(0.5) * b / g, 1e-6);
    CHECK_CLOSE(m.covariance[6][8], tan(0.5) * b * b / g / g * -1, 1e-6 * b * b / g / g);
    m = total_at(wgs84, &model, settings, 60);
    CHECK_BELOW(sigma(&m, 0), 2e-3 * b * 1800); /* of b t^2/2 */

    imk_model_default(&model);
    set_all(&model.gyro.bias.repeatability, 1e-8);
    m = total_at(wgs84, &model, settings, 1e-3);
    CHECK_RELATIVE(sigma(&m, 8), 1e-8 / across, 1e-6);
    CHECK_BELOW(sigma(&m, 6), 1e-10);
    /* The turned heading makes the Earth's rate look like the gyro's: east stays level. */
    const imk_drift_moments given = of_gyro(wgs84, 1, 1e-8 / degree_per_hour, 600);
    m = total_at(wgs84, &model, settings, 600);
    CHECK_BELOW(sigma(&m, 0), 0.2 * sigma(&given, 0));

    imk_model_default(&model);
    set_all(&model.gyro.noise.white, 1e-6);
    set_all(&model.accel.noise.white, 1e-3);
    m = total_at(wgs84, &model, settings, 1e-6);
    const double tilt = 1e-3 / 20 / g, turn = tan(0.5) * tilt, heading = 1e-6 / 20 / across;
    CHECK_RELATIVE(sigma(&m, 6), tilt, 1e-4);
    CHECK_RELATIVE(sigma(&m, 8), sqrt(turn * turn + heading * heading), 1e-4);

    imk_model_default(&model); /* of a mean of what is carried: (e_N - e_0)/T, and e_N itself */
    set_all(&model.accel.noise.quantization, 0.1);
    m = total_at(wgs84, &model, settings, 1e-6);
    CHECK_RELATIVE(sigma(&m, 6), 0.1 * sqrt(2) / 400 / g, 1e-4);
}

/* The vertical found is that of the place where the unit believes to be, and is displayed right. */
static void self_alignment_at_a_wrong_place(void **state)
{
    (void)state;
    imk_drift_settings settings = imk_drift_default();
    settings.alignment = IMK_ALIGNED_SELF;
    settings.initial_sigma[0] = 1000;
    imk_model model;
    imk_model_default(&model);
    imk_drift_moments m = total_at(wgs84, &model, settings, 1);
    /* wrong by the Earth's rate of another latitude, for a second */
    CHECK_BELOW(sigma(&m, 7), 1e-4 * 1000 / 6.4e6);
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    m = total_at(wgs84, &model, settings, 1);
    double meridian, prime_vertical;
    imk_curvature_radii(settings.latitude, &meridian, &prime_vertical);
    CHECK_RELATIVE(sigma(&m, 7), 1000 / meridian, 1e-4);
    /* so it rests but for the Earth's rate, which is that of another latitude */
    CHECK_BELOW(sigma(&m, 3), 1e-3 * 9.8 * 1000 / meridian);
}

/* ---- what the result promises ---- */

static imk_model everything(void)
{
    imk_model model;
    imk_device_model(imk_device_find("tactical"), &model);
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_triad *triad = sensor == 0 ? &model.gyro : &model.accel;
        set_all(&triad->bias.fixed, 1e-5);
        set_all(&triad->noise.ramp, 1e-9);
        triad->noise.gauss_markov_count = 2;
        set_all(&triad->noise.gauss_markov[1].sigma, 1e-6);
        set_all(&triad->noise.gauss_markov[1].correlation_time, 30);
        triad->noise.sinusoid_count = 1;
        set_all(&triad->noise.sinusoid[0].amplitude, 1e-6);
        set_all(&triad->noise.sinusoid[0].frequency, 0.01);
        set_all(&triad->dead_band, 1e-3);
    }
    return model;
}

static const imk_drift_moments *named(const imk_drift_analysis *analysis, const char *name)
{
    for (size_t i = 0; i < analysis->source_count; i++)
        if (strcmp(analysis->source[i].name, name) == 0)
            return &analysis->contribution[i * analysis->time_count];
    return NULL;
}

static void sources_add_up_on_any_threads(void **state)
{
    (void)state;
    const imk_model model = everything();
    static const double time[3] = {10, 100, 777.7};
    imk_drift_settings settings = imk_drift_default();
    settings.time = time;
    settings.time_count = 3;
    settings.alignment = IMK_ALIGNED_SELF;
    imk_thread_pool *pool = imk_thread_pool_create(3);
    const imk_executor executor = imk_thread_pool_executor(pool);
    imk_drift_analysis *one = analyse_on(wgs84, &model, &settings, NULL);
    imk_drift_analysis *many = analyse_on(wgs84, &model, &settings, &executor);
    assert_int_equal(one->source_count, many->source_count);
    assert_memory_equal(one->contribution, many->contribution,
                        one->source_count * 3 * sizeof *one->contribution);
    assert_memory_equal(one->total, many->total, 3 * sizeof *one->total);
    for (size_t t = 0; t < 3; t++) {
        imk_drift_moments sum = {{0}, {{0}}};
        for (size_t i = 0; i < one->source_count; i++)
            for (int j = 0; j < 9; j++) {
                sum.mean[j] += one->contribution[i * 3 + t].mean[j];
                for (int k = 0; k < 9; k++)
                    sum.covariance[j][k] += one->contribution[i * 3 + t].covariance[j][k];
            }
        assert_memory_equal(&sum, &one->total[t], sizeof sum);
    }
    assert_non_null(named(one, "gyro.bias.fixed"));
    assert_non_null(named(one, "accel.noise.gauss_markov[1]"));
    assert_null(named(one, "accel.noise.gauss_markov[0]")); /* of size 0 */
    assert_int_equal(one->omitted_count, 2);
    assert_string_equal(one->omitted[0], "gyro.dead_band");
    imk_thread_pool_destroy(pool);
    free(one);
    free(many);
}

/* A source can be taken out of the model by its name; a term of a list with the others of it. */
static void names_are_those_of_the_model(void **state)
{
    (void)state;
    const imk_model model = everything();
    const double time = 1;
    imk_drift_settings settings = imk_drift_default();
    settings.time = &time;
    settings.time_count = 1;
    imk_drift_analysis *analysis = analyse_on(wgs84, &model, &settings, NULL);
    assert_true(analysis->source_count > 20);
    for (size_t i = 0; i < analysis->source_count; i++) {
        char name[64];
        strcpy(name, analysis->source[i].name);
        char *bracket = strchr(name, '[');
        if (bracket)
            *bracket = 0;
        imk_model without = model;
        const char *const names[1] = {name};
        CHECK_OK(imk_model_select(&without, false, 1, names, NULL));
        imk_drift_analysis *rest = analyse_on(wgs84, &without, &settings, NULL);
        assert_null(named(rest, analysis->source[i].name));
        assert_int_equal(rest->source_count, analysis->source_count - 1);
        free(rest);
    }
    free(analysis);
}

/* Every source made 1.5 times as large by its name is, alone: in mean and 1 sigma. */
static void check_scaling(bool compensated)
{
    const imk_model model = everything();
    const double time = 1;
    imk_drift_settings settings = imk_drift_default();
    settings.time = &time;
    settings.time_count = 1;
    settings.compensated = compensated;
    settings.attitude_errors = IMK_ATTITUDE_EARTH; /* no differences of nearly equal numbers */
    for (int i = 0; i < 9; i++)
        settings.initial_sigma[i] = 1e-3;
    imk_drift_analysis *analysis = analyse_on(wgs84, &model, &settings, NULL);
    for (size_t i = 0; i < analysis->source_count; i++) {
        imk_model larger = model;
        imk_drift_settings other = settings;
        assert_true(imk_drift_scale_source(analysis->source[i].name, 1.5, &larger, &other, NULL));
        imk_drift_analysis *after = analyse_on(wgs84, &larger, &other, NULL);
        assert_int_equal(after->source_count, analysis->source_count);
        for (size_t k = 0; k < analysis->source_count; k++) {
            const double factor = k == i ? 1.5 : 1.0;
            const imk_drift_moments *a = &analysis->contribution[k], *b = &after->contribution[k];
            for (int j = 0; j < 9; j++) { /* rounding of what is 0 aside */
                const double *block = a->mean + (ptrdiff_t)3 * (j / 3);
                CHECK_CLOSE(b->mean[j], factor * a->mean[j],
                            1e-9 * (fabs(block[0]) + fabs(block[1]) + fabs(block[2])));
                CHECK_RELATIVE(b->covariance[j][j], factor * factor * a->covariance[j][j], 1e-9);
            }
        }
        free(after);
    }
    free(analysis);
    imk_model same = model;
    assert_false(imk_drift_scale_source("gyro.noise.none", 2.0, &same, &settings, NULL));
    assert_false(imk_drift_scale_source("initial.none", 2.0, &same, &settings, NULL));
    assert_false(imk_drift_scale_source("aid.position.white", 2.0, &same, &settings, NULL));
}

static void sources_scale_by_their_names(void **state)
{
    (void)state;
    check_scaling(false);
    check_scaling(true);
}

/* What is known goes with its compensation, and leaves its sigma. */
static void compensation_turns_values_into_sigmas(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.fixed.value[0] = 1e-6;
    model.gyro.bias.fixed.sigma[0] = 1e-7;
    const double time = 600;
    imk_drift_settings settings = imk_drift_default();
    imk_drift_moments before = total_at(wgs84, &model, settings, time);
    settings.compensated = true;
    const imk_drift_moments after = total_at(wgs84, &model, settings, time);
    assert_true(before.covariance[1][1] == 0 && after.mean[1] == 0);
    CHECK_RELATIVE(sigma(&after, 1), 0.1 * fabs(before.mean[1]), 1e-12);
    /* Turned to the right about north, the estimate takes the support of gravity for a push east.
     */
    assert_true(before.mean[1] > 0);
}

/* At the poles, where north is any direction, and with nothing wrong at all. */
static void poles_and_perfection(void **state)
{
    (void)state;
    imk_drift_settings settings = imk_drift_default();
    imk_model model;
    imk_model_default(&model);
    imk_drift_moments m = total_at(wgs84, &model, settings, 3600);
    assert_true(m.covariance[0][0] == 0 && m.mean[0] == 0);
    settings.latitude = pi / 2;
    set_all(&model.gyro.bias.repeatability, 1e-8);
    m = total_at(wgs84, &model, settings, 3600);
    CHECK_RELATIVE(sigma(&m, 0), sigma(&m, 1), 1e-6); /* the axis is an axis of symmetry */
    const imk_drift_moments there = of_gyro(wgs84, 0, 1e-8 / degree_per_hour, 3600);
    CHECK_RELATIVE(sigma(&m, 1), sigma(&there, 1), 0.05);
}

static void expect(imk_status status, const imk_model *model, const imk_drift_settings *settings)
{
    imk_error error;
    CHECK_STATUS(imk_drift_validate(model, settings, &error), status);
    assert_int_equal(error.status, status);
    char memory[64];
    imk_drift_analysis *analysis = NULL;
    CHECK_STATUS(
        imk_drift_covariance(model, settings, NULL, &analysis, memory, sizeof memory, &error),
        status);
}

static void what_is_not_valid_is_refused(void **state)
{
    (void)state;
    const double time[2] = {1, 2}, backwards[2] = {2, 1};
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings good = imk_drift_default(), s;
    expect(IMK_ERROR_EMPTY, &model, &good);
    good.time = time;
    good.time_count = 2;
    CHECK_OK(imk_drift_validate(&model, &good, NULL));
    s = good, s.cookie = 0;
    expect(IMK_ERROR_UNINITIALISED, &model, &s);
    const double longest[2] = {1, 1e8}, too_long[2] = {1, 1.1e8};
    s = good, s.time = longest;
    CHECK_OK(imk_drift_validate(&model, &s, NULL));
    s = good, s.time = too_long;
    expect(IMK_ERROR_RANGE, &model, &s);
    s = good, s.time = backwards;
    expect(IMK_ERROR_TIME_ORDER, &model, &s);
    s = good, s.rate = 0;
    expect(IMK_ERROR_RANGE, &model, &s);
    s = good, s.latitude = 2;
    expect(IMK_ERROR_RANGE, &model, &s);
    s = good, s.initial_sigma[8] = -1;
    expect(IMK_ERROR_RANGE, &model, &s);
    s = good, s.roll = NAN;
    expect(IMK_ERROR_NOT_FINITE, &model, &s);
    s = good, s.alignment = IMK_ALIGNED_SELF, s.latitude = 89.5 * pi / 180;
    expect(IMK_ERROR_CONFLICT, &model, &s);
    imk_model without = model;
    without.accel.present = false;
    expect(IMK_ERROR_UNSUPPORTED, &without, &good);
    without = model;
    without.gyro.direction[0][0] = 0, without.gyro.direction[0][1] = 1;
    expect(IMK_ERROR_UNSUPPORTED, &without, &good);
    without = model;
    without.gyro.noise.white.value[0] = NAN;
    expect(IMK_ERROR_NOT_FINITE, &without, &good);

    char small[64];
    imk_drift_analysis *analysis = NULL;
    imk_error error;
    CHECK_STATUS(imk_drift_covariance(&model, &good, NULL, &analysis, small, sizeof small, &error),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_drift_covariance(&model, &good, NULL, &analysis, NULL, sizeof small, &error),
                 IMK_ERROR_ARGUMENT);
}

/* A unit that aligns itself stands still: it turns by less than a thousandth of the Earth's
 * rotation, which the alignment would not see, and not by a hundredth. */
static void alignment_needs_a_rest(void **state)
{
    (void)state;
    const double time[1] = {1};
    imk_model model;
    const double level[3] = {0, 0, 0};
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    imk_model_default(&model);
    imk_drift_settings s = imk_drift_default();
    s.time = time;
    s.time_count = 1;
    s.alignment = IMK_ALIGNED_SELF;
    s.motion = &trajectory;
    for (int k = 0; k < 2; k++) {
        const double turning = (k == 0 ? 0.5e-3 : 1e-2) * IMK_EARTH_RATE;
        CHECK_OK(imk_trajectory_standstill((imk_geodetic){0.8, 0, 0}, level, true, &piece,
                                           &trajectory, NULL));
        /* q' = q (0, 0, 0, w)/2 */
        piece.length = 10;
        piece.quaternion[0][1] = -0.5 * turning * piece.quaternion[3][0];
        piece.quaternion[1][1] = 0.5 * turning * piece.quaternion[2][0];
        piece.quaternion[2][1] = -0.5 * turning * piece.quaternion[1][0];
        piece.quaternion[3][1] = 0.5 * turning * piece.quaternion[0][0];
        CHECK_STATUS(imk_drift_validate(&model, &s, NULL), k == 0 ? IMK_OK : IMK_ERROR_CONFLICT);
    }
}

/* Times that were told, and after which the analysis is to end. */
typedef struct watch {
    double last, end;
    size_t calls;
} watch;

static bool look(void *context, double time)
{
    watch *w = context;
    assert_true(time > w->last);
    w->last = time;
    w->calls++;
    return time < w->end;
}

/* With an aid an hour has many blocks; the last is told with the last time. */
static void progress_is_told_and_ends_the_analysis(void **state)
{
    (void)state;
    const double times[] = {600, 3600};
    imk_model model;
    imk_drift_settings s = imk_drift_default();
    imk_aid aid = imk_aid_default(IMK_AID_HEIGHT);
    watch all = {.end = HUGE_VAL}, part = {.end = 1000};
    imk_device_model(imk_device_find("tactical"), &model);
    s.rate = 10;
    s.time = times;
    s.time_count = 2;
    s.aid = &aid;
    s.aid_count = 1;
    s.progress = look;
    s.progress_context = &all;
    free(analyse_on(wgs84, &model, &s, NULL));
    assert_true(all.last == times[1] && all.calls > 100);
    s.progress_context = &part;
    const size_t size = imk_drift_covariance_size(&model, &s);
    void *memory = aligned_alloc(64, size);
    imk_drift_analysis *analysis = NULL;
    CHECK_STATUS(imk_drift_covariance(&model, &s, NULL, &analysis, memory, size, NULL),
                 IMK_ERROR_CANCELLED);
    assert_null(analysis);
    assert_true(part.last >= 1000 && part.last < 1100);
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grades_have_the_known_figures),
        cmocka_unit_test(single_sources_have_the_known_figures),
        cmocka_unit_test(schuler_and_the_vertical),
        cmocka_unit_test(periods_of_schuler_and_foucault),
        cmocka_unit_test(noise_agrees_with_impulse_responses),
        cmocka_unit_test(sources_add_up_to_one_joint_covariance),
        cmocka_unit_test(presets_meet_their_claims),
        cmocka_unit_test(drivers_have_their_limits),
        cmocka_unit_test(quantization_stays_what_is_carried),
        cmocka_unit_test(self_alignment_in_closed_form),
        cmocka_unit_test(self_alignment_at_a_wrong_place),
        cmocka_unit_test(sources_add_up_on_any_threads),
        cmocka_unit_test(names_are_those_of_the_model),
        cmocka_unit_test(sources_scale_by_their_names),
        cmocka_unit_test(compensation_turns_values_into_sigmas),
        cmocka_unit_test(poles_and_perfection),
        cmocka_unit_test(alignment_needs_a_rest),
        cmocka_unit_test(what_is_not_valid_is_refused),
        cmocka_unit_test(progress_is_told_and_ends_the_analysis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
