/* SPDX-License-Identifier: Apache-2.0 */
/* From the state a device kept to a noise model: streaming Allan variances, with the strides they
 * have, through the generalised least squares of allan_fit.h. */
#include "check.h"

#include "imukit/allan_fit.h"
#include "imukit/allan_stream.h"
#include "imukit/distributions.h"

#include <stdlib.h>

enum { SAMPLES = 1 << 18, BLOCK = 1 << 12 };
static const double DT = 0.01, WHITE = 0.01, FLICKER = 0.004, GRAVITY = 9.80665;

/* White noise and flicker on gravity, a block at a time, as a driver would hand them over. */
static void run_device(uint64_t run, imk_allan_stream *stream)
{
    const imk_random random = imk_random_seeded(run);
    double block[BLOCK];
    imk_white_state white;
    imk_flicker_state flicker;
    CHECK_OK(imk_white_start(&white, WHITE, DT, random, 1));
    CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){FLICKER, 0}, DT, random, 1000));
    imk_allan_stream_start(stream, 0);
    for (size_t i = 0; i < SAMPLES; i += BLOCK) {
        for (size_t k = 0; k < BLOCK; k++)
            block[k] = GRAVITY;
        imk_white_add(&white, BLOCK, block);
        imk_flicker_add(&flicker, BLOCK, block);
        imk_allan_stream_add(stream, BLOCK, block);
    }
}

static void fit_stream(const imk_allan_stream *stream, imk_allan_fit *fit)
{
    imk_allan_stream_point points[IMK_ALLAN_STREAM_FACTORS];
    const size_t count = imk_allan_stream_points(stream, points), length = SAMPLES;
    size_t factors[IMK_ALLAN_STREAM_FACTORS], strides[IMK_ALLAN_STREAM_FACTORS];
    double variances[IMK_ALLAN_STREAM_FACTORS];
    for (size_t i = 0; i < count; i++) {
        factors[i] = points[i].m;
        strides[i] = points[i].stride;
        variances[i] = points[i].variance;
    }
    const imk_allan_table table = {DT, count, factors, variances, strides, 1, &length};
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.keep[IMK_NOISE_WHITE] = settings.keep[IMK_NOISE_BIAS_INSTABILITY] = true;
    const size_t size = imk_allan_fit_workspace_size(&settings, count, 0);
    void *workspace = malloc(size);
    CHECK_OK(imk_allan_fit_table(&settings, &table, fit, workspace, size, NULL));
    free(workspace);
}

/* 95 % intervals, binomial limits that chance passes in less than 1e-6. Quantization called present
 * by chance, in 1 % of records, moves N by several sigmas. */
static void test_from_device_to_model(void **state)
{
    (void)state;
    const size_t runs = check_runs(24);
    static const double truth[2] = {WHITE, FLICKER};
    size_t outside[2] = {0, 0}, clean = 0;
    double square = 0;
    for (size_t run = 0; run < runs; run++) {
        static imk_allan_stream stream;
        imk_allan_fit fit;
        run_device(run, &stream);
        CHECK_CLOSE(imk_allan_stream_mean(&stream), GRAVITY, 0.05);
        fit_stream(&stream, &fit);
        if (fit.term[IMK_NOISE_QUANTIZATION].present)
            continue;
        clean++;
        for (int k = 0; k < 2; k++) {
            const imk_estimate *e = &fit.term[k ? IMK_NOISE_BIAS_INSTABILITY : IMK_NOISE_WHITE];
            outside[k] += !(e->lower <= truth[k] && truth[k] <= e->upper);
        }
        square +=
            pow((fit.term[IMK_NOISE_WHITE].value - WHITE) / fit.term[IMK_NOISE_WHITE].sigma, 2);
        /* Known to better than 1 and 20 %: a model, not a guess. */
        CHECK_RELATIVE(fit.term[IMK_NOISE_WHITE].value, WHITE, 0.02);
        CHECK_RELATIVE(fit.term[IMK_NOISE_BIAS_INSTABILITY].value, FLICKER, 0.5);
    }
    const double n = (double)clean;
    assert_true(clean + 4 >= runs); /* 5 of 24 at 1 % each: 4e-6 */
    for (int k = 0; k < 2; k++)
        CHECK_BELOW((double)outside[k], 0.05 * n + 5.5 * sqrt(0.05 * n) + 1);
    CHECK_BELOW(square, imk_chi_square_quantile(1 - 1e-6, n));
    CHECK_BELOW(imk_chi_square_quantile(1e-6, n), square);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_from_device_to_model)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
