/* SPDX-License-Identifier: Apache-2.0 */
/** @file campaign.h
 *  Monte Carlo beyond one process: shards of a campaign on files that survive being killed, and
 *  their merging. Part of libimukit-io.
 *
 *  A campaign is a number of runs, each of which gives the same bytes wherever it is computed. A
 *  shard is a consecutive part of them. The merged file is the same, byte for byte, however the
 *  campaign was divided. Format: docs/campaign-file.md.
 *
 *  Results files (.h5) are made and read by libhdf5, in whose serial form only one thread may be at
 *  a time. Calls of this header keep to that among themselves; a program that uses libhdf5 on
 *  other threads must not do so during imk_campaign_create(), _commit(), _load() and _merge(). */
#ifndef IMUKIT_CAMPAIGN_H
#define IMUKIT_CAMPAIGN_H

#include "imukit/output_file.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** What the numbers of a campaign depend on, and their shape. Arrays and texts are the caller's. */
typedef struct imk_campaign {
    const char *version;    /**< of the program that computes: IMK_VERSION */
    const char *parameters; /**< everything else that the numbers depend on (model, motion,
                                 settings), as JSON text of the caller's; two campaigns are the same
                                 when all of this is */
    uint64_t seed;
    uint64_t run_count;       /**< of the whole campaign, >= 1 */
    size_t time_count;        /**< >= 1 */
    const double *time;       /**< [s] */
    size_t state_count;       /**< numbers per run and time */
    const char *const *state; /**< their names, "position_north" */
    const char *const *unit;  /**< and units, "m" */
} imk_campaign;

/** Runs of shard `index` (1 … count): consecutive, differing by at most one between shards. */
IMK_API void imk_campaign_shard(uint64_t run_count, uint64_t index, uint64_t count, uint64_t *first,
                                uint64_t *runs);

/* ---- computing ---------------------------------------------------------------------------------
 */

/** A results file being made. Runs may arrive in any order; what has arrived is kept beside the
 *  file, in PATH.part, and found again after the process was killed. */
typedef struct imk_campaign_writer imk_campaign_writer;

/** Start, or go on where a killed process stopped. When PATH is already the results file (.h5) of
 *  this campaign and shard, whole and undamaged, all runs are there and there is nothing to do, so
 *  that submitting a job again costs nothing.
 *  @param path   ending in .h5 or .csv (.csv.gz, .csv.zst)
 *  @param first,runs  the shard
 *  @return IMK_ERROR_CONFLICT (PATH.part belongs to another campaign, seed, version or shard:
 *          error.found says which; or another process is writing it), IMK_ERROR_OPEN,
 *          IMK_ERROR_READ, IMK_ERROR_FORMAT (another ending), IMK_ERROR_RANGE, IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_create(const char *path, const imk_campaign *campaign,
                                       uint64_t first, uint64_t runs, imk_campaign_writer **writer,
                                       imk_error *error);
/** Runs of the shard that are there already. */
IMK_API uint64_t imk_campaign_done(const imk_campaign_writer *writer);
/** True when run `run` (a number of the campaign) is there. */
IMK_API bool imk_campaign_has(const imk_campaign_writer *writer, uint64_t run);
/** Numbers of runs that are there, such as those a killed process had left: [run][time][state].
 *  @return IMK_ERROR_EMPTY (one of them is not there), IMK_ERROR_READ */
IMK_API imk_status imk_campaign_read(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                                     double *values, imk_error *error);
/** Add runs first … first + runs - 1: [run][time][state]. Thread-safe. Kept on disk at once; synced
 *  every few seconds.
 *  @return IMK_ERROR_WRITE (a full disk: what was there before stays usable) */
IMK_API imk_status imk_campaign_add(imk_campaign_writer *writer, uint64_t first, uint64_t runs,
                                    const double *values, imk_error *error);
/** Write the results file, complete or not at all, remove PATH.part, and free the writer. On error
 *  PATH.part stays, so that nothing is lost.
 *  @return IMK_ERROR_CONFLICT (runs are missing), IMK_ERROR_WRITE */
IMK_API imk_status imk_campaign_commit(imk_campaign_writer *writer, imk_error *error);
/** Stop for now: PATH.part stays. Frees the writer; NULL is allowed. */
IMK_API void imk_campaign_stop(imk_campaign_writer *writer);

/* ---- reading and merging ------------------------------------------------------------------------
 */

/** Results in memory. */
typedef struct imk_campaign_results {
    imk_campaign campaign; /**< texts and arrays are owned by these results */
    uint64_t runs;         /**< that are there */
    const uint64_t *run;   /**< their numbers, increasing; consecutive but in a partial merge */
    const double *values;  /**< [run][time][state] */
} imk_campaign_results;

/** Read a results file (.h5): whole, a shard, or a partial merge. Its checksum is verified.
 *  @return IMK_ERROR_OPEN, IMK_ERROR_FORMAT (no results file), IMK_ERROR_VERSION (of the format),
 *          IMK_ERROR_READ (damaged or cut short: error.found says which), IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_load(const char *path, imk_campaign_results **results,
                                     imk_error *error);
/** Free results; NULL is allowed. */
IMK_API void imk_campaign_free(imk_campaign_results *results);

/** What was wrong with one file of a merge. */
typedef struct imk_campaign_complaint {
    const char *path; /**< the caller's */
    imk_error error;
} imk_campaign_complaint;

/** What became of a merge. */
typedef struct imk_campaign_merge_report {
    imk_campaign_complaint *complaint; /**< room for as many as there are paths; the caller's */
    size_t complaint_count;
    uint64_t run_count, present; /**< of the campaign; of these there */
    uint64_t shard_count;        /**< N when every good file is a shard i/N of the same N; or 0 */
    char missing[1000];          /**< runs that are not there, from 0: "17-32,65"; "" when whole */
    char shards[1000];           /**< shards i of N that hold them, from 1: "3,17-19" */
} imk_campaign_merge_report;

/** Merge shards, given in any order, into one results file: the same, byte for byte, as that of the
 *  campaign computed in one piece.
 *
 *  Damaged files, files of another campaign, seed or version than most of the good ones (the first
 *  of equals), and files that give the same run other numbers than another one does (both: which is
 *  right cannot be known) are complained about, each by name; the rest is used. When runs are
 *  missing, nothing is written unless `partial`. Long lists end in "...".
 *  @param output  ending in .h5 or .csv (.csv.gz, .csv.zst)
 *  @return IMK_OK; IMK_ERROR_CONFLICT (runs are missing, and not `partial`), IMK_ERROR_EMPTY (no
 *          usable file), IMK_ERROR_FORMAT (ending of the output), IMK_ERROR_OPEN, IMK_ERROR_WRITE,
 *          IMK_ERROR_MEMORY */
IMK_API imk_status imk_campaign_merge(size_t count, const char *const *paths, const char *output,
                                      bool partial, imk_campaign_merge_report *report,
                                      imk_error *error);

IMK_END_C
#endif
