/* SPDX-License-Identifier: Apache-2.0 */
/* The compensator: distorted motions come back, streams and records give the same bits, flags. */
#include "check.h"

#include "imukit/compensate.h"

#include <stdlib.h>
#include <string.h>

enum { COUNT = 3000, AXES = 3 };
static const double dt = 0.01, pi = 3.14159265358979323846;

/* A smooth motion: rates and forces are sums of sines, the angular acceleration their derivative.
 * w_k(t) = a_k sin(2 pi f_k t), f_k in Hz. */
static const double rate_amplitude[3] = {2.0, 1.5, 3.0}, rate_frequency[3] = {0.7, 1.1, 0.45};

typedef struct record {
    double rate[3][COUNT], force[3][COUNT], acceleration[3][COUNT];
    double temperature[COUNT], temperature_rate[COUNT], warm_up[2][COUNT];
    double reading[2][IMK_AXES_MAX][COUNT];
    double corrected[2][IMK_AXES_MAX][COUNT];
    unsigned char flags[COUNT];
} record;

static void move(record *r)
{
    for (int k = 0; k < 3; k++) {
        const double w = 2 * pi * rate_frequency[k];
        for (int i = 0; i < COUNT; i++) {
            const double t = i * dt;
            r->rate[k][i] = rate_amplitude[k] * sin(w * t);
            r->acceleration[k][i] = rate_amplitude[k] * w * cos(w * t);
            r->force[k][i] = (k == 2 ? -9.8 : 0.5) + 3 * sin(2.1 * t + k);
        }
    }
}

/* A unit of many terms, all of them moderate. Temperatures in kelvin. */
static imk_model unit(void)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < AXES; i++) {
            triads[s]->bias.fixed.value[i] = s == 0 ? 0.01 * (i + 1) : 0.05 * (i - 1.5);
            triads[s]->scale_factor.fixed.value[i] = 0.003 * (i - 1) + 0.001;
            triads[s]->misalignment.value[i][(i + 1) % 3] = 0.002;
            triads[s]->misalignment.value[i][(i + 2) % 3] = -0.001;
            triads[s]->range.value[i] = s == 0 ? 20 : 100;
            triads[s]->nonlinearity.k2.value[i] = 1e-5;
        }
    for (int i = 0; i < AXES; i++)
        model.gyro.g_sensitivity.value[i][i] = 1e-4;
    return model;
}

static void add_temperature(imk_model *model, record *r)
{
    imk_temperature_polynomial polynomial = {
        .order = 2, .reference = 298.15, .minimum = 253.15, .maximum = 343.15};
    for (int i = 0; i < AXES; i++) {
        polynomial.coefficient[0].value[i] = 1e-4;
        polynomial.coefficient[1].value[i] = -2e-6;
    }
    model->gyro.bias.temperature = model->accel.bias.temperature = polynomial;
    model->accel.bias.warm_up_time.value = 10;
    for (int i = 0; i < AXES; i++)
        model->accel.bias.warm_up_amplitude.value[i] = 0.02;
    for (int i = 0; i < COUNT; i++) {
        r->temperature[i] = 290 + 0.5 * i * dt;
        r->temperature_rate[i] = 0.5;
        r->warm_up[IMK_GYRO][i] = 0;
        r->warm_up[IMK_ACCEL][i] = exp(-(i - 0.5) * dt / 10);
    }
}

static void add_lever_arms(imk_model *model)
{
    static const double place[3][3] = {{0.03, 0, 0}, {0, -0.05, 0.01}, {0.02, 0, 0.04}};
    memcpy(model->accel.lever_arm.value, place, sizeof place);
}

