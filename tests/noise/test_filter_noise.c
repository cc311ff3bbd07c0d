/* SPDX-License-Identifier: Apache-2.0 */
/* Bias states of a Kalman filter: matrices against quadrature, the semigroup property and limits;
 * approximations of bias instability against the Allan deviation they have to keep. */
#include "check.h"

#include "imukit/filter_noise.h"
#include "imukit/noise.h"

#include <string.h>

static const double LN2 = 0.6931471805599453;

static imk_filter_noise filter_of(const imk_model *model, imk_filter_flicker flicker)
{
    imk_filter_noise_settings settings = imk_filter_noise_default();
    imk_filter_noise noise;
    settings.flicker = flicker;
    CHECK_OK(imk_filter_noise_of(&model->gyro, 0, &settings, &noise, NULL));
    return noise;
}

/* White noise, a random walk and two Gauss-Markov terms. */
static imk_model several_terms(void)
{
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.white.value[0] = 1e-4;
    model.gyro.noise.random_walk.value[0] = 2e-6;
    model.gyro.noise.gauss_markov_count = 2;
    model.gyro.noise.gauss_markov[0].sigma.value[0] = 3e-5;
    model.gyro.noise.gauss_markov[0].correlation_time.value[0] = 0.7;
    model.gyro.noise.gauss_markov[1].sigma.value[0] = 2e-5;
    model.gyro.noise.gauss_markov[1].correlation_time.value[0] = 400;
    return model;
}

static void test_continuous(void **state)
{
    (void)state;
    const imk_model model = several_terms();
    const imk_filter_noise noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    double f[16], q[16];
    assert_int_equal(noise.state_count, 3);
    assert_int_equal(noise.lost, 0);
    imk_filter_continuous(&noise, f, q);
    CHECK_RELATIVE(q[0], 1e-8, 1e-15);
    CHECK_RELATIVE(q[5], 2 * 9e-10 / 0.7, 1e-15);
    CHECK_RELATIVE(q[10], 2 * 4e-10 / 400, 1e-15);
    CHECK_RELATIVE(q[15], 4e-12, 1e-15);
    CHECK_RELATIVE(f[5], -1 / 0.7, 1e-15);
    CHECK_CLOSE(f[15], 0, 0);
    CHECK_CLOSE(f[3], 1, 0);
    CHECK_CLOSE(f[12], 0, 0);
}

/* Q_d = integral of Phi(s) Q_c Phi(s)^T, s = 0 … dt, by Simpson's rule in 2000 steps: its error is
 * about (dt/2000/T)^4/30 of the value: 5e-12 for dt = 5 and T = 0.7. */
static void test_quadrature(void **state)
{
    (void)state;
    enum { STEPS = 2000, N = 4 };
    const imk_model model = several_terms();
    const imk_filter_noise noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    static const double spans[] = {0.005, 0.5, 1.5, 5};
    for (size_t k = 0; k < 4; k++) {
        double q_c[N * N], phi[N * N], q_d[N * N], sum[N * N] = {0};
        imk_filter_continuous(&noise, NULL, q_c);
        for (int step = 0; step <= STEPS; step++) {
            const double weight = step == 0 || step == STEPS ? 1 : step % 2 == 1 ? 4 : 2;
            imk_filter_discrete(&noise, spans[k] * fmax(step, 1e-30) / STEPS, phi, NULL);
            for (size_t i = 0; i < N; i++)
                for (size_t j = 0; j < N; j++)
                    for (size_t m = 0; m < N; m++)
                        sum[i * N + j] += weight * spans[k] / STEPS / 3 * phi[i * N + m] *
                                          q_c[m * N + m] * phi[j * N + m];
        }
        imk_filter_discrete(&noise, spans[k], NULL, q_d);
        for (size_t i = 0; i < N * N; i++)
            CHECK_CLOSE(q_d[i], sum[i], 5e-11 * fabs(sum[i]));
    }
}

