/* SPDX-License-Identifier: Apache-2.0 */
/* As what class a model can be used. */
#include "grade_show_internal.h"
#include "unstated_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *class_name(imk_grade grade)
{
    const imk_grade_row *row = imk_grade_table(grade);
    return row ? row->name : "no class";
}

/* By its biases a model is of a class, for which its other terms may be too large. */
static bool falls_short(const imk_graded *one)
{
    const imk_grade_way *p = &one->way[IMK_GRADE_GIVEN];
    return !one->no_position && one->missing_count == 0 && imk_grade_table(one->table.overall) &&
           !isnan(imk_grade_table(one->table.overall)->position_time) &&
           p->grade > one->table.overall;
}

static imk_usability usability_of(const imk_graded *one)
{
    const imk_grade_result *t = &one->table;
    if (!t->limiting[0] || t->overall == IMK_GRADE_NONE)
        return IMK_NOT_USABLE;
    return t->at_best || one->no_position || one->missing_count > 0 || falls_short(one)
               ? IMK_USABLE_WITH_CARE
               : IMK_USABLE;
}

static void add_position(const imk_graded *one, imki_reasons *reasons)
{
    const imk_grade_way *p = &one->way[IMK_GRADE_GIVEN];
    const imk_unit mile = imk_unit_of("nmi");
    char text[IMK_READABLE_SIZE];
    if (one->no_position)
        imki_reason(reasons, "no position is computed, as %s", one->no_position);
    else if (falls_short(one))
        imki_reason(reasons, "by its error of position it is below it, of %s",
                    class_name(p->grade));
    else if (p->validity[IMK_GRADE_HOUR] == IMK_DRIFT_LOST)
        imki_reason(reasons, "there is no position any more after 1 h");
    else
        imki_reason(reasons, "CEP %s%s after 1 h", one->missing_count > 0 ? "at least " : "",
                    imk_readable_quantity(p->cep[IMK_GRADE_HOUR], &mile, text));
}

static void judge_one(const imk_graded *one, imki_reasons *reasons)
{
    const imk_grade_result *t = &one->table;
    const imk_usability usability = usability_of(one);
    imki_text unstated = {.bytes = NULL};
    char use[80];
    if (!t->limiting[0]) {
        imki_reason(reasons, "the model does not state the biases of both sensors");
        imki_judge(reasons, usability, " as any class by biases");
        return;
    }
    imki_unstated_biases(one->model, t->gyro_at_best, t->accel_at_best, &unstated);
    snprintf(use, sizeof use, usability == IMK_NOT_USABLE ? " as any class" : " as %s%s class",
             t->at_best ? "at best " : "", class_name(t->overall));
    if (t->at_best && unstated.size > 0)
        imki_reason(reasons, "it does not state %s", unstated.bytes);
    else
        imki_reason(reasons, "the %s %s", t->limiting,
                    usability == IMK_NOT_USABLE ? "is too large for every class" : "decides");
    add_position(one, reasons);
    if (one->shifted)
        imki_reason(reasons, "most of that are known values, which compensation takes out");
    imki_judge(reasons, usability, use);
    free(unstated.bytes);
}

/* Several models: each with its class. */
static void judge_several(const imk_graded_several *r, imki_reasons *reasons)
{
    imk_usability best = IMK_NOT_USABLE;
    for (size_t m = 0; m < r->count; m++) {
        const imk_grade_result *t = &r->graded[m]->table;
        const imk_usability usability = usability_of(r->graded[m]);
        best = usability < best ? usability : best;
        imki_reason(reasons, "%.60s %s%s", r->name[m],
                    t->limiting[0] && t->at_best ? "at best " : "",
                    t->limiting[0] ? class_name(t->overall) : "no class, as biases are not stated");
    }
    imki_judge(reasons, best, " by their biases");
}

void imki_judge_grade(const imk_graded_several *r, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    if (r->count == 1)
        judge_one(r->graded[0], &reasons);
    else
        judge_several(r, &reasons);
}
