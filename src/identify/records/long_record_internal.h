/* SPDX-License-Identifier: Apache-2.0 */
/* A long record as it is gathered: powers of segments, means of blocks, Allan sums, checks. */
#ifndef IMUKIT_LONG_RECORD_INTERNAL_H
#define IMUKIT_LONG_RECORD_INTERNAL_H

#include "identify/likelihood/identify_internal.h"
#include "imukit/identify_record.h"

enum {
    IMKI_CHUNK = 8192,       /* samples handled at a time; a segment holds a whole number of them */
    IMKI_BLOCK_LEAST = 32,   /* samples to a mean at first */
    IMKI_STRIDE_ONE = 1024,  /* Allan factors below this use every window */
    IMKI_SHORT_FACTORS = 40, /* room for those factors */
    IMKI_OCTAVES = 64,
    IMKI_EXTREMES = 4
};

/* Sizes of a record's parts. */
typedef struct imki_record_sizes {
    size_t segment;  /* samples to a segment: a power of two, at least IMKI_CHUNK/2 */
    size_t capacity; /* means kept: a power of two; beyond, they are joined two by two */
} imki_record_sizes;

/* The most extreme values on one side, the first the most extreme, and how often each came. */
typedef struct imki_extremes {
    size_t distinct;
    double value[IMKI_EXTREMES];
    size_t count[IMKI_EXTREMES];
    size_t run, longest; /* of the most extreme one */
} imki_extremes;

typedef struct imki_record_checks {
    imki_extremes high, low; /* low: of the samples' negatives */
    size_t repeats;
    double last; /* sample */
    double resolution;
} imki_record_checks;

/* Samples from now on are those of the record less `shift`, times `scale`, a power of two. */
struct imk_identify_record {
    imki_record_sizes sizes;
    size_t chunk;
    size_t samples, missing; /* handled so far; of them missing */
    bool started;            /* shift and scale are known */
    double shift, scale;
    double sum, squares;
    /* The segment being filled: samples there, those handled, and missing ones. */
    double *buffer;
    size_t filled, handled, missing_here, missing_before;
    double *spectrum; /* of one segment; segment + 1 */
    double *power;    /* squares of the coefficients, added up */
    size_t segments, skipped;
    void *transform;
    size_t transform_size;
    /* Means of `block` samples; NaN where all are missing. */
    double *means;
    size_t block, mean_count;
    /* Running sums of a chunk behind the last 2 IMKI_STRIDE_ONE of those before. */
    double *sums;
    bool carried;
    size_t short_count, short_factor[IMKI_SHORT_FACTORS], short_windows[IMKI_SHORT_FACTORS];
    double short_total[IMKI_SHORT_FACTORS]; /* variance times windows */
    imki_record_checks checks;
    imk_noise_map *map;
    size_t octave_count;
    imk_allan_point octave[IMKI_OCTAVES];
};

/* long_record.c */
imki_record_sizes imki_record_sizes_for(size_t expected);
size_t imki_record_memory(const imki_record_sizes *sizes);
imk_identify_record *imki_record_start(const imki_record_sizes *sizes, void *memory);
/* Handle what stands in the buffer behind a last whole chunk. */
void imki_record_flush(imk_identify_record *record);
/* Cosine coefficients of the `segment` samples in record->spectrum. */
void imki_record_transform(imk_identify_record *record);

/* long_record_fill.c */
/* Straight lines, and white noise about them, in place of what is missing (NaN).
 * @param stream,first  of the normals: the same ones for the same samples */
void imki_record_bridge(size_t count, double *samples, uint64_t stream, uint64_t first);

/* long_record_checks.c */
void imki_record_check(imki_record_checks *checks, size_t count, const double *samples, double low,
                       double high);
unsigned imki_record_checked(const imki_record_checks *checks, size_t samples, double deviation);

/* long_record_allan.c */
void imki_record_allan_begin(imk_identify_record *record);
void imki_record_allan_add(imk_identify_record *record, size_t count, const double *samples);
/* Points of a grid at a confidence, up to factor `last`. @param sums  mean_count + 1 running sums
 * of the means. @return how many, at most `most` */
size_t imki_record_allan_points(const imk_identify_record *record, const double *sums,
                                imk_allan_grid grid, double confidence, size_t last, size_t most,
                                imk_allan_point *points);

/* long_record_spectra.c: the two scales, and the lines in each, for the fit. */
typedef struct imki_record_spectra {
    imki_spectrum part[2]; /* slow, fast */
    imki_line lines[2][2 * IMKI_LINES_MAX];
    double *fast_powers; /* cumulative of the fast one: skirts of tones are taken out */
} imki_record_spectra;
/* Coefficients and cumulative powers of the means: point_count values, and one more.
 * @param squares  of the segments' powers @param present  share of the means */
void imki_record_spectra_make(imk_identify_record *record, double dt, double weight, double squares,
                              double present, size_t point_count, double *coefficients,
                              double *cumulative, imki_record_spectra *spectra);
/* long_record_lines.c */
void imki_record_lines(imki_record_spectra *spectra, imk_identification *result);

#endif
