/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the screening of a record that passes by, a chunk of fixed length at a time. What is
 * decided about a chunk depends on it, on the chunks before and on the next one, never on the
 * length of the record or on how it is handed over. */
#ifndef IMUKIT_SCREENER_INTERNAL_H
#define IMUKIT_SCREENER_INTERNAL_H

#include "identify/records/screen_internal.h"
#include "imukit/record_screen.h"

enum {
    IMKI_SCREEN_CHUNK = 8192,
    IMKI_SCREEN_REACH = 15, /* neighbours on each side that make the level of a sample */
    IMKI_SCREEN_LEVELS = 2048,
    IMKI_SCREEN_SHARES = 64,
    IMKI_SCREEN_BATCHES = 3,
    IMKI_SCREEN_EARLY = 24, /* chunks that count in full for an excess */
    IMKI_SCREEN_ENDS = 8,
    IMKI_CYCLE_SEGMENT = 1024,
    /* What a sample is marked with. */
    IMKI_MARK_STUCK = 1,
    IMKI_MARK_OUTLIER = 2
};

/* Samples of a record for which the thresholds hold: no record has more. */
static const double imki_screen_samples = 1e9;

/* Means of blocks of equal length over the whole record: at most IMKI_SCREEN_LEVELS, joined two by
 * two when they are more. */
typedef struct imki_levels {
    size_t block, count; /* samples to a block; whole blocks */
    size_t filled;       /* samples of the block that is being filled */
    double shift, shift_temperature;
    double sum[IMKI_SCREEN_LEVELS + 1], present[IMKI_SCREEN_LEVELS + 1]; /* less `shift` */
    double temperature[IMKI_SCREEN_LEVELS + 1], measured[IMKI_SCREEN_LEVELS + 1];
} imki_levels;

/* The most extreme values of one side, the first the most extreme, and how often each came. */
typedef struct imki_ends {
    size_t distinct;
    double value[IMKI_SCREEN_ENDS];
    imk_screen_count count[IMKI_SCREEN_ENDS]; /* runs: of the first one only */
    size_t last[IMKI_SCREEN_ENDS];            /* place of the last one */
} imki_ends;

/* The largest values of pieces of the record, in order. */
enum { IMKI_EDGE_PIECES = 256 };
typedef struct imki_edges {
    size_t count;
    double largest[IMKI_EDGE_PIECES];
} imki_edges;

/* Fast variance of batches of blocks: sums over the whole batches, and the batch being filled. */
typedef struct imki_batches {
    double blocks, sum; /* of the batch being filled */
    double count, total, squares;
} imki_batches;

/* Cycles of the strength of the noise, a number to a segment of second differences. */
typedef struct imki_cycles {
    double roots[2 * IMKI_CYCLE_SEGMENT];
    /* of the segments, sums of their coupling: each at most so large; as it is */
    double sum[IMKI_CYCLE_SEGMENT / 2 + 1], whole[IMKI_CYCLE_SEGMENT / 2 + 1];
    double segments;
    double differences, straight, straight_by_chance; /* second differences, those that vanish */
} imki_cycles;

/* Samples that are equal to something, how many are due, and the variance of their difference. */
typedef struct imki_excess {
    double samples, counted, due, variance;
} imki_excess;

/* A value that may be too frequent, three values on either side, in order, and how often they came.
 */
enum { IMKI_FREQUENT_SIDE = 3 };
typedef struct imki_frequent {
    bool looked, candidate;
    bool alone; /* beside the steps of the others */
    double samples;
    double equal;  /* difference of values that are one */
    double uneven; /* mean square error of the logarithm of what is due */
    double value[2 * IMKI_FREQUENT_SIDE + 1], number[2 * IMKI_FREQUENT_SIDE + 1];
} imki_frequent;

/* Zeros among the noise of some chunks, and values beside them, in chunks of fine steps and of
 * coarse ones. */
typedef struct imki_zeros {
    double samples;           /* of these chunks */
    double fine, near, far;   /* zeros, and values up to a quarter, and to half a scale away */
    double near_due, far_due; /* those two for one step */
    double weight;            /* of a logarithm's slope from far to near, times near_due */
    double coarse, above[3], below[3]; /* zeros, and values one, two, three steps away */
} imki_zeros;

typedef struct imki_counting {
    size_t run;  /* of missing samples at the end of what was seen */
    size_t last; /* place of the last outlier */
} imki_counting;

