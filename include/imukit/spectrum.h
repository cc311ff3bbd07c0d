/* SPDX-License-Identifier: Apache-2.0 */
/** @file spectrum.h
 *  Power spectral density of a record, its spectral lines, and the noise parameters it shows.
 *
 *  ONE convention: every density here is two-sided, in unit^2/Hz, as in IEEE 952 and everywhere in
 *  imukit: white noise of N unit/sqrt(Hz) has the density N^2, and the integral over -1/(2 dt) …
 *  1/(2 dt) is the mean square. Data sheets and analysers often print the one-sided density: twice
 *  that, on positive frequencies only.
 *
 *  There are two estimators. Welch's [WELCH1967] averages the periodograms of windowed, overlapping
 *  segments: it is fast, and suits long records. The multitaper estimator [THOMSON1982] multiplies
 *  each segment by several orthogonal Slepian tapers: it suits records too short to be divided, and
 *  has an exact test for lines. Theory: docs/theory/spectrum.md. */
#ifndef IMUKIT_SPECTRUM_H
#define IMUKIT_SPECTRUM_H

#include "imukit/identify.h"

IMK_BEGIN_C

typedef enum imk_spectrum_method {
    IMK_SPECTRUM_WELCH = 0,
    IMK_SPECTRUM_MULTITAPER
} imk_spectrum_method;

/** Windows of Welch's estimator, with the equivalent noise bandwidth in bins of 1/(length dt). */
typedef enum imk_window {
    IMK_WINDOW_HANN = 0,        /**< 1.5; side lobes fall as 1/f^3; suits inertial sensors */
    IMK_WINDOW_BLACKMAN_HARRIS, /**< 2.00; all side lobes below -92 dB [HARRIS1978] */
    IMK_WINDOW_KAISER,          /**< depends on beta: 1.8 for 8.6, with side lobes below -66 dB */
    IMK_WINDOW_RECTANGULAR /**< 1; for tests only, as strong slow noise leaks to all frequencies */
} imk_window;

enum { IMK_TAPERS_MAX = 24 };

/** Settings of the estimator. Start from imk_spectrum_default(), then change fields. */
typedef struct imk_spectrum_settings {
    uint32_t cookie;
    imk_spectrum_method method;
    double dt;          /**< sample interval [s]; must be set */
    double resolution;  /**< required equivalent noise bandwidth [Hz]; 0: about 31 segments at half
                           overlap (Welch) or one segment (multitaper), of at most 2^20 or 2^18
                           samples */
    imk_window window;  /**< window of Welch's estimator */
    double kaiser_beta; /**< 0 … 40; default 8.6 */
    double overlap;     /**< overlap of Welch's segments, 0 … 0.9; default 0.5 */
    double time_bandwidth; /**< NW of the multitaper estimator, 1 … 16; default 4 */
    int tapers;            /**< number of tapers, 1 … 2 NW; 0: 2 NW - 1 */
    bool adaptive;         /**< weight the tapers by their leakage; default true */
    bool trend; /**< true: remove a straight line from each segment; false: only its mean */
} imk_spectrum_settings;

/** Welch with Hann windows at half overlap, the mean of each segment removed. */
IMK_API imk_spectrum_settings imk_spectrum_default(void);

/** Result of an estimate. The arrays belong to the caller. */
typedef struct imk_spectrum {
    double dt;
    size_t count;     /**< bins 0 … length/2; bin k is at k * step */
    double step;      /**< 1/(length dt) [Hz] */
    double *density;  /**< count values, two-sided [unit^2/Hz]; bin 0 is the remainder after removal
                         of the mean */
    double *degrees;  /**< count values: chi-square degrees of freedom of each bin */
    double *harmonic; /**< count values: Thomson's F ratio, which tests for a line; NULL with
                         Welch's estimator */
    double harmonic_degrees[2]; /**< degrees of freedom of that ratio */
    /** Samples of a segment, and from the start of one segment to that of the next. */
    size_t length, hop;
    size_t segments; /**< number of segments used */
    size_t left_out; /**< segments with missing samples */
    /** Fraction of the segments' samples used: 1 for a record without gaps. */
    double fraction_used;
    double noise_bandwidth; /**< equivalent noise bandwidth of a bin [Hz] */
    double correlation;     /**< bins per independent value: a mean of m neighbouring bins has
                                 m degrees/correlation degrees of freedom (m large) */
    double blur;            /**< root second moment of the spectral window [Hz] */
    double blur_bins;       /**< bins on either side of a line that its main lobe covers */
    double mean;            /**< of the samples */
} imk_spectrum;

