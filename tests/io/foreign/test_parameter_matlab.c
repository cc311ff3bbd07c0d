/* SPDX-License-Identifier: Apache-2.0 */
/* MATLAB's imuSensor: the filter of bias instability has the Allan deviation that it is said to
 * have; magnetometers in uT; what the options change. */
#include "check.h"
#include "io/foreign/matlab_flicker_internal.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.141592653589793;

static imk_model model, back;
static imk_parameter_notes notes;
static char *text;

static bool has_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return true;
    return false;
}

static void convert(double rate, imk_density density)
{
    imk_error error;
    size_t size;
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = IMK_PARAMETERS_MATLAB;
    settings.rate = rate;
    settings.density = density;
    free(text);
    CHECK_OK(imk_parameters_print(NULL, &settings, &model, &text, &size, &notes, &error));
    CHECK_OK(imk_parameters_parse(text, size, &settings, &back, NULL, &error));
}

/* |numerator/denominator|^2 of the coefficients as they are written, f in cycles per sample. Near 0
 * the denominator is 1e-13 of its terms, so it takes more digits than doubles have. */
static double filter_spectrum(double f)
{
    const long double angle = 2 * (long double)pi * (long double)f;
    long double complex above = 0, below = 0;
    for (int k = 0; k <= IMKI_MATLAB_STAGES; k++) {
        const long double complex turn = cosl(angle * k) - sinl(angle * k) * I;
        above += k < IMKI_MATLAB_STAGES ? imki_matlab_flicker.numerator[k] * turn : 0;
        below += imki_matlab_flicker.denominator[k] * turn;
    }
    const long double gain = cabsl(above) / cabsl(below);
    return (double)(gain * gain);
}

/* Allan variance at n samples by the spectrum, which the filter's coefficients alone determine:
 *
 *     (2/n^2) integral over |f| < 1/2 of S(f) sin^4(pi n f)/sin^2(pi f)
 *
 * by midpoints, close enough for each turn of sin(pi n f) and for each decade below. */
static double variance_by_spectrum(double n)
{
    double sum = 0;
    const double first = 1e-9, ratio = 1.01, finest = 0.02 / n;
    for (double f = first; f < 0.5 - 1e-12;) {
        const double step = fmin(fmin(f * (ratio - 1), finest), 0.5 - f);
        const double middle = f + 0.5 * step, sine = sin(pi * n * middle);
        sum += filter_spectrum(middle) * sine * sine * sine * sine /
               (sin(pi * middle) * sin(pi * middle)) * step;
        f += step;
    }
    return 4 * sum / (n * n);
}

/* The stages and the coefficients are the same noise. 0.3 %: the midpoints, and the coefficients'
 * rounding at the lowest frequencies. */
static void test_coefficients(void **state)
{
    (void)state;
    const double samples[] = {1, 2, 3, 10, 47, 300};
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++)
        CHECK_RELATIVE(variance_by_spectrum(samples[i]),
                       imki_matlab_flicker_allan_variance(samples[i]), 3e-3);
    /* 1/(2 pi f) from far below the farthest time on, but for the ripple of the stages. */
    for (double f = 2e-6; f < 0.02; f *= 1.05)
        CHECK_RELATIVE(filter_spectrum(f), 1 / (2 * pi * f), 0.25);
    /* At 0 Hz a stage has v (1 + p)/(1 - p), about 2 v T: 0.952 x 2e5, 0.892 x 12447, 0.864 x 774,
     * 0.898 x 48, 0.879 x 3.1 */
    CHECK_RELATIVE(filter_spectrum(1e-9), 202212, 0.005);
}

/* At every number of samples up to the farthest. */
static void test_bound(void **state)
{
    (void)state;
    const double ideal = imk_flicker_allan_variance(1, 1);
    double worst = 0;
    for (double n = 1; n <= IMKI_MATLAB_FARTHEST; n = n < 2000 ? n + 1 : n + 25)
        worst = fmax(worst, fabs(sqrt(imki_matlab_flicker_allan_variance(n) / ideal) - 1));
    assert_true(worst > 0.02 && worst < 0.029);
    /* Against the model's noise at three rates, and where that ends early. */
    const double endless = 0;
    CHECK_CLOSE(imki_matlab_flicker_range((imk_flicker){1, endless}, 0.01), IMKI_MATLAB_FARTHEST,
                0);
    CHECK_CLOSE(imki_matlab_flicker_range((imk_flicker){1, endless}, 1e-4), IMKI_MATLAB_FARTHEST,
                0);
    const double to = imki_matlab_flicker_range((imk_flicker){1, 10}, 0.01);
    assert_true(to > 100 && to < 500); /* it falls by 1 % at a tenth of T, by 11 % at T */
    const imk_flicker short_one = {1, 10};
    for (double n = 2; n <= to; n++)
        CHECK_RELATIVE(sqrt(imki_matlab_flicker_allan_variance(n)),
                       sqrt(imk_flicker_sampled_allan_variance(short_one, 0.01, (size_t)n)),
                       IMKI_MATLAB_ERROR);
    CHECK_CLOSE(imki_matlab_flicker_range((imk_flicker){1, 1e-3}, 0.01), 1, 0);
}

