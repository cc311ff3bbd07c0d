/* SPDX-License-Identifier: Apache-2.0 */
/* A campaign whose numbers are computed from run, time and state, for the tests of campaign files.
 */
#ifndef IMUKIT_TESTS_CAMPAIGN_RUNS_H
#define IMUKIT_TESTS_CAMPAIGN_RUNS_H

#include "check.h"

#include "imukit/campaign.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 137, TIMES = 5, STATES = 3, RUN_VALUES = TIMES * STATES };

static const double times[TIMES] = {1, 60, 600.5, 3600, 86400};
static const char *const states[STATES] = {"position_north", "velocity_north", "heading"};
static const char *const state_units[STATES] = {"m", "m/s", "rad"};

static inline imk_campaign make_campaign(void)
{
    return (imk_campaign){.version = IMK_VERSION,
                          .parameters = "{\"model\": \"AHRS\", \"duration\": 86400, \"yaw\": 0}",
                          .seed = 42,
                          .run_count = RUNS,
                          .time_count = TIMES,
                          .time = times,
                          .state_count = STATES,
                          .state = states,
                          .unit = state_units};
}

/* Bits without a pattern (a step of Knuth's MMIX generator), as numbers between 1 and 2. */
static inline double number_of(uint64_t run, size_t value)
{
    uint64_t x = (run * RUN_VALUES + value) * 6364136223846793005u + 1442695040888963407u;
    x = (x ^ x >> 29) * 6364136223846793005u;
    double y;
    x = x >> 12 | UINT64_C(0x3FF0000000000000);
    memcpy(&y, &x, sizeof y);
    return y;
}

static inline void fill_runs(uint64_t first, uint64_t runs, double *values)
{
    for (uint64_t run = first; run < first + runs; run++)
        for (size_t i = 0; i < RUN_VALUES; i++)
            *values++ = number_of(run, i);
}

static inline imk_status add_runs(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                                  imk_error *error)
{
    double values[64 * RUN_VALUES];
    fill_runs(first, runs, values);
    return imk_campaign_add(writer, first, runs, values, error);
}

/* Compute what is missing of a shard and write its file. */
static inline void compute_shard(const char *path, const imk_campaign *campaign, uint64_t first,
                                 uint64_t runs)
{
    imk_campaign_writer *writer;
    imk_error error;
    CHECK_STATUS(imk_campaign_create(path, campaign, first, runs, &writer, &error), IMK_OK);
    /* Last run first: the order must not matter. */
    for (uint64_t run = first + runs; run-- > first;)
        if (!imk_campaign_has(writer, run))
            CHECK_STATUS(add_runs(writer, run, 1, &error), IMK_OK);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
}

static inline unsigned char *read_bytes(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = '\0';
    fclose(file);
    return bytes;
}

static inline void write_bytes(const char *path, const unsigned char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static inline void check_same_file(const char *left, const char *right)
{
    size_t size, other_size;
    unsigned char *bytes = read_bytes(left, &size), *other = read_bytes(right, &other_size);
    assert_int_equal(size, other_size);
    assert_memory_equal(bytes, other, size);
    free(bytes);
    free(other);
}

#endif
