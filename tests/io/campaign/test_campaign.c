/* SPDX-License-Identifier: Apache-2.0 */
/* Results files of campaigns: made, read, interrupted. The values expected are those put in, bit
 * for bit. */
#define _DEFAULT_SOURCE
#include "enter_folder.h"
#include "io/campaign_runs.h"

#include "imukit/decimal.h"
#include "imukit/io.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The same number, bit for bit but for the sign of zero. */
static void check_exact(double actual, double expected)
{
    CHECK_CLOSE(actual, expected, 0.0);
}

static char directory[] = "/tmp/imukit-campaign-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    enter_folder(directory);
    return 0;
}

static int clean(void **state)
{
    (void)state;
    DIR *listing = opendir(".");
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry; entry = readdir(listing))
        if (entry->d_name[0] != '.' || strstr(entry->d_name, ".part"))
            remove(entry->d_name);
    return listing ? closedir(listing) : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return chdir("/") == 0 ? rmdir(directory) : -1;
}

/* Consecutive, complete, and sizes that differ by one at most, for every division. */
static void shards_divide_the_runs(void **state)
{
    (void)state;
    for (uint64_t count = 1; count <= RUNS; count++) {
        uint64_t next = 0;
        for (uint64_t index = 1; index <= count; index++) {
            uint64_t first, runs;
            imk_campaign_shard(RUNS, index, count, &first, &runs);
            assert_int_equal(first, next);
            assert_in_range(runs, RUNS / count, RUNS / count + 1);
            next = first + runs;
        }
        assert_int_equal(next, RUNS);
    }
}

static void what_is_written_is_read(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_results *r;
    imk_error error;
    double expected[RUN_VALUES];
    compute_shard("shard.h5", &campaign, 30, 50);
    assert_int_not_equal(access("shard.h5.part", F_OK), 0);
    CHECK_STATUS(imk_campaign_load("shard.h5", &r, &error), IMK_OK);
    assert_string_equal(r->campaign.version, campaign.version);
    assert_string_equal(r->campaign.parameters, campaign.parameters);
    assert_int_equal(r->campaign.seed, campaign.seed);
    assert_int_equal(r->campaign.run_count, RUNS);
    assert_int_equal(r->campaign.time_count, TIMES);
    assert_memory_equal(r->campaign.time, times, sizeof times);
    assert_int_equal(r->campaign.state_count, STATES);
    for (size_t k = 0; k < STATES; k++) {
        assert_string_equal(r->campaign.state[k], states[k]);
        assert_string_equal(r->campaign.unit[k], state_units[k]);
    }
    assert_int_equal(r->runs, 50);
    for (uint64_t i = 0; i < 50; i++) {
        assert_int_equal(r->run[i], 30 + i);
        fill_runs(30 + i, 1, expected);
        assert_memory_equal(r->values + i * RUN_VALUES, expected, sizeof expected);
    }
    imk_campaign_free(r);
    imk_campaign_free(NULL);
}

/* The text is that of the format's description. */
static void csv_has_a_row_per_run_and_time(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    compute_shard("all.csv", &campaign, 0, RUNS);
    size_t size;
    char *text = (char *)read_bytes("all.csv", &size), *line = text;
    const char head[] = "run,time [s],position_north [m],velocity_north [m/s],heading [rad]\n";
    assert_memory_equal(text, head, sizeof head - 1);
    line += sizeof head - 1;
    for (uint64_t run = 0; run < RUNS; run++) {
        for (size_t t = 0; t < TIMES; t++) {
            const char *end = strchr(line, '\n');
            double cell[2 + STATES];
            assert_non_null(end);
            for (size_t k = 0; k < 2 + STATES; k++) {
                const char *after = imk_decimal_parse(line, end, &cell[k]);
                assert_true(after > line && *after == (k < 1 + STATES ? ',' : '\n'));
                line = text + (after - text) + 1;
            }
            check_exact(cell[0], (double)run);
            check_exact(cell[1], times[t]);
            for (size_t k = 0; k < STATES; k++)
                check_exact(cell[2 + k], number_of(run, t * STATES + k));
        }
    }
    assert_true(*line == '\0');
    free(text);
}

/* ---- interrupted ---- */

/* A process that dies at any moment costs at most the runs it had in hand. Each child adds runs in
 * an order of its own until it is killed, and the bytes are those of an undisturbed campaign. */
