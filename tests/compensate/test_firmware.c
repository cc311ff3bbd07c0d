/* SPDX-License-Identifier: Apache-2.0 */
/* Plans for devices: the bound holds, and is no larger than it must be; the flags are those of the
 * compensator; what cannot be planned is refused. Expected values are imk_correct()'s. */
#include "firmware_models.h"

#include "check.h"

enum { MODELS = 260, SAMPLES = 50 };

static imk_firmware plan, other;
static imk_correction exact;
static imk_compensator compensator;

static void make_plan(const imk_model *model, imk_firmware_arithmetic arithmetic)
{
    imk_firmware_settings settings = imk_firmware_default();
    imk_error error;
    settings.arithmetic = arithmetic;
    CHECK_OK(imk_firmware_plan(&plan, model, &settings, &error));
    CHECK_OK(imk_correction_start(&exact, &plan.model, NULL, &error));
}

/* The largest error of an unflagged sample, in bounds. @return samples without a flag */
static int run_sample(uint64_t *state, double part, double *worst)
{
    imk_firmware_sample sample;
    double out[2][IMK_AXES_MAX];
    draw_sample(state, &plan, part, &sample);
    imk_firmware_run(&plan, &sample);
    if (sample.flags & ~(unsigned)IMK_FLAG_TEMPERATURE)
        return 0;
    correct_sample(&exact, &sample, out);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < plan.output_count[sensor]; j++)
            *worst =
                fmax(*worst, fabs(sample.out[sensor][j] - out[sensor][j]) / plan.bound[sensor]);
    return 1;
}

/* 13 000 samples of 260 models for each arithmetic: none beyond its bound. A bound ten times larger
 * than what happens would be of little use: the worst is above a tenth of it in single precision
 * and fixed point. In double the bound is mostly that of imk_correct(), 1e-14 of the limit. */
static void check_bounds(imk_firmware_arithmetic arithmetic, double least, double relative)
{
    uint64_t state = 1 + (uint64_t)arithmetic;
    double worst = 0;
    int held = 0;
    for (int m = 0; m < MODELS; m++) {
        const imk_model model = practical_model(&state, m % 2 == 0);
        make_plan(&model, arithmetic);
        for (int sensor = 0; sensor < 2; sensor++)
            if (plan.output_count[sensor] > 0)
                CHECK_BELOW(plan.bound[sensor], relative * plan.correction.limit[sensor][0]);
        for (int k = 0; k < SAMPLES; k++)
            held += run_sample(&state, 0.85 * random_unit(&state), &worst);
    }
    CHECK_BELOW(worst, 1.0);
    CHECK_BELOW(least, worst);
    assert_true(held >= 10000);
}

/* Relative to the limit: some tens of roundings of 6e-8, 1e-16 and 5e-10 (2^-31). */
static void test_bound_float(void **state)
{
    (void)state;
    check_bounds(IMK_FIRMWARE_FLOAT, 0.1, 5e-6);
}

static void test_bound_double(void **state)
{
    (void)state;
    check_bounds(IMK_FIRMWARE_DOUBLE, 0.005, 5e-14);
}

static void test_bound_fixed(void **state)
{
    (void)state;
    check_bounds(IMK_FIRMWARE_FIXED, 0.1, 3e-7);
}

/* Six axes, third order, g-sensitivity: 46 products and one more for the temperature. 18 Horner
 * steps, 18 weights of the rates, 9 of the forces, 1 for t. */
static imk_model third_order(void)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_temperature_polynomial *p = &triads[sensor]->bias.temperature;
        p->order = 3;
        p->reference = 298.15;
        p->minimum = 233.15;
        p->maximum = 358.15;
        for (int i = 0; i < 3; i++) {
            triads[sensor]->range.value[i] = sensor == IMK_GYRO ? 10 : 100;
            triads[sensor]->bias.fixed.value[i] = 0.1 * (i + 1);
            for (int k = 0; k < 3; k++) {
                triads[sensor]->misalignment.value[i][k] = i == k ? 0 : 1e-3 * (i + 2 * k);
                model.gyro.g_sensitivity.value[i][k] = 1e-4 * (i + k + 1);
                p->coefficient[k].value[i] = 1e-3 / (1 + 49 * k) * (i + 1 + 3 * sensor);
            }
        }
    }
    return model;
}

/* A coefficient that is off by one part in 2^15 is seen. */
static void test_bound_can_fail(void **state)
{
    (void)state;
    uint64_t random = 5;
    double worst = 0;
    const imk_model model = third_order();
    make_plan(&model, IMK_FIRMWARE_FLOAT);
    const imk_firmware_operation *output = &plan.operation[plan.output[IMK_ACCEL][0]];
    assert_int_equal(output->kind, IMK_FIRMWARE_SUM);
    plan.term[output->first].coefficient *= 1 + 0x1p-15;
    for (int k = 0; k < 200; k++)
        run_sample(&random, 0.8, &worst);
    CHECK_BELOW(1.0, worst);
}