/** Number of bins for n samples; 0 for fewer than 64 samples, or wrong settings. */
IMK_API size_t imk_spectrum_count(const imk_spectrum_settings *settings, size_t n);
/** Bytes of workspace for imk_spectrum_estimate(). */
IMK_API size_t imk_spectrum_workspace_size(const imk_spectrum_settings *settings, size_t n);

/** Estimate the density of n equally spaced samples.
 *
 *  Samples that are not finite are missing: segments that contain any are left out. The first
 *  finite sample is subtracted from all, so a large constant costs no accuracy. Takes about 30 ns
 *  per sample (Welch), 30 ns per sample and taper (multitaper).
 *  @param density,degrees  imk_spectrum_count() values each
 *  @param harmonic         imk_spectrum_count() values, or NULL; filled by the multitaper estimator
 *                          with two or more tapers
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (error.field: the setting), _TOO_SHORT, _GAP (no segment
 *          is complete: choose a coarser resolution), _CONSTANT, _NOT_FINITE (squares overflow),
 *          _WORKSPACE */
IMK_API imk_status imk_spectrum_estimate(const imk_spectrum_settings *settings, size_t n,
                                         const double *samples, imk_spectrum *spectrum,
                                         double *density, double *degrees, double *harmonic,
                                         void *workspace, size_t workspace_size, imk_error *error);

/** Interval of a density with chi-square `degrees`, at two-sided confidence (at most 0.999999999,
 *  see imk_allan_interval()). */
IMK_API void imk_spectrum_interval(double density, double degrees, double confidence, double *lower,
                                   double *upper);

/** Slepian tapers (discrete prolate spheroidal sequences) of n samples and time-bandwidth NW: the
 *  `count` sequences of unit energy with the largest share of it within W = NW/n cycles per sample.
 *  Sequences of even number have a positive sum, the others begin with a positive lobe.
 *
 *  Eigenvectors of the tridiagonal matrix that commutes with the concentration operator
 *  [SLEPIAN1978]: by bisection up to 640 samples; for longer ones refined from those by Rayleigh
 *  quotient iteration. Error of a value below 1e-11 up to 5000 samples, 1e-9 up to 300000.
 *  @param tapers          count * n values, one sequence after the other
 *  @param concentrations  count values: share of each sequence's energy within W
 *  @return IMK_ERROR_RANGE (n < 8, count < 1, count > 2 NW, NW outside 0.5 … n/4), _WORKSPACE */
IMK_API imk_status imk_slepian_tapers(size_t n, double time_bandwidth, int count, double *tapers,
                                      double *concentrations, void *workspace,
                                      size_t workspace_size);
/** Bytes of workspace for tapers of n samples. */
IMK_API size_t imk_slepian_workspace_size(size_t n);

/* ---- lines ----------------------------------------------------------------------------------- */

/** One spectral line. */
typedef struct imk_spectrum_line {
    double frequency, frequency_sigma; /**< [Hz] */
    double amplitude, amplitude_sigma; /**< amplitude of the sinusoid [unit]; for a line that is not
                                          coherent, sqrt(2) times its root mean square */
    double phase;  /**< phase of cos() at the first sample [rad]; only for coherent lines */
    bool coherent; /**< true: one sinusoid over the whole record; false: its frequency wanders, or
                      it is a resonance */
    double width;  /**< half-power width of a line that is not coherent [Hz]; else 0 */
    double density, level; /**< density at the peak, and level of its surroundings [unit^2/Hz] */
    double false_alarm;    /**< probability of such a peak anywhere in a record without lines */
    size_t first, last;    /**< bins that the line covers */
    int family; /**< number of its family, from 0; lines of a family are multiples of the lowest one
                 */
    int multiple; /**< multiple of the lowest line of the family; 1 for that line */
} imk_spectrum_line;

