/* SPDX-License-Identifier: Apache-2.0 */
/* Sudden lasting changes of the level, against the slow noise (level_noise.c).
 *
 * A jump of one unit at border j has the cosine coefficients
 *
 *     h_k = -sqrt(2/M) sin(pi k j/M)/(2 s)
 *
 * so the generalised least-squares estimate of its size is A = (sum h_k c_k/S_k)/D with the
 * information D = sum h_k^2/S_k, and A sqrt(D) is standard normal where there is none. The sums
 * over k of all borders together are the running sum of the inverse transform of c_k/S_k. The
 * largest of all borders is a jump if it is significant among M of them, alone and against the
 * scatter of the means about it; it is subtracted, and the rest is searched again
 * [BROCKWELL1991, 10.8]. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/fourier.h"
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { LOCAL = 24, ENDS = 3 };

static const double pi = 3.14159265358979324;

typedef struct jump_search {
    imki_level_noise noise;
    size_t n;
    double empty;   /* share of the means that lie on lines */
    double *mean;   /* of the caller */
    double *cosine; /* cos(2 pi i/M) */
    double *weight; /* h_k^2/S_k but for the sine */
    double *kept;   /* means before a jump is taken out */
} jump_search;

size_t imki_jumps_room(size_t n)
{
    return 3 * n + imki_level_noise_room(n);
}

static void lay_out(jump_search *j, size_t n, double *room)
{
    double **const parts[] = {&j->cosine, &j->weight, &j->kept};
    j->n = n;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++, room += n)
        *parts[i] = room;
    imki_level_noise_begin(&j->noise, n, room);
    for (size_t i = 0; i < n; i++)
        j->cosine[i] = imk_cos(2 * pi * (double)i / (double)n);
}

/* D of a border. */
static double information(const jump_search *j, size_t border)
{
    double sum = 0;
    for (size_t k = 1, turn = 0; k < j->n; k++) {
        turn += border;
        turn -= turn >= j->n ? j->n : 0;
        sum += j->weight[k] * (1 - j->cosine[turn]);
    }
    return sum / (double)j->n;
}

/* Median size of differences of neighbours about a border over that of all: where the record is
 * noisier, a jump is less sure. Less than half as much again is chance. */
static double local_noise(const jump_search *j, size_t border)
{
    double *sorted = j->noise.coefficient; /* not needed any more */
    const size_t from = border > LOCAL ? border - LOCAL : 1;
    const size_t to = border + LOCAL < j->n ? border + LOCAL : j->n;
    for (size_t i = from; i < to; i++)
        sorted[i - from] = fabs(j->mean[i] - j->mean[i - 1]);
    imki_sort(sorted, to - from);
    const double here = sorted[(to - from) / 2];
    for (size_t i = 1; i < j->n; i++)
        sorted[i - 1] = fabs(j->mean[i] - j->mean[i - 1]);
    imki_sort(sorted, j->n - 1);
    /* those on lines hardly differ */
    const double all = sorted[(size_t)((double)(j->n - 1) * 0.5 * (1 + j->empty))];
    return here > 1.5 * all ? here / all : 1;
}

/* The border whose jump is the most significant; its size and significance. */
static size_t search(jump_search *j, double *size, double *significance)
{
    size_t best = 0;
    double sum = 0;
    *significance = *size = 0;
    for (size_t k = 1; k < j->n; k++) {
        j->weight[k] = (j->noise.walk[k] + 1.0 / 6) / j->noise.spectrum[k];
        j->noise.coefficient[k] /= j->noise.spectrum[k];
    }
    (void)imk_cosine_inverse(j->n, j->noise.coefficient, j->noise.transform,
                             j->noise.transform_size);
    for (size_t border = 1; border + ENDS <= j->n; border++) {
        sum -= j->noise.coefficient[border - 1]; /* the sum of all is 0 */
        if (border < ENDS || sum * sum <= 0)
            continue;
        const double d = information(j, border), z = fabs(sum) / sqrt(d);
        if (z > *significance) {
            *significance = z;
            *size = sum / d;
            best = border;
        }
    }
    return best;
}

