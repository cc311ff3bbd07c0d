/* SPDX-License-Identifier: Apache-2.0 */
/* What every job asks of what it is handed, before it uses it. */
#ifndef IMUKI_RECORD_CHECK_INTERNAL_H
#define IMUKI_RECORD_CHECK_INTERNAL_H

#include "imukit/job.h"
#include "imukit/model.h"
#include "imukit/record.h"

/* A source that can be read: IMK_ERROR_ARGUMENT says what is missing. */
imk_status imki_check_source(const imk_record_source *source, imk_error *error);

/* A sink that can be written. */
imk_status imki_check_sink(const imk_record_sink *sink, imk_error *error);

/* A model that was initialised; its ranges are judged where they matter. */
imk_status imki_check_model(const imk_model *model, imk_error *error);

/* A number between 0 and 1, such as a confidence. */
imk_status imki_check_fraction(const char *field, double value, imk_error *error);

/* A unit that was asked for: IMK_ERROR_DIMENSION when it is none of this dimension. A scale of 0
 * asks for nothing. */
imk_status imki_check_unit(const imk_unit *asked, imk_dimension due, const char *field,
                           imk_error *error);

/* Findings of a source; one that offers none has those of the times of `rows` rows.
 * @param data  one array per column of the source */
imk_status imki_source_findings(const imk_record_source *source, size_t rows, double *const *data,
                                const imk_allocator *allocator, imk_log_findings *found,
                                imk_error *error);

/* Tell how a source is read, where that is not as one would think. */
void imki_tell_manner(const imk_record_source *source, imk_findings *findings);
/* The same, and what of a source, which is read to its end, could not be read. */
void imki_tell_damage(const imk_record_source *source, imk_findings *findings);

#endif
