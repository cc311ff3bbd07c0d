/* SPDX-License-Identifier: Apache-2.0 */
/* The sentence that judges a result: "Usable with care for X: reason; reason; and 2 more." */
#include "show_internal.h"

#include "report/result_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { REASONS_MOST = 3 };

void imki_reason(imki_reasons *reasons, const char *format, ...)
{
    imk_result *result = reasons->result;
    va_list arguments;
    if (!result)
        return;
    if (reasons->told == REASONS_MOST) {
        reasons->left++;
        return;
    }
    va_start(arguments, format);
    const char *text = imki_arena_format(&result->arena, format, arguments);
    va_end(arguments);
    reasons->text =
        reasons->told == 0 ? text : imk_result_key(result, "%s; %s", reasons->text, text);
    reasons->told++;
}

/* What a message says before it explains or advises: to the first colon or semicolon behind the
 * name it begins with. */
static int length_of_fact(const char *text, const char *name)
{
    const char *begin = text;
    const size_t length = strlen(name);
    if (length > 0 && strncmp(text, name, length) == 0 && text[length] == ':')
        begin += length + 1;
    else if (strncmp(text, "the record:", strlen("the record:")) == 0)
        begin += strlen("the record:");
    const char *end = begin;
    while (*end && !((*end == ';' || *end == ':' || *end == '.') && (end[1] == ' ' || !end[1])))
        end++;
    return (int)(end - text);
}

void imki_reasons_of_warnings(imki_reasons *reasons, const imk_findings *findings)
{
    char text[900];
    for (const imk_finding *f = findings->item; f < findings->item + findings->count; f++) {
        if (f->level != IMK_FINDING_WARNING)
            continue;
        imk_finding_text(f, text, sizeof text);
        imki_reason(reasons, "%.*s", length_of_fact(text, f->name), text);
    }
}

const char *imki_judgement(const imki_reasons *reasons, imk_usability usability, const char *use)
{
    static const char *const grades[] = {"Usable", "Usable with care", "Not usable"};
    char more[40] = "";
    if (reasons->left > 0)
        snprintf(more, sizeof more, "; and %zu more", reasons->left);
    const char *text =
        imk_result_key(reasons->result, "%s%s%s%s%s", grades[usability], use,
                       reasons->told > 0 ? ": " : "", reasons->text ? reasons->text : "", more);
    const size_t length = strlen(text);
    return length > 0 && strchr(".?", text[length - 1])
               ? text
               : imk_result_key(reasons->result, "%s.", text);
}

void imki_judge(const imki_reasons *reasons, imk_usability usability, const char *use)
{
    imk_result_judge(reasons->result, usability, "%s", imki_judgement(reasons, usability, use));
}
