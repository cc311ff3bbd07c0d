/* SPDX-License-Identifier: Apache-2.0 */
/** @file spectrum.h
 *  Power spectral density of a record, its spectral lines, and the noise parameters it shows.
 *
 *  ONE convention: every density here is two-sided, in unit^2/Hz, as in IEEE 952 and everywhere in
 *  imukit: white noise of N unit/sqrt(Hz) stands at N^2, and the integral over -1/(2 dt) …
 *  1/(2 dt) is the mean square. Data sheets and analysers often print the one-sided density: twice
 *  that, on positive frequencies only.
 *
 *  Two estimators. Welch's [WELCH1967] averages the periodograms of windowed, overlapping segments:
 *  cheap, and the right one for long records. The multitaper estimator [THOMSON1982] looks at each
 *  segment through several orthogonal Slepian tapers: it makes the most of a record too short to be
 *  cut up, and has an exact test for lines. Theory: docs/theory/spectrum.md. */
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
    IMK_WINDOW_HANN = 0,        /**< 1.5; side lobes fall as 1/f^3: right for inertial sensors */
    IMK_WINDOW_BLACKMAN_HARRIS, /**< 2.00; all side lobes below -92 dB [HARRIS1978] */
    IMK_WINDOW_KAISER,          /**< by its beta: 1.8 at 8.6, where side lobes are below -66 dB */
    IMK_WINDOW_RECTANGULAR      /**< 1; for tests: strong slow noise leaks everywhere */
} imk_window;

enum { IMK_TAPERS_MAX = 24 };

/** How to estimate. Start from imk_spectrum_default(), then change fields. */
typedef struct imk_spectrum_settings {
    uint32_t cookie;
    imk_spectrum_method method;
    double dt;             /**< sample interval [s]; must be set */
    double resolution;     /**< equivalent noise bandwidth wanted [Hz]; 0: about 31 segments at half
                                overlap (Welch) or one segment (multitaper), of at most 2^20 and 2^18
                                samples */
    imk_window window;     /**< of Welch's estimator */
    double kaiser_beta;    /**< 0 … 40; default 8.6 */
    double overlap;        /**< of Welch's segments, 0 … 0.9; default 0.5 */
    double time_bandwidth; /**< NW of the multitaper estimator, 1 … 16; default 4 */
    int tapers;            /**< 1 … 2 NW; 0: 2 NW - 1 */
    bool adaptive;         /**< weight the tapers by what leaks into them; default true */
    bool trend;            /**< remove a straight line from each segment; false: its mean only */
} imk_spectrum_settings;

/** Welch with Hann windows at half overlap, the mean of each segment removed. */
IMK_API imk_spectrum_settings imk_spectrum_default(void);

/** What was estimated. The arrays belong to the caller. */
typedef struct imk_spectrum {
    double dt;
    size_t count;     /**< bins 0 … length/2; bin k is at k * step */
    double step;      /**< 1/(length dt) [Hz] */
    double *density;  /**< count values, two-sided [unit^2/Hz]; bin 0 is what mean removal left */
    double *degrees;  /**< count values: chi-square degrees of freedom of each bin */
    double *harmonic; /**< count values: Thomson's F ratio for a line, or NULL (Welch) */
    double harmonic_degrees[2]; /**< of that ratio */
    size_t length, hop;         /**< samples of a segment, and from one to the next */
    size_t segments;            /**< used */
    size_t left_out;            /**< segments with missing samples */
    double fraction_used;       /**< of the samples in segments: 1 for a record without gaps */
    double noise_bandwidth;     /**< [Hz]: width of the white noise a bin holds */
    double correlation;         /**< bins per independent value: a mean of m neighbouring bins has
                                     m degrees/correlation degrees of freedom (m large) */
    double blur;                /**< root second moment of the spectral window [Hz] */
    double blur_bins;           /**< bins on either side of a line that hold its main lobe */
    double mean;                /**< of the samples */
} imk_spectrum;

/** Bins the estimate of n samples has; 0 when they are too few (64) or the settings are wrong. */
IMK_API size_t imk_spectrum_count(const imk_spectrum_settings *settings, size_t n);
/** Bytes of workspace for imk_spectrum_estimate(). */
IMK_API size_t imk_spectrum_workspace_size(const imk_spectrum_settings *settings, size_t n);

/** Estimate the density of n equally spaced samples.
 *
 *  Samples that are not finite are missing: segments with any are left out. The first finite sample
 *  is subtracted before anything is added up, so a large constant costs no digits. Cost: about
 *  30 ns per sample (Welch), 30 ns per sample and taper (multitaper).
 *  @param density,degrees  imk_spectrum_count() values each
 *  @param harmonic  the same, or NULL; filled by the multitaper estimator with two tapers or more
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (error.field: the setting), _TOO_SHORT, _GAP (no segment
 *          is complete: ask for a coarser resolution), _CONSTANT, _NOT_FINITE (squares
 *          overflow), _WORKSPACE */
