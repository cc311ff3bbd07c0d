/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the identification of one channel: the cosine spectrum in bands, the likelihood fit of
 * its terms, and the search for lines, resonances and the output filter. */
#ifndef IMUKIT_IDENTIFY_INTERNAL_H
#define IMUKIT_IDENTIFY_INTERNAL_H

#include "base/logarithm_internal.h"
#include "base/workspace_internal.h"
#include "identify/records/screen_internal.h" /* the record's faults */
#include "imukit/identify.h"

enum {
    IMKI_SINGLE_BANDS = 64, /* lowest frequencies, one to a band */
    IMKI_BANDS_MAX = 2048,  /* bands in all */
    IMKI_GAUSS_MARKOV_MAX = IMK_TERMS_MAX,
    IMKI_TEMPLATES_MAX = 4 + IMKI_GAUSS_MARKOV_MAX + IMK_TERMS_MAX,
    IMKI_LINES_MAX = 2 * IMK_TERMS_MAX,
    IMKI_POINTS_MAX = 160 /* of an Allan deviation: ten a decade */
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
    size_t length[IMKI_BANDS_MAX];         /* samples of the transform behind it: n, or a segment */
    double power[IMKI_BANDS_MAX];          /* their mean square times dt: an estimate of S */
    double rounding;                       /* white noise of rounding the output; 0: none */
    size_t singles;                        /* leading bands of one coefficient, k = 1 … singles */
    double coefficient[IMKI_SINGLE_BANDS]; /* those coefficients, with sign */
    double ramp[IMKI_SINGLE_BANDS];        /* what a ramp of 1 unit/s adds to them */
    /* The rounding errors at the two ends of a quantized record add u_k a, u_k = sqrt(2/n)
     * cos(w/2)/dt, with one a for even k [0], another for odd k [1]. Sums over the band, times dt:
     * of u_k c_k and of u_k^2; 0 where `length` is not n. */
    double end_product[2][IMKI_BANDS_MAX], end_square[2][IMKI_BANDS_MAX];
} imki_bands;

/* What a coefficient of power P has less of log-likelihood, times two, where the spectrum is S than
 * where S = P: r - 1 - log r, r = P/S. The sum of log S + P/S over 1e6 samples is 1e7, whose last
 * digit is 2e-9; this one's is some hundred, so that a fit can tell steps that gain 1e-8. S is
 * between the least spectrum and its inverse. */
static const double IMKI_LEAST_SPECTRUM = 1e-150, IMKI_MOST_SPECTRUM = 1e150;
static inline double imki_deviance(double power, double spectrum)
{
    const double ratio = (power > IMKI_LEAST_SPECTRUM ? power : IMKI_LEAST_SPECTRUM) / spectrum;
    return ratio - 1 - imki_ln_of_normal(ratio, 0);
}

/* Spectrum and powers of a fit at the bands, and rows that its slope is summed with. */
typedef struct imki_evaluation {
    double spectrum[IMKI_BANDS_MAX];
    double power[IMKI_BANDS_MAX]; /* without ramp and ends */
    double weight[IMKI_BANDS_MAX], product[IMKI_BANDS_MAX];
    double end_slope; /* of the likelihood in Q^2 by the ends' variance alone */
    double end_information;
    double log_likelihood;
} imki_evaluation;

/* Spectral model: S = sum of amount[j] * shape[j], amount >= 0, plus a ramp in the mean. */
typedef struct imki_fit {
    size_t templates;
    double shape[IMKI_TEMPLATES_MAX][IMKI_BANDS_MAX]; /* for amount 1 */
    bool active[IMKI_TEMPLATES_MAX];
    double amount[IMKI_TEMPLATES_MAX]; /* squares: Q^2, N^2, B^2, K^2, sigma^2 */
    double floor;                      /* known part of S: what comes after the filter */
    bool ramp_active;
    double ramp;                                    /* [unit/s] */
    double correlation_time[IMKI_GAUSS_MARKOV_MAX]; /* [s], of the shapes; 0: no shape yet */
    double log_likelihood;
    double sine_square[IMKI_BANDS_MAX];                   /* sin^2(pi f dt) at the bands */
    double change[IMKI_GAUSS_MARKOV_MAX][IMKI_BANDS_MAX]; /* scratch: d S/d log correlation time */
    imki_evaluation evaluation;                           /* scratch of spectral_fit.c */
} imki_fit;

/* A fit but for its shapes: cheap to keep and to go back to. */
typedef struct imki_amounts {
    bool active[IMKI_TEMPLATES_MAX], ramp_active;
    double amount[IMKI_TEMPLATES_MAX], ramp, correlation_time[IMKI_GAUSS_MARKOV_MAX];
    double log_likelihood;
} imki_amounts;

