/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan_stream.h
 *  Allan variances of a record as its samples arrive: for a device that characterises itself, and
 *  for records cut into pieces (shards).
 *
 *  One pass, less than 4 KiB a channel whatever the length, no allocation. The averaging factors
 *  are the octaves m = 1, 2, 4 … 2^27. A tier t adds up blocks of 2^t samples, two of tier t - 1 at
 *  a time, and keeps the last eight; a difference of four blocks and the four before is one window
 *  of factor m = 2^(t+2). So windows start every m/4 samples (every sample for m <= 4), which is
 *  less than the full overlap of OADEV and keeps this part of its degrees of freedom:
 *
 *  | noise        | m = 8 | 16    | 32    | large  |
 *  |--------------|-------|-------|-------|--------|
 *  | quantization | 0.500 | 0.250 | 0.125 | 4/m    |
 *  | white        | 0.946 | 0.932 | 0.929 | 0.9275 |
 *  | flicker      | 0.997 | 0.997 | 0.997 | 0.997  |
 *  | random walk  | 1.000 | 1.000 | 1.000 | 1.000  |
 *
 *  (1 for m <= 4; from the correlations of the windows, docs/theory/allan-stream.md). Quantization
 *  is determined by the shortest factors, where nothing is lost.
 *
 *  A block is the pairwise sum of its samples, so a large constant (gravity) costs no digits: the
 *  rounding error of a mean over 2^27 samples stays below 2e-15 of the constant.
 *
 *  The values are Allan variances (twice the Haar wavelet variances) of the record and go into
 *  allan_fit.h to become a noise model. Complexity: about four windows a sample at any length. */
#ifndef IMUKIT_ALLAN_STREAM_H
#define IMUKIT_ALLAN_STREAM_H

#include "imukit/status.h"

IMK_BEGIN_C

enum {
    IMK_ALLAN_STREAM_TIERS = 26,
    IMK_ALLAN_STREAM_BLOCKS = 8,  /**< blocks kept of each tier, at each end */
    IMK_ALLAN_STREAM_OVERLAP = 4, /**< windows start every m/4 samples, at least every sample */
    IMK_ALLAN_STREAM_FACTORS = IMK_ALLAN_STREAM_TIERS + 2
};

/** A stream, or a shard of one. Plain data: it may be copied and stored. Start it with
 *  imk_allan_stream_start(). */
typedef struct imk_allan_stream {
    uint64_t first, next;    /**< sample numbers: first of the shard, and the next one to come */
    uint64_t present;        /**< samples that were finite */
    uint64_t missing;        /**< samples that were not */
    double sum, sum_error;   /**< sum of the samples, and its rounding error */
    double minimum, maximum; /**< infinite while there is no sample */
    double last[IMK_ALLAN_STREAM_TIERS][IMK_ALLAN_STREAM_BLOCKS]; /**< block b in b mod 8 */
    /** The shard's first blocks. */
    double head[IMK_ALLAN_STREAM_TIERS][IMK_ALLAN_STREAM_BLOCKS - 1];
    struct imk_allan_stream_squares {
        uint64_t count;    /**< windows */
        double sum, error; /**< sum of their squares, and its rounding error */
    } squares[IMK_ALLAN_STREAM_FACTORS];
} imk_allan_stream;

/** Start a stream or a shard. @param first  number of the first sample in the record: 0 for a
 *  stream (below 2^62) */
IMK_API void imk_allan_stream_start(imk_allan_stream *stream, uint64_t first);

/** Take the next samples; it does not matter how they are divided among calls.
 *
 *  A sample that is not finite counts as missing. Windows of m <= 4 that touch it are left out; in
 *  longer windows a block with one half missing takes twice the other half. So rare drops cost
 *  nothing, and a missing fraction p raises white noise by less than about 2 p. A block without
 *  samples is missing, too. */
IMK_API void imk_allan_stream_add(imk_allan_stream *stream, size_t count, const double *samples);

/** Join a shard and the shard that follows it. Windows and counts are the same as for one pass over
 *  both; sums differ by no more than their last digit. Shards may be joined in any grouping.
 *  @param stream     samples a … b; afterwards a … c
 *  @param following  samples b … c
 *  @return IMK_ERROR_ARGUMENT when `following` does not start where `stream` ends */
IMK_API imk_status imk_allan_stream_join(imk_allan_stream *stream,
                                         const imk_allan_stream *following);

/** Pool the windows of another record (another day, behind a gap) of the same sensor: squares and
 *  counts add; no window spans both. Afterwards `stream` takes no more samples and cannot be
 *  joined: it holds statistics only. */
IMK_API void imk_allan_stream_pool(imk_allan_stream *stream, const imk_allan_stream *other);

/** One octave of a stream. */
typedef struct imk_allan_stream_point {
    size_t m;        /**< averaging factor, tau = m dt */
    size_t stride;   /**< samples from one window to the next */
    uint64_t count;  /**< windows */
    double variance; /**< Allan variance [unit^2] */
} imk_allan_stream_point;

/** Octaves with at least one window, ascending.
 *  @param points  room for IMK_ALLAN_STREAM_FACTORS
 *  @return how many */
IMK_API size_t imk_allan_stream_points(const imk_allan_stream *stream,
                                       imk_allan_stream_point *points);

/** Mean of the finite samples; NaN when there is none. */
IMK_API double imk_allan_stream_mean(const imk_allan_stream *stream);

IMK_END_C
#endif
