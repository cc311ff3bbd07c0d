/* SPDX-License-Identifier: Apache-2.0 */
/* Do axes share their noise? Each gyro and each accelerometer has noise of its own, so they share
 * it where one is computed from others, where they talk across, or where one is another one some
 * rows late.
 *
 * The coherence |S_ab|/sqrt(S_aa S_bb) of their steps from row to row [BENDAT2010] does
 * not depend on a delay, and a tone that all axes feel is in few bands: its median over the bands
 * is that of the broad-band noise, without those in which a structure resonates. Each segment
 * counts as much as another, and without the steps far beyond the others, so that rows with faults
 * on all axes count nothing. */
#include "log_coherence_internal.h"

#include "imukit/elementary.h"
#include "imukit/fourier.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SEGMENT = 64,
    BANDS = IMKI_COHERENT_BANDS,
    STRETCH = 2048, /* rows of which some segments are taken: */
    EARLY = 1 << 16,
    EARLY_SEGMENTS = 16,
    LATE_STRETCHES = 32, /* later, one of so many stretches */
    SEGMENTS_MIN = 40
};

/* Coherence of two axes that is a doubt; that is told. */
static const double doubted = 0.3, told = 0.2;
/* By chance the coherence of a band exceeds r with the probability exp(-n r^2), n the number of
 * segments [BENDAT2010]: the median over the bands is 0.84/sqrt(n), with a deviation of
 * 0.12/sqrt(n) (2000 simulated records of six axes). Beyond this over sqrt(n), seven deviations, it
 * is none of chance. */
static const double by_chance = 1.7;
/* Power over the median of the bands beyond which a band does not count. */
static const double resonant = 1.5;
static const double two_pi = 6.283185307179586;
static const double far_of_mean = 5; /* steps beyond are faults: four standard deviations */

