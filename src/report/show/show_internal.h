/* SPDX-License-Identifier: Apache-2.0 */
/* Functions for the display of results, shared by several jobs. */
#ifndef IMUKI_SHOW_INTERNAL_H
#define IMUKI_SHOW_INTERNAL_H

#include "imukit/channel_units.h"
#include "imukit/even_record.h"
#include "imukit/identify.h"
#include "imukit/readable.h"
#include "imukit/show.h"
#include "report/growing_text_internal.h"

enum { IMKI_WORDS = 120 };

/* "1.2345 ± 0.0012", with the digits that the uncertainty allows, in a unit of this scale. */
typedef struct imki_words {
    char text[IMKI_WORDS];
} imki_words;
imki_words imki_plus_minus(double value, double sigma, double scale);
/* A value alone, with the digits that its uncertainty allows, or `digits` if the uncertainty is
 * 0. */
imki_words imki_value(double value, double uncertainty, int digits);

/* "1.2 to 3.4", with the digits that the width allows. */
imki_words imki_range(double lower, double upper, double scale);
/* The interval of an estimate, or "< 3.4" for an absent term. */
imki_words imki_interval(const imk_estimate *estimate, double scale);
/* "0.03", "below 1e-12" */
imki_words imki_chance(double probability);
imki_words imki_duration(double seconds);

/* The channels of a kind. @return how many */
size_t imki_members(const imk_even_record *record, imk_channel_kind kind, size_t *member);

/* {"present", "value", "sigma", "lower", "upper", "unit"} of an estimate. */
void imki_show_estimate(imk_result *result, const char *key, const imk_estimate *estimate,
                        double scale, const char *unit);

/* Begin an object, or write null if there is none. @return `there` */
bool imki_begin_object(imk_result *result, const char *key, bool there);
/* An array of texts. */
void imki_show_texts(imk_result *result, const char *key, size_t count, const char *const *texts);

/* A curve without points yet. */
void imki_begin_curve(imk_figure_builder *figure, const char *label, imk_curve_style style,
                      int color);

/* A line from a composed text; nothing when the text is empty. The text is freed. */
void imki_show_text(imki_text *text, imk_result *result);

/* Why a result is judged as it is: three reasons at most are told, the others counted. A structure
 * of zeros with a result is empty. */
typedef struct imki_reasons {
    imk_result *result;
    const char *text;
    size_t told, left;
} imki_reasons;
/* judgement.c */
void imki_reason(imki_reasons *reasons, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* What the warnings say, without their advice. */
void imki_reasons_of_warnings(imki_reasons *reasons, const imk_findings *findings);
/* The same of a message, behind the name it begins with. */
void imki_reason_of_message(imki_reasons *reasons, const char *text);
/* "Usable with care for a first look: reason; reason." @param use  " for a first look", or "" */
const char *imki_judgement(const imki_reasons *reasons, imk_usability usability, const char *use);
/* The same as the judgement of the result, in the object of its data that is open. */
void imki_judge(const imki_reasons *reasons, imk_usability usability, const char *use);

bool imki_warned(const imk_findings *findings);
/* The warnings, as findings of the page. */
void imki_show_warnings(const imk_findings *findings, imk_result *result);
/* evaluate_judgement.c: in the object of the data that is open. */
void imki_judge_evaluation(const imk_evaluate_shown *v, imk_result *result);
/* evaluate_figure_show.c: deviations and hysteresis of a channel. */
void imki_show_evaluate_panels(const imk_evaluate_channel *channel, imk_figure_builder *figure);

#endif
