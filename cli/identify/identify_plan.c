/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify --plan: how long to record. */
#include "identify_parts.h"
#include "shell/growing_list.h"

#include <stdlib.h>
#include <string.h>

static int refuse_name(const imk_record_plan *p, const char *model, const char *given)
{
    const char *keys[IMK_PLAN_PARAMETERS_MAX];
    size_t count = 0;
    growing_list list = {0};
    for (size_t k = 0; k < p->parameter_count; k++) {
        bool known = false;
        for (size_t j = 0; j < count; j++)
            known = known || strcmp(keys[j], p->parameter[k].key) == 0;
        if (known)
            continue;
        keys[count++] = p->parameter[k].key;
        list_add_item(&list, "%s", p->parameter[k].key);
    }
    const char *nearest = command_nearest(given, count, keys);
    const int code = command_misused("--want \"%s\": %s has no such noise term%s%s%s; it has %s",
                                     given, model, nearest ? " (did you mean " : "",
                                     nearest ? nearest : "", nearest ? "?)" : "", list.text);
    list_free(&list);
    return code;
}

/* @return -1 or the exit code */
static int tell(const imk_record_plan *p, const char *model, imk_status status,
                const imk_error *error)
{
    char text[400];
    if (command_unless_memory(status) == IMK_OK)
        return -1;
    const imk_finding *failure = p ? imk_findings_failure(&p->findings) : NULL;
    if (!failure)
        return command_error(error, model);
    if (status == IMK_ERROR_NAME_UNKNOWN)
        return refuse_name(p, model, failure->name);
    imk_finding_text(failure, text, sizeof text);
    return status == IMK_ERROR_EMPTY ? command_failed("%s %s", model, text)
                                     : command_misused("%s", text);
}

int identify_plan(const identify_options *o)
{
    if (!(o->log.file.rate > 0))
        return command_misused(
            "--plan: the sampling rate of the record is missing; add it, such as --rate 100Hz");
    imk_model *model = command_memory(NULL, sizeof *model);
    imk_record_plan *p = NULL;
    imk_error error;
    int code = command_model(o->plan, model, NULL);
    if (code < 0) {
        imk_record_plan_settings settings = imk_record_plan_default();
        settings.rate = o->log.file.rate;
        settings.duration = o->duration;
        settings.significance = o->significance;
        settings.want = o->want;
        settings.curve = o->plot != NULL;
        const imk_status status = imk_record_plan_run(model, &settings, NULL, &p, &error);
        code = tell(p, o->plan, status, &error);
    }
    if (code < 0) {
        imk_result *result = show_begin("identify");
        imk_show_record_plan(p, o->plan, result);
        const show_options options = {.plot = o->plot, .json = o->json};
        code = show_end(result, &options, o->strict && !p->met ? EXIT_FAILED : EXIT_DONE);
    }
    imk_record_plan_free(p, &(imk_allocator){0});
    free(model);
    return code;
}
