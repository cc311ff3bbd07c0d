/* SPDX-License-Identifier: Apache-2.0 */
/* What came out, or why nothing did: messages, the model file, what is shown. */
#include "calibrate_parts.h"
#include "shell/model_changes.h"
#include "shell/voice.h"

#include <stdlib.h>

static const char *given_model(const calibrate_options *o)
{
    return o->into ? o->into : o->model ? o->model : "the model";
}

int session_done(const session *b, imk_status status, const imk_error *error)
{
    const imk_calibrate_log *found = b->found;
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(&found->findings) : NULL;
    const char *path = found->failed < found->count ? found->record[found->failed].path : NULL;
    char text[1000];
    for (size_t k = 0; k < found->findings.count; k++) {
        const imk_finding *f = &found->findings.item[k];
        imk_finding_message(f, path, given_model(b->options), text, sizeof text);
        if (f->level == IMK_FINDING_WARNING)
            command_warn(imk_finding_code(f), "%s", text);
        else if (f->level == IMK_FINDING_NOTE)
            command_note(imk_finding_code(f), "%s", text);
    }
    if (command_unless_memory(status) == IMK_OK)
        return -1;
    if (failure && status == IMK_ERROR_ARGUMENT)
        return command_misused("%s", text);
    if (failure || imk_calibrate_failure(found, error, text, sizeof text) > 0)
        return command_failed_by(failure ? imk_finding_code(failure) : NULL, error, path, "%s",
                                 text);
    const bool of_name = status == IMK_ERROR_KEY_UNKNOWN || status == IMK_ERROR_RANGE ||
                         status == IMK_ERROR_WORKSPACE;
    if (b->options->settings.estimate && !found->result && of_name && found->failed == found->count)
        return session_terms_refused("estimate", error);
    return command_error(error, path);
}

static void show_next(const session *b, bool useless, imk_result *result)
{
    const calibrate_options *o = b->options;
    if (o->report)
        imk_result_line(result, "Report: %s", o->report);
    if (useless && !o->anyway)
        return;
    if (!o->output)
        imk_result_line(result, "Next: add -o model.yaml to keep the model, --report report.html "
                                "for a page");
    else if (b->found->runs)
        imk_result_line(result, "Model: %s\nNext: imukit grade %s", o->output, o->output);
    else
        imk_result_line(result, "Model: %s\nNext: imukit compensate LOG %s -o clean.csv", o->output,
                        o->output);
}

/* What was warned of on the way here belongs to the verdict, and what that warns of is told too. */
static imk_verdict assess(const session *b, imk_result *result)
{
    size_t count = 0;
    imk_message *before = command_memory(NULL, (told_warnings() + 1) * sizeof *before);
    for (size_t k = 0; k < told_count(); k++) {
        const told *t = told_get(k);
        if (t->level == IMK_FINDING_WARNING)
            before[count++] = (imk_message){.level = t->level, .code = t->code, .text = t->message};
    }
    const imk_verdict v = imk_calibrate_verdict(b->found, count, before, result);
    free(before);
    for (size_t k = count; k < v.count; k++)
        if (v.message[k].level >= IMK_FINDING_WARNING)
            command_warn(v.message[k].code, "%s", v.message[k].text);
    return v;
}

static int write_model(session *b)
{
    imk_error error;
    const calibrate_options *o = b->options;
    const imk_model *model = &b->found->model;
    if (o->into)
        model_print_changes(o->into, b->found->before, model, b->document);
    if (o->output && imk_model_write(o->output, model, b->document, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

int session_show(session *b)
{
    const calibrate_options *o = b->options;
    imk_model *model = &b->found->model;
    if (o->name || !model->name[0] || !o->into)
        command_model_name(o->name, b->path[0], model->name, sizeof model->name);
    imk_result *result = show_begin("calibrate");
    const imk_verdict verdict = assess(b, result);
    const bool useless = imk_verdict_level(&verdict) == IMK_FINDING_FAILURE;
    const bool writes = !useless || o->anyway;
    const int end =
        (useless && !o->anyway) || (o->strict && told_warnings() > 0) ? EXIT_FAILED : EXIT_DONE;
    int code = -1;
    if (writes)
        code = write_model(b);
    else if (o->output)
        command_note("not_written", "%s is not written (--anyway would)", o->output);
    if (code >= 0) {
        imk_result_free(result);
        return code;
    }
    if (writes)
        voice_model(model);
    imk_show_calibrate_log(b->found, &verdict, o->poses, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_model(result, "Model file", &b->found->model);
    show_origin(result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_next(b, useless, result);
    const bool drawn = imk_result_figure_get(result, IMK_FOR_PAGE, 0);
    const show_options options = {.report = o->report,
                                  .plot = o->plot,
                                  .json = o->json,
                                  .lacking = drawn ? NULL : "observations to draw"};
    return show_end(result, &options, end);
}