static void killed_and_restarted(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    compute_shard("whole.h5", &campaign, 0, RUNS);
    uint64_t done = 0;
    for (unsigned life = 0; life < 60; life++) {
        const pid_t child = fork();
        if (child == 0) {
            imk_campaign_writer *writer;
            if (imk_campaign_create("killed.h5", &campaign, 0, RUNS, &writer, NULL) != IMK_OK)
                _exit(1);
            if (imk_campaign_done(writer) < done)
                _exit(2);
            for (uint64_t i = 0; i < RUNS; i++) {
                const uint64_t run = (i * 53 + life) % RUNS; /* 53 and 137 have no common factor */
                if (!imk_campaign_has(writer, run) && add_runs(writer, run, 1, NULL) != IMK_OK)
                    _exit(3);
                usleep(200);
            }
            _exit(imk_campaign_commit(writer, NULL) == IMK_OK ? 0 : 4);
        }
        assert_true(child > 0);
        int status;
        /* Between nothing and most of what the whole takes. */
        usleep(life * 7919 % 30000);
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
        if (access("killed.h5", F_OK) == 0)
            break;
        imk_campaign_writer *writer;
        CHECK_STATUS(imk_campaign_create("killed.h5", &campaign, 0, RUNS, &writer, NULL), IMK_OK);
        assert_true(imk_campaign_done(writer) >= done);
        done = imk_campaign_done(writer);
        imk_campaign_stop(writer);
    }
    assert_true(done > 0);
    compute_shard("killed.h5", &campaign, 0, RUNS);
    check_same_file("killed.h5", "whole.h5");
}

/* Any end of the file, and any damage in it, costs the runs that are hit and nothing else. */
static void a_damaged_part_is_used_as_far_as_it_goes(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    compute_shard("whole.h5", &campaign, 0, RUNS);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
    for (uint64_t run = 0; run < 100; run += 10)
        CHECK_STATUS(add_runs(writer, run, 10, &error), IMK_OK);
    imk_campaign_stop(writer);
    imk_campaign_stop(NULL);
    size_t size;
    unsigned char *bytes = read_bytes("x.h5.part", &size);
    const size_t record = 24 + 10 * RUN_VALUES * sizeof(double), head = size - 10 * record;
    for (size_t trial = 0; trial < 100; trial++) {
        const size_t place = (trial * 7919 + 1) % size;
        if (trial % 2 == 0) {
            write_bytes("x.h5.part", bytes, place);
        } else {
            bytes[place] ^= 0x10;
            write_bytes("x.h5.part", bytes, size);
            bytes[place] ^= 0x10;
        }
        const imk_status status = imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error);
        if (trial % 2 == 1 && place < head) {
            CHECK_STATUS(status, IMK_ERROR_CONFLICT);
            continue;
        }
        CHECK_STATUS(status, IMK_OK);
        const size_t hit = place < head ? 0 : (place - head) / record;
        if (trial % 2 == 0 || (place - head) % record < 24)
            assert_int_equal(imk_campaign_done(writer), 10 * hit);
        else
            assert_int_equal(imk_campaign_done(writer), 90);
        if (trial >= 90) {
            for (uint64_t run = 0; run < RUNS; run++)
                if (!imk_campaign_has(writer, run))
                    CHECK_STATUS(add_runs(writer, run, 1, &error), IMK_OK);
            CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
            check_same_file("x.h5", "whole.h5");
            remove("x.h5");
        } else {
            imk_campaign_stop(writer);
        }
    }
    free(bytes);
}

/* ---- what is on the disk, and when ---- */

/* These stand in for those of the C library, and keep account: s file synced, d directory synced, r
 * renamed, u removed. */
static char events[64];
static double ahead; /* of the clock [s] */

static void note(char event)
{
    const size_t length = strlen(events);
    if (length + 1 < sizeof events)
        events[length] = event;
}

int fsync(int file)
{
    struct stat about;
    note(fstat(file, &about) == 0 && S_ISDIR(about.st_mode) ? 'd' : 's');
    return fdatasync(file);
}

int rename(const char *from, const char *to)
{
    note('r');
    return renameat(AT_FDCWD, from, AT_FDCWD, to);
}

int unlink(const char *path)
{
    note('u');
    return unlinkat(AT_FDCWD, path, 0);
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    struct timeval time;
    (void)clock;
    gettimeofday(&time, NULL);
    const double seconds = (double)time.tv_sec + ahead;
    *now = (struct timespec){.tv_sec = (time_t)seconds, .tv_nsec = 1000 * (long)time.tv_usec};
    return 0;
}

/* A crash of the machine costs the last seconds at most: PATH.part is synced every five, the
 * results file before it gets its name, and PATH.part goes after that. */
