/* SPDX-License-Identifier: Apache-2.0 */
/* The messages of a verdict: collected one by one, and shown as data, as boxes and as lines. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void imki_verdict_add(imk_verdict *v, imk_finding_level level, const char *code, const char *format,
                      ...)
{
    if (!v->result)
        return;
    imki_arena *arena = &v->result->arena;
    va_list arguments;
    va_start(arguments, format);
    const char *text = imki_arena_format(arena, format, arguments);
    va_end(arguments);
    v->message = imki_arena_extend(arena, v->message, v->count, sizeof *v->message);
    if (!v->message) {
        v->count = 0;
        return;
    }
    if (v->label)
        text = imk_result_key(v->result, "%.200s: %s", v->label, text);
    v->message[v->count++] = (imk_message){.level = level, .code = code, .text = text};
    imki_verdict_about(v, NULL, 0);
}

void imki_verdict_list(imk_verdict *v, imk_finding_level level, const char *code,
                       const char *before, imki_text *list, const char *after)
{
    if (list->size > 0)
        imki_verdict_add(v, level, code, "%s%s%s", before, list->bytes, after);
    if (v->result && list->failed)
        v->result->arena.failed = true;
    free(list->bytes);
}

bool imk_verdict_warns(const imk_verdict *v)
{
    for (size_t k = 0; k < v->count; k++)
        if (v->message[k].level >= IMK_FINDING_WARNING)
            return true;
    return false;
}

void imki_verdict_data(const imk_verdict *v, imk_result *result)
{
    static const char *const levels[] = {"good", "note", "warning", "failure"};
    imk_result_array(result, "verdict");
    for (size_t k = 0; k < v->count; k++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "level", levels[v->message[k].level]);
        imk_result_text(result, "code", v->message[k].code);
        imk_result_text(result, "message", v->message[k].text);
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imki_verdict_boxes(const imk_verdict *v, imk_result *result)
{
    for (size_t k = 0; k < v->count; k++)
        if (strcmp(v->message[k].code, "good") != 0)
            imk_result_finding(result, (int)v->message[k].level, v->message[k].text);
}

/* A message of the job as a sentence among others; what begins with the name of a channel, or in
 * brackets, stays as it is. */
static const char *sentence(imk_result *result, const char *text)
{
    const size_t size = strlen(text), word = strcspn(text, " ");
    const bool plain = text[0] >= 'a' && text[0] <= 'z' && !memchr(text, '_', word);
    const bool ends = size > 0 && strchr(".!?", text[size - 1]) != NULL;
    return plain || !ends ? imk_result_key(result, "%c%s%s", plain ? text[0] - 'a' + 'A' : text[0],
                                           text + 1, ends ? "" : ".")
                          : text;
}

/* One box of doubts and one of notes: a page begins with the picture, not with a column of boxes.
 */
void imki_verdict_brief_boxes(const imk_verdict *v, imk_result *result)
{
    for (int doubts = 1; doubts >= 0; doubts--) {
        const char *all = NULL;
        imk_finding_level level = IMK_FINDING_GOOD;
        for (size_t k = 0; k < v->count; k++) {
            const imk_message *m = &v->message[k];
            const char *text = sentence(result, m->brief ? m->brief : m->text);
            if (strcmp(m->code, "good") == 0 || (m->level >= IMK_FINDING_WARNING) != (doubts > 0))
                continue;
            all = all ? imk_result_key(result, "%s %s", all, text) : text;
            level = m->level > level ? m->level : level;
        }
        if (all)
            imk_result_finding(result, (int)level, all);
    }
}

void imki_verdict_lines(const imk_verdict *v, bool verbose, imk_result *result)
{
    if (!verbose)
        imki_verdict_briefly(v, result);
    for (size_t k = 0; verbose && k < v->count; k++)
        if (strcmp(v->message[k].code, "good") != 0)
            imk_result_line(result, "%s", v->message[k].text);
}
