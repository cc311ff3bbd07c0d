/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of one channel: checks and memory, then spectrum and lines (identify_lines.c), the
 * fit and the choice of terms (identify_terms.c), intervals (identify_intervals.c), and how far it
 * agrees with the Allan deviation (identify_verdict.c). */
#include "identify_internal.h"
#include "imukit/fourier.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x1DE70001, SAMPLES_MIN = 256, SORTED = 65536 };

imk_identify_settings imk_identify_default(void)
{
    return (imk_identify_settings){
        .cookie = COOKIE, .confidence = 0.95, .significance = 0.01, .shape = true};
}

static size_t aligned(size_t size)
{
    return (size + 63) / 64 * 64;
}

size_t imk_identify_workspace_size(size_t n)
{
    return 64 + 3 * aligned((n + 1) * sizeof(double)) + aligned(sizeof(imki_bands)) +
           3 * aligned(sizeof(imki_fit)) + aligned(imk_cosine_workspace_size(n));
}

static void *take(char **memory, size_t size)
{
    void *start = *memory;
    *memory += aligned(size);
    return start;
}

static void lay_out(imki_work *w, void *workspace)
{
    char *memory = (char *)workspace + (64 - (uintptr_t)workspace % 64) % 64;
    w->samples = take(&memory, (w->n + 1) * sizeof(double));
    w->coefficients = take(&memory, (w->n + 1) * sizeof(double));
    w->cumulative = take(&memory, (w->n + 1) * sizeof(double));
    w->bands = take(&memory, sizeof(imki_bands));
    w->fit = take(&memory, sizeof(imki_fit));
    w->trial = take(&memory, sizeof(imki_fit));
    w->chosen = take(&memory, sizeof(imki_fit));
    w->transform_size = imk_cosine_workspace_size(w->n);
    w->transform = take(&memory, w->transform_size);
}

static imk_status check_arguments(const imk_identify_settings *settings, size_t n,
                                  const double *samples, size_t workspace_size, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_identify_default()");
    if (!(settings->dt > 0) || !(settings->confidence > 0 && settings->confidence < 1) ||
        !(settings->significance > 0 && settings->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, confidence in (0, 1), significance in (0, 0.5)");
    if (n < SAMPLES_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, NULL, NULL,
                             "record at least 256 samples; hours of them tell the slow terms");
    if (workspace_size < imk_identify_workspace_size(n))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_identify_workspace_size() bytes");
    bool constant = true;
    for (size_t i = 0; i < n; i++) {
        if (!(fabs(samples[i]) < HUGE_VAL)) {
            imk_error_set(error, IMK_ERROR_NOT_FINITE, NULL, NULL, "remove or bridge such samples");
            if (error)
                error->index = i < INT32_MAX ? (int)i : -1;
            return IMK_ERROR_NOT_FINITE;
        }
        constant = constant && samples[i] == samples[0];
    }
    if (constant) {
        imk_error_set(error, IMK_ERROR_CONSTANT, NULL, NULL,
                      "check its wiring and driver: a working sensor never repeats itself for a "
                      "whole record");
        if (error)
            error->value = samples[0];
        return IMK_ERROR_CONSTANT;
    }
    return IMK_OK;
}

/* A power of two that brings the record's span near 1, so that no square overflows or vanishes. */
static double scale_of(size_t n, const double *samples)
{
    double span = 0;
    int exponent;
    for (size_t i = 1; i < n; i++)
        span = fmax(span, fabs(samples[i] - samples[0]));
    frexp(span, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : exponent > 1000 ? -1000 : -exponent);
}

/* The record without its mean, scaled, as the work's samples. */
static void take_record(imki_work *w, const double *samples, imk_identification *result)
{
    double shifted = 0, squares = 0;
    for (size_t i = 0; i < w->n; i++)
        shifted += (samples[i] - samples[0]) * w->scale;
    const double mean = shifted / (double)w->n;
    for (size_t i = 0; i < w->n; i++) {
        w->samples[i] = (samples[i] - samples[0]) * w->scale - mean;
        squares += w->samples[i] * w->samples[i];
    }
    result->mean = samples[0] + mean / w->scale;
    result->deviation = sqrt(squares / (double)(w->n - 1)) / w->scale;
}

static void rescale(imk_estimate *e, double factor)
{
    e->value *= factor;
    e->sigma *= factor;
    e->lower *= factor;
    e->upper *= factor;
}

/* Back to the unit of the record. */
static void undo_scale(imk_identification *result, double factor)
{
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        rescale(&result->term[term], factor);
    for (int i = 0; i < result->gauss_markov_count; i++)
        rescale(&result->gauss_markov[i].sigma, factor);
    for (int i = 0; i < result->sinusoid_count; i++)
        result->sinusoid[i].amplitude *= factor;
    for (int i = 0; i < result->resonance_count; i++)
        result->resonance[i].sigma *= factor;
    result->minimum_floor *= factor;
}

static bool is_finite(const imk_identification *result)
{
    double sum = 0; /* not a number as soon as one of them is none, or infinite */
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *e = &result->term[term];
        sum += 0 * e->value + 0 * e->sigma + 0 * e->lower + 0 * e->upper;
    }
    return sum == 0;
}

imk_status imk_identify_channel(const imk_identify_settings *settings, size_t n,
                                const double *samples, imk_identification *result, void *workspace,
                                size_t workspace_size, imk_error *error)
{
    imk_status status = check_arguments(settings, n, samples, workspace_size, error);
    if (status != IMK_OK)
        return status;
    imki_work work = {.settings = settings, .n = n, .scale = scale_of(n, samples)}, *w = &work;
    lay_out(w, workspace);
    imk_identification found = {0};
    take_record(w, samples, &found);
    found.resolution = imki_record_resolution(n, samples, w->coefficients, n < SORTED ? n : SORTED);
    found.verdict = imki_record_verdict(n, samples, found.resolution, found.deviation);

    imki_identify_transform(w);
    if (settings->shape)
        imki_identify_lines(w, &found);
    imki_identify_terms(w, &found);
    imki_identify_intervals(w, &found);
    take_record(w, samples, &found); /* the lines may have been taken out */
    imki_identify_judge(w, &found);
    undo_scale(&found, 1 / w->scale);
    if (!is_finite(&found))
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, "no noise in the record",
                             "a record of a real sensor: this one is smooth or too regular");
    *result = found;
    return IMK_OK;
}
