/* SPDX-License-Identifier: Apache-2.0 */
/** @file campaign.h
 *  Monte Carlo campaigns divided among processes: shards, kept in files that survive a killed
 *  process, and their merging. Part of libimukit-io.
 *
 *  A campaign is a number of runs; each run gives the same bytes wherever it is computed. A shard
 *  is a consecutive part of the runs. The merged file does not depend on how the campaign was
 *  divided. Format: docs/campaign-file.md.
 *
 *  Results files (.h5) are written and read by libhdf5, whose serial form allows one thread at a
 *  time. The functions of this header ensure that among themselves. A program that uses libhdf5
 *  itself must not do so on another thread during imk_campaign_create(), _commit(), _load() and
 *  _merge(). */
#ifndef IMUKIT_CAMPAIGN_H
#define IMUKIT_CAMPAIGN_H

#include "imukit/output_file.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Everything on which the numbers of a campaign depend, and their shape. Arrays and texts belong
 *  to the caller. */
typedef struct imk_campaign {
    const char *version;    /**< version of the program that computes: IMK_VERSION */
    const char *parameters; /**< everything else on which the numbers depend (model, motion,
                               settings), as JSON text; two campaigns are the same when all members
                               of this structure are equal */
    uint64_t seed;
    uint64_t run_count;       /**< of the whole campaign, >= 1 */
    size_t time_count;        /**< >= 1 */
    const double *time;       /**< [s] */
    size_t state_count;       /**< numbers per run and time */
    const char *const *state; /**< their names, "position_north" */
    const char *const *unit;  /**< their units, "m" */
} imk_campaign;

/** First run and number of runs of shard `index` (1 … count). The numbers differ by at most one
 *  between shards. */
IMK_API void imk_campaign_shard(uint64_t run_count, uint64_t index, uint64_t count, uint64_t *first,
                                uint64_t *runs);

/* ---- computing ---------------------------------------------------------------------------------
 */

/** A results file in the making. Runs may be added in any order. They are kept in PATH.part and
 *  found again after a killed process. */
typedef struct imk_campaign_writer imk_campaign_writer;

/** Start a results file, or continue where a killed process stopped. If PATH is already the
 *  complete, undamaged results file (.h5) of this campaign and shard, all runs are present and
 *  nothing is left to do, so submitting a job again costs nothing.
 *  @param path        ending in .h5 or .csv (.csv.gz, .csv.zst)
 *  @param first,runs  the shard
 *  @return IMK_ERROR_CONFLICT (PATH.part belongs to another campaign, seed, version or shard:
 *          error.found says which; or another process is writing it), IMK_ERROR_OPEN,
 *          IMK_ERROR_READ, IMK_ERROR_FORMAT (another ending), IMK_ERROR_RANGE, IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_create(const char *path, const imk_campaign *campaign,
                                       uint64_t first, uint64_t runs, imk_campaign_writer **writer,
                                       imk_error *error);
/** Number of runs of the shard that are already present. */
IMK_API uint64_t imk_campaign_done(const imk_campaign_writer *writer);
/** True when run `run` (numbered in the campaign) is present. */
IMK_API bool imk_campaign_has(const imk_campaign_writer *writer, uint64_t run);
/** Read runs that are present, such as those left by a killed process.
 *  @param values  [run][time][state]
 *  @return IMK_ERROR_EMPTY (a run is not present), IMK_ERROR_READ */
IMK_API imk_status imk_campaign_read(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                                     double *values, imk_error *error);
/** Add runs first … first + runs - 1: [run][time][state]. Thread-safe. They are written at once and
 *  synced every few seconds.
 *  @return IMK_ERROR_WRITE (such as a full disk; earlier runs stay usable) */
IMK_API imk_status imk_campaign_add(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                                    const double *values, imk_error *error);
/** Write the results file, complete or not at all, remove PATH.part, and free the writer. After an
 *  error PATH.part remains, so nothing is lost.
 *  @return IMK_ERROR_CONFLICT (runs are missing), IMK_ERROR_WRITE */
IMK_API imk_status imk_campaign_commit(imk_campaign_writer *writer, imk_error *error);
/** Stop without a results file; PATH.part remains, to be continued later. Frees the writer; NULL is
 *  allowed. */
IMK_API void imk_campaign_stop(imk_campaign_writer *writer);

/* ---- reading and merging ------------------------------------------------------------------------
 */

/** Results in memory. */
typedef struct imk_campaign_results {
    imk_campaign campaign; /**< texts and arrays are owned by these results */
    uint64_t runs;         /**< number of runs present */
    /** Numbers of these runs, increasing; consecutive except after a partial merge. */
    const uint64_t *run;
    const double *values; /**< [run][time][state] */
} imk_campaign_results;

/** Read a results file (.h5): whole, a shard, or a partial merge. Its checksum is verified.
 *  @return IMK_ERROR_OPEN, IMK_ERROR_FORMAT (no results file), IMK_ERROR_VERSION (of the format),
 *          IMK_ERROR_READ (damaged or cut short: error.found says which), IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_load(const char *path, imk_campaign_results **results,
                                     imk_error *error);
/** Free results; NULL is allowed. */
IMK_API void imk_campaign_free(imk_campaign_results *results);

/** A fault of one file of a merge. */
typedef struct imk_campaign_complaint {
    const char *path; /**< name of the file, which belongs to the caller */
    imk_error error;
} imk_campaign_complaint;

/** Outcome of a merge. */
typedef struct imk_campaign_merge_report {
    imk_campaign_complaint *complaint; /**< room for one per path; belongs to the caller */
    size_t complaint_count;
    uint64_t run_count, present; /**< runs of the campaign, and how many of them are present */
    uint64_t shard_count;        /**< N when every good file is a shard i/N of the same N; or 0 */
    char missing[1000];          /**< missing runs, counted from 0: "17-32,65"; "" when complete */
    /** Shards i of N that contain the missing runs, counted from 1: "3,17-19". */
    char shards[1000];
} imk_campaign_merge_report;

/** Merge shards, given in any order, into one results file. It has the same bytes as that of the
 *  campaign computed in one piece.
 *
 *  Each unusable file is reported in `complaint`; the others are used. Unusable are damaged files;
 *  files of another campaign, seed or version than most of the good ones (of equal numbers the
 *  first counts); and files that contradict each other about a run (both, as it is not known which
 *  is right). When runs are missing, nothing is written unless `partial`. Long lists end in "...".
 *  @param output  ending in .h5 or .csv (.csv.gz, .csv.zst)
 *  @return IMK_OK; IMK_ERROR_CONFLICT (runs are missing, and `partial` is false), IMK_ERROR_EMPTY
 *          (no usable file), IMK_ERROR_FORMAT (ending of the output), IMK_ERROR_OPEN,
 *          IMK_ERROR_WRITE, IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_merge(size_t count, const char *const *paths, const char *output,
                                      bool partial, imk_campaign_merge_report *report,
                                      imk_error *error);

IMK_END_C
#endif
