/* SPDX-License-Identifier: Apache-2.0 */
/* The aids of the navigator and their end, from the options. */
#include "drift_parts.h"
#include "shell/aid_option.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int read_aids(const option_texts *texts, drift_scene *s)
{
    imk_drift_settings *settings = &s->settings;
    imk_aid aid[IMK_AIDS_MAX];
    for (size_t t = 0; t < texts->count; t++) {
        size_t count;
        const int code = aid_option_parse("aid", texts->text[t], &count, aid);
        if (code >= 0)
            return code;
        if (settings->aid_count + count > IMK_AIDS_MAX)
            return command_misused("--aid: at most %d quantities in all", IMK_AIDS_MAX);
        if (aid[0].interval * settings->rate < 1.0 - 1e-9)
            return command_misused(
                "--aid \"%s\": readings come at most once a sample, and --rate is "
                "%g Hz; state a lower rate, or a higher --rate",
                texts->text[t], settings->rate);
        for (size_t k = 0; k < count; k++)
            s->aid[settings->aid_count++] = aid[k];
    }
    settings->aid = s->aid;
    return -1;
}

static int check_outage(const drift_options *o, const drift_scene *s)
{
    const bool ends = !isnan(imk_drift_outage(&s->settings));
    if (o->outage && !o->aid.count)
        return command_misused("--outage is for a navigator with aids; add --aid \"gnss position "
                               "1 m, velocity 0.05 m/s at 1 Hz until 600 s\"");
    if (o->outage && (o->times || !isnan(o->duration)))
        return command_misused("--outage gives the times of the table; leave %s out",
                               o->times ? "--times" : "--duration");
    if ((o->outage || s->want_after) && !ends)
        return command_misused("%s counts from the end of the aids, and no --aid ends; add \"until "
                               "600 s\" to it",
                               o->outage ? "--outage" : "\"after\" in --want");
    if (o->filter_model && !o->aid.count)
        return command_misused("--filter-model is for a navigator with aids; add --aid");
    if (o->gains == 1 && (!o->aid.count || !o->want))
        return command_misused("--gains retuned is for --want with a navigator with aids; add %s",
                               o->want ? "--aid" : "--want \"CEP 5 m after 60 s\"");
    return -1;
}

int drift_aids_open(const drift_options *o, drift_scene *s)
{
    int code = read_aids(&o->aid, s);
    if (code < 0)
        code = check_outage(o, s);
    if (code < 0 && s->want_after)
        s->want.time += imk_drift_outage(&s->settings);
    if (code < 0 && o->filter_model) {
        s->filter_model = command_memory(NULL, sizeof *s->filter_model);
        code = command_model(o->filter_model, s->filter_model, NULL);
        s->settings.filter_model = s->filter_model;
    }
    return code;
}
