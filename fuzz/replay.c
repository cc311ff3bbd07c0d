/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one fuzz entry point without a fuzzer, so that every build and every sanitizer sees it: on
 * each saved input, on what is left of it when it is cut short, and on seeded mutations of it.
 *
 *     fuzz_log fuzz/corpus/log…      files, or directories of files */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { CUTS = 64, MUTATIONS = 256, SIZE_MAX_READ = 1 << 20 };

/* Where an input goes: exactly as large as the input, so that the address sanitizer sees a read
 * one byte too far. */
static void run(const uint8_t *data, size_t size)
{
    uint8_t *copy = malloc(size > 0 ? size : 1);
    if (!copy)
        exit(EXIT_FAILURE);
    if (size > 0)
        memcpy(copy, data, size);
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

/* xorshift64 [MARSAGLIA2003]: a fixed sequence is all that is needed here. */
static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Bytes that matter to the formats read here. */
static const char interesting[] = "0123456789.,;:-+eE#\"'[]{}()\n\r\t &*!%@`|<>/^\\\xff\x80\xb1";

static void run_mutations(uint8_t *data, size_t size)
{
    uint64_t state = 0x9E3779B97F4A7C15u ^ size;
    const int share = getenv("IMUKIT_TEST_RUNS") ? 4 : 1; /* under sanitizers: tests/check.h */
    for (int i = 0; i < CUTS / share; i++)
        run(data, next_random(&state) % (size + 1));
    for (int i = 0; i < MUTATIONS / share; i++) {
        size_t place = next_random(&state) % size;
        uint8_t kept = data[place];
        uint64_t draw = next_random(&state);
        data[place] = draw % 4 == 0 ? (uint8_t)(draw >> 8)
                                    : (uint8_t)interesting[(draw >> 8) % sizeof interesting];
        run(data, size);
        if (i % 8 != 0) /* now and then a change stays, and they add up */
            data[place] = kept;
    }
}

static size_t run_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *data = malloc(SIZE_MAX_READ);
    if (!file || !data) {
        perror(path);
        exit(EXIT_FAILURE);
    }
    size_t size = fread(data, 1, SIZE_MAX_READ, file);
    fclose(file);
    run(data, size);
    if (size > 0)
        run_mutations(data, size);
    free(data);
    return 1;
}

static size_t run_directory(const char *path)
{
    size_t count = 0;
    DIR *directory = opendir(path);
    if (!directory)
        return 0;
    for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
        char file[4096];
        struct stat status;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        if (stat(file, &status) == 0 && S_ISREG(status.st_mode))
            count += run_file(file);
    }
    closedir(directory);
    return count;
}

int main(int argc, char **argv)
{
    size_t count = 0;
    for (int i = 1; i < argc; i++) {
        struct stat status;
        if (stat(argv[i], &status) == 0 && S_ISDIR(status.st_mode))
            count += run_directory(argv[i]);
        else
            count += run_file(argv[i]);
    }
    printf("%zu inputs, each with up to %d cuts and %d mutations\n", count, CUTS, MUTATIONS);
    return count > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
