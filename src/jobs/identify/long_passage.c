/* SPDX-License-Identifier: Apache-2.0 */
/* One channel of a long record as it passes by.
 *
 * Whether its outliers are faults or the noise itself is known at the end. So from the block on in
 * which the screener suspects the latter, the record is gathered twice, with and without them. */
#include "long_passage_internal.h"

static void gather(imki_passage *p, imk_identify_record *record, size_t count,
                   const double *samples)
{
    if (p->status == IMK_OK)
        p->status = imk_identify_record_add(record, count, samples, &p->error);
}

static void fork_record(imki_passage *p)
{
    const size_t size = imk_identify_record_size(p->expected);
    p->fork = imki_resize(p->allocator, NULL, size);
    if (!p->fork) {
        p->status = imk_error_set(&p->error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        return;
    }
    p->status = imk_identify_record_copy(p->clean, &p->loose, p->fork, size, &p->error);
}

static void take(void *context, size_t count, const double *loose, const double *clean)
{
    imki_passage *p = context;
    if (clean != loose && !p->loose && p->status == IMK_OK &&
        imk_screener_suspects_tails(p->screener))
        fork_record(p);
    if (p->loose)
        gather(p, p->loose, count, loose);
    gather(p, p->clean, count, clean);
}

bool imki_passage_begin(imki_passage *p, const imk_screen_settings *settings, unsigned take_out,
                        size_t expected, imki_arena *arena, const imk_allocator *allocator)
{
    const size_t size = imk_identify_record_size(expected), screener = imk_screener_size();
    *p = (imki_passage){.take_out = take_out, .expected = expected, .allocator = allocator};
    void *memory = imki_arena_room(arena, size), *beside = imki_arena_room(arena, screener);
    return memory && beside &&
           imk_identify_record_begin(expected, &p->clean, memory, size, NULL) == IMK_OK &&
           imk_screener_begin(settings, take_out, take, p, &p->screener, beside, screener, NULL) ==
               IMK_OK;
}

void imki_passage_add(imki_passage *p, size_t count, const double *samples,
                      const double *temperature)
{
    imk_screener_add(p->screener, count, samples, temperature);
}

/* The trend of a passage at a time. */
static double trend_of(const void *context, double time)
{
    const imki_passage *p = context;
    return imk_screener_trend(p->screener, p->take_out, time);
}

imk_status imki_passage_finish(imki_passage *p, double dt, imk_identify_record **record,
                               imk_screen *found, imk_error *error)
{
    const imk_status screened = imk_screener_finish(p->screener, found, error);
    if (screened != IMK_OK)
        return screened;
    if (p->status != IMK_OK) {
        if (error)
            *error = p->error;
        return p->status;
    }
    const bool kept = found->heavy_tails && p->loose;
    *record = kept ? p->loose : p->clean;
    const unsigned trends = IMK_SCREEN_WARM_UP | IMK_SCREEN_TEMPERATURE;
    if ((p->take_out & trends) && (found->warm_up || found->temperature_degree > 0))
        imk_identify_record_subtract(*record, dt, trend_of, p);
    return IMK_OK;
}

void imki_passage_end(imki_passage *p)
{
    if (p->fork)
        imki_resize(p->allocator, p->fork, 0);
    p->fork = NULL;
    p->loose = NULL;
}
