/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --plan: which test reaches a wanted uncertainty, as a table and as a programme
 * that imukit simulate, a table and imukit calibrate --motion understand. */
#include "calibrate_parts.h"
#include "shell/growing_list.h"
#include "shell/place_text.h"

#include "imukit/calibration_plan.h"
#include "imukit/output_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* A chamber's rate that a unit follows without large gradients: 1 K/min [K/s]. */
static const double ramp_rate = 1.0 / 60.0;

typedef struct plan {
    bench *b;
    imk_plan_settings settings;
    imk_plan_wish wish[IMK_CORRELATED_MAX];
    imk_plan_step *step;
    imk_plan_result result;
    double duration; /* of the whole programme [s] */
} plan;

/* ---- wishes ---------------------------------------------------------------------------------- */

/* "accel.scale_factor 50 ppm": every number of the term. */
static int parse_wish(plan *p, const char *text, size_t length)
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
    int code = bench_list_terms(p->b, "want", name, IMK_CORRELATED_MAX, parameter, &count);
    for (size_t k = 0; code < 0 && k < count; k++) {
        double sigma, unused;
        size_t numbers;
        imk_error error;
        const char *unit = imk_parameter_file_unit(parameter[k]);
        if (imk_quantity_parse(value, value + strlen(value), imk_unit_of(unit).dimension, 1, &sigma,
                               &unused, &numbers, NULL, &error) != IMK_OK ||
            !(sigma > 0))
            return command_misused("--want \"%s %s\": expected a positive number with a unit such "
                                   "as %s",
                                   name, value, unit);
        if (p->settings.wish_count == IMK_CORRELATED_MAX)
            return command_misused("--want: these are more than %d numbers", IMK_CORRELATED_MAX);
        p->wish[p->settings.wish_count++] =
            (imk_plan_wish){.parameter = parameter[k], .sigma = sigma};
    }
    return code;
}

static int parse_wishes(plan *p)
{
    int code = -1;
    for (const char *text = p->b->options->want; code < 0 && text && *text;) {
        const size_t length = strcspn(text, ",");
        code = parse_wish(p, text, length);
        text += length + (text[length] == ',');
    }
    p->settings.wish = p->wish;
    return code;
}

/* ---- programme as a file --------------------------------------------------------------------- */

static void put_motion(growing_list *t, const plan *p, const imk_motion_script *script)
{
    list_add(t, "imukit_motion: 1\nname: %s programme\n",
             imk_procedure_name(p->settings.procedure));
    if (p->b->found->settings.place_known)
        list_add(t, "start: {latitude: %.9g deg, longitude: %.9g deg, height: %.9g m}\n",
                 p->b->place.latitude / degree, p->b->place.longitude / degree, p->b->place.height);
    list_add(t, "steps:\n");
    for (size_t k = 0; k < script->step_count; k++) {
        const imk_motion_step *s = &script->step[k];
        if (s->kind == IMK_STEP_HOLD)
            list_add(t, "  - hold %.6g s\n", s->duration);
        else if (s->kind == IMK_STEP_POSE)
            list_add(t, "  - pose %.6g %.6g %.6g deg in %.6g s\n", s->angle[0] / degree,
                     s->angle[1] / degree, s->angle[2] / degree, s->duration);
        else
            list_add(t, "  - rotate %c %.9g deg at %.9g deg/s\n", "xyz"[s->axis],
                     s -> amount / degree, s -> rate / degree);
    }
    list_add(t, "then: hold\n");
}

/* Temperatures are of a chamber; the unit rests. */
static void put_temperature(growing_list *t, const plan *p)
{
    list_add(t, "imukit_temperature: 1\nname: %s programme\nsteps:\n",
             imk_procedure_name(p->settings.procedure));
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        if (k == 0)
            list_add(t, "  - start %.6g degC\n", s->temperature - 273.15);
        else
            list_add(t, "  - ramp to %.6g degC at 1 degC/min\n", s->temperature - 273.15);
        list_add(t, "  - soak %.6g s\n", p->settings.soak + s->duration + p->settings.margin);
    }
}