static void distort(const imk_model *model, record *r)
{
    imk_distortion distortion;
    imk_stimulus stimulus = {.temperature = r->temperature,
                             .temperature_rate = r->temperature_rate,
                             .warm_up = {r->warm_up[0], r->warm_up[1]}};
    for (int k = 0; k < 3; k++) {
        stimulus.angular_rate[k] = r->rate[k];
        stimulus.specific_force[k] = r->force[k];
        stimulus.angular_acceleration[k] = r->acceleration[k];
    }
    CHECK_OK(imk_distortion_start(&distortion, model, NULL, IMK_KERNEL_SCALAR, NULL));
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < distortion.axis_count[s]; i++)
            imk_distort(&distortion, s, i, &stimulus, COUNT, r->reading[s][i]);
}

static imk_readings readings_of(record *r)
{
    imk_readings readings = {.temperature = r->temperature};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            readings.channel[s][i] = r->reading[s][i];
    return readings;
}

static void outputs_of(record *r, double *out[2][IMK_AXES_MAX])
{
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            out[s][i] = r->corrected[s][i];
}

static void compensate(const imk_model *model, record *r)
{
    imk_compensator *c = malloc(sizeof *c);
    double *out[2][IMK_AXES_MAX], *workspace = malloc(imk_compensate_workspace_size(COUNT));
    CHECK_OK(imk_compensator_start(c, model, dt, NULL, NULL));
    imk_readings readings = readings_of(r);
    outputs_of(r, out);
    CHECK_OK(imk_compensate_record(c, &readings, COUNT, out, r->flags, workspace,
                                   imk_compensate_workspace_size(COUNT)));
    free(workspace);
    free(c);
}

static double worst(double (*actual)[COUNT], double (*truth)[COUNT], int from, int to)
{
    double largest = 0;
    for (int k = 0; k < 3; k++)
        for (int i = from; i < to; i++) {
            const double error = fabs(actual[k][i] - truth[k][i]);
            largest = error <= largest ? largest : error; /* NaN counts as the largest */
        }
    return largest;
}

static record *new_record(void)
{
    record *r = calloc(1, sizeof *r);
    assert_non_null(r);
    move(r);
    return r;
}

/* Without lever arms the inverse is exact up to the tolerance of the solution, 1e-14 of the limits
 * (22 rad/s, 110 m/s^2), and rounding: some units in the last place of 20 m/s^2 (4e-15). */
static void test_closed_loop(void **state)
{
    (void)state;
    record *r = new_record();
    imk_model model = unit();
    add_temperature(&model, r);
    distort(&model, r);
    assert_true(worst(r->reading[1], r->force, 0, COUNT) > 0.05); /* there is something to undo */
    compensate(&model, r);
    CHECK_BELOW(worst(r->corrected[0], r->rate, 0, COUNT), 1e-12);
    CHECK_BELOW(worst(r->corrected[1], r->force, 0, COUNT), 1e-11);
    for (int i = 0; i < COUNT; i++)
        assert_int_equal(r->flags[i], 0);
    free(r);
}

/* Largest |w'''| and |w''| of the three axes together: amplitude (2 pi f)^n each, root sum of
 * squares as the worst case. */
static double largest_derivative(int order)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += pow(rate_amplitude[k] * pow(2 * pi * rate_frequency[k], order), 2);
    return sqrt(square);
}

/* With lever arms the force errs by at most dt^2/6 |w'''| |r|, dt/2 |w''| |r| at the ends, as the
 * header says; a given angular acceleration leaves only rounding. The scale factor and misalignment
 * of the accelerometers raise the bounds by less than a hundredth. */
