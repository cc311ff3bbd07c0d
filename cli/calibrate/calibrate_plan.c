/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --plan: which test reaches a wanted uncertainty, as a table and as a programme
 * that imukit simulate, a table and imukit calibrate --motion understand. */
#include "calibrate_parts.h"
#include "shell/json_output.h"
#include "shell/place_text.h"

#include "imukit/calibration_plan.h"
#include "imukit/output_file.h"

#include <math.h>
#include <stdarg.h>
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
        const char *unit = parameter_file_unit(parameter[k]);
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

typedef struct text_buffer {
    char *text;
    size_t used, size;
} text_buffer;

static void put(text_buffer *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(text_buffer *t, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(t->text + t->used, t->size - t->used, format, arguments);
    va_end(arguments);
    t->used += length > 0 && (size_t)length < t->size - t->used ? (size_t)length : 0;
}

static void put_motion(text_buffer *t, const plan *p, const imk_motion_script *script)
{
    put(t, "imukit_motion: 1\nname: %s programme\n", imk_procedure_name(p->settings.procedure));
    if (p->b->place_known)
        put(t, "start: {latitude: %.9g deg, longitude: %.9g deg, height: %.9g m}\n",
            p->b->place.latitude / degree, p->b->place.longitude / degree, p->b->place.height);
    put(t, "steps:\n");
    for (size_t k = 0; k < script->step_count; k++) {
        const imk_motion_step *s = &script->step[k];
        if (s->kind == IMK_STEP_HOLD)
            put(t, "  - hold %.6g s\n", s->duration);
        else if (s->kind == IMK_STEP_POSE)
            put(t, "  - pose %.6g %.6g %.6g deg in %.6g s\n", s->angle[0] / degree,
                s->angle[1] / degree, s->angle[2] / degree, s->duration);
        else
            put(t, "  - rotate %c %.9g deg at %.9g deg/s\n", "xyz"[s->axis], s -> amount / degree,
                s -> rate / degree);
    }
    put(t, "then: hold\n");
}

/* Temperatures are of a chamber; the unit rests. */
static void put_temperature(text_buffer *t, const plan *p)
{
    put(t, "imukit_temperature: 1\nname: %s programme\nsteps:\n",
        imk_procedure_name(p->settings.procedure));
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        if (k == 0)
            put(t, "  - start %.6g degC\n", s->temperature - 273.15);
        else
            put(t, "  - ramp to %.6g degC at 1 degC/min\n", s->temperature - 273.15);
        put(t, "  - soak %.6g s\n", p->settings.soak + s->duration + p->settings.margin);
    }
}