/* golden_section.c: place of the highest value between low and high, which should hold one peak. */
typedef double (*imki_height)(void *context, double place);
double imki_peak(imki_height height, void *context, double low, double high, int sections);

/* Part of the frequencies, seen by one cosine transform or by the mean power of several. */
typedef struct imki_spectrum {
    size_t n; /* points of the transform */
    double dt;
    size_t length;              /* samples behind them */
    size_t first, end;          /* coefficients to use: first … end - 1 */
    double squares;             /* averaged in each coefficient's power */
    const double *coefficients; /* with sign; NULL for mean powers */
    const double *cumulative;   /* cumulative[k] = sum of power times dt over 1 <= i < k */
    size_t line_count;
    const imki_line *lines; /* left out */
} imki_spectrum;

/* cosine_spectrum.c */
/* Add the bands of a part; count, singles, n and dt are the caller's to start with. */
void imki_bands_add(imki_bands *bands, const imki_spectrum *spectrum, size_t resonance_count,
                    const imk_resonance *resonances);
/* Bands of a whole record, n + 1 values of cumulative. */
void imki_bands_build(imki_bands *bands, size_t n, double dt, const double *coefficients,
                      const double *cumulative, size_t line_count, const imki_line *lines,
                      size_t resonance_count, const imk_resonance *resonances);

/* Give a band so many times its weight in the likelihood. */
void imki_bands_weigh(imki_bands *bands, size_t b, double factor);

/* Spectra of unit resonances and of filtered white noise of unit density at the bands. */
void imki_resonance_shape(double frequency, double q, const imki_bands *bands, double *shape);
void imki_filter_shape(imk_low_pass filter, const imki_bands *bands, double *shape);
/* The white template of a fit through a filter (bandwidth 0: none), and the floor: the output is
 * rounded after the filter. Without one, the rounding is part of the white noise. */
void imki_fit_set_filter(imki_fit *fit, imk_low_pass filter, const imki_bands *bands);

/* spectral_fit.c: all return the log-likelihood, and leave it in the fit. */
double imki_fit_maximise(imki_fit *fit, const imki_bands *bands);
/* The same with one amount (or the ramp: index IMK_NOISE_RAMP when `ramp`) held at a value. */
double imki_fit_profile(imki_fit *fit, const imki_bands *bands, int held, double value);
/* Covariance of the active amounts, templates x templates, row-major; zero for the others. */
void imki_fit_covariance(imki_fit *fit, const imki_bands *bands, double *covariance);
/* Degrees of freedom v of a function of the amounts, given its value and slope: of the chi-square
 * whose variance is the same part 2/v of its square [SATTERTHWAITE1946]; at most 1e6. */
double imki_fit_degrees(imki_fit *fit, const imki_bands *bands, double value, const double *slope);
/* Of the ramp's estimate: the inverse of its variance, and the degrees of freedom of that, less the
 * one that the ramp takes. */
double imki_fit_ramp_information(const imki_fit *fit, const imki_bands *bands);
double imki_fit_ramp_degrees(imki_fit *fit, const imki_bands *bands);
double imki_fit_spectrum(const imki_fit *fit, size_t band);
imki_amounts imki_fit_keep(const imki_fit *fit);
/* Shapes of Gauss-Markov templates whose time has changed since are made again. */
void imki_fit_restore(imki_fit *fit, const imki_bands *bands, const imki_amounts *kept);
void imki_fit_copy(imki_fit *to, const imki_fit *from, const imki_bands *bands);
/* Log-likelihood's gradient and information over `count` columns of d S/d parameter, at the fit. */
void imki_fit_slope(imki_fit *fit, const imki_bands *bands, size_t count,
                    const double *const *columns, double *gradient, double *information);
enum { IMKI_HELD_NONE = -1, IMKI_HELD_RAMP = -2 };

/* spectral_lines.c */
/* @param squares  squares averaged in each coefficient's power: 1 for a whole record */
size_t imki_lines_find(size_t n, const double *cumulative, double squares, imki_line *lines);
/* Do the skirts of a line reach more than half-way to frequency 0? */
bool imki_line_is_strong(const imki_line *line);
/* The coefficients a line spreads over, skirts included, but of a strong one no more than half-way
 * to frequency 0. */
imki_line imki_line_widen(const imki_line *line, size_t n);
/* Variance of a line: its power in excess of its surroundings'. */
double imki_line_variance(const imki_line *line, size_t n, double dt, const double *cumulative);