struct imk_screener {
    imk_screen_settings settings;
    unsigned what;
    imk_screen_sink sink;
    void *context;
    double z;        /* threshold in standard deviations */
    double *raw[2];  /* the chunk to be decided, and the next one; NaN where nothing is there */
    double *warm[2]; /* their temperatures, NaN where missing */
    double *loose, *clean, *value;
    uint32_t *place;
    unsigned char *mark;
    bool marked;  /* is any sample of the chunk? */
    double *room; /* all of these arrays, for other use at the end */
    size_t room_count;
    double lowest[2], highest[2]; /* of raw[] */
    size_t count[2], chunk;       /* samples in raw[]; number of chunks decided */
    bool thermal;
    /* Repeats: shares of stretches of 512 samples, the last ones in turn. */
    double share[IMKI_SCREEN_SHARES];
    size_t shares, repeats, compared, chunk_repeats[2];
    bool chunk_whole[2]; /* nothing is missing */
    double last;         /* sample */
    /* The run of one value that the last chunk ended with. */
    double run_value;
    size_t run_length;
    bool run_stuck;
    double tail[IMKI_SCREEN_REACH]; /* last samples of the chunk before */
    size_t tail_count;
    double scale, step; /* of the noise, of the values; 0: not known yet */
    double scale_sum, threshold_sum, scale_count;
    size_t shoulder;             /* samples that are nearly outliers */
    double core_sum, core_count; /* median distances from the mean of 32 samples, of chunks */
    double tail_samples, far[2]; /* of some chunks: from 3.5 to 5 standard deviations of most
                                     samples, and beyond */
    imki_counting counting;
    double fast, fast_blocks;                     /* sum of the variances within blocks */
    imki_batches batches[2][IMKI_SCREEN_BATCHES]; /* with outliers, and without */
    double shift, norm, mean; /* of the samples: Chan's update of mean and root sum of squares */
    imki_ends high, low;      /* low: of the negatives */
    imki_edges upper, lower;  /* lower: of the negatives */
    imki_levels levels;
    imki_cycles cycles;
    imki_zeros zeros;
    imki_frequent frequent;
    imki_excess repeated, straight; /* equal to the sample before; means of their neighbours */
    imk_screen found;
};

/* screener.c: decide what has not been decided yet. */
void imki_screen_flush(imk_screener *screener);

/* screener_moments.c */
void imki_screen_extremes(size_t count, const double *x, double *low, double *high);
/* Extremes of a new chunk, raw[at]; its mean and deviation join those before. */
void imki_screen_moments(imk_screener *s, int at, size_t missing);
/* Variance within blocks of 32 samples: in batches; and by the median. */
void imki_screen_variances(imk_screener *s);
void imki_screen_core(imk_screener *s);

/* screener_stuck.c */
/* Shares of repeats of a new chunk, raw[at]. @param whole  nothing is missing in it */
void imki_screen_repeats(imk_screener *s, int at, bool whole);
/* Longest run of one value that the noise allows, by the last shares. */
size_t imki_screen_stuck_limit(const imk_screener *s);
/* Mark stuck samples of raw[0]; raw[1] tells how the last run goes on. */
void imki_screen_stuck(imk_screener *s);

/* screener_edges.c */
void imki_edges_begin(imki_edges *edges);
/* @param low  of the negatives */
void imki_edges_add(imki_edges *high, imki_edges *low, size_t count, const double *samples);
/* Are there more samples near the largest than noise has?
 * @param samples  of the record @param deviation  of the fast noise @param step  between values; 0:
 * none */
bool imki_edge_is_abrupt(const imki_edges *edges, size_t samples, double deviation, double step);

/* screener_excess.c */
/* Has the chunk noise, and steps fine enough that it spreads over them? */
bool imki_screen_has_noise(const imk_screener *s);
/* Are the samples of the chunk counted for what follows? */
bool imki_screen_counts(size_t chunk);
/* Share of the samples by which more are counted than due; 0: no more than chance has, than
 * `least`, or than `factor` times what is due. */
double imki_excess_share(const imki_excess *excess, double least, double factor);

/* screener_frequent.c */
/* Find a value that is too frequent, and gaps among the values; count it in the chunk. */
void imki_screen_frequent(imk_screener *s);
double imki_frequent_excess(const imki_frequent *frequent);

/* screener_serial.c */
/* Count samples equal to the one before, and those that are the mean of their neighbours. */
void imki_screen_serial(imk_screener *s);
double imki_repeated_excess(const imk_screener *s);
double imki_straight_excess(const imk_screener *s);

/* screener_zeros.c */
/* Mark zeros that lie outside the other samples of raw[0]. */
void imki_screen_lost(imk_screener *s);
/* Count zeros among the noise of the chunk. */
void imki_screen_zeros(imk_screener *s);
/* Share of the samples by which zeros are more than due; 0: they are not. */
double imki_zeros_excess(const imki_zeros *zeros);

/* screener_outliers.c */
void imki_screen_outliers(imk_screener *s);

/* screener_ends.c */
/* @param place  of the first sample in the record @param sign  -1: of the negatives */
void imki_ends_add(imki_ends *ends, size_t place, size_t count, const double *samples, double sign);
/* Do samples pile up at the end? As many as `present` normal samples about `mean` would not.
 * @param resolution  step between values; 0: none
 * @param fast  is their deviation that of neighbouring samples? */
