/* SPDX-License-Identifier: Apache-2.0 */
/* Do axes of one sensor share their noise? Each has noise of its own, so they share it where one is
 * computed from others, where they talk across, or where one is another one some rows late.
 *
 * The coherence |S_ab|/sqrt(S_aa S_bb) of their steps from row to row [BENDAT2010] does
 * not depend on a delay, and a tone that all axes feel is in few bands: its median over the bands
 * is that of the broad-band noise. Each segment counts as much as another, and without the steps
 * far beyond the others, so that rows with faults on all axes count nothing. */
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
    EARLY_SEGMENTS = 8,
    LATE_STRETCHES = 32, /* later, one of so many stretches */
    SEGMENTS_MIN = 20
};

/* Coherence of two axes that is a doubt; that is told. By chance it is one over the root of the
 * number of segments. */
static const double doubted = 0.5, told = 0.3;
static const double far_of_mean = 5; /* steps beyond are faults: four standard deviations */

void imki_coherence_start(imki_coherence *coherence, size_t count, const int *channel,
                          const imk_log_column *columns)
{
    memset(coherence, 0, sizeof *coherence);
    for (size_t c = 0; c < count; c++) {
        const bool accel = columns[channel[c]].quantity == IMK_QUANTITY_SPECIFIC_FORCE;
        imki_coherent_axes *sensor = &coherence->sensor[accel];
        if (columns[channel[c]].quantity != IMK_QUANTITY_OTHER && sensor->axes < IMKI_COHERENT_AXES)
            sensor->column[sensor->axes++] = channel[c];
    }
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
    static const double two_pi = 6.283185307179586;
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

static void add_segment(imki_coherent_axes *s, double *const *columns, size_t first)
{
    double spectrum[IMKI_COHERENT_AXES][2 * SEGMENT];
    for (size_t c = 0; c < s->axes; c++)
        if (!spectrum_of(columns[s->column[c]] + first, spectrum[c]))
            return;
    for (size_t b = 0, pair = 0; b < s->axes; b++) {
        for (size_t k = 0; k < BANDS; k++) {
            const double *y = spectrum[b] + 2 * (k + 1);
            s->power[b][k] += y[0] * y[0] + y[1] * y[1];
        }
        for (size_t a = 0; a < b; a++, pair++)
            for (size_t k = 0; k < BANDS; k++) {
                const double *x = spectrum[a] + 2 * (k + 1), *y = spectrum[b] + 2 * (k + 1);
                s->cross[pair][k][0] += x[0] * y[0] + x[1] * y[1];
                s->cross[pair][k][1] += x[0] * y[1] - x[1] * y[0];
            }
    }
    s->segments++;
}

static void add_stretch(imki_coherent_axes *s, size_t rows, double *const *columns, size_t first)
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
    for (int k = 0; k < 2; k++)
        for (size_t first = 0; coherence->sensor[k].axes > 1 && first < rows; first += STRETCH)
            add_stretch(&coherence->sensor[k], rows - first < STRETCH ? rows - first : STRETCH,
                        columns, first);
}

/* Median over the bands. */
static double coherence_of(const imki_coherent_axes *s, size_t a, size_t b)
{
    double band[BANDS];
    const size_t pair = b * (b - 1) / 2 + a;
    for (size_t k = 0; k < BANDS; k++) {
        const double power = s->power[a][k] * s->power[b][k];
        band[k] = power > 0 ? hypot(s->cross[pair][k][0], s->cross[pair][k][1]) / sqrt(power) : 0;
    }
    qsort(band, BANDS, sizeof *band, ascending);
    return band[BANDS / 2];
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

void imki_coherence_tell(const imki_coherence *coherence, const imk_log_column *columns,
                         imk_findings *findings)
{
    for (int k = 0; k < 2; k++) {
        const imki_coherent_axes *s = &coherence->sensor[k];
        for (size_t b = 1; b < s->axes && s->segments >= SEGMENTS_MIN; b++)
            for (size_t a = 0; a < b; a++) {
                char names[2 * sizeof columns->name];
                const double shared = coherence_of(s, a, b);
                snprintf(names, sizeof names, "%s\t%s", columns[s->column[b]].name,
                         columns[s->column[a]].name);
                if (shared > told && !is_told(findings, names))
                    imki_find(findings, shared > doubted ? IMK_FINDING_WARNING : IMK_FINDING_NOTE,
                              "correlated", names, IMKI_NUMBERS(shared));
            }
    }
}
