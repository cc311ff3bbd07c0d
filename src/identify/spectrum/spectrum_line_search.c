/* SPDX-License-Identifier: Apache-2.0 */
/* Spectral lines by what stands out of a spectrum.
 *
 * The level of a bin's surroundings is the median of the bins about it, which a monotonic spectrum
 * leaves unbiased and lines do not touch. Without a line the bin over the level is nearly a ratio
 * of mean squares (F): its own degrees of freedom above, those of the median below. With the
 * multitaper estimator Thomson's F ratio is a second test; the chances are halved between the two,
 * and divided by the number of independent bins, so that the rate of false alarms is that of the
 * whole record. */
#include "spectrum_internal.h"

#include "base/workspace_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

/* REACH bins on either side make the level; below FIRST_BIN there are too few to tell a line from
 * slow noise. The median of m normal values has 2/pi of the information of their mean. */
enum { REACH = 128, FIRST_BIN = 16, GAP = 2 };
static const double MEDIAN_EFFICIENCY = 0.6366, PI = 3.14159265358979323846;

/* ---- level ----------------------------------------------------------------------------------- */

/* A window of values in order, moved one bin at a time. */
typedef struct running_median {
    size_t count, first, last; /* bins first … last are in it */
    double sorted[2 * REACH + 1];
} running_median;