bool imki_ends_pile(const imki_ends *ends, double resolution, double mean, double deviation,
                    double present, bool fast);

/* screener_levels.c */
void imki_levels_begin(imki_levels *levels);
void imki_levels_add(imki_levels *levels, size_t count, const double *samples,
                     const double *temperature);
/* Means of groups of blocks, at most `most` of them; what is missing lies on lines.
 * @param empty  set to the share of the means that nothing was there for
 * @return how many; 0 when nothing is there */
size_t imki_levels_means(const imki_levels *levels, size_t most, const double *sum,
                         const double *present, double shift, double *mean, double *empty);
/* Samples of a group. */
size_t imki_levels_length(const imki_levels *levels, size_t most);

/* screener_cycles.c */
void imki_cycles_begin(imki_cycles *cycles);
/* @param samples  of a chunk, NaN where missing @param step  between values; 0: not known
 * @param room  6 segments of doubles */
void imki_cycles_add(imki_cycles *cycles, size_t chunk, size_t count, const double *samples,
                     double step, double *room);
/* Has the noise a cycle? @param rate  set to the rate of the sensor over that of the log, 0 if the
 * noise alternates; the second is 0, or another one if coarse steps hide which it is */
bool imki_cycles_find(const imki_cycles *cycles, double significance, double rate[2]);

/* level_noise.c */
enum { IMKI_LEVEL_NOISES = 3 };
typedef struct imki_level_noise {
    size_t n;
    double *flicker, *walk;           /* spectra for amount 1 */
    double *coefficient, *spectrum;   /* c_k, S_k */
    double amount[IMKI_LEVEL_NOISES]; /* of white noise, flicker, walk */
    void *transform;
    size_t transform_size;
} imki_level_noise;
/* Begin with n means. @param room  imki_level_noise_room(n) doubles */
size_t imki_level_noise_room(size_t n);
void imki_level_noise_begin(imki_level_noise *noise, size_t n, double *room);
/* Coefficients of the means; amounts and spectrum of the coefficients, @return the log-likelihood;
 * the spectrum raised to octaves of more power. */
void imki_level_noise_transform(imki_level_noise *noise, const double *mean);
/* Take steady tones out of the means, four at most. */
void imki_level_noise_take_tones(imki_level_noise *noise, double *mean);
double imki_level_noise_fit(imki_level_noise *noise);
void imki_level_noise_raise(imki_level_noise *noise);

/* level_cycle.c */
/* Most likely cycle of the level among n means; tones are taken out of them.
 * @param room  imki_cycle_room(n) doubles @return whether it is significant */
typedef struct imki_cycle {
    double periods, amplitude; /* periods in the record */
    double square; /* without a cycle chi-square with two degrees of freedom, but for the search */
} imki_cycle;
size_t imki_cycle_room(size_t n);
bool imki_cycle_find(size_t n, double *mean, double empty, double significance, double *room,
                     imki_cycle *cycle);

/* level_jumps.c */
typedef struct imki_jump {
    size_t place; /* first mean behind it; 0: none */
    double size, square;
} imki_jump;
/* Most likely sudden changes among n means, 64 <= n <= IMKI_SCREEN_LEVELS, each significant beside
 * those before; they are subtracted from the means.
 * @param empty    share of the means that are no measurements
 * @param room     memory, imki_jumps_room(n) doubles
 * @param most     places in `place` (first mean behind the jump) and `size`
 * @param gain     log-likelihood that the first one is worth; 0 without one
 * @param possible  the most likely one that is not significant
 * @return how many */
size_t imki_jumps_room(size_t n);
size_t imki_jumps_find(size_t n, double *mean, double empty, double significance, double *room,
                       size_t most, size_t *place, double *size, double *gain, imki_jump *possible);

/* level_moves.c */
typedef struct imki_move {
    size_t first, end; /* means first … end - 1 */
} imki_move;
/* Stretches in which the sensor was moved, in order.
 * @param empty  share of the means that are no measurements
 * @param least  a change that is none, however small the others are
 * @param edge   means at either end of which one change is enough
 * @param room   n doubles
 * @return how many, at most `most` */
size_t imki_moves_find(size_t n, const double *mean, double empty, double least, size_t edge,
                       double *room, imki_move *move, size_t most);

/* clipped_normal.c */
/* A normal distribution of which everything beyond two limits is put onto them. */
typedef struct imki_clipped {
    double deviation; /* of the normal distribution over that of what is left */
    double gain;      /* of slow changes: the share that is not clipped */
    double misfit;    /* relative, of the deviation found to that of such a distribution */
} imki_clipped;
/* @param share  of samples at the lower and the upper limit; 0: no limit
 * @param limit  these values; @param mean,deviation  of the samples; @param step  between values */
imki_clipped imki_clipped_normal(const double share[2], const double limit[2], double mean,
                                 double deviation, double step);

/* screen_finish.c: what the whole record tells. */
void imki_screen_conclude(imk_screener *s);

#endif
