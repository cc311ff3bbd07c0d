/* SPDX-License-Identifier: Apache-2.0 */
/** @file noise_map.h
 *  Noise that changes with time: the dynamic Allan map of a channel, and a test that finds when and
 *  at which averaging times the noise of a record changes (docs/theory/changing-noise.md).
 *
 *  The map has a row for each octave of averaging time and a column for each of at most
 *  IMK_NOISE_MAP_BLOCKS stretches of time. A cell holds sums over Haar differences, which are the
 *  differences of the means of neighbouring clusters that no other difference of the octave uses:
 *  half their mean square is the Allan variance. They are nearly independent for all noises of
 *  IEEE 952 [PERCIVAL1994], so flicker noise and random walk are no change of the noise. */
#ifndef IMUKIT_NOISE_MAP_H
#define IMUKIT_NOISE_MAP_H

#include "imukit/identify.h"

IMK_BEGIN_C

enum {
    IMK_NOISE_MAP_CHUNK = 256,  /**< samples taken at a time; a block holds 2^k chunks */
    IMK_NOISE_MAP_BLOCKS = 128, /**< columns at most: beyond, they are joined two by two */
    IMK_NOISE_MAP_OCTAVES = 26, /**< rows: averaging times of 1, 2, 4, … samples */
    IMK_NOISE_SEGMENTS_MAX = 9  /**< parts of a record between changes of its noise */
};

/** Sums over the Haar differences of one octave that begin in one block. */
typedef struct imk_noise_cell {
    double count;
    double absolute; /**< sum of their absolute values [unit] */
    double square;   /**< [unit^2] */
    double fourth;   /**< [unit^4] */
} imk_noise_cell;

/** The map of one channel. Plain data of 110 kB: do not put it on a small stack. Start with
 *  imk_noise_map_begin(). */
typedef struct imk_noise_map {
    size_t samples; /**< handed over so far */
    size_t block;   /**< samples of a column */
    imk_noise_cell cell[IMK_NOISE_MAP_OCTAVES][IMK_NOISE_MAP_BLOCKS];
    /** First of two neighbouring means of an octave, and the share of samples present in it;
     *  negative: there is none. */
    double waiting[IMK_NOISE_MAP_OCTAVES], share[IMK_NOISE_MAP_OCTAVES];
    size_t done, filled; /**< samples in the cells; samples in the buffer */
    double buffer[IMK_NOISE_MAP_CHUNK];
} imk_noise_map;

/** Empty map. */
IMK_API void imk_noise_map_begin(imk_noise_map *map);
/** Add samples at equal intervals, NaN where missing; in any number of calls, with the same result.
 *  About 2 ns a sample. */
IMK_API void imk_noise_map_add(imk_noise_map *map, size_t count, const double *samples);
/** State that there are no more samples; then the map may be read. */
IMK_API void imk_noise_map_end(imk_noise_map *map);
/** Multiply everything by a factor > 0, such as that of another unit. */
IMK_API void imk_noise_map_rescale(imk_noise_map *map, double factor);
/** Number of columns in use. */
IMK_API size_t imk_noise_map_blocks(const imk_noise_map *map);
/** Number of rows with at least 16 differences. */
IMK_API size_t imk_noise_map_octaves(const imk_noise_map *map);

/** Allan deviation at 2^octave samples over some of the columns.
 *  @param first,end   columns first … end - 1
 *  @param confidence  of the interval, such as 0.95
 *  @return value, lower, upper [unit]; sigma by the delta method; `present` is false when there is
 *          no difference. The interval is by chi-square with the number of differences, which fits
 *          Gaussian noise. */
IMK_API imk_estimate imk_noise_map_deviation(const imk_noise_map *map, size_t octave, size_t first,
                                             size_t end, double confidence);

/** A part of a record in which the noise does not change. */
typedef struct imk_noise_segment {
    size_t first, end;             /**< samples first … end - 1 */
    imk_estimate white;            /**< N; not present: the model has none */
    imk_estimate bias_instability; /**< B, with all other terms as in the model; not present: the
                                      model has none */
} imk_noise_segment;

/** What a map says about the noise of a channel. */
typedef struct imk_noise_changes {
    size_t segment_count; /**< 1: no change was found */
    imk_noise_segment segment[IMK_NOISE_SEGMENTS_MAX];
    unsigned tested;     /**< octaves that were tested, bit 2^octave */
    unsigned changed;    /**< octaves in which a change was found */
    double probability;  /**< that sound noise shows the largest change found, or a larger one; all
                            octaves and times together */
    size_t octave;       /**< the one that changes most, relatively; of those that changed */
    imk_noise_term term; /**< the term that changes: white noise or bias instability;
                            IMK_NOISE_TERMS: another one, or only a band of averaging times */
    size_t strange;      /**< the segment in which it is farthest from its value in the record */
    double deviation;    /**< Allan deviation there [unit] */
    double of_record;    /**< Allan deviation of the whole record in this octave [unit] */
    double ratio;        /**< deviation/of_record; 1: no change was found */
    bool matters; /**< this is more than 1.5 % and than half the interval of N (10 % at most) */

    bool gaussian_tested; /**< false: coarse steps or tones hide the distribution */
    double kurtosis; /**< excess kurtosis of the white noise, in stretches of a block; 0: Gaussian
                      */
    double kurtosis_sigma; /**< its standard deviation for Gaussian noise */
    bool heavy_tails;      /**< the kurtosis is larger than Gaussian noise makes it */
    bool light_tails; /**< it is smaller than Gaussian noise, rounding, tones and resonances make
                         it, and by so much that white noise is some 1.5 % too low */
    double scatter;   /**< variance of the white noise's strength from block to block, over that
                         of noise that does not change and has this kurtosis; 1 when not tested */
    size_t scatter_octave; /**< octave in which it is largest */
    bool bursts;           /**< that scatter is too large: the noise comes in bursts */
} imk_noise_changes;

/** Settings of the test. Start from imk_noise_changes_default(). */
typedef struct imk_noise_changes_settings {
    uint32_t cookie;
    double dt;           /**< sample interval [s]; must be set */
    double confidence;   /**< of the intervals; default 0.95 */
    double significance; /**< false-alarm rate of each of the tests (changes of an octave, changes
                            of the slow noise as a whole, tails, bursts), all octaves and times
                            together; default 1e-3 */
} imk_noise_changes_settings;

/** The defaults stated above; dt must be set. */
IMK_API imk_noise_changes_settings imk_noise_changes_default(void);

/** Test a map and estimate the noise between the changes.
 *  @param identified  of the same record: its terms, tones and resolution
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE (settings) */
IMK_API imk_status imk_noise_changes_find(const imk_noise_changes_settings *settings,
                                          const imk_noise_map *map,
                                          const imk_identification *identified,
                                          imk_noise_changes *result, imk_error *error);

/** Widen sigma and interval of the white noise by what heavy tails and bursts add to its scatter:
 *  for a linear process the relative variance of N gains kurtosis/(4 n) [ANDERSON1971].
 *  @param n  number of samples present */
IMK_API void imk_noise_changes_widen(const imk_noise_changes *changes, size_t n,
                                     imk_identification *identified);

IMK_END_C
#endif