static void the_disk_is_never_behind(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, 3, &writer, &error), IMK_OK);
    memset(events, 0, sizeof events);
    CHECK_STATUS(add_runs(writer, 0, 1, &error), IMK_OK);
    assert_string_equal(events, "");
    ahead += 5.5;
    CHECK_STATUS(add_runs(writer, 1, 1, &error), IMK_OK);
    assert_string_equal(events, "s");
    CHECK_STATUS(add_runs(writer, 2, 1, &error), IMK_OK);
    assert_string_equal(events, "s");
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    assert_string_equal(events, "ssrdu");
    /* A run that comes twice is one. */
    CHECK_STATUS(imk_campaign_create("y.h5", &campaign, 0, 3, &writer, &error), IMK_OK);
    CHECK_STATUS(add_runs(writer, 1, 1, &error), IMK_OK);
    CHECK_STATUS(add_runs(writer, 1, 1, &error), IMK_OK);
    assert_int_equal(imk_campaign_done(writer), 1);
    imk_campaign_stop(writer);
}

/* Each byte of the head of a record is under its checksum: what it says of which runs follow is not
 * believed otherwise. It ends the file there, which is cut. */
static void a_damaged_record_head_ends_the_file(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    struct stat about;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
    for (uint64_t run = 0; run < 30; run += 10)
        CHECK_STATUS(add_runs(writer, run, 10, &error), IMK_OK);
    imk_campaign_stop(writer);
    size_t size;
    unsigned char *bytes = read_bytes("x.h5.part", &size);
    const size_t record = 24 + 10 * RUN_VALUES * sizeof(double), second = size - 2 * record;
    for (size_t place = second; place < second + 24; place++) {
        bytes[place] ^= 4;
        write_bytes("x.h5.part", bytes, size);
        bytes[place] ^= 4;
        CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
        assert_int_equal(imk_campaign_done(writer), 10);
        assert_true(imk_campaign_has(writer, 9) && !imk_campaign_has(writer, 14));
        imk_campaign_stop(writer);
        assert_int_equal(stat("x.h5.part", &about), 0);
        assert_int_equal(about.st_size, second);
    }
    free(bytes);
}

static void check_conflict(const imk_campaign *campaign, uint64_t first, uint64_t runs,
                           const char *found)
{
    imk_campaign_writer *writer;
    imk_error error;
    CHECK_STATUS(imk_campaign_create("x.h5", campaign, first, runs, &writer, &error),
                 IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "x.h5.part");
    assert_string_equal(error.found, found);
}

static void a_part_of_another_campaign_is_refused(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign other;
    imk_campaign_writer *writer;
    imk_error error;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 10, 20, &writer, &error), IMK_OK);
    check_conflict(&campaign, 10, 20, "another process is writing this file");
    imk_campaign_stop(writer);
    check_conflict(&campaign, 10, 21, "the file is of the shard of runs 10-29, not 10-30");
    check_conflict(&campaign, 0, RUNS, "the file is of the shard of runs 10-29, not 0-136");
    other = campaign;
    other.seed = 43;
    check_conflict(&other, 10, 20, "the seed is 42, not 43");
    other = campaign;
    other.version = "0.0.9";
    check_conflict(&other, 10, 20, "it was made by imukit " IMK_VERSION ", not 0.0.9");
    other = campaign;
    other.run_count = 200;
    check_conflict(&other, 10, 20, "the campaign has 137 runs, not 200");
    other = campaign;
    other.parameters = "{\"model\": \"AHRS\", \"duration\": 3600, \"yaw\": 0}";
    check_conflict(&other, 10, 20, "a parameter is \"duration\": 86400, not \"duration\": 3600");
    other = campaign;
    other.time_count = TIMES - 1;
    check_conflict(&other, 10, 20, "the times are not the same");
    other = campaign;
    other.state_count = STATES - 1;
    check_conflict(&other, 10, 20, "the states are not the same");
    const char *units[STATES] = {"m", "m/s", "deg"};
    other = campaign;
    other.unit = units;
    check_conflict(&other, 10, 20, "the states are not the same");
    write_bytes("x.h5.part", (const unsigned char *)"a letter, which someone may want to keep", 41);
    check_conflict(&campaign, 10, 20, "the file is not from an interrupted campaign");
    assert_int_equal(access("x.h5.part", F_OK), 0);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    CHECK_STATUS(imk_campaign_create("x.txt", &campaign, 0, RUNS, &writer, &error),
                 IMK_ERROR_FORMAT);
    CHECK_STATUS(imk_campaign_create("no/where.h5", &campaign, 0, RUNS, &writer, &error),
                 IMK_ERROR_OPEN);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, 0, &writer, &error), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 100, 38, &writer, &error), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, RUNS, 1, &writer, &error), IMK_ERROR_RANGE);
    campaign.state_count = 0;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_ERROR_RANGE);
    campaign = make_campaign();
    campaign.time_count = SIZE_MAX / 16;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_ERROR_RANGE);
    assert_int_not_equal(access("x.h5.part", F_OK), 0);
    campaign = make_campaign();
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 10, 10, &writer, &error), IMK_OK);
    CHECK_STATUS(add_runs(writer, 9, 1, &error), IMK_ERROR_RANGE);
    CHECK_STATUS(add_runs(writer, 19, 2, &error), IMK_ERROR_RANGE);
    double values[RUN_VALUES];
    CHECK_STATUS(add_runs(writer, 12, 1, &error), IMK_OK);
    CHECK_STATUS(imk_campaign_read(writer, 12, 1, values, &error), IMK_OK);
    check_exact(values[7], number_of(12, 7));
    CHECK_STATUS(imk_campaign_read(writer, 13, 1, values, &error), IMK_ERROR_EMPTY);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.found, "9 of 10 runs are missing");
    assert_int_equal(access("x.h5.part", F_OK), 0);
}

