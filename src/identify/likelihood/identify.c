/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of one channel: checks and memory, then spectrum and lines (identify_lines.c), the
 * fit and the choice of terms (identify_terms.c), intervals (identify_intervals.c), and how far it
 * agrees with the Allan deviation (identify_verdict.c). */
#include "base/refuse_internal.h"
#include "identify/records/missing_internal.h"
#include "identify_internal.h"
#include "imukit/fourier.h"

#include <math.h>

enum { COOKIE = 0x1DE70001, SAMPLES_MIN = 256, SORTED = 65536 };

imk_identify_settings imk_identify_default(void)
{
    return (imk_identify_settings){
        .cookie = COOKIE, .confidence = 0.95, .significance = 0.01, .shape = true};
}

/* At most three quarters of a record may be missing. */
static size_t missing_maximum(size_t n)
{
    return n - n / 4;
}

static void lay_out(imki_work *w, size_t missing, imki_parts *parts)
{
    w->samples = imki_take(parts, (w->n + 1) * sizeof(double));
    w->coefficients = imki_take(parts, (w->n + 1) * sizeof(double));
    w->cumulative = imki_take(parts, (w->n + 1) * sizeof(double));
    w->points = imki_take(parts, IMKI_POINTS_MAX * sizeof(imk_allan_point));
    imki_work_take_fits(w, parts);
    w->transform_size = imk_cosine_workspace_size(w->n);
    w->transform = imki_take(parts, w->transform_size);
    void *place = imki_take(parts, missing > 0 ? imki_missing_size(missing) : 0);
    w->missing = place && missing > 0 ? imki_missing_place(place, missing) : NULL;
}

size_t imk_identify_workspace_size(size_t n)
{
    imki_work unused = {.n = n};
    imki_parts parts = imki_parts_of(NULL);
    lay_out(&unused, missing_maximum(n), &parts);
    return imki_parts_size(&parts);
}

/* Cut NaN off the ends of a record; returns how many at its start. A length with large prime
 * factors may need more memory than the whole did: then missing samples at the end stay, or, where
 * there are none, a few present ones go. */
static size_t trim(size_t *n, const double **samples)
{
    const size_t allowed = imk_identify_workspace_size(*n);
    size_t before = 0, end = *n;
    while (end > 0 && isnan((*samples)[end - 1]))
        end--;
    while (before < end && isnan((*samples)[before]))
        before++;
    size_t length = end - before;
    while (before + length < *n && imk_identify_workspace_size(length) > allowed)
        length++;
    while (length > 0 && imk_identify_workspace_size(length) > allowed)
        length--;
    *n = length;
    *samples += before;
    return before;
}

