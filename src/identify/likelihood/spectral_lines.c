/* SPDX-License-Identifier: Apache-2.0 */
/* Spectral lines: narrow excesses of power over their surroundings.
 *
 * A window of w coefficients is compared with two flanks. If both held the same noise, the ratio r
 * of their means would be that of chi-squares; the log-likelihood a line of that width is worth is
 *
 *     gain = w s/2 (r - 1 - log r)
 *
 * where every coefficient is the mean of s squares: 1 for the transform of a whole record, the
 * number of segments where their powers are averaged.
 * Windows of all widths compete, and the largest gains win. Sums come from cumulative powers, so
 * that any window costs the same. */
#include "identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* gain > 30 has a chance of about e^-30 per window, 1e-7 in a record of 1e6 windows; an excess
 * below 25 % bends neither the fit nor a plot. Lines below the 48th coefficient cannot be told from
 * slow noise. */
static const double GAIN_MIN = 30, RATIO_MIN = 1.25;
enum { FIRST_COEFFICIENT = 48, CANDIDATES = 256 };

static double mean_power(const double *cumulative, size_t from, size_t to)
{
    return (cumulative[to] - cumulative[from]) / (double)(to - from);
}

static double gain_of(double degrees, double ratio)
{
    return 0.5 * degrees * (ratio - 1 - imk_ln(ratio));
}

/* Ratio at which a window of so many degrees gains GAIN_MIN, at least RATIO_MIN. */
static double least_ratio(double degrees)
{
    double low = 1, high = 2 + 4 * GAIN_MIN / degrees;
    for (int i = 0; i < 40; i++) {
        const double middle = 0.5 * (low + high);
        *(gain_of(degrees, middle) > GAIN_MIN ? &high : &low) = middle;
    }
    return high > RATIO_MIN ? high : RATIO_MIN;
}

/* Square of the ratio of a window's mean to its surroundings': the product of the flanks' means,
 * the square of the level between them for any power law. 0 where the flanks do not fit. */
static double squared_ratio(size_t n, const double *cumulative, size_t first, size_t w)
{
    const size_t gap = w / 2 + 1, flank = 3 * w > 32 ? 3 * w : 32;
    if (first < gap + flank + 1 || first + w + gap + flank > n)
        return 0;
    const size_t left = first - gap, right = first + w + gap;
    const double below = cumulative[left] - cumulative[left - flank];
    const double above = cumulative[right + flank] - cumulative[right];
    const double inside = (cumulative[first + w] - cumulative[first]) * (double)flank / (double)w;
    return below * above > 0 ? inside * inside / (below * above) : 0;
}

/* Keep the candidates that gain most; the list is small and unsorted. */
static void add_candidate(imki_line *list, size_t *count, imki_line line)
{
    if (*count < CANDIDATES) {
        list[(*count)++] = line;
        return;
    }
    size_t least = 0;
    for (size_t i = 1; i < CANDIDATES; i++)
        least = list[i].gain < list[least].gain ? i : least;
    if (list[least].gain < line.gain)
        list[least] = line;
}

static void scan_width(size_t n, const double *cumulative, double squares, size_t w,
                       imki_line *list, size_t *count)
{
    const size_t step = w >= 4 ? w / 4 : 1;
    const size_t start = 8 * w > FIRST_COEFFICIENT ? 8 * w : FIRST_COEFFICIENT;
    const double degrees = (double)w * squares, least = least_ratio(degrees);
    const double needed = least * least;
    imki_line best = {0};
    for (size_t first = start; first + w < n; first += step) {
        const double squared = squared_ratio(n, cumulative, first, w);
        if (squared > needed && (best.gain == 0 || first <= best.last)) {
            const double r = sqrt(squared), gain = gain_of(degrees, r);
            if (gain > best.gain)
                best = (imki_line){first, first + w - 1, r, gain};
        } else if (best.gain > 0 && first > best.last) {
            add_candidate(list, count, best);
            best = (imki_line){0};
        }
    }
    if (best.gain > 0)
        add_candidate(list, count, best);
}

static bool near(const imki_line *a, const imki_line *b)
{
    const size_t wa = a->last - a->first + 1, wb = b->last - b->first + 1;
    const size_t margin = wa > wb ? wa : wb;
    return a->first <= b->last + margin && b->first <= a->last + margin;
}

size_t imki_lines_find(size_t n, const double *cumulative, double squares, imki_line *lines)
{
    imki_line list[CANDIDATES];
    size_t candidates = 0, count = 0;
    for (size_t w = 1; 16 * w < n; w *= 2)
        scan_width(n, cumulative, squares, w, list, &candidates);
    while (count < IMKI_LINES_MAX) {
        size_t best = candidates;
        for (size_t i = 0; i < candidates; i++)
            if (list[i].gain > 0 && (best == candidates || list[i].gain > list[best].gain))
                best = i;
        if (best == candidates)
            break;
        lines[count] = list[best];
        for (size_t i = 0; i < candidates; i++)
            if (near(&list[i], &lines[count]))
                list[i].gain = 0;
        count++;
    }
    return count;
}

/* The skirts of a Lorentzian peak `ratio` times its surroundings fall to a twentieth of these at
 * width/2 sqrt(20 ratio) from it. */
static double skirts(const imki_line *line)
{
    const double width = (double)(line->last - line->first + 1);
    return width * fmax(2, 0.5 * sqrt(20 * line->ratio));
}

static size_t farthest(const imki_line *line)
{
    return line->first / 2;
}

bool imki_line_is_strong(const imki_line *line)
{
    return skirts(line) > (double)farthest(line);
}

/* No farther than half-way to frequency 0: without the lowest coefficients nothing would tell the
 * slow terms, and without nearly all others nothing the white noise. */
imki_line imki_line_widen(const imki_line *line, size_t n)
{
    imki_line wide = *line;
    const size_t reach = imki_line_is_strong(line) ? farthest(line) : (size_t)skirts(line);
    wide.first = line->first > reach ? line->first - reach : 1;
    wide.last = line->last + reach < n ? line->last + reach : n - 1;
    return wide;
}

/* The level under the line is the lower of two flanks as wide as three lines: the other may hold a
 * neighbour. */
double imki_line_variance(const imki_line *line, size_t n, double dt, const double *cumulative)
{
    const imki_line wide = imki_line_widen(line, n);
    const size_t width = line->last - line->first + 1, flank = 3 * width > 32 ? 3 * width : 32;
    const size_t below = wide.first > flank ? wide.first - flank : 1;
    const size_t above = wide.last + 1 + flank < n ? wide.last + 1 + flank : n;
    double level = HUGE_VAL;
    if (below < wide.first)
        level = mean_power(cumulative, below, wide.first);
    if (wide.last + 1 < above)
        level = fmin(level, mean_power(cumulative, wide.last + 1, above));
    const double excess = mean_power(cumulative, wide.first, wide.last + 1) - level;
    return excess > 0 ? excess * (double)(wide.last - wide.first + 1) / ((double)n * dt) : 0;
}
