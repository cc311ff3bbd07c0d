/* SPDX-License-Identifier: Apache-2.0 */
/* Is the white noise Gaussian, and is its strength as steady as noise allows?
 *
 * The kurtosis is that of the Haar differences of one sample, within columns, so that noise that
 * changes from column to column is not taken for heavy tails. A difference of 2 m independent
 * values has 1/(2 m) of their excess kurtosis, and white noise that is a share w of the variance
 * shows w^2 of it. Behind an output filter an octave is taken that is slower than the filter.
 *
 * Bursts make the strength vary from column to column by more than independent differences do. The
 * squares of a resonance are correlated over Q/(2 pi f), which is allowed for. Bursts shorter than
 * a column leave heavy tails at averaging times at which independent samples of any distribution
 * would have become Gaussian: differences of Gaussian noise have no excess kurtosis, whatever its
 * spectrum. */
#include "imukit/distributions.h"
#include "noise_map_internal.h"

#include <math.h>

static const double many = 32;           /* differences in a column */
static const double scatter_least = 1.5; /* that matters: 22 % of the interval */

/* The first octave behind the output filter. */
static size_t white_octave(const imk_identification *identified, double dt)
{
    size_t octave = 0;
    while (identified->filter.bandwidth > 0 && octave + 1 < IMK_NOISE_MAP_OCTAVES &&
           identified->filter.bandwidth * dt * (double)((size_t)1 << octave) < 1)
        octave++;
    return octave;
}

/* Excess kurtosis from fourth powers and squared mean squares of columns of about c differences, of
 * which the latter are v^2 (1 + (2 + kurtosis)/c) on average. */
static double kurtosis_within(const imk_noise_map *map, size_t octave, double *differences)
{
    double fourth = 0, squared = 0, count = 0, columns = 0;
    for (size_t b = 0; b < imk_noise_map_blocks(map); b++) {
        const imk_noise_cell *cell = &map->cell[octave][b];
        if (!(cell->count >= many))
            continue;
        fourth += cell->fourth;
        squared += cell->square * cell->square / cell->count;
        count += cell->count;
        columns++;
    }
    *differences = count;
    if (!(squared > 0))
        return 0;
    const double ratio = fourth / squared, c = count / columns;
    return (ratio * (1 + 2 / c) - 3) / fmax(1 - ratio / c, 0.1);
}

/* The least excess kurtosis of a sound difference. A constant has -2 and a sine -1.5, also a
 * vibration whose frequency wanders, which is described as a resonance. Rounding errors are uniform
 * and have -1.2: differences of 2 m of them have -0.6/m, their second differences, of which
 * quantization is made, -1.2 (1 + 2^4 + 1)/(1 + 2^2 + 1)^2 = -0.6. */
static double sound_kurtosis(const imk_identification *identified, double dt,
                             const imki_noise_shares *shares, size_t octave)
{
    const size_t m = (size_t)1 << octave;
    const double total = imki_noise_total(shares, octave), step = identified->resolution;
    double tones = shares->tones[octave];
    for (int i = 0; i < identified->resonance_count; i++)
        tones += imk_resonance_sampled_allan_variance(identified->resonance[i], dt, m);
    const double angle =
        imk_identification_allan_variance(identified, dt, m, IMK_NOISE_QUANTIZATION) / total;
    const double rounding = step * step / (12 * (double)m * total);
    return -2 * tones * tones / (total * total) - 0.6 * angle * angle -
           0.6 / (double)m * rounding * rounding;
}

/* A stage y = x - a x^3, for noise of unit variance, lowers the deviation by 3 a and the kurtosis
 * by 24 a: at 1.5 % it is lower by 0.12. Clipping and leaving out lower it by about as much. */
static bool is_light(const imk_noise_changes *r, double sound, double significance)
{
    static const double least = 0.12;
    const double chance = -imk_normal_quantile(0.01 * significance) * r->kurtosis_sigma;
    return r->kurtosis < sound - fmax(least, chance);
}

static void test_tails(const imk_noise_map *map, const imk_noise_changes_settings *settings,
                       const imk_identification *identified, const imki_noise_shares *shares,
                       imk_noise_changes *r)
{
    const size_t octave = white_octave(identified, settings->dt);
    double differences;
    if (octave >= shares->octaves || !(imki_noise_total(shares, octave) > 0))
        return;
    const double share = shares->white[octave] / imki_noise_total(shares, octave);
    const double fast = imk_noise_map_deviation(map, 0, 0, IMK_NOISE_MAP_BLOCKS, 0.95).value;
    const double excess = kurtosis_within(map, octave, &differences);
    r->gaussian_tested = share > 0.7 && fast > 0.7 * identified->resolution &&
                         shares->tones[octave] < 0.1 * imki_noise_total(shares, octave) &&
                         differences > 0;
    if (!r->gaussian_tested)
        return;
    const double factor = 2 * (double)((size_t)1 << octave) / (share * share);
    r->kurtosis = factor * excess;
    r->kurtosis_sigma = factor * sqrt(24 / differences);
    /* The distribution of a kurtosis is skewed: a tenth of the significance of the normal one. */
    r->heavy_tails =
        r->kurtosis > -imk_normal_quantile(0.1 * settings->significance) * r->kurtosis_sigma;
    const double sound = factor * sound_kurtosis(identified, settings->dt, shares, octave);
    r->light_tails = is_light(r, sound, settings->significance);
}