static void test_lever_arms(void **state)
{
    (void)state;
    record *r = new_record();
    imk_model model = unit();
    add_lever_arms(&model);
    distort(&model, r);
    compensate(&model, r);
    /* The largest |r|, over all axes, and one axis' share of every output component. */
    const double arm = sqrt(3) * 0.051;
    const double inner = dt * dt / 6 * largest_derivative(3) * arm;
    const double ends = dt / 2 * largest_derivative(2) * arm;
    CHECK_BELOW(worst(r->corrected[1], r->force, 1, COUNT - 1), 1.01 * inner);
    CHECK_BELOW(worst(r->corrected[1], r->force, 0, COUNT), 1.01 * ends);
    /* The differences are not that of a coarser rule, and the arms do matter. */
    assert_true(inner < 0.01 && ends > 5 * inner);
    CHECK_BELOW(worst(r->corrected[0], r->rate, 1, COUNT - 1), 1e-4 * 1.01 * inner);

    imk_compensator *c = malloc(sizeof *c);
    double *out[2][IMK_AXES_MAX], *workspace = malloc(imk_compensate_workspace_size(COUNT));
    imk_readings readings = readings_of(r);
    for (int k = 0; k < 3; k++)
        readings.angular_acceleration[k] = r->acceleration[k];
    outputs_of(r, out);
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    CHECK_OK(imk_compensate_record(c, &readings, COUNT, out, r->flags, workspace,
                                   imk_compensate_workspace_size(COUNT)));
    CHECK_BELOW(worst(r->corrected[1], r->force, 0, COUNT), 1e-11);
    free(workspace);
    free(c);
    free(r);
}

static void spoil(record *r)
{
    r->reading[0][1][700] = (double)NAN;
    r->reading[1][2][1500] = (double)INFINITY;
    r->reading[0][0][2000] = r->reading[0][0][2002] = (double)NAN;
    r->reading[0][2][2500] = 25;
    r->temperature[900] = (double)NAN;
    r->temperature[1000] = 400;
}

static void check_same_bits(const record *a, const record *b, int count)
{
    for (int s = 0; s < 2; s++)
        for (int k = 0; k < 3; k++)
            assert_memory_equal(a->corrected[s][k], b->corrected[s][k], count * sizeof(double));
    assert_memory_equal(a->flags, b->flags, count);
}

/* Sample by sample, in blocks of many lengths, and in place: the same bits, bad samples included.
 */
static void test_stream_equals_record(void **state)
{
    (void)state;
    static const size_t lengths[] = {1, 2, 255, 256, 257, 1000};
    record *whole = new_record(), *other = malloc(sizeof *other);
    imk_compensator *c = malloc(sizeof *c);
    double *out[2][IMK_AXES_MAX], *workspace = malloc(imk_compensate_workspace_size(COUNT));
    imk_model model = unit();
    add_temperature(&model, whole);
    for (int i = 0; i < AXES; i++)
        model.gyro.bias.temperature_rate.value[i] = 0.01;
    for (int with_arms = 0; with_arms < 2; with_arms++) {
        if (with_arms)
            add_lever_arms(&model);
        distort(&model, whole);
        spoil(whole);
        compensate(&model, whole);

        *other = *whole;
        memset(other->corrected, 0, sizeof other->corrected);
        CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
        assert_int_equal(imk_compensator_delay(c), with_arms);
        int written = 0;
        for (int i = 0; i <= COUNT; i++) {
            imk_compensator_sample sample;
            for (int s = 0; s < 2 && i < COUNT; s++)
                for (int k = 0; k < 3; k++)
                    sample.reading[s][k] = other->reading[s][k][i];
            sample.temperature = other->temperature[i < COUNT ? i : 0];
            if (!(i < COUNT ? imk_compensator_next(c, &sample)
                            : imk_compensator_finish(c, &sample)))
                continue;
            for (int k = 0; k < 3; k++) {
                other->corrected[0][k][written] = sample.rate[k];
                other->corrected[1][k][written] = sample.force[k];
            }
            other->flags[written++] = (unsigned char)sample.flags;
        }
        assert_int_equal(written, COUNT);
        check_same_bits(whole, other, COUNT);

        for (size_t l = 0; l < sizeof lengths / sizeof lengths[0]; l++) {
            *other = *whole;
            CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
            size_t done = 0;
            for (size_t first = 0; first < COUNT; first += lengths[l]) {
                imk_readings readings = {.temperature = other->temperature + first};
                for (int s = 0; s < 2; s++)
                    for (int k = 0; k < 3; k++) {
                        readings.channel[s][k] = other->reading[s][k] + first;
                        out[s][k] = other->reading[s][k] + done; /* in place */
                    }
                const size_t left = COUNT - first;
                done += imk_compensator_block(c, &readings, left < lengths[l] ? left : lengths[l],
                                              out, other->flags + done, workspace,
                                              imk_compensate_workspace_size(COUNT));
            }
            assert_int_equal(done, COUNT - with_arms);
            memcpy(other->corrected, other->reading, sizeof other->corrected);
            check_same_bits(whole, other, (int)done);
        }
    }
    free(workspace);
    free(c);
    free(other);
    free(whole);
}

