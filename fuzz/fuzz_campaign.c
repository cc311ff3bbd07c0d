/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of what campaigns keep: the first line of a results file, before libhdf5 sees
 * anything of it, the head, and PATH.part. Checksums that a stranger would get right are put right
 * here, so that what stands behind them is reached.
 * Reads: src/io/campaign/campaign_seal.c src/io/campaign/campaign_head.c
 * src/io/campaign/campaign_part.c src/io/file/file_bytes.c */
#define _POSIX_C_SOURCE 200809L
#include "harness.h"

#include "io/campaign/campaign_internal.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RUNS = 5, VALUES = 2, RECORD_HEAD = 24 };

/* ---- results files ---- */

static imk_status verify(const uint8_t *data, size_t size)
{
    imki_seal seal;
    imk_error error = {.status = IMK_OK};
    const int file = open(input_file_put(INPUT_TABLE, data, size), O_RDONLY | O_CLOEXEC);
    require(file >= 0);
    const imk_status status = imki_seal_verify(file, size, &seal, &error);
    require_told(status, &error);
    require(status != IMK_OK || seal.size == size);
    close(file);
    return status;
}

/* As it is; with a line that is right; and with that and a bit of the file turned. */
static void check_seal(const uint8_t *data, size_t size)
{
    (void)verify(data, size);
    const size_t whole = IMKI_SEAL_SIZE + size;
    uint8_t *file = malloc(whole);
    if (!file)
        return;
    imki_seal seal = {whole, 0};
    imki_seal_put(seal, file);
    memcpy(file + IMKI_SEAL_SIZE, data, size);
    seal.crc = imki_crc(0, file, whole);
    imki_seal_put(seal, file);
    require(verify(file, whole) == IMK_OK);
    const uint32_t choice = choice_of(data, size);
    file[choice % whole] ^= (uint8_t)(1u << choice / 7 % 8);
    require(verify(file, whole) != IMK_OK);
    free(file);
}

/* ---- heads ---- */

/* A head that is read is made again from what it says. */
static void check_head(const uint8_t *data, size_t size)
{
    imki_record record, again;
    imk_error error = {.status = IMK_OK};
    uint8_t *head = malloc(size + 1); /* taken over */
    if (!head)
        return;
    memcpy(head, data, size);
    const imk_status status = imki_record_read(head, size, &record, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    if (imki_record_make(&record.campaign, record.runs, record.run, &again, NULL) == IMK_OK) {
        require(again.head_size == size && memcmp(again.head, data, size) == 0);
        require(imki_campaign_compare(&again.campaign, &record.campaign, NULL) == IMK_OK);
        imki_record_free(&again);
    }
    imki_record_free(&record);
}

/* ---- PATH.part ---- */

static imk_status make_own(imki_record *record)
{
    static const double times[1] = {1.0};
    static const char *const states[VALUES] = {"north", "east"}, *const units[VALUES] = {"m", "m"};
    static const uint64_t runs[RUNS] = {3, 4, 5, 6, 7};
    const imk_campaign campaign = {.version = "1",
                                   .parameters = "{}",
                                   .seed = 1,
                                   .run_count = 9,
                                   .time_count = 1,
                                   .time = times,
                                   .state_count = VALUES,
                                   .state = states,
                                   .unit = units};
    return imki_record_make(&campaign, RUNS, runs, record, NULL);
}

/* Put the checksum of a head of each record right, and of every second one's values. */
static void mend_records(uint8_t *bytes, size_t size)
{
    for (size_t at = 0; size - at >= RECORD_HEAD;) {
        uint8_t *head = bytes + at;
        const uint64_t runs = imki_get_number(head + 4, 4);
        const size_t there = size - at - RECORD_HEAD;
        const uint64_t values = runs * VALUES * sizeof(double);
        if (memcmp(head, "RUNS", 4) != 0)
            return;
        if (head[16] % 2 == 0 && values <= there)
            imki_put_number(head + 16, imki_crc(0, head + RECORD_HEAD, (size_t)values), 4);
        imki_put_number(head + 20, imki_crc(0, head, 20), 4);
        at += RECORD_HEAD + (size_t)(values < there ? values : there);
    }
}

/* Open what the bytes left behind: runs found lie within the file, and nothing is found twice. */
static void check_open(const imki_record *own, uint64_t size)
{
    imki_part part;
    uint64_t place[RUNS] = {0};
    imk_error error = {.status = IMK_OK};
    const imk_status status = imki_part_open(FUZZ_FILES "/campaign.h5", own, place, &part, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    for (size_t i = 0; i < RUNS; i++)
        require(place[i] == 0 || (place[i] + part.run_size <= size && place[i] < part.end));
    imki_part_close(&part, false);
}

static void check_part(const uint8_t *data, size_t size)
{
    imki_record own;
    imki_part part;
    uint64_t place[RUNS] = {0};
    if (make_own(&own) != IMK_OK)
        return;
    /* As it is, then behind a head that is right. */
    (void)input_file_put(INPUT_CAMPAIGN_PART, data, size);
    check_open(&own, size);
    (void)input_file_put(INPUT_CAMPAIGN_PART, data, 0);
    require(imki_part_open(FUZZ_FILES "/campaign.h5", &own, place, &part, NULL) == IMK_OK);
    uint8_t *records = malloc(size + 1);
    if (records) {
        memcpy(records, data, size);
        mend_records(records, size);
        require(pwrite(part.file, records, size, (off_t)part.end) == (ssize_t)size);
    }
    const uint64_t end = part.end + size;
    imki_part_close(&part, false);
    check_open(&own, end);
    free(records);
    imki_record_free(&own);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_seal(data, size);
    check_head(data, size);
    check_part(data, size);
    return 0;
}
