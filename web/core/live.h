/* SPDX-License-Identifier: Apache-2.0 */
/* The instrument that runs in a page, for the functions that run it (live.c) and those that
 * describe and draw it (live_show.c). */
#ifndef IMUKIT_WEB_LIVE_H
#define IMUKIT_WEB_LIVE_H

#include "imukit/design_file.h"
#include "io/log/log_format_internal.h"

enum { LIVE_ROWS = 4096, LIVE_COLUMNS = IMK_INSTRUMENT_OUTPUTS_MAX + IMK_INSTRUMENT_SIGNALS_MAX };

typedef struct live_instrument {
    imk_design_file file; /* instrument and design */
    void *state;
    imk_physics_settings physics; /* its rate is that of the rows */
    imk_exposure exposure;
    double asked_rate; /* rate of the rows as the pace asks for it [Hz] */
    double pace;       /* simulated seconds for each second on the screen */
    double owed;       /* part of a row that is due */
    double screen;     /* time on the screen since the beginning [s] */
    double turned;     /* integral of the input along x over the run [rad], [m/s] */
    uint64_t row;      /* rows of the run so far */
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    imki_column_format column[LIVE_COLUMNS]; /* outputs, then signals */
    double rows[LIVE_ROWS * (1 + LIVE_COLUMNS)];
} live_instrument;

extern live_instrument live;

/* Unit of a column of the rows: an output, or a signal after them. */
const char *live_unit(const imk_instrument *instrument, size_t column);

/* What is seen first: pace, input, and time before it [s]. */
double live_first_pace(const imk_instrument *instrument, const void *design);
void live_first_input(const imk_instrument *instrument, imk_exposure *exposure);
double live_settling(void);

#endif
