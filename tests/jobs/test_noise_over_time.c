/* SPDX-License-Identifier: Apache-2.0 */
/* Noise over time from the job of identification to the verdict; the same map in one pass over
 * a long record. */
#include "check.h"
#include "imukit/identify_log.h"
#include "imukit/identify_record.h"
#include "imukit/random.h"
#include "imukit/show.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 32768, LONG = 9 * 65536 };

static double samples[2][ROWS], long_samples[LONG];

/* Two channels of white noise; that of the first is `factor` times as strong from half-way on. */
static imk_identify_log *identified(double factor)
{
    const char *const names[] = {"gyro_x [rad/s]", "gyro_y [rad/s]"};
    const double *const data[] = {samples[0], samples[1]};
    const imk_identify_log_settings settings = imk_identify_log_default();
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *log;
    for (size_t c = 0; c < 2; c++)
        imk_random_normals(imk_random_seeded(31), c, 0, ROWS, samples[c]);
    for (size_t i = ROWS / 2; i < ROWS; i++)
        samples[0][i] *= factor;
    CHECK_OK(imk_array_source_make(2, names, data, ROWS, 100, &memory, &source, NULL));
    CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &log, NULL));
    return log;
}

static bool says(const imk_verdict *verdict, const char *code, imk_finding_level level)
{
    for (size_t k = 0; k < verdict->count; k++)
        if (strcmp(verdict->message[k].code, code) == 0 && verdict->message[k].level == level)
            return true;
    return false;
}

static void test_verdict(void **state)
{
    (void)state;
    for (int faulty = 0; faulty < 2; faulty++) {
        imk_identify_log *log = identified(faulty ? 2 : 1);
        imk_result *result = imk_result_create(NULL);
        const imk_verdict verdict = imk_identify_verdict(log, NULL, result);
        assert_int_equal(says(&verdict, "noise_changes", IMK_FINDING_WARNING), faulty);
        assert_int_equal(log->changes[0].segment_count, 1 + faulty);
        assert_int_equal(log->changes[1].segment_count, 1);
        /* A column has 256 samples. */
        CHECK_CLOSE((double)log->changes[0].segment[0].end, faulty ? ROWS / 2 : ROWS, 256);
        imk_result_free(result);
        imk_identify_log_free(log);
    }
}

/* The record is scaled and shifted inside, which its map does not show. */
static void test_long_record(void **state)
{
    (void)state;
    imk_random_normals(imk_random_seeded(32), 0, 0, LONG, long_samples);
    for (size_t i = 0; i < LONG; i++)
        long_samples[i] = 1000 + 30 * long_samples[i];
    long_samples[70000] = long_samples[70001] = (double)NAN;
    imk_noise_map *map = malloc(sizeof *map);
    const size_t size = imk_identify_record_size(LONG);
    void *memory = malloc(size);
    imk_identify_record *record;
    imk_identification found;
    CHECK_OK(imk_identify_record_begin(LONG, &record, memory, size, NULL));
    CHECK_OK(imk_identify_record_add(record, LONG, long_samples, NULL));
    const size_t work_size = imk_identify_record_workspace_size(record);
    void *workspace = malloc(work_size);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    CHECK_OK(imk_identify_record_finish(record, &settings, &found, workspace, work_size, NULL));
    imk_noise_map_begin(map);
    imk_noise_map_add(map, LONG, long_samples);
    imk_noise_map_end(map);
    const imk_noise_map *made = imk_identify_record_map(record);
    assert_int_equal(made->samples, LONG);
    assert_int_equal(imk_noise_map_octaves(made), imk_noise_map_octaves(map));
    for (size_t j = 0; j < imk_noise_map_octaves(map); j++)
        for (size_t b = 0; b < imk_noise_map_blocks(map); b += 8) {
            const imk_estimate one = imk_noise_map_deviation(map, j, b, b + 8, 0.95);
            const imk_estimate other = imk_noise_map_deviation(made, j, b, b + 8, 0.95);
            assert_int_equal(one.present, other.present);
            CHECK_RELATIVE(other.value, one.value, 1e-9); /* a mean 30 times the noise */
        }
    free(workspace);
    free(memory);
    free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_verdict),
                                       cmocka_unit_test(test_long_record)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