static int write_text(const char *path, const growing_list *t)
{
    imk_error error;
    imk_output_file *file = NULL;
    imk_status status = imk_output_file_open(path, &file, &error);
    if (status == IMK_OK) {
        (void)imk_output_file_write(file, t->text, t->size);
        status = imk_output_file_commit(file, &error);
    }
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

/* Room for the steps of a motion. */
static imk_motion_step *new_steps(const plan *p)
{
    return command_zeroed((imk_plan_script_steps(p->result.step_count) + 1) *
                          sizeof(imk_motion_step));
}

static int write_programme(const plan *p, const char *path)
{
    imk_error error;
    imk_motion_script script;
    growing_list t = {0};
    int code = -1;
    if (p->settings.procedure == IMK_PROCEDURE_CENTRIFUGE)
        return command_misused("--output: a motion file turns the unit where it stands and has no "
                               "arm to swing it on: leave --output out, and take the levels of the "
                               "centrifuge from the table");
    imk_motion_step *steps = new_steps(p);
    if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        put_temperature(&t, p);
    else if (imk_plan_script(&p->settings, p->result.step_count, p->step, steps, &script, &error) ==
             IMK_OK)
        put_motion(&t, p, &script);
    else
        code = command_error(&error, path);
    if (code < 0)
        code = write_text(path, &t);
    free(steps);
    list_free(&t);
    return code;
}

/* ---- output ---------------------------------------------------------------------------------- */

static void show_steps(const plan *p, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "step\troll pitch yaw [deg]\tinput\tfor [s]\tat [degC]");
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        /* + 0.0 makes 0 of -0 */
        imk_table_row(table, "%zu\t%.1f %.1f %.1f", k + 1, s->angle[0] / degree + 0.0,
                      s->angle[1] / degree + 0.0, s->angle[2] / degree + 0.0);
        if (s->action == IMK_PLAN_RATE)
            imk_table_add(table, "turn about %c at %+.4g deg/s", "xyz"[s->axis],
                          s -> rate / degree);
        else if (s->action == IMK_PLAN_FORCE)
            imk_table_add(table, "force %+.3g %+.3g %+.3g g", s->force[0] / 9.80665,
                          s->force[1] / 9.80665, s->force[2] / 9.80665);
        else
            imk_table_add(table, "rest");
        imk_table_add(table, "%.3g", s->duration);
        if (isfinite(s->temperature))
            imk_table_add(table, "%.1f", s->temperature - 273.15);
    }
    imk_result_gap(result);
}

static void show_wishes(const plan *p, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    if (p->settings.wish_count == 0)
        return;
    imk_table_row(table, "wanted (1 sigma)\tunit\twish\texpected\t");
    for (const imk_plan_wish *w = p->wish; w < p->wish + p->settings.wish_count; w++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        const imk_unit unit = imk_unit_of(imk_parameter_file_unit(w->parameter));
        if (imk_model_parameter_name(w->parameter, name) != IMK_OK)
            continue;
        imk_table_row(table, "%s\t%s\t%.3g", name, unit.text, w->sigma / unit.scale);
        if (isfinite(w->expected))
            imk_table_add(table, "%.3g", w->expected / unit.scale);
        else
            imk_table_add(table, "not determined");
        if (!w->reached && w->floor > 0)
            imk_table_add(table, "not reached; no test goes below %.3g", w->floor / unit.scale);
        else
            imk_table_add(table, w->reached ? "reached" : "not reached");
    }
    imk_result_gap(result);
}

/* With the ramps between the temperatures; of a motion what its steps take. */
static double programme_length(const plan *p)
{
    double length = p->result.duration;
    imk_motion_script script;
    imk_error error;
    imk_motion_step *steps = new_steps(p);
    if (p->settings.procedure != IMK_PROCEDURE_THERMAL &&
        imk_plan_script(&p->settings, p->result.step_count, p->step, steps, &script, &error) ==
            IMK_OK) {
        length = 0;
        for (size_t k = 0; k < script.step_count; k++)
            length += imk_motion_step_duration(&script, k);
    }
    free(steps);
    for (size_t k = 1; k < p->result.step_count && p->settings.procedure == IMK_PROCEDURE_THERMAL;
         k++)
        length += fabs(p->step[k].temperature - p->step[k - 1].temperature) / ramp_rate;
    return length;
}

static void show_next(const plan *p, imk_result *result)
{
    const calibrate_options *o = p->b->options;
    const imk_procedure procedure = p->settings.procedure;
    const char *model = p->b->found->record[0].path;
    const bool wants_motion = procedure >= IMK_PROCEDURE_RATE_TABLE;
    if (procedure == IMK_PROCEDURE_CENTRIFUGE)
        imk_result_line(result, "These are the levels to set; a motion file has no arm to swing "
                                "the unit on, so there is none. Next: log the test with columns "
                                "reference_force_x [g] …, and imukit calibrate LOG --procedure "
                                "centrifuge");
    else if (!o->output)
        imk_result_line(result, "Next: add -o programme.yaml to keep the programme");
    else if (procedure == IMK_PROCEDURE_THERMAL)
        imk_result_line(result,
                        "Programme: %s\nNext: imukit simulate %s --temperature %s --rate %gHz "
                        "--duration %.0fs -o bench.csv",
                        o->output, model, o->output, p->settings.rate, ceil(p->duration));
    else
        imk_result_line(result,
                        "Programme: %s\nNext: imukit simulate %s --motion %s --rate %gHz "
                        "--duration %.0fs -o bench.csv && imukit calibrate bench.csv --procedure "
                        "%s%s%s%s%s%s",
                        o->output, model, o->output, p->settings.rate, ceil(p->duration),
                        imk_procedure_name(procedure), wants_motion ? " --motion " : "",
                        wants_motion ? o->output : "", o->position ? " --position \"" : "",
                        o->position ? o->position : "", o->position ? "\"" : "");
}

