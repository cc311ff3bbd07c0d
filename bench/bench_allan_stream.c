/* SPDX-License-Identifier: Apache-2.0 */
/* Streaming Allan variances, a sample at a time through all octaves in less than 4 KiB, against the
 * batch form (running sums, then every octave over the whole array). The batch form has the full
 * overlap and needs the record in memory. */
#include "bench.h"

#include "imukit/allan.h"
#include "imukit/allan_stream.h"
#include "imukit/random.h"

enum { SAMPLES = 10000000, BLOCK = 4096, REPEATS = 5 };

typedef struct records {
    double *rate, *sums;
    size_t factors[64], count;
    double variances[64];
    imk_allan_stream stream;
} records;

static void by_stream(void *context)
{
    records *r = context;
    imk_allan_stream_start(&r->stream, 0);
    for (size_t i = 0; i < SAMPLES; i += BLOCK)
        imk_allan_stream_add(&r->stream, SAMPLES - i < BLOCK ? SAMPLES - i : BLOCK, r->rate + i);
    bench_use(&r->stream);
}

static void by_array(void *context)
{
    records *r = context;
    imk_allan_sums(SAMPLES, r->rate, r->sums, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, SAMPLES, r->sums, r->count, r->factors, r->variances,
                        NULL, NULL);
    bench_use(r->variances);
}

int main(void)
{
    bench_pin();
    static records r;
    r.rate = malloc(SAMPLES * sizeof(double));
    r.sums = malloc((SAMPLES + 1) * sizeof(double));
    imk_random_normals(imk_random_seeded(1), 1, 0, SAMPLES, r.rate);
    r.count = imk_allan_factors(IMK_ALLAN_OCTAVE, SAMPLES, r.factors);
    double stream, array;
    bench_compare(REPEATS, by_stream, &r, by_array, &r, &stream, &array);
    bench_row_time("allan_stream_per_sample", 1e9 * stream / SAMPLES, 1e9 * array / SAMPLES, "ns",
                   "-", 1);
    fprintf(stderr, "bench_allan_stream: %zu bytes of state a channel\n", sizeof r.stream);
    free(r.rate);
    free(r.sums);
    return 0;
}
