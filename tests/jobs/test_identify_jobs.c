/* SPDX-License-Identifier: Apache-2.0 */
/* Jobs about identified records, from arrays in memory: runs, devices, curves, plans, and what they
 * do when memory fails. */
#include "check.h"

#include "imukit/identify_curve.h"
#include "imukit/identify_several.h"
#include "imukit/random.h"
#include "imukit/record_plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4096, RECORDS = 3 };

static const double rate = 100; /* [Hz] */

/* Memory that is counted, and fails once. */
typedef struct account {
    size_t pieces, calls, fail_at; /* fail_at 0: never */
} account;

static void *counted(void *context, void *at, size_t size)
{
    account *a = context;
    if (size == 0) {
        a->pieces -= at != NULL;
        free(at);
        return NULL;
    }
    if (++a->calls == a->fail_at)
        return NULL;
    a->pieces += at == NULL;
    return realloc(at, size);
}

static imk_identify_log *identified(const char *name, uint64_t seed, double sigma)
{
    static double samples[ROWS];
    const double *const data[] = {samples};
    imk_identify_log_settings settings = imk_identify_log_default();
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *log;
    imk_random_normals(imk_random_seeded(seed), 0, 0, ROWS, samples);
    for (size_t i = 0; i < ROWS; i++)
        samples[i] *= sigma;
    settings.summarise = true;
    CHECK_OK(imk_array_source_make(1, &name, data, ROWS, rate, &memory, &source, NULL));
    CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &log, NULL));
    return log;
}

static void test_runs_and_devices(void **state)
{
    (void)state;
    imk_identify_log *alike[RECORDS], *louder;
    imk_identify_several *several;
    for (uint64_t r = 0; r < RECORDS; r++)
        alike[r] = identified("gyro_x", r + 1, 1e-3);
    louder = identified("gyro_x", 9, 2e-3);
    CHECK_OK(
        imk_identify_runs(RECORDS, (const imk_identify_log *const *)alike, NULL, &several, NULL));
    const imk_estimate *joint = &several->joint.result[0].term[IMK_NOISE_WHITE];
    assert_int_equal(several->joint.origin, IMK_IDENTIFY_RECORDS);
    CHECK_RELATIVE(several->joint.duration, RECORDS * ROWS / rate, 1e-12);
    CHECK_RELATIVE(joint->value, 1e-3 / sqrt(rate), 0.05); /* sigma sqrt(dt); 0.6 % is its sigma */
    CHECK_BELOW(joint->sigma, alike[0]->result[0].term[IMK_NOISE_WHITE].sigma);
    assert_false(several->differs[0]);
    assert_int_equal(several->joint.curve[0].count, alike[0]->curve[0].count);
    imk_identify_several_free(several);
    const imk_identify_log *const differ[] = {alike[0], louder};
    CHECK_OK(imk_identify_runs(2, differ, NULL, &several, NULL));
    assert_true(several->differs[0]);
    imk_identify_several_free(several);
    CHECK_OK(imk_identify_devices(2, differ, NULL, &several, NULL));
    const imk_device_term *white = &several->term[0][IMK_NOISE_WHITE];
    assert_true(white->compared && white->differs && white->low == 0 && white->high == 1);
    imk_identify_several_free(several);
    imk_identify_log_free(louder);
    for (size_t r = 0; r < RECORDS; r++)
        imk_identify_log_free(alike[r]);
}

static void test_what_cannot_be_compared(void **state)
{
    (void)state;
    imk_identify_log *one = identified("gyro_x", 1, 1e-3), *other = identified("gyro_y", 2, 1e-3);
    const imk_identify_log *const logs[] = {one, other};
    imk_identify_several *several;
    imk_error error;
    CHECK_STATUS(imk_identify_devices(2, logs, NULL, &several, &error), IMK_ERROR_CONFLICT);
    assert_null(several);
    assert_string_equal(error.field, "channels");
    assert_int_equal(error.index, 1);
    CHECK_STATUS(imk_identify_runs(1, logs, NULL, &several, &error), IMK_ERROR_ARGUMENT);
    imk_identify_log_free(one);
    imk_identify_log_free(other);
}