static void test_scatter(const imk_noise_map *map, const imk_noise_changes_settings *settings,
                         const imk_identification *identified, const imki_noise_shares *shares,
                         imk_noise_changes *r)
{
    for (size_t j = white_octave(identified, settings->dt); j < shares->octaves; j++) {
        double steps = 0, squares = 0;
        if (!(r->tested >> j & 1) || shares->tones[j] > 0.02 * imki_noise_total(shares, j))
            continue;
        for (size_t k = 0; k < r->segment_count; k++)
            squares += imki_noise_steps(map, j, r->segment[k].first / map->block,
                                        (r->segment[k].end + map->block - 1) / map->block, &steps);
        if (steps < 8)
            continue;
        const double scatter =
            squares / steps / imki_noise_expected_scatter(identified, settings->dt, shares, j);
        const double chance = imk_f_upper(scatter, 2.0 / 3 * steps, HUGE_VAL);
        if (chance * (double)shares->octaves > settings->significance || scatter < scatter_least ||
            scatter < r->scatter)
            continue;
        r->scatter = scatter;
        r->scatter_octave = j;
        r->bursts = true;
    }
}

/* Excess kurtosis of all differences of an octave; its standard deviation for Gaussian noise. */
static double whole_kurtosis(const imk_noise_map *map, size_t octave, double *sigma)
{
    const imk_noise_cell all = imki_noise_cells(map, octave, 0, IMK_NOISE_MAP_BLOCKS);
    *sigma = all.count > 0 ? sqrt(24 / all.count) : HUGE_VAL;
    return all.square > 0 ? all.fourth * all.count / (all.square * all.square) - 3 : 0;
}

static void test_clusters(const imk_noise_map *map, const imk_noise_changes_settings *settings,
                          const imk_identification *identified, const imki_noise_shares *shares,
                          imk_noise_changes *r)
{
    enum { FAR = 4 }; /* octaves, over which the kurtosis of independent samples falls to 1/16 */
    static const double least = 0.3, deviations = 6, share_least = 0.7, tones_most = 0.02;
    const size_t first = white_octave(identified, settings->dt);
    double sigma;
    if (r->changed != 0 || r->bursts || !r->heavy_tails)
        return;
    const double samples = whole_kurtosis(map, first, &sigma);
    for (size_t j = first + FAR; j < shares->octaves; j++) {
        const double total = imki_noise_total(shares, j), excess = whole_kurtosis(map, j, &sigma);
        const double independent = samples / (double)((size_t)1 << (j - first));
        if (!(r->tested >> j & 1) || shares->white[j] < share_least * total ||
            shares->tones[j] > tones_most * total ||
            excess < fmax(least, 2 * independent + deviations * sigma) ||
            1 + 0.5 * excess < r->scatter)
            continue;
        r->scatter = 1 + 0.5 * excess; /* a mean square scatters by (2 + excess)/count */
        r->scatter_octave = j;
        r->bursts = true;
    }
}

void imki_noise_tails(const imk_noise_map *map, const imk_noise_changes_settings *settings,
                      const imk_identification *identified, const imki_noise_shares *shares,
                      imk_noise_changes *result)
{
    test_tails(map, settings, identified, shares, result);
    test_scatter(map, settings, identified, shares, result);
    test_clusters(map, settings, identified, shares, result);
}

void imk_noise_changes_widen(const imk_noise_changes *changes, size_t n,
                             imk_identification *identified)
{
    imk_estimate *e = &identified->term[IMK_NOISE_WHITE];
    if (!e->present || !(e->sigma > 0) || n == 0)
        return;
    const double relative = e->sigma / e->value, gaussian = relative * relative;
    double variance = gaussian;
    if (changes->heavy_tails)
        variance += changes->kurtosis / (4 * (double)n);
    if (changes->bursts)
        variance *= changes->scatter;
    const double factor = sqrt(variance / gaussian);
    e->sigma *= factor;
    e->upper = e->free_value + factor * (e->upper - e->free_value);
    e->lower = fmax(0, e->free_value - factor * (e->free_value - e->lower));
}
