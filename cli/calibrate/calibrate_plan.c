/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --plan: which test reaches a wanted uncertainty, as a table and as a programme
 * that imukit simulate, a table and imukit calibrate --motion understand. */
#include "calibrate_parts.h"

#include "imukit/output_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct plan {
    session *b;
    imk_plan_settings settings;
    imk_sigma_requirement requirement[IMK_CORRELATED_MAX];
    imk_calibrate_plan *made;
} plan;

/* ---- requirements ---------------------------------------------------------------------------- */

static int parse_requirements(plan *p)
{
    imk_error error;
    const imk_status status = imk_calibrate_requirements(
        p->b->found->calibration, p->b->settings.temperature_order, p->b->options->want,
        IMK_CORRELATED_MAX, p->requirement, &p->settings.requirement_count, &error);
    p->settings.requirement = p->requirement;
    if (status == IMK_ERROR_SYNTAX)
        return command_misused("--want \"%s\": expected %s", error.found, error.expected);
    return status == IMK_OK ? -1 : session_terms_refused("want", &error);
}

/* ---- programme as a file --------------------------------------------------------------------- */

static int write_programme(const plan *p, const char *path)
{
    imk_error error;
    char *text = NULL;
    size_t size = 0;
    if (p->settings.procedure == IMK_PROCEDURE_CENTRIFUGE)
        return command_misused("--output: a motion file cannot describe the arm of a centrifuge: "
                               "leave --output out, and set the levels that the table shows");
    if (p->made->unscripted.status != IMK_OK)
        return command_error(&p->made->unscripted, path);
    const imk_geodetic *place = p->b->settings.place_known ? &p->b->settings.place : NULL;
    (void)command_unless_memory(imk_calibrate_plan_text(p->made, place, &text, &size));
    imk_output_file *file = NULL;
    imk_status status = imk_output_file_open(path, &file, &error);
    if (status == IMK_OK) {
        (void)imk_output_file_write(file, text, size);
        status = imk_output_file_commit(file, &error);
    }
    free(text);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

/* ---- output ---------------------------------------------------------------------------------- */

static void show_next(const plan *p, imk_result *result)
{
    const calibrate_options *o = p->b->options;
    const imk_procedure procedure = p->settings.procedure;
    const char *model = p->b->path[0];
    const bool wants_motion = procedure >= IMK_PROCEDURE_RATE_TABLE;
    if (procedure == IMK_PROCEDURE_CENTRIFUGE)
        imk_result_line(result, "Set these levels; a motion file cannot describe the arm of a "
                                "centrifuge. Next: log the test with columns "
                                "reference_force_x [g] …, and imukit calibrate LOG --procedure "
                                "centrifuge");
    else if (!o->output)
        imk_result_line(result, "Next: add -o programme.yaml to keep the programme");
    else if (procedure == IMK_PROCEDURE_THERMAL)
        imk_result_line(result,
                        "Programme: %s\nNext: imukit simulate %s --temperature %s --rate %gHz "
                        "--duration %.0fs -o bench.csv",
                        o->output, model, o->output, p->settings.rate, ceil(p->made->duration));
    else
        imk_result_line(result,
                        "Programme: %s\nNext: imukit simulate %s --motion %s --rate %gHz "
                        "--duration %.0fs -o bench.csv && imukit calibrate bench.csv --procedure "
                        "%s%s%s%s%s%s",
                        o->output, model, o->output, p->settings.rate, ceil(p->made->duration),
                        imk_procedure_name(procedure), wants_motion ? " --motion " : "",
                        wants_motion ? o->output : "", o->position ? " --position \"" : "",
                        o->position ? o->position : "", o->position ? "\"" : "");
}

/* ---- run ------------------------------------------------------------------------------------- */

static int make(plan *p)
{
    imk_error error;
    const imk_status status =
        imk_calibrate_plan_run(p->b->found->calibration, &p->settings, NULL, &p->made, &error);
    if (status == IMK_ERROR_KEY_MISSING && strstr(error.field, "noise"))
        return command_failed_by(
            "no_noise", NULL, p->b->path[0],
            "%s states no noise, so the length of the test cannot be computed: "
            "identify the noise from a log at rest (imukit identify)",
            p->b->path[0]);
    return command_unless_memory(status) == IMK_OK ? -1 : command_error(&error, NULL);
}

static int set_up(plan *p)
{
    session *b = p->b;
    const calibrate_options *o = b->options;
    imk_document *unused = NULL;
    int code = -1;
    imk_error error;
    if (imk_calibrate_plan_settings(b->found, &p->settings, &error) != IMK_OK)
        code = command_misused("--plan: %s; %s", error.found, error.expected);
    if (code < 0)
        code = command_model(b->path[0], &b->found->calibration->model, &unused);
    imk_document_free(unused);
    if (code >= 0)
        return code;
    if (!isnan(o->soak))
        p->settings.soak = o->soak;
    if (o->log.file.rate > 0)
        p->settings.rate = o->log.file.rate;
    return parse_requirements(p);
}

int session_plan(session *b)
{
    plan *p = command_zeroed(sizeof *p);
    p->b = b;
    int code = set_up(p);
    if (code < 0)
        code = make(p);
    if (code < 0 && b->options->output)
        code = write_programme(p, b->options->output);
    if (code < 0) {
        const bool short_of = p->made->result.reached < p->settings.requirement_count;
        code = b->options->strict && short_of ? EXIT_FAILED : EXIT_DONE;
        imk_result *result = show_begin("calibrate");
        imk_show_calibrate_plan(p->made, b->path[0], result);
        show_next(p, result);
        code = show_end(result, &(show_options){.json = b->options->json}, code);
    }
    imk_calibrate_plan_free(p->made);
    free(p);
    return code;
}
