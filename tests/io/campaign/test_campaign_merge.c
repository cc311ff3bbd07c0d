/* SPDX-License-Identifier: Apache-2.0 */
/* Merging shards: the bytes of the campaign in one piece, however it was divided, and what is said
 * about files that do not belong. */
#define _DEFAULT_SOURCE
#include "enter_folder.h"
#include "io/campaign_runs.h"

#include <dirent.h>
#include <unistd.h>

static char directory[] = "/tmp/imukit-merge-XXXXXX";

enum { FILES_MAX = 200 };
static char names[FILES_MAX][32];
static const char *paths[FILES_MAX];
static imk_campaign_complaint complaints[FILES_MAX];
static imk_campaign_merge_report report;

/* Nothing here is about crashes of the machine, and some hundred files would wait for the disk. */
int fsync(int file)
{
    (void)file;
    return 0;
}

static int set_up(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    for (size_t i = 0; i < FILES_MAX; i++)
        paths[i] = names[i];
    report.complaint = complaints;
    enter_folder(directory);
    compute_shard("whole.h5", &campaign, 0, RUNS);
    return 0;
}

static int clean(void **state)
{
    (void)state;
    DIR *listing = opendir(".");
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry; entry = readdir(listing))
        if (entry->d_name[0] != '.' && strcmp(entry->d_name, "whole.h5") != 0)
            remove(entry->d_name);
    return listing ? closedir(listing) : -1;
}

static int tear_down(void **state)
{
    (void)state;
    remove("whole.h5");
    return chdir("/") == 0 ? rmdir(directory) : -1;
}

/* Shard i of `count` is file names[i - 1]. */
static void compute_shards(size_t count)
{
    const imk_campaign campaign = make_campaign();
    for (size_t i = 1; i <= count; i++) {
        uint64_t first, runs;
        imk_campaign_shard(RUNS, i, count, &first, &runs);
        snprintf(names[i - 1], sizeof names[0], "s%zu.h5", i);
        compute_shard(names[i - 1], &campaign, first, runs);
    }
}

static imk_status merge(size_t count, bool partial, imk_error *error)
{
    remove("all.h5");
    return imk_campaign_merge(count, paths, "all.h5", partial, &report, error);
}

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

static void any_division_gives_the_same_bytes(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 3, 100};
    imk_error error;
    for (size_t k = 0; k < 3; k++) {
        const size_t count = counts[k];
        compute_shards(count);
        /* In another order: 37 has no factor in common with any of the counts. */
        for (size_t i = 0; i < count; i++)
            paths[i] = names[(i * 37 + 5) % count];
        CHECK_STATUS(merge(count, false, &error), IMK_OK);
        assert_int_equal(report.complaint_count, 0);
        assert_int_equal(report.present, RUNS);
        assert_string_equal(report.missing, "");
        check_same_file("all.h5", "whole.h5");
        for (size_t i = 0; i < count; i++)
            paths[i] = names[i];
    }
}

static void csv_is_that_of_the_campaign_in_one_piece(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_error error;
    compute_shard("whole.csv", &campaign, 0, RUNS);
    compute_shards(3);
    CHECK_STATUS(imk_campaign_merge(3, paths, "all.csv", false, &report, &error), IMK_OK);
    check_same_file("all.csv", "whole.csv");
    CHECK_STATUS(imk_campaign_merge(3, paths, "all.txt", false, &report, &error), IMK_ERROR_FORMAT);
}

static void damage(const char *path, size_t place)
{
    size_t size;
    unsigned char *bytes = read_bytes(path, &size);
    bytes[place < size ? place : size - 1] ^= 1;
    write_bytes(path, bytes, size);
    free(bytes);
}

/* Of 10 shards of 14 or 13 runs one is missing, one is damaged and one is cut short; the first
 * seven shards have 14. */