static void test_cost(void **state)
{
    (void)state;
    const imk_model model = third_order();
    make_plan(&model, IMK_FIRMWARE_FLOAT);
    assert_int_equal(plan.cost.multiplications, 18 + 18 + 9 + 1);
    /* Of Horner's rule 18, t 1, readings less bias 6, weights 15 + 6. */
    assert_int_equal(plan.cost.additions, 18 + 1 + 6 + 15 + 6);
    assert_int_equal(plan.iterations, 1);
    /* Each reading with its range, the temperature with its own, which is clipped too. */
    assert_int_equal(plan.cost.comparisons, 6 * 2 + 2 + 2);
    /* A perfect unit costs nothing but looking at its readings. */
    imk_model perfect;
    imk_model_default(&perfect);
    make_plan(&perfect, IMK_FIRMWARE_FLOAT);
    assert_int_equal(plan.cost.multiplications + plan.cost.additions, 0);
    assert_int_equal(plan.cost.comparisons, 6 * 2);
}

/* A linear model without a range is flagged beyond the motion that its bound holds for, which is
 * the usual unit's or the one stated: in every sample without a flag the bound holds. */
static void test_no_range(void **state)
{
    (void)state;
    uint64_t random = 11;
    double worst = 0;
    int held = 0;
    imk_model model = third_order();
    for (int i = 0; i < 3; i++)
        model.gyro.range.value[i] = model.accel.range.value[i] = 0;
    for (int stated = 0; stated < 2; stated++) {
        imk_error error;
        imk_firmware_settings settings = imk_firmware_default();
        settings.rate_limit = stated ? 20 : 0;
        CHECK_OK(imk_firmware_plan(&plan, &model, &settings, &error));
        CHECK_OK(imk_correction_start(&exact, &plan.model, NULL, &error));
        CHECK_CLOSE(plan.limit[IMK_GYRO][0], stated ? 20 : 35, 1e-6);
        assert_int_equal(plan.limit_stated[IMK_GYRO], stated);
        for (int k = 0; k < 1000; k++) {
            imk_firmware_sample sample;
            draw_sample(&random, &plan, 3, &sample);
            imk_firmware_run(&plan, &sample);
            held += run_sample(&random, 3 * random_unit(&random), &worst);
            for (int i = 0; i < 3; i++)
                if (fabs(sample.reading[IMK_GYRO][i]) > 1.5 * plan.limit[IMK_GYRO][i])
                    assert_true(sample.flags & IMK_FLAG_LIMIT);
        }
    }
    CHECK_BELOW(worst, 1.0);
    assert_in_range(held, 200, 1800);
}

/* Flags are those of the compensator, in every arithmetic, at the edges too: readings at the range,
 * temperatures near the ends of the valid one (at the very end kelvins are rounded). */
static void check_flags(imk_firmware_arithmetic arithmetic, bool counts)
{
    imk_model model = third_order();
    imk_error error;
    for (int i = 0; i < 3; i++) {
        model.gyro.sensitivity.value[i] = counts ? 3276.8 : 0;
        model.gyro.zero_offset.value[i] = counts ? 512 : 0;
    }
    make_plan(&model, arithmetic);
    CHECK_OK(imk_compensator_start(&compensator, &model, 0.01, NULL, &error));
    static const double parts[] = {0, 0.5, 0.999, 0.9999999, 1, 1.001, -0.999, -1, -1.5};
    static const double temperatures[] = {20, -39.99, -40.01, 84.99, 85.01, 95};
    int flagged = 0;
    for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++)
        for (size_t t = 0; t < sizeof temperatures / sizeof temperatures[0]; t++) {
            imk_firmware_sample sample = {.temperature = temperatures[t]};
            imk_compensator_sample reference;
            const double range = counts ? 32768 : 10;
            sample.reading[IMK_GYRO][1] = range * parts[p] + (counts ? 512 : 0);
            sample.reading[IMK_GYRO][0] = sample.reading[IMK_GYRO][2] = counts ? 512 : 0;
            imk_firmware_round(&plan, &sample);
            memset(&reference, 0, sizeof reference);
            memcpy(reference.reading, sample.reading, sizeof reference.reading);
            reference.temperature = sample.temperature + 273.15;
            imk_firmware_run(&plan, &sample);
            imk_compensator_next(&compensator, &reference);
            assert_int_equal(sample.flags, reference.flags);
            flagged += sample.flags != 0;
        }
    assert_true(flagged > 20);
}

