/* SPDX-License-Identifier: Apache-2.0 */
/* Bags of the reference programs (tests/fixtures) in which a byte of the head of any record is
 * another: the rows that come are rows that were written, to the last bit; no more are missing than
 * the record holds; and whenever one is, this is told. The same from memory and from pipes. */
#define _POSIX_C_SOURCE 200809L
#include "bag_files.h"

#include "io/log/ros/ros_bytes_internal.h"

#include <sys/wait.h>

enum { SAMPLES = 10, RECORDS_MAX = 64 };

/* ---- the records of a file ---- */

/* A record outside of chunks. */
typedef struct record {
    size_t at, head; /* of a chunk, the head is all but the records in it */
    size_t rows;     /* in it */
    bool defines;    /* topics are defined in it */
} record;

typedef struct file {
    size_t size, count;
    record record[RECORDS_MAX];
} file;

static bool has(const char *at, size_t size, const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i + length <= size; i++)
        if (memcmp(at + i, text, length) == 0)
            return true;
    return false;
}

static void add(file *f, size_t at, size_t head, size_t rows, bool defines)
{
    assert_true(f->count < RECORDS_MAX);
    f->record[f->count++] = (record){at, head, rows, defines};
}

/* @param rows  of each chunk; NULL: messages stand alone */
static void walk_mcap(const char *bytes, const size_t *rows, file *f)
{
    enum { MAGIC = 8, HEAD = 9, TEXT = HEAD + 28, IMU = 300 };
    bool first = true;
    for (size_t at = MAGIC; at + HEAD + MAGIC <= f->size;) {
        const uint8_t *head = (const uint8_t *)bytes + at;
        const size_t size = (size_t)imki_get_u64(head + 1);
        const bool chunk = head[0] == 6, message = head[0] == 5;
        if (chunk) {
            add(f, at, TEXT + 4 + imki_get_u32(head + TEXT) + 8, *rows++, first);
            first = false;
        } else {
            add(f, at, HEAD, message && size > IMU, head[0] == 3 || head[0] == 4);
        }
        at += HEAD + size;
    }
}

static void walk_bag(const char *bytes, const size_t *rows, file *f)
{
    enum { MAGIC = 13 };
    bool first = true;
    for (size_t at = MAGIC; at < f->size;) {
        const size_t header = imki_get_u32((const uint8_t *)bytes + at);
        const size_t size = imki_get_u32((const uint8_t *)bytes + at + 4 + header);
        const char *fields = bytes + at + 4, *data = fields + header + 4;
        const bool chunk = has(fields, header, "op=\5"), message = has(fields, header, "op=\2");
        add(f, at, 8 + header, chunk ? *rows++ : message && has(data, size, "sensor"),
            (chunk && first) || has(fields, header, "op=\7"));
        first &= !chunk;
        at += 8 + header + size;
    }
}

/* ---- what comes of it ---- */

/* What is damaged, and how it is read. */
typedef struct damage {
    const file *of;
    size_t record;
    bool defines; /* topics, which are told nowhere else */
    bool last;    /* a length beyond the end is that of a file that is cut short */
    char where[128];
} damage;

/* @return the row as it was written, by its rate about x, which is 0.001 times its number
 * (experiments/formats/samples.py); the time counts from the first row that came */
static size_t check_row(const bag_table *t, size_t i, size_t first)
{
    const size_t row = (size_t)(t->data[1][i] * 1000.0 + 0.5);
    assert_true(row < SAMPLES);
    for (size_t c = 1; c < 7; c++) {
        const double axis = (double)((c - 1) % 3);
        const double due =
            c < 4 ? (double)row * 0.001 + axis * 0.1 : (double)row * -0.01 + axis * 9.80665;
        assert_true(t->data[c][i] == due);
    }
    first = i == 0 ? row : first;
    assert_true(row >= first);
    assert_true(t->data[0][i] == (double)((int64_t)(row - first) * 5000001) / 1e9);
    return row;
}

