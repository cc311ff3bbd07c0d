/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan family by name, and the averaging factors each member takes. */
#include "allan_internal.h"
#include "imukit/elementary.h"

#include <math.h>

static const struct {
    const char *name, *title;
} statistics[IMK_ALLAN_STATISTICS] = {
    [IMK_ALLAN_OVERLAPPING] = {"oadev", "overlapping Allan deviation"},
    [IMK_ALLAN_PLAIN] = {"adev", "Allan deviation"},
    [IMK_ALLAN_MODIFIED] = {"mdev", "modified Allan deviation"},
    [IMK_ALLAN_TIME] = {"tdev", "time deviation"},
    [IMK_ALLAN_HADAMARD] = {"ohdev", "overlapping Hadamard deviation"},
    [IMK_ALLAN_HADAMARD_PLAIN] = {"hdev", "Hadamard deviation"},
    [IMK_ALLAN_TOTAL] = {"totdev", "total deviation"},
    [IMK_ALLAN_MODIFIED_TOTAL] = {"mtot", "modified total deviation"},
    [IMK_ALLAN_HADAMARD_TOTAL] = {"htot", "Hadamard total deviation"},
    [IMK_ALLAN_THEO1] = {"theo1", "Theo1 deviation"},
    [IMK_ALLAN_PARABOLIC] = {"pdev", "parabolic deviation"},
    [IMK_ALLAN_HAAR] = {"haar", "Haar wavelet deviation"},
};

const char *imk_allan_name(imk_allan_statistic statistic)
{
    return (unsigned)statistic < IMK_ALLAN_STATISTICS ? statistics[statistic].name : NULL;
}

const char *imk_allan_title(imk_allan_statistic statistic)
{
    return (unsigned)statistic < IMK_ALLAN_STATISTICS ? statistics[statistic].title : NULL;
}

/* Theo1 below 10 has too few stretches to be worth its name [RILEY2008, 5.2.15]. */
enum { THEO_LEAST = 10 };

void imk_allan_range(imk_allan_statistic statistic, size_t n, size_t *lowest, size_t *highest,
                     size_t *step)
{
    *lowest = *step = 1;
    switch (statistic) {
    case IMK_ALLAN_MODIFIED:
    case IMK_ALLAN_TIME:
    case IMK_ALLAN_MODIFIED_TOTAL:
        *highest = (n + 1) / 3;
        break;
    case IMK_ALLAN_HADAMARD:
    case IMK_ALLAN_HADAMARD_PLAIN:
    case IMK_ALLAN_HADAMARD_TOTAL:
        *highest = n / 3;
        break;
    case IMK_ALLAN_PARABOLIC: /* a single sum has no slope: m = 1 is OAVAR, of three sums */
        *highest = n < 2 ? 0 : (n + 1) / 2;
        break;
    case IMK_ALLAN_THEO1:
        *lowest = THEO_LEAST;
        *highest = n / 2 * 2;
        *step = 2;
        break;
    default:
        *highest = n / 2;
    }
}

double imk_allan_averaging(imk_allan_statistic statistic, size_t m)
{
    return statistic == IMK_ALLAN_THEO1 ? 0.75 * (double)m : (double)m;
}

/* Factor of a place in a grid; SIZE_MAX where it does not fit. */
static size_t grid_factor(imk_allan_grid grid, size_t place)
{
    enum { PER_DECADE = 10, DENSE = 64, PER_OCTAVE = 32 };
    if (grid == IMK_ALLAN_OCTAVE)
        return place < 8 * sizeof(size_t) ? (size_t)1 << place : SIZE_MAX;
    if (grid == IMK_ALLAN_DECADE) {
        const double m = imk_exp(2.302585092994046 * (double)place / PER_DECADE) + 0.5;
        return m < 0x1p53 ? (size_t)m : SIZE_MAX;
    }
    if (grid == IMK_ALLAN_ALL || place < DENSE)
        return place + 1;
    const size_t octave = (place - DENSE) / PER_OCTAVE, rest = (place - DENSE) % PER_OCTAVE;
    /* 66, 68 … 128, 132, 136 … */
    return octave < 8 * sizeof(size_t) - 7 ? (PER_OCTAVE + rest + 1) << (octave + 1) : SIZE_MAX;
}

static size_t factors_between(imk_allan_grid grid, size_t lowest, size_t highest, size_t step,
                              size_t *factors)
{
    size_t count = 0, last = 0;
    for (size_t place = 0;; place++) {
        const size_t base = grid_factor(grid, place);
        if (base > highest / step)
            return count;
        const size_t m = base * step;
        if (m == last || m < lowest)
            continue;
        if (factors)
            factors[count] = m;
        count++;
        last = m;
    }
}

size_t imk_allan_factors(imk_allan_grid grid, size_t n, size_t *factors)
{
    return factors_between(grid, 1, n / 2, 1, factors);
}

size_t imk_allan_factors_for(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                             size_t *factors)
{
    size_t lowest, highest, step;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    return factors_between(grid, lowest, highest, step, factors);
}

imk_power_law imki_allan_lowest_type(imk_allan_statistic statistic)
{
    switch (statistic) {
    case IMK_ALLAN_HADAMARD:
    case IMK_ALLAN_HADAMARD_PLAIN:
    case IMK_ALLAN_HADAMARD_TOTAL:
        return IMK_RANDOM_RUN_RATE;
    default:
        return IMK_RANDOM_WALK_RATE;
    }
}
