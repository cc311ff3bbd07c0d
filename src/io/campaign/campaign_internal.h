/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of campaign.h. Two kinds of file hold the numbers of a campaign:
 *
 *   results file  a line of text with size and CRC-32 (campaign_seal.c), then an HDF5 file that
 *                 ends in the values (campaign_hdf5_write.c, campaign_hdf5_read.c)
 *   PATH.part     a line of text, a plain head (campaign_head.c), records of runs as they come
 *                 (campaign_part.c) */
#ifndef IMUKIT_CAMPAIGN_INTERNAL_H
#define IMUKIT_CAMPAIGN_INTERNAL_H

#include "imukit/campaign.h"

#include "io/file/file_bytes_internal.h"
#include "io/file/hdf5_use_internal.h"

#include <stdio.h>

/* ---- what a file is about: campaign_head.c, campaign_compare.c ---- */

/* A campaign and the numbers of some of its runs, in memory of its own. */
typedef struct imki_record {
    imk_campaign campaign;
    uint64_t runs;
    const uint64_t *run;
    unsigned char *head; /* all of this in one piece; what is above points into it */
    size_t head_size;
    const char **texts; /* where they begin in the head */
} imki_record;

/* Bytes of a run's values. */
uint64_t imki_run_size(const imk_campaign *campaign);
/* @return IMK_ERROR_RANGE (no runs, times or states; names or values beyond what a file can hold),
 *         IMK_ERROR_MEMORY, IMK_ERROR_UNSUPPORTED (a big-endian machine) */
imk_status imki_record_make(const imk_campaign *campaign, uint64_t runs, const uint64_t *run,
                            imki_record *record, imk_error *error);
/* @param head  from malloc(); taken over, also on error
 * @return IMK_ERROR_FORMAT, IMK_ERROR_MEMORY */
imk_status imki_record_read(unsigned char *head, size_t head_size, imki_record *record,
                            imk_error *error);
void imki_record_free(imki_record *record);
/* "No results file": IMK_ERROR_FORMAT. */
imk_status imki_record_refuse(imk_error *error);

/* Say how `other` differs from `campaign`: IMK_ERROR_CONFLICT, or IMK_OK when it does not. */
imk_status imki_campaign_compare(const imk_campaign *other, const imk_campaign *campaign,
                                 imk_error *error);

/* ---- the first line of a results file: campaign_seal.c ---- */

#define IMKI_RESULTS_MAGIC "imukit results " /* begins it */
enum { IMKI_SEAL_SIZE = 512 };               /* bytes: the least user block of HDF5 */

typedef struct imki_seal {
    uint64_t size; /* of the whole file */
    uint32_t crc;  /* CRC-32 of it, its own digits taken as zeros */
} imki_seal;

void imki_seal_put(imki_seal seal, unsigned char block[IMKI_SEAL_SIZE]);
/* Read the line and verify the file. @return as imk_campaign_load(), with error.field "" */
imk_status imki_seal_verify(int file, uint64_t size, imki_seal *seal, imk_error *error);

/* ---- what libhdf5 writes and reads: campaign_hdf5*.c ---- */

/* All of a results file in front of its values, which follow at once: from malloc(). The first
 * IMKI_SEAL_SIZE bytes are the seal's, and zero.
 * @param path  for the error
 * @return IMK_ERROR_MEMORY; IMK_ERROR_WRITE: libhdf5 lays files out in a way of its own */
imk_status imki_hdf5_write(const imki_record *record, const char *path, unsigned char **bytes,
                           size_t *size, imk_error *error);
/* Read what a file is about, after it was verified.
 * @param file    the same, open
 * @param values  where they begin
 * @return IMK_ERROR_FORMAT, IMK_ERROR_VERSION, IMK_ERROR_MEMORY, IMK_ERROR_UNSUPPORTED */
imk_status imki_hdf5_read(const char *path, int file, uint64_t file_size, imki_record *record,
                          uint64_t *values, imk_error *error);

/* ---- results files: campaign_results.c, campaign_store.c ---- */

typedef struct imki_results {
    int file; /* -1: closed */
    imki_record record;
    imki_seal seal;
    uint64_t values; /* where they begin */
} imki_results;

/* Open and verify. error.field is "". @return as imk_campaign_load() */
imk_status imki_results_open(const char *path, imki_results *results, imk_error *error);
/* Close the file for a while, and open and verify it again. @return IMK_ERROR_READ (it is not the
 * same any more), and as imk_campaign_load() */
void imki_results_pause(imki_results *results);
imk_status imki_results_resume(const char *path, imki_results *results, imk_error *error);
/* Runs by their places in the file. @return IMK_ERROR_READ */
imk_status imki_results_read(const imki_results *results, uint64_t place, uint64_t count,
                             double *values, imk_error *error);
void imki_results_close(imki_results *results);

/* Gives `count` runs from place `place` on: [run][time][state]. */
typedef imk_status (*imki_values)(void *context, uint64_t place, uint64_t count, double *values,
                                  imk_error *error);

/* Does the name say what to write? @return IMK_ERROR_FORMAT */
imk_status imki_store_check(const char *path, imk_error *error);
bool imki_store_is_hdf5(const char *path);
imk_status imki_store(const char *path, const imki_record *record, imki_values values,
                      void *context, imk_error *error);

/* ---- PATH.part: campaign_part.c ---- */

typedef struct imki_part {
    int file;
    char *path;
    uint64_t end;      /* of the last whole record */
    uint64_t run_size; /* bytes */
    double synced;     /* when [s] */
} imki_part;

/* Open or make, lock, and find what is there.
 * @param place  for each run of the record, set to where its values lie in the file; 0: not there
 * @return as imk_campaign_create() */
imk_status imki_part_open(const char *path, const imki_record *record, uint64_t *place,
                          imki_part *part, imk_error *error);
/* Add a record. On error the file is as it was.
 * @param at  where the first run's values lie */
imk_status imki_part_add(imki_part *part, uint64_t first, uint64_t runs, const double *values,
                         uint64_t *at, imk_error *error);
/* Close; remove it too when it is not needed any more. */
void imki_part_close(imki_part *part, bool remove_it);

/* The system's reason for a failed imki_read_at(): campaign_seal.c. */
imk_status imki_read_error(int number, const char *field, imk_error *error);

#endif
