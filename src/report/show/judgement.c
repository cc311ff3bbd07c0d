/* SPDX-License-Identifier: Apache-2.0 */
/* The sentence that judges a result: "Usable with care for X: reason; reason; and 2 more." */
#include "show_internal.h"

#include "report/result_internal.h"

#include <stdarg.h>
#include <stddef.h>
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

/* "NAME: " or "NAME in OTHER: " that a message begins with, of a name "NAME<tab>OTHER".
 * @return its length; 0: there is none */
static size_t length_of_name(const char *text, const char *name)
{
    char begins[2 * IMKI_WORDS];
    const char *tab = strchr(name, '\t');
    const int length = tab ? (int)(tab - name) : (int)strlen(name);
    snprintf(begins, sizeof begins, "%.*s: ", length, name);
    if (tab && strncmp(text, begins, strlen(begins)) != 0)
        snprintf(begins, sizeof begins, "%.*s in %s: ", length, name, tab + 1);
    return length > 0 && strncmp(text, begins, strlen(begins)) == 0 ? strlen(begins) : 0;
}

/* What a message says before it explains or advises: to the first colon or semicolon behind the
 * name it begins with, not within parentheses. */
static int length_of_fact(const char *text, const char *name)
{
    const size_t named = length_of_name(text, name);
    const char *end = text + (named > 0 ? named : length_of_name(text, "the record"));
    for (int depth = 0; *end; end++) {
        depth += (*end == '(') - (*end == ')');
        if (depth == 0 && strchr(";:.", *end) && (end[1] == ' ' || !end[1]))
            break;
    }
    return (int)(end - text);
}

void imki_reason_of_message(imki_reasons *reasons, const char *text)
{
    const char *colon = strstr(text, ": ");
    char name[IMKI_WORDS] = "";
    if (colon && colon - text < (ptrdiff_t)sizeof name)
        snprintf(name, sizeof name, "%.*s", (int)(colon - text), text);
    imki_reason(reasons, "%.*s", length_of_fact(text, name), text);
}

/* Warnings of the kind of one of them, before it or behind it. */
static size_t count_alike(const imk_findings *findings, size_t first, bool before)
{
    size_t count = 0;
    for (size_t k = before ? 0 : first + 1; k < (before ? first : findings->count); k++)
        count += findings->item[k].level == IMK_FINDING_WARNING &&
                 strcmp(findings->item[k].code, findings->item[first].code) == 0;
    return count;
}

void imki_reasons_of_warnings(imki_reasons *reasons, const imk_findings *findings)
{
    char text[900];
    for (size_t k = 0; k < findings->count; k++) {
        const imk_finding *f = &findings->item[k];
        if (f->level != IMK_FINDING_WARNING || count_alike(findings, k, true) > 0)
            continue;
        const size_t alike = count_alike(findings, k, false);
        imk_finding_text(f, text, sizeof text);
        char more[40] = "";
        if (alike > 0)
            snprintf(more, sizeof more, " (and %zu more)", alike);
        imki_reason(reasons, "%.*s%s", length_of_fact(text, f->name), text, more);
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
