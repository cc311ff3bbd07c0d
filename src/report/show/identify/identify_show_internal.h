/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the display of an identification, of one record or of several. */
#ifndef IMUKI_IDENTIFY_SHOW_INTERNAL_H
#define IMUKI_IDENTIFY_SHOW_INTERNAL_H

#include "report/show/show_internal.h"

#include "report/growing_text_internal.h"

/* ---- verdicts: verdict_messages.c ------------------------------------------------------------ */

void imki_verdict_add(imk_verdict *verdict, imk_finding_level level, const char *code,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));
/* The same of a list, unless it is empty; it is freed. */
void imki_verdict_list(imk_verdict *verdict, imk_finding_level level, const char *code,
                       const char *before, imki_text *list, const char *after);
/* The channels that the last message concerns; from its code follow its few words. */
void imki_verdict_about(imk_verdict *verdict, const imk_even_record *record, uint64_t channels);
/* The clause of the last message, a finding with this code. */
void imki_verdict_clause(imk_verdict *verdict, const char *code);
/* The array "verdict". */
void imki_verdict_data(const imk_verdict *verdict, imk_result *result);
/* Coloured boxes below the sentence: of the whole messages, or of a few words each. */
void imki_verdict_boxes(const imk_verdict *verdict, imk_result *result);
void imki_verdict_brief_boxes(const imk_verdict *verdict, imk_result *result);
/* Lines of the whole messages, or of a few words each and at most 120 in all. */
void imki_verdict_lines(const imk_verdict *verdict, bool verbose, imk_result *result);
/* verdict_samples.c, verdict_terms.c: what holds on some channels. */
void imki_assess_samples(imk_verdict *verdict, const imk_identify_log *log);
void imki_assess_terms(imk_verdict *verdict, const imk_identify_log *log);
/* verdict_values.c: values that are too frequent, or never come. */
void imki_assess_values(imk_verdict *verdict, const imk_identify_log *log);
/* verdict_vibration.c: tones that several channels share. */
void imki_assess_vibration(imk_verdict *verdict, const imk_identify_log *log);
/* verdict_axes.c: an axis unlike the others of its triad; gyros with impossible numbers. */
void imki_assess_axes(imk_verdict *verdict, const imk_identify_log *log);
/* verdict_untestable.c: what no log of this kind can show. */
void imki_assess_untestable(imk_verdict *verdict, const imk_even_record *record);
/* verdict_words.c */
void imki_verdict_briefly(const imk_verdict *verdict, imk_result *result);

/* ---- parts: identify_show.c, identify_tables.c, identify_figure_show.c ------------------------
 */

/* The object of a channel, which is left open; for a joint estimate it has no keys about samples.
 */
void imki_channel_data(const imk_identify_log *log, size_t channel, imk_result *result);
/* "channels", all of them. */
void imki_channels_data(const imk_identify_log *log, imk_result *result);

/* "line of 12.5 Hz" */
void imki_part_name(const imk_identification *r, imk_identified_kind kind, int index, size_t size,
                    char *text);

/* A table for each kind of sensor: values with their intervals below them. */
void imki_identify_tables(const imk_identify_log *log, imk_result *result);
/* noise_changes_show.c: the verdict on changes of the noise; "noise_over_time", in the unit of the
 * channel; a figure with its heading. */
void imki_verdict_noise_changes(imk_verdict *verdict, const imk_identify_log *log);
void imki_noise_changes_data(const imk_identify_log *log, size_t channel, imk_unit unit,
                             imk_result *result);
void imki_noise_changes_figure(const imk_identify_shown *shown, imk_result *result);
/* Names and units of a term of several records: those of the joint estimate. Sensors have their
 * own, and what none of them counts is white noise of the integral, or reading noise if their rates
 * differ. */
imk_term_display imki_several_term(const imk_identify_several *s, size_t channel,
                                   imk_noise_term term);

/* Truth beside the estimates, and how many intervals cover it. */
void imki_truth_table(const imk_identify_shown *shown, imk_result *result);

/* The Allan deviations of each channel; on the page with the misfit below each.
 * @param points  what the points are, for the caption */
void imki_identify_figure(const imk_identify_shown *shown, const char *points, imk_result *result);
/* Deviations and models of several sensors, a panel for each channel. @param name  of the figure */
void imki_devices_figure(const imk_identify_several *several, const imk_identify_shown *records,
                         const char *name, imk_result *result);

#endif
