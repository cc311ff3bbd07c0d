/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the spectral density: the division into segments, windows, eigenspectra. */
#ifndef IMUKIT_SPECTRUM_INTERNAL_H
#define IMUKIT_SPECTRUM_INTERNAL_H

#include "imukit/spectrum.h"

/* Segments overlap by at most 0.9, so no more than ten share a sample. */
enum { IMKI_LAGS_MAX = 16 };

/* How a record is cut, and what is in the workspace. */
typedef struct imki_segments {
    const imk_spectrum_settings *settings;
    size_t n, length, hop, count; /* samples; of a segment; to the next; segments */
    int tapers;                   /* 1 for Welch */
} imki_segments;

/* False when the settings do not allow any: the error says why. */
imk_status imki_segments_plan(const imk_spectrum_settings *settings, size_t n,
                              imki_segments *segments, imk_error *error);

/* spectrum_window.c: `length` values of unit energy. */
void imki_window_fill(const imk_spectrum_settings *settings, size_t length, double *window);
/* Equivalent noise bandwidth [bins] of a long window, and of the tapers together. */
double imki_window_bandwidth(const imk_spectrum_settings *settings);
/* Bins from the peak of the window's transform to its first zero. */
double imki_window_lobe(const imk_spectrum_settings *settings);
/* Root second moment [bins] of the squared transform of a window of unit energy. */
double imki_window_blur(const imk_spectrum_settings *settings, size_t length, const double *window);

/* spectrum_multitaper.c: one segment's adaptive estimate from its eigencoefficients.
 * @param eigen  tapers x count complex numbers, scaled so that |.|^2 is a density
 * @param sums   tapers: sums of the tapers (0 for the odd ones, by symmetry)
 * @param variance  of the segment times dt: the density of white noise of the same power */
void imki_multitaper_add(int tapers, size_t count, const double *eigen, const double *concentration,
                         bool adaptive, double variance, double *density, double *degrees);
/* Numerator and denominator of the F ratio, added up. */
void imki_harmonic_add(int tapers, size_t count, const double *eigen, const double *sums,
                       double *explained, double *rest);

/* spectrum_line_refine.c: a sinusoid near line->frequency over the whole record. */
typedef struct imki_tone {
    size_t n, block, count; /* samples; of a block; blocks */
    double dt;
    const double *samples;
    double *re, *im, *weight; /* count each */
    size_t padded;            /* points of the transform of the block sums */
    double *transform;        /* 2 padded */
    void *scratch;
    size_t scratch_size;
} imki_tone;
void imki_line_refine(const imk_spectrum *spectrum, imki_tone *tone, imk_spectrum_line *line);
/* Lay a tone out from `memory`, or only count: the bytes it takes. */
size_t imki_tone_lay_out(const imk_spectrum *spectrum, size_t n, double *memory, imki_tone *tone);

#endif