/* Two steps of dt are one of 2 dt: Phi Phi, and Phi Q Phi^T + Q. Relative to the diagonal. */
static void test_semigroup(void **state)
{
    (void)state;
    enum { N = 4 };
    const imk_model model = several_terms();
    const imk_filter_noise noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    for (double dt = 1e-4; dt < 1e4; dt *= 3.7) {
        double phi[N * N], q[N * N], phi2[N * N], q2[N * N];
        imk_filter_discrete(&noise, dt, phi, q);
        imk_filter_discrete(&noise, 2 * dt, phi2, q2);
        for (size_t i = 0; i < N; i++)
            for (size_t j = 0; j < N; j++) {
                double product = 0, covariance = q[i * N + j];
                for (size_t m = 0; m < N; m++) {
                    product += phi[i * N + m] * phi[m * N + j];
                    for (size_t l = 0; l < N; l++)
                        covariance += phi[i * N + m] * q[m * N + l] * phi[j * N + l];
                }
                CHECK_CLOSE(phi2[i * N + j], product, 1e-14 * fabs(product));
                CHECK_CLOSE(q2[i * N + j], covariance, 1e-14 * sqrt(q2[i * N + i] * q2[j * N + j]));
            }
    }
}

/* The series against its closed form where they meet, and the first terms where a is tiny:
 * 1/3 - a/4 + 7 a^2/60. */
static void test_limits(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.gauss_markov_count = 1;
    model.gyro.noise.gauss_markov[0].sigma.value[0] = 1;
    model.gyro.noise.gauss_markov[0].correlation_time.value[0] = 1;
    const imk_filter_noise noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    double phi[4], q[4], below[4];
    imk_filter_discrete(&noise, 1e-5, phi, q);
    CHECK_RELATIVE(q[0], 2 * 1e-15 * (1.0 / 3 - 1e-5 / 4 + 7e-10 / 60), 1e-14);
    CHECK_RELATIVE(q[1], 2 * 1e-10 * 0.5 * (1 - 1e-5 + 7e-10 / 12), 1e-14);
    CHECK_RELATIVE(q[3], 2 * 1e-5 * (1 - 1e-5 + 2e-10 / 3), 1e-14);
    imk_filter_discrete(&noise, 1, phi, q);
    imk_filter_discrete(&noise, 1 - 1e-9, phi, below);
    /* d ln Q_00/d ln dt is below 3: 3e-9. */
    CHECK_RELATIVE(below[0], q[0], 3e-9);
    CHECK_RELATIVE(q[0], 2 * (1 - 2 * (1 - exp(-1.0)) + (1 - exp(-2.0)) / 2), 1e-13);
    CHECK_RELATIVE(phi[0], 1, 0);
}

/* K^2 tau/3 = (2 ln 2/pi) B^2 at the middle of the range, 31.6 s; with K in the model both add up
 * in one state. */
static void test_flicker_as_walk(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.bias_instability.value[0] = 4e-5;
    imk_filter_noise noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    const double tau = sqrt(1000.0), k = sqrt(6 * LN2 / 3.141592653589793 / tau) * 4e-5;
    assert_int_equal(noise.state_count, 1);
    assert_int_equal(noise.state[0].source, IMK_FILTER_FROM_BIAS_INSTABILITY);
    CHECK_RELATIVE(noise.state[0].driving, k, 1e-14);
    CHECK_RELATIVE(imk_filter_noise_allan_variance(&noise, tau),
                   imk_flicker_allan_variance(4e-5, tau), 1e-14);
    /* The walk grows as sqrt(tau): at the ends of three decades it is off by 10^(3/4). */
    CHECK_RELATIVE(noise.misfit, pow(10, 0.75) - 1, 1e-12);
    model.gyro.noise.random_walk.value[0] = 2e-6;
    noise = filter_of(&model, IMK_FILTER_FLICKER_RANDOM_WALK);
    assert_int_equal(noise.state_count, 1);
    assert_int_equal(noise.state[0].source, IMK_FILTER_FROM_RANDOM_WALK);
    CHECK_RELATIVE(noise.state[0].driving, sqrt(k * k + 4e-12), 1e-14);
    CHECK_RELATIVE(noise.state[0].flicker_walk, k, 1e-14);
}

/* The misfit that is stated is the largest over the range, and more states make it smaller: with
 * white noise in front, two processes stay within 10 %. */