void imki_coherence_start(imki_coherence *coherence, size_t count, const int *channel,
                          const imk_log_column *columns)
{
    memset(coherence, 0, sizeof *coherence);
    for (size_t c = 0; c < count && coherence->axes < IMKI_COHERENT_AXES; c++)
        if (columns[channel[c]].quantity != IMK_QUANTITY_OTHER)
            coherence->column[coherence->axes++] = channel[c];
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Steps far beyond the mean size of the others become 0. @return sum of squares, 0 if some are
 * missing */
static double steps_of(const double *x, double *step)
{
    double most = HUGE_VAL, square = 0;
    for (size_t i = 0; i < SEGMENT; i++)
        step[i] = x[i + 1] - x[i];
    for (int round = 0; round < 3; round++) {
        double size = 0, there = 0;
        square = 0;
        for (size_t i = 0; i < SEGMENT; i++) {
            step[i] = fabs(step[i]) > most ? 0 : step[i];
            size += fabs(step[i]);
            square += step[i] * step[i];
            there += step[i] != 0;
        }
        if (!(square > 0 && square < HUGE_VAL))
            return 0;
        most = far_of_mean * size / there;
    }
    return square;
}

/* Spectrum of the steps of a segment, of unit variance; false: some are missing, or none differs.
 */
static bool spectrum_of(const double *x, double *spectrum)
{
    char room[1 << 13];
    double step[SEGMENT];
    const double square = steps_of(x, step);
    if (!(square > 0))
        return false;
    for (size_t i = 0; i < SEGMENT; i++) {
        const double window = 1 - imk_cos(two_pi * (double)i / SEGMENT);
        spectrum[2 * i] = step[i] * window / sqrt(square);
        spectrum[2 * i + 1] = 0;
    }
    return imk_fourier(SEGMENT, spectrum, 0, room, sizeof room) == IMK_OK;
}

static void add_pair(const double *x, const double *y, double (*cross)[2])
{
    for (size_t k = 0; k < BANDS; k++, x += 2, y += 2) {
        cross[k][0] += x[0] * y[0] + x[1] * y[1];
        cross[k][1] += x[0] * y[1] - x[1] * y[0];
    }
}

static size_t pair_of(size_t a, size_t b)
{
    return b * (b - 1) / 2 + a;
}

static void add_segment(imki_coherence *s, double *const *columns, size_t first)
{
    double spectrum[IMKI_COHERENT_AXES][2 * SEGMENT];
    bool there[IMKI_COHERENT_AXES];
    for (size_t b = 0; b < s->axes; b++) {
        there[b] = spectrum_of(columns[s->column[b]] + first, spectrum[b]);
        s->segments[b] += there[b];
        for (size_t k = 0; there[b] && k < BANDS; k++) {
            const double *y = spectrum[b] + 2 * (k + 1);
            s->power[b][k] += y[0] * y[0] + y[1] * y[1];
        }
        for (size_t a = 0; a < b; a++)
            if (there[a] && there[b]) {
                s->pair[pair_of(a, b)].segments++;
                add_pair(spectrum[a] + 2, spectrum[b] + 2, s->pair[pair_of(a, b)].cross);
            }
    }
}

static void add_stretch(imki_coherence *s, size_t rows, double *const *columns, size_t first)
{
    const bool early = s->rows < EARLY;
    const size_t every = early ? STRETCH / EARLY_SEGMENTS : STRETCH;
    if (early || s->rows / STRETCH % LATE_STRETCHES == 0)
        for (size_t at = first; at + SEGMENT < first + rows; at += every)
            add_segment(s, columns, at);
    s->rows += rows;
}

void imki_coherence_add(imki_coherence *coherence, size_t rows, double *const *columns)
{
    for (size_t first = 0; coherence->axes > 1 && first < rows; first += STRETCH)
        add_stretch(coherence, rows - first < STRETCH ? rows - first : STRETCH, columns, first);
}

static double median_of(size_t count, double *values)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

/* Median over the bands whose noise is not far above that of the others, as by a resonance that
 * both axes feel; 0: there are too few segments, or it may be of chance. */
static double coherence_of(const imki_coherence *s, size_t a, size_t b)
{
    double band[BANDS], level[BANDS], sorted[BANDS];
    const double segments = s->pair[pair_of(a, b)].segments;
    size_t used = 0;
    if (segments < SEGMENTS_MIN)
        return 0;
    for (size_t k = 0; k < BANDS; k++) {
        const double *cross = s->pair[pair_of(a, b)].cross[k];
        const double power = s->power[a][k] / s->segments[a] * s->power[b][k] / s->segments[b];
        band[k] =
            power > 0 ? sqrt((cross[0] * cross[0] + cross[1] * cross[1]) / power) / segments : 0;
        /* of the samples: steps have 2 - 2 cos(2 pi f) times their power */
        level[k] = sqrt(power) / (1 - imk_cos(two_pi * (double)(k + 1) / SEGMENT));
        sorted[k] = level[k];
    }
    const double most = resonant * median_of(BANDS, sorted);
    for (size_t k = 0; k < BANDS; k++)
        if (level[k] <= most)
            band[used++] = band[k];
    const double shared = median_of(used, band);
    return shared > by_chance / sqrt(segments) ? shared : 0;
}

static bool is_told(const imk_findings *findings, const char *name)
{
    for (size_t k = 0; k < findings->count; k++) {
        const imk_finding *f = &findings->item[k];
        if ((strcmp(f->code, "copy") == 0 || strcmp(f->code, "follows") == 0) &&
            strcmp(f->name, name) == 0)
            return true;
    }
    return false;
}

/* Of many axes that share their noise, each is told with the one with which it shares most. */
void imki_coherence_tell(const imki_coherence *coherence, const imk_log_column *columns,
                         imk_findings *findings)
{
    double shared[IMKI_COHERENT_AXES * (IMKI_COHERENT_AXES - 1) / 2];
    double most[IMKI_COHERENT_AXES] = {0};
    for (size_t b = 1; b < coherence->axes; b++)
        for (size_t a = 0; a < b; a++) {
            const double found = shared[pair_of(a, b)] = coherence_of(coherence, a, b);
            most[a] = fmax(most[a], found);
            most[b] = fmax(most[b], found);
        }
    for (size_t b = 1; b < coherence->axes; b++)
        for (size_t a = 0; a < b; a++) {
            char names[2 * sizeof columns->name];
            const double found = shared[pair_of(a, b)];
            snprintf(names, sizeof names, "%s\t%s", columns[coherence->column[b]].name,
                     columns[coherence->column[a]].name);
            if (found > told && found >= fmin(most[a], most[b]) && !is_told(findings, names))
                imki_find(findings, found > doubted ? IMK_FINDING_WARNING : IMK_FINDING_NOTE,
                          "correlated", names, IMKI_NUMBERS(found));
        }
}