/* Every allocation fails once: the job says so, and nothing is left behind. */
static void test_joint_without_memory(void **state)
{
    (void)state;
    imk_identify_log *one = identified("gyro_x", 1, 1e-3), *other = identified("gyro_x", 2, 1e-3);
    const imk_identify_log *const logs[] = {one, other};
    account all = {0};
    const imk_job job = {.allocator = {counted, &all}};
    imk_identify_several *several;
    for (;;) {
        all.calls = 0;
        all.fail_at++;
        const imk_status status = imk_identify_runs(2, logs, &job, &several, NULL);
        if (status == IMK_OK)
            break;
        CHECK_STATUS(status, IMK_ERROR_MEMORY);
        assert_null(several);
        assert_int_equal(all.pieces, 0);
    }
    assert_true(all.fail_at > 3);
    imk_identify_several_free(several);
    assert_int_equal(all.pieces, 0);
    imk_identify_log_free(one);
    imk_identify_log_free(other);
}

/* Deviations of white noise, as a data sheet might print them. */
static imk_status fit_curve(const char *const *names, const imk_job *job, imk_identify_log **log)
{
    static const double tau[] = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100};
    enum { COUNT = sizeof tau / sizeof tau[0] };
    double deviation[COUNT];
    const double *const data[] = {tau, deviation};
    imk_identify_curve_settings settings = imk_identify_curve_default();
    imk_array_source memory;
    imk_record_source source;
    for (size_t k = 0; k < COUNT; k++)
        deviation[k] = 1e-4 / sqrt(tau[k]);
    settings.rate = rate;
    settings.duration = 3600;
    CHECK_OK(imk_array_source_make(2, names, data, COUNT, rate, &memory, &source, NULL));
    return imk_identify_curve_run(&source, &settings, job, log, NULL);
}

static void test_curve(void **state)
{
    (void)state;
    static const char *const names[] = {"tau", "gyro_x"}, *const without[] = {"time_s", "gyro_x"};
    account all = {0};
    const imk_job job = {.allocator = {counted, &all}};
    imk_identify_log *log;
    CHECK_OK(fit_curve(names, &job, &log));
    assert_int_equal(log->origin, IMK_IDENTIFY_CURVE);
    assert_int_equal(log->record.count, 1);
    assert_int_equal(log->record.rows, 360000);
    CHECK_RELATIVE(log->result[0].term[IMK_NOISE_WHITE].value, 1e-4, 0.01);
    assert_string_equal(log->findings.item[0].code, "curve");
    imk_identify_log_free(log);
    assert_int_equal(all.pieces, 0);
    CHECK_STATUS(fit_curve(without, &job, &log), IMK_ERROR_FORMAT);
    assert_string_equal(imk_findings_failure(&log->findings)->code, "no_curve");
    imk_identify_log_free(log);
    for (imk_status status = IMK_ERROR_MEMORY; status != IMK_OK; imk_identify_log_free(log)) {
        all.calls = 0;
        all.fail_at++;
        status = fit_curve(names, &job, &log);
        assert_true(status == IMK_OK || status == IMK_ERROR_MEMORY);
    }
    assert_int_equal(all.pieces, 0);
}

/* ---- curves read from a page ------------------------------------------------------------------
 */

enum { CURVE_SAMPLES = 1 << 16, CURVE_POINTS = 64 };

/* N, B and K at 1 Hz: each is seen over a decade of tau. */
static const double curve_truth[3] = {1, 0.1, 0.003};

/* Deviations of a record at ten tau to the decade, each times exp(error x normal).
 * @return number of tau */
static size_t read_curve(uint64_t seed, double error, double *tau, double *deviation)
{
    static double samples[CURVE_SAMPLES], sums[CURVE_SAMPLES + 1], normals[CURVE_POINTS];
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    const imk_random random = imk_random_seeded(seed);
    size_t factors[CURVE_POINTS], count = imk_allan_factors(IMK_ALLAN_DECADE, CURVE_SAMPLES, NULL);
    assert_true(count <= CURVE_POINTS);
    memset(samples, 0, sizeof samples);
    CHECK_OK(imk_white_start(&white, curve_truth[0], 1, random, 1));
    CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){curve_truth[1], 0}, 1, random,
                               (uint64_t)2 << 32));
    CHECK_OK(imk_random_walk_start(&walk, curve_truth[2], 1, random, (uint64_t)3 << 32));
    imk_white_add(&white, CURVE_SAMPLES, samples);
    imk_flicker_add(&flicker, CURVE_SAMPLES, samples);
    imk_random_walk_add(&walk, CURVE_SAMPLES, samples);
    imk_allan_sums(CURVE_SAMPLES, samples, sums, NULL);
    imk_allan_factors(IMK_ALLAN_DECADE, CURVE_SAMPLES, factors);
    while (factors[count - 1] > CURVE_SAMPLES / 8)
        count--;
    CHECK_OK(imk_allan_variances(IMK_ALLAN_OVERLAPPING, CURVE_SAMPLES, sums, count, factors,
                                 deviation, NULL, NULL));
    imk_random_normals(random, (uint64_t)4 << 32, 0, count, normals);
    for (size_t k = 0; k < count; k++) {
        tau[k] = (double)factors[k];
        deviation[k] = sqrt(deviation[k]) * exp(error * normals[k]);
    }
    return count;
}

