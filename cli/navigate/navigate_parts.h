/* SPDX-License-Identifier: Apache-2.0 */
/* Options of imukit navigate. */
#ifndef IMUKIT_NAVIGATE_PARTS_H
#define IMUKIT_NAVIGATE_PARTS_H

#include "log/log_input.h"

#include "imukit/navigate_log.h"

typedef struct navigate_options {
    log_input log;
    const char *position, *position_sigma, *velocity, *attitude, *heading, *model, *zero_velocity,
        *output, *plot, *report;
    const char *aid, *aid_map, *aid_sigma, *aid_lever_arm, *speed_lever_arm;
    double aid_delay, aid_interval, aid_until; /* NaN: not given */
    /* NaN: not given, of align, stop and still_rotation */
    double align, stop, still_velocity, still_rotation, interval, standard_gravity;
    option_integer samples;
    int method, vertical; /* method -1: not given */
    bool json, strict, gravity_free, smooth;
} navigate_options;

/* What is asked. @param model  the settings have it when it is asked for
 * @return -1 or the exit code, the message printed */
int navigate_parse(const navigate_options *o, imk_model *model, imk_navigate_log_settings *s);

/* The same of aids. @return -1 or the exit code, the message printed */
int navigate_parse_aids(const navigate_options *o, imk_navigate_log_settings *s);

#endif
