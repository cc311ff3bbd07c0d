/* SPDX-License-Identifier: Apache-2.0 */
/* Input streams: plain, gzip and zstd content from files, pipes and memory; damage is an error and
 * never a short read. */
#define _POSIX_C_SOURCE 200809L
#define ZLIB_CONST
#include "io/file/input_stream_internal.h"

#include "check.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

enum { TEXT_SIZE = 700001, PACKED_SIZE = 2 * TEXT_SIZE };

static char directory[64];
static char text[TEXT_SIZE];          /* more than two raw buffers when it hardly compresses */
static char packed[PACKED_SIZE + 64]; /* what a test writes to its file */

static const char *path_of(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static void save(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* One gzip member. */
static size_t gzip(const void *bytes, size_t size, char *target)
{
    z_stream z = {0};
    assert_int_equal(deflateInit2(&z, 1, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = bytes;
    z.avail_in = (uInt)size;
    z.next_out = (Bytef *)target;
    z.avail_out = PACKED_SIZE;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    const size_t length = z.total_out;
    deflateEnd(&z);
    return length;
}

/* One zstd frame, with checksum. */
static size_t zstandard(const void *bytes, size_t size, char *target)
{
    ZSTD_CCtx *context = ZSTD_createCCtx();
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    const size_t length = ZSTD_compress2(context, target, PACKED_SIZE, bytes, size);
    assert_false(ZSTD_isError(length));
    ZSTD_freeCCtx(context);
    return length;
}

/* Read to the end in pieces of `step` and compare with the text. @return status of the last read */
static imk_status read_and_compare(imki_input *input, size_t step, size_t *total, imk_error *error)
{
    static char buffer[TEXT_SIZE + 1];
    *total = 0;
    for (;;) {
        size_t got = 12345;
        const imk_status status = imki_input_read(input, buffer, step, &got, error);
        if (status != IMK_OK) {
            assert_int_equal(got, 12345); /* outputs are untouched on error */
            return status;
        }
        assert_true(got <= step);
        if (got == 0)
            return IMK_OK;
        for (size_t done = 0; done < got;) { /* the text repeats */
            const size_t at = *total % TEXT_SIZE;
            const size_t part = got - done < TEXT_SIZE - at ? got - done : TEXT_SIZE - at;
            assert_memory_equal(buffer + done, text + at, part);
            done += part;
            *total += part;
        }
    }
}

static void check_file(const char *path, size_t expected)
{
    static const size_t steps[] = {1000, 65536, 700000};
    for (size_t i = 0; i < 3; i++) {
        imki_input *input;
        imk_error error;
        size_t total, mapped;
        CHECK_OK(imki_input_open(path, &input, &error));
        assert_null(imki_input_mapped(input, &mapped));
        CHECK_OK(read_and_compare(input, steps[i], &total, &error));
        assert_int_equal(total, expected);
        size_t got = 1;
        CHECK_OK(imki_input_read(input, packed, 10, &got, &error)); /* the end stays the end */
        assert_int_equal(got, 0);
        uint64_t done, size;
        imki_input_progress(input, &done, &size);
        struct stat about;
        assert_int_equal(stat(path, &about), 0);
        assert_int_equal(done, size);
        assert_int_equal(size, about.st_size);
        imki_input_close(input);
    }
}

static void plain_file(void **state)
{
    (void)state;
    save(path_of("a.csv"), text, TEXT_SIZE);
    check_file(path_of("a.csv"), TEXT_SIZE);
    for (size_t size = 1; size < 6; size++) { /* shorter than the magic numbers */
        save(path_of("a.csv"), text, size);
        check_file(path_of("a.csv"), size);
    }
}

static void gzip_members_and_padding(void **state)
{
    (void)state;
    size_t size = gzip(text, TEXT_SIZE, packed);
    save(path_of("a.csv"), packed, size); /* recognised by content, not by name */
    check_file(path_of("a.csv"), TEXT_SIZE);

    size = gzip(text, 100, packed); /* members of 100, 0, and all other bytes, then zeros */
    size += gzip(text, 0, packed + size);
    size += gzip(text + 100, TEXT_SIZE - 100, packed + size);
    memset(packed + size, 0, 37);
    save(path_of("a.gz"), packed, size + 37);
    check_file(path_of("a.gz"), TEXT_SIZE);
}

static void zstd_frames(void **state)
{
    (void)state;
    size_t size = zstandard(text, TEXT_SIZE, packed);
    save(path_of("a.zst"), packed, size);
    check_file(path_of("a.zst"), TEXT_SIZE);

    /* a skippable frame of 3 bytes [RFC8878, 3.1.2], then two frames */
    const char skippable[11] = {0x5A, 0x2A, 0x4D, 0x18, 3, 0, 0, 0, 'x', 'y', 'z'};
    memcpy(packed, skippable, sizeof skippable);
    size = sizeof skippable;
    size += zstandard(text, 4321, packed + size);
    size += zstandard(text + 4321, TEXT_SIZE - 4321, packed + size);
    save(path_of("a.zst"), packed, size);
    check_file(path_of("a.zst"), TEXT_SIZE);
}

/* Every cut and every kind of damage is seen, whatever was decoded before.
 * @return how many bytes were delivered before */
static size_t check_damaged(const char *path, size_t size, const char *found)
{
    save(path, packed, size);
    imki_input *input;
    imk_error error = {0};
    size_t total, got;
    CHECK_OK(imki_input_open(path, &input, &error));
    CHECK_STATUS(read_and_compare(input, 65536, &total, &error), IMK_ERROR_COMPRESSED);
    assert_int_equal(error.status, IMK_ERROR_COMPRESSED);
    assert_string_equal(error.field, path);
    if (!strstr(error.found, found))
        fail_msg("\"%s\" does not say \"%s\"", error.found, found);
    char byte;
    CHECK_STATUS(imki_input_read(input, &byte, 1, &got, NULL), IMK_ERROR_COMPRESSED); /* for good */
    imki_input_close(input);
    return total;
}

static void damaged_gzip(void **state)
{
    (void)state;
    const char *path = path_of("damaged.gz");
    const size_t size = gzip(text, TEXT_SIZE, packed);
    check_damaged(path, size - 1, "cut short");
    check_damaged(path, size - 8, "cut short");
    check_damaged(path, size / 2, "cut short");
    check_damaged(path, 12, "cut short");
    check_damaged(path, 5, "cut short");
    check_damaged(path, 2, "cut short");
    packed[size] = 'x';
    check_damaged(path, size + 1, "not gzip");
    packed[size] = 0x1F; /* half a magic number */
    check_damaged(path, size + 1, "not gzip");
    packed[size - 6] ^= 1;
    assert_int_equal(check_damaged(path, size, "data check"), TEXT_SIZE); /* found at the end */
    packed[size - 6] ^= 1;
    packed[size - 2] ^= 1;
    assert_int_equal(check_damaged(path, size, "length check"), TEXT_SIZE);
}

static void damaged_zstd(void **state)
{
    (void)state;
    const char *path = path_of("damaged.zst");
    const size_t size = zstandard(text, TEXT_SIZE, packed);
    check_damaged(path, size - 1, "cut short");
    check_damaged(path, size / 2, "cut short");
    check_damaged(path, 6, "cut short");
    memcpy(packed + size, "junk!", 5);
    check_damaged(path, size + 5, "at byte");
    check_damaged(path, size + 3, "not zstd");
    packed[size - 1] ^= 1;
    check_damaged(path, size, "checksum");
}

/* A frame that ends before the size in its head, by a block without bytes: where there is no room
 * for all of it, libzstd takes it for whole. */
static void short_zstd(void **state)
{
    (void)state;
    static const char head[] = "\x28\xB5\x2F\xFD\x80\0\0\0\x10\0" /* 1 MiB, window of 1 KiB */
                               "\x18\0";                          /* a block of 3 bytes */
    memcpy(packed, head, sizeof head);
    memcpy(packed + sizeof head, text, 3);
    memcpy(packed + sizeof head + 3, "\1\0", 3); /* the last block */
    check_damaged(path_of("damaged.zst"), sizeof head + 6, "the size of the zstd data");
}

/* A damaged frame of the format of 2016: libzstd says that it filled the whole buffer, which it did
 * not touch. */
static void old_zstd(void **state)
{
    (void)state;
    static const char bytes[] = "P*M\x18\4\0\0\0skip"
                                "\x26\xB5\x2F\xFD\x04\x1D\0}\0 ";
    memcpy(packed, bytes, sizeof bytes - 1);
    assert_int_equal(check_damaged(path_of("damaged.zst"), sizeof bytes - 1, "not zstd"), 0);
}

/* Standard input is a pipe that delivers little at a time. */
static void check_pipe(const char *bytes, size_t size, size_t expected)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        for (size_t done = 0; done < size;) {
            const size_t step = done < 4 ? 1 : size - done < 3001 ? size - done : 3001;
            if (write(ends[1], bytes + done, step) != (ssize_t)step)
                _exit(1);
            done += step;
        }
        _exit(0);
    }
    assert_true(child > 0);
    const int saved = dup(STDIN_FILENO);
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    close(ends[1]);
    imki_input *input;
    imk_error error;
    size_t total;
    uint64_t done, file_size;
    CHECK_OK(imki_input_open("-", &input, &error));
    CHECK_OK(read_and_compare(input, 65536, &total, &error));
    assert_int_equal(total, expected);
    imki_input_progress(input, &done, &file_size);
    assert_int_equal(done, size);
    assert_int_equal(file_size, 0);
    imki_input_close(input);
    dup2(saved, STDIN_FILENO); /* also shows that close left standard input open */
    close(saved);
}

static void pipes(void **state)
{
    (void)state;
    check_pipe(text, TEXT_SIZE, TEXT_SIZE);
    check_pipe(packed, gzip(text, TEXT_SIZE, packed), TEXT_SIZE);
    check_pipe(packed, zstandard(text, TEXT_SIZE, packed), TEXT_SIZE);
}

static void memory(void **state)
{
    (void)state;
    imki_input *input;
    imk_error error;
    size_t size = 0, total;
    CHECK_OK(imki_input_open_memory(text, TEXT_SIZE, &input));
    assert_ptr_equal(imki_input_mapped(input, &size), text);
    assert_int_equal(size, TEXT_SIZE);
    CHECK_OK(read_and_compare(input, 999, &total, &error));
    assert_int_equal(total, TEXT_SIZE);
    imki_input_close(input);
    CHECK_OK(imki_input_open_memory(NULL, 0, &input));
    assert_non_null(imki_input_mapped(input, &size));
    assert_int_equal(size, 0);
    CHECK_OK(read_and_compare(input, 999, &total, &error));
    imki_input_close(input);
    imki_input_close(NULL);
}

static void check_refused(const char *path, imk_status status, const char *found)
{
    imki_input *input = NULL;
    imk_error error;
    CHECK_STATUS(imki_input_open(path, &input, &error), status);
    assert_null(input);
    assert_int_equal(error.status, status);
    assert_string_equal(error.field, path);
    assert_string_equal(error.found, found);
    CHECK_STATUS(imki_input_open(path, &input, NULL), status);
}

static void refusals_name_the_reason(void **state)
{
    (void)state;
    check_refused(path_of("missing.csv"), IMK_ERROR_OPEN, strerror(2)); /* ENOENT */
    check_refused(directory, IMK_ERROR_OPEN, "Is a directory");
    save(path_of("empty.csv"), "", 0);
    check_refused(path_of("empty.csv"), IMK_ERROR_EMPTY, "the file is empty");
    check_refused("/dev/null", IMK_ERROR_EMPTY, "the file is empty");
    save(path_of("secret.csv"), "1", 1);
    chmod(path_of("secret.csv"), 0);
    if (access(path_of("secret.csv"), R_OK) != 0) /* root may read everything */
        check_refused(path_of("secret.csv"), IMK_ERROR_OPEN, "Permission denied");
}

/* A frame that needs a window of 2 GiB [RFC8878, 3.1.1.1.2], as of zstd --long=31, is sound. */
static void large_window(void **state)
{
    (void)state;
    const char *path = path_of("a.zst");
    save(path, "\x28\xB5\x2F\xFD\x00\xA8\x01\x00\x00", 9);
    imki_input *input;
    imk_error error = {0};
    char byte;
    size_t got;
    CHECK_OK(imki_input_open(path, &input, &error));
    CHECK_STATUS(imki_input_read(input, &byte, 1, &got, &error), IMK_ERROR_UNSUPPORTED);
    assert_string_equal(error.field, path);
    assert_string_equal(error.found, "the window of the zstd data is larger than 128 MiB");
    imki_input_close(input);
}

/* Text that compresses to about a third, so that the compressed data spans raw buffers. */
static int make_text(void **state)
{
    (void)state;
    uint32_t random = 1;
    for (size_t i = 0; i < TEXT_SIZE; i++) {
        random = 1664525u * random + 1013904223u;
        text[i] = i % 9 == 8 ? '\n' : (char)('0' + (random >> 24) % 10);
    }
    snprintf(directory, sizeof directory, "/tmp/imukit_input_XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    static const char *const names[] = {"a.csv",       "a.gz",       "a.zst",    "damaged.gz",
                                        "damaged.zst", "secret.csv", "empty.csv"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        unlink(path_of(names[i]));
    return rmdir(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_file),   cmocka_unit_test(gzip_members_and_padding),
        cmocka_unit_test(zstd_frames),  cmocka_unit_test(damaged_gzip),
        cmocka_unit_test(damaged_zstd), cmocka_unit_test(short_zstd),
        cmocka_unit_test(old_zstd),     cmocka_unit_test(pipes),
        cmocka_unit_test(memory),       cmocka_unit_test(refusals_name_the_reason),
        cmocka_unit_test(large_window),
    };
    return cmocka_run_group_tests(tests, make_text, remove_directory);
}