static void test_flags(void **state)
{
    (void)state;
    for (int arithmetic = 0; arithmetic < 3; arithmetic++) {
        check_flags((imk_firmware_arithmetic)arithmetic, true);
        check_flags((imk_firmware_arithmetic)arithmetic, false);
    }
}

/* NaN and infinity are flagged, spoil what depends on them and nothing else; a temperature that is
 * not known spoils everything that depends on it. */
static void test_not_finite(void **state)
{
    (void)state;
    const imk_model model = third_order();
    make_plan(&model, IMK_FIRMWARE_FLOAT);
    imk_firmware_sample sample = {.temperature = 20};
    sample.reading[IMK_GYRO][2] = (double)NAN;
    imk_firmware_run(&plan, &sample);
    assert_int_equal(sample.flags, IMK_FLAG_NOT_FINITE);
    assert_true(isnan(sample.out[IMK_GYRO][0]) && isfinite(sample.out[IMK_ACCEL][0]));
    sample.reading[IMK_GYRO][2] = (double)INFINITY;
    imk_firmware_run(&plan, &sample);
    assert_int_equal(sample.flags, IMK_FLAG_NOT_FINITE);
    sample.reading[IMK_GYRO][2] = 0;
    sample.temperature = (double)NAN;
    imk_firmware_run(&plan, &sample);
    assert_int_equal(sample.flags, IMK_FLAG_NOT_FINITE);
    assert_true(isnan(sample.out[IMK_GYRO][1]) && isnan(sample.out[IMK_ACCEL][1]));
}

/* Readings far beyond the range do not overflow in fixed point: the end value, flagged. */
static void test_far_readings(void **state)
{
    (void)state;
    imk_model model = third_order();
    for (int i = 0; i < 3; i++)
        model.gyro.sensitivity.value[i] = 3276.8;
    make_plan(&model, IMK_FIRMWARE_FIXED);
    for (int sign = -1; sign <= 1; sign += 2) {
        imk_firmware_sample sample = {.temperature = 20};
        sample.reading[IMK_GYRO][0] = sign * 2147483000.0;
        imk_firmware_round(&plan, &sample);
        imk_firmware_run(&plan, &sample);
        assert_int_equal(sample.flags, IMK_FLAG_SATURATED);
        /* 10 rad/s less the bias and what misalignment does. */
        CHECK_CLOSE(sample.out[IMK_GYRO][0], sign * 10, 0.3);
    }
}

/* What needs time is left out of the plan, and does not change it. */
static void test_left_out(void **state)
{
    (void)state;
    imk_model model = third_order();
    make_plan(&model, IMK_FIRMWARE_FLOAT);
    other = plan;
    model.accel.lever_arm.value[1][0] = 0.01;
    model.gyro.bias.warm_up_amplitude.value[0] = 0.01;
    model.gyro.bias.warm_up_time.value = 100;
    model.accel.bias.temperature_rate.value[2] = 0.1;
    model.gyro.bias.hysteresis.value[0] = 0.01;
    model.gyro.noise.white.value[0] = 0.01;
    make_plan(&model, IMK_FIRMWARE_FLOAT);
    assert_int_equal(plan.operation_count, other.operation_count);
    assert_memory_equal(plan.operation, other.operation, sizeof plan.operation);
    assert_memory_equal(plan.term, other.term, sizeof plan.term);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_firmware_settings settings = {.cookie = 0};
    imk_error error;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, &settings, &error), IMK_ERROR_UNINITIALISED);
    settings = imk_firmware_default();
    settings.arithmetic = (imk_firmware_arithmetic)3;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, &settings, &error), IMK_ERROR_ARGUMENT);
    settings = imk_firmware_default();
    settings.tolerance = (double)NAN;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, &settings, &error), IMK_ERROR_RANGE);
    /* Fixed point needs to know how large numbers are: from the model, or from the settings. */
    settings = imk_firmware_default();
    settings.arithmetic = IMK_FIRMWARE_FIXED;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, &settings, &error), IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.field, "gyro.range");
    settings.rate_limit = 10;
    settings.force_limit = 100;
    CHECK_OK(imk_firmware_plan(&plan, &model, &settings, &error));
    /* Terms that are not linear need a range; the error is that of the correction. */
    model.gyro.nonlinearity.k2.value[0] = 1e-3;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, NULL, &error), IMK_ERROR_KEY_MISSING);
    model.gyro.nonlinearity.k2.value[0] = (double)NAN;
    CHECK_STATUS(imk_firmware_plan(&plan, &model, NULL, &error), IMK_ERROR_NOT_FINITE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bound_float),  cmocka_unit_test(test_bound_double),
        cmocka_unit_test(test_bound_fixed),  cmocka_unit_test(test_bound_can_fail),
        cmocka_unit_test(test_cost),         cmocka_unit_test(test_no_range),
        cmocka_unit_test(test_flags),        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_far_readings), cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