/* A limit on the size of files takes the place of a full disk: write() fails half-way in the same
 * manner, with another reason. */
static void a_full_disk_loses_nothing(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    compute_shard("whole.h5", &campaign, 0, RUNS);
    size_t size, first_size_read;
    free(read_bytes("whole.h5", &size));
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit before, limit;
    getrlimit(RLIMIT_FSIZE, &before);
    imk_campaign_writer *writer;
    imk_error error;
    imk_status status = IMK_OK;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
    free(read_bytes("x.h5.part", &first_size_read));
    const off_t first_size = (off_t)first_size_read;
    limit = before;
    limit.rlim_cur = size / 2;
    setrlimit(RLIMIT_FSIZE, &limit);
    uint64_t run = 0;
    for (; run < RUNS && status == IMK_OK; run++)
        status = add_runs(writer, run, 1, &error);
    const imk_status again = add_runs(writer, run - 1, 1, &error);
    struct stat about;
    assert_int_equal(stat("x.h5.part", &about), 0);
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK_STATUS(status, IMK_ERROR_WRITE);
    CHECK_STATUS(again, IMK_ERROR_WRITE);
    assert_string_equal(error.field, "x.h5.part");
    assert_string_equal(error.found, strerror(EFBIG));
    assert_in_range(run, RUNS / 4, RUNS / 2 + 1);
    /* What was written of the last one has been given back. */
    const off_t record = 24 + RUN_VALUES * (off_t)sizeof(double);
    assert_int_equal(about.st_size, first_size + (off_t)(run - 1) * record);
    assert_int_equal(imk_campaign_done(writer), run - 1);
    /* Space is there again: in this process, and in the next. */
    CHECK_STATUS(add_runs(writer, run - 1, 1, &error), IMK_OK);
    imk_campaign_stop(writer);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
    assert_int_equal(imk_campaign_done(writer), run);
    for (; run < RUNS; run++)
        CHECK_STATUS(add_runs(writer, run, 1, &error), IMK_OK);
    /* The results file does not fit. */
    setrlimit(RLIMIT_FSIZE, &limit);
    status = imk_campaign_commit(writer, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK_STATUS(status, IMK_ERROR_WRITE);
    assert_string_equal(error.field, "x.h5");
    assert_int_not_equal(access("x.h5", F_OK), 0);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, RUNS, &writer, &error), IMK_OK);
    assert_int_equal(imk_campaign_done(writer), RUNS);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    check_same_file("x.h5", "whole.h5");
}

/* Submitting a job again that was done. */
static void what_is_finished_is_not_computed_again(void **state)
{
    (void)state;
    imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    double values[RUN_VALUES];
    compute_shard("x.h5", &campaign, 40, 20);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 40, 20, &writer, &error), IMK_OK);
    assert_int_equal(imk_campaign_done(writer), 20);
    assert_true(imk_campaign_has(writer, 59) && !imk_campaign_has(writer, 60));
    CHECK_STATUS(imk_campaign_read(writer, 59, 1, values, &error), IMK_OK);
    check_exact(values[3], number_of(59, 3));
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    assert_int_not_equal(access("x.h5.part", F_OK), 0);
    campaign.seed++;
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 40, 20, &writer, &error), IMK_OK);
    assert_int_equal(imk_campaign_done(writer), 0);
    imk_campaign_stop(writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shards_divide_the_runs),
        cmocka_unit_test_teardown(what_is_written_is_read, clean),
        cmocka_unit_test_teardown(csv_has_a_row_per_run_and_time, clean),
        cmocka_unit_test_teardown(killed_and_restarted, clean),
        cmocka_unit_test_teardown(a_damaged_part_is_used_as_far_as_it_goes, clean),
        cmocka_unit_test_teardown(the_disk_is_never_behind, clean),
        cmocka_unit_test_teardown(a_damaged_record_head_ends_the_file, clean),
        cmocka_unit_test_teardown(a_part_of_another_campaign_is_refused, clean),
        cmocka_unit_test_teardown(what_cannot_be_is_refused, clean),
        cmocka_unit_test_teardown(a_full_disk_loses_nothing, clean),
        cmocka_unit_test_teardown(what_is_finished_is_not_computed_again, clean),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