/** Bytes of workspace for imk_spectrum_lines(). */
IMK_API size_t imk_spectrum_lines_workspace_size(const imk_spectrum *spectrum, size_t n);

/** Find lines: bins that exceed the median of their surroundings significantly, or whose F ratio is
 *  significant. The surroundings are 256 bins, or half as many as lie below the bin if that is
 *  less.
 *
 *  Frequency and amplitude are found by least squares on the whole record, their sigmas from the
 *  level of the surroundings. Peaks wider than some 100 bins are not lines, but belong to the shape
 *  of the spectrum.
 *  @param samples      the record; NULL: only the spectrum is used, and no line is coherent
 *  @param false_alarm  probability that a line is found in a record without lines; 1e-3 is usual
 *  @param lines        room for `capacity` lines, sorted by frequency; if there are more, the
 *                      strongest are kept
 *  @return IMK_ERROR_RANGE, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_spectrum_lines(const imk_spectrum *spectrum, size_t n, const double *samples,
                                      double false_alarm, size_t capacity, imk_spectrum_line *lines,
                                      size_t *count, void *workspace, size_t workspace_size);

/* ---- bands ----------------------------------------------------------------------------------- */

/** Mean density over a band of frequencies. */
typedef struct imk_spectrum_band {
    double frequency, from, to; /**< [Hz]: geometric mean and ends */
    double density, lower, upper;
    double degrees;
} imk_spectrum_band;

/** Compute means over logarithmically spaced bands, for tables and plots.
 *  @param per_decade  bands per decade, 1 … 1000; where bins are wider, a band is one bin
 *  @param lines       lines to leave out of the means; NULL: none
 *  @param bands       room for `capacity` bands; further bands are not computed
 *  @return how many */
IMK_API size_t imk_spectrum_bands(const imk_spectrum *spectrum, int per_decade, double confidence,
                                  size_t line_count, const imk_spectrum_line *lines,
                                  size_t capacity, imk_spectrum_band *bands);

/* ---- parameters ------------------------------------------------------------------------------ */

/** Quantization, white noise, bias instability and random walk from a spectrum, as a cross-check of
 *  imk_identify_channel(), which is the better estimator. */
typedef struct imk_spectrum_parameters {
    imk_estimate term[IMK_NOISE_RANDOM_WALK + 1]; /**< by imk_noise_term [unit of the parameter] */
    double lowest, highest;                       /**< frequencies fitted [Hz] */
    double misfit; /**< root mean square of the fit's residuals in bands of a tenth of a decade,
                        in their sigmas: about 1 when the four terms explain the spectrum */
    double worst_frequency; /**< [Hz] of the largest residual */
    double worst_ratio;     /**< measured over fitted density there */
} imk_spectrum_parameters;

/** Fit the noise parameters by Whittle's likelihood [WHITTLE1953], leaving lines out.
 *  @param lowest,highest  frequencies to fit [Hz]; 0: from the lowest frequency that the window
 *                         resolves, to 1/(2 dt). If an output filter or resonances shape the high
 *                         frequencies, set `highest` below them
 *  @param significance    chance that an absent term is called present; 0.01 is usual
 *  @return IMK_ERROR_RANGE, IMK_ERROR_TOO_SHORT (less than 8 bins), IMK_ERROR_NO_CONVERGENCE */
IMK_API imk_status imk_spectrum_fit(const imk_spectrum *spectrum, size_t line_count,
                                    const imk_spectrum_line *lines, double lowest, double highest,
                                    double confidence, double significance,
                                    imk_spectrum_parameters *result);

IMK_END_C
#endif
