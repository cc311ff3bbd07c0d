/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the Allan family: one factor of each statistic that is more than a difference. */
#ifndef IMUKIT_ALLAN_INTERNAL_H
#define IMUKIT_ALLAN_INTERNAL_H

#include "imukit/allan.h"
#include "imukit/random.h"

/* Kernels are compiled once for each instruction set, which works only if they are part of the
 * function that names it. */
#if defined(__GNUC__)
#define IMKI_INLINED static inline __attribute__((always_inline))
#define IMKI_OUTLINED static __attribute__((noinline))
#else
#define IMKI_INLINED static inline
#define IMKI_OUTLINED static
#endif

/* name_portable() and name_avx2(): `name` inlined into a function of the same parameters for each
 * instruction set, of which IMKI_ALLAN_CALL() takes one. With AVX-512 (Zen 4) differences took 10 %
 * less time and running sums 10 % more: not worth a version. */
#define IMKI_ALLAN_VERSION(name, set, parameters, ...)                                             \
    set double name parameters                                                                     \
    {                                                                                              \
        return __VA_ARGS__;                                                                        \
    }
#if defined(__x86_64__) && defined(__GNUC__)
#define IMKI_ALLAN_VERSIONS(name, parameters, ...)                                                 \
    IMKI_ALLAN_VERSION(name##_portable, IMKI_OUTLINED, parameters, name(__VA_ARGS__))              \
    IMKI_ALLAN_VERSION(name##_avx2, __attribute__((target("avx2"))) static, parameters,            \
                       name(__VA_ARGS__))
#define IMKI_ALLAN_CALL(kernel, name, ...)                                                         \
    ((kernel) == IMK_KERNEL_AVX512 || (kernel) == IMK_KERNEL_AVX2 ? name##_avx2(__VA_ARGS__)       \
                                                                  : name##_portable(__VA_ARGS__))
#else
#define IMKI_ALLAN_VERSIONS(name, parameters, ...)                                                 \
    IMKI_ALLAN_VERSION(name##_portable, IMKI_OUTLINED, parameters, name(__VA_ARGS__))
#define IMKI_ALLAN_CALL(kernel, name, ...) ((void)(kernel), name##_portable(__VA_ARGS__))
#endif

enum {
    IMKI_ALLAN_LANES = 16,  /* partial sums, added up in a fixed order */
    IMKI_ALLAN_BLOCK = 1024 /* consecutive terms handled at once; their arrays stay in L1 */
};

/* Sum of the lanes, which are used up, in a fixed order. */
IMKI_INLINED double imki_sum_lanes(double *lane)
{
    for (size_t half = IMKI_ALLAN_LANES / 2; half > 0; half /= 2)
        for (size_t l = 0; l < half; l++)
            lane[l] += lane[l + half];
    return lane[0];
}

/* Where a sum over overlapping terms of one factor stands. */
typedef struct imki_allan_cursor {
    size_t m, count; /* terms in all */
    double total;    /* squares so far */
    size_t exact;    /* term at which window and slope were last summed afresh */
    double window,
        slope; /* sums over a window at the next term (allan_modified, allan_parabolic) */
} imki_allan_cursor;

/* Add terms first … first + size - 1 (size <= BLOCK; blocks in order from 0) to the total. */
void imki_allan_modified_block(imki_allan_cursor *c, imk_kernel kernel, const double *sums,
                               size_t first, size_t size);
void imki_allan_parabolic_block(imki_allan_cursor *c, imk_kernel kernel, const double *sums,
                                size_t first, size_t size);

/* allan_total.c: squares of the terms that reach beyond the record's ends, 2 (m - 1) up to m = n/2
 * and n - 1 beyond. */
double imki_allan_total_ends(size_t n, const double *sums, size_t m);

/* allan_total_windows.c: the variances MTOT (or HTOT) from reflected stretches. */
size_t imki_allan_windows_doubles(size_t n, size_t m);
double imki_allan_windows(bool hadamard, size_t n, const double *sums, size_t m, size_t *count,
                          double *scratch);

/* allan_theo.c */
double imki_allan_theo(size_t n, const double *sums, size_t m, size_t *count, imk_kernel kernel,
                       double *scratch);

/* allan_theo_fast.c: its sum of squares by correlations, in a scratch of so many doubles; none
 * where the definition is as fast. */
size_t imki_allan_theo_doubles(size_t n, size_t m);
double imki_allan_theo_fast(size_t n, const double *sums, size_t m, double *scratch);

/* allan_edf.c: the sum over lags for difference statistics and PDEV, and the generalised
 * autocovariance of the sums of sampled noise it rests on. */
double imki_allan_edf(imk_allan_statistic statistic, imk_power_law type, bool continuous, size_t n,
                      size_t m);
double imki_allan_autocovariance(int alpha, double lag);

/* The total family and Theo1: allan_edf_total.c from exact forms, allan_edf_published.c by the
 * published fits. */
double imki_allan_edf_total(imk_allan_statistic statistic, imk_power_law type, size_t n, size_t m);
double imki_allan_edf_published(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                size_t m);

/* allan_type.c: noise type of a record of n samples at factor m. `found` is what the clusters of m
 * show (read only where there are IMKI_ALLAN_CLUSTERS_MIN), `before` the type at the next shorter
 * factor; NULL: none. */
enum { IMKI_ALLAN_CLUSTERS_MIN = 30 };
imk_power_law imki_allan_type_at(size_t clusters, imk_power_law found, const imk_power_law *before);
/* The type whose lag-1 autocorrelation of d-th differences of means of m is next to r, no lower
 * than `lowest`. */
imk_power_law imki_allan_nearest_type(double r, int d, size_t m, imk_power_law lowest);

/* Lowest power law for which a statistic converges. */
imk_power_law imki_allan_lowest_type(imk_allan_statistic statistic);

#endif
