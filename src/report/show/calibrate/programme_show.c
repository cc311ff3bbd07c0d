/* SPDX-License-Identifier: Apache-2.0 */
/* The programme of a test, as a table, and as a file that imukit simulate, a table and imukit
 * calibrate --motion understand. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdlib.h>

static const double degree = 0.017453292519943295;

/* ---- file ------------------------------------------------------------------------------------ */

static void put_motion(imki_text *t, const imk_calibrate_plan *p, const imk_geodetic *place)
{
    const imk_motion_script *script = &p->script;
    imki_text_add(t, "imukit_motion: 1\nname: %s programme\n",
                  imk_procedure_name(p->settings.procedure));
    if (place)
        imki_text_add(t, "start: {latitude: %.9g deg, longitude: %.9g deg, height: %.9g m}\n",
                      place->latitude / degree, place->longitude / degree, place->height);
    imki_text_add(t, "steps:\n");
    for (size_t k = 0; k < script->step_count; k++) {
        const imk_motion_step *s = &script->step[k];
        if (s->kind == IMK_STEP_HOLD)
            imki_text_add(t, "  - hold %.6g s\n", s->duration);
        else if (s->kind == IMK_STEP_POSE)
            imki_text_add(t, "  - pose %.6g %.6g %.6g deg in %.6g s\n", s->angle[0] / degree,
                          s->angle[1] / degree, s->angle[2] / degree, s->duration);
        else
            imki_text_add(t, "  - rotate %c %.9g deg at %.9g deg/s\n", "xyz"[s->axis],
                          s -> amount / degree, s -> rate / degree);
    }
    imki_text_add(t, "then: hold\n");
}

/* Temperatures are of a chamber; the unit rests. */
static void put_temperature(imki_text *t, const imk_calibrate_plan *p)
{
    imki_text_add(t, "imukit_temperature: 1\nname: %s programme\nsteps:\n",
                  imk_procedure_name(p->settings.procedure));
    for (size_t k = 0; k < p->result.step_count; k++) {
        const imk_plan_step *s = &p->step[k];
        if (k == 0)
            imki_text_add(t, "  - start %.6g degC\n", s->temperature - 273.15);
        else
            imki_text_add(t, "  - ramp to %.6g degC at 1 degC/min\n", s->temperature - 273.15);
        imki_text_add(t, "  - soak %.6g s\n", p->settings.soak + s->duration + p->settings.margin);
    }
}

imk_status imk_calibrate_plan_text(const imk_calibrate_plan *p, const imk_geodetic *place,
                                   char **text, size_t *size)
{
    imki_text t = {.bytes = NULL};
    if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        put_temperature(&t, p);
    else
        put_motion(&t, p, place);
    *text = imki_text_take(&t, size);
    return *text ? IMK_OK : IMK_ERROR_MEMORY;
}

/* ---- display --------------------------------------------------------------------------------- */

static void show_steps(const imk_calibrate_plan *p, imk_result *result)
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

static void show_requirements(const imk_calibrate_plan *p, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    if (p->settings.requirement_count == 0)
        return;
    imk_table_row(table, "wanted (1 sigma)\tunit\trequirement\texpected\t");
    for (const imk_sigma_requirement *w = p->settings.requirement;
         w < p->settings.requirement + p->settings.requirement_count; w++) {
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
            imk_table_add(table, "not reached; no test can go below %.3g", w->floor / unit.scale);
        else
            imk_table_add(table, w->reached ? "reached" : "not reached");
    }
    imk_result_gap(result);
}

/* A programme is judged by what is wanted of it; if nothing is, by what it determines. */
static void judge(const imk_calibrate_plan *p, imk_result *result)
{
    const imk_plan_result *r = &p->result;
    const size_t wanted = p->settings.requirement_count;
    imki_reasons reasons = {.result = result};
    imki_text precision = {0};
    char length[60];
    size_t unknown = 0;
    imk_readable_duration(p->duration, length, sizeof length);
    for (size_t k = 0; k < r->parameter_count; k++)
        unknown += !isfinite(r->sigma[k]);
    imki_precision(r->parameter_count, r->parameter, r->sigma, &precision);
    const imk_usability usability = r->reached < wanted ? IMK_NOT_USABLE
                                    : unknown > 0       ? IMK_USABLE_WITH_CARE
                                                        : IMK_USABLE;
    if (wanted > 0)
        imki_reason(&reasons, "%zu steps of %s in all reach %zu of the %zu accuracies wanted",
                    r->step_count, length, r->reached, wanted);
    else
        imki_reason(&reasons, "%zu steps of %s in all", r->step_count, length);
    if (unknown > 0)
        imki_reason(&reasons, "%zu of %zu parameters would not be determined", unknown,
                    r->parameter_count);
    if (precision.size > 0)
        imki_reason(&reasons, "%s, 1 sigma of the worst axis", precision.bytes);
    imki_judge(&reasons, usability, r->reached < wanted ? " for what is wanted" : "");
    free(precision.bytes);
}

static void show_data(const imk_calibrate_plan *p, const char *model, imk_result *result)
{
    static const char *const actions[] = {"hold", "rate", "force", "soak"};
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", model);
    imk_result_text(result, "procedure", imk_procedure_name(p->settings.procedure));
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(p, result);
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
    for (const imk_sigma_requirement *w = p->settings.requirement;
         w < p->settings.requirement + p->settings.requirement_count; w++) {
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

void imk_show_calibrate_plan(const imk_calibrate_plan *p, const char *model, imk_result *result)
{
    show_data(p, model, result);
    show_steps(p, result);
    show_requirements(p, result);
    if (p->settings.procedure == IMK_PROCEDURE_THERMAL)
        imk_result_line(result,
                        "Each temperature is held for %g s until the unit has settled (--soak), "
                        "then measured; the chamber moves from one to the next at 1 K/min.",
                        p->settings.soak);
}