/* The rows that are missing are those of the record, or fewer. */
static void check_table(const damage *d, const bag_table *t)
{
    size_t begin = 0, first = 0, next = 0, missing = 0;
    for (size_t r = 0; r < d->record; r++)
        begin += d->of->record[r].rows;
    const size_t end = begin + d->of->record[d->record].rows;
    for (size_t i = 0; i <= t->rows; i++) {
        const size_t row = i < t->rows ? check_row(t, i, first) : SAMPLES;
        first = i == 0 ? row : first;
        assert_true(i == t->rows || row >= next);
        for (; next < row; next++, missing++)
            if (!d->defines && (next < begin || next >= end))
                fail_msg("%s: row %zu is missing", d->where, next);
        next++;
    }
    if (missing > 0 && t->findings.damaged == 0 && !(d->last && t->findings.cut_short))
        fail_msg("%s: %zu rows are missing and nothing is told", d->where, missing);
    if (t->findings.cut_short && !d->last)
        fail_msg("%s: the log is said to be cut short", d->where);
}

static imk_status read_pipe(const char *bytes, size_t size, bag_table *t, imk_error *error)
{
    int ends[2];
    char path[64];
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        close(ends[0]);
        for (ssize_t done = 1; size > 0 && done > 0; bytes += done, size -= (size_t)done)
            done = write(ends[1], bytes, size);
        _exit(0);
    }
    close(ends[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    const imk_status status = bag_load(path, NULL, t, error);
    close(ends[0]);
    assert_int_equal(waitpid(child, NULL, 0), child);
    return status;
}

static imk_status read_short_pipe(const char *bytes, size_t size, bag_table *t, imk_error *error)
{
    int ends[2];
    char path[64];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], bytes, size), size); /* less than a pipe holds */
    close(ends[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    const imk_status status = bag_load(path, NULL, t, error);
    close(ends[0]);
    return status;
}

static imk_status read_memory(const char *bytes, size_t size, bag_table *t, imk_error *error)
{
    imk_log_reader *reader = NULL;
    imk_status status = imk_log_open_memory(bytes, size, NULL, &reader, error);
    t->rows = 0;
    if (status == IMK_OK)
        status = bag_read(reader, 4, t, error);
    imk_log_close(reader);
    return status;
}

/* ---- heads of records ---- */

typedef struct sample_file {
    const char *name;
    size_t rows[3]; /* of its chunks: counted in those that are not compressed */
    bool indexed;
} sample_file;

static const sample_file files[] = {
    {"cdr_none.mcap", {3, 6, 1}, true}, {"cdr_zstd.mcap", {3, 6, 1}, true},
    {"unchunked.mcap", {0}, true},      {"no_summary.mcap", {3, 6, 1}, false},
    {"none.bag", {1, 6, 3}, true},      {"lz4.bag", {1, 6, 3}, true},
    {"outside.bag", {0}, false},
};
enum { FILES = sizeof files / sizeof files[0] };

static char *load(const char *name, const size_t *rows, file *f)
{
    char path[256];
    snprintf(path, sizeof path, BAGS "%s", name);
    f->count = 0;
    char *bytes = bag_bytes(path, &f->size);
    (strstr(name, ".mcap") ? walk_mcap : walk_bag)(bytes, rows, f);
    size_t all = 0;
    for (size_t r = 0; r < f->count; r++)
        all += f->record[r].rows;
    assert_int_equal(all, SAMPLES);
    return bytes;
}

/* Is it a byte of the number of the topic of a message? One that is another topic's is no fault
 * that can be seen. */
static bool is_topic(const char *bytes, const record *of, size_t i)
{
    const char *at = bytes + of->at + i;
    for (size_t k = 5; k < 9 && k <= i && of->rows == 1; k++)
        if (memcmp(at - k, "conn=", 5) == 0)
            return true;
    return false;
}

/* @return whether rows are missing */
static bool check_head(const sample_file *of, const char *bytes, const damage *d, bool from_pipe)
{
    static bag_table t;
    imk_error error = {.status = IMK_OK};
    const imk_status status = from_pipe ? read_short_pipe(bytes, d->of->size, &t, &error)
                                        : read_memory(bytes, d->of->size, &t, &error);
    if (status == IMK_OK)
        check_table(d, &t);
    else if (status != IMK_ERROR_EMPTY || !d->defines || error.found[0] == '\0')
        fail_msg("%s of %s: %s", d->where, of->name, error.found);
    return status != IMK_OK || t.rows < SAMPLES;
}

static void test_heads(void **state)
{
    (void)state;
    static const uint8_t patterns[] = {0xFF, 0x01, 0x04, 0x10, 0x80, 0x55};
    enum { PATTERNS = sizeof patterns };
    for (size_t k = 0; k < FILES; k++) {
        file f;
        char *bytes = load(files[k].name, files[k].rows, &f);
        const bool bag = !strstr(files[k].name, ".mcap");
        size_t lost = 0, tried = 0;
        for (size_t r = 0; r < f.count; r++)
            for (size_t i = 0; i < PATTERNS * f.record[r].head; i++) {
                char *at = &bytes[f.record[r].at + i / PATTERNS];
                const uint8_t pattern = patterns[i % PATTERNS];
                const bool from_pipe = tried++ % 2 == 1;
                if (check_skips(tried, 13) || (bag && is_topic(bytes, &f.record[r], i / PATTERNS)))
                    continue;
                damage d = {.of = &f, .record = r};
                d.defines = f.record[r].defines && (from_pipe || !files[k].indexed);
                /* The head of a bag says where its index is. */
                d.last = bag && (r == 0 || r + 1 == f.count);
                snprintf(d.where, sizeof d.where, "%s: record %zu at %zu, byte %zu ^ %02x%s",
                         files[k].name, r, f.record[r].at, i / PATTERNS, pattern,
                         from_pipe ? ", from a pipe" : "");
                *at ^= (char)pattern;
                lost += check_head(&files[k], bytes, &d, from_pipe);
                *at ^= (char)pattern;
            }
        assert_true(lost > 0);
        free(bytes);
    }
}

/* ---- long logs ---- */

enum { ROWS = 5000 };

static double data[BAG_COLUMNS][ROWS];

static size_t write_rows(const char *path, char **bytes)
{
    static const char *const names[BAG_COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                                   "accel_x", "accel_y", "accel_z"};
    imk_log_column columns[BAG_COLUMNS];
    const double *from[BAG_COLUMNS];
    imk_log_writer *writer;
    imk_error error;
    uint64_t random = 5;
    size_t size;
    for (size_t c = 0; c < BAG_COLUMNS; c++) {
        columns[c] = imk_record_column(names[c]);
        from[c] = data[c];
        for (size_t i = 0; i < ROWS; i++) {
            random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            data[c][i] = c == 0 ? (double)i / 256 : (double)(int64_t)random * 0x1p-60;
        }
    }
    CHECK_OK(
        imk_log_create(path, BAG_COLUMNS, columns, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
    CHECK_OK(imk_log_write(writer, ROWS, from, NULL));
    CHECK_OK(imk_log_commit(writer, &error));
    *bytes = bag_bytes(path, &size);
    return size;
}

/* The place of the second chunk, which ours write each with its index behind it. */
static size_t second_chunk(const char *bytes, size_t size, bool bag)
{
    static size_t rows[RECORDS_MAX];
    file f = {.size = size};
    (bag ? walk_bag : walk_mcap)(bytes, rows, &f);
    size_t chunks = 0, r = 0;
    for (; r < f.count && chunks < 2; r++)
        chunks += bag ? has(bytes + f.record[r].at + 4, f.record[r].head, "op=\5")
                      : bytes[f.record[r].at] == 6;
    assert_int_equal(chunks, 2);
    return f.record[r - 1].at;
}

/* Rows are those written, but for one gap if the second chunk cannot be had. @return the gap */
static size_t check_gap(const bag_table *t)
{
    const size_t gap = ROWS - t->rows;
    size_t first = 0;
    while (first < t->rows && t->data[0][first] == data[0][first])
        first++;
    for (size_t i = 0; i < t->rows; i++)
        for (size_t c = 0; c < BAG_COLUMNS; c++)
            assert_true(t->data[c][i] == data[c][i + (i < first ? 0 : gap)]);
    assert_true(gap == 0 || (first > 0 && first < t->rows)); /* in the middle */
    return gap;
}

/* The head of a chunk of hundreds of kilobytes: the search goes beyond what a step of it has at
 * hand. A plain chunk without its head still shows its messages to a pipe. */
static void test_long_logs(void **state)
{
    (void)state;
    static const char *const endings[] = {".mcap", ".bag"};
    static const size_t bytes_of[] = {1, 7}; /* of the length; of the length of a field */
    static bag_table t;
    for (int bag = 0; bag < 2; bag++) {
        char path[256], *bytes;
        imk_error error;
        const size_t size = write_rows(bag_path(endings[bag], path), &bytes);
        const size_t at = second_chunk(bytes, size, bag);
        bytes[at + bytes_of[bag]] ^= 0x55;
        bag_save(path, bytes, size);
        CHECK_OK(bag_load(path, NULL, &t, &error));
        assert_true(check_gap(&t) > 1000);
        assert_int_equal(t.findings.damaged, 1);
        assert_false(t.findings.cut_short);
        CHECK_OK(read_pipe(bytes, size, &t, &error));
        assert_true(bag ? check_gap(&t) == 0 : check_gap(&t) > 1000);
        assert_int_equal(t.findings.damaged, 1);
        assert_false(t.findings.cut_short);
        remove(path);
        free(bytes);
    }
}

/* ---- MCAP ---- */

/* A value of a message outside of chunks: the CRC-32 of the data tells, and the row is kept. */
static void test_data_crc(void **state)
{
    (void)state;
    static const size_t none[1];
    static bag_table t;
    imk_error error;
    file f;
    char *bytes = load("unchunked.mcap", none, &f);
    size_t last = 0;
    for (size_t r = 0; r < f.count; r++)
        last = f.record[r].rows > 0 ? f.record[r].at : last;
    bytes[last + 200] ^= 1; /* in its first covariance */
    for (int from_pipe = 0; from_pipe < 2; from_pipe++) {
        CHECK_OK((from_pipe ? read_short_pipe : read_memory)(bytes, f.size, &t, &error));
        assert_int_equal(t.rows, SAMPLES);
        assert_int_equal(t.findings.damaged, 1);
        assert_int_equal(t.findings.first_damaged, SAMPLES);
    }
    free(bytes);
}

/* `count` bytes more at a place. */
static char *insert(const char *bytes, size_t *size, size_t at, const void *what, size_t count)
{
    char *longer = malloc(*size + count);
    assert_non_null(longer);
    memcpy(longer, bytes, at);
    memcpy(longer + at, what, count);
    memcpy(longer + at + count, bytes + at, *size - at);
    *size += count;
    return longer;
}

/* Records of kinds that are not known, and members behind those that are, are no damage. */
static void test_extensions(void **state)
{
    (void)state;
    static const uint8_t own[] = {0x80, 5, 0, 0, 0, 0, 0, 0, 0, 'a', 'b', 'c', 'd', 'e'};
    static bag_table t;
    for (int member = 0; member < 2; member++) {
        imk_error error;
        file f;
        char *bytes = load("no_summary.mcap", files[3].rows, &f);
        size_t size = f.size;
        const size_t at = f.record[1].at;
        char *longer = insert(bytes, &size, member ? f.record[2].at : at, own, sizeof own);
        if (member)
            imki_put_u64((uint8_t *)longer + at + 1,
                         imki_get_u64((uint8_t *)bytes + at + 1) + sizeof own);
        for (int from_pipe = 0; from_pipe < 2; from_pipe++) {
            CHECK_OK((from_pipe ? read_short_pipe : read_memory)(longer, size, &t, &error));
            assert_int_equal(t.rows, SAMPLES);
            assert_int_equal(t.findings.damaged, 0);
        }
        free(longer);
        free(bytes);
    }
}

/* If no chunk can be unpacked, the reason is that of the first. */
static void test_unknown_packing(void **state)
{
    (void)state;
    static bag_table t;
    imk_error error;
    file f;
    char *bytes = load("no_summary.mcap", files[3].rows, &f);
    for (size_t r = 0; r < f.count; r++)
        if (f.record[r].rows > 0)
            memcpy(bytes + f.record[r].at + 41, "rare", 4);
    CHECK_STATUS(read_memory(bytes, f.size, &t, &error), IMK_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.found, "compressed by \"rare\""));
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heads),           cmocka_unit_test(test_long_logs),
        cmocka_unit_test(test_data_crc),        cmocka_unit_test(test_extensions),
        cmocka_unit_test(test_unknown_packing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
