/* SPDX-License-Identifier: Apache-2.0 */
/* imukit convert with a motion option: the specific force at another point of the body, and the
 * acceleration without gravity. Stands between the reader and what is done with the rows. */
#ifndef IMUKIT_CONVERT_MOTION_H
#define IMUKIT_CONVERT_MOTION_H

#include "shell/command.h"

#include "imukit/log.h"

typedef struct convert_motion_options {
    const char *to_point;
    bool gravity_free;
    double still, latitude, height, yaw; /* latitude NaN: not given */
} convert_motion_options;

enum { CONVERT_MOTION_OPTIONS = 6 };
extern const option convert_motion_option_table[CONVERT_MOTION_OPTIONS];
/* The defaults. */
convert_motion_options convert_motion_default(void);

typedef struct convert_motion convert_motion;

/* Check the options and the columns of the log. *motion is NULL when no option asks for anything.
 * @return -1 or the exit code, the message printed */
int convert_motion_start(const convert_motion_options *o, imk_log_reader *reader, const char *log,
                         convert_motion **motion);
/* As imk_log_read(), with the rows changed; a plain imk_log_read() when motion is NULL. */
imk_status convert_motion_read(convert_motion *motion, imk_log_reader *reader, size_t max_rows,
                               double *const *columns, size_t *rows, imk_error *error);
/* Say what is to be said of the result, and free; NULL is allowed. */
void convert_motion_end(convert_motion *motion);

#endif