static int write_text(const char *path, const text_buffer *t)
{
    imk_error error;
    imk_output_file *file = NULL;
    imk_status status = imk_output_file_open(path, &file, &error);
    if (status == IMK_OK) {
        (void)imk_output_file_write(file, t->text, t->used);
        status = imk_output_file_commit(file, &error);
    }
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static int write_programme(const plan *p, const char *path)
{
    imk_error error;
    imk_motion_script script;
    const size_t lines = imk_plan_script_steps(p->result.step_count) + 8;
    imk_motion_step *steps = calloc(lines, sizeof *steps);
    text_buffer t = {.size = lines * 120 + 1000};
    t.text = malloc(t.size);
    int code = steps && t.text ? -1 : command_failed("memory is exhausted");
    if (code < 0 && p->settings.procedure == IMK_PROCEDURE_CENTRIFUGE)
        code = command_misused("--output: a motion file turns the unit where it stands and has no "
                               "arm to swing it on: leave --output out, and take the levels of the "
                               "centrifuge from the table");
    if (code < 0 && p->settings.procedure == IMK_PROCEDURE_THERMAL) {
        put_temperature(&t, p);
    } else if (code < 0) {
        if (imk_plan_script(&p->settings, p->result.step_count, p->step, steps, &script, &error) ==
            IMK_OK)
            put_motion(&t, p, &script);
        else
            code = command_error(&error, path);
    }
    if (code < 0)
        code = write_text(path, &t);
    free(steps);
    free(t.text);
    return code;
}

/* ---- output ---------------------------------------------------------------------------------- */

static void put_steps(const plan *p)
{
    text_table table = text_table_make(5);
    static const char *const headers[] = {"step", "roll pitch yaw [deg]", "input", "for [s]",
                                          "at [degC]"};
    text_table_row(&table);
    for (size_t c = 0; c < 5; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        text_table_row(&table);
        text_table_set(&table, 0, "%zu", k + 1);
        /* + 0.0 makes 0 of -0 */
        text_table_set(&table, 1, "%.1f %.1f %.1f", s->angle[0] / degree + 0.0,
                       s->angle[1] / degree + 0.0, s->angle[2] / degree + 0.0);
        if (s->action == IMK_PLAN_RATE)
            text_table_set(&table, 2, "turn about %c at %+.4g deg/s", "xyz"[s->axis],
                           s -> rate / degree);
        else if (s->action == IMK_PLAN_FORCE)
            text_table_set(&table, 2, "force %+.3g %+.3g %+.3g g", s->force[0] / 9.80665,
                           s->force[1] / 9.80665, s->force[2] / 9.80665);
        else
            text_table_set(&table, 2, "rest");
        text_table_set(&table, 3, "%.3g", s->duration);
        if (isfinite(s->temperature))
            text_table_set(&table, 4, "%.1f", s->temperature - 273.15);
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
}

static void put_wishes(const plan *p)
{
    text_table table = text_table_make(5);
    static const char *const headers[] = {"wanted (1 sigma)", "unit", "wish", "expected", ""};
    if (p->settings.wish_count == 0)
        return;
    text_table_row(&table);
    for (size_t c = 0; c < 5; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t k = 0; k < p->settings.wish_count; k++) {
        const imk_plan_wish *w = &p->wish[k];
        char name[IMK_MODEL_PARAMETER_NAME];
        const imk_unit unit = imk_unit_of(parameter_file_unit(w->parameter));
        if (imk_model_parameter_name(w->parameter, name) != IMK_OK)
            continue;
        text_table_row(&table);
        text_table_set(&table, 0, "%s", name);
        text_table_set(&table, 1, "%s", unit.text);
        text_table_set(&table, 2, "%.3g", w->sigma / unit.scale);
        if (isfinite(w->expected))
            text_table_set(&table, 3, "%.3g", w->expected / unit.scale);
        else
            text_table_set(&table, 3, "not determined");
        if (!w->reached && w->floor > 0)
            text_table_set(&table, 4, "not reached; no test goes below %.3g",
                           w->floor / unit.scale);
        else
            text_table_set(&table, 4, w->reached ? "reached" : "not reached");
    }
    putchar('\n');
    text_table_print(&table, stdout);
    text_table_free(&table);
}

/* With the ramps between the temperatures; of a motion what its steps take. */
static double programme_length(const plan *p)
{
    double length = p->result.duration;
    imk_motion_script script;
    imk_error error;
    imk_motion_step *steps = calloc(imk_plan_script_steps(p->result.step_count) + 1, sizeof *steps);
    if (steps && p->settings.procedure != IMK_PROCEDURE_THERMAL &&
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

static void print_plan(const plan *p, const char *model)
{
    const calibrate_options *o = p->b->options;
    const char *name = imk_procedure_name(p->settings.procedure);
    const bool wants_motion = p->settings.procedure >= IMK_PROCEDURE_RATE_TABLE;
    const double duration = p->duration;
    char length[60];
    put_steps(p);
    put_wishes(p);
    format_duration(duration, length, sizeof length);
    printf("\n%zu steps, %s.\n", p->result.step_count, length);
    if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        printf("Each temperature is held for %g s until the unit has settled (--soak), then "
               "measured; between them the chamber goes at 1 K/min.\n",
               p->settings.soak);
    if (p->settings.procedure == IMK_PROCEDURE_CENTRIFUGE)
        printf("These are the levels to set; a motion file has no arm to swing the unit on, so "
               "there is none. Next: log the test with columns reference_force_x [g] …, and "
               "imukit calibrate LOG --procedure centrifuge\n");
    else if (!o->output)
        printf("Next: add -o programme.yaml to keep the programme\n");
    else if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        printf("Programme: %s\nNext: imukit simulate %s --temperature %s --rate %gHz --duration "
               "%.0fs -o bench.csv\n",
               o->output, model, o->output, p->settings.rate, ceil(duration));
    else
        printf("Programme: %s\nNext: imukit simulate %s --motion %s --rate %gHz --duration %.0fs "
               "-o bench.csv && imukit calibrate bench.csv --procedure %s%s%s%s%s%s\n",
               o->output, model, o->output, p->settings.rate, ceil(duration), name,
               wants_motion ? " --motion " : "", wants_motion ? o->output : "",
               o->position ? " --position \"" : "", o->position ? o->position : "",
               o->position ? "\"" : "");
}

static int print_json(const plan *p, const char *model, int code)
{
    json_t *wishes = json_array(), *steps = json_array();
    for (size_t k = 0; k < p->settings.wish_count; k++) {
        const imk_plan_wish *w = &p->wish[k];
        char name[IMK_MODEL_PARAMETER_NAME] = "";
        (void)imk_model_parameter_name(w->parameter, name);
        json_array_append_new(wishes,
                              json_pack("{s:s, s:o, s:o, s:o, s:b, s:s}", "name", name, "wish",
                                        json_number(w->sigma), "expected", json_number(w->expected),
                                        "floor", json_number(w->floor), "reached", w->reached,
                                        "unit", imk_model_parameter_unit(w->parameter)));
    }
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        static const char *const actions[] = {"hold", "rate", "force", "soak"};
        json_array_append_new(steps,
                              json_pack("{s:s, s:[o, o, o], s:i, s:o, s:o, s:o}", "action",
                                        actions[s->action], "angle", json_number(s->angle[0]),
                                        json_number(s->angle[1]), json_number(s->angle[2]), "axis",
                                        s->axis, "rate", json_quantity(s->rate, "rad/s"),
                                        "temperature", json_quantity(s->temperature, "K"),
                                        "duration", json_quantity(s->duration, "s")));
    }
    json_t *inputs = json_pack("{s:o, s:s}", "model", json_text(model), "procedure",
                               imk_procedure_name(p->settings.procedure));
    return json_print("calibrate", inputs,
                      json_pack("{s:o, s:o, s:o}", "steps", steps, "wishes", wishes, "duration",
                                json_quantity(p->duration, "s")),
                      code);
}

/* ---- run ------------------------------------------------------------------------------------- */

static int make(plan *p)
{
    imk_error error;
    imk_calibration *c = p->b->calibration;
    const size_t room = p->settings.steps_maximum;
    p->step = calloc(room + 1, sizeof *p->step);
    c->observation = calloc(room + 1, sizeof *c->observation);
    c->turn = calloc(room + 1, sizeof *c->turn);
    c->observation_capacity = c->turn_capacity = room;
    imk_status status = IMK_ERROR_MEMORY;
    if (p->step && c->observation && c->turn) {
        const size_t size = imk_plan_workspace_size(c, &p->settings);
        void *workspace = malloc(size > 0 ? size : 1);
        if (workspace)
            status = imk_plan_make(c, &p->settings, workspace, size, p->step, &p->result, &error);
        free(workspace);
    }
    if (status == IMK_ERROR_MEMORY)
        return command_failed("memory is exhausted");
    if (status == IMK_ERROR_KEY_MISSING && strstr(error.field, "noise"))
        return command_failed("%s states no noise, from which to tell how long to measure: imukit "
                              "identify finds it in a log at rest",
                              p->b->log[0].path);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

static int set_up(plan *p)
{
    bench *b = p->b;
    const calibrate_options *o = b->options;
    imk_document *unused = NULL;
    if (b->log_count != 1)
        return command_misused("--plan takes one MODEL, of the unit that will be tested");
    int code = bench_choose(b);
    if (code < 0 && b->repeatability)
        code = command_misused("--plan: repeatability needs no programme: as many power cycles as "
                               "you can afford, ten or more");
    if (code < 0)
        code = command_model(b->log[0].path, &b->calibration->model, &unused);
    imk_document_free(unused);
    if (code >= 0)
        return code;
    p->settings = imk_plan_default(b->log[0].procedure);
    p->settings.nonlinear = b->log[0].settings.nonlinear;
    p->settings.cross_products = b->log[0].settings.cross_products;
    p->settings.g_sensitivity = b->log[0].settings.g_sensitivity;
    p->settings.placement_sigma = b->log[0].settings.placement_sigma;
    p->settings.fixture_sigma = b->log[0].settings.fixture_sigma;
    p->settings.turn_angle = b->log[0].settings.turn_angle;
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
    plan *p = calloc(1, sizeof *p);
    if (!p)
        return command_failed("memory is exhausted");
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
        if (b->options->json)
            code = print_json(p, b->log[0].path, code);
        else
            print_plan(p, b->log[0].path);
    }
    free(p->step);
    free(p);
    return code;
}
