/* SPDX-License-Identifier: Apache-2.0 */
/* Notes, warnings and the error as data. Standard output of a command with --json holds one object:
 * the result, or the error. */
#include "told.h"

#include "command.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static told *findings;
static size_t finding_count;

static bool json_wanted, json_printed;

static struct {
    bool told;
    char code[48], message[2000], file[1000], next[2600];
    imk_error error;
} failure;

void told_wants_json(void)
{
    json_wanted = true;
}

void told_begin(void)
{
    for (size_t i = 0; i < finding_count; i++) {
        free(findings[i].code);
        free(findings[i].message);
    }
    free(findings);
    findings = NULL;
    finding_count = 0;
    memset(&failure, 0, sizeof failure);
    json_printed = false;
}

static char *copy_of(const char *text)
{
    const size_t size = strlen(text) + 1;
    return memcpy(command_memory(NULL, size), text, size);
}

bool told_finding(imk_finding_level level, const char *code, const char *message)
{
    for (size_t i = 0; i < finding_count; i++)
        if (strcmp(findings[i].code, code) == 0 && strcmp(findings[i].message, message) == 0)
            return false;
    findings = command_memory(findings, (finding_count + 1) * sizeof *findings);
    /* Where memory ends here, what was told before is shown: the list grows at last. */
    findings[finding_count] =
        (told){.level = level, .code = copy_of(code), .message = copy_of(message)};
    finding_count++;
    return true;
}

size_t told_count(void)
{
    return finding_count;
}

const told *told_get(size_t index)
{
    return index < finding_count ? &findings[index] : NULL;
}

size_t told_warnings(void)
{
    size_t count = 0;
    for (size_t i = 0; i < finding_count; i++)
        count += findings[i].level == IMK_FINDING_WARNING;
    return count;
}

/* "rate_missing" of IMK_ERROR_RATE_MISSING. */
static void status_code(imk_status status, size_t size, char *code)
{
    static const char prefix[] = "IMK_ERROR_";
    const char *name = imk_status_name(status);
    if (strncmp(name, prefix, sizeof prefix - 1) == 0)
        name += sizeof prefix - 1;
    size_t length = 0;
    for (; name[length] && length + 1 < size; length++)
        code[length] = (char)tolower((unsigned char)name[length]);
    code[length] = '\0';
}

void told_code(const char *code, const imk_error *error, size_t size, char *text)
{
    if (code || !error)
        snprintf(text, size, "%s", code ? code : "failed");
    else
        status_code(error->status, size, text);
}

void told_error(const char *code, const imk_error *error, const char *file, const char *message)
{
    if (failure.told)
        return;
    failure.told = true;
    if (error)
        failure.error = *error;
    told_code(code, error, sizeof failure.code, failure.code);
    snprintf(failure.message, sizeof failure.message, "%s", message);
    snprintf(failure.file, sizeof failure.file, "%s", file ? file : "");
}

void told_next(const char *line)
{
    snprintf(failure.next, sizeof failure.next, "%s", line);
}

static void show_text(imk_result *result, const char *key, const char *text)
{
    imk_result_text(result, key, *text ? text : NULL);
}

static void show_place(imk_result *result, const char *key, size_t place)
{
    if (place > 0)
        imk_result_count(result, key, (long long)place);
    else
        imk_result_null(result, key);
}

static void show_error(imk_result *result)
{
    imk_result_object(result, "error");
    imk_result_text(result, "code", failure.code);
    imk_result_text(result, "message", failure.message);
    show_text(result, "file", failure.file);
    show_place(result, "line", failure.error.line);
    show_place(result, "column", failure.error.column);
    show_text(result, "field", failure.error.field);
    show_text(result, "found", failure.error.found);
    show_text(result, "expected", failure.error.expected);
    show_text(result, "next", failure.next);
    imk_result_end(result);
}

void told_show(imk_result *result)
{
    json_printed = true;
    if (failure.told)
        show_error(result);
    imk_result_array(result, "findings");
    for (size_t i = 0; i < finding_count; i++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "level",
                        findings[i].level == IMK_FINDING_WARNING ? "warning" : "note");
        imk_result_text(result, "code", findings[i].code);
        imk_result_text(result, "message", findings[i].message);
        imk_result_end(result);
    }
    imk_result_end(result);
}

/* Where memory is exhausted, standard error alone says so. */
void told_end(int code)
{
    char *text = NULL;
    size_t size = 0;
    if (code == EXIT_DONE || !json_wanted || json_printed || !failure.told)
        return;
    imk_result *result = imk_result_create(NULL);
    imk_result_text(result, "imukit", imk_version());
    imk_result_text(result, "command", command_verb());
    told_show(result);
    if (imk_result_to_json(result, &text, &size) == IMK_OK)
        (void)fwrite(text, 1, size, stdout);
    free(text);
    imk_result_free(result);
}