/* What is bad stays where it is. */
static void test_flags(void **state)
{
    (void)state;
    record *good = new_record(), *bad = malloc(sizeof *bad);
    imk_model model = unit();
    add_temperature(&model, good);
    add_lever_arms(&model);
    distort(&model, good);
    *bad = *good;
    spoil(bad);
    compensate(&model, good);
    compensate(&model, bad);
    for (int i = 0; i < COUNT; i++) {
        int due = 0;
        if (i == 700 || i == 1500 || i == 2000 || i == 2002)
            due |= IMK_FLAG_NOT_FINITE;
        if (i == 700 || i == 1500 || i == 2000 || i == 2002) {
            /* g-sensitivity and lever arms: everything depends on everything. */
            for (int k = 0; k < 3; k++)
                assert_true(isnan(bad->corrected[0][k][i]) && isnan(bad->corrected[1][k][i]));
        }
        if (i == 2001) /* between two that are missing */
            due |= IMK_FLAG_ACCELERATION;
        if (i == 2500)
            due |= IMK_FLAG_SATURATED | IMK_FLAG_LIMIT;
        if (i == 2499 || i == 2501)
            due |= IMK_FLAG_ACCELERATION;
        if (i == 1000)
            due |= IMK_FLAG_TEMPERATURE;
        /* A sample that is missing has no acceleration of its own to speak of. */
        const int flags = bad->flags[i] & IMK_FLAG_NOT_FINITE
                              ? bad->flags[i] & ~IMK_FLAG_ACCELERATION
                              : bad->flags[i];
        assert_int_equal(flags, due);
        const int beside = i == 699 || i == 701 || i == 1499 || i == 1501 || i == 1999 || i == 2003;
        /* Another temperature tells in the rates, and beside it in their differences. */
        if (due == 0 && !beside && abs(i - 900) > 1 && abs(i - 1000) > 1)
            for (int k = 0; k < 3; k++) {
                assert_true(bad->corrected[0][k][i] == good->corrected[0][k][i]);
                assert_true(bad->corrected[1][k][i] == good->corrected[1][k][i]);
            }
        /* Beside a missing sample: the one-sided difference. */
        if (beside)
            for (int k = 0; k < 3; k++) {
                CHECK_CLOSE(bad->corrected[1][k][i], bad->force[k][i],
                            1.01 * dt / 2 * largest_derivative(2) * sqrt(3) * 0.051);
                assert_true(bad->corrected[0][k][i] == bad->corrected[0][k][i]);
            }
        /* The temperature before stands in: 5 mK of slope 1e-4 rad/s/K. */
        if (i == 900)
            CHECK_CLOSE(bad->corrected[0][0][i], bad->rate[0][i], 1e-6);
    }
    free(bad);
    free(good);
}

/* A gyro without its accelerometers' terms is not spoilt by them; nor is the other way round. */
static void test_independent_sensors(void **state)
{
    (void)state;
    record *r = new_record();
    imk_model model = unit();
    memset(&model.gyro.g_sensitivity, 0, sizeof model.gyro.g_sensitivity);
    distort(&model, r);
    r->reading[0][0][5] = (double)NAN;
    r->reading[1][0][6] = -(double)INFINITY;
    compensate(&model, r);
    for (int k = 0; k < 3; k++) {
        assert_true(isnan(r->corrected[0][k][5]) && !isnan(r->corrected[1][k][5]));
        assert_true(!isnan(r->corrected[0][k][6]) && isnan(r->corrected[1][k][6]));
    }
    assert_int_equal(r->flags[4], 0);
    assert_int_equal(r->flags[5], IMK_FLAG_NOT_FINITE);
    assert_int_equal(r->flags[6], IMK_FLAG_NOT_FINITE);
    free(r);
}