static void test_flicker_as_markov(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.white.value[0] = 1e-4;
    model.gyro.noise.random_walk.value[0] = 1e-7;
    model.gyro.noise.bias_instability.value[0] = 4e-5;
    static const double limit[] = {10, 0.4, 0.1};
    double before = HUGE_VAL;
    for (int flicker = 0; flicker < 3; flicker++) {
        const imk_filter_noise noise = filter_of(&model, (imk_filter_flicker)flicker);
        double worst = 0;
        for (double tau = 1; tau < 1000.0001; tau *= pow(10, 0.02)) {
            const double truth = imk_white_allan_variance(1e-4, tau) +
                                 imk_flicker_allan_variance(4e-5, tau) +
                                 imk_random_walk_allan_variance(1e-7, tau);
            worst =
                fmax(worst, fabs(sqrt(imk_filter_noise_allan_variance(&noise, tau) / truth) - 1));
        }
        CHECK_RELATIVE(noise.misfit, worst, 0.02); /* its grid is coarser */
        CHECK_BELOW(noise.misfit, limit[flicker]);
        CHECK_BELOW(noise.misfit, before);
        before = noise.misfit;
        for (int i = 0; i < noise.state_count; i++)
            if (noise.state[i].sigma > 0)
                CHECK_RELATIVE(noise.state[i].driving,
                               noise.state[i].sigma * sqrt(2 / noise.state[i].correlation_time),
                               1e-14);
    }
    const imk_filter_noise none = filter_of(&model, IMK_FILTER_FLICKER_LEFT_OUT);
    assert_int_equal(none.state_count, 1);
    assert_int_equal(none.lost, IMK_FILTER_LOST_FLICKER);
}

static void test_rest(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_filter_noise_settings settings = imk_filter_noise_default();
    imk_filter_noise noise;
    imk_error error;
    model.gyro.bias.repeatability.value[0] = 1e-3;
    model.gyro.noise.quantization.value[0] = 5e-6;
    model.gyro.noise.reading_noise.value[0] = 7e-6;
    model.gyro.noise.angle_white.value[0] = 9e-6;
    model.gyro.noise.ramp.value[0] = 1e-9;
    model.gyro.bandwidth.value[0] = 50;
    CHECK_OK(imk_filter_noise_of(&model.gyro, 0, &settings, &noise, &error));
    assert_int_equal(noise.state_count, 1);
    assert_int_equal(noise.state[0].source, IMK_FILTER_FROM_CONSTANT);
    CHECK_CLOSE(noise.state[0].initial, 1e-3, 0);
    CHECK_CLOSE(noise.quantization, 5e-6, 0);
    CHECK_CLOSE(noise.reading_noise, 7e-6, 0);
    CHECK_CLOSE(noise.angle_white, 9e-6, 0);
    assert_int_equal(noise.lost, IMK_FILTER_LOST_RAMP | IMK_FILTER_LOST_LOW_PASS);
    CHECK_STATUS(imk_filter_noise_of(&model.gyro, 3, &settings, &noise, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "axis");
    settings.to = 0.5;
    CHECK_STATUS(imk_filter_noise_of(&model.gyro, 0, &settings, &noise, &error), IMK_ERROR_RANGE);
    settings.to = 1e308;
    CHECK_STATUS(imk_filter_noise_of(&model.gyro, 0, &settings, &noise, &error), IMK_ERROR_RANGE);
    settings.from = 1e-320;
    settings.to = 1e3;
    CHECK_STATUS(imk_filter_noise_of(&model.gyro, 0, &settings, &noise, &error), IMK_ERROR_RANGE);
    memset(&settings, 0, sizeof settings);
    CHECK_STATUS(imk_filter_noise_of(&model.gyro, 0, &settings, &noise, &error),
                 IMK_ERROR_UNINITIALISED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_continuous),
                                       cmocka_unit_test(test_quadrature),
                                       cmocka_unit_test(test_semigroup),
                                       cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_flicker_as_walk),
                                       cmocka_unit_test(test_flicker_as_markov),
                                       cmocka_unit_test(test_rest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
