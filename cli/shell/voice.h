/* SPDX-License-Identifier: Apache-2.0 */
/* How the command speaks to whoever runs it: voice.c is for a person at a terminal. A program that
 * runs verbs by itself, as the gateway of matlab/ does, has functions of its own in its place. */
#ifndef IMUKIT_VOICE_H
#define IMUKIT_VOICE_H

#include "imukit/model.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum voice_kind { VOICE_NOTE, VOICE_WARNING, VOICE_FAILURE } voice_kind;

/* A message, without control sequences.
 * @param name  of the verb that speaks; NULL: none yet
 * @param code  of a warning; of a failure "usage" or "failed" */
void voice_say(voice_kind kind, const char *name, const char *code, const char *text);
/* What to type next. */
void voice_advise(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* A result, as JSON or text. */
void voice_result(const char *text, size_t size);
/* A text beside the result, of several lines. */
void voice_aside(const char *text, size_t size);
/* A model that a verb has made, which --output writes. */
void voice_model(const imk_model *model);
/* Has the person asked to stop? The command is then ended by a signal, so here the answer is no. */
bool voice_interrupted(void);
/* End where there is no way back. */
_Noreturn void voice_end(int code);

#endif