/* sinusoids.c: a tone c cos + s sin of 2 pi cycles (i - (n - 1)/2) at sample i. */
typedef struct imki_sinusoid {
    double cycles; /* per sample */
    double c, s;
} imki_sinusoid;
double imki_sinusoid_amplitude(const imki_sinusoid *tone);
/* Fit and subtract a tone near `cycles`; false, and nothing subtracted, when it holds less than 0.6
 * of the line's variance. */
bool imki_sinusoid_remove(size_t n, double cycles, double variance, double *samples,
                          imki_sinusoid *tone);
/* Tones that were subtracted, fitted again together; the samples are what they leave. */
void imki_sinusoids_refine(size_t n, double *samples, size_t count, imki_sinusoid *tones);

/* spectral_shape.c: fits a resonance from a start; false when the line, of the given variance, is
 * not shaped like one. */
bool imki_shape_resonance(imk_resonance *resonance, double line_variance, size_t n, double dt,
                          const double *cumulative);

/* output_filter.c: finds the filter (bandwidth 0: none) and leaves the fit at it. */
imk_low_pass imki_filter_find(imki_fit *fit, const imki_bands *bands);

/* spectral_templates.c: shapes of the four random terms, and of a Gauss-Markov term of unit
 * variance. */
void imki_templates_set(imki_fit *fit, const imki_bands *bands);
void imki_gauss_markov_shape(const imki_fit *fit, const imki_bands *bands, double correlation_time,
                             double *shape);

/* gauss_markov_search.c: correlation time at which one more term brings the likelihood most, left
 * in the fit with its amount; false, and the fit as it was, when none brings `gain`. */
bool imki_gauss_markov_add(imki_fit *fit, const imki_bands *bands, double gain);
/* Correlation times of all active terms and everything else at the maximum of the likelihood; one
 * amount, or one correlation time, may be held where it is. */
double imki_gauss_markov_settle(imki_fit *fit, const imki_bands *bands, int held, int held_time);
/* Range of correlation times [s] that a record can tell; false when there is none. */
bool imki_gauss_markov_range(const imki_bands *bands, double *shortest, double *longest);

/* term_search.c: the set of terms with the largest likelihood less its penalties. */
typedef struct imki_penalties {
    double term;         /* a strength */
    double gauss_markov; /* a strength and a correlation time */
    double significance; /* of a ramp */
} imki_penalties;
imki_penalties imki_penalties_of(const imki_bands *bands, double significance);
/* The likeliest set that the search has met for each number of Gauss-Markov terms (the last: that
 * many or more), without and with a ramp; -infinity: none. Bias instability and random walk do not
 * divide the sets: intervals have them free in any case. */
enum { IMKI_ALTERNATIVE_COUNTS = 4 };
typedef struct imki_alternatives {
    double log_likelihood[2][IMKI_ALTERNATIVE_COUNTS];
    imki_amounts set[2][IMKI_ALTERNATIVE_COUNTS];
} imki_alternatives;
/* Returns the likelihood less the penalties of the set, which is left in the fit. */
double imki_terms_choose(imki_fit *fit, const imki_bands *bands, const imki_penalties *penalties,
                         imki_alternatives *met);

/* Damping above which the second order's faster pole is far above the other: first order. */
#define IMKI_OVERDAMPED 3.0

/* Step of the output, in Allan deviations at one sample, up to which rounding errors are white: of
 * unfiltered noise (1.6 standard deviations, or 2.1 for the angle), of filtered noise. */
#define IMKI_STEP_WHITE 1.45
#define IMKI_STEP_FILTERED 2.2

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
    imki_alternatives *alternatives, *spare; /* of the search that chose the terms; of another */
    size_t line_count;
    imki_line lines[IMKI_LINES_MAX]; /* left out of the fit */
    bool crowded;                    /* more lines were left when IMKI_LINES_MAX tones were out */
    int resonant_lines;              /* first resonances of the result that were lines: those behind
                                      * them may stand for any shape */
    struct imki_missing *missing;    /* missing_internal.h; NULL: none are */
    bool bands_given;                /* several records: the bands are there already */
    /* A long record instead comes as the spectra of two scales and its Allan deviations,
     * ascending; 0 of them: as samples. From factor block_from on, windows start every `block`
     * samples; 0: at every one. */
    size_t spectrum_count, point_count;
    const imki_spectrum *spectra;
    size_t block, block_from;
    imk_allan_point *points; /* room for IMKI_POINTS_MAX */
} imki_work;

static inline void imki_work_take_fits(imki_work *w, imki_parts *parts)
{
    w->bands = imki_take(parts, sizeof *w->bands);
    w->fit = imki_take(parts, sizeof *w->fit);
    w->trial = imki_take(parts, sizeof *w->trial);
    w->chosen = imki_take(parts, sizeof *w->chosen);
    w->alternatives = imki_take(parts, sizeof *w->alternatives);
    w->spare = imki_take(parts, sizeof *w->spare);
}