static void fill_model(void)
{
    imk_model_default(&model);
    model.gyro.present = model.accel.present = model.mag.present = true;
    for (int axis = 0; axis < 3; axis++) {
        model.gyro.noise.white.value[axis] = 1e-4;
        model.gyro.noise.bias_instability.value[axis] = 1e-5;
        model.accel.noise.random_walk.value[axis] = 1e-5;
        model.mag.bias.fixed.value[axis] = 1e-6 * (axis + 1);
        model.mag.scale_factor.fixed.value[axis] = 0.01 * axis;
        model.mag.noise.white.value[axis] = 2e-7;
        model.mag.range.value[axis] = 4.9e-3;
        model.mag.resolution.value[axis] = 1.5e-7;
    }
}

static void test_magnetometer(void **state)
{
    (void)state;
    fill_model();
    convert(100, IMK_DENSITY_UNSTATED);
    assert_non_null(strstr(text, "\"Magnetometer\": {\n      \"MeasurementRange\": 4900,\n"));
    assert_non_null(strstr(text, "\"ConstantBias\": [1, 2, 3]"));
    assert_true(back.mag.present);
    for (int axis = 0; axis < 3; axis++) {
        CHECK_RELATIVE(back.mag.bias.fixed.value[axis], model.mag.bias.fixed.value[axis], 1e-14);
        CHECK_RELATIVE(back.mag.noise.white.value[axis], 2e-7, 1e-14);
        CHECK_RELATIVE(back.mag.range.value[axis], 4.9e-3, 1e-14);
        CHECK_RELATIVE(back.mag.resolution.value[axis], 1.5e-7, 1e-14);
        CHECK_CLOSE(back.mag.scale_factor.fixed.value[axis], 0.01 * axis, 1e-14);
    }
    assert_false(has_note(true, "mag"));
}

static void test_options(void **state)
{
    (void)state;
    fill_model();
    convert(100, IMK_DENSITY_UNSTATED);
    assert_non_null(strstr(text, "\"BiasInstabilityFilter\": {\n      \"SampleRate\": 100,\n"));
    assert_null(strstr(text, "NoiseType")); /* which loadparams() refuses */
    assert_null(strstr(text, "Coefficients"));
    assert_true(has_note(false, "within 3.5 % of the model's from 0.01 s to 500 s"));
    CHECK_RELATIVE(back.gyro.noise.white.value[0], 1e-4, 1e-14);
    CHECK_RELATIVE(back.accel.noise.random_walk.value[0], 1e-5, 1e-14);
    convert(100, IMK_DENSITY_TWO_SIDED);
    assert_true(has_note(false, "single-sided: set it in MATLAB"));
    CHECK_RELATIVE(back.gyro.noise.white.value[0], 1e-4, 1e-14);
    convert(0, IMK_DENSITY_UNSTATED);
    assert_null(strstr(text, "BiasInstabilityFilter"));
    assert_true(has_note(false, "add --rate RATE"));
    model.gyro.noise.bias_instability_correlation_time.value = 0.1;
    convert(100, IMK_DENSITY_UNSTATED);
    assert_null(strstr(text, "BiasInstabilityFilter"));
    assert_true(has_note(true, "bias_instability_correlation_time is so short"));
    memset(&model.gyro.noise.bias_instability, 0, sizeof model.gyro.noise.bias_instability);
    model.gyro.noise.bias_instability_correlation_time.value = 0;
    convert(100, IMK_DENSITY_UNSTATED);
    assert_null(strstr(text, "BiasInstabilityFilter"));
    assert_false(has_note(false, "BiasInstability"));
    free(text);
    text = NULL;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coefficients), cmocka_unit_test(test_bound),
        cmocka_unit_test(test_magnetometer), cmocka_unit_test(test_options)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