static void show_data(const plan *p, imk_result *result)
{
    static const char *const actions[] = {"hold", "rate", "force", "soak"};
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", p->b->found->record[0].path);
    imk_result_text(result, "procedure", imk_procedure_name(p->settings.procedure));
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_array(result, "steps");
    for (const imk_plan_step *s = p->step; s < p->step + p->result.step_count; s++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "action", actions[s->action]);
        imk_result_numbers(result, "angle", 3, s->angle);
        imk_result_count(result, "axis", s->axis);
        imk_result_quantity(result, "rate", s->rate, "rad/s");
        imk_result_quantity(result, "temperature", s->temperature, "K");
        imk_result_quantity(result, "duration", s->duration, "s");
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_array(result, "wishes");
    for (const imk_plan_wish *w = p->wish; w < p->wish + p->settings.wish_count; w++) {
        char name[IMK_MODEL_PARAMETER_NAME] = "";
        (void)imk_model_parameter_name(w->parameter, name);
        imk_result_object(result, NULL);
        imk_result_text(result, "name", name);
        imk_result_number(result, "wish", w->sigma);
        imk_result_number(result, "expected", w->expected);
        imk_result_number(result, "floor", w->floor);
        imk_result_flag(result, "reached", w->reached);
        imk_result_text(result, "unit", imk_model_parameter_unit(w->parameter));
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_quantity(result, "duration", p->duration, "s");
    imk_result_end(result);
}

static void show(const plan *p, imk_result *result)
{
    char length[60];
    show_data(p, result);
    show_steps(p, result);
    show_wishes(p, result);
    imk_readable_duration(p->duration, length, sizeof length);
    imk_result_line(result, "%zu steps, %s.", p->result.step_count, length);
    if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        imk_result_line(result,
                        "Each temperature is held for %g s until the unit has settled (--soak), "
                        "then measured; between them the chamber goes at 1 K/min.",
                        p->settings.soak);
    show_next(p, result);
}

/* ---- run ------------------------------------------------------------------------------------- */

static int make(plan *p)
{
    imk_error error;
    imk_calibration *c = p->b->found->calibration;
    const size_t room = p->settings.steps_maximum;
    p->step = command_zeroed((room + 1) * sizeof *p->step);
    c->observation = command_zeroed((room + 1) * sizeof *c->observation);
    c->turn = command_zeroed((room + 1) * sizeof *c->turn);
    c->observation_capacity = c->turn_capacity = room;
    const size_t size = imk_plan_workspace_size(c, &p->settings);
    void *workspace = command_memory(NULL, size);
    const imk_status status =
        imk_plan_make(c, &p->settings, workspace, size, p->step, &p->result, &error);
    free(workspace);
    if (status == IMK_ERROR_KEY_MISSING && strstr(error.field, "noise"))
        return command_failed("%s states no noise, from which to tell how long to measure: imukit "
                              "identify finds it in a log at rest",
                              p->b->found->record[0].path);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static int set_up(plan *p)
{
    bench *b = p->b;
    const calibrate_options *o = b->options;
    imk_document *unused = NULL;
    if (b->found->count != 1)
        return command_misused("--plan takes one MODEL, of the unit that will be tested");
    int code = bench_choose(b);
    if (code < 0 && b->found->settings.repeatability)
        code = command_misused("--plan: repeatability needs no programme: as many power cycles as "
                               "you can afford, ten or more");
    if (code < 0)
        code = command_model(b->found->record[0].path, &b->found->calibration->model, &unused);
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
    if (o->log.rate > 0)
        p->settings.rate = o->log.rate;
    return parse_wishes(p);
}

int bench_plan(bench *b)
{
    plan *p = command_zeroed(sizeof *p);
    p->b = b;
    int code = set_up(p);
    if (code < 0)
        code = make(p);
    if (code < 0)
        p->duration = programme_length(p);
    if (code < 0 && b->options->output)
        code = write_programme(p, b->options->output);
    if (code < 0) {
        const bool short_of = p->result.reached < p->settings.wish_count;
        code = b->options->strict && short_of ? EXIT_FAILED : EXIT_DONE;
        imk_result *result = show_begin("calibrate");
        show(p, result);
        code = show_end(result, &(show_options){.json = b->options->json}, code);
    }
    free(p->step);
    free(p);
    return code;
}