static size_t place_of(const running_median *m, double value)
{
    size_t low = 0, high = m->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (m->sorted[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void insert(running_median *m, double value)
{
    const size_t at = place_of(m, value);
    memmove(m->sorted + at + 1, m->sorted + at, (m->count - at) * sizeof *m->sorted);
    m->sorted[at] = value;
    m->count++;
}

static void take_out(running_median *m, double value)
{
    const size_t at = place_of(m, value);
    m->count--;
    memmove(m->sorted + at, m->sorted + at + 1, (m->count - at) * sizeof *m->sorted);
}

static void surroundings(const imk_spectrum *s, size_t bin, size_t *first, size_t *last)
{
    const size_t reach = bin / 2 < REACH ? bin / 2 : REACH;
    const size_t above = s->count - 2 - bin; /* the last bin has half the degrees */
    *last = bin + (above < reach ? above : reach);
    *first = bin - reach;
}

static double middle_of(const double *sorted, size_t count)
{
    return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

/* Median of chi-square over its degrees. */
static double unit_median(double degrees)
{
    return imk_chi_square_quantile(0.5, degrees) / degrees;
}

/* Levels of all bins, in one sweep. */
static void all_levels(const imk_spectrum *s, double *level)
{
    running_median m = {.first = FIRST_BIN - FIRST_BIN / 2, .last = FIRST_BIN - FIRST_BIN / 2 - 1};
    double degrees = 0, unit = 1;
    for (size_t bin = FIRST_BIN; bin + 2 < s->count; bin++) {
        size_t first, last;
        surroundings(s, bin, &first, &last);
        while (m.first < first)
            take_out(&m, s->density[m.first++]);
        while (m.last < last)
            insert(&m, s->density[++m.last]);
        if (s->degrees[bin] != degrees) {
            degrees = s->degrees[bin];
            unit = unit_median(degrees);
        }
        level[bin] = middle_of(m.sorted, m.count) / unit;
    }
}

/* ---- candidates ------------------------------------------------------------------------------ */

typedef struct search {
    const imk_spectrum *spectrum;
    const double *level;
    double chance; /* of a bin: the record's false-alarm rate over tests and bins */
    double tests;  /* independent bins times tests */
    double normal_limit, harmonic_limit; /* standard normal value and F ratio of that chance */
} search;

static double level_degrees(const imk_spectrum *s, size_t bin)
{
    size_t first, last;
    surroundings(s, bin, &first, &last);
    return s->degrees[bin] * fmax(1, (double)(last - first + 1) / s->correlation) *
           MEDIAN_EFFICIENCY;
}

static double chance_of(const search *q, size_t bin)
{
    const imk_spectrum *s = q->spectrum;
    double chance =
        imk_f_upper(s->density[bin] / q->level[bin], s->degrees[bin], level_degrees(s, bin));
    if (s->harmonic)
        chance = fmin(
            chance, imk_f_upper(s->harmonic[bin], s->harmonic_degrees[0], s->harmonic_degrees[1]));
    return chance;
}

/* Most bins are nowhere near. A ratio of mean squares is skewed upwards, so one that is as rare as
 * asked for stands out further than a normal value would: anything below needs no distribution. */
static bool stands_out(const search *q, size_t bin)
{
    const imk_spectrum *s = q->spectrum;
    const double spread = sqrt(2 / s->degrees[bin]);
    if (s->harmonic && s->harmonic[bin] > q->harmonic_limit)
        return true;
    return s->density[bin] > (1 + q->normal_limit * spread) * q->level[bin] &&
           chance_of(q, bin) < q->chance;
}

/* The line about a peak: bins that stand out, with gaps of up to GAP, and the main lobe. */
static imk_spectrum_line make_line(const search *q, size_t first, size_t last)
{
    const imk_spectrum *s = q->spectrum;
    size_t peak = first;
    double chance = 1;
    for (size_t bin = first; bin <= last; bin++) {
        peak = s->density[bin] > s->density[peak] ? bin : peak;
        chance = fmin(chance, chance_of(q, bin));
    }
    const size_t lobe = (size_t)ceil(s->blur_bins);
    imk_spectrum_line line = {.first = first < peak - lobe ? first : peak - lobe,
                              .last = last > peak + lobe ? last : peak + lobe,
                              .frequency = (double)peak * s->step,
                              .density = s->density[peak],
                              .level = q->level[peak],
                              .false_alarm = fmin(1, chance * q->tests)};
    line.last = line.last < s->count - 1 ? line.last : s->count - 1;
    return line;
}

static void keep(size_t capacity, imk_spectrum_line *lines, size_t *count, imk_spectrum_line line)
{
    if (*count < capacity) {
        lines[(*count)++] = line;
        return;
    }
    size_t least = 0; /* the list is full: the one that stands out least goes */
    for (size_t i = 1; i < capacity; i++)
        least = lines[i].density * lines[least].level < lines[least].density * lines[i].level
                    ? i
                    : least;
    if (capacity > 0 && lines[least].density * line.level < line.density * lines[least].level) {
        memmove(lines + least, lines + least + 1, (capacity - least - 1) * sizeof *lines);
        lines[capacity - 1] = line;
    }
}

static void find(const search *q, size_t capacity, imk_spectrum_line *lines, size_t *count)
{
    const imk_spectrum *s = q->spectrum;
    const size_t end = s->count > 2 ? s->count - 2 : 0;
    size_t first = 0, last = 0;
    for (size_t bin = FIRST_BIN; bin < end; bin++) {
        if (!stands_out(q, bin))
            continue;
        if (first > 0 && bin > last + GAP + 1) {
            keep(capacity, lines, count, make_line(q, first, last));
            first = 0;
        }
        first = first > 0 ? first : bin;
        last = bin;
    }
    if (first > 0)
        keep(capacity, lines, count, make_line(q, first, last));
}

/* ---- from the spectrum alone ----------------------------------------------------------------- */

/* Power above the level: frequency is its centroid; amplitude by a^2/2 = 2 sum (S - level) df (both
 * sides). The width is that of a Lorentzian peak of this power and height, pi/2 times its
 * half-power width, less the window's. Over a duration D a line of width w fluctuates by 1/sqrt(w
 * D). */
static void measure(const search *q, imk_spectrum_line *line)
{
    const imk_spectrum *s = q->spectrum;
    double power = 0, moment = 0, noise = 0;
    for (size_t bin = line->first; bin <= line->last; bin++) {
        const double excess = s->density[bin] - line->level;
        power += excess;
        moment += excess * ((double)bin - line->frequency / s->step);
        noise += 2 * line->level * line->level / s->degrees[bin];
    }
    const double height = line->density - line->level;
    power = fmax(power, 1e-3 * line->density);
    if (fabs(moment / power) <= (double)(line->last - line->first))
        line->frequency += moment / power * s->step;
    if (height > 0)
        line->width = fmax(0, power * s->step / height - s->noise_bandwidth) * 2 / PI;
    const double duration =
        (double)s->segments * (double)(s->hop < s->length ? s->hop : s->length) * s->dt;
    const double extent = fmax(line->width, s->noise_bandwidth);
    /* 2.355: half-power width over deviation of a normal curve. */
    line->frequency_sigma = extent / 2.355 / sqrt(fmax(1, extent * duration));
    line->amplitude = 2 * sqrt(power * s->step);
    const double relative = sqrt(noise * s->correlation) / power;
    const double own = line->width > 0 ? 1 / sqrt(fmax(1, extent * duration)) : 0;
    line->amplitude_sigma = 0.5 * line->amplitude * sqrt(relative * relative + own * own);
}

/* ---- families -------------------------------------------------------------------------------- */

static void sort_lines(size_t count, imk_spectrum_line *lines)
{
    for (size_t i = 1; i < count; i++) {
        const imk_spectrum_line line = lines[i];
        size_t j = i;
        for (; j > 0 && lines[j - 1].frequency > line.frequency; j--)
            lines[j] = lines[j - 1];
        lines[j] = line;
    }
}

/* A line is a multiple of a lower one when it lies within three sigmas and half a resolution of
 * one; where that would catch more than one in twenty of all frequencies it proves nothing. */
static bool is_multiple(const imk_spectrum *s, const imk_spectrum_line *lowest,
                        const imk_spectrum_line *line, int *multiple)
{
    enum { MULTIPLE_MAX = 64 };
    const double ratio = floor(line->frequency / lowest->frequency + 0.5);
    const double tolerance =
        0.5 * s->noise_bandwidth + 3 * line->frequency_sigma + 3 * ratio * lowest->frequency_sigma;
    if (ratio < 2 || ratio > MULTIPLE_MAX || 2 * tolerance > 0.05 * lowest->frequency)
        return false;
    *multiple = (int)ratio;
    return fabs(line->frequency - ratio * lowest->frequency) < tolerance;
}

static void find_families(const imk_spectrum *s, size_t count, imk_spectrum_line *lines)
{
    int families = 0;
    for (size_t i = 0; i < count; i++)
        lines[i].family = -1;
    for (size_t i = 0; i < count; i++) {
        if (lines[i].family >= 0)
            continue;
        lines[i].family = families;
        lines[i].multiple = 1;
        for (size_t j = i + 1; j < count; j++)
            if (lines[j].family < 0 && is_multiple(s, &lines[i], &lines[j], &lines[j].multiple))
                lines[j].family = families;
        families++;
    }
}

/* ---- the whole ------------------------------------------------------------------------------- */

size_t imk_spectrum_lines_workspace_size(const imk_spectrum *spectrum, size_t n)
{
    imki_tone tone;
    return spectrum->count * sizeof(double) + imki_tone_lay_out(spectrum, n, NULL, &tone) +
           IMKI_ALIGNMENT_SLACK;
}

imk_status imk_spectrum_lines(const imk_spectrum *spectrum, size_t n, const double *samples,
                              double false_alarm, size_t capacity, imk_spectrum_line *lines,
                              size_t *count, void *workspace, size_t workspace_size)
{
    if (!(false_alarm > 0 && false_alarm < 1))
        return IMK_ERROR_RANGE;
    if (!workspace || workspace_size < imk_spectrum_lines_workspace_size(spectrum, n))
        return IMK_ERROR_WORKSPACE;
    double *level = imki_align(workspace);
    const double independent = (double)spectrum->count * (spectrum->harmonic ? 2 : 1);
    search q = {.spectrum = spectrum,
                .level = level,
                .chance = false_alarm / independent,
                .tests = independent};
    q.normal_limit = fmax(0, -imk_normal_quantile(q.chance));
    if (spectrum->harmonic)
        q.harmonic_limit = imk_f_upper_quantile(q.chance, spectrum->harmonic_degrees[0],
                                                spectrum->harmonic_degrees[1]);
    all_levels(spectrum, level);
    size_t found = 0;
    find(&q, capacity, lines, &found);
    imki_tone tone;
    imki_tone_lay_out(spectrum, n, level + spectrum->count, &tone);
    tone.samples = samples;
    for (size_t i = 0; i < found; i++) {
        measure(&q, &lines[i]);
        if (samples)
            imki_line_refine(spectrum, &tone, &lines[i]);
    }
    sort_lines(found, lines);
    find_families(spectrum, found, lines);
    *count = found;
    return IMK_OK;
}