/* Take a jump out. It may lie within a mean, on either side of the border: those two are put at the
 * level of their neighbours. */
static void take_out(jump_search *j, size_t border, double size)
{
    double *at = j->mean + border;
    for (size_t i = border; i < j->n; i++)
        j->mean[i] -= size;
    at[-1] = 0.5 * (at[-3] + at[-2]);
    at[0] = 0.5 * (at[1] + at[2]);
}

/* The jump of the list that a border belongs to: the first fit of a jump takes it for a walk in
 * part, and leaves some of it. */
static size_t entry_of(size_t count, const size_t *place, size_t border)
{
    size_t k = 0;
    while (k < count && (border > place[k] + 2 || place[k] > border + 2))
        k++;
    return k;
}

/* Size and significance of a jump at a border by the spectrum at hand, which is raised where the
 * rest has more power; the coefficients become those of the kept means. */
static double judge(jump_search *j, size_t border, double *size)
{
    double product = 0, d = 0;
    imki_level_noise_raise(&j->noise);
    imki_level_noise_transform(&j->noise, j->kept);
    for (size_t k = 1; k < j->n; k++) {
        const double angle = pi * (double)k * (double)border / (double)j->n;
        const double h = -sqrt(2 / (double)j->n) * imk_sin(angle) * j->noise.flicker[k];
        product += h * j->noise.coefficient[k] / j->noise.spectrum[k];
        d += h * h / j->noise.spectrum[k];
    }
    *size = product / d;
    return product * product / d;
}

/* Look for one more jump; it is taken out if its significance, a square, is above what is due.
 * @return the most likely border, or 0 if there is none worth a look; significance and size are set
 */
static size_t next_jump(jump_search *j, double due, double *square, double *size)
{
    const double promising = 3;
    double z;
    imki_level_noise_transform(&j->noise, j->mean);
    const double without = imki_level_noise_fit(&j->noise);
    imki_level_noise_raise(&j->noise);
    const size_t border = search(j, size, &z);
    if (border == 0 || z < promising)
        return 0;
    const double local = local_noise(j, border);
    memcpy(j->kept, j->mean, j->n * sizeof *j->mean);
    take_out(j, border, *size);
    imki_level_noise_transform(&j->noise, j->mean);
    const double gain = imki_level_noise_fit(&j->noise) - without;
    *square = fmin(2 * gain, judge(j, border, size)) * (1 - j->empty) / (local * local);
    memcpy(j->mean, j->kept, j->n * sizeof *j->mean);
    if (*square > due)
        take_out(j, border, *size);
    return border;
}

size_t imki_jumps_find(size_t n, double *mean, double empty, double significance, double *room,
                       size_t most, size_t *place, double *size, double *gain, imki_jump *possible)
{
    jump_search work, *j = &work;
    const double z = -imk_normal_quantile(significance / (2 * (double)n));
    size_t count = 0;
    lay_out(j, n, room);
    j->mean = mean;
    imki_level_noise_take_tones(&j->noise, mean);
    j->empty = empty;
    *gain = 0;
    *possible = (imki_jump){0, 0, 0};
    for (size_t round = 0; round < 3 * most; round++) {
        double square, change;
        const size_t border = next_jump(j, z * z, &square, &change);
        if (border > 0 && !(square > z * z))
            *possible = (imki_jump){border, change, square};
        const size_t at =
            possible->place == 0 && border > 0 ? entry_of(count, place, border) : most;
        if (at == most)
            break;
        *gain = round == 0 ? 0.5 * square : *gain;
        size[at] = at == count ? change : size[at] + change;
        place[at] = at == count ? border : place[at];
        count += at == count;
    }
    return count;
}