/* Saturation as it comes out of an output stage: a reading of the range, rounded to the resolution
 * or to counts, may stand half a step below it; a step below that it is not saturated. */
static void test_saturation_edges(void **state)
{
    (void)state;
    imk_compensator *c = malloc(sizeof *c);
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    for (int i = 0; i < AXES; i++) {
        model.gyro.range.value[i] = 10;
        model.gyro.resolution.value[i] = 0.3; /* 33 steps are 9.9 */
    }
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    imk_compensator_sample sample = {.reading = {{9.9, 0, 0}}};
    assert_true(imk_compensator_next(c, &sample));
    assert_int_equal(sample.flags, IMK_FLAG_SATURATED);
    sample.reading[0][0] = 9.6;
    assert_true(imk_compensator_next(c, &sample));
    assert_int_equal(sample.flags, 0);
    sample.reading[0][0] = -9.9;
    assert_true(imk_compensator_next(c, &sample));
    assert_int_equal(sample.flags, IMK_FLAG_SATURATED);

    /* 10 rad/s at 100.04 count/(rad/s) from 512 are 1512.4 counts, put out as 1512; -10 as -488. */
    for (int i = 0; i < AXES; i++) {
        model.gyro.resolution.value[i] = 0;
        model.gyro.sensitivity.value[i] = 100.04;
        model.gyro.zero_offset.value[i] = 512;
    }
    static const struct {
        double count;
        unsigned flags;
    } cases[] = {{1512, IMK_FLAG_SATURATED}, {1511, 0}, {-488, IMK_FLAG_SATURATED}, {-487, 0}};
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sample.reading[0][0] = cases[i].count;
        sample.reading[0][1] = sample.reading[0][2] = 512;
        assert_true(imk_compensator_next(c, &sample));
        assert_int_equal(sample.flags, cases[i].flags);
        CHECK_CLOSE(sample.rate[0], (cases[i].count - 512) / 100.04, 1e-14);
    }
    free(c);
}

/* A unit of one gyro: one output per axis. */
static void test_single_axis(void **state)
{
    (void)state;
    imk_compensator *c = malloc(sizeof *c);
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    model.gyro.axis_count = 1;
    model.gyro.direction[0][0] = 0;
    model.gyro.direction[0][2] = 1;
    model.gyro.bias.fixed.value[0] = 0.25;
    model.gyro.scale_factor.fixed.value[0] = 1;
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    assert_int_equal(imk_compensator_components(c, IMK_GYRO), 1);
    assert_int_equal(imk_compensator_components(c, IMK_ACCEL), 0);
    imk_compensator_sample sample = {.reading = {{1.25}}};
    assert_true(imk_compensator_next(c, &sample));
    CHECK_CLOSE(sample.rate[0], 0.5, 0); /* (1.25 - 0.25)/(1 + 1), exact in binary */
    sample.reading[0][0] = (double)NAN;
    assert_true(imk_compensator_next(c, &sample));
    assert_true(isnan(sample.rate[0]) && sample.flags == IMK_FLAG_NOT_FINITE);
    free(c);
}

/* A steady slope of temperature is found to e^(-t/tau) of itself; before any temperature is known
 * the outputs that need one are NaN. */