/* A likelihood held at places of one parameter: a strength (by its square root), the ramp, or the
 * correlation time of a Gauss-Markov term (by its logarithm). */
typedef struct imki_interval_profile {
    imki_fit *fit;
    const imki_bands *bands;
    int held, held_time;
    imki_amounts best;
    double top;  /* log-likelihood there */
    double drop; /* of the log-likelihood, at the interval's end */
} imki_interval_profile;
/* profile_interval.c: below 0 inside the interval. The fit is left at the place. */
double imki_interval_beyond(const imki_interval_profile *p, double place);
/* End of the interval in the direction of `step`, at most at `limit`. */
double imki_interval_end(const imki_interval_profile *p, double start, double step, double limit);
/* A profile of a strength or of the ramp around the maximum at which the fit is, with its centre
 * and a first step from it. */
imki_interval_profile imki_interval_profile_at(const imki_work *w, int held, double drop,
                                               double *centre, double *step);
/* What a drop is multiplied by where the variance of a mean is known with v degrees. */
double imki_student_factor(double v);
/* White noise, bias instability, random walk and a term free as well; everything fitted again. */
void imki_intervals_free(imki_work *w, int term);
/* Quantization out of the fit, or into it; everything fitted again. */
void imki_quantization_switch(imki_work *w);

/* alternative_intervals.c: intervals that hold for the other sets of terms, too, that explain the
 * record about as well; the fit is left as it was. */
void imki_intervals_join(imki_work *w, imk_identification *result, double drop);
/* The interval of white noise covers what resonances that stand for the filter's shape have of it.
 */
void imki_intervals_join_shape(const imki_work *w, imk_identification *result);

/* fast_shape.c: fits the filter and the wide resonances jointly with all amounts, and adds the
 * resonances that the residuals ask for; returns how many. Uses `trial` and `chosen`. */
int imki_fast_shape_refine(imki_work *w, imk_identification *result);
/* joint_shape.c: sigmas and intervals of the random terms, found with filter and resonances held,
 * times what these add to their uncertainty. */
void imki_identify_widen(imki_work *w, imk_identification *result);

/* What a joint estimate needs of a record. */
enum { IMKI_SUMMARY_COOKIE = 0x5A3A0001 };
struct imk_spectral_summary {
    uint32_t cookie;
    double scale;     /* of the record: the bands are of the record times it */
    imki_bands bands; /* without ramp; singles and ends are 0 */
};

/* spectral_summary.c: filled after the terms are found; NULL: nothing. */
void imki_summary_save(const imki_work *w, imk_spectral_summary *summary);

/* The steps of imk_identify_channel(), in order, one file each. */
void imki_identify_transform(imki_work *w);
void imki_identify_lines(imki_work *w, imk_identification *result);
void imki_identify_bands(imki_work *w, const imk_identification *result);
void imki_identify_terms(imki_work *w, imk_identification *result);
void imki_identify_intervals(imki_work *w, imk_identification *result);
void imki_identify_assess(imki_work *w, imk_identification *result);

/* identify_level.c: compares the lowest frequencies with the fit. */
void imki_identify_level(imki_work *w, imk_identification *result);

/* identify_agreement.c: the longest range of tau [s] over which measured deviations agree with the
 * model of the result; infinite `from` when there is none. */
void imki_agreement(const imki_work *w, const imk_identification *result, size_t count,
                    const imk_allan_point *points, double *from, double *to);

/* Is the ratio of a measured Allan variance to the expected one inside its range, but for a
 * probability of at most `tail` on each side? edf: degrees of freedom under the model, > 0. */
bool imki_allan_is_likely(double ratio, double edf, double tail);

/* identify_lines.c: enter a line that is no subtracted tone as a resonance or, where it is not
 * shaped like one, as a sinusoid at `frequency`; true when it is to be left out of the fit.
 * @param narrowest  half-power width [Hz] that the transform tells from a tone */
bool imki_line_describe(const imki_line *line, size_t n, double dt, const double *cumulative,
                        double frequency, double narrowest, imk_identification *result);

/* identify.c: what all ways in share. */
imk_status imki_identify_check(const imk_identify_settings *settings, imk_error *error);
/* Strengths of everything random, and of the ramp, times a factor. */
void imki_identification_rescale(imk_identification *result, double factor);
bool imki_identification_is_finite(const imk_identification *result);
/* Finite, and a description of the record: not one that finds no white noise and agrees with the
 * record at no averaging time, or finds none under a comb of more tones than it takes out. */
bool imki_identification_is_a_model(const imk_identification *result, bool crowded);

#endif