imk_status imki_identify_check(const imk_identify_settings *settings, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_identify_default()");
    if (!(settings->dt > 0) || !(settings->confidence > 0 && settings->confidence < 1) ||
        !(settings->significance > 0 && settings->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, confidence in (0, 1), significance in (0, 0.5)");
    return IMK_OK;
}

static imk_status check_arguments(const imk_identify_settings *settings, size_t n,
                                  const double *samples, size_t workspace_size, size_t *missing,
                                  imk_error *error)
{
    const imk_status status = imki_identify_check(settings, error);
    if (status != IMK_OK)
        return status;
    if (n < SAMPLES_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, NULL, NULL,
                             "record at least 256 samples; the slow terms need hours");
    if (workspace_size < imk_identify_workspace_size(n))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_identify_workspace_size() bytes");
    bool constant = true;
    *missing = 0;
    for (size_t i = 0; i < n; i++) {
        if (isnan(samples[i])) {
            ++*missing;
            continue;
        }
        if (!(fabs(samples[i]) < HUGE_VAL)) {
            imk_error_set(error, IMK_ERROR_NOT_FINITE, NULL, NULL, "remove or bridge such samples");
            if (error)
                error->index = i < INT32_MAX ? (int)i : -1;
            return IMK_ERROR_NOT_FINITE;
        }
        constant = constant && samples[i] == samples[0];
    }
    if (constant) {
        return imki_refuse(
            error, IMK_ERROR_CONSTANT, NULL, samples[0], 0.0,
            "check its wiring and driver: a working sensor never repeats itself for a "
            "whole record");
    }
    if (*missing > missing_maximum(n) || n - *missing < SAMPLES_MIN)
        return imk_error_set(
            error, IMK_ERROR_TOO_SHORT, NULL, NULL,
            "more than three quarters of the samples are missing, or fewer than 256 are left: "
            "check the sample rate, or analyse the parts separately");
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

/* The record without its mean, scaled, as the work's samples; NaN stays where it is. */
static void take_record(imki_work *w, const double *samples, imk_identification *result)
{
    double shifted = 0, squares = 0;
    size_t present = 0;
    for (size_t i = 0; i < w->n; i++)
        if (!isnan(samples[i])) {
            shifted += (samples[i] - samples[0]) * w->scale;
            present++;
        }
    const double mean = shifted / (double)present;
    for (size_t i = 0; i < w->n; i++) {
        w->samples[i] = (samples[i] - samples[0]) * w->scale - mean;
        squares += isnan(samples[i]) ? 0 : w->samples[i] * w->samples[i];
    }
    result->dt = w->settings->dt;
    result->mean = samples[0] + mean / w->scale;
    result->deviation = sqrt(squares / (double)(present - 1)) / w->scale;
}

/* The checks of the samples themselves, of those that are there. */
static void check_record(imki_work *w, const double *samples, imk_identification *found)
{
    size_t n = w->n;
    const double *present = samples;
    if (w->missing) {
        n = 0;
        for (size_t i = 0; i < w->n; i++)
            if (!isnan(samples[i]))
                w->cumulative[n++] = samples[i];
        present = w->cumulative;
    }
    found->resolution =
        imki_record_resolution(n, present, w->coefficients, n < SORTED ? n : SORTED);
    found->verdict = imki_record_verdict(n, present, found->resolution, found->deviation);
}

static void rescale(imk_estimate *e, double factor)
{
    e->value *= factor;
    e->sigma *= factor;
    e->lower *= factor;
    e->upper *= factor;
    e->free_value *= factor;
}

void imki_identification_rescale(imk_identification *result, double factor)
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
    result->rounding *= factor;
    result->plateau *= factor;
}

bool imki_identification_is_finite(const imk_identification *result)
{
    double sum = 0; /* not a number as soon as one of them is none, or infinite */
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *e = &result->term[term];
        sum += 0 * e->value + 0 * e->sigma + 0 * e->lower + 0 * e->upper;
    }
    return sum == 0;
}

bool imki_identification_is_a_model(const imk_identification *result, bool crowded)
{
    const bool nowhere = !(result->valid_from < HUGE_VAL);
    const bool white = result->term[IMK_NOISE_WHITE].present;
    return imki_identification_is_finite(result) && (white || !(nowhere || crowded));
}

static void find_terms(imki_work *w, imk_identification *found)
{
    w->line_count = 0;
    w->crowded = false;
    imki_identify_transform(w);
    if (w->settings->shape)
        imki_identify_lines(w, found);
    imki_identify_terms(w, found);
}

/* Missing samples again, with the spectrum just found; false when it has settled. */
static bool refill(imki_work *w, const double *samples, imk_identification *plain)
{
    take_record(w, samples, plain);
    imki_missing_draw(w->missing, w->samples);
    return imki_missing_refine(w, plain);
}

imk_status imk_identify_channel(const imk_identify_settings *settings, size_t n,
                                const double *samples, imk_identification *result, void *workspace,
                                size_t workspace_size, imk_error *error)
{
    size_t missing = 0;
    const size_t before = trim(&n, &samples);
    imk_status status = check_arguments(settings, n, samples, workspace_size, &missing, error);
    if (status == IMK_ERROR_NOT_FINITE && error && error->index >= 0)
        error->index = (size_t)error->index + before < INT32_MAX ? error->index + (int)before : -1;
    if (status != IMK_OK)
        return status;
    imki_work work = {.settings = settings, .n = n, .scale = scale_of(n, samples)}, *w = &work;
    imki_parts parts = imki_parts_of(workspace);
    lay_out(w, missing, &parts);
    imk_identification found = {0};
    take_record(w, samples, &found);
    check_record(w, samples, &found);
    if (w->missing)
        imki_missing_fill(w, &found);

    imk_identification plain = found;
    find_terms(w, &found);
    while (w->missing && refill(w, samples, &plain)) {
        found = plain;
        find_terms(w, &found);
    }
    imki_summary_save(w, settings->summary);
    imki_identify_intervals(w, &found);
    take_record(w, samples, &found); /* the lines may have been taken out */
    if (w->missing)
        imki_missing_draw(w->missing, w->samples);
    imki_identify_assess(w, &found);
    imki_identification_rescale(&found, 1 / w->scale);
    if (!imki_identification_is_a_model(&found, w->crowded))
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, "no noise in the record",
                             "a record of a real sensor: this one is smooth or too regular");
    *result = found;
    return IMK_OK;
}
