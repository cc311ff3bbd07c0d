/* SPDX-License-Identifier: Apache-2.0 */
/* Whether an instrument follows its input, and whether experiments find the error model of its
 * closed forms. */
#include "physics_show_internal.h"

#include "report/show/show_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const imk_triad *triad_of(const imk_physics_shown *p)
{
    return p->settings->instrument->sensor == IMK_GYRO ? &p->model->gyro : &p->model->accel;
}

/* ---- run ------------------------------------------------------------------------------------- */

static bool is_told(const imk_findings *findings, const char *code)
{
    for (size_t k = 0; k < findings->count; k++)
        if (strcmp(findings->item[k].code, code) == 0)
            return true;
    return false;
}

/* Findings that say that the reading is not the input. */
static bool is_off(const imk_findings *findings)
{
    static const char *const codes[] = {"range", "physics:saturated", "dead_band", "not_followed",
                                        "physics:touched"};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        if (is_told(findings, codes[i]))
            return true;
    return false;
}

static void judge_run(const imk_physics_shown *p, imki_reasons *reasons)
{
    const imk_physics_log *r = p->run;
    const bool gyro = p->settings->instrument->sensor == IMK_GYRO;
    const imk_exposure *e = &p->settings->input.exposure;
    const double input = (gyro ? e->angular_rate : e->specific_force)[0];
    const imk_unit unit = imk_physics_output_unit(r, 0);
    imki_reasons_of_warnings(reasons, &r->findings);
    if (r->samples < 2)
        imki_reason(reasons, "one sample shows neither scatter nor whether the output settles");
    const imk_usability usability = is_off(&r->findings) ? IMK_NOT_USABLE
                                    : reasons->told > 0  ? IMK_USABLE_WITH_CARE
                                                         : IMK_USABLE;
    if (p->settings->input.frequency > 0 ||
        strcmp(p->settings->instrument->outputs[0].si, gyro ? "rad/s" : "m/s^2") != 0)
        imki_reason(reasons, "the run has %llu samples", (unsigned long long)r->samples);
    else if (usability != IMK_NOT_USABLE && r->samples > 1 && !is_told(&r->findings, "scattered"))
        imki_reason(reasons, "the output follows the input of %.6g %s, with %.8g %s at the end",
                    input / unit.scale, unit.text, r->last[0] / unit.scale, unit.text);
    imki_judge(reasons, usability, usability == IMK_NOT_USABLE ? " at this input" : "");
}

/* ---- experiments ----------------------------------------------------------------------------- */

static void judge_sweep(const imk_physics_sweep *l, imki_reasons *reasons)
{
    size_t agree = 0, differ = 0, unknown = 0;
    for (size_t i = 0; i < l->count; i++) {
        const bool differs = l->verdict[i] == IMK_LABORATORY_DIFFERS;
        if (l->computed[i].value == 0 && !differs) /* of what is nothing, nothing is known */
            continue;
        if (differs)
            imki_reason(reasons, "%s differs from the experiment", l->computed[i].key);
        differ += differs;
        agree += l->verdict[i] == IMK_LABORATORY_AGREES || l->verdict[i] == IMK_LABORATORY_CLOSE;
        unknown += l->verdict[i] == IMK_LABORATORY_CANNOT_TELL ||
                   l->verdict[i] == IMK_LABORATORY_NOT_MEASURED;
    }
    imki_reasons_of_warnings(reasons, &l->findings);
    const imk_usability usability = agree == 0          ? IMK_NOT_USABLE
                                    : reasons->told > 0 ? IMK_USABLE_WITH_CARE
                                                        : IMK_USABLE;
    imki_reason(reasons, "experiments find %zu of the %zu parameters of the closed forms", agree,
                agree + differ + unknown);
    if (unknown > 0)
        imki_reason(reasons, "%zu they cannot tell", unknown);
    imki_judge(reasons, usability, " as an error model");
}

/* ---- closed forms ---------------------------------------------------------------------------- */

/* What a design is good for by its closed forms. */
static void judge_design(const imk_physics_shown *p, imki_reasons *reasons)
{
    const bool gyro = p->settings->instrument->sensor == IMK_GYRO;
    const imk_triad *t = triad_of(p);
    const imk_unit full = imk_unit_of(gyro ? "deg/s" : "g"),
                   small = imk_unit_of(gyro ? "deg/h" : "ug");
    char use[80] = "";
    if (t->range.value[0] > 0)
        snprintf(use, sizeof use, " up to %.4g %s", t->range.value[0] / full.scale, full.text);
    if (t->noise.bias_instability.value[0] > 0)
        imki_reason(reasons, "bias instability %.3g %s",
                    t->noise.bias_instability.value[0] / small.scale, small.text);
    if (t->bias.repeatability.value[0] > 0)
        imki_reason(reasons, "bias from run to run %.3g %s",
                    t->bias.repeatability.value[0] / small.scale, small.text);
    if (t->dead_band.value[0] > 0)
        imki_reason(reasons, "inputs below %.3g %s read 0", t->dead_band.value[0] / small.scale,
                    small.text);
    imki_reason(reasons, "by closed forms, which experiments can check");
    imki_judge(reasons, t->dead_band.value[0] > 0 ? IMK_USABLE_WITH_CARE : IMK_USABLE, use);
}

void imki_judge_physics(const imk_physics_shown *p, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    if (p->run)
        judge_run(p, &reasons);
    else if (p->sweep)
        judge_sweep(p->sweep, &reasons);
    else
        judge_design(p, &reasons);
}
