/* SPDX-License-Identifier: Apache-2.0 */
/* From what was gathered of a long record to its identification: the last segment, the slow
 * spectrum, Allan deviations, lines; then the same fit, intervals and verdict as for a record that
 * was transformed as a whole. */
#include "base/refuse_internal.h"
#include "imukit/fourier.h"
#include "long_record_internal.h"

#include <math.h>
#include <string.h>

enum { SEGMENTS_LEAST = 8, LARGEST_PRIME = 13 };

/* Has n no prime factor above 13? Other lengths take the transform ten times as long. */
static bool is_smooth(size_t n)
{
    for (size_t prime = 2; prime <= LARGEST_PRIME; prime++)
        while (n % prime == 0)
            n /= prime;
    return n == 1;
}

/* Means to transform: an even number with small factors, at most a thousandth below; else all. */
static size_t transform_length(size_t means)
{
    for (size_t n = means / 2 * 2; n > means - means / 1000 - 2; n -= 2)
        if (is_smooth(n))
            return n;
    return means;
}

typedef struct parts {
    size_t points, transform_size, total;
} parts;

/* Means when the samples that wait in the buffer will have been handled. */
static size_t means_at_end(const imk_identify_record *r)
{
    const size_t waiting = r->filled - r->handled;
    const bool joined = r->mean_count == r->sizes.capacity && waiting >= r->block;
    return joined ? r->mean_count / 2 + waiting / (2 * r->block)
                  : r->mean_count + waiting / r->block;
}

static parts parts_of(const imk_identify_record *r)
{
    const size_t means = means_at_end(r);
    parts p = {.points = transform_length(means)};
    p.transform_size = imk_cosine_workspace_size(p.points);
    p.total = 64 + 2 * imki_aligned((means + 1) * sizeof(double)) + imki_aligned(p.transform_size) +
              imki_aligned(IMKI_POINTS_MAX * sizeof(imk_allan_point)) +
              imki_aligned(sizeof(imki_bands)) + 3 * imki_aligned(sizeof(imki_fit)) +
              2 * imki_aligned(sizeof(imki_alternatives)) +
              imki_aligned(sizeof(imki_record_spectra));
    return p;
}

size_t imk_identify_record_workspace_size(const imk_identify_record *record)
{
    return parts_of(record).total;
}

/* Weight and degrees of the segments' powers. The samples behind the last whole segment make one
 * more with those before them, a share w of it new; its coefficients are correlated with the last
 * one's by about 1 - w:
 *
 *     degrees = (s + w)^2/(s + w^2 + 2 w (1 - w)^2)
 */
static void add_last_segment(imk_identify_record *r, double *weight, double *degrees)
{
    const size_t n = r->sizes.segment, rest = r->filled;
    const double s = (double)r->segments;
    *weight = *degrees = s;
    if (rest == 0 || r->missing_here + r->missing_before > n / 100)
        return;
    const double w = (double)rest / (double)n;
    memcpy(r->spectrum, r->buffer + rest, (n - rest) * sizeof(double));
    memcpy(r->spectrum + (n - rest), r->buffer, rest * sizeof(double));
    imki_record_transform(r);
    for (size_t k = 0; k < n; k++)
        r->power[k] += w * r->spectrum[k] * r->spectrum[k];
    *weight = s + w;
    *degrees = (s + w) * (s + w) / (s + w * w + 2 * w * (1 - w) * (1 - w));
}

static imk_status check_record(const imk_identify_record *r, const imk_identify_settings *settings,
                               size_t empty, size_t workspace_size, imk_error *error)
{
    const imk_status status = imki_identify_check(settings, error);
    if (status != IMK_OK)
        return status;
    if (r->samples < SEGMENTS_LEAST * r->sizes.segment)
        return imk_error_set(
            error, IMK_ERROR_TOO_SHORT, NULL, NULL,
            "use imk_identify_channel() for records of fewer than half a million samples");
    if (workspace_size < imk_identify_record_workspace_size(r))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_identify_record_workspace_size() bytes");
    if (r->checks.high.distinct == 1) {
        return imki_refuse(
            error, IMK_ERROR_CONSTANT, NULL, r->checks.high.value[0] / r->scale + r->shift, 0.0,
            "check its wiring and driver: a working sensor never repeats itself for a "
            "whole record");
    }
    if (r->segments <= r->skipped || empty > r->mean_count / 20)
        return imk_error_set(error, IMK_ERROR_GAP, NULL, NULL,
                             "a stretch with less than a hundredth of its samples missing, or "
                             "imk_identify_channel() for a shorter one");
    return IMK_OK;
}

