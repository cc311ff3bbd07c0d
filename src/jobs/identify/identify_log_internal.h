/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the job: a record in memory, and one that is too long for it. */
#ifndef IMUKI_IDENTIFY_LOG_INTERNAL_H
#define IMUKI_IDENTIFY_LOG_INTERNAL_H

#include "imukit/allan_fit.h"
#include "imukit/identify_log.h"

/* Settings of a channel's estimate; with a summary to be filled where it is wanted.
 * @return false: memory is exhausted */
bool imki_identify_settings(imk_identify_log *log, size_t channel, const imk_allocator *allocator,
                            imk_identify_settings *settings);

/* Settings of the screening of each channel: a thousandth for false alarms in all of them. */
imk_screen_settings imki_screen_settings(const imk_identify_log *log);

/* Why a channel could not be identified. @return status */
imk_status imki_identify_explain(imk_identify_log *log, size_t channel, imk_status status,
                                 const imk_error *why, imk_error *error);

/* Noise over time of a channel that is identified, and what follows for its interval of N.
 * @param map  of the channel; NULL: made of its samples */
imk_status imki_identify_changes(imk_identify_log *log, size_t channel, const imk_noise_map *map,
                                 const imk_allocator *allocator, imk_error *error);

/* All channels of a loaded record, each screened and identified as an item of the executor. */
imk_status imki_identify_channels(imk_identify_log *log, const imk_job *job, imk_error *error);

/* All channels of a long record in one pass over it. `taken` is false, and nothing is kept, where
 * it is to be loaded: it is short, or its rows are not evenly spaced. */
imk_status imki_identify_long(imk_identify_log *log, const imk_record_source *source,
                              const imk_job *job, bool *taken, imk_error *error);

/* To the digits the values have, in the units of the model file. */
void imki_round_model(imk_model *model);

/* Replace the terms by those of a generalised least-squares fit to the Allan deviations, with the
 * lines, resonances and filter found before. */
imk_status imki_identify_by_allan(imk_identify_log *log, const imk_job *job, imk_error *error);
/* The terms of such a fit. */
void imki_store_fit(imk_identification *result, const imk_allan_fit *fit);

#endif
