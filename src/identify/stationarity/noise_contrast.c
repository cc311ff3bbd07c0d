/* SPDX-License-Identifier: Apache-2.0 */
/* A stretch of time in which one octave of the noise differs from the rest, as in circular binary
 * segmentation [OLSHEN2004]: all stretches of columns are compared with the columns around them,
 * and the probability of the largest difference is multiplied by the number of stretches
 * [BONFERRONI1936], which needs no assumption about their dependence.
 *
 * Where columns hold many differences, their mean absolute values are compared, which heavy tails
 * disturb less than squares. Their variance is that within the columns, times the scatter of the
 * columns where this is larger: differences of filtered or resonant noise are correlated. It is
 * known from few columns, so Student's distribution applies. Where columns hold few differences,
 * which are means of many samples and so Gaussian, the ratio of mean squares has the F
 * distribution. Its degrees are 8/9 of the number of differences, because their correlation is
 * largest for random walk, 1/4 between neighbours, and sum r^2 = 1 + 2/16; times 2/(2 + excess
 * kurtosis), where this is less than 1.
 *
 * A band joins octaves: squares over their variance, weighted by a share, whose sum has the degrees
 * (sum of shares)^2/(sum of their squares) of as many differences [SATTERTHWAITE1946]. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "noise_map_internal.h"

#include <math.h>

enum {
    BLOCKS = IMK_NOISE_MAP_BLOCKS,
    COLUMNS_LEAST = 12, /* whose scatter is known */
    SIDE_LEAST = 4      /* differences on both sides of an F test */
};
static const double many = 32; /* differences in a column */
static const double degrees_most = 8.0 / 9;

/* Running sums over the columns that hold something. */
typedef struct columns {
    size_t count;
    size_t place[BLOCKS]; /* of each in the map */
    double n[BLOCKS + 1], absolute[BLOCKS + 1], square[BLOCKS + 1];
    double variance; /* of an absolute value within its column; of a single octave */
    double degrees;  /* of a mean square of n = 1 */
} columns;

/* Sums of a band over columns first … end - 1: n and square are those of differences of variance 1,
 * each of which counts the share of its octave. */
typedef struct band_cell {
    double n, squared_shares, absolute, square, fourth, within, degrees;
} band_cell;

static band_cell band_sums(const imk_noise_map *map, const imki_noise_band *band, size_t first,
                           size_t end)
{
    band_cell sum = {0};
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++) {
        const double share = band->share[j], scale = band->share[j] * band->scale[j];
        for (size_t b = first; b < end && share > 0; b++) {
            const imk_noise_cell *cell = &map->cell[j][b];
            if (!(cell->count > 0))
                continue;
            sum.n += share * cell->count;
            sum.squared_shares += share * share * cell->count;
            sum.absolute += cell->absolute;
            sum.square += scale * cell->square;
            sum.fourth += scale * scale * cell->fourth;
            sum.within += fmax(0, cell->square - cell->absolute * cell->absolute / cell->count);
            sum.degrees += cell->count - 1;
        }
    }
    return sum;
}

static void gather(const imk_noise_map *map, const imki_noise_band *band, size_t low, size_t high,
                   columns *c)
{
    double within = 0, degrees = 0, fourth = 0, squared_shares = 0;
    c->count = 0;
    c->n[0] = c->absolute[0] = c->square[0] = 0;
    for (size_t b = low; b < high; b += band->joined) {
        const size_t end = b + band->joined < high ? b + band->joined : high;
        const band_cell cell = band_sums(map, band, b, end);
        if (!(cell.n > 0))
            continue;
        const size_t k = c->count++;
        c->place[k] = b;
        c->n[k + 1] = c->n[k] + cell.n;
        c->absolute[k + 1] = c->absolute[k] + cell.absolute;
        c->square[k + 1] = c->square[k] + cell.square;
        within += cell.within;
        degrees += cell.degrees;
        fourth += cell.fourth;
        squared_shares += cell.squared_shares;
    }
    c->variance = degrees > 0 ? within / degrees : 0;
    const double n = c->n[c->count], square = c->square[c->count];
    const double kurtosis = square > 0 ? fourth * n * n / (squared_shares * square * square) : 3;
    c->degrees =
        degrees_most * 2 / fmax(2, kurtosis - 1) * (squared_shares > 0 ? n / squared_shares : 1);
}

static double step_of(const columns *c, size_t k, size_t width)
{
    const double n1 = c->n[k + width] - c->n[k], n2 = c->n[k + 2 * width] - c->n[k + width];
    const double d = (c->absolute[k + width] - c->absolute[k]) / n1 -
                     (c->absolute[k + 2 * width] - c->absolute[k + width]) / n2;
    return d * d / (1 / n1 + 1 / n2);
}

/* Steps between neighbours: their mean square, which a few changes raise little, and of four
 * columns joined the median, which they do not raise at all. */
static double scatter_of(const columns *c)
{
    enum { WIDTH = 4 };
    double sum = 0, sorted[BLOCKS / WIDTH];
    size_t count = 0, wide = 0;
    for (size_t k = 0; k + 2 <= c->count; k++, count++)
        sum += step_of(c, k, 1);
    for (size_t k = 0; k + 2 * WIDTH <= c->count; k += WIDTH) {
        const double value = step_of(c, k, WIDTH);
        size_t i = wide++;
        for (; i > 0 && sorted[i - 1] > value; i--)
            sorted[i] = sorted[i - 1];
        sorted[i] = value;
    }
    const double narrow = sum / (double)count / c->variance;
    const double median = wide > 4 ? sorted[wide / 2] / 0.4549 / c->variance : 0;
    return fmax(1, fmax(narrow, median));
}