/* Mean, deviation and the checks, in the unit of the scaled samples but for mean and deviation. */
static void describe_samples(const imk_identify_record *r, imk_identification *result)
{
    const double n = (double)(r->samples - r->missing), mean = r->sum / n;
    const double deviation = sqrt(fmax(0, r->squares - r->sum * mean) / (n - 1));
    result->mean = mean / r->scale + r->shift;
    result->deviation = deviation / r->scale;
    result->resolution = r->checks.resolution / r->scale;
    result->verdict = imki_record_checked(&r->checks, r->samples, deviation);
    result->verdict |=
        imki_record_verdict(r->mean_count, r->means, 0, deviation) & IMK_VERDICT_WARM_UP;
}

/* Allan deviations of the record, and cosine coefficients of its means. */
static size_t transform_means(imk_identify_record *r, const imk_identify_settings *settings,
                              size_t points, double *coefficients, double *sums, void *transform,
                              size_t transform_size, imk_allan_point *measured)
{
    imk_allan_sums(r->mean_count, r->means, sums, NULL);
    const size_t count = imki_record_allan_points(r, sums, IMK_ALLAN_DECADE, settings->confidence,
                                                  r->samples / 9, IMKI_POINTS_MAX, measured);
    r->octave_count = imki_record_allan_points(r, sums, IMK_ALLAN_OCTAVE, settings->confidence,
                                               r->samples / 2, IMKI_OCTAVES, r->octave);
    memcpy(coefficients, r->means, points * sizeof(double));
    (void)imk_cosine(points, coefficients, transform, transform_size); /* sized for it */
    return count;
}

static void rescale_points(imk_identify_record *r)
{
    for (size_t i = 0; i < r->octave_count; i++) {
        r->octave[i].deviation /= r->scale;
        r->octave[i].lower /= r->scale;
        r->octave[i].upper /= r->scale;
    }
}

imk_status imk_identify_record_finish(imk_identify_record *r, const imk_identify_settings *settings,
                                      imk_identification *result, void *workspace,
                                      size_t workspace_size, imk_error *error)
{
    imki_record_flush(r);
    size_t empty = 0;
    for (size_t i = 0; i < r->mean_count; i++)
        empty += r->means[i] != r->means[i];
    imk_status status = check_record(r, settings, empty, workspace_size, error);
    if (status != IMK_OK)
        return status;
    imki_record_bridge(r->mean_count, r->means, 1, 0);
    imk_identification found = {0};
    describe_samples(r, &found);
    found.dt = settings->dt;

    const parts p = parts_of(r);
    imki_parts room = imki_parts_of(workspace);
    double *coefficients = imki_take(&room, (r->mean_count + 1) * sizeof(double));
    double *cumulative = imki_take(&room, (r->mean_count + 1) * sizeof(double));
    void *transform = imki_take(&room, p.transform_size);
    imki_record_spectra *spectra = imki_take(&room, sizeof *spectra);
    imki_work work = {.settings = settings, .n = p.points * r->block, .scale = r->scale};
    work.points = imki_take(&room, IMKI_POINTS_MAX * sizeof(imk_allan_point));
    work.point_count = transform_means(r, settings, p.points, coefficients, cumulative, transform,
                                       p.transform_size, work.points);
    work.block = r->block;
    work.block_from = IMKI_STRIDE_ONE;
    work.spectrum_count = 2;
    work.spectra = spectra->part;
    imki_work_take_fits(&work, &room);

    double weight, degrees;
    add_last_segment(r, &weight, &degrees);
    const double present = 1 - (double)empty / (double)r->mean_count;
    imki_record_spectra_make(r, settings->dt, weight, degrees, present, p.points, coefficients,
                             cumulative, spectra);
    if (settings->shape)
        imki_record_lines(spectra, &found);
    imki_identify_terms(&work, &found);
    imki_summary_save(&work, settings->summary);
    imki_identify_intervals(&work, &found);
    imki_identify_assess(&work, &found);
    imki_identification_rescale(&found, 1 / r->scale);
    rescale_points(r);
    imk_noise_map_end(r->map);
    imk_noise_map_rescale(r->map, 1 / r->scale);
    if (!imki_identification_is_a_model(&found, false))
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, "no noise in the record",
                             "a record of a real sensor: this one is smooth or too regular");
    *result = found;
    return IMK_OK;
}
