/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of a long record: found in the segments' mean power, where a chance of e^-30 per window
 * needs less excess the more segments there are, and below them in the means' spectrum. What folds
 * from a line above into the means is left out there and is no line of its own. */
#include "long_record_internal.h"

#include "imukit/elementary.h"

#include <math.h>

static const double pi = 3.141592653589793;
enum { FLANK = 32 }; /* coefficients beside a line that tell its level */

/* Frequency at the centre of the power in excess of the lesser end, over the line and its two
 * neighbours: a tone between two coefficients is told to a tenth of their distance. */
static double centre_frequency(const imki_spectrum *s, const imki_line *line)
{
    const size_t from = line->first > 2 ? line->first - 2 : 1;
    const size_t to = line->last + 3 < s->n ? line->last + 3 : s->n;
    double least = HUGE_VAL, sum = 0, moment = 0;
    for (size_t k = from; k < to; k++)
        least = fmin(least, s->cumulative[k + 1] - s->cumulative[k]);
    for (size_t k = from; k < to; k++) {
        const double power = s->cumulative[k + 1] - s->cumulative[k] - least;
        sum += power;
        moment += power * (double)k;
    }
    const double centre = sum > 0 ? moment / sum : 0.5 * (double)(line->first + line->last);
    return centre / (2 * (double)s->n * s->dt);
}

static bool overlap(const imki_line *a, const imki_line *b)
{
    return a->first <= b->last && b->first <= a->last;
}

/* Where a line of the fast spectrum folds to in the slow one, with a margin of some coefficients.
 */
static imki_line folded(const imki_spectrum *slow, const imki_spectrum *fast, const imki_line *line)
{
    const double step = 1 / slow->dt, fast_hz = 1 / (2 * (double)fast->n * fast->dt);
    const double slow_hz = 1 / (2 * (double)slow->n * slow->dt);
    const double low = ((double)line->first - 1) * fast_hz,
                 high = ((double)line->last + 1) * fast_hz;
    const double nearest = step * floor(0.5 * (low + high) / step + 0.5);
    const double a = fabs(low - nearest), b = fabs(high - nearest);
    const double from = low <= nearest && nearest <= high ? 0 : fmin(a, b), to = fmax(a, b);
    imki_line image = {.first = (size_t)(from / slow_hz), .last = (size_t)(to / slow_hz) + 1};
    image.first = image.first > 4 ? image.first - 4 : 1;
    image.last += 4;
    return image;
}

static void leave_out(imki_spectrum *s, imki_line *left_out, imki_line line)
{
    if (s->line_count < 2 * IMKI_LINES_MAX)
        left_out[s->line_count++] = line;
}

static size_t peak_of(const imki_spectrum *s, const imki_line *line)
{
    const double *sum = s->cumulative;
    size_t peak = line->first;
    for (size_t k = line->first; k <= line->last; k++)
        peak = sum[k + 1] - sum[k] > sum[peak + 1] - sum[peak] ? k : peak;
    return peak;
}

static double mean_power(const imki_spectrum *s, size_t from, size_t to)
{
    return from < to ? (s->cumulative[to] - s->cumulative[from]) / (double)(to - from) : HUGE_VAL;
}

/* Variance in a place above the lower level of 32 coefficients on either side. */
static double variance_in(const imki_spectrum *s, const imki_line *place)
{
    const size_t before = place->first > FLANK ? place->first - FLANK : 1;
    const size_t behind = place->last + 1 + FLANK < s->n ? place->last + 1 + FLANK : s->n;
    const double level =
        fmin(mean_power(s, before, place->first), mean_power(s, place->last + 1, behind));
    const double excess = mean_power(s, place->first, place->last + 1) - level;
    const double count = (double)(place->last + 1 - place->first);
    return excess > 0 ? excess * count / ((double)s->n * s->dt) : 0;
}

/* A tone has nine tenths of its power in five coefficients; a resonance as concentrated is narrower
 * than one, and cannot be told from it. */
static bool is_tone(const imki_spectrum *s, const imki_line *line, double variance)
{
    const double level = mean_power(s, line->first, line->last + 1) / line->ratio;
    const size_t peak = peak_of(s, line);
    const size_t from = peak > 3 ? peak - 2 : 1, to = peak + 3 < s->n ? peak + 3 : s->n;
    const double near = (mean_power(s, from, to) - level) * (double)(to - from);
    return near > 0.8 * variance * (double)s->n * s->dt;
}

/* What a tone at coefficient k0, not a whole number, adds to the power of coefficient k, per unit
 * of its variance, on average over its phase: the cosine transform of a sinusoid cut off at a
 * segment's ends, with w = pi k/n, w0 = pi k0/n,
 *
 *     dt/n X^2 [1 - (-1)^k cos(pi k0)],   X = 2 sin(w0/2) cos(w/2)/(cos w - cos w0)
 *
 * which near the tone is n dt/2 [sin(pi d/2)/(pi d/2)]^2 at a distance d. */
static double tone_power(const imki_spectrum *s, double k0, size_t k)
{
    const double n = (double)s->n, d = (double)k - k0;
    if (fabs(d) < 1e-3)
        return 0.5 * n * s->dt;
    const double w = pi * (double)k / n, w0 = pi * k0 / n, half = imk_sin(0.5 * pi * d);
    /* cos w - cos w0 and 1 - cos without cancellation */
    const double difference = 2 * imk_sin(0.5 * (w0 + w)) * imk_sin(0.5 * pi * d / n);
    const double x = 2 * imk_sin(0.5 * w0) * imk_cos(0.5 * w) / difference;
    return s->dt / n * x * x * 2 * half * half;
}

