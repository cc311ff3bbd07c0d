/* SPDX-License-Identifier: Apache-2.0 */
/* Messages to standard error, results to standard output. */
#include "voice.h"

#include "command.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void voice_say(voice_kind kind, const char *name, const char *code, const char *text)
{
    static const struct {
        const char *color, *label;
    } form[] = {[VOICE_NOTE] = {"", ""},
                [VOICE_WARNING] = {COLOR_YELLOW, "warning:"},
                [VOICE_FAILURE] = {COLOR_RED, "error:"}};
    const char *color = form[kind].color, *label = form[kind].label;
    (void)code;
    fflush(stdout);
    fprintf(stderr, "imukit%s%s: ", name ? " " : "", name ? name : "");
    if (*label)
        fprintf(stderr, "%s%s%s ", command_color(stderr, color), label,
                command_color(stderr, COLOR_RESET));
    fprintf(stderr, "%s\n", text);
}

void voice_advise(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputs("\n", stderr);
}

void voice_result(const char *text, size_t size)
{
    if (fwrite(text, 1, size, stdout) != size)
        (void)command_failed("standard output: %s", strerror(errno));
}

void voice_aside(const char *text, size_t size)
{
    (void)fwrite(text, 1, size, stderr);
}

void voice_model(const imk_model *model)
{
    (void)model;
}

bool voice_interrupted(void)
{
    return false;
}

void voice_end(int code)
{
    exit(code);
}
