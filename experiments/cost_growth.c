/* SPDX-License-Identifier: Apache-2.0 */
/* How the cost of an analysis grows with the record, on one core.
 *
 * usage: cost_growth [longest] [FIGURE.svg]
 *
 * Records of 1e5, 1e6 … samples (up to 1e9 unless told otherwise) of white noise, flicker and walk;
 * each is timed through the streaming Allan variances, the overlapped Allan deviation at octaves
 * (which holds the record and is left out beyond 16 GB), and the whole identification, from samples
 * to a model, gathered block by block beyond the length that imk_identify_channel() is for. Prints
 * nanoseconds a sample; a linear cost is a constant. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { DECADES = 5, BLOCK = 1 << 16, WAYS = 3 };
static const double DT = 0.01, HELD_MAX = 1.0e9;
static const char *const names[WAYS] = {"streaming Allan variances, 3.9 kB",
                                        "overlapped Allan deviation, octaves",
                                        "identification, samples to model"};

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct source {
    imk_white_state white;
    imk_flicker_state flicker;
    imk_random_walk_state walk;
} source;

static void start(source *s)
{
    const imk_random random = imk_random_seeded(1);
    imk_white_start(&s->white, 1, DT, random, 1);
    imk_flicker_start(&s->flicker, (imk_flicker){0.1, 0}, DT, random, 1000);
    imk_random_walk_start(&s->walk, 0.002, DT, random, 2000);
}

static void make(source *s, size_t count, double *out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = 9.80665;
    imk_white_add(&s->white, count, out);
    imk_flicker_add(&s->flicker, count, out);
    imk_random_walk_add(&s->walk, count, out);
}

static double time_stream(size_t n, source *s, double *block)
{
    static imk_allan_stream stream;
    double spent = 0;
    imk_allan_stream_start(&stream, 0);
    start(s);
    for (size_t i = 0; i < n; i += BLOCK) {
        const size_t count = n - i < BLOCK ? n - i : BLOCK;
        make(s, count, block);
        const double begin = now();
        imk_allan_stream_add(&stream, count, block);
        spent += now() - begin;
    }
    return spent;
}

static double *whole(size_t n, source *s)
{
    double *record = malloc((n + 1) * sizeof *record);
    start(s);
    if (record)
        make(s, n, record);
    return record;
}

static double time_overlapped(size_t n, source *s)
{
    size_t factors[64];
    double variances[64], *record = (double)n <= HELD_MAX ? whole(n, s) : NULL;
    if (!record)
        return (double)NAN;
    const size_t count = imk_allan_factors(IMK_ALLAN_OCTAVE, n, factors);
    const double begin = now();
    imk_allan_sums(n, record, record, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, n, record, count, factors, variances, NULL, NULL);
    const double spent = now() - begin;
    free(record);
    return spent;
}

static double time_channel(size_t n, source *s, const imk_identify_settings *settings)
{
    const size_t size = imk_identify_workspace_size(n);
    double *record = whole(n, s);
    void *workspace = malloc(size);
    imk_identification result;
    double spent = (double)NAN;
    if (record && workspace) {
        const double begin = now();
        if (imk_identify_channel(settings, n, record, &result, workspace, size, NULL) == IMK_OK)
            spent = now() - begin;
    }
    free(record);
    free(workspace);
    return spent;
}

static double time_gathered(size_t n, source *s, double *block,
                            const imk_identify_settings *settings)
{
    const size_t size = imk_identify_record_size(n);
    void *memory = malloc(size), *workspace = NULL;
    imk_identify_record *record;
    imk_identification result;
    if (!memory || imk_identify_record_begin(n, &record, memory, size, NULL) != IMK_OK)
        return (double)NAN;
    double spent = 0;
    start(s);
    for (size_t i = 0; i < n; i += BLOCK) {
        const size_t count = n - i < BLOCK ? n - i : BLOCK;
        make(s, count, block);
        const double begin = now();
        imk_identify_record_add(record, count, block, NULL);
        spent += now() - begin;
    }
    const size_t need = imk_identify_record_workspace_size(record);
    workspace = malloc(need);
    const double begin = now();
    const imk_status status =
        workspace ? imk_identify_record_finish(record, settings, &result, workspace, need, NULL)
                  : IMK_ERROR_MEMORY;
    spent += now() - begin;
    free(workspace);
    free(memory);
    return status == IMK_OK ? spent : (double)NAN;
}

static void draw(const char *path, size_t count, double lengths[DECADES],
                 double seconds[WAYS][DECADES])
{
    imk_curve curves[WAYS];
    for (int w = 0; w < WAYS; w++)
        curves[w] =
            (imk_curve){names[w], IMK_CURVE_POINTS, w, count, lengths, seconds[w], NULL, NULL};
    const imk_panel panel = {.title = "One core, one channel",
                             .x_label = "samples",
                             .y_label = "time [s]",
                             .x_logarithmic = true,
                             .y_logarithmic = true,
                             .curve_count = WAYS,
                             .curves = curves,
                             .key = IMK_KEY_BELOW};
    const imk_figure figure = {"Cost against the length of the record", 1, 1, &panel};
    imk_error error;
    if (imk_figure_write(&figure, path, &error) != IMK_OK)
        fprintf(stderr, "cost_growth: %s was not written\n", path);
}

int main(int argc, char **argv)
{
    const double longest = argc > 1 ? atof(argv[1]) : 1e9;
    static source s;
    double *block = malloc(BLOCK * sizeof *block);
    double lengths[DECADES], seconds[WAYS][DECADES];
    imk_identify_settings settings = imk_identify_default();
    settings.dt = DT;
    size_t count = 0;
    printf("samples,%s,%s,%s [ns a sample]\n", names[0], names[1], names[2]);
    for (double length = 1e5; length <= longest && count < DECADES; length *= 10, count++) {
        const size_t n = (size_t)length;
        lengths[count] = length;
        seconds[0][count] = time_stream(n, &s, block);
        seconds[1][count] = time_overlapped(n, &s);
        seconds[2][count] = n <= IMK_IDENTIFY_RECORD_ADVISED
                                ? time_channel(n, &s, &settings)
                                : time_gathered(n, &s, block, &settings);
        printf("%.0e,%.3g,%.3g,%.3g\n", length, 1e9 * seconds[0][count] / length,
               1e9 * seconds[1][count] / length, 1e9 * seconds[2][count] / length);
        fflush(stdout);
    }
    if (argc > 2)
        draw(argv[2], count, lengths, seconds);
    free(block);
    return 0;
}
