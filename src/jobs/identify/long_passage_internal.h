/* SPDX-License-Identifier: Apache-2.0 */
/* One channel of a long record as it passes by: screened, then gathered. */
#ifndef IMUKI_LONG_PASSAGE_INTERNAL_H
#define IMUKI_LONG_PASSAGE_INTERNAL_H

#include "jobs/arena_internal.h"

#include "imukit/identify_record.h"
#include "imukit/record_screen.h"

/* Gathered without what is to be taken out; and, once its outliers may be the noise itself, with
 * them, in memory of its own. */
typedef struct imki_passage {
    unsigned take_out;
    size_t expected;
    const imk_allocator *allocator;
    imk_screener *screener;
    imk_identify_record *clean, *loose;
    void *fork; /* memory of `loose` */
    imk_status status;
    imk_error error;
} imki_passage;

/* @param arena  of everything but the fork @return false: memory is exhausted, or not enough */
bool imki_passage_begin(imki_passage *passage, const imk_screen_settings *settings,
                        unsigned take_out, size_t expected, imki_arena *arena,
                        const imk_allocator *allocator);
void imki_passage_add(imki_passage *passage, size_t count, const double *samples,
                      const double *temperature);
/* What was found, and the record to be identified, without its trends if they are to be taken out.
 */
imk_status imki_passage_finish(imki_passage *passage, double dt, imk_identify_record **record,
                               imk_screen *found, imk_error *error);
void imki_passage_end(imki_passage *passage);

#endif
