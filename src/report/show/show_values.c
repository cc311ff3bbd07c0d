/* SPDX-License-Identifier: Apache-2.0 */
/* Values with their uncertainty, in words and as data. */
#include "show_internal.h"

#include "report/result_internal.h"

#include <stdio.h>
#include <stdlib.h>

imki_words imki_value(double value, double uncertainty, int digits)
{
    imki_words words;
    imk_readable_value(value, uncertainty, digits, words.text, sizeof words.text);
    return words;
}

imki_words imki_plus_minus(double value, double sigma, double scale)
{
    char number[IMKI_WORDS / 2 - 4], width[IMKI_WORDS / 2 - 4];
    imki_words words;
    imk_readable_value(value / scale, sigma / scale, 4, number, sizeof number);
    imk_readable_value(sigma / scale, sigma / scale, 2, width, sizeof width);
    snprintf(words.text, sizeof words.text, "%s ± %s", number, width);
    return words;
}

imki_words imki_range(double lower, double upper, double scale)
{
    const double width = (upper - lower) / scale / 4;
    char first[IMKI_WORDS / 2 - 4], second[IMKI_WORDS / 2 - 4];
    imki_words words;
    imk_readable_value(lower / scale, width, 3, first, sizeof first);
    imk_readable_value(upper / scale, width, 3, second, sizeof second);
    snprintf(words.text, sizeof words.text, "%s to %s", first, second);
    return words;
}

imki_words imki_interval(const imk_estimate *e, double scale)
{
    imki_words words;
    if (e->present)
        return imki_range(e->lower, e->upper, scale);
    snprintf(words.text, sizeof words.text, "< %.60s", imki_value(e->upper / scale, 0, 2).text);
    return words;
}

imki_words imki_chance(double probability)
{
    imki_words words;
    snprintf(words.text, sizeof words.text, probability < 1e-12 ? "below 1e-12" : "%.2g",
             probability);
    return words;
}

imki_words imki_duration(double seconds)
{
    imki_words words;
    imk_readable_duration(seconds, words.text, sizeof words.text);
    return words;
}

size_t imki_members(const imk_even_record *record, imk_channel_kind kind, size_t *member)
{
    size_t count = 0;
    for (size_t c = 0; c < record->count; c++)
        if (imk_channel_kind_of(imk_even_record_column(record, c)) == kind)
            member[count++] = c;
    return count;
}

void imki_show_estimate(imk_result *result, const char *key, const imk_estimate *estimate,
                        double scale, const char *unit)
{
    imk_result_object(result, key);
    imk_result_flag(result, "present", estimate->present);
    imk_result_number(result, "value", estimate->value / scale);
    imk_result_number(result, "sigma", estimate->sigma / scale);
    imk_result_number(result, "lower", estimate->lower / scale);
    imk_result_number(result, "upper", estimate->upper / scale);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

bool imki_begin_object(imk_result *result, const char *key, bool there)
{
    if (there)
        imk_result_object(result, key);
    else
        imk_result_null(result, key);
    return there;
}

void imki_show_texts(imk_result *result, const char *key, size_t count, const char *const *texts)
{
    imk_result_array(result, key);
    for (size_t i = 0; i < count; i++)
        imk_result_text(result, NULL, texts[i]);
    imk_result_end(result);
}

void imki_begin_curve(imk_figure_builder *figure, const char *label, imk_curve_style style,
                      int color)
{
    imk_figure_curve(figure, &(imk_curve){.label = label, .style = style, .color = color}, 1);
}

void imki_show_text(imki_text *text, imk_result *result)
{
    if (result && text->failed)
        result->arena.failed = true;
    else if (text->size > 0)
        imk_result_line(result, "%s", text->bytes);
    free(text->bytes);
}

bool imki_warned(const imk_findings *findings)
{
    for (size_t i = 0; i < findings->count; i++)
        if (findings->item[i].level == IMK_FINDING_WARNING)
            return true;
    return false;
}

void imki_show_warnings(const imk_findings *findings, imk_result *result)
{
    char text[400];
    for (size_t i = 0; i < findings->count; i++)
        if (findings->item[i].level == IMK_FINDING_WARNING) {
            imk_finding_text(&findings->item[i], text, sizeof text);
            imk_result_finding(result, 2, text);
        }
}