static void what_is_missing_is_named(void **state)
{
    (void)state;
    imk_error error;
    compute_shards(10);
    remove("s1.h5");
    damage("s4.h5", SIZE_MAX);
    size_t size;
    unsigned char *bytes = read_bytes("s5.h5", &size);
    write_bytes("s5.h5", bytes, size - 100);
    free(bytes);
    CHECK_STATUS(merge(10, false, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.found, "42 of 137 runs are missing");
    assert_false(is_there("all.h5"));
    assert_int_equal(report.complaint_count, 3);
    assert_string_equal(complaints[0].path, "s1.h5");
    CHECK_STATUS(complaints[0].error.status, IMK_ERROR_OPEN);
    assert_string_equal(complaints[1].path, "s4.h5");
    CHECK_STATUS(complaints[1].error.status, IMK_ERROR_READ);
    assert_string_equal(complaints[2].path, "s5.h5");
    assert_non_null(strstr(complaints[2].error.found, "the file is cut short"));
    assert_string_equal(report.missing, "0-13,42-69");
    assert_int_equal(report.shard_count, 10);
    assert_string_equal(report.shards, "1,4-5");
    assert_int_equal(report.run_count, RUNS);
    assert_int_equal(report.present, RUNS - 42);
}

/* A partial merge, and the rest later: shards with gaps between their runs. */
static void a_partial_merge_is_completed(void **state)
{
    (void)state;
    imk_error error;
    compute_shards(10);
    const char *odd[] = {"s1.h5", "s3.h5", "s5.h5", "s7.h5", "s9.h5"};
    CHECK_STATUS(imk_campaign_merge(5, odd, "odd.h5", true, &report, &error), IMK_OK);
    assert_string_equal(report.shards, "2,4,6,8,10");
    imk_campaign_results *r;
    CHECK_STATUS(imk_campaign_load("odd.h5", &r, &error), IMK_OK);
    assert_int_equal(r->runs, 4 * 14 + 13);
    for (uint64_t i = 0; i < r->runs; i++)
        CHECK_CLOSE(r->values[i * RUN_VALUES + 4], number_of(r->run[i], 4), 0.0);
    imk_campaign_free(r);
    /* s1 and s3 are given twice, which does no harm. */
    const char *rest[] = {"s10.h5", "s2.h5", "s4.h5", "s6.h5", "odd.h5", "s8.h5", "s1.h5", "s3.h5"};
    CHECK_STATUS(imk_campaign_merge(8, rest, "all.h5", false, &report, &error), IMK_OK);
    assert_int_equal(report.complaint_count, 0);
    check_same_file("all.h5", "whole.h5");
}

static void other_campaigns_are_left_out(void **state)
{
    (void)state;
    imk_campaign other = make_campaign();
    imk_error error;
    compute_shards(3);
    other.seed = 43;
    compute_shard("a.h5", &other, 0, 46);
    other = make_campaign();
    other.version = "0.0.9";
    compute_shard("b.h5", &other, 46, 46);
    other = make_campaign();
    other.parameters = "{}";
    compute_shard("c.h5", &other, 46, 46);
    /* The stranger comes first; the majority decides. */
    const char *some[] = {"a.h5", "s3.h5", "b.h5", "s1.h5", "c.h5", "s2.h5"};
    CHECK_STATUS(imk_campaign_merge(6, some, "all.h5", false, &report, &error), IMK_OK);
    check_same_file("all.h5", "whole.h5");
    assert_int_equal(report.complaint_count, 3);
    assert_string_equal(complaints[0].path, "a.h5");
    assert_string_equal(complaints[0].error.found, "the seed is 43, not 42");
    assert_string_equal(complaints[1].path, "b.h5");
    assert_string_equal(complaints[1].error.found, "it was made by imukit 0.0.9, not " IMK_VERSION);
    assert_string_equal(complaints[2].path, "c.h5");
    assert_non_null(strstr(complaints[2].error.found, "\"model\": \"AHRS\""));
}

/* Which of two files is right when they do not agree cannot be known. */
static void contradictions_are_left_out(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    double values[RUN_VALUES];
    compute_shards(3);
    CHECK_STATUS(imk_campaign_create("bad.h5", &campaign, 50, 2, &writer, &error), IMK_OK);
    CHECK_STATUS(add_runs(writer, 50, 1, &error), IMK_OK);
    fill_runs(51, 1, values);
    values[RUN_VALUES - 1] += 1e-9;
    CHECK_STATUS(imk_campaign_add(writer, 51, 1, values, &error), IMK_OK);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    snprintf(names[3], sizeof names[0], "bad.h5");
    CHECK_STATUS(merge(4, false, &error), IMK_ERROR_CONFLICT);
    assert_int_equal(report.complaint_count, 2);
    assert_string_equal(complaints[0].error.found, "run 51 has different numbers in another file");
    assert_string_equal(report.missing, "46-91");
    assert_string_equal(report.shards, "2");
    assert_int_equal(report.shard_count, 3);
    /* With a second copy of the right one the campaign is whole. */
    compute_shard("again.h5", &campaign, 40, 60);
    snprintf(names[4], sizeof names[0], "again.h5");
    CHECK_STATUS(merge(5, false, &error), IMK_OK);
    assert_int_equal(report.complaint_count, 2);
    check_same_file("all.h5", "whole.h5");
}

/* A partial merge that reaches furthest but has not the runs two others share does not hide that
 * they do not agree. */
static void contradictions_behind_gaps_are_found(void **state)
{
    (void)state;
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    imk_error error;
    double values[RUN_VALUES];
    compute_shard("first.h5", &campaign, 0, 2);
    compute_shard("last.h5", &campaign, 100, 37);
    const char *ends[] = {"first.h5", "last.h5"};
    CHECK_STATUS(imk_campaign_merge(2, ends, "ends.h5", true, &report, &error), IMK_OK);
    compute_shard("good.h5", &campaign, 0, 60);
    compute_shard("rest.h5", &campaign, 50, 87);
    CHECK_STATUS(imk_campaign_create("bad.h5", &campaign, 20, 1, &writer, &error), IMK_OK);
    fill_runs(20, 1, values);
    values[3] = -values[3];
    CHECK_STATUS(imk_campaign_add(writer, 20, 1, values, &error), IMK_OK);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    const char *some[] = {"ends.h5", "bad.h5", "good.h5", "rest.h5"};
    CHECK_STATUS(imk_campaign_merge(4, some, "all.h5", false, &report, &error), IMK_ERROR_CONFLICT);
    assert_int_equal(report.complaint_count, 2);
    assert_string_equal(complaints[0].error.found, "run 20 has different numbers in another file");
    assert_string_equal(report.missing, "2-49");
    /* And one that does not agree with a partial merge is found with others between them. */
    CHECK_STATUS(imk_campaign_create("odd.h5", &campaign, 120, 1, &writer, &error), IMK_OK);
    fill_runs(120, 1, values);
    values[3] = -values[3];
    CHECK_STATUS(imk_campaign_add(writer, 120, 1, values, &error), IMK_OK);
    CHECK_STATUS(imk_campaign_commit(writer, &error), IMK_OK);
    const char *more[] = {"odd.h5", "good.h5", "ends.h5"};
    CHECK_STATUS(imk_campaign_merge(3, more, "all.h5", false, &report, &error), IMK_ERROR_CONFLICT);
    assert_int_equal(report.complaint_count, 2);
    assert_string_equal(report.missing, "60-136");
}

/* Of as many files of each, the campaign is that of the first given. */
static void the_first_of_equals_counts(void **state)
{
    (void)state;
    imk_campaign other = make_campaign();
    imk_error error;
    compute_shard("a.h5", &other, 0, 70);
    compute_shard("b.h5", &other, 70, 67);
    other.seed = 43;
    compute_shard("c.h5", &other, 0, 70);
    compute_shard("d.h5", &other, 70, 67);
    const char *some[] = {"a.h5", "c.h5", "d.h5", "b.h5"};
    CHECK_STATUS(imk_campaign_merge(4, some, "all.h5", false, &report, &error), IMK_OK);
    check_same_file("all.h5", "whole.h5");
    assert_int_equal(report.complaint_count, 2);
    assert_string_equal(complaints[0].error.found, "the seed is 43, not 42");
}

/* "0-99999,100001-119999,…": 14 characters a piece, from a million on 16, and 1000 have room. With
 * fewer of the first files the list ends at another place. */
static void long_lists_end_in_dots(void **state)
{
    (void)state;
    enum { FILES = 90, SHIFTS = 16 };
    imk_campaign campaign = make_campaign();
    imk_error error;
    campaign.run_count = 2000000;
    for (size_t i = 0; i < FILES; i++) {
        snprintf(names[i], sizeof names[0], "s%zu.h5", i);
        compute_shard(names[i], &campaign, 100000 + 20000 * i, 1);
    }
    for (size_t shift = 0; shift < SHIFTS; shift++) {
        if (check_skips(shift, 4))
            continue;
        CHECK_STATUS(
            imk_campaign_merge(FILES - shift, paths + shift, "all.h5", false, &report, &error),
            IMK_ERROR_CONFLICT);
        char start[64];
        const size_t length = strlen(report.missing);
        snprintf(start, sizeof start, "0-%zu,%zu-%zu,", 99999 + 20000 * shift,
                 100001 + 20000 * shift, 119999 + 20000 * shift);
        assert_memory_equal(report.missing, start, strlen(start));
        assert_in_range(length, sizeof report.missing - 25, sizeof report.missing - 1);
        assert_string_equal(report.missing + length - 5, "9,...");
        assert_int_equal(report.present, FILES - shift);
    }
}

static void nothing_usable(void **state)
{
    (void)state;
    imk_error error;
    snprintf(names[0], sizeof names[0], "nowhere.h5");
    CHECK_STATUS(merge(1, true, &error), IMK_ERROR_EMPTY);
    assert_int_equal(report.complaint_count, 1);
    CHECK_STATUS(merge(0, true, &error), IMK_ERROR_EMPTY);
    /* What a full disk, and what a killed process may leave of a shard. */
    const imk_campaign campaign = make_campaign();
    imk_campaign_writer *writer;
    write_bytes("empty.h5", (const unsigned char *)"", 0);
    CHECK_STATUS(imk_campaign_create("x.h5", &campaign, 0, 2, &writer, &error), IMK_OK);
    imk_campaign_stop(writer);
    const char *some[] = {"empty.h5", "x.h5.part"};
    CHECK_STATUS(imk_campaign_merge(2, some, "all.h5", true, &report, &error), IMK_ERROR_EMPTY);
    assert_string_equal(complaints[0].error.found, "the file is empty");
    assert_string_equal(complaints[1].error.found, "this is the file of an unfinished campaign");
    assert_false(is_there("all.h5"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(any_division_gives_the_same_bytes, clean),
        cmocka_unit_test_teardown(csv_is_that_of_the_campaign_in_one_piece, clean),
        cmocka_unit_test_teardown(what_is_missing_is_named, clean),
        cmocka_unit_test_teardown(a_partial_merge_is_completed, clean),
        cmocka_unit_test_teardown(other_campaigns_are_left_out, clean),
        cmocka_unit_test_teardown(contradictions_are_left_out, clean),
        cmocka_unit_test_teardown(contradictions_behind_gaps_are_found, clean),
        cmocka_unit_test_teardown(the_first_of_equals_counts, clean),
        cmocka_unit_test_teardown(long_lists_end_in_dots, clean),
        cmocka_unit_test_teardown(nothing_usable, clean),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