typedef struct tone_search {
    const imki_spectrum *spectrum;
    size_t from, to;
} tone_search;

/* How well the powers about a peak are those of a tone there. */
static double likeness(void *context, double k0)
{
    const tone_search *t = context;
    const double *sum = t->spectrum->cumulative;
    double product = 0, square = 0;
    for (size_t k = t->from; k < t->to; k++) {
        const double shape = tone_power(t->spectrum, k0, k);
        product += shape * (sum[k + 1] - sum[k]);
        square += shape * shape;
    }
    return product / sqrt(square);
}

/* Take a tone's skirts out of the powers, at most nine tenths of each, and put the level of 32
 * coefficients on either side in place of the tone. */
static void remove_tone(const imki_spectrum *s, double *cumulative, double k0, double variance,
                        const imki_line *place)
{
    double level = 0, count = 0, before = cumulative[1];
    for (size_t k = 1; k < s->n; k++) {
        const bool below = k < place->first && k + FLANK >= place->first;
        const bool above = k > place->last && k <= place->last + FLANK;
        if (below || above) {
            const double power = cumulative[k + 1] - cumulative[k];
            level += fmax(power - variance * tone_power(s, k0, k), 0.1 * power);
            count++;
        }
    }
    level = count > 0 ? level / count : 0;
    for (size_t k = 1; k < s->n; k++) {
        const double power = cumulative[k + 1] - before;
        before = cumulative[k + 1];
        const bool inside = k >= place->first && k <= place->last;
        cumulative[k + 1] =
            cumulative[k] +
            (inside ? level : fmax(power - variance * tone_power(s, k0, k), 0.1 * power));
    }
}

static imki_line around(const imki_line *line, size_t reach, size_t n)
{
    imki_line wide = *line;
    wide.first = line->first > reach ? line->first - reach : 1;
    wide.last = line->last + reach < n ? line->last + reach : n - 1;
    return wide;
}

/* The skirts of a tone of power P, in units of that of a coefficient beside it, fall to a twentieth
 * at sqrt(20 P)/pi coefficients. */
static imki_line tone_place(const imki_spectrum *s, const imki_line *line)
{
    const double width = (double)(line->last - line->first + 1);
    return around(line, (size_t)(sqrt(20 * line->ratio * width) / pi + 2), s->n);
}

/* Tones, the strongest first, each with its skirts: what is found after it does not lie on them. */
static size_t take_tones(imki_record_spectra *spectra, imki_line *taken, imk_identification *result)
{
    imki_spectrum *fast = &spectra->part[1];
    imki_line found[IMKI_LINES_MAX];
    size_t tones = 0;
    while (tones < IMKI_LINES_MAX && result->sinusoid_count < IMK_TERMS_MAX) {
        const size_t count = imki_lines_find(fast->n, fast->cumulative, fast->squares, found);
        size_t tone = 0;
        double variance = 0;
        imki_line place = {0};
        for (; tone < count; tone++) {
            place = tone_place(fast, &found[tone]);
            variance = variance_in(fast, &place);
            if (found[tone].last >= fast->first && is_tone(fast, &found[tone], variance))
                break;
        }
        if (tone == count)
            break;
        const double peak = (double)peak_of(fast, &found[tone]);
        tone_search search = {fast, (size_t)peak - 2, (size_t)peak + 3};
        const double k0 = imki_peak(likeness, &search, peak - 1, peak + 1, 24);
        const double frequency = k0 / (2 * (double)fast->n * fast->dt);
        result->sinusoid[result->sinusoid_count++] =
            (imk_sinusoid){.amplitude = sqrt(2 * variance), .frequency = frequency};
        leave_out(fast, spectra->lines[1], place);
        remove_tone(fast, spectra->fast_powers, k0, variance, &place);
        taken[tones++] = found[tone];
    }
    return tones;
}

/* A line that is no tone. */
static void take_line(imki_spectrum *s, imki_line *left_out, const imki_line *line,
                      imk_identification *result)
{
    const double spacing = 1 / (2 * (double)s->n * s->dt);
    if (imki_line_describe(line, s->n, s->dt, s->cumulative, centre_frequency(s, line), spacing,
                           result))
        leave_out(s, left_out, imki_line_widen(line, s->n));
}

void imki_record_lines(imki_record_spectra *spectra, imk_identification *result)
{
    imki_spectrum *slow = &spectra->part[0], *fast = &spectra->part[1];
    imki_line found[IMKI_LINES_MAX], high[2 * IMKI_LINES_MAX];
    const size_t tones = take_tones(spectra, high, result);
    const size_t others = imki_lines_find(fast->n, fast->cumulative, fast->squares, high + tones);
    for (size_t i = tones; i < tones + others; i++)
        if (high[i].last >= fast->first)
            take_line(fast, spectra->lines[1], &high[i], result);

    const size_t reach = slow->end + slow->end / 2;
    const size_t searched = reach < slow->n ? reach : slow->n;
    const size_t count = imki_lines_find(searched, slow->cumulative, slow->squares, found);
    for (size_t i = 0; i < count; i++) {
        if (found[i].first >= slow->end)
            continue;
        bool image = false;
        for (size_t h = 0; h < tones + others && !image; h++) {
            const imki_line at = folded(slow, fast, &high[h]);
            image = overlap(&at, &found[i]);
        }
        if (image)
            leave_out(slow, spectra->lines[0], imki_line_widen(&found[i], slow->n));
        else
            take_line(slow, spectra->lines[0], &found[i], result);
    }
}
