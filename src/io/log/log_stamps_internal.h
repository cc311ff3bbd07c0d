/* SPDX-License-Identifier: Apache-2.0 */
/* Times of rows that a double does not hold: 19 digits of nanoseconds since 1970, dates. They are
 * read as whole ticks, and the first one is subtracted before they become numbers. */
#ifndef IMUKIT_LOG_STAMPS_INTERNAL_H
#define IMUKIT_LOG_STAMPS_INTERNAL_H

#include <stdbool.h>
#include <stdint.h>

typedef struct imki_log_stamps {
    bool exact;         /* times are read so */
    bool dates;         /* the cells are dates, the ticks nanoseconds */
    int digits;         /* decimals of a tick */
    int64_t origin;     /* [ticks], of the first row */
    double per_unit;    /* ticks in the unit of the time; of dates, in a second */
    int64_t rest_ticks; /* [ticks] of one in the second column of the time; 0: there is none */
} imki_log_stamps;

/* A date with time: "2024-05-01T12:00:00.123456Z", with a blank instead of the T, with +02:00 or
 * without a zone, after [ISO8601]. @param ticks  [ns] since 1970, NULL: not wanted */
bool imki_log_date_read(const char *begin, const char *end, int64_t *ticks);

/* Begin with the cell of the first row, for times that count from an epoch.
 * @param scale  [s] of the unit */
imki_log_stamps imki_log_stamps_start(const char *begin, const char *end, double scale);

/* As imki_log_stamps_start(), of whole seconds and the rest beyond them in two columns.
 * @param rest_ticks  [ns] of one of the rest */
imki_log_stamps imki_log_stamps_join(const char *begin, const char *end, const char *rest,
                                     const char *rest_end, int64_t rest_ticks);
bool imki_log_stamp_join(const imki_log_stamps *stamps, const char *begin, const char *end,
                         const char *rest, const char *rest_end, double *value);

/* Time of a row in its unit, from the first one on. */
bool imki_log_stamp_read(const imki_log_stamps *stamps, const char *begin, const char *end,
                         double *value);

/* What was subtracted, in the unit. */
double imki_log_stamps_origin(const imki_log_stamps *stamps);

#endif