static void test_temperature_rate(void **state)
{
    (void)state;
    imk_compensator *c = malloc(sizeof *c);
    imk_model model;
    imk_model_default(&model);
    const double coefficient = 2.0, slope = 0.1;
    for (int i = 0; i < AXES; i++)
        model.gyro.bias.temperature_rate.value[i] = coefficient;
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    c->temperature_time = 1;
    imk_compensator_sample sample = {.temperature = (double)NAN};
    assert_true(imk_compensator_next(c, &sample));
    assert_true(isnan(sample.rate[0]) && sample.force[0] == 0);
    assert_int_equal(sample.flags, IMK_FLAG_NOT_FINITE);
    for (int i = 0; i <= 1000; i++) {
        memset(sample.reading, 0, sizeof sample.reading);
        sample.temperature = 300 + slope * i * dt;
        assert_true(imk_compensator_next(c, &sample));
        /* rate[k] = slope (1 - phi^k), phi = e^(-dt/tau); differences of 300 K keep 1e-11 K/s. */
        CHECK_CLOSE(sample.rate[0], -coefficient * slope * (1 - exp(-i * dt)), 1e-10);
    }
    /* After a gap the slope counts over the whole of it: phi = e^-50 forgets everything else. */
    imk_compensator_resume(c, 1002 * dt + 50 - dt);
    memset(sample.reading, 0, sizeof sample.reading);
    sample.temperature += 0.02 * 50;
    assert_true(imk_compensator_next(c, &sample));
    CHECK_CLOSE(sample.rate[0], -coefficient * 0.02, 1e-9);
    free(c);
}

/* Warm-up counts from power-on, and is that of the middle of a sample, which ends at its time. */
static void test_warm_up(void **state)
{
    (void)state;
    imk_compensator *c = malloc(sizeof *c);
    imk_model model;
    imk_model_default(&model);
    model.accel.bias.warm_up_time.value = 60;
    for (int i = 0; i < AXES; i++)
        model.accel.bias.warm_up_amplitude.value[i] = 0.5;
    CHECK_OK(imk_compensator_start(c, &model, dt, NULL, NULL));
    imk_compensator_resume(c, 30);
    for (int i = 0; i < 3; i++) {
        imk_compensator_sample sample = {.temperature = (double)NAN};
        assert_true(imk_compensator_next(c, &sample));
        CHECK_CLOSE(sample.force[1], -0.5 * exp(-(30 + (i - 0.5) * dt) / 60), 1e-15);
        assert_int_equal(sample.flags, 0); /* it needs no temperature */
    }
    free(c);
}

static void test_bad_arguments(void **state)
{
    (void)state;
    static const double bad[] = {0, -1, 1e-13, 1e10, (double)NAN, (double)INFINITY};
    imk_compensator *c = malloc(sizeof *c);
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK_STATUS(imk_compensator_start(c, &model, bad[i], NULL, &error), IMK_ERROR_RANGE);
        assert_string_equal(error.field, "dt");
    }
    model.gyro.bias.fixed.value[0] = (double)NAN;
    CHECK_STATUS(imk_compensator_start(c, &model, dt, NULL, &error), IMK_ERROR_NOT_FINITE);
    imk_model_default(&model);
    /* The third accelerometer in the plane of the others, when the gyros need all of the force. */
    model.accel.direction[2][2] = 0;
    model.accel.direction[2][0] = 1;
    model.gyro.g_sensitivity.value[0][1] = 1e-4;
    CHECK_STATUS(imk_compensator_start(c, &model, dt, NULL, &error), IMK_ERROR_SINGULAR);
    free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_closed_loop),
                                       cmocka_unit_test(test_lever_arms),
                                       cmocka_unit_test(test_stream_equals_record),
                                       cmocka_unit_test(test_flags),
                                       cmocka_unit_test(test_independent_sensors),
                                       cmocka_unit_test(test_saturation_edges),
                                       cmocka_unit_test(test_single_axis),
                                       cmocka_unit_test(test_temperature_rate),
                                       cmocka_unit_test(test_warm_up),
                                       cmocka_unit_test(test_bad_arguments)};
    return cmocka_run_group_tests_name("compensator", tests, NULL, NULL);
}
