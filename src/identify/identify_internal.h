/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the identification of one channel: the cosine spectrum in bands, the likelihood fit of
 * its terms, and the search for lines, resonances and the output filter. */
#ifndef IMUKIT_IDENTIFY_INTERNAL_H
#define IMUKIT_IDENTIFY_INTERNAL_H

#include "imukit/identify.h"

enum {
    IMKI_SINGLE_BANDS = 64, /* lowest frequencies, one to a band */
    IMKI_BANDS_MAX = 2048,  /* bands in all */
    IMKI_GAUSS_MARKOV_MAX = 2,
    IMKI_TEMPLATES_MAX = 4 + IMKI_GAUSS_MARKOV_MAX + IMK_TERMS_MAX,
    IMKI_LINES_MAX = 2 * IMK_TERMS_MAX
};

/* Templates by index: the four random terms in the order of imk_noise_term, Gauss-Markov terms,
 * then resonances. */
enum { IMKI_FIRST_GAUSS_MARKOV = 4, IMKI_FIRST_RESONANCE = 4 + IMKI_GAUSS_MARKOV_MAX };

/* A spectral line found: DCT indices first … last around its peak. */
typedef struct imki_line {
    size_t first, last;
    double ratio; /* mean power over the surroundings' */
    double gain;  /* log-likelihood it is worth */
} imki_line;

/* Spectrum S(f) in bands: mean power of `count` cosine coefficients. */
typedef struct imki_bands {
    size_t n; /* samples in the record */
    double dt;
    size_t count;
    double frequency[IMKI_BANDS_MAX];
    double degrees[IMKI_BANDS_MAX];        /* coefficients in the band */
    double power[IMKI_BANDS_MAX];          /* their mean square times dt: an estimate of S */
    size_t singles;                        /* leading bands of one coefficient, k = 1 … singles */
    double coefficient[IMKI_SINGLE_BANDS]; /* those coefficients, with sign */
    double ramp[IMKI_SINGLE_BANDS];        /* what a ramp of 1 unit/s adds to them */
} imki_bands;

/* Spectral model: S = sum of amount[j] * shape[j], amount >= 0, plus a ramp in the mean. */
typedef struct imki_fit {
    size_t templates;
    double shape[IMKI_TEMPLATES_MAX][IMKI_BANDS_MAX]; /* for amount 1 */
    bool active[IMKI_TEMPLATES_MAX];
    double amount[IMKI_TEMPLATES_MAX]; /* squares: Q^2, N^2, B^2, K^2, sigma^2 */
    bool ramp_active;
    double ramp; /* [unit/s] */
    double log_likelihood;
} imki_fit;

/* golden_section.c: place of the highest value between low and high, which should hold one peak. */
typedef double (*imki_height)(void *context, double place);
double imki_peak(imki_height height, void *context, double low, double high, int sections);

/* cosine_spectrum.c */
void imki_bands_build(imki_bands *bands, size_t n, double dt, const double *coefficients,
                      const double *cumulative, size_t line_count, const imki_line *lines,
                      size_t resonance_count, const imk_resonance *resonances);

/* Spectra of unit resonances and of filtered white noise of unit density at the bands. */
void imki_resonance_shape(double frequency, double q, const imki_bands *bands, double *shape);
void imki_filter_shape(imk_low_pass filter, const imki_bands *bands, double *shape);

/* spectral_fit.c: all return the log-likelihood, and leave it in the fit. */
double imki_fit_maximise(imki_fit *fit, const imki_bands *bands);
/* The same with one amount (or the ramp: index IMK_NOISE_RAMP when `ramp`) held at a value. */
double imki_fit_profile(imki_fit *fit, const imki_bands *bands, int held, double value);
/* Covariance of the active amounts, templates x templates, row-major; zero for the others. */
void imki_fit_covariance(const imki_fit *fit, const imki_bands *bands, double *covariance);
double imki_fit_ramp_information(const imki_fit *fit, const imki_bands *bands);
double imki_fit_spectrum(const imki_fit *fit, size_t band);
enum { IMKI_HELD_NONE = -1, IMKI_HELD_RAMP = -2 };

/* spectral_lines.c */
size_t imki_lines_find(size_t n, const double *cumulative, imki_line *lines);
/* Fit and subtract a sinusoid whose frequency is near `frequency`; false, and nothing subtracted,
 * when it holds less than 0.6 of the line's variance. */
bool imki_sinusoid_remove(size_t n, double dt, double frequency, double variance, double *samples,
                          imk_sinusoid *sinusoid);
/* The coefficients a line spreads over, skirts included. */
imki_line imki_line_widen(const imki_line *line, size_t n);
/* Variance of a line: its power in excess of its surroundings'. */
double imki_line_variance(const imki_line *line, size_t n, double dt, const double *cumulative);

/* spectral_shape.c: fits a resonance from a start; false when the line, of the given variance, is
 * not shaped like one. */
bool imki_shape_resonance(imk_resonance *resonance, double line_variance, size_t n, double dt,
                          const double *cumulative);

/* Frequency and quality on the whole spectrum, all amounts refitted at each point. */
void imki_resonance_refine(imki_fit *fit, const imki_bands *bands, size_t index,
                           imk_resonance *resonance);

/* output_filter.c: finds the filter (bandwidth 0: none) and leaves the fit at it. */
imk_low_pass imki_filter_find(imki_fit *fit, const imki_bands *bands);

/* gauss_markov_search.c: adds the Gauss-Markov terms that the likelihood asks for; returns how many
 * the fit then holds, with their correlation times. */
size_t imki_gauss_markov_find(imki_fit *fit, imki_fit *trial, const imki_bands *bands,
                              double *correlation_times);
/* Put the template of one term at a correlation time and refit. */
double imki_gauss_markov_set(imki_fit *fit, const imki_bands *bands, size_t term,
                             double correlation_time);
/* Best correlation time near a start, within a factor `reach`. */
double imki_gauss_markov_refine(imki_fit *fit, const imki_bands *bands, size_t term, double start,
                                double reach);

/* record_checks.c */
double imki_record_resolution(size_t n, const double *samples, double *scratch,
                              size_t scratch_count);
unsigned imki_record_verdict(size_t n, const double *samples, double resolution, double deviation);

/* Quality above which a resonance counts as a narrow line. */
#define IMKI_NARROW 50.0

/* Everything that one channel needs, laid out in the caller's workspace. */
typedef struct imki_work {
    const imk_identify_settings *settings;
    size_t n;
    double scale;         /* of samples and all that follows from them: record times scale */
    double *samples;      /* n: mean removed, later sinusoids subtracted */
    double *coefficients; /* n: cosine transform */
    double *cumulative;   /* n + 1: powers summed, later running sums */
    void *transform;
    size_t transform_size;
    imki_bands *bands;
    imki_fit *fit, *trial, *chosen;
    size_t line_count;
    imki_line lines[IMKI_LINES_MAX]; /* left out of the fit */
    double correlation_times[IMKI_GAUSS_MARKOV_MAX];
} imki_work;

/* The steps of imk_identify_channel(), in order, one file each. */
void imki_identify_transform(imki_work *w);
void imki_identify_lines(imki_work *w, imk_identification *result);
void imki_identify_terms(imki_work *w, imk_identification *result);
void imki_identify_intervals(imki_work *w, imk_identification *result);
void imki_identify_judge(imki_work *w, imk_identification *result);

#endif