IMK_API imk_status imk_spectrum_estimate(const imk_spectrum_settings *settings, size_t n,
                                         const double *samples, imk_spectrum *spectrum,
                                         double *density, double *degrees, double *harmonic,
                                         void *workspace, size_t workspace_size, imk_error *error);

/** Interval of a density with chi-square `degrees`, at two-sided confidence, which is to be at most
 *  0.999999999 as in imk_allan_interval(). */
IMK_API void imk_spectrum_interval(double density, double degrees, double confidence, double *lower,
                                   double *upper);

/** Slepian tapers (discrete prolate spheroidal sequences) of n samples and time-bandwidth NW: the
 *  `count` sequences of unit energy with most of it within W = NW/n cycles per sample, and how much
 *  that is. Even ones have a positive sum, odd ones begin with a positive lobe.
 *
 *  Eigenvectors of the tridiagonal matrix that commutes with the concentration operator
 *  [SLEPIAN1978]: by bisection up to 640 samples; for longer ones refined from those by Rayleigh
 *  quotient iteration. Error of a value below 1e-11 up to 5000 samples, 1e-9 up to 300000.
 *  @param tapers          count * n values, one sequence after the other
 *  @param concentrations  count values
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
    double amplitude, amplitude_sigma; /**< of the sinusoid [unit]; of a line that is not coherent
                                            sqrt(2) times its root mean square */
    double phase;  /**< of cos() at the first sample [rad], coherent ones only */
    bool coherent; /**< one sinusoid over the whole record; false: it wanders, or is a resonance */
    double width;  /**< half-power width of a line that is not coherent [Hz]; else 0 */
    double density, level; /**< at the peak, and of the surroundings [unit^2/Hz] */
    double false_alarm;    /**< probability of such a peak anywhere in a record without lines */
    size_t first, last;    /**< bins it covers */
    int family;            /**< lines of one family are multiples of its lowest: number from 0 */
    int multiple;          /**< 1: the lowest of its family */
} imk_spectrum_line;

/** Bytes of workspace for imk_spectrum_lines(). */
IMK_API size_t imk_spectrum_lines_workspace_size(const imk_spectrum *spectrum, size_t n);

/** Find lines: bins that stand out from the median of their surroundings (256 bins about them, half
 *  as many as lie below them if that is less), or whose F ratio does.
 *
 *  Frequency and amplitude by least squares on the whole record, their sigmas from the level of
 *  the surroundings. Peaks wider than some 100 bins are no lines but the shape of the spectrum.
 *  @param samples      the record, or NULL: peaks of the spectrum alone, none of them coherent
 *  @param false_alarm  probability that a record without lines yields any; 1e-3 is usual
 *  @param lines        capacity values, by frequency; when there are more, the strongest
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

/** Logarithmically spaced means, for tables and plots.
 *  @param per_decade   bands per decade, 1 … 1000; where bins are wider, one bin a band
 *  @param lines        left out of the means; NULL: none
 *  @param bands        capacity values; bands beyond are not made
 *  @return how many */
IMK_API size_t imk_spectrum_bands(const imk_spectrum *spectrum, int per_decade, double confidence,
                                  size_t line_count, const imk_spectrum_line *lines,
                                  size_t capacity, imk_spectrum_band *bands);

/* ---- parameters ------------------------------------------------------------------------------ */

/** Quantization, white noise, bias instability and random walk seen in a spectrum: a cross-check of
 *  imk_identify_channel(), which is the better estimator. */
typedef struct imk_spectrum_parameters {
    imk_estimate term[IMK_NOISE_RANDOM_WALK + 1]; /**< by imk_noise_term [unit of the parameter] */
    double lowest, highest;                       /**< frequencies fitted [Hz] */
    double misfit; /**< root mean square of the fit's residuals in bands of a tenth of a decade,
                        in their sigmas: about 1 when the four terms explain the spectrum */
    double worst_frequency; /**< [Hz] of the largest residual */
    double worst_ratio;     /**< measured over fitted density there */
} imk_spectrum_parameters;

/** Fit them by Whittle's likelihood [WHITTLE1953], lines left out.
 *  @param lowest,highest  frequencies to fit [Hz]; 0: from where the window is resolved, to
 *                         1/(2 dt). Where an output filter or resonances shape the fast end, say
 *                         where they begin
 *  @param significance    chance at which a term that is not there is called present; 0.01
 *  @return IMK_ERROR_RANGE, IMK_ERROR_TOO_SHORT (less than 8 bins), IMK_ERROR_NO_CONVERGENCE */
IMK_API imk_status imk_spectrum_fit(const imk_spectrum *spectrum, size_t line_count,
                                    const imk_spectrum_line *lines, double lowest, double highest,
                                    double confidence, double significance,
                                    imk_spectrum_parameters *result);

IMK_END_C
#endif
