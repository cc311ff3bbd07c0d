/* SPDX-License-Identifier: Apache-2.0 */
/* Aids of a navigator: in words, as data, and times that count from their end. */
#include "drift_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- times ---- */

/* A time of the table counts from the end of the aids. */
static bool is_without(const imk_drift_models *r, double time, double *since)
{
    *since = time - imk_drift_outage(&r->settings.drift);
    return *since > 0.5 / r->settings.drift.rate;
}

const char *imki_drift_row_label(const imk_drift_models *r, double time,
                                 imk_drift_validity validity, char text[IMKI_DRIFT_TIME])
{
    char plain[IMKI_DRIFT_TIME];
    double since;
    const bool outage = !isnan(imk_drift_outage(&r->settings.drift));
    const bool without = outage && is_without(r, time, &since);
    imki_drift_time(without ? since : time, IMK_DRIFT_LINEAR, plain);
    snprintf(text, IMKI_DRIFT_TIME, "%s%.40s%s%s", without ? "+" : "", plain,
             outage && !without ? ", aided" : "", validity == IMK_DRIFT_ROUGH ? " ~" : "");
    return text;
}

const char *imki_drift_moment(const imk_drift_models *r, double time, char text[IMKI_DRIFT_TIME])
{
    char plain[IMKI_DRIFT_TIME];
    double since;
    const bool without = is_without(r, time, &since);
    imki_drift_time(without ? since : time, IMK_DRIFT_LINEAR, plain);
    snprintf(text, IMKI_DRIFT_TIME, "%.40s%s", plain, without ? " of outage" : "");
    return text;
}

/* ---- words ---- */

static void add_sigmas(const imk_aid *aid, const double sigma[3], imki_text *text)
{
    const imk_unit unit =
        imk_unit_of(aid->kind == IMK_AID_HEADING ? "deg" : imk_aid_unit(aid->kind));
    double first = 0.0;
    bool equal = true;
    for (size_t i = 0; i < imk_aid_axes(aid->kind); i++) {
        first = first > 0.0 || !isfinite(sigma[i]) ? first : sigma[i];
        equal = equal && (sigma[i] == first || !isfinite(sigma[i]));
    }
    for (size_t i = 0; i < (equal ? 1 : imk_aid_axes(aid->kind)); i++) {
        const double value = equal ? first : sigma[i];
        if (isfinite(value))
            imki_text_add(text, " %.3g", value / unit.scale);
        else
            imki_text_add(text, " -");
    }
    imki_text_add(text, " %s", aid->kind == IMK_AID_HEADING ? "deg" : imk_aid_unit(aid->kind));
}

static void add_aid(const imk_aid *aid, imki_text *text)
{
    const bool correlated = aid->correlation_time > 0.0 && aid->correlated_sigma[0] > 0.0;
    const bool level =
        imk_aid_axes(aid->kind) == 3 && aid->kind != IMK_AID_ODOMETER && isinf(aid->sigma[2]);
    imki_text_add(text, "%s%s", level ? "horizontal " : "", imk_aid_kind_name(aid->kind));
    add_sigmas(aid, correlated ? aid->correlated_sigma : aid->sigma, text);
    if (correlated) {
        imki_text_add(text, " (correlated over %.4g s, white", aid->correlation_time);
        add_sigmas(aid, aid->sigma, text);
        imki_text_put(text, ")");
    }
}

/* Are readings at the same times? */
static bool same_times(const imk_aid *a, const imk_aid *b)
{
    return a->interval == b->interval && a->from == b->from && a->until == b->until;
}

void imki_drift_aids_words(const imk_drift_models *r, imki_text *text)
{
    const imk_drift_settings *s = &r->settings.drift;
    for (size_t k = 0; k < s->aid_count; k++) {
        const imk_aid *aid = &s->aid[k];
        char until[IMKI_DRIFT_TIME];
        imki_text_put(text, k == 0 ? "aided by " : ", ");
        add_aid(aid, text);
        if (k + 1 < s->aid_count && same_times(aid, &aid[1]))
            continue;
        if (aid->interval <= 1.0)
            imki_text_add(text, " at %.4g Hz", 1.0 / aid->interval);
        else
            imki_text_add(text, " every %.4g s", aid->interval);
        if (isfinite(aid->until))
            imki_text_add(text, " until %s", imki_drift_time(aid->until, IMK_DRIFT_LINEAR, until));
    }
}

