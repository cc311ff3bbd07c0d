/* SPDX-License-Identifier: Apache-2.0 */
/* The options of imukit navigate about aids: which columns are used, their sigmas and lever arms.
 */
#include "navigate_parts.h"
#include "shell/aid_option.h"

#include <math.h>

static int check_aids(const navigate_options *o)
{
    static const struct {
        const char *name;
        size_t at;
    } dependants[] = {{"aid-map", offsetof(navigate_options, aid_map)},
                      {"aid-sigma", offsetof(navigate_options, aid_sigma)},
                      {"aid-lever-arm", offsetof(navigate_options, aid_lever_arm)},
                      {"speed-lever-arm", offsetof(navigate_options, speed_lever_arm)}};
    for (size_t k = 0; k < sizeof dependants / sizeof *dependants && !o->aid; k++)
        if (*(const char *const *)(const void *)((const char *)o + dependants[k].at))
            return command_misused("--%s is about --aid FILE; add that option", dependants[k].name);
    if (!o->aid && (!isnan(o->aid_delay) || !isnan(o->aid_interval) || !isnan(o->aid_until)))
        return command_misused("--aid-%s is about --aid FILE; add that option",
                               !isnan(o->aid_delay)      ? "delay"
                               : !isnan(o->aid_interval) ? "interval"
                                                         : "until");
    if (o->aid && !o->model)
        return command_misused("--aid needs the errors of the sensors; add --model MODEL, one from "
                               "imukit identify or a name from imukit devices");
    if (o->smooth && !o->model)
        return command_misused("--smooth needs the errors of the sensors; add --model MODEL, one "
                               "from imukit identify or a name from imukit devices");
    if (o->smooth && !isnan(o->still_rotation) && o->still_rotation > 0.0)
        return command_misused("--smooth cannot be used with --still-rotation: leave one out");
    if (o->aid_interval < 0.0 || o->aid_until < 0.0)
        return command_misused("--aid-interval and --aid-until must not be negative");
    return -1;
}

int navigate_parse_aids(const navigate_options *o, imk_navigate_log_settings *s)
{
    int code = check_aids(o);
    if (code >= 0 || !o->aid)
        return code;
    if (o->aid_sigma)
        code = aid_option_kinds("aid-sigma", o->aid_sigma, &s->aid_count, s->aid);
    if (code < 0 && o->aid_lever_arm)
        code = aid_option_arm("aid-lever-arm", o->aid_lever_arm, s->lever_arm, s->lever_arm_sigma);
    if (code < 0 && o->speed_lever_arm)
        code = aid_option_arm("speed-lever-arm", o->speed_lever_arm, s->speed_lever_arm, NULL);
    for (size_t k = 0; k < s->aid_count && code < 0; k++) {
        const imk_aid *aid = &s->aid[k];
        if (aid->interval != 1.0 || aid->from != 1.0 || aid->until < (double)INFINITY)
            return command_misused("--aid-sigma \"%s\": the times are those of the table; "
                                   "--aid-interval and --aid-until choose among them",
                                   o->aid_sigma);
    }
    s->aid_delay = isnan(o->aid_delay) ? 0.0 : o->aid_delay;
    s->aid_interval = isnan(o->aid_interval) ? 0.0 : o->aid_interval;
    s->aid_until = isnan(o->aid_until) ? (double)INFINITY : o->aid_until;
    s->aids_name = o->aid;
    return code;
}
