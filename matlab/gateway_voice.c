/* SPDX-License-Identifier: Apache-2.0 */
/* What verbs say within MATLAB and Octave: kept until they have ended (voice.h). */
#include "gateway.h"

#include "imukit/model_file.h"

#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static gateway_call call;

gateway_call *gateway_now(void)
{
    return &call;
}

void gateway_clear(void)
{
    gateway_remove_files();
    for (int i = 0; i < call.count; i++)
        free(call.word[i]);
    for (size_t i = 0; i < call.warning_count; i++)
        free(call.warning[i].text);
    free(call.json);
    free(call.model);
    memset(&call, 0, sizeof call);
}

static void set_failure(const char *by, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

static void set_failure(const char *by, const char *format, va_list arguments)
{
    if (call.failed_by[0])
        return;
    snprintf(call.failed_by, sizeof call.failed_by, "%s", by);
    vsnprintf(call.failure, sizeof call.failure, format, arguments);
}

bool gateway_refuse(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    set_failure("usage", format, arguments);
    va_end(arguments);
    return false;
}

char *gateway_copy(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    if (!copy)
        voice_end(1);
    memcpy(copy, text, strlen(text) + 1);
    return copy;
}

/* ---- voice.h --------------------------------------------------------------------------------- */

static void fail(const char *by, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void fail(const char *by, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    set_failure(by, format, arguments);
    va_end(arguments);
}

/* Notes are in the result. */
void voice_say(voice_kind kind, const char *name, const char *code, const char *text)
{
    (void)name;
    if (kind == VOICE_FAILURE) {
        fail(code, "%s", text);
    } else if (kind == VOICE_WARNING && call.warning_count < GATEWAY_WARNINGS_MAX) {
        gateway_warning *warning = &call.warning[call.warning_count];
        warning->text = gateway_copy(text);
        snprintf(warning->code, sizeof warning->code, "%s", code);
        call.warning_count++;
    }
}

/* What to type at a shell. */
void voice_advise(const char *format, ...)
{
    (void)format;
}

void voice_result(const char *text, size_t size)
{
    char *copy = malloc(size + 1);
    if (!copy)
        voice_end(1);
    memcpy(copy, text, size);
    copy[size] = '\0';
    free(call.json);
    call.json = copy;
}

void voice_aside(const char *text, size_t size)
{
    (void)text;
    (void)size;
}

void voice_model(const imk_model *model)
{
    char *text = NULL;
    size_t size;
    imk_error error;
    if (imk_model_print(model, NULL, &text, &size, &error) == IMK_ERROR_MEMORY)
        voice_end(1);
    free(call.model);
    call.model = text;
}

#ifdef HAVE_OCTAVE
extern sig_atomic_t octave_interrupt_state; /* of quit.h, which is C++ */
static bool interrupted(void)
{
    return octave_interrupt_state > 0;
}
#else
extern bool utIsInterruptPending(void); /* of libut, which every MATLAB has */
static bool interrupted(void)
{
    return utIsInterruptPending();
}
#endif

bool voice_interrupted(void)
{
    if (interrupted())
        fail("cancelled", "interrupted");
    return interrupted();
}

void voice_end(int code)
{
    (void)code;
    gateway_remove_files();
    mexErrMsgIdAndTxt("imukit:memory", "memory is exhausted");
    abort(); /* the line above does not return */
}