/* "aid.velocity[1].white": the aid of a source; NULL: of several. */
static const imk_aid *aid_of_source(const imk_drift_settings *s, const char *name)
{
    const char *dot = strchr(name + strlen("aid."), '.');
    size_t number = 0;
    for (size_t k = 0; k < s->aid_count && dot; k++) {
        char kind[24];
        snprintf(kind, sizeof kind, "%s", imk_aid_kind_name(s->aid[k].kind));
        for (char *blank = strchr(kind, ' '); blank; blank = strchr(blank, ' '))
            *blank = '_';
        const char *rest = name + strlen("aid.") + strlen(kind);
        if (strncmp(name + strlen("aid."), kind, strlen(kind)) != 0)
            continue;
        const size_t wanted = *rest == '[' ? (size_t)(rest[1] - '0') : 0;
        if (number++ == wanted)
            return &s->aid[k];
    }
    return NULL;
}

void imki_drift_aid_value(const imk_drift_settings *s, const char *name, double factor,
                          imki_text *text)
{
    const imk_aid *aid = aid_of_source(s, name);
    double sigma[3];
    if (!aid)
        return;
    const bool white = strstr(name, ".white");
    for (int i = 0; i < 3; i++)
        sigma[i] = factor * (white ? aid->sigma[i] : aid->correlated_sigma[i]);
    imki_text number = {.bytes = NULL};
    add_sigmas(aid, sigma, &number);
    imki_text_add(text, "%s", number.size > 0 ? number.bytes + 1 : "");
    free(number.bytes);
}

/* ---- data ---- */

static void show_aid(const imk_aid *aid, imk_result *result)
{
    const char *unit = imk_aid_unit(aid->kind);
    imk_result_object(result, NULL);
    imk_result_text(result, "kind", imk_aid_kind_name(aid->kind));
    imk_result_array(result, "white_sigma");
    for (size_t i = 0; i < imk_aid_axes(aid->kind); i++)
        imk_result_quantity(result, NULL, aid->sigma[i], unit);
    imk_result_end(result);
    imk_result_array(result, "correlated_sigma");
    for (size_t i = 0; i < imk_aid_axes(aid->kind); i++)
        imk_result_quantity(result, NULL, aid->correlated_sigma[i], unit);
    imk_result_end(result);
    imk_result_quantity(result, "correlation_time", aid->correlation_time, "s");
    imk_result_quantity(result, "interval", aid->interval, "s");
    imk_result_quantity(result, "from", aid->from, "s");
    imk_result_quantity(result, "until", aid->until, "s");
    imk_result_array(result, "lever_arm");
    for (size_t i = 0; i < 3; i++)
        imk_result_quantity(result, NULL, aid->lever_arm[i], "m");
    imk_result_end(result);
    imk_result_array(result, "lever_arm_sigma");
    for (size_t i = 0; i < 3; i++)
        imk_result_quantity(result, NULL, aid->lever_arm_sigma[i], "m");
    imk_result_end(result);
    imk_result_end(result);
}

void imki_drift_show_aids(const imk_drift_models *r, const char *filter_model, imk_result *result)
{
    const imk_drift_settings *s = &r->settings.drift;
    if (s->aid_count == 0)
        return;
    imk_result_array(result, "aids");
    for (size_t k = 0; k < s->aid_count; k++)
        show_aid(&s->aid[k], result);
    imk_result_end(result);
    imk_result_text(result, "filter_model", filter_model);
    if (!isnan(imk_drift_outage(s)))
        imk_result_quantity(result, "outage", imk_drift_outage(s), "s");
    else
        imk_result_null(result, "outage");
}