imki_noise_band imki_noise_octave(size_t octave)
{
    imki_noise_band band = {.joined = 1};
    band.share[octave] = band.scale[octave] = 1;
    return band;
}

double imki_noise_scatter(const imk_noise_map *map, size_t octave, size_t low, size_t high)
{
    const imki_noise_band band = imki_noise_octave(octave);
    columns c;
    gather(map, &band, low, high, &c);
    const double total = c.n[c.count];
    if (c.count < COLUMNS_LEAST || total < many * (double)c.count || !(c.variance > 0))
        return 0;
    return scatter_of(&c);
}

double imki_noise_steps(const imk_noise_map *map, size_t octave, size_t low, size_t high,
                        double *steps)
{
    const imki_noise_band band = imki_noise_octave(octave);
    columns c;
    double sum = 0;
    gather(map, &band, low, high, &c);
    if (c.n[c.count] < many * (double)c.count || !(c.variance > 0))
        return 0;
    for (size_t k = 0; k + 2 <= c.count; k++)
        sum += step_of(&c, k, 1) / c.variance;
    *steps += c.count > 1 ? (double)(c.count - 1) : 0;
    return sum;
}

/* Mean absolute values inside and outside: Student's t. */
static double compare_means(const columns *c, size_t i, size_t j)
{
    const double all = c->n[c->count], n = c->n[j] - c->n[i], rest = all - n;
    if (!(n > 0 && rest > 0))
        return 0;
    const double inside = c->absolute[j] - c->absolute[i];
    const double outside = c->absolute[c->count] - inside;
    return fabs(inside / n - outside / rest) / sqrt(c->variance * (1 / n + 1 / rest));
}

/* Ratio of mean squares inside and outside, and its degrees. */
static double compare_squares(const columns *c, size_t i, size_t j, double *inside, double *outside)
{
    const double n = c->n[j] - c->n[i], rest = c->n[c->count] - n;
    const double square = c->square[j] - c->square[i];
    *inside = c->degrees * n;
    *outside = c->degrees * rest;
    if (n < SIDE_LEAST || rest < SIDE_LEAST || !(square < c->square[c->count]))
        return 0;
    return square / n / ((c->square[c->count] - square) / rest);
}

static double cube_root(double x)
{
    return x > 0 ? imk_exp(imk_ln(x) / 3) : 0;
}

/* A ratio with the F distribution as a normal deviate [WILSON1931]. */
static double deviate(double ratio, double inside, double outside)
{
    const double a = 2 / (9 * inside), b = 2 / (9 * outside), root = cube_root(ratio);
    return fabs((1 - b) * root - (1 - a)) / sqrt(b * root * root + a);
}

static double two_sided(double ratio, double inside, double outside)
{
    const double upper = imk_f_upper(ratio, inside, outside);
    const double lower = imk_f_upper(1 / ratio, outside, inside);
    return 2 * fmin(upper, lower);
}

static double probability_of(const columns *c, double scatter, double size, size_t i, size_t j)
{
    double inside, outside;
    if (scatter > 0) {
        const double degrees = 2.0 / 3 * (double)(c->count - 1);
        return imk_f_upper(size * size / scatter, 1, degrees);
    }
    const double ratio = compare_squares(c, i, j, &inside, &outside);
    return ratio > 0 ? two_sided(ratio, inside, outside) : 1;
}

/* Size of the difference between columns i … j - 1 and the others. */
static double size_of(const columns *c, double scatter, size_t i, size_t j)
{
    double inside, outside;
    if (scatter > 0)
        return compare_means(c, i, j);
    const double ratio = compare_squares(c, i, j, &inside, &outside);
    return ratio > 0 ? deviate(ratio, inside, outside) : 0;
}

double imki_noise_compare(const imk_noise_map *map, const imki_noise_band *band, size_t low,
                          size_t middle, size_t high, double scatter)
{
    columns c;
    size_t before = 0;
    gather(map, band, low, high, &c);
    while (before < c.count && c.place[before] < middle)
        before++;
    if (before == 0 || before == c.count || (scatter > 0 && !(c.variance > 0)))
        return 1;
    return probability_of(&c, scatter, size_of(&c, scatter, 0, before), 0, before);
}

imki_noise_contrast imki_noise_contrast_find(const imk_noise_map *map, const imki_noise_band *band,
                                             size_t low, size_t high, double scatter)
{
    columns c;
    imki_noise_contrast found = {low, high, 1, 0};
    size_t best_i = 0, best_j = 0;
    gather(map, band, low, high, &c);
    if (scatter > 0 && (c.count < 2 || !(c.variance > 0)))
        return found;
    for (size_t i = 0; i < c.count; i++)
        for (size_t j = i + 1; j <= c.count - (i == 0); j++) {
            const double size = size_of(&c, scatter, i, j);
            if (size > found.size) {
                found.size = size;
                best_i = i;
                best_j = j;
            }
        }
    if (!(found.size > 0))
        return found;
    const double stretches = 0.5 * (double)c.count * (double)(c.count + 1) - 1;
    found.probability =
        fmin(1, stretches * probability_of(&c, scatter, found.size, best_i, best_j));
    found.size /= scatter > 0 ? sqrt(scatter) : 1;
    found.first = best_i == 0 ? low : c.place[best_i];
    found.end = best_j == c.count ? high : c.place[best_j];
    return found;
}