/* @return the error found in the deviations [%]; *covered counts intervals that hold the truth */
static double fit_read_curve(uint64_t seed, double error, int *covered)
{
    static const char *const names[] = {"tau", "gyro_x"};
    double tau[CURVE_POINTS], deviation[CURVE_POINTS], found = 0;
    const double *const data[] = {tau, deviation};
    const size_t count = read_curve(seed, error, tau, deviation);
    imk_identify_curve_settings settings = imk_identify_curve_default();
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *log;
    settings.rate = 1;
    settings.duration = CURVE_SAMPLES;
    CHECK_OK(imk_array_source_make(2, names, data, count, 1, &memory, &source, NULL));
    CHECK_OK(imk_identify_curve_run(&source, &settings, NULL, &log, NULL));
    for (int i = 0; i < 3; i++) {
        const imk_estimate *e = &log->result[0].term[IMK_NOISE_WHITE + i];
        *covered += e->lower <= curve_truth[i] && curve_truth[i] <= e->upper;
    }
    for (size_t k = 0; k < log->findings.count; k++)
        if (strcmp(log->findings.item[k].code, "curve_tolerance") == 0)
            found = log->findings.item[k].number[0];
    imk_identify_log_free(log);
    return found;
}

/* Errors of reading are found, to a factor, and 95 % intervals hold the truth with them: at least
 * 85 of 100 of all, four standard deviations below. White noise is never lost. In computed curves
 * hardly any error is found. */
static void test_read_curve(void **state)
{
    (void)state;
    const int curves = check_quick() ? 2 : 8;
    static const double errors[] = {0, 0.01, 0.04};
    int covered = 0;
    for (size_t e = 0; e < sizeof errors / sizeof errors[0]; e++) {
        int fitting = 0;
        for (uint64_t seed = 1; seed <= (uint64_t)curves; seed++) {
            const double found = fit_read_curve(seed, errors[e], &covered);
            fitting += e == 0 ? found == 0 : found >= 50 * errors[e] && found <= 250 * errors[e];
        }
        print_message("error %g: %d of %d intervals hold so far, error found in %d\n", errors[e],
                      covered, 3 * curves * ((int)e + 1), fitting);
        assert_true(fitting >= 9 * curves / 10);
    }
    assert_true(covered >= 85 * 9 * curves / 100);
}

static imk_status plan_for(const char *want, imk_record_plan **plan)
{
    static imk_model model;
    imk_model_default(&model);
    model.gyro.present = true;
    model.gyro.axis_count = 1;
    model.gyro.noise.white.value[0] = 1e-4;
    model.gyro.noise.bias_instability.value[0] = 1e-5;
    imk_record_plan_settings settings = imk_record_plan_default();
    settings.rate = rate;
    settings.want = want;
    return imk_record_plan_run(&model, &settings, NULL, plan, NULL);
}

static void test_plan(void **state)
{
    (void)state;
    static const struct {
        const char *want, *code;
    } wrong[] = {{"bias_instability 5", "requirement"},
                 {"N 1%, bias_instability detected 200%", "requirement_chance"},
                 {"rate_random_walk 5%", "no_such_noise"},
                 {"accel.N 5%", "no_such_noise"}};
    const imk_allocator none = {0};
    imk_record_plan *p;
    CHECK_OK(plan_for("bias_instability 5%, gyro.N 1%", &p));
    assert_int_equal(p->parameter_count, 2);
    assert_int_equal(p->requirement_count, 2);
    assert_true(p->met && p->duration >= p->requirement[0].duration);
    assert_string_equal(p->requirement[1].text, "gyro.N 1%");
    for (size_t d = 0; d < p->record_count; d++)
        if (p->record[d].planned)
            CHECK_BELOW(p->record[d].relative[1], 0.05001);
    imk_record_plan_free(p, &none);
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        assert_true(plan_for(wrong[k].want, &p) != IMK_OK);
        assert_string_equal(imk_findings_failure(&p->findings)->code, wrong[k].code);
        imk_record_plan_free(p, &none);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_runs_and_devices),     cmocka_unit_test(test_what_cannot_be_compared),
        cmocka_unit_test(test_joint_without_memory), cmocka_unit_test(test_curve),
        cmocka_unit_test(test_read_curve),           cmocka_unit_test(test_plan)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
