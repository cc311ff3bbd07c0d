/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of the readings of an integral, from samples to the verdict: what is counted and what is
 * white, over seeds and through decimals of a text; values that end by themselves and values that
 * are cut off; logs at several rates. */
#include "check.h"

#include "imukit/identify_several.h"
#include "imukit/noise.h"
#include "imukit/show.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 4096 };

static const char *const name = "gyro_x";

/* Errors of readings, 1 sigma `size`, at a rate, with white noise of N = `white`; rounded to
 * decimals, unless these are 0. */
typedef struct record {
    enum { ANGLES, COUNTED, UNIFORM } kind; /* normal; of a rounded integral; uniform */
    double size, white, rate;
    int decimals;
    double limit; /* values are cut off, or folded back, there; 0: nowhere */
    bool folded;
} record;

static void fill(const record *r, uint64_t seed, double *x)
{
    const double dt = 1 / r->rate;
    const imk_random random = imk_random_seeded(seed);
    static uint32_t reading[ROWS + 1];
    imk_white_state white;
    memset(x, 0, ROWS * sizeof *x);
    if (r->white > 0) {
        CHECK_OK(imk_white_start(&white, r->white, dt, random, 1));
        imk_white_add(&white, ROWS, x);
    }
    if (r->kind == COUNTED) {
        imk_quantization_state state;
        CHECK_OK(imk_quantization_start(&state, r->size, dt, random, 2));
        imk_quantization_apply(&state, ROWS, x);
    } else if (r->kind == ANGLES) {
        imk_angle_white_state state;
        CHECK_OK(imk_angle_white_start(&state, r->size * sqrt(dt), dt, random, 3));
        imk_angle_white_add(&state, ROWS, x);
    } else {
        imk_random_words(random, 4, 0, ROWS + 1, reading);
        for (size_t i = 0; i < ROWS; i++)
            x[i] += ((double)reading[i + 1] - (double)reading[i]) / 4294967296.0 * sqrt(12) *
                    r->size / dt;
    }
    const double grid = pow(10, -r->decimals);
    for (size_t i = 0; i < ROWS; i++) {
        if (r->limit > 0 && fabs(x[i]) > r->limit)
            x[i] = copysign(r->folded ? 2 * r->limit - fabs(x[i]) : r->limit, x[i]);
        if (r->decimals > 0)
            x[i] = round(x[i] / grid) * grid;
    }
}

static imk_identify_log *identified(const record *r, uint64_t seed)
{
    static double samples[ROWS];
    const double *const data[] = {samples};
    imk_identify_log_settings settings = imk_identify_log_default();
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *log;
    fill(r, seed, samples);
    settings.summarise = true;
    CHECK_OK(imk_array_source_make(1, &name, data, ROWS, r->rate, &memory, &source, NULL));
    CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &log, NULL));
    return log;
}

static bool told(const imk_identify_log *log, const char *code)
{
    imk_result *result = imk_result_create(NULL);
    const imk_verdict verdict = imk_identify_verdict(log, NULL, result);
    bool any = false;
    for (size_t k = 0; k < verdict.count; k++)
        any = any || strcmp(verdict.message[k].code, code) == 0;
    imk_result_free(result);
    return any;
}

/* With noise of half a count or more per sample, rounding lies on its grid, whatever the decimals
 * of the text, and errors that are normal or uniform lie on none: no record of 8 of each of eight
 * kinds is told wrongly (if one in ten of one kind were, all were right with a probability of 0.4;
 * over 200 seeds of each none was). Sizes in rad/s at 100 Hz: a count of 3.5e-4 rad is a step of
 * 0.035; decimals of 1e-4 and 1e-6 are no grid of counts. */
static void test_counted(void **state)
{
    (void)state;
    static const record kinds[] = {
        {COUNTED, 1e-4, 2e-3, 100, 0, 0, false}, {COUNTED, 1e-4, 2e-3, 100, 4, 0, false},
        {COUNTED, 1e-4, 2e-3, 100, 6, 0, false}, {ANGLES, 1e-4, 1e-3, 100, 0, 0, false},
        {ANGLES, 1e-4, 1e-3, 100, 3, 0, false},  {ANGLES, 1e-4, 1e-3, 100, 6, 0, false},
        {UNIFORM, 1e-4, 1e-3, 100, 0, 0, false}, {UNIFORM, 1e-4, 1e-3, 100, 6, 0, false}};
    const uint64_t seeds = check_quick() ? 2 : 8;
    static imk_model model;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        size_t covered = 0;
        for (uint64_t seed = 1; seed <= seeds; seed++) {
            imk_identify_log *log = identified(&kinds[k], seed);
            const imk_identification *r = &log->result[0];
            const bool counted = kinds[k].kind == COUNTED;
            assert_true(r->term[IMK_NOISE_QUANTIZATION].present);
            assert_true(imk_identification_counted(r) == counted);
            assert_true(told(log, "angle_noise") != counted);
            imk_identify_log_model(log, "log", &model);
            const imk_noise *noise = &model.gyro.noise;
            const imk_interval *interval = &model.gyro_evidence.interval[0];
            const double size = counted ? kinds[k].size : 0.1 * kinds[k].size; /* sqrt(dt) */
            CHECK_CLOSE(noise->quantization.value[0], counted ? size : 0, 0.4 * size);
            CHECK_CLOSE(noise->angle_white.value[0], counted ? 0 : size, 0.4 * size);
            assert_string_equal(interval->key,
                                counted ? "noise.quantization" : "noise.angle_white");
            covered += interval->lower.value[0] <= size && size <= interval->upper.value[0];
            imk_identify_log_free(log);
        }
        /* Of 8 right 95 % intervals fewer than 4 hold with a probability of 1.5e-5. */
        assert_true(covered + 4 >= seeds);
    }
}

