/* SPDX-License-Identifier: Apache-2.0 */
/* Noise of the shell gyro: Brownian motion, pickoff noise and the run's slow error, against the
 * error model. Seeds are fixed; a right instrument passes with a probability above 1 - 1e-6 a
 * test. */
#include "shell_gyro_designs.h"

#include "imukit/distributions.h"

/* Equipartition: a^2 + q^2, which is twice the energy over m w^2, has the mean 4 kB T/(m w^2). The
 * shell forgets in tau = 3.2 ms; of 1e5 samples 10 ms apart the mean has the relative deviation
 * sqrt(1/2e5) = .22 %: a part in 1e6 is outside 1.1 %. */
static void test_equipartition(void **unused)
{
    (void)unused;
    enum { SAMPLES = 100000 };
    imk_shell_gyro design = perfect(IMK_SHELL_FREE);
    design.resonator.quality = 10.0;
    design.pattern.amplitude = 1e-15;
    design.anisotropy.damping_difference = 100.0; /* of 2/tau = 628: a bath of one temperature */
    design.anisotropy.damping_angle = 0.3;
    design.control.cycles = 1;
    imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 100.0);
    settings.noise = true;
    settings.seed = 7;
    const imk_exposure exposure = imk_exposure_default();
    void *state = started(shell, &design, &settings);
    double sum = 0.0;
    for (int i = 0; i < SAMPLES; i++) {
        run(shell, state, &exposure, 1, 0, NULL);
        const double a = signal_of(state, AMPLITUDE), q = signal_of(state, QUADRATURE);
        sum += a * a + q * q;
    }
    free(state);
    const double omega = 2.0 * pi * design.resonator.frequency;
    const double expected = 4.0 * 1.380649e-23 * 293.15 / (design.resonator.mass * omega * omega);
    CHECK_RELATIVE(sum / SAMPLES, expected, 0.011);
}

/* Angle random walk: the sum of squares of independent readings over N^2 rate is chi-square
 * distributed; outside 1e-7 on either side. */
static void check_random_walk(const imk_shell_gyro *design, imk_level level, double rate,
                              size_t count)
{
    imk_model model;
    imk_instrument_reduce(shell, design, &model);
    const double n = model.gyro.noise.white.value[0], bias = model.gyro.bias.fixed.value[0];
    CHECK_RELATIVE(n, imk_shell_gyro_thermal_random_walk(design, 293.15), 1e-12);
    CHECK_RELATIVE(n, 1e-3, 0.01);
    imk_physics_settings settings = quiet(level, rate);
    settings.noise = true;
    settings.seed = 11;
    const imk_exposure exposure = imk_exposure_default();
    double *samples = malloc(count * sizeof *samples), sum = 0.0;
    assert_non_null(samples);
    void *state = started(shell, design, &settings);
    run(shell, state, &exposure, 5, 0, NULL);
    run(shell, state, &exposure, count, 0, samples);
    for (size_t i = 0; i < count; i++)
        sum += (samples[i] - bias) * (samples[i] - bias);
    const double probability = imk_chi_square_probability(sum / (n * n * rate), (double)count);
    if (!(probability > 1e-7 && probability < 1.0 - 1e-7))
        fail_msg("level %d: N %g, expected %g", (int)level, sqrt(sum / ((double)count * rate)), n);
    free(state);
    free(samples);
}

static void test_angle_random_walk(void **unused)
{
    (void)unused;
    /* at two samples a second the loop (10 Hz) takes 1/(w_b h) = 3 % of the variance: at 0.2, .3 %
     */
    imk_shell_gyro design = light(IMK_SHELL_REBALANCE);
    check_random_walk(&design, IMK_LEVEL_FULL, 0.2, 400);
    check_random_walk(&design, IMK_LEVEL_SLOW, 0.2, 4000);
    design.mode = IMK_SHELL_WHOLE_ANGLE;
    check_random_walk(&design, IMK_LEVEL_FULL, 2.0, 3000);
    check_random_walk(&design, IMK_LEVEL_SLOW, 2.0, 30000);
    design.forcer.drive = IMK_SHELL_PARAMETRIC;
    check_random_walk(&design, IMK_LEVEL_FULL, 2.0, 3000);
}

/* Design -> full log -> identification: all terms, pickoff noise and instability included. */
static void test_chain(void **unused)
{
    (void)unused;
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure exposure = imk_exposure_default();
    imk_shell_gyro design = light(IMK_SHELL_REBALANCE);
    settings.rate = 1.0;
    settings.seed = 3;
    design.pickoff.noise = 3e-10;
    design.anisotropy.damping_instability = 3e-4;
    check_chain(shell, &design, &settings, &exposure, 20, 3000);
    design.mode = IMK_SHELL_WHOLE_ANGLE;
    check_chain(shell, &design, &settings, &exposure, 20, 3000);
    design = imk_shell_gyro_default();
    settings.level = IMK_LEVEL_SLOW;
    check_chain(shell, &design, &settings, &exposure, 20, 20000);
    design = hemispherical();
    check_chain(shell, &design, &settings, &exposure, 20, 20000);
    /* Brownian motion alone, whose interval is then +-5.5 %; the loop is fast against a sample */
    design = light(IMK_SHELL_REBALANCE);
    design.pickoff.noise = 0.0;
    design.anisotropy.damping_repeatability = design.anisotropy.damping_instability = 0.0;
    settings.rate = 0.2;
    check_chain(shell, &design, &settings, &exposure, 20, 4000);
}

/* A run's constant: a normal of the stated deviation from run to run. 60 runs: chi-square. */
static void test_repeatability(void **unused)
{
    (void)unused;
    enum { RUNS = 60 };
    imk_shell_gyro design = perfect(IMK_SHELL_REBALANCE);
    design.resonator.mass = 1.0; /* no Brownian motion to speak of */
    design.anisotropy.damping_repeatability = 0.01;
    imk_model model;
    imk_instrument_reduce(shell, &design, &model);
    const double sigma = model.gyro.bias.repeatability.value[0];
    CHECK_RELATIVE(sigma, 0.01 / (2.0 * 0.554), 1e-12);
    const imk_exposure exposure = imk_exposure_default();
    double sum[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < RUNS; i++) {
        double mean[2];
        for (int level = 0; level < 2; level++) {
            imk_physics_settings settings = quiet((imk_level)level, 10.0);
            settings.noise = true;
            settings.run = i;
            mean[level] = mean_of(shell, &design, &settings, &exposure, 4, 1, 0);
            sum[level] += mean[level] * mean[level];
        }
        CHECK_CLOSE(mean[0], mean[1], 2e-3 * sigma);
    }
    for (int level = 0; level < 2; level++) {
        const double p = imk_chi_square_probability(sum[level] / (sigma * sigma), RUNS);
        assert_true(p > 2e-7 && p < 1.0 - 2e-7);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equipartition),
        cmocka_unit_test(test_angle_random_walk),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_repeatability),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
