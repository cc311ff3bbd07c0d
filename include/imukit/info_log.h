/* SPDX-License-Identifier: Apache-2.0 */
/** @file info_log.h
 *  The job of `imukit info`: what is in a record. Columns, rate, gaps, ranges, steps, clipping, and
 *  whether the sensor is at rest. A long record is looked at in places; what follows from these
 *  only is marked as an estimate. */
#ifndef IMUKIT_INFO_LOG_H
#define IMUKIT_INFO_LOG_H

#include "imukit/job.h"
#include "imukit/record.h"

IMK_BEGIN_C

/** Settings of the job. Start from imk_info_log_default(). */
typedef struct imk_info_log_settings {
    uint32_t cookie;
    bool full;     /**< read every row of a long record, too; default false */
    uint64_t rows; /**< number of rows, where an index of the log states it; 0 (default): unknown */
} imk_info_log_settings;

/** Look at long records in places. */
IMK_API imk_info_log_settings imk_info_log_default(void);

/** Where a figure is from. */
typedef enum imk_info_basis {
    IMK_INFO_READ = 0,  /**< all rows were read */
    IMK_INFO_INDEX,     /**< the index of the log states it */
    IMK_INFO_ENDS,      /**< first and last row */
    IMK_INFO_SIZE,      /**< the rows per byte of what was read, and the size of the log */
    IMK_INFO_BEGINNING, /**< the beginning, as the log gives nothing else at once: a lower bound */
    IMK_INFO_PLACES     /**< the places that were read */
} imk_info_basis;

/** Motion of the sensor. */
typedef enum imk_info_motion {
    IMK_INFO_UNKNOWN = 0, /**< there are no gyros and accelerometers, or too few rows */
    IMK_INFO_REST,        /**< it is at rest, in one attitude */
    IMK_INFO_POSES,       /**< it rests in several attitudes, and is moved between them */
    IMK_INFO_MOVES
} imk_info_motion;

/** One column. Values are in SI; of columns without a known unit, as in the log. */
typedef struct imk_info_channel {
    imk_log_column column;
    size_t finite; /**< values that are finite numbers, among the rows read */
    double mean;
    double scatter; /**< root mean square deviation within a second or 16 rows */
    double lowest, highest;
    double step; /**< resolution: distance of neighbouring values; 0: none is seen */
    /** Rows at the lowest, the highest value, where three of them follow one another and values
     * between the extremes are many; 0: it is not clipped */
    size_t clipped_low, clipped_high;
} imk_info_channel;

/** Result of the job. */
typedef struct imk_info_log {
    imk_info_log_settings settings;
    imk_allocator allocator;
    size_t channel_count;
    imk_info_channel channel[IMK_LOG_COLUMNS_MAX];
    size_t rows_read, places; /**< rows and stretches that were read */
    bool whole;               /**< that was the whole record */
    uint64_t rows;            /**< of the record */
    imk_info_basis rows_from;
    /** Whether the units of time and sensors, and the rate, are known. Without that the motion is
     *  not, and readings are the numbers of the log (imk_log_settings.as_written). */
    bool stated;
    bool timed; /**< whether `interval`, `duration` and times are in seconds; false: they are in the
                     numbers of the time column, or 0 and NaN where there is none */
    double first_time, last_time; /**< [s]; NaN: there is no time column, or not known */
    double time_origin;           /**< see imk_log_findings */
    double duration;              /**< [s] */
    imk_info_basis duration_from;
    double interval; /**< median time step, or 1/rate [s]; 0: not known */
    /** The stamps are no sample times, but coarse, bunched or late: `interval` and the gaps are
     * what the analyses read from them, by `findings`, and `jitter` says nothing. */
    bool uneven_stamps;
    bool rate_stated;   /**< by the settings of the source; `jitter` says nothing */
    bool times_refused; /**< no rate follows from the times, for the reason in `findings` */
    double jitter;      /**< rms deviation of time steps from it [s] */
    /** Counts among the rows read: steps that leave samples out, samples left out there, time steps
     *  of 0 and below 0, rows with a value that is no finite number, rows that cannot be read. */
    size_t gaps, missing, repeats, reversals, not_finite, damaged;
    bool cut_short; /**< the record ends within a row or message */
    bool stopped;   /**< an error ended the reading; the figures are of what was read before */
    /** Messages among them whose frame is not that of the first, and the frames; see
     *  imk_log_findings. */
    size_t other_frames;
    char frames[96];
    imk_info_motion motion;
    double resting;   /**< share of the seconds at rest; NaN: not known */
    size_t attitudes; /**< attitudes of rests that differ by more than 30 deg */
    size_t holds;     /**< rests of two seconds and more, one behind the other */
    imk_findings findings;
} imk_info_log;

/** Look at a record. About 64 MB of a long record are read, unless settings.full; a record that
 *  cannot be read at other places (a pipe, compressed) is read from its beginning.
 *  @param job  NULL: no progress, the memory of the C library
 *  @return errors of the source (with the result of what was read before); IMK_ERROR_EMPTY (no
 *          row), _MEMORY, _UNINITIALISED */
IMK_API imk_status imk_info_log_run(const imk_record_source *source,
                                    const imk_info_log_settings *settings, const imk_job *job,
                                    imk_info_log **result, imk_error *error);
/** Free a result; NULL is allowed. */
IMK_API void imk_info_log_free(imk_info_log *result);

IMK_END_C
#endif