/* Uniform errors: two readings differ by a count at most, and values end there by themselves. Where
 * they are cut off or folded back at two thirds of it, they do not. */
static void test_ends(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        imk_identify_log *log = identified(&(record){UNIFORM, 1e-4, 0, 100, 0, 0, false}, seed);
        assert_false(told(log, "ends"));
        imk_identify_log_free(log);
    }
    const double step = sqrt(12) * 1e-4 / 0.01;
    imk_identify_log *log = identified(&(record){UNIFORM, 1e-4, 0, 100, 0, 0.66 * step, false}, 1);
    assert_true(told(log, "at_limit"));
    imk_identify_log_free(log);
    log = identified(&(record){UNIFORM, 1e-4, 0, 100, 0, 0.66 * step, true}, 1);
    assert_true(told(log, "ends"));
    imk_identify_log_free(log);
}

static imk_identify_several *at_rates(const record *r, double reading, double white, uint64_t seed,
                                      imk_identify_log **log, imk_error *error)
{
    static const double rates[3] = {10, 100, 1000};
    imk_identify_several *several;
    for (uint64_t i = 0; i < 3; i++) {
        record one = *r;
        one.rate = rates[i];
        one.size = sqrt(reading * reading + white * white * rates[i]);
        log[i] = identified(&one, 10 * seed + i);
    }
    const imk_status status =
        imk_identify_runs(3, (const imk_identify_log *const *)log, NULL, &several, error);
    assert_true((status == IMK_OK) == (several != NULL));
    return several;
}

static void drop(imk_identify_several *several, imk_identify_log **log)
{
    imk_identify_several_free(several);
    for (size_t i = 0; i < 3; i++)
        imk_identify_log_free(log[i]);
}

/* Readings at three rates. What is there is told, and its interval holds: fewer than 2 of 5 right
 * 95 % intervals with a probability of 3e-5. A part that is not there is called present in 1 % of
 * sets, so in 3 of 5 with a probability of 1e-5. */
static void test_rates(void **state)
{
    (void)state;
    static const double truths[3][2] = {{1e-4, 0}, {0, 1e-5}, {1e-4, 1e-5}};
    static const imk_reading_kind kinds[3] = {IMK_READING_ALIKE, IMK_READING_WHITE,
                                              IMK_READING_BOTH};
    const size_t sets = check_quick() ? 1 : 5;
    static imk_model model;
    imk_identify_log *log[3];
    for (size_t t = 0; t < 3; t++) {
        size_t right = 0, covered[2] = {0};
        for (uint64_t seed = 1; seed <= sets; seed++) {
            imk_identify_several *s = at_rates(&(record){.kind = ANGLES}, truths[t][0],
                                               truths[t][1], 100 * t + seed, log, NULL);
            assert_non_null(s);
            assert_true(s->rates && s->longest == 0);
            const imk_reading_parts *p = &s->readings[0];
            const imk_estimate *part[2] = {&p->reading_noise, &p->angle_white};
            right += p->kind == kinds[t];
            for (int i = 0; i < 2; i++)
                covered[i] += part[i]->lower <= truths[t][i] && truths[t][i] <= part[i]->upper;
            if (p->kind == kinds[t]) {
                imk_identify_log_model(&s->joint, "logs", &model);
                /* but for the digits of the file */
                CHECK_CLOSE(model.gyro.noise.reading_noise.value[0], p->reading_noise.value,
                            1e-3 * truths[t][0]);
                CHECK_CLOSE(model.gyro.noise.angle_white.value[0], p->angle_white.value,
                            1e-3 * truths[t][1]);
            }
            drop(s, log);
        }
        print_message("kind %d: right %zu of %zu, held %zu and %zu\n", (int)kinds[t], right, sets,
                      covered[0], covered[1]);
        assert_true(right + 2 >= sets && covered[0] + 3 >= sets && covered[1] + 3 >= sets);
    }
}

/* Without errors of readings, or where they are counted, several rates are refused. */
static void test_rates_refused(void **state)
{
    (void)state;
    static const record kinds[2] = {{.kind = ANGLES, .white = 1e-3},
                                    {.kind = COUNTED, .white = 1e-2}};
    for (size_t k = 0; k < 2; k++) {
        imk_identify_log *log[3];
        imk_error error;
        imk_identify_several *s = at_rates(&kinds[k], k == 0 ? 1e-9 : 1e-4, 0, 7 + k, log, &error);
        assert_null(s);
        assert_int_equal(error.status, IMK_ERROR_CONFLICT);
        assert_string_equal(error.field, "rate");
        assert_int_equal(error.index, 1);
        drop(s, log);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counted),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_rates),
        cmocka_unit_test(test_rates_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
