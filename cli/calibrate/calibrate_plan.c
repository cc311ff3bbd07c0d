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

/* "accel.scale_factor 50 ppm": every number of the term. */
static int parse_requirement(plan *p, const char *text, size_t length)
{
    char item[160];
    snprintf(item, sizeof item, "%.*s", (int)(length < 159 ? length : 159), text);
    char *name = item + strspn(item, " "), *value = name + strcspn(name, " ");
    if (!*value)
        return command_misused("--want \"%s\": expected a term and its 1 sigma, such as "
                               "\"accel.scale_factor 50 ppm\"",
                               name);
    *value++ = '\0';
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    size_t count = 0;
    imk_error error;
    if (imk_calibrate_terms(p->b->found->calibration, p->b->settings.temperature_order, name,
                            IMK_CORRELATED_MAX, parameter, &count, &error) != IMK_OK)
        return session_terms_refused("want", &error);
    for (size_t k = 0; k < count; k++) {
        double sigma, unused;
        size_t numbers;
        const char *unit = imk_parameter_file_unit(parameter[k]);
        if (imk_quantity_parse(value, value + strlen(value), imk_unit_of(unit).dimension, 1, &sigma,
                               &unused, &numbers, NULL, &error) != IMK_OK ||
            !(sigma > 0))
            return command_misused("--want \"%s %s\": expected a positive number with a unit such "
                                   "as %s",
                                   name, value, unit);
        if (p->settings.requirement_count == IMK_CORRELATED_MAX)
            return command_misused("--want: there are more than %d numbers", IMK_CORRELATED_MAX);
        p->requirement[p->settings.requirement_count++] =
            (imk_sigma_requirement){.parameter = parameter[k], .sigma = sigma};
    }
    return -1;
}

static int parse_requirements(plan *p)
{
    int code = -1;
    for (const char *text = p->b->options->want; code < 0 && text && *text;) {
        const size_t length = strcspn(text, ",");
        code = parse_requirement(p, text, length);
        text += length + (text[length] == ',');
    }
    p->settings.requirement = p->requirement;
    return code;
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
    if (b->settings.repeatability)
        code = command_misused("--plan: repeatability needs no programme; record as many power "
                               "cycles as you can, ten or more");
    if (code < 0 && b->found->record[0].procedure == IMK_PROCEDURE_MAGNETOMETER)
        code = command_misused("--plan: magnetometer needs no programme; turn the unit slowly by "
                               "hand for a minute, so that each of its axes points along the field "
                               "and against it");
    if (code < 0)
        code = command_model(b->path[0], &b->found->calibration->model, &unused);
    imk_document_free(unused);
    if (code >= 0)
        return code;
    p->settings = imk_plan_default(b->found->record[0].procedure);
    p->settings.nonlinear = b->found->record[0].settings.nonlinear;
    p->settings.cross_products = b->found->record[0].settings.cross_products;
    p->settings.g_sensitivity = b->found->record[0].settings.g_sensitivity;
    p->settings.placement_sigma = b->found->record[0].settings.placement_sigma;
    p->settings.fixture_sigma = b->found->record[0].settings.fixture_sigma;
    p->settings.turn_angle = b->found->record[0].settings.turn_angle;
    if (!isnan(o->soak))
        p->settings.soak = o->soak;
    if (o->temperature_order.given)
        p->settings.temperature_order = (int)o->temperature_order.value;
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
